//! Wavefront .obj: triangles by (object, material).

use std::collections::{HashMap, HashSet};
use std::path::Path;

use crate::assets::{Dropped, TriangleMesh};
use crate::error::SceneError;
use crate::limits::MAX_INSTANCES;

use super::mtl_look::MtlLook;
use super::obj_text::{CleanObj, clean};
use super::{counted, file_name, mtl, obj_mesh, read_model};

/// The most parts of a file: each becomes an instance, and a ground comes on top.
const MAX_PARTS: u64 = MAX_INSTANCES - 1;

/// One object of an .obj file in one material.
#[derive(Debug)]
pub(crate) struct ObjPart {
    /// The object's (or group's) name, and the material's if there is one.
    pub(crate) name: String,
    /// From the .mtl file; the default material if there is none.
    pub(crate) look: MtlLook,
    /// At least one triangle.
    pub(crate) mesh: TriangleMesh,
}

/// A whole .obj file.
#[derive(Debug)]
pub(crate) struct ObjFile {
    /// In the order of their first triangles; at least one.
    pub(crate) parts: Vec<ObjPart>,
    /// Triangles in the file.
    pub(crate) triangles: u32,
    /// Triangles left out.
    pub(crate) dropped: Dropped,
    /// Materials that parts are of.
    materials: usize,
    /// One line each: what is in the file, or in its materials, and not used.
    pub(crate) ignored: Vec<String>,
    /// One line each: missing or damaged material files.
    pub(crate) warnings: Vec<String>,
}

impl ObjFile {
    /// Reads the file at `path` and the material files beside it.
    ///
    /// # Errors
    /// A file that cannot be read, a line that cannot be understood, or no triangle that is any
    /// good. A material file never fails: what it lacks is a warning.
    pub(crate) fn read(path: &Path) -> Result<Self, SceneError> {
        let bytes = read_model(path)?;
        if bytes.starts_with(&[0xFE, 0xFF]) || bytes.starts_with(&[0xFF, 0xFE]) {
            return Err(SceneError::model(path, 1, "is UTF-16; save it as UTF-8"));
        }
        // Only names can be other than ASCII, and a name may be mended.
        let text = String::from_utf8_lossy(&bytes);
        let clean = clean(path, text.trim_start_matches('\u{FEFF}'))?;
        if clean.triangle_ids.is_empty() {
            return Err(nothing_left(path, &clean));
        }
        let mut warnings = Vec::new();
        let library = mtl::read_libraries(path, &clean, &mut warnings);
        Self::from_clean(path, clean, &library, warnings)
    }

    fn from_clean(
        path: &Path,
        clean: CleanObj,
        library: &mtl::Library,
        warnings: Vec<String>,
    ) -> Result<Self, SceneError> {
        let options = tobj::LoadOptions {
            single_index: true,
            triangulate: true,
            ignore_points: true,
            ignore_lines: true,
        };
        // One made-up library file at the top: the real ones are read, and their absence reported,
        // already.
        let text = format!("mtllib all\n{}", clean.text);
        let (models, _) = tobj::load_obj_buf(&mut text.as_bytes(), &options, |_: &Path| {
            Ok((Vec::new(), library.indices()))
        })
        .map_err(|error| SceneError::unusable(path, error.to_string()))?;
        let used: HashSet<_> = models.iter().filter_map(|model| model.mesh.material_id).collect();
        let parts = group(models, &clean.triangle_ids, library);
        if parts.len() as u64 > MAX_PARTS {
            let message = format!("has {} objects; {MAX_PARTS} are the most", parts.len());
            return Err(SceneError::unusable(path, message));
        }
        Ok(Self {
            parts,
            materials: used.iter().filter(|&&index| library.has(index)).count(),
            ignored: clean.ignored.lines().into_iter().chain(library.ignored.lines()).collect(),
            triangles: clean.triangles,
            dropped: clean.dropped,
            warnings,
        })
    }

    /// All parts as one mesh, triangles in the file's order.
    pub(crate) fn whole(&self) -> TriangleMesh {
        let mut whole = TriangleMesh::default();
        for part in &self.parts {
            obj_mesh::append(&mut whole, &part.mesh);
        }
        obj_mesh::mend(&mut whole);
        let mut numbered: Vec<_> = whole.triangle_ids.into_iter().zip(whole.triangles).collect();
        numbered.sort_unstable();
        (whole.triangle_ids, whole.triangles) = numbered.into_iter().unzip();
        whole
    }

    /// What a scene shows of the file, one line each.
    pub(crate) fn used(&self) -> Vec<String> {
        let triangles: usize = self.parts.iter().map(|part| part.mesh.triangles.len()).sum();
        let mut used =
            vec![format!("{} with {}", counted(self.parts.len(), "part"), counted(triangles, "triangle"))];
        if self.materials > 0 {
            used.push(counted(self.materials, "material"));
        }
        let any = |has: fn(&TriangleMesh) -> bool| self.parts.iter().any(|part| has(&part.mesh));
        let carried = [
            ("normals", any(|mesh| !mesh.normals.is_empty())),
            ("texture coordinates", any(|mesh| !mesh.uvs[0].is_empty())),
            ("colours", any(|mesh| !mesh.colors.is_empty())),
        ];
        used.extend(carried.iter().filter(|(_, is_there)| *is_there).map(|(what, _)| (*what).to_owned()));
        used
    }

    /// The line about triangles left out, if any were.
    pub(crate) fn dropped_line(&self, path: &Path) -> Option<String> {
        (self.dropped.total() > 0).then(|| {
            format!(
                "{}: dropped {} of {} triangles ({})",
                file_name(path),
                self.dropped.total(),
                self.triangles,
                self.dropped
            )
        })
    }
}

/// `tobj`'s models, those with the same name and material joined.
fn group(models: Vec<tobj::Model>, ids: &[u32], library: &mtl::Library) -> Vec<ObjPart> {
    let mut parts: Vec<ObjPart> = Vec::new();
    let mut found: HashMap<(String, Option<usize>), usize> = HashMap::new();
    let mut ids = ids.iter().copied();
    for tobj::Model { mesh, name } in models {
        if mesh.indices.is_empty() {
            continue;
        }
        let material_id = mesh.material_id;
        let index = *found.entry((name, material_id)).or_insert_with_key(|(name, _)| {
            parts.push(ObjPart {
                name: library.part_name(name, material_id),
                look: library.look(material_id),
                mesh: TriangleMesh::default(),
            });
            parts.len() - 1
        });
        obj_mesh::append(&mut parts[index].mesh, &obj_mesh::triangles(&mesh, &mut ids));
    }
    for part in &mut parts {
        obj_mesh::mend(&mut part.mesh);
    }
    parts
}

fn nothing_left(path: &Path, clean: &CleanObj) -> SceneError {
    let message = match clean.triangles {
        0 => "has no triangle".to_owned(),
        n => format!("none of its {n} triangles can be used ({})", clean.dropped),
    };
    SceneError::unusable(path, message)
}
