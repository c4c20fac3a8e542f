//! Error-aware adaptive rendering (seed document 3, chapter 3 and §5.1.3), and what its chapter 6 hopes for.
use std::cell::Cell;

use glam::Vec3;
use luxel_cpu::svo_walk::Entered;

use crate::contrast::Contrast;
use crate::eye::{Eye, Square, average};
use crate::node_error::NodeError;
use crate::octree::Octree;
use crate::picture::{Cost, MISSED, Picture, Pixel};
use crate::surroundings::surroundings;
use crate::view::View;

/// What the renderer goes by.
#[derive(Clone, Copy, Debug)]
pub struct ErrorAware<'a> {
    /// The error of ending a ray on a node.
    pub error: NodeError<'a>,
    /// Above this error a ray makes way for 2×2 rays one level down. Nothing has an error of 0, so that a negative threshold
    /// refines everything.
    pub threshold: f32,
    /// The ray goes on as one of the four instead of being discarded (§6.2). Its place is then that of a sixteenth of its
    /// square beside the middle, so that full refinement gives the reference's samples.
    pub keeps_ray: bool,
    /// Errors count by what they can change in the picture (§6.1).
    pub luminance: Option<LuminanceAware<'a>>,
}

/// The error becomes E · δ + weight · σ. δ is how far luminances differ around the pixel at one ray each, nothing counting
/// as black, so that silhouettes are never let go: rays that pass a node see what is around it. σ is the contrast
/// below the node.
#[derive(Clone, Copy, Debug)]
pub struct LuminanceAware<'a> {
    /// σ.
    pub contrast: &'a Contrast,
    /// How much σ counts beside E · δ.
    pub weight: f32,
}

/// A picture whose rays are refined where nodes hide too much: at most 1 + 4 + 16 rays a pixel, 16 if rays are kept.
#[must_use]
pub fn error_aware(octree: &Octree<'_>, view: &View, settings: &ErrorAware<'_>) -> Picture {
    let eye = Eye::new(octree, view);
    let around = settings.luminance.map(|_| {
        let places = if settings.keeps_ray { Place::Kept } else { Place::Middle };
        let first = Picture::of(view, |x, y| first_look(&eye, &places.of(&Square::pixel(x, y), 2)));
        surroundings(&first)
    });
    Picture::of(view, |x, y| {
        let differs = around.as_ref().map_or(1.0, |around| around[(y * view.size + x) as usize]);
        let mut refinement =
            Refinement { eye: &eye, settings, differs, cost: Cost::default(), finest: MISSED };
        let pixel = Square::pixel(x, y);
        let rgb = if settings.keeps_ray {
            refinement.sample_kept(&pixel, view.level)
        } else {
            refinement.sample(&pixel, view.level)
        };
        Pixel { rgb, finest: refinement.finest, cost: refinement.cost }
    })
}

/// A pixel at one ray.
fn first_look(eye: &Eye<'_>, place: &Square) -> Pixel {
    let mut cost = Cost::default();
    let node = eye.look(&eye.ray(place), eye.view.level, &mut cost);
    let rgb = node.map_or(Vec3::ZERO, |node| eye.rgb(node));
    Pixel { rgb, finest: node.map_or(MISSED, |_| eye.view.level as u8), cost }
}

/// Where in a square its ray goes through.
enum Place {
    Middle,
    Kept,
}

impl Place {
    /// The part of a square whose middle is the ray's place; `splits` tells how often the square may be quartered.
    fn of(&self, square: &Square, splits: u32) -> Square {
        match self {
            Self::Middle => *square,
            Self::Kept => (0..splits).fold(*square, |part, n| part.quarters()[own_quarter(splits - n)]),
        }
    }
}

/// The quarter that keeps the ray of a square which may be quartered so often: of a pixel the first, and of a quarter the
/// one that lies at the pixel's middle if it is the first.
fn own_quarter(splits: u32) -> usize {
    if splits == 2 { 0 } else { 3 }
}

/// A pixel under way.
struct Refinement<'a> {
    eye: &'a Eye<'a>,
    settings: &'a ErrorAware<'a>,
    differs: f32,
    cost: Cost,
    finest: u8,
}

impl Refinement<'_> {
    /// The light of a square, its ray discarded if the node is refined.
    fn sample(&mut self, square: &Square, level: u32) -> Vec3 {
        let ray = self.eye.ray(square);
        let node = self.eye.look(&ray, level, &mut self.cost);
        if level > self.eye.view.finest() && self.is_refined(node, ray.direction) {
            return average(square, |quarter| self.sample(quarter, level - 1));
        }
        self.keep(node, level)
    }

    /// The light of a square, its ray going on in one of the quarters if a node is refined.
    fn sample_kept(&mut self, square: &Square, level: u32) -> Vec3 {
        let finest = self.eye.view.finest();
        let ray = self.eye.ray(&Place::Kept.of(square, level - finest));
        let at_level = Cell::new(level);
        let is_end = |entered: &Entered<'_>| {
            while entered.depth + at_level.get() == self.eye.octree.levels {
                if at_level.get() == finest || !self.is_refined(Some(entered.index), ray.direction) {
                    return true;
                }
                at_level.set(at_level.get() - 1);
            }
            false
        };
        let seen = self.eye.octree.first_where(&ray, is_end);
        // What meets nothing is refined by a negative threshold alone.
        let ended =
            if seen.node.is_none() && self.is_refined(None, ray.direction) { finest } else { at_level.get() };
        if seen.node.is_some() {
            self.cost += Cost { rays: 1, steps: u64::from(seen.steps) };
        }
        let own = self.keep(seen.node, ended);
        self.with_siblings(square, level, ended, own)
    }

    /// The average over a square of which one ray is known, which ended on a lower level.
    fn with_siblings(&mut self, square: &Square, level: u32, ended: u32, own: Vec3) -> Vec3 {
        if level == ended {
            return own;
        }
        let mut quarter_number = 0;
        average(square, |quarter| {
            let is_own = quarter_number == own_quarter(level - self.eye.view.finest());
            quarter_number += 1;
            if is_own {
                self.with_siblings(quarter, level - 1, ended, own)
            } else {
                self.sample_kept(quarter, level - 1)
            }
        })
    }

    /// Takes a ray's end as a sample.
    fn keep(&mut self, node: Option<u32>, level: u32) -> Vec3 {
        node.map_or(Vec3::ZERO, |node| {
            self.finest = self.finest.min(level as u8);
            self.eye.rgb(node)
        })
    }

    fn is_refined(&self, node: Option<u32>, direction: Vec3) -> bool {
        let error = node.map_or(0.0, |node| {
            let error = self.settings.error.of(self.eye.octree, node, direction);
            match &self.settings.luminance {
                None => error,
                Some(luminance) => error * self.differs + luminance.weight * luminance.contrast.below(node),
            }
        });
        error > self.settings.threshold
    }
}
