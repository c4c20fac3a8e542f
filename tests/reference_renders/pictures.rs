//! The pictures that Mitsuba 3 converged to, and ours of the same scenes.
//!
//! Compared are all five: the whole of `test_directional` and `test_textured_diffuse`; of `test_constant` and
//! `test_arealight` the diffuse and the wooden ball, the diamond, the leaves and all around; of
//! `test_roughplastic_linear` the museum behind the balls. What Luxel has no model of does not apply and is told beside
//! its reference, with the nearest that Luxel has: Beckmann's microfacets (ours are GGX), conductors (ours are
//! Schlick's metal of glTF), plastic (Mitsuba's has light reflected inside the coat; ours is coupled by directional
//! albedos), and rough glass (Mitsuba's masks both directions apart and loses what scatters more than once).
//!
//! With `LUXEL_SOAK=1` there are 32 times as many samples: more than the references have.
use bevy_ecs::prelude::World;
use luxel_cpu::CpuTracer;
use luxel_film::Film;

use crate::grid::{self, Body, Leaves};
use crate::judge::{Region, judge_pixels, judge_regions, mean};
use crate::mitsuba::{engine, lamp};
use crate::reference::{Picture, Reference, SIZE, xyz};
use crate::view::View;
use crate::welch::batches_of;
use crate::{single, stage};

/// The pixels of each body: those that may show a body whose model Luxel lacks are of no other.
fn regions(view: View, bodies: Vec<Body>) -> Vec<Region> {
    let mut regions: Vec<Region> =
        bodies.iter().map(|body| Region { name: body.name, lacks: body.lacks, pixels: Vec::new() }).collect();
    for pixel in 0..SIZE * SIZE {
        let seen = |body: &&(usize, &Body)| view.shows(pixel, body.1.outline);
        let all: Vec<(usize, &Body)> = bodies.iter().enumerate().collect();
        let lacking = all.iter().filter(|(_, body)| body.lacks.is_some()).find(seen);
        let (owner, _) = lacking.or_else(|| all.iter().find(seen)).unwrap();
        regions[*owner].pixels.push(pixel);
    }
    regions
}

fn render(world: World, samples: u32) -> Vec<Picture> {
    let wanted = |film: &Film| film.beauty().into_iter().map(xyz).collect();
    batches_of(&mut engine(world), &mut CpuTracer::new(), 0x8000, samples, wanted)
}

/// Holds a world's picture against a reference, and wrong pictures too.
fn check(name: &str, world: World, samples: u32, reference: &Reference, regions: &[Region]) {
    let samples =
        if std::env::var("LUXEL_SOAK").is_ok_and(|soak| soak == "1") { 32 * samples } else { samples };
    let batches = render(world, samples);
    show(name, &mean(&batches), &reference.mean);
    let judge = |batches: &[Picture]| {
        (judge_pixels(batches, samples, reference, regions), judge_regions(batches, reference, regions))
    };
    let (pixels, bodies) = judge(&batches);
    println!("{name}: {}; regions, XYZ:\n{}", pixels.text, bodies.text);
    assert!(pixels.ratio <= 1.0, "{name}: a pixel differs: {}", pixels.text);
    assert!(bodies.ratio <= 1.0, "{name}: a region differs:\n{}", bodies.text);

    let changed =
        |change: &dyn Fn(&Picture) -> Picture| -> Vec<Picture> { batches.iter().map(change).collect() };
    let scaled = |by: f64| changed(&|picture| picture.iter().map(|xyz| xyz.map(|v| by * v)).collect());
    for by in [0.98, 1.02] {
        let ratio = judge(&scaled(by)).1.ratio;
        println!("{name}: {by} times as bright: {ratio:.2} times the limit of regions");
        assert!(ratio > 1.0, "{name}: the test does not see {by} times as much light");
    }
    let turned = changed(&|picture| picture.chunks(SIZE).rev().flatten().copied().collect());
    let moved = changed(&|picture| (0..SIZE * SIZE).map(|at| picture[(at + 1) % (SIZE * SIZE)]).collect());
    for (what, wrong) in [("upside down", turned), ("one pixel aside", moved)] {
        let ratio = judge(&wrong).0.ratio;
        println!("{name}: {what}: {ratio:.2} times the limit of pixels");
        assert!(ratio > 1.0, "{name}: the test does not see that the picture is {what}");
    }
}

/// Writes both pictures for the eye, side by side, into the folder that `LUXEL_LOOK` names.
fn show(name: &str, ours: &Picture, reference: &Picture) {
    let Some(folder) = std::env::var_os("LUXEL_LOOK") else { return };
    let code = |value: f64| (255.0 * value.clamp(0.0, 1.0).powf(1.0 / 2.2)) as u8;
    let image = image::RgbImage::from_fn(20 * SIZE as u32, 10 * SIZE as u32, |x, y| {
        let (x, y) = (x as usize / 10, y as usize / 10);
        let [a, b, c] = if x < SIZE { ours[y * SIZE + x] } else { reference[y * SIZE + x - SIZE] };
        let rgb = [
            3.2405 * a - 1.5372 * b - 0.4985 * c,
            -0.9693 * a + 1.8760 * b + 0.0416 * c,
            0.0556 * a - 0.2040 * b + 1.0573 * c,
        ];
        image::Rgb(rgb.map(code))
    });
    image.save(std::path::Path::new(&folder).join(format!("{name}.png"))).unwrap();
}

#[test]
fn a_rectangle_of_light() {
    let Some(reference) = Reference::read("bsdf_spheres", "test_arealight") else { return };
    let Some(mut world) = grid::scene(Leaves::Cut) else { return };
    lamp(&mut world).unwrap();
    check("area light", world, 64, &reference, &regions(grid::view(), grid::bodies()));
}

#[test]
fn a_constant_sky() {
    let Some(reference) = Reference::read("bsdf_spheres", "test_constant") else { return };
    for leaves in [Leaves::Cut, Leaves::Whole] {
        let Some(mut world) = grid::scene(leaves) else { return };
        world.insert_resource(luxel_scene::Environment::Constant(glam::Vec3::ONE));
        let shown = |body: Body| match (leaves, body.name) {
            (Leaves::Cut, "diffuse" | "wood") => Body { lacks: Some("leaves cast whole shadows"), ..body },
            (Leaves::Whole, "leaf") => Body { lacks: Some("whole here"), ..body },
            _ => body,
        };
        let bodies = grid::bodies().into_iter().map(shown).collect();
        let name = if leaves == Leaves::Cut { "sky, leaves" } else { "sky, balls" };
        check(name, world, 32, &reference, &regions(grid::view(), bodies));
    }
}

#[test]
fn a_wooden_ball_in_a_museum() {
    let Some(reference) = Reference::read("bsdf_spheres", "test_textured_diffuse") else { return };
    let Some((world, bodies)) = single::wooden() else { return };
    check("wood", world, 32, &reference, &regions(single::view(), bodies));
}

#[test]
fn the_museum_behind_plastic() {
    let Some(reference) = Reference::read("bsdf_spheres", "test_roughplastic_linear") else { return };
    let Some((world, bodies)) = single::plastic() else { return };
    check("plastic", world, 32, &reference, &regions(single::view(), bodies));
}

#[test]
fn a_light_from_above() {
    let Some(reference) = Reference::read("floating_sphere", "test_directional") else { return };
    let Some((world, bodies)) = stage::floating() else { return };
    check("directional", world, 32, &reference, &regions(stage::view(), bodies));
}
