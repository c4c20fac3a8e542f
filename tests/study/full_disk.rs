//! What a disk that fills up leaves of a study: whole runs, and no empty folder. A limit on the size of files stands for the disk.
use std::path::Path;

use crate::front_door::{Outcome, luxel, names, run};
use crate::page::refused;

/// Runs `luxel study octree` in `folder` with no file longer than `blocks` of 512 or 1,024 bytes.
fn study(folder: &Path, blocks: u32, arguments: &str) -> Outcome {
    let program = luxel(folder);
    // A program that ignores the signal is told by an error, as it is of a full disk.
    let script = format!("trap '' XFSZ; ulimit -f {blocks}; exec \"$0\" study octree {arguments}");
    let mut command = std::process::Command::new("sh");
    command.args(["-c", script.as_str()]).arg(program.get_program()).current_dir(folder);
    for (name, value) in program.get_envs() {
        match value {
            Some(value) => command.env(name, value),
            None => command.env_remove(name),
        };
    }
    run(&mut command)
}

#[test]
fn what_finds_no_space_leaves_what_was_measured_whole_and_no_empty_folder() {
    let folder = tempfile::tempdir().unwrap();
    // The first run and its picture fill 60 KiB.
    let outcome = study(folder.path(), 130, "--quick --seconds 0.001 --backend cpu --out new/out");
    assert_eq!(outcome.code, Some(3), "{}", outcome.stderr);
    assert!(outcome.stderr.contains("error: cannot write new/out/runs.jsonl.part"), "{}", outcome.stderr);
    assert_eq!(names(&folder.path().join("new/out")), ["runs.jsonl.part"]);
    let again = "--from new/out/runs.jsonl.part --out";
    study(folder.path(), 100_000, &format!("{again} again")).succeeded();
    assert_eq!(names(&folder.path().join("again")), ["octree.html", "runs.csv"]);
    let error = refused(study(folder.path(), 1, &format!("{again} once/more")), 3);
    assert!(error.contains("cannot write once/more/octree.html: ") && !error.contains(".luxel-"), "{error}");
    assert_eq!(names(folder.path()), ["again", "new"]);
}
