//! The report's octree: cells, each leaf with a list of all spheres that reach into it (seed 1, II.A and II.B).
//!
//! The root is the box of all spheres. A cell with more than [`OctreeOptions::min_spheres`] spheres is divided at
//! its middle into eight, down to [`OctreeOptions::max_depth`]; cells without spheres are not. Nodes stand
//! breadth-first, children in blocks of eight, each with the offset of its children, and for leaves offset and
//! number of their spheres; what is not there is `NONE`, which the validator checks, instead of −1.
//!
//! Deviations from the report:
//! - children are in the order of the bits x, y, z, not z, x, y, as everywhere in Luxel;
//! - a leaf lists copies of its spheres, not indices: one access less for a ray, one binding less for the GPU;
//! - the tree is built breadth-first, straight into the flat arrays, and stops growing at [`CELL_BUDGET_BYTES`];
//! - the overlap test has a margin, so that no ray that starts less than ten root edges away meets a sphere where it is
//!   not listed; from farther out a ray that grazes a silhouette, where rounding decides, may be answered otherwise
//!   than by testing all spheres (`cell.rs`).
//!
//! Edits only change the list of spheres; [`CellOctree::finish`] builds the tree anew.
//!
//! Invariants, checked by [`CellOctree::validate`]: those above; a child's box is exactly the eighth of its
//! parent's, with shared planes; every sphere is listed once in every leaf that it reaches into, and nowhere else.
mod build;
mod cell;
mod validate;

use glam::Vec3;
use luxel_flat::{Heap, LeafSphere, MAX_OCTREE_DEPTH, OctreeNode, SphereRecord};
use luxel_geom::Aabb;

use crate::slots::SphereSlots;
use crate::{AccelError, OctreeOptions, StructureWork};

/// Neither the nodes nor the lists of an octree of cells become larger: what a storage binding may have in WebGPU
/// without asking for more. Nodes at which this ends are leaves, however many spheres they list. Only the list of
/// an undivided root may be longer.
pub const CELL_BUDGET_BYTES: usize = 128 << 20;

/// An octree of cells over spheres in slots; see the module's text.
///
/// ```
/// use luxel_accel::{CellOctree, OctreeOptions};
/// use luxel_flat::SphereRecord;
///
/// let sphere = |x| SphereRecord { center: [x, 0.0, 0.0], radius: 0.5, ..Default::default() };
/// let options = OctreeOptions { max_depth: 1, min_spheres: 1 };
/// let mut octree = CellOctree::build(options, &[(0, sphere(-2.0)), (1, sphere(2.0))], 1)?;
/// assert_eq!(octree.nodes().len(), 9);
/// octree.remove(1, 2)?;
/// octree.finish(2);
/// assert_eq!(octree.nodes().len(), 1);
/// octree.validate()?;
/// # Ok::<(), luxel_accel::AccelError>(())
/// ```
#[derive(Clone, Debug)]
pub struct CellOctree {
    options: OctreeOptions,
    slots: SphereSlots,
    nodes: Heap<OctreeNode>,
    leaf_spheres: Heap<LeafSphere>,
    depth: u32,
    is_cut_off: bool,
    /// Spheres changed since the tree was built.
    is_stale: bool,
    work: StructureWork,
}

impl CellOctree {
    /// An octree over spheres given as (slot, record); their `next` and `node` are ignored.
    ///
    /// # Errors
    /// [`AccelError::BadSphere`], [`AccelError::SlotTaken`] if two records name one slot.
    pub fn build(
        options: OctreeOptions,
        spheres: &[(u32, SphereRecord)],
        revision: u64,
    ) -> Result<Self, AccelError> {
        let options = OctreeOptions { max_depth: options.max_depth.min(MAX_OCTREE_DEPTH), ..options };
        let mut octree = Self {
            options,
            slots: SphereSlots::build(spheres, revision)?,
            nodes: Heap::default(),
            leaf_spheres: Heap::default(),
            depth: 0,
            is_cut_off: false,
            is_stale: false,
            work: StructureWork::default(),
        };
        octree.build_tree(revision);
        Ok(octree)
    }

    /// Puts a sphere into a free slot; its `next` and `node` are ignored.
    ///
    /// # Errors
    /// [`AccelError::SlotTaken`], [`AccelError::BadSphere`].
    pub fn insert(&mut self, slot: u32, sphere: SphereRecord, revision: u64) -> Result<(), AccelError> {
        self.slots.insert(slot, sphere, revision)?;
        self.note_edit(true);
        Ok(())
    }

    /// Takes a sphere out and frees its slot.
    ///
    /// # Errors
    /// [`AccelError::SlotEmpty`].
    pub fn remove(&mut self, slot: u32, revision: u64) -> Result<(), AccelError> {
        self.slots.remove(slot, revision)?;
        self.note_edit(true);
        Ok(())
    }

    /// Moves or resizes a sphere.
    ///
    /// # Errors
    /// [`AccelError::SlotEmpty`], [`AccelError::BadSphere`].
    pub fn update(&mut self, slot: u32, center: Vec3, radius: f32, revision: u64) -> Result<(), AccelError> {
        let changes = self.slots.update(slot, center, radius, revision)?;
        self.note_edit(changes);
        Ok(())
    }

    /// Changes a sphere's material slot.
    ///
    /// # Errors
    /// [`AccelError::SlotEmpty`].
    pub fn set_material(&mut self, slot: u32, material: u32, revision: u64) -> Result<(), AccelError> {
        let changes = self.slots.set_material(slot, material, revision)?;
        self.note_edit(changes);
        Ok(())
    }

    /// Builds the tree anew if spheres changed since it was built.
    pub fn finish(&mut self, revision: u64) {
        if std::mem::take(&mut self.is_stale) {
            self.work.rebuilds += 1;
            self.build_tree(revision);
        }
    }

    fn build_tree(&mut self, revision: u64) {
        let tree = build::Tree::build(&self.slots, &self.options);
        self.work.nodes_touched += tree.nodes.len() as u64;
        self.work.spheres_touched += tree.leaf_spheres.len() as u64;
        self.nodes = Heap::from_records(tree.nodes, revision);
        self.leaf_spheres = Heap::from_records(tree.leaf_spheres, revision);
        (self.depth, self.is_cut_off) = (tree.depth, tree.is_cut_off);
    }

    fn note_edit(&mut self, changes: bool) {
        self.is_stale |= changes;
        self.work.spheres_touched += u64::from(changes);
    }

    /// When cells are divided.
    pub fn options(&self) -> OctreeOptions {
        self.options
    }

    /// The nodes, breadth-first; one without a box if there is no sphere.
    pub fn nodes(&self) -> &Heap<OctreeNode> {
        &self.nodes
    }

    /// The spheres as the leaves list them.
    pub fn leaf_spheres(&self) -> &Heap<LeafSphere> {
        &self.leaf_spheres
    }

    /// The spheres by slot.
    pub fn spheres(&self) -> &Heap<SphereRecord> {
        self.slots.records()
    }

    /// Number of spheres.
    pub fn len(&self) -> u32 {
        self.slots.len()
    }

    /// True if there is no sphere.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Union of the spheres' boxes when the tree was built: the root's cell. Empty without spheres.
    pub fn bounds(&self) -> Aabb<f32> {
        node_cell(&self.nodes.as_slice()[0])
    }

    /// Deepest level of a node below the root.
    pub fn depth(&self) -> u32 {
        self.depth
    }

    /// True if cells were left undivided because the tree would have exceeded [`CELL_BUDGET_BYTES`].
    pub fn is_cut_off(&self) -> bool {
        self.is_cut_off
    }

    /// What has been done so far.
    pub fn work(&self) -> StructureWork {
        self.work
    }
}

fn node_cell(node: &OctreeNode) -> Aabb<f32> {
    Aabb { lo: node.lo.into(), hi: node.hi.into() }
}
