//! Errors of voxel nodes for directions of a file, as a table: what the error-aware renderer goes by, to be checked.
use std::path::Path;
use std::time::Instant;

use csv::{ReaderBuilder, StringRecord, Trim, Writer};
use glam::DVec3;
use luxel_accel::lod_error::{Errors, OctantShares, Sh9};
use luxel_engine::output;

use crate::{StudyError, StudyEvent, StudyObserver, StudyProgress};

/// Edge of the picture that is cast along each direction, as in seed document 3 (§3.2).
const RESOLUTION: u32 = 512;
/// Where cast rays are jittered from.
const SEED: u32 = 1;
/// The observer is told after as many rows.
const ROWS_AT_A_TIME: usize = 16;

/// How errors are found.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ErrorMethod {
    /// By casting 512² rays along each direction (seed document 3, §3.1.2).
    RayCast,
    /// From nine coefficients of spherical harmonics for each mask, fitted to cast errors of 256 directions (§3.2).
    Sh9,
    /// By exact areas.
    Exact,
}

/// The directions of a file.
#[derive(Clone, Debug, PartialEq)]
pub struct Directions {
    /// True if names stood above them.
    has_head: bool,
    rows: Vec<DVec3>,
}

impl Directions {
    /// Reads rows of x, y, z, with or without a head.
    ///
    /// # Errors
    /// [`StudyError::Io`] if there is no such file, [`StudyError::Record`] with the first row that is no direction,
    /// [`StudyError::Format`] if there is none at all.
    pub fn read(path: &Path) -> Result<Self, StudyError> {
        let io = |source| StudyError::Io { path: path.to_owned(), source };
        let text = std::fs::read(path).map_err(io)?;
        let mut reader = ReaderBuilder::new();
        let reader = reader.has_headers(false).flexible(true).trim(Trim::All);
        let mut directions = Self { has_head: false, rows: Vec::new() };
        let mut is_first = true;
        for record in reader.from_reader(text.as_slice()).into_records() {
            let line = |position: Option<&csv::Position>| position.map_or(0, csv::Position::line) as usize;
            let record = record.map_err(|error| StudyError::Record {
                path: path.to_owned(),
                line: line(error.position()),
                reason: "this is not text".to_owned(),
            })?;
            let line = line(record.position());
            if std::mem::take(&mut is_first) && is_head(&record) {
                directions.has_head = true;
                continue;
            }
            let wrong = |reason| StudyError::Record { path: path.to_owned(), line, reason };
            directions.rows.push(direction(&record).map_err(wrong)?);
        }
        if directions.rows.is_empty() {
            return Err(StudyError::Format {
                path: path.to_owned(),
                reason: "there is no direction in it".to_owned(),
            });
        }
        Ok(directions)
    }
}

/// True if nothing in the first row is a number.
fn is_head(record: &StringRecord) -> bool {
    record.iter().all(|cell| cell.parse::<f64>().is_err())
}

fn direction(record: &StringRecord) -> Result<DVec3, String> {
    let numbers: Vec<f64> = record
        .iter()
        .map(|cell| cell.parse().map_err(|_| format!("“{cell}” is not a number")))
        .collect::<Result<_, _>>()?;
    let [x, y, z] = numbers[..] else {
        return Err(format!("a direction has three numbers, not {}", numbers.len()));
    };
    // Scaled first, so that no length is beyond what a number holds.
    let largest = DVec3::new(x, y, z).abs().max_element();
    if !(largest > 0.0 && largest.is_finite() && [x, y, z].into_iter().all(f64::is_finite)) {
        return Err(format!("{x}, {y}, {z} is no direction"));
    }
    Ok((DVec3::new(x, y, z) / largest).normalize())
}

/// Writes a row for every direction, with the error of each of the 256 masks (bit i stands for child i: x lowest, then y,
/// then z). Numbers of masks stand above if the directions had a head. Returns the number of rows; `None` if the observer
/// stopped it, when nothing is written.
///
/// # Errors
/// When the table cannot be written.
pub fn write_errors(
    directions: &Directions,
    method: ErrorMethod,
    to: &Path,
    observer: &mut StudyObserver<'_>,
) -> Result<Option<usize>, StudyError> {
    output::check(to).map_err(luxel_engine::EngineError::from)?;
    let start = Instant::now();
    let errors = Source::new(method);
    let mut table = Writer::from_writer(Vec::new());
    if directions.has_head {
        table.write_record((0..256).map(|mask| mask.to_string()))?;
    }
    for (n, rows) in directions.rows.chunks(ROWS_AT_A_TIME).enumerate() {
        let progress = StudyProgress {
            fraction: (n * ROWS_AT_A_TIME) as f64 / directions.rows.len() as f64,
            what: "errors".to_owned(),
            secs: start.elapsed().as_secs_f64(),
        };
        if observer(&StudyEvent::Progress(progress)).is_break() {
            return Ok(None);
        }
        for row in rows {
            table.write_record(errors.along(*row).map(|error| error.to_string()))?;
        }
    }
    let bytes = table.into_inner().map_err(|error| csv::Error::from(error.into_error()))?;
    output::write_file(to, &bytes).map_err(luxel_engine::EngineError::from)?;
    Ok(Some(directions.rows.len()))
}

enum Source {
    RayCast,
    Sh9(Box<Sh9>),
    Exact,
}

impl Source {
    fn new(method: ErrorMethod) -> Self {
        match method {
            ErrorMethod::RayCast => Self::RayCast,
            ErrorMethod::Exact => Self::Exact,
            ErrorMethod::Sh9 => Self::Sh9(Box::new(Sh9::of_document())),
        }
    }

    fn along(&self, direction: DVec3) -> Errors {
        match self {
            Self::RayCast => OctantShares::by_rays(direction, RESOLUTION, SEED).errors(),
            Self::Sh9(sh9) => sh9.errors(direction),
            Self::Exact => OctantShares::exact(direction).errors(),
        }
    }
}
