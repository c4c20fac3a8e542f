//! A render as data: what differs from the scene's own settings, and when to stop.
use bevy_ecs::prelude::*;
use luxel_film::{StopRule, ToneMap};
use luxel_flat::FeatureSet;
use luxel_scene::{
    LightSampling, MeshAccel, MeshLevels, MeshQuality, RenderSettings, SphereAccel, ToneMapping,
};

use crate::{BackendChoice, Engine, EngineError, Quality};

/// Largest width or height of a picture.
pub const MAX_SIZE: u32 = 16_384;

/// Largest depth of a path.
pub const MAX_DEPTH: u32 = 65_535;

/// What is to be rendered. `None` leaves a setting to the scene.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct RenderJob {
    /// Width and height in pixels.
    pub size: Option<(u32, u32)>,
    /// Samples and depth together; `spp` and `max_depth` win over it.
    pub quality: Option<Quality>,
    /// Samples per pixel.
    pub spp: Option<u32>,
    /// Seconds of tracing.
    pub seconds: Option<f64>,
    /// Relative error of the picture, 0.02 for 2 %.
    pub error: Option<f64>,
    /// Seed of the random numbers.
    pub seed: Option<u32>,
    /// How often light may scatter after the first hit.
    pub max_depth: Option<u32>,
    /// Which techniques find lights.
    pub light_sampling: Option<LightSampling>,
    /// Structure over the spheres.
    pub sphere_accel: Option<SphereAccel>,
    /// How meshes are searched.
    pub mesh_accel: Option<MeshAccel>,
    /// How much work goes into the trees of meshes.
    pub mesh_quality: Option<MeshQuality>,
    /// Whether each mesh has its tree, or all have one.
    pub mesh_levels: Option<MeshLevels>,
    /// Name of the camera.
    pub camera: Option<String>,
    /// Curve from radiance to display.
    pub tone_map: Option<ToneMap>,
    /// Exposure in stops.
    pub exposure: Option<f32>,
    /// First-hit outputs are wanted.
    pub aovs: bool,
    /// Features to trace with beyond those that the scene calls for.
    pub extra_features: FeatureSet,
    /// Where to trace.
    pub backend: BackendChoice,
}

impl RenderJob {
    /// Writes the job's settings into the engine's world.
    ///
    /// # Errors
    /// [`EngineError::Setting`] for one out of range, [`EngineError::NoSuchCamera`].
    pub(crate) fn apply(&self, engine: &mut Engine) -> Result<(), EngineError> {
        self.check()?;
        if let Some(name) = &self.camera {
            engine.use_camera(name)?;
        }
        if let Some(accel) = self.sphere_accel {
            engine.use_sphere_accel(accel);
        }
        engine.use_mesh_structure(self.mesh_accel, self.mesh_quality, self.mesh_levels);
        let mut settings = engine.settings();
        (settings.width, settings.height) = self.size.unwrap_or((settings.width, settings.height));
        settings.spp = self.samples().unwrap_or(settings.spp);
        settings.seed = self.seed.unwrap_or(settings.seed);
        let depth = self.max_depth.or(self.quality.map(|quality| quality.row().max_depth));
        settings.max_depth = depth.unwrap_or(settings.max_depth);
        settings.light_sampling = self.light_sampling.unwrap_or(settings.light_sampling);
        settings.tone_map = self.tone_map.map_or(settings.tone_map, tone_mapping);
        settings.exposure = self.exposure.unwrap_or(settings.exposure);
        engine.world.resource_mut::<RenderSettings>().set_if_neq(settings);
        Ok(())
    }

    /// Samples per pixel, given as such or by a preset.
    fn samples(&self) -> Option<u32> {
        self.spp.or(self.quality.map(|quality| quality.row().spp))
    }

    fn check(&self) -> Result<(), EngineError> {
        let refuse = |message: String| Err(EngineError::Setting(message));
        if let Some((width, height)) = self.size
            && !((1..=MAX_SIZE).contains(&width) && (1..=MAX_SIZE).contains(&height))
        {
            return refuse(format!("size {width}x{height}: each side must be 1 to {MAX_SIZE} pixels"));
        }
        if self.spp == Some(0) {
            return refuse("samples per pixel must be at least 1".to_owned());
        }
        if self.max_depth.is_some_and(|depth| depth > MAX_DEPTH) {
            return refuse(format!("the depth must be 0 to {MAX_DEPTH} scatterings"));
        }
        if self.seconds.is_some_and(|s| !(s > 0.0 && s.is_finite())) {
            return refuse("the time limit must be a positive number of seconds".to_owned());
        }
        if self.error.is_some_and(|e| !(e > 0.0 && e.is_finite())) {
            return refuse("the error limit must be a positive percentage".to_owned());
        }
        if self.exposure.is_some_and(|stops| !stops.is_finite()) {
            return refuse("the exposure must be a number of stops".to_owned());
        }
        Ok(())
    }

    /// When to stop: the limits given, or the scene's samples if none is.
    pub(crate) fn stop_rules(&self, settings: &RenderSettings) -> Vec<StopRule> {
        let mut rules = Vec::new();
        rules.extend(self.samples().map(StopRule::Samples));
        rules.extend(self.seconds.map(StopRule::Seconds));
        rules.extend(self.error.map(StopRule::Error));
        if rules.is_empty() {
            rules.push(StopRule::Samples(settings.spp));
        }
        rules
    }
}

/// The name that a scene has for a curve.
fn tone_mapping(tone_map: ToneMap) -> ToneMapping {
    match tone_map {
        ToneMap::None => ToneMapping::None,
        ToneMap::Reinhard => ToneMapping::Reinhard,
        ToneMap::Aces => ToneMapping::Aces,
        ToneMap::AgX => ToneMapping::AgX,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_preset_is_a_number_of_samples_and_what_is_given_wins() {
        let scene = RenderSettings::default();
        let low = RenderJob { quality: Some(Quality::Low), ..RenderJob::default() };
        assert_eq!(low.stop_rules(&scene), [StopRule::Samples(4)]);
        let both = RenderJob { spp: Some(7), ..low.clone() };
        assert_eq!(both.stop_rules(&scene), [StopRule::Samples(7)]);
        let timed = RenderJob { seconds: Some(2.0), ..low };
        assert_eq!(timed.stop_rules(&scene), [StopRule::Samples(4), StopRule::Seconds(2.0)]);
    }
}
