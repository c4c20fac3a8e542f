//! What is asked for over the meshes of a scene.
use bevy_ecs::prelude::*;
use luxel_scene::{MeshAccel, MeshQuality, MeshStructure};

use crate::Engine;

impl Engine {
    /// Asks for a way through meshes and for a quality of their trees, whatever the scene says; `None` leaves it to the
    /// scene.
    pub fn use_mesh_structure(&mut self, accel: Option<MeshAccel>, quality: Option<MeshQuality>) {
        let mut structure = self.world.resource_mut::<MeshStructure>();
        let wish = MeshStructure {
            accel: accel.unwrap_or(structure.accel),
            quality: quality.unwrap_or(structure.quality),
            ..*structure
        };
        structure.set_if_neq(wish);
    }
}
