//! Cases of microfacets, Schlick's approximation and the albedo tables.
use glam::Vec3;
use luxel_geom::albedo::{Facets, TABLES, lookup};
use luxel_geom::{microfacet as ggx, schlick};
use luxel_testkit::Random;

use crate::cases::{Case, xyz};
use crate::inputs::{input, unit};
use crate::judge::{Expected, Input};

/// Two directions above the surface, some of them grazing, and α.
fn directions(r: &mut Random) -> Input {
    let (wo, wi, alpha) = (above(r), above(r), r.log_between(ggx::SMOOTH_ALPHA, 1.0));
    input([
        (wo, alpha),
        (wi, r.log_between(0.4, 2.5)),
        (Vec3::new(r.uniform(), r.uniform(), 0.0), 0.0),
        NOTHING,
    ])
}

const NOTHING: (Vec3, f32) = (Vec3::ZERO, 0.0);

fn above(r: &mut Random) -> Vec3 {
    let v = unit(r);
    let z = if r.below(4) == 0 { r.log_between(1e-7, 1e-2) } else { v.z.abs().max(1e-7) };
    Vec3::new(v.x, v.y, z).normalize()
}

/// A direction and a microfacet normal within some widths of its lobe, and α.
fn direction_and_normal(r: &mut Random) -> Input {
    let (wo, alpha) = (above(r), r.log_between(ggx::SMOOTH_ALPHA, 1.0));
    let slope = unit(r) * alpha * r.log_between(1e-2, 1e2);
    let h = Vec3::new(slope.x, slope.y, 1.0).normalize();
    input([(wo, alpha), (h, 0.0), NOTHING, NOTHING])
}

/// A cosine, a roughness and an index above one, and a second cosine.
fn table_place(r: &mut Random) -> Input {
    let cos = [0.0, 1.0, r.uniform(), r.log_between(1e-6, 1.0)];
    let cos = [cos[r.below(4) as usize], cos[r.below(4) as usize]];
    let roughness = [0.0, 0.0316, 1.0, r.uniform()][r.below(4) as usize];
    let eta = [r.between(1.0, 2.6), 1.0 + r.log_between(1e-3, 1e4)][r.below(2) as usize];
    input([(Vec3::new(cos[0], roughness, eta), cos[1]), NOTHING, NOTHING, NOTHING])
}

pub(crate) static CASES: [Case; 10] = [
    Case {
        function: "masking_shadowing",
        imports: "import package::geom::microfacet::{masking, masking_shadowing, shadowing, slope_length};",
        body: "let alpha = in.a.w;
            return give(vec4f(masking(in.a.xyz, alpha), masking_shadowing(in.a.xyz, in.b.xyz, alpha),
                shadowing(in.a.xyz, in.b.xyz, alpha), slope_length(in.b.xyz, alpha)), 1u);",
        twin: |i| {
            let (wo, wi, alpha) = (xyz(i.a), xyz(i.b), i.a[3]);
            let both = ggx::masking_shadowing::<f32>(wo, wi, alpha);
            let [one, rest] = [ggx::masking::<f32>(wo, alpha), ggx::shadowing::<f32>(wo, wi, alpha)];
            Expected::relative(1, [one, both, rest, ggx::slope_length::<f32>(wi, alpha)])
        },
        make: directions,
    },
    Case {
        function: "visible_normal_pdf",
        imports: "import package::geom::microfacet::{distribution, reflection_pdf, visible_normal_pdf};",
        body: "return give(vec4f(visible_normal_pdf(in.a.xyz, in.b.xyz, in.a.w), distribution(in.b.xyz, in.a.w),
                reflection_pdf(in.a.xyz, in.b.xyz, in.a.w), 0.0), 1u);",
        twin: |i| {
            let (wo, h, alpha) = (xyz(i.a), xyz(i.b), i.a[3]);
            let pdf = ggx::visible_normal_pdf::<f32>(wo, h, alpha);
            let [all, mirrored] =
                [ggx::distribution::<f32>(h, alpha), ggx::reflection_pdf::<f32>(wo, h, alpha)];
            // wo · h cancels where the normal turns away.
            Expected { key: 1, values: [pdf, all, mirrored, 0.0], scale: [4.0 * mirrored, all, mirrored, 0.0] }
        },
        make: direction_and_normal,
    },
    Case {
        function: "sample_visible_normal",
        imports: "import package::geom::microfacet::sample_visible_normal;",
        body: "return give(vec4f(sample_visible_normal(in.a.xyz, in.a.w, in.c.x, in.c.y), 0.0), 1u);",
        twin: |i| {
            let h = ggx::sample_visible_normal::<f32>(xyz(i.a), i.a[3], i.c[0], i.c[1]);
            // The cap's coordinates are of size one; the slopes are α of them over their height.
            let slope = (h.x * h.x + h.y * h.y).sqrt() + (i.a[3] * h.z / (1.0 - i.c[1])).min(1.0);
            Expected { key: 1, values: h.extend(0.0).to_array(), scale: [slope.min(1.0), slope.min(1.0), 1.0, 1.0] }
        },
        make: directions,
    },
    Case {
        function: "refraction_normal",
        imports: "import package::geom::microfacet::{refraction_normal, reflection_normal};",
        body: "let n = refraction_normal(in.a.xyz, -in.b.xyz, in.b.w);
            return give(vec4f(n, reflection_normal(in.a.xyz, in.b.xyz).z), 1u);",
        twin: |i| {
            let (wo, wi) = (xyz(i.a), -xyz(i.b));
            let n = ggx::refraction_normal::<f32>(wo, wi, i.b[3]);
            let up = ggx::reflection_normal::<f32>(wo, -wi);
            let scale = (1.0 + i.b[3]) / (wo + wi * i.b[3]).length();
            let own = 2.0 / (wo - wi).length();
            Expected { key: 1, values: n.extend(up.z).to_array(), scale: [scale, scale, scale, own] }
        },
        make: directions,
    },
    Case {
        function: "refraction_jacobian",
        imports: "import package::geom::microfacet::refraction_jacobian;",
        body: "return give(vec4f(refraction_jacobian(in.a.xyz, -in.b.xyz, in.c.xyz, in.b.w), 0.0, 0.0, 0.0), 1u);",
        twin: |i| {
            let (wo, wi, h, eta) = (xyz(i.a), -xyz(i.b), xyz(i.c), i.b[3]);
            let value = ggx::refraction_jacobian::<f32>(wo, wi, h, eta);
            let (sizes, bend) = ((1.0 + eta) * h.length(), (wo.dot(h) + eta * wi.dot(h)).abs());
            let cancelled = value * sizes / bend + eta * eta * h.length() / (bend * bend);
            Expected::scaled(1, [value, 0.0, 0.0, 0.0], cancelled)
        },
        make: |r| {
            let given = directions(r);
            let h = ggx::refraction_normal::<f32>(xyz(given.a), -xyz(given.b), given.b[3]);
            Input { c: h.extend(0.0).to_array(), ..given }
        },
    },
    Case {
        function: "fresnel_schlick",
        imports: "import package::geom::schlick::fresnel_schlick;",
        body: "return give(vec4f(fresnel_schlick(in.a.xyz, in.b.w, in.a.w), 0.0), 1u);",
        twin: |i| {
            let f = schlick::fresnel_schlick::<f32>(xyz(i.a), i.b[3], i.a[3]);
            Expected::scaled(1, f.extend(0.0).to_array(), 1.0)
        },
        make: |r| {
            let f0 = Vec3::new(r.uniform(), r.uniform(), [0.0, 1.0, r.uniform()][r.below(3) as usize]);
            input([(f0, r.between(-0.1, 1.1)), (Vec3::ZERO, r.uniform()), NOTHING, NOTHING])
        },
    },
    Case {
        function: "fresnel_dielectric_schlick",
        imports: "import package::geom::schlick::{eta_to_f0, f0_to_eta, fresnel_dielectric_schlick};",
        body: "let f = fresnel_dielectric_schlick(in.a.x, in.a.y);
            return give(vec4f(f.reflectance, f.cos_t, eta_to_f0(in.a.y), f0_to_eta(in.a.z)), 1u + u32(f.cos_t == 0.0));",
        twin: |i| {
            let f = schlick::fresnel_dielectric_schlick(i.a[0], i.a[1]);
            let [f0, eta] = [schlick::eta_to_f0(i.a[1]), schlick::f0_to_eta(i.a[2])];
            Expected {
                key: 1 + u32::from(f.cos_t == 0.0),
                values: [f.reflectance, f.cos_t, f0, eta],
                scale: [1.0, 1.0, 1.0, eta],
            }
        },
        make: |r| {
            let eta = r.log_between(0.3, 3.0);
            let critical = (1.0 - eta * eta).max(0.0).sqrt();
            let cosine = [0.0, 1.0, r.uniform(), critical * r.between(0.9999, 1.0001)][r.below(4) as usize];
            input([(Vec3::new(cosine, eta, r.between(0.0, 0.5)), 0.0), NOTHING, NOTHING, NOTHING])
        },
    },
    Case {
        function: "conductor_loss",
        imports: "import package::geom::albedo::{compensation, conductor_loss, conductor_loss_average};
            import package::geom::schlick::multi_scatter_tint;",
        body: "let mean = conductor_loss_average(in.a.y);
            let own = conductor_loss(in.a.x, in.a.y);
            let lobe = compensation(vec3f(own), vec3f(conductor_loss(in.a.w, in.a.y)), vec3f(mean)).x;
            return give(vec4f(own, mean, lobe, multi_scatter_tint(vec3f(in.a.x), mean).x), 1u);",
        twin: |i| {
            let [cos, roughness, _, other] = i.a;
            let mean = lookup::conductor_loss_average(&TABLES, roughness);
            let [own, other] = [cos, other].map(|c| lookup::conductor_loss(&TABLES, c, roughness));
            let tint = schlick::multi_scatter_tint::<f32>(Vec3::splat(cos), mean).x;
            let lobe = lookup::compensation(own, other, mean);
            Expected { key: 1, values: [own, mean, lobe, tint], scale: [1.0, 1.0, lobe.max(1.0), 1.0] }
        },
        make: table_place,
    },
    Case {
        function: "mean_reflectance",
        imports: "import package::geom::albedo::{
                coat_passing_average, mean_reflectance, rim_albedo, rim_albedo_average
            };",
        body: "return give(vec4f(mean_reflectance(in.a.x, in.a.y, in.a.z), coat_passing_average(in.a.y, in.a.z),
                rim_albedo(in.a.x, in.a.y), rim_albedo_average(in.a.y)), 1u);",
        twin: |i| {
            let [cos, roughness, eta, _] = i.a;
            let own = lookup::mean_reflectance(&TABLES, cos, roughness, eta);
            let mean = lookup::coat_passing_average(&TABLES, roughness, eta);
            let rim = lookup::rim_albedo(&TABLES, cos, roughness);
            Expected::scaled(1, [own, mean, rim, lookup::rim_albedo_average(&TABLES, roughness)], 1.0)
        },
        make: table_place,
    },
    Case {
        function: "glass_loss",
        imports: "import package::geom::albedo::{glass_loss, glass_loss_average};",
        body: "let eta = select(in.a.z, 1.0 / in.a.z, in.code.x == 1u);
            let own = glass_loss(in.code.y, in.a.x, in.a.y, eta);
            return give(vec4f(own, glass_loss_average(in.code.y, in.a.y, eta), 0.0, 0.0), 1u);",
        twin: |i| {
            let ([cos, roughness, eta, _], facets) = (i.a, Facets::ALL[i.code[1] as usize]);
            let eta = if i.code[0] == 1 { 1.0 / eta } else { eta };
            let own = lookup::glass_loss(&TABLES, facets, cos, roughness, eta);
            let mean = lookup::glass_loss_average(&TABLES, facets, roughness, eta);
            Expected::scaled(1, [own, mean, 0.0, 0.0], 1.0)
        },
        make: |r| Input { code: [r.below(2), r.below(3), 0, 0], ..table_place(r) },
    },
];
