//! Meshes in the flat scene: a BVH and its triangles per mesh asset in use.
use std::sync::Arc;

use luxel_accel::{BvhOptions, build_mesh};
use luxel_flat::Span;
use luxel_geom::Aabb;
use luxel_scene::{AssetId, Assets, MeshAsset};

use crate::assets::BakedAsset;
use crate::journal::{Journal, Topic};
use crate::objects::ObjectItem;
use crate::store::Heaps;
use crate::{BakeCounters, BakeError};

/// Where a mesh stands.
#[derive(Clone, Copy, Debug)]
pub(crate) struct BuiltMesh {
    pub nodes: Span,
    pub triangles: Span,
    /// Box of the root, in the mesh's coordinates.
    pub bounds: Aabb<f32>,
}

impl BakedAsset for MeshAsset {
    const KIND: &'static str = "mesh";
    const TOPIC: Topic = Topic::Mesh;
    type Built = BuiltMesh;

    fn shown_by(object: &ObjectItem) -> Option<AssetId> {
        object.mesh.map(|instance| instance.mesh)
    }

    fn find(assets: &Assets, id: AssetId) -> Option<&Arc<Self>> {
        assets.mesh(id)
    }

    fn build(&self, heaps: &mut Heaps, journal: &mut Journal) -> Result<BuiltMesh, BakeError> {
        let mesh = &self.mesh;
        let bvh = build_mesh(&mesh.positions, &mesh.triangles, &mesh.triangle_ids, &BvhOptions::default())?;
        let revision = journal.revision();
        Ok(BuiltMesh {
            nodes: heaps.bvh_nodes.place(&bvh.nodes, revision)?,
            triangles: heaps.triangles.place(&bvh.triangles, revision)?,
            bounds: bvh.bounds,
        })
    }

    fn release(built: &BuiltMesh, heaps: &mut Heaps, journal: &mut Journal) {
        heaps.bvh_nodes.release(built.nodes, journal.revision());
        heaps.triangles.release(built.triangles, journal.revision());
    }

    fn counters(counters: &mut BakeCounters) -> (&mut u64, &mut u64) {
        (&mut counters.blas_built, &mut counters.blas_freed)
    }
}
