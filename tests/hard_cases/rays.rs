//! T01–T04, T16, T20: closed meshes. A ray from inside meets a triangle, whatever it is aimed at.
use glam::Vec3;
use luxel_cpu::Exclusion;
use luxel_cpu::naive::Naive;
use luxel_flat::FlatScene;
use luxel_geom::{Exclude, Ray};
use luxel_testkit::{Random, TestMesh, closed};
use rayon::prelude::*;

use crate::common::{bits, mesh_scene, trace};
use crate::many::{count_bad, tally};
use crate::models::bunny;
use crate::support::{bounds, trace_from};
use crate::table::{Case, is_soak};

/// A ray from a point to a vertex of a mesh or to a point of one of its edges.
pub(crate) fn at_seam(mesh: &TestMesh, random: &mut Random, origin: Vec3, at_vertex: bool) -> Ray<f32> {
    let [a, b, _] = mesh.vertices(random.below(mesh.triangles.len() as u32) as usize);
    let along = if at_vertex { 0.0 } else { random.uniform() };
    Ray::new(origin, a + (b - a) * along - origin)
}

/// Rays, of `count` from around `middle`, that slip out of a closed mesh.
fn lost(mesh: &TestMesh, count: u64, middle: Vec3, reach: f32, seams: impl Fn(u32) -> bool + Sync) -> u64 {
    let scene = mesh_scene(mesh);
    count_bad(1, count, |random| {
        let origin = middle + random.point(reach);
        let at_vertex = seams(random.word());
        trace(&scene, &at_seam(mesh, random, origin, at_vertex)).is_none()
    })
}

#[test]
fn t01_no_ray_slips_through_a_vertex() {
    let case = Case::begin("T01");
    assert_eq!(lost(&closed::pbrt_ball(), case.size(), Vec3::ZERO, 0.14, |_| true), 0);
    let size = case.size();
    case.end(format_args!("{size} rays on the CPU"));
}

#[test]
fn t02_no_ray_slips_through_an_edge() {
    let case = Case::begin("T02");
    assert_eq!(lost(&closed::pbrt_ball(), case.size(), Vec3::ZERO, 0.14, |_| false), 0);
    let size = case.size();
    case.end(format_args!("{size} rays on the CPU"));
}

/// T03: where the ball stands and how large it is.
pub(crate) const FAR_AND_SMALL: [(Vec3, f32); 5] = [
    (Vec3::new(148_376.0, 1234.0, -223_423.0), 1.0),
    (Vec3::splat(1e4), 1.0),
    (Vec3::ZERO, 1e-3),
    (Vec3::ZERO, 1e-6),
    (Vec3::ZERO, 1e6),
];

#[test]
fn t03_no_ray_slips_through_far_away_or_at_any_size() {
    let case = Case::begin("T03");
    let size = case.size();
    for (offset, scale) in FAR_AND_SMALL {
        let mesh = closed::pbrt_ball().map(|p| p * scale + offset);
        let lost = lost(&mesh, size / 5, offset, 0.14 * scale, |word| word.is_multiple_of(2));
        assert_eq!(lost, 0, "{offset} {scale}");
    }
    case.end(format_args!("{size} rays on the CPU"));
}

#[test]
fn a_mesh_with_a_hole_loses_rays() {
    let mut mesh = closed::pbrt_ball();
    let [a, b, c] = mesh.vertices(200);
    mesh.triangles.remove(200);
    let ray: Ray<f32> = Ray::new(Vec3::ZERO, (a + b + c) / 3.0);
    assert!(trace(&mesh_scene(&mesh), &ray).is_none());
}

const PICTURE: [u32; 2] = [1920, 1080];

/// A camera close to the tip of an ear: the highest vertex of the mesh, seen from beside and above.
struct EarCamera {
    origin: Vec3,
    forward: Vec3,
    right: Vec3,
    up: Vec3,
}

impl EarCamera {
    /// At `distance`, as a part of the mesh's diagonal.
    fn new(mesh: &TestMesh, distance: f32) -> Self {
        let tip = mesh.positions.iter().copied().max_by(|a, b| a.y.total_cmp(&b.y)).unwrap();
        let away = Vec3::new(0.48, 0.6, 0.64) * distance * bounds(mesh).extent().length();
        let right = away.cross(Vec3::Y).normalize();
        Self { origin: tip + away, forward: -away.normalize(), right, up: right.cross(-away.normalize()) }
    }

    /// The ray through the middle of a pixel.
    fn ray(&self, pixel: u32) -> Ray<f32> {
        let [width, height] = PICTURE;
        let x = ((pixel % width) as f32 + 0.5) / width as f32 * 2.0 - 1.0;
        let y = 1.0 - ((pixel / width) as f32 + 0.5) / height as f32 * 2.0;
        let aspect = width as f32 / height as f32;
        Ray::new(self.origin, self.forward + self.right * (x * aspect) + self.up * y)
    }
}

/// Pixels for which the structures and exhaustive search differ, and hits.
fn compare(scene: &FlatScene, camera: &EarCamera, pixels: impl ParallelIterator<Item = u32>) -> [u64; 2] {
    let naive = Naive::new(scene);
    let look = |pixel: u32| {
        let ray = camera.ray(pixel);
        let (fast, slow) = (trace(scene, &ray), naive.intersect(&ray, &Exclusion::NOTHING));
        [u64::from(bits(&fast) != bits(&slow)), u64::from(slow.is_some())]
    };
    pixels.map(look).reduce(|| [0; 2], |a, b| [a[0] + b[0], a[1] + b[1]])
}

/// Looks at the tip from three distances: pixels spread over the picture, and the window around the tip.
fn look_at_ear(mesh: &TestMesh, pixels: u64) -> [u64; 2] {
    let scene = mesh_scene(mesh);
    let [width, height] = PICTURE;
    let mut sum = [0; 2];
    for (distance, share) in [(1e-3, 4), (1e-2, 2), (1e-1, 4)] {
        let camera = EarCamera::new(mesh, distance);
        let all = u64::from(width * height);
        let spread = if is_soak() && share == 2 { pixels } else { pixels.min(20_000) / share };
        let over_picture = (0..spread).into_par_iter().map(|i| (i * all / spread) as u32);
        let edge = if is_soak() { 140 } else { 40 };
        let window = (0..edge * edge)
            .into_par_iter()
            .map(move |i| (height / 2 - edge / 2 + i / edge) * width + width / 2 - edge / 2 + i % edge);
        for [differing, hits] in [compare(&scene, &camera, over_picture), compare(&scene, &camera, window)] {
            sum = [sum[0] + differing, sum[1] + hits];
        }
    }
    sum
}

#[test]
fn t04_no_triangle_is_lost_beside_the_ears_of_the_bunny() {
    let case = Case::begin("T04");
    let Some(mesh) = bunny() else { return };
    let [differing, hits] = look_at_ear(&mesh, case.size());
    assert!(differing == 0 && hits > case.size() / 4, "{differing} of {hits} differ");
    let size = case.size();
    case.end(format_args!("{size} pixels and the ear window of the bunny, {hits} hits"));
}

#[test]
fn t04_no_triangle_is_lost_beside_a_bump() {
    let case = Case::begin("T04");
    let mesh = closed::bumps_70k();
    let [differing, hits] = look_at_ear(&mesh, case.size());
    assert!(differing == 0 && hits > case.size() / 4, "{differing} of {hits} differ");
    assert_eq!(lost(&mesh, case.size(), Vec3::ZERO, 0.3, |word| word.is_multiple_of(2)), 0);
    let size = case.size();
    case.end(format_args!("{size} pixels and the window of 70,000 bumps, {hits} hits"));
}

#[test]
fn t16_no_ray_slips_through_embrees_far_sphere() {
    let case = Case::begin("T16");
    let center = Vec3::new(148_376.0, 1234.0, -223_423.0);
    let mesh = closed::sphere(200, 200, center, 2.0);
    let scene = mesh_scene(&mesh);
    let lost = count_bad(16, case.size(), |random| {
        let origin = center + random.point(1.0);
        let ray = match random.below(3) {
            0 => Ray::new(origin, random.direction()),
            kind => at_seam(&mesh, random, origin, kind == 1),
        };
        trace(&scene, &ray).is_none()
    });
    assert_eq!(lost, 0);
    let size = case.size();
    case.end(format_args!("{size} rays"));
}

/// Whether a ray from inside a closed fan is lost at the apex, and whether it meets the fan twice there.
fn through_apex(scene: &FlatScene, mesh: &TestMesh, random: &mut Random) -> [u64; 2] {
    let origin = Vec3::new(random.between(-0.1, 0.1), random.between(-0.5, -0.2), random.between(-0.1, 0.1));
    let apex = mesh.positions[0];
    let rim = mesh.positions[2 + random.below(mesh.positions.len() as u32 - 2) as usize];
    let along = if random.below(2) == 0 { 0.0 } else { random.log_between(1e-7, 0.9) };
    let ray: Ray<f32> = Ray::new(origin, apex + (rim - apex) * along - origin);
    let Some(hit) = trace(scene, &ray) else { return [1, 0] };
    let place = luxel_cpu::surface::Place::at(scene, &ray, &hit);
    let onward: Ray<f32> = Ray::new(place.spawn_origin(ray.direction), ray.direction);
    let exclusion =
        Exclusion { instance: 0, primitive: hit.on.slot, how: Exclude::Leaving, ..Exclusion::NOTHING };
    [0, u64::from(trace_from(scene, &onward, &exclusion).is_some())]
}

#[test]
fn t20_a_fan_has_no_hole_at_its_apex_and_is_met_once() {
    let case = Case::begin("T20");
    let fans = [3, 4, 5, 7, 12, 31, 64].into_iter().flat_map(|n| [0.0, 1e-9, 1e-6].map(|h| (n, h)));
    for (count, height) in fans.clone() {
        let mesh = closed::double_fan(count, height);
        let scene = mesh_scene(&mesh);
        let share = case.size() / fans.clone().count() as u64;
        let [lost, twice] = tally(20, share, |random| through_apex(&scene, &mesh, random));
        assert_eq!([lost, twice], [0, 0], "{count} triangles, height {height}");
    }
    let size = case.size();
    case.end(format_args!("{size} rays"));
}
