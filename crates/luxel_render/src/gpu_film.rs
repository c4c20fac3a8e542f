//! The film on the GPU, in tiles that respect the binding limit, and the paths in flight.
use bevy_ecs::prelude::Resource;
use luxel_film::Film;
use luxel_flat::{Aov, FilmPixel, Path, SurfacePoint};
use luxel_gpu::{Gpu, GpuBuffer, GpuError, Resources};

/// Most pixels of a tile, whatever the device allows.
const MAX_TILE_PIXELS: u64 = 1 << 20;

/// Consecutive pixels that share a buffer.
struct Tile {
    first: u32,
    count: u32,
    pixels: GpuBuffer,
    aovs: Option<GpuBuffer>,
}

/// Accumulated samples, first-hit outputs, paths, and the surfaces at their ends.
#[derive(Resource)]
pub struct GpuFilm {
    tiles: Vec<Tile>,
    paths: GpuBuffer,
    surfaces: GpuBuffer,
    resolved: GpuBuffer,
}

impl GpuFilm {
    /// An empty film.
    ///
    /// # Errors
    /// When the device has no room.
    pub fn new(gpu: &Gpu, pixel_count: u32, aovs: bool) -> Result<Self, GpuError> {
        let fitting = gpu.limits().max_storage_binding_bytes / size_of::<FilmPixel>() as u64;
        let tile_pixels = fitting.clamp(1, MAX_TILE_PIXELS) as u32;
        let tiles = (0..pixel_count.div_ceil(tile_pixels)).map(|i| {
            let first = i * tile_pixels;
            let count = tile_pixels.min(pixel_count - first);
            let pixels = GpuBuffer::new(gpu, "film", u64::from(count) * size_of::<FilmPixel>() as u64)?;
            let aovs = aovs.then(|| GpuBuffer::new(gpu, "aovs", u64::from(count) * size_of::<Aov>() as u64));
            Ok(Tile { first, count, pixels, aovs: aovs.transpose()? })
        });
        Ok(Self {
            tiles: tiles.collect::<Result<_, GpuError>>()?,
            paths: GpuBuffer::new(gpu, "paths", size_of::<Path>() as u64)?,
            surfaces: GpuBuffer::new(gpu, "surfaces", size_of::<SurfacePoint>() as u64)?,
            resolved: GpuBuffer::new(gpu, "resolved", size_of::<u32>() as u64)?,
        })
    }

    /// Number of tiles.
    pub(crate) fn tile_count(&self) -> usize {
        self.tiles.len()
    }

    /// First pixel and number of pixels of a tile.
    pub(crate) fn tile_span(&self, tile: usize) -> (u32, u32) {
        (self.tiles[tile].first, self.tiles[tile].count)
    }

    /// Makes room for a number of paths.
    pub(crate) fn reserve_paths(&mut self, gpu: &Gpu, count: u32) -> Result<(), GpuError> {
        self.paths.reserve(gpu, u64::from(count) * size_of::<Path>() as u64)?;
        self.surfaces.reserve(gpu, u64::from(count) * size_of::<SurfacePoint>() as u64)?;
        Ok(())
    }

    /// Most paths that may be in flight: as many as fit into one binding.
    pub(crate) fn max_paths(gpu: &Gpu) -> u64 {
        let record = size_of::<Path>().max(size_of::<SurfacePoint>()) as u64;
        (gpu.limits().max_storage_binding_bytes / record).min(MAX_TILE_PIXELS)
    }

    /// Makes room for the picture of a tile.
    pub(crate) fn reserve_resolved(&mut self, gpu: &Gpu, tile: usize) -> Result<(), GpuError> {
        self.resolved.reserve(gpu, u64::from(self.tiles[tile].count) * size_of::<u32>() as u64)?;
        Ok(())
    }

    /// The picture of a tile, one packed pixel each, after the resolve node ran on it.
    pub(crate) fn read_resolved(&self, gpu: &Gpu, tile: usize) -> Result<Vec<u32>, GpuError> {
        self.resolved.read(gpu, 0, self.tiles[tile].count.into())
    }

    /// Reads everything back.
    pub(crate) fn read(&self, gpu: &Gpu, width: u32, height: u32) -> Result<Film, GpuError> {
        let mut film = Film { width, height, ..Film::default() };
        let mut aovs = Vec::new();
        for tile in &self.tiles {
            film.pixels.extend(tile.pixels.read::<FilmPixel>(gpu, 0, tile.count.into())?);
            if let Some(buffer) = &tile.aovs {
                aovs.extend(buffer.read::<Aov>(gpu, 0, tile.count.into())?);
            }
        }
        film.aovs = (!aovs.is_empty()).then_some(aovs);
        Ok(film)
    }

    /// Adds what a kernel may bind of a tile.
    pub(crate) fn resources<'a>(&'a self, resources: Resources<'a>, tile: usize) -> Resources<'a> {
        let tile = &self.tiles[tile];
        let resources = resources
            .buffer("paths", &self.paths)
            .buffer("surfaces", &self.surfaces)
            .buffer("film", &tile.pixels)
            .buffer("resolved", &self.resolved);
        match &tile.aovs {
            Some(aovs) => resources.buffer("aovs", aovs),
            None => resources,
        }
    }
}
