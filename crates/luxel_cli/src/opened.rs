//! A scene as the command line names it.
use luxel_engine::{Engine, LoadOptions};

use crate::args::SceneArgs;
use crate::error::{CliError, one_line};
use crate::ignored::without_scenes;
use crate::reply;

impl SceneArgs {
    /// Loads the scene as it is in its file, to be looked at and not rendered, and says which option has no effect.
    pub(crate) fn open(&self) -> Result<Engine, CliError> {
        let engine = Engine::load_with(&self.file, &self.options(None))?;
        without_scenes(self.scene.is_some(), &self.file).iter().for_each(|note| reply::note(&one_line(note)));
        Ok(engine)
    }

    /// How the file is loaded; a model without a camera is framed for a picture of `size`.
    pub(crate) fn options(&self, size: Option<(u32, u32)>) -> LoadOptions {
        LoadOptions { scene: self.scene.clone(), environment: self.environment.clone(), size }
    }

    /// Asks for the structures that the command line names.
    pub(crate) fn ask(&self, engine: &mut Engine) {
        self.sphere_accel.into_iter().for_each(|accel| engine.use_sphere_accel(accel));
        engine.use_mesh_structure(self.mesh_accel, self.mesh_quality, self.mesh_levels);
    }
}
