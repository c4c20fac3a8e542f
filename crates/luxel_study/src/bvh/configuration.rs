//! What is varied between the runs of a group.
use luxel_engine::{MeshAccel, MeshLevels, MeshQuality, MeshStructure};
use luxel_scene::MeshSplit;

use super::select::{LARGEST_AXIS, SAH};
use super::staging::Staging;

/// How one picture of a scene is made.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Configuration {
    /// The structure over meshes.
    pub(crate) mesh: MeshStructure,
    /// What is changed in the world.
    pub(crate) staging: Staging,
    /// Name among the runs of the group, for figures.
    pub(crate) variant: &'static str,
    pub(crate) size: (u32, u32),
    /// Samples per pixel and frame.
    pub(crate) spp: u32,
    /// How often light may scatter after the first hit.
    pub(crate) bounces: u32,
    /// Samples per pixel of the picture that is kept; 0 for none.
    pub(crate) shown_spp: u32,
}

impl Configuration {
    /// The defaults of Luxel in a picture of that size.
    pub(crate) fn new(size: (u32, u32), spp: u32, bounces: u32) -> Self {
        Self {
            mesh: MeshStructure::default(),
            staging: Staging::default(),
            variant: "",
            size,
            spp,
            bounces,
            shown_spp: 0,
        }
    }

    pub(crate) fn with(self, accel: MeshAccel) -> Self {
        Self { mesh: MeshStructure { accel, ..self.mesh }, ..self }
    }

    pub(crate) fn quality(self, quality: MeshQuality) -> Self {
        Self { mesh: MeshStructure { quality, ..self.mesh }, ..self }
    }

    pub(crate) fn bins(self, bins: u32) -> Self {
        Self { mesh: MeshStructure { bins: Some(bins), ..self.mesh }, ..self }
    }

    pub(crate) fn leaf_size(self, leaf_size: u32) -> Self {
        Self { mesh: MeshStructure { leaf_size, ..self.mesh }, ..self }
    }

    pub(crate) fn split(self, split: MeshSplit) -> Self {
        Self { mesh: MeshStructure { split, ..self.mesh }, ..self }
    }

    pub(crate) fn levels(self, levels: MeshLevels) -> Self {
        Self { mesh: MeshStructure { levels, ..self.mesh }, ..self }
    }

    pub(crate) fn shown(self, spp: u32) -> Self {
        Self { shown_spp: spp, ..self }
    }

    pub(crate) fn variant(self, variant: &'static str) -> Self {
        Self { variant, ..self }
    }

    pub(crate) fn staged(self, staging: Staging) -> Self {
        Self { staging, ..self }
    }
}

/// The name that records have for a rule to cut nodes.
pub(crate) fn split_name(split: MeshSplit) -> &'static str {
    match split {
        MeshSplit::Sah => SAH,
        MeshSplit::LargestAxis => LARGEST_AXIS,
    }
}
