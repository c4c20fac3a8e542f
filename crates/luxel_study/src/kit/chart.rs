//! Charts as SVG: lines or bars over categories, with axes, units and a logarithmic scale where it is wanted.
//!
//! Drawn by `plotters` without any font: texts are elements that the reader's browser sets. The legend is made by
//! the page from the names and colours of the series, so that it never covers data.
use plotters::coord::Shift;
use plotters::coord::combinators::BindKeyPoints;
use plotters::coord::ranged1d::{Ranged, ValueFormatter};
use plotters::coord::types::RangedCoordf64;
use plotters::drawing::DrawingAreaErrorKind;
use plotters::prelude::*;

use super::text::short;
use crate::StudyError;

type DrawError = DrawingAreaErrorKind<std::io::Error>;

const SIZE: (u32, u32) = (760, 400);
/// Part of a category's width that its bars fill.
const BARS: f64 = 0.8;
/// Colours that people with any kind of colour vision can tell apart (Okabe and Ito 2008), without yellow.
const COLORS: [RGBColor; 7] = [
    RGBColor(0, 114, 178),
    RGBColor(213, 94, 0),
    RGBColor(0, 158, 115),
    RGBColor(204, 121, 167),
    RGBColor(86, 180, 233),
    RGBColor(230, 159, 0),
    RGBColor(70, 70, 70),
];

/// How the series are drawn.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Kind {
    Lines,
    Bars,
}

/// How a series is told from others: the same in every chart.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Ink {
    color: RGBColor,
    is_dashed: bool,
}

impl Ink {
    /// One of a few distinct colours.
    pub(crate) fn distinct(index: usize) -> Self {
        Self { color: COLORS[index % COLORS.len()], is_dashed: false }
    }

    /// A colour of an ordered scale, by the place from 0 to 1.
    pub(crate) fn scale(place: f64) -> Self {
        let place = place.clamp(0.0, 1.0);
        let HSLColor(hue, saturation, light) = HSLColor(0.72 * (1.0 - place), 0.75, 0.32 + 0.1 * place);
        let (red, green, blue) = HSLColor(hue, saturation, light).rgb();
        Self { color: RGBColor(red, green, blue), is_dashed: false }
    }

    /// The same colour, its line with gaps if so wished.
    pub(crate) fn dashed(self, is_dashed: bool) -> Self {
        Self { is_dashed, ..self }
    }

    /// As the background of a swatch in CSS.
    pub(crate) fn css(self) -> String {
        let RGBColor(red, green, blue) = self.color;
        let color = format!("#{red:02x}{green:02x}{blue:02x}");
        if self.is_dashed {
            format!("repeating-linear-gradient(90deg,{color} 0 4px,transparent 4px 6px)")
        } else {
            color
        }
    }
}

/// Values over the categories; `None` where nothing was measured.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Series {
    pub(crate) name: String,
    pub(crate) ink: Ink,
    pub(crate) values: Vec<Option<f64>>,
}

/// A chart.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Chart {
    pub(crate) caption: String,
    pub(crate) kind: Kind,
    /// What the categories are.
    pub(crate) x: &'static str,
    /// What the values are, with their unit.
    pub(crate) y: &'static str,
    pub(crate) is_log: bool,
    pub(crate) categories: Vec<String>,
    pub(crate) series: Vec<Series>,
    /// A value to compare with, drawn as a line across.
    pub(crate) level: Option<f64>,
}

impl Chart {
    /// Values that can be shown: all, or those above 0 on a logarithmic scale.
    fn shown(&self) -> impl Iterator<Item = f64> {
        let values = self.series.iter().flat_map(|series| series.values.iter().copied().flatten());
        values.filter(|value| !self.is_log || *value > 0.0)
    }

    /// True if there is nothing to draw.
    pub(crate) fn is_empty(&self) -> bool {
        self.shown().next().is_none()
    }

    /// The chart as an `svg` element.
    pub(crate) fn svg(&self) -> Result<String, StudyError> {
        let mut svg = String::new();
        let area = SVGBackend::with_string(&mut svg, SIZE).into_drawing_area();
        self.draw(&area).map_err(|error| StudyError::Page(format!("chart '{}': {error}", self.caption)))?;
        drop(area);
        Ok(svg)
    }

    fn draw(&self, area: &DrawingArea<SVGBackend<'_>, Shift>) -> Result<(), DrawError> {
        let (low, high) = self.range();
        let across = -0.5..self.categories.len() as f64 - 0.5;
        let mut builder = ChartBuilder::on(area);
        builder.margin(12).x_label_area_size(46).y_label_area_size(64);
        if self.is_log {
            let ticks = (low..high).log_scale().with_key_points(log_ticks(low, high));
            let mut chart = builder.build_cartesian_2d(across, ticks)?;
            self.fill(&mut chart, low)?;
        } else {
            let mut chart = builder.build_cartesian_2d(across, low..high)?;
            self.fill(&mut chart, low)?;
        }
        area.present()?;
        Ok(())
    }

    /// The least and the most of the value axis.
    fn range(&self) -> (f64, f64) {
        let level = self.level.filter(|_| !self.is_empty());
        let most = self.shown().chain(level).fold(f64::MIN_POSITIVE, f64::max);
        if !self.is_log {
            return (0.0, 1.08 * most);
        }
        let least = self.shown().chain(level).fold(most, f64::min);
        (least / 1.5, (most * 1.5).max(least * 3.0))
    }

    fn fill<'a, Y>(
        &self,
        chart: &mut ChartContext<'a, SVGBackend<'a>, Cartesian2d<RangedCoordf64, Y>>,
        low: f64,
    ) -> Result<(), DrawError>
    where
        Y: Ranged<ValueType = f64> + ValueFormatter<f64>,
    {
        chart
            .configure_mesh()
            .disable_x_mesh()
            .light_line_style(RGBColor(238, 238, 238))
            .bold_line_style(RGBColor(221, 221, 221))
            .axis_style(RGBColor(85, 85, 85))
            .label_style(("sans-serif", 14))
            .axis_desc_style(("sans-serif", 15))
            .x_desc(self.x)
            .y_desc(self.y)
            .x_labels(2 * self.categories.len() + 1)
            .y_labels(8)
            .max_light_lines(0)
            .x_label_formatter(&|place| self.category(*place))
            .y_label_formatter(&|value| short(*value))
            .draw()?;
        if let Some(level) = self.level {
            let ends = [(-0.5, level), (self.categories.len() as f64 - 0.5, level)];
            chart.draw_series(DashedLineSeries::new(ends, 6, 4, RGBColor(120, 120, 120).into()))?;
        }
        for (index, series) in self.series.iter().enumerate() {
            let Ink { color, is_dashed } = series.ink;
            match self.kind {
                Kind::Lines => {
                    let points = || self.points(series);
                    if is_dashed {
                        chart.draw_series(DashedLineSeries::new(
                            points().collect::<Vec<_>>(),
                            7,
                            4,
                            color.stroke_width(2),
                        ))?;
                    } else {
                        chart.draw_series(LineSeries::new(points(), color.stroke_width(2)))?;
                    }
                    chart.draw_series(points().map(|point| Circle::new(point, 3, color.filled())))?;
                }
                Kind::Bars => {
                    let width = BARS / self.series.len() as f64;
                    let left = index as f64 * width - 0.5 * BARS;
                    let bar = |(x, y): (f64, f64)| {
                        let corners = [(x + left, low), (x + left + 0.92 * width, y)];
                        Rectangle::new(corners, color.filled())
                    };
                    chart.draw_series(self.points(series).map(bar))?;
                }
            }
        }
        Ok(())
    }

    fn points<'s>(&self, series: &'s Series) -> impl Iterator<Item = (f64, f64)> + use<'s> {
        let is_log = self.is_log;
        let points = series.values.iter().enumerate();
        let points = points.filter_map(|(i, value)| value.map(|value| (i as f64, value)));
        points.filter(move |(_, value)| !is_log || *value > 0.0)
    }

    /// The category at a place of the axis; nothing between two.
    fn category(&self, place: f64) -> String {
        let nearest = place.round();
        let is_there = (place - nearest).abs() < 1e-6 && nearest >= 0.0;
        let category = is_there.then(|| self.categories.get(nearest as usize)).flatten();
        category.cloned().unwrap_or_default()
    }
}

/// 1, 2 and 5 times the powers of ten of a range, or the powers alone if it is wide.
fn log_ticks(low: f64, high: f64) -> Vec<f64> {
    let steps: &[f64] = if high / low > 1000.0 { &[1.0] } else { &[1.0, 2.0, 5.0] };
    let decades = low.log10().floor() as i32..=high.log10().ceil() as i32;
    let ticks = decades.flat_map(|decade| steps.iter().map(move |step| step * 10f64.powi(decade)));
    ticks.filter(|tick| (low..=high).contains(tick)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn chart(kind: Kind, is_log: bool, values: Vec<Option<f64>>) -> Chart {
        Chart {
            caption: "c".to_owned(),
            kind,
            x: "spheres",
            y: "frames per second",
            is_log,
            categories: ["10", "50", "a<b"].map(str::to_owned).to_vec(),
            series: vec![Series { name: "octree".to_owned(), ink: Ink::distinct(0), values }],
            level: Some(144.0),
        }
    }

    #[test]
    fn every_category_and_value_is_drawn() {
        for (kind, shape) in [(Kind::Lines, "<circle"), (Kind::Bars, "<rect")] {
            for is_log in [false, true] {
                let svg = chart(kind, is_log, vec![Some(1.0), None, Some(900.0)]).svg().unwrap();
                for part in ["viewBox", "spheres", "frames per second", "10", "50", "a&lt;b"] {
                    assert!(svg.contains(part), "no {part}");
                }
                // A chart's background may be a rectangle too.
                assert!(svg.matches(shape).count() >= 2, "{kind:?}");
            }
        }
    }

    #[test]
    fn nothing_and_nothing_but_zero_can_be_drawn() {
        for values in [vec![], vec![None, None], vec![Some(0.0)]] {
            let chart = chart(Kind::Lines, true, values);
            assert!(chart.is_empty());
            chart.svg().unwrap();
        }
        assert!(!chart(Kind::Bars, false, vec![Some(0.0)]).is_empty());
        chart(Kind::Bars, false, vec![Some(0.0)]).svg().unwrap();
    }

    #[test]
    fn a_logarithmic_axis_names_round_values_of_its_range() {
        assert_eq!(log_ticks(15.0, 210.0), [20.0, 50.0, 100.0, 200.0]);
        assert_eq!(log_ticks(0.5, 20_000.0), [1.0, 10.0, 100.0, 1000.0, 10_000.0]);
    }

    #[test]
    fn inks_differ() {
        let distinct = (0..COLORS.len()).map(Ink::distinct);
        let inks = distinct.chain((0..=10).map(|i| Ink::scale(f64::from(i) / 10.0)));
        let css: std::collections::HashSet<String> =
            inks.flat_map(|ink| [ink.css(), ink.dashed(true).css()]).collect();
        assert_eq!(css.len(), 2 * (COLORS.len() + 11));
    }
}
