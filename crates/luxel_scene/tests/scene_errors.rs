//! Every mistake in a scene file is one clear line with the file, the entity and the field.
#![allow(clippy::unwrap_used)]

use std::fs;
use std::path::{Path, PathBuf};

use luxel_scene::{MeshInstance, Sphere, StableId, Transform, empty_world, load};

fn load_text(text: &str) -> Result<bevy_ecs::world::World, String> {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("bad.ron");
    fs::write(&path, text).unwrap();
    let mut world = empty_world();
    match load(&path, &mut world) {
        Ok(_) => Ok(world),
        Err(error) => {
            let untouched = world.try_query::<&StableId>().is_none_or(|mut q| q.iter(&world).count() == 0);
            assert!(untouched, "a failed load left entities");
            let message = error.to_string();
            assert!(!message.contains('\n'), "{message}");
            let folder = folder.path().canonicalize().unwrap();
            Err(message.replace(&format!("{}/", folder.display()), ""))
        }
    }
}

fn entity(fields: &str) -> String {
    format!("(version: 1, meshes: {{1: Quad}}, entities: [(id: 3, name: \"ball\", {fields})])")
}

/// Field of entity 3 "ball", what is written, the rule in the message.
const ENTITY_MISTAKES: &[(&str, &str, &str)] = &[
    ("sphere.radius", "sphere: (radius: 0.0)", "must be positive and finite, but is 0.0"),
    ("sphere.radius", "sphere: (radius: -1)", "must be positive and finite, but is -1.0"),
    ("sphere.radius", "sphere: (radius: NaN)", "must be positive and finite, but is NaN"),
    ("sphere.radius", "sphere: (radius: inf)", "must be positive and finite, but is inf"),
    ("sphere, mesh and voxels", "sphere: (radius: 1), mesh: 1", "exclude one another"),
    ("transform.translation", "transform: (translation: (0, NaN, 0))", "must be finite"),
    ("transform.translation", "transform: (translation: (1e999, 0, 0))", "must be finite"),
    ("transform.scale", "transform: (scale: (1, 0, 1))", "must be non-zero on each axis"),
    ("transform.scale", "transform: (scale: (1, -inf, 1))", "must be finite"),
    ("transform.rotation", "transform: (rotation: (0, 0, 0, 2))", "quaternion (x, y, z, w) of length 1"),
    ("transform.rotation", "transform: (rotation: (NaN, 0, 0, 1))", "quaternion (x, y, z, w) of length 1"),
    ("transform.rotation_degrees", "transform: (rotation_degrees: (0, inf, 0))", "must be finite"),
    ("transform.rotation", "transform: (rotation: (0.7, 0, 0, 0.7))", "quaternion (x, y, z, w) of length 1"),
    ("transform.rotation", "transform: (rotation: (0, 0, 0, 1.02))", "quaternion (x, y, z, w) of length 1"),
    (
        "transform.look_at",
        "transform: (translation: (0, 0, 6), look_at: (0, 0, 6))",
        "must be another place than the translation, but is [0.0, 0.0, 6.0]",
    ),
    ("transform.look_at", "transform: (look_at: (0, 0, NaN))", "must be finite"),
    (
        "transform.rotation, rotation_degrees and look_at",
        "transform: (look_at: (0, 0, 1), rotation_degrees: (0, 0, 0))",
        "exclude one another",
    ),
    ("material.emission", "material: (surface: Dielectric(ior: 1.5), emission: (0, -1, 0))", "not negative"),
    (
        "material.emission",
        "material: (surface: Dielectric(ior: 1.5), emission: (inf, 0, 0))",
        "must be finite",
    ),
    ("material.surface.albedo", "material: (surface: Lambert(albedo: (0.5, 1.1, 0)))", "in 0 to 1"),
    ("material.surface.albedo", "material: (surface: Metal(albedo: (NaN, 1, 0), fuzz: 0))", "in 0 to 1"),
    ("material.surface.fuzz", "material: (surface: Metal(albedo: (1, 1, 1), fuzz: 1.5))", "in 0.0 to 1.0"),
    ("material.surface.ior", "material: (surface: Dielectric(ior: 0.9))", "at least 1"),
    ("material.surface.ior", "material: (surface: Dielectric(ior: inf))", "finite"),
    ("camera.vertical_fov_degrees", "camera: (vertical_fov_degrees: 180)", "between 0 and 180"),
    ("camera.vertical_fov_degrees", "camera: (vertical_fov_degrees: NaN)", "between 0 and 180"),
    ("camera.vertical_fov", "camera: (vertical_fov: 3.2)", "between 0 and π"),
    (
        "camera.vertical_fov, vertical_fov_degrees and orthographic_height",
        "camera: (vertical_fov: 1, vertical_fov_degrees: 50)",
        "exclude one another",
    ),
    ("camera.lens_radius", "camera: (lens_radius: -0.1)", "not negative"),
    ("camera.focus_distance", "camera: (focus_distance: 0)", "must be positive"),
    ("camera.orthographic_height", "camera: (orthographic_height: 0)", "must be positive"),
    (
        "camera.vertical_fov, vertical_fov_degrees and orthographic_height",
        "camera: (vertical_fov: 1, orthographic_height: 2)",
        "exclude one another",
    ),
    (
        "material.surface.smoothness",
        "material: (surface: SemiSpecular(albedo: (1, 1, 1), smoothness: 2))",
        "in 0.0 to 1.0",
    ),
    ("material.surface.base_color", "material: (surface: Principled((base_color: (2, 0, 0))))", "in 0 to 1"),
    ("material.surface.metallic", "material: (surface: Principled((metallic: -1)))", "in 0.0 to 1.0"),
    ("material.surface.roughness", "material: (surface: Principled((roughness: NaN)))", "in 0.0 to 1.0"),
    ("material.surface.ior", "material: (surface: Principled((ior: 0.5)))", "at least 1"),
    ("material.surface.specular", "material: (surface: Principled((specular: 1.5)))", "in 0.0 to 1.0"),
    (
        "material.surface.specular_color",
        "material: (surface: Principled((specular_color: (0, 0, -2))))",
        "not negative",
    ),
    (
        "material.surface.transmission",
        "material: (surface: Principled((transmission: inf)))",
        "in 0.0 to 1.0",
    ),
    ("material.surface.clearcoat", "material: (surface: Principled((clearcoat: 2)))", "in 0.0 to 1.0"),
    (
        "material.surface.clearcoat_roughness",
        "material: (surface: Principled((clearcoat_roughness: 2)))",
        "in 0.0",
    ),
    (
        "material.surface.volume.attenuation_color",
        "material: (surface: Principled((volume: (attenuation_color: (0, 1, 1), attenuation_distance: 1))))",
        "above 0 and at most 1",
    ),
    (
        "material.surface.volume.attenuation_distance",
        "material: (surface: Principled((volume: (attenuation_color: (1, 1, 1), attenuation_distance: 0))))",
        "positive",
    ),
    ("material.surface.color", "material: (surface: Unlit(color: (-1, 0, 0)))", "not negative"),
    (
        "material.opacity.alpha",
        "material: (surface: Unlit(color: (0, 0, 0)), opacity: Blend(alpha: 2))",
        "in 0.0 to 1.0",
    ),
    (
        "material.opacity.cutoff",
        "material: (surface: Unlit(color: (0, 0, 0)), opacity: Mask(alpha: 1, cutoff: -1))",
        "in 0.0 to 1.0",
    ),
    ("smooth_normals", "smooth_normals: 4", "in 0.0 to 3.14"),
    ("point_light.intensity", "point_light: (intensity: (0, -1, 0))", "not negative"),
    (
        "spot_light.outer_angle",
        "spot_light: (intensity: (1, 1, 1), inner_angle: 0, outer_angle: 1.6)",
        "at most π/2",
    ),
    (
        "spot_light.inner_angle",
        "spot_light: (intensity: (1, 1, 1), inner_angle: 1, outer_angle: 1)",
        "below the outer angle",
    ),
    ("distant_light.irradiance", "distant_light: (irradiance: (NaN, 1, 1))", "finite"),
    (
        "distant_light.angular_diameter",
        "distant_light: (irradiance: (1, 1, 1), angular_diameter: 3.2)",
        "below π",
    ),
    ("textures.color.uv_set", "textures: (color: (image: 1, uv_set: 2))", "in 0 to 1"),
    ("textures.normal.normal_scale", "textures: (normal: (image: 1, normal_scale: inf))", "finite"),
    ("textures.emission.offset", "textures: (emission: (image: 1, offset: (NaN, 0)))", "finite"),
    ("textures.specular.scale", "textures: (specular: (image: 1, scale: (inf, 0)))", "finite"),
    ("textures.clearcoat.rotation", "textures: (clearcoat: (image: 1, rotation: NaN))", "finite"),
    ("textures.color.image", "textures: (color: (image: 7))", "names image 7, which does not exist"),
    ("parent", "parent: 9", "names entity 9, which does not exist"),
    // I04: an entity within itself.
    ("parent", "parent: 3", "leads back to the entity itself"),
    ("mesh", "mesh: 2", "names mesh 2, which does not exist"),
    ("voxels", "voxels: 1", "names volume 1, which does not exist"),
];

#[test]
fn every_number_of_an_entity_is_checked() {
    for (field, text, rule) in ENTITY_MISTAKES {
        let message = load_text(&entity(text)).err().unwrap_or_else(|| panic!("{text} was taken"));
        assert!(message.starts_with(&format!("bad.ron: entity 3 \"ball\": {field} ")), "{message}");
        assert!(message.contains(rule), "{text}: {message}");
    }
}

/// A whole file's fields after `version: 1`, and what the message holds.
const FILE_MISTAKES: &[(&str, &str)] = &[
    ("environment: Constant((-1, 0, 0))", "environment: constant must be finite and not negative"),
    ("environment: Gradient(zenith: (0,0,0), horizon: (0,0,0), ground: (0,NaN,0))", "environment: ground"),
    ("settings: (width: 0)", "settings: width must be in 1 to 16384, but is 0"),
    ("settings: (height: 16385)", "settings: height must be in 1 to 16384"),
    ("settings: (spp: 0)", "settings: spp must be in 1 to"),
    ("settings: (exposure: NaN)", "settings: exposure must be in -64.0 to 64.0, but is NaN"),
    ("mesh_structure: (bins: Some(1))", "mesh_structure: bins must be in 2 to 64, but is 1"),
    ("mesh_structure: (leaf_size: 9)", "mesh_structure: leaf_size must be in 1 to 8, but is 9"),
    ("sphere_cloud: (max_depth: 21)", "sphere_cloud: max_depth must be in 0 to 20, but is 21"),
    ("sphere_cloud: (min_spheres: 65536)", "sphere_cloud: min_spheres must be in 0 to 65535, but is 65536"),
    ("meshes: {0: Quad}", "mesh 0: id must be in 1 to"),
    ("meshes: {1: Icosphere(subdivisions: 9)}", "mesh 1: subdivisions must be in 0 to 8"),
    ("meshes: {1: TorusKnot(p: 0, q: 3, tube: 0.1, segments: 9, sides: 9)}", "mesh 1: p must be"),
    ("meshes: {1: TorusKnot(p: 2, q: 3, tube: NaN, segments: 9, sides: 9)}", "mesh 1: tube must be"),
    ("meshes: {1: Terrain(seed: 1, cells: 4, height: 0)}", "mesh 1: height must be positive"),
    ("meshes: {1: File(\"/etc/passwd\")}", "mesh 1: path must be relative"),
    ("meshes: {1: File(\"http://example.org/a.obj\")}", "mesh 1: path must be relative"),
    ("meshes: {1: File(\"C:\\\\a.obj\")}", "mesh 1: path must be relative"),
    ("meshes: {1: File(\"\")}", "mesh 1: path must be relative"),
    ("meshes: {1: File(\"none.obj\")}", "bad.ron: mesh 1: none.obj: cannot be read"),
    ("meshes: {1: File(\".\")}", "bad.ron: mesh 1: "),
    ("meshes: {1: File(\".\")}", "is not a regular file"),
    // A file that is no model: this scene itself.
    ("meshes: {1: File(\"bad.ron\")}", "bad.ron: mesh 1: bad.ron: has no triangle"),
    ("meshes: {2: FilePart(\"bad.ron\", 3)}", "bad.ron: mesh 2: bad.ron: has no triangle"),
    ("volumes: {1: File(\"bad.ron\")}", "bad.ron: volume 1: bad.ron:"),
    ("volumes: {1: Menger(level: 6)}", "volume 1: level must be in 0 to 5"),
    ("volumes: {1: Island(size: 8, seed: 1)}", "volume 1: size must be in 16 to 512"),
    ("volumes: {1: Area(kind: Desert, size: 32, seed: 1)}", "volume 1: size must be in 64 to 2048"),
    ("volumes: {1: Area(kind: Desert, size: 100, seed: 1)}", "volume 1: size must be a power of two"),
    ("volumes: {1: File(\"none.vox\")}", "bad.ron: volume 1: none.vox: cannot be read"),
    ("meshes: {1: Quad}, volumes: {1: Menger(level: 1)}", "volume 1: id is a mesh's id too"),
    ("images: {0: Checker(squares: 2, a: (0, 0, 0), b: (1, 1, 1))}", "image 0: id must be in 1 to"),
    ("images: {1: Checker(squares: 0, a: (0, 0, 0), b: (1, 1, 1))}", "image 1: squares must be in 1 to 256"),
    ("images: {1: File(\"/a.png\")}", "image 1: path must be relative"),
    ("images: {1: File(\"none.png\")}", "bad.ron: image 1: none.png: cannot be read"),
    ("images: {1: File(\"bad.ron\")}", "bad.ron: image 1: bad.ron: is no PNG, JPEG"),
    ("images: {1: ModelImage(\"bad.ron\", 0)}", "bad.ron: image 1: bad.ron:1:"),
    ("meshes: {1: ModelPrimitive(path: \"bad.ron\", mesh: 0, primitive: 0)}", "bad.ron: mesh 1: bad.ron:1:"),
    (
        "meshes: {1: Quad}, images: {1: Checker(squares: 2, a: (0, 0, 0), b: (1, 1, 1))}",
        "image 1: id is a mesh's id too",
    ),
    ("environment: Map(image: 4)", "environment: image names image 4, which does not exist"),
    ("environment: Map(image: 4, strength: -1)", "environment: strength must be finite and not negative"),
    ("environment: Map(image: 4, rotation: NaN)", "environment: rotation must be finite"),
    ("scatter: [(count: 0, seed: 1, min: (0,0,0), max: (1,1,1), radius: (1, 2))]", "scatter 0: count"),
    ("scatter: [(count: 9, seed: 1, min: (0,2,0), max: (1,1,1), radius: (1, 2))]", "scatter 0: max"),
    ("scatter: [(count: 9, seed: 1, min: (0,0,0), max: (1,1,1), radius: (2, 1))]", "scatter 0: radius"),
    ("entities: [(id: 0)]", "entity 0: id must be in 1 to"),
    ("entities: [(id: 2), (id: 2)]", "entity 2: id is used by another entity"),
    ("entities: [(id: 1, parent: 2), (id: 2, parent: 1)]", "parent leads back"),
    ("active_camera: 1, entities: [(id: 1)]", "file: active_camera names entity 1, which is not a camera"),
    ("next_id: 0", "file: next_id must be in 1 to"),
];

#[test]
fn every_section_is_checked() {
    for (text, expected) in FILE_MISTAKES {
        let message =
            load_text(&format!("(version: 1, {text})")).err().unwrap_or_else(|| panic!("{text} was taken"));
        assert!(message.contains(expected), "{text}: {message}");
    }
}

#[test]
fn syntax_errors_name_line_and_column() {
    for (text, expected) in [
        ("(version: 1,\n entities: [(\n  colour: 3)])", "bad.ron:3:"),
        ("(version: 1,\n entities: [(id: \"a\")])", "bad.ron:2:17"),
        ("(version: 1,\n", "bad.ron:1:13"),
        ("(version: 1, sky: 3)", "bad.ron:1:14"),
        ("(version: 1, entities: [(sphere: (radius: 1, colour: 2))])", "bad.ron:1:"),
        ("(version: 1, entities: [(material: (surface: Lambert(albedo: (1, 1, 1), x: 2)))])", "bad.ron:1:"),
        ("(version: 1, settings: (tone_map: Filmic))", "bad.ron:1:35"),
        ("(version: 1, sphere_cloud: (max_depth: -1))", "bad.ron:1:"),
        ("(version: 1, sphere_cloud: (depth: 1))", "bad.ron:1:"),
        ("(entities: [])", "bad.ron:1:"),
        ("\u{FEFF}rubbish", "bad.ron:1:"),
        ("\0\0\0\0", "bad.ron:1:"),
    ] {
        let message = load_text(text).err().unwrap();
        assert!(message.starts_with(expected), "{text}: {message}");
    }
    let unknown = load_text("(version: 1, entities: [(sphere: (radius: 1), colour: 2)])").err().unwrap();
    assert!(unknown.contains("colour"), "{unknown}");
    let unknown = load_text("(version: 1, sphere_cloud: (accel: Kdtree))").err().unwrap();
    assert!(unknown.starts_with("bad.ron:1:") && unknown.contains("Kdtree"), "{unknown}");
    for known in ["Auto", "Naive", "OctreeBase", "OctreeSeed", "Octree", "Bvh"] {
        assert!(unknown.contains(&format!("`{known}`")), "{unknown}");
    }
}

#[test]
fn other_versions_are_refused_clearly() {
    let newer = load_text("(version: 2, entities: [(hologram: Yes(deeply: [1, 2]))], soul: 3)");
    let newer = newer.err().unwrap();
    assert!(newer.contains("version 2") && newer.contains("a newer Luxel is needed"), "{newer}");
    let older = load_text("(version: 0)").err().unwrap();
    assert!(older.contains("version 0") && !older.contains("newer"), "{older}");
}

#[test]
fn a_path_that_is_no_scene_is_one_clear_error() {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| -> PathBuf { folder.path().join(name) };
    fs::create_dir(at("dir.ron")).unwrap();
    for name in ["empty.ron", "empty.obj", "empty.vox"] {
        fs::write(at(name), "").unwrap();
    }
    fs::write(at("a.xyz"), "x").unwrap();
    for (name, expected) in [
        ("dir.ron", "is not a regular file"),
        ("missing.ron", "cannot be read"),
        ("missing.obj", "cannot be read"),
        ("missing.vox", "cannot be read"),
        ("empty.ron", "is empty"),
        ("empty.obj", "is empty"),
        ("empty.vox", "is empty"),
        ("a.xyz", "unknown kind of file"),
    ] {
        let message = load(&at(name), &mut empty_world()).unwrap_err().to_string();
        assert!(message.starts_with(&at(name).display().to_string()), "{message}");
        assert!(message.contains(expected), "{name}: {message}");
    }
}

#[test]
fn deep_hierarchies_end_in_an_error_not_in_a_stack_overflow() {
    let chain = |length: u32| {
        let entities: String = (1..=length)
            .map(
                |id| {
                    if id == 1 { "(id: 1),".to_owned() } else { format!("(id: {id}, parent: {}),", id - 1) }
                },
            )
            .collect();
        load_text(&format!("(version: 1, entities: [{entities}])"))
    };
    assert!(chain(1024).is_ok());
    assert!(chain(1025).err().unwrap().contains("parent chain is longer than 1024"));
    assert!(chain(20_000).is_err());
    let nested = format!("(version: 1, entities: {})", "[".repeat(100_000));
    let message = load_text(&nested).err().unwrap();
    assert!(message.contains(".ron:1:") && message.ends_with(": values are nested too deeply"), "{message}");
}

#[test]
fn every_prefix_of_a_scene_file_is_an_error_or_a_scene() {
    let text = entity(
        "sphere: (radius: 2.5), transform: (look_at: (1, 2, 3)), material: (surface: Metal(albedo: (1, 0.5, 0.25), fuzz: 0.5))",
    );
    for end in 0..text.len() {
        assert!(load_text(&text[..end]).is_err(), "{}", &text[..end]);
    }
    assert!(load_text(&text).is_ok());
}

#[test]
fn conveniences_of_hand_written_files_become_plain_components() {
    let mut world = load_text(
        "(version: 1, next_id: 10, meshes: {4: Quad}, entities: [
            (mesh: 4, transform: (rotation_degrees: (90, 0, 0))),
            (id: 7, transform: (translation: (0, 1, 5), look_at: (0, 1, 0)), camera: (vertical_fov_degrees: 60)),
        ], scatter: [(count: 5, seed: 1, min: (-1, 0, -1), max: (1, 0, 1), radius: (0.1, 0.2), resting: true)])",
    )
    .unwrap();
    use luxel_scene::{ActiveCamera, Camera};
    let (id, mesh, transform) =
        world.query::<(&StableId, &MeshInstance, &Transform)>().single(&world).unwrap();
    assert_eq!((id.0, mesh.mesh.0), (10, 4));
    let up = transform.affine().transform_vector3(glam::DVec3::Y);
    assert!(up.distance(glam::DVec3::Z) < 1e-12, "{up}");
    let mut cameras =
        world.query_filtered::<(&StableId, &Camera, &Transform), bevy_ecs::prelude::With<ActiveCamera>>();
    let (id, camera, transform) = cameras.single(&world).unwrap();
    assert_eq!((id.0, camera.focus_distance), (7, 5.0));
    let luxel_scene::Projection::Perspective { vertical_fov } = camera.projection else {
        panic!("a perspective")
    };
    assert!((vertical_fov - std::f64::consts::FRAC_PI_3).abs() < 1e-12);
    assert!(transform.affine().transform_vector3(-glam::DVec3::Z).distance(-glam::DVec3::Z) < 1e-12);
    let spheres: Vec<_> = world.query::<(&StableId, &Sphere, &Transform)>().iter(&world).collect();
    assert_eq!(spheres.len(), 5);
    for (id, sphere, transform) in spheres {
        assert!((11..16).contains(&id.0));
        assert_eq!(transform.translation.y, sphere.radius);
    }
}

#[test]
fn a_byte_order_mark_is_no_part_of_a_scene() {
    let mut world = load_text("\u{FEFF}(version: 1, entities: [(sphere: (radius: 2))])").unwrap();
    assert_eq!(world.query::<&Sphere>().iter(&world).count(), 1);
}

#[test]
fn a_rounded_quaternion_is_normalised_and_an_exact_one_is_kept() {
    let rotation = |text: &str| {
        let mut world = load_text(&entity(&format!("transform: (rotation: {text})"))).unwrap();
        world.query::<&Transform>().single(&world).unwrap().rotation
    };
    let half = std::f64::consts::FRAC_1_SQRT_2;
    for text in ["(0.707, 0, 0, 0.707)", "(0.71, 0, 0, 0.71)", "(0.707107, 0, 0, 0.707107)"] {
        let normalised = rotation(text);
        assert!(normalised.abs_diff_eq(glam::DQuat::from_xyzw(half, 0.0, 0.0, half), 1e-15), "{text}");
    }
    let exact = glam::DQuat::from_xyzw(0.1, -0.7, 0.3, 0.2).normalize();
    let [x, y, z, w] = exact.to_array();
    let kept = rotation(&format!("({x:?}, {y:?}, {z:?}, {w:?})"));
    assert_eq!(kept.to_array().map(f64::to_bits), exact.to_array().map(f64::to_bits));
}

#[test]
fn every_example_scene_loads_and_survives_saving() {
    let assets = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../assets");
    let folder = tempfile::tempdir().unwrap();
    let mut count = 0;
    for dir in [assets.clone(), assets.join("furnace")] {
        for path in fs::read_dir(dir).unwrap().map(|entry| entry.unwrap().path()) {
            if path.extension().is_some_and(|ending| ending == "ron") {
                let mut world = empty_world();
                let report = load(&path, &mut world).unwrap_or_else(|error| panic!("{error}"));
                assert_eq!(report, luxel_scene::LoadReport::default());
                let saved = folder.path().join("saved.ron");
                luxel_scene::save(&world, &saved).unwrap();
                let mut again = empty_world();
                load(&saved, &mut again).unwrap();
                let hash = |world| luxel_scene::world_hash(world).unwrap();
                assert_eq!(hash(&world), hash(&again), "{}", path.display());
                count += 1;
            }
        }
    }
    assert!(count >= 8, "{count}");
}
