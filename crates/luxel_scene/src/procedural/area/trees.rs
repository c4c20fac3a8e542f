//! Trees and bushes: stems, and crowns of leaves with gaps between them.

use glam::Vec3;

use super::field::{hash, mix, random, step};
use super::stuff::Stuff;
use super::tile::Tile;

/// Kinds of crowns.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(super) enum Crown {
    /// Tiers of hanging branches that narrow to a tip.
    Conifer,
    /// A heap of round tufts of leaves.
    Round,
    /// Flat tufts on a bare stem, as an acacia's.
    Umbrella,
    /// Bare branches.
    Dead,
    /// A tuft on the ground.
    Bush,
}

/// A tree; metres.
pub(super) struct Tree {
    pub(super) crown: Crown,
    /// Where the stem leaves the ground.
    pub(super) foot: Vec3,
    pub(super) height: f32,
    /// Of the crown.
    pub(super) radius: f32,
    pub(super) leaves: Stuff,
    /// Of all its leaves, from −1 to 1.
    pub(super) tone: f32,
    /// How different leaves are.
    pub(super) mottle: f32,
    /// Share of cells of the crown that hold leaves.
    pub(super) density: f32,
    /// Share of what faces up that is under snow.
    pub(super) snow: f32,
    pub(super) seed: u32,
}

impl Tree {
    pub(super) fn bounds(&self) -> [Vec3; 2] {
        let aside = Vec3::new(self.radius * 1.3, 0.0, self.radius * 1.3);
        [self.foot - aside - Vec3::Y, self.foot + aside + Vec3::Y * (self.height + 1.0)]
    }

    pub(super) fn draw(&self, tile: &mut Tile) {
        match self.crown {
            Crown::Conifer => self.draw_conifer(tile),
            Crown::Round => self.draw_tufts(tile, &self.tufts(7, 0.55, [0.48, 0.30])),
            Crown::Umbrella => self.draw_tufts(tile, &self.tufts(5, 0.82, [0.55, 0.13])),
            Crown::Dead => self.draw_dead(tile),
            Crown::Bush => self.draw_tufts(tile, &self.tufts(3, 0.45, [0.7, 0.55])),
        }
    }

    fn is_stem(&self, p: Vec3, voxel: f32, to: f32) -> bool {
        let t = (p.y - self.foot.y) / self.height;
        let radius = mix(0.018 * self.height + 0.06, 0.05, t.max(0.0)).max(0.5 * voxel);
        let (x, z) = (p.x - self.foot.x, p.z - self.foot.z);
        t < to && x.abs() <= radius && z.abs() <= radius && x * x + z * z <= 1.5 * radius * radius
    }

    /// A leaf or a gap. `edge` is 0 inside the crown and 1 at its border; `open` says that the sky is above.
    fn leaf(&self, cell: [i32; 3], edge: f32, open: bool) -> Option<u8> {
        let roll = hash(cell, self.seed);
        if roll >= self.density {
            return None;
        }
        let mottle = hash(cell, self.seed ^ 0x51AB);
        if mottle < if open { self.snow } else { 0.5 * self.snow } {
            return Some(Stuff::Snow.shade(0.9 * hash(cell, self.seed ^ 0x77) - 0.3));
        }
        let light = if open { 0.35 } else { -0.35 };
        Some(self.leaves.shade(self.tone + self.mottle * (1.4 * mottle - 0.7 + light + 0.3 * edge)))
    }

    fn draw_conifer(&self, tile: &mut Tile) {
        let voxel = tile.voxel;
        let tiers = (self.height / 1.5).max(3.0);
        let skirt = 0.10 + 0.08 * hash([1, 2, 3], self.seed);
        // How far branches reach at a height, in a direction of eight.
        let reach = |p: Vec3| {
            let t = (p.y - self.foot.y) / self.height;
            if t < skirt || t > 1.0 {
                return 0.0;
            }
            let (x, z) = (p.x - self.foot.x, p.z - self.foot.z);
            let sector = i32::from(x > 0.0) + 2 * i32::from(z > 0.0) + 4 * i32::from(x.abs() > z.abs());
            let level = t * tiers;
            let tier = level as i32;
            let droop = 1.0 - 0.55 * (level - tier as f32);
            self.radius * (1.05 - t) * droop * (0.75 + 0.5 * hash([sector, tier, 7], self.seed))
        };
        tile.paint(self.bounds(), |cell, p| {
            if self.is_stem(p, voxel, 0.9) {
                return Some(Stuff::Bark.shade(hash(cell, self.seed) - 0.5));
            }
            let (x, z) = (p.x - self.foot.x, p.z - self.foot.z);
            let (r, own) = ((x * x + z * z).sqrt(), reach(p));
            if r > own.max(0.4 * voxel) || r < 0.45 * own || own <= 0.0 {
                return None;
            }
            let above = reach(p + Vec3::Y * (0.6_f32.max(voxel)));
            self.leaf(cell, r / own, r > above)
        });
    }

    /// Centres and half axes of the tufts of a crown, spread round its middle at `middle` of the height.
    fn tufts(&self, count: u32, middle: f32, [wide, high]: [f32; 2]) -> Vec<[Vec3; 2]> {
        let centre = self.foot + Vec3::Y * (middle * self.height);
        let half = Vec3::new(self.radius * wide, (self.height * high * 0.75).max(0.3), self.radius * wide);
        let mut tufts = vec![[centre + Vec3::Y * (0.15 * half.y), half * 1.15]];
        for index in 1..count {
            let [u, v, w, s] = random([index, self.seed, 0x7F75, 0]);
            let aside = Vec3::new(2.0 * u - 1.0, 1.2 * v - 0.6, 2.0 * w - 1.0);
            let away = Vec3::new(self.radius * (1.0 - wide), half.y, self.radius * (1.0 - wide));
            tufts.push([centre + aside * away, half * (0.65 + 0.4 * s)]);
        }
        tufts
    }

    fn draw_tufts(&self, tile: &mut Tile, tufts: &[[Vec3; 2]]) {
        let voxel = tile.voxel;
        let depth = |p: Vec3| {
            let inside = |[centre, half]: &[Vec3; 2]| {
                let half = half.max(Vec3::splat(0.5 * voxel));
                1.0 - ((p - *centre) / half).length_squared()
            };
            tufts.iter().map(inside).fold(-1.0, f32::max)
        };
        tile.paint(self.bounds(), |cell, p| {
            let own = depth(p);
            let middle = tufts.first().map_or(0.0, |[centre, _]| (centre.y - self.foot.y) / self.height);
            if own < 0.55 && self.crown != Crown::Bush && self.is_stem(p, voxel, middle) {
                return Some(Stuff::Bark.shade(hash(cell, self.seed) - 0.4));
            }
            // Leaves grow at the border, the middle is bare.
            if !(0.0..0.6).contains(&own) {
                return None;
            }
            self.leaf(cell, 1.0 - own, depth(p + Vec3::Y * (0.5_f32.max(voxel))) < 0.0)
        });
    }

    fn draw_dead(&self, tile: &mut Tile) {
        let voxel = tile.voxel;
        let branches: Vec<[Vec3; 2]> = (0..9)
            .map(|index| {
                let [u, v, w, s] = random([index, self.seed, 0xDEAD, 1]);
                let from = self.foot + Vec3::Y * (self.height * mix(0.35, 0.95, u));
                let way = Vec3::new(2.0 * v - 1.0, 0.4 + 0.5 * s, 2.0 * w - 1.0);
                [from, way * (self.radius * mix(0.9, 0.5, u))]
            })
            .collect();
        let thick = 0.13_f32.max(0.6 * voxel);
        tile.paint(self.bounds(), |cell, p| {
            let is_branch = |[from, way]: &[Vec3; 2]| {
                let t = ((p - *from).dot(*way) / way.length_squared()).clamp(0.0, 1.0);
                (p - *from - *way * t).length() < thick * (1.2 - 0.6 * t)
            };
            let filled = self.is_stem(p, voxel, 1.0) || branches.iter().any(is_branch);
            let snow = step(0.0, 1.0, self.snow) > hash(cell, self.seed);
            let stuff = if snow { Stuff::Snow } else { Stuff::Bark };
            filled.then(|| stuff.shade(hash(cell, self.seed ^ 1) - 0.2))
        });
    }
}
