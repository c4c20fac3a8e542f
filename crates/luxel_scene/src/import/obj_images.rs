//! The textures of an .obj file's materials: images below its folder.

use std::collections::{HashMap, HashSet};
use std::path::{Path, PathBuf};

use crate::assets::{AssetId, Assets, ImagePixels, ImageSource};
use crate::report::LoadReport;
use crate::textures::{MaterialTextures, TextureRef};

use super::budget::{ImageBudget, Room};
use super::confined::confined;
use super::image::{Decoded, read_image};
use super::mtl_look::{Map, Role};
use super::{counted, derived, file_name, one_line};

/// The images that materials asked for.
#[derive(Debug)]
pub(super) struct ObjImages<'a> {
    model: &'a Path,
    budget: ImageBudget,
    /// By what was asked for and by what came of it; `None` where nothing did.
    made: HashMap<ImageSource, Option<Image>>,
    /// Names of files that were complained about.
    told: HashSet<String>,
    /// Files that were no good, with the most bytes that they might have: they are not tried again.
    unusable: HashSet<(PathBuf, u64)>,
    warnings: Vec<String>,
    /// Materials whose mask lies on the surface in another way than its colours.
    askew: usize,
}

#[derive(Clone, Copy, Debug)]
struct Image {
    id: AssetId,
    /// As normal maps are; pictures of heights are grey.
    is_colored: bool,
}

impl<'a> ObjImages<'a> {
    /// None yet of those of the file at `model`, and so much left for them.
    pub(super) fn new(model: &'a Path, budget: ImageBudget) -> Self {
        Self {
            model,
            budget,
            made: HashMap::new(),
            told: HashSet::new(),
            unusable: HashSet::new(),
            warnings: Vec::new(),
            askew: 0,
        }
    }

    /// The textures of a material; `None` if it has none that can be used.
    pub(super) fn textures(&mut self, maps: &[(Role, Map)], assets: &mut Assets) -> Option<MaterialTextures> {
        let map = |wanted| maps.iter().find(|(role, _)| *role == wanted).map(|(_, map)| map);
        let color = match (map(Role::Color), map(Role::Mask)) {
            (color, Some(mask)) => self.masked(color, mask, assets),
            (color, None) => color.and_then(|color| self.plain(color, assets)),
        };
        let mut plain = |role| self.plain(map(role)?, assets);
        let mut textures = MaterialTextures {
            color,
            normal: plain(Role::Normal),
            emission: plain(Role::Emission),
            specular_color: plain(Role::SpecularColor),
            metallic_roughness: plain(Role::MetallicRoughness),
            ..MaterialTextures::default()
        };
        if textures.normal.is_none() {
            textures.normal = map(Role::Bump).and_then(|bump| self.bump(bump, assets));
        }
        (textures != MaterialTextures::default()).then_some(textures)
    }

    /// Says what was used, what could not be, and what is not understood.
    pub(super) fn tell(self, report: &mut LoadReport) {
        let used: HashSet<_> = self.made.values().flatten().map(|image| image.id).collect();
        if !used.is_empty() {
            report.used.push(counted(used.len(), "texture image"));
        }
        if self.askew > 0 {
            let materials = counted(self.askew, "material");
            report.ignored.push(format!("places of masks that are not those of their colours ({materials})"));
        }
        report.warnings.extend(self.warnings);
    }

    /// A texture that is a file.
    fn plain(&mut self, map: &Map, assets: &mut Assets) -> Option<TextureRef> {
        let path = self.path(map)?;
        let source = ImageSource::File(path.clone());
        let image = match self.made.get(&source) {
            Some(known) => *known,
            None => {
                let picture = self.picture(map, &path, self.budget.image());
                self.keep(map, source, picture, assets)
            }
        };
        Some(map.texture(image?.id))
    }

    /// Colours with a mask, which may be in the same file. It lies on the surface as they do.
    fn masked(&mut self, color: Option<&Map>, mask: &Map, assets: &mut Assets) -> Option<TextureRef> {
        let colors = color.and_then(|map| Some((map, self.path(map)?)));
        let path = self.path(mask).filter(|path| colors.as_ref().is_none_or(|(_, other)| other != path));
        let Some(path) = path else { return self.plain(color?, assets) };
        let place = colors.as_ref().map_or(mask, |(map, _)| map);
        self.askew += usize::from(!place.lies_like(mask));
        let color_path = colors.as_ref().map(|(_, path)| path.clone());
        let source = ImageSource::Masked { color: color_path, mask: path.clone() };
        let image = match self.made.get(&source) {
            Some(known) => *known,
            None => {
                let made = self.mask(colors.as_ref(), (mask, path), assets);
                self.made.insert(source, made);
                made
            }
        };
        match image {
            Some(image) => Some(place.texture(image.id)),
            None => self.plain(color?, assets),
        }
    }

    /// Makes a masked picture; colours that cannot be used are white.
    fn mask(
        &mut self,
        color: Option<&(&Map, PathBuf)>,
        (map, mask): (&Map, PathBuf),
        assets: &mut Assets,
    ) -> Option<Image> {
        let opacity = self.picture(map, &mask, self.budget.input())?;
        // Both are in memory at once.
        let room = self.budget.without(opacity.bytes()).input();
        let colors = color.and_then(|(map, path)| Some((self.picture(map, path, room)?, path.clone())));
        let (colors, color) = colors.unzip();
        let picture = self.or_tell(map, derived::masked(colors, opacity));
        self.keep(map, ImageSource::Masked { color, mask }, picture, assets)
    }

    /// A normal map, which may be made of heights.
    fn bump(&mut self, map: &Map, assets: &mut Assets) -> Option<TextureRef> {
        let path = self.path(map)?;
        let (file, heights) = (ImageSource::File(path.clone()), ImageSource::Bumps(path.clone()));
        let colored = self.made.get(&file).copied().flatten().filter(|image| image.is_colored);
        let image = match self.made.get(&heights) {
            Some(known) => *known,
            None if colored.is_some() => colored,
            None => match self.picture(map, &path, self.budget.input()) {
                Some(picture) if is_colored(&picture) => self.keep(map, file, Some(picture), assets),
                picture => {
                    let normals = picture.and_then(|it| self.or_tell(map, derived::normals(it)));
                    self.keep(map, heights, normals, assets)
                }
            },
        };
        Some(map.texture(image?.id))
    }

    fn path(&mut self, map: &Map) -> Option<PathBuf> {
        let path = confined(self.model, &map.file);
        self.or_tell(map, path)
    }

    /// The picture in a file, if it fits into `room`.
    fn picture(&mut self, map: &Map, path: &Path, room: Room) -> Option<Decoded> {
        let attempt = (path.to_owned(), room.bytes());
        if self.unusable.contains(&attempt) {
            return None;
        }
        let picture = read_image(path, room);
        if picture.is_err() {
            self.unusable.insert(attempt);
        }
        self.or_tell(map, picture.map_err(|error| format!("cannot be used ({error})")))
    }

    /// Makes a picture an asset, and remembers it under its source.
    fn keep(
        &mut self,
        map: &Map,
        source: ImageSource,
        picture: Option<Decoded>,
        assets: &mut Assets,
    ) -> Option<Image> {
        let image = picture.map(|picture| {
            self.budget = self.budget.without(picture.bytes());
            let is_colored = is_colored(&picture);
            let (asset, warning) = picture.into_asset(source.clone(), &map.file);
            self.warnings.extend(warning);
            Image { id: assets.insert_image(asset), is_colored }
        });
        self.made.insert(source, image);
        image
    }

    /// What a file gives, or once a line about why it gives nothing.
    fn or_tell<T>(&mut self, map: &Map, found: Result<T, String>) -> Option<T> {
        let reason = match found {
            Ok(found) => return Some(found),
            Err(reason) => reason,
        };
        if self.told.insert(map.file.clone()) {
            let short: String = one_line(&map.file).chars().take(80).collect();
            let model = file_name(self.model);
            self.warnings.push(format!("{model}: texture \"{short}\" {reason}; it is left out"));
        }
        None
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
