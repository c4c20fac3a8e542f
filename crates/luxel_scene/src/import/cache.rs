//! Every model file is read once per scene file, however many assets come from it.

use std::collections::HashMap;
use std::path::{Path, PathBuf};

use crate::assets::{ImageAsset, ImageSource, MeshAsset, MeshSource};
use crate::error::SceneError;
use crate::report::LoadReport;

use super::image::{checker, read_image};
use super::ply::PlyFile;
use super::{GltfFile, ObjFile, derived, file_name};

/// Model files by their absolute paths.
#[derive(Debug, Default)]
pub(crate) struct Models {
    objs: HashMap<PathBuf, ObjFile>,
    gltfs: HashMap<PathBuf, GltfFile>,
    /// What the files had to say.
    pub(crate) report: LoadReport,
}

impl Models {
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

    /// An image by its source.
    pub(crate) fn image(&mut self, source: ImageSource) -> Result<ImageAsset, SceneError> {
        let (asset, warning) = match &source {
            ImageSource::File(path) => {
                let name = file_name(path);
                read_image(path)?.into_asset(source, &name)
            }
            ImageSource::Masked { color, mask } => {
                let colors = color.as_deref().map(read_image).transpose()?;
                let made = derived::masked(colors, read_image(mask)?);
                let name = file_name(mask);
                made.map_err(|reason| SceneError::unusable(mask, reason))?.into_asset(source, &name)
            }
            ImageSource::Bumps(path) => {
                let made = derived::normals(read_image(path)?);
                let name = file_name(path);
                made.map_err(|reason| SceneError::unusable(path, reason))?.into_asset(source, &name)
            }
            ImageSource::ModelImage(path, number) => self.gltf(path)?.image_asset(*number)?,
            ImageSource::Checker { squares, a, b } => checker(*squares, *a, *b).into_asset(source, "checker"),
        };
        self.report.warnings.extend(warning);
        Ok(asset)
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
