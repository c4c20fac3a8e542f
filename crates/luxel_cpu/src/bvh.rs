//! A walk through a binary tree of boxes, the nearer child first.
//!
//! Both children of a node are tested at once. The farther one waits on a short stack with its entry and is passed
//! over if a hit was found before it. The stack is a small array, so that it costs next to nothing to have; should
//! it be full, the farther subtree is walked at once by its skip pointers, which needs no stack: no depth can
//! overflow, and only time depends on the order. A damaged tree neither panics nor loops forever: in a sound one every
//! node has one parent and its box is tested at most once, so a walk that would test more boxes than there are nodes
//! runs in a circle, and ends.
use luxel_flat::{BvhNode, LEAF_COUNT_SHIFT};
use luxel_geom::{PairRay, Real, SlabRay};

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

/// Visits the leaves that a ray enters. `visit_leaf` gets a leaf's primitives (first and count) and returns up to
/// where the ray is still searched: its `t_max` or the best hit's parameter.
#[inline(always)]
pub fn walk<R: Real>(nodes: &[BvhNode], ray: &SlabRay<R>, visit_leaf: impl FnMut(u32, u32) -> R) -> Walk {
    Walker::<R, _, STACK_SIZE>::new(nodes, ray, visit_leaf).run()
}

/// The state of a walk.
struct Walker<'a, R: Real, F, const SIZE: usize> {
    nodes: &'a [BvhNode],
    ray: SlabRay<R>,
    visit_leaf: F,
    walk: Walk,
    /// `BvhNode::leaf` of a node, and where the ray enters it.
    stack: [(u32, R); SIZE],
    waiting: usize,
}

impl<'a, R: Real, F: FnMut(u32, u32) -> R, const SIZE: usize> Walker<'a, R, F, SIZE> {
    #[inline(always)]
    fn new(nodes: &'a [BvhNode], ray: &SlabRay<R>, visit_leaf: F) -> Self {
        let walk = Walk { node_count: 0, is_sound: true };
        Self { nodes, ray: *ray, visit_leaf, walk, stack: [(0, R::ZERO); SIZE], waiting: 0 }
    }

    #[inline(always)]
    fn run(mut self) -> Walk {
        let pair_ray = PairRay::new(&self.ray);
        let mut next = self.enter_root();
        while let Some(content) = next {
            next = if content >> LEAF_COUNT_SHIFT == 0 {
                self.enter(&pair_ray, content)
            } else {
                self.visit(content);
                None
            };
            next = next.or_else(|| self.pop());
        }
        self.walk
    }

    /// Tests the root: `BvhNode::leaf` of it, if the ray enters it.
    #[inline(always)]
    fn enter_root(&mut self) -> Option<u32> {
        let root = self.nodes.first()?;
        self.walk.node_count += 1;
        self.is_entered(root).then_some(root.leaf)
    }

    #[inline(always)]
    fn is_entered(&self, node: &BvhNode) -> bool {
        node_box(node).interval(&self.ray).overlaps(self.ray.t_min, self.ray.t_max)
    }

    /// True if more boxes may be tested; else the tree is damaged.
    #[inline(always)]
    fn may_go_on(&self) -> bool {
        self.walk.node_count < self.nodes.len() as u64
    }

    /// Ends the walk of a damaged tree.
    #[cold]
    fn give_up(&mut self) {
        self.walk.is_sound = false;
        self.waiting = 0;
    }

    /// Tests the children of an inner node: the one to go on with, if any.
    #[inline(always)]
    fn enter(&mut self, pair_ray: &PairRay<R>, first_child: u32) -> Option<u32> {
        let first = first_child as usize;
        let pair = self.nodes.get(first..first + 2);
        let Some([a, b]) = pair.filter(|_| self.may_go_on()) else {
            self.give_up();
            return None;
        };
        self.walk.node_count += 2;
        let hit = pair_ray.test([a.lo, b.lo], [a.hi, b.hi], self.ray.t_max);
        match hit.is_hit {
            [true, true] if hit.enter[1] < hit.enter[0] => {
                self.push(first, hit.enter[0]);
                Some(b.leaf)
            }
            [true, true] => {
                self.push(first + 1, hit.enter[1]);
                Some(a.leaf)
            }
            [true, false] => Some(a.leaf),
            [false, true] => Some(b.leaf),
            [false, false] => None,
        }
    }

    /// Lets a node wait; if there is no room, walks its subtree at once.
    #[inline(always)]
    fn push(&mut self, node: usize, enter: R) {
        match self.stack.get_mut(self.waiting) {
            Some(place) => {
                *place = (self.nodes[node].leaf, enter);
                self.waiting += 1;
            }
            None => self.walk_by_skips(node),
        }
    }

    /// The waiting node that was pushed last, of those that the ray enters before the best hit.
    #[inline(always)]
    fn pop(&mut self) -> Option<u32> {
        while self.waiting > 0 {
            self.waiting -= 1;
            let (content, enter) = self.stack[self.waiting];
            if enter <= self.ray.t_max {
                return Some(content);
            }
        }
        None
    }

    #[inline(always)]
    fn visit(&mut self, leaf: u32) {
        let (first, count) = BvhNode { leaf, ..BvhNode::default() }.primitives();
        self.ray.t_max = (self.visit_leaf)(first, count);
    }

    /// Walks the subtree of a node whose box was tested, without the stack.
    #[cold]
    fn walk_by_skips(&mut self, root: usize) {
        let BvhNode { leaf, skip: end, .. } = self.nodes[root];
        if self.nodes[root].is_leaf() {
            return self.visit(leaf);
        }
        let mut index = leaf;
        while index != end {
            let Some(node) = self.nodes.get(index as usize).filter(|_| self.may_go_on()) else {
                return self.give_up();
            };
            self.walk.node_count += 1;
            index = node.skip;
            if self.is_entered(node) {
                if node.is_leaf() {
                    self.visit(node.leaf);
                } else {
                    index = node.first_child();
                }
            }
        }
    }
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
        let walk = Walker::<f32, _, SIZE>::new(nodes, &slab_ray, visit_leaf).run();
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
