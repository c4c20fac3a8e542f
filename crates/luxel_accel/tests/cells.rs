//! The octree of cells: the report's rules (seed 1, II.A and II.B), hard cases of robustness.md C2, and its bounds.
#![allow(clippy::unwrap_used)]
use glam::Vec3;
use luxel_accel::{CELL_BUDGET_BYTES, CellOctree, OctreeOptions};
use luxel_flat::{LeafSphere, NONE, OctreeNode, SphereRecord};
use luxel_testkit::{Random, spheres};

fn build(max_depth: u32, min_spheres: u32, spheres: &[SphereRecord]) -> CellOctree {
    let in_slots: Vec<_> = (0..).zip(spheres.iter().copied()).collect();
    let octree = CellOctree::build(OctreeOptions { max_depth, min_spheres }, &in_slots, 1).unwrap();
    octree.validate().unwrap();
    octree
}

/// The slots that a node lists.
fn listed(octree: &CellOctree, node: &OctreeNode) -> Vec<u32> {
    let first = if node.sphere_count == 0 { 0 } else { node.first_sphere as usize };
    octree.leaf_spheres().as_slice()[first..first + node.sphere_count as usize]
        .iter()
        .map(|s| s.slot)
        .collect()
}

fn levels(octree: &CellOctree) -> Vec<u32> {
    let mut levels: Vec<u32> = Vec::new();
    for node in octree.nodes().as_slice() {
        levels.push(if node.parent == NONE { 0 } else { levels[node.parent as usize] + 1 });
    }
    levels
}

#[test]
fn without_spheres_there_is_a_root_without_a_box() {
    let octree = build(20, 8, &[]);
    assert!(octree.is_empty() && octree.bounds().is_empty());
    assert_eq!((octree.nodes().len(), octree.leaf_spheres().len(), octree.depth()), (1, 0, 0));
}

#[test]
fn depth_0_is_the_root_alone() {
    let octree = build(0, 0, &spheres::cloud(1, 500, 1.0, [0.01, 0.1]));
    assert_eq!((octree.nodes().len(), octree.leaf_spheres().len()), (1, 500));
    assert!(!octree.is_cut_off());
}

#[test]
fn min_spheres_0_divides_what_is_not_empty_down_to_the_last_level() {
    let octree = build(4, 0, &spheres::cloud(2, 40, 1.0, [0.01, 0.1]));
    for (node, level) in octree.nodes().as_slice().iter().zip(levels(&octree)) {
        let is_divided = node.first_child != NONE;
        assert_eq!(is_divided, level < 4 && node.subtree_count > 0);
        assert!(level == 4 || node.sphere_count == 0);
    }
}

#[test]
fn min_spheres_is_how_many_a_cell_may_keep() {
    for min_spheres in [1, 2, 4, 16] {
        let octree = build(20, min_spheres, &spheres::cloud(3, 1000, 1.0, [0.001, 0.002]));
        assert!(
            octree.nodes().as_slice().iter().all(|node| node.sphere_count <= min_spheres),
            "{min_spheres}"
        );
        // Two spheres far apart under "2" stay together, under "1" they do not.
        let pair = [spheres::sphere(Vec3::ZERO, 1.0, 0), spheres::sphere(Vec3::splat(9.0), 1.0, 1)];
        assert_eq!(build(20, min_spheres, &pair).nodes().len() == 1, min_spheres > 1);
    }
}

#[test]
fn nodes_stand_breadth_first() {
    let octree = build(5, 1, &spheres::cloud(4, 300, 1.0, [0.01, 0.1]));
    let levels = levels(&octree);
    assert!(levels.is_sorted() && octree.depth() == 5);
    let offsets: Vec<u32> = octree.nodes().as_slice().iter().map(|node| node.first_child).collect();
    assert!(offsets.iter().filter(|first| **first != NONE).is_sorted());
}

#[test]
fn a_sphere_stands_in_every_leaf_that_a_point_of_it_lies_in() {
    let all = spheres::cloud(5, 300, 1.0, [0.01, 0.3]);
    let octree = build(5, 1, &all);
    let nodes = octree.nodes().as_slice();
    let mut random = Random::new(5);
    for (slot, record) in (0..).zip(&all) {
        for _ in 0..100 {
            let point = Vec3::from(record.center) + 0.999 * record.radius * random.direction();
            let inside = |node: &&OctreeNode| {
                node.first_child == NONE
                    && point.cmpge(Vec3::from(node.lo)).all()
                    && point.cmple(Vec3::from(node.hi)).all()
            };
            for leaf in nodes.iter().filter(inside) {
                assert!(listed(&octree, leaf).contains(&slot));
            }
        }
    }
}

#[test]
fn o01_o02_o04_hard_clouds_are_in_order() {
    for all in [spheres::small_and_large(1), spheres::inside_one(2), spheres::on_boundaries()] {
        for (max_depth, min_spheres) in [(6, 1), (4, 0), (20, 40)] {
            build(max_depth, min_spheres, &all);
        }
    }
}

#[test]
fn o03_the_budget_ends_what_division_cannot() {
    let identical: Vec<_> = (0..4000).map(|id| spheres::sphere(Vec3::ONE, 1.0, id)).collect();
    let octree = build(20, 8, &identical);
    assert!(octree.is_cut_off());
    assert!(
        octree.nodes().bytes() <= CELL_BUDGET_BYTES && octree.leaf_spheres().bytes() <= CELL_BUDGET_BYTES
    );
    assert!(octree.leaf_spheres().len() > 1_000_000);
}

#[test]
fn o03_specks_at_one_point_end_at_the_last_level() {
    // A second speck makes the cloud's box; the margin lists each in a few cells around it.
    let mut specks: Vec<_> = (0..20).map(|id| spheres::sphere(Vec3::splat(0.3), 1e-30, id)).collect();
    specks.push(spheres::sphere(Vec3::splat(-0.7), 1e-30, 20));
    let octree = build(12, 1, &specks);
    assert_eq!((octree.depth(), octree.is_cut_off()), (12, false));
}

#[test]
fn a_cell_without_room_is_not_divided() {
    // All numbers of the box are neighbours: level 20 would be 18 levels of nothing.
    let center = Vec3::splat(1.0);
    let specks: Vec<_> = (0..20).map(|id| spheres::sphere(center, f32::MIN_POSITIVE, id)).collect();
    let octree = build(20, 1, &specks);
    assert!(octree.depth() < 6 && !octree.is_cut_off(), "{}", octree.depth());
}

/// (a + b) / 2 rounded to single precision, halves to even, of numbers given as multiples of 2⁻⁴⁰: integers alone.
fn middle(a: i64, b: i64) -> i64 {
    let (sum, sign) = ((a + b).abs(), (a + b).signum());
    // `sum` counts 2⁻⁴¹; it has `bits` binary digits, of which 24 remain.
    let bits = 64 - sum.leading_zeros();
    let dropped = bits.saturating_sub(24);
    let (kept, rest) = (sum >> dropped, sum & ((1 << dropped) - 1));
    let half = if dropped > 0 { 1i64 << (dropped - 1) } else { 1 };
    let up = rest > half || (rest == half && kept & 1 == 1);
    sign * (((kept + i64::from(up)) << dropped) / 2)
}

fn units(x: f32) -> i64 {
    (f64::from(x) * (1u64 << 40) as f64) as i64
}

#[test]
fn o09_the_integer_path_of_a_centre_ends_in_a_leaf_that_lists_it() {
    let mut random = Random::new(9);
    let ulp = 1.0 / (1u32 << 21) as f32;
    let fine: Vec<_> = (0..20)
        .map(|id| {
            let center = Vec3::from([(); 3].map(|()| 1.0 + random.below(1 << 21) as f32 * ulp));
            spheres::sphere(center, 0.25 * ulp, id)
        })
        .collect();
    let octree = build(20, 0, &fine);
    assert_eq!(octree.depth(), 20);
    let nodes = octree.nodes().as_slice();
    for (slot, record) in (0..).zip(&fine) {
        let center = record.center.map(units);
        let (mut lo, mut hi) = (nodes[0].lo.map(units), nodes[0].hi.map(units));
        let mut node = &nodes[0];
        while node.first_child != NONE {
            let mut octant = 0;
            for axis in 0..3 {
                let middle = middle(lo[axis], hi[axis]);
                let is_upper = center[axis] >= middle;
                octant |= u32::from(is_upper) << axis;
                if is_upper { lo[axis] = middle } else { hi[axis] = middle }
            }
            node = &nodes[(node.first_child + octant) as usize];
            assert_eq!((node.lo.map(units), node.hi.map(units)), (lo, hi));
        }
        assert!(listed(&octree, node).contains(&slot));
    }
}

#[test]
fn the_build_does_not_depend_on_threads() {
    let all: Vec<_> = (0..).zip(spheres::cloud(6, 20_000, 1.0, [0.001, 0.05])).collect();
    let build = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        let options = OctreeOptions { max_depth: 6, min_spheres: 1 };
        let octree = pool.install(|| CellOctree::build(options, &all, 1).unwrap());
        (octree.nodes().as_slice().to_vec(), octree.leaf_spheres().as_slice().to_vec())
    };
    let one: (Vec<OctreeNode>, Vec<LeafSphere>) = build(1);
    assert!(one == build(4));
}
