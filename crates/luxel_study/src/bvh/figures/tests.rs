//! Answers to made-up records, in both directions.
use super::super::plan::{BOUNCED, DIRECT, SHADINGS, SMOOTHNESS};
use super::super::record::{Sweep, example};
use super::*;
use crate::kit::picture::png;
use crate::kit::verdict::Answer;

const FIRST: u32 = 6;
const LAST: u32 = 24;

fn figure(runs: &[Run], number: u32) -> Figure {
    figures(&Runs::all(runs)).into_iter().find(|figure| figure.number == number).unwrap()
}

fn answer(runs: &[Run], number: u32) -> Answer {
    figure(runs, number).verdict.answer
}

fn run(sweep: Sweep, structure: &str, triangles: u32, fps: f64) -> Run {
    let run = Run { sweep, structure: structure.to_owned(), triangles, ..example() };
    run.with_frames([1e3 / fps; 3])
}

/// A picture of one grey.
fn grey(value: u8) -> Option<String> {
    let picture = luxel_engine::output::Picture { width: 16, height: 9, pixels: vec![[value; 3]; 144] };
    Some(png(&picture).unwrap())
}

fn varied(sweep: Sweep, variant: &str, value: u8) -> Run {
    Run { variant: variant.to_owned(), picture_png: grey(value), ..run(sweep, "bvh", 1000, 10.0) }
}

#[test]
fn every_number_is_there_once_and_says_something_even_without_runs() {
    let all = figures(&Runs::all(&[]));
    let numbers: Vec<u32> = all.iter().map(|figure| figure.number).collect();
    assert!(numbers.iter().copied().eq(FIRST..=LAST), "{numbers:?}");
    for figure in &all {
        assert!(!figure.title.is_empty() && !figure.shows.is_empty());
        assert_eq!(figure.claim.is_none(), [10, 11, 12, 21].contains(&figure.number), "{}", figure.number);
        assert!(!figure.verdict.because.is_empty());
        assert_eq!(figure.verdict.answer, Answer::NotMeasured, "figure {}", figure.number);
    }
}

#[test]
fn only_a_hardware_gpu_can_miss_the_reports_frame_rates() {
    for (sweep, number) in [(Sweep::Bunny, 6), (Sweep::Room, 8)] {
        let at = |fps: f64, hardware_gpu| {
            let whole = Run { width: 1920, height: 1080, hardware_gpu, ..run(sweep, "bvh", 70_000, fps) };
            answer(&[Run { backend: "gpu".to_owned(), ..whole }], number)
        };
        assert_eq!([at(500.0, true), at(500.0, false)], [Answer::Holds; 2]);
        assert_eq!([at(5.0, true), at(5.0, false)], [Answer::Fails, Answer::Open]);
    }
    let near = |fps: f64| {
        let far = Run { view: "far".to_owned(), ..run(Sweep::Views, "bvh", 70_000, 100.0) };
        let near = Run { view: "near".to_owned(), ..run(Sweep::Views, "bvh", 70_000, fps) };
        answer(&[far, near], 6)
    };
    assert_eq!([near(50.0), near(101.0), near(300.0)], [Answer::Holds, Answer::Open, Answer::Fails]);
}

#[test]
fn flat_shading_must_be_seen_and_more_so_with_reflections() {
    let runs = |smooth: [u8; 2]| {
        let values = [100, smooth[0], 100, smooth[1]];
        SHADINGS
            .iter()
            .zip(values)
            .map(|(row, value)| varied(Sweep::Shading, row.0, value))
            .collect::<Vec<_>>()
    };
    assert_eq!(answer(&runs([110, 160]), 7), Answer::Holds);
    assert_eq!(answer(&runs([160, 110]), 7), Answer::Partly);
    assert_eq!(answer(&runs([100, 100]), 7), Answer::Fails);
}

#[test]
fn a_shadow_must_become_lighter() {
    let runs = |bounced| {
        [(DIRECT, 0.3), (BOUNCED, bounced)]
            .map(|(variant, dark)| Run { dark: Some(dark), ..varied(Sweep::Shadow, variant, 50) })
    };
    assert_eq!([answer(&runs(0.01), 9), answer(&runs(0.2), 9)], [Answer::Holds, Answer::Fails]);
}

#[test]
fn half_smooth_must_lie_between_diffuse_and_mirror() {
    let runs = |half: u8| {
        let values = [50, half, 150];
        SMOOTHNESS
            .iter()
            .zip(values)
            .map(|(row, value)| varied(Sweep::Floor, row.0, value))
            .collect::<Vec<_>>()
    };
    assert_eq!(answer(&runs(100), 13), Answer::Holds);
    assert_eq!(answer(&runs(255), 13), Answer::Partly);
}

#[test]
fn both_backends_must_show_the_same_and_a_software_driver_is_no_gpu() {
    let runs = |gray: u8, fps: f64, hardware_gpu| {
        let gpu = Run { backend: "gpu".to_owned(), hardware_gpu, fps, ..varied(Sweep::Reference, "", gray) };
        [varied(Sweep::Reference, "", 100), gpu]
    };
    assert_eq!(answer(&runs(100, 200.0, true), 14), Answer::Holds);
    assert_eq!(answer(&runs(100, 1.0, false), 14), Answer::Open);
    assert_eq!(answer(&runs(160, 1.0, false), 14), Answer::Fails);
    assert_eq!(answer(&runs(100, 1.0, true), 14), Answer::Partly);
    assert_eq!(answer(&runs(100, 1.0, true)[..1], 14), Answer::NotMeasured);
    // Ten frames of 192 × 108 per second, a hundredth of the report's: 10 s per sample.
    let sized = runs(100, 1.0, false).map(|run| Run { width: 192, height: 108, picture_spp: 60, ..run });
    let because = figure(&sized, 14).verdict.because;
    assert!(because.contains("with 60 samples per pixel the picture is 10 minutes on this CPU"), "{because}");
}

#[test]
fn structures_are_compared_in_both_directions() {
    let runs = |escape: f64, ordered: f64| {
        let of = |name: &str, fps| run(Sweep::Counts, name, 4500, fps);
        [of("naive", 10.0), of("bvh-escape", 10.0 * escape), of("bvh", 10.0 * ordered)]
    };
    assert_eq!([answer(&runs(9.0, 9.0), 15), answer(&runs(0.5, 0.5), 15)], [Answer::Holds, Answer::Fails]);
    assert_eq!(answer(&runs(9.0, 0.5), 15), Answer::Partly);
    assert_eq!(
        [answer(&runs(9.0, 3.0), 18), answer(&runs(3.0, 9.0), 18), answer(&runs(9.0, 9.1), 18)],
        [Answer::Holds, Answer::Fails, Answer::Open]
    );
}

#[test]
fn the_memory_of_both_walks_is_told_beside_their_speed() {
    let runs = [("bvh-escape", 10.0), ("bvh", 5.0)].map(|(name, fps)| Run {
        nodes: 1000,
        depth: 20,
        ..run(Sweep::Counts, name, 4500, fps)
    });
    let figure = figure(&runs, 18);
    assert!(figure.claim.unwrap().contains("not judged"));
    let because = figure.verdict.because;
    assert!(because.contains("4,000 bytes in all") && because.contains("160 bytes per ray"), "{because}");
}

#[test]
fn costs_of_different_trees_do_not_stand_side_by_side() {
    let heads = |sweep, number| {
        let figure = figure(&[run(sweep, "bvh", 70_000, 1.0)], number);
        let tables = figure.parts.into_iter().filter_map(|part| match part {
            Part::Table(table) => Some(table.head),
            _ => None,
        });
        tables.flatten().collect::<Vec<String>>()
    };
    assert!(!heads(Sweep::Levels, 23).contains(&"cost".to_owned()));
    assert!(heads(Sweep::Views, 22).contains(&"cost".to_owned()));
}

#[test]
fn a_gain_of_a_hundred_frames_is_one_at_the_size_of_the_report() {
    let runs = |fps: f64| {
        let of = |name: &str, fps| {
            let run =
                Run { width: 1920, height: 1080, hardware_gpu: true, ..run(Sweep::Counts, name, 980, fps) };
            Run { backend: "gpu".to_owned(), ..run }
        };
        [of("naive", 10.0), of("bvh", fps)]
    };
    assert_eq!([answer(&runs(150.0), 17), answer(&runs(90.0), 17)], [Answer::Holds, Answer::Fails]);
    let small = runs(150.0).map(|run| Run { width: 192, height: 108, hardware_gpu: false, ..run });
    assert_eq!(answer(&small, 17), Answer::Open);
}

#[test]
fn work_must_grow_with_the_logarithm() {
    let runs = |last: f64| {
        let at = |count, nodes_per_ray| Run { nodes_per_ray, ..run(Sweep::Counts, "bvh", count, 10.0) };
        [at(1000, 20.0), at(4000, 24.0), at(64_000, last)]
    };
    assert_eq!([answer(&runs(35.0), 16), answer(&runs(900.0), 16)], [Answer::Holds, Answer::Fails]);
}

#[test]
fn presets_must_cost_more_and_yield_no_worse() {
    let runs = |secs: [f64; 4], costs: [f64; 4]| {
        let presets = super::super::select::PRESETS.iter().zip(secs.into_iter().zip(costs));
        let of = |(preset, (build_secs, sah_cost)): (&&str, (f64, f64))| {
            let preset = (*preset).to_owned();
            Run { preset, build_secs, sah_cost, ..run(Sweep::Presets, "bvh", 70_000, 10.0) }
        };
        presets.map(of).collect::<Vec<_>>()
    };
    assert_eq!(answer(&runs([1.0, 2.0, 4.0, 8.0], [9.0, 8.0, 7.0, 6.0]), 19), Answer::Holds);
    assert_eq!(answer(&runs([8.0, 4.0, 2.0, 1.0], [6.0, 7.0, 8.0, 9.0]), 19), Answer::Fails);
}

#[test]
fn bins_must_converge() {
    let runs = |costs: [f64; 4]| {
        let of = |(bins, sah_cost)| Run { bins, sah_cost, ..run(Sweep::Bins, "bvh", 70_000, 10.0) };
        [2, 4, 8, 16].into_iter().zip(costs).map(of).collect::<Vec<_>>()
    };
    assert_eq!(answer(&runs([50.0, 40.0, 38.0, 37.9]), 20), Answer::Holds);
    assert_eq!(answer(&runs([37.0, 37.1, 38.0, 50.0]), 20), Answer::Fails);
}

#[test]
fn the_heuristic_must_do_poorly_inside() {
    let runs = |far: f64, inside: f64| {
        let of = |view: &str, split: &str, fps| {
            let (view, split) = (view.to_owned(), split.to_owned());
            Run { view, split, ..run(Sweep::Views, "bvh", 70_000, fps) }
        };
        [
            of("far", "sah", 10.0 * far),
            of("far", "largest-axis", 10.0),
            of("inside", "sah", 10.0 * inside),
            of("inside", "largest-axis", 10.0),
        ]
    };
    assert_eq!(answer(&runs(2.0, 0.5), 22), Answer::Holds);
    assert_eq!(answer(&runs(2.0, 1.5), 22), Answer::Partly);
    assert_eq!(answer(&runs(1.5, 2.0), 22), Answer::Fails);
}

#[test]
fn two_levels_must_gain_a_lot() {
    let runs = |two: f64| {
        [("two", two), ("one", 10.0)]
            .map(|(levels, fps)| Run { levels: levels.to_owned(), ..run(Sweep::Levels, "bvh", 70_000, fps) })
    };
    assert_eq!([answer(&runs(20.0), 23), answer(&runs(5.0), 23)], [Answer::Holds, Answer::Fails]);
}

/// What three frames of each came to once: 110.9, 108.5, 69.6 ms against 62.2, 113.8, 68.0 ms.
#[test]
fn frames_that_overlap_tell_nothing_however_far_apart_their_medians_are() {
    const SLOW: [f64; 3] = [89.05, 108.5, 109.7];
    const FAST: [f64; 3] = [65.1, 68.0, 90.9];
    let views = |inside: [[f64; 3]; 2]| {
        let of = |view: &str, split: &str, frames| {
            let (view, split) = (view.to_owned(), split.to_owned());
            Run { view, split, ..run(Sweep::Views, "bvh", 70_000, 1.0) }.with_frames(frames)
        };
        [
            of("far", "sah", [50.0; 3]),
            of("far", "largest-axis", [50.0; 3]),
            of("inside", "sah", inside[0]),
            of("inside", "largest-axis", inside[1]),
        ]
    };
    assert_eq!(answer(&views([SLOW, FAST]), 22), Answer::Open);
    assert_eq!(answer(&views([[108.5; 3], [68.0; 3]]), 22), Answer::Holds);
    let levels = |[two, one]: [[f64; 3]; 2]| {
        [("two", two), ("one", one)].map(|(levels, frames)| {
            let run = Run { levels: levels.to_owned(), ..run(Sweep::Levels, "bvh", 70_000, 1.0) };
            run.with_frames(frames)
        })
    };
    assert_eq!(answer(&levels([SLOW, FAST]), 23), Answer::Open);
    assert_eq!(answer(&levels([FAST, SLOW]), 23), Answer::Open);
    let counts = |[escape, ordered]: [[f64; 3]; 2]| {
        [("bvh-escape", escape), ("bvh", ordered)]
            .map(|(structure, frames)| run(Sweep::Counts, structure, 4500, 1.0).with_frames(frames))
    };
    assert_eq!(answer(&counts([FAST, SLOW]), 18), Answer::Open);
}

#[test]
fn lost_triangles_are_reported_as_they_are() {
    let runs = |lost| {
        let naive = run(Sweep::Lost, "naive", 70_000, 1.0);
        [naive, Run { lost_pixels: Some(lost), ..run(Sweep::Lost, "bvh", 70_000, 10.0) }]
    };
    assert_eq!([answer(&runs(0), 24), answer(&runs(3), 24)], [Answer::Fails, Answer::Holds]);
    assert!(figure(&runs(3), 24).verdict.because.contains("3 of 2,304 pixels"));
}

#[test]
fn repeats_make_the_noise() {
    let same = [100.0, 130.0].map(|fps| run(Sweep::Noise, "bvh", 980, fps));
    assert!((Runs::all(&same).noise().0 - 0.3).abs() < 1e-9);
    let close = [run(Sweep::Counts, "bvh-escape", 4500, 125.0), run(Sweep::Counts, "bvh", 4500, 100.0)];
    assert_eq!(answer(&close, 18), Answer::Holds);
    assert_eq!(answer(&[&close[..], &same[..]].concat(), 18), Answer::Open);
}
