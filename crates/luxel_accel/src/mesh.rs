//! The tree of a triangle mesh, and its triangles in leaf order.
use glam::Vec3;
use luxel_flat::{BvhNode, FAR, Triangle};
use luxel_geom::{Aabb, triangle};
use rayon::prelude::*;

use crate::bvh::validate_tree;
use crate::{AccelError, BvhOptions, build_bvh};

/// A mesh ready to be placed in the flat scene.
#[derive(Clone, Debug, PartialEq)]
pub struct MeshBvh {
    /// Nodes, the root first; a leaf's primitives are consecutive `triangles`.
    pub nodes: Vec<BvhNode>,
    /// Triangles in leaf order, with material 0.
    pub triangles: Vec<Triangle>,
    /// The root's box in the mesh's coordinates; empty without triangles.
    pub bounds: Aabb<f32>,
}

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
    if triangles.len() != ids.len() {
        return Err(AccelError::IdCount { triangles: triangles.len(), ids: ids.len() });
    }
    let records = (triangles.par_iter().zip(ids).enumerate())
        .map(|(triangle, (indices, &id))| record(positions, triangle, *indices, id))
        .collect::<Result<Vec<Triangle>, AccelError>>()?;
    let boxes: Vec<Aabb<f32>> = records.par_iter().map(bounds).collect();
    let bvh = build_bvh(&boxes, options)?;
    Ok(MeshBvh {
        bounds: bvh.nodes.first().map_or_else(Aabb::empty, |n| Aabb { lo: n.lo.into(), hi: n.hi.into() }),
        triangles: bvh.order.par_iter().map(|&index| records[index as usize]).collect(),
        nodes: bvh.nodes,
    })
}

impl MeshBvh {
    /// Checks the tree against its triangles; see [`Bvh`](crate::Bvh).
    ///
    /// # Errors
    /// [`AccelError::Broken`] with the first node at fault.
    pub fn validate(&self) -> Result<(), AccelError> {
        validate_tree(&self.nodes, self.triangles.len(), |index| {
            self.triangles.get(index as usize).map(bounds)
        })
    }
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
    Ok(Triangle { v0: vertex(0)?, id, v1: vertex(1)?, material: 0, v2: vertex(2)?, reserved: 0 })
}
