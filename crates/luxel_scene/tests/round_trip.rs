//! Load → save → load gives the same world, bit for bit.
#![allow(clippy::unwrap_used)]

mod any_world;

use std::collections::BTreeMap;
use std::fs;
use std::path::Path;

use bevy_ecs::hierarchy::ChildOf;
use bevy_ecs::prelude::{Entity, EntityRef, World};
use glam::DQuat;
use luxel_scene::*;
use proptest::prelude::*;

use any_world::{
    AnyEntity, Kind, any_entity, any_environment, any_mesh_structure, any_settings, any_sphere_cloud,
    with_images,
};

/// Everything of one entity, floats as bits where `PartialEq` would blur them.
#[derive(Debug, PartialEq)]
struct Snapshot {
    name: Option<Name>,
    parent: Option<StableId>,
    transform: Option<[u64; 10]>,
    sphere: Option<u64>,
    mesh: Option<MeshInstance>,
    volume: Option<VoxelVolume>,
    material: Option<(String, [u32; 3])>,
    camera: Option<(String, [u64; 2])>,
    textures: Option<MaterialTextures>,
    smooth: Option<SmoothNormals>,
    lights: (Option<PointLight>, Option<SpotLight>, Option<DistantLight>),
    active: bool,
    visible: Option<Visibility>,
}

fn snapshot(world: &World) -> BTreeMap<StableId, Snapshot> {
    let Some(mut query) = world.try_query::<(EntityRef, &StableId)>() else {
        return BTreeMap::new();
    };
    query
        .iter(world)
        .map(|(entity, &id)| {
            let transform = entity.get::<Transform>().map(|t| {
                let (p, r, s) = (t.translation, t.rotation, t.scale);
                [p.x, p.y, p.z, r.x, r.y, r.z, r.w, s.x, s.y, s.z].map(f64::to_bits)
            });
            let material = entity.get::<Material>().map(|m| {
                // Debug prints the shortest text that reads back to the same bits, sign included.
                (format!("{:?} {:?}", m.surface, m.opacity), m.emission.to_array().map(f32::to_bits))
            });
            let parent = entity.get::<ChildOf>().map(|c| *world.get::<StableId>(c.parent()).unwrap());
            let camera = entity.get::<Camera>().map(|c| {
                (format!("{:?}", c.projection), [c.lens_radius, c.focus_distance].map(f64::to_bits))
            });
            let value = Snapshot {
                name: entity.get().cloned(),
                parent,
                transform,
                sphere: entity.get::<Sphere>().map(|s| s.radius.to_bits()),
                mesh: entity.get().copied(),
                volume: entity.get().copied(),
                material,
                camera,
                textures: entity.get().copied(),
                smooth: entity.get().copied(),
                lights: (entity.get().copied(), entity.get().copied(), entity.get().copied()),
                active: entity.contains::<ActiveCamera>(),
                visible: entity.get().copied(),
            };
            (id, value)
        })
        .collect()
}

fn assert_same(a: &World, b: &World) {
    assert_eq!(snapshot(a), snapshot(b));
    assert_eq!(a.resource::<Assets>(), b.resource::<Assets>());
    assert_eq!(a.resource::<Environment>(), b.resource::<Environment>());
    assert_eq!(a.resource::<RenderSettings>(), b.resource::<RenderSettings>());
    assert_eq!(a.resource::<SphereCloud>(), b.resource::<SphereCloud>());
    assert_eq!(a.resource::<MeshStructure>(), b.resource::<MeshStructure>());
    assert_eq!(a.resource::<StableIds>(), b.resource::<StableIds>());
    assert_eq!(world_hash(a).unwrap(), world_hash(b).unwrap());
}

fn load_new(path: &Path) -> World {
    let mut world = empty_world();
    load(path, &mut world).unwrap();
    world
}

/// A world with assets of every kind of source, the files in `folder`.
fn build(folder: &Path, entities: &[AnyEntity], environment: Environment, settings: RenderSettings) -> World {
    let mut world = empty_world();
    world.insert_resource(settings);
    let (meshes, volumes, images) = insert_assets(folder, &mut world.resource_mut::<Assets>());
    world.insert_resource(match environment {
        Environment::Map { image, rotation, strength } => {
            Environment::Map { image: images[image.0 as usize], rotation, strength }
        }
        other => other,
    });
    let mut spawned: Vec<Entity> = Vec::new();
    let mut has_camera = false;
    for entity in entities {
        let id = spawn(&mut world, entity.transform);
        let mut new = world.entity_mut(id);
        match entity.kind {
            Kind::Group => {}
            Kind::Sphere(radius) => drop(new.insert(Sphere { radius })),
            Kind::Mesh(index) => drop(new.insert(MeshInstance { mesh: meshes[index] })),
            Kind::Volume(index) => drop(new.insert(VoxelVolume { volume: volumes[index] })),
            Kind::Point(light) => drop(new.insert(light)),
            Kind::Spot(light) => drop(new.insert(light)),
            Kind::Distant(light) => drop(new.insert(light)),
            Kind::Camera(camera) => {
                new.insert(camera);
                if !has_camera && !entity.deleted {
                    has_camera = true;
                    new.insert(ActiveCamera);
                }
            }
        }
        if let Some(name) = &entity.name {
            new.insert(Name(name.clone()));
        }
        if let Some(material) = entity.material {
            new.insert(material);
        }
        if let Some(textures) = entity.textures {
            new.insert(with_images(textures, &images));
        }
        if let Some(crease_angle) = entity.smooth {
            new.insert(SmoothNormals { crease_angle });
        }
        if let Some(visible) = entity.visible {
            new.insert(Visibility(visible));
        }
        if let Some(parent) = entity.parent.filter(|_| !spawned.is_empty()) {
            new.insert(ChildOf(spawned[parent.index(spawned.len())]));
        }
        if entity.deleted {
            new.despawn();
        } else {
            spawned.push(id);
        }
    }
    world
}

/// A glTF file with one triangle, (0, 0, 0), (1, 0, 0), (0, 1, 0).
const ONE_TRIANGLE: &str = r#"{"asset": {"version": "2.0"},
    "buffers": [{"byteLength": 36, "uri": "data:;base64,AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAA"}],
    "bufferViews": [{"buffer": 0, "byteLength": 36}],
    "accessors": [{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3"}],
    "meshes": [{"primitives": [{"attributes": {"POSITION": 0}}]}],
    "nodes": [{"mesh": 0}], "scenes": [{"nodes": [0]}]}"#;

/// A Radiance picture of two pixels, not compressed.
const SKY: &[u8] = b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 1 +X 2\n\x80\x40\x20\x81\x10\x20\x40\x80";

fn insert_assets(folder: &Path, assets: &mut Assets) -> (Vec<AssetId>, Vec<AssetId>, Vec<AssetId>) {
    let obj = folder.join("two.obj");
    fs::write(&obj, "v 0 0 0\nv 1 0 0\nv 0 1 0\no a\nf 1 2 3\no b\nf 3 2 1\nf 1 2 9\n").unwrap();
    let unused = assets.insert_mesh(MeshAsset::from_source(MeshSource::Cube).unwrap());
    let gltf = folder.join("one.gltf");
    fs::write(&gltf, ONE_TRIANGLE).unwrap();
    let meshes = [
        MeshSource::ModelPrimitive { path: gltf, mesh: 0, primitive: 0 },
        MeshSource::Terrain { seed: 3, cells: 4, height: 0.1 },
        MeshSource::File(obj.clone()),
        MeshSource::FilePart(obj, 1),
    ]
    .map(|source| assets.insert_mesh(MeshAsset::from_source(source).unwrap()));
    assets.remove_mesh(unused);
    let volumes = [
        VolumeSource::Menger { level: 1 },
        VolumeSource::Lantern { size: 5 },
        VolumeSource::Island { size: 16, seed: 9 },
        VolumeSource::Area { kind: AreaKind::Biomes, size: 64, seed: 2 },
    ]
    .map(|source| assets.insert_volume(VolumeAsset::from_source(source).unwrap()));
    let sky = folder.join("sky.hdr");
    fs::write(&sky, SKY).unwrap();
    let images = [ImageSource::Checker { squares: 2, a: [255, 0, 9], b: [0; 3] }, ImageSource::File(sky)]
        .map(|source| assets.insert_image(ImageAsset::from_source(source).unwrap()));
    (meshes.to_vec(), volumes.to_vec(), images.to_vec())
}

proptest! {
    #![proptest_config(ProptestConfig {
        cases: 64,
        failure_persistence: None,
        rng_seed: proptest::test_runner::RngSeed::Fixed(0x1CED),
        ..ProptestConfig::default()
    })]

    #[test]
    fn a_world_survives_saving_and_loading(
        entities in proptest::collection::vec(any_entity(), 0..24),
        environment in any_environment(),
        settings in any_settings(),
        sphere_cloud in any_sphere_cloud(),
        mesh_structure in any_mesh_structure(),
    ) {
        let folder = tempfile::tempdir().unwrap();
        let mut world = build(folder.path(), &entities, environment, settings);
        world.insert_resource(sphere_cloud);
        world.insert_resource(mesh_structure);
        let first = folder.path().join("first.ron");
        save(&world, &first).unwrap();
        let loaded = load_new(&first);
        assert_same(&world, &loaded);
        // In another folder the relative paths change, and nothing else.
        fs::create_dir(folder.path().join("below")).unwrap();
        let second = folder.path().join("below/second.ron");
        save(&loaded, &second).unwrap();
        assert_same(&loaded, &load_new(&second));
        let third = folder.path().join("third.ron");
        save(&load_new(&second), &third).unwrap();
        prop_assert_eq!(fs::read(&first).unwrap(), fs::read(&third).unwrap());
    }
}

#[test]
fn the_hash_notices_a_single_bit() {
    let world_with = |radius| {
        let mut world = empty_world();
        spawn(&mut world, Sphere { radius });
        world_hash(&world).unwrap()
    };
    assert_eq!(world_with(1.0), world_with(1.0));
    assert_ne!(world_with(1.0), world_with(1.0 + f64::EPSILON));
}

#[test]
fn the_mesh_structure_is_saved_and_hashed_only_where_it_is_not_the_default() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("structure.ron");
    let saved = |structure: MeshStructure| {
        let mut world = empty_world();
        world.insert_resource(structure);
        save(&world, &path).unwrap();
        fs::read_to_string(&path).unwrap()
    };
    assert!(!saved(MeshStructure::default()).contains("mesh_structure"));
    let given = MeshStructure { accel: MeshAccel::BvhEscape, bins: Some(4), ..MeshStructure::default() };
    assert!(saved(given).contains("mesh_structure: ("));
    assert_eq!(*load_new(&path).resource::<MeshStructure>(), given);
    assert!(!saved(given).contains("levels"), "older programs read what does not need it");
    let one = MeshStructure { levels: MeshLevels::One, ..MeshStructure::default() };
    assert!(saved(one).contains("levels: One"));
    assert_eq!(*load_new(&path).resource::<MeshStructure>(), one);
    fs::write(&path, "(version: 1, mesh_structure: (quality: Best, split: LargestAxis, leaf_size: 2))")
        .unwrap();
    let expected = MeshStructure {
        quality: MeshQuality::Best,
        split: MeshSplit::LargestAxis,
        leaf_size: 2,
        ..MeshStructure::default()
    };
    assert_eq!(*load_new(&path).resource::<MeshStructure>(), expected);
}

#[test]
fn the_sphere_cloud_is_saved_and_hashed_only_where_it_is_not_the_default() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("scene.ron");
    let mut world = empty_world();
    let mut saved = |cloud: SphereCloud| {
        world.insert_resource(cloud);
        save(&world, &path).unwrap();
        (fs::read_to_string(&path).unwrap(), world_hash(&world).unwrap())
    };
    let (text, hash) = saved(SphereCloud::default());
    assert!(!text.contains("sphere_cloud"), "{text}");
    for cloud in [
        SphereCloud { accel: SphereAccel::Bvh, ..SphereCloud::default() },
        SphereCloud { max_depth: 3, ..SphereCloud::default() },
        SphereCloud { min_spheres: 1, ..SphereCloud::default() },
    ] {
        let (text, other_hash) = saved(cloud);
        assert!(text.contains("sphere_cloud: (") && hash != other_hash, "{text}");
    }
    fs::write(&path, "(version: 1, sphere_cloud: (accel: Bvh, max_depth: 8))").unwrap();
    let expected = SphereCloud { accel: SphereAccel::Bvh, max_depth: 8, ..SphereCloud::default() };
    assert_eq!(*load_new(&path).resource::<SphereCloud>(), expected);
}

#[test]
fn a_rotation_that_has_drifted_is_saved_as_the_unit_one_that_is_loaded() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("drifted.ron");
    let mut world = empty_world();
    let rotation = DQuat::from_xyzw(0.6, 0.0, 0.0, 0.8 + 1e-7);
    spawn(&mut world, Transform { rotation, ..Transform::default() });
    save(&world, &path).unwrap();
    let mut loaded = load_new(&path);
    assert_eq!(world_hash(&world).unwrap(), world_hash(&loaded).unwrap());
    let loaded = loaded.query::<&Transform>().single(&loaded).unwrap().rotation;
    assert!((loaded.length_squared() - 1.0).abs() < 1e-15 && loaded.abs_diff_eq(rotation, 1e-7));
}

#[test]
fn a_world_that_no_file_may_hold_is_not_saved_and_the_old_file_stays() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("scene.ron");
    fs::write(&path, "old").unwrap();
    let mut world = empty_world();
    spawn(&mut world, (Name("ball".to_owned()), Sphere { radius: f64::NAN }));
    let message = save(&world, &path).unwrap_err().to_string();
    assert!(message.ends_with("entity 1 \"ball\": sphere.radius must be positive and finite, but is NaN"));
    assert_eq!(fs::read(&path).unwrap(), b"old");
    assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 1);
}

#[test]
fn saving_into_a_folder_that_is_none_is_one_clear_error() {
    let folder = tempfile::tempdir().unwrap();
    let message = save(&empty_world(), &folder.path().join("no/scene.ron")).unwrap_err().to_string();
    assert!(message.contains("scene.ron: cannot be written"), "{message}");
    let message = save(&empty_world(), folder.path()).unwrap_err().to_string();
    assert!(message.contains("cannot be written"), "{message}");
    assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 0);
}
