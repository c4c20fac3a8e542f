//! The forest (§4.2): a dark, dense valley among high mountains with noisy snow, rock formations, trees under snow, and a
//! slackline over a clearing.

use glam::Vec3;

use super::Landscape;
use super::field::{Field, distance, mix, step};
use super::ground::{Cover, Spot};
use super::rocks::Rock;
use super::ropes::Beam;
use super::stuff::Stuff;
use super::things::{Offer, Thing, scatter};
use super::trees::{Crown, Tree};

/// The numbers of the forest; metres.
#[derive(Debug)]
pub(super) struct ForestRecipe {
    contrast: f32,
    thickness: f32,
    base: f32,
    mountain_height: f32,
    /// Where the mountains begin and end, from the valley's middle.
    flanks: [f32; 2],
    /// Height of the snow line, and over how many metres snow sets in.
    snow: [f32; 2],
    /// How rough the texture of snow is, of rock, and of the forest's floor.
    grains: [f32; 3],
    roughness: f32,
    /// From tree to tree, and how many places of a valley and of a flank have one.
    trees: (f32, [f32; 2]),
    /// Share of a crown that is leaves.
    leaves: f32,
    /// Up to where trees grow.
    tree_line: f32,
    /// Middle and radius of the clearing.
    clearing: ([f32; 2], f32),
    /// Height and sag of the slackline.
    line: [f32; 2],
}

pub(super) const FOREST: ForestRecipe = ForestRecipe {
    contrast: 1.0,
    thickness: 1.14,
    base: 38.0,
    mountain_height: 185.0,
    flanks: [62.0, 225.0],
    snow: [98.0, 46.0],
    grains: [1.6, 0.8, 0.25],
    roughness: 0.9,
    trees: (4.0, [0.9, 0.6]),
    leaves: 0.5,
    tree_line: 165.0,
    clearing: ([262.0, 300.0], 24.0),
    line: [9.0, 1.2],
};

pub(super) struct Forest {
    seed: u32,
    land: Field,
    detail: Field,
}

impl Forest {
    pub(super) fn new(seed: u32) -> Self {
        Self { seed, land: Field::new(seed, 11), detail: Field::new(seed, 12) }
    }

    /// 0 in the valley, 1 where mountains are highest.
    fn flank(&self, x: f32, z: f32) -> f32 {
        let middle = 262.0 + 0.16 * (z - 256.0) + 46.0 * self.land.at(0.0, z, 300.0);
        let away = (x - middle).abs() + 26.0 * self.land.fbm(x, z, 120.0, 3);
        step(FOREST.flanks[0], FOREST.flanks[1], away)
    }

    fn is_clear(&self, x: f32, z: f32) -> bool {
        let (centre, radius) = FOREST.clearing;
        distance([x, z], centre) < radius + 4.0 * self.land.at(x, z, 15.0)
    }

    /// How much snow lies at a height, before patches: 0 none, 1 all.
    fn snow(&self, x: f32, z: f32, height: f32) -> f32 {
        let [line, over] = FOREST.snow;
        step(line - over, line + over, height + 24.0 * self.land.fbm(x, z, 60.0, 3))
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
        let (flank, foot) = (self.flank(x, z), self.foot(offer));
        let [valley, slopes] = FOREST.trees.1;
        let glades = step(-0.45, -0.2, self.land.fbm(x, z, 40.0, 2));
        let line = FOREST.tree_line + 25.0 * self.land.fbm(x, z, 70.0, 2);
        let chance =
            mix(valley, slopes, flank.min(0.5) * 2.0) * glades * (1.0 - step(line - 50.0, line, foot.y));
        if roll > chance || self.is_clear(x, z) || self.slope(x, z) > 1.5 {
            return None;
        }
        let snow = self.snow(x, z, foot.y);
        let round = kind > 0.80 + 0.3 * snow;
        let high = mix(8.0, 19.0, size) * mix(1.0, 0.7, flank);
        Some(Thing::Tree(Tree {
            crown: if round {
                Crown::Round
            } else if kind < 0.02 {
                Crown::Dead
            } else {
                Crown::Conifer
            },
            foot: foot - Vec3::Y * 0.3,
            height: if round { 0.8 * high } else { high },
            radius: if round { mix(2.4, 4.2, size) } else { mix(1.9, 3.3, size) },
            leaves: if round {
                Stuff::Leaves
            } else if snow > 0.4 {
                Stuff::Frost
            } else {
                Stuff::Conifer
            },
            tone: 0.5 * tone - 0.4,
            mottle: 0.5,
            density: FOREST.leaves,
            snow: 0.75 * snow,
            seed: offer.seed,
        }))
    }

    fn bush(&self, offer: &Offer) -> Option<Thing> {
        let [roll, size, tone, _] = offer.rolls;
        let (x, z) = (offer.x, offer.z);
        let chance = if self.is_clear(x, z) { 0.10 } else { 0.3 * (1.0 - self.flank(x, z)) };
        (roll < chance).then(|| {
            let foot = self.foot(offer);
            Thing::Tree(Tree {
                crown: Crown::Bush,
                foot,
                height: mix(0.7, 1.5, size),
                radius: mix(0.6, 1.3, size),
                leaves: if tone < 0.7 { Stuff::Leaves } else { Stuff::Moss },
                tone: tone - 0.7,
                mottle: 0.4,
                density: 0.5,
                snow: 0.6 * self.snow(x, z, foot.y),
                seed: offer.seed,
            })
        })
    }

    fn rock(&self, offer: &Offer) -> Option<Thing> {
        let [roll, size, tone, lean] = offer.rolls;
        let (x, z) = (offer.x, offer.z);
        let crags = step(0.08, 0.35, self.land.fbm(x + 700.0, z, 75.0, 3));
        let flank = self.flank(x, z);
        if roll > 0.03 + 0.75 * crags * step(0.05, 0.4, flank)
            || self.is_clear(x, z)
            || self.slope(x, z) > 1.7
        {
            return None;
        }
        let tall = crags > 0.7 && size > 0.75;
        let wide = if tall { mix(3.0, 6.0, lean) } else { mix(0.8, 3.6, size * size) };
        let high = if tall { mix(5.0, 12.0, tone) } else { wide * mix(0.6, 1.2, lean) };
        let foot = self.foot(offer);
        Some(Thing::Rock(Rock {
            centre: foot + Vec3::Y * (0.3 * high),
            half: Vec3::new(wide, high, wide * mix(0.7, 1.3, tone)),
            stuff: Stuff::Rock,
            tone: 0.5 * tone - 0.3,
            mottle: 0.9,
            snow: 0.7 * self.snow(x, z, foot.y),
            seed: offer.seed,
        }))
    }

    /// The slackline, between two rocks at the clearing's borders.
    fn slackline(&self) -> [Thing; 3] {
        let ([x, z], radius) = FOREST.clearing;
        let [high, sag] = FOREST.line;
        let top = self.height(x, z) + high;
        let ends = [Vec3::new(x - radius + 1.0, top, z - 4.0), Vec3::new(x + radius - 1.0, top, z + 3.0)];
        let anchor = |end: Vec3, seed: u32| {
            let half = Vec3::new(2.4, 7.0, 2.2);
            let centre = end - Vec3::Y * (0.55 * half.y);
            let (stuff, seed) = (Stuff::Rock, self.seed ^ seed);
            Thing::Rock(Rock { centre, half, stuff, tone: 0.1, mottle: 0.7, snow: 0.0, seed })
        };
        let line = Beam { from: ends[0], to: ends[1], sag, thick: 0.0, stuff: Stuff::Cloth, seed: 0 };
        [anchor(ends[0], 1), anchor(ends[1], 2), Thing::Beam(line)]
    }
}

impl Landscape for Forest {
    fn height(&self, x: f32, z: f32) -> f32 {
        let flank = self.flank(x, z);
        let crags = self.land.ridged(x, z, 150.0, 6);
        let clear = step(0.6, 1.6, distance([x, z], FOREST.clearing.0) / FOREST.clearing.1);
        let hills = 9.0 * clear * self.land.fbm(x, z, 90.0, 4);
        let rough = FOREST.roughness * mix(0.25, 1.0, flank) * self.detail.fbm(x, z, 5.0, 3);
        let cliffs = 11.0 * flank * step(0.1, 0.2, self.land.fbm(x + 300.0, z, 55.0, 4));
        FOREST.base + hills + rough + cliffs + FOREST.mountain_height * flank * mix(0.35, 1.0, crags)
    }

    fn cover(&self, spot: &Spot) -> Cover {
        let (x, z) = (spot.x, spot.z);
        let [snowy, rocky, floor] = FOREST.grains;
        let grain = 1.5 * self.detail.at(x, z, 2.0) + 0.5 * (spot.roll - 0.5);
        let patch = self.detail.fbm(x, z, 7.0, 3) + 0.35 * (spot.roll - 0.5);
        let snow = self.snow(x, z, spot.height) - 0.3 * (spot.slope - 1.2).max(0.0);
        let deep = snow - 0.4 - 0.75 * patch;
        if snow > 0.02 && deep > 0.0 {
            let stuff = if deep < 0.28 { Stuff::Slush } else { Stuff::Snow };
            return Cover::bare(stuff, snowy * grain);
        }
        if spot.slope + 0.3 * patch > 1.0 {
            return Cover::bare(Stuff::Rock, rocky * grain + 0.3 * self.land.fbm(x, z, 30.0, 3));
        }
        if self.is_clear(x, z) {
            let tuft = (spot.roll < 0.2).then_some((Stuff::Grass, 0.5));
            return Cover { stuff: Stuff::Grass, tone: 0.4 + floor * grain, tuft };
        }
        let stuff = if patch > 0.1 { Stuff::Moss } else { Stuff::Litter };
        Cover { stuff, tone: floor * grain, tuft: (spot.roll < 0.16).then_some((Stuff::Moss, 0.6)) }
    }

    fn things(&self) -> Vec<Thing> {
        let mut things = Vec::from(self.slackline());
        things.extend(scatter(7.0, self.seed, 12, |offer| self.rock(offer)));
        things.extend(scatter(FOREST.trees.0, self.seed, 11, |offer| self.tree(offer)));
        things.extend(scatter(3.0, self.seed, 13, |offer| self.bush(offer)));
        things
    }

    fn thickness(&self) -> f32 {
        FOREST.thickness
    }

    fn contrast(&self) -> f32 {
        FOREST.contrast
    }
}
