//! Cases of emitters, packed directions, maps and guarded normals.
use glam::Vec3;
use luxel_geom::{emitter, equirect, normal_guard, octahedral, srgb, warp};
use luxel_testkit::Random;

use crate::bounds::GUARD;
use crate::cases::{Case, square, xyz};
use crate::inputs::{input, point, size, unit};
use crate::judge::{Expected, Input};

const NOTHING: (Vec3, f32) = (Vec3::ZERO, 0.0);
/// Lengths below this say nothing.
const UNIT: f32 = crate::judge::U;

/// A sphere seen from nearby, from far away or from inside, and a point of the square.
fn sphere(r: &mut Random) -> Input {
    let radius = size(r);
    let away = [r.log_between(1e-3, 0.99), r.log_between(1.01, 10.0), r.log_between(1.0, 1e6)];
    let to_center = unit(r) * radius * away[r.below(3) as usize];
    Input { b: square(r).a, ..input([(to_center, radius), NOTHING, NOTHING, NOTHING]) }
}

/// Errors of [`normal_guard::valid_shading_normal`] in u, both sides together. The cosines are scalar products of unit
/// vectors (6u + 3u); so are the level parts wrong by 15u, and their sum `level` by 36u of the factors and, as the factors
/// are cosines, by 27u. Scaled to length one (30u, with the root and the part along `ng` 60u) that is in parts of the
/// length of `level`, and the half vector in parts of its own length, scaled with another 30u. A normal that is not
/// bent is exact.
fn guard_errors(ng: Vec3, ns: Vec3, wo: Vec3) -> f32 {
    let (cos_view, upright) = (wo.dot(ng), ns.dot(ng).max(0.0));
    let least = (0.9 * cos_view).min(0.01);
    let level = (ns - ng * ns.dot(ng)) * (least + cos_view) - (wo - ng * cos_view) * upright;
    let half = wo + level.normalize_or_zero() * (1.0 - least * least).sqrt() + ng * least;
    let of_level = 27.0 + 36.0 * (least + cos_view + upright);
    (30.0 + (60.0 + of_level / level.length().max(UNIT)) / half.length().max(UNIT)).min(GUARD)
}

fn any_word(r: &mut Random) -> Input {
    let edge = [0x8000_7fff, 0x7fff_8000, 0, u32::MAX, 0x7fff_7fff];
    let word = if r.below(4) == 0 { edge[r.below(5) as usize] } else { r.word() };
    Input { code: [word, 0, 0, 0], ..Input::default() }
}

pub(crate) static CASES: [Case; 10] = [
    Case {
        function: "uniform_triangle",
        imports: "import package::geom::warp::uniform_triangle;",
        body: "return give(vec4f(uniform_triangle(in.a.x, in.a.y), 0.0, 0.0), 1u);",
        twin: |i| {
            let (b0, b1) = warp::uniform_triangle(i.a[0], i.a[1]);
            Expected::scaled(1, [b0, b1, 0.0, 0.0], 1.0)
        },
        make: square,
    },
    Case {
        function: "uniform_cone",
        imports: "import package::geom::warp::{uniform_cone, uniform_cone_pdf};",
        body: "return give(vec4f(uniform_cone(in.b.w, in.a.x, in.a.y), uniform_cone_pdf(in.b.w)), 1u);",
        twin: |i| {
            let v: Vec3 = warp::uniform_cone(i.b[3], i.a[0], i.a[1]);
            let pdf = warp::uniform_cone_pdf(i.b[3]);
            let wide = (2.0 * i.b[3]).sqrt().min(1.0);
            Expected { key: 1, values: v.extend(pdf).to_array(), scale: [wide, wide, 1.0, pdf] }
        },
        make: |r| Input { b: [0.0, 0.0, 0.0, 2.0 * r.log_between(1e-20, 1.0)], ..square(r) },
    },
    Case {
        function: "sphere_opening",
        imports: "import package::geom::emitter::{sphere_opening, sphere_pdf};",
        body: "return give(vec4f(sphere_opening(in.a.xyz, in.a.w), sphere_pdf(in.a.xyz, in.a.w), 0.0, 0.0), 1u);",
        twin: |i| {
            let opening = emitter::sphere_opening::<f32>(xyz(i.a), i.a[3]);
            Expected::relative(1, [opening, emitter::sphere_pdf::<f32>(xyz(i.a), i.a[3]), 0.0, 0.0])
        },
        make: sphere,
    },
    Case {
        function: "sample_sphere",
        imports: "import package::geom::emitter::sample_sphere;",
        body: "let s = sample_sphere(in.a.xyz, in.a.w, in.b.x, in.b.y);
            return give(vec4f(s.wi, s.distance), 1u);",
        twin: |i| {
            let s = emitter::sample_sphere::<f32>(xyz(i.a), i.a[3], i.b[0], i.b[1]);
            let reach = xyz(i.a).length() + i.a[3];
            Expected { key: 1, values: s.wi.extend(s.distance).to_array(), scale: [1.0, 1.0, 1.0, reach] }
        },
        make: sphere,
    },
    Case {
        function: "triangle_pdf",
        imports: "import package::geom::emitter::triangle_pdf;",
        body: "return give(vec4f(triangle_pdf(in.a.xyz, in.b.xyz), 0.0, 0.0, 0.0), 1u);",
        twin: |i| {
            let (offset, edges) = (xyz(i.a), xyz(i.b));
            let pdf = emitter::triangle_pdf::<f32>(offset, edges);
            let cancelled = offset.abs().dot(edges.abs()) / offset.dot(edges).abs().max(f32::MIN_POSITIVE);
            Expected::scaled(1, [pdf, 0.0, 0.0, 0.0], pdf * cancelled.max(1.0))
        },
        make: |r| input([(point(r), 0.0), (unit(r) * size(r), 0.0), NOTHING, NOTHING]),
    },
    Case {
        function: "decode_direction",
        imports: "import package::geom::octahedral::decode_direction;",
        body: "return give(vec4f(decode_direction(in.code.x), 0.0), 1u);",
        twin: |i| {
            let v: Vec3 = octahedral::decode::<f32>(i.code[0]);
            Expected::scaled(1, v.extend(0.0).to_array(), 1.0)
        },
        make: any_word,
    },
    Case {
        function: "decode_tangent",
        imports: "import package::geom::octahedral::decode_tangent;",
        body: "let t = decode_tangent(in.code.x); return give(vec4f(t.direction, t.side), 1u);",
        twin: |i| {
            let (v, side) = octahedral::decode_tangent::<f32>(i.code[0]);
            Expected::scaled(1, v.extend(side).to_array(), 1.0)
        },
        make: any_word,
    },
    Case {
        function: "srgb_decode",
        imports: "import package::geom::srgb::srgb_decode;",
        body: "return give(vec4f(srgb_decode(in.a.x), 0.0, 0.0, 0.0), 1u);",
        twin: |i| Expected::relative(1, [srgb::srgb_decode(i.a[0]), 0.0, 0.0, 0.0]),
        make: |r| {
            let code = if r.below(2) == 0 { r.below(256) as f32 / 255.0 } else { r.uniform() };
            input([(Vec3::new(code, 0.0, 0.0), 0.0), NOTHING, NOTHING, NOTHING])
        },
    },
    Case {
        function: "direction_to_equirect",
        imports: "import package::geom::equirect::{direction_to_equirect, equirect_jacobian, equirect_to_direction};",
        body: "return give(vec4f(direction_to_equirect(in.a.xyz), equirect_to_direction(in.b.x, in.b.y).x,
                equirect_jacobian(in.b.y)), 1u);",
        twin: |i| {
            let (u, v) = equirect::direction_to_equirect::<f32>(xyz(i.a));
            let back: Vec3 = equirect::equirect_to_direction(i.b[0], i.b[1]);
            let jacobian = equirect::equirect_jacobian(i.b[1]);
            Expected { key: 1, values: [u, v, back.x, jacobian], scale: [1.0, 1.0, 1.0, 20.0] }
        },
        make: |r| {
            let d = unit(r);
            // The seam is in the map's one end or the other.
            let d = if d.z > 0.0 && d.x == 0.0 { -d } else { d };
            let d = if d.x == 0.0 && d.z == 0.0 { Vec3::X } else { d };
            Input { b: square(r).a, ..input([(d, 0.0), NOTHING, NOTHING, NOTHING]) }
        },
    },
    Case {
        function: "valid_shading_normal",
        imports: "import package::geom::normal_guard::valid_shading_normal;",
        body: "return give(vec4f(valid_shading_normal(in.a.xyz, in.b.xyz, in.c.xyz), 0.0), 1u);",
        twin: |i| {
            let [ng, ns, wo] = [i.a, i.b, i.c].map(xyz);
            let n = normal_guard::valid_shading_normal::<f32>(ng, ns, wo);
            let errors = if n == ns || n == ng { 0.0 } else { guard_errors(ng, ns, wo) };
            Expected::scaled(1, n.extend(0.0).to_array(), errors)
        },
        make: |r| {
            let (ng, wo) = (unit(r), unit(r));
            let wo = if wo.dot(ng) < 0.0 && r.below(8) > 0 { -wo } else { wo };
            let ns = (ng + unit(r) * r.between(0.0, 0.9)).normalize();
            input([(ng, 0.0), (ns, 0.0), (wo, 0.0), NOTHING])
        },
    },
];
