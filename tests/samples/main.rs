//! Samples as statistics sees them: noise falls as it must (L14), seeds and pixels know nothing of each other (L15), and a
//! sample that is not a number is dropped, counted and forgotten (L18).
#![allow(clippy::unwrap_used, clippy::print_stdout)]
mod poison;
mod scenes;
mod seeds;
mod slope;
#[path = "../support/welch.rs"]
mod welch;
