//! The textures of an .obj file's materials: images below its folder.

use std::collections::HashMap;
use std::path::{Path, PathBuf};

use crate::assets::{AssetId, Assets, ImagePixels, ImageSource};
use crate::report::LoadReport;
use crate::textures::MaterialTextures;

use super::confined::confined;
use super::image::{Decoded, read_image};
use super::mtl_look::{Map, Role};
use super::{counted, file_name, one_line};

/// The most bytes that the images of a model may fill together: 1 GiB.
const MAX_IMAGE_BYTES: u64 = 1 << 30;

/// The images that materials asked for.
#[derive(Debug)]
pub(super) struct ObjImages<'a> {
    model: &'a Path,
    left: u64,
    /// By the names that materials give them.
    known: HashMap<String, Option<Image>>,
    /// By their paths, which may have several names.
    read: HashMap<PathBuf, Image>,
    warnings: Vec<String>,
    heights: usize,
}

#[derive(Clone, Copy, Debug)]
struct Image {
    id: AssetId,
    /// As normal maps are; pictures of heights are grey.
    is_colored: bool,
}

impl<'a> ObjImages<'a> {
    /// None yet of those of the file at `model`.
    pub(super) fn new(model: &'a Path) -> Self {
        let (known, read) = (HashMap::new(), HashMap::new());
        Self { model, left: MAX_IMAGE_BYTES, known, read, warnings: Vec::new(), heights: 0 }
    }

    /// The textures of a material; `None` if it has none that can be used.
    pub(super) fn textures(&mut self, maps: &[(Role, Map)], assets: &mut Assets) -> Option<MaterialTextures> {
        let mut textures = MaterialTextures::default();
        for (role, map) in maps {
            let Some(image) = self.image(&map.file, assets) else { continue };
            let texture = Some(map.texture(image.id));
            match role {
                Role::Color => textures.color = texture,
                Role::Emission => textures.emission = texture,
                Role::SpecularColor => textures.specular_color = texture,
                Role::MetallicRoughness => textures.metallic_roughness = texture,
                Role::Normal => textures.normal = texture,
                Role::Bump if image.is_colored => textures.normal = textures.normal.or(texture),
                Role::Bump => self.heights += 1,
            }
        }
        (textures != MaterialTextures::default()).then_some(textures)
    }

    /// Says what was used, what could not be, and what is not understood.
    pub(super) fn tell(self, report: &mut LoadReport) {
        if !self.read.is_empty() {
            report.used.push(counted(self.read.len(), "texture image"));
        }
        if self.heights > 0 {
            report.ignored.push(format!("bump maps of heights ({})", counted(self.heights, "material")));
        }
        report.warnings.extend(self.warnings);
    }

    fn image(&mut self, name: &str, assets: &mut Assets) -> Option<Image> {
        if let Some(known) = self.known.get(name) {
            return *known;
        }
        let image = self.read(name, assets);
        let short: String = one_line(name).chars().take(80).collect();
        let image = image
            .map_err(|reason| {
                let model = file_name(self.model);
                self.warnings.push(format!("{model}: texture \"{short}\" {reason}; it is left out"));
            })
            .ok();
        self.known.insert(name.to_owned(), image);
        image
    }

    fn read(&mut self, name: &str, assets: &mut Assets) -> Result<Image, String> {
        let path = confined(self.model, name)?;
        if let Some(read) = self.read.get(&path) {
            return Ok(*read);
        }
        let decoded = read_image(&path).map_err(|error| format!("cannot be used ({error})"))?;
        self.left = self.left.checked_sub(decoded.bytes()).ok_or("is one too many")?;
        let is_colored = is_colored(&decoded);
        let (asset, warning) = decoded.into_asset(ImageSource::File(path.clone()), &file_name(&path));
        self.warnings.extend(warning);
        let image = Image { id: assets.insert_image(asset), is_colored };
        self.read.insert(path, image);
        Ok(image)
    }
}

/// Whether any of a few hundred pixels is no grey.
fn is_colored(image: &Decoded) -> bool {
    match &image.pixels {
        ImagePixels::Rgba8(pixels) => {
            let step = (pixels.len() / 256).max(1);
            pixels.iter().step_by(step).any(|[r, g, b, _]| r.abs_diff(*g).max(g.abs_diff(*b)) > 8)
        }
        ImagePixels::RgbF32(_) => false,
    }
}
