//! An area, looked at from above (seed document 3, §5.1.1).
use std::ops::ControlFlow;

use glam::{UVec3, Vec3};
use luxel_accel::{Svo, SvoVoxel, build_svo};
use luxel_lod::{Contrast, Octree, Sun, View, lit_by};
use luxel_scene::{AREA_EXTENT, Area, AreaKind, Material, VoxelGrid, cache_folder};

use super::viewpoint::Viewpoint;
use crate::StudyError;

/// How far above the mean ground the camera stands, in metres: high enough for about a fifth of the picture to look beyond
/// the area, as the document's pictures do.
const ABOVE_GROUND: f32 = 288.0;
/// Pixels along an edge of a picture whose pixels are as large as nodes two levels above the leaves.
pub(super) const FULL_SIZE: u32 = 512;
/// Voxels along an edge of the areas at which that holds.
const FULL_VOXELS: u32 = 2048;

/// How voxels are lit.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Lighting {
    /// Not at all: they show their colour.
    Albedo,
    /// By the sun at one of four times of day.
    Time(usize),
}

/// Voxels along an edge from which on areas are kept on disk.
const KEPT_VOXELS: u32 = 512;

/// Where the sun stands at the four times of day, and its light: morning, forenoon low in the south, noon, evening.
const SUNS: [(Vec3, Vec3); 4] = [
    (Vec3::new(0.80, 0.42, 0.25), Vec3::new(0.95, 0.80, 0.62)),
    (Vec3::new(0.35, 0.30, 0.85), Vec3::new(0.90, 0.68, 0.48)),
    (Vec3::new(0.20, 0.95, 0.22), Vec3::new(1.00, 0.97, 0.92)),
    (Vec3::new(-0.72, 0.36, -0.35), Vec3::new(0.98, 0.72, 0.45)),
];

impl Lighting {
    /// All five, albedo first.
    pub(super) const ALL: [Self; 5] =
        [Self::Albedo, Self::Time(0), Self::Time(1), Self::Time(2), Self::Time(3)];

    /// As records have it.
    pub(super) fn name(self) -> &'static str {
        match self {
            Self::Albedo => "albedo",
            Self::Time(n) => ["time 0", "time 1", "time 2", "time 3"][n.min(3)],
        }
    }
}

/// An area as an octree.
pub(super) struct Land {
    pub(super) svo: Svo,
    pub(super) voxels: u64,
    /// The view from above.
    above: View,
    /// Height of the mean ground, in voxels.
    ground: f32,
    size: u32,
}

/// An area under one lighting.
pub(super) struct LitLand<'a> {
    land: &'a Land,
    /// `None` for the colours that the octree has.
    colors: Option<Vec<u32>>,
    pub(super) contrast: Contrast,
}

impl Land {
    /// Makes an area or takes it from the cache; `None` if `progress`, which is told the share that is done, broke off.
    pub(super) fn load(
        kind: AreaKind,
        size: u32,
        progress: &mut dyn FnMut(f64) -> ControlFlow<()>,
    ) -> Result<Option<Self>, StudyError> {
        let area = Area { kind, size, seed: 1 };
        let mut told = |done: u32, all: u32| progress(f64::from(done) / f64::from(all.max(1)));
        let folder = cache_folder().filter(|_| size >= KEPT_VOXELS);
        let grid = match folder {
            Some(folder) => area.cached(&folder, &mut told),
            None => area.generate(&mut told),
        };
        let Ok(grid) = grid else {
            return Ok(None);
        };
        let colors: Vec<[u8; 3]> = grid.palette.iter().map(Material::display_color).collect();
        let voxel = |voxel: &luxel_scene::Voxel| SvoVoxel {
            cell: voxel.cell,
            color: colors[usize::from(voxel.palette)],
            material: voxel.palette,
        };
        let voxels: Vec<SvoVoxel> = grid.voxels.iter().map(voxel).collect();
        let svo = build_svo(&voxels, UVec3::splat(size))?;
        let middle = 0.5 * size as f32;
        let ground = mean_height(&grid);
        let eye = Vec3::new(middle, ground + ABOVE_GROUND / AREA_EXTENT * size as f32, middle);
        let above = View::down(eye, FULL_SIZE * size / FULL_VOXELS);
        Ok(Some(Self { svo, voxels: voxels.len() as u64, above, ground, size }))
    }

    /// The picture from a viewpoint, its edge halved as often.
    pub(super) fn view(&self, viewpoint: Viewpoint, halvings: u32) -> View {
        viewpoint.view(&self.above, self.ground, self.size).resized(halvings)
    }

    /// The light of one time of day.
    pub(super) fn lit(&self, lighting: Lighting) -> LitLand<'_> {
        let octree = Octree::of(&self.svo);
        let colors = match lighting {
            Lighting::Albedo => None,
            Lighting::Time(n) => {
                let (toward, light) = SUNS[n.min(3)];
                Some(lit_by(&octree, &Sun { toward, light }))
            }
        };
        let lit = LitLand { land: self, colors, contrast: Contrast::default() };
        LitLand { contrast: Contrast::of(&lit.octree()), ..lit }
    }
}

impl LitLand<'_> {
    pub(super) fn octree(&self) -> Octree<'_> {
        let octree = Octree::of(&self.land.svo);
        match &self.colors {
            Some(colors) => octree.with_colors(colors),
            None => octree,
        }
    }
}

/// The mean height of the highest voxel over all columns that have any.
fn mean_height(grid: &VoxelGrid) -> f32 {
    let width = grid.size.x as usize;
    let mut tops = vec![None; width * grid.size.z as usize];
    for voxel in &grid.voxels {
        let top = &mut tops[usize::from(voxel.cell[0]) + width * usize::from(voxel.cell[2])];
        *top = (*top).max(Some(voxel.cell[1]));
    }
    let (count, sum) =
        tops.iter().flatten().fold((0.0, 0.0), |(n, sum), top| (n + 1.0, sum + f64::from(*top)));
    (sum / f64::max(count, 1.0)) as f32
}
