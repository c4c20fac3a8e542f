//! Damaged lists of runs, for the tests of every study.
use std::fs;

use crate::kit::list::read_runs;
use crate::kit::record::Record;

/// What is replaced in a good line, by what, and a part of what is said about it.
pub(crate) type Damage<'a> = (&'a str, &'a str, &'a str);

/// Damages to fields that every record has, as `example_of` fills them.
const COMMON: [Damage<'static>; 16] = [
    ("\"fps\":100.0", "\"fps\":0.0", "fps is out of range: 0"),
    ("\"fps\":100.0", "\"fps\":-1.0", "fps is out of range: -1"),
    ("\"fps\":100.0", "\"fps\":1e999", "number out of range"),
    ("\"fps\":100.0", "\"fps\":NaN", "\"fps\":N"),
    ("\"fps\":100.0", "\"fps\":90.0", "fps 90 contradicts frame_ms 10"),
    ("\"fps\"", "\"pfs\"", "unknown field `pfs`"),
    ("\"frame_ms_p25\":9.5", "\"frame_ms_p25\":10.25", "between"),
    ("\"metal_bounces\":10.0", "\"metal_bounces\":-1.0", "metal_bounces is out of range: -1"),
    ("\"build_secs\":0.001", "\"build_secs\":-0.5", "build_secs is out of range: -0.5"),
    ("\"backend\":\"cpu\"", "\"backend\":\"quantum\"", "backend is 'quantum'"),
    ("\"structure\":\"bvh\"", "\"structure\":\"kd\"", "structure is 'kd'"),
    ("\"width\":64", "\"width\":0", "width is out of range: 0"),
    ("\"frames\":50", "\"frames\":4294967295", "frames is out of range"),
    ("\"outliers\":1", "\"outliers\":4294967295", "outliers is out of range"),
    ("}", ",\"frames_ms\":[1.0]}", "frames_ms has 1"),
    ("}", ",\"picture_png\":\"\\\" onerror=\"}", "picture_png"),
];

/// Checks that every damage, of all studies or of one, is refused in one line with file and line.
pub(crate) fn assert_refused<R: Record>(good: &R, own: &[Damage<'_>]) {
    let good = serde_json::to_string(good).unwrap();
    let cut_off = (good.as_str(), "{\"study\"", "EOF while parsing an object, at column 8: …{\"study\"");
    assert_eq!(read::<R>(&good).unwrap(), 1);
    for (from, to, part) in COMMON.iter().chain(own).copied().chain([cut_off]) {
        let damaged = good.replace(from, to);
        assert_ne!(damaged, good, "there is no {from}");
        let message = read::<R>(&format!("{good}\n\n{damaged}\n")).unwrap_err();
        assert!(message.contains("runs.jsonl:3: ") && message.contains(part), "{message}");
        assert!(!message.contains("line"), "{message}");
    }
    every_number_is_checked::<R>(&good);
    assert!(read::<R>("\n").unwrap_err().contains("no run"));
    let twice = read::<R>(&format!("{good}\n\n{good}\n")).unwrap_err();
    assert!(twice.ends_with("runs.jsonl:3: the same run as on line 1"), "{twice}");
}

/// Checks that no number of a record may be below 0.
fn every_number_is_checked<R: Record>(good: &str) {
    let fields: serde_json::Map<String, serde_json::Value> = serde_json::from_str(good).unwrap();
    for (field, _) in fields.iter().filter(|(_, value)| value.is_number()) {
        let mut damaged = fields.clone();
        damaged.insert(field.clone(), (-1.5).into());
        let message = read::<R>(&serde_json::to_string(&damaged).unwrap());
        assert!(message.is_err(), "{field} may be -1.5");
    }
}

/// The number of runs in a list, or why there is none.
pub(crate) fn read<R: Record>(text: &str) -> Result<usize, String> {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("runs.jsonl");
    fs::write(&path, text).unwrap();
    read_runs::<R>(&path).map(|runs| runs.len()).map_err(|error| error.to_string())
}
