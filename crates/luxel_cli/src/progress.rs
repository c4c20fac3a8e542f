//! The progress bar of a render or study, on stderr when that is a terminal, and the notices beside it. A study, which
//! may take an hour, tells how far it is now and then where there is no terminal.
use std::cell::Cell;
use std::path::Path;
use std::time::{Duration, Instant};

use indicatif::{ProgressBar, ProgressStyle};
use luxel_engine::RenderProgress;
use luxel_study::octree::StudyProgress;

/// Steps of the bar.
const STEPS: u64 = 1000;
/// How often a study tells how far it is where there is no terminal.
const TELL_EVERY: Duration = Duration::from_secs(10);
/// Part of a study before which nothing is said about its end: it begins with pictures, which take longer than most runs.
const TELLING_PART: f64 = 0.05;
const TEMPLATE: &str = "{spinner} {prefix} {bar:30} {percent:>3} %  {msg}";

/// Shows how far a render or study is.
pub(crate) struct ProgressLine {
    bar: ProgressBar,
    /// When it was last told without a terminal.
    told: Cell<Instant>,
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
        Self { bar, told: Cell::new(Instant::now()) }
    }

    /// Says what is going on before there is progress.
    pub(crate) fn stage(&self, what: &'static str) {
        self.bar.set_message(what);
    }

    /// Shows how far a render is; silent where nobody watches.
    pub(crate) fn show(&self, progress: &RenderProgress) {
        self.bar.set_position((progress.fraction * STEPS as f64) as u64);
        self.bar.set_message(message(progress));
    }

    /// Shows how far a study is.
    pub(crate) fn show_study(&self, progress: &StudyProgress) {
        self.bar.set_position((progress.fraction * STEPS as f64) as u64);
        self.bar.set_message(study_message(progress));
        if self.bar.is_hidden() && self.told.get().elapsed() >= TELL_EVERY {
            self.told.set(Instant::now());
            self.note(&format!("{:.0} %, {}", 100.0 * progress.fraction, study_message(progress)));
        }
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
    message + &to_go(progress.fraction, progress.secs)
}

/// What is measured, time so far and to go.
fn study_message(progress: &StudyProgress) -> String {
    let known = if progress.fraction < TELLING_PART { 0.0 } else { progress.fraction };
    format!("{}, {}{}", progress.what, clock(progress.secs), to_go(known, progress.secs))
}

/// Time until the end if work goes on as it did; nothing before anything is done.
fn to_go(fraction: f64, secs: f64) -> String {
    if fraction > 0.0 {
        format!(", {} to go", clock(secs * (1.0 - fraction) / fraction))
    } else {
        String::new()
    }
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
        let study = StudyProgress { fraction: 0.5, what: "CPU, 10 spheres, bvh".to_owned(), secs: 30.0 };
        assert_eq!(study_message(&study), "CPU, 10 spheres, bvh, 0:30, 0:30 to go");
        assert_eq!(study_message(&StudyProgress { fraction: 0.01, ..study }), "CPU, 10 spheres, bvh, 0:30");
    }

    #[test]
    fn the_template_is_sound() {
        ProgressStyle::with_template(TEMPLATE).unwrap();
    }
}
