//! The table at the top of the page: the machine, and what came out.
use super::record::Sweep;
use super::select::{NAIVE, ORDERED, Runs};
use crate::kit::figure::{Figure, Table};
use crate::kit::page::{machine_rows, tally};
use crate::kit::text::{count, short, times};

/// What is known in a few lines.
pub(crate) fn summary(runs: &Runs<'_>, figures: &[Figure]) -> Table {
    let mut rows = machine_rows(runs);
    let mut row = |name: String, value: String| rows.push(vec![name, value]);
    for (name, on) in runs.by_backend() {
        if let Some(bunny) = on.of(Sweep::Bunny).iter().max_by(|a, b| a.fps.total_cmp(&b.fps)) {
            row(
                format!("The bunny on the {name}"),
                format!(
                    "{} triangles, {}×{}: {} ms per frame of one sample ({}), {} million rays per second",
                    count(bunny.triangles.into()),
                    bunny.width,
                    bunny.height,
                    short(bunny.frame_ms),
                    bunny.structure,
                    short(1e-6 * bunny.rays_per_sec)
                ),
            );
        }
        if let Some((triangles, ratio)) = on.of(Sweep::Counts).ratios(ORDERED, NAIVE).last() {
            row(
                format!("BVH against every triangle on the {name}"),
                format!("{} at {} triangles", times(*ratio), count(u64::from(*triangles))),
            );
        }
        let lost = on.of(Sweep::Lost);
        let pixels: Vec<u32> = lost.iter().filter_map(|run| run.lost_pixels).collect();
        if !pixels.is_empty() {
            let sum = pixels.iter().map(|lost| u64::from(*lost)).sum();
            row(format!("Lost pixels near an ear on the {name}"), count(sum));
        }
    }
    let bunny = runs.of(Sweep::Bunny);
    if let Some(run) = bunny.first() {
        row(
            "BVH of the bunny".to_owned(),
            format!(
                "{} ms to build, cost {}, {} nodes, depth {}",
                short(1e3 * run.build_secs),
                short(run.sah_cost),
                count(run.nodes.into()),
                run.depth
            ),
        );
    }
    row("Claims".to_owned(), tally(figures));
    Table { head: Vec::new(), rows }
}
