//! The page of the octree study: what it says about itself, around its figures.
use maud::{Markup, html};

use super::figures::{LAST_OF_REPORT, figures};
use super::record::Run;
use super::select::{FPS_LIMIT, Runs};
use super::summary::summary;
use crate::StudyError;
use crate::kit::page::{Page, backends, judgement, stopped, turns};
use crate::kit::text::count;

/// The title of every page, by which it is known again.
pub(crate) const TITLE: &str = "Luxel: octree study";

/// What is measured more than once.
const REPEATS: &str = "different depths and smallest nodes often lead to the same tree, which is then measured more \
                       than once.";

/// The page of some runs.
///
/// # Errors
/// [`StudyError::Page`] if a chart cannot be drawn.
pub fn page(runs: &[Run]) -> Result<String, StudyError> {
    let selected = Runs::all(runs);
    let figures = figures(&selected);
    let intro = html! {
        p {
            "The assessment of “Simple Real-Time Ray Tracing using Octrees in OpenGL” (Cruz and Xavier), made \
             again with Luxel on one machine: its figures 1 to 21 from our data, each with the report's claim \
             and whether it holds here, and what the report lacks."
        }
    };
    let page = Page {
        title: TITLE,
        heading: "Octree study",
        intro,
        summary: &summary(&selected, &figures),
        method: method(&selected),
        figures: &figures,
        last_of_report: LAST_OF_REPORT,
    };
    page.html()
}

fn method(runs: &Runs<'_>) -> Markup {
    let most = runs.iter().map(|run| run.frames + run.outliers).max().unwrap_or_default();
    let cut_off = runs.filter(|run| run.cut_off).iter().count();
    html! {
        (stopped(runs))
        p {
            "Scene: random spheres in a box, a third each Lambert, metal and dielectric, together always 3 % of the \
             box, nothing else but the sky. Rays that miss the box around all \
             spheres test none of them, without a structure too. " (turns(runs))
        }
        p {
            "Rendering time only: building the structure is given on its own (figure 24). The report's octree \
             (octree-seed, octree-base) has a smallest node of 1 as in the report and a depth that grows with the \
             scene, about a cell per sphere: 1 at 10 spheres, 3 at 1,000, 6 at a million; ours has its defaults, \
             depth 20 and 8 spheres. Depths above 20 are held at 20."
        }
        p {
            "Where a value is taken over several settings it is the geometric mean of their medians. A limit of "
            (FPS_LIMIT) " frames per second, where a figure has one, is computed: faster frames count as if they \
             had waited."
        }
        (judgement(runs, REPEATS))
        @if cut_off > 0 {
            p {
                (cut_off) " runs are of octrees that stopped growing before their largest depth because they had used \
                 up their memory: 128 MiB for nodes and as much for lists of spheres."
            }
        }
        @if runs.iter().any(|run| run.quick) {
            p {
                strong { "Shortened (--quick): " }
                "small pictures, at most " (most) " frames, some depths left out, larger nodes at the greatest depth \
                 only, scenes of up to " (count(u64::from(runs.counts().last().copied().unwrap_or_default())))
                " spheres. A full study takes longer and scatters less."
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
        let run =
            Run { machine: "<script>alert(1)</script>".to_owned(), device: "a\"b&c".to_owned(), ..example() };
        let page = page(&[run]).unwrap();
        assert!(!page.contains("<script") && page.contains("&lt;script&gt;"));
    }

    #[test]
    fn a_study_that_lacks_runs_says_so() {
        let text = |planned_runs| page(&[Run { planned_runs, ..example() }]).unwrap();
        assert!(text(7).contains("1 of 7 runs were made") && !text(1).contains("Incomplete"));
        assert!(!text(0).contains("Incomplete"));
    }

    #[test]
    fn figures_without_runs_on_the_gpu_are_named() {
        let of = |sweep, backend: &str| Run { sweep, backend: backend.to_owned(), ..example() };
        let picture = |run| Run { picture_png: Some("iVBORw0KGgo=".to_owned()), noise: Some(0.1), ..run };
        let runs = [picture(of(Sweep::Scene, "cpu")), of(Sweep::Counts, "cpu"), of(Sweep::Counts, "gpu")];
        let text = page(&runs).unwrap();
        assert!(text.contains("Measured on the CPU only: figures 2."), "{text}");
    }

    #[test]
    fn the_page_needs_nothing_else() {
        let page = page(&[example()]).unwrap().replace("http://www.w3.org/2000/svg", "");
        for word in ["http:", "https:", "src=\"/", "@import", "<link", "url(h", "url(/"] {
            assert!(!page.contains(word), "{word}");
        }
    }
}
