//! Tells the program which commit it is built from: `LUXEL_COMMIT`, with `-dirty` if tracked files are changed.
//!
//! Found while building, since the working copy may be another when the program runs. Without git, or where this is no
//! working copy of Luxel, nothing is told.
use std::path::Path;
use std::process::Command;

fn main() {
    println!("cargo:rerun-if-changed=build.rs");
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    // In another project's working copy git would name that project's commit.
    if git(&root, &["rev-parse", "--show-cdup"]).as_deref() != Some("") {
        return;
    }
    let Some(commit) = git(&root, &["describe", "--always", "--dirty", "--exclude=*"]) else { return };
    println!("cargo:rustc-env=LUXEL_COMMIT={commit}");
    for place in watched(&root) {
        println!("cargo:rerun-if-changed={}", root.join(place).display());
    }
}

/// Whatever may change the answer and the program with it: where the working copy stands, and the sources of all rooms.
/// A place that is missing is left out, for cargo would run the script each time.
fn watched(root: &Path) -> Vec<String> {
    let git_paths = ["HEAD", "logs/HEAD", "packed-refs"];
    let mut places: Vec<String> =
        git_paths.iter().filter_map(|name| git(root, &["rev-parse", "--git-path", name])).collect();
    places.extend(["Cargo.toml", "Cargo.lock", "shaders"].map(str::to_owned));
    let rooms = std::fs::read_dir(root.join("crates")).into_iter().flatten().flatten();
    places.extend(rooms.map(|room| format!("crates/{}/src", room.file_name().to_string_lossy())));
    places.retain(|place| root.join(place).exists());
    places
}

/// The line that git answers with; `None` if it fails or is missing.
fn git(root: &Path, arguments: &[&str]) -> Option<String> {
    let output = Command::new("git").arg("-C").arg(root).args(arguments).output().ok()?;
    let text = String::from_utf8(output.stdout).ok()?;
    output.status.success().then(|| text.trim().to_owned())
}
