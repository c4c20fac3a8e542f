//! Random numbers and noise for recipes: the same on every machine.

use fastnoise_lite::{FastNoiseLite, FractalType, NoiseType};
use luxel_geom::rng::{pcg4d, uniform};

/// Four numbers in [0, 1) for an address; another address, other numbers.
pub(super) fn random(address: [u32; 4]) -> [f64; 4] {
    pcg4d(address).map(uniform)
}

/// Smooth hills in [−1, 1] (OpenSimplex, five octaves) with about `hills` of them in a unit of the
/// plane.
pub(super) struct Hills(FastNoiseLite);

impl Hills {
    pub(super) fn new(seed: u32, hills: f32) -> Self {
        let mut noise = FastNoiseLite::with_seed(seed.cast_signed());
        noise.set_noise_type(Some(NoiseType::OpenSimplex2));
        noise.set_fractal_type(Some(FractalType::FBm));
        noise.set_fractal_octaves(Some(5));
        noise.set_frequency(Some(hills));
        Self(noise)
    }

    pub(super) fn at(&self, x: f32, z: f32) -> f32 {
        self.0.get_noise_2d(x, z)
    }
}
