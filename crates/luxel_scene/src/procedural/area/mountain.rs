//! The mountain (§4.3): all under snow, the greatest span of heights, trees under snow, dark rocks, and calm places.

use glam::Vec3;

use super::Landscape;
use super::field::{Field, distance, mix, step};
use super::ground::{Cover, Spot};
use super::rocks::Rock;
use super::stuff::Stuff;
use super::things::{Offer, Thing, scatter};
use super::trees::{Crown, Tree};

/// The numbers of the mountain; metres.
#[derive(Debug)]
pub(super) struct MountainRecipe {
    contrast: f32,
    thickness: f32,
    /// Height of the lower left corner, and how much higher the upper right one is.
    rise: [f32; 2],
    /// Height of ridges.
    ridges: f32,
    /// How rough the texture of snow is, and of rock.
    grains: [f32; 2],
    roughness: f32,
    /// How steep snow may lie.
    bare: f32,
    /// From tree to tree, and how many places have one, at most.
    trees: (f32, f32),
    leaves: f32,
    /// Share of a tree's upper side that is under snow.
    laden: f32,
    /// Middles and radii of calm places.
    calm: [([f32; 2], f32); 5],
}

pub(super) const MOUNTAIN: MountainRecipe = MountainRecipe {
    contrast: 1.0,
    thickness: 1.35,
    rise: [26.0, 225.0],
    ridges: 92.0,
    grains: [1.7, 0.6],
    roughness: 1.0,
    bare: 1.85,
    trees: (3.7, 0.88),
    leaves: 0.56,
    laden: 0.8,
    calm: [
        ([128.0, 350.0], 42.0),
        ([300.0, 385.0], 36.0),
        ([345.0, 205.0], 34.0),
        ([150.0, 160.0], 40.0),
        ([60.0, 455.0], 34.0),
    ],
};

pub(super) struct Mountain {
    seed: u32,
    land: Field,
    detail: Field,
}

impl Mountain {
    pub(super) fn new(seed: u32) -> Self {
        Self { seed, land: Field::new(seed, 21), detail: Field::new(seed, 22) }
    }

    /// 1 in a calm place.
    fn calm(&self, x: f32, z: f32) -> f32 {
        let wave = 8.0 * self.land.fbm(x, z, 40.0, 2);
        let one = |(centre, radius): ([f32; 2], f32)| {
            1.0 - step(0.7 * radius, 1.15 * radius, distance(centre, [x, z]) + wave)
        };
        MOUNTAIN.calm.into_iter().map(one).fold(0.0, f32::max)
    }

    /// How much forest there is: most in the middle.
    fn woods(&self, x: f32, z: f32) -> f32 {
        let middle = 1.0 - step(60.0, 235.0, distance([x, z], [240.0, 275.0]));
        step(-0.25, 0.25, self.land.fbm(x, z, 95.0, 3) + 0.6 * middle - 0.2)
    }

    fn foot(&self, offer: &Offer) -> Vec3 {
        Vec3::new(offer.x, self.height(offer.x, offer.z), offer.z)
    }

    fn slope(&self, x: f32, z: f32) -> f32 {
        let here = self.height(x, z);
        (self.height(x + 2.0, z) - here).abs().max((self.height(x, z + 2.0) - here).abs()) / 2.0
    }

    fn tree(&self, offer: &Offer) -> Option<Thing> {
        let [roll, size, tone, kind] = offer.rolls;
        let (x, z) = (offer.x, offer.z);
        let foot = self.foot(offer);
        let chance = MOUNTAIN.trees.1 * mix(0.06, 1.0, self.woods(x, z)) * (1.0 - step(190.0, 240.0, foot.y));
        if roll > chance * (1.0 - self.calm(x, z)) || self.slope(x, z) > 1.3 {
            return None;
        }
        Some(Thing::Tree(Tree {
            crown: if kind < 0.04 { Crown::Dead } else { Crown::Conifer },
            foot: foot - Vec3::Y * 0.3,
            height: mix(6.0, 16.0, size),
            radius: mix(1.7, 3.1, size),
            leaves: if kind < 0.8 { Stuff::Frost } else { Stuff::Conifer },
            tone: 0.6 * tone,
            mottle: 0.5,
            density: MOUNTAIN.leaves,
            snow: MOUNTAIN.laden,
            seed: offer.seed,
        }))
    }

    fn rock(&self, offer: &Offer) -> Option<Thing> {
        let [roll, size, tone, lean] = offer.rolls;
        let (x, z) = (offer.x, offer.z);
        let crags = step(0.12, 0.4, self.land.fbm(x + 900.0, z, 70.0, 3) + 0.15 * step(330.0, 60.0, z));
        if roll > (0.02 + 0.4 * crags) * (1.0 - self.calm(x, z)) || self.slope(x, z) > 1.7 {
            return None;
        }
        let tall = crags > 0.7 && size > 0.78;
        let wide = if tall { mix(3.0, 6.5, lean) } else { mix(0.8, 3.4, size * size) };
        let high = if tall { mix(7.0, 18.0, tone) } else { wide * mix(0.6, 1.2, lean) };
        Some(Thing::Rock(Rock {
            centre: self.foot(offer) + Vec3::Y * (0.3 * high),
            half: Vec3::new(wide, high, wide * mix(0.7, 1.3, tone)),
            stuff: Stuff::DarkRock,
            tone: 0.5 * tone - 0.2,
            mottle: 0.9,
            snow: 0.5,
            seed: offer.seed,
        }))
    }
}

impl Landscape for Mountain {
    fn height(&self, x: f32, z: f32) -> f32 {
        let across = ((x + 512.0 - z) / 1024.0 + 0.10 * self.land.fbm(x, z, 260.0, 3)).clamp(0.0, 1.0);
        let [low, rise] = MOUNTAIN.rise;
        let calm = self.calm(x, z);
        let ridges = MOUNTAIN.ridges * mix(0.35, 1.0, across) * self.land.ridged(x, z, 140.0, 6);
        let smooth = MOUNTAIN.ridges * mix(0.35, 1.0, across) * self.land.ridged(x, z, 140.0, 1) * 0.5;
        let rough = MOUNTAIN.roughness * self.detail.fbm(x, z, 5.0, 3);
        low + rise * across * across.sqrt() + mix(ridges + rough, smooth + 0.12 * rough, calm)
    }

    fn cover(&self, spot: &Spot) -> Cover {
        let (x, z) = (spot.x, spot.z);
        let [snowy, rocky] = MOUNTAIN.grains;
        let noisy = 1.0 - 0.95 * self.calm(x, z);
        let grain = noisy * (1.5 * self.detail.at(x, z, 2.0) + 0.5 * (spot.roll - 0.5));
        let patch = self.detail.fbm(x, z, 7.0, 3) + 0.35 * (spot.roll - 0.5);
        let steep = spot.slope + 0.6 * noisy * patch - MOUNTAIN.bare;
        if steep > 0.0 {
            let stuff = if steep < 0.45 { Stuff::Slush } else { Stuff::DarkRock };
            return Cover::bare(stuff, rocky * grain);
        }
        Cover::bare(Stuff::Snow, 0.1 + snowy * grain + 0.2 * self.land.fbm(x, z, 40.0, 2))
    }

    fn things(&self) -> Vec<Thing> {
        let mut things = scatter(7.0, self.seed, 22, |offer| self.rock(offer));
        things.extend(scatter(MOUNTAIN.trees.0, self.seed, 21, |offer| self.tree(offer)));
        things
    }

    fn thickness(&self) -> f32 {
        MOUNTAIN.thickness
    }

    fn contrast(&self) -> f32 {
        MOUNTAIN.contrast
    }
}
