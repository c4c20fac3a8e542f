//! Shared by the tests that compare tracers: a scene of `assets/`, and a tracer run to a number of samples.
use std::path::Path;

use luxel_engine::Engine;
use luxel_film::Film;
use luxel_film::tracer::{TraceRequest, TraceStats, Tracer};
use luxel_scene::RenderSettings;

/// A film and what was done for it.
pub struct Traced {
    pub film: Film,
    pub stats: TraceStats,
}

/// Traces a request until every pixel has that many samples.
pub fn trace(tracer: &mut dyn Tracer, request: &TraceRequest, samples: u32) -> Traced {
    tracer.set_scene(request.clone()).unwrap();
    tracer.advance(f64::MAX, samples).unwrap();
    Traced { film: tracer.film().unwrap(), stats: tracer.stats() }
}

/// A scene of `assets/` at another size.
pub fn asset(name: &str, [width, height]: [u32; 2]) -> Engine {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("assets").join(name);
    let mut engine = Engine::load(&path).unwrap();
    let mut settings = engine.world.resource_mut::<RenderSettings>();
    (settings.width, settings.height) = (width, height);
    engine
}
