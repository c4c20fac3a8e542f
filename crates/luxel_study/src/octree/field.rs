//! The scenes of the octree study, in memory: random spheres in a box, as in seed document 1 (II.A), and its three
//! materials side by side.
//!
//! The box is always the same and the spheres fill always the same part of it, so that a picture stays as full of
//! detail, and the camera where it is, from ten spheres to a million. (The report does not say how its spheres
//! shrink, or its box grows, with their number.) No ground and no other object: rays meet spheres or the sky.
use bevy_ecs::prelude::*;
use glam::{DVec3, Vec3};
use luxel_geom::Ray;
use luxel_geom::rng::uniform4;
use luxel_scene::{ActiveCamera, Camera, Environment, Material, Sphere, Transform};

/// Half the edge of the box of centres, metres.
const HALF_EDGE: f64 = 1.0;
/// The part of the box that the spheres would fill if none overlapped.
const FILLED: f64 = 0.03;
/// Radii lie between these multiples of the one that fills the box.
const RADIUS_SPREAD: (f64, f64) = (0.6, 1.3);
/// Radii of large spheres among small ones, metres: three to five tenths of the box (robustness.md, O01).
const LARGE_RADII: (f64, f64) = (0.6, 1.0);
/// Where the camera stands; it looks at the origin and sees the whole box and sky around it.
const EYE: DVec3 = DVec3::new(0.9, 0.7, 3.7);

/// Dark enough for bright spheres to stand out.
const SKY: Environment = Environment::Gradient {
    zenith: Vec3::new(0.12, 0.25, 0.62),
    horizon: Vec3::new(0.42, 0.52, 0.68),
    ground: Vec3::new(0.07, 0.06, 0.05),
};

/// A scene of the octree study.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(crate) enum SphereField {
    /// Three spheres: Lambert, metal, dielectric from left to right.
    Materials,
    /// Random spheres of three materials at random places.
    Random {
        /// How many.
        count: u32,
        /// Picks them.
        seed: u32,
    },
    /// The same with large spheres among them: what the report's heuristic is worst at.
    Mixed {
        /// How many small ones.
        count: u32,
        /// How many large ones.
        large: u32,
        /// Picks them.
        seed: u32,
    },
}

impl SphereField {
    /// Number of spheres.
    pub(crate) fn count(&self) -> u32 {
        match self {
            Self::Materials => 3,
            Self::Random { count, .. } => *count,
            Self::Mixed { count, large, .. } => count + large,
        }
    }

    /// The spheres: place, shape, surface.
    fn spheres(self) -> Vec<(Transform, Sphere, Material)> {
        match self {
            Self::Materials => three_materials(),
            Self::Random { count, seed } => {
                (0..count).map(|index| random_sphere(index, count, seed)).collect()
            }
            Self::Mixed { count, large, seed } => (0..large)
                .map(|index| large_sphere(index, count, seed))
                .chain((large..count + large).map(|index| random_sphere(index, count, seed)))
                .collect(),
        }
    }
}

/// A world with the spheres of a field and a camera that looks at the box.
pub(crate) fn world(field: SphereField) -> World {
    let mut world = luxel_scene::empty_world();
    let camera = Camera { focus_distance: EYE.length(), ..Camera::default() };
    world.insert_resource(SKY);
    luxel_scene::spawn(&mut world, (Transform::looking_at(EYE, DVec3::ZERO), camera, ActiveCamera));
    for sphere in field.spheres() {
        luxel_scene::spawn(&mut world, sphere);
    }
    world
}

/// Rays from anywhere to anywhere: every second one starts in the box, the others around it.
pub(crate) fn rays(count: u32, seed: u32) -> impl Iterator<Item = Ray<f32>> {
    (0..count).map(move |index| {
        let [x, y, z, _] = uniform4::<f64>(index, 3, 0, seed);
        let [u, v, w, _] = uniform4::<f64>(index, 4, 0, seed);
        let in_box = |x: f64, y: f64, z: f64| (2.0 * DVec3::new(x, y, z) - DVec3::ONE) * HALF_EDGE;
        let target = in_box(u, v, w);
        let around = 3.0 * HALF_EDGE * in_box(x, y, z).try_normalize().unwrap_or(DVec3::X);
        let origin = if index % 2 == 0 { in_box(x, y, z) } else { around };
        Ray::new(origin.as_vec3(), (target - origin).as_vec3())
    })
}

fn three_materials() -> Vec<(Transform, Sphere, Material)> {
    let materials = [
        Material::lambert(Vec3::new(0.75, 0.25, 0.2)),
        Material::metal(Vec3::new(0.85, 0.75, 0.5), 0.05),
        Material::dielectric(1.5),
    ];
    let place = |index: usize| Transform::at(DVec3::new(1.1 * (index as f64 - 1.0), 0.0, 0.0));
    materials.into_iter().enumerate().map(|(i, m)| (place(i), Sphere { radius: 0.5 }, m)).collect()
}

fn large_sphere(index: u32, count: u32, seed: u32) -> (Transform, Sphere, Material) {
    let (place, _, material) = random_sphere(index, count, seed);
    let [size, ..] = uniform4::<f64>(index, 2, 0, seed);
    let radius = LARGE_RADII.0 + (LARGE_RADII.1 - LARGE_RADII.0) * size;
    (place, Sphere { radius }, material)
}

fn random_sphere(index: u32, count: u32, seed: u32) -> (Transform, Sphere, Material) {
    let [u, v, w, size] = uniform4::<f64>(index, 0, 0, seed);
    let place = (2.0 * DVec3::new(u, v, w) - DVec3::ONE) * HALF_EDGE;
    let volume_each = FILLED * (2.0 * HALF_EDGE).powi(3) / f64::from(count.max(1));
    let radius = (volume_each * 0.75 / std::f64::consts::PI).cbrt();
    let (small, large) = RADIUS_SPREAD;
    let sphere = Sphere { radius: radius * (small + (large - small) * size) };
    (Transform::at(place), sphere, random_material(index, seed))
}

/// As many of each material.
fn random_material(index: u32, seed: u32) -> Material {
    let [red, green, blue, fuzz] = uniform4::<f64>(index, 1, 0, seed).map(|x| x as f32);
    let color = Vec3::new(red, green, blue);
    match index % 3 {
        0 => Material::lambert(0.1 + 0.8 * color),
        1 => Material::metal(0.5 + 0.45 * color, 0.3 * fuzz),
        _ => Material::dielectric(1.5),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_world_has_the_spheres_of_its_field() {
        for (field, count) in [
            (SphereField::Random { count: 40, seed: 1 }, 40),
            (SphereField::Mixed { count: 40, large: 3, seed: 1 }, 43),
            (SphereField::Materials, 3),
        ] {
            let mut world = world(field);
            assert_eq!(world.query::<&Sphere>().iter(&world).count(), count);
            assert_eq!(field.count() as usize, count);
        }
    }

    #[test]
    fn spheres_shrink_with_their_number_and_stay_in_the_box() {
        let volume = |count| -> f64 {
            let spheres = SphereField::Random { count, seed: 3 }.spheres();
            assert!(spheres.iter().all(|(t, ..)| t.translation.abs().max_element() <= HALF_EDGE));
            spheres.iter().map(|(_, sphere, _)| 4.2 * sphere.radius.powi(3)).sum()
        };
        let (few, many) = (volume(500), volume(20_000));
        assert!((few / many - 1.0).abs() < 0.2 && (many / 8.0 - FILLED).abs() < 0.3 * FILLED, "{few} {many}");
    }
}
