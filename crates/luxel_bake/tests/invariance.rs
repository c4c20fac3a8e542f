//! What is published is a function of the world: not of the way there, and not of where its origin lies.
#![allow(clippy::unwrap_used)]
mod common;

use bevy_ecs::prelude::*;
use common::{OneOfEach, Studio, visible};
use glam::{DQuat, DVec3, Vec3};
use luxel_bake::TextureBudget;
use luxel_flat::FlatScene;
use luxel_geom::rng;
use luxel_scene::{
    AssetId, Material, MaterialTextures, MeshInstance, MeshSource, Opacity, Principled, SmoothNormals,
    Sphere, SphereAccel, SphereCloud, TextureRef, Transform, Visibility, VolumeSource, VoxelVolume, spawn,
};

/// Random numbers of an edit, in [0, 1).
fn random(edit: u32) -> [f64; 8] {
    let [a, b] = [0, 1].map(|block| rng::uniform4::<f64>(edit, 0, block, 42));
    std::array::from_fn(|i| if i < 4 { a[i] } else { b[i - 4] })
}

/// X01: every root and the camera moved by (2²⁰, 2²⁰, 2²⁰) changes no bit of any heap.
#[test]
fn a_moved_world_is_the_same_world() {
    let build = |offset: DVec3, accel: SphereAccel| {
        let mut studio = Studio::empty();
        studio.world.insert_resource(SphereCloud { accel, ..SphereCloud::default() });
        let scene = OneOfEach::new(&mut studio);
        let group = spawn(
            &mut studio.world,
            Transform { rotation: DQuat::from_rotation_y(0.7), ..Transform::at(DVec3::new(0.5, 1.25, -2.0)) },
        );
        studio.world.entity_mut(scene.cubes[0]).insert(ChildOf(group));
        studio.world.entity_mut(scene.cubes[1]).insert(SmoothNormals { crease_angle: 2.0 });
        let cells = |x: f64| (x * 1024.0).round() / 1024.0;
        for i in 0..200 {
            let r = random(i);
            let at = DVec3::new(r[0], r[1], r[2]).map(|x| cells(x * 6.0 - 3.0));
            studio.sphere(at, 0.01 + 0.1 * r[3], Material::default());
        }
        for mut transform in
            studio.world.query_filtered::<&mut Transform, Without<ChildOf>>().iter_mut(&mut studio.world)
        {
            transform.translation += offset;
        }
        studio.run()
    };
    let offset = DVec3::splat(f64::from(1 << 20));
    for (name, accel) in SphereAccel::NAMES {
        let (here, there) = (build(DVec3::ZERO, *accel), build(offset, *accel));
        assert_eq!(DVec3::from(there.anchor), DVec3::from(here.anchor) + offset);
        assert_eq!(bits(&here), bits(&there), "{name}");
    }
}

/// Everything but the anchor, floats as text in full (−0 and 0 differ).
fn bits(scene: &FlatScene) -> String {
    format!(
        "{:?} {:?} {:?} {:?} {:?} {:?} {:?} {:?} {:?} {:?} {:?} {:?}",
        scene.params,
        (scene.triangle_attributes.as_slice(), scene.textures.as_slice(), scene.texels.as_slice()),
        scene.tlas_nodes.as_slice(),
        scene.bvh_nodes.as_slice(),
        scene.instances.as_slice(),
        scene.octree_nodes.as_slice(),
        scene.spheres.as_slice(),
        (scene.sphere_accel, scene.sphere_nodes.as_slice(), scene.leaf_spheres.as_slice()),
        scene.triangles.as_slice(),
        scene.svo_nodes.as_slice(),
        scene.materials.as_slice(),
        scene.features,
    )
}

/// The cloud's instance box holds every sphere's box after translation.
#[test]
fn the_clouds_box_holds_its_spheres() {
    for scale in [1e-3, 1.0, 1e6] {
        let mut studio = Studio::empty();
        for i in 0..100 {
            let r = random(i);
            studio.sphere(
                DVec3::new(r[0], r[1] + 5.0, r[2]) * scale,
                r[3] * 0.1 * scale,
                Material::default(),
            );
        }
        let scene = studio.run();
        let cloud = scene.instances.as_slice()[scene.tlas()[0].primitives().0 as usize];
        let translation = Vec3::from_array([0, 1, 2].map(|i| cloud.world_from_object[i][3]));
        for sphere in scene.spheres.as_slice() {
            let bounds =
                luxel_geom::sphere::bounds::<f32>(Vec3::from(sphere.center) + translation, sphere.radius);
            assert!(
                Vec3::from(cloud.lo).cmple(bounds.lo).all() && Vec3::from(cloud.hi).cmpge(bounds.hi).all()
            );
        }
    }
}

/// 2,000 random edits under every structure; now and then everything is compared with a fresh bake of the same world.
#[test]
fn edited_equals_fresh() {
    for (name, accel) in SphereAccel::NAMES {
        assert_edited_equals_fresh(name, SphereCloud { accel: *accel, ..SphereCloud::default() });
    }
}

/// What edits choose from.
struct Stock {
    meshes: [AssetId; 3],
    images: [AssetId; 3],
    volumes: [AssetId; 2],
}

impl Stock {
    fn new(studio: &mut Studio) -> Self {
        let meshes = [
            studio.decorated_asset(MeshSource::Cube, |_| {}),
            studio.mesh_asset(MeshSource::Quad),
            studio.decorated_asset(MeshSource::Icosphere { subdivisions: 1 }, |mesh| {
                mesh.normals = mesh.positions.iter().map(|p| p.normalize()).collect();
            }),
        ];
        let images = [(8, 4, 255), (3, 5, 40), (16, 16, 255)].map(|(w, h, a)| studio.image_asset(w, h, a));
        let volumes = [VolumeSource::Menger { level: 1 }, VolumeSource::Lantern { size: 6 }]
            .map(|s| studio.volume_asset(s));
        Self { meshes, images, volumes }
    }

    /// A new object, an edit of one that is there, or the end of one, as the numbers say.
    fn edit(&self, world: &mut World, objects: &mut Vec<Entity>, r: [f64; 8]) {
        let pick = |n: usize| (r[0] * n as f64) as usize;
        let old = (!objects.is_empty()).then(|| objects[pick(objects.len())]);
        let choice = (r[4] * 15.0) as u32;
        let at = DVec3::new(r[1], r[2], r[3]) * 20.0 - 10.0;
        match (choice, old) {
            (0..2, _) | (_, None) => {
                objects.push(spawn(world, (Sphere { radius: 0.1 + r[5] }, Transform::at(at), material(r[6]))))
            }
            (2, _) => {
                let mesh = MeshInstance { mesh: self.meshes[pick(3)] };
                objects.push(spawn(world, (mesh, Transform::at(at), material(r[6]))));
            }
            (3, _) => {
                let volume = VoxelVolume { volume: self.volumes[pick(2)] };
                objects.push(spawn(world, (volume, Transform::at(at))));
            }
            (4, Some(old)) if objects.len() > 30 => {
                world.despawn(old);
                objects.retain(|e| world.get_entity(*e).is_ok());
            }
            (8, Some(old)) => {
                // Only onto objects of lower number, so that no cycle can come about.
                let parent =
                    objects.iter().copied().find(|e| *e < old && r[5] < 0.5 && !is_below(world, *e, old));
                match parent {
                    Some(parent) => _ = world.entity_mut(old).insert(ChildOf(parent)),
                    None => _ = world.entity_mut(old).remove::<ChildOf>(),
                }
            }
            (14, _) if r[5] < 0.5 => world.resource_mut::<TextureBudget>().bytes = (r[6] * 1500.0) as u64,
            (choice, Some(old)) => self.change(world, old, choice, at, r),
        }
    }

    /// An edit of one object.
    fn change(&self, world: &mut World, old: Entity, choice: u32, at: DVec3, r: [f64; 8]) {
        let mut object = world.entity_mut(old);
        match choice {
            5 => {
                object.get_mut::<Transform>().unwrap().scale = DVec3::new(0.5 + r[5], 0.5 + r[5], 0.2 - r[6])
            }
            6 => _ = object.insert(material(r[6])),
            7 => _ = object.insert(Visibility(r[5] < 0.6)),
            9 => _ = object.remove::<(Sphere, Material)>(),
            12 => _ = object.insert(textures(&self.images, r[5], r[6])),
            13 => _ = object.insert(SmoothNormals { crease_angle: (r[5] * 4.0) as u32 as f32 }),
            14 => _ = object.remove::<(MaterialTextures, SmoothNormals)>(),
            _ => object.get_mut::<Transform>().unwrap().translation = at,
        }
    }
}

fn assert_edited_equals_fresh(name: &str, cloud: SphereCloud) {
    let mut studio = Studio::empty();
    studio.world.insert_resource(cloud);
    OneOfEach::new(&mut studio);
    let stock = Stock::new(&mut studio);
    studio.run();
    let mut objects: Vec<Entity> = Vec::new();
    for edit in 0..2_000 {
        stock.edit(&mut studio.world, &mut objects, random(edit));
        let scene = studio.run();
        if edit % 100 == 99 {
            studio.baker.validate(&studio.world).unwrap();
            assert_eq!(visible(&scene), visible(&studio.fresh()), "{name} after edit {edit}");
        }
    }
    for object in objects {
        _ = studio.world.try_despawn(object);
    }
    let lengths = |s: &FlatScene| {
        [
            s.instances.len(),
            s.triangles.len(),
            s.triangle_attributes.len(),
            s.svo_nodes.len(),
            s.materials.len(),
            s.textures.len(),
            s.texels.len(),
        ]
    };
    assert_eq!(lengths(&studio.run()), lengths(&studio.fresh()), "everything is given back");
}

fn textures(images: &[AssetId; 3], x: f64, y: f64) -> MaterialTextures {
    let pick = |x: f64| TextureRef::new(images[(x * 3.0) as usize]);
    let normal = (y < 0.3).then(|| pick(y * 3.0));
    MaterialTextures { color: Some(pick(x)), emission: Some(pick(y)), normal, ..MaterialTextures::default() }
}

fn is_below(world: &World, entity: Entity, ancestor: Entity) -> bool {
    let parent = |e: Entity| world.get::<ChildOf>(e).map(ChildOf::parent);
    std::iter::successors(Some(entity), |e| parent(*e)).any(|e| e == ancestor)
}

fn material(x: f64) -> Material {
    let color = Vec3::new(x as f32, 0.5, 0.25);
    match (x * 6.0) as u32 {
        0 => Material::lambert(color),
        1 => Material::metal(color, 0.1),
        2 => Material::dielectric(1.5),
        3 => Material::principled(Principled { base_color: color, ..Principled::default() }),
        4 => Material { opacity: Opacity::Blend { alpha: 0.5 }, ..Material::lambert(color) },
        _ => Material::lamp(color),
    }
}
