//! The sphere cloud's BVH, edited in place.
//!
//! A sphere comes and goes along one path from the root: the tree's shape changes where it is, boxes and links on
//! the way up (`insert.rs`, `remove.rs`). Moves only take notes; [`SphereBvh::finish`] takes them in. If they are
//! few, a sphere that left the box of its leaf's parent goes to another place, and the others' paths to the root are
//! refitted. If they are many, the tree keeps its shape and all boxes are recomputed from the leaves up (Wald, Boulos,
//! Shirley 2007, "Ray Tracing Deformable Scenes Using Dynamic Bounding Volume Hierarchies"): results stay exact, but
//! the quality suffers, and whoever holds the tree decides when to build it anew. For spheres that came and went, and
//! for room that is no longer used, there is a bound (`wear.rs`), beyond which `finish` builds the tree anew; so it
//! does where an insertion would exceed the depth bound.
//!
//! Deviation from [`Bvh`](crate::Bvh): children of an edited tree may stand before their parents; pairs of nodes
//! and blocks of leaf entries that are not in use hold records that no walk comes to.
//!
//! Invariants, checked by [`SphereBvh::validate`] after `finish`: those of `Bvh` but for the order; leaves list
//! copies of the live spheres, each once; what is not in the tree is free, and listed as such once.
mod heaps;
mod insert;
mod refit;
mod remove;
mod validate;
mod wear;

use glam::Vec3;
use luxel_flat::{BvhNode, Heap, LeafSphere, MAX_LEAF_SIZE, NONE, SphereRecord};
use luxel_geom::Aabb;

use crate::slots::{SphereSlots, sphere_bounds};
use crate::{AccelError, BvhOptions, StructureWork, build_bvh};

/// The root, if there is a node.
const ROOT: u32 = 0;

/// A refit that touches more leaves than this share of all nodes goes over all nodes: a path to the root is about
/// this long, and a pass in order is cheaper per node.
const NODES_PER_PATH: usize = 16;

/// How the tree is built. A leaf's spheres are looked through four at a time, so large leaves pay.
const OPTIONS: BvhOptions =
    BvhOptions { max_leaf_size: MAX_LEAF_SIZE, traversal_cost: 6.0, ..BvhOptions::MEDIUM };

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
    /// Parent of each node; `NONE` for the root and free nodes.
    parents: Vec<u32>,
    /// Levels below each node; 0 for free ones.
    heights: Vec<u8>,
    /// Where in `leaf_spheres` each slot's sphere is listed; `NONE` for a free slot.
    places: Vec<u32>,
    /// The leaf that lists each of `leaf_spheres`; `NONE` for free entries.
    leaves: Vec<u32>,
    /// First nodes of pairs not in use.
    free_pairs: Vec<u32>,
    /// First entries of blocks not in use.
    free_blocks: Vec<u32>,
    /// Blocks stand from this entry on; entries before it are as the build laid them.
    first_block: u32,
    /// Spheres that came or went since the tree was built.
    edit_count: usize,
    /// Slots of spheres that moved since the last `finish`, some perhaps more than once. Until then their leaves
    /// list them where they were, so that leaves and boxes agree.
    touched: Vec<u32>,
    /// The next `finish` builds the tree anew, whatever it is now.
    is_stale: bool,
    work: StructureWork,
}

impl SphereBvh {
    /// A tree over spheres given as (slot, record); their `next` and `node` are ignored.
    ///
    /// # Errors
    /// [`AccelError::BadSphere`], [`AccelError::SlotTaken`] if two records name one slot,
    /// [`AccelError::TooManyPrimitives`].
    pub fn build(spheres: &[(u32, SphereRecord)], revision: u64) -> Result<Self, AccelError> {
        let mut bvh = Self { slots: SphereSlots::build(spheres, revision)?, ..Self::default() };
        bvh.build_tree(revision)?;
        Ok(bvh)
    }

    /// Puts a sphere into a free slot; its `next` and `node` are ignored.
    ///
    /// # Errors
    /// [`AccelError::SlotTaken`], [`AccelError::BadSphere`].
    pub fn insert(&mut self, slot: u32, sphere: SphereRecord, revision: u64) -> Result<(), AccelError> {
        self.slots.insert(slot, sphere, revision)?;
        self.places.resize(self.slots.records().len(), NONE);
        self.edit_count += 1;
        self.is_stale = self.is_stale || self.is_worn() || !self.link(slot, revision);
        Ok(())
    }

    /// Takes a sphere out and frees its slot.
    ///
    /// # Errors
    /// [`AccelError::SlotEmpty`].
    pub fn remove(&mut self, slot: u32, revision: u64) -> Result<(), AccelError> {
        self.slots.remove(slot, revision)?;
        self.edit_count += 1;
        self.is_stale = self.is_stale || self.is_worn() || !self.unlink(slot, revision);
        Ok(())
    }

    /// Moves or resizes a sphere.
    ///
    /// # Errors
    /// [`AccelError::SlotEmpty`], [`AccelError::BadSphere`].
    pub fn update(&mut self, slot: u32, center: Vec3, radius: f32, revision: u64) -> Result<(), AccelError> {
        if self.slots.update(slot, center, radius, revision)? && !self.is_stale {
            self.touched.push(slot);
        }
        Ok(())
    }

    /// Changes a sphere's material slot.
    ///
    /// # Errors
    /// [`AccelError::SlotEmpty`].
    pub fn set_material(&mut self, slot: u32, material: u32, revision: u64) -> Result<(), AccelError> {
        if self.slots.set_material(slot, material, revision)? && !self.is_stale {
            let place = self.places[slot as usize] as usize;
            self.leaf_spheres.get_mut(place, revision).material = material;
            self.work.spheres_touched += 1;
        }
        Ok(())
    }

    /// Brings the tree up to date with the edits since the last call.
    ///
    /// # Errors
    /// [`AccelError::TooManyPrimitives`].
    pub fn finish(&mut self, revision: u64) -> Result<(), AccelError> {
        let touched = std::mem::take(&mut self.touched);
        self.is_stale = self.is_stale || self.is_worn() || !self.follow_all(touched, revision);
        if self.is_stale {
            self.work.rebuilds += 1;
            self.build_tree(revision)?;
        }
        Ok(())
    }

    /// Takes in that spheres moved. False if that takes a rebuild.
    fn follow_all(&mut self, slots: Vec<u32>, revision: u64) -> bool {
        if slots.len() * NODES_PER_PATH > self.nodes.len() {
            slots.into_iter().for_each(|slot| self.copy_to_leaf(slot, revision));
            self.refit_all(revision);
            return true;
        }
        slots.into_iter().all(|slot| self.follow(slot, revision))
    }

    /// The nodes, free ones among them; clone the heap to publish them.
    pub fn nodes(&self) -> &Heap<BvhNode> {
        &self.nodes
    }

    /// The spheres as the leaves list them, free entries among them; clone the heap to publish them.
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

    /// Deepest level of a node below the root.
    pub fn depth(&self) -> u32 {
        self.heights.first().copied().map_or(0, u32::from)
    }

    /// What has been done so far: nodes read, fitted or built, spheres copied, pairs taken and given back.
    pub fn work(&self) -> StructureWork {
        self.work
    }

    /// Builds the tree over the live spheres in order of their slots.
    fn build_tree(&mut self, revision: u64) -> Result<(), AccelError> {
        let live: Vec<(u32, &SphereRecord)> = self.slots.live().collect();
        let boxes: Vec<Aabb<f32>> = live.iter().map(|(_, record)| sphere_bounds(record)).collect();
        let bvh = build_bvh(&boxes, &OPTIONS)?;
        let in_leaf = |&index: &u32| LeafSphere::of(live[index as usize].0, live[index as usize].1);
        let leaf_spheres: Vec<LeafSphere> = bvh.order.iter().map(in_leaf).collect();
        let mut places = vec![NONE; self.slots.records().len()];
        for (place, sphere) in leaf_spheres.iter().enumerate() {
            places[sphere.slot as usize] = place as u32;
        }
        let mut work = self.work;
        work.nodes_touched += bvh.nodes.len() as u64;
        work.spheres_touched += leaf_spheres.len() as u64;
        *self = Self {
            slots: std::mem::take(&mut self.slots),
            parents: parents(&bvh.nodes),
            heights: heights(&bvh.nodes),
            places,
            leaves: leaves(&bvh.nodes),
            first_block: leaf_spheres.len() as u32,
            nodes: Heap::from_records(bvh.nodes, revision),
            leaf_spheres: Heap::from_records(leaf_spheres, revision),
            work,
            ..Self::default()
        };
        Ok(())
    }

    /// Renews the copy of a slot's sphere in its leaf, if there is one.
    fn copy_to_leaf(&mut self, slot: u32, revision: u64) {
        let place = self.places[slot as usize];
        if place != NONE {
            let record = &self.slots.records().as_slice()[slot as usize];
            *self.leaf_spheres.get_mut(place as usize, revision) = LeafSphere::of(slot, record);
            self.work.spheres_touched += 1;
        }
    }
}

fn bounds(node: &BvhNode) -> Aabb<f32> {
    Aabb { lo: node.lo.into(), hi: node.hi.into() }
}

fn leaf_sphere_bounds(sphere: &LeafSphere) -> Aabb<f32> {
    luxel_geom::sphere::bounds(Vec3::from(sphere.center), sphere.radius)
}

/// The parent of each node of a tree as built.
fn parents(nodes: &[BvhNode]) -> Vec<u32> {
    let mut parents = vec![NONE; nodes.len()];
    for (index, node) in nodes.iter().enumerate().filter(|(_, node)| !node.is_leaf()) {
        let first = node.first_child() as usize;
        parents[first..first + 2].fill(index as u32);
    }
    parents
}

/// The levels below each node of a tree as built, children behind their parents.
fn heights(nodes: &[BvhNode]) -> Vec<u8> {
    let mut heights = vec![0u8; nodes.len()];
    for (index, node) in nodes.iter().enumerate().rev().filter(|(_, node)| !node.is_leaf()) {
        let first = node.first_child() as usize;
        heights[index] = 1 + heights[first].max(heights[first + 1]);
    }
    heights
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
