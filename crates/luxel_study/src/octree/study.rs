//! What the octree study takes from a configuration, and its record.
use bevy_ecs::prelude::World;
use luxel_engine::{Counter, FrameSettings, FrameStage, MeshStructure, SphereAccel, SphereFacts};

use super::field::{self, SphereField};
use super::page::{TITLE, page};
use super::plan::{Configuration, Group};
use super::record::{OwnFields, Run, Sweep};
use crate::StudyError;
use crate::kit::measured::{Look, Measured, median_build, rounded};
use crate::kit::picture::png;
use crate::kit::plan::SEED;
use crate::kit::record::{Built, Shape};
use crate::kit::study::{Made, Study};

/// Up to this many spheres, first hits are compared with those of no structure at all, beyond with those of our
/// octree, which equals it.
const NAIVE_MOST: u32 = 2000;
/// Rays from anywhere that are compared.
const WRONG_RAYS: u32 = 20_000;
/// Builds are repeated no longer than this.
const BUILD_SECS: f64 = 0.02;

/// Seed document 1's assessment.
pub(crate) struct OctreeStudy;

/// What is taken from a configuration beside its frames.
#[derive(Default)]
pub(crate) struct Facts {
    structure: SphereFacts,
    build_secs: f64,
    wrong_pixels: Option<f64>,
    wrong_rays: Option<f64>,
    look: Option<Look>,
}

impl Study for OctreeStudy {
    type Run = Run;
    type Sweep = Sweep;
    type Scene = SphereField;
    type Configuration = Configuration;
    type Facts = Facts;

    const KIND: &'static str = "an octree study";
    const WORLD: &'static str = "(octree study)";
    const TITLE: &'static str = TITLE;
    const PAGE: &'static str = super::PAGE;

    fn world(scene: &SphereField) -> Result<World, StudyError> {
        Ok(field::world(*scene))
    }

    fn settings(configuration: &Configuration, seed: u32) -> FrameSettings {
        let quality = configuration.quality.row();
        FrameSettings {
            cloud: configuration.cloud(),
            mesh: MeshStructure::default(),
            size: configuration.size,
            spp: quality.spp,
            max_depth: quality.max_depth,
            seed,
            first_hits: false,
        }
    }

    fn what(group: &Group, configuration: &Configuration) -> String {
        format!("{} spheres, {}", group.scene.count(), configuration.accel.name())
    }

    fn baked(stage: &mut FrameStage, secs: f64, measured: &mut Measured<Facts>) -> Result<(), StudyError> {
        measured.facts.structure = stage.structure();
        measured.facts.build_secs = median_build(secs.min(BUILD_SECS), || stage.build_secs())?;
        Ok(())
    }

    /// Takes the picture and its noise, the pixels and rays that are wrong.
    fn look(
        stage: &mut FrameStage,
        group: &Group,
        configuration: &Configuration,
        seed: u32,
        measured: &mut Measured<Facts>,
        _first: Option<&Facts>,
    ) -> Result<(), StudyError> {
        if matches!(group.sweep, Sweep::Materials | Sweep::Scene | Sweep::Quality) {
            stage.set(&Self::settings(configuration, seed))?;
            stage.frame()?;
            measured.facts.look = Some(Look { png: png(&stage.picture()?)?, noise: stage.noise()? });
        }
        let is_compared = matches!(group.sweep, Sweep::Counts | Sweep::Mixed);
        if is_compared && configuration.accel == SphereAccel::OctreeSeed {
            let exact =
                if group.scene.count() <= NAIVE_MOST { SphereAccel::Naive } else { SphereAccel::Octree };
            let right = seen(stage, group, &Configuration { accel: exact, ..*configuration }, seed)?;
            let ours = seen(stage, group, configuration, seed)?;
            measured.facts.wrong_pixels = Some(differing(&right.pixels, &ours.pixels));
            measured.facts.wrong_rays =
                right.rays.zip(ours.rays).map(|(right, ours)| differing(&right, &ours));
        }
        Ok(())
    }

    fn record(made: &Made<'_, Self>, configuration: &Configuration, measured: &Measured<Facts>) -> Run {
        let Configuration { accel, asked_depth, min_spheres, size, quality } = *configuration;
        let (row, facts) = (quality.row(), &measured.facts);
        let shape = Shape { structure: accel.name(), size, spp: row.spp, bounces: row.max_depth };
        let own = OwnFields {
            spheres: made.group.scene.count(),
            asked_depth,
            max_depth: configuration.cloud().max_depth,
            min_spheres,
            quality: row.name.to_owned(),
            cut_off: facts.structure.cut_off,
            wrong_pixels: facts.wrong_pixels.map(rounded),
            wrong_rays: facts.wrong_rays.map(rounded),
        };
        let built = Built {
            build_secs: facts.build_secs,
            bytes: facts.structure.bytes,
            nodes: facts.structure.nodes,
            depth: facts.structure.depth,
            nodes_per_ray: measured.per_ray(Counter::SphereNodes),
            tests_per_ray: measured.per_ray(Counter::SphereTests),
        };
        Run::of(made, shape, built, measured.timing(), facts.look.as_ref(), own)
    }

    fn page(runs: &[Run]) -> Result<String, StudyError> {
        page(runs)
    }
}

/// What rays meet first, by stable id.
struct Seen {
    /// Those of the pixels.
    pixels: Vec<u32>,
    /// Those from anywhere, where they are compared.
    rays: Option<Vec<u32>>,
}

fn seen(
    stage: &mut FrameStage,
    group: &Group,
    configuration: &Configuration,
    seed: u32,
) -> Result<Seen, StudyError> {
    let settings = OctreeStudy::settings(configuration, seed);
    stage.set(&FrameSettings { spp: 1, max_depth: 0, first_hits: true, ..settings })?;
    stage.frame()?;
    // The rays are traced on the CPU, so that they say nothing about another backend.
    let is_cpu = group.backend == luxel_engine::BackendChoice::Cpu;
    let rays = is_cpu.then(|| stage.nearest(field::rays(WRONG_RAYS, SEED)));
    Ok(Seen { pixels: stage.first_hits()?, rays })
}

/// The share in which two answers to the same questions differ.
fn differing(a: &[u32], b: &[u32]) -> f64 {
    let count = a.iter().zip(b).filter(|(a, b)| a != b).count();
    count as f64 / a.len().max(1) as f64
}
