//! `luxel study`: measurements on this machine, and the page of what came out.
use std::ops::ControlFlow;
use std::path::Path;

use luxel_engine::{BackendChoice, ExitCode};
use luxel_study::bvh::{self, BunnyModel};
use luxel_study::octree;
use luxel_study::voxel::{self, Directions, ErrorMethod};
use luxel_study::{Origin, Studied, StudyError, StudyEvent, StudyObserver};

use crate::args::{BvhArgs, OctreeArgs, Study, StudyArgs, StudyBackends, StudyOptions, VoxelArgs};
use crate::error::{CliError, one_line};
use crate::interrupt::Interrupt;
use crate::progress::ProgressLine;
use crate::reply;

/// The commit that this program was built from, with a mark if there were changes; the build script finds it.
const COMMIT: Option<&str> = option_env!("LUXEL_COMMIT");

/// Makes the study that the arguments name.
pub(crate) fn study(args: &StudyArgs) -> Result<ExitCode, CliError> {
    let line = match &args.study {
        Study::Octree(args) => octree(args)?,
        Study::Bvh(args) => bvh(args)?,
        Study::Voxel(args) => voxel(args)?,
    };
    reply::print_text(&line)?;
    Ok(ExitCode::Done)
}

fn octree(args: &OctreeArgs) -> Result<String, CliError> {
    let OctreeArgs { options, out } = args;
    if let Some(list) = &options.from {
        return Ok(last_line(&octree::redo(list, out)?));
    }
    let make = if options.quick { octree::Plan::quick } else { octree::Plan::full };
    let mut plan = make(backends(options));
    if let Some(secs) = options.seconds {
        plan = plan.with_secs_each(secs);
    }
    let studied = measure("octree study", |origin, observer| octree::run(&plan, origin, out, observer))?;
    Ok(last_line(&studied))
}

fn bvh(args: &BvhArgs) -> Result<String, CliError> {
    let BvhArgs { file, options, out } = args;
    if let Some(list) = &options.from {
        return Ok(last_line(&bvh::redo(list, out)?));
    }
    // Before anything else, so that a name mistyped is told at once: no folder is made, no device asked for.
    let model = file.as_deref().map_or(Ok(BunnyModel::Rabbit), BunnyModel::from_file)?;
    let make = if options.quick { bvh::Plan::quick } else { bvh::Plan::full };
    let mut plan = make(backends(options), &model);
    if let Some(secs) = options.seconds {
        plan = plan.with_secs_each(secs);
    }
    let studied = measure("BVH study", |origin, observer| bvh::run(&plan, origin, out, observer))?;
    Ok(last_line(&studied))
}

fn voxel(args: &VoxelArgs) -> Result<String, CliError> {
    if let (Some(method), Some(directions), Some(output)) = (args.error_table, &args.directions, &args.output)
    {
        return voxel_errors(method, directions, output);
    }
    if let Some(list) = &args.from {
        return Ok(last_line(&voxel::redo(list, &args.out)?));
    }
    let plan = if args.quick { voxel::Plan::quick() } else { voxel::Plan::full() };
    let studied = measure("voxel study", |origin, observer| voxel::run(&plan, origin, &args.out, observer))?;
    Ok(last_line(&studied))
}

fn voxel_errors(method: ErrorMethod, directions: &Path, output: &Path) -> Result<String, CliError> {
    let directions = Directions::read(directions)?;
    let rows =
        observed("error table", |observer| voxel::write_errors(&directions, method, output, observer))?;
    Ok(match rows {
        Some(rows) => format!("wrote {}: errors along {rows} directions", output.display()),
        None => "stopped; nothing was written".to_owned(),
    })
}

/// Runs a study under a line of progress, until it is over or interrupted.
fn measure<R>(
    name: &str,
    run: impl FnOnce(&Origin, &mut StudyObserver<'_>) -> Result<Studied<R>, StudyError>,
) -> Result<Studied<R>, CliError> {
    let origin = Origin::now(COMMIT.map(str::to_owned));
    let studied = observed(name, |observer| run(&origin, observer))?;
    if !studied.is_complete && !studied.files.is_empty() {
        reply::note("interrupted; what there is was written");
    }
    Ok(studied)
}

/// Runs something long under a line of progress, until it is over or interrupted.
fn observed<T>(
    name: &str,
    run: impl FnOnce(&mut StudyObserver<'_>) -> Result<T, StudyError>,
) -> Result<T, CliError> {
    let interrupt = Interrupt::listen()?;
    let progress = ProgressLine::new(Path::new(name));
    let mut observer = |event: &StudyEvent| {
        match event {
            StudyEvent::Progress(state) => progress.show_study(state),
            StudyEvent::Notice(notice) => progress.note(&one_line(notice)),
        }
        if interrupt.is_asked() { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    };
    Ok(run(&mut observer)?)
}

fn backends(options: &StudyOptions) -> &'static [BackendChoice] {
    match options.backend {
        StudyBackends::Cpu => &[BackendChoice::Cpu],
        StudyBackends::Gpu => &[BackendChoice::Gpu],
        StudyBackends::Both => &[BackendChoice::Cpu, BackendChoice::Gpu],
    }
}

fn last_line<R>(studied: &Studied<R>) -> String {
    if studied.files.is_empty() {
        return "stopped before the first run; nothing was written".to_owned();
    }
    let files = studied.files.iter().map(|path| path.display().to_string()).collect::<Vec<_>>().join(", ");
    format!("wrote {files}: {} runs", studied.runs.len())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_commit_is_that_of_the_build_and_needs_no_git_now() {
        let is_working_copy = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../.git").exists();
        let is_hex = |text: &str| text.len() >= 7 && text.bytes().all(|byte| byte.is_ascii_hexdigit());
        match COMMIT {
            Some(commit) => assert!(is_hex(commit.trim_end_matches("-dirty")), "{commit}"),
            None => assert!(!is_working_copy),
        }
    }
}
