//! From the text of a scene file to a world.

use std::path::Path;

use bevy_ecs::prelude::World;
use ron::Options;
use ron::error::SpannedError;
use ron::extensions::Extensions;
use serde::Deserialize;
use serde::de::DeserializeOwned;

use crate::error::SceneError;
use crate::import::{ImageBudget, Models, read_file};
use crate::report::LoadReport;

use super::assets::load_assets;
use super::check::{Flaw, check_entity, check_sections};
use super::graph::{assign_ids, check_references};
use super::record::{SceneFile, VERSION};
use super::world::fill;

/// The longest scene file that is read: 1 GiB.
const MAX_SCENE_BYTES: u64 = 1 << 30;

/// What some editors begin a UTF-8 file with.
const BYTE_ORDER_MARK: &[u8] = "\u{FEFF}".as_bytes();

/// Reads the scene file at `path`, with so much left for its images, into `world`, which is untouched unless all went
/// well.
pub(crate) fn load_scene(
    path: &Path,
    world: &mut World,
    budget: ImageBudget,
) -> Result<LoadReport, SceneError> {
    let bytes = read_file(path, MAX_SCENE_BYTES)?;
    let mut file = parse(path, bytes.strip_prefix(BYTE_ORDER_MARK).unwrap_or(&bytes))?;
    let next_id = check(&mut file).map_err(|(place, flaw)| invalid(path, place, flaw))?;
    let (assets, report) = load_assets(path, &file, Models::with_budget(budget))?;
    fill(world, &file, next_id, assets);
    Ok(report)
}

/// RON options: `Some(…)` is not written.
pub(super) fn options() -> Options {
    Options::default().with_default_extension(Extensions::IMPLICIT_SOME)
}

pub(super) fn invalid(path: &Path, place: String, flaw: Flaw) -> SceneError {
    SceneError::Invalid { path: path.to_owned(), place, field: flaw.field, message: flaw.message }
}

/// Gives ids and checks everything; returns the next free id.
pub(super) fn check(file: &mut SceneFile) -> Result<u32, (String, Flaw)> {
    check_sections(file)?;
    let next_id = assign_ids(file)?;
    for entity in &file.entities {
        check_entity(entity).map_err(|flaw| (entity.place(), flaw))?;
    }
    check_references(file)?;
    Ok(next_id)
}

/// The one field that every version has.
#[derive(Deserialize)]
struct Versioned {
    version: u32,
}

/// The place where a file of an older version will be turned into one of this version.
fn parse(path: &Path, bytes: &[u8]) -> Result<SceneFile, SceneError> {
    let Versioned { version } = from_ron(path, bytes)?;
    match version {
        VERSION => from_ron(path, bytes),
        found => Err(SceneError::Version { path: path.to_owned(), found, known: VERSION }),
    }
}

fn from_ron<T: DeserializeOwned>(path: &Path, bytes: &[u8]) -> Result<T, SceneError> {
    options().from_bytes(bytes).map_err(|SpannedError { code, span }| SceneError::Syntax {
        path: path.to_owned(),
        line: span.start.line,
        column: span.start.col,
        message: match code {
            ron::Error::IntegerOutOfBounds => "the number is out of the range of this field".to_owned(),
            ron::Error::ExceededRecursionLimit => "values are nested too deeply".to_owned(),
            other => other.to_string(),
        },
    })
}
