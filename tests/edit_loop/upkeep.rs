//! What edits may leave behind (E01): no memory that nothing needs, and no trees that rays pay for.
use std::fmt;
use std::sync::Arc;

use luxel_accel::{build_mesh, sah_cost};
use luxel_bake::build_options;
use luxel_cpu::{Exclusion, first_hit, traverse};
use luxel_flat::{Counters, FlatScene, Instance, KIND_MESH, Triangle};
use luxel_geom::Ray;
use luxel_scene::MeshStructure;
use rayon::prelude::*;

/// Most memory after the edits, in parts of what a fresh bake needs; and most at any time, in parts of what a fresh bake of
/// all that may be there at once needs (robustness.md).
const MOST_MEMORY: f64 = 1.1;
/// Most that a mesh's tree or the rays may cost, in parts of a fresh build's or bake's (robustness.md).
const MOST_COST: f64 = 1.5;
/// The scene under edits, and what was seen of its upkeep on the way.
pub(crate) struct Run {
    pub(crate) scene: Arc<FlatScene>,
    /// The most of [`kept_bytes`] after any edit.
    peak: usize,
    /// The largest ratio of [`worst_tree`] so far.
    worst_tree: f64,
}

impl Run {
    pub(crate) fn of(scene: Arc<FlatScene>) -> Self {
        Self { scene, peak: 0, worst_tree: 0.0 }
    }

    /// The scene after another edit.
    pub(crate) fn go_on(&mut self, scene: Arc<FlatScene>) {
        self.peak = self.peak.max(kept_bytes(&scene));
        self.scene = scene;
    }

    pub(crate) fn look_at_trees(&mut self) {
        self.worst_tree = self.worst_tree.max(worst_tree(&self.scene));
    }
}

/// What edits left behind, in parts of what a scene without a history has.
pub(crate) struct Upkeep {
    memory: f64,
    peak: f64,
    tree: f64,
    steps: f64,
}

impl Upkeep {
    /// Against a fresh bake of the same world, and one of a world that is full.
    pub(crate) fn measure(run: &Run, fresh: &FlatScene, full: &FlatScene, rays: &[Ray<f32>]) -> Self {
        let ratio = |a: u64, b: u64| a as f64 / b as f64;
        Self {
            memory: ratio(bytes(&run.scene) as u64, bytes(fresh) as u64),
            peak: ratio(run.peak as u64, kept_bytes(full) as u64),
            tree: run.worst_tree,
            steps: ratio(steps(&run.scene, rays), steps(fresh, rays)),
        }
    }

    pub(crate) fn check(&self) {
        assert!(self.memory <= MOST_MEMORY && self.peak <= MOST_MEMORY, "{self}");
        assert!(self.tree <= MOST_COST && self.steps <= MOST_COST, "{self}");
    }
}

impl fmt::Display for Upkeep {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            f,
            "memory {:.3} of a fresh bake's, its peak {:.3} of a full world's, ",
            self.memory, self.peak
        )?;
        write!(f, "worst tree {:.3} of a fresh one's cost, rays {:.3} of the steps", self.tree, self.steps)
    }
}

/// Bytes of all arrays of a scene that an edit can change.
fn bytes(scene: &FlatScene) -> usize {
    kept_bytes(scene) + scene.lights.bytes() + scene.light_nodes.bytes()
}

/// Bytes of the arrays that live on from edit to edit, with holes where something was: all but the table of lights, which is
/// made anew from what shines.
fn kept_bytes(scene: &FlatScene) -> usize {
    let structures = [
        scene.instances.bytes(),
        scene.tlas_nodes.bytes(),
        scene.bvh_nodes.bytes(),
        scene.triangles.bytes(),
        scene.svo_nodes.bytes(),
        scene.spheres.bytes(),
        scene.octree_nodes.bytes(),
        scene.sphere_nodes.bytes(),
        scene.leaf_spheres.bytes(),
    ];
    structures.iter().sum::<usize>() + scene.materials.bytes()
}

/// The largest cost, by the surface area heuristic, of a mesh's tree in parts of one built over the same triangles.
fn worst_tree(scene: &FlatScene) -> f64 {
    let meshes = scene.instances.as_slice().iter().filter(|i| i.kind == KIND_MESH && i.node_count > 0);
    let mut trees: Vec<&Instance> = meshes.collect();
    trees.sort_unstable_by_key(|mesh| mesh.node_first);
    trees.dedup_by_key(|mesh| mesh.node_first);
    trees.par_iter().map(|mesh| tree_ratio(scene, mesh)).reduce(|| 0.0, f64::max)
}

fn tree_ratio(scene: &FlatScene, mesh: &Instance) -> f64 {
    let range = |first: u32, count: u32| first as usize..(first + count) as usize;
    let nodes = &scene.bvh_nodes.as_slice()[range(mesh.node_first, mesh.node_count)];
    let triangles = &scene.triangles.as_slice()[range(mesh.primitive_first, mesh.primitive_count)];
    sah_cost(nodes) / fresh_cost(triangles)
}

fn fresh_cost(triangles: &[Triangle]) -> f64 {
    let corners: Vec<_> = triangles.iter().flat_map(|t| t.vertices().map(glam::Vec3::from)).collect();
    let ids: Vec<u32> = (0..triangles.len() as u32).collect();
    let indices: Vec<_> = ids.iter().map(|k| [3 * k, 3 * k + 1, 3 * k + 2]).collect();
    let options = build_options(&MeshStructure::default());
    build_mesh(&corners, &indices, &ids, &options).unwrap().built_cost
}

/// Nodes visited and primitives tested by rays.
fn steps(scene: &FlatScene, rays: &[Ray<f32>]) -> u64 {
    let steps = |ray: &Ray<f32>| {
        let mut counters = Counters::default();
        traverse::intersect(scene, ray, &Exclusion::NOTHING, &mut counters);
        u64::from(first_hit::steps(&Counters::default(), &counters))
    };
    rays.par_iter().map(steps).sum()
}
