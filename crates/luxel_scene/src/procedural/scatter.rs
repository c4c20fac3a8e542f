//! Many spheres by one recipe, as in the first seed document: random places in a box, random radii,
//! three materials.

use std::collections::HashMap;

use glam::{DVec3, IVec3, Vec3};
use serde::{Deserialize, Serialize};

use crate::components::Sphere;
use crate::material::Material;

use super::noise::random;

/// Seeded spheres; a scene file's `scatter` entry. Loading turns them into entities.
#[derive(Clone, PartialEq, Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Scatter {
    /// How many, 1..=1,000,000.
    pub(crate) count: u32,
    /// Picks the spheres.
    pub(crate) seed: u32,
    /// Corner of the box of centres, metres.
    pub(crate) min: DVec3,
    /// The opposite corner, not below `min`.
    pub(crate) max: DVec3,
    /// Smallest and largest radius, metres; small ones are more frequent.
    pub(crate) radius: (f64, f64),
    /// Whether spheres stand on y = `min.y` instead.
    #[serde(default)]
    pub(crate) resting: bool,
    /// Whether to look for a place where a sphere touches no other (32 tries, then it stays).
    #[serde(default)]
    pub(crate) apart: bool,
}

/// Tries to place a sphere apart from the others.
const TRIES: u32 = 32;

impl Scatter {
    /// Centre, sphere and material of each.
    pub(crate) fn spheres(&self) -> Vec<(DVec3, Sphere, Material)> {
        let mut placed = Placed::new(2.0 * self.radius.1);
        (0..self.count)
            .map(|index| {
                let (centre, radius) = self.place(index, &placed);
                placed.add(centre, radius);
                (centre, Sphere { radius }, self.material(index))
            })
            .collect()
    }

    fn place(&self, index: u32, placed: &Placed) -> (DVec3, f64) {
        let tries = if self.apart { TRIES } else { 1 };
        let candidate = |attempt: u32| {
            let [u, v, w, size] = random([index, attempt, self.seed, 1]);
            let radius = self.radius.0 + (self.radius.1 - self.radius.0) * size * size;
            let mut centre = self.min + (self.max - self.min) * DVec3::new(u, v, w);
            if self.resting {
                centre.y = self.min.y + radius;
            }
            (centre, radius)
        };
        (0..tries)
            .map(candidate)
            .find(|&(centre, radius)| !self.apart || placed.is_free(centre, radius))
            .unwrap_or_else(|| candidate(tries - 1))
    }

    /// Six in ten matt, a quarter metal, the rest glass.
    fn material(&self, index: u32) -> Material {
        let [kind, hue, tone, fuzz] = random([index, 0, self.seed, 2]).map(|x| x as f32);
        match kind {
            k if k < 0.6 => Material::lambert(colour(hue, 0.25 + 0.65 * tone)),
            k if k < 0.85 => {
                Material::metal(Vec3::splat(0.75).lerp(colour(hue, 0.9), 0.5), 0.4 * fuzz * fuzz)
            }
            _ => Material::dielectric(1.5),
        }
    }
}

/// A saturated colour; `hue` runs once round the circle.
fn colour(hue: f32, value: f32) -> Vec3 {
    let channel = |shift: f32| {
        let wave = ((hue + shift).fract() * 6.0 - 3.0).abs() - 1.0;
        wave.clamp(0.0, 1.0)
    };
    let pure = Vec3::new(channel(0.0), channel(2.0 / 3.0), channel(1.0 / 3.0));
    Vec3::splat(0.4).lerp(pure, 0.6) * value
}

/// The spheres so far, in boxes as wide as the largest sphere.
struct Placed {
    width: f64,
    boxes: HashMap<IVec3, Vec<(DVec3, f64)>>,
}

impl Placed {
    fn new(width: f64) -> Self {
        Self { width, boxes: HashMap::new() }
    }

    fn box_of(&self, centre: DVec3) -> IVec3 {
        (centre / self.width).floor().as_ivec3()
    }

    fn add(&mut self, centre: DVec3, radius: f64) {
        let key = self.box_of(centre);
        self.boxes.entry(key).or_default().push((centre, radius));
    }

    fn is_free(&self, centre: DVec3, radius: f64) -> bool {
        let home = self.box_of(centre);
        (0..27)
            .map(|i| home.saturating_add(IVec3::new(i % 3, i / 3 % 3, i / 9) - 1))
            .filter_map(|key| self.boxes.get(&key))
            .flatten()
            .all(|&(other, size)| centre.distance(other) >= radius + size)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::material::Surface;

    fn recipe(apart: bool) -> Scatter {
        Scatter {
            count: 300,
            seed: 5,
            min: DVec3::new(-4.0, 1.0, -4.0),
            max: DVec3::new(4.0, 3.0, 4.0),
            radius: (0.05, 0.4),
            resting: false,
            apart,
        }
    }

    #[test]
    fn spheres_lie_in_the_box_and_show_three_materials() {
        let spheres = recipe(false).spheres();
        assert_eq!(spheres.len(), 300);
        let mut kinds = [0; 3];
        for (centre, sphere, material) in spheres {
            assert!(centre.cmpge(DVec3::new(-4.0, 1.0, -4.0)).all());
            assert!(centre.cmple(DVec3::new(4.0, 3.0, 4.0)).all());
            assert!((0.05..=0.4).contains(&sphere.radius));
            kinds[match material.surface {
                Surface::Lambert { .. } => 0,
                Surface::Metal { .. } => 1,
                Surface::Dielectric { .. } => 2,
                ref other => panic!("{other:?} is no kind of a scattered sphere"),
            }] += 1;
        }
        assert!(kinds.iter().all(|&count| count > 20), "{kinds:?}");
    }

    #[test]
    fn apart_means_no_two_touch() {
        let touching = |apart| {
            let spheres = recipe(apart).spheres();
            let mut count = 0;
            for (i, (a, r, _)) in spheres.iter().enumerate() {
                for (b, s, _) in &spheres[..i] {
                    count += usize::from(a.distance(*b) < r.radius + s.radius);
                }
            }
            count
        };
        assert_eq!(touching(true), 0);
        assert!(touching(false) > 0);
    }
}
