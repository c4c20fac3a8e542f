//! Cases of what shading starts from: points and normals of triangles, and the principled model as a whole.
use glam::Vec3;
use luxel_cpu::bsdf::{self, Bsdf, Geometry};
use luxel_flat::{
    Counters, MATERIAL_DIELECTRIC, MATERIAL_LAMBERT, MATERIAL_METAL, MATERIAL_PRINCIPLED, MATERIAL_SCHLICK,
    MATERIAL_SEMI_SPECULAR, MATERIAL_THIN, MaterialRecord,
};
use luxel_geom::albedo::TABLES;
use luxel_geom::{triangle, warp};
use luxel_testkit::Random;

use crate::bounds::{LEVEL, SINE};
use crate::cases::{Case, square, xyz};
use crate::inputs::{input, point, size, unit};
use crate::judge::{Expected, Input, U};

/// A triangle of some size anywhere; the weights of a point of it, often on an edge; and a drift.
fn triangle_place(r: &mut Random) -> Input {
    let (at, size) = (point(r), size(r));
    let [a, b, c] = [(); 3].map(|()| at + size * Vec3::new(r.uniform(), r.uniform(), r.uniform()));
    let u = [0.0, r.uniform(), r.uniform()][r.below(3) as usize];
    let v = [0.0, 1.0, r.uniform(), r.uniform()][r.below(4) as usize] * (1.0 - u);
    input([(a, u), (b, v), (c, 1e-6 * at.abs().max_element()), (Vec3::ZERO, 0.0)])
}

fn vertices(i: &Input) -> [Vec3; 3] {
    [xyz(i.a), xyz(i.b), xyz(i.c)]
}

/// The material of a call: colour, metal and transmission in `c`, the rest in the words.
fn material(i: &Input) -> MaterialRecord {
    let share = |k: usize| (i.code[3] >> (8 * k) & 0xff) as f32 / 255.0;
    MaterialRecord {
        kind: i.code[0] >> 16,
        flags: i.code[0] & 0xffff,
        color: xyz(i.c).to_array(),
        roughness: i.a[3],
        metallic: i.b[3],
        transmission: i.c[3],
        ior: i.d[0],
        specular: share(0),
        specular_color: [1.0, 0.8, 0.6],
        clearcoat: share(1),
        clearcoat_roughness: if share(2) < 0.1 { 0.0 } else { 0.3 + 0.7 * share(2) },
        ..MaterialRecord::default()
    }
}

/// How the material is seen: the geometric normal is +Z, the shading normal in `d`.
fn geometry(i: &Input) -> Geometry<f32> {
    let normal = Vec3::new(i.d[1], i.d[2], i.d[3]);
    Geometry { wo: xyz(i.a), normal, geometric: Vec3::Z, front: i.code[1] == 1 }
}

/// The twins of [`material`] and [`geometry`].
const SCATTERING: &str = "import package::bsdf::sample::{Geometry, evaluate_bsdf, sample_bsdf};
    import package::generated::shared::SurfacePoint;
    fn share(word: u32, k: u32) -> f32 { return f32((word >> (8u * k)) & 0xffu) / 255.0; }
    fn material(in: Input) -> SurfacePoint {
        var s: SurfacePoint;
        s.kind = in.code.x >> 16u;
        s.flags = in.code.x & 0xffffu;
        s.color = in.c.xyz;
        s.roughness = in.a.w;
        s.metallic = in.b.w;
        s.transmission = in.c.w;
        s.ior = in.d.x;
        s.specular = share(in.code.w, 0u);
        s.specular_color = vec3f(1.0, 0.8, 0.6);
        s.clearcoat = share(in.code.w, 1u);
        let coat = share(in.code.w, 2u);
        s.clearcoat_roughness = select(0.3 + 0.7 * coat, 0.0, coat < 0.1);
        return s;
    }
    fn geometry(in: Input) -> Geometry {
        return Geometry(in.a.xyz, in.d.yzw, vec3f(0.0, 0.0, 1.0), in.code.y == 1u);
    }";

/// A direction that is not grazing.
fn steep(r: &mut Random) -> Vec3 {
    let v = unit(r);
    Vec3::new(v.x, v.y, v.z.signum() * v.z.abs().max(0.02)).normalize()
}

/// A principled material seen from above, and another direction.
fn principled_place(r: &mut Random) -> Input {
    let (wo, wi) = (steep(r), steep(r));
    let wo = Vec3::new(wo.x, wo.y, wo.z.abs());
    // All or nothing, or well between: the smaller of two shares is one minus the larger.
    let mut ends = || [0.0, 1.0, r.between(0.1, 0.9)][r.below(3) as usize];
    let (metal, clear) = (ends(), ends());
    let color = Vec3::new(r.between(0.2, 1.0), r.between(0.2, 1.0), r.between(0.2, 1.0));
    let vectors = input([
        (wo, r.between(0.3, 1.0)),
        (wi, metal),
        (color, clear),
        (Vec3::new(r.between(1.3, 2.4), 0.0, 0.0), 1.0),
    ]);
    let thin = if r.below(4) == 0 { MATERIAL_THIN } else { 0 };
    Input { code: [thin | MATERIAL_PRINCIPLED << 16, r.below(2), 0, r.word()], ..vectors }
}

/// A material, most often principled, with a shading normal of its own, and three numbers; smooth ones among them.
fn scattering_place(r: &mut Random) -> Input {
    let Input { mut a, mut b, d, code, .. } = principled_place(r);
    let kinds = [MATERIAL_LAMBERT, MATERIAL_METAL, MATERIAL_DIELECTRIC, MATERIAL_SEMI_SPECULAR];
    let kind = [MATERIAL_PRINCIPLED; 12].into_iter().chain(kinds).nth(r.below(16) as usize).unwrap();
    let flags = if r.below(2) == 0 { MATERIAL_SCHLICK } else { 0 };
    a[3] *= f32::from(u8::from(r.below(4) > 0));
    b[..3].copy_from_slice(&[r.uniform(), r.uniform(), r.uniform()]);
    let normal = (Vec3::Z + unit(r) * r.between(0.0, 0.7)).normalize();
    let words = [code[0] & 0xffff | flags | kind << 16, code[1], r.below(2), code[3]];
    let given = principled_place(r);
    Input { a, b, c: given.c, d: [d[0], normal.x, normal.y, normal.z], code: words }
}

/// Errors of [`warp::level_hemisphere`] in u, both sides together: of x and y, and of z. The logarithm is wrong by 6u and
/// its argument by 9u, so the exponent x by 29u of itself; exp by (6 + 4x)u; so the square of the cosine by
/// w²((33x + 7)eˣ + 3) and 6u of itself. Roots of numbers that are d apart are apart by √d at most, and by d in parts of the
/// root. The angle adds WGSL's sin and cos and 20u.
fn level_errors(width: f32, u0: f32, direction: Vec3) -> [f32; 2] {
    let square = width * width;
    let exponent = u0 * (1.0 + 1.0 / square).ln();
    let off = square * ((33.0 * exponent + 7.0) * exponent.exp() + 3.0) + 6.0 * direction.z * direction.z;
    let of_root = |root: f32| 12.0 + (off / root.max(f32::MIN_POSITIVE)).min((off / U).sqrt());
    let sine = direction.truncate().length();
    [of_root(sine) + (SINE + 20.0) * sine, of_root(direction.z)].map(|errors| errors.min(LEVEL))
}

pub(crate) static CASES: [Case; 5] = [
    Case {
        function: "area_normal",
        imports: "import package::geom::triangle::area_normal;",
        body: "return give(vec4f(area_normal(in.a.xyz, in.b.xyz, in.c.xyz), 0.0), 1u);",
        twin: |i| {
            let [a, b, c] = vertices(i);
            let square = (b - a).length_squared().max((c - b).length_squared()).max((a - c).length_squared());
            Expected::scaled(1, triangle::area_normal::<f32>(&[a, b, c]).extend(0.0).to_array(), square)
        },
        make: triangle_place,
    },
    Case {
        function: "triangle_point_inside",
        imports: "import package::geom::triangle::triangle_point_inside;",
        body: "let p = triangle_point_inside(in.a.xyz, in.b.xyz, in.c.xyz, vec2f(in.a.w, in.b.w), vec3f(in.c.w));
            return give(vec4f(p.point, p.error.x), 1u);",
        twin: |i| {
            let corners = vertices(i);
            let (p, error) = triangle::point_inside(&corners, i.a[3], i.b[3], Vec3::splat(i.c[3]));
            let reach = corners.iter().fold(0.0f32, |reach, corner| reach.max(corner.abs().max_element()));
            Expected { key: 1, values: p.extend(error.x).to_array(), scale: [reach, reach, reach, error.x] }
        },
        make: triangle_place,
    },
    Case {
        function: "level_hemisphere",
        imports: "import package::geom::warp::{level_hemisphere, level_hemisphere_pdf};",
        body: "return give(vec4f(level_hemisphere(in.b.w, in.a.x, in.a.y), level_hemisphere_pdf(in.b.w, in.c.w)), 1u);",
        twin: |i| {
            let v: Vec3 = warp::level_hemisphere(i.b[3], i.a[0], i.a[1]);
            let pdf = warp::level_hemisphere_pdf(i.b[3], i.c[3]);
            let [level, upright] = level_errors(i.b[3], i.a[0], v);
            // Nine operations, two of them on the logarithm.
            let scale = [level, level, upright, 64.0 * pdf];
            Expected { key: 1, values: v.extend(pdf).to_array(), scale }
        },
        make: |r| {
            let (width, cos) = (r.log_between(1e-3, 1.0), r.log_between(1e-6, 1.0));
            Input { b: [0.0, 0.0, 0.0, width], c: [0.0, 0.0, 0.0, cos], ..square(r) }
        },
    },
    Case {
        function: "evaluate_bsdf",
        imports: SCATTERING,
        body: "let value = evaluate_bsdf(material(in), geometry(in), in.b.xyz);
            return give(vec4f(value.f_cos, value.pdf), 1u);",
        twin: |i| {
            let value = bsdf::evaluate(&Bsdf::<f32>::of(&material(i)), &geometry(i), xyz(i.b), &TABLES);
            let scale = value.f_cos.max_element() + value.pdf;
            Expected::scaled(1, value.f_cos.extend(value.pdf).to_array(), scale)
        },
        make: principled_place,
    },
    Case {
        function: "sample_bsdf",
        imports: SCATTERING,
        body: "let s = sample_bsdf(material(in), geometry(in), in.b.xyz);
            let key = 1u + u32(s.pdf == 0.0) + 2u * u32(s.wi.z < 0.0);
            return give(select(vec4f(s.weight, s.eta_scale), vec4f(s.wi, s.pdf), in.code.z == 0u),
                select(key, 0u, s.eta_scale == 0.0));",
        twin: |i| {
            let [u0, u1, u2, _] = i.b;
            let bsdf = Bsdf::<f32>::of(&material(i));
            let sampled = bsdf::sample(&bsdf, &geometry(i), [u0, u1, u2], &TABLES, &mut Counters::default());
            let Some(s) = sampled else { return Expected::MISS };
            let key = 1 + u32::from(s.pdf == 0.0) + 2 * u32::from(s.wi.z < 0.0);
            if i.code[2] == 0 {
                let values = s.wi.extend(s.pdf).to_array();
                return Expected { key, values, scale: [1.0, 1.0, 1.0, s.pdf] };
            }
            let weight = s.weight.max_element();
            let values = s.weight.extend(s.eta_scale).to_array();
            Expected { key, values, scale: [weight, weight, weight, s.eta_scale] }
        },
        make: scattering_place,
    },
];
