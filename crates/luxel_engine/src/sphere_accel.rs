//! What is told about the structure over a scene's spheres.
use bevy_ecs::prelude::*;
use luxel_bake::SphereFacts;
use luxel_scene::{SphereAccel, SphereCloud};
use serde::Serialize;

use crate::Engine;

/// The structure over the spheres of the last baked scene, and why it is that one.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct SphereAccelFacts {
    /// Which, by its name on the command line.
    pub name: &'static str,
    /// Why, as the end of a sentence that begins with "because".
    pub because: String,
    /// Nodes; 0 without spheres.
    pub nodes: u32,
    /// Deepest level; the root is level 0.
    pub depth: u32,
    /// Bytes of its heaps: spheres, nodes and leaves.
    pub bytes: u64,
    /// True if nodes stayed leaves that should have been divided.
    pub cut_off: bool,
}

impl SphereAccelFacts {
    /// What a user should know about it, one line each.
    pub fn notices(&self) -> Vec<String> {
        let seed = SphereAccel::OctreeSeed.name();
        let is_wrong = self.nodes > 0 && self.name == seed;
        let wrong = is_wrong.then(|| {
            format!("{seed} ends a ray at the first leaf with a hit: it is for comparison, and its pictures may be wrong")
        });
        let cut_off = self.cut_off.then(|| {
            format!(
                "the {} is cut off: divided as far as asked it would list its spheres too often; a smaller \
                 max_depth or a larger min_spheres lets it be whole",
                self.name
            )
        });
        wrong.into_iter().chain(cut_off).collect()
    }
}

impl Engine {
    /// Asks for a structure over the spheres, whatever the scene says.
    pub fn use_sphere_accel(&mut self, accel: SphereAccel) {
        let mut cloud = self.world.resource_mut::<SphereCloud>();
        let wish = SphereCloud { accel, ..*cloud };
        cloud.set_if_neq(wish);
    }

    /// The structure over the spheres of the last baked scene.
    pub fn sphere_accel(&self) -> SphereAccelFacts {
        self.sphere_accel_facts(&self.bake_report().sphere_cloud)
    }

    pub(crate) fn sphere_accel_facts(&self, built: &SphereFacts) -> SphereAccelFacts {
        let SphereFacts { name, nodes, depth, bytes, cut_off } = *built;
        let because = self.sphere_keeper().because().to_owned();
        SphereAccelFacts { name, because, nodes, depth, bytes, cut_off }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_may_be_wrong_is_told() {
        let facts = |name, cut_off| SphereAccelFacts {
            name,
            because: String::new(),
            nodes: 9,
            depth: 2,
            bytes: 0,
            cut_off,
        };
        for (name, _) in SphereAccel::NAMES {
            assert_eq!(facts(name, false).notices().len(), usize::from(*name == "octree-seed"), "{name}");
        }
        assert!(facts("octree-base", true).notices()[0].contains("octree-base is cut off"));
        let empty = SphereAccelFacts { nodes: 0, ..facts("octree-seed", false) };
        assert!(empty.notices().is_empty());
    }
}
