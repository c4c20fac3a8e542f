//! Cases of what a surface carries: textures, attributes of corners, normal maps, holes and see-through places.
use glam::{Vec2, Vec3};
use luxel_cpu::hit::PrimitiveHit;
use luxel_cpu::surface::{Surface, attributes, roles};
use luxel_cpu::{Hit, alpha, texture};
use luxel_flat::{
    Counters, FeatureSet, INSTANCE_ATTRIBUTES, Instance, KIND_MESH, TEXTURE_ROLE_NORMAL, TEXTURE_SRGB,
    TEXTURE_UV1, TextureSlot,
};
use luxel_geom::{Affine, Ray, rng};
use luxel_testkit::Random;

use crate::bounds::{SRGB, TEXTURE};
use crate::cases::{Case, xyz};
use crate::inputs::{input, unit};
use crate::judge::{Expected, Input};
use crate::scene::SCENE;

const NOTHING: (Vec3, f32) = (Vec3::ZERO, 0.0);
/// Pixel whose samples toss coins.
const PIXEL: u32 = 7;

/// Coordinates that are round or wild, a transform, and a part of the texels as an image.
fn textured(r: &mut Random) -> Input {
    let mut coordinate = || match r.below(4) {
        0 => 0.25 * (r.below(17) as f32 - 8.0),
        1 => r.between(-1e3, 1e3),
        _ => r.between(-2.0, 2.0),
    };
    let uv = [(); 4].map(|()| coordinate());
    let (scale, angle) = (r.log_between(0.25, 4.0), [0.0, r.between(-3.0, 3.0)][r.below(2) as usize]);
    let (sin, cos) = angle.sin_cos();
    let offset = [0.0, r.between(-1.0, 1.0)][r.below(2) as usize];
    let [width, height] = [1 + r.below(12), 1 + r.below(12)];
    let first = r.below(SCENE.texels.len() as u32 - width * height);
    Input {
        a: uv,
        b: [scale * cos, scale * sin, offset, 0.0],
        c: [-sin, cos, 1.5 * offset, 0.0],
        d: [0.0; 4],
        code: [first, width | height << 16, r.below(128), 0],
    }
}

fn slot(i: &Input) -> TextureSlot {
    let [texel_first, size, flags, _] = i.code;
    let (row_u, row_v) = (xyz(i.b).to_array(), xyz(i.c).to_array());
    TextureSlot { row_u, texel_first, row_v, size, flags, ..TextureSlot::default() }
}

/// Errors of [`texture::sample_texture`] in u, both sides together, for coordinates that are wrong by `given` u. A texel's
/// is that of unpacking (3 ulp) and, for sRGB, of decoding (14u of what was unpacked, and [`SRGB`]); mixing four takes 14u in
/// WGSL and 7u in Rust. A coordinate is a scalar product (6u + 3u of its terms), brought into a period and to a texel in
/// four steps (8u + 4u of one), and the value moves by no more than one for each texel that it is off.
fn texture_errors(slot: &TextureSlot, [u, v]: [f32; 2], given: f32) -> f32 {
    let off = |row: [f32; 3]| {
        let terms = (row[0] * u).abs() + (row[1] * v).abs() + row[2].abs();
        9.0 * terms + (row[0].abs() + row[1].abs()) * given + 12.0
    };
    let across = off(slot.row_u) * (slot.size & 0xffff) as f32;
    let down = off(slot.row_v) * (slot.size >> 16) as f32;
    let decoded = if slot.flags & TEXTURE_SRGB == 0 { 6.0 } else { 14.0 + SRGB };
    decoded + 21.0 + across + down
}

/// What a texture's errors are in parts of, at most [`TEXTURE`]: a decoded texel, and steps between texels, as
/// coordinates move by 16 u of their terms.
fn texture_scale(slot: &TextureSlot, [u, v]: [f32; 2]) -> f32 {
    let terms = |row: [f32; 3]| (row[0] * u).abs() + (row[1] * v).abs() + row[2].abs() + 1.0;
    let across = terms(slot.row_u) * (slot.size & 0xffff) as f32;
    let down = terms(slot.row_v) * (slot.size >> 16) as f32;
    let decoded = if slot.flags & TEXTURE_SRGB == 0 { 0.0 } else { 1.0 };
    decoded + (across + down) / 16.0
}

/// The largest of the errors of a place's textures in u; those of its normal map apart. The coordinates are three products
/// with weights (4u) and their sum: 10u + 5u of the largest corner's.
fn texture_errors_at(i: &Input, role: impl Fn(u32) -> bool) -> f32 {
    let material = &SCENE.materials.as_slice()[hit(i).material as usize];
    let record = attributes::record(&SCENE, instance(i), i.code[1]).unwrap();
    let uvs = attributes::texture_coordinates::<f32>(record, hit(i).uv);
    let corners = record.uv0.iter().chain(&record.uv1).flatten();
    let given = 15.0 * corners.fold(0.0f32, |most, coordinate| most.max(coordinate.abs()));
    let bits = (0..32).map(|bit| 1 << bit).filter(|bit| material.texture_mask & bit != 0 && role(*bit));
    let slots = bits.filter_map(|bit| roles::slot(&SCENE, material, bit));
    let errors =
        slots.map(|slot| texture_errors(slot, uvs[usize::from(slot.flags & TEXTURE_UV1 != 0)], given));
    errors.fold(0.0, f32::max)
}

/// Errors of a surface's shading normal in u, both sides together. The interpolated one, its tangent and its bitangent are
/// decoded, summed, transformed and scaled to length one: 150u. A normal map's texel is off by what textures are, twice,
/// in each of three. Where the normal is bent so that the view's mirror is above the surface, the error is in parts of
/// the length of the half vector, twice the cosine of view and normal.
fn normal_errors(i: &Input, s: &Surface<f32>) -> f32 {
    let map = texture_errors_at(i, |role| role == TEXTURE_ROLE_NORMAL);
    let (wo, n) = (-xyz(i.b), s.shading_normal);
    let mirrored = n * (2.0 * wo.dot(n)) - wo;
    let is_bent = (mirrored.dot(s.place.normal) * wo.dot(s.place.normal).signum()) < 0.011;
    let size = if is_bent { 2.0 * wo.dot(n).abs() } else { 1.0 };
    ((150.0 + 6.0 * map) / size.clamp(1e-6, 1.0)).min(TEXTURE)
}

/// A place on one of the balls: instance and triangle in `code`, weights in `b` and `c`, the ray in `a` and `b`.
fn place(r: &mut Random) -> Input {
    let balls: Vec<(u32, &Instance)> = (0..)
        .zip(SCENE.instances.as_slice())
        .filter(|(_, instance)| instance.kind == KIND_MESH && instance.flags & INSTANCE_ATTRIBUTES != 0)
        .collect();
    let (index, ball) = balls[r.below(balls.len() as u32) as usize];
    let triangle = ball.primitive_first + r.below(ball.primitive_count);
    let [u, v] = [[0.0, 0.5, r.uniform(), r.uniform()][r.below(4) as usize], r.uniform()];
    let uv = Vec2::new(u, v * (1.0 - u));
    let [v0, v1, v2] = {
        let t = &SCENE.triangles.as_slice()[triangle as usize];
        [t.v0, t.v1, t.v2].map(Vec3::from_array)
    };
    let point =
        Affine::<f32>::from_rows(&ball.world_from_object).point(v0 + (v1 - v0) * uv.x + (v2 - v0) * uv.y);
    let (direction, t) = (unit(r), r.log_between(0.1, 10.0));
    let vectors = input([(point - direction * t, t), (direction, uv.x), (Vec3::ZERO, uv.y), NOTHING]);
    Input { code: [index, triangle, r.below(6), r.word()], ..vectors }
}

fn instance(i: &Input) -> &'static Instance {
    &SCENE.instances.as_slice()[i.code[0] as usize]
}

fn hit(i: &Input) -> PrimitiveHit<f32> {
    let triangle = &SCENE.triangles.as_slice()[i.code[1] as usize];
    PrimitiveHit {
        t: i.a[3],
        uv: [i.b[3], i.c[3]],
        slot: i.code[1],
        primitive: i.code[3],
        material: instance(i).material_first + triangle.material,
    }
}

/// The twin of [`place`]'s reading.
const PLACE: &str = "import package::bindings::{instances, triangle_attributes, triangles};
    import package::generated::shared::Path;
    import package::trace::alpha::{coins, enter_mesh, passes_alpha, toss_coins};
    import package::trace::surface::surface_at;
    import package::trace::surface_attributes::vertex_attributes;
    fn material(in: Input) -> u32 {
        return instances[in.code.x].material_first + triangles[in.code.y].material;
    }
    fn path(in: Input) -> Path {
        var p: Path;
        p.origin = in.a.xyz;
        p.direction = in.b.xyz;
        p.hit_t = in.a.w;
        p.hit_instance = in.code.x;
        p.hit_slot = in.code.y;
        p.hit_uv = vec2f(in.b.w, in.c.w);
        p.hit_material = material(in);
        return p;
    }";

/// A part of the surface at a place: four of its numbers, and what their errors are relative to.
fn surface_part(i: &Input) -> Expected {
    let ray = Ray::new(xyz(i.a), xyz(i.b));
    let hit = Hit { instance: i.code[0], instance_id: instance(i).stable_id, on: hit(i) };
    let s = Surface::at(&SCENE, FeatureSet::ALL, &ray, &hit, &mut Counters::default());
    let key = 1 + s.bsdf.kind + 8 * s.body + 4096 * s.light.wrapping_add(1);
    let reach = s.place.point.abs().max_element() + 1.0;
    // A texture times a corner's colour (24u, interpolated) and the material's: at most one, so shares of one.
    let textured = texture_errors_at(i, |role| role != TEXTURE_ROLE_NORMAL) + 32.0;
    let textured = textured.min(TEXTURE);
    let of = |values: [f32; 4]| Expected::scaled(key, values, textured);
    match i.code[2] {
        // As triangle_point_inside and transform_point.
        0 => Expected {
            key,
            values: s.place.point.extend(s.place.error.x).to_array(),
            scale: [reach, reach, reach, s.place.error.x].map(|size| 96.0 * size),
        },
        1 => {
            let bent = normal_errors(i, &s);
            let values = s.shading_normal.extend(s.bsdf.roughness).to_array();
            Expected { key, values, scale: [bent, bent, bent, textured] }
        }
        2 => of(s.bsdf.color.extend(s.bsdf.metallic).to_array()),
        3 => of(s.emission.extend(s.bsdf.transmission).to_array()),
        4 => of(s.bsdf.specular_color.extend(s.bsdf.specular).to_array()),
        _ => of([s.bsdf.ior, s.bsdf.clearcoat, s.bsdf.clearcoat_roughness, 0.0]),
    }
}

pub(crate) static CASES: [Case; 4] = [
    Case {
        function: "sample_texture",
        imports: "import package::trace::texture::sample_texture; import package::generated::shared::TextureSlot;",
        body: "let slot = TextureSlot(in.b.xyz, in.code.x, in.c.xyz, in.code.y, in.code.z, 1.0, 0u, 0u);
            return give(sample_texture(slot, in.a), 1u);",
        twin: |i| {
            let [u0, v0, u1, v1] = i.a;
            let (slot, uv) = (slot(i), [[u0, v0], [u1, v1]]);
            let texel = texture::sample_texture::<f32>(&SCENE, &slot, &uv, &mut Counters::default());
            let set = usize::from(slot.flags & TEXTURE_UV1 != 0);
            let errors = texture_errors(&slot, uv[set], 0.0).min(TEXTURE * texture_scale(&slot, uv[set]));
            Expected::scaled(1, texel, errors)
        },
        make: textured,
    },
    Case {
        function: "vertex_attributes",
        imports: PLACE,
        body: "let instance = instances[in.code.x];
            let record = triangle_attributes[in.code.y + instance.attribute_offset];
            let a = vertex_attributes(record, instance, vec2f(in.b.w, in.c.w));
            let parts = array<vec4f, 3>(vec4f(a.normal, 0.0), a.uv, a.color);
            return give(parts[in.code.z % 3u], 1u);",
        twin: |i| {
            let record = attributes::record(&SCENE, instance(i), i.code[1]).unwrap();
            let a = attributes::vertex_attributes::<f32>(record, instance(i), hit(i).uv);
            let [[u0, v0], [u1, v1]] = a.uv;
            let values = match i.code[2] % 3 {
                0 => a.normal.unwrap_or_default().extend(0.0).to_array(),
                1 => [u0, v0, u1, v1],
                _ => a.color,
            };
            Expected::scaled(1, values, 2.0)
        },
        make: place,
    },
    Case {
        function: "surface_at",
        imports: PLACE,
        body: "let s = surface_at(path(in));
            let parts = array<vec4f, 6>(vec4f(s.point, s.error.x), vec4f(s.shading_normal, s.roughness),
                vec4f(s.color, s.metallic), vec4f(s.emission, s.transmission), vec4f(s.specular_color, s.specular),
                vec4f(s.ior, s.clearcoat, s.clearcoat_roughness, 0.0));
            return give(parts[in.code.z], 1u + s.kind + 8u * s.body + 4096u * (s.light + 1u));",
        twin: surface_part,
        make: place,
    },
    Case {
        function: "passes_alpha",
        imports: PLACE,
        body: "toss_coins(7u, in.code.w, in.code.z);
            enter_mesh(instances[in.code.x]);
            let passes = passes_alpha(in.code.y, vec2f(in.b.w, in.c.w), in.code.w, material(in));
            return give(vec4f(1.0 + f32(coins >> 8u) / 16777216.0, 0.0, 0.0, 0.0), 1u + u32(passes));",
        twin: |i| {
            let coins = alpha::ray_coins(SCENE.params.seed, PIXEL, i.code[3], i.code[2]);
            let counters = &mut Counters::default();
            let passes = alpha::passes_alpha(&SCENE, instance(i), &hit(i), coins, counters);
            let value = 1.0 + rng::uniform::<f32>(coins);
            Expected::scaled(1 + u32::from(passes), [value, 0.0, 0.0, 0.0], 1.0)
        },
        make: place,
    },
];
