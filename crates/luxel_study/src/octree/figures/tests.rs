//! Answers to made-up records, in both directions.
use super::super::record::{Run, Sweep, example};
use super::*;
use crate::kit::verdict::Answer;

const OCTREES: [&str; 2] = ["octree", "octree-seed"];

fn figure(runs: &[Run], number: u32) -> Figure {
    figures(&Runs::all(runs)).into_iter().find(|figure| figure.number == number).unwrap()
}

fn answer(runs: &[Run], number: u32) -> Answer {
    figure(runs, number).verdict.answer
}

fn run(sweep: Sweep, structure: &str, spheres: u32, depth: u32, min_spheres: u32, fps: f64) -> Run {
    let run = Run {
        sweep,
        structure: structure.to_owned(),
        spheres,
        asked_depth: depth,
        max_depth: depth.min(20),
        min_spheres,
        // Each is a tree of its own, and so no repeat.
        nodes: 1 + 100 * depth + min_spheres,
        ..example()
    };
    run.with_frames([1e3 / fps; 3])
}

/// Runs of both octrees over the depth.
fn depths(spheres: u32, fps: impl Fn(u32) -> f64) -> Vec<Run> {
    let of = |structure| (0..=5).map(move |depth| (structure, depth));
    let all = OCTREES.into_iter().flat_map(of);
    all.map(|(structure, depth)| run(Sweep::Depth, structure, spheres, depth, 1, fps(depth))).collect()
}

#[test]
fn every_number_is_there_once_and_says_something_even_without_runs() {
    let all = figures(&Runs::all(&[]));
    let numbers: Vec<u32> = all.iter().map(|figure| figure.number).collect();
    let expected: Vec<u32> = (1..=numbers.len() as u32).collect();
    assert!(numbers == expected && numbers.len() as u32 > LAST_OF_REPORT, "{numbers:?}");
    for figure in &all {
        assert!(!figure.title.is_empty() && !figure.shows.is_empty());
        assert_eq!(figure.claim.is_none(), [1, 2, 4, 5, 6].contains(&figure.number), "{}", figure.number);
        assert!(!figure.verdict.because.is_empty());
        let measured = figure.verdict.answer != Answer::NotMeasured;
        assert_eq!(measured, figure.number == 3, "figure {}", figure.number);
    }
}

/// Naive and both octrees at two resolutions and the two lower qualities.
fn grid(octree: f64) -> Vec<Run> {
    let mut runs = Vec::new();
    for (height, spp) in [(24, 4), (48, 4), (24, 16), (48, 16)] {
        for (structure, fps) in
            [("naive", 100.0), ("octree", 100.0 * octree), ("octree-seed", 100.0 * octree)]
        {
            let quality = if spp == 4 { "low" } else { "standard" }.to_owned();
            runs.push(Run { height, spp, quality, ..run(Sweep::Grid, structure, 10, 5, 1, fps) });
        }
    }
    runs
}

#[test]
fn naive_and_octree_are_compared_in_both_directions() {
    for (octree, better) in
        [(2.0, Answer::Holds), (1.01, Answer::Open), (0.99, Answer::Open), (0.5, Answer::Fails)]
    {
        for number in [9, 13, 14] {
            assert_eq!(answer(&grid(octree), number), better, "figure {number} at {octree}");
        }
        let slower = match better {
            Answer::Holds => Answer::Fails,
            Answer::Fails => Answer::Holds,
            other => other,
        };
        assert_eq!(answer(&grid(octree), 10), slower, "{octree}");
    }
}

#[test]
fn a_growing_advantage_holds_and_a_shrinking_one_does_not() {
    let runs = |late: f64| {
        let mut runs = Vec::new();
        for (count, ratio) in [(500, 2.0), (1000, 4.0), (2000, late)] {
            runs.push(run(Sweep::Counts, "naive", count, 20, 8, 10.0));
            runs.extend(OCTREES.map(|name| run(Sweep::Counts, name, count, 6, 1, 10.0 * ratio)));
        }
        runs
    };
    assert_eq!(answer(&runs(8.0), 12), Answer::Holds);
    assert_eq!(answer(&runs(1.0), 12), Answer::Fails);
    assert_eq!(answer(&runs(3.0), 12), Answer::Partly);
    assert_eq!(answer(&runs(8.0), 11), Answer::Holds);
}

#[test]
fn the_best_depth_must_grow() {
    let runs = |small: u32, large: u32| {
        let at = |spheres, best| depths(spheres, move |depth| if depth == best { 100.0 } else { 50.0 });
        [at(10, small), at(2000, large)].concat()
    };
    assert_eq!((answer(&runs(1, 4), 15), answer(&runs(1, 4), 27)), (Answer::Holds, Answer::Holds));
    assert_eq!((answer(&runs(4, 1), 15), answer(&runs(4, 1), 27)), (Answer::Fails, Answer::Fails));
}

#[test]
fn under_the_limit_the_best_depth_cannot_be_told() {
    let fast = [depths(500, |depth| 200.0 + f64::from(depth)), depths(1000, |_| 300.0)].concat();
    assert_eq!(answer(&fast, 15), Answer::Open);
    assert!(figure(&fast, 15).verdict.because.contains("any at 500"));
}

#[test]
fn one_sphere_per_node_must_beat_none() {
    let runs = |one: f64, ten: f64| {
        let mut runs = Vec::new();
        for (count, speed) in [(10, ten), (50, 100.0), (250, 50.0), (500, 50.0), (1000, 50.0)] {
            for structure in OCTREES {
                runs.push(run(Sweep::Depth, structure, count, 3, 0, speed));
                let gain = if count < 250 { 1.0 } else { one };
                runs.push(run(Sweep::Depth, structure, count, 3, 1, speed * gain));
            }
        }
        runs
    };
    assert_eq!(
        (answer(&runs(1.5, 400.0), 20), answer(&runs(1.5, 400.0), 17)),
        (Answer::Holds, Answer::Holds)
    );
    assert_eq!(
        (answer(&runs(0.5, 100.0), 20), answer(&runs(0.5, 100.0), 17)),
        (Answer::Partly, Answer::Fails)
    );
}

#[test]
fn only_large_scenes_need_depth() {
    let runs = |few: f64, many: f64| {
        let at = |spheres, flat: f64| depths(spheres, move |depth| if depth == 0 { flat } else { 100.0 });
        [at(10, few), at(2000, many)].concat()
    };
    assert_eq!(answer(&runs(100.0, 10.0), 18), Answer::Holds);
    assert_eq!(answer(&runs(10.0, 100.0), 18), Answer::Fails);
}

#[test]
fn depths_are_compared_with_those_of_the_report() {
    let runs = |best: [u32; 4], gains: [f64; 4]| {
        let mut runs = Vec::new();
        for ((spheres, best), gain) in [250, 500, 1000, 2000].into_iter().zip(best).zip(gains) {
            let fps = move |depth| match depth {
                0 => 10.0,
                depth if depth == best => 10.0 * gain,
                _ => 8.0,
            };
            runs.extend(depths(spheres, fps));
        }
        runs
    };
    assert_eq!(answer(&runs([1, 2, 3, 3], [2.0, 3.0, 4.0, 5.0]), 19), Answer::Holds);
    assert_eq!(answer(&runs([4, 3, 2, 1], [5.0, 4.0, 3.0, 2.0]), 19), Answer::Fails);
    assert_eq!(answer(&runs([1, 2, 4, 5], [2.0, 3.0, 4.0, 5.0]), 19), Answer::Partly);
}

#[test]
fn depth_beyond_need_must_change_nothing_where_trees_differ() {
    let runs = |double: f64, nodes: u32| {
        let mut runs = Vec::new();
        for structure in OCTREES {
            for (depth, fps, nodes) in [(5, 100.0, 17), (10, 98.0, 17), (20, double, nodes)] {
                runs.push(Run { nodes, ..run(Sweep::Fraction, structure, 10, depth, 1, fps) });
            }
        }
        runs
    };
    assert_eq!(answer(&runs(97.0, 25), 16), Answer::Holds);
    assert_eq!(answer(&runs(40.0, 25), 16), Answer::Fails);
    assert_eq!(answer(&runs(40.0, 17), 16), Answer::Open);
}

#[test]
fn the_trend_over_depth_must_be_that_of_every_quality() {
    let runs = |high: fn(f64) -> f64| {
        let mut runs = Vec::new();
        for (spp, quality) in [(4, "low"), (32, "high")] {
            for (depth, fps) in [(0, 1.0), (1, 100.0), (3, 70.0), (5, 50.0), (10, 49.0)] {
                let fps = if spp == 4 { fps } else { high(fps) };
                let of = |name| run(Sweep::DepthQuality, name, 250, depth, 1, fps);
                runs.extend(OCTREES.map(|name| Run { spp, quality: quality.to_owned(), ..of(name) }));
            }
        }
        runs
    };
    assert_eq!(answer(&runs(|fps| 0.1 * fps), 21), Answer::Holds);
    assert_eq!(answer(&runs(|fps| 1e3 / fps), 21), Answer::Partly);
    let reversed: Vec<Run> =
        runs(|fps| 0.1 * fps).into_iter().map(|r| Run { fps: 1e3 / r.fps, ..r }).collect();
    assert_eq!(answer(&reversed, 21), Answer::Partly);
}

#[test]
fn wrong_pixels_and_rays_are_reported_as_they_are() {
    let runs = |pixels: f64, rays: f64| {
        let mut seed = run(Sweep::Counts, "octree-seed", 100, 5, 1, 90.0);
        (seed.wrong_pixels, seed.wrong_rays) = (Some(pixels), Some(rays));
        [seed, run(Sweep::Counts, "octree", 100, 20, 8, 80.0)]
    };
    let because = figure(&runs(0.25, 0.5), 22).verdict.because;
    assert!(
        because.contains("768 of 3,072 pixels (25 %)") && because.contains("50 % of the rays"),
        "{because}"
    );
    assert!(because.contains("proven by tests"), "{because}");
    assert_eq!(answer(&runs(0.0, 0.01), 22), Answer::Holds);
    assert_eq!(answer(&runs(0.0, 0.0), 22), Answer::Fails);
    let mut exact = runs(0.25, 0.5);
    exact[1].wrong_pixels = Some(0.0);
    assert!(figure(&exact, 22).verdict.because.contains("0 % at most"));
}

#[test]
fn memory_and_building_are_compared_with_ours() {
    let runs = |bytes: u64, build_secs: f64| {
        let seed = run(Sweep::Counts, "octree-seed", 100, 5, 1, 90.0);
        [Run { bytes, build_secs, ..seed }, run(Sweep::Counts, "octree", 100, 20, 8, 80.0)]
    };
    let (more, less) = (runs(9000, 0.01), runs(900, 0.0001));
    assert_eq!((answer(&more, 23), answer(&more, 24)), (Answer::Holds, Answer::Holds));
    assert_eq!((answer(&less, 23), answer(&less, 24)), (Answer::Fails, Answer::Fails));
}

#[test]
fn larger_nodes_must_help_small_scenes_more_than_large_ones() {
    let runs = |small: f64, large: f64| {
        let mut runs = Vec::new();
        for (spheres, gain) in [(10, small), (2000, large)] {
            for structure in OCTREES {
                // At a depth that nobody would choose, a node of 1 is slow.
                runs.push(run(Sweep::Depth, structure, spheres, 10, 1, 1.0));
                runs.push(run(Sweep::Depth, structure, spheres, 3, 1, 100.0));
                runs.push(run(Sweep::Depth, structure, spheres, 10, 8, 100.0 * gain));
            }
        }
        runs
    };
    assert_eq!(answer(&runs(2.0, 1.0), 25), Answer::Holds);
    assert_eq!(answer(&runs(0.5, 1.0), 25), Answer::Fails);
    assert_eq!(answer(&runs(2.0, 4.0), 25), Answer::Partly);
}

#[test]
fn large_scenes_must_not_take_time_in_proportion() {
    let runs = |late: f64| {
        ["octree", "bvh"].into_iter().flat_map(move |name| {
            [(10, 100.0), (10_000, late)].map(|(count, fps)| run(Sweep::Counts, name, count, 20, 8, fps))
        })
    };
    assert_eq!(answer(&runs(50.0).collect::<Vec<_>>(), 26), Answer::Holds);
    assert_eq!(answer(&runs(0.1).collect::<Vec<_>>(), 26), Answer::Fails);
}

/// A run whose frames scatter by a factor.
fn scattered(run: Run, scatter: f64) -> Run {
    let ms = run.frame_ms;
    run.with_frames([ms / scatter, ms, ms * scatter])
}

/// The fastest or slowest of all is so noisy that it tells nothing, but others differ as well.
#[test]
fn a_noisy_extreme_does_not_hide_what_the_others_tell() {
    let trees = OCTREES.into_iter().flat_map(|structure| {
        [(5, 100.0, 1.0), (10, 60.0, 1.0), (20, 50.0, 3.0)].map(|(depth, fps, scatter)| {
            scattered(run(Sweep::Fraction, structure, 10, depth, 1, fps), scatter)
        })
    });
    assert_eq!(answer(&trees.collect::<Vec<_>>(), 16), Answer::Fails);
    // Depths of few spheres are not alike, but depth 0 falls off with many.
    let few = depths(10, |depth| if depth == 0 { 10.0 } else { 100.0 });
    let many = depths(2000, |depth| [10.0, 100.0, 110.0][depth.min(2) as usize]);
    let many = many.into_iter().map(|run| match run.max_depth {
        2.. => scattered(run, 20.0),
        _ => run,
    });
    assert_eq!(answer(&few.into_iter().chain(many).collect::<Vec<_>>(), 18), Answer::Partly);
}

/// The medians are those of claims that hold, but the frames scatter more than they differ.
#[test]
fn frames_that_overlap_tell_nothing_however_far_apart_their_medians_are() {
    let scattered = |runs: Vec<Run>, scatter: f64| -> Vec<Run> {
        runs.into_iter().map(|run| scattered(run, scatter)).collect()
    };
    let counts = || {
        let mut runs = Vec::new();
        for (count, ratio) in [(500, 2.0), (1000, 4.0), (2000, 8.0)] {
            runs.push(run(Sweep::Counts, "naive", count, 20, 8, 10.0));
            runs.extend(OCTREES.map(|name| run(Sweep::Counts, name, count, 6, 1, 10.0 * ratio)));
        }
        runs
    };
    let depth = || {
        let at = |spheres, best| depths(spheres, move |depth| if depth == best { 100.0 } else { 50.0 });
        [at(10, 1), at(2000, 4)].concat()
    };
    // A ratio of two speeds is off by the square of what the frames scatter, one of two ratios by its square.
    for (number, runs, told, open) in [
        (9, grid(2.0), 1.3, 1.5),
        (11, counts(), 1.3, 3.0),
        (12, counts(), 1.1, 1.5),
        (13, grid(2.0), 1.3, 1.5),
        (15, depth(), 1.3, 1.5),
        (27, depth(), 1.3, 1.5),
    ] {
        assert_eq!(answer(&scattered(runs.clone(), told), number), Answer::Holds, "figure {number}");
        assert_eq!(answer(&scattered(runs, open), number), Answer::Open, "figure {number}");
    }
}
