//! Cases of what shading starts from: points and normals of triangles, and the principled model as a whole.
use glam::Vec3;
use luxel_cpu::bsdf::{self, Bsdf, Geometry};
use luxel_flat::{MATERIAL_PRINCIPLED, MATERIAL_THIN, MaterialRecord};
use luxel_geom::albedo::TABLES;
use luxel_geom::{triangle, warp};
use luxel_testkit::Random;

use crate::cases::{Case, square, xyz};
use crate::inputs::{input, point, size, unit};
use crate::judge::{Expected, Input};

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
        kind: MATERIAL_PRINCIPLED,
        flags: i.code[0],
        color: xyz(i.c).to_array(),
        roughness: i.a[3],
        metallic: i.b[3],
        transmission: i.c[3],
        ior: i.d[0],
        specular: share(0),
        specular_color: [1.0, 0.8, 0.6],
        clearcoat: share(1),
        clearcoat_roughness: 0.3 + 0.7 * share(2),
        ..MaterialRecord::default()
    }
}

pub(crate) static CASES: [Case; 4] = [
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
            Expected { key: 1, values: v.extend(pdf).to_array(), scale: [1.0, 1.0, 1.0, pdf] }
        },
        make: |r| {
            let (width, cos) = (r.log_between(1e-3, 1.0), r.log_between(1e-6, 1.0));
            Input { b: [0.0, 0.0, 0.0, width], c: [0.0, 0.0, 0.0, cos], ..square(r) }
        },
    },
    Case {
        function: "evaluate_bsdf",
        imports: "import package::bsdf::sample::{Geometry, evaluate_bsdf};
            import package::generated::shared::{MATERIAL_PRINCIPLED, SurfacePoint};
            fn share(word: u32, k: u32) -> f32 { return f32((word >> (8u * k)) & 0xffu) / 255.0; }",
        body: "var s: SurfacePoint;
            s.kind = MATERIAL_PRINCIPLED;
            s.flags = in.code.x;
            s.color = in.c.xyz;
            s.roughness = in.a.w;
            s.metallic = in.b.w;
            s.transmission = in.c.w;
            s.ior = in.d.x;
            s.specular = share(in.code.w, 0u);
            s.specular_color = vec3f(1.0, 0.8, 0.6);
            s.clearcoat = share(in.code.w, 1u);
            s.clearcoat_roughness = 0.3 + 0.7 * share(in.code.w, 2u);
            let up = vec3f(0.0, 0.0, 1.0);
            let value = evaluate_bsdf(s, Geometry(in.a.xyz, up, up, in.code.y == 1u), in.b.xyz);
            return give(vec4f(value.f_cos, value.pdf), 1u);",
        twin: |i| {
            let up = Vec3::Z;
            let geometry = Geometry { wo: xyz(i.a), normal: up, geometric: up, front: i.code[1] == 1 };
            let value = bsdf::evaluate(&Bsdf::<f32>::of(&material(i)), &geometry, xyz(i.b), &TABLES);
            let scale = value.f_cos.max_element() + value.pdf;
            Expected::scaled(1, value.f_cos.extend(value.pdf).to_array(), scale)
        },
        make: |r| {
            let mut direction = |least: f32| {
                let v = unit(r);
                Vec3::new(v.x, v.y, v.z.signum() * v.z.abs().max(least)).normalize()
            };
            let (wo, wi) = (direction(0.02), direction(0.02));
            let wo = Vec3::new(wo.x, wo.y, wo.z.abs());
            // All or nothing, or well between: the smaller of two shares is one minus the larger.
            let mut ends = || [0.0, 1.0, r.between(0.1, 0.9)][r.below(3) as usize];
            let (metal, clear) = (ends(), ends());
            let color = Vec3::new(r.between(0.2, 1.0), r.between(0.2, 1.0), r.between(0.2, 1.0));
            let vectors = input([
                (wo, r.between(0.3, 1.0)),
                (wi, metal),
                (color, clear),
                (Vec3::new(r.between(1.3, 2.4), 0.0, 0.0), 0.0),
            ]);
            let thin = if r.below(4) == 0 { MATERIAL_THIN } else { 0 };
            Input { code: [thin, r.below(2), 0, r.word()], ..vectors }
        },
    },
];
