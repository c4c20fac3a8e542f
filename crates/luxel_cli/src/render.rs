//! `luxel render`: a scene or model to a picture, with its first-hit outputs.
use std::ops::ControlFlow;
use std::path::{Path, PathBuf};
use std::time::Instant;

use luxel_engine::output::Precision;
use luxel_engine::{
    AovKind, Engine, ExitCode, LoadOptions, RenderEvent, RenderJob, RenderSummary, Rendered, Stopped, View,
};
use serde::Serialize;

use crate::args::RenderArgs;
use crate::error::{CliError, one_line};
use crate::ignored::{ignored, without_spheres};
use crate::interrupt::Interrupt;
use crate::progress::ProgressLine;
use crate::reply;
use crate::targets::Targets;

/// What a render prints with `--json`.
#[derive(Serialize)]
struct Answer {
    #[serde(flatten)]
    summary: RenderSummary,
    /// Files that were written.
    outputs: Vec<String>,
}

/// Renders as the arguments say.
pub(crate) fn render(args: &RenderArgs) -> Result<ExitCode, CliError> {
    let targets = Targets {
        output: args.output.clone().unwrap_or_else(|| default_output(&args.scene.file)),
        aovs: each_once(&args.aov),
        view: args.view,
        precision: args.exr_precision.unwrap_or_default(),
    };
    if args.output.is_some() {
        targets.check()?;
    }
    let options = args.scene.options(args.size);
    run(&args.scene.file, &options, job(args), &targets, &ignored(args, &targets.output), args.json)
}

/// Renders a job to one PNG and says so.
pub(crate) fn to_picture(scene: &Path, job: RenderJob, output: &Path) -> Result<ExitCode, CliError> {
    let output = output.to_owned();
    let targets = Targets { output, aovs: Vec::new(), view: View::PathTraced, precision: Precision::Half };
    run(scene, &LoadOptions { size: job.size, ..LoadOptions::default() }, job, &targets, &[], false)
}

fn job(args: &RenderArgs) -> RenderJob {
    RenderJob {
        size: args.size,
        quality: args.quality,
        spp: args.spp,
        seconds: args.time,
        error: args.error,
        seed: args.seed,
        light_sampling: args.light_sampling,
        max_depth: args.max_depth,
        sphere_accel: args.scene.sphere_accel,
        mesh_accel: args.scene.mesh_accel,
        mesh_quality: args.scene.mesh_quality,
        mesh_levels: args.scene.mesh_levels,
        camera: args.camera.clone(),
        tone_map: args.tone_map,
        exposure: args.exposure,
        aovs: args.view.needs_first_hits() || args.aov.iter().any(|kind| kind.needs_first_hits()),
        backend: args.backend,
        ..RenderJob::default()
    }
}

/// The list without repetitions, in its order.
fn each_once(kinds: &[AovKind]) -> Vec<AovKind> {
    let is_first = |at: usize| !kinds[..at].contains(&kinds[at]);
    (0..kinds.len()).filter(|at| is_first(*at)).map(|at| kinds[at]).collect()
}

/// The scene's name with `.png`, in the current folder.
fn default_output(scene: &Path) -> PathBuf {
    let mut name = scene.file_stem().unwrap_or_default().to_owned();
    name.push(".png");
    name.into()
}

/// Renders, writes and answers; `notes` are told once the scene is known to make sense.
fn run(
    scene: &Path,
    options: &LoadOptions,
    job: RenderJob,
    targets: &Targets,
    notes: &[String],
    json: bool,
) -> Result<ExitCode, CliError> {
    let interrupt = Interrupt::listen()?;
    let progress = ProgressLine::new(scene);
    progress.stage("loading");
    let mut engine = Engine::load_with(scene, options)?;
    // After loading, because the output may be named after a scene that does not exist.
    targets.check()?;
    notes.iter().for_each(|note| progress.note(&one_line(note)));
    progress.stage("building");
    let rendered = engine.render(&job, &mut |event| watch(event, &progress, &interrupt))?;
    progress.stage("writing");
    let start = Instant::now();
    let outputs = targets.write(&rendered, &engine)?;
    let write_secs = start.elapsed().as_secs_f64();
    let mut summary = rendered.summary(&engine);
    summary.seconds.write = write_secs;
    tell_notices(&rendered, &summary, &progress);
    without_spheres(job.sphere_accel, &summary.sphere_accel).iter().for_each(|note| progress.note(note));
    drop(progress);
    if json {
        let outputs = outputs.iter().map(|path| path.display().to_string()).collect();
        reply::print_json(&Answer { summary, outputs })?;
    } else {
        reply::print_text(&last_line(&summary, rendered.error.is_trusted(), &outputs))?;
    }
    Ok(ExitCode::Done)
}

fn watch(event: &RenderEvent, progress: &ProgressLine, interrupt: &Interrupt) -> ControlFlow<()> {
    match event {
        RenderEvent::Progress(state) => progress.show(state),
        RenderEvent::Notice(notice) => progress.note(&one_line(notice)),
    }
    if interrupt.is_asked() { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
}

/// Prints what the user should know and has not been told while the render ran.
fn tell_notices(rendered: &Rendered, summary: &RenderSummary, progress: &ProgressLine) {
    for notice in summary.notices.iter().filter(|notice| !rendered.notices.contains(notice)) {
        progress.note(&one_line(notice));
    }
    if rendered.stopped == Stopped::Interrupted {
        let state =
            if rendered.samples == 0 { "some pixels have no sample yet" } else { "every pixel has samples" };
        progress.note(&format!("interrupted; what there is was written ({state})"));
    }
}

/// Where, what, how fast, how good, with what and why.
fn last_line(summary: &RenderSummary, is_trusted: bool, outputs: &[PathBuf]) -> String {
    let files = outputs.iter().map(|path| path.display().to_string()).collect::<Vec<_>>().join(", ");
    let doubt = if is_trusted { "" } else { ", too few samples to be sure" };
    let error = match summary.error {
        Some(error) => format!("error {:.1} % (estimated{doubt})", 100.0 * error),
        None => "error unknown from one sample".to_owned(),
    };
    format!(
        "wrote {files}: {}x{}, {} spp in {:.1} s, {} rays/s, {error}, {} ({}) because {}",
        summary.width,
        summary.height,
        summary.spp,
        summary.seconds.trace,
        reply::per_second(summary.rays_per_sec),
        summary.backend,
        summary.device,
        summary.because
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_output_that_is_named_twice_is_written_once() {
        use AovKind::{Albedo, Ids};
        assert_eq!(each_once(&[Ids, Albedo, Ids, Ids]), [Ids, Albedo]);
    }

    #[test]
    fn the_picture_is_named_after_the_scene() {
        assert_eq!(default_output(Path::new("scenes/a.b.ron")), Path::new("a.b.png"));
        assert_eq!(default_output(Path::new("bunny.obj")), Path::new("bunny.png"));
    }
}
