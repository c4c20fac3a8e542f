//! The film: what a tracer hands out and everything else reads.
use luxel_flat::{Aov, FilmPixel};

use crate::{TraceError, accumulate};

/// Accumulated samples, row by row from the upper left corner.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Film {
    /// Width in pixels.
    pub width: u32,
    /// Height in pixels.
    pub height: u32,
    /// Accumulated radiance, `width · height` entries.
    pub pixels: Vec<FilmPixel>,
    /// First-hit outputs as the tracers keep them, if they were asked for; as many as `pixels`. Albedo and normal
    /// are sums over samples: read them through [`Film::first_hits`].
    pub aovs: Option<Vec<Aov>>,
    /// Origin of tracer space in world space, metres (`FlatScene::anchor`): turns the tracer-space positions of
    /// `aovs` into world positions.
    pub anchor: [f64; 3],
}

impl Film {
    /// A film without samples and without first-hit outputs.
    pub fn new(width: u32, height: u32) -> Self {
        let pixels = vec![FilmPixel::default(); width as usize * height as usize];
        Self { width, height, pixels, aovs: None, anchor: [0.0; 3] }
    }

    /// A film without samples, with room for first-hit outputs if they are wanted.
    ///
    /// # Errors
    /// [`TraceError::OutOfMemory`] if the machine has no room for it.
    pub fn allocate(width: u32, height: u32, aovs: bool) -> Result<Self, TraceError> {
        let mut film = Self { width, height, ..Self::default() };
        let count = width as usize * height as usize;
        film.reserve(count, aovs)?;
        film.pixels.resize(count, FilmPixel::default());
        if let Some(aovs) = &mut film.aovs {
            aovs.resize(count, Aov::default());
        }
        Ok(film)
    }

    /// Asks for the memory of a film and gives it back.
    ///
    /// # Errors
    /// [`TraceError::OutOfMemory`] if the machine has no room for it.
    pub fn check_room(width: u32, height: u32, aovs: bool) -> Result<(), TraceError> {
        Self { width, height, ..Self::default() }.reserve(width as usize * height as usize, aovs)
    }

    /// A copy.
    ///
    /// # Errors
    /// [`TraceError::OutOfMemory`] if the machine has no room for it.
    pub fn try_clone(&self) -> Result<Self, TraceError> {
        let mut copy =
            Self { width: self.width, height: self.height, anchor: self.anchor, ..Self::default() };
        copy.reserve(self.pixels.len(), self.aovs.is_some())?;
        copy.pixels.extend_from_slice(&self.pixels);
        if let (Some(copy), Some(aovs)) = (&mut copy.aovs, &self.aovs) {
            copy.extend_from_slice(aovs);
        }
        Ok(copy)
    }

    /// Makes room for pixels and first-hit outputs.
    fn reserve(&mut self, count: usize, aovs: bool) -> Result<(), TraceError> {
        let mut hits = Vec::new();
        let room = self
            .pixels
            .try_reserve_exact(count)
            .and_then(|()| hits.try_reserve_exact(if aovs { count } else { 0 }));
        self.aovs = aovs.then_some(hits);
        room.map_err(|_| {
            let bytes = size_of::<FilmPixel>() + if aovs { size_of::<Aov>() } else { 0 };
            let gib = count as f64 * bytes as f64 / f64::from(1 << 30);
            TraceError::OutOfMemory(format!(
                "a film of {}x{} pixels takes {gib:.1} GiB",
                self.width, self.height
            ))
        })
    }

    /// Mean radiance of every pixel, linear Rec. 709.
    pub fn beauty(&self) -> Vec<[f32; 3]> {
        self.pixels.iter().map(accumulate::mean).collect()
    }

    /// First-hit outputs with albedo and normal as means over samples; `None` if they were not asked for.
    pub fn first_hits(&self) -> Option<Vec<Aov>> {
        let mean = |(aov, pixel): (&Aov, &FilmPixel)| {
            let share = 1.0 / pixel.count.max(1) as f32;
            Aov { albedo: aov.albedo.map(|c| c * share), normal: aov.normal.map(|c| c * share), ..*aov }
        };
        Some(self.aovs.as_ref()?.iter().zip(&self.pixels).map(mean).collect())
    }

    /// Samples that every pixel has; 0 for a film without pixels.
    pub fn samples(&self) -> u32 {
        self.pixels.iter().map(|pixel| pixel.count).min().unwrap_or(0)
    }

    /// Samples dropped in all pixels together.
    pub fn dropped(&self) -> u64 {
        self.pixels.iter().map(|pixel| u64::from(pixel.dropped)).sum()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_film_larger_than_memory_is_refused_in_words() {
        let error = Film::allocate(u32::MAX, u32::MAX, false).unwrap_err();
        assert!(error.to_string().contains("a film of 4294967295x4294967295 pixels takes"), "{error}");
    }

    #[test]
    fn a_copy_is_equal() {
        let mut film = Film::allocate(3, 2, true).unwrap();
        film.pixels[4].count = 7;
        film.anchor = [1.0, 2.0, 3.0];
        assert_eq!(film.try_clone().unwrap(), film);
        assert_eq!(Film { aovs: None, ..film.clone() }.try_clone().unwrap().aovs, None);
    }
}
