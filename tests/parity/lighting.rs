//! Cases of light: which light is picked, how each kind is sampled, and what arrives from outside the scene.
use std::f32::consts::{PI, TAU};

use glam::{DVec3, Vec3};
use luxel_cpu::lights::{self, Receiver};
use luxel_cpu::sky;
use luxel_flat::{Counters, Feature, FeatureSet, LIGHT_TRIANGLE};
use luxel_geom::{equirect, octahedral};
use luxel_testkit::Random;

use crate::bounds::{ATAN2, SKY};
use crate::cases::{Case, xyz};
use crate::inputs::{input, unit};
use crate::judge::{Expected, Input, U, jitter, sway};
use crate::scene::SCENE;

const NOTHING: (Vec3, f32) = (Vec3::ZERO, 0.0);

/// A point among the lights with a normal, four numbers, and one of the lights that have a place.
fn receiver_place(r: &mut Random) -> Input {
    let point = Vec3::new(r.between(-4.0, 4.0), r.between(-6.0, 8.0), r.between(-4.0, 4.0));
    let far = if r.below(8) == 0 { r.log_between(1.0, 1e4) } else { 1.0 };
    let local = SCENE.params.light_count - SCENE.params.distant_count;
    let light = SCENE.params.distant_count + r.below(local);
    let numbers = (Vec3::new(r.uniform(), r.uniform(), r.uniform()), r.uniform());
    let vectors = input([(point * far, 0.0), numbers, (unit(r), r.log_between(0.1, 20.0)), NOTHING]);
    Input { code: [octahedral::encode(unit(r)), light, r.below(2), 0], ..vectors }
}

fn receiver(i: &Input) -> Receiver<f32> {
    Receiver { point: xyz(i.a), normal: octahedral::decode::<f32>(i.code[0]) }
}

/// A light, its way of being found (with a place or without, by scattering too or not), and what errors are relative to.
fn sampled_part(i: &Input) -> Expected {
    let counters = &mut Counters::default();
    let Some(s) = lights::sample_light(&SCENE, FeatureSet::ALL, &receiver(i), i.b, counters) else {
        return Expected::MISS;
    };
    let is_far = s.distance >= luxel_flat::FAR;
    let key = 1 + u32::from(s.is_delta) + 2 * u32::from(is_far);
    if i.code[2] == 0 {
        let values = s.wi.extend(s.pdf).to_array();
        return Expected { key, values, scale: [1.0, 1.0, 1.0, s.pdf] };
    }
    let reach = xyz(i.a).length() + s.distance;
    let values = [s.radiance.x, s.radiance.y, if is_far { 0.0 } else { s.target.x }, s.radiance.z];
    let brightest = s.radiance.max_element();
    Expected { key, values, scale: [brightest, brightest, if is_far { 1.0 } else { reach }, brightest] }
}

/// A direction, every second near a sun, and a density; and the direction again, in which the picture is looked at.
fn sky_direction(r: &mut Random) -> Input {
    let suns = &SCENE.lights.as_slice()[..SCENE.params.distant_count as usize];
    let sun = Vec3::from_array(suns[r.below(suns.len() as u32) as usize].position);
    let direction = if r.below(2) == 0 { (sun + unit(r) * r.uniform() * 0.5).normalize() } else { unit(r) };
    // The edge of the picture is in its one end or the other.
    let direction = if direction.x == 0.0 { Vec3::new(0.6, 0.48, 0.64) } else { direction };
    let pdf = [0.0, r.log_between(1e-3, 1e3)][r.below(2) as usize];
    input([(direction, pdf), (direction, 0.0), NOTHING, NOTHING])
}

/// What a direction's azimuth and polar angle may be wrong by, in u, both sides together: it is turned into the picture
/// with two products and a sum (6u + 3u, 13u across), in parts of its level length for the azimuth; that length takes 15u
/// more for the polar angle; and WGSL's atan2 is wrong by a share of the angle.
fn angle_errors(direction: Vec3) -> [f32; 2] {
    let level = direction.x.hypot(direction.z);
    [ATAN2 * PI + 13.0 / level, ATAN2 * level.atan2(direction.y) + 28.0]
}

/// The same but for rounding. The rim of a sun is met without an angle, so what meets the suns is jittered; the cell of the
/// picture is told by its angles, so there the direction may be one in the next cell, if that is within their errors.
pub(crate) fn near_sky(i: &Input, by: f32, random: &mut Random) -> Input {
    let direction = xyz(i.b);
    let other = turned(direction, random);
    let cell = |d: Vec3| picture_place(d).map(|place| place.floor() as i32);
    let b = if cell(other) == cell(direction) { i.b } else { other.extend(0.0).to_array() };
    Input { b, ..jitter(i, by, random) }
}

/// The direction turned by no more than its angles may be wrong by.
fn turned(direction: Vec3, random: &mut Random) -> Vec3 {
    let [azimuth, polar] = angle_errors(direction).map(|error| f64::from(U * error * sway(random)));
    let (level, height) = (f64::from(direction.x).hypot(direction.z.into()), f64::from(direction.y));
    let (sine, cosine) = (level.atan2(height) + polar).sin_cos();
    let (x, z) = (f64::from(direction.x).atan2(direction.z.into()) + azimuth).sin_cos();
    DVec3::new(sine * x, cosine, sine * z).as_vec3()
}

/// Where a direction is in the picture, in cells from its upper left corner.
fn picture_place(direction: Vec3) -> [f32; 2] {
    let params = &SCENE.params;
    let (cos, sin) = (params.environment_cos, params.environment_sin);
    let (x, z) = (cos * direction.x - sin * direction.z, sin * direction.x + cos * direction.z);
    let (u, v) = equirect::direction_to_equirect::<f32>(Vec3::new(x, direction.y, z));
    [u * params.environment_width as f32, v * params.environment_height as f32]
}

/// The largest differences of texels that are neighbours, across and down, around a direction's place.
fn steps_near(direction: Vec3) -> [Vec3; 2] {
    let params = &SCENE.params;
    let [width, height] = [params.environment_width, params.environment_height].map(|size| size as i32);
    let corner = picture_place(direction).map(|place| (place - 0.5).floor() as i32);
    let texel = |column: i32, row: i32| {
        let index = row.clamp(0, height - 1) * width + column.rem_euclid(width);
        Vec3::from_slice(&SCENE.environment.as_slice()[index as usize][..3])
    };
    let around = (-1..=2).flat_map(|down| (-1..=2).map(move |across| (across, down)));
    around.fold([Vec3::ZERO; 2], |[across, down], (i, j)| {
        let (column, row) = (corner[0] + i, corner[1] + j);
        let here = texel(column, row);
        [across.max((texel(column + 1, row) - here).abs()), down.max((texel(column, row + 1) - here).abs())]
    })
}

/// Errors of [`sky::gather`] in u, both sides together. All terms are positive, so theirs are shares of the result: a weight
/// is a density (13u), a quotient (18u), its square (38u), a sum (21u of it) and a quotient (64u, in Rust 22u), and light is
/// two mixtures, two products and a sum of three (22u + 11u). The place in the picture is off by its angles and 8u, and the
/// light by that many steps between texels; but never by more than [`SKY`] of the light and the brightest texel.
fn sky_errors(direction: Vec3, light: Vec3) -> Vec3 {
    let params = &SCENE.params;
    let [azimuth, polar] = angle_errors(direction);
    let across = params.environment_width as f32 * (azimuth / TAU + 8.0);
    let down = params.environment_height as f32 * (polar / PI + 8.0);
    let [step_across, step_down] = steps_near(direction);
    let errors = light * 128.0 + (step_across * across + step_down * down) * params.environment_strength;
    errors.min(Vec3::splat(SKY * (light.max_element() + params.environment_strength * brightest_texel())))
}

fn brightest_texel() -> f32 {
    let params = &SCENE.params;
    let texels =
        &SCENE.environment.as_slice()[..(params.environment_width * params.environment_height) as usize];
    texels.iter().flat_map(|texel| &texel[..3]).fold(0.0f32, |most, value| most.max(*value))
}

pub(crate) static CASES: [Case; 4] = [
    Case {
        function: "sample_light_tree",
        imports: "import package::bindings::lights; import package::lights::light::make_receiver;
            import package::lights::tree::{light_tree_probability, sample_light_tree};",
        body: "let receiver = make_receiver(in.a.xyz, in.code.x);
            let picked = sample_light_tree(receiver, in.b.x);
            let other = light_tree_probability(lights[in.code.y].trail, receiver);
            return give(vec4f(picked.probability, other, 0.0, 0.0), 1u + picked.light);",
        twin: |i| {
            let counters = &mut Counters::default();
            let (light, own) = lights::pick_in_tree(&SCENE, &receiver(i), i.b[0], counters).unwrap();
            let trail = SCENE.lights.as_slice()[i.code[1] as usize].trail;
            let other = lights::tree_probability(&SCENE, trail, &receiver(i), counters);
            Expected::relative(1 + light, [own, other, 0.0, 0.0])
        },
        make: receiver_place,
    },
    Case {
        function: "sample_light",
        imports: "import package::generated::shared::FAR; import package::lights::light::make_receiver;
            import package::lights::sample::sample_light;",
        body: "let s = sample_light(make_receiver(in.a.xyz, in.code.x), in.b);
            let is_far = s.distance >= FAR;
            let values = vec4f(s.radiance.xy, select(s.aim.x, 0.0, is_far), s.radiance.z);
            return give(select(values, vec4f(s.wi, s.pdf), in.code.z == 0u),
                select(0u, 1u + u32(s.is_delta) + 2u * u32(is_far), s.pdf > 0.0));",
        twin: sampled_part,
        make: receiver_place,
    },
    Case {
        function: "light_pdf",
        imports: "import package::lights::light::make_receiver; import package::lights::sample::light_pdf;",
        body: "let pdf = light_pdf(in.code.y, make_receiver(in.a.xyz, in.code.x), in.c.xyz * in.c.w);
            return give(vec4f(pdf, 0.0, 0.0, 0.0), 1u);",
        twin: |i| {
            let offset = xyz(i.c) * i.c[3];
            let counters = &mut Counters::default();
            let features = FeatureSet::ALL;
            let pdf = lights::light_pdf(&SCENE, features, i.code[1], &receiver(i), offset, counters);
            let light = &SCENE.lights.as_slice()[i.code[1] as usize];
            let normal = Vec3::from_array(light.edge1).cross(Vec3::from_array(light.edge2));
            // A plane that is nearly seen edge-on.
            let cancelled = offset.abs().dot(normal.abs()) / offset.dot(normal).abs().max(f32::MIN_POSITIVE);
            let cancelled = if light.kind == LIGHT_TRIANGLE { cancelled.max(1.0) } else { 1.0 };
            Expected::scaled(1, [pdf, 0.0, 0.0, 0.0], pdf * cancelled)
        },
        make: receiver_place,
    },
    Case {
        function: "sky_light",
        imports: "import package::trace::sky::sky_light;",
        body: "return give(vec4f(sky_light(in.a.xyz, in.a.w), 0.0), 1u);",
        twin: |i| {
            let (direction, counters) = (xyz(i.b), &mut Counters::default());
            let without_suns = FeatureSet::ALL.with(Feature::DistantLights, false);
            let light = lights::gather_distant::<f32>(&SCENE, FeatureSet::ALL, xyz(i.a), i.a[3])
                + sky::gather::<f32>(&SCENE, without_suns, direction, i.a[3], counters);
            let scale = sky_errors(direction, light).extend(0.0).to_array();
            Expected { key: 1, values: light.extend(0.0).to_array(), scale }
        },
        make: sky_direction,
    },
];
