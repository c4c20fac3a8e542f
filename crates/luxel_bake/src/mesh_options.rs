//! What is to be built over meshes, and how it is searched, from the scene's wish.
use luxel_accel::{BvhOptions, BvhQuality, BvhSplit};
use luxel_flat::MeshAccel;
use luxel_scene::{MeshQuality, MeshSplit, MeshStructure};

/// How the tree of each mesh is built; the key of what was built. How it is searched is no part of it.
pub fn build_options(wish: &MeshStructure) -> BvhOptions {
    let quality = match wish.quality {
        MeshQuality::Fast => BvhQuality::Fast,
        MeshQuality::Medium => BvhQuality::Medium,
        MeshQuality::High => BvhQuality::High,
        MeshQuality::Best => BvhQuality::Best,
    };
    let options = quality.options();
    BvhOptions {
        split: match wish.split {
            MeshSplit::Sah => BvhSplit::Sah,
            MeshSplit::LargestAxis => BvhSplit::LargestAxis,
        },
        bins: wish.bins.unwrap_or(options.bins),
        max_leaf_size: wish.leaf_size,
        ..options
    }
}

/// How meshes are searched.
pub(crate) fn accel(wish: &MeshStructure) -> MeshAccel {
    match wish.accel {
        luxel_scene::MeshAccel::Naive => MeshAccel::Naive,
        luxel_scene::MeshAccel::BvhEscape => MeshAccel::Escape,
        luxel_scene::MeshAccel::Bvh => MeshAccel::Bvh,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_name_in_a_scene_file_is_the_way_or_the_preset_of_that_name() {
        for (name, way) in luxel_scene::MeshAccel::NAMES {
            assert_eq!(accel(&MeshStructure { accel: *way, ..MeshStructure::default() }).name(), *name);
        }
        for ((name, quality), preset) in MeshQuality::NAMES.iter().zip(BvhQuality::ALL) {
            assert_eq!(preset.name(), *name);
            let wish = MeshStructure { quality: *quality, ..MeshStructure::default() };
            assert_eq!(build_options(&wish), preset.options());
        }
    }

    #[test]
    fn bounds_of_the_scene_are_those_of_the_builder() {
        assert_eq!(luxel_scene::MAX_MESH_BINS, luxel_accel::MAX_BINS);
        assert_eq!(luxel_scene::MAX_MESH_LEAF_SIZE, luxel_flat::MAX_LEAF_SIZE);
    }
}
