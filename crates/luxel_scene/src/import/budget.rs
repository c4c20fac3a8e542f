//! How much the images of a scene may fill together, whichever file they come from.

use crate::limits::MAX_SCENE_IMAGE_BYTES;

/// What is left for images.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ImageBudget {
    left: u64,
}

impl Default for ImageBudget {
    /// That of a scene without an image.
    fn default() -> Self {
        Self { left: MAX_SCENE_IMAGE_BYTES }
    }
}

impl ImageBudget {
    /// With so many bytes left.
    #[cfg(test)]
    pub(crate) fn of(bytes: u64) -> Self {
        Self { left: bytes }
    }

    /// Bytes that the next image may fill.
    pub(crate) fn left(self) -> u64 {
        self.left
    }

    /// What is left after an image of so many bytes.
    ///
    /// # Errors
    /// It does not fit; the end of a sentence that begins with its name.
    pub(crate) fn after(self, bytes: u64) -> Result<Self, String> {
        let left = self.left.checked_sub(bytes).ok_or_else(|| one_too_many(bytes, self.left))?;
        Ok(Self { left })
    }
}

/// What is said of an image that would fill more bytes than are left.
pub(super) fn one_too_many(bytes: u64, left: u64) -> String {
    let (needs, left) = (bytes.div_ceil(1 << 20), left >> 20);
    format!("is one too many: it needs {needs} MiB, and {left} MiB are left for it")
}
