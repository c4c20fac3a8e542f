//! The picture of the surroundings among the flat records, halved where memory asks for it.
use std::sync::Arc;

use bevy_ecs::prelude::*;
use luxel_flat::Heap;
use luxel_scene::{Assets, Environment, ImageAsset, ImagePixels};

use crate::TextureBudget;
use crate::journal::{BakeWarning, Journal, Topic};
use crate::resample::{shrink_by, srgb_table};
use crate::store::Heaps;

/// The map that the environment heap holds.
#[derive(Clone)]
struct Placed {
    asset: Arc<ImageAsset>,
    size: [u32; 2],
}

/// What the surroundings are.
#[derive(Resource, Default)]
pub(crate) struct Surroundings {
    map: Option<Placed>,
}

impl Surroundings {
    /// Width and height of the map in texels; `None` if the surroundings are no picture.
    pub(crate) fn size(&self) -> Option<[u32; 2]> {
        self.map.as_ref().map(|map| map.size)
    }
}

/// Brings the environment heap up to date.
pub(crate) fn place_environment(
    environment: Res<Environment>,
    assets: Res<Assets>,
    budget: Res<TextureBudget>,
    mut surroundings: ResMut<Surroundings>,
    mut heaps: ResMut<Heaps>,
    mut journal: Journal,
) {
    let wish = wish(&environment, &assets, budget.bytes);
    let same = match (&wish, &surroundings.map) {
        (Some(new), Some(old)) => Arc::ptr_eq(&new.asset, &old.asset) && new.size == old.size,
        (None, None) => true,
        _ => false,
    };
    if !same {
        let records = wish.as_ref().and_then(records);
        surroundings.map = wish.filter(|_| records.is_some());
        heaps.environment = Heap::from_records(records.unwrap_or_default(), journal.revision());
    }
    let warning = warning(&environment, &surroundings, budget.bytes);
    journal.warning(Entity::PLACEHOLDER, Topic::Environment, warning);
}

/// What the heap is to hold. A map that sheds no light is none.
fn wish(environment: &Environment, assets: &Assets, budget: u64) -> Option<Placed> {
    let Environment::Map { image, strength, .. } = *environment else { return None };
    let asset = Arc::clone(assets.image(image).filter(|_| strength > 0.0)?);
    let mut size = [asset.width, asset.height];
    while bytes(size) > budget && size != [1, 1] {
        size = size.map(|edge| (edge / 2).max(1));
    }
    Some(Placed { asset, size })
}

/// Bytes of the records of a map: its texels, and one for each row.
fn bytes([width, height]: [u32; 2]) -> u64 {
    (u64::from(width) + 1) * u64::from(height) * size_of::<[f32; 4]>() as u64
}

/// The records of a map; `None` if the image is damaged.
fn records(map: &Placed) -> Option<Vec<[f32; 4]>> {
    let from = [map.asset.width, map.asset.height];
    let radiance = match &map.asset.pixels {
        ImagePixels::RgbF32(pixels) if from == map.size => pixels.clone(),
        ImagePixels::RgbF32(pixels) => shrink_by(pixels, from, map.size, |pixel| *pixel),
        ImagePixels::Rgba8(pixels) => {
            let light = srgb_table();
            shrink_by(pixels, from, map.size, |[r, g, b, _]| {
                [*r, *g, *b].map(|code| light[usize::from(code)])
            })
        }
    };
    luxel_geom::environment::table(map.size[0], map.size[1], &radiance)
}

fn warning(environment: &Environment, surroundings: &Surroundings, budget: u64) -> Option<BakeWarning> {
    let Environment::Map { image, strength, .. } = *environment else { return None };
    match &surroundings.map {
        None => (strength > 0.0).then_some(BakeWarning::NoEnvironment { asset: image.0 }),
        Some(Placed { asset, size }) => {
            let from = [asset.width, asset.height];
            (from != *size)
                .then(|| BakeWarning::ShrunkImages { budget, images: vec![(image.0, from, *size)] })
        }
    }
}
