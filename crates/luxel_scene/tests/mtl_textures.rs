//! Textures of .mtl files that are made of more than a picture: masks in files of their own, heights, normal maps.
#![allow(clippy::unwrap_used)]

use std::fs;
use std::path::Path;

use bevy_ecs::prelude::World;
use glam::Vec2;
use image::{Rgba, RgbaImage};
use luxel_scene::*;

fn save_picture(path: &Path, width: u32, height: u32, pixel: impl Fn(u32, u32) -> [u8; 4]) {
    RgbaImage::from_fn(width, height, |x, y| Rgba(pixel(x, y))).save(path).unwrap();
}

fn load_with_materials(folder: &Path, mtl: &str) -> (World, LoadReport) {
    fs::write(folder.join("a.mtl"), mtl).unwrap();
    let names = mtl.lines().filter_map(|line| line.strip_prefix("newmtl "));
    let faces: String = names.map(|name| format!("usemtl {name}\nf 1/1 2/2 3/3\n")).collect();
    let corners = "v 0 0 0\nv 1 0 0\nv 1 1 0\nvt 0 0\nvt 1 0\nvt 1 1\n";
    let path = folder.join("a.obj");
    fs::write(&path, format!("mtllib a.mtl\n{corners}{faces}")).unwrap();
    let mut world = empty_world();
    let report = load(&path, &mut world).unwrap();
    (world, report)
}

/// Material and textures of each `newmtl`, in their order.
fn looks(world: &mut World) -> Vec<(Material, MaterialTextures)> {
    let mut query = world.query::<(&StableId, &Name, &Material, Option<&MaterialTextures>)>();
    let mut found: Vec<_> = query
        .iter(world)
        .filter(|(_, name, ..)| name.0.contains('('))
        .map(|(id, _, material, textures)| (*id, (*material, textures.copied().unwrap_or_default())))
        .collect();
    found.sort_by_key(|found| found.0);
    found.into_iter().map(|found| found.1).collect()
}

fn image(world: &World, texture: Option<TextureRef>) -> ImageAsset {
    (**world.resource::<Assets>().image(texture.unwrap().image).unwrap()).clone()
}

fn pixels(image: &ImageAsset) -> &[[u8; 4]] {
    let ImagePixels::Rgba8(pixels) = &image.pixels else { panic!("8 bits") };
    pixels
}

fn survives_saving(world: &World, folder: &Path) {
    let saved = folder.join("saved.ron");
    save(world, &saved).unwrap();
    let mut again = empty_world();
    load(&saved, &mut again).unwrap();
    assert_eq!(world.resource::<Assets>(), again.resource::<Assets>());
    assert_eq!(world_hash(world).unwrap(), world_hash(&again).unwrap());
}

#[test]
fn a_mask_in_a_file_of_its_own_becomes_the_opacity_of_the_colours() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    save_picture(&folder.join("leaf.png"), 4, 2, |x, y| [x as u8, y as u8, 9, 255]);
    save_picture(&folder.join("mask.png"), 4, 2, |x, _| if x < 2 { [0, 0, 0, 255] } else { [255; 4] });
    save_picture(&folder.join("alpha.png"), 8, 4, |x, _| [0, 0, 0, if x < 4 { 0 } else { 255 }]);
    let mtl = "newmtl leaf\nKd 0 0 0\nd 0\nmap_Kd -s 2 2 leaf.png\nmap_d -s 2 2 mask.png\n\
        newmtl twin\nmap_Kd leaf.png\nmap_d mask.png\n\
        newmtl larger\nmap_Kd leaf.png\nmap_d alpha.png\n\
        newmtl bare\nKd 0.5 0.5 0.5\nmap_d -o 0.5 0 0 mask.png\n\
        newmtl askew\nmap_Kd leaf.png\nmap_d -s 3 3 mask.png\n";
    let (mut world, report) = load_with_materials(folder, mtl);
    assert!(report.warnings.is_empty(), "{report:?}");
    assert_eq!(report.ignored, ["places of masks that are not those of their colours (1 material)"]);
    let looks = looks(&mut world);
    assert_eq!(looks[0].0.surface, Surface::Lambert { albedo: glam::Vec3::ONE });
    for (material, textures) in &looks {
        assert_eq!(material.opacity, Opacity::Mask { alpha: 1.0, cutoff: 0.5 }, "{textures:?}");
    }
    let leaf = image(&world, looks[0].1.color);
    let expected: Vec<_> = (0..8u8).map(|i| [i % 4, i / 4, 9, if i % 4 < 2 { 0 } else { 255 }]).collect();
    assert_eq!(pixels(&leaf), expected);
    assert_eq!(looks[0].1.color.unwrap().scale, Vec2::splat(2.0));
    assert_eq!(looks[1].1.color.unwrap().image, looks[0].1.color.unwrap().image, "made once");
    let larger = image(&world, looks[2].1.color);
    assert_eq!((larger.width, larger.height), (8, 4), "no detail is lost");
    assert_eq!(
        pixels(&larger).iter().map(|p| p[3]).collect::<Vec<_>>(),
        [0, 0, 0, 0, 255, 255, 255, 255].repeat(4)
    );
    let bare = looks[3].1.color.unwrap();
    assert_eq!(
        (bare.offset.x, looks[3].0.surface),
        (0.5, Surface::Lambert { albedo: glam::Vec3::splat(0.5) })
    );
    assert!(pixels(&image(&world, Some(bare))).iter().all(|p| p[..3] == [255; 3]));
    survives_saving(&world, folder);
}

#[test]
fn what_is_missing_of_a_masked_picture_is_told_once_and_the_rest_is_used() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    save_picture(&folder.join("leaf.png"), 2, 2, |_, _| [1, 2, 3, 255]);
    save_picture(&folder.join("mask.png"), 2, 2, |x, _| [0, 0, 0, 255 * x as u8]);
    fs::write(folder.join("broken.png"), b"\x89PNG\r\n\x1a\nno more").unwrap();
    let mtl = "newmtl a\nmap_Kd leaf.png\nmap_d none.png\n\
        newmtl b\nmap_Kd leaf.png\nmap_d none.png\n\
        newmtl c\nmap_Kd leaf.png\nmap_d broken.png\n\
        newmtl d\nmap_Kd leaf.png\nmap_d broken.png\n\
        newmtl e\nmap_Kd broken.png\nmap_d mask.png\n\
        newmtl f\nmap_Kd broken.png\nmap_d broken.png\n\
        newmtl g\nmap_d ../mask.png\nbump broken.png\n\
        newmtl h\nbump broken.png\n";
    let (mut world, report) = load_with_materials(folder, mtl);
    assert_eq!(report.warnings.len(), 3, "{report:?}");
    for (line, name) in report.warnings.iter().zip(["none.png", "broken.png", "../mask.png"]) {
        assert!(line.contains(&format!("texture \"{name}\"")) && line.ends_with("it is left out"), "{line}");
    }
    let looks = looks(&mut world);
    for (_, textures) in &looks[..4] {
        assert_eq!(pixels(&image(&world, textures.color)), [[1, 2, 3, 255]; 4]);
    }
    let white = [[255, 255, 255, 0], [255; 4]].repeat(2);
    assert_eq!(pixels(&image(&world, looks[4].1.color)), white);
    assert!(looks[5..].iter().all(|(_, textures)| *textures == MaterialTextures::default()));
    survives_saving(&world, folder);
}

#[test]
fn heights_become_normals_and_normal_maps_stay() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    save_picture(&folder.join("ramp.png"), 16, 4, |x, _| [10 * x as u8, 10 * x as u8, 10 * x as u8, 255]);
    save_picture(&folder.join("normal.png"), 4, 4, |_, _| [128, 128, 255, 255]);
    let mtl = "newmtl grey\nmap_Bump -bm 0.5 ramp.png\n\
        newmtl again\nbump -bm -2 ramp.png\nmap_Ks ramp.png\n\
        newmtl blue\nmap_bump -bm 0.25 normal.png\n\
        newmtl norm\nnorm normal.png\nbump ramp.png\n\
        newmtl late\nmap_Ks ramp.png\nbump ramp.png\n";
    let (mut world, report) = load_with_materials(folder, mtl);
    assert!(report.warnings.is_empty() && report.ignored.is_empty(), "{report:?}");
    assert_eq!(report.used.last().unwrap(), "3 texture images", "{report:?}");
    let looks = looks(&mut world);
    let normal = |k: usize| looks[k].1.normal.unwrap();
    assert_eq!([0, 1, 2, 3].map(|k| normal(k).normal_scale), [0.5, -2.0, 0.25, 1.0]);
    assert_eq!(normal(0).image, normal(1).image);
    assert_eq!(normal(0).image, normal(4).image);
    assert_eq!(normal(2).image, normal(3).image);
    // Four texels high where white is: 40 / 255 up per texel to the right, so that the normal leans to the left.
    let ramp = image(&world, Some(normal(0)));
    let [x, y, z, _] = pixels(&ramp)[5].map(|code| f32::from(code) / 127.5 - 1.0);
    assert!((x / z + 40.0 / 255.0).abs() < 0.01 && y.abs() < 0.01, "{x} {y} {z}");
    assert_eq!(pixels(&image(&world, Some(normal(3)))), [[128, 128, 255, 255]; 16]);
    survives_saving(&world, folder);
}

#[test]
fn pictures_too_large_to_be_mixed_are_refused_by_their_headers() {
    let folder = tempfile::tempdir().unwrap();
    // A TGA's header without a picture: 8193 x 8192 pixels of 32 bits.
    let mut header = [0; 18];
    header[2] = 2;
    header[12..16].copy_from_slice(&[1, 32, 0, 32]);
    header[16] = 32;
    header[17] = 8;
    fs::write(folder.path().join("much.tga"), header).unwrap();
    let (_, report) = load_with_materials(
        folder.path(),
        "newmtl m\nmap_Kd much.tga\nmap_d -s 2 2 much.tga\nbump much.tga\n",
    );
    assert_eq!(report.warnings.len(), 1, "{report:?}");
    let (_, report) = load_with_materials(folder.path(), "newmtl m\nbump much.tga\n");
    let expected = "is too large to make another picture of: it needs 257 MiB, and 256 MiB are the most";
    assert!(report.warnings.iter().any(|line| line.contains(expected)), "{report:?}");
}
