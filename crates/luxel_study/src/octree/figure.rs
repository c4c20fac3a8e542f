//! A figure of the page, and what may stand in it.
use super::chart::Chart;
use super::record::Run;
use super::verdict::Verdict;

/// A figure of the report redone, or one that it lacks.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Figure {
    /// 1 to 21 are the report's.
    pub(crate) number: u32,
    pub(crate) title: String,
    /// One sentence: what is to be seen.
    pub(crate) shows: String,
    /// What the report claims, or what one would expect; `None` if nothing.
    pub(crate) claim: Option<String>,
    pub(crate) verdict: Verdict,
    pub(crate) parts: Vec<Part>,
}

/// Part of a figure.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Part {
    Chart(Chart),
    Heat(Heat),
    /// PNG in base64, and what it shows.
    Picture(String, String),
    Table(Table),
    /// The cells of a cube and the eight directions in which they are visited.
    Cube,
}

impl Part {
    /// Draws a value to compare with across a chart.
    pub(crate) fn with_level(self, level: f64) -> Self {
        match self {
            Self::Chart(chart) => Self::Chart(Chart { level: Some(level), ..chart }),
            other => other,
        }
    }
}

/// Rows of texts under a head.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Table {
    pub(crate) head: Vec<String>,
    pub(crate) rows: Vec<Vec<String>>,
}

/// Frames per second by two settings; the colour follows the logarithm.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Heat {
    pub(crate) caption: String,
    pub(crate) corner: &'static str,
    pub(crate) columns: Vec<String>,
    pub(crate) rows: Vec<(String, Vec<Option<f64>>)>,
}

/// The setting of a sweep in words: `low quality (4 samples, depth 4), 96x72, CPU`.
pub(crate) fn setting(run: Option<&Run>) -> String {
    match run {
        None => "not measured".to_owned(),
        Some(run) => format!(
            "{} quality ({} samples, depth {}), {}x{}, {}",
            run.quality,
            run.spp,
            run.bounces,
            run.width,
            run.height,
            super::select::backend_name(&run.backend)
        ),
    }
}
