//! Renders a scene file without a window, on the CPU or the GPU, and writes a PNG.
//!
//! `cargo run --release --example render_headless -- [SCENE] [--gpu] [--quick] [--out DIR]`
#![allow(clippy::print_stdout, clippy::print_stderr, reason = "an example talks to a terminal")]
use std::ops::ControlFlow;
use std::path::PathBuf;

use luxel_engine::output::{Picture, write_png};
use luxel_engine::{BackendChoice, Engine, RenderEvent, RenderJob};
use luxel_film::View;

fn main() -> anyhow::Result<()> {
    let options = Options::from_args();
    let mut engine = Engine::load(&options.scene)?;
    let job = RenderJob {
        size: Some(if options.quick { (64, 36) } else { (960, 540) }),
        spp: Some(if options.quick { 4 } else { 64 }),
        backend: if options.gpu { BackendChoice::Gpu } else { BackendChoice::Auto },
        ..RenderJob::default()
    };
    let rendered = engine.render(&job, &mut |event| {
        if let RenderEvent::Progress(p) = event {
            eprint!("\r{:3.0} %  {} samples", p.fraction * 100.0, p.samples);
        }
        ControlFlow::Continue(())
    })?;

    let picture = Picture::of(&rendered.film, engine.display(), View::PathTraced)
        .ok_or_else(|| anyhow::anyhow!("the film has no picture"))?;
    let path = options.out.join("render_headless.png");
    write_png(&path, &picture, &rendered.metadata(&engine))?;
    eprintln!("\r{} on {}: {}", path.display(), rendered.facts.device, rendered.because);
    Ok(())
}

/// What the command line says.
struct Options {
    scene: PathBuf,
    gpu: bool,
    quick: bool,
    out: PathBuf,
}

impl Options {
    fn from_args() -> Self {
        let mut options =
            Self { scene: "assets/showcase.ron".into(), gpu: false, quick: false, out: ".".into() };
        let mut args = std::env::args().skip(1);
        while let Some(arg) = args.next() {
            match arg.as_str() {
                "--gpu" => options.gpu = true,
                "--quick" => options.quick = true,
                "--out" => options.out = args.next().unwrap_or_default().into(),
                _ => options.scene = arg.into(),
            }
        }
        options
    }
}
