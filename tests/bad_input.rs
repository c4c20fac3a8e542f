//! Bad input at the front door: one clear line, the right exit code, and nothing left behind.
#![allow(clippy::unwrap_used)]

mod front_door;

use std::path::Path;

use front_door::{asset, luxel, names, run};

const TRIANGLE: &str = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";

/// A scene with one sphere of the given radius and anything else that an entity may hold.
fn scene(radius: &str, more: &str) -> String {
    format!(
        "(version: 1, entities: [(id: 1, name: \"camera\", camera: (vertical_fov_degrees: 40)), \
         (id: 2, sphere: (radius: {radius}), {more})])"
    )
}

/// Runs `luxel` in a folder that holds `input`, and insists on one line of error that contains `says`, on one of
/// the exit codes for errors, on an empty stdout, and on a folder without anything new.
fn refuses(input: Option<(&str, &[u8])>, arguments: &[&str], says: &str) {
    let folder = tempfile::tempdir().unwrap();
    if let Some((name, content)) = input {
        std::fs::write(folder.path().join(name), content).unwrap();
    }
    std::fs::create_dir(folder.path().join("a_folder.png")).unwrap();
    let before = names(folder.path());
    let outcome = run(luxel(folder.path()).args(arguments));
    let stderr = &outcome.stderr;
    assert!(matches!(outcome.code, Some(2 | 3)), "{arguments:?} gave {:?}: {stderr}", outcome.code);
    assert_eq!(stderr.lines().count(), 1, "{arguments:?}: {stderr}");
    let message =
        stderr.strip_prefix("error: ").unwrap_or_else(|| panic!("{arguments:?}: {stderr}")).trim_end();
    assert!(!message.is_empty() && message.contains(says), "{arguments:?}: no '{says}' in {stderr}");
    assert!(!stderr.contains("panicked"), "{stderr}");
    assert_eq!(outcome.stdout, "", "{arguments:?}");
    assert_eq!(names(folder.path()), before, "{arguments:?} left something");
    assert_eq!(names(&folder.path().join("a_folder.png")), [""; 0], "{arguments:?} left something");
}

/// A small render of a file on the CPU.
fn render(file: &str) -> Vec<&str> {
    vec!["render", file, "--size", "8x4", "--spp", "1", "--backend", "cpu", "--json"]
}

#[test]
fn files_that_are_not_there_or_not_files() {
    refuses(None, &render("missing.ron"), "missing.ron");
    refuses(None, &render("missing.obj"), "missing.obj");
    refuses(None, &render("a_folder.png"), "a_folder.png");
    for folder in [".", "..", "/"] {
        refuses(None, &render(folder), &format!("{folder}: is not a regular file"));
    }
    refuses(None, &["info", "missing.ron", "--json"], "missing.ron");
    refuses(None, &["graph", "missing.vox", "--json"], "missing.vox");
    refuses(Some(("scene.jpg", b"x")), &render("scene.jpg"), "scene.jpg");
    refuses(Some(("scene.ron", b"")), &render("scene.ron"), "scene.ron");
    refuses(Some(("scene.ron", b"\xff\xfe\x00")), &render("scene.ron"), "scene.ron");
}

#[test]
fn models_that_are_cut_short_or_hold_nothing() {
    let triangle_without_end = format!("{TRIANGLE}f 1 2");
    let cut_number = "v 0 0 0\nv 1 0";
    let bad_indices = format!("{TRIANGLE}f 1 2 9\nf 7 8 9\n");
    let degenerate = format!("{TRIANGLE}f 1 1 1\n");
    for model in [&triangle_without_end, cut_number, &bad_indices, &degenerate, TRIANGLE, ""] {
        refuses(Some(("model.obj", model.as_bytes())), &render("model.obj"), "model.obj");
    }
    let mut whole = b"VOX \x96\0\0\0MAIN\0\0\0\0\x28\0\0\0SIZE\x0c\0\0\0\0\0\0\0".to_vec();
    whole.extend(b"\x01\0\0\0\x01\0\0\0\x01\0\0\0XYZI\x08\0\0\0\0\0\0\0\x01\0\0\0\0\0\0\x01");
    for length in [0, 3, 8, 20, 40, whole.len() - 5] {
        refuses(Some(("model.vox", &whole[..length])), &render("model.vox"), "model.vox");
    }
}

#[test]
fn scenes_that_make_no_sense() {
    let cases = [
        ("(version: 1, entities: [".to_owned(), "scene.ron:1"),
        (scene("0", ""), "radius"),
        (scene("-1", ""), "radius"),
        (scene("NaN", ""), "radius"),
        (scene("inf", ""), "radius"),
        (scene("1", "colour: 3"), "colour"),
        ("(version: 1, entities: [(id: 1, sphere: (radius: 1))])".to_owned(), "camera"),
        ("(version: 999, entities: [])".to_owned(), "version 999"),
        (scene("1", "mesh: 5"), "exclude one another, but 2 are given"),
        ("(version: 1, sphere_cloud: (accel: Kdtree))".to_owned(), "`OctreeSeed`"),
        (
            "(version: 1, sphere_cloud: (max_depth: 21))".to_owned(),
            "sphere_cloud: max_depth must be in 0 to 20",
        ),
        ("(version: 1, sphere_cloud: (min_spheres: 65536))".to_owned(), "min_spheres must be in 0 to 65535"),
    ];
    for (text, says) in cases {
        refuses(Some(("scene.ron", text.as_bytes())), &render("scene.ron"), says);
    }
}

#[test]
fn the_line_and_column_of_a_syntax_error_are_named() {
    let text = "(\n  version: 1,\n  entities: [\n    (id: 1 name: 2),\n  ],\n)\n";
    refuses(Some(("scene.ron", text.as_bytes())), &render("scene.ron"), "scene.ron:4:");
}

#[test]
fn outputs_that_cannot_be_written() {
    let scene = scene("1", "");
    let input = Some(("scene.ron", scene.as_bytes()));
    let cases = [
        ("missing/out.png", "there is no folder"),
        ("a_folder.png", "it is a folder"),
        ("out.jpg", "must end in .png or .exr"),
        ("out", "must end in .png or .exr"),
        ("scene.ron/out.png", "there is no folder"),
        ("/proc/luxel.png", "/proc/luxel.png"),
    ];
    for (output, says) in cases {
        refuses(input, &[render("scene.ron"), vec!["-o", output]].concat(), says);
    }
    refuses(input, &[render("scene.ron"), vec!["-o", "a.exr", "--view", "steps"]].concat(), "--aov");
}

#[test]
fn an_extra_output_that_cannot_be_written_stops_before_the_render() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::create_dir(folder.path().join("out.depth.png")).unwrap();
    let scene = asset("one_of_each.ron");
    let mut command = luxel(folder.path());
    command.args(render(scene.to_str().unwrap())).args(["-o", "out.png", "--aov", "depth"]);
    let outcome = run(&mut command);
    assert_eq!(outcome.code, Some(2), "{}", outcome.stderr);
    assert_eq!(names(folder.path()), ["out.depth.png"]);
}

#[test]
fn options_out_of_range() {
    let scene = scene("1", "");
    let input = Some(("scene.ron", scene.as_bytes()));
    let cases: [(&[&str], &str); 23] = [
        (&["--size", "3"], "WIDTHxHEIGHT"),
        (&["--size", "0x4"], "WIDTHxHEIGHT"),
        (&["--size", "99999x4"], "99999x4"),
        (&["--spp", "0"], "--spp"),
        (&["--spp", "many"], "--spp"),
        (&["--size", "-3x4"], "WIDTHxHEIGHT"),
        (&["--spp", "-1"], "-1 is not in 1.."),
        (&["--time", "-1"], "expected a positive number"),
        (&["--time", "NaN"], "--time"),
        (&["--error", "0%"], "--error"),
        (&["--error", "-1"], "expected a positive percentage"),
        (&["--error", "-1%"], "expected a positive percentage"),
        (&["--seed", "-3"], "-3 is not in 0..=4294967295"),
        (&["--max-depth", "65536"], "65536 is not in 0..=65535"),
        (&["--max-depth", "-1"], "-1 is not in 0..=65535"),
        (&["--camera", "nobody"], "no camera is named 'nobody'"),
        (&["--aov", "depth,colour"], "colour"),
        (&["--view", "xray"], "xray"),
        (&["--backend", "fpga"], "fpga"),
        (&["--exposure", "inf"], "--exposure"),
        (&["--sphere-accel", "kdtree"], "octree-base, octree-seed, octree, bvh"),
        (&["--sphere-accel", "Bvh"], "--sphere-accel"),
        (&["--quality", "ultra"], "low, standard, high"),
    ];
    for (options, says) in cases {
        let arguments = [&["render", "scene.ron", "--json"], options].concat();
        refuses(input, &arguments, says);
    }
    refuses(None, &["info", "scene.ron", "--sphere-accel", "fast"], "fast");
    refuses(None, &["graph", "scene.ron", "--sphere-accel", ""], "--sphere-accel");
    refuses(None, &["render"], "<FILE>");
    refuses(None, &["frobnicate"], "frobnicate");
    refuses(None, &["render", "a.ron", "b.ron"], "b.ron");
}

#[test]
fn pictures_that_cannot_be_compared() {
    let exr = Path::new("a.exr");
    let small = |name: &str, width: u32| {
        let mut bytes = std::io::Cursor::new(Vec::new());
        let format =
            if Path::new(name) == exr { image::ImageFormat::OpenExr } else { image::ImageFormat::Png };
        let picture = image::DynamicImage::new_rgb32f(width, 16);
        let picture = if format == image::ImageFormat::Png { picture.into_rgb8().into() } else { picture };
        picture.write_to(&mut bytes, format).unwrap();
        bytes.into_inner()
    };
    let (png, other_png, exr) = (small("a.png", 16), small("b.png", 17), small("a.exr", 16));
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name).to_str().unwrap().to_owned();
    for (name, content) in
        [("other.png", other_png.as_slice()), ("a.exr", &exr), ("cut.png", &png[..png.len() / 2])]
    {
        std::fs::write(path(name), content).unwrap();
    }
    let input = Some(("a.png", png.as_slice()));
    for (other, says) in
        [("other.png", "size"), ("a.exr", "kind"), ("cut.png", "cut.png"), ("no.png", "no.png")]
    {
        refuses(input, &["compare", "a.png", &path(other), "--json"], says);
    }
    refuses(input, &["compare", "a.png", "a_folder.png"], "a_folder.png");
    refuses(input, &["compare", "a.png", "a.png", "--max-flip", "NaN"], "--max-flip");
    for limit in ["--max-rmse", "--max-relmse", "--min-psnr", "--min-ssim", "--max-flip"] {
        refuses(input, &["compare", "a.png", "a.png", limit, "-1"], "expected a number that is not negative");
    }
}

#[test]
fn a_model_with_some_bad_faces_renders_the_rest_and_says_how_many() {
    let folder = tempfile::tempdir().unwrap();
    let model = format!("{TRIANGLE}f 1 2 3\nf 1 2 99\nf 3 2 -50\n");
    std::fs::write(folder.path().join("model.obj"), model).unwrap();
    let outcome = run(luxel(folder.path()).args(render("model.obj")));
    assert_eq!(outcome.code, Some(0), "{}", outcome.stderr);
    let notes: Vec<&str> = outcome.stderr.lines().filter(|line| line.starts_with("note: ")).collect();
    assert!(notes.iter().any(|note| note.contains('2')), "no count of dropped faces in {}", outcome.stderr);
    let answer: serde_json::Value = serde_json::from_str(&outcome.stdout).unwrap();
    assert!(!answer["notices"].as_array().unwrap().is_empty());
    image::open(folder.path().join("model.png")).unwrap();
}
