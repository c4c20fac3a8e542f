//! The studies of voxels, small, cut short and gone on with.
use std::ops::ControlFlow;

use super::*;
use crate::StudyEvent;

fn plan() -> Plan {
    Plan { areas: vec![AreaKind::Desert, AreaKind::Mountain], size: 64, quick: true }
}

pub(super) fn small_study(out: &Path, most_events: usize) -> Studied {
    let mut events = 0;
    let mut observer = |_: &StudyEvent| {
        events += 1;
        if events > most_events { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    };
    run(&plan(), &Origin::now(None), out, &mut observer).unwrap()
}

/// What does not differ from one time to the next.
fn timeless(runs: &[Run]) -> Vec<Run> {
    runs.iter().map(|run| Run { secs: 0.0, date: String::new(), ..run.clone() }).collect()
}

#[test]
fn a_study_that_was_cut_short_goes_on_and_ends_as_one_that_was_not() {
    let folders = [tempfile::tempdir().unwrap(), tempfile::tempdir().unwrap()];
    let whole = small_study(folders[0].path(), usize::MAX);
    assert!(whole.is_complete && whole.runs.len() > 100, "{}", whole.runs.len());
    let first = small_study(folders[1].path(), 200);
    assert!(!first.is_complete && !first.runs.is_empty() && first.runs.len() < whole.runs.len());
    let second = small_study(folders[1].path(), usize::MAX);
    assert!(second.is_complete);
    assert!(second.runs[..first.runs.len()] == first.runs, "something was measured twice");
    assert!(timeless(&second.runs) == timeless(&whole.runs), "other pictures");
    let list = folders[1].path().join("runs.jsonl");
    assert!(read_runs(&list).unwrap() == second.runs);
    let again = tempfile::tempdir().unwrap();
    redo(&list, again.path()).unwrap();
    let page = |folder: &Path| std::fs::read_to_string(folder.join(PAGE)).unwrap();
    assert!(page(again.path()) == page(folders[1].path()));
}

#[test]
fn damaged_lines_are_named() {
    let folder = tempfile::tempdir().unwrap();
    let runs = small_study(folder.path(), 40).runs;
    let list = folder.path().join("list.jsonl");
    let good = serde_json::to_string(&runs[0]).unwrap();
    let damages = [
        good.replace("\"format\":1", "\"format\":7"),
        good.replace("\"resolution\":16", "\"resolution\":4000000000"),
        good.replace("\"missed\":", "\"missed\":1"),
        good.replace("\"ssim\":", "\"ssim\":9"),
        good.replace("\"area\"", "\"place\""),
        good.clone(),
    ];
    for damaged in damages {
        std::fs::write(&list, format!("{good}\n{damaged}\n")).unwrap();
        let error = read_runs(&list).unwrap_err();
        assert!(matches!(error, StudyError::Record { line: 2, .. }), "{error}: {damaged}");
    }
}
