//! Average colours: exact integer sums in linear light, rounded once per node.
//!
//! Theory: IEC 61966-2-1 (sRGB). A byte is brought to linear light with 24 fractional bits; 2048³ of them still
//! fit 64 bits, and integer sums do not depend on their order.

use luxel_flat::SVO_SHARE_SHIFT;

/// Linear light 1.
const LINEAR_ONE: f64 = (1 << 24) as f64;

/// Linear light of each byte, and where bytes change when going back.
#[derive(Clone, Debug)]
pub(super) struct Srgb {
    linear: [u64; 256],
    /// `border[i]`: the least linear value that is rounded to a byte above `i`.
    borders: [u64; 255],
}

impl Srgb {
    pub(super) fn new() -> Self {
        let decode = |byte: f64| {
            let s = byte / 255.0;
            let linear = if s <= 0.04045 { s / 12.92 } else { ((s + 0.055) / 1.055).powf(2.4) };
            (linear * LINEAR_ONE).round() as u64
        };
        Self {
            linear: std::array::from_fn(|i| decode(i as f64)),
            borders: std::array::from_fn(|i| decode(i as f64 + 0.5)),
        }
    }

    fn encode(&self, linear: u64) -> u32 {
        self.borders.partition_point(|&border| border <= linear) as u32
    }
}

/// Sum over solid voxels.
#[derive(Clone, Copy, Default, PartialEq, Eq, Debug)]
pub(super) struct Sum {
    linear: [u64; 3],
    count: u64,
}

impl Sum {
    /// The sum over one leaf, from its packed colour.
    pub(super) fn of_leaf(color: u32, srgb: &Srgb) -> Self {
        let channel = |i: usize| srgb.linear[(color >> (8 * i) & 0xff) as usize];
        Self { linear: std::array::from_fn(channel), count: 1 }
    }

    pub(super) fn add(&mut self, other: &Self) {
        for (sum, linear) in self.linear.iter_mut().zip(other.linear) {
            *sum += linear;
        }
        self.count += other.count;
    }

    /// Takes back what was added before.
    pub(super) fn subtract(&mut self, part: &Self) {
        for (sum, linear) in self.linear.iter_mut().zip(part.linear) {
            *sum -= linear;
        }
        self.count -= part.count;
    }

    /// True without voxels.
    pub(super) fn is_empty(&self) -> bool {
        self.count == 0
    }

    /// The packed average of a node `levels` above the leaves. Of the solid share the square root is stored, which tells
    /// one voxel in 8³ from none; it is at least 1 of 255, so that nothing solid is lost.
    pub(super) fn color(&self, levels: u32, srgb: &Srgb) -> u32 {
        let channel = |i: usize| srgb.encode(self.linear[i] / self.count) << (8 * i);
        let share = self.count as f64 / (1u64 << (3 * levels)) as f64;
        let root = (255.0 * share.sqrt()).round().max(1.0) as u32;
        channel(0) | channel(1) | channel(2) | root << SVO_SHARE_SHIFT
    }
}

/// The solid share of a cell, from its packed colour.
pub fn solid_share(color: u32) -> f32 {
    let root = (color >> SVO_SHARE_SHIFT) as f32 / 255.0;
    root * root
}

/// The packed colour of a leaf: wholly solid.
pub(super) fn leaf_color([red, green, blue]: [u8; 3]) -> u32 {
    u32::from_le_bytes([red, green, blue, 255])
}

#[cfg(test)]
mod tests {
    use super::*;

    fn average(colors: &[[u8; 3]], levels: u32) -> [u8; 4] {
        let srgb = Srgb::new();
        let mut sum = Sum::default();
        colors.iter().for_each(|c| sum.add(&Sum::of_leaf(leaf_color(*c), &srgb)));
        sum.color(levels, &srgb).to_le_bytes()
    }

    #[test]
    fn equal_colours_average_to_themselves() {
        for byte in 0..=255 {
            let color = [byte, 255 - byte, byte / 2];
            assert_eq!(average(&[color; 3], 1)[..3], color);
        }
    }

    #[test]
    fn black_and_white_average_in_linear_light() {
        assert_eq!(average(&[[0; 3], [255; 3]], 1)[..3], [188; 3]);
    }

    #[test]
    fn the_solid_share_is_rounded_but_never_zero() {
        assert_eq!(average(&[[9; 3]; 8], 1)[3], 255);
        assert_eq!(average(&[[9; 3]; 2], 1)[3], 128);
        assert_eq!(average(&[[9; 3]; 1], 11)[3], 1);
        for (count, levels) in [(1, 3), (1, 1), (3, 1), (4, 1), (7, 1), (100, 3), (511, 3)] {
            let share = solid_share(u32::from_le_bytes(average(&vec![[9; 3]; count], levels)));
            let exact = count as f32 / (1 << (3 * levels)) as f32;
            assert!((share - exact).abs() < 4e-3 && (count > 1 || (share - exact).abs() < 1e-3), "{count}");
        }
    }
}
