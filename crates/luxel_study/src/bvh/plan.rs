//! What the BVH study measures.
use luxel_engine::{BackendChoice, MeshAccel, MeshLevels, MeshQuality, has_hardware_gpu};
use luxel_scene::{MeshSplit, Surface};

use super::configuration::Configuration;
use super::model::BunnyModel;
use super::record::Sweep;
use super::scene::{BUNNY_FREQUENCY, Scene};
use super::staging::{Staging, View};
use super::study::BvhStudy;
use crate::kit::plan::Plan as KitPlan;

/// Up to this many triangles they are also tested one by one.
const NAIVE_MOST: u32 = 5000;
/// Tests of a frame in which every pixel tests every triangle, at most: as many as those of the rabbit in full. Larger
/// models are compared in fewer pixels.
const LOST_MOST_TESTS: f64 = 6e9;
/// Fewest rows of those pixels.
const LOST_LEAST_HEIGHT: u32 = 9;
/// Fineness of the rabbit whose triangles are tested one by one on the GPU: a software driver ends loops after 65,536
/// turns.
const NAIVE_GPU_FREQUENCY: u32 = 57;
/// How often the same thing is measured to learn the noise.
const REPEATS: usize = 4;
/// Rays of a path in the pictures of the report's kind: enough for light to reach every corner.
pub(crate) const BOUNCES: u32 = 6;
/// What a floor is in the three pictures of figure 13.
pub(crate) const SMOOTHNESS: [(&str, f32); 3] = [("diffuse", 0.0), ("half", 0.5), ("mirror", 1.0)];
/// The bins that are compared.
const BINS: [u32; 6] = [2, 4, 8, 16, 32, 64];
/// The sizes of leaves that are compared.
const LEAF_SIZES: [u32; 4] = [1, 2, 4, 8];
/// The four pictures of figure 7.
pub(crate) const SHADINGS: [(&str, bool, bool); 4] = [
    ("diffuse, flat", false, false),
    ("diffuse, smooth", true, false),
    ("semi-specular, flat", false, true),
    ("semi-specular, smooth", true, true),
];
/// The bunny as plastic: what the report says looks like a diamond when it is flat.
const PLASTIC: Surface = Surface::SemiSpecular { albedo: glam::Vec3::new(0.62, 0.50, 0.38), smoothness: 0.5 };
/// Variants of figure 9.
pub(crate) const DIRECT: &str = "direct light";
pub(crate) const BOUNCED: &str = "with bounces";

/// A study to be made.
pub struct Plan(pub(crate) KitPlan<BvhStudy>);

/// Configurations that take turns.
pub(crate) type Group = crate::kit::plan::Group<BvhStudy>;

/// How much of everything.
struct Extent {
    quick: bool,
    /// Heights of pictures that are shown, and their samples.
    picture_height: u32,
    picture_spp: u32,
    /// Heights of what is only measured, on the CPU and on the GPU.
    cpu_height: u32,
    gpu_height: u32,
    /// Height and samples of the picture that both backends make.
    reference_height: u32,
    reference_spp: u32,
    /// Heights of the window around an ear.
    cpu_ear_height: u32,
    gpu_ear_height: u32,
    /// Finenesses of the rabbit.
    counts: &'static [u32],
    preset_counts: &'static [u32],
    /// The same of pictures that are shown and of those that are only measured, on a GPU that is no software driver.
    hardware_picture_height: u32,
    hardware_height: u32,
    /// What takes long on a software driver is measured on the CPU alone.
    whole_gpu: bool,
    frames: u32,
    rounds: u32,
    secs_each: f64,
}

const FULL: Extent = Extent {
    quick: false,
    picture_height: 720,
    picture_spp: 32,
    cpu_height: 360,
    gpu_height: 90,
    reference_height: 180,
    reference_spp: 64,
    cpu_ear_height: 216,
    gpu_ear_height: 54,
    counts: &[7, 15, 30, 59, 84, 118],
    preset_counts: &[7, 30, BUNNY_FREQUENCY, 118],
    hardware_picture_height: 1080,
    hardware_height: 1080,
    whole_gpu: true,
    frames: 50,
    rounds: 5,
    secs_each: 3.0,
};

const QUICK: Extent = Extent {
    quick: true,
    picture_height: 234,
    picture_spp: 16,
    cpu_height: 90,
    gpu_height: 36,
    reference_height: 108,
    reference_spp: 10,
    cpu_ear_height: 54,
    gpu_ear_height: 18,
    counts: &[7, 15, 30, BUNNY_FREQUENCY, 118],
    preset_counts: &[7, BUNNY_FREQUENCY],
    hardware_picture_height: 1080,
    hardware_height: 540,
    whole_gpu: false,
    frames: 12,
    rounds: 3,
    secs_each: 0.12,
};

/// A few seconds in all: for tests.
const TINY: Extent = Extent {
    quick: true,
    picture_height: 18,
    picture_spp: 1,
    cpu_height: 9,
    gpu_height: 9,
    reference_height: 9,
    reference_spp: 2,
    cpu_ear_height: 9,
    gpu_ear_height: 9,
    counts: &[2, 7, 16],
    preset_counts: &[2, 7],
    hardware_picture_height: 18,
    hardware_height: 9,
    whole_gpu: false,
    frames: 2,
    rounds: 1,
    secs_each: 0.001,
};

impl Plan {
    /// The report's results and what it supposes, at length.
    pub fn full(backends: &[BackendChoice], model: &BunnyModel) -> Self {
        Self::of(&FULL, backends, model)
    }

    /// The same figures in three minutes on two cores: smaller pictures, fewer frames and steps.
    pub fn quick(backends: &[BackendChoice], model: &BunnyModel) -> Self {
        Self::of(&QUICK, backends, model)
    }

    /// The same figures in seconds, of no value but to see whether they come out.
    pub fn tiny(backends: &[BackendChoice], model: &BunnyModel) -> Self {
        Self::of(&TINY, backends, model)
    }

    /// The same with other seconds of frames per configuration.
    #[must_use]
    pub fn with_secs_each(mut self, secs: f64) -> Self {
        self.0.set_secs_each(secs);
        self
    }

    /// Number of runs.
    pub fn run_count(&self) -> usize {
        self.0.run_count()
    }

    fn of(extent: &Extent, backends: &[BackendChoice], model: &BunnyModel) -> Self {
        let mut groups = Vec::new();
        for &backend in backends {
            let is_hardware = backend == BackendChoice::Gpu && has_hardware_gpu();
            let on = On { extent, backend, is_hardware, model };
            groups.extend(on.measured_everywhere());
            if backend == BackendChoice::Cpu || is_hardware || backends.len() == 1 || extent.whole_gpu {
                groups.extend(on.pictures());
                groups.extend(on.builds());
            }
        }
        let Extent { quick, frames, rounds, .. } = *extent;
        Self(KitPlan { groups, quick, frames, rounds })
    }
}

/// An extent on a backend.
struct On<'a> {
    extent: &'a Extent,
    backend: BackendChoice,
    is_hardware: bool,
    model: &'a BunnyModel,
}

impl On<'_> {
    fn group(&self, sweep: Sweep, scene: Scene, configurations: Vec<Configuration>) -> Group {
        Group { sweep, backend: self.backend, scene, configurations, secs_each: self.extent.secs_each }
    }

    fn is_gpu(&self) -> bool {
        self.backend == BackendChoice::Gpu
    }

    /// A picture that is only measured.
    fn measured(&self) -> Configuration {
        let Extent { cpu_height, gpu_height, hardware_height, .. } = *self.extent;
        let height = match (self.is_gpu(), self.is_hardware) {
            (false, _) => cpu_height,
            (true, false) => gpu_height,
            (true, true) => hardware_height,
        };
        Configuration::new(sixteen_by_nine(height), 1, BOUNCES)
    }

    /// A picture that is also shown.
    fn shown(&self) -> Configuration {
        let Extent { picture_height, picture_spp, cpu_height, gpu_height, hardware_picture_height, .. } =
            *self.extent;
        let height = match (self.is_gpu(), self.is_hardware) {
            (false, _) => picture_height,
            (true, false) => picture_height * gpu_height / cpu_height,
            (true, true) => hardware_picture_height,
        };
        Configuration::new(sixteen_by_nine(height), 1, BOUNCES).shown(picture_spp)
    }

    fn both_searches(&self, configuration: &Configuration) -> Vec<Configuration> {
        vec![
            configuration.clone().with(MeshAccel::Bvh),
            Configuration { shown_spp: 0, ..configuration.clone() }.with(MeshAccel::BvhEscape),
        ]
    }

    fn bunny(&self) -> Scene {
        Scene::Bunny(self.model.clone())
    }

    fn measured_everywhere(&self) -> Vec<Group> {
        let mut groups = vec![
            self.group(Sweep::Bunny, self.bunny(), self.both_searches(&self.shown())),
            self.group(Sweep::Room, Scene::MirrorRoom, self.both_searches(&self.shown())),
            self.group(
                Sweep::BunnyRoom,
                Scene::BunnyRoom(self.model.clone()),
                self.both_searches(&self.shown()),
            ),
            self.reference(),
            self.lost(),
            self.views(),
            self.levels(),
            self.group(Sweep::Noise, Scene::Rabbit(self.extent.counts[0]), vec![self.measured(); REPEATS]),
            self.group(Sweep::Noise, self.bunny(), vec![self.measured(); REPEATS]),
        ];
        groups.extend(self.extent.counts.iter().map(|frequency| self.counts(*frequency)));
        groups
    }

    fn reference(&self) -> Group {
        let Extent { reference_height, reference_spp, .. } = *self.extent;
        let size = sixteen_by_nine(reference_height);
        let all = vec![Configuration::new(size, 1, BOUNCES).shown(reference_spp)];
        self.group(Sweep::Reference, Scene::MirrorRoom, all)
    }

    fn lost(&self) -> Group {
        let Extent { cpu_ear_height, gpu_ear_height, .. } = *self.extent;
        let height = match self.model {
            _ if self.is_gpu() => gpu_ear_height,
            BunnyModel::Rabbit => cpu_ear_height,
            BunnyModel::File(file) => cpu_ear_height.min(lost_height(file.asset.mesh.triangles.len())),
        };
        let window = Configuration::new(sixteen_by_nine(height), 1, 0)
            .staged(Staging { view: View::Ear, ..Staging::default() });
        let searches = [MeshAccel::Naive, MeshAccel::BvhEscape, MeshAccel::Bvh];
        let mut all = searches.map(|accel| window.clone().with(accel));
        if !self.is_gpu() {
            all[2].shown_spp = self.extent.picture_spp;
        }
        let scene = if self.is_gpu() { Scene::Rabbit(NAIVE_GPU_FREQUENCY) } else { self.bunny() };
        self.group(Sweep::Lost, scene, all.to_vec())
    }

    fn counts(&self, frequency: u32) -> Group {
        let mut all = vec![self.measured(), self.measured().with(MeshAccel::BvhEscape)];
        if 20 * frequency * frequency <= NAIVE_MOST {
            all.insert(0, self.measured().with(MeshAccel::Naive));
        }
        self.group(Sweep::Counts, Scene::Rabbit(frequency), all)
    }

    fn pictures(&self) -> Vec<Group> {
        let shading = |(variant, is_smooth, is_plastic): (&'static str, bool, bool)| {
            let surface = is_plastic.then_some(PLASTIC);
            let view = View::Close;
            self.shown().variant(variant).staged(Staging { view, is_smooth, surface, ..Staging::default() })
        };
        let smoothness = |(variant, smoothness): (&'static str, f32)| {
            self.shown()
                .variant(variant)
                .staged(Staging { smoothness: Some(smoothness), ..Staging::default() })
        };
        // The first scattering is that of direct light.
        let direct = Configuration { bounces: 1, ..self.shown() }.variant(DIRECT);
        vec![
            self.group(Sweep::Shading, self.bunny(), SHADINGS.map(shading).to_vec()),
            self.group(Sweep::Shadow, Scene::BounceLight, vec![direct, self.shown().variant(BOUNCED)]),
            self.group(Sweep::Spheres, Scene::DiffuseSpheres, vec![self.shown()]),
            self.group(Sweep::PointLights, Scene::PointLights, vec![self.shown()]),
            self.group(Sweep::Floor, Scene::SemiSpecularFloor, SMOOTHNESS.map(smoothness).to_vec()),
        ]
    }

    fn builds(&self) -> Vec<Group> {
        let one = || self.measured();
        let qualities =
            MeshQuality::NAMES.iter().map(|(_, quality)| one().quality(*quality)).collect::<Vec<_>>();
        let mut groups: Vec<Group> = self
            .extent
            .preset_counts
            .iter()
            .map(|frequency| self.group(Sweep::Presets, Scene::Rabbit(*frequency), qualities.clone()))
            .collect();
        groups.extend([
            self.group(Sweep::Bins, self.bunny(), BINS.map(|bins| one().bins(bins)).to_vec()),
            self.group(Sweep::Leaves, self.bunny(), LEAF_SIZES.map(|size| one().leaf_size(size)).to_vec()),
        ]);
        groups
    }

    fn views(&self) -> Group {
        let mut all = Vec::new();
        for view in [View::Far, View::Near, View::Inside] {
            for split in [MeshSplit::Sah, MeshSplit::LargestAxis] {
                all.push(self.measured().split(split).staged(Staging { view, ..Staging::default() }));
            }
        }
        self.group(Sweep::Views, self.bunny(), all)
    }

    fn levels(&self) -> Group {
        let of = |levels, split| self.measured().split(split).levels(levels);
        let all = vec![
            of(MeshLevels::Two, MeshSplit::Sah),
            of(MeshLevels::One, MeshSplit::Sah),
            of(MeshLevels::Two, MeshSplit::LargestAxis),
            of(MeshLevels::One, MeshSplit::LargestAxis),
        ];
        self.group(Sweep::Levels, Scene::OneOrTwoLevels(self.model.clone()), all)
    }
}

/// Rows of the largest picture whose pixels can each test so many triangles.
fn lost_height(triangles: usize) -> u32 {
    let pixels = LOST_MOST_TESTS / (triangles as f64).max(1.0);
    ((pixels * 9.0 / 16.0).sqrt() as u32).max(LOST_LEAST_HEIGHT)
}

fn sixteen_by_nine(height: u32) -> (u32, u32) {
    (height * 16 / 9, height)
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use luxel_scene::{Dropped, MeshAsset, MeshSource, TriangleMesh};

    use super::super::model::ModelFile;
    use super::*;

    const BOTH: [BackendChoice; 2] = [BackendChoice::Cpu, BackendChoice::Gpu];

    fn plans() -> Vec<Plan> {
        let model = BunnyModel::Rabbit;
        let full = Plan::full(&BOTH, &model);
        vec![full, Plan::quick(&BOTH, &model), Plan::tiny(&BOTH, &model), Plan::quick(&BOTH[1..], &model)]
    }

    #[test]
    fn every_sweep_is_in_every_plan() {
        for plan in plans() {
            for sweep in Sweep::ALL {
                assert!(plan.0.groups.iter().any(|group| group.sweep == sweep), "{sweep:?}");
            }
            assert!(plan.0.groups.iter().all(|group| !group.configurations.is_empty()));
            let all = plan.0.groups.iter().flat_map(|group| &group.configurations);
            assert!(all.clone().all(|c| c.size.0 > 0 && c.size.1 > 0));
        }
    }

    #[test]
    fn naive_searches_stand_first_where_others_are_compared_with_them() {
        for plan in plans() {
            let lost = plan.0.groups.iter().filter(|group| group.sweep == Sweep::Lost);
            assert!(lost.clone().all(|group| group.configurations[0].mesh.accel == MeshAccel::Naive));
            assert_eq!(lost.count(), plan.0.backends().len());
        }
    }

    #[test]
    fn a_large_model_is_not_tested_triangle_by_triangle_in_every_pixel() {
        assert!(lost_height(69_620) > FULL.cpu_ear_height && lost_height(500) > 1000);
        let triangles = 1_000_000;
        let mesh = TriangleMesh { triangles: vec![[0, 1, 2]; triangles], ..TriangleMesh::default() };
        let source = MeshSource::File("large.obj".into());
        let asset = MeshAsset { source, mesh, dropped: Dropped::default() };
        let model = BunnyModel::File(Arc::new(ModelFile { name: "large.obj".to_owned(), asset }));
        for group in Plan::full(&BOTH[..1], &model).0.groups {
            let (width, height) = group.configurations[0].size;
            let tests = f64::from(width * height) * triangles as f64;
            assert!(group.sweep != Sweep::Lost || tests <= LOST_MOST_TESTS, "{width}×{height}");
        }
        assert_eq!(lost_height(usize::MAX), LOST_LEAST_HEIGHT);
    }

    #[test]
    fn both_backends_make_the_same_reference() {
        for plan in plans().iter().take(3) {
            let of = |group: &&Group| group.sweep == Sweep::Reference;
            let mut groups = plan.0.groups.iter().filter(of);
            let (cpu, gpu) = (groups.next().unwrap(), groups.next().unwrap());
            assert!(cpu.configurations == gpu.configurations && cpu.scene == gpu.scene);
        }
    }
}
