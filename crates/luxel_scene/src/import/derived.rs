//! Pictures made of others: colours with the opacity of a mask, and normal maps of heights.

use image::RgbaImage;
use image::imageops::{FilterType, resize};

use crate::assets::ImagePixels;

use super::image::Decoded;

/// How many texels white stands above black in a picture of heights. No file says; `-bm` in an .mtl file is a factor
/// on it, and becomes one on the x and y of the normals.
const HEIGHT: f32 = 4.0;

/// The most bytes of a picture that another is made of: 256 MiB, 8192 x 8192 pixels. To fit two of them to one size takes
/// four times as much.
pub(super) const MAX_INPUT_BYTES: u64 = 256 << 20;

/// The colours of one picture (white without) with the opacity of another, as large as the one with more pixels.
///
/// A mask says opacity by its alpha channel if that is not opaque all over, and else by its luminance.
///
/// # Errors
/// What is wrong, as the end of a sentence that begins with the picture's name.
pub(super) fn masked(color: Option<Decoded>, mask: Decoded) -> Result<Decoded, String> {
    let mut mask = Picture::of(mask)?;
    let by_alpha = mask.texels.iter().any(|texel| texel[3] < u8::MAX);
    for texel in &mut mask.texels {
        let opacity = if by_alpha { texel[3] } else { luminance(*texel).round() as u8 };
        *texel = [u8::MAX, u8::MAX, u8::MAX, opacity];
    }
    let Some(color) = color else { return Ok(mask.into_decoded()) };
    let (mut color, mask) = same_size(Picture::of(color)?, mask);
    for (texel, mask) in color.texels.iter_mut().zip(&mask.texels) {
        texel[3] = mask[3];
    }
    Ok(color.into_decoded())
}

/// The normal map of a picture whose luminance is heights, from central differences; it goes on beyond its edges with
/// itself.
///
/// # Errors
/// As [`masked`].
pub(super) fn normals(heights: Decoded) -> Result<Decoded, String> {
    let picture = Picture::of(heights)?;
    let (width, height) = (picture.width, picture.height);
    let at = |x: u32, y: u32| luminance(picture.texel(x % width, y % height)) * (HEIGHT / 255.0);
    let texel = |x: u32, y: u32| {
        let along = (at(x + 1, y) - at(x + width - 1, y)) * 0.5;
        let down = (at(x, y + 1) - at(x, y + height - 1)) * 0.5;
        // A normal map's y runs up the picture.
        let normal = glam::Vec3::new(-along, down, 1.0).normalize();
        let [r, g, b] = normal.to_array().map(|n| (127.5 + 127.5 * n).round() as u8);
        [r, g, b, u8::MAX]
    };
    let mut texels = Vec::with_capacity(picture.texels.len());
    texels.extend((0..height).flat_map(|y| (0..width).map(move |x| (x, y))).map(|(x, y)| texel(x, y)));
    Ok(Picture { width, height, texels }.into_decoded())
}

/// Rec. 709's luminance of the codes, 0 to 255.
fn luminance([r, g, b, _]: [u8; 4]) -> f32 {
    0.2126 * f32::from(r) + 0.7152 * f32::from(g) + 0.0722 * f32::from(b)
}

/// Both as large as the one with more pixels: no picture becomes larger than one that was there.
fn same_size(a: Picture, b: Picture) -> (Picture, Picture) {
    let larger = if a.texels.len() >= b.texels.len() { &a } else { &b };
    let (width, height) = (larger.width, larger.height);
    (a.fit(width, height), b.fit(width, height))
}

/// A picture of 8 bits per channel, `width · height` texels.
struct Picture {
    width: u32,
    height: u32,
    texels: Vec<[u8; 4]>,
}

impl Picture {
    fn of(decoded: Decoded) -> Result<Self, String> {
        let (width, height) = (decoded.width, decoded.height);
        match decoded.pixels {
            ImagePixels::Rgba8(texels) => Ok(Self { width, height, texels }),
            ImagePixels::RgbF32(_) => Err("holds radiance, and a texture has 8 bits".to_owned()),
        }
    }

    fn texel(&self, x: u32, y: u32) -> [u8; 4] {
        let index = y as usize * self.width as usize + x as usize;
        self.texels.get(index).copied().unwrap_or_default()
    }

    fn fit(self, width: u32, height: u32) -> Self {
        if (self.width, self.height) == (width, height) {
            return self;
        }
        let from = RgbaImage::from_raw(self.width, self.height, self.texels.into_flattened());
        let fitted = resize(&from.unwrap_or_default(), width, height, FilterType::Triangle);
        Self { width, height, texels: fitted.as_raw().as_chunks().0.to_vec() }
    }

    fn into_decoded(self) -> Decoded {
        let Self { width, height, texels } = self;
        Decoded { width, height, pixels: ImagePixels::Rgba8(texels), mended: 0 }
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used, clippy::indexing_slicing)]
mod tests {
    use super::*;

    fn picture(width: u32, height: u32, pixel: impl Fn(u32, u32) -> [u8; 4]) -> Decoded {
        let texels = (0..height).flat_map(|y| (0..width).map(move |x| (x, y))).map(|(x, y)| pixel(x, y));
        Picture { width, height, texels: texels.collect() }.into_decoded()
    }

    fn rgba(picture: &Decoded) -> &[[u8; 4]] {
        let ImagePixels::Rgba8(pixels) = &picture.pixels else { panic!("8 bits") };
        pixels
    }

    #[test]
    fn a_mask_is_its_alpha_or_else_its_luminance() {
        let colors = || picture(2, 1, |x, _| [10 + x as u8, 20, 30, 255]);
        let grey = picture(2, 1, |x, _| [if x == 0 { 40 } else { 200 }; 4].map(|v| v)).pixels;
        let grey = Decoded { width: 2, height: 1, pixels: grey, mended: 0 };
        let alpha = masked(Some(colors()), grey).unwrap();
        assert_eq!(rgba(&alpha), [[10, 20, 30, 40], [11, 20, 30, 200]]);
        let opaque = picture(2, 1, |x, _| if x == 0 { [0, 0, 0, 255] } else { [255, 255, 255, 255] });
        assert_eq!(rgba(&masked(Some(colors()), opaque).unwrap()), [[10, 20, 30, 0], [11, 20, 30, 255]]);
        let green = picture(1, 1, |_, _| [0, 255, 0, 255]);
        assert_eq!(rgba(&masked(None, green).unwrap()), [[255, 255, 255, 182]]);
    }

    #[test]
    fn of_two_sizes_the_one_with_more_pixels_stays() {
        let wide = || picture(64, 1, |x, _| [4 * x as u8, 7, 7, 255]);
        let tall = || picture(1, 32, |_, y| [8 * y as u8, 0, 0, 8 * y as u8]);
        let both = masked(Some(wide()), tall()).unwrap();
        assert_eq!((both.width, both.height), (64, 1));
        assert!(rgba(&both).iter().enumerate().all(|(x, p)| p[0] == 4 * x as u8 && p[3].abs_diff(124) <= 2));
        let small = masked(Some(picture(1, 1, |_, _| [9, 8, 7, 255])), wide()).unwrap();
        assert_eq!(small.width, 64);
        assert!(rgba(&small).iter().all(|p| p[..3] == [9, 8, 7]));
        let radiance =
            || Decoded { width: 1, height: 1, pixels: ImagePixels::RgbF32(vec![[1.0; 3]]), mended: 0 };
        assert!(masked(Some(radiance()), wide()).is_err() && normals(radiance()).is_err());
    }

    #[test]
    fn normals_lean_away_from_what_is_high_and_wrap() {
        // A ramp of 10 codes per texel to the right: the normal leans to the left by HEIGHT · 10 / 255 texels.
        let ramp = normals(picture(16, 4, |x, _| [10 * x as u8; 4])).unwrap();
        let slope = HEIGHT * 10.0 / 255.0;
        let expected = glam::Vec3::new(-slope, 0.0, 1.0).normalize();
        let normal = |p: [u8; 4]| glam::Vec3::new(p[0].into(), p[1].into(), p[2].into()) / 127.5 - 1.0;
        assert!((normal(rgba(&ramp)[5]) - expected).length() < 0.01);
        // Beyond the right edge it begins again, 150 codes lower.
        let fall = HEIGHT * (140.0 / 2.0) / 255.0;
        let expected = glam::Vec3::new(fall, 0.0, 1.0).normalize();
        assert!((normal(rgba(&ramp)[15]) - expected).length() < 0.01);
        // Upwards in the picture: y grows, so above a peak the normal leans up.
        let peak = normals(picture(3, 3, |x, y| [if (x, y) == (1, 1) { 255 } else { 0 }; 4])).unwrap();
        assert!(rgba(&peak)[1][1] > 200 && rgba(&peak)[7][1] < 55, "{:?}", rgba(&peak));
        assert!(rgba(&peak)[3][0] < 55 && rgba(&peak)[5][0] > 200);
        assert_eq!(rgba(&normals(picture(1, 1, |_, _| [77; 4])).unwrap()), [[128, 128, 255, 255]]);
    }
}
