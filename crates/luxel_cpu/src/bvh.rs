//! A walk through a binary tree of boxes, the nearer child first.
//!
//! Both children of a node are tested at once. The farther one waits on a short stack with its entry and is passed
//! over if a hit was found before it. The stack is a small array, so that it costs next to nothing to have; should
//! it be full, the farther subtree is walked at once by its skip pointers, which needs no stack: no depth can
//! overflow, and only time depends on the order. A damaged tree neither panics nor loops forever.
use luxel_flat::{BvhNode, LEAF_COUNT_SHIFT};
use luxel_geom::{PairRay, Real, SlabRay};

use crate::traverse::node_box;

/// Subtrees that can wait.
const STACK_SIZE: usize = 32;

/// What a walk did.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Walk {
    /// Nodes whose box was tested.
    pub node_count: u64,
    /// False if the tree is damaged.
    pub is_sound: bool,
}

/// Visits the leaves that a ray enters. `visit_leaf` gets a leaf's primitives (first and count) and returns up to
/// where the ray is still searched: its `t_max` or the best hit's parameter.
#[inline]
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
    #[inline]
    fn new(nodes: &'a [BvhNode], ray: &SlabRay<R>, visit_leaf: F) -> Self {
        let walk = Walk { node_count: 0, is_sound: true };
        Self { nodes, ray: *ray, visit_leaf, walk, stack: [(0, R::ZERO); SIZE], waiting: 0 }
    }

    #[inline]
    fn run(mut self) -> Walk {
        let pair_ray = PairRay::new(&self.ray);
        let mut next = self.nodes.first().map(|root| root.leaf);
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

    /// Tests the children of an inner node: the one to go on with, if any.
    #[inline]
    fn enter(&mut self, pair_ray: &PairRay<R>, first_child: u32) -> Option<u32> {
        let first = first_child as usize;
        let pair = self.nodes.get(first..first + 2);
        let Some([a, b]) = pair.filter(|_| self.walk.node_count <= self.nodes.len() as u64) else {
            self.walk.is_sound = false;
            self.waiting = 0;
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
    #[inline]
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
    #[inline]
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

    #[inline]
    fn visit(&mut self, leaf: u32) {
        let (first, count) = BvhNode { leaf, ..BvhNode::default() }.primitives();
        self.ray.t_max = (self.visit_leaf)(first, count);
    }

    /// Walks a subtree without the stack.
    #[cold]
    fn walk_by_skips(&mut self, root: usize) {
        let end = self.nodes[root].skip as usize;
        let mut index = root;
        while index != end {
            let in_tree = self.walk.node_count <= self.nodes.len() as u64;
            let Some(node) = self.nodes.get(index).filter(|_| in_tree) else {
                self.walk.is_sound = false;
                self.waiting = 0;
                return;
            };
            self.walk.node_count += 1;
            index = node.skip as usize;
            if node_box(node).interval(&self.ray).overlaps(self.ray.t_min, self.ray.t_max) {
                if node.is_leaf() {
                    self.visit(node.leaf);
                } else {
                    index = node.first_child() as usize;
                }
            }
        }
    }
}
