//! EXR: linear radiance and any first-hit outputs, as channels of one layer.
//!
//! One part with channels named `albedo.R`, `N.X`, … is what compositing programs take for layers. Colour is
//! half or float as asked; lengths and statistics are always float, counts and ids always integers.
use std::fs::File;
use std::io::{BufWriter, Write};
use std::path::Path;

use exr::prelude::{
    AnyChannel, AnyChannels, AttributeValue, Encoding, Error, FlatSamples, Image, LayerAttributes, SmallVec,
    Text, WritableImage, f16,
};
use luxel_film::aov::{LayerValues, beauty_layers};
use luxel_film::{AovKind, Film, Layer};

use super::atomic::write_atomically;
use super::{Metadata, OutputError};

/// How colours are kept.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Precision {
    /// 16 bits: three significant digits, up to 65504; brighter values are clipped to that.
    #[default]
    Half,
    /// 32 bits: as the film has them.
    Float,
}

/// Writes the mean radiance and the outputs asked for as EXR.
///
/// # Errors
/// See [`OutputError`]. An output that needs first hits cannot be written from a film without them.
pub fn write_exr(
    path: &Path,
    film: &Film,
    kinds: &[AovKind],
    precision: Precision,
    metadata: &Metadata,
) -> Result<(), OutputError> {
    let refuse = |message: String| OutputError::Encode { path: path.to_owned(), message };
    let mut layers = beauty_layers(film);
    for kind in kinds {
        let missing =
            || refuse(format!("first hits were not traced, so there is no {} to write", kind.name()));
        layers.extend(kind.layers(film).ok_or_else(missing)?);
    }
    let pixel_count = film.width as usize * film.height as usize;
    if pixel_count == 0 || layers.iter().any(|layer| len(&layer.values) != pixel_count) {
        return Err(refuse("the film has no pixels, or not as many as its size says".to_owned()));
    }
    write_atomically(path, |file| {
        encode(file, film, layers, precision, metadata).map_err(|error| match error {
            Error::Io(source) => OutputError::Io { path: path.to_owned(), source },
            other => refuse(other.to_string()),
        })
    })
}

fn encode(
    file: &mut File,
    film: &Film,
    layers: Vec<Layer>,
    precision: Precision,
    metadata: &Metadata,
) -> Result<(), Error> {
    let channels: SmallVec<_> = layers
        .into_iter()
        .map(|layer| AnyChannel::new(layer.name, samples(layer.values, precision)))
        .collect();
    let size = (film.width as usize, film.height as usize);
    let layer = exr::prelude::Layer::new(
        size,
        attributes(metadata),
        Encoding::SMALL_LOSSLESS,
        AnyChannels::sort(channels),
    );
    let mut out = BufWriter::new(file);
    Image::from_layer(layer).write().to_buffered(&mut out)?;
    Ok(out.flush()?)
}

fn attributes(metadata: &Metadata) -> LayerAttributes {
    let mut attributes =
        LayerAttributes { software_name: Some(text(Metadata::SOFTWARE)), ..Default::default() };
    for (key, value) in metadata.entries() {
        attributes.other.insert(text(key), AttributeValue::Text(text(&value)));
    }
    attributes
}

/// UTF-8 as it is; the crate's own conversion refuses everything beyond Latin-1.
fn text(utf8: &str) -> Text {
    Text::from_slice_unchecked(utf8.as_bytes())
}

fn samples(values: LayerValues, precision: Precision) -> FlatSamples {
    match (values, precision) {
        (LayerValues::Color(values), Precision::Half) => {
            FlatSamples::F16(values.into_iter().map(half).collect())
        }
        (LayerValues::Color(values) | LayerValues::Float(values), _) => FlatSamples::F32(values),
        (LayerValues::Integer(values), _) => FlatSamples::U32(values),
    }
}

fn half(value: f32) -> f16 {
    f16::from_f32(value.clamp(f16::MIN.to_f32(), f16::MAX.to_f32()))
}

fn len(values: &LayerValues) -> usize {
    match values {
        LayerValues::Color(values) | LayerValues::Float(values) => values.len(),
        LayerValues::Integer(values) => values.len(),
    }
}

#[cfg(test)]
mod tests {
    use exr::prelude::{ReadChannels, ReadLayers, read_first_flat_layer_from_file};
    use luxel_film::accumulate::add_sample;
    use luxel_flat::Aov;

    use super::super::metadata::example;
    use super::*;

    fn film() -> Film {
        let mut film = Film::new(5, 3);
        for (i, pixel) in film.pixels.iter_mut().enumerate() {
            add_sample(pixel, [i as f32 * 0.37, 1e5, 0.1]);
        }
        let hit = |i: u8| Aov {
            instance: 70_000 + u32::from(i),
            depth: 0.1 * f32::from(i),
            normal: [0.0, 0.6, 0.8],
            ..Aov::default()
        };
        film.aovs = Some((0..15).map(hit).collect());
        film
    }

    /// Writes the film and reads one channel back as f32.
    fn round_trip(precision: Precision, name: &str) -> Vec<f32> {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.exr");
        write_exr(&path, &film(), AovKind::ALL, precision, &example()).unwrap();
        let read = read_first_flat_layer_from_file(&path).unwrap();
        assert_eq!((read.layer_data.size.0, read.layer_data.size.1), (5, 3));
        let channels = read.layer_data.channel_data.list;
        assert_eq!(channels.len(), 3 + 3 + 3 + 1 + 3 + 2 + 1 + 1);
        let channel = channels.iter().find(|channel| channel.name.eq(name)).unwrap();
        channel.sample_data.values_as_f32().collect()
    }

    #[test]
    fn float_colours_come_back_bit_for_bit() {
        let beauty = film().beauty();
        assert_eq!(round_trip(Precision::Float, "R"), beauty.iter().map(|c| c[0]).collect::<Vec<_>>());
        assert_eq!(round_trip(Precision::Float, "G"), [1e5; 15]);
    }

    #[test]
    fn half_colours_come_back_rounded_and_never_infinite() {
        for (read, meant) in round_trip(Precision::Half, "R").iter().zip(film().beauty()) {
            assert!((read - meant[0]).abs() <= meant[0] * 2.0_f32.powi(-11));
        }
        assert_eq!(round_trip(Precision::Half, "G"), [65504.0; 15]);
    }

    #[test]
    fn lengths_and_ids_stay_exact_beside_half_colours() {
        let depths: Vec<f32> = (0..15_u8).map(|i| 0.1 * f32::from(i)).collect();
        assert_eq!(round_trip(Precision::Half, "Z"), depths);
        assert_eq!(round_trip(Precision::Half, "id.instance")[14], 70_014.0);
        assert_eq!(round_trip(Precision::Half, "N.Z"), [0.8; 15]);
        assert_eq!(round_trip(Precision::Half, "samples"), [1.0; 15]);
    }

    #[test]
    fn the_metadata_is_found_in_the_file() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.exr");
        write_exr(&path, &film(), &[], Precision::Half, &example()).unwrap();
        let reader = exr::prelude::read().no_deep_data().largest_resolution_level().all_channels();
        let read = reader.first_valid_layer().all_attributes().from_file(&path).unwrap();
        let attributes = read.layer_data.attributes;
        assert_eq!(attributes.software_name, Some(text(Metadata::SOFTWARE)));
        for (key, value) in example().entries() {
            assert_eq!(attributes.other.get(&text(key)), Some(&AttributeValue::Text(text(&value))), "{key}");
        }
    }

    #[test]
    fn what_the_film_lacks_is_one_clear_error_and_no_file() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.exr");
        let write =
            |film: &Film, kinds: &[AovKind]| write_exr(&path, film, kinds, Precision::Half, &example());

        let bare = Film { aovs: None, ..film() };
        write(&bare, &[AovKind::SampleCount]).unwrap();
        std::fs::remove_file(&path).unwrap();
        let error = write(&bare, &[AovKind::Normal]).unwrap_err().to_string();
        assert!(
            error.ends_with("a.exr: first hits were not traced, so there is no normal to write"),
            "{error}"
        );

        let torn = Film { height: 4, ..film() };
        for bad in [torn, Film::new(0, 7)] {
            assert!(matches!(write(&bad, &[]), Err(OutputError::Encode { .. })));
        }
        assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 0);
    }

    #[test]
    fn a_missing_folder_is_named() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("none/a.exr");
        let error = write_exr(&path, &film(), &[], Precision::Half, &example()).unwrap_err();
        assert!(matches!(error, OutputError::NoFolder { .. }), "{error}");
    }
}
