//! What is known of the meshes of measured frames: their trees, and the time that it takes to build them.
use std::collections::BTreeMap;
use std::time::Instant;

use glam::Vec3;
use luxel_accel::{build_mesh, sah_cost};
use luxel_bake::build_options;
use luxel_flat::{BvhNode, Instance, KIND_MESH, Span, Triangle};
use luxel_scene::MeshStructure;

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
        let nodes = self.scene.bvh_nodes.as_slice();
        let largest = self.trees().max_by_key(|mesh| mesh.primitive_count);
        let tree = largest.and_then(|mesh| {
            let first = mesh.node_first as usize;
            nodes.get(first..first + mesh.node_count as usize)
        });
        let tree = tree.unwrap_or_default();
        let count = |of: fn(&Instance) -> u32| self.trees().map(|mesh| u64::from(of(mesh))).sum();
        let (all_nodes, all_triangles): (u64, u64) = (count(|m| m.node_count), count(|m| m.primitive_count));
        let size = |bytes: usize| bytes as u64;
        MeshTreeFacts {
            triangles: self.engine.bake_report().instanced_triangles,
            nodes: all_nodes,
            bytes: all_nodes * size(size_of::<BvhNode>()) + all_triangles * size(size_of::<Triangle>()),
            depth: luxel_accel::depth(tree),
            sah_cost: sah_cost(tree),
        }
    }

    /// One instance for each tree in the picture.
    fn trees(&self) -> impl Iterator<Item = &Instance> {
        let instances = self.scene.instances.as_slice().iter();
        let meshes = instances.filter(|i| i.kind == KIND_MESH && i.node_count > 0);
        meshes.map(|mesh| (mesh.node_first, mesh)).collect::<BTreeMap<u32, &Instance>>().into_values()
    }

    /// Seconds that the trees alone take to be built over the meshes of the scene.
    ///
    /// # Errors
    /// When one cannot be built.
    pub fn mesh_build_secs(&self) -> Result<f64, EngineError> {
        let options = build_options(self.engine.world.resource::<MeshStructure>());
        let meshes: Vec<Input> = self.trees().map(|tree| self.input_of(tree)).collect();
        let start = Instant::now();
        for Input { positions, triangles, ids } in &meshes {
            let built = build_mesh(positions, triangles, ids, &options);
            built.map_err(|error| EngineError::Setting(format!("a BVH cannot be built: {error}")))?;
        }
        Ok(start.elapsed().as_secs_f64())
    }

    /// What a tree was built over, in its order there.
    fn input_of(&self, tree: &Instance) -> Input {
        let span = Span { first: tree.primitive_first, count: tree.primitive_count };
        let mut listed = self.scene.triangles.as_slice().get(span.range()).unwrap_or_default().to_vec();
        listed.sort_unstable_by_key(|triangle| triangle.id);
        Input {
            positions: listed.iter().flat_map(|triangle| triangle.vertices().map(Vec3::from)).collect(),
            triangles: (0..span.count).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect(),
            ids: listed.iter().map(|triangle| triangle.id).collect(),
        }
    }
}

/// Triangles as builders take them; each has corners of its own.
struct Input {
    positions: Vec<Vec3>,
    triangles: Vec<[u32; 3]>,
    ids: Vec<u32>,
}
