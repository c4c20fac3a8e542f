//! Reading a list of runs: every line is checked, for a page that is made from it must not claim what cannot be.
use std::collections::HashMap;
use std::fs;
use std::path::Path;

use luxel_engine::QUALITIES;

use crate::kit::picture::is_png;
use super::plan::MAX_DEPTH;
use super::record::{FORMAT, Run, STUDY};
use super::select::STRUCTURES;
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
pub fn read_runs(path: &Path) -> Result<Vec<Run>, StudyError> {
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

fn read_run(line: &str) -> Result<Run, String> {
    let run: Run = serde_json::from_str(line).map_err(|error| json_reason(line, &error))?;
    check_numbers(&run)?;
    check_names(&run)?;
    check_counts(&run)?;
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

fn check_names(run: &Run) -> Result<(), String> {
    if (run.study.as_str(), run.format) != (STUDY, FORMAT) {
        return Err(format!("study '{}', format {}: not of this study", run.study, run.format));
    }
    let qualities: Vec<&str> = QUALITIES.iter().map(|row| row.name).collect();
    for (field, name, known) in [
        ("backend", &run.backend, &["cpu", "gpu"][..]),
        ("structure", &run.structure, &STRUCTURES[..]),
        ("quality", &run.quality, &qualities),
    ] {
        if !known.contains(&name.as_str()) {
            return Err(format!("{field} is '{name}'; known are {}", known.join(", ")));
        }
    }
    if run.picture_png.as_ref().is_some_and(|text| !is_png(text)) {
        return Err("picture_png is not a PNG file in base64".to_owned());
    }
    Ok(())
}

fn check_numbers(run: &Run) -> Result<(), String> {
    let any = 0.0..=f64::MAX;
    let positive = f64::MIN_POSITIVE..=f64::MAX;
    let numbers = [
        ("build_secs", run.build_secs, &any),
        ("frame_ms", run.frame_ms, &positive),
        ("frame_ms_p25", run.frame_ms_p25, &any),
        ("frame_ms_p75", run.frame_ms_p75, &any),
        ("fps", run.fps, &positive),
        ("rays", run.rays, &any),
        ("rays_per_sec", run.rays_per_sec, &any),
        ("nodes_per_ray", run.nodes_per_ray, &any),
        ("tests_per_ray", run.tests_per_ray, &any),
        ("lambert_bounces", run.lambert_bounces, &any),
        ("metal_bounces", run.metal_bounces, &any),
        ("dielectric_bounces", run.dielectric_bounces, &any),
        ("wrong_pixels", run.wrong_pixels.unwrap_or_default(), &(0.0..=1.0)),
        ("wrong_rays", run.wrong_rays.unwrap_or_default(), &(0.0..=1.0)),
        ("noise", run.noise.unwrap_or_default(), &any),
    ];
    let frames = run.frames_ms.iter().map(|ms| ("frames_ms", *ms, &positive));
    match numbers.into_iter().chain(frames).find(|(_, number, range)| !range.contains(number)) {
        Some((field, number, _)) => Err(format!("{field} is out of range: {number}")),
        None => check_times(run),
    }
}

fn check_times(run: &Run) -> Result<(), String> {
    if (run.fps * run.frame_ms / 1e3 - 1.0).abs() > AGREEMENT {
        return Err(format!("fps {} contradicts frame_ms {}", run.fps, run.frame_ms));
    }
    if run.frame_ms_p25 > run.frame_ms || run.frame_ms > run.frame_ms_p75 {
        return Err("frame_ms does not lie between frame_ms_p25 and frame_ms_p75".to_owned());
    }
    Ok(())
}

fn check_counts(run: &Run) -> Result<(), String> {
    for (field, number, most) in [
        ("spheres", run.spheres, u32::MAX),
        ("width", run.width, LONGEST_EDGE),
        ("height", run.height, LONGEST_EDGE),
        ("spp", run.spp, u32::MAX),
        ("frames", run.frames, MOST_FRAMES),
    ] {
        if number == 0 || number > most {
            return Err(format!("{field} is out of range: {number}"));
        }
    }
    if run.outliers > MOST_FRAMES {
        return Err(format!("outliers is out of range: {}", run.outliers));
    }
    if run.max_depth > MAX_DEPTH || run.max_depth > run.asked_depth {
        return Err(format!("max_depth is out of range: {}", run.max_depth));
    }
    let frames = run.frames_ms.len();
    if frames > 0 && frames != (run.frames + run.outliers) as usize {
        return Err(format!("frames_ms has {frames} frames, not frames and outliers together"));
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::super::record::example;
    use super::*;

    fn refused(path: &Path) -> String {
        read_runs(path).unwrap_err().to_string()
    }

    #[test]
    fn a_damaged_line_is_one_error_with_file_and_line() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("runs.jsonl");
        let good = serde_json::to_string(&Run { wrong_pixels: Some(0.5), ..example() }).unwrap();
        for (from, to, part) in [
            (good.as_str(), "{\"study\"", "EOF while parsing an object, at column 8: …{\"study\""),
            ("\"octree\",\"format\"", "\"bvh\",\"format\"", "study 'bvh'"),
            ("\"fps\":100.0", "\"fps\":0.0", "fps is out of range: 0"),
            ("\"fps\":100.0", "\"fps\":-1.0", "fps is out of range: -1"),
            ("\"fps\":100.0", "\"fps\":1e999", "number out of range"),
            ("\"fps\":100.0", "\"fps\":NaN", "\"fps\":N"),
            ("\"fps\":100.0", "\"fps\":90.0", "fps 90 contradicts frame_ms 10"),
            ("\"frame_ms_p25\":9.5", "\"frame_ms_p25\":10.25", "between"),
            ("\"fps\"", "\"pfs\"", "unknown field `pfs`"),
            ("\"metal_bounces\":10.0", "\"metal_bounces\":-1.0", "metal_bounces is out of range: -1"),
            ("\"wrong_pixels\":0.5", "\"wrong_pixels\":7.0", "wrong_pixels is out of range: 7"),
            ("\"backend\":\"cpu\"", "\"backend\":\"quantum\"", "backend is 'quantum'"),
            ("\"quality\":\"low\"", "\"quality\":\"lower\"", "quality is 'lower'"),
            ("\"spheres\":100", "\"spheres\":0", "spheres is out of range: 0"),
            ("\"width\":64", "\"width\":0", "width is out of range: 0"),
            ("\"frames\":50", "\"frames\":4294967295", "frames is out of range"),
            ("\"outliers\":1", "\"outliers\":4294967295", "outliers is out of range"),
            ("\"max_depth\":20", "\"max_depth\":21", "max_depth is out of range"),
            ("}", ",\"frames_ms\":[1.0]}", "frames_ms has 1"),
            ("}", ",\"picture_png\":\"\\\" onerror=\"}", "picture_png"),
        ] {
            let third = good.replace(from, to);
            assert_ne!(third, good);
            fs::write(&path, format!("{good}\n\n{third}\n")).unwrap();
            let message = refused(&path);
            assert!(message.contains("runs.jsonl:3: ") && message.contains(part), "{message}");
            assert!(!message.contains("line"), "{message}");
        }
        fs::write(&path, "\n").unwrap();
        assert!(refused(&path).contains("no run"));
        fs::write(&path, format!("{good}\n\n{good}\n")).unwrap();
        assert!(refused(&path).ends_with("runs.jsonl:3: the same run as on line 1"));
    }
}
