//! The .mtl files of an .obj file: colours, emission, glass and mirrors.
//!
//! A material file is a help, not a need: whatever is missing or damaged in it becomes a warning and
//! the default material. `tobj` panics on a colour of two numbers, so only lines that can be
//! understood reach it.

use std::collections::HashMap;
use std::path::{Component, Path};

use glam::Vec3;

use crate::material::{Material, Surface};

use super::obj_text::CleanObj;
use super::{file_name, read_file};

/// The longest material file that is read: 16 MiB.
const MAX_MTL_BYTES: u64 = 1 << 24;

/// Materials by name.
#[derive(Debug, Default)]
pub(super) struct Library {
    materials: Vec<(String, Material)>,
}

impl Library {
    /// From names to indices, as `tobj` wants it; of two with one name the later counts.
    pub(super) fn indices(&self) -> HashMap<String, usize> {
        self.materials.iter().enumerate().map(|(index, (name, _))| (name.clone(), index)).collect()
    }

    /// The material with this index, or the default one.
    pub(super) fn material(&self, index: Option<usize>) -> Material {
        self.find(index).map_or_else(Material::default, |found| found.1)
    }

    /// The name of an object in a material.
    pub(super) fn part_name(&self, object: &str, index: Option<usize>) -> String {
        self.find(index).map_or_else(|| object.to_owned(), |(material, _)| format!("{object} ({material})"))
    }

    fn find(&self, index: Option<usize>) -> Option<&(String, Material)> {
        self.materials.get(index?)
    }
}

/// Reads every library that the model names, from its own folder or below.
pub(super) fn read_libraries(obj: &Path, model: &CleanObj, warnings: &mut Vec<String>) -> Library {
    let mut library = Library::default();
    for name in model.libraries.iter().flat_map(|names| file_names(obj, names)) {
        match read_library(obj, name, warnings) {
            Ok(materials) => library.materials.extend(materials),
            Err(reason) => warnings.push(format!(
                "{}: material file \"{name}\" {reason}; default materials are used",
                file_name(obj)
            )),
        }
    }
    if model.libraries.is_empty() && model.uses_materials {
        warnings.push(format!(
            "{}: names materials but no material file; default materials are used",
            file_name(obj)
        ));
    }
    library
}

/// The files of one `mtllib` line: one whose name may hold spaces, or several.
fn file_names<'a>(obj: &Path, names: &'a str) -> Vec<&'a str> {
    if obj.with_file_name(names).exists() { vec![names] } else { names.split_whitespace().collect() }
}

fn read_library(
    obj: &Path,
    name: &str,
    warnings: &mut Vec<String>,
) -> Result<Vec<(String, Material)>, String> {
    let relative = name.replace('\\', "/");
    let inside = Path::new(&relative)
        .components()
        .all(|part| matches!(part, Component::Normal(_) | Component::CurDir));
    if !inside || relative.contains(':') {
        return Err("is outside the model's folder".to_owned());
    }
    let path = obj.parent().unwrap_or(Path::new("")).join(relative);
    let bytes = read_file(&path, MAX_MTL_BYTES).map_err(|error| match error {
        crate::SceneError::Read { source, .. } => format!("cannot be read ({source})"),
        other => format!("cannot be used ({other})"),
    })?;
    let text = clean_mtl(&path, &String::from_utf8_lossy(&bytes), warnings);
    let (materials, _) =
        tobj::load_mtl_buf(&mut text.as_bytes()).map_err(|error| format!("is damaged ({error})"))?;
    Ok(materials.iter().map(|material| (material.name.clone(), surface_of(material))).collect())
}

/// The lines that matter here and are well formed; a warning for each that is not.
fn clean_mtl(path: &Path, text: &str, warnings: &mut Vec<String>) -> String {
    let mut kept = String::new();
    for (index, line) in text.lines().enumerate() {
        let line = line.trim();
        let mut words = line.split_whitespace();
        let numbers_wanted = match words.next() {
            Some("newmtl") if words.next().is_some() => 0,
            Some("Kd" | "Ks" | "Ke") => 3,
            Some("Ns" | "Ni" | "d" | "illum") => 1,
            _ => continue,
        };
        let is_number = |word: &str| word.parse::<f32>().is_ok_and(f32::is_finite);
        let illum_ok = !line.starts_with("illum")
            || line.split_whitespace().nth(1).is_some_and(|n| n.parse::<u8>().is_ok());
        if words.by_ref().take(numbers_wanted).filter(|word| is_number(word)).count() == numbers_wanted
            && illum_ok
        {
            kept.push_str(line);
            kept.push('\n');
        } else {
            warnings.push(format!(
                "{}:{}: \"{line}\" is not understood and left out",
                file_name(path),
                index + 1
            ));
        }
    }
    kept
}

/// The nearest of our materials.
///
/// `illum` 4, 6, 7 and 9 are glass (as is anything more transparent than not), 3, 5 and 8 mirrors;
/// all else is matt. The mirror's fuzz undoes Blender's export, Ns = 1000 (1 − roughness)².
fn surface_of(material: &tobj::Material) -> Material {
    let colour = |rgb: Option<[f32; 3]>, or: f32| rgb.map_or(Vec3::splat(or), Vec3::from_array);
    let albedo = |rgb, or| colour(rgb, or).clamp(Vec3::ZERO, Vec3::ONE);
    let surface = match material.illumination_model {
        Some(4 | 6 | 7 | 9) => glass(material),
        _ if material.dissolve.is_some_and(|opacity| opacity < 0.5) => glass(material),
        Some(3 | 5 | 8) => Surface::Metal {
            albedo: albedo(material.specular, 0.9),
            fuzz: 1.0 - (material.shininess.unwrap_or(1000.0) / 1000.0).clamp(0.0, 1.0).sqrt(),
        },
        _ => Surface::Lambert { albedo: albedo(material.diffuse, 0.73) },
    };
    Material { surface, emission: colour(material.emissive, 0.0).max(Vec3::ZERO) }
}

fn glass(material: &tobj::Material) -> Surface {
    let ior = material.optical_density.filter(|&ior| ior > 1.0).unwrap_or(1.5);
    Surface::Dielectric { ior }
}
