//! What every record of a run has.
use serde::Serialize;
use serde::de::DeserializeOwned;

/// A run of a study: a line of `runs.jsonl`, a row of `runs.csv`.
pub(crate) trait Record: Clone + PartialEq + Serialize + DeserializeOwned {
    /// What is measured again under the same circumstances has the same key.
    type Repeat: Ord;

    /// The value of its field `study`.
    const STUDY: &'static str;
    /// The value of its field `format`: another number when a field changes its meaning.
    const FORMAT: u32;
    /// The values that `structure` may have, in the order of legends.
    const STRUCTURES: &'static [&'static str];

    /// A structure in a legend.
    fn label(structure: &str) -> String;

    /// What every record has.
    fn common(&self) -> Common<'_>;

    /// Numbers beside the common ones, by the names of their fields, and whether they are shares of a whole.
    fn numbers(&self) -> Vec<(&'static str, f64, Allowed)>;

    /// Checks what else there is to be checked.
    ///
    /// # Errors
    /// What is wrong, in words.
    fn check_rest(&self) -> Result<(), String>;

    /// The record without what is too long for a table: single frames and the picture.
    fn for_table(&self) -> Self;

    /// What it repeats; `None` if nothing of its kind is measured twice.
    fn repeat(&self) -> Option<Self::Repeat>;
}

/// Which numbers a field may have.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Allowed {
    /// Any that is finite and not negative.
    NotNegative,
    /// Those above 0.
    Positive,
    /// 0 to 1.
    Share,
}

/// The fields that every record has.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Common<'a> {
    pub(crate) study: &'a str,
    pub(crate) format: u32,
    pub(crate) planned_runs: u32,
    pub(crate) date: &'a str,
    pub(crate) version: &'a str,
    pub(crate) commit: &'a str,
    pub(crate) machine: &'a str,
    pub(crate) backend: &'a str,
    pub(crate) device: &'a str,
    pub(crate) driver: &'a str,
    pub(crate) structure: &'a str,
    pub(crate) width: u32,
    pub(crate) height: u32,
    pub(crate) spp: u32,
    pub(crate) frames: u32,
    pub(crate) outliers: u32,
    pub(crate) frame_ms: f64,
    pub(crate) frame_ms_p25: f64,
    pub(crate) frame_ms_p75: f64,
    pub(crate) fps: f64,
    pub(crate) rays: f64,
    pub(crate) rays_per_sec: f64,
    pub(crate) frames_ms: &'a [f64],
    pub(crate) picture_png: Option<&'a str>,
}
