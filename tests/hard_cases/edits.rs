//! E03, E04: objects that come back, and trees that follow a deformation.
use glam::{DVec3, Vec3};
use luxel_accel::{BvhOptions, build_mesh};
use luxel_bake::Baker;
use luxel_cpu::naive::Naive;
use luxel_cpu::{Exclusion, Hit};
use luxel_flat::FlatScene;
use luxel_geom::Ray;
use luxel_scene::{
    ActiveCamera, Assets, Camera, Material, MeshAsset, MeshInstance, MeshSource, Transform, empty_world,
    spawn,
};
use luxel_testkit::{Random, TestMesh, meshes};

use crate::common::{bits, trace};
use crate::many::tally;
use crate::support::{alone, bounds};
use crate::table::Case;

#[test]
fn e03_an_object_that_goes_and_comes_back_is_where_it_was() {
    let case = Case::begin("E03");
    let mut world = empty_world();
    spawn(&mut world, (Camera::default(), ActiveCamera, Transform::at(DVec3::Z * 10.0)));
    let mesh = world.resource_mut::<Assets>().insert_mesh(MeshAsset::from_source(MeshSource::Cube).unwrap());
    let home = DVec3::new(0.1, 1.0 / 3.0, -0.7);
    let cube = spawn(&mut world, (MeshInstance { mesh }, Transform::at(home), Material::default()));
    let mut baker = Baker::new(&mut world).unwrap();
    let text = |scene: &FlatScene| format!("{:?} {:?}", scene.instances.as_slice(), scene.tlas());
    let before = text(&baker.run(&mut world).unwrap());
    for round in 0..case.size() {
        for place in [DVec3::new(1e6, -1e6, round as f64), home] {
            world.get_mut::<Transform>(cube).unwrap().translation = place;
            let after = text(&baker.run(&mut world).unwrap());
            assert_eq!(after == before, place == home, "round {round}");
        }
    }
    let size = case.size();
    case.end(format_args!("{size} times to 1e6 and back"));
}

/// A mesh whose vertices are moved by up to `amplitude` times its size.
fn deformed(mesh: &TestMesh, amplitude: f32, seed: u32) -> TestMesh {
    let mut random = Random::new(seed);
    let reach = amplitude * bounds(mesh).extent().max_element();
    let positions = mesh.positions.iter().map(|p| *p + random.point(reach)).collect();
    TestMesh { positions, triangles: mesh.triangles.clone() }
}

#[test]
fn e04_a_refitted_tree_finds_what_every_triangle_tested_finds() {
    let case = Case::begin("E04");
    let mesh = meshes::bumpy_sphere(20, 30);
    for (seed, amplitude) in [0.01, 1.0, 100.0].into_iter().enumerate() {
        let other = deformed(&mesh, amplitude, seed as u32);
        let ids = mesh.ids();
        let mut built = build_mesh(&mesh.positions, &mesh.triangles, &ids, &BvhOptions::MEDIUM).unwrap();
        built.refit(&other.positions, &other.triangles).unwrap();
        built.validate().unwrap();
        // The instance and the TLAS are those of a fresh build; the tree and the triangles' order are the refitted ones.
        let mut scene = alone(&other, &BvhOptions::MEDIUM);
        let mut instance = scene.instances.as_slice()[0];
        scene.bvh_nodes = Default::default();
        scene.bvh_nodes.write(0, &built.nodes, 1);
        scene.triangles.write(0, &built.triangles, 2);
        instance.node_count = built.nodes.len() as u32;
        scene.instances.write(0, &[instance], 2);
        let [wrong, hits] = compare(&scene, bounds(&other).extent().max_element(), case.size() / 3);
        assert!(wrong == 0 && hits > case.size() / 100, "{amplitude}: {wrong} wrong, {hits} hits");
    }
    let size = case.size();
    case.end(format_args!("{size} rays at meshes deformed by up to 100 times their size"));
}

/// Rays whose hits differ from exhaustive search, and hits.
fn compare(scene: &FlatScene, reach: f32, rays: u64) -> [u64; 2] {
    let naive = Naive::new(scene);
    tally(4, rays, |random| {
        let origin: Vec3 = random.point(0.7 * reach);
        let ray: Ray<f32> = Ray::new(origin, random.point(0.4 * reach) - origin);
        let exact: Option<Hit<f32>> = naive.intersect(&ray, &Exclusion::NOTHING);
        [u64::from(bits(&trace(scene, &ray)) != bits(&exact)), u64::from(exact.is_some())]
    })
}
