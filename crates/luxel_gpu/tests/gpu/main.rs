//! The room on a real device (hardware or lavapipe).

mod buffers;
mod kernels;
mod lost;
mod passes;
mod probing;
mod shaders;
