//! The reader of lists, against damaged records of this study.
use std::fs;
use std::path::Path;

use super::read_runs;
use super::record::{Run, example};

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
