//! Noise and curves over the plane, in metres, from additions, multiplications and comparisons only: the same bits on
//! every machine.

use fastnoise_lite::{FastNoiseLite, NoiseType};
use luxel_geom::rng::pcg4d;

/// One octave of OpenSimplex noise, and sums of octaves.
pub(super) struct Field(FastNoiseLite);

impl Field {
    /// Another `channel`, another field.
    pub(super) fn new(seed: u32, channel: u32) -> Self {
        let [word, ..] = pcg4d([seed, channel, 0xF1E1D, 0]);
        let mut noise = FastNoiseLite::with_seed(word.cast_signed());
        noise.set_noise_type(Some(NoiseType::OpenSimplex2));
        noise.set_frequency(Some(1.0));
        Self(noise)
    }

    /// In [−1, 1]; `wave` is the length of a wave.
    pub(super) fn at(&self, x: f32, z: f32, wave: f32) -> f32 {
        self.0.get_noise_2d(x / wave, z / wave)
    }

    /// Octaves of halved lengths and heights, in [−1, 1].
    pub(super) fn fbm(&self, x: f32, z: f32, wave: f32, octaves: u32) -> f32 {
        let (mut sum, mut total, mut height, mut scale) = (0.0, 0.0, 1.0, 1.0 / wave);
        for octave in 0..octaves {
            let shift = 37.7 * octave as f32;
            sum += height * self.0.get_noise_2d(x * scale + shift, z * scale - shift);
            total += height;
            height *= 0.5;
            scale *= 2.0;
        }
        sum / total
    }

    /// The same with sharp crests, in [0, 1]; small octaves are weaker in the valleys.
    pub(super) fn ridged(&self, x: f32, z: f32, wave: f32, octaves: u32) -> f32 {
        let (mut sum, mut total, mut height, mut scale) = (0.0, 0.0, 1.0, 1.0 / wave);
        let mut weight = 1.0;
        for octave in 0..octaves {
            let shift = 51.3 * octave as f32;
            let noise = self.0.get_noise_2d(x * scale + shift, z * scale - shift);
            // Rounded a little, lest crests end in needles.
            let crest = 1.0 - (noise * noise + 0.012).sqrt();
            let crest = crest * crest * weight;
            sum += height * crest;
            total += height;
            weight = crest.clamp(0.2, 1.0);
            height *= 0.4;
            scale *= 2.0;
        }
        sum / total
    }
}

/// 0 below `from`, 1 above `to`, smooth between.
pub(super) fn step(from: f32, to: f32, x: f32) -> f32 {
    let t = ((x - from) / (to - from)).clamp(0.0, 1.0);
    t * t * (3.0 - 2.0 * t)
}

/// From `a` to `b` as `t` goes from 0 to 1.
pub(super) fn mix(a: f32, b: f32, t: f32) -> f32 {
    a + (b - a) * t
}

/// Distance between two points of the plane.
pub(super) fn distance(a: [f32; 2], b: [f32; 2]) -> f32 {
    let (x, z) = (a[0] - b[0], a[1] - b[1]);
    (x * x + z * z).sqrt()
}

/// Four numbers in [0, 1) for an address.
pub(super) fn random(address: [u32; 4]) -> [f32; 4] {
    pcg4d(address).map(|word| (word >> 8) as f32 / (1 << 24) as f32)
}

/// A number in [0, 1) for a cell: cheaper than [`random`].
pub(super) fn hash(cell: [i32; 3], salt: u32) -> f32 {
    let [x, y, z] = cell.map(i32::cast_unsigned);
    let mut word =
        x.wrapping_mul(0x8DA6_B343) ^ y.wrapping_mul(0xD816_3841) ^ z.wrapping_mul(0xCB1A_B31F) ^ salt;
    word = (word ^ (word >> 16)).wrapping_mul(0x7FEB_352D);
    word = (word ^ (word >> 15)).wrapping_mul(0x846C_A68B);
    ((word ^ (word >> 16)) >> 8) as f32 / (1 << 24) as f32
}
