//! A picture that is ready to be shown.
use luxel_film::{Display, Film, View};

/// An sRGB picture with eight bits per channel.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Picture {
    /// Width in pixels.
    pub width: u32,
    /// Height in pixels.
    pub height: u32,
    /// Red, green and blue, row by row from the upper left corner; `width · height` entries.
    pub pixels: Vec<[u8; 3]>,
}

impl Picture {
    /// What a view shows of a film; `None` if it needs first-hit outputs and the film has none.
    pub fn of(film: &Film, display: Display, view: View) -> Option<Self> {
        Some(Self { width: film.width, height: film.height, pixels: display.pixels(film, view)? })
    }
}
