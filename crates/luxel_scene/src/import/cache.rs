//! Every model file is read once per scene file, however many assets come from it.

use std::collections::HashMap;
use std::path::{Path, PathBuf};

use crate::assets::{ImageAsset, ImageSource, MeshAsset, MeshSource};
use crate::error::SceneError;
use crate::report::LoadReport;

use super::budget::ImageBudget;
use super::image::{checker, checker_bytes, read_image};
use super::ply::PlyFile;
use super::{GltfFile, ObjFile, derived, file_name};

/// Model files by their absolute paths, and what is left for images.
#[derive(Debug, Default)]
pub(crate) struct Models {
    objs: HashMap<PathBuf, ObjFile>,
    gltfs: HashMap<PathBuf, GltfFile>,
    budget: ImageBudget,
    /// What the files had to say.
    pub(crate) report: LoadReport,
}

impl Models {
    /// None read yet, and so much left for images.
    pub(crate) fn with_budget(budget: ImageBudget) -> Self {
        Self { budget, ..Self::default() }
    }

    /// All triangles of an .obj or .ply file; what ends otherwise is taken for an .obj.
    pub(crate) fn whole(&mut self, path: &Path) -> Result<MeshAsset, SceneError> {
        if path.extension().is_some_and(|ending| ending.eq_ignore_ascii_case("ply")) {
            let file = PlyFile::read(path)?;
            let report = file.report(path);
            self.tell(report);
            return Ok(file.into_asset(path));
        }
        let file = self.obj(path)?;
        Ok(MeshAsset { source: MeshSource::File(path.to_owned()), mesh: file.whole(), dropped: file.dropped })
    }

    /// One part of an .obj file.
    pub(crate) fn part(&mut self, path: &Path, part: u32) -> Result<MeshAsset, SceneError> {
        let file = self.obj(path)?;
        let count = file.parts.len();
        let found = file.parts.get(part as usize).ok_or_else(|| {
            SceneError::unusable(path, format!("has {count} parts, so there is no part {part}"))
        })?;
        let source = MeshSource::FilePart(path.to_owned(), part);
        Ok(MeshAsset { source, mesh: found.mesh.clone(), dropped: file.dropped })
    }

    /// One primitive of a glTF file.
    pub(crate) fn primitive(
        &mut self,
        path: &Path,
        mesh: u32,
        primitive: u32,
    ) -> Result<MeshAsset, SceneError> {
        let asset = self.gltf(path)?.mesh_asset(mesh, primitive)?;
        if asset.dropped.total() > 0 {
            let (name, count) = (file_name(path), asset.dropped.total());
            let total = asset.mesh.triangles.len() + count as usize;
            let line = format!(
                "{name}: mesh {mesh}, primitive {primitive}: dropped {count} of {total} triangles ({})",
                asset.dropped
            );
            self.report.dropped.push(line);
        }
        Ok(asset)
    }

    /// An image by its source, if all images that were asked for so far fit together.
    pub(crate) fn image(&mut self, source: ImageSource) -> Result<ImageAsset, SceneError> {
        let path = match &source {
            ImageSource::File(path) | ImageSource::Bumps(path) | ImageSource::ModelImage(path, _) => path,
            ImageSource::Masked { mask, .. } => mask,
            ImageSource::Checker { .. } => Path::new("checkerboard"),
        }
        .to_owned();
        let (asset, warning) = self.made(source, &path)?;
        self.budget = self.budget.without(asset.pixels.bytes());
        self.report.warnings.extend(warning);
        Ok(asset)
    }

    /// Makes an image; `path` is what messages call it.
    fn made(&mut self, source: ImageSource, path: &Path) -> Result<(ImageAsset, Option<String>), SceneError> {
        let unusable = |reason: String| SceneError::unusable(path, reason);
        let budget = self.budget;
        let decoded = match &source {
            ImageSource::File(path) => read_image(path, budget.image())?,
            ImageSource::Masked { color, mask } => {
                let mask = read_image(mask, budget.input())?;
                // Both are in memory at once.
                let room = budget.without(mask.bytes()).input();
                let colors = color.as_deref().map(|color| read_image(color, room)).transpose()?;
                derived::masked(colors, mask).map_err(unusable)?
            }
            ImageSource::Bumps(path) => {
                let heights = read_image(path, budget.input())?;
                derived::normals(heights).map_err(unusable)?
            }
            ImageSource::ModelImage(path, number) => {
                return self.gltf(path)?.image_asset(*number, budget.image());
            }
            ImageSource::Checker { squares, a, b } => {
                budget.image().check(checker_bytes(*squares)).map_err(unusable)?;
                checker(*squares, *a, *b)
            }
        };
        Ok(decoded.into_asset(source, &file_name(path)))
    }

    fn obj(&mut self, path: &Path) -> Result<&ObjFile, SceneError> {
        if !self.objs.contains_key(path) {
            let file = ObjFile::read(path)?;
            self.report.dropped.extend(file.dropped_line(path));
            self.report.warnings.extend(file.warnings.iter().cloned());
            self.objs.insert(path.to_owned(), file);
        }
        self.objs.get(path).ok_or_else(|| SceneError::unusable(path, "was not read"))
    }

    fn gltf(&mut self, path: &Path) -> Result<&mut GltfFile, SceneError> {
        if !self.gltfs.contains_key(path) {
            self.gltfs.insert(path.to_owned(), GltfFile::read(path)?);
        }
        self.gltfs.get_mut(path).ok_or_else(|| SceneError::unusable(path, "was not read"))
    }

    /// A scene file says itself what of a model it uses, so only damage is worth a word.
    fn tell(&mut self, report: LoadReport) {
        self.report.dropped.extend(report.dropped);
        self.report.warnings.extend(report.warnings);
    }
}
