//! Figures 5.1 and 5.2: how the two renderers go about a picture.
use super::section::Section;
use super::select::{ALBEDO, DESERT, Map, Renderer, Runs, pictures};

pub(super) fn sections(runs: &Runs<'_>) -> [Section; 2] {
    let [adaptive, aware] =
        [Renderer::Adaptive(1), Renderer::ErrorAware].map(|renderer| runs.renderer(DESERT, ALBEDO, renderer));
    let first = pictures([
        (adaptive, Map::Luminance, "(a) luminance at one ray a pixel".to_owned()),
        (adaptive, Map::Variance, "(b) normalised variance, white for 1 and more".to_owned()),
        (adaptive, Map::Rays, "(c) rays, black for 0 to white".to_owned()),
        (adaptive, Map::Picture, "(d) result".to_owned()),
    ]);
    let second = pictures([
        (aware, Map::Rays, "(a) rays, up to 21".to_owned()),
        (aware, Map::Levels, "(b) finest level, white for the leaves".to_owned()),
        (aware, Map::Picture, "(c) result".to_owned()),
    ]);
    [
        Section::figure((5, 1), "Adaptive rendering algorithm and results", vec![first]),
        Section::figure((5, 2), "Error-aware rendering algorithm and results", vec![second]),
    ]
}
