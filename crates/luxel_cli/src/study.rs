//! `luxel study`: measurements on this machine, and the page of what came out.
use std::ops::ControlFlow;
use std::path::Path;
use std::process::{Command, Stdio};

use luxel_engine::{BackendChoice, ExitCode};
use luxel_study::bvh::{self, BunnyModel};
use luxel_study::octree;
use luxel_study::{Origin, Studied, StudyError, StudyEvent, StudyObserver};

use crate::args::{BvhArgs, OctreeArgs, Study, StudyArgs, StudyBackends, StudyOptions};
use crate::error::{CliError, one_line};
use crate::interrupt::Interrupt;
use crate::progress::ProgressLine;
use crate::reply;

/// Makes the study that the arguments name; `source` is the folder that the program was built from.
pub(crate) fn study(args: &StudyArgs, source: &Path) -> Result<ExitCode, CliError> {
    let line = match &args.study {
        Study::Octree(args) => octree(args, source)?,
        Study::Bvh(args) => bvh(args, source)?,
    };
    reply::print_text(&line)?;
    Ok(ExitCode::Done)
}

fn octree(args: &OctreeArgs, source: &Path) -> Result<String, CliError> {
    let OctreeArgs { options, out } = args;
    if let Some(list) = &options.from {
        return Ok(last_line(&octree::redo(list, out)?));
    }
    let make = if options.quick { octree::Plan::quick } else { octree::Plan::full };
    let mut plan = make(backends(options));
    if let Some(secs) = options.seconds {
        plan = plan.with_secs_each(secs);
    }
    let studied =
        measure("octree study", source, |origin, observer| octree::run(&plan, origin, out, observer))?;
    Ok(last_line(&studied))
}

fn bvh(args: &BvhArgs, source: &Path) -> Result<String, CliError> {
    let BvhArgs { file, options, out } = args;
    if let Some(list) = &options.from {
        return Ok(last_line(&bvh::redo(list, out)?));
    }
    let model = file.clone().map_or(BunnyModel::Rabbit, BunnyModel::File);
    let make = if options.quick { bvh::Plan::quick } else { bvh::Plan::full };
    let mut plan = make(backends(options), &model);
    if let Some(secs) = options.seconds {
        plan = plan.with_secs_each(secs);
    }
    let studied = measure("BVH study", source, |origin, observer| bvh::run(&plan, origin, out, observer))?;
    Ok(last_line(&studied))
}

/// Runs a study under a line of progress, until it is over or interrupted.
fn measure<R>(
    name: &str,
    source: &Path,
    run: impl FnOnce(&Origin, &mut StudyObserver<'_>) -> Result<Studied<R>, StudyError>,
) -> Result<Studied<R>, CliError> {
    let interrupt = Interrupt::listen()?;
    let progress = ProgressLine::new(Path::new(name));
    let mut observer = |event: &StudyEvent| {
        match event {
            StudyEvent::Progress(state) => progress.show_study(state),
            StudyEvent::Notice(notice) => progress.note(&one_line(notice)),
        }
        if interrupt.is_asked() { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    };
    let studied = run(&Origin::now(commit(source)), &mut observer)?;
    if !studied.is_complete && !studied.files.is_empty() {
        progress.note("interrupted; what there is was written");
    }
    Ok(studied)
}

fn backends(options: &StudyOptions) -> &'static [BackendChoice] {
    match options.backend {
        StudyBackends::Cpu => &[BackendChoice::Cpu],
        StudyBackends::Gpu => &[BackendChoice::Gpu],
        StudyBackends::Both => &[BackendChoice::Cpu, BackendChoice::Gpu],
    }
}

/// The commit of a source folder, with a mark if it has changes; `None` if it is no working copy, or git is missing.
fn commit(source: &Path) -> Option<String> {
    let mut git = Command::new("git");
    git.arg("-C").arg(source).args(["describe", "--always", "--dirty", "--exclude=*"]);
    let output = git.stderr(Stdio::null()).output().ok()?;
    let name = String::from_utf8(output.stdout).ok()?.trim().to_owned();
    (output.status.success() && !name.is_empty()).then_some(name)
}

fn last_line<R>(studied: &Studied<R>) -> String {
    if studied.files.is_empty() {
        return "stopped before the first run; nothing was written".to_owned();
    }
    let files = studied.files.iter().map(|path| path.display().to_string()).collect::<Vec<_>>().join(", ");
    format!("wrote {files}: {} runs", studied.runs.len())
}
