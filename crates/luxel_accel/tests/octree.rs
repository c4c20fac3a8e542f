//! The sphere octree: hard cases of robustness.md C2, edits against a fresh build, and what edits cost.
#![allow(clippy::unwrap_used)]
use std::collections::BTreeMap;

use glam::Vec3;
use luxel_accel::{AccelError, OctreeOptions, RootCell, SphereOctree, StructureWork, octree_depth};
use luxel_flat::{NONE, SphereRecord};
use luxel_geom::{Aabb, sphere};
use luxel_testkit::{Random, spheres};
use proptest::prelude::*;

const DEFAULT: OctreeOptions = OctreeOptions { max_depth: 20, min_spheres: 8 };
const UNIT: RootCell = RootCell { center: Vec3::ZERO, half_extent: 1.0 };

fn in_slots(spheres: &[SphereRecord]) -> Vec<(u32, SphereRecord)> {
    (0..).zip(spheres.iter().copied()).collect()
}

fn build(root: RootCell, spheres: &[SphereRecord]) -> SphereOctree {
    let octree = SphereOctree::build(root, DEFAULT, &in_slots(spheres), 1).unwrap();
    octree.validate().unwrap();
    assert_eq!(octree.bounds(), union(spheres));
    octree
}

fn insert_all(root: RootCell, spheres: &[SphereRecord]) -> SphereOctree {
    let mut octree = SphereOctree::new(root, DEFAULT);
    for (slot, record) in in_slots(spheres) {
        octree.insert(slot, record, 1).unwrap();
    }
    octree.validate().unwrap();
    octree
}

fn union<'a>(spheres: impl IntoIterator<Item = &'a SphereRecord>) -> Aabb<f32> {
    let bounds = |s: &SphereRecord| sphere::bounds(s.center.into(), s.radius);
    spheres.into_iter().map(bounds).fold(Aabb::empty(), |a, b| a.union(&b))
}

fn depth(octree: &SphereOctree) -> usize {
    let nodes = octree.nodes().as_slice();
    let level = |node: u32| {
        std::iter::successors(Some(node), |&n| Some(nodes[n as usize].parent).filter(|&p| p != NONE)).count()
            - 1
    };
    octree.spheres().as_slice().iter().filter(|s| s.radius > 0.0).map(|s| level(s.node)).max().unwrap_or(0)
}

/// What was done between two readings.
fn difference(before: StructureWork, after: StructureWork) -> StructureWork {
    StructureWork {
        nodes_touched: after.nodes_touched - before.nodes_touched,
        spheres_touched: after.spheres_touched - before.spheres_touched,
        blocks_allocated: after.blocks_allocated - before.blocks_allocated,
        blocks_freed: after.blocks_freed - before.blocks_freed,
        rebuilds: after.rebuilds - before.rebuilds,
    }
}

#[test]
fn an_empty_octree_has_a_root() {
    let octree = SphereOctree::new(UNIT, DEFAULT);
    octree.validate().unwrap();
    assert!(octree.is_empty() && octree.bounds().is_empty());
    assert_eq!(octree.nodes().len(), 1);
}

#[test]
fn few_spheres_stay_at_the_root() {
    for count in 0..=8 {
        let octree = build(UNIT, &spheres::cloud(1, count, 0.9, [0.01, 0.02]));
        assert_eq!((octree.nodes().len(), octree.len()), (1, count));
    }
    assert!(build(UNIT, &spheres::cloud(1, 9, 0.9, [0.01, 0.02])).nodes().len() > 1);
}

#[test]
fn o01_o02_small_beside_large() {
    build(UNIT, &spheres::small_and_large(1));
    build(RootCell { center: Vec3::ZERO, half_extent: 16.0 }, &spheres::inside_one(2));
}

#[test]
fn o03_many_spheres_at_one_point() {
    let distinct = spheres::nested(10_000, 1.0 / 16_384.0);
    let identical: Vec<_> = (0..10_000).map(|id| spheres::sphere(Vec3::ZERO, 1.0 / 1024.0, id)).collect();
    for all in [distinct, identical] {
        for octree in [build(UNIT, &all), insert_all(UNIT, &all)] {
            assert!(octree.nodes().len() <= 2 * all.len(), "{}", octree.nodes().len());
            assert!(depth(&octree) <= 14, "{}", depth(&octree));
        }
    }
}

#[test]
fn o03_the_depth_is_capped() {
    let specks: Vec<_> = (0..100).map(|id| spheres::sphere(Vec3::splat(0.3), 1e-30, id)).collect();
    let octree = build(UNIT, &specks);
    assert_eq!(depth(&octree), 20);
    assert_eq!(octree.nodes().len(), 1 + 8 * 20);
}

#[test]
fn o04_centres_on_dividing_planes() {
    let all = spheres::on_boundaries();
    for octree in [build(UNIT, &all), insert_all(UNIT, &all)] {
        assert_eq!(octree.len(), all.len() as u32);
    }
}

#[test]
fn o08_a_sphere_crosses_a_plane_back_and_forth() {
    let mut octree = build(UNIT, &spheres::cloud(8, 100, 0.9, [0.01, 0.1]));
    for i in 0..1000u64 {
        let x = if i % 2 == 0 { (-0.5f32).next_up() } else { (-0.5f32).next_down() };
        octree.update(7, Vec3::new(x, -0.5, -0.5), 0.05, i).unwrap();
    }
    octree.validate().unwrap();
}

#[test]
fn spheres_outside_the_root_cell_stay_at_the_root() {
    let mut all = spheres::cloud(3, 50, 0.9, [0.01, 0.02]);
    all.push(spheres::sphere(Vec3::new(100.0, 0.0, 0.0), 0.01, 50));
    let octree = build(UNIT, &all);
    assert_eq!(octree.spheres().as_slice()[50].node, 0);
}

#[test]
fn bad_edits_change_nothing() {
    let mut octree = build(UNIT, &spheres::cloud(3, 50, 0.9, [0.01, 0.02]));
    let before = (octree.nodes().as_slice().to_vec(), octree.spheres().as_slice().to_vec());
    let bad = |center: Vec3, radius| SphereRecord { center: center.into(), radius, ..Default::default() };
    for (center, radius) in [
        (Vec3::ZERO, 0.0),
        (Vec3::ZERO, -1.0),
        (Vec3::ZERO, f32::MIN_POSITIVE / 2.0),
        (Vec3::ZERO, f32::NAN),
        (Vec3::ZERO, f32::INFINITY),
        (Vec3::NAN, 1.0),
        (Vec3::new(0.0, f32::NEG_INFINITY, 0.0), 1.0),
        (Vec3::splat(1e31), 1.0),
    ] {
        assert_eq!(octree.insert(60, bad(center, radius), 2), Err(AccelError::BadSphere { slot: 60 }));
        assert_eq!(octree.update(3, center, radius, 2), Err(AccelError::BadSphere { slot: 3 }));
    }
    assert_eq!(octree.insert(3, bad(Vec3::ZERO, 1.0), 2), Err(AccelError::SlotTaken { slot: 3 }));
    assert_eq!(octree.remove(50, 2), Err(AccelError::SlotEmpty { slot: 50 }));
    assert_eq!(octree.update(90, Vec3::ZERO, 1.0, 2), Err(AccelError::SlotEmpty { slot: 90 }));
    assert_eq!(octree.set_material(90, 1, 2), Err(AccelError::SlotEmpty { slot: 90 }));
    assert_eq!(before.0, octree.nodes().as_slice());
    assert_eq!(before.1, octree.spheres().as_slice());
    let twice = [(1, bad(Vec3::ZERO, 1.0)), (1, bad(Vec3::ZERO, 1.0))];
    assert_eq!(SphereOctree::build(UNIT, DEFAULT, &twice, 1).unwrap_err(), AccelError::SlotTaken { slot: 1 });
}

#[test]
fn moving_one_of_10000_touches_the_way_to_the_root() {
    let root = RootCell { center: Vec3::ZERO, half_extent: 64.0 };
    let mut all = spheres::cloud(5, 10_000, 50.0, [0.1, 0.3]);
    all[0] = spheres::sphere(Vec3::new(0.0, -60.0, 0.0), 40.0, 0);
    let mut octree = build(root, &all);
    let levels = depth(&octree) as u64;
    assert!((4..=9).contains(&levels), "{levels}");
    let mut random = Random::new(6);
    let (mut most_nodes, mut most_spheres) = (0, 0);
    for revision in 2..1002 {
        let slot = 1 + random.below(9_999);
        let before = octree.work();
        octree.update(slot, random.point(50.0), 0.2, revision).unwrap();
        let work = difference(before, octree.work());
        most_nodes = most_nodes.max(work.nodes_touched);
        most_spheres = most_spheres.max(work.spheres_touched);
        assert!(work.blocks_allocated <= 2 && work.blocks_freed <= 2);
    }
    octree.validate().unwrap();
    // Down once or twice, up twice, eight children read per refitted level, one block split at most.
    assert!(most_nodes <= 40 * (levels + 1), "{most_nodes}");
    assert!(most_spheres <= 200, "{most_spheres}");
}

#[test]
fn a_material_change_touches_one_record() {
    let mut octree = build(UNIT, &spheres::cloud(5, 2000, 0.9, [0.01, 0.02]));
    octree.set_material(7, 42, 2).unwrap();
    assert_eq!(octree.spheres().as_slice()[7].material, 42);
    assert_eq!(octree.spheres().newer_than(1).len(), 1);
    assert!(octree.nodes().newer_than(1).is_empty());
    octree.validate().unwrap();
}

#[test]
fn an_equal_update_writes_nothing() {
    let mut octree = build(UNIT, &spheres::cloud(5, 200, 0.9, [0.01, 0.02]));
    let record = octree.spheres().as_slice()[9];
    octree.update(9, record.center.into(), record.radius, 2).unwrap();
    assert!(octree.spheres().newer_than(1).is_empty() && octree.nodes().newer_than(1).is_empty());
}

#[test]
fn removing_everything_frees_everything() {
    let all = spheres::cloud(9, 3000, 0.9, [0.001, 0.1]);
    let mut octree = build(UNIT, &all);
    let mut slots: Vec<u32> = (0..3000).collect();
    Random::new(9).shuffle(&mut slots);
    for slot in slots {
        octree.remove(slot, 2).unwrap();
    }
    octree.validate().unwrap();
    assert!(octree.is_empty() && octree.bounds().is_empty());
    assert_eq!(octree.work().blocks_freed, octree.work().blocks_allocated);
    assert_eq!(octree.nodes().as_slice()[0].first_child, NONE);
}

#[test]
fn ten_thousand_edits_equal_a_fresh_build() {
    let mut random = Random::new(10);
    let mut octree = SphereOctree::new(UNIT, DEFAULT);
    let mut model: BTreeMap<u32, SphereRecord> = BTreeMap::new();
    for edit in 0..10_000u64 {
        let slot = random.below(1500);
        let center = random.point(1.2);
        let radius = random.log_between(1e-3, 1.0);
        let present = model.contains_key(&slot);
        match (present, random.below(4)) {
            (false, _) => {
                let record = spheres::sphere(center, radius, slot);
                octree.insert(slot, record, edit).unwrap();
                model.insert(slot, record);
            }
            (true, 0) => {
                octree.remove(slot, edit).unwrap();
                model.remove(&slot);
            }
            (true, 1) => {
                octree.set_material(slot, edit as u32, edit).unwrap();
                model.entry(slot).and_modify(|s| s.material = edit as u32);
            }
            (true, _) => {
                octree.update(slot, center, radius, edit).unwrap();
                model.entry(slot).and_modify(|s| (s.center, s.radius) = (center.into(), radius));
            }
        }
        if edit % 500 == 499 {
            octree.validate().unwrap();
            assert_eq!(octree.bounds(), union(model.values()));
        }
    }
    let fresh: Vec<(u32, SphereRecord)> = model.iter().map(|(&slot, &record)| (slot, record)).collect();
    let fresh = SphereOctree::build(UNIT, DEFAULT, &fresh, 1).unwrap();
    assert_eq!((octree.bounds(), octree.len()), (fresh.bounds(), fresh.len()));
    let content = |o: &SphereOctree| -> Vec<SphereRecord> {
        let links_aside = |s: &SphereRecord| SphereRecord { next: 0, node: 0, ..*s };
        o.spheres().as_slice().iter().map(links_aside).filter(|s| s.radius > 0.0).collect()
    };
    assert_eq!(content(&octree), content(&fresh));
    assert!(octree.nodes().len() <= 3 * fresh.nodes().len(), "{}", octree.nodes().len());
}

#[derive(Clone, Debug)]
enum Edit {
    Insert(u32, [i8; 3], i32),
    Remove(u32),
    Update(u32, [i8; 3], i32),
}

fn edits() -> impl Strategy<Value = Vec<Edit>> {
    let radius = -12i32..3;
    let edit = prop_oneof![
        3 => (0u32..60, any::<[i8; 3]>(), radius.clone()).prop_map(|(s, c, r)| Edit::Insert(s, c, r)),
        1 => (0u32..60).prop_map(Edit::Remove),
        2 => (0u32..60, any::<[i8; 3]>(), radius).prop_map(|(s, c, r)| Edit::Update(s, c, r)),
    ];
    proptest::collection::vec(edit, 0..150)
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    #[test]
    fn any_edits_leave_a_valid_tree(edits in edits()) {
        let mut octree = SphereOctree::new(UNIT, DEFAULT);
        let center = |c: [i8; 3]| Vec3::from(c.map(f32::from)) / 64.0;
        for edit in edits {
            // Refused edits (slot taken, slot empty) are part of the game.
            let _refused = match edit {
                Edit::Insert(slot, c, r) => octree.insert(slot, spheres::sphere(center(c), (r as f32).exp2(), slot), 1),
                Edit::Remove(slot) => octree.remove(slot, 1),
                Edit::Update(slot, c, r) => octree.update(slot, center(c), (r as f32).exp2(), 1),
            };
            prop_assert_eq!(octree.validate(), Ok(()));
        }
        prop_assert_eq!(octree.bounds(), union(octree.spheres().as_slice().iter().filter(|s| s.radius > 0.0)));
    }
}

#[test]
fn the_options_hold_for_builds_and_edits() {
    let all = spheres::cloud(12, 2000, 0.9, [0.001, 0.01]);
    let mut sizes = Vec::new();
    for (max_depth, min_spheres) in [(0, 0), (1, 0), (3, 0), (3, 4), (5, 1), (20, 40)] {
        let options = OctreeOptions { max_depth, min_spheres };
        let built = SphereOctree::build(UNIT, options, &in_slots(&all), 1).unwrap();
        let mut edited = SphereOctree::new(UNIT, options);
        for (slot, record) in in_slots(&all) {
            edited.insert(slot, record, 1).unwrap();
        }
        for octree in [&built, &edited] {
            octree.validate().unwrap();
            assert_eq!(octree.options(), options);
            assert!(
                depth(octree) <= max_depth as usize && octree_depth(octree.nodes().as_slice()) <= max_depth
            );
        }
        sizes.push(built.nodes().len());
        for slot in 0..2000 {
            edited.update(slot, Vec3::from(all[slot as usize].center) * 0.5, 0.002, 2).unwrap();
        }
        edited.validate().unwrap();
    }
    assert_eq!(sizes[..3], [1, 9, 1 + 8 + 64 + 512]);
    assert!(sizes[3] <= sizes[2] && sizes[4] > sizes[3] && sizes[5] > 9, "{sizes:?}");
}

#[test]
fn depth_0_is_the_root_alone() {
    let options = OctreeOptions { max_depth: 0, min_spheres: 0 };
    let octree =
        SphereOctree::build(UNIT, options, &in_slots(&spheres::cloud(1, 99, 0.9, [0.01, 0.1])), 1).unwrap();
    octree.validate().unwrap();
    assert_eq!((octree.nodes().len(), octree_depth(octree.nodes().as_slice())), (1, 0));
}

#[test]
fn o09_the_path_of_descent_is_the_morton_index() {
    // The cube [1, 2]³, whose cells of level 20 are 2⁻²⁰ wide; centres use one bit more, all that a single has.
    let root = RootCell { center: Vec3::splat(1.5), half_extent: 0.5 };
    let mut random = Random::new(9);
    let at: Vec<[u32; 3]> = (0..1000).map(|_| [(); 3].map(|()| random.below(1 << 21))).collect();
    let center = |k: u32| 1.0 + k as f32 / (1u32 << 21) as f32;
    let all: Vec<_> =
        (0..).zip(&at).map(|(id, k)| spheres::sphere(Vec3::from(k.map(center)), 1e-9, id)).collect();
    let options = OctreeOptions { max_depth: 20, min_spheres: 0 };
    let octree = SphereOctree::build(root, options, &in_slots(&all), 1).unwrap();
    octree.validate().unwrap();
    let nodes = octree.nodes().as_slice();
    for (record, k) in octree.spheres().as_slice().iter().zip(&at) {
        let mut node = record.node;
        for level in (0..20).rev() {
            let parent = nodes[node as usize].parent;
            let bit = |axis: usize| (k[axis] >> (20 - level) & 1) << axis;
            assert_eq!(node - nodes[parent as usize].first_child, bit(0) | bit(1) | bit(2), "{k:?} {level}");
            node = parent;
        }
        assert_eq!(node, 0);
    }
}
