//! The .mtl files of an .obj file: colours, emission, glass and mirrors.
//!
//! A material file is a help, not a need: whatever is missing or damaged in it becomes a warning and
//! the default material. `tobj` panics on a colour of two numbers, so only lines that can be
//! understood reach it.

use std::collections::{HashMap, HashSet};
use std::path::Path;

use super::confined::confined;
use super::mtl_look::{KEYWORDS, MtlLook, look, renamed};
use super::obj_text::CleanObj;
use super::tally::Tally;
use super::{file_name, read_file};

/// The longest material file that is read: 16 MiB.
const MAX_MTL_BYTES: u64 = 1 << 24;

/// Materials by name.
#[derive(Debug, Default)]
pub(super) struct Library {
    materials: Vec<(String, MtlLook)>,
    /// Keys of materials that this program does not use.
    pub(super) ignored: Tally,
}

impl Library {
    /// From names to indices, as `tobj` wants it; of two with one name the later counts.
    pub(super) fn indices(&self) -> HashMap<String, usize> {
        self.materials.iter().enumerate().map(|(index, (name, _))| (name.clone(), index)).collect()
    }

    /// The look with this index, or the default one.
    pub(super) fn look(&self, index: Option<usize>) -> MtlLook {
        self.find(index).map_or_else(MtlLook::default, |found| found.1.clone())
    }

    /// The name of an object in a material.
    pub(super) fn part_name(&self, object: &str, index: Option<usize>) -> String {
        self.find(index).map_or_else(|| object.to_owned(), |(material, _)| format!("{object} ({material})"))
    }

    /// Whether there is a look with this index.
    pub(super) fn has(&self, index: usize) -> bool {
        index < self.materials.len()
    }

    fn find(&self, index: Option<usize>) -> Option<&(String, MtlLook)> {
        self.materials.get(index?)
    }
}

/// Reads every library that the model names, from its own folder or below.
pub(super) fn read_libraries(obj: &Path, model: &CleanObj, warnings: &mut Vec<String>) -> Library {
    let mut library = Library::default();
    let (mut names, mut files) = (HashSet::new(), HashSet::new());
    let named = model.libraries.iter().flat_map(|names| file_names(obj, names));
    for name in named.filter(|name| names.insert(*name)) {
        match confined(obj, name).and_then(|path| {
            let is_new = files.insert(path.clone());
            if is_new { library.read(&path, warnings) } else { Ok(()) }
        }) {
            Ok(()) => {}
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

impl Library {
    /// Adds what the file at `path` has.
    fn read(&mut self, path: &Path, warnings: &mut Vec<String>) -> Result<(), String> {
        let bytes = read_file(path, MAX_MTL_BYTES).map_err(|error| match error {
            crate::SceneError::Read { source, .. } => format!("cannot be read ({source})"),
            other => format!("cannot be used ({other})"),
        })?;
        let text = clean_mtl(path, &String::from_utf8_lossy(&bytes), &mut self.ignored, warnings);
        let (materials, _) =
            tobj::load_mtl_buf(&mut text.as_bytes()).map_err(|error| format!("is damaged ({error})"))?;
        let looks = materials.iter().map(|material| (material.name.clone(), look(material)));
        self.materials.extend(looks);
        Ok(())
    }
}

/// The lines that matter here and are well formed; a warning for each that is not.
fn clean_mtl(path: &Path, text: &str, ignored: &mut Tally, warnings: &mut Vec<String>) -> String {
    let mut kept = String::new();
    for (index, line) in text.trim_start_matches('\u{FEFF}').lines().enumerate() {
        let line = line.trim();
        let mut words = line.split_whitespace();
        let numbers_wanted = match words.next() {
            Some("newmtl") if words.next().is_some() => 0,
            Some("Kd" | "Ks" | "Ke") => 3,
            Some("Ns" | "Ni" | "d" | "illum" | "Pr" | "Pm" | "Pc" | "Pcr") => 1,
            Some(keyword) if KEYWORDS.contains(&keyword) => {
                kept.push_str(&renamed(keyword));
                kept.push_str(&line[keyword.len()..]);
                kept.push('\n');
                continue;
            }
            // Ambient light, which paths of light make themselves.
            Some("newmtl" | "Ka" | "map_Ka") | None => continue,
            Some(comment) if comment.starts_with('#') => continue,
            Some(other) => {
                let name: String = other.chars().take(40).collect();
                ignored.add(&format!("\"{name}\" of materials"));
                continue;
            }
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
