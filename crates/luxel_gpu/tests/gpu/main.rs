//! The room on a real device (hardware or lavapipe).

#![allow(clippy::unwrap_used)]

mod buffers;
mod kernels;
mod lost;
mod passes;
mod probing;
mod shaders;
