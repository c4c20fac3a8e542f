//! The page has every table and figure of the document.
#![allow(clippy::unwrap_used)]
use super::*;
use crate::kit::verdict::Answer;
use crate::voxel::tests::small_study;

/// Tables of chapters 3 to 5, and figures.
const TABLES: [(u32, u32); 3] = [(3, 1), (4, 1), (5, 30)];
const FIGURES: [(u32, u32); 3] = [(3, 8), (4, 5), (5, 20)];

fn names() -> Vec<String> {
    let all = |name: &'static str, (chapter, last): (u32, u32)| {
        (1..=last).map(move |number| format!("{name} {chapter}.{number}"))
    };
    let tables = TABLES.into_iter().flat_map(|last| all("Table", last));
    tables.chain(FIGURES.into_iter().flat_map(|last| all("Figure", last))).collect()
}

#[test]
fn every_table_and_figure_is_on_the_page() {
    let folder = tempfile::tempdir().unwrap();
    let runs = small_study(folder.path(), usize::MAX).runs;
    let html = page(&runs).unwrap();
    let names = names();
    assert_eq!(names.len(), 65);
    for name in &names {
        assert_eq!(html.matches(&format!(">{name}: ")).count(), 1, "{name}");
    }
    let is_here = |section: &Section| section.verdict.answer != Answer::NotMeasured;
    let sections = sections(&Runs(&runs)).unwrap();
    let missing: Vec<String> = sections.iter().filter(|s| !is_here(s)).map(Section::name).collect();
    // Of the areas that a small study leaves out.
    let of_forest = ["Figure 3.7", "Figure 3.8", "Figure 4.3", "Figure 5.4", "Figure 5.8"];
    let of_biomes = ["Figure 4.5", "Figure 5.6", "Figure 5.10"];
    assert!(of_forest.iter().chain(&of_biomes).all(|name| missing.iter().any(|m| m == name)), "{missing:?}");
    assert_eq!(missing.len(), 8 + 2 * 4 + 2 * 2, "{missing:?}");
}

#[test]
fn a_page_of_one_run_has_them_too() {
    let folder = tempfile::tempdir().unwrap();
    let runs = small_study(folder.path(), 30).runs;
    let html = page(&runs[..1]).unwrap();
    assert!(names().iter().all(|name| html.contains(&format!(">{name}: "))));
}
