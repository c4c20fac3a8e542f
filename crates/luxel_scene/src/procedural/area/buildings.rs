//! Houses, towers and walls round a town.

use glam::Vec3;

use super::field::hash;
use super::stuff::Stuff;
use super::tile::Tile;

/// What closes a building above.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(super) enum Roof {
    /// A terrace with a parapet, and things on it.
    Flat,
    /// Two slopes.
    Gable,
    /// Half a ball.
    Dome,
}

/// A building with walls along x and z; metres.
pub(super) struct Building {
    /// The middle of its floor.
    pub(super) foot: Vec3,
    /// Half its lengths along x and z.
    pub(super) half: [f32; 2],
    /// Of its walls.
    pub(super) height: f32,
    pub(super) roof: Roof,
    pub(super) walls: Stuff,
    pub(super) tone: f32,
    pub(super) seed: u32,
}

/// Below the floor, for slopes.
const FOUNDATION: f32 = 4.0;
/// Of a storey.
const STOREY: f32 = 3.2;
/// From window to window.
const BAY: f32 = 2.4;

impl Building {
    pub(super) fn bounds(&self) -> [Vec3; 2] {
        let low = Vec3::new(self.half[0] + 1.5, FOUNDATION, self.half[1] + 1.5);
        let over = self.half[0].min(self.half[1]) + 3.0;
        [self.foot - low, self.foot + Vec3::new(low.x, self.height + over, low.z)]
    }

    pub(super) fn draw(&self, tile: &mut Tile) {
        let voxel = tile.voxel;
        tile.paint(self.bounds(), |cell, p| {
            let q = p - self.foot;
            // How far inside the walls.
            let inset = (self.half[0] - q.x.abs()).min(self.half[1] - q.z.abs());
            let fine = hash(cell, self.seed) - 0.5;
            if q.y >= self.height {
                return self.roof_cell(cell, q, inset, voxel, fine);
            }
            if inset < 0.0 {
                return self.awning(q, inset).then(|| self.cloth().shade(fine));
            }
            if inset > 1.5 * voxel {
                return None;
            }
            let face = if self.half[0] - q.x.abs() < self.half[1] - q.z.abs() { q.z } else { q.x };
            if self.is_window(q.y, face) {
                return Some(Stuff::Window.shade(fine));
            }
            // Stone courses at the foot and under the roof.
            let course = q.y < 0.7 || self.height - q.y < 0.4;
            let (stuff, tone) = if course { (Stuff::Stone, -0.3) } else { (self.walls, self.tone) };
            Some(stuff.shade(tone + 0.7 * fine + 0.5 * (hash(cell.map(|c| c / 6), self.seed) - 0.5)))
        });
    }

    fn is_window(&self, height: f32, face: f32) -> bool {
        let part = |x: f32, length: f32| {
            let parts = (x + 64.0 * length) / length;
            (parts - parts.floor()) * length
        };
        let is_door = face.abs() < 0.7 && height > 0.0 && height < 2.3;
        let (up, along) = (part(height, STOREY), part(face + 0.5 * BAY, BAY));
        is_door || (height > 0.8 && (1.1..2.3).contains(&up) && (0.75..1.65).contains(&along))
    }

    fn cloth(&self) -> Stuff {
        if hash([4, 5, 6], self.seed) < 0.6 { Stuff::Cloth } else { Stuff::Teal }
    }

    /// A cloth along one side, as broad as a metre, that falls outwards.
    fn awning(&self, q: Vec3, inset: f32) -> bool {
        let side = hash([7, 7, 7], self.seed) < 0.5;
        let out = -inset;
        let beside = if side { q.x > self.half[0] } else { q.z > self.half[1] };
        let wide = if side { q.z.abs() < 0.7 * self.half[1] } else { q.x.abs() < 0.7 * self.half[0] };
        beside && wide && out < 1.3 && (q.y + 0.5 * out - 2.7).abs() < 0.14 && self.height > 3.0
    }

    fn roof_cell(&self, cell: [i32; 3], q: Vec3, inset: f32, voxel: f32, fine: f32) -> Option<u8> {
        let up = q.y - self.height;
        let thin = 1.1 * voxel;
        match self.roof {
            Roof::Flat if inset < 0.0 => None,
            Roof::Flat => {
                let parapet = inset < 0.4 && up < 0.8;
                if parapet || up < thin {
                    return Some(Stuff::Stone.shade(self.tone + if parapet { 0.4 } else { -0.2 } + fine));
                }
                self.on_the_roof(cell, q, up, voxel)
            }
            Roof::Gable => {
                let (across, half) = if self.half[0] < self.half[1] {
                    (q.x.abs(), self.half[0])
                } else {
                    (q.z.abs(), self.half[1])
                };
                let under = 0.7 * (half - across);
                let on = (up - under).abs() < 0.8 * voxel && inset > -0.6;
                let gable = inset >= 0.0 && inset < thin && up < under;
                let row = hash([0, cell[1], 0], self.seed) - 0.5;
                let tiles = || Stuff::Tile.shade(self.tone + 0.8 * fine + 0.5 * row);
                if on { Some(tiles()) } else { gable.then(|| self.walls.shade(self.tone + fine)) }
            }
            Roof::Dome => {
                if inset >= 0.0 && up < thin {
                    return Some(Stuff::Stone.shade(fine));
                }
                let radius = 0.85 * self.half[0].min(self.half[1]);
                let out = q.with_y(up).length();
                (out <= radius && out > radius - 1.5 * voxel).then(|| Stuff::Teal.shade(0.3 + fine))
            }
        }
    }

    /// Boxes, cloths and jars on a terrace.
    fn on_the_roof(&self, cell: [i32; 3], q: Vec3, up: f32, voxel: f32) -> Option<u8> {
        let block = [q.x, q.z].map(|c| ((c + 64.0) / 1.5) as i32);
        let roll = hash([block[0], 1, block[1]], self.seed);
        let (stuff, high) = match roll {
            r if r < 0.10 => (self.cloth(), 2.0),
            r if r < 0.22 => (Stuff::Wood, 0.9),
            r if r < 0.28 => (Stuff::Plaster, 1.6),
            _ => return None,
        };
        let is_cloth = roll < 0.10;
        let filled = if is_cloth { (up - high).abs() < 0.6 * voxel } else { up < high };
        filled.then(|| stuff.shade(self.tone + hash(cell, self.seed) - 0.5))
    }
}

/// A wall round a town, with battlements and four gates; metres.
pub(super) struct RingWall {
    /// The middle of the ring, at the foot of the wall.
    pub(super) centre: Vec3,
    pub(super) radius: f32,
    pub(super) height: f32,
    pub(super) thick: f32,
    pub(super) seed: u32,
}

impl RingWall {
    pub(super) fn bounds(&self) -> [Vec3; 2] {
        let wide = self.radius + self.thick;
        [self.centre - Vec3::new(wide, 8.0, wide), self.centre + Vec3::new(wide, self.height + 1.0, wide)]
    }

    pub(super) fn draw(&self, tile: &mut Tile) {
        let voxel = tile.voxel;
        tile.paint(self.bounds(), |cell, p| {
            let q = p - self.centre;
            let across = (q.x * q.x + q.z * q.z).sqrt() - self.radius;
            let gate = q.x.abs().min(q.z.abs()) < 2.5 && q.y < 0.7 * self.height;
            if across.abs() > 0.5 * self.thick || gate || q.y > self.height {
                return None;
            }
            let inner = across.abs() < 0.5 * self.thick - 1.6 * voxel;
            // The walk on top lies a metre lower than the battlements at its borders.
            let tooth = ((q.x + q.z + 1000.0) as i32) % 2 == 0;
            let top = self.height - if inner || tooth { 1.0 } else { 0.0 };
            let filled = q.y <= top && (!inner || q.y > top - 1.2 * voxel);
            let stones = hash(cell.map(|c| c / 3), self.seed) + 0.6 * hash(cell, self.seed) - 0.8;
            filled.then(|| Stuff::Stone.shade(0.9 * stones))
        });
    }
}
