//! Table 4.1 and figures 4.1 to 4.5: the areas.
use super::section::{Section, cell, rows};
use super::select::{ALBEDO, Map, Renderer, Runs, TIMES, change, pictures};
use crate::kit::text::{count, list};
use crate::kit::verdict::Case;
use crate::voxel::ask::Sweep;
use crate::voxel::thesis::VOXELS_AND_NODES;

/// Voxels along an edge of the document's areas.
const EDGE: f64 = 2048.0;
/// The share by which our counts may differ from the document's.
const CLOSE: f64 = 0.1;

pub(super) fn sections(runs: &Runs<'_>) -> Vec<Section> {
    let mut sections = vec![lightings(runs), counts(runs)];
    sections.extend((2..).zip(VOXELS_AND_NODES).map(|(figure, (area, _))| views(runs, figure, area)));
    sections
}

fn lightings(runs: &Runs<'_>) -> Section {
    let area = runs.areas().into_iter().next().unwrap_or_default();
    let all = [ALBEDO].into_iter().chain(TIMES);
    let part = pictures(all.map(|lighting| {
        (runs.renderer(&area, lighting, Renderer::Reference), Map::Picture, format!("{area}, {lighting}"))
    }));
    Section::figure((4, 1), "Lighting scenarios in dataset", vec![part])
}

fn counts(runs: &Runs<'_>) -> Section {
    let (mut cases, mut said, mut lines) = (Vec::new(), Vec::new(), Vec::new());
    for (area, [voxels, nodes]) in VOXELS_AND_NODES {
        let run = runs.0.iter().find(|run| run.area == area);
        // Land has a surface: a quarter of the voxels at half the edge.
        let ratio = run.map(|run| run.voxels as f64 / voxels as f64 * (EDGE / f64::from(run.size)).powi(2));
        cases.extend(ratio.map(|ratio| Case::from((ratio - 1.0).abs() <= CLOSE)));
        said.extend(ratio.map(|ratio| format!("{area} {}", change(ratio))));
        lines.push(vec![
            area.to_owned(),
            count(voxels),
            cell(run, |run| count(run.voxels)),
            count(nodes),
            cell(run, |run| count(run.nodes)),
            cell(run, |run| format!("{:.3}", run.nodes as f64 / run.voxels.max(1) as f64)),
            cell(run, |run| run.recipe.clone()),
        ]);
    }
    let because = match said.is_empty() {
        true => String::new(),
        false => format!("Voxels, set to the document's edge by its square: {}.", list(said)),
    };
    let head = ["Area", "Voxels, thesis", "Voxels", "Nodes, thesis", "Nodes", "Nodes a voxel", "Recipe"];
    let claim = "Our areas have as many voxels as the document's, within 10 %.";
    Section::table((4, 1), "Voxel and octree node counts in dataset", claim, &cases, because)
        .with([rows(&head, lines)])
}

fn views(runs: &Runs<'_>, number: u32, area: &str) -> Section {
    let of = |view: &str| runs.of(Sweep::Views).find(|run| run.area == area && run.view == view);
    let above = runs.renderer(area, ALBEDO, Renderer::Reference);
    let part = pictures([
        (of("overview"), Map::Picture, format!("(a) {area}, overview")),
        (of("near"), Map::Picture, "(b) near by".to_owned()),
        (of("east"), Map::Picture, "(c) the east, near by".to_owned()),
        (above, Map::Picture, "from above".to_owned()),
    ]);
    Section::figure((4, number), format!("{area} area overview"), vec![part])
}
