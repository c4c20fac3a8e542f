//! Pictures of one area under one lighting, measured against its reference.
use std::time::Instant;

use luxel_lod::{
    Adaptive, ErrorAware, ErrorTable, LuminanceAware, MISSED, NodeError, Picture, VarianceScale, View,
    adaptive, error_aware, luminance, plain, reference,
};

use super::ask::Variant;
use super::land::{Land, LitLand};
use super::viewpoint::Viewpoint;
use crate::ssim::ssim;

/// The variance that counts as 1 for the adaptive renderer in all areas: with it the four need about as many rays for a
/// pixel in albedo as in the document. It was fixed, with the areas, before the error-aware renderer was measured on them.
pub(super) const VARIANCE_SCALE: VarianceScale = VarianceScale(0.3125);

/// How much the contrast below a node counts among the improvements.
const CONTRAST_WEIGHT: f32 = 1.0;

/// The tables of errors.
pub(super) struct Tables {
    sh9: ErrorTable,
    directions: ErrorTable,
}

/// A view of an area, and its reference.
pub(super) struct Bench<'a> {
    tables: &'a Tables,
    lit: &'a LitLand<'a>,
    view: View,
    pub(super) reference: Shot,
}

/// A picture, what it shows as code values, and the seconds that it took.
pub(super) struct Shot {
    pub(super) picture: Picture,
    pub(super) codes: Vec<[f64; 3]>,
    pub(super) secs: f64,
}

/// How far a picture is from its reference.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Distance {
    pub(super) rmse: f64,
    /// `None` if they are equal.
    pub(super) psnr: Option<f64>,
    pub(super) ssim: f64,
}

impl Tables {
    pub(super) fn new() -> Self {
        Self { sh9: ErrorTable::sh9(), directions: ErrorTable::directions() }
    }
}

impl Shot {
    fn take(make: impl FnOnce() -> Picture) -> Self {
        let start = Instant::now();
        let picture = make();
        let secs = start.elapsed().as_secs_f64();
        let codes = picture.codes().as_chunks::<3>().0.iter().map(|code| code.map(f64::from)).collect();
        Self { picture, codes, secs }
    }

    /// Mean linear luminance.
    pub(super) fn luminance(&self) -> f64 {
        let sum: f64 = self.picture.pixels.iter().map(|pixel| f64::from(luminance(pixel.rgb))).sum();
        sum / self.picture.pixels.len() as f64
    }

    /// Pixels that ended so many levels below the level of pixels; and those that show nothing.
    pub(super) fn levels(&self, view_level: u32) -> ([u64; 3], u64) {
        let count = |below: u32| self.picture.count(view_level.saturating_sub(below) as u8);
        ([0, 1, 2].map(count), self.picture.count(MISSED))
    }
}

impl<'a> Bench<'a> {
    pub(super) fn new(
        tables: &'a Tables,
        land: &Land,
        lit: &'a LitLand<'a>,
        viewpoint: Viewpoint,
        halvings: u32,
    ) -> Self {
        let view = land.view(viewpoint, halvings);
        let reference = Shot::take(|| reference(&lit.octree(), &view));
        Self { tables, lit, view, reference }
    }

    pub(super) fn view(&self) -> &View {
        &self.view
    }

    pub(super) fn plain(&self) -> Shot {
        Shot::take(|| plain(&self.lit.octree(), &self.view))
    }

    pub(super) fn adaptive(&self, iterations: u32) -> Shot {
        let settings = Adaptive { iterations, ..Adaptive::document(VARIANCE_SCALE) };
        Shot::take(|| adaptive(&self.lit.octree(), &self.view, &settings))
    }

    pub(super) fn error_aware(&self, variant: Variant, decay: f32, threshold: f32) -> Shot {
        let table = if variant.directions { &self.tables.directions } else { &self.tables.sh9 };
        let luminance = LuminanceAware { contrast: &self.lit.contrast, weight: CONTRAST_WEIGHT };
        let settings = ErrorAware {
            error: NodeError { table, decay },
            threshold,
            keeps_ray: variant.keeps_ray,
            luminance: variant.luminance.then_some(luminance),
        };
        Shot::take(|| error_aware(&self.lit.octree(), &self.view, &settings))
    }

    pub(super) fn distance(&self, shot: &Shot) -> Distance {
        let (a, b) = (&self.reference.codes, &shot.codes);
        let squares = a.as_flattened().iter().zip(b.as_flattened()).map(|(a, b)| (a - b) * (a - b));
        let rmse = (squares.sum::<f64>() / (3 * a.len()) as f64).sqrt();
        let psnr = (rmse > 0.0).then(|| -20.0 * rmse.log10());
        Distance { rmse, psnr, ssim: ssim(self.view.size as usize, a, b).unwrap_or(1.0) }
    }
}
