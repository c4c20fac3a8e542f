//! The sphere kernel by itself (robustness.md S01, S04, S05, S08); what a whole scene does with it is tested in
//! `luxel_cpu`.
use glam::{DVec3, Vec3};
use luxel_geom::{Exclude, Ray, Real, SlabRay, Vector, spawn, sphere};
use luxel_testkit::Random;

fn first_hit(ray: &Ray<f32>, center: Vec3, radius: f32, exclude: Exclude) -> Option<f32> {
    sphere::intersect(&SlabRay::new(ray), center, radius, exclude)
}

/// The textbook's b² − 4ac in single precision: what the kernel must be better than.
fn textbook_hits(ray: &Ray<f32>, center: Vec3, radius: f32) -> bool {
    let f = ray.origin - center;
    let (a, b, c) = (ray.direction.dot(ray.direction), f.dot(ray.direction), f.dot(f) - radius * radius);
    b * b - a * c >= 0.0
}

/// Distance of the ray's line from the centre over the radius, in double precision.
fn relative_miss(ray: &Ray<f32>, center: Vec3, radius: f32) -> f64 {
    let (f, d) = (ray.origin.as_dvec3() - center.as_dvec3(), ray.direction.as_dvec3());
    (f - d * (f.dot(d) / d.dot(d))).length() / f64::from(radius)
}

/// How near to the silhouette rounding may decide: 1e-3 of the radius. From 10⁴ radii on it is more, as the foot of the
/// perpendicular from the centre is a difference of two numbers of the size of the distance.
fn silhouette_band(distance: f32) -> f64 {
    f64::from(2.0 * f32::UNIT_ROUNDOFF * distance).max(1e-3)
}

#[test]
fn s01_far_spheres_keep_their_silhouette() {
    let mut random = Random::new(11);
    let (mut wrong, mut textbook_wrong) = (0, 0);
    for distance in [3.0f32, 100.0, 1e3, 4096.0, 1e5] {
        for _ in 0..100_000 {
            // Coordinates that subtract without rounding: else the input is off before the test begins.
            let center = (random.point(1.0) * 64.0).round() / 64.0;
            let origin = center + distance * random.direction();
            let ray: Ray<f32> = Ray::new(origin, center + 1.2 * random.direction() - origin);
            let miss = relative_miss(&ray, center, 1.0);
            if (miss - 1.0).abs() > silhouette_band(distance) {
                let hits = first_hit(&ray, center, 1.0, Exclude::Nothing).is_some();
                wrong += u32::from(hits != (miss < 1.0));
                textbook_wrong += u32::from(textbook_hits(&ray, center, 1.0) != (miss < 1.0));
            }
        }
    }
    assert_eq!(wrong, 0);
    assert!(textbook_wrong > 10_000, "the rays are too easy: {textbook_wrong}");
}

#[test]
fn singles_and_doubles_agree() {
    let mut random = Random::new(12);
    for _ in 0..200_000 {
        let (center, radius) = (random.point(2.0), random.between(0.5, 2.0));
        let ray: Ray<f32> = Ray::new(random.point(8.0), random.direction());
        let exact = Ray::new(ray.origin.as_dvec3(), ray.direction.as_dvec3());
        let t = first_hit(&ray, center, radius, Exclude::Nothing);
        let reference: Option<f64> =
            sphere::intersect(&SlabRay::new(&exact), center.as_dvec3(), f64::from(radius), Exclude::Nothing);
        // Near the silhouette, and where the origin lies on the sphere, rounding may decide.
        let miss = relative_miss(&ray, center, radius);
        let on_surface = ((ray.origin - center).length() / radius - 1.0).abs() < 1e-3;
        if (miss - 1.0).abs() > 1e-3 && !on_surface {
            assert_eq!(t.is_some(), reference.is_some(), "{ray:?} {center} {radius}");
            let apart = t.zip(reference).map_or(0.0, |(t, r)| (f64::from(t) - r).abs());
            assert!(apart < 1e-4, "{ray:?} {center} {radius} {apart:e}");
        }
    }
}

#[test]
fn s04_tangent_rays_give_finite_parameters() {
    let mut random = Random::new(4);
    for _ in 0..20_000 {
        let (radius, direction) = (random.log_between(1e-6, 1e6), random.direction());
        let side = direction.cross(random.direction()).normalized();
        for k in -8i32..=8 {
            let offset = f32::from_bits(radius.to_bits().wrapping_add_signed(k));
            let ray: Ray<f32> = Ray::new(side * offset - direction * radius, direction);
            let t = first_hit(&ray, Vec3::ZERO, radius, Exclude::Nothing);
            // Half a chord of relative height h is √(2h): at 64 roundings that is 3e-3.
            assert!(t.is_none_or(|t| (t / radius - 1.0).abs() < 3e-3), "{radius:e} {k} {t:?}");
        }
    }
}

/// Where a random ray from outside meets a sphere, as a spawn point: point, error and normal.
fn surface_point(random: &mut Random, center: Vec3, radius: f32) -> (Vec3, Vec3, Vec3) {
    let (point, normal) = sphere::surface::<f32>(center + radius * random.direction(), center, radius);
    (point, sphere::point_error::<f32>(center, radius), normal)
}

#[test]
fn s05_a_million_outward_rays_meet_nothing() {
    let mut random = Random::new(5);
    let mut textbook_meets = 0;
    for i in 0..1_000_000 {
        let (center, radius) = (random.point(8.0), random.log_between(1e-3, 1e3));
        let (point, error, normal) = surface_point(&mut random, center, radius);
        let direction = outward(&mut random, normal, i % 2 == 0);
        let origin = spawn::offset_origin::<f32>(point, error, normal, direction);
        let ray: Ray<f32> = Ray::new(origin, direction);
        assert_eq!(first_hit(&ray, center, radius, Exclude::Leaving), None);
        // The offset alone is enough here; the exclusion is for spheres that touch others.
        assert_eq!(first_hit(&ray, center, radius, Exclude::Nothing), None, "{ray:?} {center} {radius}");
        let without: Ray<f32> = Ray::new(point, direction);
        textbook_meets += u32::from(first_hit(&without, center, radius, Exclude::Nothing).is_some());
    }
    assert!(textbook_meets > 1000, "rays without an offset re-hit nothing either: {textbook_meets}");
}

/// A unit direction on the normal's side; a grazing one has a cosine of 1e-4 to 1e-2.
fn outward(random: &mut Random, normal: Vec3, grazing: bool) -> Vec3 {
    let any = random.direction();
    if grazing {
        let tangent = any.cross(normal).normalized();
        (tangent + normal * random.log_between(1e-4, 1e-2)).normalized()
    } else if any.dot(normal) < 0.0 {
        -any
    } else {
        any
    }
}

#[test]
fn s05_a_million_inward_rays_leave_once() {
    let mut random = Random::new(55);
    for i in 0..1_000_000 {
        let (center, radius) = (random.point(8.0), random.log_between(1e-3, 1e3));
        let (point, error, normal) = surface_point(&mut random, center, radius);
        let direction = -outward(&mut random, normal, i % 2 == 0);
        let origin = spawn::offset_origin::<f32>(point, error, normal, direction);
        let inside: Ray<f32> = Ray::new(origin, direction);
        let exit = first_hit(&inside, center, radius, Exclude::Entering);
        let exit = exit.unwrap_or_else(|| panic!("no way out: {inside:?} {center} {radius}"));
        assert!(exit > 0.0);
        // Where it comes out it is gone for good.
        let (point, normal) = sphere::surface::<f32>(inside.at(exit), center, radius);
        if direction.dot(normal) > 0.0 {
            let origin = spawn::offset_origin::<f32>(point, error, normal, direction);
            let outside: Ray<f32> = Ray::new(origin, direction);
            assert_eq!(first_hit(&outside, center, radius, Exclude::Nothing), None, "{outside:?}");
        }
    }
}

#[test]
fn s08_spheres_without_a_size_are_never_hit() {
    let mut random = Random::new(8);
    for radius in [0.0, -0.0, -1.0, f32::NAN, f32::NEG_INFINITY] {
        for _ in 0..1000 {
            let center = random.point(1.0);
            let outside = random.direction() * 4.0;
            for (origin, direction) in [(outside, center - outside), (center, random.direction())] {
                let aimed: Ray<f32> = Ray::new(origin, direction);
                for exclude in [Exclude::Nothing, Exclude::Leaving, Exclude::Entering] {
                    assert_eq!(first_hit(&aimed, center, radius, exclude), None, "{radius:e}");
                }
            }
        }
    }
}

#[test]
fn s08_a_subnormal_sphere_gives_no_nan() {
    let mut random = Random::new(88);
    for _ in 0..1000 {
        let ray: Ray<f32> = Ray::new(random.direction(), random.direction());
        let aimed: Ray<f32> = Ray::new(ray.origin, -ray.origin);
        for ray in [ray, aimed] {
            let t = first_hit(&ray, Vec3::ZERO, 1e-45, Exclude::Nothing);
            assert!(t.is_none_or(f32::is_finite), "{t:?}");
        }
    }
}

#[test]
fn doubles_resolve_a_planet() {
    // S03 in the anchor's precision: an eye 1.7 m above a planet, looking down to the horizon.
    let radius = 6.4e6;
    let ray = Ray::new(DVec3::new(0.0, radius + 1.7, 0.0), DVec3::new(1.0, -0.001, 0.0));
    let t = sphere::intersect(&SlabRay::new(&ray), DVec3::ZERO, radius, Exclude::Nothing).unwrap();
    // Flat ground would be met after 1700 m; the curvature t²/2r adds 13 % to the height that is lost.
    let flat = radius + 1.7 - 0.001 * t;
    assert!((flat.hypot(t) - radius).abs() < 1e-6, "{t}");
}
