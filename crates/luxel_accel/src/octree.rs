//! The sphere cloud's octree: loose, lazy, edited in place.
//!
//! Theory: loose octrees, Ulrich 2000, "Loose Octrees" (Game Programming Gems). A sphere belongs to exactly one
//! node: the deepest whose cell its centre lies in and whose edge is at least its diameter. So no sphere is
//! listed twice, and nothing depends on how a sphere overlaps a cell. Deviations: nodes carry tight boxes
//! instead of enlarged cells, so that results are exact whatever the tree's shape; and the tree is lazy: a node
//! is subdivided only when it holds more than [`OctreeOptions::min_spheres`] spheres that could go deeper.
//!
//! A centre exactly on a dividing plane belongs to the upper half. A sphere whose centre lies outside the root
//! cell stays at the root.
//!
//! Invariants, checked by [`SphereOctree::validate`]:
//! node 0 is the root and always exists; children stand in blocks of eight; a block exists only while it holds
//! a sphere; chains are acyclic and hold every sphere once; boxes, counts and masks are those of the content.
//! The shape of an edited tree may differ from a fresh one's, never what a ray meets.
mod cell;
mod edit;
mod refit;
mod structure;
mod validate;

use luxel_flat::{Heap, MAX_OCTREE_DEPTH, NONE, OctreeNode, SphereRecord};
use luxel_geom::Aabb;

use crate::slots::{check_free, check_sphere, store};
use crate::{AccelError, StructureWork};
use cell::Cell;
pub use cell::RootCell;
pub use validate::validate_octree;

/// When a node of an octree is subdivided (seed 1, II.A: "Max Octree Depth", "Min Spheres per Node").
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct OctreeOptions {
    /// Deepest level below the root; 0 is the root alone. Held to at most `MAX_OCTREE_DEPTH`.
    pub max_depth: u32,
    /// A node with more spheres than this is subdivided. In the loose octree those count that could go deeper.
    pub min_spheres: u32,
}

impl Default for OctreeOptions {
    fn default() -> Self {
        Self { max_depth: MAX_OCTREE_DEPTH, min_spheres: 8 }
    }
}

/// An octree over spheres in slots; see the module's text.
///
/// ```
/// use glam::Vec3;
/// use luxel_accel::{OctreeOptions, RootCell, SphereOctree};
/// use luxel_flat::SphereRecord;
///
/// let root = RootCell { center: Vec3::ZERO, half_extent: 8.0 };
/// let mut octree = SphereOctree::new(root, OctreeOptions::default());
/// let sphere = SphereRecord { center: [1.0, 2.0, 3.0], radius: 0.5, ..Default::default() };
/// octree.insert(0, sphere, 1)?;
/// octree.update(0, Vec3::ZERO, 0.25, 2)?;
/// assert_eq!(octree.nodes().as_slice()[0].subtree_count, 1);
/// octree.validate()?;
/// # Ok::<(), luxel_accel::AccelError>(())
/// ```
#[derive(Clone, Debug)]
pub struct SphereOctree {
    nodes: Heap<OctreeNode>,
    spheres: Heap<SphereRecord>,
    /// First nodes of unused blocks.
    free_blocks: Vec<u32>,
    root: RootCell,
    options: OctreeOptions,
    work: StructureWork,
}

impl SphereOctree {
    /// An octree without spheres.
    pub fn new(root: RootCell, options: OctreeOptions) -> Self {
        Self {
            nodes: Heap::from_records(vec![empty_node(NONE)], 0),
            spheres: Heap::default(),
            free_blocks: Vec::new(),
            root,
            options,
            work: StructureWork::default(),
        }
    }

    /// An octree over spheres given as (slot, record), built in one go.
    ///
    /// # Errors
    /// [`AccelError::BadSphere`], [`AccelError::SlotTaken`] if two records name one slot.
    pub fn build(
        root: RootCell,
        options: OctreeOptions,
        spheres: &[(u32, SphereRecord)],
        revision: u64,
    ) -> Result<Self, AccelError> {
        let mut octree = Self::new(root, options);
        for &(slot, record) in spheres {
            check_free(&octree.spheres, slot)?;
            check_sphere(slot, record.center.into(), record.radius)?;
            store(&mut octree.spheres, slot, record, revision);
            octree.link(0, slot, revision);
        }
        octree.grow_whole(revision);
        Ok(octree)
    }

    /// The nodes; clone the heap to publish them.
    pub fn nodes(&self) -> &Heap<OctreeNode> {
        &self.nodes
    }

    /// The spheres by slot; clone the heap to publish them.
    pub fn spheres(&self) -> &Heap<SphereRecord> {
        &self.spheres
    }

    /// The cell of the root.
    pub fn root(&self) -> RootCell {
        self.root
    }

    /// When nodes are subdivided.
    pub fn options(&self) -> OctreeOptions {
        self.options
    }

    /// Number of spheres.
    pub fn len(&self) -> u32 {
        self.node(0).subtree_count
    }

    /// True if there is no sphere.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Union of the spheres' boxes: a function of the content alone. Empty without spheres.
    pub fn bounds(&self) -> Aabb<f32> {
        node_bounds(self.node(0))
    }

    /// What has been done so far.
    pub fn work(&self) -> StructureWork {
        self.work
    }

    fn node(&self, node: u32) -> &OctreeNode {
        &self.nodes.as_slice()[node as usize]
    }

    fn sphere(&self, slot: u32) -> &SphereRecord {
        &self.spheres.as_slice()[slot as usize]
    }

    fn root_cell(&self) -> Cell {
        self.root.cell(self.options.max_depth)
    }
}

/// A node without spheres and children.
fn empty_node(parent: u32) -> OctreeNode {
    let bounds = Aabb::<f32>::empty();
    OctreeNode {
        lo: bounds.lo.into(),
        first_child: NONE,
        hi: bounds.hi.into(),
        first_sphere: NONE,
        sphere_count: 0,
        child_mask: 0,
        parent,
        subtree_count: 0,
    }
}

/// Deepest level of a node of an octree below its root.
pub fn octree_depth(nodes: &[OctreeNode]) -> u32 {
    let parent = |&node: &u32| Some(nodes[node as usize].parent).filter(|&parent| parent != NONE);
    // One child of each block stands for all; an unused block has no parent.
    let blocks = (1..nodes.len() as u32).step_by(8);
    blocks.map(|first| std::iter::successors(Some(first), parent).count() as u32 - 1).max().unwrap_or(0)
}

fn node_bounds(node: &OctreeNode) -> Aabb<f32> {
    Aabb { lo: node.lo.into(), hi: node.hi.into() }
}
