//! What the film keeps for a pixel. The arithmetic is in `luxel_film::accumulate`.
use crate::layout::{WgslType, shared_struct};

shared_struct! {
    /// Partial sums of one half of a pixel's samples (robustness.md, A7): no running mean, and no single sum of
    /// millions of terms. Their sum is the sum of the samples.
    pub struct Cascade {
        /// What `group` could not hold without rounding; less than its last few bits.
        pub batch: [f32; 3],
        /// The same of the squared luminances.
        pub batch_square: f32,
        /// Sum of up to `CASCADE_FOLD`² samples, and what `total` could not hold without rounding.
        pub group: [f32; 3],
        /// The same of the squared luminances.
        pub group_square: f32,
        /// Sum of all samples up to the last fold.
        pub total: [f32; 3],
        /// The same of the squared luminances.
        pub total_square: f32,
    }
}

impl WgslType for Cascade {
    const NAME: &'static str = "Cascade";
    const ALIGN: usize = 16;
}

shared_struct! {
    /// A pixel: of the samples that are kept, even ones in one half and odd ones in the other, so that their
    /// difference tells the error.
    pub struct FilmPixel {
        /// Sums of the kept samples 0, 2, 4, …
        pub even: Cascade,
        /// Sums of the kept samples 1, 3, 5, …
        pub odd: Cascade,
        /// Samples taken, the dropped ones included.
        pub count: u32,
        /// Samples dropped because they were not finite.
        pub dropped: u32,
        /// Always 0.
        pub reserved0: u32,
        /// Always 0.
        pub reserved1: u32,
    }
}
