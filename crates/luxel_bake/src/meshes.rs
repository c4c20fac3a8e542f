//! Meshes in the flat scene: a BVH and its triangles per mesh asset in use.
//!
//! With [`MeshLevels::One`] the triangles are placed without a BVH, in the mesh's order: attributes are named by their
//! slots, and the tree over all meshes ([`joined`](crate::joined)) is built from them.
use std::sync::Arc;

use luxel_accel::{BvhOptions, MeshBvh, build_mesh, mesh_triangles};
use luxel_flat::Triangle;
use luxel_geom::{Aabb, triangle};
use luxel_scene::{AssetId, Assets, MeshAsset, MeshLevels, MeshStructure};

use crate::assets::BakedAsset;
use crate::journal::{Journal, Topic};
use crate::mesh_options::build_options;
use crate::mesh_tree::MeshTree;
use crate::objects::ObjectItem;
use crate::store::Heaps;
use crate::{BakeCounters, BakeError};

/// Where a mesh stands.
#[derive(Clone, Copy, Debug)]
pub(crate) struct BuiltMesh {
    /// In the mesh's coordinates.
    pub tree: MeshTree,
    /// The run that placed the triangles as they are: another one may have put them in another order or elsewhere.
    pub built_in: u64,
}

impl BakedAsset for MeshAsset {
    const KIND: &'static str = "mesh";
    const TOPIC: Topic = Topic::Mesh;
    type Built = BuiltMesh;
    /// How the tree of each mesh is built; `None` if it has none.
    type Settings = Option<BvhOptions>;

    fn shown_by(object: &ObjectItem) -> Option<AssetId> {
        object.mesh.map(|instance| instance.mesh)
    }

    fn find(assets: &Assets, id: AssetId) -> Option<&Arc<Self>> {
        assets.mesh(id)
    }

    fn settings(wish: &MeshStructure) -> Option<BvhOptions> {
        (wish.levels == MeshLevels::Two).then(|| build_options(wish))
    }

    fn build(
        &self,
        options: &Option<BvhOptions>,
        heaps: &mut Heaps,
        journal: &mut Journal,
    ) -> Result<BuiltMesh, BakeError> {
        let mesh = &self.mesh;
        let bvh = match options {
            Some(options) => build_mesh(&mesh.positions, &mesh.triangles, &mesh.triangle_ids, options)?,
            None => without_tree(mesh_triangles(&mesh.positions, &mesh.triangles, &mesh.triangle_ids)?),
        };
        let tree = MeshTree::place(&bvh, heaps, journal.revision())?;
        Ok(BuiltMesh { tree, built_in: journal.revision() })
    }

    /// A mesh with the same triangles in other places is a deformed one.
    fn follow(&self, old: &Self, built: &mut BuiltMesh, heaps: &mut Heaps, journal: &mut Journal) -> bool {
        let (new, old) = (&self.mesh, &old.mesh);
        if new.triangles != old.triangles || new.triangle_ids != old.triangle_ids {
            return false;
        }
        let number = |id: u32| new.triangle_ids.binary_search(&id).ok().map(|index| index as u32);
        let places = (new.positions.as_slice(), new.triangles.as_slice());
        let Some(tree) = built.tree.refitted(places, number, |_| {}, heaps, journal.revision()) else {
            return false;
        };
        // What belongs to the triangles depends on their places too: normals, tangents, lights.
        *built = BuiltMesh { tree, built_in: journal.revision() };
        journal.counters.blas_refitted += 1;
        true
    }

    fn release(built: &BuiltMesh, heaps: &mut Heaps, journal: &mut Journal) {
        built.tree.release(heaps, journal.revision());
    }

    fn counters(counters: &mut BakeCounters) -> (&mut u64, &mut u64) {
        (&mut counters.blas_built, &mut counters.blas_freed)
    }
}

/// Triangles that are only a part of another tree.
fn without_tree(triangles: Vec<Triangle>) -> MeshBvh {
    let bounds = |one: &Triangle| triangle::bounds::<f32>(&one.vertices().map(glam::Vec3::from));
    MeshBvh {
        bounds: triangles.iter().map(bounds).fold(Aabb::empty(), |all, one| all.union(&one)),
        nodes: Vec::new(),
        order: (0..triangles.len() as u32).collect(),
        triangles,
        built_cost: 0.0,
        built_floor: 0.0,
        built_area: 0.0,
        refits: 0,
    }
}
