//! What may be asked for on loading.

use std::path::PathBuf;

/// How a file is loaded; the default is what it says itself.
#[derive(Clone, PartialEq, Eq, Debug, Default)]
pub struct LoadOptions {
    /// Which scene of a glTF model, by name or by number from 0; without effect on other files.
    pub scene: Option<String>,
    /// An HDR or EXR picture (or any image) that surrounds the scene in place of its own environment. A model
    /// then gets no sky and no lamp.
    pub environment: Option<PathBuf>,
    /// Width and height, in pixels, of the picture that a model without a camera is framed for, in place of the default size.
    pub size: Option<(u32, u32)>,
}
