//! First-hit outputs and film statistics as named channels of an EXR file.
//!
//! Names are those that other programs read: `albedo.R`, `N.X`, `Z`, `P.X`, `id.instance`, `samples`, … Where
//! the camera ray left the scene, everything is 0.
use luxel_flat::{Aov, FilmPixel};

use crate::{Film, accumulate};

/// An output beside the picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum AovKind {
    /// Albedo of the first surface.
    Albedo,
    /// Unit shading normal of the first surface, world axes.
    Normal,
    /// Distance of the first surface from the camera, metres.
    Depth,
    /// First hit point, world space, metres.
    Position,
    /// Stable ids of the instance (plus one) and of the primitive.
    Ids,
    /// Samples per pixel, dropped ones included.
    SampleCount,
    /// Variance of the mean luminance.
    Variance,
}

/// A channel of a file.
#[derive(Clone, Debug, PartialEq)]
pub struct Layer {
    /// Name of the channel.
    pub name: &'static str,
    /// One value per pixel, row by row from the upper left corner.
    pub values: LayerValues,
}

/// Values of a channel, by what they must keep.
#[derive(Clone, Debug, PartialEq)]
pub enum LayerValues {
    /// Colour: half precision is enough.
    Color(Vec<f32>),
    /// Lengths and statistics: need full precision.
    Float(Vec<f32>),
    /// Counts and ids: exact.
    Integer(Vec<u32>),
}

impl AovKind {
    /// Every kind.
    pub const ALL: &[Self] = &[
        Self::Albedo,
        Self::Normal,
        Self::Depth,
        Self::Position,
        Self::Ids,
        Self::SampleCount,
        Self::Variance,
    ];

    /// Name on the command line.
    pub fn name(self) -> &'static str {
        match self {
            Self::Albedo => "albedo",
            Self::Normal => "normal",
            Self::Depth => "depth",
            Self::Position => "position",
            Self::Ids => "ids",
            Self::SampleCount => "samples",
            Self::Variance => "variance",
        }
    }

    /// True if the tracer must have written first-hit outputs ([`Film::aovs`]).
    pub fn needs_first_hits(self) -> bool {
        !matches!(self, Self::SampleCount | Self::Variance)
    }

    /// The channels; `None` if they need first-hit outputs and the film has none.
    pub fn layers(self, film: &Film) -> Option<Vec<Layer>> {
        let hits = &if self.needs_first_hits() { film.first_hits()? } else { Vec::new() };
        let anchor = film.anchor;
        Some(match self {
            Self::Albedo => vec![
                color("albedo.R", hits, |hit| hit.albedo[0]),
                color("albedo.G", hits, |hit| hit.albedo[1]),
                color("albedo.B", hits, |hit| hit.albedo[2]),
            ],
            Self::Normal => vec![
                float("N.X", hits, |hit| hit.normal[0]),
                float("N.Y", hits, |hit| hit.normal[1]),
                float("N.Z", hits, |hit| hit.normal[2]),
            ],
            Self::Depth => vec![float("Z", hits, |hit| hit.depth)],
            Self::Position => vec![
                float("P.X", hits, |hit| world_position(hit, anchor)[0]),
                float("P.Y", hits, |hit| world_position(hit, anchor)[1]),
                float("P.Z", hits, |hit| world_position(hit, anchor)[2]),
            ],
            Self::Ids => vec![
                integer("id.instance", hits, |hit| hit.instance),
                integer("id.primitive", hits, |hit| hit.primitive),
            ],
            Self::SampleCount => vec![integer("samples", &film.pixels, |pixel: &FilmPixel| pixel.count)],
            Self::Variance => vec![float("variance", &film.pixels, accumulate::variance_of_mean)],
        })
    }
}

/// The picture itself as the channels `R`, `G` and `B`: linear radiance.
pub fn beauty_layers(film: &Film) -> Vec<Layer> {
    let beauty = film.beauty();
    vec![color("R", &beauty, |c| c[0]), color("G", &beauty, |c| c[1]), color("B", &beauty, |c| c[2])]
}

/// The hit point in world space, rounded once from f64; 0 where nothing was hit.
pub fn world_position(hit: &Aov, anchor: [f64; 3]) -> [f32; 3] {
    if hit.instance == 0 {
        return [0.0; 3];
    }
    std::array::from_fn(|i| (f64::from(hit.position[i]) + anchor[i]) as f32)
}

fn color<T>(name: &'static str, of: &[T], value: impl Fn(&T) -> f32) -> Layer {
    Layer { name, values: LayerValues::Color(of.iter().map(value).collect()) }
}

fn float<T>(name: &'static str, of: &[T], value: impl Fn(&T) -> f32) -> Layer {
    Layer { name, values: LayerValues::Float(of.iter().map(value).collect()) }
}

fn integer<T>(name: &'static str, of: &[T], value: impl Fn(&T) -> u32) -> Layer {
    Layer { name, values: LayerValues::Integer(of.iter().map(value).collect()) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn layers_hold_what_the_film_holds() {
        let mut film = Film::new(2, 1);
        let hit = Aov {
            albedo: [0.1, 0.2, 0.3],
            depth: 4.0,
            instance: 5,
            primitive: 6,
            position: [1.0, 2.0, 3.0],
            ..Aov::default()
        };
        film.aovs = Some(vec![hit, Aov::default()]);
        film.anchor = [1000.0, 0.0, 0.0];
        accumulate::add_sample(&mut film.pixels[1], [1.0; 3]);

        let named = |kind: AovKind, name| {
            let layers = kind.layers(&film).unwrap();
            layers.into_iter().find(|layer| layer.name == name).unwrap().values
        };
        assert_eq!(named(AovKind::Albedo, "albedo.G"), LayerValues::Color(vec![0.2, 0.0]));
        assert_eq!(named(AovKind::Depth, "Z"), LayerValues::Float(vec![4.0, 0.0]));
        assert_eq!(named(AovKind::Position, "P.X"), LayerValues::Float(vec![1001.0, 0.0]));
        assert_eq!(named(AovKind::Ids, "id.instance"), LayerValues::Integer(vec![5, 0]));
        assert_eq!(named(AovKind::Ids, "id.primitive"), LayerValues::Integer(vec![6, 0]));
        assert_eq!(named(AovKind::SampleCount, "samples"), LayerValues::Integer(vec![0, 1]));
        assert_eq!(beauty_layers(&film)[0].values, LayerValues::Color(vec![0.0, 1.0]));
    }

    #[test]
    fn only_first_hit_outputs_can_be_missing() {
        let film = Film::new(3, 2);
        for kind in AovKind::ALL {
            assert_eq!(kind.layers(&film).is_none(), kind.needs_first_hits(), "{kind:?}");
        }
    }

    #[test]
    fn every_channel_has_its_own_name_and_one_value_per_pixel() {
        let mut film = Film::new(3, 2);
        film.aovs = Some(vec![Aov::default(); 6]);
        let mut names = std::collections::HashSet::new();
        for layer in beauty_layers(&film)
            .into_iter()
            .chain(AovKind::ALL.iter().flat_map(|kind| kind.layers(&film).unwrap()))
        {
            let count = match &layer.values {
                LayerValues::Color(values) | LayerValues::Float(values) => values.len(),
                LayerValues::Integer(values) => values.len(),
            };
            assert_eq!(count, 6, "{}", layer.name);
            assert!(names.insert(layer.name), "{} stands twice", layer.name);
        }
    }
}
