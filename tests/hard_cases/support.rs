//! Scenes for the hard cases, beyond those of `common`.
use glam::{DAffine3, Vec3};
use luxel_accel::{BvhOptions, build_mesh, build_tlas};
use luxel_cpu::{Exclusion, Hit, traverse};
use luxel_flat::{Counters, FlatScene, Instance, KIND_MESH, MeshAccel};
use luxel_geom::{Aabb, Affine, Ray};
use luxel_testkit::TestMesh;

/// One mesh under a tree of a builder's settings, placed any number of times. The stable id of an instance is its slot.
pub(crate) fn instanced(mesh: &TestMesh, options: &BvhOptions, places: &[DAffine3]) -> FlatScene {
    let built = build_mesh(&mesh.positions, &mesh.triangles, &mesh.ids(), options).unwrap();
    built.validate().unwrap();
    let instance = |(slot, place): (usize, &DAffine3)| {
        let forward = Affine::<f32>::from_daffine(place);
        let bounds = forward.bounds(&built.bounds);
        Instance {
            kind: KIND_MESH,
            node_count: built.nodes.len() as u32,
            primitive_count: built.triangles.len() as u32,
            world_from_object: forward.to_rows(),
            object_from_world: Affine::<f32>::from_daffine(&place.inverse()).to_rows(),
            lo: bounds.lo.into(),
            hi: bounds.hi.into(),
            stable_id: slot as u32,
            ..Instance::default()
        }
    };
    let instances: Vec<Instance> = places.iter().enumerate().map(instance).collect();
    let bounds = |i: &Instance| Aabb { lo: i.lo.into(), hi: i.hi.into() };
    let boxes: Vec<_> = instances.iter().enumerate().map(|(slot, i)| (slot as u32, bounds(i))).collect();
    let tlas = build_tlas(&boxes).unwrap();
    let mut scene = FlatScene::default();
    scene.bvh_nodes.write(0, &built.nodes, 1);
    scene.triangles.write(0, &built.triangles, 1);
    scene.tlas_nodes.write(0, &tlas, 1);
    scene.params.tlas_count = tlas.len() as u32;
    scene.instances.write(0, &instances, 1);
    scene
}

/// One mesh where it is.
pub(crate) fn alone(mesh: &TestMesh, options: &BvhOptions) -> FlatScene {
    instanced(mesh, options, &[DAffine3::IDENTITY])
}

/// The closest hit, by the structures, of a ray that starts on a primitive.
pub(crate) fn trace_from(scene: &FlatScene, ray: &Ray<f32>, exclusion: &Exclusion) -> Option<Hit<f32>> {
    traverse::intersect(scene, ray, exclusion, &mut Counters::default())
}

/// The same scene, its meshes searched in another way.
pub(crate) fn searched(scene: &FlatScene, accel: MeshAccel) -> FlatScene {
    FlatScene { mesh_accel: accel, ..scene.clone() }
}

/// The box around a mesh.
pub(crate) fn bounds(mesh: &TestMesh) -> Aabb<f32> {
    let point = |p: &Vec3| Aabb { lo: *p, hi: *p };
    mesh.positions.iter().map(point).fold(Aabb::empty(), |all, p| all.union(&p))
}

#[test]
fn a_placed_mesh_is_met() {
    let mesh = luxel_testkit::closed::pbrt_ball();
    let (here, common) = (alone(&mesh, &BvhOptions::default()), crate::common::mesh_scene(&mesh));
    let ray: Ray<f32> = Ray::new(Vec3::ZERO, Vec3::new(0.3, 0.5, 0.8));
    let hit = crate::common::trace(&here, &ray);
    assert!(hit.is_some());
    assert_eq!(hit, crate::common::trace(&common, &ray));
}
