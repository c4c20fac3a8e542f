//! Cases of bodies inside bodies: what a surface is to a path, the bodies that a ray is in beyond it, and what they absorb.
use glam::Vec3;
use luxel_cpu::PathState;
use luxel_cpu::bsdf::Bsdf;
use luxel_cpu::medium::{Media, media_towards, medium_transmittance, met_by};
use luxel_cpu::surface::{Place, Surface};
use luxel_flat::{
    Counters, FeatureSet, MATERIAL_DIELECTRIC, MATERIAL_LAMBERT, MATERIAL_PRINCIPLED, MATERIAL_THIN,
    MaterialRecord, NONE,
};
use luxel_geom::Ray;
use luxel_testkit::Random;

use crate::bounds::ABSORPTION;
use crate::cases::{Case, xyz};
use crate::inputs::{input, unit};
use crate::judge::{Expected, Input};
use crate::scene::SCENE;

const NOTHING: (Vec3, f32) = (Vec3::ZERO, 0.0);

/// A path in up to four bodies, innermost first, that meets a surface from any side, and a direction in which it goes on.
/// In the words are the bodies, a byte each, the surface's body (every second time one of those that the path is in), and
/// its kind and flags.
fn border(r: &mut Random) -> Input {
    let mut slots: Vec<u32> = (0..SCENE.materials.len() as u32).collect();
    r.shuffle(&mut slots[..]);
    let count = r.below(5);
    let media = (0..4).zip(&slots).map(|(k, slot)| if k < count { slot << (8 * k) } else { 0xff << (8 * k) });
    let among = [4, slots.len() as u32][r.below(2) as usize];
    let body = slots[r.below(among) as usize];
    let body = if r.below(16) == 0 { NONE } else { body };
    let kinds = [MATERIAL_DIELECTRIC, MATERIAL_PRINCIPLED, MATERIAL_PRINCIPLED, MATERIAL_LAMBERT];
    let flags = if r.below(4) == 0 { MATERIAL_THIN } else { 0 };
    let look = kinds[r.below(4) as usize] | flags << 8;
    let transmission = [0.0, 1.0, r.uniform(), r.uniform()][r.below(4) as usize];
    let vectors = input([(unit(r), transmission), (unit(r), r.between(1.0, 2.5)), (unit(r), 0.0), NOTHING]);
    Input { code: [media.sum(), body, look, 0], ..vectors }
}

fn path(i: &Input) -> PathState<f32> {
    let bodies = [0, 1, 2, 3].map(|k| i.code[0] >> (8 * k) & 0xff);
    let media = Media(bodies.map(|body| if body == 0xff { NONE } else { body }));
    PathState { media, ..PathState::start(0, 0, Ray::new(Vec3::ZERO, xyz(i.a))) }
}

fn surface(i: &Input) -> Surface<f32> {
    let material = MaterialRecord {
        kind: i.code[2] & 0xff,
        flags: i.code[2] >> 8,
        transmission: i.a[3],
        ior: i.b[3],
        ..MaterialRecord::default()
    };
    Surface {
        place: Place { point: Vec3::ZERO, error: Vec3::ZERO, normal: xyz(i.b) },
        shading_normal: xyz(i.b),
        bsdf: Bsdf::of(&material),
        emission: Vec3::ZERO,
        light: NONE,
        body: i.code[1],
    }
}

/// The twins of [`path`] and [`surface`].
const BORDER: &str = "import package::bsdf::sample::facing;
    import package::generated::shared::{NONE, Path, SurfacePoint};
    import package::trace::medium::{media_towards, met_by};
    fn path(in: Input) -> Path {
        var p: Path;
        p.direction = in.a.xyz;
        let bodies = (vec4u(in.code.x) >> vec4u(0u, 8u, 16u, 24u)) & vec4u(0xffu);
        p.media = select(bodies, vec4u(NONE), bodies == vec4u(0xffu));
        return p;
    }
    fn surface(in: Input) -> SurfacePoint {
        var s: SurfacePoint;
        s.normal = in.b.xyz;
        s.shading_normal = in.b.xyz;
        s.kind = in.code.z & 0xffu;
        s.flags = in.code.z >> 8u;
        s.transmission = in.a.w;
        s.ior = in.b.w;
        s.body = in.code.y;
        return s;
    }";

pub(crate) static CASES: [Case; 3] = [
    Case {
        function: "met_by",
        imports: BORDER,
        body: "let met = met_by(path(in), surface(in));
            return give(vec4f(met.ior, 0.0, 0.0, 0.0), 1u + met.kind + 16u * (met.body + 1u));",
        twin: |i| {
            let met = met_by(&SCENE, FeatureSet::ALL, &path(i), &surface(i));
            let key = 1 + met.bsdf.kind + 16 * met.body.wrapping_add(1);
            Expected::relative(key, [met.bsdf.ior, 0.0, 0.0, 0.0])
        },
        make: border,
    },
    Case {
        function: "media_towards",
        imports: BORDER,
        body: "let s = surface(in);
            let there = media_towards(path(in).media, s, facing(s, in.a.xyz), in.c.xyz);
            return give(2.0 + vec4f(bitcast<vec4i>(there)), 1u);",
        twin: |i| {
            let surface = surface(i);
            let there = media_towards(path(i).media, &surface, &surface.facing(xyz(i.a)), xyz(i.c));
            Expected::relative(1, there.0.map(|body| 2.0 + body.cast_signed() as f32))
        },
        make: border,
    },
    Case {
        function: "medium_transmittance",
        imports: "import package::trace::medium::medium_transmittance;",
        body: "return give(vec4f(medium_transmittance(in.code.x, in.a.x), 0.0), 1u);",
        twin: |i| {
            let counters = &mut Counters::default();
            let left = medium_transmittance(&SCENE, FeatureSet::ALL, i.code[0], i.a[0], counters);
            // The product (2u + 1u of the exponent), exp ((3 + 2x) ulp in WGSL, 2u in Rust): (8 + 7x) u.
            let scale = left.map(|share| share * (8.0 - 7.0 * share.ln()).min(ABSORPTION));
            Expected { key: 1, values: left.extend(0.0).to_array(), scale: scale.extend(0.0).to_array() }
        },
        make: |r| {
            let distance = [0.0, r.log_between(1e-3, 1e3), r.uniform(), r.uniform()][r.below(4) as usize];
            let medium = [NONE, r.below(SCENE.materials.len() as u32)][usize::from(r.below(8) > 0)];
            Input { a: [distance, 0.0, 0.0, 0.0], code: [medium, 0, 0, 0], ..Input::default() }
        },
    },
];
