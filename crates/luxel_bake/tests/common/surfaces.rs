//! What rays find on the surfaces of a flat scene.
#![allow(dead_code, unreachable_pub)]
use glam::{DVec3, Vec3};
use luxel_cpu::surface::Surface;
use luxel_cpu::{Exclusion, Hit, traverse};
use luxel_flat::{Counters, FlatScene, LIGHT_TRIANGLE, NONE};
use luxel_geom::Ray;

/// Rays across a box around the origin of the world, in tracer space.
pub fn rays(scene: &FlatScene, count: u32, reach: f32) -> Vec<Ray<f32>> {
    let anchor = DVec3::from(scene.anchor).as_vec3();
    let moved = |ray: &Ray<f32>| Ray::new(ray.origin - anchor, ray.direction);
    luxel_testkit::rays::random(7, count, reach).iter().map(moved).collect()
}

/// The surface at the end of each ray that meets one.
pub fn surfaces(scene: &FlatScene, rays: &[Ray<f32>]) -> Vec<Option<(Hit<f32>, Surface<f32>)>> {
    let mut counters = Counters::default();
    let mut surface = |ray: &Ray<f32>| {
        let hit = traverse::intersect(scene, ray, &Exclusion::NOTHING, &mut counters)?;
        Some((hit, Surface::at(scene, scene.features, ray, &hit, &mut counters)))
    };
    rays.iter().map(&mut surface).collect()
}

/// Everything of what rays find that does not depend on slots, bit for bit.
pub fn seen(scene: &FlatScene, rays: &[Ray<f32>]) -> Vec<String> {
    let text = |(hit, surface): (Hit<f32>, Surface<f32>)| {
        let on = (hit.instance_id, hit.on.primitive, hit.on.t, hit.on.uv);
        let looks = (surface.shading_normal, surface.bsdf.color, surface.emission);
        format!("{on:?} {:?} {looks:?} {}", surface.place.point, surface.light == NONE)
    };
    surfaces(scene, rays).into_iter().map(|found| found.map_or(String::new(), text)).collect()
}

/// How many rays meet a triangle that is a light. Each must lie on the light's record.
pub fn shining(scene: &FlatScene, rays: &[Ray<f32>]) -> usize {
    let found = surfaces(scene, rays).into_iter().flatten().filter(|(_, surface)| surface.light != NONE);
    let lies_on_its_light = |(_, surface): (Hit<f32>, Surface<f32>)| {
        let light = scene.lights.as_slice()[surface.light as usize];
        assert_eq!(light.kind, LIGHT_TRIANGLE);
        let (e1, e2) = (Vec3::from(light.edge1).as_dvec3(), Vec3::from(light.edge2).as_dvec3());
        let from_corner = surface.place.point.as_dvec3() - Vec3::from(light.position).as_dvec3();
        // Coordinates along the edges, and off the plane.
        let at = glam::DMat3::from_cols(e1, e2, e1.cross(e2)).inverse() * from_corner;
        let slack = 1e-3;
        let is_inside = at.x > -slack && at.y > -slack && at.x + at.y < 1.0 + slack;
        assert!(is_inside && at.z.abs() < slack / e1.cross(e2).length(), "{at} on {light:?}");
    };
    found.map(lies_on_its_light).count()
}
