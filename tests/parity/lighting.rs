//! Cases of light: which light is picked, how each kind is sampled, and what arrives from outside the scene.
use glam::Vec3;
use luxel_cpu::lights::{self, Receiver};
use luxel_cpu::sky;
use luxel_flat::{Counters, FeatureSet, LIGHT_TRIANGLE};
use luxel_geom::octahedral;
use luxel_testkit::Random;

use crate::cases::{Case, xyz};
use crate::inputs::{input, unit};
use crate::judge::{Expected, Input};
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

/// A direction, every second near a sun, and a density.
fn sky_direction(r: &mut Random) -> Input {
    let suns = &SCENE.lights.as_slice()[..SCENE.params.distant_count as usize];
    let sun = Vec3::from_array(suns[r.below(suns.len() as u32) as usize].position);
    let direction = if r.below(2) == 0 { (sun + unit(r) * r.uniform() * 0.5).normalize() } else { unit(r) };
    // The edge of the picture is in its one end or the other.
    let direction = if direction.x == 0.0 { Vec3::new(0.6, 0.48, 0.64) } else { direction };
    let pdf = [0.0, r.log_between(1e-3, 1e3)][r.below(2) as usize];
    input([(direction, pdf), NOTHING, NOTHING, NOTHING])
}

/// A direction that is wrong by 1 moves the place in the picture by so many texels, each as bright as the brightest.
fn step_between_texels() -> f32 {
    let params = &SCENE.params;
    let texels =
        &SCENE.environment.as_slice()[..(params.environment_width * params.environment_height) as usize];
    let brightest = texels.iter().flat_map(|texel| &texel[..3]).fold(0.0f32, |most, value| most.max(*value));
    params.environment_strength * brightest
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
            let (direction, counters) = (xyz(i.a), &mut Counters::default());
            let light = sky::gather(&SCENE, FeatureSet::ALL, direction, i.a[3], counters);
            Expected::scaled(1, light.extend(0.0).to_array(), light.max_element() + step_between_texels())
        },
        make: sky_direction,
    },
];
