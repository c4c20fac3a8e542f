//! What seed document 3 measured, typed from its tables once; pages show it beside what is measured here.
mod albedo;
mod lighting;
mod sweeps;

pub(super) use albedo::{ALBEDO, Albedo};
pub(super) use lighting::{LIGHTING, LUMINANCE, Lit};
pub(super) use sweeps::{
    ADAPTIVE, BEST, BY_DECAY, BY_RESOLUTION, BY_THRESHOLD, RAY_CAST_BOUNDS, VOXELS_AND_NODES,
};

/// Rays that met something, and the octree nodes that they stepped through.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Counts {
    pub(super) rays: u64,
    pub(super) steps: u64,
}

/// How near a picture is to the reference.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Quality {
    pub(super) psnr: f64,
    pub(super) rmse: f64,
    pub(super) ssim: f64,
}

/// One renderer's row.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Row {
    pub(super) counts: Counts,
    pub(super) quality: Quality,
}

/// The document's two renderers under the same setting.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Pair {
    pub(super) adaptive: Row,
    pub(super) error_aware: Row,
}

const fn row(rays: u64, steps: u64, psnr: f64, rmse: f64, ssim: f64) -> Row {
    Row { counts: Counts { rays, steps }, quality: Quality { psnr, rmse, ssim } }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Every pair of the tables.
    fn pairs() -> Vec<Pair> {
        let lit = LIGHTING.iter().flat_map(|lit| lit.times);
        let swept = BY_RESOLUTION.iter().map(|(_, pair)| *pair);
        ALBEDO.iter().map(|albedo| albedo.pair).chain(lit).chain(swept).collect()
    }

    #[test]
    fn psnr_and_rmse_say_the_same() {
        for Pair { adaptive, error_aware } in pairs() {
            for Quality { psnr, rmse, .. } in [adaptive.quality, error_aware.quality] {
                // RMSE is given to 1e-5, sometimes rounded and sometimes cut off.
                let psnr_of = |rmse: f64| -20.0 * rmse.log10();
                let range = psnr_of(rmse + 1.01e-5)..psnr_of(rmse - 0.6e-5);
                assert!(range.contains(&psnr), "{psnr} dB, {rmse}");
            }
        }
    }

    #[test]
    fn rays_per_pixel_follow_from_rays() {
        for albedo in &ALBEDO {
            let rows = [albedo.pair.adaptive, albedo.pair.error_aware];
            let pixels = [albedo.adaptive_pixels, albedo.error_aware_pixels];
            for ((row, pixels), per_pixel) in rows.iter().zip(pixels).zip(albedo.rays_per_pixel) {
                let shown = 512 * 512 - pixels[0];
                assert!((row.counts.rays as f64 / shown as f64 - per_pixel).abs() < 1.1e-3, "{per_pixel}");
            }
        }
    }
}
