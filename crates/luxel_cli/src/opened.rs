//! A scene that is looked at and not rendered.
use luxel_engine::{Engine, LoadOptions};

use crate::args::SceneArgs;
use crate::error::{CliError, one_line};
use crate::ignored::without_scenes;
use crate::reply;

impl SceneArgs {
    /// Loads the scene as it is in its file, and says which option has no effect.
    pub(crate) fn open(&self) -> Result<Engine, CliError> {
        let options = LoadOptions {
            scene: self.scene.clone(),
            environment: self.environment.clone(),
            ..LoadOptions::default()
        };
        let engine = Engine::load_with(&self.file, &options)?;
        without_scenes(self.scene.is_some(), &self.file).iter().for_each(|note| reply::note(&one_line(note)));
        Ok(engine)
    }

    /// Asks for the structures that the command line names.
    pub(crate) fn ask(&self, engine: &mut Engine) {
        self.sphere_accel.into_iter().for_each(|accel| engine.use_sphere_accel(accel));
        engine.use_mesh_structure(self.mesh_accel, self.mesh_quality, self.mesh_levels);
    }
}
