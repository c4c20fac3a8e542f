//! The tree of a triangle mesh, and its triangles in leaf order.
use glam::Vec3;
use luxel_flat::{BvhNode, FAR, Triangle};
use luxel_geom::{Aabb, triangle};
use rayon::prelude::*;

use crate::bvh::{floor_cost, half_area, validate_tree};
use crate::{AccelError, BvhOptions, build_bvh, sah_cost};

/// A mesh ready to be placed in the flat scene.
#[derive(Clone, Debug, PartialEq)]
pub struct MeshBvh {
    /// Nodes, the root first; a leaf's primitives are consecutive `triangles`.
    pub nodes: Vec<BvhNode>,
    /// Triangles in leaf order, with material 0, each the light of its place.
    pub triangles: Vec<Triangle>,
    /// The root's box in the mesh's coordinates; empty without triangles.
    pub bounds: Aabb<f32>,
    /// Where each of `triangles` stands in the input.
    pub order: Vec<u32>,
    /// [`sah_cost`] of the tree as built.
    pub built_cost: f64,
    /// What of that no tree over these triangles could save: the cost of testing each where a ray meets its own box.
    pub built_floor: f64,
    /// Half the surface of the root's box then.
    pub built_area: f64,
    /// Refits since then.
    pub refits: u32,
}

/// What a refit made of a tree.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Refit {
    /// [`sah_cost`] now.
    pub cost: f64,
    /// What of that no tree could save.
    pub floor: f64,
    /// Half the surface of the root's box.
    pub area: f64,
    /// [`sah_cost`] of the tree as it was built.
    pub built_cost: f64,
    /// What of that no tree could have saved.
    pub built_floor: f64,
    /// Half the surface of the root's box then.
    pub built_area: f64,
    /// Refits since then, this one included.
    pub refits: u32,
}

/// A refitted tree whose nodes cost more than this many times what they cost when built, beyond what no tree can save, is
/// worth building anew: tracing it costs about as much more, and a build about as much as tracing one ray per ten
/// triangles.
pub const REBUILD_RATIO: f64 = 1.3;

/// Where what no tree can save is by more than this another than when the tree was built, up or down, and the triangles
/// themselves are as much larger or smaller, they fill their box in another way (a heap that was a surface, a point that
/// unfolds), and what a tree cost over them then says nothing about what one could cost now. What only grows as a whole,
/// or moves far away, changes one of the two.
const SAME_SHAPE: f64 = 1.5;

/// After so many refits a tree is built anew in any case. Neither rule sees that the triangles now lie so that a tree
/// could cost less than the old one ever did (loose parts that gather in a row); a build takes about five times as long as
/// a refit, so that this costs a sixth of the time of refits.
pub const MAX_REFITS: u32 = 32;

/// Builds the tree of a mesh. `ids[i]` is what a hit on `triangles[i]` reports.
///
/// # Errors
/// [`AccelError::IdCount`], [`AccelError::VertexOutOfRange`], [`AccelError::BadTriangle`],
/// [`AccelError::TooManyPrimitives`].
pub fn build_mesh(
    positions: &[Vec3],
    triangles: &[[u32; 3]],
    ids: &[u32],
    options: &BvhOptions,
) -> Result<MeshBvh, AccelError> {
    let records = mesh_triangles(positions, triangles, ids)?;
    let boxes: Vec<Aabb<f32>> = records.par_iter().map(bounds).collect();
    let bvh = build_bvh(&boxes, options)?;
    let in_slot = |(slot, &index): (usize, &u32)| Triangle { light: slot as u32, ..records[index as usize] };
    Ok(MeshBvh {
        bounds: root_bounds(&bvh.nodes),
        built_floor: bvh.nodes.first().map_or(0.0, |root| floor_cost(root, boxes.iter().copied())),
        triangles: bvh.order.par_iter().enumerate().map(in_slot).collect(),
        order: bvh.order,
        built_cost: sah_cost(&bvh.nodes),
        built_area: bvh.nodes.first().map_or(0.0, half_area),
        refits: 0,
        nodes: bvh.nodes,
    })
}

/// The triangles of a mesh in its own order, without a tree, for whoever builds one over several meshes. Each is the light
/// of its place.
///
/// # Errors
/// As [`build_mesh`], but for [`AccelError::TooManyPrimitives`].
pub fn mesh_triangles(
    positions: &[Vec3],
    triangles: &[[u32; 3]],
    ids: &[u32],
) -> Result<Vec<Triangle>, AccelError> {
    if triangles.len() != ids.len() {
        return Err(AccelError::IdCount { triangles: triangles.len(), ids: ids.len() });
    }
    (triangles.par_iter().zip(ids).enumerate())
        .map(|(triangle, (indices, &id))| record(positions, triangle, *indices, id))
        .collect()
}

/// Checks nodes against the triangles that their leaves list; see [`Bvh`](crate::Bvh).
///
/// # Errors
/// [`AccelError::Broken`] with the first node at fault.
pub fn validate_mesh(nodes: &[BvhNode], triangles: &[Triangle]) -> Result<(), AccelError> {
    validate_tree(nodes, triangles.len(), |index| triangles.get(index as usize).map(bounds))
}

impl MeshBvh {
    /// Checks the tree against its triangles; see [`Bvh`](crate::Bvh).
    ///
    /// # Errors
    /// [`AccelError::Broken`] with the first node at fault.
    pub fn validate(&self) -> Result<(), AccelError> {
        validate_mesh(&self.nodes, &self.triangles)
    }

    /// Follows a deformation: vertices have moved, the triangles `indices` are those that the tree was built over. The
    /// tree keeps its shape and all boxes are computed anew from the leaves up (Wald, Boulos, Shirley 2007, "Ray Tracing
    /// Deformable Scenes Using Dynamic Bounding Volume Hierarchies"): hits are exact as ever, but rays may cost more.
    ///
    /// # Errors
    /// [`AccelError::IdCount`] for another number of triangles, [`AccelError::VertexOutOfRange`],
    /// [`AccelError::BadTriangle`]; then nothing has changed.
    pub fn refit(&mut self, positions: &[Vec3], indices: &[[u32; 3]]) -> Result<Refit, AccelError> {
        if indices.len() != self.triangles.len() {
            return Err(AccelError::IdCount { triangles: indices.len(), ids: self.triangles.len() });
        }
        let moved = |(old, &place): (&Triangle, &u32)| {
            let new = record(positions, place as usize, indices[place as usize], old.id)?;
            Ok(Triangle { material: old.material, light: old.light, ..new })
        };
        self.triangles =
            self.triangles.par_iter().zip(&self.order).map(moved).collect::<Result<_, AccelError>>()?;
        self.refit_boxes();
        self.bounds = root_bounds(&self.nodes);
        self.refits += 1;
        let floor = |root: &BvhNode| floor_cost(root, self.triangles.iter().map(bounds));
        Ok(Refit {
            cost: sah_cost(&self.nodes),
            floor: self.nodes.first().map_or(0.0, floor),
            area: self.nodes.first().map_or(0.0, half_area),
            built_cost: self.built_cost,
            built_floor: self.built_floor,
            built_area: self.built_area,
            refits: self.refits,
        })
    }

    /// Children stand behind their parents.
    fn refit_boxes(&mut self) {
        for index in (0..self.nodes.len()).rev() {
            let node = self.nodes[index];
            let union = if node.is_leaf() {
                let (first, count) = node.primitives();
                let listed = &self.triangles[first as usize..(first + count) as usize];
                listed.iter().map(bounds).fold(Aabb::empty(), |all, one| all.union(&one))
            } else {
                let first = node.first_child() as usize;
                node_bounds(&self.nodes[first]).union(&node_bounds(&self.nodes[first + 1]))
            };
            self.nodes[index] = BvhNode { lo: union.lo.into(), hi: union.hi.into(), ..node };
        }
    }
}

impl Refit {
    /// True if a tree built anew would save more than it costs, or nobody knows any more.
    pub fn is_rebuild_due(&self) -> bool {
        let has_changed = |now: f64, built: f64| now > SAME_SHAPE * built || built > SAME_SHAPE * now;
        let is_other_shape = has_changed(self.floor, self.built_floor)
            && has_changed(self.floor * self.area, self.built_floor * self.built_area);
        let is_dearer = self.cost - self.floor > REBUILD_RATIO * (self.built_cost - self.built_floor);
        is_other_shape || is_dearer || self.refits >= MAX_REFITS
    }
}

fn root_bounds(nodes: &[BvhNode]) -> Aabb<f32> {
    nodes.first().map_or_else(Aabb::empty, node_bounds)
}

fn node_bounds(node: &BvhNode) -> Aabb<f32> {
    Aabb { lo: node.lo.into(), hi: node.hi.into() }
}

fn bounds(triangle: &Triangle) -> Aabb<f32> {
    triangle::bounds::<f32>(&triangle.vertices().map(Vec3::from))
}

fn record(positions: &[Vec3], triangle: usize, indices: [u32; 3], id: u32) -> Result<Triangle, AccelError> {
    let vertex = |corner: usize| {
        let vertex = indices[corner];
        let out_of_range = AccelError::VertexOutOfRange { triangle, vertex, vertex_count: positions.len() };
        let position = *positions.get(vertex as usize).ok_or(out_of_range)?;
        let is_good = position.is_finite() && position.abs().max_element() < FAR;
        if is_good { Ok(position.to_array()) } else { Err(AccelError::BadTriangle { triangle }) }
    };
    Ok(Triangle { v0: vertex(0)?, id, v1: vertex(1)?, material: 0, v2: vertex(2)?, light: triangle as u32 })
}
