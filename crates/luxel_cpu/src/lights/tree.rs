//! The light tree: a light picked in proportion to what it may contribute.
//!
//! Theory: Conty and Kulla 2018; pbrt-v4 §12.6.3, `LightBounds::Importance`. Deviations: lights are taken to be as far
//! away as their box's centre, but at least an eighth of its diagonal, which scales as distances do; no cosine counts for
//! less than `LEAST_LIGHT_COSINE`, so that no light that contributes is ruled out by rounding; and two nodes are compared
//! without dividing by a squared distance, which may be no number.
use luxel_flat::{Counter, Counters, FlatScene, LEAST_LIGHT_COSINE, LIGHT_LEAF, LightNode, NONE};
use luxel_geom::{Real, Vector};

use super::Receiver;

/// A bound on the levels of a tree: a trail has 32 bits.
const MAX_LEVELS: u32 = 32;
/// Squared distances that differ by more count as differing by that.
const LEAST_RATIO: f64 = 1e-18;

/// Squared distance of lights around a point, at least, in parts of their box's half diagonal squared. Of those nearby
/// one is far nearer than the centre: with 1 a plain of 10,000 lamps had 18 times the variance.
const LEAST_SQUARE: f64 = 1.0 / 16.0;

/// What the lights of a node may contribute: `strength / square`.
#[derive(Clone, Copy)]
struct Importance<R> {
    strength: R,
    square: R,
}

/// Picks a light; returns it and its probability. `None` without lights. `u` is in `[0, 1)`.
pub fn pick<R: Real>(
    scene: &FlatScene,
    receiver: &Receiver<R>,
    u: R,
    counters: &mut Counters,
) -> Option<(u32, R)> {
    let (mut index, mut u, mut probability) = (0, u, R::ONE);
    for _ in 0..MAX_LEVELS {
        let node = node(scene, index)?;
        if node.content & LIGHT_LEAF != 0 {
            return Some((node.content & !LIGHT_LEAF, probability));
        }
        let first = first_share(scene, index, node, receiver, counters)?;
        let is_second = u >= first;
        let share = if is_second { R::ONE - first } else { first };
        u = ((if is_second { u - first } else { u }) / share).clamped(R::ZERO, R::BELOW_ONE);
        probability *= share;
        index = if is_second { node.content } else { index + 1 };
    }
    None
}

/// The probability with which [`pick`] takes the light of a trail.
pub fn probability<R: Real>(
    scene: &FlatScene,
    trail: u32,
    receiver: &Receiver<R>,
    counters: &mut Counters,
) -> R {
    let (mut index, mut probability) = (0, R::ONE);
    if trail == NONE {
        return R::ZERO;
    }
    for depth in 0..MAX_LEVELS {
        let Some(node) = node(scene, index) else { return R::ZERO };
        if node.content & LIGHT_LEAF != 0 {
            return probability;
        }
        let Some(first) = first_share(scene, index, node, receiver, counters) else { return R::ZERO };
        let is_second = trail >> depth & 1 != 0;
        probability *= if is_second { R::ONE - first } else { first };
        index = if is_second { node.content } else { index + 1 };
    }
    R::ZERO
}

fn node(scene: &FlatScene, index: u32) -> Option<&LightNode> {
    scene.light_nodes.as_slice().get(index as usize)
}

/// Probability of the first child of an inner node.
fn first_share<R: Real>(
    scene: &FlatScene,
    index: u32,
    parent: &LightNode,
    receiver: &Receiver<R>,
    counters: &mut Counters,
) -> Option<R> {
    counters[Counter::LightNodes] += 2;
    let first = importance(node(scene, index + 1)?, receiver);
    let second = importance(node(scene, parent.content)?, receiver);
    let farther = first.square.max(second.square);
    let ratio = |square: R| {
        if farther > R::ZERO { (square / farther).max(R::from_f64(LEAST_RATIO)) } else { R::ONE }
    };
    let (a, b) = (first.strength * ratio(second.square), second.strength * ratio(first.square));
    Some(if a + b > R::ZERO { a / (a + b) } else { R::from_f64(0.5) })
}

/// What a node's lights may contribute at a point.
fn importance<R: Real>(node: &LightNode, receiver: &Receiver<R>) -> Importance<R> {
    let half = R::from_f64(0.5);
    let [lo, hi] = [node.lo, node.hi].map(R::Vec3::from_array);
    let (to_center, half_size) = ((lo + hi) * half - receiver.point, (hi - lo) * half);
    let (square, radius_square) = (to_center.dot(to_center), half_size.dot(half_size));
    let power = R::from_f32(node.power);
    if square <= radius_square {
        return Importance { strength: power, square: square.max(radius_square * R::from_f64(LEAST_SQUARE)) };
    }
    let wi = to_center * (R::ONE / square.sqrt());
    // The cone under which the bounding sphere is seen. Of far lights its cosine no longer tells the sine.
    let sine_square = radius_square / square;
    let cone = Angle { cos: (R::ONE - sine_square).max(R::ZERO).sqrt(), sin: sine_square.sqrt() };
    let cos_w = -wi.dot(R::Vec3::from_array(node.axis));
    let cos_w = if node.two_sided == 1 { cos_w.abs() } else { cos_w };
    let cos_x = cos_of_difference(cos_w, Angle::of(R::from_f32(node.cos_normals)));
    let cos_leaving = cos_of_difference(cos_x, cone);
    let is_lit = cos_leaving > R::from_f32(node.cos_emission);
    let cos_arriving = cos_of_difference(wi.dot(receiver.normal).abs(), cone);
    let least = R::from_f32(LEAST_LIGHT_COSINE);
    let leaving = if is_lit { cos_leaving.max(least) } else { least };
    Importance { strength: power * leaving * cos_arriving.max(least), square }
}

/// An angle in `[0, π]`.
#[derive(Clone, Copy)]
struct Angle<R> {
    cos: R,
    sin: R,
}

impl<R: Real> Angle<R> {
    fn of(cos: R) -> Self {
        Self { cos, sin: (R::ONE - cos * cos).max(R::ZERO).sqrt() }
    }
}

/// Cosine of `max(0, a − b)`; `a` is given by its cosine.
fn cos_of_difference<R: Real>(cos_a: R, b: Angle<R>) -> R {
    if cos_a > b.cos {
        return R::ONE;
    }
    cos_a * b.cos + Angle::of(cos_a).sin * b.sin
}
