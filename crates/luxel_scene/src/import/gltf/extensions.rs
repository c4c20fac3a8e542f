//! Which extensions of glTF are understood, and what of a file is not shown.

use std::collections::{BTreeMap, BTreeSet};

use gltf::json::Root;

/// Extensions that a file may require.
const KNOWN: [&str; 13] = [
    "EXT_mesh_gpu_instancing",
    "KHR_lights_punctual",
    "KHR_materials_clearcoat",
    "KHR_materials_emissive_strength",
    "KHR_materials_ior",
    "KHR_materials_pbrSpecularGlossiness",
    "KHR_materials_specular",
    "KHR_materials_transmission",
    "KHR_materials_unlit",
    "KHR_materials_volume",
    "KHR_mesh_quantization",
    "KHR_texture_transform",
    // What is in a file beside the glTF is not looked at, and its licence is its own matter.
    "KHR_xmp_json_ld",
];

/// The first of `required` that is not understood.
pub(super) fn first_unknown(required: &[String]) -> Option<&str> {
    required.iter().map(String::as_str).find(|name| !KNOWN.contains(name))
}

/// The understood extensions that the file says it uses.
pub(super) fn known_used(root: &Root) -> BTreeSet<&str> {
    root.extensions_used.iter().map(String::as_str).filter(|name| KNOWN.contains(name)).collect()
}

/// What a file has and the scene does not show, counted.
#[derive(Debug, Default)]
pub(super) struct Ignored(BTreeMap<(String, &'static str), usize>);

impl Ignored {
    /// One more `what`, of things that are called `unit` (in the singular; empty if `what` says it).
    pub(super) fn add(&mut self, what: &str, unit: &'static str) {
        self.add_many(what, unit, 1);
    }

    /// The same, `count` times.
    pub(super) fn add_many(&mut self, what: &str, unit: &'static str, count: usize) {
        if count > 0 {
            *self.0.entry((what.to_owned(), unit)).or_insert(0) += count;
        }
    }

    /// What an index of the file leads to; one more of those that do not exist if that is nothing.
    pub(super) fn existing<T>(&mut self, found: Option<T>, plural: &str) -> Option<T> {
        if found.is_none() {
            self.add(&format!("{plural} that do not exist"), "");
        }
        found
    }

    /// An extension that something has: ignored unless understood.
    pub(super) fn extension(&mut self, name: &str, unit: &'static str) {
        if !KNOWN.contains(&name) {
            self.add(name, unit);
        }
    }

    /// What belongs to the file as a whole: animations, and extensions that nothing else was counted for.
    pub(super) fn whole_file(&mut self, root: &Root, animations: usize) {
        self.add_many("animations", "", animations);
        self.add_many("skins, shown in their rest pose", "", root.skins.len());
        for name in &root.extensions_used {
            let is_counted = self.0.keys().any(|(what, _)| what == name);
            if !is_counted && !KNOWN.contains(&name.as_str()) {
                self.0.insert((name.clone(), ""), 0);
            }
        }
    }

    /// One line each.
    pub(super) fn lines(&self) -> Vec<String> {
        self.0
            .iter()
            .map(|((what, unit), count)| match (*count, *unit) {
                (0, _) => what.clone(),
                (count, "") => format!("{what} ({count})"),
                (count, unit) => format!("{what} ({})", super::counted(count, unit)),
            })
            .collect()
    }
}
