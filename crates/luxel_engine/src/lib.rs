//! Composition root: world, schedules, headless runner, backend choice, output files
pub mod output;
