//! A figure of the page, and what may stand in it.
use super::chart::Chart;
use super::verdict::Verdict;

/// A figure of the report redone, or one that it lacks.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Figure {
    /// In the order of the page; the report's have its numbers.
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
    /// Several, side by side: PNG in base64, and the text below.
    Pictures(Vec<(String, String)>),
    Table(Table),
    /// An `svg` element.
    Drawing(String),
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
