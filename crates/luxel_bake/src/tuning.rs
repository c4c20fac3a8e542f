//! What the structure over the spheres is to be: the scene's wish, and what measurement makes of it.
use bevy_ecs::prelude::Resource;
use luxel_accel::SphereOptions;
use luxel_flat::SphereAccel;
use luxel_scene::SphereCloud;

/// What whoever measures traversal decides; a change of either number is the only trigger of a rebuild that the
/// scene did not ask for.
#[derive(Resource, Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct SphereTuning {
    /// The structure that a scene gets which leaves the choice open ([`luxel_scene::SphereAccel::Auto`]).
    pub auto: SphereAccel,
    /// Another number asks for a structure built anew from the same spheres.
    pub generation: u64,
}

impl SphereTuning {
    /// What is to be built for a scene's wish. Options that a structure does not heed are at their default, so that
    /// changing them rebuilds nothing.
    pub(crate) fn options(&self, wish: &SphereCloud) -> SphereOptions {
        let accel = match wish.accel {
            luxel_scene::SphereAccel::Auto => self.auto,
            luxel_scene::SphereAccel::Naive => SphereAccel::Naive,
            luxel_scene::SphereAccel::OctreeBase => SphereAccel::OctreeBase,
            luxel_scene::SphereAccel::OctreeSeed => SphereAccel::OctreeSeed,
            luxel_scene::SphereAccel::Octree => SphereAccel::Octree,
            luxel_scene::SphereAccel::Bvh => SphereAccel::Bvh,
        };
        match accel {
            SphereAccel::Naive | SphereAccel::Bvh => SphereOptions { accel, ..SphereOptions::default() },
            _ => SphereOptions { accel, max_depth: wish.max_depth, min_spheres: wish.min_spheres },
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_name_in_a_scene_file_is_the_structure_of_that_name() {
        let tuning = SphereTuning { auto: SphereAccel::Naive, generation: 0 };
        for (name, accel) in luxel_scene::SphereAccel::NAMES {
            let options = tuning.options(&SphereCloud { accel: *accel, ..SphereCloud::default() });
            let expected = if *name == "auto" { "naive" } else { name };
            assert_eq!(options.accel.name(), expected);
        }
    }

    #[test]
    fn only_octrees_heed_depth_and_leaf_size() {
        let wish = |accel| SphereCloud { accel, max_depth: 3, min_spheres: 1 };
        for (_, accel) in luxel_scene::SphereAccel::NAMES {
            let tuning = SphereTuning::default();
            let (fine, plain) = (wish(*accel), SphereCloud { accel: *accel, ..SphereCloud::default() });
            let name = tuning.options(&fine).accel.name();
            let heeds = tuning.options(&fine) != tuning.options(&plain);
            assert_eq!(heeds, name.starts_with("octree"), "{name}");
        }
    }
}
