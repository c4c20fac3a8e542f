//! Spheres scattered evenly, a picture's rays, and one bounce from every hit.
use glam::Vec3;
use luxel_flat::SphereRecord;
use luxel_geom::Ray;
use luxel_testkit::{Random, spheres};

use crate::Hit;

const WIDTH: u32 = 1920;
const HEIGHT: u32 = 1080;
const EYE: Vec3 = Vec3::new(0.0, 0.0, 3.5);

/// Spheres in the cube of corners ±1, and the random numbers for their rays.
pub struct Spheres {
    pub records: Vec<SphereRecord>,
    random: Random,
}

impl Spheres {
    /// Radii between one and three eighths of the mean distance of neighbours.
    pub fn new(count: usize) -> Self {
        let mut random = Random::new(42);
        let spacing = 2.0 / (count as f32).cbrt();
        let mut one = |id| {
            let center = random.point(1.0);
            spheres::sphere(center, spacing * random.between(0.125, 0.375), id)
        };
        Self { records: (0..count as u32).map(&mut one).collect(), random }
    }

    /// One ray through the middle of every pixel.
    pub fn primary_rays(&self) -> Vec<Ray<f32>> {
        let at = |i: u32, size: u32| (i as f32 + 0.5) / size as f32 * 2.0 - 1.0;
        let half = 0.5;
        let aspect = WIDTH as f32 / HEIGHT as f32;
        let pixels = (0..HEIGHT).flat_map(|y| (0..WIDTH).map(move |x| (x, y)));
        let direction = |(x, y)| Vec3::new(at(x, WIDTH) * half * aspect, -at(y, HEIGHT) * half, -1.0);
        pixels.map(|pixel| Ray::new(EYE, direction(pixel).normalize())).collect()
    }

    /// A diffuse bounce from each hit.
    pub fn bounce_rays(&mut self, rays: &[Ray<f32>], hits: &[Hit]) -> Vec<Ray<f32>> {
        let mut bounces = Vec::new();
        for (ray, hit) in rays.iter().zip(hits) {
            if let Some((t, sphere)) = hit {
                let sphere = &self.records[*sphere as usize];
                let point = ray.at(*t);
                let normal = (point - Vec3::from(sphere.center)).normalize();
                let direction = (normal + self.random.direction().normalize() * 0.999).normalize();
                bounces.push(Ray::new(point + normal * (1e-3 * sphere.radius.max(1e-3)), direction));
            }
        }
        bounces
    }
}
