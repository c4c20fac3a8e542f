//! Table 3.1 and figures 3.1 to 3.3: the error of a node by direction.
use glam::{DVec2, DVec3};
use luxel_accel::lod_error::{Errors, OctantShares, Sh9, even_directions, multi_jittered};

use super::cube::{drawing, sphere};
use super::section::{Section, rows};
use crate::StudyError;
use crate::kit::figure::Part;
use crate::kit::text::{list, times};
use crate::kit::verdict::Case;
use crate::voxel::thesis::{BEST, RAY_CAST_BOUNDS};

/// The example of figure 3.1: the four children of one side, which hide nothing from it and half of the cell from above.
const EXAMPLE: u8 = 0b0101_0101;
/// Directions that the ray-cast errors are compared along.
const COMPARED: u32 = 12;
/// Directions of the document's table (§3.2).
const DIRECTIONS: u32 = 256;
/// Edge of the picture cast along each for figure 3.2.
const CAST: u32 = 64;
const SEED: u32 = 1;
/// Places along an edge of a quarter in figure 3.3.
const PLACES: u32 = 8;

pub(super) fn sections() -> Result<Vec<Section>, StudyError> {
    Ok(vec![node(), ray_cast(), over_directions()?, jitter()])
}

fn node() -> Section {
    let [aslant, side, top] = [DVec3::new(-1.0, -0.8, -0.6), DVec3::X, -DVec3::Y]
        .map(|direction| (drawing(EXAMPLE, direction), direction));
    let said = |(_, direction): &(String, DVec3)| {
        format!("{:.3}", OctantShares::exact(*direction).errors()[usize::from(EXAMPLE)])
    };
    let note = format!(
        "The dashed box is the node, the solids are its four children: aslant, from the side and from above. The exact errors are \
         {}, {} and {}.",
        said(&aslant),
        said(&side),
        said(&top)
    );
    let parts = [aslant, side, top].map(|(svg, _)| Part::Drawing(svg)).to_vec();
    Section::figure((3, 1), "Octree node example", parts).noted([note])
}

/// The largest and the mean difference between ray-cast and exact errors, of all sets of children.
fn differences(resolution: u32) -> (f64, f64) {
    let (mut most, mut sum) = (0.0f64, 0.0);
    for direction in even_directions(COMPARED) {
        let exact = OctantShares::exact(direction).errors();
        let cast = OctantShares::by_rays(direction, resolution, SEED).errors();
        // A leaf has no error by any method.
        for (a, b) in exact.iter().zip(&cast).skip(1) {
            most = most.max((a - b).abs());
            sum += (a - b).abs();
        }
    }
    (most, sum / f64::from(255 * COMPARED))
}

fn ray_cast() -> Section {
    let found = RAY_CAST_BOUNDS.map(|(resolution, bound)| (resolution, bound, differences(resolution)));
    let mut cases: Vec<Case> = found.iter().map(|(_, bound, (most, _))| Case::from(most <= bound)).collect();
    cases.push(Case::from(found.is_sorted_by(|a, b| a.2.1 <= b.2.1)));
    let margins = list(found.iter().map(|(_, bound, (most, _))| times(bound / most)));
    let because = format!("From 512² down, the bound is {margins} the largest error that was found.");
    let line = |(resolution, bound, (most, mean)): &(u32, f64, (f64, f64))| {
        vec![
            format!("{resolution}×{resolution}"),
            bound.to_string(),
            format!("{most:.5}"),
            format!("{mean:.6}"),
        ]
    };
    let claim = "The error of casting rays stays below the bound and falls with the resolution.";
    Section::table((3, 1), "Error introduced through raycasting approximation", claim, &cases, because)
        .with([rows(&["Resolution", "Bound, thesis", "Largest error", "Mean error"], found.iter().map(line).collect())])
        .noted([format!(
            "The thesis bounds the error by half a cell along all 48 units of edges and measures none. Ours are differences from \
             exact areas over {COMPARED} directions and all 255 sets of children."
        )])
}

fn over_directions() -> Result<Section, StudyError> {
    let directions = even_directions(DIRECTIONS);
    let cast: Vec<(DVec3, Errors)> =
        directions.iter().map(|d| (*d, OctantShares::by_rays(*d, CAST, SEED).errors())).collect();
    let sh9 = Sh9::project(&cast);
    let example = usize::from(EXAMPLE);
    let nearest = |direction: DVec3| {
        let found = cast.iter().max_by(|a, b| a.0.dot(direction).total_cmp(&b.0.dot(direction)));
        found.map_or(0.0, |(_, errors)| errors[example])
    };
    let exact = |direction: DVec3| OctantShares::exact(direction).errors()[example];
    let harmonic = |direction: DVec3| sh9.errors(direction)[example];
    let threshold = BEST[1];
    let pictures = vec![
        (sphere(nearest, threshold)?, format!("ray cast: the nearest of {DIRECTIONS} directions")),
        (sphere(harmonic, threshold)?, "sh9: nine coefficients of them".to_owned()),
        (sphere(exact, threshold)?, "exact areas".to_owned()),
    ];
    let misses = even_directions(1000).into_iter().map(|d| (harmonic(d) - exact(d)).abs());
    let most = misses.fold(0.0, f64::max);
    Ok(Section::figure((3, 2), "Sample error values", vec![Part::Pictures(pictures)]).noted([
        format!("Brighter is a larger error; red is above the threshold, {threshold}. Rays were cast as pictures of {CAST}²."),
        format!("For this node the nine coefficients are off by up to {most:.3}, as much as the threshold has.")
            .replace(", as much as the threshold has", if most >= threshold { ", more than the threshold" } else { "" }),
    ]))
}

fn jitter() -> Section {
    let mut shapes = String::new();
    for quarter in 0..4 {
        let corner = DVec2::new(f64::from(quarter & 1), f64::from(quarter >> 1)) * 150.0;
        shapes += &format!(
            "<rect x=\"{}\" y=\"{}\" width=\"150\" height=\"150\" fill=\"none\" stroke=\"#8c1820\"/>",
            corner.x, corner.y
        );
        for place in multi_jittered(PLACES, [SEED, quarter]) {
            let at = corner + place * 150.0;
            shapes += &format!("<circle cx=\"{:.1}\" cy=\"{:.1}\" r=\"2\"/>", at.x, at.y);
        }
    }
    let svg = format!("<svg viewBox=\"-2 -2 304 304\" style=\"max-width:304px\">{shapes}</svg>");
    Section::figure((3, 3), "Sample jittering from [Ken13]", vec![Part::Drawing(svg)]).noted([format!(
        "Correlated multi-jittered places in the four quarters of the picture that is cast, {PLACES}² each."
    )])
}
