//! The sphere cases of robustness.md on the GPU, for every structure over the spheres.
#![allow(clippy::unwrap_used, clippy::print_stdout)]
mod accuracy;
mod compare;
mod o01;
mod scene;
mod shapes;
mod upload;
