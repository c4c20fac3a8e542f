//! The sphere BVH after edits, and what an edit touches.
#![allow(clippy::unwrap_used)]
use glam::Vec3;
use luxel_accel::{AccelError, MAX_BVH_DEPTH, SphereBvh, StructureWork, build_bvh};
use luxel_flat::{BvhNode, SphereRecord};
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

/// What a ray that meets the root's box is expected to cost, in sphere tests, a step being six.
fn expected_cost(bvh: &SphereBvh) -> f64 {
    let nodes = bvh.nodes().as_slice();
    let area = |node: &BvhNode| {
        let [x, y, z] = [0, 1, 2].map(|k| f64::from(node.hi[k] - node.lo[k]));
        x * y + y * z + z * x
    };
    let (mut cost, mut waiting) = (0.0, vec![0]);
    while let Some(index) = waiting.pop() {
        let node = &nodes[index as usize];
        let (_, count) = node.primitives();
        cost += area(node) * if count == 0 { 6.0 } else { f64::from(count) };
        if count == 0 {
            waiting.extend([node.first_child(), node.first_child() + 1]);
        }
    }
    cost / area(&nodes[0])
}

fn fresh(bvh: &SphereBvh) -> SphereBvh {
    let all = in_slots(bvh.spheres().as_slice());
    SphereBvh::build(&all.into_iter().filter(|(_, s)| s.radius > 0.0).collect::<Vec<_>>(), 1).unwrap()
}

fn work_of(bvh: &mut SphereBvh, edit: impl FnOnce(&mut SphereBvh)) -> StructureWork {
    let before = bvh.work();
    edit(bvh);
    bvh.finish(9).unwrap();
    let after = bvh.work();
    StructureWork {
        nodes_touched: after.nodes_touched - before.nodes_touched,
        spheres_touched: after.spheres_touched - before.spheres_touched,
        rebuilds: after.rebuilds - before.rebuilds,
        ..after
    }
}

#[test]
fn ten_thousand_edits_leave_a_valid_and_good_tree() {
    let (mut worst, mut rebuilds) = (0.0f64, 0);
    for (seed, count, radii) in [(1, 2000, [0.01, 0.05]), (2, 300, [1e-3, 1.0]), (3, 0, [0.01, 0.05])] {
        let mut random = Random::new(seed);
        let mut bvh = SphereBvh::build(&in_slots(&spheres::cloud(seed, count, 1.0, radii)), 1).unwrap();
        for edit in 1..=10_000 {
            let slot = random.below(count.max(500) * 5 / 4);
            let new = spheres::sphere(random.point(1.0), random.log_between(radii[0], radii[1]), slot);
            match (random.below(2), bvh.insert(slot, new, edit).is_err()) {
                (0, true) => bvh.remove(slot, edit).unwrap(),
                (_, true) => bvh.update(slot, new.center.into(), new.radius, edit).unwrap(),
                _ => {}
            }
            if edit % 10 == 0 {
                bvh.finish(edit).unwrap();
            }
            if edit % 100 == 0 {
                bvh.validate().unwrap();
                worst = worst.max(expected_cost(&bvh) / expected_cost(&fresh(&bvh)));
            }
        }
        rebuilds += bvh.work().rebuilds;
    }
    assert!(worst < 1.5, "{worst} times the cost of a fresh tree");
    assert!(rebuilds < 200, "{rebuilds} of 30,000 edits");
}

#[test]
fn a_sphere_comes_and_goes_along_one_path() {
    let mut bvh = bvh_of(100_000);
    let mut random = Random::new(4);
    let (mut most_nodes, mut most_spheres) = (0, 0);
    let depth = u64::from(bvh.depth());
    for slot in 100_000..102_000 {
        let new = spheres::sphere(random.point(1.2), random.log_between(1e-3, 0.5), slot);
        let gone = random.below(100_000);
        let inserted = work_of(&mut bvh, |bvh| bvh.insert(slot, new, 9).unwrap());
        let removed = work_of(&mut bvh, |bvh| drop(bvh.remove(gone, 9)));
        assert_eq!(inserted.rebuilds + removed.rebuilds, 0);
        most_nodes = most_nodes.max(inserted.nodes_touched).max(removed.nodes_touched);
        most_spheres = most_spheres.max(inserted.spheres_touched).max(removed.spheres_touched);
    }
    bvh.validate().unwrap();
    assert!(most_nodes <= 5 * depth && most_spheres <= 9, "{depth}: {most_nodes} {most_spheres}");
}

#[test]
fn an_edit_writes_few_pages() {
    let mut bvh = bvh_of(100_000);
    bvh.insert(100_000, spheres::sphere(Vec3::ZERO, 0.01, 1), 2).unwrap();
    bvh.finish(2).unwrap();
    // The heap has grown by a page, and along the right side of the tree it says so. Not so the next time.
    for (slot, revision) in (100_001..).zip(3..20) {
        bvh.insert(slot, spheres::sphere(Vec3::splat(slot as f32 * 1e-6), 0.01, slot), revision).unwrap();
        bvh.remove(slot - 90_000, revision).unwrap();
        bvh.finish(revision).unwrap();
        let newer = bvh.nodes().newer_than(revision - 1);
        let written: usize = newer.iter().map(|pages| pages.len()).sum();
        assert!(written < bvh.nodes().len() / 2, "{written} of {}", bvh.nodes().len());
        let written: usize =
            bvh.leaf_spheres().newer_than(revision - 1).iter().map(|pages| pages.len()).sum();
        assert!(written <= 5 * 512, "{written}");
    }
    assert_eq!(bvh.work().rebuilds, 0);
}

#[test]
fn the_depth_bound_holds_whatever_comes() {
    let mut bvh = bvh_of(1000);
    let mut deepest = 0;
    // Each sphere is larger and farther out than all before it: every few get a leaf beside the root.
    for (slot, k) in (1000..).zip(0..900) {
        let size = 1.07f32.powi(k);
        bvh.insert(slot, spheres::sphere(10.0 * Vec3::X * size, size, slot), 2).unwrap();
        deepest = deepest.max(bvh.depth());
    }
    assert_eq!((deepest, bvh.work().rebuilds), (MAX_BVH_DEPTH, 0));
    bvh.finish(2).unwrap();
    bvh.validate().unwrap();
    assert!(bvh.depth() < MAX_BVH_DEPTH && bvh.work().rebuilds == 1);
}

#[test]
fn what_is_unused_is_bounded() {
    let mut bvh = bvh_of(20_000);
    let mut random = Random::new(6);
    for slot in 0..19_900 {
        bvh.remove((slot * 7919) % 20_000, 2).unwrap();
        if random.below(4) == 0 {
            bvh.insert(20_000 + slot, spheres::sphere(random.point(1.0), 0.01, slot), 2).unwrap();
        }
        bvh.finish(2).unwrap();
        let (nodes, entries) = (bvh.nodes().len(), bvh.leaf_spheres().len());
        assert!(entries <= 2 * bvh.len() as usize + 600, "{entries} of {}", bvh.len());
        assert!(nodes <= 2 * bvh.len() as usize + 1200, "{nodes} of {}", bvh.len());
    }
    bvh.validate().unwrap();
    assert!((3..30).contains(&bvh.work().rebuilds), "{}", bvh.work().rebuilds);
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
