//! The sphere BVH after edits, and what an edit touches.
#![allow(clippy::unwrap_used)]
use luxel_accel::{AccelError, SphereBvh, build_bvh};
use luxel_flat::SphereRecord;
use luxel_geom::{Aabb, sphere};
use luxel_testkit::{Random, spheres};

fn in_slots(records: &[SphereRecord]) -> Vec<(u32, SphereRecord)> {
    (0..).zip(records.iter().copied()).collect()
}

fn bvh_of(count: u32) -> SphereBvh {
    let bvh = SphereBvh::build(&in_slots(&spheres::cloud(1, count, 1.0, [0.01, 0.05])), 1).unwrap();
    bvh.validate().unwrap();
    bvh
}

#[test]
fn any_edits_leave_a_valid_tree() {
    let mut random = Random::new(3);
    let mut bvh = bvh_of(200);
    for revision in 2..200 {
        for _ in 0..random.below(30) {
            let slot = random.below(260);
            let new = spheres::sphere(random.point(1.0), random.between(0.01, 0.2), slot);
            match random.below(8) {
                0 => drop(bvh.insert(slot, new, revision)),
                1 if random.below(4) == 0 => drop(bvh.remove(slot, revision)),
                2 => drop(bvh.set_material(slot, random.below(5), revision)),
                _ => drop(bvh.update(slot, new.center.into(), new.radius, revision)),
            }
        }
        bvh.finish(revision).unwrap();
        bvh.validate().unwrap();
        let union = (bvh.spheres().as_slice().iter().filter(|s| s.radius > 0.0))
            .fold(Aabb::empty(), |b, s| b.union(&sphere::bounds(s.center.into(), s.radius)));
        assert_eq!(bvh.bounds(), union);
    }
}

#[test]
fn few_moves_touch_few_nodes() {
    let mut bvh = bvh_of(20_000);
    let nodes_before = bvh.work().nodes_touched;
    for slot in 0..10 {
        let center = bvh.spheres().as_slice()[slot as usize].center;
        bvh.update(slot, glam::Vec3::from(center) + 0.01, 0.02, 2).unwrap();
    }
    assert!(matches!(bvh.validate(), Err(AccelError::Broken { .. })), "edits must be finished");
    bvh.finish(2).unwrap();
    bvh.validate().unwrap();
    assert!(bvh.work().nodes_touched - nodes_before < 10 * 40);
    assert!(bvh.nodes().newer_than(1).iter().map(|pages| pages.len()).sum::<usize>() < bvh.nodes().len());
    bvh.finish(3).unwrap();
    assert!(bvh.nodes().newer_than(2).is_empty(), "nothing to do");
}

#[test]
fn many_moves_keep_the_shape() {
    let mut bvh = bvh_of(2000);
    let shape: Vec<u32> = bvh.nodes().as_slice().iter().map(|n| n.leaf).collect();
    let mut random = Random::new(9);
    for slot in 0..2000 {
        bvh.update(slot, random.point(1.0), 0.01, 2).unwrap();
    }
    bvh.finish(2).unwrap();
    bvh.validate().unwrap();
    assert!(bvh.nodes().as_slice().iter().map(|n| n.leaf).eq(shape));
}

#[test]
fn edits_of_what_is_not_there_are_refused() {
    let mut bvh = bvh_of(3);
    let one = spheres::sphere(glam::Vec3::ZERO, 1.0, 0);
    assert_eq!(bvh.insert(1, one, 2), Err(AccelError::SlotTaken { slot: 1 }));
    assert_eq!(bvh.remove(3, 2), Err(AccelError::SlotEmpty { slot: 3 }));
    assert_eq!(bvh.update(9, glam::Vec3::ZERO, 1.0, 2), Err(AccelError::SlotEmpty { slot: 9 }));
    assert_eq!(bvh.update(0, glam::Vec3::NAN, 1.0, 2), Err(AccelError::BadSphere { slot: 0 }));
    (0..3).for_each(|slot| bvh.remove(slot, 2).unwrap());
    bvh.finish(2).unwrap();
    bvh.validate().unwrap();
    assert!(bvh.is_empty() && bvh.nodes().is_empty() && bvh.bounds().is_empty());
    assert_eq!(build_bvh(&[], &Default::default()).unwrap().nodes, []);
}
