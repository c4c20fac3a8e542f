//! A small ray marcher through voxels, for looking at areas: cubes of a metre, and voxels in them.

use glam::{IVec3, Vec3};
use luxel_scene::{AREA_EXTENT, Surface, VoxelGrid};

/// Metres, and cubes, along an edge.
const EDGE: i32 = AREA_EXTENT as i32;

/// Cubes of a metre with something in them.
pub(crate) struct Bricks {
    /// 0, or one more than the brick's place in `cells`.
    index: Vec<u32>,
    /// Voxels along a brick's edge.
    side: i32,
    /// Palette entry plus one of each voxel; x fastest, then y, then z.
    cells: Vec<Vec<u8>>,
    means: Vec<Vec3>,
    palette: Vec<Vec3>,
}

impl Bricks {
    pub(crate) fn new(grid: &VoxelGrid) -> Self {
        let side = grid.size.x as i32 / EDGE;
        assert!(side >= 1, "a metre holds at least a voxel");
        let palette: Vec<Vec3> = grid
            .palette
            .iter()
            .map(|material| match material.surface {
                Surface::Lambert { albedo } => albedo,
                _ => Vec3::ZERO,
            })
            .collect();
        let mut bricks = Self {
            index: vec![0; (EDGE * EDGE * EDGE) as usize],
            side,
            cells: Vec::new(),
            means: Vec::new(),
            palette,
        };
        for voxel in &grid.voxels {
            let cell = IVec3::from(voxel.cell.map(i32::from));
            let index = bricks.brick(cell / side);
            let local = cell % side;
            bricks.cells[index][(local.x + side * (local.y + side * local.z)) as usize] = voxel.palette + 1;
        }
        bricks.means = bricks.cells.iter().map(|cells| bricks.mean(cells)).collect();
        bricks
    }

    fn brick(&mut self, at: IVec3) -> usize {
        let place = (at.x + EDGE * (at.y + EDGE * at.z)) as usize;
        if self.index[place] == 0 {
            self.cells.push(vec![0; (self.side * self.side * self.side) as usize]);
            self.index[place] = self.cells.len() as u32;
        }
        self.index[place] as usize - 1
    }

    fn mean(&self, cells: &[u8]) -> Vec3 {
        let filled: Vec<u8> = cells.iter().copied().filter(|content| *content > 0).collect();
        filled.iter().map(|content| self.palette[usize::from(*content) - 1]).sum::<Vec3>()
            / filled.len() as f32
    }

    /// Of the highest brick of each column, metres.
    pub(crate) fn mean_height(&self) -> f32 {
        let top = |x: i32, z: i32| {
            (0..EDGE).rev().find(|y| self.index[(x + EDGE * (y + EDGE * z)) as usize] > 0).unwrap_or(0)
        };
        let sum: i64 =
            (0..EDGE).flat_map(|z| (0..EDGE).map(move |x| (x, z))).map(|(x, z)| i64::from(top(x, z))).sum();
        sum as f32 / (EDGE * EDGE) as f32
    }

    /// The mean albedo of the first brick that a ray meets; metres.
    pub(crate) fn node(&self, origin: Vec3, direction: Vec3) -> Option<Vec3> {
        walk(origin, direction, IVec3::splat(EDGE), |at, _, _| {
            let index = self.index[(at.x + EDGE * (at.y + EDGE * at.z)) as usize];
            (index > 0).then(|| self.means[index as usize - 1])
        })
    }

    /// The albedo of the first voxel that a ray meets, its place and its side's normal.
    pub(crate) fn voxel(&self, origin: Vec3, direction: Vec3) -> Option<(Vec3, Vec3, Vec3)> {
        let side = self.side as f32;
        walk(origin, direction, IVec3::splat(EDGE), |at, t, normal| {
            let index = self.index[(at.x + EDGE * (at.y + EDGE * at.z)) as usize];
            if index == 0 {
                return None;
            }
            let cells = &self.cells[index as usize - 1];
            let local = (origin + direction * t - at.as_vec3()) * side;
            let start = local.clamp(Vec3::splat(1e-3), Vec3::splat(side - 1e-3));
            walk(start, direction, IVec3::splat(self.side), |c, s, own| {
                let content = cells[(c.x + self.side * (c.y + self.side * c.z)) as usize];
                let normal = if s > 0.0 { own } else { normal };
                (content > 0).then(|| {
                    let place = at.as_vec3() + (start + direction * s) / side;
                    (self.palette[usize::from(content) - 1], place, normal)
                })
            })
        })
    }
}

/// Visits cells along a ray with its distance and the normal of the side that it enters by, until `visit` has something.
fn walk<T>(
    origin: Vec3,
    direction: Vec3,
    size: IVec3,
    mut visit: impl FnMut(IVec3, f32, Vec3) -> Option<T>,
) -> Option<T> {
    let direction = Vec3::select(direction.abs().cmplt(Vec3::splat(1e-7)), Vec3::splat(1e-7), direction);
    let inverse = direction.recip();
    let (a, b) = (-origin * inverse, (size.as_vec3() - origin) * inverse);
    let enter = a.min(b).max_element().max(0.0);
    if enter >= a.max(b).min_element() {
        return None;
    }
    let mut cell = (origin + direction * (enter + 1e-4)).floor().as_ivec3().clamp(IVec3::ZERO, size - 1);
    let step = direction.signum().as_ivec3();
    let mut next = (cell.as_vec3() + step.max(IVec3::ZERO).as_vec3() - origin) * inverse;
    let (mut t, mut normal) = (enter, Vec3::ZERO);
    let side = a.min(b).max_position();
    normal[side] = -step[side] as f32;
    loop {
        if let Some(found) = visit(cell, t, normal) {
            return Some(found);
        }
        let axis = if next.x < next.y && next.x < next.z {
            0
        } else if next.y < next.z {
            1
        } else {
            2
        };
        t = next[axis];
        cell[axis] += step[axis];
        if cell[axis] < 0 || cell[axis] >= size[axis] {
            return None;
        }
        normal = Vec3::ZERO;
        normal[axis] = -step[axis] as f32;
        next[axis] += inverse[axis].abs();
    }
}

/// A pinhole camera.
pub(crate) struct View {
    pub(crate) eye: Vec3,
    pub(crate) forward: Vec3,
    pub(crate) right: Vec3,
    pub(crate) up: Vec3,
}

impl View {
    /// The document's: above the middle, 288 m above the ground, 90°.
    pub(crate) fn down(ground: f32) -> Self {
        let middle = 0.5 * AREA_EXTENT;
        Self {
            eye: Vec3::new(middle, ground + 288.0, middle),
            forward: -Vec3::Y,
            right: Vec3::X,
            up: -Vec3::Z,
        }
    }

    /// From `eye` to `target`.
    pub(crate) fn toward(eye: Vec3, target: Vec3, half: f32) -> Self {
        let forward = (target - eye).normalize();
        let side = forward.cross(Vec3::Y).normalize();
        Self { eye, forward, right: side * half, up: side.cross(forward) * half }
    }

    /// What `ray` says of each pixel's middle, in rows from above.
    pub(crate) fn picture<T>(
        &self,
        width: usize,
        height: usize,
        mut ray: impl FnMut(Vec3, Vec3) -> T,
    ) -> Vec<T> {
        let scale = 2.0 / height as f32;
        let pixels = (0..height).flat_map(|y| (0..width).map(move |x| (x, y)));
        pixels
            .map(|(x, y)| {
                let u = (x as f32 + 0.5 - 0.5 * width as f32) * scale;
                let v = 1.0 - (y as f32 + 0.5) * scale;
                ray(self.eye, self.forward + self.right * u + self.up * v)
            })
            .collect()
    }
}
