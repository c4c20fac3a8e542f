//! Which answers about a ray's first hit are right, as far as single precision can tell (robustness.md, G03).
//!
//! Two tracers may disagree about a ray only where both are right: every primitive is looked at in f64, without any
//! structure, and an answer is plausible if the primitive is hit or missed by at most [`BORDER_ULPS`], and
//! everything that stands clearly in front of it is missed or hit within as many ulps of its border. "Clearly in
//! front" means by more than 2⁻¹⁸ of the parameter, and by more than the surface would have to move to stand
//! behind: the curve in which two surfaces cross is a border too.
//!
//! An ulp is 2⁻²³ of the coordinates involved, axis by axis in the instance's space: those of the primitive, of its
//! way from the ray's origin, and of the terms that the ray's transform sums up.
mod candidate;

use std::fmt::Write;

use luxel_flat::{Aov, FlatScene, Instance, KIND_MESH, KIND_SPHERES, KIND_VOXELS};
use luxel_geom::Ray;

use candidate::{Candidate, ObjectRay};

/// How far from a border, in ulps of the coordinates involved, a ray may be on either side of it.
pub const BORDER_ULPS: f64 = 16.0;

/// Share of the parameter by which two hits may differ and be equally near.
pub const SAME_DEPTH: f64 = 1.0 / (1u32 << 18) as f64;

/// The primitive that a tracer says is hit first.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Answer {
    /// Stable id of the instance.
    pub instance: u32,
    /// Stable id of the primitive.
    pub primitive: u32,
}

impl Answer {
    /// The answer of a film's first-hit record; `None` for the sky.
    pub fn of_aov(aov: &Aov) -> Option<Self> {
        (aov.instance > 0).then(|| Self { instance: aov.instance - 1, primitive: aov.primitive })
    }
}

/// Judges answers about the rays of a scene.
pub struct Judge<'a> {
    scene: &'a FlatScene,
    /// The solid cells of each instance slot; empty for what is not a volume.
    cells: Vec<Vec<[u32; 3]>>,
}

impl<'a> Judge<'a> {
    /// Lists what there is to look at.
    pub fn new(scene: &'a FlatScene) -> Self {
        let cells = scene.instances.as_slice().iter().map(|instance| solid_cells(scene, instance)).collect();
        Self { scene, cells }
    }

    /// True if both answers about one ray are plausible: then their difference is a tie.
    pub fn explains(&self, ray: &Ray<f64>, answers: [Option<Answer>; 2]) -> bool {
        let candidates = self.candidates(ray);
        answers.iter().all(|answer| is_plausible(&candidates, *answer))
    }

    /// True if an answer is right, or cannot be told from the right one.
    pub fn is_plausible(&self, ray: &Ray<f64>, answer: Option<Answer>) -> bool {
        is_plausible(&self.candidates(ray), answer)
    }

    /// What stands along a ray, nearest first: for the message of a test that fails.
    pub fn describe(&self, ray: &Ray<f64>) -> String {
        let mut candidates = self.candidates(ray);
        candidates.sort_by(|a, b| a.lo.total_cmp(&b.lo));
        let mut text = format!("{ray:?}");
        for Candidate { answer: Answer { instance, primitive }, lo, hi, is_sure } in
            &candidates[..candidates.len().min(6)]
        {
            let how = if *is_sure { "hit" } else { "border" };
            // Writing to a string cannot fail.
            let _ = write!(text, "\n  {instance}/{primitive}: {how}, t in {lo:e} ..= {hi:e}");
        }
        text
    }

    fn candidates(&self, ray: &Ray<f64>) -> Vec<Candidate> {
        let mut candidates = Vec::new();
        for (instance, cells) in self.scene.instances.as_slice().iter().zip(&self.cells) {
            let object_ray = ObjectRay::new(ray, instance);
            let answer = |primitive| Answer { instance: instance.stable_id, primitive };
            match instance.kind {
                _ if instance.node_count == 0 => {}
                KIND_SPHERES => {
                    let live = self.scene.spheres.as_slice().iter().filter(|sphere| sphere.radius > 0.0);
                    candidates.extend(live.filter_map(|s| object_ray.sphere(s, answer(s.stable_id))));
                }
                KIND_MESH => {
                    let first = instance.primitive_first as usize;
                    let triangles =
                        &self.scene.triangles.as_slice()[first..first + instance.primitive_count as usize];
                    candidates.extend(triangles.iter().filter_map(|t| object_ray.triangle(t, answer(t.id))));
                }
                _ => {
                    let id = |cell: &[u32; 3]| {
                        cell[0] | cell[1] << instance.levels | cell[2] << (2 * instance.levels)
                    };
                    candidates
                        .extend(cells.iter().filter_map(|cell| object_ray.voxel(*cell, answer(id(cell)))));
                }
            }
        }
        candidates
    }
}

fn is_plausible(candidates: &[Candidate], answer: Option<Answer>) -> bool {
    let is_free = |lo: f64| !candidates.iter().any(|other| other.is_sure && other.hi < lo);
    match answer {
        None => !candidates.iter().any(|candidate| candidate.is_sure),
        Some(answer) => {
            candidates.iter().any(|candidate| candidate.answer == answer && is_free(candidate.lo))
        }
    }
}

fn solid_cells(scene: &FlatScene, instance: &Instance) -> Vec<[u32; 3]> {
    let mut solid = Vec::new();
    if instance.kind != KIND_VOXELS || instance.node_count == 0 {
        return solid;
    }
    let mut open = vec![(instance.node_first, [0u32; 3])];
    while let Some((index, cell)) = open.pop() {
        let node = scene.svo_nodes.as_slice()[index as usize];
        let children = (0..8).filter(|child| node.child_mask >> child & 1 == 1);
        for (nth, child) in children.enumerate() {
            let half = |axis: usize| cell[axis] << 1 | child >> axis & 1;
            open.push((instance.node_first + node.first_child + nth as u32, [half(0), half(1), half(2)]));
        }
        if node.child_mask == 0 {
            solid.push(cell);
        }
    }
    solid
}

#[cfg(test)]
mod tests;
