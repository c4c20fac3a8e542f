//! Figures 3.4 to 3.8: the lamp behind a grid, and the slackline.
use glam::{UVec3, Vec3};
use luxel_accel::{Svo, SvoVoxel, build_svo};
use luxel_engine::output::Picture as Bytes;
use luxel_lod::{ErrorAware, ErrorTable, NodeError, Octree, Picture, View, error_aware, plain, reference};

use super::section::{Section, cell};
use super::select::{Map, Renderer, Runs, gain, pictures};
use crate::StudyError;
use crate::kit::figure::Part;
use crate::kit::picture::png;
use crate::kit::verdict::{Case, Verdict};
use crate::voxel::ask::Sweep;
use crate::voxel::thesis::BEST;

/// Voxels along an edge of the box.
const EDGE: u16 = 32;
/// Pixels along an edge of the pictures.
const PIXELS: u32 = 192;

const WALL: [u8; 3] = [170, 165, 155];
const RED: [u8; 3] = [170, 40, 35];
const GREEN: [u8; 3] = [50, 130, 50];
const LAMP: [u8; 3] = [255, 245, 200];
const GRID: [u8; 3] = [70, 75, 85];

pub(super) fn sections(runs: &Runs<'_>) -> Result<Vec<Section>, StudyError> {
    let mut sections = grid_lamp()?;
    sections.extend(slackline(runs));
    Ok(sections)
}

/// A Cornell box of 32³ with a lamp at the back and a grid of gaps one voxel wide at the front (§3.2.2).
fn cornell_box() -> Result<Svo, StudyError> {
    let last = EDGE - 1;
    let mut voxels = Vec::new();
    let mut put = |cell: [u16; 3], color| voxels.push(SvoVoxel { cell, color, material: 0 });
    for a in 0..EDGE {
        for b in 0..EDGE {
            let is_lamp = [a, b].iter().all(|at| (10..22).contains(at));
            put([a, b, 0], if is_lamp { LAMP } else { WALL });
            if a % 2 == 0 || b % 2 == 0 {
                put([a, b, last], GRID);
            }
        }
    }
    for z in 1..last {
        for a in 0..EDGE {
            put([a, 0, z], WALL);
            put([a, last, z], WALL);
            if (1..last).contains(&a) {
                put([0, a, z], RED);
                put([last, a, z], GREEN);
            }
        }
    }
    Ok(build_svo(&voxels, UVec3::splat(u32::from(EDGE)))?)
}

fn grid_lamp() -> Result<Vec<Section>, StudyError> {
    let svo = cornell_box()?;
    let octree = Octree::of(&svo);
    let middle = Vec3::splat(0.5 * f32::from(EDGE));
    let aslant = View::toward(Vec3::new(30.0, 26.0, 74.0), middle, 0.9, PIXELS);
    let at_level = |level: u32| plain(&octree, &View { level, ..aslant });
    let setup = [0, 1, 2].map(|level| {
        (at_level(level), format!("({}) level of detail {level}", ["a", "b", "c"][level as usize]))
    });
    let far = View { size: PIXELS / 2, ..View::toward(Vec3::new(16.0, 16.0, 110.0), middle, 0.4, PIXELS) };
    let table = ErrorTable::directions();
    let error = NodeError { table: &table, decay: BEST[0] as f32 };
    let settings = ErrorAware { error, threshold: BEST[1] as f32, keeps_ray: false, luminance: None };
    let [best, coarse, aware] =
        [reference(&octree, &far), plain(&octree, &far), error_aware(&octree, &far, &settings)];
    let misses = [&coarse, &aware].map(|picture| rmse(&best, picture));
    let levels = Bytes { width: far.size, height: far.size, pixels: levels(&aware, far.level) };
    let shown = |picture: &Picture, text: &str| Ok::<_, StudyError>((png(&bytes(picture))?, text.to_owned()));
    let scene = setup.iter().map(|(picture, text)| shown(picture, text)).collect::<Result<_, _>>()?;
    let compared = vec![
        shown(&best, "(a) reference")?,
        shown(&coarse, "(b) plain level of detail")?,
        shown(&aware, "(c) error-aware")?,
    ];
    let stands_in = "The thesis shows the light that falls through the grid, by shadow rays whose level of detail goes by the \
                     distance. Here the camera's rays look at the lamp through the same grid instead: what they see of it is what \
                     it lights.";
    let claim = "Error-aware keeps what plain level of detail loses: at most a quarter of its RMSE.";
    let said =
        format!("RMSE is {:.4} with plain level of detail and {:.4} error-aware.", misses[0], misses[1]);
    let quality = Section {
        claim: Some(claim.to_owned()),
        verdict: Verdict::of(&[Case::from(4.0 * misses[1] <= misses[0])], said),
        ..Section::figure((3, 5), "Test scene shadow ray quality comparison", vec![Part::Pictures(compared)])
    };
    let map = vec![(png(&levels)?, "finest level of each pixel, white for the leaves".to_owned())];
    Ok(vec![
        Section::figure((3, 4), "Test scene setup", vec![Part::Pictures(scene)])
            .noted(["From the second level on the grid is a plane that hides the lamp.".to_owned()]),
        quality.noted([stands_in.to_owned()]),
        Section::figure((3, 6), "Test scene level of detail visualization", vec![Part::Pictures(map)])
            .noted([stands_in.to_owned()]),
    ])
}

fn bytes(picture: &Picture) -> Bytes {
    let codes = picture.codes();
    let pixels =
        codes.as_chunks::<3>().0.iter().map(|code| code.map(|c| (255.0 * c).round() as u8)).collect();
    Bytes { width: picture.size, height: picture.size, pixels }
}

fn levels(picture: &Picture, level: u32) -> Vec<[u8; 3]> {
    let byte =
        |finest: u8| level.checked_sub(u32::from(finest)).map_or(0, |below| 85 * (below as u8 + 1).min(3));
    picture.pixels.iter().map(|pixel| [byte(pixel.finest); 3]).collect()
}

fn rmse(reference: &Picture, picture: &Picture) -> f64 {
    let (a, b) = (reference.codes(), picture.codes());
    let squares: f64 = a.iter().zip(&b).map(|(a, b)| f64::from(a - b).powi(2)).sum();
    (squares / a.len() as f64).sqrt()
}

fn slackline(runs: &Runs<'_>) -> [Section; 2] {
    let of = |renderer| runs.at(Sweep::Views, renderer, |run| run.view == "slackline");
    let [best, coarse, aware] = [Renderer::Reference, Renderer::Plain, Renderer::ErrorAware].map(of);
    let example = pictures([
        (best, Map::Picture, "(a) the leaves".to_owned()),
        (coarse, Map::Picture, "(b) plain level of detail: the line is as thick as a node".to_owned()),
    ]);
    let results = pictures([
        (aware, Map::Picture, "(a) error-aware".to_owned()),
        (aware, Map::Levels, "(b) finest level, white for the leaves".to_owned()),
        (aware, Map::Difference, "eight times the difference from the reference".to_owned()),
        (coarse, Map::Difference, "plain level of detail: eight times the difference".to_owned()),
    ]);
    let figure = Section::figure((3, 8), "Slackline error-aware rendering test results", vec![results]);
    let gained = aware.zip(coarse).and_then(|(aware, coarse)| gain(aware, coarse));
    let verdict = Verdict::of(
        &gained.map(|gained| Case::from(gained > 0.0)).into_iter().collect::<Vec<_>>(),
        cell(gained, |gained| format!("Error-aware is {gained:+.2} dB against plain level of detail.")),
    );
    let claim = Some("With error-aware refinement the slackline does not thicken.".to_owned());
    [
        Section::figure((3, 7), "Slackline dataset example", vec![example]),
        Section { claim, verdict, ..figure },
    ]
}
