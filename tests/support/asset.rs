//! Shared by the tests that trace the scenes of `assets/`.
use std::path::Path;

use luxel_engine::Engine;
use luxel_scene::RenderSettings;

/// A scene of `assets/` at another size.
pub(crate) fn asset(name: &str, [width, height]: [u32; 2]) -> Engine {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("assets").join(name);
    let mut engine = Engine::load(&path).unwrap();
    let mut settings = engine.world.resource_mut::<RenderSettings>();
    (settings.width, settings.height) = (width, height);
    engine
}
