//! Every structure behind its one face: edits, refusals, what is published, and what is not touched.
#![allow(clippy::unwrap_used)]
use std::collections::BTreeMap;

use glam::Vec3;
use luxel_accel::{AccelError, RootCell, SphereOptions, SphereStructure};
use luxel_flat::{SPHERE_ACCELS, SphereAccel, SphereRecord};
use luxel_geom::{Aabb, sphere};
use luxel_testkit::spheres;
use proptest::prelude::*;

const UNIT: RootCell = RootCell { center: Vec3::ZERO, half_extent: 1.0 };

fn all_options() -> Vec<SphereOptions> {
    let options = |accel| SphereOptions { accel, max_depth: 4, min_spheres: 2 };
    SPHERE_ACCELS.iter().map(|row| options(row.accel)).collect()
}

fn build(options: SphereOptions, spheres: &[SphereRecord]) -> SphereStructure {
    let in_slots: Vec<_> = (0..).zip(spheres.iter().copied()).collect();
    let structure = SphereStructure::build(options, UNIT, &in_slots, 1).unwrap();
    structure.validate().unwrap();
    structure
}

fn union<'a>(spheres: impl IntoIterator<Item = &'a SphereRecord>) -> Aabb<f32> {
    let bounds = |s: &SphereRecord| sphere::bounds(s.center.into(), s.radius);
    spheres.into_iter().map(bounds).fold(Aabb::empty(), |a, b| a.union(&b))
}

/// The latest revision of any heap.
fn revision(s: &SphereStructure) -> u64 {
    let nodes = s.octree_nodes().revision().max(s.sphere_nodes().revision());
    nodes.max(s.leaf_spheres().revision()).max(s.spheres().revision())
}

#[test]
fn heaps_are_used_as_the_table_of_structures_says() {
    let all = spheres::cloud(1, 200, 0.9, [0.01, 0.1]);
    for row in SPHERE_ACCELS {
        let structure = build(SphereOptions { accel: row.accel, ..SphereOptions::default() }, &all);
        let used = [
            ("octree_nodes", structure.octree_nodes().len()),
            ("sphere_nodes", structure.sphere_nodes().len()),
            ("leaf_spheres", structure.leaf_spheres().len()),
        ];
        for (name, len) in used {
            assert_eq!(row.bindings.contains(&name), len > 0, "{} {name}", row.name);
        }
        assert_eq!(structure.spheres().len(), 200);
        let nodes = structure.octree_nodes().len() + structure.sphere_nodes().len();
        assert_eq!(structure.node_count() as usize, nodes.max(1), "{}", row.name);
        assert_eq!((structure.len(), structure.bounds()), (200, union(&all)));
        assert_eq!(structure.depth() > 0, row.accel != SphereAccel::Naive);
    }
}

#[test]
fn without_spheres_all_are_empty() {
    for options in all_options() {
        let mut structure = build(options, &[]);
        assert!(structure.is_empty() && structure.bounds().is_empty());
        structure.insert(3, spheres::sphere(Vec3::ZERO, 1.0, 9), 2).unwrap();
        structure.remove(3, 2).unwrap();
        structure.finish(2).unwrap();
        structure.validate().unwrap();
        assert!(structure.is_empty() && structure.bounds().is_empty());
    }
}

#[test]
fn s08_bad_edits_change_nothing() {
    for options in all_options() {
        let mut structure = build(options, &spheres::cloud(3, 50, 0.9, [0.01, 0.02]));
        let bad = |center: Vec3, radius| SphereRecord { center: center.into(), radius, ..Default::default() };
        for (center, radius) in [
            (Vec3::ZERO, 0.0),
            (Vec3::ZERO, -1.0),
            (Vec3::ZERO, 1e-45),
            (Vec3::ZERO, f32::NAN),
            (Vec3::ZERO, f32::INFINITY),
            (Vec3::NAN, 1.0),
            (Vec3::splat(1e31), 1.0),
        ] {
            assert_eq!(structure.insert(60, bad(center, radius), 2), Err(AccelError::BadSphere { slot: 60 }));
            assert_eq!(structure.update(3, center, radius, 2), Err(AccelError::BadSphere { slot: 3 }));
            let alone = SphereStructure::build(options, UNIT, &[(0, bad(center, radius))], 1);
            assert_eq!(alone.unwrap_err(), AccelError::BadSphere { slot: 0 });
        }
        assert_eq!(structure.insert(3, bad(Vec3::ZERO, 1.0), 2), Err(AccelError::SlotTaken { slot: 3 }));
        assert_eq!(structure.remove(50, 2), Err(AccelError::SlotEmpty { slot: 50 }));
        assert_eq!(structure.update(90, Vec3::ZERO, 1.0, 2), Err(AccelError::SlotEmpty { slot: 90 }));
        assert_eq!(structure.set_material(90, 1, 2), Err(AccelError::SlotEmpty { slot: 90 }));
        let twice = [(1, bad(Vec3::ZERO, 1.0)), (1, bad(Vec3::ZERO, 1.0))];
        let twice = SphereStructure::build(options, UNIT, &twice, 1);
        assert_eq!(twice.unwrap_err(), AccelError::SlotTaken { slot: 1 });
        structure.finish(2).unwrap();
        assert_eq!(revision(&structure), 1, "{options:?}");
    }
}

#[test]
fn what_changes_nothing_writes_nothing() {
    for options in all_options() {
        let all = spheres::cloud(5, 200, 0.9, [0.01, 0.02]);
        let mut structure = build(options, &all);
        let work = structure.work();
        structure.update(9, all[9].center.into(), all[9].radius, 2).unwrap();
        structure.set_material(9, all[9].material, 2).unwrap();
        structure.finish(2).unwrap();
        assert_eq!(
            (revision(&structure), structure.work().nodes_touched),
            (1, work.nodes_touched),
            "{options:?}"
        );
        structure.update(9, Vec3::ZERO, 0.5, 3).unwrap();
        structure.finish(3).unwrap();
        assert_eq!(revision(&structure), 3);
        structure.finish(4).unwrap();
        assert_eq!(revision(&structure), 3);
    }
}

#[test]
fn only_octrees_of_cells_are_built_anew_for_an_edit() {
    for options in all_options() {
        let all = spheres::cloud(5, 200, 0.9, [0.01, 0.02]);
        let mut structure = build(options, &all);
        assert_eq!(structure.work().rebuilds, 0);
        structure.remove(9, 2).unwrap();
        structure.insert(200, all[9], 2).unwrap();
        structure.update(8, Vec3::ZERO, 0.3, 2).unwrap();
        structure.finish(2).unwrap();
        structure.validate().unwrap();
        let is_of_cells = matches!(options.accel, SphereAccel::OctreeBase | SphereAccel::OctreeSeed);
        assert_eq!(structure.work().rebuilds, u64::from(is_of_cells), "{options:?}");
    }
}

#[test]
fn a_material_reaches_every_copy() {
    for options in all_options() {
        let mut structure = build(options, &spheres::cloud(5, 200, 0.9, [0.1, 0.2]));
        structure.set_material(7, 42, 2).unwrap();
        structure.finish(2).unwrap();
        structure.validate().unwrap();
        assert_eq!(structure.spheres().as_slice()[7].material, 42);
        let copies = structure.leaf_spheres().as_slice().iter().filter(|copy| copy.slot == 7);
        assert!(copies.map(|copy| copy.material).all(|material| material == 42));
    }
}

#[derive(Clone, Debug)]
enum Edit {
    Insert(u32, [i8; 3], i32),
    Remove(u32),
    Update(u32, [i8; 3], i32),
    Material(u32, u32),
    Finish,
}

fn edits() -> impl Strategy<Value = Vec<Edit>> {
    let radius = -8i32..2;
    let edit = prop_oneof![
        4 => (0u32..40, any::<[i8; 3]>(), radius.clone()).prop_map(|(s, c, r)| Edit::Insert(s, c, r)),
        1 => (0u32..40).prop_map(Edit::Remove),
        2 => (0u32..40, any::<[i8; 3]>(), radius).prop_map(|(s, c, r)| Edit::Update(s, c, r)),
        1 => (0u32..40, 0u32..9).prop_map(|(s, m)| Edit::Material(s, m)),
        1 => Just(Edit::Finish),
    ];
    proptest::collection::vec(edit, 0..80)
}

/// Does an edit to the structure and, unless it is refused, to the model.
fn apply(edit: &Edit, structure: &mut SphereStructure, model: &mut BTreeMap<u32, SphereRecord>) {
    let center = |c: [i8; 3]| Vec3::from(c.map(f32::from)) / 128.0;
    let is_done = match *edit {
        Edit::Insert(slot, c, r) => {
            structure.insert(slot, spheres::sphere(center(c), (r as f32).exp2(), slot), 1)
        }
        Edit::Remove(slot) => structure.remove(slot, 1),
        Edit::Update(slot, c, r) => structure.update(slot, center(c), (r as f32).exp2(), 1),
        Edit::Material(slot, material) => structure.set_material(slot, material, 1),
        Edit::Finish => structure.finish(1),
    }
    .is_ok();
    if !is_done {
        return;
    }
    match *edit {
        Edit::Insert(slot, c, r) => {
            _ = model.insert(slot, spheres::sphere(center(c), (r as f32).exp2(), slot));
        }
        Edit::Remove(slot) => _ = model.remove(&slot),
        Edit::Update(slot, c, r) => {
            let record = model.get_mut(&slot).unwrap();
            (record.center, record.radius) = (center(c).into(), (r as f32).exp2());
        }
        Edit::Material(slot, material) => model.get_mut(&slot).unwrap().material = material,
        Edit::Finish => {}
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(48))]

    #[test]
    fn any_edits_and_a_finish_leave_what_was_asked_for(edits in edits()) {
        for options in all_options() {
            let mut structure = build(options, &[]);
            let mut model = BTreeMap::new();
            edits.iter().for_each(|edit| apply(edit, &mut structure, &mut model));
            structure.finish(2).unwrap();
            prop_assert_eq!(structure.validate(), Ok(()));
            prop_assert_eq!(structure.len() as usize, model.len());
            prop_assert_eq!(structure.bounds(), union(model.values()));
            let held = (0u32..).zip(structure.spheres().as_slice()).filter(|(_, s)| s.radius > 0.0);
            let unlinked = |s: &SphereRecord| SphereRecord { next: 0, node: 0, ..*s };
            let held: BTreeMap<u32, SphereRecord> = held.map(|(slot, s)| (slot, unlinked(s))).collect();
            prop_assert_eq!(held, model.into_iter().map(|(slot, s)| (slot, unlinked(&s))).collect());
        }
    }
}
