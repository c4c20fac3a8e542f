//! The figures, from records alone: what each shows, what the report claims with it, and whether that holds.
mod depth;
mod extra;
mod heat;
mod large;
mod leaves;
mod orders;
mod pictures;
mod versus;

use super::chart::{Chart, Kind, Series};
use super::figure::{Figure, Part};
use super::select::Runs;

/// The last figure of the report.
pub(crate) const LAST_OF_REPORT: u32 = 21;

/// Every figure, in the order of their numbers.
pub(crate) fn figures(runs: &Runs<'_>) -> Vec<Figure> {
    let mut figures = pictures::figures(runs);
    figures.push(orders::figure());
    figures.extend(heat::figures(runs));
    figures.extend(versus::figures(runs));
    figures.extend(depth::figures(runs));
    figures.extend(leaves::figures(runs));
    figures.extend(extra::figures(runs));
    figures.extend(large::figures(runs));
    figures.sort_by_key(|figure| figure.number);
    figures
}

/// A series over numbers of spheres, or any other setting.
fn series<T: Copy>(name: impl Into<String>, over: &[T], value: impl Fn(T) -> Option<f64>) -> Series {
    Series { name: name.into(), values: over.iter().map(|x| value(*x)).collect() }
}

/// Frames per second over numbers of spheres, as lines.
fn fps_over_counts(caption: String, counts: &[u32], is_log: bool, series: Vec<Series>) -> Part {
    over_counts(caption, Kind::Lines, "frames per second", counts, is_log, series)
}

fn over_counts(
    caption: String,
    kind: Kind,
    y: &'static str,
    counts: &[u32],
    is_log: bool,
    series: Vec<Series>,
) -> Part {
    let categories = counts.iter().map(|count| super::text::count(u64::from(*count))).collect();
    Part::Chart(Chart { caption, kind, x: "number of spheres", y, is_log, categories, series, level: None })
}

#[cfg(test)]
mod tests {
    use super::super::record::{Run, Sweep, example};
    use super::super::verdict::Answer;
    use super::*;

    fn answer(runs: &[Run], number: u32) -> Answer {
        figures(&Runs::all(runs)).iter().find(|figure| figure.number == number).unwrap().verdict.answer
    }

    /// Runs of a sweep: structure, spheres, depth, smallest node, frames per second.
    fn made(sweep: Sweep, rows: &[(&str, u32, u32, u32, f64)]) -> Vec<Run> {
        let run = |&(structure, spheres, depth, min_spheres, fps): &(&str, u32, u32, u32, f64)| Run {
            sweep,
            structure: structure.to_owned(),
            spheres,
            asked_depth: depth,
            max_depth: depth.min(20),
            min_spheres,
            fps,
            frame_ms: 1e3 / fps,
            ..example()
        };
        rows.iter().map(run).collect()
    }

    #[test]
    fn every_number_is_there_once_and_says_something_even_without_runs() {
        let all = figures(&Runs::all(&[]));
        let numbers: Vec<u32> = all.iter().map(|figure| figure.number).collect();
        let expected: Vec<u32> = (1..=numbers.len() as u32).collect();
        assert!(numbers == expected && numbers.len() as u32 > LAST_OF_REPORT, "{numbers:?}");
        for figure in &all {
            assert!(!figure.title.is_empty() && !figure.shows.is_empty() && !figure.claim.is_empty());
            assert!(!figure.verdict.because.is_empty());
            let measured = figure.verdict.answer != Answer::NotMeasured;
            assert_eq!(measured, figure.number == 3, "figure {}", figure.number);
        }
    }

    #[test]
    fn a_growing_advantage_holds_and_a_shrinking_one_does_not() {
        let runs = |late: f64| {
            let mut rows = Vec::new();
            for (count, ratio) in [(500, 2.0), (1000, 4.0), (2000, late)] {
                rows.push(("naive", count, 20, 8, 10.0));
                rows.push(("octree-seed", count, 6, 1, 10.0 * ratio));
                rows.push(("octree", count, 20, 8, 10.0 * ratio));
            }
            made(Sweep::Counts, &rows)
        };
        assert_eq!(answer(&runs(8.0), 12), Answer::Holds);
        assert_eq!(answer(&runs(1.0), 12), Answer::Fails);
        assert_eq!(answer(&runs(3.0), 12), Answer::Partly);
        assert_eq!(answer(&runs(8.0), 11), Answer::Holds);
    }

    #[test]
    fn the_best_depth_must_grow() {
        let runs = |small: u32, large: u32| {
            let mut rows = Vec::new();
            for (count, best) in [(10, small), (2000, large)] {
                for depth in 0..=5 {
                    for structure in ["octree", "octree-seed"] {
                        let fps = if depth == best { 100.0 } else { 50.0 };
                        rows.push((structure, count, depth, 1, fps));
                    }
                }
            }
            made(Sweep::Depth, &rows)
        };
        assert_eq!((answer(&runs(1, 4), 15), answer(&runs(1, 4), 27)), (Answer::Holds, Answer::Holds));
        assert_eq!((answer(&runs(4, 1), 15), answer(&runs(4, 1), 27)), (Answer::Fails, Answer::Fails));
    }

    #[test]
    fn one_sphere_per_node_must_beat_none() {
        let runs = |with_one: f64| {
            let mut rows = Vec::new();
            for count in [250, 500, 1000] {
                for structure in ["octree", "octree-seed"] {
                    rows.push((structure, count, 3, 0, 100.0));
                    rows.push((structure, count, 3, 1, with_one));
                }
            }
            made(Sweep::Depth, &rows)
        };
        assert_eq!(answer(&runs(150.0), 20), Answer::Holds);
        assert_eq!(answer(&runs(50.0), 20), Answer::Fails);
    }

    #[test]
    fn depth_beyond_need_must_change_nothing() {
        let runs = |double: f64| {
            let mut rows = Vec::new();
            for structure in ["octree", "octree-seed"] {
                for (depth, fps) in [(50, 100.0), (100, 98.0), (200, double)] {
                    rows.push((structure, 100, depth, 1, fps));
                }
            }
            made(Sweep::Fraction, &rows)
        };
        assert_eq!(answer(&runs(97.0), 16), Answer::Holds);
        assert_eq!(answer(&runs(40.0), 16), Answer::Fails);
    }

    #[test]
    fn wrong_pixels_are_reported_as_they_are() {
        let runs = |wrong: f64| {
            let mut runs =
                made(Sweep::Counts, &[("octree-seed", 100, 5, 1, 90.0), ("octree", 100, 20, 8, 80.0)]);
            runs[0].wrong_pixels = Some(wrong);
            runs
        };
        assert_eq!(answer(&runs(0.04), 22), Answer::Holds);
        assert_eq!(answer(&runs(0.0), 22), Answer::Fails);
    }
}
