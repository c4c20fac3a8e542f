//! Lights that are sampled: they send what closed forms say, and the three ways to find them make one picture, on both
//! backends (robustness.md L01, L11–L13).
#![allow(clippy::unwrap_used, clippy::print_stdout)]
mod closed_forms;
mod doubles;
mod estimators;
mod gpu;
mod many;
mod picks;
mod scenes;
mod table;
#[path = "../support/welch.rs"]
mod welch;
