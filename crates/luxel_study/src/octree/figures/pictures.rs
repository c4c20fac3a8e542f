//! Figures 1, 2, 4, 5 and 6: pictures.
use super::super::figure::{Figure, Part, setting};
use super::super::record::{Run, Sweep};
use super::super::select::Runs;
use super::super::text::{percent, short};
use super::super::verdict::Verdict;

/// Numbers, names and settings (samples, depth) of the report's qualities.
const QUALITIES: [(u32, &str, u32, u32); 3] = [(4, "low", 4, 4), (5, "standard", 16, 8), (6, "high", 32, 16)];

pub(crate) fn figures(runs: &Runs<'_>) -> Vec<Figure> {
    let mut figures = vec![materials(runs), scene(runs)];
    figures.extend(QUALITIES.map(|row| quality(runs, row)));
    figures
}

fn picture(run: Option<&Run>, alt: &str) -> Vec<Part> {
    let picture = run.and_then(|run| run.picture_png.clone());
    picture.map(|png| Part::Picture(png, alt.to_owned())).into_iter().collect()
}

/// Light left all three materials.
fn material_verdict(run: Option<&Run>) -> Verdict {
    let Some(run) = run else { return Verdict::not_measured() };
    let bounces = [run.lambert_bounces, run.metal_bounces, run.dielectric_bounces];
    let [lambert, metal, dielectric] = bounces.map(short);
    Verdict::of(
        &bounces.map(|count| count > 0.0),
        format!(
            "A frame has {lambert} bounces off Lambert, {metal} off metal and {dielectric} off dielectric surfaces."
        ),
    )
}

fn materials(runs: &Runs<'_>) -> Figure {
    let runs = runs.of(Sweep::Materials);
    let run = runs.first();
    Figure {
        number: 1,
        title: "The 3 used materials. From left to right: Lambert, Metal, Dielectric".to_owned(),
        shows: format!("A diffuse, a metal and a glass sphere under our sky ({}).", setting(run)),
        claim: "Spheres of three materials, Lambert, metal and dielectric, can be told apart.".to_owned(),
        verdict: material_verdict(run),
        parts: picture(run, "three spheres: matt red, golden metal, clear glass"),
    }
}

fn scene(runs: &Runs<'_>) -> Figure {
    let runs = runs.of(Sweep::Scene);
    let run = runs.first();
    let is_it = run.is_some_and(|run| run.spheres == 100);
    Figure {
        number: 2,
        title: "Example of the random scene with 100 spheres".to_owned(),
        shows: format!(
            "Random spheres of the three materials in a box, the scene of all measurements ({}).",
            setting(run)
        ),
        claim: "A random scene of N spheres of three materials is diverse enough to measure with.".to_owned(),
        verdict: material_verdict(run.filter(|_| is_it)),
        parts: picture(run, "a hundred random spheres in front of the sky"),
    }
}

fn quality(runs: &Runs<'_>, (number, name, samples, depth): (u32, &str, u32, u32)) -> Figure {
    let runs = runs.of(Sweep::Quality);
    let of = |name: &str| runs.iter().find(|run| run.quality == name);
    let run = of(name);
    let mut title = name.to_owned();
    title[..1].make_ascii_uppercase();
    Figure {
        number,
        title: format!("{title} Quality"),
        shows: format!(
            "The same scene at {samples} samples per pixel and ray depth {depth}: how clean the picture becomes."
        ),
        claim: format!(
            "{title} quality ({samples} samples, depth {depth}) costs more than the level below and has less noise."
        ),
        verdict: quality_verdict(
            run,
            QUALITIES.iter().take_while(|row| row.1 != name).last().and_then(|row| of(row.1)),
        ),
        parts: picture(run, &format!("the scene at {name} quality")),
    }
}

fn quality_verdict(run: Option<&Run>, below: Option<&Run>) -> Verdict {
    let Some((run, noise)) = run.and_then(|run| Some((run, run.noise?))) else {
        return Verdict::not_measured();
    };
    let this = format!("A frame takes {} ms, its noise is {}", short(run.frame_ms), percent(noise));
    match below.and_then(|below| Some((below, below.noise?))) {
        None => Verdict::of(&[run.spp == 4, run.bounces == 4], format!("{this}; it is the lowest level.")),
        Some((below, noise_below)) => Verdict::of(
            &[run.frame_ms > below.frame_ms, noise < noise_below],
            format!(
                "{this}; at {} quality {} ms and {}.",
                below.quality,
                short(below.frame_ms),
                percent(noise_below)
            ),
        ),
    }
}

#[cfg(test)]
mod tests {
    use super::super::super::record::example;
    use super::super::super::verdict::Answer;
    use super::*;

    #[test]
    fn a_better_quality_is_slower_and_cleaner() {
        let run = |frame_ms: f64, noise: f64| Run { frame_ms, noise: Some(noise), ..example() };
        let answer = |a: &Run, b: &Run| quality_verdict(Some(a), Some(b)).answer;
        assert_eq!(answer(&run(20.0, 0.1), &run(5.0, 0.2)), Answer::Holds);
        assert_eq!(answer(&run(4.0, 0.1), &run(5.0, 0.2)), Answer::Partly);
        assert_eq!(answer(&run(4.0, 0.3), &run(5.0, 0.2)), Answer::Fails);
        assert_eq!(quality_verdict(None, Some(&run(1.0, 1.0))).answer, Answer::NotMeasured);
    }

    #[test]
    fn a_material_without_light_is_missed() {
        let dark = Run { metal_bounces: 0.0, ..example() };
        assert_eq!(material_verdict(Some(&dark)).answer, Answer::Partly);
        assert_eq!(material_verdict(Some(&example())).answer, Answer::Holds);
    }
}
