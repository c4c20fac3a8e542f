//! What every record of a run has, and [`record!`], which declares one.
use serde::Serialize;
use serde::de::DeserializeOwned;

/// What [`record!`] gives to every record.
pub(crate) trait Shared {
    /// What every record has.
    fn common(&self) -> Common<'_>;

    /// The record without what is too long for a table: single frames and the picture.
    fn for_table(&self) -> Self;
}

/// A run of a study: a line of `runs.jsonl`, a row of `runs.csv`.
pub(crate) trait Record: Shared + Clone + PartialEq + Serialize + DeserializeOwned {
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

    /// Number of things in the scene: spheres or triangles.
    fn count(&self) -> u32;

    /// Numbers beside the common ones, by the names of their fields, and which are allowed.
    fn numbers(&self) -> Vec<(&'static str, f64, Allowed)>;

    /// Checks what else there is to be checked.
    ///
    /// # Errors
    /// What is wrong, in words.
    fn check_rest(&self) -> Result<(), String>;

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
    pub(crate) build_secs: f64,
    pub(crate) nodes_per_ray: f64,
    pub(crate) tests_per_ray: f64,
    pub(crate) lambert_bounces: f64,
    pub(crate) metal_bounces: f64,
    pub(crate) dielectric_bounces: f64,
    pub(crate) frames: u32,
    pub(crate) outliers: u32,
    pub(crate) frame_ms: f64,
    pub(crate) frame_ms_p25: f64,
    pub(crate) frame_ms_p75: f64,
    pub(crate) fps: f64,
    pub(crate) rays: f64,
    pub(crate) rays_per_sec: f64,
    pub(crate) noise: Option<f64>,
    pub(crate) frames_ms: &'a [f64],
    pub(crate) picture_png: Option<&'a str>,
}

/// What a configuration says that every record has.
pub(crate) struct Shape {
    pub(crate) structure: &'static str,
    pub(crate) size: (u32, u32),
    pub(crate) spp: u32,
    pub(crate) bounces: u32,
}

/// What was built for a configuration, and what rays did in it.
pub(crate) struct Built {
    pub(crate) build_secs: f64,
    pub(crate) bytes: u64,
    pub(crate) nodes: u32,
    pub(crate) depth: u32,
    pub(crate) nodes_per_ray: f64,
    pub(crate) tests_per_ray: f64,
}

/// Declares the record `$run` of a study: `$own`, which is what its own fields are taken as, between those that all have.
/// In scope are to be `STUDY`, `FORMAT` and the study's `Sweep`.
macro_rules! record {
    ($(#[$about:meta])* pub struct $run:ident, own $own:ident {
        $($(#[$field_about:meta])* pub $field:ident: $kind:ty,)*
    }) => {
        $(#[$about])*
        #[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
        #[serde(deny_unknown_fields)]
        pub struct $run {
            /// Always [`STUDY`].
            pub study: String,
            /// Always [`FORMAT`].
            pub format: u32,
            /// What it was made for.
            pub sweep: Sweep,
            /// True if the study was shortened.
            pub quick: bool,
            /// Runs that the study was to have; 0 if it is not known.
            #[serde(default)]
            pub planned_runs: u32,
            /// When the study began, UTC, as RFC 3339 has it.
            pub date: String,
            /// Version of Luxel.
            pub version: String,
            /// Commit of the source it was built from, if known.
            pub commit: String,
            /// Processor, number of hardware threads, operating system.
            pub machine: String,
            /// `cpu` or `gpu`.
            pub backend: String,
            /// Processor threads or name of the adapter.
            pub device: String,
            /// Driver of the adapter.
            pub driver: String,
            /// Name of the structure that is searched.
            pub structure: String,
            /// Width in pixels.
            pub width: u32,
            /// Height in pixels.
            pub height: u32,
            /// Samples per pixel and frame.
            pub spp: u32,
            /// How often light may scatter after the first hit.
            pub bounces: u32,
            /// Seconds to build the structure, without anything else.
            pub build_secs: f64,
            /// Bytes of the structure with what stands in its leaves.
            pub bytes: u64,
            /// Nodes of the structure.
            pub nodes: u32,
            /// Deepest level of the structure.
            pub depth: u32,
            /// Nodes of the structure that a ray visits.
            pub nodes_per_ray: f64,
            /// Primitives that a ray tests.
            pub tests_per_ray: f64,
            /// Bounces off Lambert surfaces per frame.
            pub lambert_bounces: f64,
            /// Bounces off metals per frame.
            pub metal_bounces: f64,
            /// Reflections and refractions at glass per frame.
            pub dielectric_bounces: f64,
            $($(#[$field_about])* pub $field: $kind,)*
            /// Measured frames that count.
            pub frames: u32,
            /// Measured frames that were outliers.
            pub outliers: u32,
            /// Median of the frames, milliseconds.
            pub frame_ms: f64,
            /// A quarter of the frames are faster, milliseconds.
            pub frame_ms_p25: f64,
            /// A quarter of the frames are slower, milliseconds.
            pub frame_ms_p75: f64,
            /// Frames per second: 1000 / `frame_ms`.
            pub fps: f64,
            /// Rays per frame, of all kinds.
            pub rays: f64,
            /// Rays per second at the median frame.
            pub rays_per_sec: f64,
            /// Relative error of the picture, estimated from its samples; where there is a picture.
            #[serde(default)]
            pub noise: Option<f64>,
            /// Every measured frame, outliers too, in the order of their turns, milliseconds; only in `runs.jsonl`.
            #[serde(default, skip_serializing_if = "Vec::is_empty")]
            pub frames_ms: Vec<f64>,
            /// The picture as a PNG file in base64; only in `runs.jsonl`.
            #[serde(default, skip_serializing_if = "Option::is_none")]
            pub picture_png: Option<String>,
        }

        /// The fields of a record that no other study has.
        pub(super) struct $own {
            $(pub(super) $field: $kind,)*
        }

        impl $run {
            /// The record of a configuration.
            pub(super) fn of<S>(
                made: &$crate::kit::study::Made<'_, S>,
                shape: $crate::kit::record::Shape,
                built: $crate::kit::record::Built,
                timing: $crate::kit::measured::Timing,
                look: Option<&$crate::kit::measured::Look>,
                own: $own,
            ) -> Self
            where
                S: $crate::kit::study::Study<Sweep = Sweep>,
            {
                let (origin, backend) = (made.origin, made.facts);
                Self {
                    study: STUDY.to_owned(),
                    format: FORMAT,
                    sweep: made.group.sweep,
                    quick: made.plan.quick,
                    planned_runs: made.plan.run_count() as u32,
                    date: origin.date.clone(),
                    version: origin.version.clone(),
                    commit: origin.commit.clone(),
                    machine: origin.machine.clone(),
                    backend: backend.backend.name().to_owned(),
                    device: backend.device.clone(),
                    driver: backend.driver.trim().to_owned(),
                    structure: shape.structure.to_owned(),
                    width: shape.size.0,
                    height: shape.size.1,
                    spp: shape.spp,
                    bounces: shape.bounces,
                    build_secs: $crate::kit::measured::rounded(built.build_secs),
                    bytes: built.bytes,
                    nodes: built.nodes,
                    depth: built.depth,
                    nodes_per_ray: built.nodes_per_ray,
                    tests_per_ray: built.tests_per_ray,
                    lambert_bounces: timing.lambert_bounces,
                    metal_bounces: timing.metal_bounces,
                    dielectric_bounces: timing.dielectric_bounces,
                    $($field: own.$field,)*
                    frames: timing.frames,
                    outliers: timing.outliers,
                    frame_ms: timing.frame_ms,
                    frame_ms_p25: timing.frame_ms_p25,
                    frame_ms_p75: timing.frame_ms_p75,
                    fps: timing.fps,
                    rays: timing.rays,
                    rays_per_sec: timing.rays_per_sec,
                    noise: look.map(|look| $crate::kit::measured::rounded(look.noise)),
                    frames_ms: timing.frames_ms,
                    picture_png: look.map(|look| look.png.clone()),
                }
            }

            /// With frames, for tests, of which a quarter, half and three quarters are faster than these, milliseconds.
            #[cfg(test)]
            pub(crate) fn with_frames(self, [frame_ms_p25, frame_ms, frame_ms_p75]: [f64; 3]) -> Self {
                Self { fps: 1e3 / frame_ms, frame_ms_p25, frame_ms, frame_ms_p75, ..self }
            }

            /// A record for tests, of a sweep.
            #[cfg(test)]
            fn example_of(sweep: Sweep, structure: &str, own: $own) -> Self {
                let text = |text: &str| text.to_owned();
                Self {
                    study: text(STUDY),
                    format: FORMAT,
                    sweep,
                    quick: true,
                    planned_runs: 1,
                    date: text("2026-11-23T05:00:00Z"),
                    version: text("0.1.0"),
                    commit: text("abc"),
                    machine: text("a machine"),
                    backend: text("cpu"),
                    device: text("2 threads"),
                    driver: String::new(),
                    structure: text(structure),
                    width: 64,
                    height: 48,
                    spp: 4,
                    bounces: 4,
                    build_secs: 0.001,
                    bytes: 4096,
                    nodes: 17,
                    depth: 3,
                    nodes_per_ray: 20.0,
                    tests_per_ray: 5.0,
                    lambert_bounces: 10.0,
                    metal_bounces: 10.0,
                    dielectric_bounces: 10.0,
                    $($field: own.$field,)*
                    frames: 50,
                    outliers: 1,
                    frame_ms: 10.0,
                    frame_ms_p25: 9.5,
                    frame_ms_p75: 10.5,
                    fps: 100.0,
                    rays: 30_000.0,
                    rays_per_sec: 3e6,
                    noise: None,
                    frames_ms: Vec::new(),
                    picture_png: None,
                }
            }
        }

        impl $crate::kit::record::Shared for $run {
            fn common(&self) -> $crate::kit::record::Common<'_> {
                $crate::kit::record::Common {
                    study: &self.study,
                    format: self.format,
                    planned_runs: self.planned_runs,
                    date: &self.date,
                    version: &self.version,
                    commit: &self.commit,
                    machine: &self.machine,
                    backend: &self.backend,
                    device: &self.device,
                    driver: &self.driver,
                    structure: &self.structure,
                    width: self.width,
                    height: self.height,
                    spp: self.spp,
                    build_secs: self.build_secs,
                    nodes_per_ray: self.nodes_per_ray,
                    tests_per_ray: self.tests_per_ray,
                    lambert_bounces: self.lambert_bounces,
                    metal_bounces: self.metal_bounces,
                    dielectric_bounces: self.dielectric_bounces,
                    frames: self.frames,
                    outliers: self.outliers,
                    frame_ms: self.frame_ms,
                    frame_ms_p25: self.frame_ms_p25,
                    frame_ms_p75: self.frame_ms_p75,
                    fps: self.fps,
                    rays: self.rays,
                    rays_per_sec: self.rays_per_sec,
                    noise: self.noise,
                    frames_ms: &self.frames_ms,
                    picture_png: self.picture_png.as_deref(),
                }
            }

            fn for_table(&self) -> Self {
                Self { picture_png: None, frames_ms: Vec::new(), ..self.clone() }
            }
        }
    };
}
pub(crate) use record;
