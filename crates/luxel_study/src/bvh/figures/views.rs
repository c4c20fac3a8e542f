//! Figures 22 and 23: where rays start, and how many trees there are.
use super::super::record::{Run, Sweep};
use super::super::select::{LARGEST_AXIS, Runs, SAH, setting};
use crate::kit::draw::ratio_table;
use crate::kit::figure::{Figure, Part, Table};
use crate::kit::text::{list, short, times};
use crate::kit::verdict::Verdict;

const PLACES: [&str; 3] = ["far", "near", "inside"];

pub(crate) fn figures(runs: &Runs<'_>) -> Vec<Figure> {
    vec![views(&runs.of(Sweep::Views)), levels(&runs.of(Sweep::Levels))]
}

/// The runs with the heuristic's tree and with the one cut along the largest axis.
fn both_splits<'a>(on: &Runs<'a>, view: &str) -> [Runs<'a>; 2] {
    let at = on.seen_from(view);
    [SAH, LARGEST_AXIS].map(|split| at.split_by(split))
}

/// How many times faster the heuristic's tree is.
fn advantage(on: &Runs<'_>, view: &str) -> Option<f64> {
    let [heuristic, axis] = both_splits(on, view);
    Some(heuristic.fps()? / axis.fps()?)
}

/// How many times as many nodes and triangles a ray tests in the heuristic's tree.
fn work(on: &Runs<'_>, view: &str) -> Option<f64> {
    let at = on.seen_from(view);
    let of = |split: &str| at.split_by(split).first().map(|run| run.nodes_per_ray + run.tests_per_ray);
    Some(of(SAH)? / of(LARGEST_AXIS)?)
}

fn views(runs: &Runs<'_>) -> Figure {
    let (mut cases, mut reasons, mut rows) = (Vec::new(), Vec::new(), Vec::new());
    for (name, on) in runs.by_backend() {
        let ratios = PLACES.map(|view| advantage(&on, view));
        if let [Some(far), _, Some(inside)] = ratios {
            let (at_far, at_inside) = (both_splits(&on, "far"), both_splits(&on, "inside"));
            cases.push(on.noise_of(&at_inside).slower(inside));
            cases.push(on.noise_of(at_far.iter().chain(&at_inside)).much_faster(far / inside));
        }
        let said =
            PLACES.iter().zip(ratios).filter_map(|(view, ratio)| Some(format!("{} {view}", times(ratio?))));
        let less = PLACES.iter().filter_map(|view| Some(format!("{} {view}", times(work(&on, view)?))));
        reasons.push(format!(
            "{} on the {name}, where its rays test {} the nodes and triangles",
            list(said),
            list(less)
        ));
        rows.push((name.to_owned(), ratios.to_vec()));
    }
    let mut parts = Vec::new();
    if !runs.is_empty() {
        let corner = "speed with the heuristic against largest axis";
        parts.push(ratio_table(corner, PLACES.map(str::to_owned).to_vec(), rows));
        parts.push(Part::Table(table(runs, &["camera", "split", "cost"], |run| {
            vec![run.view.clone(), run.split.clone(), short(run.sah_cost)]
        })));
    }
    Figure {
        number: 22,
        title: "Heuristic against largest axis; camera far, near and inside".to_owned(),
        shows: format!(
            "The bunny with its tree cut by the surface area heuristic and along the largest axis, from afar, from near \
             by, and from within ({}).",
            setting(runs.first())
        ),
        claim: Some(
            "The heuristic does not account for the camera being inside of the object, where it suddenly does very poorly; \
             there, splitting the largest axis can be used."
                .to_owned(),
        ),
        verdict: Verdict::of(
            &cases,
            format!("Speed with the heuristic against largest axis: {}.", list(reasons)),
        ),
        parts,
    }
}

fn table(runs: &Runs<'_>, names: &[&str], named: impl Fn(&Run) -> Vec<String>) -> Table {
    let rest = ["where", "nodes per ray", "tests per ray", "ms per frame", "million rays per second"];
    let row = |run: &Run| {
        let mut cells = named(run);
        cells.extend([
            run.place().to_owned(),
            short(run.nodes_per_ray + run.tlas_nodes_per_ray),
            short(run.tests_per_ray),
            short(run.frame_ms),
            short(1e-6 * run.rays_per_sec),
        ]);
        cells
    };
    let head = names.iter().chain(&rest).map(|name| (*name).to_owned()).collect();
    Table { head, rows: runs.iter().map(row).collect() }
}

fn levels(runs: &Runs<'_>) -> Figure {
    let (mut cases, mut reasons) = (Vec::new(), Vec::new());
    for (name, on) in runs.by_backend() {
        let of = |levels: &str, split: &str| on.filter(|run| run.levels == levels && run.split == split);
        let compared = ["two", "one"].map(|levels| of(levels, SAH));
        if let [Some(two), Some(one)] = compared.each_ref().map(Runs::fps) {
            cases.push(on.noise_of(&compared).much_faster(two / one));
            let axis = of("one", LARGEST_AXIS).fps().map_or_else(String::new, |axis| {
                format!(", and {} as fast as one tree cut along the largest axis", times(two / axis))
            });
            reasons.push(format!("{} on the {name}{axis}", times(two / one)));
        }
    }
    // No cost: that of the largest mesh alone says nothing beside that of a tree over everything.
    let named = |run: &Run| vec![run.levels.clone(), run.split.clone()];
    Figure {
        number: 23,
        title: "One BVH over the world against one per object".to_owned(),
        shows: format!(
            "The room with the bunny, all grey, seen from inside: a BVH per object under one over the objects, and a \
             single BVH over all triangles ({}).",
            setting(runs.first())
        ),
        claim: Some(
            "With the camera inside the room, trees of their own for walls and bunny would probably gain a lot on the \
             frame rate."
                .to_owned(),
        ),
        verdict: Verdict::of(&cases, format!("Two levels against one tree: {}.", list(reasons))),
        parts: match runs.is_empty() {
            true => Vec::new(),
            false => vec![Part::Table(table(runs, &["levels", "split"], named))],
        },
    }
}
