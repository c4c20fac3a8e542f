//! Meshes in the flat scene: a BVH and its triangles per mesh asset in use.
use std::sync::Arc;

use luxel_accel::{BvhOptions, build_mesh};
use luxel_flat::Span;
use luxel_geom::Aabb;
use luxel_scene::{AssetId, Assets, MeshAsset, MeshStructure};

use crate::assets::BakedAsset;
use crate::journal::{Journal, Topic};
use crate::mesh_options::build_options;
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
    /// The run that built it: another one may have put the triangles in another order.
    pub built_in: u64,
}

impl BakedAsset for MeshAsset {
    const KIND: &'static str = "mesh";
    const TOPIC: Topic = Topic::Mesh;
    type Built = BuiltMesh;
    type Settings = BvhOptions;

    fn shown_by(object: &ObjectItem) -> Option<AssetId> {
        object.mesh.map(|instance| instance.mesh)
    }

    fn find(assets: &Assets, id: AssetId) -> Option<&Arc<Self>> {
        assets.mesh(id)
    }

    fn settings(wish: &MeshStructure) -> BvhOptions {
        build_options(wish)
    }

    fn build(
        &self,
        options: &BvhOptions,
        heaps: &mut Heaps,
        journal: &mut Journal,
    ) -> Result<BuiltMesh, BakeError> {
        let mesh = &self.mesh;
        let bvh = build_mesh(&mesh.positions, &mesh.triangles, &mesh.triangle_ids, options)?;
        let revision = journal.revision();
        Ok(BuiltMesh {
            nodes: heaps.bvh_nodes.place(&bvh.nodes, revision)?,
            triangles: heaps.triangles.place(&bvh.triangles, revision)?,
            bounds: bvh.bounds,
            built_in: revision,
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
