//! Edited clouds: after `finish` every structure answers as exhaustive search, and as one built afresh.
//!
//! | case of robustness.md | test |
//! |---|---|
//! | E01 (spheres) | `e01_ten_thousand_edits` |
//! | O08 | `o08_a_sphere_crosses_a_plane_back_and_forth` |
//! | any sequence of edits | `any_sequence_of_edits_equals_a_fresh_build` |
#![allow(clippy::unwrap_used)]
mod common;

use std::collections::BTreeMap;

use common::SceneBuilder;
use common::clouds::{EXACT, naive_bits, wrong_rays};
use glam::Vec3;
use luxel_accel::{RootCell, SphereOptions, SphereStructure};
use luxel_cpu::{Exclusion, traverse};
use luxel_flat::{Counter, Counters, FlatScene, SphereAccel, SphereRecord};
use luxel_geom::Ray;
use luxel_testkit::{Random, rays, spheres};

const ROOT: RootCell = RootCell { center: Vec3::ZERO, half_extent: 16.0 };

/// A structure, and beside it what it should hold.
struct Edited {
    structure: SphereStructure,
    model: BTreeMap<u32, SphereRecord>,
}

impl Edited {
    fn new(options: SphereOptions) -> Self {
        let structure = SphereStructure::build(options, ROOT, &[], 0).unwrap();
        Self { structure, model: BTreeMap::new() }
    }

    /// One edit of any kind: a new sphere if the slot is free.
    fn edit(&mut self, slot: u32, random: &mut Random, reach: f32, radii: [f32; 2], revision: u64) {
        let (center, radius) = (random.point(reach), random.log_between(radii[0], radii[1]));
        match (self.model.contains_key(&slot), random.below(5)) {
            (false, _) => {
                let record = spheres::sphere(center, radius, 5000 - slot);
                self.structure.insert(slot, record, revision).unwrap();
                self.model.insert(slot, record);
            }
            (true, 0) => {
                self.structure.remove(slot, revision).unwrap();
                self.model.remove(&slot);
            }
            (true, 1) => {
                self.structure.set_material(slot, revision as u32, revision).unwrap();
                self.model.entry(slot).and_modify(|s| s.material = revision as u32);
            }
            (true, _) => self.moves(slot, center, radius, revision),
        }
    }

    fn moves(&mut self, slot: u32, center: Vec3, radius: f32, revision: u64) {
        self.structure.update(slot, center, radius, revision).unwrap();
        self.model.entry(slot).and_modify(|s| (s.center, s.radius) = (center.into(), radius));
    }

    fn finished(&mut self, revision: u64) -> FlatScene {
        self.structure.finish(revision).unwrap();
        scene(&self.structure)
    }

    fn fresh(&self) -> SphereStructure {
        let all: Vec<_> = self.model.iter().map(|(slot, record)| (*slot, *record)).collect();
        SphereStructure::build(self.structure.options(), ROOT, &all, 1).unwrap()
    }

    /// Asserts that the edited structure, a fresh one and exhaustive search agree.
    #[track_caller]
    fn check(&mut self, rays: &[Ray<f32>], revision: u64) {
        let (edited, fresh) = (self.finished(revision), self.fresh());
        assert_eq!(self.structure.bounds(), fresh.bounds());
        assert_eq!(self.structure.len(), self.model.len() as u32);
        let nothing = |_| Exclusion::NOTHING;
        let expected = naive_bits(&edited, rays, nothing);
        for scene in [edited, scene(&fresh)] {
            let wrong = wrong_rays(&scene, rays, nothing, &expected);
            assert!(wrong.is_empty(), "{:?}: {} wrong", self.structure.options(), wrong.len());
        }
    }
}

/// The scene of a structure, which must be in order; one without spheres has a free slot.
fn scene(structure: &SphereStructure) -> FlatScene {
    if structure.is_empty() {
        structure.validate().unwrap();
        return FlatScene::default();
    }
    SceneBuilder::default().cloud(structure).build()
}

/// Nodes and spheres met per ray.
fn cost(scene: &FlatScene, rays: &[Ray<f32>]) -> f64 {
    let mut counters = Counters::default();
    for ray in rays {
        traverse::intersect(scene, ray, &Exclusion::NOTHING, &mut counters);
    }
    (counters[Counter::SphereNodes] + counters[Counter::SphereTests]) as f64 / rays.len() as f64
}

/// The structures, octrees of cells no deeper than spheres that fill everything allow.
fn settings() -> impl Iterator<Item = SphereOptions> {
    EXACT.into_iter().map(|options| match options.accel {
        SphereAccel::OctreeBase => SphereOptions { max_depth: options.max_depth.min(4), ..options },
        _ => options,
    })
}

#[test]
fn e01_ten_thousand_edits() {
    for options in settings() {
        let mut random = Random::new(1);
        let mut edited = Edited::new(options);
        for edit in 1..=10_000 {
            edited.edit(random.below(400), &mut random, 20.0, [1e-3, 1e3], edit);
            if edit % 100 == 0 {
                edited.check(&rays::random(edit as u32, 100, 40.0), edit);
            }
        }
        edited.check(&rays::random(1, 10_000, 40.0), 10_001);
        let (all, fresh) = (rays::random(2, 2000, 40.0), edited.fresh());
        let (now, anew) = (cost(&scene(&edited.structure), &all), cost(&scene(&fresh), &all));
        assert!(now <= 1.5 * anew, "{options:?}: {now} {anew}");
    }
}

#[test]
fn o08_a_sphere_crosses_a_plane_back_and_forth() {
    for options in settings() {
        let mut edited = Edited::new(options);
        for (slot, record) in (0..).zip(spheres::cloud(8, 100, 12.0, [0.1, 1.0])) {
            edited.structure.insert(slot, record, 1).unwrap();
            edited.model.insert(slot, record);
        }
        for i in 0..1000u64 {
            // −8 is a plane of the loose octree; where those of the cells are, the sphere crosses half of them.
            let x = if i % 2 == 0 { (-8f32).next_up() } else { (-8f32).next_down() };
            edited.moves(7, Vec3::splat(x), 0.5, i);
            let scene = edited.finished(i);
            let aimed = [Vec3::X, Vec3::Y, -Vec3::Z].map(|d| Ray::new(Vec3::splat(x) - 20.0 * d, d));
            let expected = naive_bits(&scene, &aimed, |_| Exclusion::NOTHING);
            assert!(wrong_rays(&scene, &aimed, |_| Exclusion::NOTHING, &expected).is_empty());
        }
        edited.check(&rays::random(8, 1000, 20.0), 1001);
    }
}

#[test]
fn any_sequence_of_edits_equals_a_fresh_build() {
    for options in settings() {
        for seed in 0..40 {
            let mut random = Random::new(seed);
            let mut edited = Edited::new(options);
            for batch in 1..=6 {
                for _ in 0..random.below(40) {
                    edited.edit(random.below(30), &mut random, 8.0, [0.01, 4.0], batch);
                }
                edited.check(&rays::random(100 * seed + batch as u32, 60, 16.0), batch);
            }
        }
    }
}
