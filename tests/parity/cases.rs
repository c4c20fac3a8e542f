//! The functions that have twins: how each is called in WESL and in Rust, and on what. Geometry is here, reflection in
//! `reflectance.rs`, sampling and maps in `sampling.rs`, what shading starts from in `surfaces.rs`, textures and what else surfaces carry in `dressing.rs`,
//! lights in `lighting.rs`, bodies inside bodies in `media.rs`.
use glam::Vec3;
use luxel_film::{ToneMap, tonemap};
use luxel_flat::{PATH_ENTERING, PATH_LEAVING};
use luxel_geom::{
    Aabb, Affine, Exclude, Ray, SlabRay, frame::Frame, optics, spawn, sphere, triangle, voxel, warp,
};
use luxel_gpu::Gpu;
use luxel_testkit::Random;
use rayon::prelude::*;

use crate::bounds::{BOUNDS, Bound};
use crate::device::Function;
use crate::inputs::{input, number, point, ray, ray_from_beside, size, unit};
use crate::judge::{Call, Expected, Input, Output};
use crate::{dressing, lighting, media, reflectance, sampling, surfaces};

/// Calls that are made together: little enough memory to be used again for the next.
pub(crate) const BATCH: usize = 1 << 16;
/// Parts of a batch whose inputs are made side by side.
const PARTS: u32 = 16;

/// A function and its twin.
pub(crate) struct Case {
    pub(crate) function: &'static str,
    pub(crate) imports: &'static str,
    /// The body of `fn call(in: Input) -> Output`.
    pub(crate) body: &'static str,
    pub(crate) twin: fn(&Input) -> Expected,
    pub(crate) make: fn(&mut Random) -> Input,
}

impl Case {
    /// What is allowed.
    pub(crate) fn bound(&self) -> &'static Bound {
        BOUNDS.iter().find(|bound| bound.function == self.function).unwrap()
    }

    /// The function on the device.
    pub(crate) fn function<'a>(&self, gpu: &'a Gpu) -> Function<'a> {
        let module = format!(
            "{}
struct Input {{ a: vec4f, b: vec4f, c: vec4f, d: vec4f, code: vec4u }}
struct Output {{ values: vec4f, key: vec4u }}
fn give(values: vec4f, key: u32) -> Output {{ return Output(values, vec4u(key, 0u, 0u, 0u)); }}
fn call(in: Input) -> Output {{ {} }}",
            self.imports, self.body
        );
        Function::new(gpu, &module)
    }

    /// Calls the function on a batch of inputs, others for each batch.
    pub(crate) fn calls(&self, function: &Function, batch: u32) -> Vec<Call> {
        let part = |part: u32| {
            let mut random = Random::new(self.function.len() as u32 + (batch * PARTS + part) * 1000);
            (0..BATCH / PARTS as usize).map(move |_| (self.make)(&mut random)).collect::<Vec<Input>>()
        };
        let inputs: Vec<Input> = (0..PARTS).into_par_iter().map(part).collect::<Vec<_>>().concat();
        let found: Vec<Output> = function.map(&inputs);
        inputs.into_iter().zip(found).map(|(input, found)| Call { input, found }).collect()
    }
}

/// Every case, of this file and of the others.
pub(crate) fn all() -> impl Iterator<Item = &'static Case> {
    let of_tracers =
        surfaces::CASES.iter().chain(&dressing::CASES).chain(&lighting::CASES).chain(&media::CASES);
    CASES.iter().chain(&reflectance::CASES).chain(&sampling::CASES).chain(of_tracers)
}

pub(crate) fn xyz(v: [f32; 4]) -> Vec3 {
    Vec3::new(v[0], v[1], v[2])
}

/// The ray from `a` along `b`.
fn slab_ray(i: &Input) -> SlabRay<f32> {
    SlabRay::new(&Ray::new(xyz(i.a), xyz(i.b)))
}

/// The affine map whose rows are `a`, `b`, `c`.
fn affine(i: &Input) -> Affine<f32> {
    Affine::from_rows(&[i.a, i.b, i.c])
}

/// What WGSL's word for an exclusion means.
fn exclude(how: u32) -> Exclude {
    match how {
        PATH_LEAVING => Exclude::Leaving,
        PATH_ENTERING => Exclude::Entering,
        _ => Exclude::Nothing,
    }
}

fn any_exclude(random: &mut Random) -> u32 {
    [0, 0, 0, PATH_LEAVING, PATH_ENTERING][random.below(5) as usize]
}

static CASES: [Case; 12] = [
    Case {
        function: "box_interval",
        imports: "import package::geom::aabb::{Aabb, box_interval, overlaps};
            import package::geom::ray::make_ray; import package::generated::shared::FAR;",
        body: "let i = box_interval(Aabb(in.c.xyz, in.d.xyz), make_ray(in.a.xyz, in.b.xyz, 0.0, FAR));
            return give(vec4f(i.enter, i.exit, 0.0, 0.0), u32(overlaps(i, 0.0, FAR)));",
        twin: |i| {
            let interval = Aabb { lo: xyz(i.c), hi: xyz(i.d) }.interval(&slab_ray(i));
            let key = u32::from(interval.overlaps(0.0, 1e30));
            Expected::relative(key, [interval.enter, interval.exit, 0.0, 0.0])
        },
        make: |r| {
            let (lo, extent) = (point(r), Vec3::new(size(r), size(r), size(r)));
            let target = lo + extent * Vec3::new(r.uniform(), r.uniform(), r.uniform());
            let (origin, direction) = ray(r, target);
            // As boxes are stored: a ray in the plane of a face is inside.
            let stored = Aabb::<f32> { lo, hi: lo + extent }.outset();
            input([(origin, 0.0), (direction, 0.0), (stored.lo, 0.0), (stored.hi, 0.0)])
        },
    },
    Case {
        function: "intersect_sphere",
        imports: "import package::geom::sphere::intersect_sphere; import package::geom::ray::make_ray;
            import package::generated::shared::FAR;",
        body: "let ray = make_ray(in.a.xyz, in.b.xyz, 0.0, FAR);
            let t = intersect_sphere(ray, in.c.xyz, in.c.w, in.code.x);
            return give(vec4f(select(0.0, t, t < FAR)), u32(t < FAR));",
        twin: |i| {
            let hit = sphere::intersect(&slab_ray(i), xyz(i.c), i.c[3], exclude(i.code[0]));
            hit.map_or(Expected::MISS, |t| Expected::relative(1, [t; 4]))
        },
        make: |r| {
            let (center, radius) = (point(r), size(r));
            // Half of the rays aim at the border, seen from wherever they come.
            let target = center + unit(r) * radius * if r.below(2) == 0 { 1.0 } else { r.uniform() };
            let (origin, direction) = ray(r, target);
            let vectors = input([(origin, 0.0), (direction, 0.0), (center, radius), (Vec3::ZERO, 0.0)]);
            Input { code: [any_exclude(r), 0, 0, 0], ..vectors }
        },
    },
    Case {
        function: "intersect_triangle",
        imports: "import package::geom::triangle::intersect_triangle; import package::geom::ray::make_ray;
            import package::generated::shared::FAR;",
        body: "let ray = make_ray(in.a.xyz, in.b.xyz, 0.0, FAR);
            let hit = intersect_triangle(ray, in.c.xyz, in.d.xyz, vec3f(in.a.w, in.b.w, in.c.w), 0u);
            return give(select(vec4f(0.0), vec4f(hit.t, hit.u, hit.v, 0.0), hit.t < FAR), u32(hit.t < FAR));",
        twin: |i| {
            let vertices = [xyz(i.c), xyz(i.d), Vec3::new(i.a[3], i.b[3], i.c[3])];
            let hit = triangle::intersect(&slab_ray(i), &vertices, Exclude::Nothing);
            hit.map_or(Expected::MISS, |h| Expected {
                key: 1,
                values: [h.t, h.u, h.v, 0.0],
                scale: [h.t, 1.0, 1.0, 0.0],
            })
        },
        make: |r| {
            let [v0, v1, v2] = [point(r), point(r), point(r)];
            let (u, v) = (r.uniform(), r.uniform() * r.below(2) as f32);
            let target = v0 + (v1 - v0) * (u * (1.0 - v)) + (v2 - v0) * v;
            // Some start so near to the triangle that its plane has to decide.
            let start = if r.below(16) == 0 { ray_from_beside } else { ray };
            let (origin, direction) = start(r, target);
            input([(origin, v2.x), (direction, v2.y), (v0, v2.z), (v1, 0.0)])
        },
    },
    Case {
        function: "intersect_voxel",
        imports: "import package::geom::voxel::intersect_voxel; import package::geom::ray::make_ray;
            import package::generated::shared::FAR;",
        body: "let ray = make_ray(in.a.xyz, in.b.xyz, 0.0, FAR);
            let hit = intersect_voxel(ray, in.code.xyz, in.code.w);
            return give(vec4f(select(0.0, hit.t, hit.t < FAR)), select(0u, 1u + hit.face, hit.t < FAR));",
        twin: |i| {
            let [x, y, z, how] = i.code;
            let hit = voxel::intersect(&slab_ray(i), [x, y, z], exclude(how));
            // A hit on the origin itself is as exact as the planes are.
            let planes = xyz(i.a).abs().max_element().max(x.max(y).max(z) as f32 + 1.0);
            let reach = planes / xyz(i.b).abs().max_element();
            hit.map_or(Expected::MISS, |h| Expected::scaled(1 + h.face, [h.t; 4], h.t.abs().max(reach)))
        },
        make: |r| {
            let [x, y, z] = [r.below(64), r.below(4), r.below(2048)];
            let cell = Vec3::new(x as f32, y as f32, z as f32);
            let inside = Vec3::new(r.uniform(), r.uniform(), r.uniform());
            let corner = (inside * 2.0).floor();
            let target = cell + if r.below(2) == 0 { inside } else { corner };
            let (origin, direction) = ray(r, target);
            let vectors = input([(origin, 0.0), (direction, 0.0), (Vec3::ZERO, 0.0), (Vec3::ZERO, 0.0)]);
            Input { code: [x, y, z, any_exclude(r)], ..vectors }
        },
    },
    Case {
        function: "to_world",
        imports: "import package::geom::frame::to_world;",
        body: "return give(vec4f(to_world(in.a.xyz, in.b.xyz), 0.0), 1u);",
        twin: |i| {
            let world = Frame::<f32>::around(xyz(i.a)).to_world(xyz(i.b));
            Expected::scaled(1, world.extend(0.0).to_array(), xyz(i.b).length())
        },
        make: |r| input([(unit(r), 0.0), (unit(r), 0.0), (Vec3::ZERO, 0.0), (Vec3::ZERO, 0.0)]),
    },
    Case {
        function: "fresnel_dielectric",
        imports: "import package::geom::optics::fresnel_dielectric;",
        body: "let f = fresnel_dielectric(in.a.x, in.a.y);
            return give(vec4f(f.reflectance, f.cos_t, 0.0, 0.0), 1u + u32(f.cos_t == 0.0));",
        twin: |i| {
            let f = optics::fresnel_dielectric(i.a[0], i.a[1]);
            Expected::scaled(1 + u32::from(f.cos_t == 0.0), [f.reflectance, f.cos_t, 0.0, 0.0], 1.0)
        },
        make: |r| {
            let eta = r.log_between(0.3, 3.0);
            let critical = (1.0 - eta * eta).max(0.0).sqrt();
            let cosine = [0.0, 1.0, r.uniform(), critical, critical * r.between(0.9999, 1.0001)];
            let cosine = cosine[r.below(5) as usize];
            input([
                (Vec3::new(cosine, eta, 0.0), 0.0),
                (Vec3::ZERO, 0.0),
                (Vec3::ZERO, 0.0),
                (Vec3::ZERO, 0.0),
            ])
        },
    },
    Case {
        function: "concentric_disk",
        imports: "import package::geom::warp::concentric_disk;",
        body: "return give(vec4f(concentric_disk(in.a.x, in.a.y), 0.0, 0.0), 1u);",
        twin: |i| {
            let (x, y) = warp::concentric_disk(i.a[0], i.a[1]);
            Expected::scaled(1, [x, y, 0.0, 0.0], 1.0)
        },
        make: square,
    },
    Case {
        function: "uniform_sphere",
        imports: "import package::geom::warp::uniform_sphere;",
        body: "return give(vec4f(uniform_sphere(in.a.x, in.a.y), 0.0), 1u);",
        twin: |i| {
            let p: Vec3 = warp::uniform_sphere(i.a[0], i.a[1]);
            Expected::scaled(1, p.extend(0.0).to_array(), 1.0)
        },
        make: square,
    },
    Case {
        function: "offset_origin",
        imports: "import package::geom::spawn::offset_origin;",
        body: "return give(vec4f(offset_origin(in.a.xyz, in.b.xyz, in.c.xyz, in.d.xyz), 0.0), 1u);",
        twin: |i| {
            let moved = spawn::offset_origin::<f32>(xyz(i.a), xyz(i.b), xyz(i.c), xyz(i.d));
            Expected { key: 1, values: moved.extend(0.0).to_array(), scale: offset_scale(i) }
        },
        make: |r| {
            let p = point(r);
            input([(p, 0.0), ((p.abs() + 1.0) * 3e-7, 0.0), (unit(r), 0.0), (unit(r), 0.0)])
        },
    },
    Case {
        function: "transform_point",
        imports: "import package::geom::affine::transform_point;",
        body: "return give(vec4f(transform_point(array<vec4f, 3>(in.a, in.b, in.c), in.d.xyz), 0.0), 1u);",
        twin: |i| {
            let sizes = affine(i).abs_vector(xyz(i.d)) + affine(i).translation.abs();
            let values = affine(i).point(xyz(i.d)).extend(0.0).to_array();
            Expected { key: 1, values, scale: sizes.extend(0.0).to_array() }
        },
        make: rows_and_point,
    },
    Case {
        function: "transform_point_error",
        imports: "import package::geom::affine::transform_point_error;",
        body: "let rows = array<vec4f, 3>(in.a, in.b, in.c);
            return give(vec4f(transform_point_error(rows, in.d.xyz, vec3f(in.d.w)), 0.0), 1u);",
        twin: |i| {
            let error = affine(i).point_error(xyz(i.d), Vec3::splat(i.d[3]));
            Expected::relative(1, error.extend(0.0).to_array())
        },
        make: rows_and_point,
    },
    Case {
        function: "tone_map",
        imports: "import package::film::tonemap::{srgb_encode, tone_map};",
        body: "return give(vec4f(srgb_encode(tone_map(in.a.xyz, in.code.x)), 0.0), 1u);",
        twin: |i| {
            let light = ToneMap::ALL[i.code[0] as usize].apply([i.a[0], i.a[1], i.a[2]]);
            let [r, g, b] = light.map(tonemap::srgb_encode);
            Expected::scaled(1, [r, g, b, 0.0], 1.0)
        },
        make: |r| {
            let color = Vec3::new(r.log_between(1e-6, 1e4), number(r), r.uniform());
            let vectors = input([(color, 0.0), (Vec3::ZERO, 0.0), (Vec3::ZERO, 0.0), (Vec3::ZERO, 0.0)]);
            Input { code: [r.below(4), 0, 0, 0], ..vectors }
        },
    },
];

/// Points of the unit square, some on its borders and diagonals.
pub(crate) fn square(r: &mut Random) -> Input {
    let mut at = |_| [0.0, 0.5, 1.0 - f32::EPSILON * 0.5, r.uniform(), r.uniform()][r.below(5) as usize];
    let (u, v) = (at(0), at(1));
    let v = if r.below(8) == 0 { u } else { v };
    input([(Vec3::new(u, v, 0.0), 0.0), (Vec3::ZERO, 0.0), (Vec3::ZERO, 0.0), (Vec3::ZERO, 0.0)])
}

fn rows_and_point(r: &mut Random) -> Input {
    let rows = [(point(r), number(r)), (point(r), number(r)), (point(r), number(r))];
    input([rows[0], rows[1], rows[2], (point(r), r.uniform())])
}

/// The sizes of the terms that a moved origin is a sum of.
fn offset_scale(i: &Input) -> [f32; 4] {
    let reach = xyz(i.c).abs().dot(xyz(i.b));
    (xyz(i.a).abs() + xyz(i.c).abs() * reach).extend(0.0).to_array()
}
