//! The page of the voxel study: every table of seed document 3 and every figure of its chapters 3 to 5, its numbers beside
//! ours, with a verdict for each.
mod albedo;
mod areas;
mod cube;
mod decay;
mod errors;
mod lamp;
mod lighting;
mod method;
mod probe;
mod resolutions;
mod section;
mod select;
mod summary;
#[cfg(test)]
mod tests;
mod thresholds;
mod tuning;

use maud::{DOCTYPE, Markup, PreEscaped, html};

use self::section::Section;
use self::select::Runs;
use super::record::Run;
use crate::StudyError;
use crate::kit::page::{STYLE, badge, table};
use crate::kit::text::list;

/// The page of some runs: one HTML file that needs nothing else.
///
/// # Errors
/// [`StudyError::Page`] if a chart or a picture cannot be made.
pub fn page(runs: &[Run]) -> Result<String, StudyError> {
    let runs = Runs(runs);
    let sections = sections(&runs)?;
    let shown: Vec<Markup> = sections.iter().map(Section::html).collect::<Result<_, _>>()?;
    let page = html! {
        (DOCTYPE)
        html lang="en" {
            head {
                meta charset="utf-8";
                meta name="viewport" content="width=device-width, initial-scale=1";
                title { (super::TITLE) }
                style { (PreEscaped(STYLE)) }
            }
            body {
                h1 { "Error-aware adaptive voxel ray tracing, made again" }
                (intro(&runs))
                h2 { "Summary" }
                (table(&summary::table(&runs)))
                (verdicts(&sections))
                h2 { "How it was measured" }
                (method(&runs))
                h2 { "Tables and figures" }
                @for section in &shown { (section) }
            }
        }
    };
    Ok(page.into_string())
}

/// All sections in the document's order, what it lacks at the end.
fn sections(runs: &Runs<'_>) -> Result<Vec<Section>, StudyError> {
    let mut sections = errors::sections()?;
    sections.extend(lamp::sections(runs)?);
    sections.extend(areas::sections(runs));
    sections.extend(method::sections(runs));
    sections.extend(decay::sections(runs));
    sections.extend(albedo::sections(runs));
    sections.extend(lighting::sections(runs));
    sections.extend(thresholds::sections(runs));
    sections.extend(resolutions::sections(runs));
    sections.extend(tuning::sections(runs));
    sections.extend(probe::sections(runs));
    Ok(sections)
}

fn intro(runs: &Runs<'_>) -> Markup {
    let sizes = runs.values(|run| format!("{}³", run.size));
    html! {
        p {
            "The tables of the document and the figures of its chapters 3 to 5, on landscapes of our own (the document's are \
             not public): " (list(runs.values(|run| run.area.clone()))) " at " (list(sizes)) " cells. “Thesis” marks the \
             document's numbers; all others were measured here. Ours are to be compared with each other, as the \
             document's are: other landscapes have other counts."
        }
        @if runs.0.iter().any(|run| run.quick) {
            p {
                strong { "A shortened study: " }
                "one area at a quarter of the edge. Pictures are smaller likewise, so that counts are about a \
                 sixteenth of the document's."
            }
        }
    }
}

fn verdicts(sections: &[Section]) -> Markup {
    html! {
        details {
            summary { "All verdicts" }
            table {
                thead { tr { th { "Table or figure" } th { "What it is" } th { "On our data" } } }
                tbody {
                    @for section in sections {
                        tr {
                            td { a href={ "#" (section.id()) } { (section.name()) } }
                            td { (section.title) }
                            td { (badge(section.verdict.answer)) }
                        }
                    }
                }
            }
        }
    }
}

fn method(runs: &Runs<'_>) -> Markup {
    html! {
        p {
            "Machine: " (list(runs.values(|run| run.machine.clone()))) ". Luxel "
            (list(runs.values(|run| format!("{}, commit {}", run.version, run.commit)))) ". Date: "
            (list(runs.values(|run| run.date.clone()))) ". Recipes of the areas: "
            (list(runs.values(|run| format!("{} {}", run.area, run.recipe)))) "."
        }
        p {
            "The camera looks straight down from above the middle with a field of view of 90°. A pixel's one ray ends two \
             levels above the leaves, so that two refinements reach them; the reference has 4×4 rays a pixel at the \
             leaves. Rays that meet nothing are not counted; discarded rays are, and so are the first rays of pixels \
             that the adaptive renderer makes again. A step is an octree node that a ray enters, so that steps of ours and \
             of the document's are not of one kind. PSNR and RMSE are those of sRGB code values over all pixels, SSIM is that of \
             Wang et al. (2004). Seconds are those of one picture on the CPU, all threads, the only one made: they scatter."
        }
        p {
            "Adaptive is §5.1.2 with one iteration unless said; what counts as a variance of 1 was fixed for all areas before \
             error-aware was measured. Error-aware is §5.1.3 with nine coefficients for each set of children; \
             decay factor and threshold are tuned on the desert only. Improved has all improvements on: errors from a table over directions, \
             the parent's ray kept as one of four, errors weighed by luminance. Its threshold is searched for in each \
             picture: for as many rays as adaptive takes, or for the quality of error-aware."
        }
        p {
            "A claim is taken apart into checks: it holds if all do, holds partly if some do. Nothing of it is typed in; the \
             document's numbers are, and where they contradict each other it is said."
        }
    }
}
