//! Breadth-first construction into the flat arrays, the cells of a level in parallel.
use luxel_flat::{LeafSphere, NONE, OctreeNode, SphereRecord};
use luxel_geom::Aabb;
use rayon::prelude::*;

use super::cell::{eighth, is_divisible, margin, octants_of};
use super::{CELL_BUDGET_BYTES, node_cell};
use crate::OctreeOptions;
use crate::slots::SphereSlots;

/// Most nodes of a tree.
const MAX_NODES: usize = CELL_BUDGET_BYTES / size_of::<OctreeNode>();
/// Most spheres in the lists of a tree, each counted as often as it is listed.
const MAX_LISTED: usize = CELL_BUDGET_BYTES / size_of::<LeafSphere>();

/// Nodes with more spheres divide them among threads.
const PARALLEL_COUNT: usize = 4096;

/// A finished tree.
pub(super) struct Tree {
    pub(super) nodes: Vec<OctreeNode>,
    pub(super) leaf_spheres: Vec<LeafSphere>,
    pub(super) depth: u32,
    pub(super) is_cut_off: bool,
}

/// A node whose content is not decided yet.
struct Open {
    node: usize,
    /// Positions in the builder's `live`.
    spheres: Vec<u32>,
}

/// The spheres of a node by child: those of child 0, then those of child 1, …
struct Division {
    spheres: Vec<u32>,
    counts: [usize; 8],
}

struct Builder<'a> {
    options: OctreeOptions,
    live: Vec<(u32, &'a SphereRecord)>,
    margin: f64,
    tree: Tree,
    /// Spheres in the lists of the leaves and of the open nodes.
    listed: usize,
}

impl Tree {
    /// The tree over the spheres of some slots.
    pub(super) fn build(slots: &SphereSlots, options: &OctreeOptions) -> Self {
        let live: Vec<_> = slots.live().collect();
        let root = slots.bounds();
        let tree = Self { nodes: Vec::new(), leaf_spheres: Vec::new(), depth: 0, is_cut_off: false };
        let mut builder =
            Builder { options: *options, margin: margin(&root), listed: live.len(), live, tree };
        builder.grow(root);
        builder.tree.sum_up();
        builder.tree
    }

    /// Counts and masks of inner nodes. Children stand behind their parents.
    fn sum_up(&mut self) {
        for node in (1..self.nodes.len()).rev() {
            let OctreeNode { parent, subtree_count, .. } = self.nodes[node];
            let parent = &mut self.nodes[parent as usize];
            parent.subtree_count += subtree_count;
            let octant = node as u32 - parent.first_child;
            parent.child_mask |= u32::from(subtree_count > 0) << octant;
        }
    }
}

impl Builder<'_> {
    fn grow(&mut self, root: Aabb<f32>) {
        self.tree.nodes.push(cell_node(&root, NONE));
        let mut level = vec![Open { node: 0, spheres: (0..self.live.len() as u32).collect() }];
        for depth in 0.. {
            let divisions: Vec<Option<Division>> =
                level.par_iter().map(|open| self.divide(open, depth)).collect();
            let mut next = Vec::new();
            for (open, division) in level.into_iter().zip(divisions) {
                match division.filter(|division| self.affords(division, &open)) {
                    Some(division) => self.add_children(&open, &division, &mut next),
                    None => self.close(&open),
                }
            }
            if next.is_empty() {
                self.tree.depth = depth;
                break;
            }
            level = next;
        }
    }

    /// The content of a node's children; `None` if it is a leaf.
    fn divide(&self, open: &Open, depth: u32) -> Option<Division> {
        let cell = node_cell(&self.tree.nodes[open.node]);
        let is_crowded = open.spheres.len() > self.options.min_spheres as usize;
        if !is_crowded || depth >= self.options.max_depth || !is_divisible(&cell) {
            return None;
        }
        let octants_of = |&sphere: &u32| octants_of(&cell, self.live[sphere as usize].1, self.margin);
        let octants: Vec<u8> = if open.spheres.len() > PARALLEL_COUNT {
            open.spheres.par_iter().map(octants_of).collect()
        } else {
            open.spheres.iter().map(octants_of).collect()
        };
        let mut spheres = Vec::with_capacity(2 * open.spheres.len());
        let counts = std::array::from_fn(|octant| {
            let before = spheres.len();
            let here = open.spheres.iter().zip(&octants).filter(|(_, bits)| **bits >> octant & 1 == 1);
            spheres.extend(here.map(|(sphere, _)| *sphere));
            spheres.len() - before
        });
        Some(Division { spheres, counts })
    }

    /// True if the budget allows for a node's children; then their spheres are booked.
    fn affords(&mut self, division: &Division, open: &Open) -> bool {
        let listed = self.listed - open.spheres.len() + division.spheres.len();
        let affords = listed <= MAX_LISTED.max(self.listed) && self.tree.nodes.len() + 8 <= MAX_NODES;
        if affords {
            self.listed = listed;
        }
        self.tree.is_cut_off |= !affords;
        affords
    }

    fn add_children(&mut self, open: &Open, division: &Division, next: &mut Vec<Open>) {
        let first = self.tree.nodes.len();
        let cell = node_cell(&self.tree.nodes[open.node]);
        self.tree.nodes[open.node].first_child = first as u32;
        let mut from = 0;
        for (octant, &count) in division.counts.iter().enumerate() {
            self.tree.nodes.push(cell_node(&eighth(&cell, octant as u32), open.node as u32));
            if count > 0 {
                let spheres = division.spheres[from..from + count].to_vec();
                next.push(Open { node: first + octant, spheres });
            }
            from += count;
        }
    }

    /// Makes a node a leaf.
    fn close(&mut self, open: &Open) {
        let node = &mut self.tree.nodes[open.node];
        let count = open.spheres.len() as u32;
        if count > 0 {
            (node.first_sphere, node.sphere_count) = (self.tree.leaf_spheres.len() as u32, count);
            node.subtree_count = count;
        }
        let copies = open.spheres.iter().map(|&sphere| {
            let (slot, record) = self.live[sphere as usize];
            LeafSphere::of(slot, record)
        });
        self.tree.leaf_spheres.extend(copies);
    }
}

/// A node without spheres and children.
fn cell_node(cell: &Aabb<f32>, parent: u32) -> OctreeNode {
    OctreeNode {
        lo: cell.lo.into(),
        first_child: NONE,
        hi: cell.hi.into(),
        first_sphere: NONE,
        sphere_count: 0,
        child_mask: 0,
        parent,
        subtree_count: 0,
    }
}
