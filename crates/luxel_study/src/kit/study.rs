//! What a study says of itself.
use bevy_ecs::prelude::World;
use luxel_engine::{FrameSettings, FrameStage};

use super::measured::Measured;
use super::origin::Origin;
use super::plan::{Group, Plan};
use super::record::Record;
use crate::StudyError;

/// A study: its names, its scenes, what it takes from a configuration beside frames, its records and its page.
pub(crate) trait Study: Sized {
    /// The record of a configuration.
    type Run: Record;
    /// What a group of configurations is measured for.
    type Sweep: Copy;
    /// A scene that configurations have in common.
    type Scene;
    /// What is varied.
    type Configuration;
    /// What is taken from a configuration beside its frames.
    type Facts: Default;

    /// What it is called in errors: `an octree study`.
    const KIND: &'static str;
    /// Stands for a file's name where its worlds are loaded.
    const WORLD: &'static str;
    /// The title of its page, by which the page is known again.
    const TITLE: &'static str;
    /// The file of its page.
    const PAGE: &'static str;

    /// A world with a scene.
    ///
    /// # Errors
    /// When a file of the scene cannot be read.
    fn world(scene: &Self::Scene) -> Result<World, StudyError>;

    /// Changes the world of a group to what a configuration wants to see.
    fn configure(_world: &mut World, _configuration: &Self::Configuration) {}

    /// What a configuration is traced under, random numbers aside.
    fn settings(configuration: &Self::Configuration, seed: u32) -> FrameSettings;

    /// What is being measured, for the user.
    fn what(group: &Group<Self>, configuration: &Self::Configuration) -> String;

    /// Takes what a configuration has as soon as it is baked for the first time; what is timed may take so many seconds.
    ///
    /// # Errors
    /// When its structure cannot be built.
    fn baked(
        stage: &mut FrameStage,
        secs: f64,
        measured: &mut Measured<Self::Facts>,
    ) -> Result<(), StudyError>;

    /// Takes what is not a matter of time, after all turns; `first` is what was taken from the group's first
    /// configuration, and nothing for that one itself.
    ///
    /// # Errors
    /// When the backend fails.
    fn look(
        stage: &mut FrameStage,
        group: &Group<Self>,
        configuration: &Self::Configuration,
        seed: u32,
        measured: &mut Measured<Self::Facts>,
        first: Option<&Self::Facts>,
    ) -> Result<(), StudyError>;

    /// The record of a configuration.
    fn record(
        made: &Made<'_, Self>,
        configuration: &Self::Configuration,
        measured: &Measured<Self::Facts>,
    ) -> Self::Run;

    /// The page of some runs.
    ///
    /// # Errors
    /// [`StudyError::Page`] if a chart cannot be drawn.
    fn page(runs: &[Self::Run]) -> Result<String, StudyError>;
}

/// What the records of a group have in common.
pub(crate) struct Made<'a, S: Study> {
    pub(crate) plan: &'a Plan<S>,
    pub(crate) origin: &'a Origin,
    pub(crate) facts: &'a luxel_engine::BackendFacts,
    pub(crate) group: &'a Group<S>,
}
