//! The sphere cloud's structure, whichever it is: one face for those who edit and publish it.
//!
//! After a batch of edits comes [`SphereStructure::finish`]; until then the records may be those of before. Heaps
//! that the structure does not use are empty.
use glam::Vec3;
use luxel_flat::{BvhNode, Heap, LeafSphere, MAX_OCTREE_DEPTH, OctreeNode, SphereAccel, SphereRecord};
use luxel_geom::Aabb;

use crate::sphere_list::SphereList;
use crate::{
    AccelError, CellOctree, OctreeOptions, RootCell, SphereBvh, SphereOctree, StructureWork, octree_depth,
};

/// Which structure, and when its nodes are divided.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SphereOptions {
    /// The structure.
    pub accel: SphereAccel,
    /// Octrees: deepest level below the root, held to at most `MAX_OCTREE_DEPTH`.
    pub max_depth: u32,
    /// Octrees: a node with more spheres than this is divided.
    pub min_spheres: u32,
}

impl Default for SphereOptions {
    fn default() -> Self {
        let OctreeOptions { max_depth, min_spheres } = OctreeOptions::default();
        Self { accel: SphereAccel::default(), max_depth, min_spheres }
    }
}

impl SphereOptions {
    fn octree(&self) -> OctreeOptions {
        OctreeOptions { max_depth: self.max_depth.min(MAX_OCTREE_DEPTH), min_spheres: self.min_spheres }
    }
}

/// A structure over spheres in slots; see the module's text.
///
/// ```
/// use glam::Vec3;
/// use luxel_accel::{RootCell, SphereOptions, SphereStructure};
/// use luxel_flat::{SphereAccel, SphereRecord};
///
/// let options = SphereOptions { accel: SphereAccel::Bvh, ..Default::default() };
/// let root = RootCell { center: Vec3::ZERO, half_extent: 8.0 };
/// let sphere = SphereRecord { radius: 0.5, ..Default::default() };
/// let mut structure = SphereStructure::build(options, root, &[(0, sphere)], 1)?;
/// structure.update(0, Vec3::X, 0.25, 2)?;
/// structure.finish(2)?;
/// assert!(structure.bounds().lo.x > 0.7);
/// structure.validate()?;
/// # Ok::<(), luxel_accel::AccelError>(())
/// ```
#[derive(Clone, Debug)]
pub struct SphereStructure {
    options: SphereOptions,
    root: RootCell,
    inner: Inner,
    unused: Unused,
}

#[derive(Clone, Debug)]
enum Inner {
    Naive(SphereList),
    Octree(SphereOctree),
    Cells(CellOctree),
    Bvh(SphereBvh),
}

/// What to show of heaps that the structure does not have.
#[derive(Clone, Debug, Default)]
struct Unused {
    octree_nodes: Heap<OctreeNode>,
    sphere_nodes: Heap<BvhNode>,
    leaf_spheres: Heap<LeafSphere>,
}

impl Default for SphereStructure {
    /// A loose octree without spheres.
    fn default() -> Self {
        let (options, root) = (SphereOptions::default(), RootCell { center: Vec3::ZERO, half_extent: 1.0 });
        let inner = Inner::Octree(SphereOctree::new(root, options.octree()));
        Self { options, root, inner, unused: Unused::default() }
    }
}

impl SphereStructure {
    /// The structure over spheres given as (slot, record); their `next` and `node` are ignored. The root cell
    /// counts for [`SphereAccel::Octree`] alone.
    ///
    /// # Errors
    /// [`AccelError::BadSphere`], [`AccelError::SlotTaken`] if two records name one slot,
    /// [`AccelError::TooManyPrimitives`].
    pub fn build(
        options: SphereOptions,
        root: RootCell,
        spheres: &[(u32, SphereRecord)],
        revision: u64,
    ) -> Result<Self, AccelError> {
        let octree = options.octree();
        let inner = match options.accel {
            SphereAccel::Naive => Inner::Naive(SphereList::build(spheres, revision)?),
            SphereAccel::Octree => Inner::Octree(SphereOctree::build(root, octree, spheres, revision)?),
            SphereAccel::OctreeBase | SphereAccel::OctreeSeed => {
                Inner::Cells(CellOctree::build(octree, spheres, revision)?)
            }
            SphereAccel::Bvh => Inner::Bvh(SphereBvh::build(spheres, revision)?),
        };
        Ok(Self { options, root, inner, unused: Unused::default() })
    }

    /// Puts a sphere into a free slot; its `next` and `node` are ignored.
    ///
    /// # Errors
    /// [`AccelError::SlotTaken`], [`AccelError::BadSphere`]; then nothing changed.
    pub fn insert(&mut self, slot: u32, sphere: SphereRecord, revision: u64) -> Result<(), AccelError> {
        match &mut self.inner {
            Inner::Naive(list) => list.insert(slot, sphere, revision),
            Inner::Octree(octree) => octree.insert(slot, sphere, revision),
            Inner::Cells(octree) => octree.insert(slot, sphere, revision),
            Inner::Bvh(bvh) => bvh.insert(slot, sphere, revision),
        }
    }

    /// Takes a sphere out and frees its slot.
    ///
    /// # Errors
    /// [`AccelError::SlotEmpty`].
    pub fn remove(&mut self, slot: u32, revision: u64) -> Result<(), AccelError> {
        match &mut self.inner {
            Inner::Naive(list) => list.remove(slot, revision),
            Inner::Octree(octree) => octree.remove(slot, revision),
            Inner::Cells(octree) => octree.remove(slot, revision),
            Inner::Bvh(bvh) => bvh.remove(slot, revision),
        }
    }

    /// Moves or resizes a sphere.
    ///
    /// # Errors
    /// [`AccelError::SlotEmpty`], [`AccelError::BadSphere`]; then nothing changed.
    pub fn update(&mut self, slot: u32, center: Vec3, radius: f32, revision: u64) -> Result<(), AccelError> {
        match &mut self.inner {
            Inner::Naive(list) => list.update(slot, center, radius, revision),
            Inner::Octree(octree) => octree.update(slot, center, radius, revision),
            Inner::Cells(octree) => octree.update(slot, center, radius, revision),
            Inner::Bvh(bvh) => bvh.update(slot, center, radius, revision),
        }
    }

    /// Changes a sphere's material slot.
    ///
    /// # Errors
    /// [`AccelError::SlotEmpty`].
    pub fn set_material(&mut self, slot: u32, material: u32, revision: u64) -> Result<(), AccelError> {
        match &mut self.inner {
            Inner::Naive(list) => list.set_material(slot, material, revision),
            Inner::Octree(octree) => octree.set_material(slot, material, revision),
            Inner::Cells(octree) => octree.set_material(slot, material, revision),
            Inner::Bvh(bvh) => bvh.set_material(slot, material, revision),
        }
    }

    /// Does what the edits since the last call have put off. Without edits nothing is done.
    ///
    /// # Errors
    /// [`AccelError::TooManyPrimitives`].
    pub fn finish(&mut self, revision: u64) -> Result<(), AccelError> {
        match &mut self.inner {
            Inner::Naive(list) => list.finish(),
            Inner::Octree(_) => {}
            Inner::Cells(octree) => octree.finish(revision),
            Inner::Bvh(bvh) => bvh.finish(revision)?,
        }
        Ok(())
    }

    /// Which structure it is.
    pub fn options(&self) -> SphereOptions {
        self.options
    }

    /// The cell of the loose octree's root.
    pub fn root(&self) -> RootCell {
        self.root
    }

    /// The spheres by slot.
    pub fn spheres(&self) -> &Heap<SphereRecord> {
        match &self.inner {
            Inner::Naive(list) => list.spheres(),
            Inner::Octree(octree) => octree.spheres(),
            Inner::Cells(octree) => octree.spheres(),
            Inner::Bvh(bvh) => bvh.spheres(),
        }
    }

    /// The nodes of an octree.
    pub fn octree_nodes(&self) -> &Heap<OctreeNode> {
        match &self.inner {
            Inner::Octree(octree) => octree.nodes(),
            Inner::Cells(octree) => octree.nodes(),
            _ => &self.unused.octree_nodes,
        }
    }

    /// The nodes of a BVH.
    pub fn sphere_nodes(&self) -> &Heap<BvhNode> {
        match &self.inner {
            Inner::Bvh(bvh) => bvh.nodes(),
            _ => &self.unused.sphere_nodes,
        }
    }

    /// The spheres as the leaves of a BVH or an octree of cells list them.
    pub fn leaf_spheres(&self) -> &Heap<LeafSphere> {
        match &self.inner {
            Inner::Cells(octree) => octree.leaf_spheres(),
            Inner::Bvh(bvh) => bvh.leaf_spheres(),
            _ => &self.unused.leaf_spheres,
        }
    }

    /// Number of nodes; 1 without a structure.
    pub fn node_count(&self) -> u32 {
        match &self.inner {
            Inner::Naive(_) => 1,
            Inner::Octree(_) | Inner::Cells(_) => self.octree_nodes().len() as u32,
            Inner::Bvh(bvh) => bvh.nodes().len() as u32,
        }
    }

    /// Number of spheres.
    pub fn len(&self) -> u32 {
        match &self.inner {
            Inner::Naive(list) => list.len(),
            Inner::Octree(octree) => octree.len(),
            Inner::Cells(octree) => octree.len(),
            Inner::Bvh(bvh) => bvh.len(),
        }
    }

    /// True if there is no sphere.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Union of the spheres' boxes as of the last `finish`: a function of the content alone. Empty without spheres.
    pub fn bounds(&self) -> Aabb<f32> {
        match &self.inner {
            Inner::Naive(list) => list.bounds(),
            Inner::Octree(octree) => octree.bounds(),
            Inner::Cells(octree) => octree.bounds(),
            Inner::Bvh(bvh) => bvh.bounds(),
        }
    }

    /// Deepest level of a node below the root; 0 without nodes. Takes a look at every node.
    pub fn depth(&self) -> u32 {
        match &self.inner {
            Inner::Naive(_) => 0,
            Inner::Octree(octree) => octree_depth(octree.nodes().as_slice()),
            Inner::Cells(octree) => octree.depth(),
            Inner::Bvh(bvh) => bvh.depth(),
        }
    }

    /// What has been done since the structure was made.
    pub fn work(&self) -> StructureWork {
        match &self.inner {
            Inner::Naive(list) => list.work(),
            Inner::Octree(octree) => octree.work(),
            Inner::Cells(octree) => octree.work(),
            Inner::Bvh(bvh) => bvh.work(),
        }
    }

    /// True if an octree of cells ended at [`CELL_BUDGET_BYTES`](crate::CELL_BUDGET_BYTES) instead of at its options.
    pub fn is_cut_off(&self) -> bool {
        matches!(&self.inner, Inner::Cells(octree) if octree.is_cut_off())
    }

    /// Checks every invariant of the structure. Edits must be finished.
    ///
    /// # Errors
    /// [`AccelError::Broken`] with the first record at fault.
    pub fn validate(&self) -> Result<(), AccelError> {
        match &self.inner {
            Inner::Naive(list) => list.validate(),
            Inner::Octree(octree) => octree.validate(),
            Inner::Cells(octree) => octree.validate(),
            Inner::Bvh(bvh) => bvh.validate(),
        }
    }
}
