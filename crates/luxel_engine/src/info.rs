//! What a scene holds, costs, and calls for.
use luxel_bake::BakeReport;
use luxel_flat::{FEATURES, FeatureSet};
use luxel_scene::SceneEntry;
use serde::Serialize;

use crate::{Engine, EngineError, SphereAccelFacts};

/// A feature as `luxel info` shows it.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct FeatureFacts {
    /// Name.
    pub name: &'static str,
    /// Whether the scene calls for it.
    pub used: bool,
    /// Why, as the end of a sentence that begins with "because".
    pub because: &'static str,
}

/// The answer of `luxel info`.
#[derive(Clone, Debug, Serialize)]
pub struct SceneInfo {
    /// The file.
    pub scene: String,
    /// Hash of the scene's content.
    pub scene_hash: String,
    /// Counts, structures, memory, and what is drawn otherwise than asked.
    pub baked: BakeReport,
    /// The structure over the spheres, and why.
    pub sphere_accel: SphereAccelFacts,
    /// Every feature.
    pub features: Vec<FeatureFacts>,
    /// Names of the cameras, in the order of their numbers; empty for one without a name.
    pub cameras: Vec<String>,
    /// Every scene of a glTF model, in the order of their numbers; empty for other files.
    pub scenes: Vec<SceneEntry>,
    /// What of a model is shown, one line each.
    pub used: Vec<String>,
    /// What a model has and the scene does not show, one line each.
    pub ignored: Vec<String>,
    /// What import left out because it is damaged, one line each.
    pub dropped: Vec<String>,
    /// What import and the structure over the spheres warn about, one line each.
    pub warnings: Vec<String>,
    /// Seconds that loading took.
    pub load_secs: f64,
    /// Seconds that baking took.
    pub bake_secs: f64,
}

/// Every feature with the reason for its presence or absence.
pub fn features(used: FeatureSet) -> Vec<FeatureFacts> {
    let facts = FEATURES.iter().map(|row| {
        let used = used.has(row.feature);
        FeatureFacts { name: row.name, used, because: if used { row.used } else { row.unused } }
    });
    facts.collect()
}

impl Engine {
    /// Bakes the scene and describes it.
    ///
    /// # Errors
    /// When the scene cannot be baked.
    pub fn info(&mut self) -> Result<SceneInfo, EngineError> {
        let scene = self.bake()?;
        let baked = self.bake_report();
        let sphere_accel = self.sphere_accel_facts(&baked.sphere_cloud);
        let warnings = self.load_report().warnings.iter().cloned().chain(sphere_accel.notices());
        Ok(SceneInfo {
            scene: self.path().display().to_string(),
            scene_hash: self.scene_hash()?,
            warnings: warnings.collect(),
            baked,
            sphere_accel,
            features: features(scene.features),
            cameras: self.cameras().into_iter().map(|(_, name)| name).collect(),
            scenes: self.load_report().scenes.clone(),
            used: self.load_report().used.clone(),
            ignored: self.load_report().ignored.clone(),
            dropped: self.load_report().dropped.clone(),
            load_secs: self.load_secs(),
            bake_secs: self.bake_secs(),
        })
    }

    /// Hash of the scene with its settings: equal for scenes that look equal and carry equal ids.
    ///
    /// # Errors
    /// When the scene cannot be written out.
    pub fn scene_hash(&self) -> Result<String, EngineError> {
        Ok(format!("{:016x}", luxel_scene::world_hash(&self.world)?))
    }
}
