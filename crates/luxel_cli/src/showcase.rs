//! `luxel` alone: the showcase scene, rendered for about a minute.
use std::path::{Path, PathBuf};

use luxel_engine::{ExitCode, RenderJob};

use crate::error::CliError;
use crate::render;

/// The scene, below the folder that holds Luxel's assets.
const SCENE: &str = "assets/showcase.ron";
const OUTPUT: &str = "showcase.png";
/// Large enough to look good, small enough for two cores to get rid of most noise in time.
const SIZE: (u32, u32) = (960, 540);
/// The scene's own number is never reached on a small machine, and soon on a large one.
const SPP: u32 = 1024;
const SECONDS: f64 = 60.0;

/// Renders the showcase scene to a picture in the current folder.
pub(crate) fn showcase(source: &Path) -> Result<ExitCode, CliError> {
    let scene = find(source)?;
    let job = RenderJob { size: Some(SIZE), spp: Some(SPP), seconds: Some(SECONDS), ..RenderJob::default() };
    render::to_picture(&scene, job, Path::new(OUTPUT))
}

/// The scene file: below the current folder, above the program, or where the program was built.
fn find(source: &Path) -> Result<PathBuf, CliError> {
    let program = std::env::current_exe().unwrap_or_default();
    let above = program.ancestors().skip(1).filter(|folder| !folder.as_os_str().is_empty());
    let folders = [Path::new("")].into_iter().chain(above.take(3)).chain([source]);
    let candidates: Vec<PathBuf> = folders.map(|folder| folder.join(SCENE)).collect();
    match candidates.iter().find(|path| path.is_file()) {
        Some(found) => Ok(found.clone()),
        None => Err(CliError::NoShowcase(candidates)),
    }
}
