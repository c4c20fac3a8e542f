//! Rocks: bodies between planes, of which only the skin is there; and arches.

use glam::Vec3;

use super::field::{hash, random};
use super::stuff::Stuff;
use super::tile::Tile;

/// Planes that cut a rock.
const PLANES: u32 = 11;

/// A rock; metres.
pub(super) struct Rock {
    pub(super) centre: Vec3,
    /// Half its lengths along the axes.
    pub(super) half: Vec3,
    pub(super) stuff: Stuff,
    pub(super) tone: f32,
    /// How different its faces, layers and grains are.
    pub(super) mottle: f32,
    /// Share of what faces up that is under snow.
    pub(super) snow: f32,
    pub(super) seed: u32,
}

impl Rock {
    pub(super) fn bounds(&self) -> [Vec3; 2] {
        [self.centre - self.half * 1.1, self.centre + self.half * 1.1]
    }

    /// Normals and distances, in a space where the rock is round.
    fn planes(&self) -> Vec<(Vec3, f32)> {
        let plane = |index: u32| {
            let [u, v, w, s] = random([index, self.seed, 0x40CC, 0]);
            let normal = Vec3::new(2.0 * u - 1.0, 2.0 * v - 1.0, 2.0 * w - 1.0);
            (normal / normal.length().max(0.1), 0.48 + 0.34 * s)
        };
        (0..PLANES).map(plane).collect()
    }

    pub(super) fn draw(&self, tile: &mut Tile) {
        let planes = self.planes();
        let least = self.half.min_element();
        let skin = (1.7 * tile.voxel / least).min(0.9);
        let voxel = tile.voxel;
        tile.paint(self.bounds(), |cell, p| {
            let q = (p - self.centre) / self.half;
            // The plane that the point is nearest to leaving by: 1 on it.
            let mut face = (0.0, 0);
            for (index, (normal, away)) in planes.iter().enumerate() {
                let out = normal.dot(q) / away;
                if out > face.0 {
                    face = (out, index);
                }
            }
            let out = face.0.max(0.9 * q.length());
            if out > 1.0 || out < 1.0 - skin {
                return None;
            }
            Some(self.shade(cell, planes.get(face.1).map_or(0.0, |(normal, _)| normal.y), face.1, voxel))
        });
    }

    fn shade(&self, cell: [i32; 3], up: f32, face: usize, voxel: f32) -> u8 {
        let coarse = |length: f32| cell.map(|c| (c as f32 * voxel / length) as i32);
        let grain = hash(coarse(0.8), self.seed) - 0.5;
        if up > 0.25 && hash(coarse(0.6), self.seed ^ 9) < self.snow {
            return Stuff::Snow.shade(0.8 * grain + 0.3 * (hash(cell, self.seed) - 0.5));
        }
        let [_, layer, _] = coarse(0.7);
        let layer = hash([0, layer, 0], self.seed ^ 5) - 0.5;
        let facet = hash([face as i32, 0, 0], self.seed ^ 3) - 0.5;
        let fine = hash(cell, self.seed ^ 8) - 0.5;
        self.stuff
            .shade(self.tone + self.mottle * (facet + 0.6 * layer + 0.8 * grain + 0.5 * fine + 0.3 * up))
    }
}

/// Half a ring that stands on the ground: a natural arch, or a rib of something large.
pub(super) struct Arch {
    /// The middle between its feet.
    pub(super) centre: Vec3,
    /// A unit vector of the plane, from foot to foot.
    pub(super) along: [f32; 2],
    /// Half the distance of its feet.
    pub(super) radius: f32,
    /// Its height as a multiple of that.
    pub(super) rise: f32,
    /// Half its thickness at the feet.
    pub(super) thick: f32,
    pub(super) stuff: Stuff,
    pub(super) seed: u32,
}

impl Arch {
    pub(super) fn bounds(&self) -> [Vec3; 2] {
        let wide = self.radius + self.thick;
        let reach = |c: f32| c.abs() * wide + self.thick;
        let low = Vec3::new(reach(self.along[0]), 6.0, reach(self.along[1]));
        let high = Vec3::new(low.x, (self.radius + self.thick) * self.rise, low.z);
        [self.centre - low, self.centre + high]
    }

    pub(super) fn draw(&self, tile: &mut Tile) {
        let voxel = tile.voxel;
        tile.paint(self.bounds(), |cell, p| {
            let q = p - self.centre;
            let u = q.x * self.along[0] + q.z * self.along[1];
            let w = q.z * self.along[0] - q.x * self.along[1];
            let v = q.y.max(0.0) / self.rise;
            let r = (u * u + v * v).sqrt() - self.radius;
            // Thinner toward the top, and uneven.
            let block = cell.map(|c| (c as f32 * voxel / 1.1) as i32);
            let uneven = 0.85 + 0.3 * hash(block, self.seed);
            let thick = (self.thick * (1.0 - 0.45 * v / self.radius) * uneven).max(0.6 * voxel);
            let out = (r * r + w * w).sqrt() / thick;
            let inner = 1.0 - 1.7 * voxel / thick;
            let tone = hash(block, self.seed ^ 2) + 0.5 * hash(cell, self.seed) - 0.75;
            (out <= 1.0 && out > inner).then(|| self.stuff.shade(tone))
        });
    }
}
