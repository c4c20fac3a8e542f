//! The four areas of seed document 3 (§4), by recipe: landscapes of 512 m × 512 m, as if voxelised by looking at them.
//!
//! A landscape ([`Landscape`]) says how high the ground is, what covers it and what stands on it, in metres. Columns are
//! drawn in tiles side by side; every voxel depends on its own place only, so that a tile's border cannot be seen and
//! the result is the same on every machine and with any number of threads.
//!
//! To tune an area, change the numbers of its recipe (`DESERT` in `desert.rs`, and so on): `contrast` widens or narrows
//! the shades of everything without moving a voxel, `thickness` sets how many voxels the ground takes.

mod biomes;
mod buildings;
mod cache;
mod desert;
mod field;
mod forest;
mod ground;
mod keys;
mod mountain;
mod rocks;
mod ropes;
mod store;
mod stuff;
mod things;
mod tile;
mod trees;

use std::ops::ControlFlow;
use std::path::Path;

use glam::UVec3;
use rayon::prelude::*;
use serde::{Deserialize, Serialize};
use xxhash_rust::xxh3::{Xxh3, xxh3_64};

use crate::assets::VoxelGrid;
use crate::material::Surface;

use ground::{Cover, Ground, Spot};
use keys::{Key, key, voxel};
use stuff::palette;
use things::Thing;
use tile::{TILE, Tile};

/// Metres along an edge of every area.
pub const AREA_EXTENT: f32 = EXTENT;
const EXTENT: f32 = 512.0;

/// Changes whenever areas come out differently for another reason than the numbers of their recipes.
const GENERATOR: u32 = 2;

/// Tiles that are drawn between two words to the caller.
const BATCH: usize = 16;

/// Which landscape an area shows.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug, Serialize, Deserialize)]
pub enum AreaKind {
    /// A town in a valley, a bare plateau, rock formations, a rough mountain, few trees.
    Desert,
    /// A dark, dense forest in a valley among mountains with patches of snow; a slackline over a clearing.
    Forest,
    /// Snow everywhere, dark rocks, trees under snow, and some calm places.
    Mountain,
    /// Forest, mountain, desert and desert under snow side by side.
    Biomes,
}

impl AreaKind {
    /// All of them, in the order of the document.
    pub const ALL: [Self; 4] = [Self::Desert, Self::Forest, Self::Mountain, Self::Biomes];

    /// In lower case.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Desert => "desert",
            Self::Forest => "forest",
            Self::Mountain => "mountain",
            Self::Biomes => "biomes",
        }
    }

    /// A number for everything that the voxels of this area depend on, but size and seed: the recipe's numbers and the
    /// version of the generator.
    #[must_use]
    pub fn recipe_hash(self) -> u64 {
        let numbers = match self {
            Self::Desert => format!("{:?}", desert::DESERT),
            Self::Forest => format!("{:?}", forest::FOREST),
            Self::Mountain => format!("{:?}", mountain::MOUNTAIN),
            Self::Biomes => format!("{:?}", biomes::BIOMES),
        };
        xxh3_64(format!("{GENERATOR} {} {numbers}", self.name()).as_bytes())
    }

    fn landscape(self, seed: u32) -> Box<dyn Landscape> {
        match self {
            Self::Desert => Box::new(desert::Desert::new(seed)),
            Self::Forest => Box::new(forest::Forest::new(seed)),
            Self::Mountain => Box::new(mountain::Mountain::new(seed)),
            Self::Biomes => Box::new(biomes::Biomes::new(seed)),
        }
    }
}

/// One area at one resolution.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug)]
pub struct Area {
    /// Which.
    pub kind: AreaKind,
    /// Voxels along an edge: a power of two from 64 to 2048. At 2048 a voxel has an edge of 25 cm.
    pub size: u32,
    /// Picks the landscape.
    pub seed: u32,
}

/// The caller did not want the rest.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct Cancelled;

/// Hears how many steps are done, of how many, and says whether to go on.
pub type Progress<'a> = &'a mut dyn FnMut(u32, u32) -> ControlFlow<()>;

impl Area {
    /// All voxels, in Morton order (bit 0 of the code is x, 1 is y, 2 is z).
    ///
    /// # Errors
    /// `progress` broke off.
    pub fn generate(&self, progress: Progress<'_>) -> Result<VoxelGrid, Cancelled> {
        self.keys(progress).map(|keys| self.grid(&keys))
    }

    /// The same, from the file in `folder` if there is a sound one, and otherwise kept there if that can be written.
    ///
    /// # Errors
    /// `progress` broke off.
    pub fn cached(&self, folder: &Path, progress: Progress<'_>) -> Result<VoxelGrid, Cancelled> {
        if let Some(keys) = cache::read(self, folder) {
            return Ok(self.grid(&keys));
        }
        let keys = self.keys(progress)?;
        cache::write(self, folder, &keys);
        Ok(self.grid(&keys))
    }

    /// The file of this area in a cache folder.
    #[must_use]
    pub fn cache_file(&self, folder: &Path) -> std::path::PathBuf {
        folder.join(format!("{}-{}-{}.area", self.kind.name(), self.size, self.seed))
    }

    fn keys(&self, progress: Progress<'_>) -> Result<Vec<Key>, Cancelled> {
        let landscape = self.kind.landscape(self.seed);
        let plan = Plan::new(self, &*landscape);
        let total = plan.tiles.len() as u32;
        let mut keys = Vec::new();
        for (batch, tiles) in plan.tiles.chunks(BATCH).enumerate() {
            if progress((batch * BATCH) as u32, total).is_break() {
                return Err(Cancelled);
            }
            let drawn: Vec<Vec<Key>> = tiles.par_iter().map(|at| plan.draw(*at)).collect();
            drawn.iter().for_each(|part| keys.extend_from_slice(part));
        }
        keys.par_sort_unstable();
        // The last word: nobody minds whether it breaks off.
        let _ = progress(total, total);
        Ok(keys)
    }

    fn grid(&self, keys: &[Key]) -> VoxelGrid {
        VoxelGrid {
            size: UVec3::splat(self.size),
            voxels: keys.par_iter().map(|key| voxel(*key)).collect(),
            palette: palette(self.kind.landscape(self.seed).contrast()),
        }
    }
}

/// The folder that areas are kept in: `LUXEL_CACHE`, or else `luxel` in `XDG_CACHE_HOME` or in `~/.cache`.
#[must_use]
pub fn cache_folder() -> Option<std::path::PathBuf> {
    cache::folder(|name| std::env::var_os(name))
}

/// A fingerprint of the voxels and surfaces of a grid, whatever the order of its voxels.
#[must_use]
pub fn content_hash(grid: &VoxelGrid) -> u64 {
    let mut keys: Vec<Key> = grid.voxels.par_iter().map(|voxel| key(voxel.cell, voxel.palette)).collect();
    if !keys.is_sorted() {
        keys.par_sort_unstable();
    }
    let mut hash = Xxh3::new();
    grid.size.to_array().iter().for_each(|edge| hash.update(&edge.to_le_bytes()));
    for material in &grid.palette {
        match material.surface {
            // As numbers, so that a new field of a material changes nothing.
            Surface::Lambert { albedo } => {
                albedo.to_array().iter().for_each(|channel| hash.update(&channel.to_le_bytes()));
            }
            _ => hash.update(format!("{:?}", material.surface).as_bytes()),
        }
    }
    for part in keys.chunks(1 << 16) {
        let bytes: Vec<u8> = part.iter().flat_map(|key| key.to_le_bytes()).collect();
        hash.update(&bytes);
    }
    hash.digest()
}

/// What an area shows. Lengths are metres; x goes right and z down in a picture from above.
trait Landscape: Sync {
    /// Height of the ground, above 2.
    fn height(&self, x: f32, z: f32) -> f32;
    /// What covers a column.
    fn cover(&self, spot: &Spot) -> Cover;
    /// What stands on the ground.
    fn things(&self) -> Vec<Thing>;
    /// How thick the ground is, metres; where it is steep, as thick as it must be to have no holes.
    fn thickness(&self) -> f32;
    /// How different shades are.
    fn contrast(&self) -> f32;
}

/// All that tiles are drawn from.
struct Plan<'a> {
    landscape: &'a dyn Landscape,
    ground: Ground,
    things: Vec<Thing>,
    /// First column of each tile.
    tiles: Vec<[i32; 2]>,
    size: i32,
    voxel: f32,
    seed: u32,
}

impl<'a> Plan<'a> {
    fn new(area: &Area, landscape: &'a dyn Landscape) -> Self {
        let edge = area.size as i32 / TILE;
        Self {
            landscape,
            ground: Ground::new(landscape, area.size, EXTENT),
            things: landscape.things(),
            tiles: (0..edge * edge).map(|index| [index % edge * TILE, index / edge * TILE]).collect(),
            size: area.size as i32,
            voxel: EXTENT / area.size as f32,
            seed: area.seed,
        }
    }

    fn draw(&self, at: [i32; 2]) -> Vec<Key> {
        let things = self.things_of(at);
        let cells = |metres: f32| (metres / self.voxel) as i32;
        let [low, high] = self.ground.range(at);
        let margin = cells(self.landscape.thickness()) + 2;
        let low = things.iter().fold(low, |low, thing| low.min(cells(thing.bounds()[0].y))) - margin;
        let high = things.iter().fold(high, |high, thing| high.max(cells(thing.bounds()[1].y)));
        let (low, high) = (low.max(0), (high + cells(2.0) + 2).min(self.size));
        let mut tile = Tile::new([at[0], low, at[1]], high - low, self.voxel);
        self.ground.draw(self.landscape, &mut tile, at, self.seed);
        things.iter().for_each(|thing| thing.draw(&mut tile));
        tile.filled().map(|(cell, palette)| key(cell.map(|c| c as u16), palette)).collect()
    }

    fn things_of(&self, at: [i32; 2]) -> Vec<&Thing> {
        let low = at.map(|c| c as f32 * self.voxel);
        let edge = TILE as f32 * self.voxel;
        let is_near = |thing: &&Thing| {
            let [from, to] = thing.bounds();
            let reaches = |a: f32, b: f32, low: f32| b + self.voxel >= low && a - self.voxel <= low + edge;
            reaches(from.x, to.x, low[0]) && reaches(from.z, to.z, low[1])
        };
        self.things.iter().filter(is_near).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn borders_of_tiles_cannot_be_seen() {
        for kind in AreaKind::ALL {
            let area = Area { kind, size: 256, seed: 5 };
            let landscape = kind.landscape(area.seed);
            let plan = Plan::new(&area, &*landscape);
            // A tile across four others, over what stands in the middle of the area.
            let low = [96, 160];
            let is_inside = |key: &Key| {
                let [x, _, z] = voxel(*key).cell.map(i32::from);
                (low[0]..low[0] + TILE).contains(&x) && (low[1]..low[1] + TILE).contains(&z)
            };
            let mut across = plan.draw(low);
            let parts = [[64, 128], [128, 128], [64, 192], [128, 192]].map(|at| plan.draw(at));
            let mut beside: Vec<Key> = parts.concat().into_iter().filter(is_inside).collect();
            across.sort_unstable();
            beside.sort_unstable();
            assert!(across == beside, "{}", kind.name());
        }
    }
}
