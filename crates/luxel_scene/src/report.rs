//! What was used and what was left out on loading.

/// What the user should be told about a scene that was loaded.
#[derive(Clone, PartialEq, Eq, Debug, Default)]
pub struct LoadReport {
    /// What of a model the scene shows, such as `3 meshes with 70 triangles`.
    pub used: Vec<String>,
    /// What a model has and the scene does not show, once each, such as `KHR_materials_sheen (2 materials)`.
    pub ignored: Vec<String>,
    /// One line per file of which something was left out because it is damaged, such as
    /// `bunny.obj: dropped 3 of 69451 triangles (2 bad index, 1 zero area)`.
    pub dropped: Vec<String>,
    /// One line each: a missing material file and the like.
    pub warnings: Vec<String>,
}

impl LoadReport {
    /// What the scene does not show, in one line; `None` if it shows everything.
    pub fn ignored_line(&self) -> Option<String> {
        (!self.ignored.is_empty()).then(|| format!("ignored: {}", self.ignored.join(", ")))
    }
}
