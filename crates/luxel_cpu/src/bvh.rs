//! Walks through a binary tree of boxes: the nearer child first, or in depth-first order by skip pointers.
//!
//! The nearer child first: both children of a node are tested at once. The farther one waits on a short stack with its entry and is passed
//! over if a hit was found before it. The stack is a small array, so that it costs next to nothing to have; should
//! it be full, the farther subtree is walked at once by its skip pointers, which needs no stack: no depth can
//! overflow, and only time depends on the order. A damaged tree neither panics nor loops forever: in a sound one every
//! node has one parent and its box is tested at most once, so a walk that would test more boxes than there are nodes
//! runs in a circle, and ends.
use luxel_flat::{BvhNode, LEAF_COUNT_SHIFT};
use luxel_geom::{PairHit, PairRay, Real, SlabRay};

use crate::traverse::node_box;

/// Subtrees that can wait.
const STACK_SIZE: usize = 32;

/// What a walk did.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Walk {
    /// Nodes whose box was tested, the root with them.
    pub node_count: u64,
    /// False if the tree is damaged.
    pub is_sound: bool,
}

/// What is done at the leaves that a ray enters.
///
/// A trait and no closure: what stands at several places of a walk is inlined at the hot one by attribute only.
pub trait Leaves<R: Real> {
    /// Looks through a leaf's primitives. Returns up to where the ray is still searched: its `t_max` or the best hit's
    /// parameter; less than its `t_min` ends the walk.
    fn visit(&mut self, first: u32, count: u32) -> R;
}

impl<R: Real, F: FnMut(u32, u32) -> R> Leaves<R> for F {
    #[inline(always)]
    fn visit(&mut self, first: u32, count: u32) -> R {
        self(first, count)
    }
}

/// True if a ray enters the root's box.
#[inline(always)]
pub fn enters_root<R: Real>(nodes: &[BvhNode], ray: &SlabRay<R>) -> bool {
    nodes.first().is_some_and(|root| is_entered(root, ray))
}

/// Visits the leaves that a ray enters, the nearer first. The ray enters the root's box.
#[inline(always)]
pub fn walk<R: Real>(nodes: &[BvhNode], ray: &SlabRay<R>, leaves: impl Leaves<R>) -> Walk {
    walk_near_first::<R, false, STACK_SIZE>(nodes, ray, leaves)
}

/// Visits the leaves that a ray for any hit enters: the nearer first, and of two boxes around its start the second, where
/// builders put what is likelier to end it. The ray enters the root's box.
#[inline(always)]
pub fn walk_for_any<R: Real>(nodes: &[BvhNode], ray: &SlabRay<R>, leaves: impl Leaves<R>) -> Walk {
    walk_near_first::<R, true, STACK_SIZE>(nodes, ray, leaves)
}

/// Visits the leaves that a ray enters in depth-first order, by skip pointers (escape indices) alone: without a stack, but
/// blind to which child is nearer (seed 2, 2.6.3). The ray enters the root's box.
#[inline(always)]
pub fn walk_by_skips<R: Real>(nodes: &[BvhNode], ray: &SlabRay<R>, mut leaves: impl Leaves<R>) -> Walk {
    if nodes.is_empty() {
        return Walk::ROOT_MISSED;
    }
    follow_skips(nodes, *ray, Walk { node_count: 1, is_sound: true }, &mut leaves, 0).1
}

impl Walk {
    /// Of a ray that does not enter the root's box.
    pub const ROOT_MISSED: Self = Self { node_count: 1, is_sound: true };

    /// As if all primitives were in one leaf and its box everywhere: exhaustive search.
    #[inline(always)]
    pub fn over_one_leaf<R: Real>(count: u32, mut leaves: impl Leaves<R>) -> Self {
        leaves.visit(0, count);
        Self { node_count: 0, is_sound: true }
    }
}

/// A walk for any hit or for the closest.
///
/// In one piece, and what changes on the way in variables, not in a record: the stack, which is indexed, and what is lent
/// to [`aside`] stand in memory, and a record with one of them in it would stand there as a whole.
#[inline(always)]
fn walk_near_first<R: Real, const ANY: bool, const SIZE: usize>(
    nodes: &[BvhNode],
    ray: &SlabRay<R>,
    mut leaves: impl Leaves<R>,
) -> Walk {
    let Some(root) = nodes.first() else { return Walk::ROOT_MISSED };
    let pair_ray = PairRay::new(ray);
    let (mut t_max, mut walk) = (ray.t_max, Walk { node_count: 1, is_sound: true });
    // `BvhNode::leaf` of each node that waits, and where the ray enters it.
    let (mut stack, mut waiting) = ([(0, R::ZERO); SIZE], 0);
    let mut content = root.leaf;
    loop {
        if content >> LEAF_COUNT_SHIFT == 0 {
            let Some([a, b]) = children(nodes, content, walk.node_count) else {
                return Walk { is_sound: false, ..walk };
            };
            walk.node_count += 2;
            let PairHit { enter, hits } = test(&pair_ray, a, b, t_max);
            // Branches, no selection: a branch that was foreseen lets the next node be read before this one is tested.
            if hits == 0b11 {
                let second_first = if ANY { enter[1] <= enter[0] } else { enter[1] < enter[0] };
                let (far, later);
                if second_first {
                    (content, far, later) = (b.leaf, content, (a.leaf, enter[0]));
                } else {
                    (content, far, later) = (a.leaf, content + 1, (b.leaf, enter[1]));
                }
                if let Some(place) = stack.get_mut(waiting) {
                    *place = later;
                    waiting += 1;
                } else {
                    let ray = SlabRay { t_max, ..*ray };
                    (t_max, walk) = aside(nodes, ray, walk, &mut leaves, far as usize);
                    if !walk.is_sound || t_max < ray.t_min {
                        return walk;
                    }
                }
                continue;
            }
            if hits & 0b01 != 0 {
                content = a.leaf;
                continue;
            }
            if hits != 0 {
                content = b.leaf;
                continue;
            }
        } else {
            let (first, count) = BvhNode { leaf: content, ..BvhNode::default() }.primitives();
            t_max = leaves.visit(first, count);
            if t_max < ray.t_min {
                return walk;
            }
        }
        let Some(next) = pop(&stack, &mut waiting, t_max) else { return walk };
        content = next;
    }
}

/// The children of an inner node; none in a damaged tree, where a node is not there or more boxes than all were tested.
#[inline(always)]
fn children(nodes: &[BvhNode], first: u32, node_count: u64) -> Option<&[BvhNode; 2]> {
    let first = first as usize;
    let pair = nodes.get(first..first + 2).filter(|_| node_count < nodes.len() as u64);
    pair?.as_array()
}

/// Tests the boxes of two nodes.
#[inline(always)]
fn test<R: Real>(pair_ray: &PairRay<R>, a: &BvhNode, b: &BvhNode, t_max: R) -> PairHit<R> {
    let ([a_lo, a_hi], [b_lo, b_hi]) = (rows(a), rows(b));
    pair_ray.test([a_lo, b_lo], [a_hi, b_hi], t_max)
}

/// The waiting node that was pushed last, of those that the ray enters before the best hit.
#[inline(always)]
fn pop<R: Real>(stack: &[(u32, R)], waiting: &mut usize, t_max: R) -> Option<u32> {
    while *waiting > 0 {
        *waiting -= 1;
        let (content, enter) = stack[*waiting];
        if enter <= t_max {
            return Some(content);
        }
    }
    None
}

/// [`follow_skips`] out of the way of what happens more often. What a walk needs is passed by value, so that it need not
/// stand in memory meanwhile.
#[cold]
#[inline(never)]
fn aside<R: Real>(
    nodes: &[BvhNode],
    ray: SlabRay<R>,
    walk: Walk,
    leaves: &mut impl Leaves<R>,
    root: usize,
) -> (R, Walk) {
    follow_skips(nodes, ray, walk, leaves, root)
}

/// Walks the subtree of a node whose box was tested, without a stack. Returns up to where the ray is still searched.
#[inline(always)]
fn follow_skips<R: Real>(
    nodes: &[BvhNode],
    mut ray: SlabRay<R>,
    mut walk: Walk,
    leaves: &mut impl Leaves<R>,
    root: usize,
) -> (R, Walk) {
    let BvhNode { leaf, skip: end, .. } = nodes[root];
    if nodes[root].is_leaf() {
        let (first, count) = nodes[root].primitives();
        return (leaves.visit(first, count), walk);
    }
    let mut index = leaf;
    while index != end && ray.t_max >= ray.t_min {
        let may_go_on = walk.node_count < nodes.len() as u64;
        let Some(node) = nodes.get(index as usize).filter(|_| may_go_on) else {
            walk.is_sound = false;
            break;
        };
        walk.node_count += 1;
        index = node.skip;
        if is_entered(node, &ray) {
            if node.is_leaf() {
                let (first, count) = node.primitives();
                ray.t_max = leaves.visit(first, count);
            } else {
                index = node.first_child();
            }
        }
    }
    (ray.t_max, walk)
}

#[inline(always)]
fn is_entered<R: Real>(node: &BvhNode, ray: &SlabRay<R>) -> bool {
    node_box(node).interval(ray).overlaps(ray.t_min, ray.t_max)
}

/// The corners of a node's box, each with the link behind it: as a node is read.
#[inline(always)]
fn rows(node: &BvhNode) -> [[f32; 4]; 2] {
    let BvhNode { lo, skip, hi, leaf } = *node;
    [[lo[0], lo[1], lo[2], f32::from_bits(skip)], [hi[0], hi[1], hi[2], f32::from_bits(leaf)]]
}

#[cfg(test)]
mod tests {
    use luxel_accel::{BvhOptions, build_bvh};
    use luxel_geom::{Aabb, Ray};
    use luxel_testkit::{meshes, rays};

    use super::*;

    /// The leaf entries that a walk visits, in order of their numbers.
    fn visited<const SIZE: usize>(nodes: &[BvhNode], ray: &Ray<f32>) -> (Vec<u32>, Walk) {
        let mut entries = Vec::new();
        let slab_ray = SlabRay::new(ray);
        let visit_leaf = |first, count| {
            entries.extend(first..first + count);
            slab_ray.t_max
        };
        let walk = match enters_root(nodes, &slab_ray) {
            true => walk_near_first::<f32, false, SIZE>(nodes, &slab_ray, visit_leaf),
            false => Walk::ROOT_MISSED,
        };
        entries.sort_unstable();
        (entries, walk)
    }

    fn tree() -> Vec<BvhNode> {
        let boxes: Vec<Aabb<f32>> = meshes::soup(1, 1000, 0.3).boxes();
        build_bvh(&boxes, &BvhOptions::default()).map(|bvh| bvh.nodes).unwrap_or_default()
    }

    #[test]
    fn a_full_stack_loses_nothing() {
        let nodes = tree();
        let mut entries = 0;
        for ray in rays::random(1, 2000, 2.0) {
            let (roomy, walk) = visited::<64>(&nodes, &ray);
            assert!(walk.is_sound);
            assert_eq!(visited::<0>(&nodes, &ray).0, roomy);
            assert_eq!(visited::<2>(&nodes, &ray).0, roomy);
            entries += roomy.len();
        }
        assert!(entries > 10_000, "{entries}");
    }

    #[test]
    fn around_its_start_a_ray_enters_the_first_box_first_and_for_any_hit_the_second() {
        let leaf = |r: f32, first| BvhNode {
            lo: [-r; 3],
            hi: [r; 3],
            skip: first + 2,
            leaf: BvhNode::pack_leaf(first, 1),
        };
        let root = BvhNode { skip: 3, leaf: 1, ..leaf(2.0, 0) };
        let nodes = [root, leaf(1.0, 0), leaf(2.0, 1)];
        let order = |x: f32, is_any: bool| {
            let ray = SlabRay::<f32>::new(&Ray::new(glam::Vec3::new(x, 0.1, 0.2), glam::Vec3::X));
            let mut visited = Vec::new();
            let visit = |first: u32, _: u32| {
                visited.push(first);
                ray.t_max
            };
            match is_any {
                true => walk_for_any(&nodes, &ray, visit),
                false => walk(&nodes, &ray, visit),
            };
            visited
        };
        assert_eq!((order(0.0, false), order(0.0, true)), (vec![0, 1], vec![1, 0]));
        // Elsewhere the nearer comes first.
        assert_eq!((order(-1.5, false), order(-1.5, true)), (vec![1, 0], vec![1, 0]));
    }

    #[test]
    fn damaged_nodes_end_the_walk() {
        let nodes = tree();
        for (damage, content) in [(0, 0), (1, 0), (5, 1), (0, 1 << 27), (2, nodes.len() as u32 - 1)] {
            let mut damaged = nodes.clone();
            damaged[damage] = BvhNode { leaf: content, skip: damage as u32, ..damaged[damage] };
            for ray in rays::random(2, 200, 2.0) {
                visited::<1>(&damaged, &ray);
                visited::<64>(&damaged, &ray);
            }
        }
        let mut circle = nodes.clone();
        circle[0].leaf = 0;
        assert!(rays::random(3, 50, 1.0).iter().any(|ray| !visited::<64>(&circle, ray).1.is_sound));
    }
}
