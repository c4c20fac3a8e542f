//! How much the images of a scene may fill together, whichever file they come from.

use crate::limits::MAX_SCENE_IMAGE_BYTES;

use super::derived::MAX_INPUT_BYTES;
use super::image::MAX_IMAGE_BYTES;

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

    /// The room of the next image.
    pub(crate) fn image(self) -> Room {
        Room { left: self.left, is_input: false }
    }

    /// The room of a picture that the next image is made of.
    pub(super) fn input(self) -> Room {
        Room { left: self.left, is_input: true }
    }

    /// What is left after an image of so many bytes, which kept to its [`Room`].
    pub(crate) fn without(self, bytes: u64) -> Self {
        Self { left: self.left.saturating_sub(bytes) }
    }
}

/// How many bytes one picture may fill, and why no more.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Room {
    left: u64,
    is_input: bool,
}

impl Room {
    /// The most bytes that fit.
    pub(super) fn bytes(self) -> u64 {
        self.left.min(if self.is_input { MAX_INPUT_BYTES } else { MAX_IMAGE_BYTES })
    }

    /// Whether a picture of so many bytes fits.
    ///
    /// # Errors
    /// Why not: the end of a sentence that begins with its name.
    pub(super) fn check(self, bytes: u64) -> Result<(), String> {
        let needs = bytes.div_ceil(1 << 20);
        if self.is_input && bytes > MAX_INPUT_BYTES {
            let most = MAX_INPUT_BYTES >> 20;
            return Err(format!(
                "is too large to make another picture of: it needs {needs} MiB, and {most} MiB are the most"
            ));
        }
        if bytes > self.left {
            let left = self.left >> 20;
            return Err(format!("is one too many: it needs {needs} MiB, and {left} MiB are left for it"));
        }
        Ok(())
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;

    #[test]
    fn a_picture_is_told_which_limit_it_is_beyond() {
        let whole = ImageBudget::default();
        let why = |room: Room, bytes| room.check(bytes).unwrap_err();
        assert!(
            why(whole.input(), MAX_INPUT_BYTES + 1).contains("it needs 257 MiB, and 256 MiB are the most")
        );
        let little = whole.without(MAX_SCENE_IMAGE_BYTES - (3 << 20));
        for room in [little.image(), little.input()] {
            let expected = "is one too many: it needs 4 MiB, and 3 MiB are left for it";
            assert_eq!((room.bytes(), why(room, (3 << 20) + 1).as_str()), (3 << 20, expected));
        }
        assert_eq!((whole.image().bytes(), whole.input().bytes()), (MAX_IMAGE_BYTES, MAX_INPUT_BYTES));
        assert!(whole.image().check(MAX_IMAGE_BYTES).is_ok() && whole.input().check(MAX_INPUT_BYTES).is_ok());
        assert_eq!(little.without(u64::MAX).image().bytes(), 0);
    }
}
