//! The biomes (§4.4): forest, mountain, desert and desert under snow in one, with noisy, partial snow at their borders.

use glam::Vec3;

use super::Landscape;
use super::field::{Field, distance, mix, step};
use super::ground::{Cover, Spot};
use super::rocks::Rock;
use super::stuff::Stuff;
use super::things::{Offer, Thing, scatter};
use super::trees::{Crown, Tree};

/// The numbers of the biomes; metres.
#[derive(Debug)]
pub(super) struct BiomesRecipe {
    contrast: f32,
    thickness: f32,
    base: f32,
    /// Middle and radius of the mountain, and its height.
    mountain: ([f32; 2], f32),
    mountain_height: f32,
    /// Where the forest's border is, in metres from the lower left corner along the diagonal.
    forest: f32,
    /// Above this z lies snow.
    snow: f32,
    /// How many metres of z a border of snow takes.
    border: f32,
    /// How rough the texture of snow is, of rock, and of sand.
    grains: [f32; 3],
    roughness: [f32; 2],
    trees: (f32, f32),
    leaves: f32,
}

pub(super) const BIOMES: BiomesRecipe = BiomesRecipe {
    contrast: 1.0,
    thickness: 0.62,
    base: 70.0,
    mountain: ([372.0, 130.0], 150.0),
    mountain_height: 120.0,
    forest: 300.0,
    snow: 215.0,
    border: 55.0,
    grains: [0.9, 0.9, 0.25],
    roughness: [0.4, 1.0],
    trees: (4.5, 0.85),
    leaves: 0.45,
};

pub(super) struct Biomes {
    seed: u32,
    land: Field,
    detail: Field,
}

impl Biomes {
    pub(super) fn new(seed: u32) -> Self {
        Self { seed, land: Field::new(seed, 31), detail: Field::new(seed, 32) }
    }

    fn wave(&self, x: f32, z: f32) -> f32 {
        34.0 * self.land.fbm(x, z, 110.0, 4)
    }

    fn mountain(&self, x: f32, z: f32) -> f32 {
        let (centre, radius) = BIOMES.mountain;
        (1.0 - (distance([x, z], centre) + 0.6 * self.wave(x, z)) / radius).clamp(0.0, 1.0)
    }

    /// 1 in the forest.
    fn forest(&self, x: f32, z: f32) -> f32 {
        let away = 0.8 * (x + 512.0 - z) + 0.9 * self.wave(x + 400.0, z);
        1.0 - step(BIOMES.forest - 18.0, BIOMES.forest + 18.0, away)
    }

    /// 1 deep in the snow; heights have more of it.
    fn snow(&self, x: f32, z: f32) -> f32 {
        let north = BIOMES.snow - z + 1.3 * self.wave(x, z + 300.0) + 60.0 * self.mountain(x, z);
        step(-BIOMES.border, BIOMES.border, north)
    }

    fn foot(&self, offer: &Offer) -> Vec3 {
        Vec3::new(offer.x, self.height(offer.x, offer.z), offer.z)
    }

    fn tree(&self, offer: &Offer) -> Option<Thing> {
        let [roll, size, tone, kind] = offer.rolls;
        let (x, z) = (offer.x, offer.z);
        let (forest, mountain, snow) = (self.forest(x, z), self.mountain(x, z), self.snow(x, z));
        let slopes = 0.22 * step(0.02, 0.12, mountain) * (1.0 - step(0.4, 0.55, mountain));
        let chance =
            BIOMES.trees.1 * forest * step(-0.5, -0.2, self.land.fbm(x, z, 40.0, 2)) + slopes + 0.006;
        if roll > chance {
            return None;
        }
        let (crown, leaves) = match kind {
            k if forest < 0.3 && mountain < 0.02 => {
                (if k < 0.7 { Crown::Umbrella } else { Crown::Dead }, Stuff::OliveLeaves)
            }
            k if k > 0.6 && snow < 0.3 => {
                (Crown::Round, if k > 0.93 { Stuff::GoldLeaves } else { Stuff::Leaves })
            }
            _ => (Crown::Conifer, Stuff::Conifer),
        };
        let high = mix(6.0, 15.0, size);
        let narrow = crown == Crown::Conifer;
        Some(Thing::Tree(Tree {
            crown,
            foot: self.foot(offer) - Vec3::Y * 0.3,
            height: if narrow { high } else { 0.6 * high },
            radius: if narrow { mix(1.7, 3.0, size) } else { mix(2.2, 3.8, size) },
            leaves,
            tone: 0.5 * tone - 0.4,
            mottle: 0.45,
            density: BIOMES.leaves,
            snow: 0.7 * snow,
            seed: offer.seed,
        }))
    }

    fn bush(&self, offer: &Offer) -> Option<Thing> {
        let [roll, size, tone, _] = offer.rolls;
        let (x, z) = (offer.x, offer.z);
        let dry = 0.08 * step(0.0, 0.4, self.land.fbm(x, z, 55.0, 2));
        (roll < 0.15 * self.forest(x, z) + dry).then(|| {
            Thing::Tree(Tree {
                crown: Crown::Bush,
                foot: self.foot(offer),
                height: mix(0.7, 1.5, size),
                radius: mix(0.6, 1.3, size),
                leaves: if tone < 0.5 { Stuff::OliveLeaves } else { Stuff::DryGrass },
                tone: tone - 0.7,
                mottle: 0.5,
                density: 0.5,
                snow: 0.6 * self.snow(x, z),
                seed: offer.seed,
            })
        })
    }

    fn rock(&self, offer: &Offer) -> Option<Thing> {
        let [roll, size, tone, lean] = offer.rolls;
        let (x, z) = (offer.x, offer.z);
        let mountain = self.mountain(x, z);
        let crags = step(0.15, 0.4, self.land.fbm(x + 900.0, z, 70.0, 3)) * (1.0 - self.forest(x, z));
        if roll > 0.015 + 0.5 * crags + 0.2 * step(0.2, 0.5, mountain) {
            return None;
        }
        let tall = crags > 0.7 && size > 0.7;
        let wide = if tall { mix(3.0, 6.5, lean) } else { mix(0.8, 3.2, size * size) };
        let high = if tall { mix(7.0, 18.0, tone) } else { wide * mix(0.6, 1.2, lean) };
        Some(Thing::Rock(Rock {
            centre: self.foot(offer) + Vec3::Y * (0.3 * high),
            half: Vec3::new(wide, high, wide * mix(0.7, 1.3, tone)),
            stuff: if mountain > 0.02 { Stuff::Rock } else { Stuff::RedRock },
            tone: 0.5 * tone - 0.25,
            mottle: 0.9,
            snow: 0.75 * self.snow(x, z),
            seed: offer.seed,
        }))
    }
}

impl Landscape for Biomes {
    fn height(&self, x: f32, z: f32) -> f32 {
        let mountain = self.mountain(x, z);
        let [open, rough] = BIOMES.roughness;
        let dome = step(0.0, 0.9, mountain);
        let crags = mix(0.45, 1.0, self.land.ridged(x, z, 105.0, 6));
        let dunes = 5.0 * self.land.ridged(x, z + 0.4 * x, 62.0, 2) * (1.0 - self.forest(x, z));
        let mesa =
            step(0.16, 0.24, self.land.fbm(x + 150.0, z + 90.0, 115.0, 4)) * (1.0 - step(0.0, 0.1, mountain));
        BIOMES.base
            + 12.0 * self.land.fbm(x, z, 160.0, 4)
            + dunes
            + 15.0 * mesa
            + BIOMES.mountain_height * dome * crags
            + mix(open, rough, step(0.0, 0.2, mountain)) * self.detail.fbm(x, z, 5.0, 3)
    }

    fn cover(&self, spot: &Spot) -> Cover {
        let (x, z) = (spot.x, spot.z);
        let [snowy, rocky, sandy] = BIOMES.grains;
        let grain = 1.5 * self.detail.at(x, z, 2.0) + 0.5 * (spot.roll - 0.5);
        let patch = self.detail.fbm(x, z, 6.0, 3) + 0.4 * (spot.roll - 0.5);
        let mountain = self.mountain(x, z);
        let snow = self.snow(x, z) - 0.3 * (spot.slope - 1.1).max(0.0);
        let deep = snow - 0.5 - 0.75 * patch;
        if snow > 0.02 && deep > 0.0 {
            let stuff = if deep < 0.2 { Stuff::Slush } else { Stuff::Snow };
            return Cover::bare(stuff, snowy * grain);
        }
        if spot.slope + 0.3 * patch > 0.85 || mountain > 0.25 + 0.4 * patch {
            let stuff = if mountain > 0.02 { Stuff::Rock } else { Stuff::RedRock };
            return Cover::bare(stuff, rocky * grain);
        }
        let forest = self.forest(x, z);
        if forest + 0.5 * patch > 0.5 {
            let stuff = if patch > 0.1 { Stuff::Moss } else { Stuff::Litter };
            return Cover {
                stuff,
                tone: sandy * grain,
                tuft: (spot.roll < 0.10).then_some((Stuff::Moss, 0.5)),
            };
        }
        let broad = 0.3 * self.land.fbm(x, z, 45.0, 3);
        if patch > 0.3 {
            return Cover {
                stuff: Stuff::Earth,
                tone: 0.5 + broad + sandy * grain,
                tuft: (spot.roll < 0.05).then_some((Stuff::DryGrass, 0.5)),
            };
        }
        Cover::bare(Stuff::Sand, broad + sandy * grain)
    }

    fn things(&self) -> Vec<Thing> {
        let mut things = scatter(7.0, self.seed, 32, |offer| self.rock(offer));
        things.extend(scatter(BIOMES.trees.0, self.seed, 31, |offer| self.tree(offer)));
        things.extend(scatter(3.0, self.seed, 33, |offer| self.bush(offer)));
        things
    }

    fn thickness(&self) -> f32 {
        BIOMES.thickness
    }

    fn contrast(&self) -> f32 {
        BIOMES.contrast
    }
}
