//! The page: one HTML file that needs nothing else, made from records alone.
use maud::{DOCTYPE, Markup, PreEscaped, html};

use super::chart::Chart;
use super::cube::cube;
use super::figure::{Figure, Heat, Part, Table};
use super::figures::{LAST_OF_REPORT, figures};
use super::record::Run;
use super::select::{FPS_LIMIT, NOISE_QUANTILE, Runs, backend_name};
use super::stats::MAX_Z;
use super::summary::summary;
use super::text::{count, list, percent, short};
use super::verdict::{Answer, MAJOR};
use crate::StudyError;

/// The title of every page, by which it is known again.
pub(crate) const TITLE: &str = "Luxel: octree study";
const STYLE: &str = include_str!("page.css");

/// The page of some runs.
///
/// # Errors
/// [`StudyError::Page`] if a chart cannot be drawn.
pub fn page(runs: &[Run]) -> Result<String, StudyError> {
    let selected = Runs::all(runs);
    let figures = figures(&selected);
    let (reports, extra): (Vec<_>, Vec<_>) =
        figures.iter().partition(|figure| figure.number <= LAST_OF_REPORT);
    let page = html! {
        (DOCTYPE)
        html lang="en" {
            head {
                meta charset="utf-8";
                meta name="viewport" content="width=device-width, initial-scale=1";
                title { (TITLE) }
                style { (PreEscaped(STYLE)) }
            }
            body {
                h1 { "Octree study" }
                p {
                    "The assessment of “Simple Real-Time Ray Tracing using Octrees in OpenGL” (Cruz and Xavier), made \
                     again with Luxel on one machine: its figures 1 to 21 from our data, each with the report's claim \
                     and whether it holds here, and what the report lacks."
                }
                h2 { "Summary" }
                (table(&summary(&selected, &figures)))
                (verdicts(&figures))
                h2 { "How it was measured" }
                (method(&selected, &figures))
                h2 { "The report's figures" }
                @for figure in &reports { (section(figure)?) }
                h2 { "Further figures" }
                @for figure in &extra { (section(figure)?) }
            }
        }
    };
    Ok(page.into_string())
}

fn verdicts(figures: &[Figure]) -> Markup {
    html! {
        details {
            summary { "All verdicts" }
            table {
                thead { tr { th { "Figure" } th { "Claim" } th { "On our data" } } }
                tbody {
                    @for figure in figures {
                        tr {
                            td { a href={ "#fig-" (figure.number) } { (figure.number) } }
                            td { (claim(figure)) }
                            td { (badge(figure.verdict.answer)) }
                        }
                    }
                }
            }
        }
    }
}

fn claim(figure: &Figure) -> &str {
    figure.claim.as_deref().unwrap_or("The report claims nothing with this figure.")
}

fn badge(answer: Answer) -> Markup {
    let class = match answer {
        Answer::Holds => "holds",
        Answer::Partly => "partly",
        Answer::Fails => "fails",
        Answer::Open | Answer::NoClaim | Answer::NotMeasured => "none",
    };
    html! { span class={ "verdict " (class) } { (answer.name()) } }
}

fn method(runs: &Runs<'_>, figures: &[Figure]) -> Markup {
    let most = runs.iter().map(|run| run.frames + run.outliers).max().unwrap_or_default();
    let fewest = runs.iter().map(|run| run.frames + run.outliers).min().unwrap_or_default();
    let outliers: u64 = runs.iter().map(|run| u64::from(run.outliers)).sum();
    let cut_off = runs.filter(|run| run.cut_off).iter().count();
    html! {
        (stopped(runs))
        p {
            "Scene: random spheres in a box, a third each Lambert, metal and dielectric, together always 3 % of the \
             box, nothing else but the sky. Rays that miss the box around all \
             spheres test none of them, without a structure too. A frame is the whole picture at all its samples. The structures that a \
             figure compares take turns, so that whatever happens to the machine happens to all of them; each turn \
             begins with a sample per pixel that does not count. " (fewest) " to " (most) " frames of each configuration were \
             measured, fewer where they are slow. Frames with a z-score above " (MAX_Z) " were left out as outliers ("
            (outliers) " in all; among ten frames or fewer none can be); the rest is given by its median."
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
        (judgement(runs))
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
        @if runs.on("gpu").is_empty() || runs.on("cpu").is_empty() {
            p { "Only one backend was measured." }
        } @else {
            p {
                "On the GPU pictures are smaller than on the CPU, for a software driver is many times slower than \
                 native code; compare structures within a backend, not backends with each other."
                @let cpu_only = cpu_only(runs, figures);
                @if !cpu_only.is_empty() { " Measured on the CPU only: figures " (cpu_only.join(", ")) "." }
            }
        }
    }
}

/// How claims are judged.
fn judgement(runs: &Runs<'_>) -> Markup {
    let noise = |backend| {
        let on = runs.on(backend);
        let taken = if on.knows_noise() { "" } else { " (taken over: nothing was measured twice there)" };
        format!("{} on the {}{taken}", percent(on.noise().0), backend_name(backend))
    };
    html! {
        p {
            "Noise: different depths and smallest nodes often lead to the same tree, which is then measured more than \
             once. " (percent(NOISE_QUANTILE)) " of such pairs of one sweep differ by less than the noise, which is taken \
             as 5 % at least: " (list(runs.backends().into_iter().map(noise))) ". Speeds that differ by less cannot \
             be told apart. Sweeps are made one after the other and the machine may change between them; speeds of \
             different sweeps are not compared."
        }
        p {
            "A claim is taken apart into checks: it holds if all do that can be told, holds partly if some do, and \
             cannot be told if more than half lie within the noise. A change is major or noticeable if the ratio of \
             two speeds is above " (MAJOR) "; less is alike. A best setting is given with those that cannot be told from \
             it. Claims that begin with “Expected” are not the report's."
        }
    }
}

/// Says so if runs are missing that were to be made.
fn stopped(runs: &Runs<'_>) -> Markup {
    let studies = runs.values(|run| (run.date.as_str(), run.planned_runs));
    let planned: u64 = studies.iter().map(|(_, planned)| u64::from(*planned)).sum();
    let made = runs.iter().count() as u64;
    html! {
        @if made < planned {
            p {
                strong { "Incomplete: " }
                (count(made)) " of " (count(planned)) " runs were made before the study was stopped or a backend \
                 failed. What rests on the others is not measured, or on fewer runs than it should be."
            }
        }
    }
}

/// The numbers of the figures that runs on the CPU give an answer to and runs on the GPU do not.
fn cpu_only(runs: &Runs<'_>, all: &[Figure]) -> Vec<String> {
    let of_gpu = figures(&runs.on("gpu"));
    let is_there = |figure: &Figure| figure.verdict.answer != Answer::NotMeasured;
    let pairs = all.iter().zip(&of_gpu).filter(|(all, gpu)| is_there(all) && !is_there(gpu));
    pairs.map(|(figure, _)| figure.number.to_string()).collect()
}

fn section(figure: &Figure) -> Result<Markup, StudyError> {
    let mut parts = Vec::new();
    for part in &figure.parts {
        parts.push(self::part(part)?);
    }
    Ok(html! {
        section class="figure" id={ "fig-" (figure.number) } {
            h3 { "Fig. " (figure.number) ": " (figure.title) }
            p { (figure.shows) }
            @for part in parts { (part) }
            p class="claim" { "Claim: " (claim(figure)) }
            p { (badge(figure.verdict.answer)) " " (figure.verdict.because) }
        }
    })
}

fn part(part: &Part) -> Result<Markup, StudyError> {
    Ok(match part {
        Part::Chart(drawing) if drawing.is_empty() => html! {},
        Part::Chart(drawing) => chart(drawing)?,
        Part::Heat(map) => heat(map),
        Part::Picture(png, alt) => html! { img src={ "data:image/png;base64," (png) } alt=(alt); },
        Part::Table(rows) => table(rows),
        Part::Cube => cube(),
    })
}

fn table(table: &Table) -> Markup {
    html! {
        div class="wide" {
            table {
                @if !table.head.is_empty() {
                    thead { tr { @for name in &table.head { th { (name) } } } }
                }
                tbody {
                    @for row in &table.rows {
                        tr { @for cell in row { td { (cell) } } }
                    }
                }
            }
        }
    }
}

fn chart(chart: &Chart) -> Result<Markup, StudyError> {
    Ok(html! {
        p class="caption" { (chart.caption) }
        (PreEscaped(chart.svg()?))
        ul class="legend" {
            @for series in &chart.series {
                li { span class="swatch" style={ "background:" (series.ink.css()) } {} (series.name) }
            }
        }
        details {
            summary { "Numbers" }
            (table(&numbers(chart)))
        }
    })
}

/// What a chart shows, as a table.
fn numbers(chart: &Chart) -> Table {
    let head = std::iter::once(format!("{} ╲ {}", chart.y, chart.x)).chain(chart.categories.iter().cloned());
    let cell = |value: &Option<f64>| value.map_or_else(|| "–".to_owned(), short);
    let rows = chart
        .series
        .iter()
        .map(|series| std::iter::once(series.name.clone()).chain(series.values.iter().map(cell)).collect());
    Table { head: head.collect(), rows: rows.collect() }
}

fn heat(heat: &Heat) -> Markup {
    let values = || heat.rows.iter().flat_map(|(_, row)| row.iter().copied().flatten());
    let least = values().fold(f64::MAX, f64::min).ln();
    let most = values().fold(f64::MIN_POSITIVE, f64::max).ln();
    let style = |value: f64| {
        let part = ((value.ln() - least) / (most - least).max(1e-9)).clamp(0.0, 1.0);
        let ink = if part > 0.55 { "#fff" } else { "#1f2328" };
        format!("color:{ink};background:hsl(212 {:.0}% {:.0}%)", 60.0 + 20.0 * part, 97.0 - 65.0 * part)
    };
    html! {
        p class="caption" { (heat.caption) ", frames per second" }
        div class="wide" {
            table class="heat" {
                thead { tr { th { (heat.corner) } @for column in &heat.columns { th { (column) } } } }
                tbody {
                    @for (name, row) in &heat.rows {
                        tr {
                            th { (name) }
                            @for value in row {
                                @match value {
                                    Some(value) => td style=(style(*value)) { (short(*value)) },
                                    None => td { "–" },
                                }
                            }
                        }
                    }
                }
            }
        }
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
