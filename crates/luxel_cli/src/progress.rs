//! The progress bar of a render, on stderr when that is a terminal, and the notices beside it.
use std::path::Path;
use std::time::Duration;

use indicatif::{ProgressBar, ProgressStyle};
use luxel_engine::RenderProgress;

/// Steps of the bar.
const STEPS: u64 = 1000;
const TEMPLATE: &str = "{spinner} {prefix} {bar:30} {percent:>3} %  {msg}";

/// Shows how far a render is; silent where nobody watches.
pub(crate) struct ProgressLine {
    bar: ProgressBar,
}

impl ProgressLine {
    /// Begins with the scene's name and no progress.
    pub(crate) fn new(scene: &Path) -> Self {
        let bar = ProgressBar::new(STEPS);
        bar.set_style(
            ProgressStyle::with_template(TEMPLATE).unwrap_or_else(|_| ProgressStyle::default_bar()),
        );
        bar.set_prefix(scene.file_name().unwrap_or_default().to_string_lossy().into_owned());
        bar.enable_steady_tick(Duration::from_millis(100));
        Self { bar }
    }

    /// Says what is going on before there is progress.
    pub(crate) fn stage(&self, what: &'static str) {
        self.bar.set_message(what);
    }

    /// Shows how far it is.
    pub(crate) fn show(&self, progress: &RenderProgress) {
        self.bar.set_position((progress.fraction * STEPS as f64) as u64);
        self.bar.set_message(message(progress));
    }

    /// Prints a line of its own on stderr, above the bar if there is one.
    #[expect(clippy::print_stderr, reason = "notices belong on stderr")]
    pub(crate) fn note(&self, notice: &str) {
        self.bar.suspend(|| eprintln!("note: {notice}"));
    }
}

impl Drop for ProgressLine {
    fn drop(&mut self) {
        self.bar.finish_and_clear();
    }
}

/// Samples, error if it is watched, time so far and to go.
fn message(progress: &RenderProgress) -> String {
    let mut message = format!("{} spp", progress.samples);
    if let Some(error) = progress.error {
        message += &format!(", error {:.2} %", 100.0 * error);
    }
    message += &format!(", {}", clock(progress.secs));
    if let Some(to_go) = secs_to_go(progress) {
        message += &format!(", {} to go", clock(to_go));
    }
    message
}

/// Seconds until the end if work goes on as it did; `None` before anything is done.
fn secs_to_go(progress: &RenderProgress) -> Option<f64> {
    (progress.fraction > 0.0).then(|| progress.secs * (1.0 - progress.fraction) / progress.fraction)
}

/// Seconds as minutes and seconds, hours in front if there are any.
fn clock(secs: f64) -> String {
    let secs = secs.round() as u64;
    let (hours, minutes, secs) = (secs / 3600, secs / 60 % 60, secs % 60);
    if hours > 0 { format!("{hours}:{minutes:02}:{secs:02}") } else { format!("{minutes}:{secs:02}") }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn at(fraction: f64, secs: f64, error: Option<f64>) -> RenderProgress {
        RenderProgress { fraction, samples: 16, secs, error }
    }

    #[test]
    fn the_line_says_how_far_and_how_long() {
        assert_eq!(message(&at(0.25, 10.0, None)), "16 spp, 0:10, 0:30 to go");
        assert_eq!(message(&at(0.0, 1.0, None)), "16 spp, 0:01");
        assert_eq!(message(&at(0.5, 90.0, Some(0.0213))), "16 spp, error 2.13 %, 1:30, 1:30 to go");
        assert_eq!(clock(3_725.4), "1:02:05");
    }

    #[test]
    fn the_template_is_sound() {
        ProgressStyle::with_template(TEMPLATE).unwrap();
    }
}
