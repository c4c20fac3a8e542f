//! What the octree study measures.
use luxel_engine::{BackendChoice, QUALITIES, Quality, SphereAccel, SphereCloud};

use super::field::SphereField;
use super::record::Sweep;
use super::study::OctreeStudy;
use crate::kit::plan::{Plan as KitPlan, SEED};

/// Deepest octree that is built; deeper ones that are asked for are held at this.
pub(crate) const MAX_DEPTH: u32 = 20;
/// The numbers of spheres of the report.
const COUNTS: [u32; 7] = [10, 50, 100, 250, 500, 1000, 2000];
/// Spheres of the scene in which qualities are compared.
const QUALITY_SPHERES: u32 = 100;
/// Small spheres of the scene with spheres of very different sizes.
pub(crate) const MIXED_SPHERES: u32 = 1000;
/// Large spheres among them (robustness.md, M6).
const LARGE_SPHERES: [u32; 2] = [3, 10];
/// Spheres of the scene in which depth is set against quality.
const DEPTH_QUALITY_SPHERES: u32 = 250;
/// The sizes of leaves that the report compares, and those that its conclusion asks for.
const REPORT_LEAVES: [u32; 2] = [0, 1];
const LARGER_LEAVES: [u32; 4] = [2, 4, 8, 16];
/// Deepest octree of cells that is divided down to single cells (smallest node 0) in a quick study: each level more
/// has eight times the cells.
const QUICK_DEPTH_OF_LEAF_0: u32 = 5;

/// A study to be made.
pub struct Plan(pub(crate) KitPlan<OctreeStudy>);

/// Configurations that take turns.
pub(crate) type Group = crate::kit::plan::Group<OctreeStudy>;

/// What is varied.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Configuration {
    pub(crate) accel: SphereAccel,
    pub(crate) asked_depth: u32,
    pub(crate) min_spheres: u32,
    pub(crate) size: (u32, u32),
    pub(crate) quality: Quality,
}

impl Configuration {
    pub(crate) fn cloud(&self) -> SphereCloud {
        SphereCloud {
            accel: self.accel,
            max_depth: self.asked_depth.min(MAX_DEPTH),
            min_spheres: self.min_spheres,
        }
    }
}

/// How much of everything.
struct Extent {
    quick: bool,
    counts: &'static [u32],
    large_counts: &'static [u32],
    grid_counts: &'static [u32],
    grid_heights: &'static [u32],
    depths: &'static [u32],
    picture_height: u32,
    cpu_height: u32,
    gpu_height: u32,
    depth_height: u32,
    gpu_depth: bool,
    frames: u32,
    rounds: u32,
    secs_each: f64,
}

const FULL: Extent = Extent {
    quick: false,
    counts: &COUNTS,
    large_counts: &[10_000, 100_000, 1_000_000],
    grid_counts: &COUNTS,
    grid_heights: &[96, 144, 240],
    depths: &[0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10],
    picture_height: 360,
    cpu_height: 192,
    gpu_height: 48,
    depth_height: 96,
    gpu_depth: true,
    frames: 50,
    rounds: 5,
    secs_each: 1.5,
};

const QUICK: Extent = Extent {
    quick: true,
    counts: &COUNTS,
    large_counts: &[10_000, 100_000],
    grid_counts: &[10, 50, 250, 500],
    grid_heights: &[24, 36, 48],
    depths: &[0, 1, 2, 3, 4, 5, 7, 10],
    picture_height: 270,
    cpu_height: 72,
    gpu_height: 36,
    depth_height: 48,
    gpu_depth: false,
    frames: 12,
    rounds: 3,
    secs_each: 0.06,
};

/// A few seconds in all: for tests.
const TINY: Extent = Extent {
    quick: true,
    counts: &[10, 50, 500, 1000],
    large_counts: &[3000],
    grid_counts: &[10, 50],
    grid_heights: &[6, 12],
    depths: &[0, 1, 2],
    picture_height: 12,
    cpu_height: 12,
    gpu_height: 6,
    depth_height: 6,
    gpu_depth: false,
    frames: 2,
    rounds: 1,
    secs_each: 0.001,
};

impl Plan {
    /// Everything that the report measured, and more.
    pub fn full(backends: &[BackendChoice]) -> Self {
        Self::of(&FULL, backends)
    }

    /// The same figures in two minutes on two cores: smaller pictures, fewer frames and steps.
    pub fn quick(backends: &[BackendChoice]) -> Self {
        Self::of(&QUICK, backends)
    }

    /// The same figures in seconds, of no value but to see whether they come out.
    pub fn tiny(backends: &[BackendChoice]) -> Self {
        Self::of(&TINY, backends)
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

    fn of(extent: &Extent, backends: &[BackendChoice]) -> Self {
        let mut groups = Vec::new();
        for backend in backends {
            if groups.is_empty() {
                groups.extend(extent.pictures(*backend));
            }
            groups.extend(extent.counts(*backend));
            groups.extend(extent.mixed(*backend));
            let is_gpu = *backend == BackendChoice::Gpu;
            if !is_gpu || backends.len() == 1 {
                groups.extend(extent.grid(*backend));
            }
            if !is_gpu || extent.gpu_depth || backends.len() == 1 {
                groups.extend(extent.depths(*backend));
                groups.extend(extent.fractions(*backend));
                groups.extend(extent.depths_by_quality(*backend));
            }
        }
        let Extent { quick, frames, rounds, .. } = *extent;
        Self(KitPlan { groups, quick, frames, rounds })
    }
}

impl Extent {
    fn group(
        &self,
        sweep: Sweep,
        backend: BackendChoice,
        count: u32,
        configurations: Vec<Configuration>,
    ) -> Group {
        let scene = SphereField::Random { count, seed: SEED };
        Group { sweep, backend, scene, configurations, secs_each: self.secs_each }
    }

    /// Height of the pictures of a sweep on a backend: on the GPU all are smaller by the same factor.
    fn height(&self, backend: BackendChoice, cpu_height: u32) -> u32 {
        if backend == BackendChoice::Gpu {
            cpu_height * self.gpu_height / self.cpu_height
        } else {
            cpu_height
        }
    }

    fn pictures(&self, backend: BackendChoice) -> Vec<Group> {
        let size = four_by_three(self.picture_height);
        let one = |quality| ours(size, quality);
        let qualities = QUALITIES.iter().map(|row| one(row.quality)).collect();
        let materials = Group {
            scene: SphereField::Materials,
            ..self.group(Sweep::Materials, backend, 3, vec![one(Quality::High)])
        };
        vec![
            materials,
            self.group(Sweep::Scene, backend, 100, vec![one(Quality::High)]),
            self.group(Sweep::Quality, backend, QUALITY_SPHERES, qualities),
        ]
    }

    fn counts(&self, backend: BackendChoice) -> Vec<Group> {
        let size = four_by_three(self.height(backend, self.cpu_height));
        let group = |count: &u32, is_large: bool| {
            let mut all = vec![ours(size, Quality::Low), bvh(size, Quality::Low)];
            all.extend(
                [SphereAccel::OctreeSeed, SphereAccel::OctreeBase]
                    .map(|accel| cells(accel, *count, size, Quality::Low)),
            );
            if !is_large {
                all.insert(0, naive(size, Quality::Low));
            }
            self.group(Sweep::Counts, backend, *count, all)
        };
        let large = self.large_counts.iter().map(|count| group(count, true));
        self.counts.iter().map(|count| group(count, false)).chain(large).collect()
    }

    /// Like the counts, but with spheres of very different sizes.
    fn mixed(&self, backend: BackendChoice) -> Vec<Group> {
        let size = four_by_three(self.height(backend, self.cpu_height));
        let quality = Quality::Low;
        let mut groups = Vec::new();
        for large in LARGE_SPHERES {
            let mut all = vec![ours(size, quality), bvh(size, quality)];
            let reports = [SphereAccel::OctreeSeed, SphereAccel::OctreeBase];
            all.extend(reports.map(|accel| cells(accel, MIXED_SPHERES, size, quality)));
            let scene = SphereField::Mixed { count: MIXED_SPHERES, large, seed: SEED };
            groups.push(Group { scene, ..self.group(Sweep::Mixed, backend, MIXED_SPHERES, all) });
        }
        groups
    }

    fn grid(&self, backend: BackendChoice) -> Vec<Group> {
        let mut groups = Vec::new();
        for &count in self.grid_counts {
            for row in QUALITIES {
                for &height in self.grid_heights {
                    let size = four_by_three(self.height(backend, height));
                    let quality = row.quality;
                    let seed = cells(SphereAccel::OctreeSeed, count, size, quality);
                    let all = vec![naive(size, quality), ours(size, quality), seed];
                    groups.push(self.group(Sweep::Grid, backend, count, all));
                }
            }
        }
        groups
    }

    fn depths(&self, backend: BackendChoice) -> Vec<Group> {
        let size = four_by_three(self.height(backend, self.depth_height));
        let group = |count: &u32| {
            let mut all = Vec::new();
            for accel in [SphereAccel::OctreeSeed, SphereAccel::Octree] {
                for (depth, leaf) in self.depths_and_leaves() {
                    let quality = Quality::Low;
                    all.push(Configuration { accel, asked_depth: depth, min_spheres: leaf, size, quality });
                }
            }
            self.group(Sweep::Depth, backend, *count, all)
        };
        self.counts.iter().map(group).collect()
    }

    /// Depth and smallest node. A quick study leaves out what is largest, and tries larger nodes at full depth only.
    fn depths_and_leaves(&self) -> Vec<(u32, u32)> {
        let deepest = self.depths.last().copied().unwrap_or_default();
        let small =
            REPORT_LEAVES.iter().flat_map(|leaf| self.depths.iter().map(move |depth| (*depth, *leaf)));
        let larger =
            LARGER_LEAVES.iter().flat_map(|leaf| self.depths.iter().map(move |depth| (*depth, *leaf)));
        let is_wanted = |(depth, leaf): &(u32, u32)| match leaf {
            0 => !self.quick || *depth <= QUICK_DEPTH_OF_LEAF_0,
            1 => true,
            _ => !self.quick || *depth == deepest,
        };
        small.chain(larger).filter(is_wanted).collect()
    }

    fn fractions(&self, backend: BackendChoice) -> Vec<Group> {
        let size = four_by_three(self.height(backend, self.depth_height));
        let group = |count: &u32| {
            let mut all = Vec::new();
            for accel in [SphereAccel::OctreeSeed, SphereAccel::Octree] {
                for asked_depth in [count / 2, *count, count * 2] {
                    all.push(Configuration {
                        accel,
                        asked_depth,
                        min_spheres: 1,
                        size,
                        quality: Quality::Low,
                    });
                }
            }
            self.group(Sweep::Fraction, backend, *count, all)
        };
        self.counts.iter().map(group).collect()
    }

    fn depths_by_quality(&self, backend: BackendChoice) -> Vec<Group> {
        let size = four_by_three(self.height(backend, self.depth_height));
        let group = |quality: Quality| {
            let mut all = Vec::new();
            for accel in [SphereAccel::OctreeSeed, SphereAccel::Octree] {
                for &asked_depth in self.depths {
                    all.push(Configuration { accel, asked_depth, min_spheres: 1, size, quality });
                }
            }
            self.group(Sweep::DepthQuality, backend, DEPTH_QUALITY_SPHERES, all)
        };
        QUALITIES.iter().map(|row| group(row.quality)).collect()
    }
}

fn four_by_three(height: u32) -> (u32, u32) {
    (height * 4 / 3, height)
}

fn with_defaults(accel: SphereAccel, size: (u32, u32), quality: Quality) -> Configuration {
    let SphereCloud { max_depth, min_spheres, .. } = SphereCloud::default();
    Configuration { accel, asked_depth: max_depth, min_spheres, size, quality }
}

fn naive(size: (u32, u32), quality: Quality) -> Configuration {
    with_defaults(SphereAccel::Naive, size, quality)
}

fn ours(size: (u32, u32), quality: Quality) -> Configuration {
    with_defaults(SphereAccel::Octree, size, quality)
}

fn bvh(size: (u32, u32), quality: Quality) -> Configuration {
    with_defaults(SphereAccel::Bvh, size, quality)
}

/// The report's octree with its smallest node of 1, and a depth that suits the number of spheres.
fn cells(accel: SphereAccel, count: u32, size: (u32, u32), quality: Quality) -> Configuration {
    Configuration { asked_depth: depth_for(count), min_spheres: 1, ..with_defaults(accel, size, quality) }
}

/// The depth at which there is about a cell to a sphere: the report's best (its figure 19: 2 at 500, 3 at 1000).
fn depth_for(count: u32) -> u32 {
    (count.max(1).ilog2() / 3).max(1)
}

#[cfg(test)]
mod tests {
    use super::*;

    const BOTH: [BackendChoice; 2] = [BackendChoice::Cpu, BackendChoice::Gpu];

    #[test]
    fn every_sweep_is_in_every_plan() {
        for plan in [Plan::full(&BOTH), Plan::quick(&BOTH), Plan::tiny(&BOTH), Plan::quick(&BOTH[1..])] {
            for sweep in [
                Sweep::Materials,
                Sweep::Scene,
                Sweep::Quality,
                Sweep::Grid,
                Sweep::Counts,
                Sweep::Mixed,
                Sweep::Depth,
                Sweep::Fraction,
                Sweep::DepthQuality,
            ] {
                assert!(plan.0.groups.iter().any(|group| group.sweep == sweep), "{sweep:?}");
            }
            assert!(plan.0.groups.iter().all(|group| !group.configurations.is_empty()));
        }
    }

    #[test]
    fn the_full_plan_has_what_the_report_asks_for() {
        let plan = Plan::full(&BOTH);
        let depth: Vec<_> = plan.0.groups.iter().filter(|g| g.sweep == Sweep::Depth).collect();
        assert_eq!(depth.len(), 2 * COUNTS.len());
        assert!(depth.iter().all(|group| group.configurations.len() == 2 * 11 * 6));
        let has_naive = |group: &Group| group.configurations.iter().any(|c| c.accel == SphereAccel::Naive);
        for group in plan.0.groups.iter().filter(|group| group.sweep == Sweep::Counts) {
            assert_eq!(has_naive(group), group.scene.count() <= 2000);
        }
    }

    #[test]
    fn resolutions_differ_on_every_backend() {
        for (extent, backend) in [&FULL, &QUICK, &TINY].into_iter().flat_map(|e| BOTH.map(|b| (e, b))) {
            let plan = Plan::of(extent, &[backend]);
            let grid = plan.0.groups.iter().filter(|group| group.sweep == Sweep::Grid);
            let sizes: std::collections::BTreeSet<(u32, u32)> =
                grid.flat_map(|group| &group.configurations).map(|c| c.size).collect();
            assert_eq!(sizes.len(), extent.grid_heights.len(), "{backend:?} {sizes:?}");
        }
    }

    #[test]
    fn depths_are_held_at_the_deepest_octree() {
        let plan = Plan::quick(&BOTH);
        let all = plan.0.groups.iter().flat_map(|group| &group.configurations);
        let asked: Vec<u32> = all.clone().map(|c| c.asked_depth).collect();
        assert!(asked.contains(&4000) && all.clone().all(|c| c.cloud().max_depth <= MAX_DEPTH));
        assert_eq!((depth_for(1), depth_for(500), depth_for(1000), depth_for(1_000_000)), (1, 2, 3, 6));
    }
}
