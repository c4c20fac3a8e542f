//! Images that textures show, each once among the texels, halved where memory asks for it.
//!
//! How large an image is placed is a function of the images in use and the [`TextureBudget`] alone, so that an edited
//! world has the texels of a fresh one.
use std::cmp::Reverse;
use std::collections::{BTreeMap, BinaryHeap};
use std::sync::Arc;

use bevy_ecs::prelude::*;
use luxel_flat::Span;
use luxel_scene::{AssetId, Assets, ImageAsset, ImagePixels};

use crate::BakeError;
use crate::journal::{BakeWarning, Journal, Topic};
use crate::resample::shrink;
use crate::store::Heaps;
use crate::users::Users;

/// Largest edge of an image among the texels: `TextureSlot::size` has 16 bits for it.
const MAX_EDGE: u32 = u16::MAX as u32;

/// How much memory the texels of all textures may take, and likewise those of the environment.
#[derive(Resource, Clone, Copy, Debug, PartialEq, Eq)]
pub struct TextureBudget {
    /// Bytes. Whoever binds the texels to a GPU sets this to the largest binding of its adapter.
    pub bytes: u64,
}

impl Default for TextureBudget {
    /// 4 GiB: as many as 32-bit indices of texels with four bytes reach, by a quarter.
    fn default() -> Self {
        Self { bytes: 1 << 32 }
    }
}

/// How an image is to be placed.
#[derive(Clone, Debug)]
struct Plan {
    asset: Arc<ImageAsset>,
    /// How often its edges are halved.
    halvings: u32,
    /// Whether halving mixes colours by the sRGB curve.
    is_srgb: bool,
}

impl Plan {
    /// Width and height in texels.
    fn size(&self) -> [u32; 2] {
        [self.asset.width, self.asset.height].map(|edge| (edge >> self.halvings).max(1))
    }

    fn bytes(&self) -> u64 {
        let [width, height] = self.size();
        4 * u64::from(width) * u64::from(height)
    }

    /// True if both lead to the same texels.
    fn agrees(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.asset, &other.asset)
            && self.halvings == other.halvings
            && (self.halvings == 0 || self.is_srgb == other.is_srgb)
    }

    fn texels(&self) -> Vec<u32> {
        let ImagePixels::Rgba8(pixels) = &self.asset.pixels else { return Vec::new() };
        if self.halvings == 0 {
            return pixels.iter().map(|pixel| u32::from_le_bytes(*pixel)).collect();
        }
        shrink(pixels, [self.asset.width, self.asset.height], self.size(), self.is_srgb)
    }
}

/// An image among the texels.
#[derive(Clone, Debug)]
pub(crate) struct PlacedImage {
    plan: Plan,
    span: Span,
    /// The smallest opacity of its texels.
    pub min_alpha: u8,
}

impl PlacedImage {
    /// Width and height in texels.
    pub(crate) fn size(&self) -> [u32; 2] {
        self.plan.size()
    }

    /// Width and height of the image itself.
    pub(crate) fn original_size(&self) -> [u32; 2] {
        [self.plan.asset.width, self.plan.asset.height]
    }

    /// The first texel.
    pub(crate) fn first(&self) -> u32 {
        self.span.first
    }
}

/// The images in use.
#[derive(Resource, Default)]
pub(crate) struct Images {
    /// Which entity uses which images, and whether as sRGB. Only images that [`is_usable`] says yes to.
    pub users: Users<(AssetId, bool)>,
    placed: BTreeMap<AssetId, PlacedImage>,
    /// True if the last run placed an image: slots that show one may have to follow.
    pub has_moved: bool,
}

impl Images {
    /// An image, if it is in use.
    pub(crate) fn get(&self, id: AssetId) -> Option<&PlacedImage> {
        self.placed.get(&id)
    }

    /// Every image among the texels, by rising id.
    pub(crate) fn iter(&self) -> impl Iterator<Item = (AssetId, &PlacedImage)> {
        self.placed.iter().map(|(id, image)| (*id, image))
    }

    /// How the images in use are to be placed within a budget.
    fn plans(&self, assets: &Assets, budget: &TextureBudget) -> BTreeMap<AssetId, Plan> {
        let mut plans = BTreeMap::<AssetId, Plan>::new();
        for (id, is_srgb) in self.users.keys() {
            let Some(asset) = assets.image(id) else { continue };
            let halvings = (0..32).find(|n| asset.width.max(asset.height) >> n <= MAX_EDGE).unwrap_or(0);
            let plan = Plan { asset: Arc::clone(asset), halvings, is_srgb };
            plans.entry(id).or_insert(plan).is_srgb |= is_srgb;
        }
        halve_to_fit(&mut plans, budget.bytes);
        plans
    }

    /// Takes away what is not as planned.
    fn release(&mut self, plans: &BTreeMap<AssetId, Plan>, heaps: &mut Heaps, journal: &mut Journal) {
        let is_planned =
            |id: &AssetId, image: &PlacedImage| plans.get(id).is_some_and(|p| p.agrees(&image.plan));
        for (_, image) in self.placed.extract_if(.., |id, image| !is_planned(id, image)) {
            heaps.texels.release(image.span, journal.revision());
            journal.counters.images_released += 1;
        }
    }

    /// Places what is planned and not there.
    fn place(
        &mut self,
        plans: &BTreeMap<AssetId, Plan>,
        heaps: &mut Heaps,
        journal: &mut Journal,
    ) -> Result<(), BakeError> {
        for (id, plan) in plans {
            if self.placed.contains_key(id) {
                continue;
            }
            let texels = plan.texels();
            let span = heaps.texels.place(&texels, journal.revision())?;
            let min_alpha = texels.iter().map(|texel| (texel >> 24) as u8).min().unwrap_or(u8::MAX);
            self.placed.insert(*id, PlacedImage { plan: plan.clone(), span, min_alpha });
            self.has_moved = true;
            journal.counters.images_placed += 1;
        }
        Ok(())
    }
}

/// True if an image can be a texture: colours of 8 bits.
pub(crate) fn is_usable(image: &ImageAsset) -> bool {
    matches!(image.pixels, ImagePixels::Rgba8(_))
}

/// Halves the largest image (of equals the one of the smallest id) until all fit, or none can be halved.
fn halve_to_fit(plans: &mut BTreeMap<AssetId, Plan>, budget: u64) {
    let mut total: u64 = plans.values().map(Plan::bytes).sum();
    let mut largest: BinaryHeap<(u64, Reverse<AssetId>)> =
        plans.iter().map(|(id, plan)| (plan.bytes(), Reverse(*id))).collect();
    while total > budget
        && let Some((bytes, Reverse(id))) = largest.pop()
        && let Some(plan) = plans.get_mut(&id)
        && plan.size() != [1, 1]
    {
        plan.halvings += 1;
        total -= bytes - plan.bytes();
        largest.push((plan.bytes(), Reverse(id)));
    }
}

/// Brings the texels up to date with the images in use.
pub(crate) fn place_images(
    assets: Res<Assets>,
    budget: Res<TextureBudget>,
    mut images: ResMut<Images>,
    mut heaps: ResMut<Heaps>,
    mut journal: Journal,
) {
    images.has_moved = false;
    let plans = images.plans(&assets, &budget);
    images.release(&plans, &mut heaps, &mut journal);
    let mut outcome = images.place(&plans, &mut heaps, &mut journal);
    if outcome.is_err() || heaps.texels.heap.bytes() as u64 > budget.bytes {
        // Holes between the images: without them they fit.
        images.release(&BTreeMap::new(), &mut heaps, &mut journal);
        outcome = images.place(&plans, &mut heaps, &mut journal);
    }
    journal.error(Entity::PLACEHOLDER, Topic::Texels, outcome.err());
    let shrunk: Vec<_> = (plans.iter())
        .filter(|(_, plan)| plan.halvings > 0)
        .map(|(id, plan)| (id.0, [plan.asset.width, plan.asset.height], plan.size()))
        .collect();
    let warning =
        (!shrunk.is_empty()).then(|| BakeWarning::ShrunkImages { budget: budget.bytes, images: shrunk });
    journal.warning(Entity::PLACEHOLDER, Topic::Texels, warning);
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;
    use luxel_scene::ImageSource;

    fn plan(width: u32, height: u32) -> Plan {
        let source = ImageSource::Checker { squares: 1, a: [0; 3], b: [0; 3] };
        let asset = ImageAsset { source, width, height, pixels: ImagePixels::Rgba8(Vec::new()) };
        Plan { asset: Arc::new(asset), halvings: 0, is_srgb: true }
    }

    #[test]
    fn the_largest_is_halved_first() {
        let mut plans: BTreeMap<AssetId, Plan> =
            [(1, plan(16, 16)), (2, plan(64, 32)), (3, plan(2, 2))].map(|(id, p)| (AssetId(id), p)).into();
        let halvings =
            |plans: &BTreeMap<AssetId, Plan>| plans.values().map(|p| p.halvings).collect::<Vec<_>>();
        halve_to_fit(&mut plans, 1 << 20);
        assert_eq!(halvings(&plans), [0, 0, 0]);
        halve_to_fit(&mut plans, 4 * (16 * 16 + 32 * 16 + 4));
        assert_eq!(halvings(&plans), [0, 1, 0]);
        halve_to_fit(&mut plans, 4 * (8 * 8 + 16 * 8 + 4));
        assert_eq!(halvings(&plans), [1, 2, 0]);
        halve_to_fit(&mut plans, 0);
        assert!(plans.values().all(|p| p.size() == [1, 1]), "and never below a texel");
    }
}
