//! Figure 7: one normal per triangle against interpolated ones.
use super::super::plan::SHADINGS;
use super::super::record::Sweep;
use super::super::select::{Runs, setting};
use crate::kit::figure::{Figure, Part};
use crate::kit::picture::flip;
use crate::kit::text::{percent, short};
use crate::kit::verdict::{Case, MAJOR, Verdict};

/// Mean FLIP difference of pictures from which on a difference is clearly seen somewhere in them.
const SEEN: f64 = 0.005;

pub(crate) fn figure(runs: &Runs<'_>) -> Figure {
    let shading = runs.of(Sweep::Shading);
    let (mut cases, mut because) = (Vec::new(), String::new());
    for (name, on) in shading.by_backend() {
        let of = |index: usize| on.variant(SHADINGS[index].0)?.picture_png.as_deref();
        let between = |flat, smooth| flip(of(flat)?, of(smooth)?);
        if let (Some(diffuse), Some(plastic)) = (between(0, 1), between(2, 3)) {
            cases.extend([Case::from(diffuse > SEEN), more(plastic, diffuse)]);
            let noise = on.iter().filter_map(|run| run.noise).fold(0.0, f64::max);
            because += &format!(
                "On the {name} flat and smooth shading differ by {} with the diffuse and by {} with the semi-specular \
                 material (mean FLIP; the pictures' noise is up to {}). ",
                short(diffuse),
                short(plastic),
                percent(noise)
            );
        }
    }
    let pictures = shading.iter().filter_map(|run| Some((run.picture_png.clone()?, run.variant.clone())));
    let pictures: Vec<(String, String)> = pictures.collect();
    Figure {
        number: 7,
        title: "Bunny with 70k triangles, and its triangles".to_owned(),
        shows: format!(
            "From near by, with one normal per triangle and with interpolated normals, diffuse and semi-specular ({}).",
            setting(shading.first())
        ),
        claim: Some(
            "With one normal per triangle flat shading is seen clearly; it matters less with a diffuse material, and \
             becomes more noticeable as soon as there are reflections."
                .to_owned(),
        ),
        verdict: Verdict::of(&cases, because),
        parts: if pictures.is_empty() { Vec::new() } else { vec![Part::Pictures(pictures)] },
    }
}

/// Is a difference noticeably greater than another?
fn more(a: f64, b: f64) -> Case {
    match a / b.max(f64::MIN_POSITIVE) {
        ratio if ratio > MAJOR => Case::Yes,
        ratio if ratio * MAJOR < 1.0 => Case::No,
        _ => Case::Open,
    }
}
