//! The sphere cloud's BVH: moved spheres are followed by a refit, new and removed ones by a rebuild.
//!
//! Edits only take notes; [`SphereBvh::finish`] brings the tree up to date after a batch of them. A refit keeps
//! the tree's shape and recomputes boxes from the leaves up (Wald, Boulos, Shirley 2007, "Ray Tracing Deformable
//! Scenes Using Dynamic Bounding Volume Hierarchies"): along the paths from the touched leaves to the root if
//! they are few, else over all nodes, children before parents. Results stay exact; only the quality of the tree
//! suffers, and whoever holds it decides when to build it anew.
//!
//! Invariants, checked by [`SphereBvh::validate`] after `finish`: those of [`Bvh`](crate::Bvh); `leaf_spheres` are
//! copies of the live spheres, each once.
use glam::Vec3;
use luxel_flat::{BvhNode, Heap, LeafSphere, MAX_LEAF_SIZE, NONE, SphereRecord};
use luxel_geom::Aabb;

use crate::bvh::validate_tree;
use crate::slots::{SphereSlots, sphere_bounds};
use crate::{AccelError, BvhOptions, OctreeWork, build_bvh};

/// A refit that touches more leaves than this share of all nodes goes over all nodes: a path to the root is about
/// this long, and a pass in order is cheaper per node.
const NODES_PER_PATH: usize = 16;

/// How the tree is built. A leaf's spheres are looked through four at a time, so large leaves pay.
const OPTIONS: BvhOptions = BvhOptions { max_leaf_size: MAX_LEAF_SIZE, traversal_cost: 6.0 };

/// A BVH over spheres in slots; see the module's text.
///
/// ```
/// use glam::Vec3;
/// use luxel_accel::SphereBvh;
/// use luxel_flat::SphereRecord;
///
/// let sphere = SphereRecord { center: [1.0, 2.0, 3.0], radius: 0.5, ..Default::default() };
/// let mut bvh = SphereBvh::build(&[(0, sphere)], 1)?;
/// bvh.update(0, Vec3::ZERO, 0.25, 2)?;
/// bvh.finish(2)?;
/// assert!(bvh.bounds().hi.x < 0.3);
/// bvh.validate()?;
/// # Ok::<(), luxel_accel::AccelError>(())
/// ```
#[derive(Clone, Debug, Default)]
pub struct SphereBvh {
    slots: SphereSlots,
    nodes: Heap<BvhNode>,
    leaf_spheres: Heap<LeafSphere>,
    /// Where in `leaf_spheres` each slot's sphere is listed; of no meaning for a free slot.
    places: Vec<u32>,
    /// The leaf that lists each of `leaf_spheres`.
    leaves: Vec<u32>,
    /// Parent of each node; `NONE` for the root.
    parents: Vec<u32>,
    /// Leaves whose spheres moved since the last `finish`, some perhaps more than once.
    touched: Vec<u32>,
    /// Spheres came or went since the last `finish`: the tree is not that of the spheres.
    is_stale: bool,
    work: OctreeWork,
}

impl SphereBvh {
    /// A tree over spheres given as (slot, record); their `next` and `node` are ignored.
    ///
    /// # Errors
    /// [`AccelError::BadSphere`], [`AccelError::SlotTaken`] if two records name one slot,
    /// [`AccelError::TooManyPrimitives`].
    pub fn build(spheres: &[(u32, SphereRecord)], revision: u64) -> Result<Self, AccelError> {
        let mut bvh = Self { slots: SphereSlots::build(spheres, revision)?, ..Self::default() };
        bvh.rebuild(revision)?;
        Ok(bvh)
    }

    /// Puts a sphere into a free slot; its `next` and `node` are ignored.
    ///
    /// # Errors
    /// [`AccelError::SlotTaken`], [`AccelError::BadSphere`].
    pub fn insert(&mut self, slot: u32, sphere: SphereRecord, revision: u64) -> Result<(), AccelError> {
        self.slots.insert(slot, sphere, revision)?;
        self.is_stale = true;
        Ok(())
    }

    /// Takes a sphere out and frees its slot.
    ///
    /// # Errors
    /// [`AccelError::SlotEmpty`].
    pub fn remove(&mut self, slot: u32, revision: u64) -> Result<(), AccelError> {
        self.slots.remove(slot, revision)?;
        self.is_stale = true;
        Ok(())
    }

    /// Moves or resizes a sphere.
    ///
    /// # Errors
    /// [`AccelError::SlotEmpty`], [`AccelError::BadSphere`].
    pub fn update(&mut self, slot: u32, center: Vec3, radius: f32, revision: u64) -> Result<(), AccelError> {
        if self.slots.update(slot, center, radius, revision)? && !self.is_stale {
            let place = self.copy_to_leaf(slot, revision);
            self.touched.push(self.leaves[place]);
        }
        Ok(())
    }

    /// Changes a sphere's material slot.
    ///
    /// # Errors
    /// [`AccelError::SlotEmpty`].
    pub fn set_material(&mut self, slot: u32, material: u32, revision: u64) -> Result<(), AccelError> {
        if self.slots.set_material(slot, material, revision)? && !self.is_stale {
            self.copy_to_leaf(slot, revision);
        }
        Ok(())
    }

    /// Brings the tree up to date with the edits since the last call.
    ///
    /// # Errors
    /// [`AccelError::TooManyPrimitives`].
    pub fn finish(&mut self, revision: u64) -> Result<(), AccelError> {
        if self.is_stale {
            return self.rebuild(revision);
        }
        let touched = std::mem::take(&mut self.touched);
        if touched.len() * NODES_PER_PATH > self.nodes.len() {
            self.refit_all(revision);
        } else {
            touched.iter().for_each(|&leaf| self.refit_path(leaf, revision));
        }
        Ok(())
    }

    /// The nodes; clone the heap to publish them.
    pub fn nodes(&self) -> &Heap<BvhNode> {
        &self.nodes
    }

    /// The spheres in leaf order; clone the heap to publish them.
    pub fn leaf_spheres(&self) -> &Heap<LeafSphere> {
        &self.leaf_spheres
    }

    /// The spheres by slot; clone the heap to publish them.
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

    /// Union of the spheres' boxes as of the last `finish`. Empty without spheres.
    pub fn bounds(&self) -> Aabb<f32> {
        self.nodes.as_slice().first().map_or_else(Aabb::empty, bounds)
    }

    /// What has been done so far: nodes fitted or built, spheres copied.
    pub fn work(&self) -> OctreeWork {
        self.work
    }

    /// Checks every invariant of the module's text.
    ///
    /// # Errors
    /// [`AccelError::Broken`] with the first record at fault.
    pub fn validate(&self) -> Result<(), AccelError> {
        self.slots.validate()?;
        let require = |holds, index, rule| AccelError::require(holds, "sphere bvh", index, rule);
        require(!self.is_stale && self.touched.is_empty(), 0, "edits wait for `finish`")?;
        let leaf_spheres = self.leaf_spheres.as_slice();
        validate_tree(self.nodes.as_slice(), self.len() as usize, |index| {
            leaf_spheres.get(index as usize).map(leaf_sphere_bounds)
        })?;
        require(leaf_spheres.len() == self.len() as usize, 0, "not every sphere is listed once")?;
        for (slot, record) in self.slots.live() {
            let place = self.places[slot as usize] as usize;
            let is_listed = leaf_spheres.get(place) == Some(&LeafSphere::of(slot, record));
            require(is_listed, place, "a leaf's sphere is not that of its slot")?;
        }
        require(self.parents == parents(self.nodes.as_slice()), 0, "the parents are not those of the nodes")?;
        require(self.leaves == leaves(self.nodes.as_slice()), 0, "the leaves are not those of the nodes")
    }

    /// Builds the tree anew over the live spheres in order of their slots.
    fn rebuild(&mut self, revision: u64) -> Result<(), AccelError> {
        let live: Vec<(u32, &SphereRecord)> = self.slots.live().collect();
        let boxes: Vec<Aabb<f32>> = live.iter().map(|(_, record)| sphere_bounds(record)).collect();
        let bvh = build_bvh(&boxes, &OPTIONS)?;
        let in_leaf = |&index: &u32| LeafSphere::of(live[index as usize].0, live[index as usize].1);
        let leaf_spheres: Vec<LeafSphere> = bvh.order.iter().map(in_leaf).collect();
        self.places = vec![NONE; self.slots.records().len()];
        for (place, sphere) in leaf_spheres.iter().enumerate() {
            self.places[sphere.slot as usize] = place as u32;
        }
        self.work.nodes_touched += bvh.nodes.len() as u64;
        self.work.spheres_touched += leaf_spheres.len() as u64;
        self.leaves = leaves(&bvh.nodes);
        self.parents = parents(&bvh.nodes);
        self.nodes = Heap::from_records(bvh.nodes, revision);
        self.leaf_spheres = Heap::from_records(leaf_spheres, revision);
        self.touched.clear();
        self.is_stale = false;
        Ok(())
    }

    /// Renews the copy of a sphere in its leaf and returns its place.
    fn copy_to_leaf(&mut self, slot: u32, revision: u64) -> usize {
        let place = self.places[slot as usize] as usize;
        let record = &self.slots.records().as_slice()[slot as usize];
        *self.leaf_spheres.get_mut(place, revision) = LeafSphere::of(slot, record);
        self.work.spheres_touched += 1;
        place
    }

    /// The box of a node from what is below it.
    fn fitted(&self, nodes: &[BvhNode], node: usize) -> Aabb<f32> {
        if nodes[node].is_leaf() {
            let (first, count) = nodes[node].primitives();
            let spheres = &self.leaf_spheres.as_slice()[first as usize..(first + count) as usize];
            spheres[1..].iter().fold(leaf_sphere_bounds(&spheres[0]), |b, s| b.union(&leaf_sphere_bounds(s)))
        } else {
            let first = nodes[node].first_child() as usize;
            bounds(&nodes[first]).union(&bounds(&nodes[first + 1]))
        }
    }

    /// Fits a leaf and what is above it, as far up as boxes change.
    fn refit_path(&mut self, leaf: u32, revision: u64) {
        let mut node = leaf;
        while node != NONE {
            let index = node as usize;
            let fitted = self.fitted(self.nodes.as_slice(), index);
            self.work.nodes_touched += 1;
            if fitted == bounds(&self.nodes.as_slice()[index]) {
                break;
            }
            let record = self.nodes.get_mut(index, revision);
            (record.lo, record.hi) = (fitted.lo.into(), fitted.hi.into());
            node = self.parents[index];
        }
    }

    /// Fits every node, children before their parents.
    fn refit_all(&mut self, revision: u64) {
        let mut nodes = self.nodes.as_slice().to_vec();
        for index in (0..nodes.len()).rev() {
            let fitted = self.fitted(&nodes, index);
            (nodes[index].lo, nodes[index].hi) = (fitted.lo.into(), fitted.hi.into());
        }
        self.work.nodes_touched += nodes.len() as u64;
        self.nodes.write(0, &nodes, revision);
    }
}

fn bounds(node: &BvhNode) -> Aabb<f32> {
    Aabb { lo: node.lo.into(), hi: node.hi.into() }
}

fn leaf_sphere_bounds(sphere: &LeafSphere) -> Aabb<f32> {
    luxel_geom::sphere::bounds(Vec3::from(sphere.center), sphere.radius)
}

/// The parent of each node.
fn parents(nodes: &[BvhNode]) -> Vec<u32> {
    let mut parents = vec![NONE; nodes.len()];
    for (index, node) in nodes.iter().enumerate().filter(|(_, node)| !node.is_leaf()) {
        let first = node.first_child() as usize;
        parents[first..first + 2].fill(index as u32);
    }
    parents
}

/// The leaf of each place in the leaf order.
fn leaves(nodes: &[BvhNode]) -> Vec<u32> {
    let ranges = || nodes.iter().enumerate().filter(|(_, n)| n.is_leaf()).map(|(i, n)| (i, n.primitives()));
    let mut leaves = vec![NONE; ranges().map(|(_, (_, count))| count as usize).sum()];
    for (index, (first, count)) in ranges() {
        leaves[first as usize..(first + count) as usize].fill(index as u32);
    }
    leaves
}
