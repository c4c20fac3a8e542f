//! A film as a picture: the path-traced image, or any other output drawn so that an eye can read it.
use luxel_flat::Aov;

use crate::aov::world_position;
use crate::tonemap::{srgb_encode, to_byte};
use crate::{Film, ToneMap, accumulate};

/// What a picture shows of a film.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum View {
    /// The image: exposure, tone map, sRGB.
    #[default]
    PathTraced,
    /// Albedo of the first surface, sRGB.
    Albedo,
    /// Normal of the first surface, −1…1 as 0…255 per axis.
    Normal,
    /// Distance: near is white, far is dark.
    Depth,
    /// Position within the visible box, an axis per channel.
    Position,
    /// A random colour per instance and primitive.
    Ids,
    /// Samples per pixel as heat.
    SampleCount,
    /// Standard error of the pixel as heat.
    Variance,
    /// Work of the camera ray (nodes visited and primitives tested) as heat.
    Steps,
}

impl View {
    /// Every view.
    pub const ALL: &[Self] = &[
        Self::PathTraced,
        Self::Albedo,
        Self::Normal,
        Self::Depth,
        Self::Position,
        Self::Ids,
        Self::SampleCount,
        Self::Variance,
        Self::Steps,
    ];

    /// Name on the command line.
    pub fn name(self) -> &'static str {
        match self {
            Self::PathTraced => "path",
            Self::Albedo => "albedo",
            Self::Normal => "normal",
            Self::Depth => "depth",
            Self::Position => "position",
            Self::Ids => "ids",
            Self::SampleCount => "samples",
            Self::Variance => "variance",
            Self::Steps => "steps",
        }
    }

    /// True if the tracer must have written first-hit outputs ([`Film::aovs`]).
    pub fn needs_first_hits(self) -> bool {
        !matches!(self, Self::PathTraced | Self::SampleCount | Self::Variance)
    }
}

/// How radiance is shown.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Display {
    /// Curve from scene light to display light.
    pub tone_map: ToneMap,
    /// Exposure in stops: each doubles the brightness.
    pub exposure: f32,
}

impl Display {
    /// The radiance that the exposure shows as white: 2^−exposure.
    pub fn white(&self) -> f64 {
        f64::from(-self.exposure).exp2()
    }

    /// Radiance (linear Rec. 709) as an sRGB pixel.
    pub fn encode(&self, radiance: [f32; 3]) -> [u8; 3] {
        let gain = self.exposure.exp2();
        srgb(self.tone_map.apply(radiance.map(|c| c * gain)))
    }

    /// The picture, row by row from the upper left corner; `None` if the view needs first-hit outputs and the
    /// film has none.
    pub fn pixels(&self, film: &Film, view: View) -> Option<Vec<[u8; 3]>> {
        let hits = &if view.needs_first_hits() { film.first_hits()? } else { Vec::new() };
        Some(match view {
            View::PathTraced => film.beauty().into_iter().map(|radiance| self.encode(radiance)).collect(),
            View::Albedo => hits.iter().map(|hit| srgb(ToneMap::None.apply(hit.albedo))).collect(),
            View::Normal => draw_hits(hits, |hit| hit.normal.map(|n| to_byte(0.5 + 0.5 * n))),
            View::Depth => depth(hits),
            View::Position => position(hits, film.anchor),
            View::Ids => draw_hits(hits, id_color),
            View::SampleCount => heat(film.pixels.iter().map(|pixel| pixel.count as f32)),
            View::Variance => {
                heat(film.pixels.iter().map(|pixel| accumulate::variance_of_mean(pixel).sqrt()))
            }
            View::Steps => heat(hits.iter().map(|hit| hit.steps as f32)),
        })
    }
}

fn srgb(light: [f32; 3]) -> [u8; 3] {
    light.map(|c| to_byte(srgb_encode(c)))
}

/// Draws every hit; the sky stays black.
fn draw_hits(hits: &[Aov], color: impl Fn(&Aov) -> [u8; 3]) -> Vec<[u8; 3]> {
    hits.iter().map(|hit| if hit.instance == 0 { [0; 3] } else { color(hit) }).collect()
}

/// Near is white and the farthest hit still tells from the sky.
fn depth(hits: &[Aov]) -> Vec<[u8; 3]> {
    let [near, far] = bounds(hits.iter().filter(|hit| hit.instance != 0).map(|hit| hit.depth));
    draw_hits(hits, |hit| [to_byte(1.0 - 0.9 * place(hit.depth, [near, far])); 3])
}

fn position(hits: &[Aov], anchor: [f64; 3]) -> Vec<[u8; 3]> {
    let visible = || hits.iter().filter(|hit| hit.instance != 0);
    let axes = [0, 1, 2].map(|axis| bounds(visible().map(|hit| world_position(hit, anchor)[axis])));
    draw_hits(hits, |hit| {
        let position = world_position(hit, anchor);
        std::array::from_fn(|axis| to_byte(place(position[axis], axes[axis])))
    })
}

/// Smallest and largest value.
fn bounds(values: impl Iterator<Item = f32>) -> [f32; 2] {
    values.fold([f32::MAX, f32::MIN], |[low, high], value| [low.min(value), high.max(value)])
}

/// Where a value stands between two bounds, in [0, 1]; 0 if they coincide.
fn place(value: f32, [low, high]: [f32; 2]) -> f32 {
    if high > low { ((value - low) / (high - low)).clamp(0.0, 1.0) } else { 0.0 }
}

/// Turbo (A. Mikhailov, 2019) from 0 to the value that 99 % of the pixels do not exceed, so that a few fireflies
/// do not turn everything else dark.
fn heat(values: impl Iterator<Item = f32>) -> Vec<[u8; 3]> {
    let values: Vec<f32> = values.collect();
    let mut sorted = values.clone();
    sorted.sort_unstable_by(f32::total_cmp);
    let top = sorted.get((sorted.len() * 99).div_ceil(100).saturating_sub(1)).copied().unwrap_or(0.0);
    values
        .iter()
        .map(|value| colorous::TURBO.eval_continuous(place(*value, [0.0, top]).into()).as_array())
        .collect()
}

/// A colour that neighbouring ids do not share: three bytes of a mixed hash, none of them dark.
fn id_color(hit: &Aov) -> [u8; 3] {
    let mixed = luxel_geom::rng::pcg4d([hit.instance, hit.primitive, 0, 0]);
    [mixed[0], mixed[1], mixed[2]].map(|word| 64 + (word >> 24) as u8 / 4 * 3)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn film(hits: Vec<Aov>) -> Film {
        let mut film = Film::new(hits.len() as u32, 1);
        film.aovs = Some(hits);
        film
    }

    fn hit(instance: u32, depth: f32) -> Aov {
        Aov { instance, depth, ..Aov::default() }
    }

    fn show(film: &Film, view: View) -> Vec<[u8; 3]> {
        Display::default().pixels(film, view).unwrap()
    }

    #[test]
    fn exposure_doubles_per_stop_and_moves_white() {
        let one_stop = Display { exposure: 1.0, ..Display::default() };
        assert_eq!(one_stop.white(), 0.5);
        assert_eq!(one_stop.encode([0.25; 3]), Display::default().encode([0.5; 3]));
        assert_eq!(one_stop.encode([0.5; 3]), [255; 3]);
        let absurd = Display { exposure: 1e6, tone_map: ToneMap::AgX };
        assert_eq!(absurd.encode([0.0; 3])[0], absurd.encode([0.0; 3])[2]);
    }

    #[test]
    fn normals_are_centred_and_the_sky_is_black() {
        let up = Aov { normal: [0.0, 1.0, 0.0], ..hit(1, 1.0) };
        assert_eq!(show(&film(vec![up, Aov::default()]), View::Normal), [[128, 255, 128], [0; 3]]);
    }

    #[test]
    fn near_is_lighter_than_far_and_far_lighter_than_the_sky() {
        let grey: Vec<u8> =
            show(&film(vec![hit(1, 2.0), hit(1, 3.0), hit(1, 10.0), hit(0, 0.0)]), View::Depth)
                .into_iter()
                .map(|[r, ..]| r)
                .collect();
        assert!(grey[0] == 255 && grey[0] > grey[1] && grey[1] > grey[2] && grey[2] > grey[3], "{grey:?}");
    }

    #[test]
    fn positions_span_the_visible_box() {
        let at = |position| Aov { position, ..hit(1, 1.0) };
        let picture =
            show(&film(vec![at([0.0; 3]), at([2.0, 4.0, 0.0]), at([1.0, 1.0, 0.0])]), View::Position);
        assert_eq!(picture, [[0, 0, 0], [255, 255, 0], [128, 64, 0]]);
    }

    #[test]
    fn ids_get_colours_that_differ() {
        let hits: Vec<Aov> = (1..200).map(|instance| hit(instance, 1.0)).collect();
        let colors = show(&film(hits), View::Ids);
        let distinct: std::collections::HashSet<_> = colors.iter().collect();
        assert!(distinct.len() > 190 && colors.iter().flatten().all(|c| *c >= 64));
    }

    #[test]
    fn heat_rises_with_the_value_and_ignores_a_firefly() {
        let mut hits: Vec<Aov> = (0..200).map(|steps| Aov { steps, ..Aov::default() }).collect();
        hits.push(Aov { steps: 1_000_000, ..Aov::default() });
        let picture = show(&film(hits), View::Steps);
        let ends = [0.0, 1.0].map(|t| colorous::TURBO.eval_continuous(t).as_array());
        assert_eq!([picture[0], picture[200]], ends);
        assert_ne!(picture[50], picture[150]);
    }

    #[test]
    fn every_view_draws_every_pixel_and_survives_odd_values() {
        let odd = Aov {
            normal: [f32::NAN; 3],
            depth: f32::NAN,
            position: [f32::NAN; 3],
            albedo: [f32::NAN; 3],
            ..hit(1, 0.0)
        };
        for hits in [vec![], vec![Aov::default()], vec![odd; 3]] {
            let film = film(hits);
            for view in View::ALL {
                assert_eq!(show(&film, *view).len(), film.pixels.len(), "{view:?}");
                let bare = Film { aovs: None, ..film.clone() };
                assert_eq!(Display::default().pixels(&bare, *view).is_none(), view.needs_first_hits());
            }
        }
    }
}
