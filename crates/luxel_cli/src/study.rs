//! `luxel study`: measurements on this machine, and the page of what came out.
use std::ops::ControlFlow;
use std::path::Path;
use std::process::{Command, Stdio};

use luxel_engine::{BackendChoice, ExitCode};
use luxel_study::octree::{self, Origin, Plan, Studied, StudyEvent};

use crate::args::{OctreeArgs, Study, StudyArgs, StudyBackends};
use crate::error::{CliError, one_line};
use crate::interrupt::Interrupt;
use crate::progress::ProgressLine;
use crate::reply;

/// Makes the study that the arguments name; `source` is the folder that the program was built from.
pub(crate) fn study(args: &StudyArgs, source: &Path) -> Result<ExitCode, CliError> {
    match &args.study {
        Study::Octree(args) => octree(args, source),
    }
}

fn octree(args: &OctreeArgs, source: &Path) -> Result<ExitCode, CliError> {
    let studied = match &args.from {
        Some(list) => octree::redo(list, &args.out)?,
        None => measure(args, source)?,
    };
    reply::print_text(&last_line(&studied))?;
    Ok(ExitCode::Done)
}

fn measure(args: &OctreeArgs, source: &Path) -> Result<Studied, CliError> {
    let interrupt = Interrupt::listen()?;
    let progress = ProgressLine::new(Path::new("octree study"));
    let mut observer = |event: &StudyEvent| {
        match event {
            StudyEvent::Progress(state) => progress.show_study(state),
            StudyEvent::Notice(notice) => progress.note(&one_line(notice)),
        }
        if interrupt.is_asked() { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    };
    let studied = octree::run(&plan(args), &Origin::now(commit(source)), &args.out, &mut observer)?;
    if !studied.is_complete && !studied.files.is_empty() {
        progress.note("interrupted; what there is was written");
    }
    Ok(studied)
}

fn plan(args: &OctreeArgs) -> Plan {
    let backends: &[BackendChoice] = match args.backend {
        StudyBackends::Cpu => &[BackendChoice::Cpu],
        StudyBackends::Gpu => &[BackendChoice::Gpu],
        StudyBackends::Both => &[BackendChoice::Cpu, BackendChoice::Gpu],
    };
    let plan = if args.quick { Plan::quick(backends) } else { Plan::full(backends) };
    match args.seconds {
        Some(secs) => plan.with_secs_each(secs),
        None => plan,
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

fn last_line(studied: &Studied) -> String {
    if studied.files.is_empty() {
        return "stopped before the first run; nothing was written".to_owned();
    }
    let files = studied.files.iter().map(|path| path.display().to_string()).collect::<Vec<_>>().join(", ");
    format!("wrote {files}: {} runs", studied.runs.len())
}
