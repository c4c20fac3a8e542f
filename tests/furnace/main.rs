//! Furnaces: closed rooms whose radiance is known exactly (robustness.md L01, L03, V04, V08; REFERENCES.json).
//!
//! In a closed room of albedo ρ whose walls emit L, light that scatters at most k times gives L (1 + ρ + … + ρᵏ) in
//! every direction. Each path adds up that sum whatever way it takes, so there is no noise: one ray that slips out, one
//! bounce too many, or one lost sample shows. Outside, the sky is bright enough to betray a single leak.
#![allow(clippy::unwrap_used, clippy::print_stdout, reason = "tests; the lines say what was left out")]
mod absorption;
mod glass;
mod nested;
mod room;
mod slabs;
mod walls;
