//! Figures 6 and 8 to 13: pictures, and their frame rates.
use super::super::plan::{BOUNCED, DIRECT, SMOOTHNESS};
use super::super::record::{Run, Sweep};
use super::super::select::{Runs, SAH, setting};
use super::{rate_text, rates};
use crate::kit::draw::{picture, without_claim};
use crate::kit::figure::{Figure, Part};
use crate::kit::picture::flip;
use crate::kit::text::{list, percent, short};
use crate::kit::verdict::{Case, Verdict};

/// Frames per second of the report, at least: bunny alone, room with mirrors.
const BUNNY_FPS: f64 = 50.0;
const ROOM_FPS: f64 = 30.0;
/// Share of dark pixels that is left at most when light may bounce, of what it was without.
const LEFT_DARK: f64 = 0.1;

pub(crate) fn figures(runs: &Runs<'_>) -> Vec<Figure> {
    vec![
        bunny(runs),
        room(runs),
        shadow(runs),
        spheres(runs),
        point_lights(runs),
        bunny_room(runs),
        floor(runs),
    ]
}

/// The first picture of a sweep, and its rates.
fn shown(runs: &Runs<'_>, alt: &str) -> Vec<Part> {
    let mut parts = picture(runs.iter().find(|run| run.picture_png.is_some()), alt);
    if !runs.is_empty() {
        parts.push(rates(runs.iter()));
    }
    parts
}

/// Whether the fastest search of each backend reaches a frame rate of the report's.
fn frame_rates(runs: &Runs<'_>, least: f64) -> (Vec<Case>, String) {
    let fastest = |on: Runs<'_>| on.iter().max_by(|a, b| a.fps.total_cmp(&b.fps)).cloned();
    let fastest: Vec<Run> = runs.by_backend().into_iter().filter_map(|(_, on)| fastest(on)).collect();
    let cases = fastest.iter().map(|run| run.frame_rate_case(run.fps_of_report() >= least)).collect();
    let rates = list(fastest.iter().map(rate_text));
    let text = format!(
        "Frames per second at 1920×1080, a sample per pixel and frame, if time goes with the pixels: {rates}. Only a \
         hardware GPU can fail this claim. "
    );
    (cases, text)
}

fn bunny(runs: &Runs<'_>) -> Figure {
    let (bunny, views) = (runs.of(Sweep::Bunny), runs.of(Sweep::Views));
    let (mut cases, mut because) = frame_rates(&bunny, BUNNY_FPS);
    let is_told = cases.iter().any(|case| *case != Case::Open);
    for (name, on) in views.by_backend() {
        let compared = ["near", "far"].map(|view| on.seen_from(view).split_by(SAH));
        if let [Some(near), Some(far)] = compared.each_ref().map(Runs::fps) {
            // Half of the claim says nothing where the other half cannot be told.
            if is_told || bunny.is_empty() {
                cases.push(on.noise_of(&compared).slower(near / far));
            }
            because +=
                &format!("Near the bunny the {name} makes {} frames for each from afar. ", short(near / far));
        }
    }
    Figure {
        number: 6,
        title: "Bunny with 70k triangles".to_owned(),
        shows: format!(
            "The {} alone under the sky ({}).",
            model(bunny.first()),
            setting(bunny.iter().find(|run| run.picture_png.is_some()))
        ),
        claim: Some(
            "As long as the camera is not too close to the bunny the frame rate is around 50 to 150 per second at \
             1920×1080 (GeForce GTX 1070)."
                .to_owned(),
        ),
        verdict: Verdict::of(&cases, because),
        parts: shown(&bunny, "a rabbit on pale ground under the sky"),
    }
}

/// What is shown in place of the bunny.
fn model(run: Option<&Run>) -> String {
    match run {
        Some(run) if run.model != "rabbit" => format!("model {}", run.model),
        _ => "rabbit, our stand-in for the Stanford bunny,".to_owned(),
    }
}

fn room(runs: &Runs<'_>) -> Figure {
    let room = runs.of(Sweep::Room);
    let (cases, because) = frame_rates(&room, ROOM_FPS);
    Figure {
        number: 8,
        title: "A room scene with mirrors and a glass sphere".to_owned(),
        shows: format!(
            "A closed room with two mirrors, a glass and a mirror sphere; the camera is inside ({}).",
            setting(room.first())
        ),
        claim: Some("Around 30 to 40 frames per second at 1920×1080 (GeForce GTX 1070).".to_owned()),
        verdict: Verdict::of(&cases, because),
        parts: shown(&room, "a room with two mirrors, a glass sphere and a mirror sphere"),
    }
}

/// Pictures with the texts below them.
fn side_by_side<'a>(runs: impl Iterator<Item = (&'a Run, String)>) -> Vec<Part> {
    let pictures: Vec<(String, String)> =
        runs.filter_map(|(run, text)| Some((run.picture_png.clone()?, text))).collect();
    if pictures.is_empty() { Vec::new() } else { vec![Part::Pictures(pictures)] }
}

fn shadow(runs: &Runs<'_>) -> Figure {
    let shadow = runs.of(Sweep::Shadow);
    let (mut cases, mut because) = (Vec::new(), String::new());
    for (name, on) in shadow.by_backend() {
        let dark = |variant| on.variant(variant).and_then(|run| run.dark);
        if let (Some(direct), Some(bounced)) = (dark(DIRECT), dark(BOUNCED)) {
            cases.push(Case::from(direct > 0.0 && bounced <= LEFT_DARK * direct));
            because += &format!(
                "On the {name} no light reaches {} of the pixels if it may not bounce, {} if it may. ",
                percent(direct),
                percent(bounced)
            );
        }
    }
    Figure {
        number: 9,
        title: "An example of bounce light in shadow".to_owned(),
        shows: format!(
            "A screen between a lamp and half of a room: direct light alone, and with the light that surfaces scatter \
             ({}).",
            setting(shadow.variant(BOUNCED))
        ),
        claim: Some("Light that bounces reaches what is in shadow.".to_owned()),
        verdict: Verdict::of(&cases, because),
        parts: side_by_side(shadow.iter().map(|run| (run, run.variant.clone()))),
    }
}

/// A figure with which the report claims nothing.
fn plain(number: u32, title: &str, shows: &str, runs: &Runs<'_>, because: impl Fn(&Run) -> String) -> Figure {
    let run = runs.first();
    Figure {
        number,
        title: title.to_owned(),
        shows: format!("{shows} ({}).", setting(run)),
        claim: None,
        verdict: without_claim(run.map(because)),
        parts: shown(runs, shows),
    }
}

fn spheres(runs: &Runs<'_>) -> Figure {
    let runs = runs.of(Sweep::Spheres);
    plain(10, "An example of diffuse spheres", "Diffuse spheres under a sky and a lamp", &runs, |run| {
        format!(
            "A frame has {} bounces off diffuse surfaces and takes {} ms.",
            short(run.lambert_bounces),
            short(run.frame_ms)
        )
    })
}

fn point_lights(runs: &Runs<'_>) -> Figure {
    let runs = runs.of(Sweep::PointLights);
    plain(
        11,
        "An example of point lights",
        "The spheres in the dark, lit by a warm, a cold and a low greenish point light",
        &runs,
        |run| {
            format!(
                "A frame sends {} rays to the lights, {} per ray from the camera, and takes {} ms.",
                short(run.shadow_rays),
                short(run.shadow_rays / f64::from(run.width * run.height * run.spp).max(1.0)),
                short(run.frame_ms)
            )
        },
    )
}

fn bunny_room(runs: &Runs<'_>) -> Figure {
    let runs = runs.of(Sweep::BunnyRoom);
    plain(
        12,
        "The room scene with the 70K bunny in it",
        "The room with the bunny and a glass sphere; every ray starts inside the room",
        &runs,
        |run| {
            format!(
                "A frame has {} rays; a ray tests {} nodes and {} triangles. How one BVH over the whole room does is \
                 shown by figure 23.",
                short(run.rays),
                short(run.nodes_per_ray + run.tlas_nodes_per_ray),
                short(run.tests_per_ray)
            )
        },
    )
}

fn floor(runs: &Runs<'_>) -> Figure {
    let floor = runs.of(Sweep::Floor);
    let (mut cases, mut because) = (Vec::new(), String::new());
    for (name, on) in floor.by_backend() {
        let of = |index: usize| on.variant(SMOOTHNESS[index].0)?.picture_png.as_deref();
        if let (Some(diffuse), Some(half), Some(mirror)) = (of(0), of(1), of(2))
            && let (Some(from_diffuse), Some(from_mirror), Some(apart)) =
                (flip(diffuse, half), flip(mirror, half), flip(diffuse, mirror))
        {
            cases.extend([Case::from(from_diffuse < apart), Case::from(from_mirror < apart)]);
            because += &format!(
                "On the {name} the half-smooth floor differs from the diffuse one by {} and from the mirror by {}; these \
                 two differ by {} (mean FLIP). ",
                short(from_diffuse),
                short(from_mirror),
                short(apart)
            );
        }
    }
    let text = |run: &Run| {
        let smoothness = SMOOTHNESS.iter().find(|row| row.0 == run.variant).map_or(0.0, |row| row.1);
        format!("smoothness {smoothness}")
    };
    Figure {
        number: 13,
        title: "An example of a semi-specular floor".to_owned(),
        shows: format!("The same floor at three values of smoothness ({}).", setting(floor.first())),
        claim: Some(
            "The semi-specular material blends between diffuse and perfect reflection by its smoothness."
                .to_owned(),
        ),
        verdict: Verdict::of(&cases, because),
        parts: side_by_side(floor.iter().map(|run| (run, text(run)))),
    }
}
