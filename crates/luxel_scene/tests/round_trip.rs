//! Load → save → load gives the same world, bit for bit.
#![allow(clippy::unwrap_used)]

use std::collections::BTreeMap;
use std::fs;
use std::path::Path;

use bevy_ecs::hierarchy::ChildOf;
use bevy_ecs::prelude::{Entity, EntityRef, World};
use glam::{DQuat, DVec3, Vec3};
use luxel_scene::*;
use proptest::prelude::*;

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
    camera: Option<[u64; 3]>,
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
                (format!("{:?}", m.surface), m.emission.to_array().map(f32::to_bits))
            });
            let parent = entity.get::<ChildOf>().map(|c| *world.get::<StableId>(c.parent()).unwrap());
            let camera = entity
                .get::<Camera>()
                .map(|c| [c.vertical_fov, c.lens_radius, c.focus_distance].map(f64::to_bits));
            let value = Snapshot {
                name: entity.get().cloned(),
                parent,
                transform,
                sphere: entity.get::<Sphere>().map(|s| s.radius.to_bits()),
                mesh: entity.get().copied(),
                volume: entity.get().copied(),
                material,
                camera,
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
    assert_eq!(a.resource::<StableIds>(), b.resource::<StableIds>());
    assert_eq!(world_hash(a).unwrap(), world_hash(b).unwrap());
}

fn load_new(path: &Path) -> World {
    let mut world = empty_world();
    load(path, &mut world).unwrap();
    world
}

/// Any finite number, tiny and huge ones and −0 among them.
fn any_f64() -> impl Strategy<Value = f64> {
    prop_oneof![
        -10.0..10.0,
        proptest::num::f64::NORMAL | proptest::num::f64::SUBNORMAL | proptest::num::f64::ZERO,
    ]
}

fn any_dvec3() -> impl Strategy<Value = DVec3> {
    (any_f64(), any_f64(), any_f64()).prop_map(DVec3::from)
}

fn positive_f64() -> impl Strategy<Value = f64> {
    prop_oneof![
        1e-3..10.0,
        proptest::num::f64::POSITIVE | proptest::num::f64::NORMAL | proptest::num::f64::SUBNORMAL
    ]
}

fn any_colour(max: f32) -> impl Strategy<Value = Vec3> {
    let channel = || prop_oneof![0.0..=max, Just(0.0), Just(max), Just(1e-42f32)];
    (channel(), channel(), channel()).prop_map(Vec3::from)
}

fn any_transform() -> impl Strategy<Value = Transform> {
    let rotation = prop_oneof![
        Just(DQuat::IDENTITY),
        Just(-DQuat::IDENTITY),
        (-1.0..1.0f64, -1.0..1.0f64, -1.0..1.0f64, 0.1..1.0f64)
            .prop_map(|(x, y, z, w)| DQuat::from_xyzw(x, y, z, w).normalize()),
    ];
    let scale = any_dvec3().prop_map(|s| DVec3::select(s.cmpeq(DVec3::ZERO), DVec3::ONE, s));
    prop_oneof![
        1 => Just(Transform::default()),
        4 => (any_dvec3(), rotation, scale).prop_map(|(translation, rotation, scale)| Transform {
            translation,
            rotation,
            scale
        }),
    ]
}

fn any_material() -> impl Strategy<Value = Material> {
    let surface = prop_oneof![
        any_colour(1.0).prop_map(|albedo| Surface::Lambert { albedo }),
        (any_colour(1.0), 0f32..=1.0).prop_map(|(albedo, fuzz)| Surface::Metal { albedo, fuzz }),
        (1f32..4.0).prop_map(|ior| Surface::Dielectric { ior }),
    ];
    (surface, any_colour(1e30)).prop_map(|(surface, emission)| Material { surface, emission })
}

#[derive(Debug, Clone)]
enum Kind {
    Group,
    Sphere(f64),
    Mesh(usize),
    Volume(usize),
    Camera(Camera),
}

#[derive(Debug, Clone)]
struct AnyEntity {
    kind: Kind,
    name: Option<String>,
    parent: Option<prop::sample::Index>,
    transform: Transform,
    material: Option<Material>,
    visible: Option<bool>,
    deleted: bool,
}

fn any_entity() -> impl Strategy<Value = AnyEntity> {
    let camera = (1e-6..3.125, prop_oneof![Just(0.0), 1e-9..1.0], positive_f64());
    let kind = prop_oneof![
        Just(Kind::Group),
        positive_f64().prop_map(Kind::Sphere),
        (0usize..4).prop_map(Kind::Mesh),
        (0usize..3).prop_map(Kind::Volume),
        camera.prop_map(|(vertical_fov, lens_radius, focus_distance)| Kind::Camera(Camera {
            vertical_fov,
            lens_radius,
            focus_distance,
        })),
    ];
    (
        kind,
        proptest::option::of(".*"),
        proptest::option::of(any::<prop::sample::Index>()),
        any_transform(),
        proptest::option::of(any_material()),
        any::<Option<bool>>(),
        proptest::bool::weighted(0.1),
    )
        .prop_map(|(kind, name, parent, transform, material, visible, deleted)| AnyEntity {
            kind,
            name,
            parent,
            transform,
            material,
            visible,
            deleted,
        })
}

fn any_environment() -> impl Strategy<Value = Environment> {
    let three = (any_colour(1e6), any_colour(1e6), any_colour(1e6));
    prop_oneof![
        any_colour(1e6).prop_map(Environment::Constant),
        three.prop_map(|(zenith, horizon, ground)| Environment::Gradient { zenith, horizon, ground }),
    ]
}

fn any_settings() -> impl Strategy<Value = RenderSettings> {
    let tone_map = prop_oneof![
        Just(ToneMapping::None),
        Just(ToneMapping::Reinhard),
        Just(ToneMapping::Aces),
        Just(ToneMapping::AgX)
    ];
    let sizes = (1u32..=16384, 1u32..=16384, 1u32.., 0u32..=65535);
    (sizes, any::<u32>(), any::<u32>(), -64f32..=64.0, tone_map).prop_map(
        |((width, height, spp, max_depth), roulette_depth, seed, exposure, tone_map)| RenderSettings {
            width,
            height,
            spp,
            max_depth,
            roulette_depth,
            seed,
            exposure,
            tone_map,
        },
    )
}

fn any_sphere_cloud() -> impl Strategy<Value = SphereCloud> {
    let accel = prop::sample::select(SphereAccel::NAMES).prop_map(|(_, accel)| accel);
    let given = (accel, 0..=MAX_CLOUD_DEPTH, 0..=MAX_LEAF_SPHERES);
    let given =
        given.prop_map(|(accel, max_depth, min_spheres)| SphereCloud { accel, max_depth, min_spheres });
    prop_oneof![1 => Just(SphereCloud::default()), 4 => given]
}

/// A world with assets of every kind of source, the files in `folder`.
fn build(folder: &Path, entities: &[AnyEntity], environment: Environment, settings: RenderSettings) -> World {
    let mut world = empty_world();
    world.insert_resource(environment);
    world.insert_resource(settings);
    let (meshes, volumes) = insert_assets(folder, &mut world.resource_mut::<Assets>());
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

fn insert_assets(folder: &Path, assets: &mut Assets) -> (Vec<AssetId>, Vec<AssetId>) {
    let obj = folder.join("two.obj");
    fs::write(&obj, "v 0 0 0\nv 1 0 0\nv 0 1 0\no a\nf 1 2 3\no b\nf 3 2 1\nf 1 2 9\n").unwrap();
    let unused = assets.insert_mesh(MeshAsset::from_source(MeshSource::Cube).unwrap());
    let meshes = [
        MeshSource::Quad,
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
    ]
    .map(|source| assets.insert_volume(VolumeAsset::from_source(source).unwrap()));
    (meshes.to_vec(), volumes.to_vec())
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
    ) {
        let folder = tempfile::tempdir().unwrap();
        let mut world = build(folder.path(), &entities, environment, settings);
        world.insert_resource(sphere_cloud);
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
