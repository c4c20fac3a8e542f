//! The graph: which nodes there are, in which sets they stand, and why each runs.
use bevy_ecs::prelude::*;
use bevy_ecs::schedule::{LogLevel, ScheduleBuildSettings, ScheduleConfigs, SingleThreadedExecutor};
use bevy_ecs::system::ScheduleSystem;
use luxel_flat::{Feature, FeatureSet};
use luxel_gpu::GpuError;

use crate::nodes::{self, Purpose, Work};

/// The stages of a frame, run in this order.
#[derive(SystemSet, Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum GraphSet {
    /// Uniforms for the slice.
    Begin,
    /// Paths start.
    Generate,
    /// The camera's rays meet the scene.
    CameraRays,
    /// First-hit outputs.
    FirstHits,
    /// Shading and further rays, bounce by bounce.
    Bounces,
    /// Samples go to the film.
    Accumulate,
    /// Where the next samples go.
    Refine,
    /// The film becomes a picture.
    Resolve,
}

/// A node of the graph.
pub struct NodeRow {
    /// Name, as in `luxel graph` and in pass times.
    pub name: &'static str,
    /// Its stage.
    pub set: GraphSet,
    /// Kernels it dispatches.
    pub kernels: &'static [&'static str],
    /// Runs only with this feature; always if `None`.
    pub feature: Option<Feature>,
    /// Why it runs, as the end of a sentence that begins with "because".
    pub because: &'static str,
    /// The system; `None` if the passes are recorded by the node before it, one by one between its own.
    system: Option<fn() -> ScheduleConfigs<ScheduleSystem>>,
}

/// Every node, in the order of its stage.
pub const NODES: &[NodeRow] = &[
    NodeRow {
        name: "begin",
        set: GraphSet::Begin,
        kernels: &[],
        feature: None,
        because: "the kernels read which pixels and which sample they work on",
        system: Some(|| nodes::begin.pipe(keep_error).into_configs()),
    },
    NodeRow {
        name: "generate",
        set: GraphSet::Generate,
        kernels: &["generate"],
        feature: None,
        because: "every path starts at the camera",
        system: Some(|| nodes::generate.pipe(keep_error).run_if(starting)),
    },
    NodeRow {
        name: "camera_rays",
        set: GraphSet::CameraRays,
        kernels: &["intersect", "surface"],
        feature: None,
        because: "every path needs to know what the camera sees",
        system: Some(|| nodes::camera_rays.pipe(keep_error).run_if(starting)),
    },
    NodeRow {
        name: "first_hits",
        set: GraphSet::FirstHits,
        kernels: &["first_hits"],
        feature: Some(Feature::Aovs),
        because: "first-hit outputs were asked for",
        system: Some(|| nodes::first_hits.pipe(keep_error).run_if(starting).run_if(has_aovs)),
    },
    NodeRow {
        name: "bounces",
        set: GraphSet::Bounces,
        kernels: &["shade", "scatter", "intersect", "surface"],
        feature: None,
        because: "light is gathered where a ray ends, and the path may go on",
        system: Some(|| nodes::bounces.pipe(keep_error).run_if(tracing)),
    },
    NodeRow {
        name: "shadow_rays",
        set: GraphSet::Bounces,
        kernels: &["shadow"],
        feature: Some(Feature::Lights),
        because: "a light that was sampled shines only on what it sees",
        system: None,
    },
    NodeRow {
        name: "accumulate",
        set: GraphSet::Accumulate,
        kernels: &["accumulate"],
        feature: None,
        because: "finished paths are samples of the picture",
        system: Some(|| nodes::accumulate.pipe(keep_error).run_if(finishing)),
    },
    NodeRow {
        name: "resolve",
        set: GraphSet::Resolve,
        kernels: &["resolve"],
        feature: None,
        because: "a picture is shown when one is asked for",
        system: Some(|| nodes::resolve.pipe(keep_error).run_if(resolving)),
    },
];

/// The features that the pipelines were made for.
#[derive(Resource, Clone, Copy, Default)]
pub(crate) struct ActiveFeatures(pub(crate) FeatureSet);

/// The first error of a frame.
#[derive(Resource, Default)]
pub(crate) struct Failure(pub(crate) Option<GpuError>);

fn starting(work: Res<Work>) -> bool {
    matches!(work.purpose, Purpose::Trace { starts: true, .. })
}

fn tracing(work: Res<Work>) -> bool {
    matches!(work.purpose, Purpose::Trace { .. })
}

fn finishing(work: Res<Work>) -> bool {
    matches!(work.purpose, Purpose::Trace { finishes: true, .. })
}

fn resolving(work: Res<Work>) -> bool {
    work.purpose == Purpose::Resolve
}

fn has_aovs(features: Res<ActiveFeatures>) -> bool {
    features.0.has(Feature::Aovs)
}

fn keep_error(In(result): In<Result<(), GpuError>>, mut failure: ResMut<Failure>) {
    if let Err(error) = result {
        failure.0.get_or_insert(error);
    }
}

/// The schedule, its nodes added in the given order of [`NODES`]. The order makes no difference: a test shuffles
/// it.
pub fn schedule_in_order(order: impl IntoIterator<Item = usize>) -> Schedule {
    let mut schedule = Schedule::default();
    schedule.set_executor(SingleThreadedExecutor::new());
    schedule.set_build_settings(ScheduleBuildSettings {
        ambiguity_detection: LogLevel::Error,
        ..Default::default()
    });
    schedule.configure_sets(
        (
            GraphSet::Begin,
            GraphSet::Generate,
            GraphSet::CameraRays,
            GraphSet::FirstHits,
            GraphSet::Bounces,
            GraphSet::Accumulate,
            GraphSet::Refine,
            GraphSet::Resolve,
        )
            .chain(),
    );
    for row in order.into_iter().map(|index| &NODES[index]) {
        if let Some(system) = row.system {
            schedule.add_systems(system().in_set(row.set));
        }
    }
    schedule
}
