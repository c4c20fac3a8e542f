//! The frame of a page: one HTML file that needs nothing else, made from figures alone.
use maud::{DOCTYPE, Markup, PreEscaped, html};

use super::chart::Chart;
use super::figure::{Figure, Heat, Part, Table};
use super::record::Record;
use super::select::{NOISE_QUANTILE, Runs, backend_name};
use super::stats::MAX_Z;
use super::text::{count, list, percent, short};
use super::verdict::{Answer, MAJOR};
use crate::StudyError;

/// The style of every page.
pub(crate) const STYLE: &str = include_str!("page.css");

/// What stands on a page.
pub(crate) struct Page<'a> {
    pub(crate) title: &'a str,
    pub(crate) heading: &'a str,
    pub(crate) intro: Markup,
    pub(crate) summary: &'a Table,
    /// Paragraphs on how it was measured.
    pub(crate) method: Markup,
    pub(crate) figures: &'a [Figure],
    /// Figures with greater numbers are not the report's.
    pub(crate) last_of_report: u32,
}

impl Page<'_> {
    /// The page as a file.
    ///
    /// # Errors
    /// [`StudyError::Page`] if a chart cannot be drawn.
    pub(crate) fn html(&self) -> Result<String, StudyError> {
        let (reports, extra): (Vec<_>, Vec<_>) =
            self.figures.iter().partition(|figure| figure.number <= self.last_of_report);
        let page = html! {
            (DOCTYPE)
            html lang="en" {
                head {
                    meta charset="utf-8";
                    meta name="viewport" content="width=device-width, initial-scale=1";
                    title { (self.title) }
                    style { (PreEscaped(STYLE)) }
                }
                body {
                    h1 { (self.heading) }
                    (self.intro)
                    h2 { "Summary" }
                    (table(self.summary))
                    (verdicts(self.figures))
                    h2 { "How it was measured" }
                    (self.method)
                    h2 { "The report's figures" }
                    @for figure in &reports { (section(figure)?) }
                    h2 { "Further figures" }
                    @for figure in &extra { (section(figure)?) }
                }
            }
        };
        Ok(page.into_string())
    }
}

/// Rows at the top of every summary: the machine, what was measured with, the noise.
pub(crate) fn machine_rows<R: Record>(runs: &Runs<'_, R>) -> Vec<Vec<String>> {
    let mut rows = Vec::new();
    let mut row = |name: &str, value: String| rows.push(vec![name.to_owned(), value]);
    row("Machine", list(runs.values(|run| run.common().machine)));
    let version = |run: &R| format!("{}, commit {}", run.common().version, run.common().commit);
    row("Luxel", list(runs.values(version)));
    row("Date", list(runs.values(|run| run.common().date)));
    let frames = runs.iter().map(|run| u64::from(run.common().frames)).sum();
    row("Runs", format!("{}, {} frames", runs.iter().count(), count(frames)));
    for backend in runs.backends() {
        let on = runs.on(backend);
        row(backend_name(backend), list(on.values(|run| device(run.common().device, run.common().driver))));
        row(
            &format!("Noise on the {}", backend_name(backend)),
            format!("speeds that differ by less than {} cannot be told apart", percent(on.noise().0)),
        );
    }
    rows
}

fn device(device: &str, driver: &str) -> String {
    if driver.is_empty() { device.to_owned() } else { format!("{device}, driver {driver}") }
}

/// How many claims hold.
pub(crate) fn tally(figures: &[Figure]) -> String {
    let of = |answer: Answer| {
        let count = figures.iter().filter(|figure| figure.verdict.answer == answer).count();
        (count > 0).then(|| format!("{}: {count}", answer.name()))
    };
    let with_claim = Answer::ALL.into_iter().filter(|answer| *answer != Answer::NoClaim);
    list(with_claim.filter_map(of))
}

/// How frames were measured, the same in every study.
pub(crate) fn turns<R: Record>(runs: &Runs<'_, R>) -> Markup {
    let frames = || runs.iter().map(|run| run.common().frames + run.common().outliers);
    let (most, fewest) = (frames().max().unwrap_or_default(), frames().min().unwrap_or_default());
    let outliers: u64 = runs.iter().map(|run| u64::from(run.common().outliers)).sum();
    html! {
        "A frame is the whole picture at all its samples. The structures that a \
         figure compares take turns, so that whatever happens to the machine happens to all of them; each turn \
         begins with a sample per pixel that does not count. " (fewest) " to " (most) " frames of each configuration were \
         measured, fewer where they are slow. Frames with a z-score above " (MAX_Z) " were left out as outliers ("
        (outliers) " in all; among ten frames or fewer none can be); the rest is given by its median."
    }
}

/// What the noise is, and how claims are judged; `repeats` says what is measured more than once.
pub(crate) fn judgement<R: Record>(runs: &Runs<'_, R>, repeats: &str) -> Markup {
    let is_known = runs.backends().into_iter().any(|backend| runs.on(backend).knows_noise());
    let noise = |backend| {
        let on = runs.on(backend);
        let taken = match (on.knows_noise(), is_known) {
            (true, _) => "",
            (false, true) => " (taken over: nothing was measured twice there)",
            (false, false) => " (assumed: nothing was measured twice)",
        };
        format!("{} on the {}{taken}", percent(on.noise().0), backend_name(backend))
    };
    html! {
        p {
            "Noise: " (repeats) " " (percent(NOISE_QUANTILE)) " of such pairs of one sweep differ by less than the noise, which is taken \
             as 5 % at least: " (list(runs.backends().into_iter().map(noise))) ". Speeds that differ by less cannot \
             be told apart. Where the frames of two runs scatter more than that, it is their own scatter that counts: \
             speeds whose middle halves of frames (from a quarter to three quarters) overlap cannot be told apart \
             either. Sweeps are made one after the other and the machine may change between them; speeds of \
             different sweeps are not compared."
        }
        p {
            "A claim is taken apart into checks: it holds if all do that can be told, holds partly if some do, and \
             cannot be told if more than half lie within the noise. A change is major or noticeable if the ratio of \
             two speeds is above " (MAJOR) "; less is alike. Best are the settings than which no other is known to be \
             faster. Claims that begin with “Expected” are not the report's."
        }
    }
}

/// Says so if runs are missing that were to be made.
pub(crate) fn stopped<R: Record>(runs: &Runs<'_, R>) -> Markup {
    let studies = runs.values(|run| (run.common().date, run.common().planned_runs));
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

/// Says which backends were measured; `figures` makes the figures of some runs.
pub(crate) fn backends<R: Record>(
    runs: &Runs<'_, R>,
    figures: impl Fn(&Runs<'_, R>) -> Vec<Figure>,
) -> Markup {
    html! {
        @if runs.on("gpu").is_empty() || runs.on("cpu").is_empty() {
            p { "Only one backend was measured." }
        } @else {
            p {
                @if most_pixels(&runs.on("gpu")) < most_pixels(&runs.on("cpu")) {
                    "On the GPU pictures are smaller than on the CPU, for a software driver is many times slower than \
                     native code; compare structures within a backend, not backends with each other."
                } @else {
                    "Pictures have other sizes on the GPU; compare structures within a backend."
                }
                @let cpu_only = cpu_only(&figures(&runs.on("cpu")), &figures(&runs.on("gpu")));
                @if !cpu_only.is_empty() { " Measured on the CPU only: figures " (cpu_only.join(", ")) "." }
            }
        }
    }
}

fn most_pixels<R: Record>(runs: &Runs<'_, R>) -> u64 {
    let pixels = |run: &R| u64::from(run.common().width) * u64::from(run.common().height);
    runs.iter().map(pixels).max().unwrap_or_default()
}

/// The numbers of the figures that runs on the CPU give an answer to and runs on the GPU do not.
fn cpu_only(of_cpu: &[Figure], of_gpu: &[Figure]) -> Vec<String> {
    let is_there = |figure: &Figure| figure.verdict.answer != Answer::NotMeasured;
    let pairs = of_cpu.iter().zip(of_gpu).filter(|(cpu, gpu)| is_there(cpu) && !is_there(gpu));
    pairs.map(|(figure, _)| figure.number.to_string()).collect()
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

/// An answer, in its colour.
pub(crate) fn badge(answer: Answer) -> Markup {
    let class = match answer {
        Answer::Holds => "holds",
        Answer::Partly => "partly",
        Answer::Fails => "fails",
        Answer::Open | Answer::NoClaim | Answer::NotMeasured => "none",
    };
    html! { span class={ "verdict " (class) } { (answer.name()) } }
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

/// A part of a figure.
///
/// # Errors
/// [`StudyError::Page`] if a chart cannot be drawn.
pub(crate) fn part(part: &Part) -> Result<Markup, StudyError> {
    Ok(match part {
        Part::Chart(drawing) if drawing.is_empty() => html! {},
        Part::Chart(drawing) => chart(drawing)?,
        Part::Heat(map) => heat(map),
        Part::Picture(png, alt) => html! { img src={ "data:image/png;base64," (png) } alt=(alt); },
        Part::Pictures(pictures) => html! {
            div class="pictures" {
                @for (png, text) in pictures {
                    figure { img src={ "data:image/png;base64," (png) } alt=(text); figcaption { (text) } }
                }
            }
        },
        Part::Table(rows) => table(rows),
        Part::Drawing(svg) => html! { (PreEscaped(svg)) },
    })
}

/// Rows under their head.
pub(crate) fn table(table: &Table) -> Markup {
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
