//! The ends of the numbers that samplers take.

/// The ends of `[0, 1)` in 24 bits, where samplers break, and the middle, where the disk's map divides.
pub const ENDS: [f32; 6] =
    [0.0, 1.0 / (1 << 24) as f32, 0.25, 0.5, 0.5 + 1.0 / (1 << 24) as f32, 1.0 - 1.0 / (1 << 24) as f32];

/// Every pair of them.
pub fn pairs_of_ends() -> impl Iterator<Item = (f32, f32)> {
    ENDS.into_iter().flat_map(|a| ENDS.map(|b| (a, b)))
}
