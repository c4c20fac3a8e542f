//! What is asked for over the meshes of a scene.
use bevy_ecs::prelude::*;
use luxel_scene::{MeshAccel, MeshLevels, MeshQuality, MeshStructure};

use crate::Engine;

impl Engine {
    /// Asks for a way through meshes, for a quality of their trees and for a tree over each or one over all, whatever the
    /// scene says; `None` leaves it to the scene.
    pub fn use_mesh_structure(
        &mut self,
        accel: Option<MeshAccel>,
        quality: Option<MeshQuality>,
        levels: Option<MeshLevels>,
    ) {
        let mut structure = self.world.resource_mut::<MeshStructure>();
        let wish = MeshStructure {
            accel: accel.unwrap_or(structure.accel),
            quality: quality.unwrap_or(structure.quality),
            levels: levels.unwrap_or(structure.levels),
            ..*structure
        };
        structure.set_if_neq(wish);
    }
}
