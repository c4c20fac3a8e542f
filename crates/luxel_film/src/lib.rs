//! What both backends share after a sample: accumulation, error, stop rules, tone mapping, views.
//!
//! A backend is a [`Tracer`]: it adds radiance to a [`Film`], one [`FilmPixel`](luxel_flat::FilmPixel) per
//! pixel, with the arithmetic of [`accumulate`]. Everything downstream reads a film: [`ImageError`] tells how
//! far it is, a [`StopRule`] when it is done, [`Display`] makes it a picture, [`Layer`] a table of numbers.
//!
//! ```
//! use luxel_film::{Display, Film, View, accumulate};
//!
//! let mut film = Film::new(2, 1);
//! accumulate::add_sample(&mut film.pixels[0], [1.0, 1.0, 1.0]);
//! accumulate::add_sample(&mut film.pixels[0], [f32::NAN, 0.0, 0.0]); // dropped, and counted
//! assert_eq!(film.beauty()[0], [1.0; 3]);
//! assert_eq!(film.dropped(), 1);
//! assert_eq!(Display::default().pixels(&film, View::PathTraced).unwrap(), [[255; 3], [0; 3]]);
//! ```
pub mod accumulate;
pub mod aov;
pub mod error;
pub mod film;
pub mod stop;
pub mod tonemap;
pub mod tracer;
pub mod view;

pub use aov::{AovKind, Layer};
pub use error::ImageError;
pub use film::Film;
pub use stop::{StopRule, StopState};
pub use tonemap::ToneMap;
pub use tracer::{
    Backend, BackendFacts, FilmKey, PassTime, Progress, TraceError, TraceRequest, TraceStats, Tracer,
};
pub use view::{Display, View};
