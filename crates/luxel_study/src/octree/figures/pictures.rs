//! Figures 1, 2, 4, 5 and 6: pictures.
use super::super::record::{Run, Sweep};
use super::super::select::{Runs, setting};
use crate::kit::draw::{picture, without_claim};
use crate::kit::figure::Figure;
use crate::kit::text::{percent, short};

/// Numbers, names and settings (samples, depth) of the report's qualities.
const QUALITIES: [(u32, &str, u32, u32); 3] = [(4, "low", 4, 4), (5, "standard", 16, 8), (6, "high", 32, 16)];

pub(crate) fn figures(runs: &Runs<'_>) -> Vec<Figure> {
    let mut figures = vec![materials(runs), scene(runs)];
    figures.extend(QUALITIES.map(|row| quality(runs, row)));
    figures
}

/// What light met in a frame; `None` without a run.
fn bounces_text(run: Option<&Run>) -> Option<String> {
    let run = run?;
    let [lambert, metal, dielectric] =
        [run.lambert_bounces, run.metal_bounces, run.dielectric_bounces].map(short);
    Some(format!(
        "A frame has {lambert} bounces off Lambert, {metal} off metal and {dielectric} off dielectric surfaces."
    ))
}

fn materials(runs: &Runs<'_>) -> Figure {
    let runs = runs.of(Sweep::Materials);
    let run = runs.first();
    Figure {
        number: 1,
        title: "The 3 used materials. From left to right: Lambert, Metal, Dielectric".to_owned(),
        shows: format!("A diffuse, a metal and a glass sphere under our sky ({}).", setting(run)),
        claim: None,
        verdict: without_claim(bounces_text(run)),
        parts: picture(run, "three spheres: matt red, golden metal, clear glass"),
    }
}

fn scene(runs: &Runs<'_>) -> Figure {
    let runs = runs.of(Sweep::Scene);
    let run = runs.first();
    Figure {
        number: 2,
        title: "Example of the random scene with 100 spheres".to_owned(),
        shows: format!(
            "Random spheres of the three materials in a box, the scene of all measurements ({}).",
            setting(run)
        ),
        claim: None,
        verdict: without_claim(bounces_text(run)),
        parts: picture(run, "a hundred random spheres in front of the sky"),
    }
}

fn quality(runs: &Runs<'_>, (number, name, samples, depth): (u32, &str, u32, u32)) -> Figure {
    let runs = runs.of(Sweep::Quality);
    let of = |name: &str| runs.iter().find(|run| run.quality == name);
    let run = of(name);
    let below = QUALITIES.iter().take_while(|row| row.1 != name).last().and_then(|row| of(row.1));
    let mut title = name.to_owned();
    title[..1].make_ascii_uppercase();
    Figure {
        number,
        title: format!("{title} Quality"),
        shows: format!(
            "The same scene at {samples} samples per pixel and ray depth {depth}: how clean the picture becomes."
        ),
        claim: None,
        verdict: without_claim(cost_text(run, below)),
        parts: picture(run, &format!("the scene at {name} quality")),
    }
}

/// Time and noise of a picture, and of the quality below it; `None` without a run.
fn cost_text(run: Option<&Run>, below: Option<&Run>) -> Option<String> {
    let cost = |run: &Run| Some(format!("{} ms, with noise of {}", short(run.frame_ms), percent(run.noise?)));
    let this = cost(run?)?;
    let below = below.and_then(|below| Some(format!(" ({} quality: {})", below.quality, cost(below)?)));
    Some(format!("A frame takes {this}{}.", below.unwrap_or_default()))
}

#[cfg(test)]
mod tests {
    use super::super::super::record::example;
    use super::*;
    use crate::kit::verdict::Answer;

    #[test]
    fn a_quality_is_set_beside_the_one_below() {
        let low = Run { frame_ms: 5.0, noise: Some(0.2), quality: "low".to_owned(), ..example() };
        let high = Run { frame_ms: 20.0, noise: Some(0.1), ..example() };
        let text = cost_text(Some(&high), Some(&low)).unwrap();
        assert!(text.starts_with("A frame takes 20 ms, with noise of 10 % (low quality: 5 ms"), "{text}");
        assert_eq!(cost_text(None, Some(&low)), None);
    }

    #[test]
    fn pictures_claim_nothing_and_say_what_they_show() {
        let run = Run { sweep: Sweep::Materials, ..example() };
        let figure = materials(&Runs::all(std::slice::from_ref(&run)));
        assert_eq!((figure.verdict.answer, figure.claim), (Answer::NoClaim, None));
        assert!(figure.verdict.because.contains("10 off metal"));
    }
}
