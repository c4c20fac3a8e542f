//! What was left out on loading.

/// What the user should be told about a scene that was loaded.
#[derive(Clone, PartialEq, Eq, Debug, Default)]
pub struct LoadReport {
    /// One line per file of which something was left out, such as
    /// `bunny.obj: dropped 3 of 69451 triangles (2 bad index, 1 zero area)`.
    pub dropped: Vec<String>,
    /// One line each: a missing material file and the like.
    pub warnings: Vec<String>,
}
