//! Damaged and hostile files end in a scene or in one clear line: no panic, no hang, no runaway memory.
//!
//! The files are loaded by a child process that may not have more than 4 GiB of memory; it is this test binary
//! again. It says which file comes next and how it went, so that the parent can tell which file it died of.
#![allow(clippy::unwrap_used, clippy::print_stdout)]

mod support;

use std::fs;
use std::io::{BufRead, BufReader};
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::sync::mpsc::{Receiver, channel};
use std::time::{Duration, Instant};

use luxel_scene::{Assets, ImageAsset, ImageSource, empty_world, load};
use support::{files, require};

/// Names the list of files that a child is to load.
const LIST: &str = "LUXEL_HOSTILE_LIST";

/// A child's memory in KiB: 4 GiB of address space.
const MEMORY_KIB: u64 = 4 << 20;

/// What no single file may take: far more than any does, for a loaded machine.
const PATIENCE: Duration = Duration::from_secs(30);

/// The child: loads each file of the list. Without a list it has nothing to do.
#[test]
fn child() {
    let Ok(list) = std::env::var(LIST) else { return };
    for path in fs::read_to_string(list).unwrap().lines() {
        println!("\nBEGIN {path}");
        let start = Instant::now();
        let result = attempt(Path::new(path));
        println!("\nEND {:.3} {result}", start.elapsed().as_secs_f64());
    }
}

fn attempt(path: &Path) -> String {
    let ending = path.extension().unwrap_or_default().to_string_lossy().to_lowercase();
    if matches!(ending.as_str(), "gltf" | "glb" | "obj" | "ply" | "vox" | "ron") {
        let mut world = empty_world();
        match load(path, &mut world) {
            Ok(_) => {
                let finite = world
                    .resource::<Assets>()
                    .meshes()
                    .all(|(_, mesh)| mesh.mesh.positions.iter().all(|p| p.is_finite()));
                if finite { "scene".to_owned() } else { "error POSITIONS THAT ARE NONE".to_owned() }
            }
            Err(error) => format!("error {error}"),
        }
    } else {
        match ImageAsset::from_source(ImageSource::File(path.to_owned())) {
            Ok(_) => "scene".to_owned(),
            Err(error) => format!("error {error}"),
        }
    }
}

fn start_child(list: &Path) -> Child {
    let binary = std::env::current_exe().unwrap();
    // Only Linux has a limit for this, and there it must hold.
    let then = if cfg!(target_os = "linux") { "&&" } else { ";" };
    let limited =
        format!("ulimit -v {MEMORY_KIB} {then} exec \"$0\" child --exact --nocapture --test-threads=1");
    Command::new("sh")
        .args(["-c", &limited])
        .arg(binary)
        .env(LIST, list)
        // The image library decodes in as many threads as there are processors, each with a stack.
        .env("RAYON_NUM_THREADS", "2")
        .stdout(Stdio::piped())
        .stderr(Stdio::null())
        .spawn()
        .unwrap()
}

fn lines_of(child: &mut Child) -> Receiver<String> {
    let (send, receive) = channel();
    let output = BufReader::new(child.stdout.take().unwrap());
    std::thread::spawn(move || {
        for line in output.lines().map_while(Result::ok) {
            let _ = send.send(line);
        }
    });
    receive
}

/// A file and how it went: "scene" or "error …".
type Outcome = (PathBuf, String);

/// Loads every file in a limited child. Fails if one ends or stalls it, or panics.
fn outcomes(paths: &[PathBuf]) -> Vec<Outcome> {
    let folder = tempfile::tempdir().unwrap();
    let list = folder.path().join("list");
    fs::write(&list, paths.iter().map(|path| format!("{}\n", path.display())).collect::<String>()).unwrap();
    let mut child = start_child(&list);
    let lines = lines_of(&mut child);
    let (mut current, mut outcomes) = (PathBuf::new(), Vec::new());
    let mut slowest = (0.0, PathBuf::new());
    loop {
        match lines.recv_timeout(PATIENCE) {
            Ok(line) => {
                if let Some(path) = line.strip_prefix("BEGIN ") {
                    current = path.into();
                } else if let Some((seconds, result)) =
                    line.strip_prefix("END ").and_then(|end| end.split_once(' '))
                {
                    let seconds: f64 = seconds.parse().unwrap();
                    if seconds > slowest.0 {
                        slowest = (seconds, current.clone());
                    }
                    outcomes.push((current.clone(), result.to_owned()));
                }
            }
            Err(std::sync::mpsc::RecvTimeoutError::Timeout) => {
                child.kill().unwrap();
                panic!("{} takes longer than {PATIENCE:?}", current.display());
            }
            Err(std::sync::mpsc::RecvTimeoutError::Disconnected) => break,
        }
    }
    let status = child.wait().unwrap();
    assert!(status.success(), "{} ended the process: {status}", current.display());
    assert_eq!(outcomes.len(), paths.len(), "after {}", current.display());
    println!("{} files, the slowest {:.3} s: {}", outcomes.len(), slowest.0, slowest.1.display());
    for (path, outcome) in &outcomes {
        assert!(!outcome.contains("gave up"), "{}: a panic: {outcome}", path.display());
        assert!(!outcome.contains("THAT ARE NONE"), "{}: {outcome}", path.display());
    }
    outcomes
}

#[test]
fn collected_hostile_models() {
    let mut paths = Vec::new();
    for (folder, endings) in [
        ("gltf-malformed", &["gltf", "glb"][..]),
        ("gltf-unsupported", &["gltf", "glb"]),
        ("gltf-asset-generator/Negative", &["gltf", "glb"]),
        ("obj-edge", &["obj"]),
        ("obj-fuzz", &["obj"]),
        ("ply-edge", &["ply"]),
        ("vox-malformed", &["vox"]),
        ("vox", &["vox"]),
    ] {
        paths.extend(files(folder, endings));
    }
    require(paths.len(), 500, "hostile models");
    if paths.is_empty() {
        return;
    }
    let outcomes = outcomes(&paths);
    let scenes = outcomes.iter().filter(|(_, outcome)| outcome == "scene").count();
    println!("{scenes} scenes, {} errors", outcomes.len() - scenes);
    if std::env::var("LUXEL_SHOW").is_ok() {
        outcomes.iter().for_each(|(path, outcome)| println!("{}: {outcome}", path.display()));
    }
    check_expected(&outcomes);
}

/// Files without an error, by the Khronos validator, must load.
fn check_expected(outcomes: &[Outcome]) {
    let table = support::shared("gltf-malformed/khronos-validator/EXPECTED.tsv");
    let table = fs::read_to_string(table).unwrap_or_default();
    let mut wrong = Vec::new();
    for row in table.lines().skip(1) {
        let columns: Vec<_> = row.split('\t').collect();
        let path = support::shared(columns[0]);
        let Some((_, outcome)) = outcomes.iter().find(|(file, _)| *file == path) else { continue };
        // What asks for an extension that we lack must be refused, valid or not.
        let is_refused = outcome.contains("requires the glTF extension")
            || outcome.contains("this program reads glTF 2.0");
        if columns[1] == "0" && outcome != "scene" && !is_refused {
            wrong.push(format!("{}: {outcome}", columns[0]));
        }
    }
    assert!(wrong.is_empty(), "{wrong:#?}");
}

#[test]
fn collected_hostile_images() {
    let mut paths = files("exr-malformed", &[]);
    // They have no ending by which an image is known; their content says what they are.
    paths.extend(files("hdr", &["hdr", "exr"]));
    paths.extend(files("heightmaps", &["png"]));
    require(paths.len(), 15, "images");
    if !paths.is_empty() {
        outcomes(&paths);
    }
}

/// Writes `count` beginnings of `path`, evenly spread, into `folder`.
fn prefixes(path: &Path, index: usize, count: usize, folder: &Path) -> Vec<PathBuf> {
    let bytes = fs::read(path).unwrap();
    let name = path.file_name().unwrap().to_string_lossy();
    let ends = (0..count).map(|step| bytes.len() * step / count);
    ends.map(|end| {
        let cut = folder.join(format!("{index}-{end}-{name}"));
        fs::write(&cut, &bytes[..end]).unwrap();
        cut
    })
    .collect()
}

#[test]
fn beginnings_of_good_files() {
    let is_soak = std::env::var("LUXEL_SOAK").is_ok_and(|soak| soak == "1");
    let mut sources = files("gltf", &["gltf", "glb"]);
    sources.extend(files("ply-edge", &["ply"]));
    sources.extend(files("hdr", &["hdr", "exr"]));
    sources.retain(|path| is_soak || fs::metadata(path).unwrap().len() < 200_000);
    require(sources.len(), 40, "good files");
    let folder = tempfile::tempdir().unwrap();
    let count = if is_soak { 400 } else { 12 };
    for part in sources.chunks(32) {
        let cut: Vec<_> = part
            .iter()
            .enumerate()
            .flat_map(|(index, path)| prefixes(path, index, count, folder.path()))
            .collect();
        outcomes(&cut);
        for path in cut {
            // Two ends of a short file may be one.
            let _ = fs::remove_file(path);
        }
    }
}

/// The JSON of a .glb file, where a change does most; all of any other file.
fn text_of(bytes: &[u8]) -> std::ops::Range<usize> {
    match bytes.get(12..16) {
        Some(length) if bytes.starts_with(b"glTF") => {
            20..20 + u32::from_le_bytes(length.try_into().unwrap()) as usize
        }
        _ => 0..bytes.len(),
    }
}

#[test]
fn changed_bytes_of_good_files() {
    let is_soak = std::env::var("LUXEL_SOAK").is_ok_and(|soak| soak == "1");
    let names = [
        "gltf/Box.glb",
        "gltf/Box-embedded.gltf",
        "gltf/box_sparse.glb",
        "gltf/BoxInterleaved.glb",
        "gltf/BoxVertexColors.glb",
        "gltf/Duck.glb",
        "scenes/cornell-box/CornellBox.glb",
        "ply-edge/mitsuba/rectangle_normals_uv.ply",
        "ply-edge/assimp/cube_binary_header_with_RN_newline.ply",
        "hdr/image-rs/rgbr4x4.hdr",
    ];
    let sources: Vec<_> =
        names.iter().map(|name| support::shared(name)).filter(|path| path.exists()).collect();
    let folder = tempfile::tempdir().unwrap();
    let mut state = 0x1CED_u64;
    // SplitMix64: the same changes on every machine.
    let mut random = move |below: usize| {
        state = state.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut z = state;
        z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        ((z ^ (z >> 31)) % below as u64) as usize
    };
    let mut changed = Vec::new();
    for source in &sources {
        let bytes = fs::read(source).unwrap();
        let text = text_of(&bytes);
        for round in 0..if is_soak { 3000 } else { 100 } {
            let mut copy = bytes.clone();
            for _ in 0..=random(4) {
                let part = if random(4) == 0 { 0..bytes.len() } else { text.clone() };
                let (at, value) = (part.start + random(part.len()), random(256) as u8);
                // Digits mostly stay digits, so that the change reaches beyond the parser.
                copy[at] = if copy[at].is_ascii_digit() { b'0' + value % 10 } else { value };
            }
            let name = source.file_name().unwrap().to_string_lossy();
            let path = folder.path().join(format!("{round}-{name}"));
            fs::write(&path, copy).unwrap();
            changed.push(path);
        }
    }
    if !changed.is_empty() {
        outcomes(&changed);
    }
}
