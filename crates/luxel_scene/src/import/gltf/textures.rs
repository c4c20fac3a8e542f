//! Textures and images of a glTF file.

use std::collections::HashMap;
use std::path::Path;

use glam::Vec2;
use gltf::json::extensions::texture::Info as InfoExtensions;
use gltf::json::material::NormalTexture;
use gltf::json::texture::{Info, MagFilter, Texture, WrappingMode};
use gltf::json::validation::Checked;
use gltf::json::{Image, Index, Root};
use image::ImageFormat;
use serde_json::Value;

use crate::assets::{AssetId, Assets, ImageAsset, ImageSource};
use crate::textures::{Filter, TextureRef, Wrap};

use super::super::budget::{ImageBudget, Room};
use super::super::file_name;
use super::super::image::decode;
use super::buffers::{Buffers, resolve, short};
use super::extensions::Ignored;

/// The images of a file that were asked for.
#[derive(Debug)]
pub(super) struct Images<'a> {
    path: &'a Path,
    root: &'a Root,
    buffers: &'a Buffers,
    budget: ImageBudget,
    known: HashMap<usize, Option<AssetId>>,
    /// One line per image that cannot be used.
    pub(super) warnings: Vec<String>,
}

impl<'a> Images<'a> {
    /// None yet of those of the file at `path`, and so much left for them.
    pub(super) fn new(path: &'a Path, root: &'a Root, buffers: &'a Buffers, budget: ImageBudget) -> Self {
        Self { path, root, buffers, budget, known: HashMap::new(), warnings: Vec::new() }
    }

    /// How many are in use.
    pub(super) fn used(&self) -> usize {
        self.known.values().flatten().count()
    }

    /// The asset of image `index`, decoded now or before; `None` if it cannot be used.
    fn asset(&mut self, index: Index<Image>, assets: &mut Assets) -> Option<AssetId> {
        let number = index.value();
        if let Some(known) = self.known.get(&number) {
            return *known;
        }
        let room = self.budget.image();
        let id = match decode_image(self.path, self.root, self.buffers, number as u32, room) {
            Ok((image, warning)) => {
                self.budget = self.budget.without(image.pixels.bytes());
                self.warnings.extend(warning);
                Some(assets.insert_image(image))
            }
            Err(reason) => {
                self.warnings.push(format!("{}: {reason}; it is left out", file_name(self.path)));
                None
            }
        };
        self.known.insert(number, id);
        id
    }

    /// What an entity's material needs to show a texture; `None`, with a word about it, if it cannot be shown.
    pub(super) fn texture(
        &mut self,
        info: &Info,
        assets: &mut Assets,
        ignored: &mut Ignored,
    ) -> Option<TextureRef> {
        self.reference(info.index, info.tex_coord, info.extensions.as_ref(), assets, ignored)
    }

    /// The same for a normal map.
    pub(super) fn normal_texture(
        &mut self,
        info: &NormalTexture,
        assets: &mut Assets,
        ignored: &mut Ignored,
    ) -> Option<TextureRef> {
        // The crate has no transform of its own here, but keeps the JSON of it.
        let others = info.extensions.as_ref().map(|extensions| Value::Object(extensions.others.clone()));
        let extensions = others.and_then(|value| serde_json::from_value::<InfoExtensions>(value).ok());
        let texture = self.reference(info.index, info.tex_coord, extensions.as_ref(), assets, ignored)?;
        Some(TextureRef { normal_scale: finite(info.scale, 1.0), ..texture })
    }

    fn reference(
        &mut self,
        index: Index<Texture>,
        tex_coord: u32,
        extensions: Option<&InfoExtensions>,
        assets: &mut Assets,
        ignored: &mut Ignored,
    ) -> Option<TextureRef> {
        let texture = ignored.existing(self.root.get(index), "textures")?;
        if let Some(extensions) = &texture.extensions {
            extensions.others.keys().for_each(|name| ignored.extension(name, "texture"));
        }
        if self.root.get(texture.source).is_none() {
            ignored.add("textures without an image", "");
            return None;
        }
        let transform = extensions.and_then(|extensions| extensions.texture_transform.as_ref());
        let uv_set = transform.and_then(|transform| transform.tex_coord).unwrap_or(tex_coord);
        if uv_set > 1 {
            ignored.add("textures on a third set of coordinates", "");
            return None;
        }
        let mut reference = TextureRef { uv_set, ..TextureRef::new(self.asset(texture.source, assets)?) };
        if let Some(transform) = transform {
            reference.offset = finite2(transform.offset.0, Vec2::ZERO);
            reference.rotation = finite(transform.rotation.0, 0.0);
            reference.scale = finite2(transform.scale.0, Vec2::ONE);
        }
        let sampler = texture.sampler.map(|sampler| ignored.existing(self.root.get(sampler), "samplers"));
        if let Some(sampler) = sampler.flatten() {
            reference.wrap_u = wrap(sampler.wrap_s);
            reference.wrap_v = wrap(sampler.wrap_t);
            if matches!(sampler.mag_filter, Some(Checked::Valid(MagFilter::Nearest))) {
                reference.filter = Filter::Nearest;
            }
        }
        Some(reference)
    }
}

fn finite(value: f32, or: f32) -> f32 {
    if value.is_finite() { value } else { or }
}

fn finite2(value: [f32; 2], or: Vec2) -> Vec2 {
    let value = Vec2::from_array(value);
    if value.is_finite() { value } else { or }
}

fn wrap(mode: Checked<WrappingMode>) -> Wrap {
    match mode {
        Checked::Valid(WrappingMode::ClampToEdge) => Wrap::Clamp,
        Checked::Valid(WrappingMode::MirroredRepeat) => Wrap::Mirror,
        _ => Wrap::Repeat,
    }
}

/// An image, and a warning about it.
type Found = (ImageAsset, Option<String>);

/// Image `number` of the file at `path`, if it fits into `room`.
///
/// # Errors
/// Why it cannot be used: a sentence.
pub(super) fn decode_image(
    path: &Path,
    root: &Root,
    buffers: &Buffers,
    number: u32,
    room: Room,
) -> Result<Found, String> {
    let name = format!("image {number}");
    let image = root.images.get(number as usize).ok_or_else(|| format!("{name} does not exist"))?;
    let content;
    let bytes = match (&image.uri, image.buffer_view) {
        (Some(uri), _) => {
            content = resolve(path, uri, 1 << 30).map_err(|reason| format!("{name} {reason}"))?;
            &content
        }
        (None, Some(view)) => buffers.view(root, view)?.0,
        (None, None) => return Err(format!("{name} has no content")),
    };
    let by_name = image.uri.as_deref().filter(|uri| !uri.starts_with("data:"));
    let by_name = by_name.and_then(|uri| ImageFormat::from_path(short(uri)).ok());
    let decoded = decode(bytes, by_name, room).map_err(|reason| format!("{name} {reason}"))?;
    Ok(decoded.into_asset(ImageSource::ModelImage(path.to_owned(), number), &name))
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;

    #[test]
    fn images_that_do_not_fit_together_are_left_out_by_number() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.gltf");
        image::RgbaImage::new(32, 32).save(folder.path().join("a.png")).unwrap();
        let images = vec![serde_json::json!({"uri": "a.png"}); 3];
        let json = serde_json::json!({"asset": {"version": "2.0"}, "images": images}).to_string();
        let root = Root::from_str(&json).unwrap();
        let buffers = Buffers::read(&path, &root, None);
        // Each fills 4 KiB.
        for (bytes, fitting) in [(12 << 10, 3), ((12 << 10) - 1, 2), (8 << 10, 2), (4095, 0)] {
            let mut images = Images::new(&path, &root, &buffers, ImageBudget::of(bytes));
            let mut assets = Assets::default();
            let used = (0..3).filter_map(|index| images.asset(Index::new(index), &mut assets)).count();
            assert_eq!(
                (used, images.used(), images.warnings.len()),
                (fitting, fitting, 3 - fitting),
                "{bytes}"
            );
            let expected =
                "a.gltf: image 2 is one too many: it needs 1 MiB, and 0 MiB are left for it; it is left out";
            assert!(images.warnings.last().is_none_or(|line| line == expected), "{:?}", images.warnings);
        }
    }
}
