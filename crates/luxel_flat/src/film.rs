//! What the film keeps for a pixel. The arithmetic is in `luxel_film::accumulate`.
use crate::layout::{WgslType, shared_struct};

shared_struct! {
    /// Partial sums of one half of a pixel's samples, folded every `CASCADE_FOLD` (robustness.md, A7): no running
    /// mean, and no single sum of millions of terms.
    pub struct Cascade {
        /// Sum of up to 64 samples.
        pub batch: [f32; 3],
        /// Sum of up to 64 squared luminances.
        pub batch_square: f32,
        /// Sum of up to 64 batches.
        pub group: [f32; 3],
        /// Sum of up to 64 batches of squared luminances.
        pub group_square: f32,
        /// Sum of groups.
        pub total: [f32; 3],
        /// Sum of groups of squared luminances.
        pub total_square: f32,
    }
}

impl WgslType for Cascade {
    const NAME: &'static str = "Cascade";
    const ALIGN: usize = 16;
}

shared_struct! {
    /// A pixel: even samples in one half, odd samples in the other, so that their difference tells the error.
    pub struct FilmPixel {
        /// Sums of samples 0, 2, 4, …
        pub even: Cascade,
        /// Sums of samples 1, 3, 5, …
        pub odd: Cascade,
        /// Samples accumulated.
        pub count: u32,
        /// Samples dropped because they were not finite.
        pub dropped: u32,
        /// Always 0.
        pub reserved0: u32,
        /// Always 0.
        pub reserved1: u32,
    }
}
