//! Surface scattering against what must hold for any material: energy, densities, reciprocity, extremes.
#![allow(clippy::unwrap_used, clippy::print_stdout)]
mod bounds;
mod closures;
mod densities;
mod extremes;
mod furnace;
mod glass;
mod reciprocity;
mod tint;
