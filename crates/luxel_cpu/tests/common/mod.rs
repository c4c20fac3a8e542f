//! Flat scenes made straight from the builders, and the standing oracle: accelerated equals naive, bit for bit.
#![allow(dead_code, reason = "each test binary uses its own part")]
pub(crate) mod clouds;

use glam::{DAffine3, UVec3, Vec3};
use luxel_accel::{
    BvhOptions, RootCell, SphereOptions, SphereStructure, Svo, SvoVoxel, build_mesh, build_svo, build_tlas,
};
use luxel_cpu::naive::Naive;
use luxel_cpu::{Exclusion, Hit, traverse};
use luxel_flat::{
    Counters, FlatScene, Instance, KIND_MESH, KIND_SPHERES, KIND_VOXELS, MESH_ACCELS, MeshAccel, SphereRecord,
};
use luxel_geom::{Aabb, Affine, Ray, Real};
use luxel_testkit::TestMesh;
use rayon::prelude::*;

/// A scene under construction. Instances get the stable ids 0, 1, 2, … in the order of adding.
#[derive(Default)]
pub(crate) struct SceneBuilder {
    flat: FlatScene,
    instances: Vec<Instance>,
}

impl SceneBuilder {
    /// Adds a mesh; the primitive ids are `ids`.
    pub(crate) fn mesh_with_ids(mut self, mesh: &TestMesh, ids: &[u32], world_from_object: DAffine3) -> Self {
        let built = build_mesh(&mesh.positions, &mesh.triangles, ids, &BvhOptions::default()).unwrap();
        built.validate().unwrap();
        let instance = Instance {
            kind: KIND_MESH,
            node_first: self.flat.bvh_nodes.len() as u32,
            node_count: built.nodes.len() as u32,
            primitive_first: self.flat.triangles.len() as u32,
            primitive_count: built.triangles.len() as u32,
            ..Instance::default()
        };
        self.flat.bvh_nodes.write(self.flat.bvh_nodes.len(), &built.nodes, 1);
        self.flat.triangles.write(self.flat.triangles.len(), &built.triangles, 1);
        self.place(instance, world_from_object, &built.bounds)
    }

    /// Adds a mesh whose primitive ids are positions.
    pub(crate) fn mesh(self, mesh: &TestMesh, world_from_object: DAffine3) -> Self {
        self.mesh_with_ids(mesh, &mesh.ids(), world_from_object)
    }

    /// Adds the sphere cloud, spheres in slots 0, 1, 2, …, under the default structure.
    pub(crate) fn spheres(self, root: RootCell, spheres: &[SphereRecord]) -> Self {
        let in_slots: Vec<_> = (0..).zip(spheres.iter().copied()).collect();
        self.cloud(&SphereStructure::build(SphereOptions::default(), root, &in_slots, 1).unwrap())
    }

    /// Adds the sphere cloud as its structure has it.
    pub(crate) fn cloud(mut self, structure: &SphereStructure) -> Self {
        structure.validate().unwrap();
        self.flat.sphere_accel = structure.options().accel;
        self.flat.spheres = structure.spheres().clone();
        self.flat.octree_nodes = structure.octree_nodes().clone();
        self.flat.sphere_nodes = structure.sphere_nodes().clone();
        self.flat.leaf_spheres = structure.leaf_spheres().clone();
        let instance = Instance {
            kind: KIND_SPHERES,
            node_count: structure.node_count(),
            primitive_count: structure.spheres().len() as u32,
            ..Instance::default()
        };
        self.place(instance, DAffine3::IDENTITY, &structure.bounds())
    }

    /// Adds a voxel volume.
    pub(crate) fn volume(mut self, svo: &Svo, world_from_object: DAffine3) -> Self {
        svo.validate().unwrap();
        let instance = Instance {
            kind: KIND_VOXELS,
            node_first: self.flat.svo_nodes.len() as u32,
            node_count: svo.nodes.len() as u32,
            levels: svo.levels,
            ..Instance::default()
        };
        self.flat.svo_nodes.write(self.flat.svo_nodes.len(), &svo.nodes, 1);
        self.flat.svo_colors.write(self.flat.svo_colors.len(), &svo.colors, 1);
        self.place(instance, world_from_object, &svo.bounds)
    }

    /// The scene with its TLAS; instances without nodes are free slots.
    pub(crate) fn build(mut self) -> FlatScene {
        let live = self.instances.iter().enumerate().filter(|(_, i)| i.node_count > 0);
        let bounds = |i: &Instance| Aabb { lo: i.lo.into(), hi: i.hi.into() };
        let boxes: Vec<_> = live.map(|(slot, i)| (slot as u32, bounds(i))).collect();
        let tlas = build_tlas(&boxes).unwrap();
        self.flat.params.tlas_first = self.flat.bvh_nodes.len() as u32;
        self.flat.params.tlas_count = tlas.len() as u32;
        self.flat.tlas_nodes.write(0, &tlas, 1);
        self.flat.instances.write(0, &self.instances, 1);
        self.flat
    }

    fn place(mut self, instance: Instance, world_from_object: DAffine3, bounds: &Aabb<f32>) -> Self {
        let forward = Affine::<f32>::from_daffine(&world_from_object);
        let bounds = forward.bounds(bounds);
        self.instances.push(Instance {
            world_from_object: forward.to_rows(),
            object_from_world: Affine::<f32>::from_daffine(&world_from_object.inverse()).to_rows(),
            lo: bounds.lo.into(),
            hi: bounds.hi.into(),
            stable_id: self.instances.len() as u32,
            ..instance
        });
        self
    }
}

/// A scene of one mesh.
pub(crate) fn mesh_scene(mesh: &TestMesh) -> FlatScene {
    SceneBuilder::default().mesh(mesh, DAffine3::IDENTITY).build()
}

/// A scene of spheres; the root cell is centred at the origin.
pub(crate) fn sphere_scene(half_extent: f32, spheres: &[SphereRecord]) -> FlatScene {
    SceneBuilder::default().spheres(RootCell { center: Vec3::ZERO, half_extent }, spheres).build()
}

/// A scene of one volume of `edge³` cells, its lowest corner at `corner`.
pub(crate) fn volume_scene(edge: u32, voxels: &[SvoVoxel], corner: Vec3) -> FlatScene {
    let svo = build_svo(voxels, UVec3::splat(edge)).unwrap();
    SceneBuilder::default().volume(&svo, DAffine3::from_translation(corner.as_dvec3())).build()
}

/// The closest hit by the structures.
pub(crate) fn trace<R: Real>(scene: &FlatScene, ray: &Ray<R>) -> Option<Hit<R>> {
    traverse::intersect(scene, ray, &Exclusion::NOTHING, &mut Counters::default())
}

/// Asserts that structures and exhaustive search return the same bits, and returns the number of hits.
#[track_caller]
pub(crate) fn assert_equals_naive(scene: &FlatScene, rays: &[Ray<f32>]) -> usize {
    assert_equals_naive_excluding(scene, rays, |_| Exclusion::NOTHING)
}

/// The same, each ray with an exclusion.
#[track_caller]
pub(crate) fn assert_equals_naive_excluding(
    scene: &FlatScene,
    rays: &[Ray<f32>],
    exclusion: impl Fn(usize) -> Exclusion + Sync,
) -> usize {
    let differences = differences(scene, rays, exclusion);
    let some = &differences[..differences.len().min(3)];
    assert!(some.is_empty(), "{} of {} rays differ: {}", differences.len(), rays.len(), some.join("\n"));
    rays.par_iter().filter(|ray| trace(scene, ray).is_some()).count()
}

/// A text for each ray for which exhaustive search and one of the ways through meshes differ in any bit, or for which
/// whether there is any hit is not answered as the closest one is.
pub(crate) fn differences(
    scene: &FlatScene,
    rays: &[Ray<f32>],
    exclusion: impl Fn(usize) -> Exclusion + Sync,
) -> Vec<String> {
    let naive = Naive::new(scene);
    let ways: Vec<FlatScene> = ways(scene).collect();
    let compare = |(i, ray): (usize, &Ray<f32>)| {
        let slow = naive.intersect(ray, &exclusion(i));
        let differs = |way: &&FlatScene| {
            let mut counters = Counters::default();
            let fast = traverse::intersect(way, ray, &exclusion(i), &mut counters);
            let any = traverse::occluded(way, ray, &exclusion(i), &mut counters);
            bits(&fast) != bits(&slow) || any != slow.is_some()
        };
        let wrong = ways.iter().find(differs)?;
        let fast = traverse::intersect(wrong, ray, &exclusion(i), &mut Counters::default());
        Some(format!("{}, ray {i}: {ray:?}\n  fast {fast:?}\n  naive {slow:?}", wrong.mesh_accel.name()))
    };
    rays.par_iter().enumerate().filter_map(compare).collect()
}

/// The scene under every way through meshes; not triangle by triangle where that would take too long.
fn ways(scene: &FlatScene) -> impl Iterator<Item = FlatScene> {
    let is_small = scene.triangles.len() <= 10_000;
    let ways = MESH_ACCELS.iter().filter(move |row| is_small || row.accel != MeshAccel::Naive);
    ways.map(|row| FlatScene { mesh_accel: row.accel, ..scene.clone() })
}

/// Everything that a hit says, as bits.
pub(crate) fn bits(hit: &Option<Hit<f32>>) -> Option<[u32; 8]> {
    hit.map(|h| {
        let on = h.on;
        assert!(on.t.is_finite() && on.uv.iter().all(|x| x.is_finite()), "{h:?}");
        let [u, v] = on.uv.map(f32::to_bits);
        [h.instance, h.instance_id, on.t.to_bits(), u, v, on.slot, on.primitive, on.material]
    })
}
