//! Average colours: exact integer sums in linear light, rounded once per node.
//!
//! Theory: IEC 61966-2-1 (sRGB). A byte is brought to linear light with 24 fractional bits; 2048³ of them still
//! fit 64 bits, and integer sums do not depend on their order.

/// Linear light 1.
const LINEAR_ONE: f64 = (1 << 24) as f64;

/// Linear light of each byte, and where bytes change when going back.
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

    /// The packed average of a node `levels` above the leaves; the solid share is at least 1 of 255, so that
    /// nothing solid is lost.
    pub(super) fn color(&self, levels: u32, srgb: &Srgb) -> u32 {
        let channel = |i: usize| srgb.encode(self.linear[i] / self.count) << (8 * i);
        let cells = 1u64 << (3 * levels);
        let share = ((2 * 255 * self.count + cells) / (2 * cells)).max(1) as u32;
        channel(0) | channel(1) | channel(2) | share << 24
    }
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
        assert_eq!(average(&[[9; 3]; 4], 1)[3], 128);
        assert_eq!(average(&[[9; 3]; 1], 1)[3], 32);
        assert_eq!(average(&[[9; 3]; 1], 11)[3], 1);
    }
}
