//! Figure 24: triangles that a search loses.
use super::super::record::{Run, Sweep};
use super::super::select::{NAIVE, Runs, setting};
use crate::kit::draw::picture;
use crate::kit::figure::{Figure, Part, Table};
use crate::kit::text::count;
use crate::kit::verdict::{Case, Verdict};

pub(crate) fn figure(runs: &Runs<'_>) -> Figure {
    let lost = runs.of(Sweep::Lost);
    let searched = lost.filter(|run| run.lost_pixels.is_some());
    let cases: Vec<Case> =
        searched.iter().map(|run| Case::from(run.lost_pixels.unwrap_or_default() > 0)).collect();
    let said = |run: &Run| {
        format!(
            "{} on the {}: {} of {} pixels. ",
            run.structure,
            run.place(),
            count(run.lost_pixels.unwrap_or_default().into()),
            count(pixels(run))
        )
    };
    let mut parts = picture(lost.iter().find(|run| run.picture_png.is_some()), "the tip of an ear");
    if !searched.is_empty() {
        parts.push(Part::Table(table(&lost)));
    }
    Figure {
        number: 24,
        title: "Lost triangles".to_owned(),
        shows: format!(
            "A window around the bunny's highest point: pixels whose first hit is another than with every triangle \
             tested ({}).",
            setting(lost.first())
        ),
        claim: Some(
            "When moving closer to the ears some triangles seem to be lost and do not show up.".to_owned(),
        ),
        verdict: Verdict::of(&cases, searched.iter().map(said).collect()),
        parts,
    }
}

fn pixels(run: &Run) -> u64 {
    u64::from(run.width) * u64::from(run.height)
}

fn table(runs: &Runs<'_>) -> Table {
    let head = ["where", "structure", "triangles", "pixels", "other first hits"];
    let row = |run: &Run| {
        let lost = match run.lost_pixels {
            Some(lost) => count(lost.into()),
            None if run.structure == NAIVE => "the measure".to_owned(),
            None => "–".to_owned(),
        };
        vec![
            run.place().to_owned(),
            run.structure.clone(),
            count(run.triangles.into()),
            count(pixels(run)),
            lost,
        ]
    };
    Table { head: head.map(str::to_owned).to_vec(), rows: runs.iter().map(row).collect() }
}
