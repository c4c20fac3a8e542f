//! A driver that ends long loops (Mesa's software driver: after 65,535 turns of a thread's loops, each later loop makes
//! one) must be found out, wherever in a search it does so: a wrong answer is never given without a count.
//!
//! For each structure there are searches of every length around that limit, which meet their target last: boxes nested
//! like shells, with a ray through so many of their corners as the length asks for, or lists that are made shorter.
use std::collections::HashMap;

use glam::{DAffine3, DVec3, UVec3, Vec3};
use luxel_accel::{BvhOptions, SphereOptions, SvoVoxel, build_mesh, build_svo, build_tlas};
use luxel_flat::{
    Counter, Feature, FeatureSet, FlatScene, Heap, Instance, KIND_MESH, KIND_VOXELS, MaterialRecord,
    SceneParams, SphereAccel, SphereRecord,
};
use luxel_geom::{Aabb, Affine, Ray};
use luxel_gpu::testing::gpu_or_fail;
use luxel_render::{GpuHit, RayShooter};
use luxel_testkit::{Random, TestMesh, spheres};

use crate::scene::scene_with;

/// Lengths of searches, from 0.
const LENGTHS: u32 = 1 << 13;
/// How many lengths around the limit are looked at, on either side.
const AROUND: u32 = 24;

/// What became of one search.
#[derive(Clone, Copy)]
struct Outcome {
    is_right: bool,
    is_counted: bool,
}

/// Searches of every length: the longest must be cut by a driver that cuts, and wherever the cut falls it is counted.
/// Returns the number of wrong answers that were looked at.
#[track_caller]
fn assert_cuts_are_counted(name: &str, mut search: impl FnMut(u32) -> Outcome) -> usize {
    let mut known = HashMap::new();
    let mut at = |length: u32| *known.entry(length).or_insert_with(|| search(length));
    assert!(at(0).is_right && !at(0).is_counted, "{name}: the shortest search");
    let is_cut = |outcome: Outcome| outcome.is_counted || !outcome.is_right;
    if !is_cut(at(LENGTHS - 1)) {
        println!("{name}: this driver cuts nothing");
        return 0;
    }
    let (mut whole, mut cut) = (0, LENGTHS - 1);
    while cut - whole > 1 {
        let middle = u32::midpoint(whole, cut);
        *(if is_cut(at(middle)) { &mut cut } else { &mut whole }) = middle;
    }
    let near = cut.saturating_sub(AROUND)..(cut + AROUND).min(LENGTHS);
    let beyond = (cut..LENGTHS).step_by(LENGTHS as usize / 16);
    let mut wrong = 0;
    for length in near.chain(beyond) {
        let outcome = at(length);
        assert!(
            outcome.is_right || outcome.is_counted,
            "{name}: a wrong answer at length {length}, uncounted"
        );
        wrong += usize::from(!outcome.is_right);
    }
    println!("{name}: cut from length {cut} on, {wrong} wrong answers, all counted");
    assert!(wrong > 0, "{name}: no search met its target last");
    wrong
}

/// Shoots one ray; `is_target` tells the right answer.
fn shoot(
    shooter: &mut RayShooter,
    scene: &FlatScene,
    ray: Ray<f32>,
    is_target: impl Fn(&GpuHit) -> bool,
) -> Outcome {
    let shot = shooter.shoot(scene, &[ray]).unwrap();
    Outcome { is_right: is_target(&shot.hits[0]), is_counted: shot.counters[Counter::TraversalCaps] > 0 }
}

/// A ray along z through the corners of more and more shells, the longer the search is to be.
fn through_corners(length: u32) -> Ray<f32> {
    let x = 1.34 - 0.37 * length as f32 / LENGTHS as f32;
    Ray::new(Vec3::new(x, x, -5.0), Vec3::Z)
}

/// Sizes of shells from 1 to 1.3.
fn shells(count: u32) -> impl Iterator<Item = (u32, f32)> {
    (0..count).map(move |i| (i, 1.0 + 0.3 * i as f32 / count as f32))
}

/// Spheres around nearly one centre, and far behind them the target, numbered `count`; it comes last in a list with
/// others that are hit farther away.
fn sphere_shells(count: u32) -> Vec<SphereRecord> {
    let mut random = Random::new(1);
    let mut all: Vec<_> =
        shells(count).map(|(id, radius)| spheres::sphere(random.point(0.01), radius, id)).collect();
    let behind = |i: u32| spheres::sphere(Vec3::new(1.15, 1.15, 10.0 + 0.01 * i as f32), 1.0, count + i);
    all.extend((0..4).rev().map(behind));
    all
}

#[test]
fn in_naive() {
    let Some(gpu) = gpu_or_fail() else { return };
    let mut shooter = RayShooter::new(&gpu);
    assert_cuts_are_counted("naive", |length| {
        let target = 62_000 + length;
        let all = sphere_shells(target);
        let options = SphereOptions { accel: SphereAccel::Naive, ..SphereOptions::default() };
        let ray = through_corners(LENGTHS - 1);
        shoot(&mut shooter, &scene_with(options, &all, 1), ray, |hit| hit.primitive == target)
    });
}

#[test]
fn in_the_bvh() {
    let Some(gpu) = gpu_or_fail() else { return };
    let mut shooter = RayShooter::new(&gpu);
    let count = 60_000;
    let options = SphereOptions { accel: SphereAccel::Bvh, ..SphereOptions::default() };
    let scene = scene_with(options, &sphere_shells(count), 1);
    assert_cuts_are_counted("bvh", |length| {
        shoot(&mut shooter, &scene, through_corners(length), |hit| hit.primitive == count)
    });
}

/// Octrees whose longest list of spheres is made shorter.
fn in_an_octree(accel: SphereAccel, max_depth: u32, count: u32) {
    let Some(gpu) = gpu_or_fail() else { return };
    let mut shooter = RayShooter::new(&gpu);
    let ray = through_corners(LENGTHS - 1);
    let options = SphereOptions { accel, max_depth, min_spheres: 8 };
    let scene = scene_with(options, &sphere_shells(count), 1);
    let nodes = scene.octree_nodes.as_slice();
    let meets =
        |i: &usize| (0..2).all(|axis| (nodes[*i].lo[axis]..=nodes[*i].hi[axis]).contains(&ray.origin[axis]));
    let longest = (0..nodes.len()).filter(meets).max_by_key(|i| nodes[*i].sphere_count).unwrap();
    assert!(nodes[longest].sphere_count > LENGTHS);
    let name = format!("{}, at most {max_depth} deep", accel.name());
    assert_cuts_are_counted(&name, |length| {
        let mut shorter = scene.clone();
        shorter.octree_nodes.get_mut(longest, 1).sphere_count -= LENGTHS - length;
        shoot(&mut shooter, &shorter, ray, |hit| hit.primitive == count)
    });
}

#[test]
fn in_the_octree() {
    in_an_octree(SphereAccel::Octree, 2, 69_000);
    in_an_octree(SphereAccel::Octree, 20, 69_000);
}

#[test]
fn in_the_octree_of_cells() {
    in_an_octree(SphereAccel::OctreeBase, 1, 68_000);
    in_an_octree(SphereAccel::OctreeBase, 2, 68_000);
}

#[test]
fn in_a_mesh() {
    let Some(gpu) = gpu_or_fail() else { return };
    let mut shooter = RayShooter::new(&gpu);
    let count = 60_000;
    let mut random = Random::new(2);
    let mut triangles: Vec<[Vec3; 3]> =
        shells(count).map(|(_, size)| corner_of(size, 0.01 * random.uniform())).collect();
    triangles.push(corner_of(4.0, 10.0));
    let mesh = Parts::mesh(&TestMesh::from_triangles(triangles));
    let scene = mesh.place([DAffine3::IDENTITY]);
    assert_cuts_are_counted("mesh", |length| {
        shoot(&mut shooter, &scene, through_corners(length), |hit| hit.primitive == count)
    });
}

/// A triangle with its right angle at the z axis.
fn corner_of(size: f32, z: f32) -> [Vec3; 3] {
    [Vec3::new(0.0, 0.0, z), Vec3::new(size, 0.0, z), Vec3::new(0.0, size, z)]
}

#[test]
fn in_the_tlas() {
    let Some(gpu) = gpu_or_fail() else { return };
    let mut shooter = RayShooter::new(&gpu);
    let count = 24_000;
    let mesh = Parts::mesh(&TestMesh::from_triangles([corner_of(1.0, 0.0)]));
    let place = |scale: f32, z: f64| {
        DAffine3::from_scale_rotation_translation(
            DVec3::splat(scale.into()),
            glam::DQuat::IDENTITY,
            DVec3::Z * z,
        )
    };
    let mut random = Random::new(3);
    let nested: Vec<_> =
        shells(count).map(|(_, size)| place(size, 0.01 * f64::from(random.uniform()))).collect();
    let scene = mesh.place(nested.into_iter().chain([place(4.0, 10.0)]));
    assert_cuts_are_counted("tlas", |length| {
        shoot(&mut shooter, &scene, through_corners(length), |hit| hit.instance == count)
    });
}

#[test]
fn in_volumes() {
    let Some(gpu) = gpu_or_fail() else { return };
    let mut shooter = RayShooter::new(&gpu);
    // A row of voxels beside the ray, and one in its way.
    let edge = 2048;
    let mut row: Vec<SvoVoxel> = (0..edge).map(|x| voxel([x, 1, 0])).collect();
    row.push(voxel([edge - 1, 0, 0]));
    let row = Parts::volume(&row, edge.into());
    // The same volume six times, a little beside each other. All are hit at once, then the lowest id wins: that of the
    // one which the walk over the instances comes to last.
    let beside = (0..6).map(|i| DAffine3::from_translation(DVec3::Y * f64::from(i) * 0.05));
    let mut scene = row.place(beside);
    let last = last_instance(&scene);
    for slot in 0..6 {
        scene.instances.get_mut(slot, 1).stable_id = if slot == last { 0 } else { slot as u32 + 1 };
    }
    assert_cuts_are_counted("volumes", |length| {
        let x = f32::from(edge - 2) * (1.0 - length as f32 / LENGTHS as f32);
        let ray = Ray::new(Vec3::new(x, 0.5, 0.5), Vec3::X);
        shoot(&mut shooter, &scene, ray, |hit| hit.instance == last as u32)
    });
}

/// The slot that a walk over the TLAS comes to last: always the second child.
fn last_instance(scene: &FlatScene) -> usize {
    let nodes = scene.tlas();
    let mut node = nodes[0];
    while !node.is_leaf() {
        node = nodes[node.first_child() as usize + 1];
    }
    node.primitives().0 as usize
}

fn voxel(cell: [u16; 3]) -> SvoVoxel {
    SvoVoxel { cell, color: [128; 3], material: 0 }
}

/// An object that can be placed many times.
struct Parts {
    flat: FlatScene,
    instance: Instance,
    bounds: Aabb<f32>,
}

impl Parts {
    fn mesh(mesh: &TestMesh) -> Self {
        let built =
            build_mesh(&mesh.positions, &mesh.triangles, &mesh.ids(), &BvhOptions::default()).unwrap();
        let instance = Instance {
            kind: KIND_MESH,
            node_count: built.nodes.len() as u32,
            primitive_count: built.triangles.len() as u32,
            ..Instance::default()
        };
        let flat = FlatScene {
            bvh_nodes: Heap::from_records(built.nodes, 1),
            triangles: Heap::from_records(built.triangles, 1),
            features: FeatureSet::NONE.with(Feature::Triangles, true),
            ..FlatScene::default()
        };
        Self { flat, instance, bounds: built.bounds }
    }

    fn volume(voxels: &[SvoVoxel], edge: u32) -> Self {
        let svo = build_svo(voxels, UVec3::splat(edge)).unwrap();
        let instance = Instance {
            kind: KIND_VOXELS,
            node_count: svo.nodes.len() as u32,
            levels: svo.levels,
            ..Instance::default()
        };
        let flat = FlatScene {
            svo_nodes: Heap::from_records(svo.nodes, 1),
            features: FeatureSet::NONE.with(Feature::Voxels, true),
            ..FlatScene::default()
        };
        Self { flat, instance, bounds: svo.bounds }
    }

    /// The scene with the object at these places, in slots 0, 1, 2, …
    fn place(self, places: impl IntoIterator<Item = DAffine3>) -> FlatScene {
        let placed = |(slot, world_from_object): (u32, DAffine3)| {
            let forward = Affine::<f32>::from_daffine(&world_from_object);
            let bounds = forward.bounds(&self.bounds);
            Instance {
                world_from_object: forward.to_rows(),
                object_from_world: Affine::<f32>::from_daffine(&world_from_object.inverse()).to_rows(),
                lo: bounds.lo.into(),
                hi: bounds.hi.into(),
                stable_id: slot,
                ..self.instance
            }
        };
        let instances: Vec<Instance> = (0..).zip(places).map(placed).collect();
        let boxes = (0..).zip(&instances).map(|(slot, i)| (slot, Aabb { lo: i.lo.into(), hi: i.hi.into() }));
        let tlas = build_tlas(&boxes.collect::<Vec<_>>()).unwrap();
        let (tlas_first, tlas_count) = (self.flat.bvh_nodes.len() as u32, tlas.len() as u32);
        FlatScene {
            params: SceneParams { tlas_first, tlas_count, ..SceneParams::default() },
            tlas_nodes: Heap::from_records(tlas, 1),
            instances: Heap::from_records(instances, 1),
            materials: Heap::from_records(vec![MaterialRecord::default()], 1),
            features: self.flat.features.with(Feature::Lambert, true),
            revision: 1,
            ..self.flat
        }
    }
}
