//! Shared by the tests that compare tracers: one run to a number of samples.
use luxel_film::Film;
use luxel_film::tracer::{TraceRequest, TraceStats, Tracer};

/// A film and what was done for it.
pub(crate) struct Traced {
    pub(crate) film: Film,
    pub(crate) stats: TraceStats,
}

/// Traces a request until every pixel has that many samples.
pub(crate) fn trace(tracer: &mut dyn Tracer, request: &TraceRequest, samples: u32) -> Traced {
    tracer.set_scene(request.clone()).unwrap();
    tracer.advance(f64::MAX, samples).unwrap();
    Traced { film: tracer.film().unwrap(), stats: tracer.stats() }
}
