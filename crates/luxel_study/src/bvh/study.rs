//! What the BVH study takes from a configuration, and its record.
use bevy_ecs::prelude::World;
use luxel_engine::{Counter, FrameSettings, FrameStage, MeshTreeFacts, SphereCloud};

use super::configuration::{Configuration, split_name};
use super::page::{TITLE, page};
use super::plan::{BOUNCES, Group};
use super::record::{OwnFields, Run, Sweep};
use super::scene::{self, Scene};
use super::staging;
use crate::StudyError;
use crate::kit::measured::{Look, Measured, median_build, rounded};
use crate::kit::picture::png;
use crate::kit::plan::SEED;
use crate::kit::record::{Built, Shape};
use crate::kit::study::{Made, Study};

/// Builds are repeated no longer than this.
const BUILD_SECS: f64 = 0.1;

/// Seed document 2's results and discussion.
pub(crate) struct BvhStudy;

/// What is taken from a configuration beside its frames.
#[derive(Default)]
pub(crate) struct Facts {
    trees: MeshTreeFacts,
    build_secs: f64,
    hardware_gpu: bool,
    look: Option<Look>,
    dark: Option<f64>,
    /// What the pixels show first, where structures are compared.
    seen: Vec<[u32; 2]>,
    lost_pixels: Option<u32>,
}

impl Study for BvhStudy {
    type Run = Run;
    type Sweep = Sweep;
    type Scene = Scene;
    type Configuration = Configuration;
    type Facts = Facts;

    const KIND: &'static str = "a BVH study";
    const WORLD: &'static str = "(BVH study)";
    const TITLE: &'static str = TITLE;
    const PAGE: &'static str = super::PAGE;

    fn world(scene: &Scene) -> Result<World, StudyError> {
        scene::world(scene)
    }

    fn configure(world: &mut World, configuration: &Configuration) {
        staging::stage(world, &configuration.staging);
    }

    fn settings(configuration: &Configuration, seed: u32) -> FrameSettings {
        FrameSettings {
            cloud: SphereCloud::default(),
            mesh: configuration.mesh,
            size: configuration.size,
            spp: configuration.spp,
            max_depth: configuration.bounces,
            seed,
            first_hits: false,
        }
    }

    fn what(group: &Group, configuration: &Configuration) -> String {
        let variant = match configuration.variant {
            "" => configuration.mesh.accel.name(),
            variant => variant,
        };
        format!("{}, {variant}", group.scene.name())
    }

    fn baked(stage: &mut FrameStage, secs: f64, measured: &mut Measured<Facts>) -> Result<(), StudyError> {
        measured.facts.trees = stage.mesh_trees();
        measured.facts.build_secs = median_build(secs.min(BUILD_SECS), || stage.mesh_build_secs())?;
        measured.facts.hardware_gpu = stage.is_hardware_gpu();
        Ok(())
    }

    /// Takes the picture, what is dark in it, and what structures see first.
    fn look(
        stage: &mut FrameStage,
        group: &Group,
        configuration: &Configuration,
        _seed: u32,
        measured: &mut Measured<Facts>,
        first: Option<&Facts>,
    ) -> Result<(), StudyError> {
        let facts = &mut measured.facts;
        if configuration.shown_spp > 0 {
            stage.edit(|world| Self::configure(world, configuration));
            // Pictures that are compared with each other have the same random numbers.
            let settings = Self::settings(configuration, SEED);
            // Where only first hits are measured, the picture shows more than those.
            let max_depth = if group.sweep == Sweep::Lost { BOUNCES } else { configuration.bounces };
            stage.set(&FrameSettings { spp: configuration.shown_spp, max_depth, ..settings })?;
            stage.frame()?;
            facts.look = Some(Look { png: png(&stage.picture()?)?, noise: stage.noise()? });
            facts.dark = (group.sweep == Sweep::Shadow).then(|| stage.dark_share()).transpose()?;
        }
        if group.sweep == Sweep::Lost {
            stage.edit(|world| Self::configure(world, configuration));
            let settings = Self::settings(configuration, SEED);
            stage.set(&FrameSettings { first_hits: true, ..settings })?;
            stage.frame()?;
            facts.seen = stage.first_primitives()?;
            facts.lost_pixels = first.map(|naive| differing(&naive.seen, &facts.seen));
        }
        Ok(())
    }

    fn record(made: &Made<'_, Self>, configuration: &Configuration, measured: &Measured<Facts>) -> Run {
        let Configuration { mesh, staging, variant, size, spp, bounces, shown_spp } = configuration;
        let (scene, facts) = (&made.group.scene, &measured.facts);
        let shape = Shape { structure: mesh.accel.name(), size: *size, spp: *spp, bounces: *bounces };
        let own = OwnFields {
            hardware_gpu: facts.hardware_gpu,
            scene: scene.name().to_owned(),
            model: scene.model(),
            variant: (*variant).to_owned(),
            preset: mesh.quality.name().to_owned(),
            split: split_name(mesh.split).to_owned(),
            bins: mesh.bins.unwrap_or_default(),
            leaf_size: mesh.leaf_size,
            levels: mesh.levels.name().to_owned(),
            view: staging.view.name().to_owned(),
            triangles: u32::try_from(facts.trees.triangles).unwrap_or(u32::MAX),
            picture_spp: *shown_spp,
            sah_cost: rounded(facts.trees.sah_cost),
            tlas_nodes_per_ray: measured.per_ray(Counter::TlasNodes),
            semi_specular_bounces: measured.per_frame(Counter::SemiSpecularBounces),
            shadow_rays: measured.per_frame(Counter::ShadowRays),
            lost_pixels: facts.lost_pixels,
            dark: facts.dark.map(rounded),
        };
        let built = Built {
            build_secs: facts.build_secs,
            bytes: facts.trees.bytes,
            nodes: u32::try_from(facts.trees.nodes).unwrap_or(u32::MAX),
            depth: facts.trees.depth,
            nodes_per_ray: measured.per_ray(Counter::BvhNodes),
            tests_per_ray: measured.per_ray(Counter::TriangleTests),
        };
        Run::of(made, shape, built, measured.timing(), facts.look.as_ref(), own)
    }

    fn page(runs: &[Run]) -> Result<String, StudyError> {
        page(runs)
    }
}

/// How many pixels show something else.
fn differing(a: &[[u32; 2]], b: &[[u32; 2]]) -> u32 {
    let common = a.iter().zip(b).filter(|(a, b)| a != b).count();
    (common + a.len().abs_diff(b.len())) as u32
}
