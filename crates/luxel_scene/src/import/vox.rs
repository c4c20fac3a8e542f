//! MagicaVoxel .vox: all visible models in one grid.
//!
//! Models are turned and shifted by whole voxels, so merging them is exact. Z-up becomes Y-up by
//! (x, y, z) → (x, z, −y): what faced MagicaVoxel's front view faces +Z.

use std::collections::HashSet;
use std::path::Path;

use dot_vox::DotVoxData;
use glam::UVec3;

use crate::assets::{Voxel, VoxelGrid};
use crate::error::SceneError;

use super::vox_graph::{Instance, instances};
use super::{counted, file_name, read_model, vox_chunks, vox_palette};

/// The most voxels that a file may expand to by showing models many times.
const MAX_VOXELS: u64 = 1 << 27;

/// The longest edge of a grid: a cell is 16-bit.
const MAX_EXTENT: i64 = u16::MAX as i64;

/// A whole .vox file.
#[derive(Debug)]
pub(crate) struct VoxFile {
    /// At least one voxel; only the palette entries that are used.
    pub(crate) grid: VoxelGrid,
    /// Voxels in models that are shown, in the grid or not.
    pub(crate) voxels: u64,
    /// Voxels outside their model's size.
    pub(crate) dropped: u64,
    /// Models that are shown, each once.
    models: usize,
    /// One line each: what is in the file and not used.
    pub(crate) ignored: Vec<String>,
    /// One line each: what is in the file and not in the grid.
    pub(crate) warnings: Vec<String>,
}

impl VoxFile {
    /// Reads the file at `path`.
    ///
    /// # Errors
    /// A file that cannot be read, is damaged, expands to too much, or shows no voxel.
    pub(crate) fn read(path: &Path) -> Result<Self, SceneError> {
        let bytes = read_model(path)?;
        let skeleton = vox_chunks::check(path, &bytes)?;
        let data = dot_vox::load_bytes(&bytes).map_err(|message| SceneError::unusable(path, message))?;
        if data.models.len() != skeleton.models || data.models.is_empty() {
            return Err(SceneError::unusable(path, "has no model, or a model without a size"));
        }
        let instances = instances(path, &data, &skeleton)?;
        let voxels = count_voxels(path, &data, &instances)?;
        let (cells, dropped) = place_all(&data, &instances);
        if cells.is_empty() {
            let message = match dropped {
                0 => "shows no voxel".to_owned(),
                n => format!("all {n} voxels lie outside their model"),
            };
            return Err(SceneError::unusable(path, message));
        }
        let models = instances.iter().map(|instance| instance.model).collect::<HashSet<_>>().len();
        let ignored = skeleton.ignored.lines();
        let (grid, warnings) = (grid(path, cells, &data)?, warnings(path, &data));
        Ok(Self { grid, voxels, dropped, models, ignored, warnings })
    }

    /// What a scene shows of the file, one line each.
    pub(crate) fn used(&self) -> Vec<String> {
        vec![
            format!("{} with {}", counted(self.models, "model"), counted(self.grid.voxels.len(), "voxel")),
            counted(self.grid.palette.len(), "material"),
        ]
    }

    /// The line about voxels left out, if any were.
    pub(crate) fn dropped_line(&self, path: &Path) -> Option<String> {
        (self.dropped > 0).then(|| {
            format!(
                "{}: dropped {} of {} voxels (outside their model)",
                file_name(path),
                self.dropped,
                self.voxels
            )
        })
    }
}

/// A filled cell of the world, Y up, and its place in the palette.
type Cell = ([i64; 3], u8);

fn count_voxels(path: &Path, data: &DotVoxData, instances: &[Instance]) -> Result<u64, SceneError> {
    let count = instances
        .iter()
        .map(|instance| data.models[instance.model].voxels.len() as u64)
        .fold(0, u64::saturating_add);
    if count > MAX_VOXELS {
        let message = format!("expands to {count} voxels; {MAX_VOXELS} is the most");
        return Err(SceneError::unusable(path, message));
    }
    Ok(count)
}

/// All voxels at their places, and the number of those outside their model.
fn place_all(data: &DotVoxData, instances: &[Instance]) -> (Vec<Cell>, u64) {
    let mut cells = Vec::new();
    let mut dropped = 0;
    for Instance { model, placement } in instances {
        let model = &data.models[*model];
        let size = [model.size.x, model.size.y, model.size.z];
        for voxel in &model.voxels {
            let cell = [voxel.x, voxel.y, voxel.z];
            if (0..3).all(|axis| u32::from(cell[axis]) < size[axis]) {
                let [x, y, z] = placement.place(cell, size);
                cells.push(([x, z, -1 - y], voxel.i));
            } else {
                dropped += 1;
            }
        }
    }
    (cells, dropped)
}

/// The smallest grid around `cells`; where models overlap the later one is seen.
fn grid(path: &Path, mut cells: Vec<Cell>, data: &DotVoxData) -> Result<VoxelGrid, SceneError> {
    // Stable, and reversed: of equal cells the last comes first and stays.
    cells.reverse();
    cells.sort_by_key(|&(cell, _)| cell);
    cells.dedup_by_key(|&mut (cell, _)| cell);
    let axis = |axis: usize| cells.iter().map(move |(cell, _)| cell[axis]);
    let min = [0, 1, 2].map(|a| axis(a).min().unwrap_or(0));
    let extent = [0, 1, 2].map(|a| axis(a).max().unwrap_or(0) - min[a] + 1);
    if extent.iter().any(|&edge| edge > MAX_EXTENT) {
        let message = format!("spreads over {extent:?} voxels; {MAX_EXTENT} along an edge is the most");
        return Err(SceneError::unusable(path, message));
    }
    let mut palette = Palette::new(data);
    let voxels = cells
        .iter()
        .map(|&(cell, colour)| Voxel {
            cell: [0, 1, 2].map(|a| (cell[a] - min[a]) as u16),
            palette: palette.index(colour),
        })
        .collect();
    Ok(VoxelGrid {
        size: UVec3::from_array(extent.map(|edge| edge as u32)),
        voxels,
        palette: palette.materials,
    })
}

/// The palette entries that are used, in the order of their first use.
struct Palette<'a> {
    data: &'a DotVoxData,
    new_index: [Option<u8>; 256],
    materials: Vec<crate::Material>,
}

impl<'a> Palette<'a> {
    fn new(data: &'a DotVoxData) -> Self {
        Self { data, new_index: [None; 256], materials: Vec::new() }
    }

    fn index(&mut self, colour: u8) -> u8 {
        *self.new_index[usize::from(colour)].get_or_insert_with(|| {
            self.materials.push(vox_palette::material(self.data, colour));
            (self.materials.len() - 1) as u8
        })
    }
}

fn warnings(path: &Path, data: &DotVoxData) -> Vec<String> {
    let others = data.models.len() - 1;
    if data.scenes.is_empty() && others > 0 {
        vec![format!(
            "{}: shows the first of {} models: without a scene graph they are frames of an animation",
            file_name(path),
            others + 1
        )]
    } else {
        Vec::new()
    }
}
