//! Smaller images: a box filter of any ratio.
//!
//! Every texel of the small image is the mean of the part of the large one that it covers, colours mixed as light:
//! an image with the sRGB curve is decoded before and encoded after.

use luxel_geom::srgb::srgb_encode;

/// Linear light of a code value in [0, 1] (IEC 61966-2-1).
pub(crate) fn srgb_decode(code: f32) -> f32 {
    if code <= 0.040_45 { code / 12.92 } else { ((code + 0.055) / 1.055).powf(2.4) }
}

/// The light of each 8-bit code.
pub(crate) fn srgb_table() -> [f32; 256] {
    std::array::from_fn(|code| srgb_decode(code as f32 / 255.0))
}

/// An image of `from` pixels at the smaller size `to`, packed as texels.
pub(crate) fn shrink(pixels: &[[u8; 4]], from: [u32; 2], to: [u32; 2], is_srgb: bool) -> Vec<u32> {
    let curve = if is_srgb { srgb_table() } else { std::array::from_fn(|code| code as f32 / 255.0) };
    let light = |pixel: &[u8; 4]| {
        let [r, g, b, a] = *pixel;
        [curve[usize::from(r)], curve[usize::from(g)], curve[usize::from(b)], f32::from(a) / 255.0]
    };
    shrink_by(pixels, from, to, light).into_iter().map(|mean| pack(mean, is_srgb)).collect()
}

/// An image of `from` pixels at the smaller size `to`: the mean of `light` over what each pixel covers.
pub(crate) fn shrink_by<P, const N: usize>(
    pixels: &[P],
    from: [u32; 2],
    to: [u32; 2],
    light: impl Fn(&P) -> [f32; N],
) -> Vec<[f32; N]> {
    let columns: Vec<Vec<(u32, f32)>> = (0..to[0]).map(|x| shares(x, from[0], to[0])).collect();
    let mut small = Vec::with_capacity(to[0] as usize * to[1] as usize);
    for y in 0..to[1] {
        let rows = shares(y, from[1], to[1]);
        for columns in &columns {
            let mut mean = [0.0; N];
            for (row, share_y) in &rows {
                for (column, share_x) in columns {
                    let place = *row as usize * from[0] as usize + *column as usize;
                    let Some(pixel) = pixels.get(place) else { continue };
                    for (sum, part) in mean.iter_mut().zip(light(pixel)) {
                        *sum += share_x * share_y * part;
                    }
                }
            }
            small.push(mean);
        }
    }
    small
}

/// Which of `from` cells the cell `index` of `to` covers, and with which share of its mean.
fn shares(index: u32, from: u32, to: u32) -> Vec<(u32, f32)> {
    let (index, from, to) = (u64::from(index), u64::from(from), u64::from(to));
    // In units of 1 / to of a cell, so that everything is a whole number.
    let (lo, hi) = (index * from, (index + 1) * from);
    let cells = lo / to..hi.div_ceil(to);
    let share = |cell: u64| ((cell + 1) * to).min(hi) - (cell * to).max(lo);
    cells.map(|cell| (cell as u32, share(cell) as f32 / from as f32)).collect()
}

fn pack(mean: [f32; 4], is_srgb: bool) -> u32 {
    let [r, g, b, a] = mean;
    let curve = |light: f32| if is_srgb { srgb_encode(light) } else { light };
    let code = |value: f32| (value.clamp(0.0, 1.0) * 255.0).round() as u8;
    u32::from_le_bytes([code(curve(r)), code(curve(g)), code(curve(b)), code(a)])
}

#[cfg(test)]
mod tests {
    use super::*;

    fn texels(pixels: &[[u8; 4]]) -> Vec<u32> {
        pixels.iter().map(|pixel| u32::from_le_bytes(*pixel)).collect()
    }

    #[test]
    fn the_curve_has_an_inverse() {
        for code in 0..=255u8 {
            let light = srgb_table()[usize::from(code)];
            assert_eq!((srgb_encode(light) * 255.0).round() as u8, code);
        }
    }

    #[test]
    fn a_mean_of_light_is_brighter_than_one_of_codes() {
        let board = [[0, 0, 0, 0], [255, 255, 255, 255], [255, 255, 255, 255], [0, 0, 0, 0]];
        assert_eq!(shrink(&board, [2, 2], [1, 1], false), texels(&[[128; 4]]));
        assert_eq!(shrink(&board, [2, 2], [1, 1], true), texels(&[[188, 188, 188, 128]]));
    }

    #[test]
    fn what_is_plain_stays_plain_at_odd_sizes() {
        let plain = vec![[10, 200, 30, 77]; 7 * 5];
        assert_eq!(shrink(&plain, [7, 5], [3, 2], true), texels(&[[10, 200, 30, 77]; 6]));
    }

    #[test]
    fn shares_cover_everything_once() {
        for (from, to) in [(7, 3), (8, 4), (5, 1), (9, 4), (6, 6)] {
            let mut covered = vec![0.0; from as usize];
            for index in 0..to {
                let shares = shares(index, from, to);
                assert!((shares.iter().map(|s| s.1).sum::<f32>() - 1.0).abs() < 1e-6);
                shares.iter().for_each(|(cell, share)| covered[*cell as usize] += share);
            }
            let even = to as f32 / from as f32;
            assert!(covered.iter().all(|share| (share - even).abs() < 1e-6), "{from} → {to}: {covered:?}");
        }
    }
}
