//! Reading a list of runs: every line is checked, for a page that is made from it must not claim what cannot be.
use std::collections::HashMap;
use std::fs;
use std::path::Path;

use super::picture::is_png;
use super::record::{Allowed, Common, Record};
use crate::StudyError;

/// Most frames of a configuration, and most pixels along an edge, that are believed.
const MOST_FRAMES: u32 = 1_000_000;
const LONGEST_EDGE: u32 = 65_535;
/// Frames per second and milliseconds per frame, both rounded to seven digits, agree to this share.
const AGREEMENT: f64 = 1e-5;
/// Bytes of a line that an error quotes.
const QUOTED_BYTES: usize = 30;

/// Reads the records of an earlier study.
///
/// # Errors
/// [`StudyError::Io`], or [`StudyError::Record`] with the first line that is no record of this study.
pub(crate) fn read_runs<R: Record>(path: &Path) -> Result<Vec<R>, StudyError> {
    let text = fs::read_to_string(path).map_err(|source| StudyError::Io { path: path.to_owned(), source })?;
    let bad = |line: usize, reason: String| StudyError::Record { path: path.to_owned(), line, reason };
    let mut runs = Vec::new();
    let mut seen = HashMap::new();
    for (number, line) in (1..).zip(text.lines()).filter(|(_, line)| !line.trim().is_empty()) {
        if let Some(before) = seen.insert(line, number) {
            return Err(bad(number, format!("the same run as on line {before}")));
        }
        runs.push(read_run(line).map_err(|reason| bad(number, reason))?);
    }
    if runs.is_empty() { Err(bad(1, "there is no run in it".to_owned())) } else { Ok(runs) }
}

fn read_run<R: Record>(line: &str) -> Result<R, String> {
    let run: R = serde_json::from_str(line).map_err(|error| {
        let study = other_study::<R>(line).map(|name| format!("study '{name}': not of this study"));
        study.unwrap_or_else(|| json_reason(line, &error))
    })?;
    check_numbers(&run)?;
    check_names::<R>(&run.common())?;
    check_counts(&run.common())?;
    run.check_rest()?;
    Ok(run)
}

/// What is wrong, and what stands before the place where it was noticed.
fn json_reason(line: &str, error: &serde_json::Error) -> String {
    let text = error.to_string();
    let what = text.rsplit_once(" at line ").map_or(text.as_str(), |(what, _)| what);
    let end = error.column().min(line.len());
    let quoted = String::from_utf8_lossy(&line.as_bytes()[end.saturating_sub(QUOTED_BYTES)..end]);
    format!("{what}, at column {end}: …{quoted}")
}

/// The study of a line that is a record of another one, whose fields are other fields.
fn other_study<R: Record>(line: &str) -> Option<String> {
    let value: serde_json::Value = serde_json::from_str(line).ok()?;
    let name = value.get("study")?.as_str()?;
    (name != R::STUDY).then(|| name.to_owned())
}

fn check_names<R: Record>(run: &Common<'_>) -> Result<(), String> {
    if (run.study, run.format) != (R::STUDY, R::FORMAT) {
        return Err(format!("study '{}', format {}: not of this study", run.study, run.format));
    }
    known("backend", run.backend, &["cpu", "gpu"])?;
    known("structure", run.structure, R::STRUCTURES)?;
    if run.picture_png.is_some_and(|text| !is_png(text)) {
        return Err("picture_png is not a PNG file in base64".to_owned());
    }
    Ok(())
}

/// Refuses a name that is not among those that a field may have.
///
/// # Errors
/// The field, the name, and those that are known.
pub(crate) fn known(field: &str, name: &str, names: &[&str]) -> Result<(), String> {
    if names.contains(&name) {
        return Ok(());
    }
    Err(format!("{field} is '{name}'; known are {}", names.join(", ")))
}

fn check_numbers<R: Record>(run: &R) -> Result<(), String> {
    let common = run.common();
    let shared = [
        ("frame_ms", common.frame_ms, Allowed::Positive),
        ("frame_ms_p25", common.frame_ms_p25, Allowed::NotNegative),
        ("frame_ms_p75", common.frame_ms_p75, Allowed::NotNegative),
        ("fps", common.fps, Allowed::Positive),
        ("rays", common.rays, Allowed::NotNegative),
        ("rays_per_sec", common.rays_per_sec, Allowed::NotNegative),
        ("noise", common.noise.unwrap_or_default(), Allowed::NotNegative),
        ("build_secs", common.build_secs, Allowed::NotNegative),
        ("nodes_per_ray", common.nodes_per_ray, Allowed::NotNegative),
        ("tests_per_ray", common.tests_per_ray, Allowed::NotNegative),
        ("lambert_bounces", common.lambert_bounces, Allowed::NotNegative),
        ("metal_bounces", common.metal_bounces, Allowed::NotNegative),
        ("dielectric_bounces", common.dielectric_bounces, Allowed::NotNegative),
    ];
    let frames = common.frames_ms.iter().map(|ms| ("frames_ms", *ms, Allowed::Positive));
    for (field, number, allowed) in shared.into_iter().chain(run.numbers()).chain(frames) {
        let range = match allowed {
            Allowed::NotNegative => 0.0..=f64::MAX,
            Allowed::Positive => f64::MIN_POSITIVE..=f64::MAX,
            Allowed::Share => 0.0..=1.0,
        };
        if !range.contains(&number) {
            return Err(format!("{field} is out of range: {number}"));
        }
    }
    check_times(&common)
}

fn check_times(run: &Common<'_>) -> Result<(), String> {
    if (run.fps * run.frame_ms / 1e3 - 1.0).abs() > AGREEMENT {
        return Err(format!("fps {} contradicts frame_ms {}", run.fps, run.frame_ms));
    }
    if run.frame_ms_p25 > run.frame_ms || run.frame_ms > run.frame_ms_p75 {
        return Err("frame_ms does not lie between frame_ms_p25 and frame_ms_p75".to_owned());
    }
    Ok(())
}

fn check_counts(run: &Common<'_>) -> Result<(), String> {
    for (field, number, most) in [
        ("width", run.width, LONGEST_EDGE),
        ("height", run.height, LONGEST_EDGE),
        ("spp", run.spp, u32::MAX),
        ("frames", run.frames, MOST_FRAMES),
    ] {
        count_in(field, number, most)?;
    }
    if run.outliers > MOST_FRAMES {
        return Err(format!("outliers is out of range: {}", run.outliers));
    }
    let frames = run.frames_ms.len();
    if frames > 0 && frames != (run.frames + run.outliers) as usize {
        return Err(format!("frames_ms has {frames} frames, not frames and outliers together"));
    }
    Ok(())
}

/// Refuses a count that is 0 or more than it can be.
///
/// # Errors
/// The field and the count.
pub(crate) fn count_in(field: &str, count: u32, most: u32) -> Result<(), String> {
    if (1..=most).contains(&count) { Ok(()) } else { Err(format!("{field} is out of range: {count}")) }
}
