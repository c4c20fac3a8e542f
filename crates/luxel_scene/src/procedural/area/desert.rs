//! The desert (§4.1): a town in a valley, a bare plateau, large ruins, rock formations, a rough mountain, few trees, and
//! one small dark forest.

use glam::Vec3;

use super::Landscape;
use super::buildings::{Building, RingWall, Roof};
use super::field::{Field, distance, mix, random, step};
use super::ground::{Cover, Spot};
use super::rocks::{Arch, Rock};
use super::ropes::Beam;
use super::stuff::Stuff;
use super::things::{Offer, Thing, scatter};
use super::trees::{Crown, Tree};

/// The numbers of the desert; metres.
#[derive(Debug)]
pub(super) struct DesertRecipe {
    contrast: f32,
    thickness: f32,
    base: f32,
    /// Middle and radius of the town.
    town: ([f32; 2], f32),
    town_depth: f32,
    plateau_height: f32,
    /// Middle and radius of the mountain.
    mountain: ([f32; 2], f32),
    mountain_height: f32,
    /// Middle and radius of the dark forest.
    grove: ([f32; 2], f32),
    /// Middle and radius of the rock formations.
    rocks: ([f32; 2], f32),
    /// How rough the texture is: open land, the town's valley, the rocks' land, the mountain.
    grains: [f32; 4],
    /// Height of the roughness of open land, and of the mountain.
    roughness: [f32; 2],
}

pub(super) const DESERT: DesertRecipe = DesertRecipe {
    contrast: 1.2,
    thickness: 0.975,
    base: 78.0,
    town: ([205.0, 372.0], 84.0),
    town_depth: 15.0,
    plateau_height: 34.0,
    mountain: ([428.0, 92.0], 128.0),
    mountain_height: 118.0,
    grove: ([418.0, 238.0], 40.0),
    rocks: ([388.0, 372.0], 92.0),
    grains: [0.12, 0.5, 0.9, 1.0],
    roughness: [0.35, 2.2],
};

pub(super) struct Desert {
    seed: u32,
    land: Field,
    detail: Field,
}

impl Desert {
    pub(super) fn new(seed: u32) -> Self {
        Self { seed, land: Field::new(seed, 1), detail: Field::new(seed, 2) }
    }

    /// How much a place belongs to a round region with a wavy border.
    fn within(&self, (centre, radius): ([f32; 2], f32), x: f32, z: f32) -> f32 {
        let away = distance(centre, [x, z]) + 0.22 * radius * self.land.fbm(x, z, 0.9 * radius, 3);
        1.0 - step(0.75 * radius, 1.1 * radius, away)
    }

    /// Metres inside the plateau's border.
    fn plateau(&self, x: f32, z: f32) -> f32 {
        let wave = 22.0 * self.land.fbm(x, z, 95.0, 4);
        (252.0 - 0.12 * x - z + wave).min(318.0 - 0.15 * z - x + wave)
    }

    /// How rough the texture is.
    fn grain(&self, x: f32, z: f32) -> f32 {
        let [open, town, rocks, mountain] = DESERT.grains;
        let grain = mix(open, town, self.within(DESERT.town, x, z));
        let grain = mix(grain, rocks, self.within(DESERT.rocks, x, z));
        mix(grain, mountain, self.within(DESERT.mountain, x, z))
    }

    fn foot(&self, offer: &Offer) -> Vec3 {
        Vec3::new(offer.x, self.height(offer.x, offer.z), offer.z)
    }

    /// Trees of the grove, of the lower left corner, and a few elsewhere.
    fn tree(&self, offer: &Offer) -> Option<Thing> {
        let [roll, size, tone, _] = offer.rolls;
        let (x, z) = (offer.x, offer.z);
        let grove = self.within(DESERT.grove, x, z);
        if grove > 0.4 && roll < 0.93 {
            return Some(Thing::Tree(Tree {
                crown: Crown::Round,
                foot: self.foot(offer),
                height: mix(6.0, 11.0, size),
                radius: mix(2.2, 3.6, size),
                leaves: Stuff::Leaves,
                tone: mix(-0.7, -0.3, tone),
                mottle: 0.3,
                density: 0.55,
                snow: 0.0,
                seed: offer.seed,
            }));
        }
        let corner = distance([x, z], [62.0, 448.0]) < 52.0;
        let rim = (4.0..26.0).contains(&self.plateau(x, z)) && x < 140.0;
        let town = self.within(DESERT.town, x, z) > 0.5;
        let chance = match (corner, rim || town) {
            (true, _) => 0.085,
            (false, true) => 0.05,
            (false, false) => 0.0012,
        };
        (roll < chance && grove < 0.1).then(|| {
            Thing::Tree(Tree {
                crown: if tone < 0.8 { Crown::Umbrella } else { Crown::Dead },
                foot: self.foot(offer),
                height: mix(5.0, 8.5, size),
                radius: mix(2.4, 4.6, size),
                leaves: Stuff::OliveLeaves,
                tone: mix(-0.5, 0.1, tone),
                mottle: 0.6,
                density: 0.5,
                snow: 0.0,
                seed: offer.seed,
            })
        })
    }

    fn bush(&self, offer: &Offer) -> Option<Thing> {
        let [roll, size, tone, _] = offer.rolls;
        let (x, z) = (offer.x, offer.z);
        let near = self.within(DESERT.grove, x, z).max(0.5 * self.within(DESERT.rocks, x, z));
        let dry = 0.05 * step(0.0, 0.4, self.land.fbm(x, z, 60.0, 2));
        let chance = if self.plateau(x, z) > 4.0 { 0.004 } else { 0.3 * near + dry };
        (roll < chance).then(|| {
            Thing::Tree(Tree {
                crown: Crown::Bush,
                foot: self.foot(offer),
                height: mix(0.7, 1.6, size),
                radius: mix(0.6, 1.4, size),
                leaves: if tone < 0.5 { Stuff::OliveLeaves } else { Stuff::DryGrass },
                tone: tone - 0.6,
                mottle: 0.6,
                density: 0.5,
                snow: 0.0,
                seed: offer.seed,
            })
        })
    }

    /// Boulders, and pillars in the land of rocks.
    fn rock(&self, offer: &Offer) -> Option<Thing> {
        let [roll, size, tone, lean] = offer.rolls;
        let (x, z) = (offer.x, offer.z);
        let land = self.within(DESERT.rocks, x, z);
        let slopes = self.within(DESERT.mountain, x, z);
        if roll > 0.5 * land + 0.25 * slopes + 0.012 || self.within(DESERT.town, x, z) > 0.2 {
            return None;
        }
        let pillar = land > 0.5 && size > 0.72;
        let wide = if pillar { mix(3.0, 6.5, lean) } else { mix(0.7, 3.4, size * size) };
        let high = if pillar { mix(9.0, 22.0, tone) } else { wide * mix(0.5, 1.1, lean) };
        Some(Thing::Rock(Rock {
            centre: self.foot(offer) + Vec3::Y * (0.35 * high),
            half: Vec3::new(wide, high, wide * mix(0.7, 1.3, tone)),
            stuff: Stuff::RedRock,
            tone: 0.3 * tone - 0.15,
            mottle: 0.9,
            snow: 0.0,
            seed: offer.seed,
        }))
    }

    /// Houses along streets that cross, smaller towards the wall.
    fn house(&self, offer: &Offer) -> Option<Thing> {
        const BLOCK: f32 = 12.5;
        let [roll, size, tone, shape] = offer.rolls;
        let (column, row) = ((offer.x / BLOCK).floor(), (offer.z / BLOCK).floor());
        let (x, z) = ((column + 0.5) * BLOCK, (row + 0.5) * BLOCK);
        let ([cx, cz], radius) = DESERT.town;
        let away = distance([x, z], [cx, cz]);
        // A street goes through each fourth column and row, and a square is left in the middle.
        let street = (column as i32) % 4 == 0 || (row as i32) % 5 == 0;
        if away > radius - 13.0 || away < 11.0 || street || roll > 0.94 {
            return None;
        }
        let central = 1.0 - away / radius;
        let half = [mix(3.4, 5.5, size), mix(3.4, 5.5, shape)];
        let storeys = 1.0 + (mix(0.6, 3.4, tone) * (0.5 + central)).floor();
        let roof = match roll {
            r if r < 0.12 => Roof::Dome,
            r if r < 0.40 => Roof::Gable,
            _ => Roof::Flat,
        };
        let tower = roll > 0.90;
        Some(Thing::Building(Building {
            foot: Vec3::new(x, self.height(x, z) - 0.2, z),
            half: if tower { [2.6, 2.6] } else { half },
            height: if tower { 21.0 } else { 3.3 * storeys },
            roof,
            walls: if shape < 0.65 { Stuff::Plaster } else { Stuff::Stone },
            tone: tone - 0.5,
            seed: offer.seed,
        }))
    }

    /// Small things in the town's streets and outside its wall: stalls, crates, tents.
    fn clutter(&self, offer: &Offer) -> Option<Thing> {
        let [roll, size, tone, shape] = offer.rolls;
        let away = distance([offer.x, offer.z], DESERT.town.0) / DESERT.town.1;
        let chance = if away < 0.95 { 0.28 } else { 0.10 * (1.35 - away) };
        (roll < chance && away > 0.08).then(|| {
            Thing::Building(Building {
                foot: self.foot(offer),
                half: [mix(0.4, 1.3, size), mix(0.4, 1.3, shape)],
                height: mix(0.6, 2.2, tone),
                roof: if shape < 0.5 { Roof::Flat } else { Roof::Gable },
                walls: if tone < 0.5 { Stuff::Wood } else { Stuff::Cloth },
                tone: size - 0.5,
                seed: offer.seed,
            })
        })
    }

    /// The wall of the town, its keep, the ribs of something large, and natural arches.
    fn landmarks(&self) -> Vec<Thing> {
        let ([x, z], radius) = DESERT.town;
        let floor = self.height(x, z);
        let wall = RingWall {
            centre: Vec3::new(x, floor, z),
            radius: radius - 4.0,
            height: 8.5,
            thick: 3.0,
            seed: self.seed,
        };
        let keep = Building {
            foot: Vec3::new(x, floor - 0.2, z),
            half: [6.5, 6.5],
            height: 26.0,
            roof: Roof::Dome,
            walls: Stuff::Stone,
            tone: 0.2,
            seed: self.seed ^ 77,
        };
        let mut things = vec![Thing::RingWall(wall), Thing::Building(keep)];
        for index in 0..9u32 {
            things.extend(self.rib(index));
        }
        for index in 0..5u32 {
            let [u, v, size, turn] = random([index, self.seed, 0xA4C4, 0]);
            let (x, z) = (mix(330.0, 450.0, u), mix(315.0, 430.0, v));
            let (a, b) = (2.0 * turn - 1.0, 2.0 * size - 1.0);
            let length = (a * a + b * b).sqrt().max(0.1);
            things.push(Thing::Arch(Arch {
                centre: Vec3::new(x, self.height(x, z) - 1.0, z),
                along: [a / length, b / length],
                radius: mix(7.0, 13.0, size),
                rise: mix(0.9, 1.4, turn),
                thick: 3.4,
                stuff: Stuff::RedRock,
                seed: self.seed ^ index,
            }));
        }
        things
    }

    /// A rib of the ruin west of the town, and the piece of spine to the next.
    fn rib(&self, index: u32) -> [Thing; 2] {
        let [wear, ..] = random([index, self.seed, 0x41B, 0]);
        let at = |i: f32| [mix(34.0, 122.0, i / 8.0), mix(352.0, 292.0, i / 8.0)];
        let [x, z] = at(index as f32);
        let [nx, nz] = at(index as f32 + 1.0);
        let radius = 17.0 - 0.35 * (index as f32 - 4.0) * (index as f32 - 4.0);
        let floor = self.height(34.0, 352.0).min(self.height(122.0, 292.0)) - 1.0;
        let rib = Arch {
            centre: Vec3::new(x, floor, z),
            along: [0.563, 0.826],
            radius,
            rise: mix(1.25, 1.45, wear),
            thick: 1.5,
            stuff: Stuff::Rust,
            seed: self.seed ^ index,
        };
        let crest = floor + 1.33 * radius;
        let spine = Beam {
            from: Vec3::new(x, crest, z),
            to: Vec3::new(nx, crest - 1.5 * (wear - 0.5), nz),
            sag: 0.0,
            thick: 1.2,
            stuff: Stuff::Rust,
            seed: self.seed ^ (index + 100),
        };
        [Thing::Arch(rib), Thing::Beam(spine)]
    }
}

impl Landscape for Desert {
    fn height(&self, x: f32, z: f32) -> f32 {
        let recipe = &DESERT;
        let town = 1.0 - step(0.95, 1.5, distance([x, z], recipe.town.0) / recipe.town.1);
        let mountain = self.within(recipe.mountain, x, z);
        let [open, rough] = recipe.roughness;
        let mut height = recipe.base + 7.0 * self.land.fbm(x, z, 190.0, 4) * (1.0 - 0.9 * town);
        let inside = self.plateau(x, z);
        height += recipe.plateau_height * (0.55 * step(-3.0, 2.5, inside) + 0.45 * step(7.0, 13.0, inside));
        height -= recipe.town_depth * town;
        let away = distance([x, z], recipe.mountain.0) / recipe.mountain.1;
        let dome = (1.1 - away).clamp(0.0, 1.0);
        let crags = self.land.ridged(x, z, 85.0, 6);
        height += recipe.mountain_height * dome * mix(0.45, 1.0, crags) * step(0.0, 0.3, dome);
        height += mix(open, rough, mountain) * self.detail.fbm(x, z, 5.0, 3) * (1.0 - 0.8 * town);
        // Ledges in the land of rocks.
        let ledges = self.within(recipe.rocks, x, z);
        height + 7.0 * ledges * step(0.05, 0.13, self.land.fbm(x, z, 48.0, 4))
    }

    fn cover(&self, spot: &Spot) -> Cover {
        let (x, z) = (spot.x, spot.z);
        let grain = self.grain(x, z) * (1.5 * self.detail.at(x, z, 2.0) + 0.5 * (spot.roll - 0.5));
        let broad = 0.3 * self.land.fbm(x, z, 45.0, 3);
        let mountain = self.within(DESERT.mountain, x, z);
        if spot.slope + 0.25 * spot.roll + 0.4 * mountain > 1.15 {
            return Cover::bare(Stuff::RedRock, broad + grain);
        }
        let patch = self.detail.fbm(x, z, 9.0, 3) + 0.5 * (spot.roll - 0.5);
        if mountain > 0.3 && patch > 0.05 {
            return Cover::bare(if patch > 0.25 { Stuff::Rock } else { Stuff::Earth }, broad + grain);
        }
        let grove = self.within(DESERT.grove, x, z);
        if grove + 0.6 * patch > 0.55 {
            return Cover {
                stuff: Stuff::Litter,
                tone: grain,
                tuft: (spot.roll < 0.12).then_some((Stuff::Moss, 0.5)),
            };
        }
        if distance([x, z], DESERT.town.0) < 0.96 * DESERT.town.1 {
            return Cover::bare(Stuff::Road, 0.5 * broad + grain);
        }
        let rocks = self.within(DESERT.rocks, x, z);
        let bare = 0.5 * step(-6.0, 6.0, self.plateau(x, z));
        if patch > 0.38 - 0.3 * rocks + bare {
            let tuft = (spot.roll < 0.05).then_some((Stuff::DryGrass, 0.5));
            return Cover { stuff: Stuff::Earth, tone: 0.5 + broad + grain, tuft };
        }
        Cover::bare(Stuff::Sand, 0.1 + broad + grain)
    }

    fn things(&self) -> Vec<Thing> {
        let mut things = self.landmarks();
        things.extend(scatter(12.5, self.seed, 1, |offer| self.house(offer)));
        things.extend(scatter(3.0, self.seed, 2, |offer| self.clutter(offer)));
        things.extend(scatter(4.0, self.seed, 3, |offer| self.tree(offer)));
        things.extend(scatter(7.0, self.seed, 4, |offer| self.rock(offer)));
        things.extend(scatter(3.0, self.seed, 5, |offer| self.bush(offer)));
        things
    }

    fn thickness(&self) -> f32 {
        DESERT.thickness
    }

    fn contrast(&self) -> f32 {
        DESERT.contrast
    }
}
