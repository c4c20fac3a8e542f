//! What an edit may rebuild: asserted from the counters of the bake that followed it.
use glam::DVec3;
use luxel_bake::BakeCounters;
use luxel_flat::{FlatScene, Instance, SphereAccel};

use crate::studio::{Action, Edit, Kind};

/// Nodes of the loose octree that one sphere may touch: its way up to the root and down again, and blocks of children.
const MOST_NODES: u64 = 200;

/// The cost of an edit together with what follows from two snapshots: what differs must have been written, and
/// nothing else.
fn with_snapshots(cost: BakeCounters, before: &FlatScene, after: &FlatScene) -> BakeCounters {
    let old = |slot: usize| before.instances.as_slice().get(slot).copied().unwrap_or_default();
    let new = after.instances.as_slice().iter().enumerate();
    BakeCounters {
        instances_written: new.filter(|(slot, new)| is_live(new) && old(*slot) != **new).count() as u64,
        tlas_builds: u64::from(boxes(before) != boxes(after)),
        anchors_moved: u64::from(before.anchor != after.anchor),
        features_changed: u64::from(before.features != after.features),
        publishes: 1,
        ..cost
    }
}

fn is_live(instance: &Instance) -> bool {
    instance.node_count > 0
}

/// What the TLAS stands over: slots and boxes.
fn boxes(scene: &FlatScene) -> Vec<(usize, [f32; 3], [f32; 3])> {
    let live = scene.instances.as_slice().iter().enumerate().filter(|(_, instance)| is_live(instance));
    live.map(|(slot, instance)| (slot, instance.lo, instance.hi)).collect()
}

/// The cost of an edit together with what it does to the spheres' structure: an edit of that, unless the root cell is
/// another now.
fn with_spheres(edit: &Edit, root_changed: bool) -> BakeCounters {
    match (edit.kind, edit.action) {
        (Kind::Sphere, Action::Material) | (Kind::Mesh | Kind::Volume, _) => edit.cost,
        _ if root_changed => BakeCounters { sphere_rebuilds: 1, ..edit.cost },
        (_, Action::Add) => BakeCounters { sphere_inserts: 1, ..edit.cost },
        (_, Action::Remove) => BakeCounters { sphere_removes: 1, ..edit.cost },
        _ => BakeCounters { sphere_updates: 1, ..edit.cost },
    }
}

/// The sphere cloud's root cell, centre and half edge: a pure function of the spheres (`luxel_bake::lattice`). The
/// smallest power of two that the cloud fits in, on a lattice of that step.
pub(crate) fn root_cell(balls: impl Iterator<Item = (DVec3, f64)>) -> (DVec3, f64) {
    let all = balls.map(|(center, radius)| (center, center, radius));
    let all = all.reduce(|a, b| (a.0.min(b.0), a.1.max(b.1), a.2.max(b.2)));
    let Some((lo, hi, reach)) = all else { return (DVec3::ZERO, 1.0) };
    let size = (hi - lo).max_element() + 2.0 * reach;
    let step = size.log2().ceil().exp2();
    let center = lo + (hi - lo) * 0.5;
    ((center / step + 0.5).floor() * step, step)
}

/// Asserts that a bake did the work of its edit, and nothing else.
#[track_caller]
pub(crate) fn check(
    number: u32,
    edit: &Edit,
    work: &BakeCounters,
    before: &FlatScene,
    after: &FlatScene,
    root_changed: bool,
) {
    let context = format!("edit {number}, {:?} {:?}", edit.action, edit.kind);
    let worn_out = worn_out(work, after.sphere_accel);
    assert!(worn_out <= 1, "{context}: {work:?}");
    let work = &BakeCounters { sphere_rebuilds: work.sphere_rebuilds - worn_out, ..*work };
    let expected = with_snapshots(with_spheres(edit, root_changed), before, after);
    let expected = BakeCounters {
        sphere_nodes_touched: work.sphere_nodes_touched,
        light_tables: work.light_tables,
        ..expected
    };
    let expected = with_deformed(edit, work, expected);
    assert_eq!(*work, expected, "{context}");
    check_lights(&context, work, before, after);
    let edits_spheres = expected.sphere_inserts + expected.sphere_removes + expected.sphere_updates;
    // The other structures may be built anew by any edit of a sphere.
    let bounds_nodes = after.sphere_accel == SphereAccel::Octree && expected.sphere_rebuilds == 0;
    let most_per_edit = if bounds_nodes { MOST_NODES } else { u64::MAX };
    let most_nodes = (edits_spheres + expected.sphere_rebuilds).saturating_mul(most_per_edit);
    assert!(work.sphere_nodes_touched <= most_nodes, "{context}: {work:?}");
    check_promises(&context, edit, work);
}

/// The cost of an edit together with what a deformed mesh's tree costs: one refit, or one build in the place of the old.
fn with_deformed(edit: &Edit, work: &BakeCounters, expected: BakeCounters) -> BakeCounters {
    if edit.action != Action::Deform {
        return expected;
    }
    let built = work.blas_built.min(1);
    BakeCounters { blas_refitted: 1 - built, blas_built: built, blas_freed: built, ..expected }
}

/// A table of lights is made at most once, if it is another, and never where nothing shines.
fn check_lights(context: &str, work: &BakeCounters, before: &FlatScene, after: &FlatScene) {
    let differs = before.lights.as_slice() != after.lights.as_slice();
    let shines = !(before.lights.is_empty() && after.lights.is_empty());
    let allowed = u64::from(differs)..=u64::from(shines);
    assert!(allowed.contains(&work.light_tables), "{context}: {work:?}");
}

/// Rebuilds of a structure that an edit of one sphere wore out: the loose octree knows none, and naive has no structure.
fn worn_out(work: &BakeCounters, accel: SphereAccel) -> u64 {
    let edits = work.sphere_inserts + work.sphere_removes + work.sphere_updates;
    let can_wear_out = matches!(accel, SphereAccel::OctreeBase | SphereAccel::OctreeSeed | SphereAccel::Bvh);
    if can_wear_out && edits > 0 { work.sphere_rebuilds } else { 0 }
}

/// The promises of the issue in its own words; they must not depend on what the snapshots say.
fn check_promises(context: &str, edit: &Edit, work: &BakeCounters) {
    let structures = work.blas_built + work.blas_freed + work.svo_built + work.svo_freed;
    let spheres = work.sphere_inserts + work.sphere_removes + work.sphere_updates + work.sphere_rebuilds;
    let moves_origin = work.anchors_moved > 0;
    match (edit.kind, edit.action) {
        (_, Action::Material) => {
            assert_eq!(
                (work.tlas_builds, structures, spheres, work.transforms_propagated),
                (0, 0, 0, 0),
                "{context}"
            );
            let records = if edit.kind == Kind::Volume { 0..=8 } else { 1..=1 };
            assert!(records.contains(&work.materials_written), "{context}: {work:?}");
        }
        (Kind::Mesh | Kind::Volume, Action::Move | Action::Scale) => {
            assert_eq!(
                (work.tlas_builds, structures, spheres, work.materials_written),
                (1, 0, 0, 0),
                "{context}"
            );
            assert!(work.instances_written == 1 || moves_origin, "{context}: {work:?}");
        }
        (_, Action::Deform) => {
            assert_eq!(
                (work.blas_refitted + work.blas_built, spheres, work.materials_written),
                (1, 0, 0),
                "{context}"
            );
        }
        (Kind::Mesh | Kind::Volume, _) => assert_eq!((work.tlas_builds, spheres), (1, 0), "{context}"),
        (Kind::Sphere, _) => {
            assert_eq!((structures, spheres), (0, 1), "{context}");
            // The cloud's own record, when its box or its number of nodes is another.
            assert!(work.instances_written <= 1 || moves_origin, "{context}: {work:?}");
        }
    }
}
