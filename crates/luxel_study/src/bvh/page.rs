//! The page of the BVH study: what it says about itself, around its figures.
use maud::{Markup, html};

use super::figures::{LAST_OF_REPORT, figures};
use super::record::Run;
use super::select::Runs;
use super::summary::summary;
use crate::StudyError;
use crate::kit::page::{Page, backends, judgement, stopped, turns};
use crate::kit::text::list;

/// The title of every page, by which it is known again.
pub(crate) const TITLE: &str = "Luxel: BVH study";

/// What is measured more than once.
const REPEATS: &str = "the rabbit, coarse and fine, is measured four times over with the same settings.";

/// The page of some runs.
///
/// # Errors
/// [`StudyError::Page`] if a chart cannot be drawn.
pub fn page(runs: &[Run]) -> Result<String, StudyError> {
    let selected = Runs::all(runs);
    let figures = figures(&selected);
    let intro = html! {
        p {
            "The results of “Simple Path Tracer with BVH Acceleration Structure” (Boge and Ebenholm), made again with \
             Luxel on one machine: its figures 6 to 14 from our data, what its text and discussion claim about its BVH, \
             each with whether it holds here, and what the report lacks. Figures 1 to 5 are listings and a drawing."
        }
    };
    let page = Page {
        title: TITLE,
        heading: "BVH study",
        intro,
        summary: &summary(&selected, &figures),
        method: method(&selected),
        figures: &figures,
        last_of_report: LAST_OF_REPORT,
    };
    page.html()
}

fn method(runs: &Runs<'_>) -> Markup {
    let models = runs.values(|run| run.model.as_str());
    html! {
        (stopped(runs))
        p {
            "Scenes: those of the folder assets/scenes, and the rabbit at any fineness: an icosphere drawn out to ears, \
             20 · n² triangles, 69,620 where the report has its bunny (tables count the two of its ground too). Shown as the bunny: " (list(models)) ". "
            (turns(runs))
        }
        p {
            "Rendering time only, one sample per pixel and frame unless said otherwise; direct light is sampled, so a path \
             has rays to lights beside those of the report. Pictures are shown with more samples than a frame has. Where the \
             report gives frames per second at 1920×1080, ours are multiplied by the part of those pixels that were traced."
        }
        p {
            "Structures: naive tests every triangle; bvh-escape visits a BVH in depth-first order and goes on by escape \
             index, as the report does; bvh visits the nearer child first. The cost of a tree is that of the surface area \
             heuristic, a node and a triangle test costing 1 each."
        }
        (judgement(runs, REPEATS))
        @if runs.iter().any(|run| run.quick) {
            p {
                strong { "Shortened (--quick): " }
                "small pictures, few frames and steps. A full study takes longer and scatters less."
            }
        }
        (backends(runs, figures))
    }
}

#[cfg(test)]
mod tests {
    use super::super::record::{Sweep, example};
    use super::*;

    #[test]
    fn what_a_record_says_cannot_break_the_page() {
        let run = Run {
            machine: "<script>alert(1)</script>".to_owned(),
            model: "a\"b&c<script>".to_owned(),
            sweep: Sweep::Bunny,
            ..example()
        };
        let page = page(&[run]).unwrap();
        assert!(!page.contains("<script") && page.contains("&lt;script&gt;"));
    }

    #[test]
    fn a_study_that_lacks_runs_says_so() {
        let text = |planned_runs| page(&[Run { planned_runs, ..example() }]).unwrap();
        assert!(text(7).contains("1 of 7 runs were made") && !text(1).contains("Incomplete"));
    }

    #[test]
    fn the_page_needs_nothing_else() {
        let page = page(&[example()]).unwrap().replace("http://www.w3.org/2000/svg", "");
        for word in ["http:", "https:", "src=\"/", "@import", "<link", "url(h", "url(/"] {
            assert!(!page.contains(word), "{word}");
        }
    }
}
