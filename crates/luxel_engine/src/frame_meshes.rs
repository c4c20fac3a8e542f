//! What is known of the meshes of measured frames: their trees, and the time that it takes to build them.
use std::collections::BTreeSet;
use std::time::Instant;

use luxel_accel::{build_mesh, sah_cost};
use luxel_bake::build_options;
use luxel_flat::KIND_MESH;
use luxel_scene::{AssetId, Assets, MeshStructure};

use crate::{EngineError, FrameStage};

/// Facts about the trees over the triangles of a scene.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct MeshTreeFacts {
    /// Triangles in the picture, each instance counted.
    pub triangles: u64,
    /// Nodes of all trees.
    pub nodes: u64,
    /// Bytes of nodes and triangles.
    pub bytes: u64,
    /// Deepest level of the tree of the largest mesh.
    pub depth: u32,
    /// Cost of that tree by the surface area heuristic, a node and a triangle test costing 1 each.
    pub sah_cost: f64,
}

impl FrameStage {
    /// Facts about the trees that the scene has now.
    pub fn mesh_trees(&self) -> MeshTreeFacts {
        let report = self.engine.bake_report();
        let nodes = self.scene.bvh_nodes.as_slice();
        let meshes =
            self.scene.instances.as_slice().iter().filter(|i| i.kind == KIND_MESH && i.node_count > 0);
        let largest = meshes.max_by_key(|mesh| mesh.primitive_count);
        let tree = largest.and_then(|mesh| {
            let first = mesh.node_first as usize;
            nodes.get(first..first + mesh.node_count as usize)
        });
        let tree = tree.unwrap_or_default();
        let count =
            |of: fn(&luxel_bake::MeshFacts) -> u32| report.meshes.iter().map(|m| u64::from(of(m))).sum();
        let (all_nodes, all_triangles): (u64, u64) = (count(|m| m.nodes), count(|m| m.triangles));
        let size = |bytes: usize| bytes as u64;
        MeshTreeFacts {
            triangles: report.instanced_triangles,
            nodes: all_nodes,
            bytes: all_nodes * size(size_of::<luxel_flat::BvhNode>())
                + all_triangles * size(size_of::<luxel_flat::Triangle>()),
            depth: luxel_accel::depth(tree),
            sah_cost: sah_cost(tree),
        }
    }

    /// Seconds that the trees alone take to be built over the meshes of the scene.
    ///
    /// # Errors
    /// When one cannot be built.
    pub fn mesh_build_secs(&self) -> Result<f64, EngineError> {
        let world = &self.engine.world;
        let options = build_options(world.resource::<MeshStructure>());
        let assets = world.resource::<Assets>();
        let in_use: BTreeSet<u32> = self.engine.bake_report().meshes.iter().map(|mesh| mesh.asset).collect();
        let start = Instant::now();
        for mesh in in_use.into_iter().filter_map(|id| assets.mesh(AssetId(id))) {
            let mesh = &mesh.mesh;
            let built = build_mesh(&mesh.positions, &mesh.triangles, &mesh.triangle_ids, &options);
            built.map_err(|error| EngineError::Setting(format!("a BVH cannot be built: {error}")))?;
        }
        Ok(start.elapsed().as_secs_f64())
    }
}
