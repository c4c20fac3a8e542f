//! Which answers about a ray's first hit are right, as far as single precision can tell (robustness.md, G03).
//!
//! Two tracers may disagree about a ray only where both are right. Every primitive is looked at in f64, without any
//! structure. An answer is plausible if its primitive is hit, or missed by at most [`BORDER_ULPS`], and if the way
//! there is free: what stands clearly in front is hit within as many ulps of its border, and a small shift of the
//! ray gets past all of its instance that does. So a ray through the silhouette of a mesh may tell what is behind,
//! and one through an edge that two triangles share may not.
//!
//! "Clearly in front" means by more than 2⁻¹⁸ of the parameter, and by more than the surface would have to move to
//! stand behind: the curve in which two surfaces cross is a border too. An ulp is 2⁻²³ of the coordinates involved,
//! axis by axis in the instance's space: those of the primitive, of its way from the ray's origin, and of the terms
//! that the ray's transform sums up.
mod candidate;
mod sight;

use luxel_flat::{Aov, FlatScene, Instance, KIND_MESH, KIND_SPHERES, KIND_VOXELS};
use luxel_geom::Ray;

use candidate::Primitive;
use sight::Sight;

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
    /// The primitives of each instance slot.
    primitives: Vec<Vec<(Answer, Primitive)>>,
}

impl<'a> Judge<'a> {
    /// Lists what there is to look at.
    pub fn new(scene: &'a FlatScene) -> Self {
        let primitives =
            scene.instances.as_slice().iter().map(|instance| primitives(scene, instance)).collect();
        Self { scene, primitives }
    }

    /// True if both answers about one ray are plausible: then their difference is a tie.
    pub fn explains(&self, ray: &Ray<f64>, answers: [Option<Answer>; 2]) -> bool {
        let sight = self.sight(ray);
        answers.iter().all(|answer| sight.is_plausible(*answer))
    }

    /// True if an answer is right, or cannot be told from the right one.
    pub fn is_plausible(&self, ray: &Ray<f64>, answer: Option<Answer>) -> bool {
        self.sight(ray).is_plausible(answer)
    }

    /// What stands along a ray, nearest first: for the message of a test that fails.
    pub fn describe(&self, ray: &Ray<f64>) -> String {
        format!("{ray:?}{}", self.sight(ray))
    }

    fn sight(&self, ray: &Ray<f64>) -> Sight {
        Sight::new(ray, self.scene.instances.as_slice().iter().zip(&self.primitives))
    }
}

fn primitives(scene: &FlatScene, instance: &Instance) -> Vec<(Answer, Primitive)> {
    let named = |primitive| Answer { instance: instance.stable_id, primitive };
    match instance.kind {
        _ if instance.node_count == 0 => Vec::new(),
        KIND_SPHERES => {
            let live = scene.spheres.as_slice().iter().filter(|sphere| sphere.radius > 0.0);
            live.map(|sphere| (named(sphere.stable_id), Primitive::sphere(sphere))).collect()
        }
        KIND_MESH => {
            let first = instance.primitive_first as usize;
            let triangles = &scene.triangles.as_slice()[first..first + instance.primitive_count as usize];
            triangles.iter().map(|triangle| (named(triangle.id), Primitive::triangle(triangle))).collect()
        }
        _ => {
            let id = |[x, y, z]: [u32; 3]| x | y << instance.levels | z << (2 * instance.levels);
            let cells = solid_cells(scene, instance).into_iter();
            cells.map(|cell| (named(id(cell)), Primitive::Voxel(cell))).collect()
        }
    }
}

fn solid_cells(scene: &FlatScene, instance: &Instance) -> Vec<[u32; 3]> {
    debug_assert_eq!(instance.kind, KIND_VOXELS);
    let mut solid = Vec::new();
    let mut open = vec![(0, [0u32; 3])];
    while let Some((index, cell)) = open.pop() {
        let node = scene.svo_nodes.as_slice()[(instance.node_first + index) as usize];
        if node.child_mask() == 0 {
            solid.push(cell);
        }
        for (nth, child) in (0..8).filter(|child| node.child_mask() >> child & 1 == 1).enumerate() {
            let half = |axis: usize| cell[axis] << 1 | child >> axis & 1;
            open.push((node.first_child + nth as u32, [half(0), half(1), half(2)]));
        }
    }
    solid
}

#[cfg(test)]
mod tests;
