//! Every command at the front door: the program itself, on small scenes.
#![allow(clippy::unwrap_used)]

mod front_door;

use std::path::Path;
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

use front_door::{asset, luxel, run};
use serde_json::Value;

/// The smallest render of the smallest scene with everything in it.
const SMALL: &[&str] = &["--size", "32x18", "--spp", "2"];

/// Renders `one_of_each` in `folder` with further arguments and gives stdout.
fn render(folder: &Path, more: &[&str]) -> String {
    let mut command = luxel(folder);
    command.arg("render").arg(asset("one_of_each.ron")).args(SMALL).args(more);
    run(&mut command).succeeded()
}

fn json(text: &str) -> Value {
    serde_json::from_str(text).unwrap_or_else(|error| panic!("{error} in {text}"))
}

/// The text of a PNG's iTXt chunk: length, `iTXt`, keyword, a zero, no compression (two bytes), two empty strings, text.
fn png_text(path: &Path, key: &str) -> String {
    let bytes = std::fs::read(path).unwrap();
    let keyword = format!("iTXt{key}\0");
    let found = bytes.windows(keyword.len()).position(|window| window == keyword.as_bytes());
    let start = found.unwrap_or_else(|| panic!("no {key}"));
    let length = u32::from_be_bytes(bytes[start - 4..start].try_into().unwrap()) as usize;
    let text = &bytes[start + keyword.len() + 4..start + 4 + length];
    String::from_utf8(text.to_vec()).unwrap()
}

fn exr_channels(path: &Path) -> Vec<String> {
    let image = exr::prelude::read_first_flat_layer_from_file(path).unwrap();
    image.layer_data.channel_data.list.iter().map(|channel| channel.name.to_string()).collect()
}

/// What both backends must answer.
fn check_render_on(backend: &str) {
    let folder = tempfile::tempdir().unwrap();
    let answer =
        json(&render(folder.path(), &["--backend", backend, "-o", "out.png", "--seed", "7", "--json"]));
    let picture = image::open(folder.path().join("out.png")).unwrap().into_rgb8();
    assert_eq!((picture.width(), picture.height()), (32, 18));
    assert!(picture.pixels().any(|pixel| pixel != picture.get_pixel(0, 0)), "the picture is one colour");
    assert_eq!(png_text(&folder.path().join("out.png"), "luxel.samples"), "2");

    assert_eq!((&answer["width"], &answer["height"], &answer["spp"]), (&32.into(), &18.into(), &2.into()));
    assert_eq!((&answer["backend"], &answer["stopped_by"]), (&backend.into(), &"samples".into()));
    assert_eq!(answer["outputs"], serde_json::json!(["out.png"]));
    for stage in ["load", "bake", "compile", "trace", "write"] {
        assert!(answer["seconds"][stage].as_f64().unwrap() >= 0.0, "{stage}");
    }
    assert!(answer["seconds"]["write"].as_f64().unwrap() > 0.0, "writing took no time");
    let passes = answer["passes"].as_array().unwrap();
    assert!(!passes.is_empty() && passes.iter().all(|pass| pass["ms"].is_f64() && pass["runs"].is_u64()));
    assert!(answer["rays_per_sec"].as_f64().unwrap() > 0.0);
    assert_eq!(answer["counters"]["camera_rays"], 32 * 18 * 2);
}

#[test]
fn render_on_the_cpu() {
    check_render_on("cpu");
}

#[test]
fn render_on_the_gpu() {
    if luxel_gpu::testing::gpu_or_fail().is_some() {
        check_render_on("gpu");
    }
}

#[test]
fn equal_seeds_give_equal_pictures_and_others_do_not() {
    let folder = tempfile::tempdir().unwrap();
    for (name, seed) in [("a.png", "1"), ("b.png", "1"), ("c.png", "2")] {
        render(folder.path(), &["--backend", "cpu", "-o", name, "--seed", seed]);
    }
    let pixels = |name: &str| image::open(folder.path().join(name)).unwrap().into_rgb8().into_raw();
    assert_eq!(pixels("a.png"), pixels("b.png"));
    assert_ne!(pixels("a.png"), pixels("c.png"));
}

#[test]
fn the_last_line_says_where_and_how() {
    let folder = tempfile::tempdir().unwrap();
    let line = render(folder.path(), &["--backend", "cpu"]);
    assert_eq!(line.lines().count(), 1, "{line}");
    for part in
        ["wrote one_of_each.png: 32x18, 2 spp in ", " rays/s, error ", "because the CPU was asked for"]
    {
        assert!(line.contains(part), "no '{part}' in {line}");
    }
    assert!(folder.path().join("one_of_each.png").is_file());
}

#[test]
fn outputs_beside_a_png_are_files() {
    let folder = tempfile::tempdir().unwrap();
    let aovs = "albedo,normal,depth,position,ids,samples,variance";
    render(folder.path(), &["--backend", "cpu", "-o", "out.png", "--aov", aovs]);
    for name in aovs.split(',') {
        let picture = image::open(folder.path().join(format!("out.{name}.png"))).unwrap();
        assert_eq!((picture.width(), picture.height()), (32, 18), "{name}");
    }
    assert_eq!(front_door::names(folder.path()).len(), 8);
}

#[test]
fn outputs_in_an_exr_are_layers() {
    let folder = tempfile::tempdir().unwrap();
    let more =
        ["--backend", "cpu", "-o", "out.exr", "--aov", "albedo,depth,ids,ids", "--exr-precision", "float"];
    render(folder.path(), &more);
    let channels = exr_channels(&folder.path().join("out.exr"));
    let expected = ["B", "G", "R", "Z", "albedo.B", "albedo.G", "albedo.R", "id.instance", "id.primitive"];
    assert_eq!(channels, expected);
}

#[test]
fn every_view_and_every_curve_makes_a_picture() {
    let folder = tempfile::tempdir().unwrap();
    let options = [
        ("--view", "path albedo normal depth position ids samples variance steps"),
        ("--tone-map", "none reinhard aces agx"),
    ];
    for (option, values) in options {
        for value in values.split(' ') {
            render(folder.path(), &["--backend", "cpu", "-o", "out.png", option, value]);
            image::open(folder.path().join("out.png")).unwrap();
        }
    }
}

#[test]
fn options_without_effect_are_noted_and_stdout_stays_json() {
    let folder = tempfile::tempdir().unwrap();
    let noted = |options: &str| {
        let mut command = luxel(folder.path());
        command.arg("render").arg(asset("one_of_each.ron")).args(SMALL);
        let outcome = run(command.args(["--backend", "cpu", "--json"]).args(options.split(' ')));
        json(&outcome.stdout);
        outcome.stderr
    };
    assert_eq!(
        noted("-o a.exr --tone-map agx --exposure 1"),
        "note: --tone-map has no effect on a.exr: an EXR holds linear light\n\
         note: --exposure has no effect on a.exr: an EXR holds linear light \
         (only the error estimate takes the exposure in)\n"
    );
    assert_eq!(
        noted("-o a.png --exr-precision half"),
        "note: --exr-precision has no effect on a.png: it is for an EXR\n"
    );
    assert_eq!(
        noted("-o a.png --quality high --max-depth 2"),
        "note: --quality has no effect on a.png: --spp and --max-depth say all that it stands for\n"
    );
    let scene = asset("one_of_each.ron");
    let scenes = format!(
        "note: --scene has no effect on {}: only a glTF model has scenes to choose from\n",
        scene.display()
    );
    assert_eq!(noted("-o a.png --scene 7"), scenes);
    for command in ["info", "graph"] {
        let outcome = run(luxel(folder.path()).arg(command).arg(&scene).args(["--scene", "7", "--json"]));
        json(&outcome.stdout);
        assert_eq!(outcome.stderr, scenes, "{command}");
    }
    assert_eq!(noted("-o a.png --tone-map agx --exposure 1 --aov ids --sphere-accel bvh"), "");
    let mut command = luxel(folder.path());
    command.arg("render").arg(asset("empty.ron")).args(SMALL).args(["--backend", "cpu"]);
    let outcome = run(command.args(["--sphere-accel", "bvh"]));
    assert_eq!(outcome.stderr, "note: --sphere-accel has no effect: the scene has no spheres\n");
}

#[test]
fn every_example_scene_makes_a_picture() {
    let folder = tempfile::tempdir().unwrap();
    let files = ["", "furnace"].map(|below| std::fs::read_dir(asset(below)).unwrap());
    let scenes = files.into_iter().flatten().map(|entry| entry.unwrap().path());
    let scenes: Vec<_> =
        scenes.filter(|path| path.extension().is_some_and(|ending| ending == "ron")).collect();
    assert!(scenes.len() >= 10, "{scenes:?}");
    for scene in scenes {
        let mut command = luxel(folder.path());
        command.arg("render").arg(&scene).args([
            "--size",
            "16x9",
            "--spp",
            "1",
            "--backend",
            "cpu",
            "-o",
            "out.png",
        ]);
        let outcome = run(&mut command);
        assert_eq!((outcome.code, outcome.stderr.as_str()), (Some(0), ""), "{}", scene.display());
        image::open(folder.path().join("out.png")).unwrap();
    }
}

#[test]
fn the_structure_over_the_spheres_is_chosen_named_and_changes_no_picture() {
    let folder = tempfile::tempdir().unwrap();
    let scene = asset("hundred_spheres.ron");
    let ask = |command: &str, more: &[&str]| run(luxel(folder.path()).arg(command).arg(&scene).args(more));
    let picture = |accel: &str| {
        let small = ["--size", "64x36", "--quality", "low", "--backend", "cpu", "-o", "out.png", "--json"];
        let outcome = ask("render", &[&small[..], &["--sphere-accel", accel]].concat());
        assert_eq!(outcome.code, Some(0), "{}", outcome.stderr);
        assert_eq!(
            outcome.stderr.contains("note: octree-seed ends a ray"),
            accel == "octree-seed",
            "{}",
            outcome.stderr
        );
        let answer = json(&outcome.stdout);
        let facts = &answer["sphere_accel"];
        let expected = if accel == "auto" { facts["name"].as_str().unwrap() } else { accel };
        assert_eq!((facts["name"].as_str(), &answer["spp"]), (Some(expected), &4.into()));
        assert!(facts["nodes"].as_u64().unwrap() > 0 && facts["depth"].is_u64() && facts["cut_off"] == false);
        assert!(!facts["because"].as_str().unwrap().is_empty());
        let settings = png_text(&folder.path().join("out.png"), "luxel.settings");
        assert!(settings.contains("max_depth: 4"), "{settings}");
        image::open(folder.path().join("out.png")).unwrap().into_rgb8().into_raw()
    };
    let naive = picture("naive");
    for accel in ["octree-base", "octree", "bvh", "auto"] {
        assert_eq!(picture(accel), naive, "{accel}");
    }
    picture("octree-seed");
    let info = ask("info", &[]).succeeded();
    assert!(info.contains("because it is estimated to do the least work per ray"), "{info}");
    let info = json(&ask("info", &["--sphere-accel", "bvh", "--json"]).succeeded());
    assert_eq!(info["sphere_accel"]["name"], "bvh");
    let seed = ask("info", &["--sphere-accel", "octree-seed"]).succeeded();
    assert!(seed.contains("its pictures may be wrong"), "{seed}");
    let graph = ask("graph", &["--sphere-accel", "naive"]).succeeded();
    assert!(graph.contains("spheres are found by naive, because it was asked for"), "{graph}");
}

#[test]
fn exposure_and_curve_reach_picture_and_metadata() {
    let folder = tempfile::tempdir().unwrap();
    let brightness = |stops: &str| {
        render(
            folder.path(),
            &["--backend", "cpu", "-o", "out.png", "--exposure", stops, "--tone-map", "aces"],
        );
        let picture = image::open(folder.path().join("out.png")).unwrap().into_rgb8();
        picture.into_raw().iter().map(|byte| u64::from(*byte)).sum::<u64>()
    };
    let (dark, bright) = (brightness("-2"), brightness("1"));
    assert!(dark * 3 < bright * 2, "{dark} {bright}");
    let settings = png_text(&folder.path().join("out.png"), "luxel.settings");
    assert!(settings.contains("exposure: 1.0") && settings.contains("Aces"), "{settings}");
}

#[test]
fn a_render_stops_by_time_or_by_error() {
    let folder = tempfile::tempdir().unwrap();
    let scene = asset("one_of_each.ron");
    let stopped = |limit: [&str; 2]| {
        let mut command = luxel(folder.path());
        command.arg("render").arg(&scene).args(["--size", "16x9", "--backend", "cpu", "--json"]).args(limit);
        json(&run(&mut command).succeeded())
    };
    assert_eq!(stopped(["--time", "0.3"])["stopped_by"], "seconds");
    let by_error = stopped(["--error", "30%"]);
    assert_eq!(by_error["stopped_by"], "error");
    assert!(by_error["error"].as_f64().unwrap() <= 0.3 && by_error["spp"].as_u64().unwrap() >= 32);
}

#[test]
fn a_scene_can_be_seen_through_another_camera() {
    let folder = tempfile::tempdir().unwrap();
    let more = ["--backend", "cpu", "--camera", "camera", "-o", "named.png"];
    render(folder.path(), &more);
    assert!(folder.path().join("named.png").is_file());
}

#[test]
fn info_tells_counts_memory_and_features() {
    let folder = tempfile::tempdir().unwrap();
    let ask = |more: &[&str]| {
        run(luxel(folder.path()).arg("info").arg(asset("one_of_each.ron")).args(more)).succeeded()
    };
    let text = ask(&[]);
    for part in
        ["1 sphere\n", "80 triangles", "1 voxel volume\n", "TLAS depth", "total", "left out", "dropped: none"]
    {
        assert!(text.contains(part), "no '{part}' in {text}");
    }
    let info = json(&ask(&["--json"]));
    assert_eq!((&info["baked"]["spheres"], &info["baked"]["instanced_triangles"]), (&1.into(), &80.into()));
    let features = info["features"].as_array().unwrap();
    let used = |name: &str| features.iter().find(|feature| feature["name"] == name).unwrap()["used"].clone();
    assert_eq!((used("voxels"), used("aovs")), (true.into(), false.into()));
    assert!(features.iter().all(|feature| !feature["because"].as_str().unwrap().is_empty()));
}

#[test]
fn graph_shows_passes_and_first_hits_only_on_demand() {
    let folder = tempfile::tempdir().unwrap();
    let ask = |more: &[&str]| {
        run(luxel(folder.path()).arg("graph").arg(asset("one_of_each.ron")).args(more)).succeeded()
    };
    let text = ask(&[]);
    assert!(text.lines().all(|line| line.contains(" because ")) && text.contains("accumulate"), "{text}");
    let first_hits = |more: &[&str]| {
        let answer = json(&ask(more));
        let nodes = answer["nodes"].as_array().unwrap().clone();
        nodes.into_iter().find(|node| node["name"] == "first_hits").unwrap()["runs"].clone()
    };
    assert_eq!((first_hits(&["--json"]), first_hits(&["--json", "--aov"])), (false.into(), true.into()));
}

#[test]
fn compare_measures_and_judges() {
    let folder = tempfile::tempdir().unwrap();
    for (name, seed) in [("a.exr", "1"), ("b.exr", "2")] {
        render(folder.path(), &["--backend", "cpu", "-o", name, "--seed", seed]);
    }
    let compare = |args: &[&str]| run(luxel(folder.path()).arg("compare").args(args));
    let equal =
        json(&compare(&["a.exr", "a.exr", "--json", "--max-flip", "0", "--min-psnr", "99"]).succeeded());
    assert_eq!((&equal["rmse"], &equal["psnr_db"]), (&0.0.into(), &Value::Null));
    let text = compare(&["a.exr", "b.exr"]).succeeded();
    for metric in ["RMSE", "relMSE", "PSNR", "SSIM", "FLIP"] {
        assert!(text.contains(metric), "{text}");
    }
    for limit in
        [["--max-rmse", "1e-6"], ["--max-relmse", "0"], ["--min-psnr", "90"], ["--min-ssim", "0.9999"]]
    {
        let outcome = compare(&[&["a.exr", "b.exr", "--json"], limit.as_slice()].concat());
        assert_eq!(outcome.code, Some(1), "{limit:?}");
        assert_eq!(json(&outcome.stdout)["failed"].as_array().unwrap().len(), 1);
    }
}

#[test]
fn a_limit_on_a_metric_that_does_not_exist_fails() {
    let folder = tempfile::tempdir().unwrap();
    render(folder.path(), &["--backend", "cpu", "-o", "a.png"]);
    let outcome = run(luxel(folder.path()).args(["compare", "a.png", "a.png", "--max-relmse", "1"]));
    assert_eq!(outcome.code, Some(1));
    assert!(outcome.stdout.contains("FAILED"), "{}", outcome.stdout);
}

#[test]
fn doctor_says_what_would_be_used() {
    let folder = tempfile::tempdir().unwrap();
    let text = run(luxel(folder.path()).arg("doctor")).succeeded();
    assert!(text.contains("auto") && text.contains("because"), "{text}");
    let answer = json(&run(luxel(folder.path()).args(["doctor", "--json"])).succeeded());
    assert!(answer["threads"].as_u64().unwrap() > 0 && answer["adapters"].is_array());
    assert!(["cpu", "gpu"].contains(&answer["backend"].as_str().unwrap()));
}

#[test]
fn help_is_complete() {
    let folder = tempfile::tempdir().unwrap();
    let help = run(luxel(folder.path()).arg("--help")).succeeded();
    for part in ["render", "info", "graph", "compare", "doctor", "showcase.png", "Exit codes:", "LUXEL_LOG"] {
        assert!(help.contains(part), "no '{part}' in {help}");
    }
    let render = run(luxel(folder.path()).args(["render", "--help"])).succeeded();
    assert!(render.contains("Ctrl-C") && render.contains("Examples:"), "{render}");
}

#[test]
fn a_log_filter_that_is_none_is_told_once_and_log_lines_in_a_pipe_have_no_colours() {
    let folder = tempfile::tempdir().unwrap();
    let logged = |filter: &str, arguments: &[&str]| {
        let outcome = run(luxel(folder.path()).env("LUXEL_LOG", filter).args(arguments));
        assert_eq!(outcome.code, Some(0), "{}", outcome.stderr);
        outcome.stderr
    };
    let scene = asset("empty.ron");
    let info = ["info", scene.to_str().unwrap()];
    assert_eq!(logged("[[[", &info), "note: LUXEL_LOG '[[[' is ignored: invalid filter directive\n");
    assert_eq!((logged("", &info), logged("debug", &info)), (String::new(), String::new()));
    if luxel_gpu::testing::gpu_or_fail().is_some() {
        let line = logged("luxel_gpu=info", &["doctor"]);
        assert!(line.contains("INFO luxel_gpu") && !line.contains('\u{1b}'), "{line}");
    }
}

/// Starts the program, asks it to stop as Ctrl-C does, insists on success soon after, and gives stdout.
#[cfg(unix)]
fn interrupted(command: &mut Command) -> String {
    let child = command.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
    // Listening begins before the scene is read; this is plenty even on a busy machine.
    std::thread::sleep(Duration::from_millis(1500));
    let killed = Command::new("kill").args(["-INT", &child.id().to_string()]).status().unwrap();
    assert!(killed.success());
    let asked = Instant::now();
    let output = child.wait_with_output().unwrap();
    let stderr = String::from_utf8(output.stderr).unwrap();
    assert_eq!(output.status.code(), Some(0), "{stderr}");
    assert!(asked.elapsed() < Duration::from_secs(20), "it went on for {:?}", asked.elapsed());
    assert!(stderr.contains("note: interrupted"), "{stderr}");
    String::from_utf8(output.stdout).unwrap()
}

#[cfg(unix)]
#[test]
fn an_interrupted_render_writes_what_there_is() {
    let folder = tempfile::tempdir().unwrap();
    let mut command = luxel(folder.path());
    command.arg("render").arg(asset("one_of_each.ron")).args(["--backend", "cpu", "-o", "out.png", "--json"]);
    let answer = interrupted(command.args(["--size", "320x180", "--spp", "1000000"]));
    assert_eq!(json(&answer)["stopped_by"], "interrupted");
    let picture = image::open(folder.path().join("out.png")).unwrap().into_rgb8();
    assert_eq!((picture.width(), picture.height()), (320, 180));
    assert_eq!(front_door::names(folder.path()), ["out.png"]);
}

#[cfg(unix)]
#[test]
fn without_a_command_the_showcase_is_rendered_from_any_folder() {
    let folder = tempfile::tempdir().unwrap();
    let line = interrupted(&mut luxel(folder.path()));
    assert!(line.starts_with("wrote showcase.png: 960x540"), "{line}");
    assert_eq!(front_door::names(folder.path()), ["showcase.png"]);
}

#[cfg(unix)]
#[test]
fn a_reader_that_goes_away_is_no_error() {
    let folder = tempfile::tempdir().unwrap();
    let mut command = luxel(folder.path());
    command
        .args(["info", "--json"])
        .arg(asset("one_of_each.ron"))
        .stdout(Stdio::piped())
        .stderr(Stdio::piped());
    let mut child = command.spawn().unwrap();
    drop(child.stdout.take());
    let output = child.wait_with_output().unwrap();
    assert_eq!(output.status.code(), Some(0));
    assert_eq!(String::from_utf8(output.stderr).unwrap(), "");
}

#[cfg(target_os = "linux")]
#[test]
fn file_names_need_not_be_text() {
    use std::ffi::OsStr;
    use std::os::unix::ffi::OsStrExt;
    let folder = tempfile::tempdir().unwrap();
    let scene = folder.path().join(OsStr::from_bytes(b"sc\xffne.ron"));
    std::fs::copy(asset("one_of_each.ron"), &scene).unwrap();
    run(luxel(folder.path()).arg("render").arg(&scene).args(SMALL).args(["--backend", "cpu", "--json"]))
        .succeeded();
    assert!(folder.path().join(OsStr::from_bytes(b"sc\xffne.png")).is_file());
}

#[test]
fn cameras_of_one_name_are_told_apart_by_number_and_no_name_steers_the_terminal() {
    let folder = tempfile::tempdir().unwrap();
    let model = r#"{"asset": {"version": "2.0"},
        "cameras": [{"type": "perspective", "perspective": {"yfov": 0.5, "znear": 0.1}}],
        "nodes": [{"name": "eye", "camera": 0}, {"name": "eye", "camera": 0}, {"name": "\u001b[2J", "camera": 0}],
        "scenes": [{"nodes": [0, 1, 2]}]}"#;
    std::fs::write(folder.path().join("a.gltf"), model).unwrap();
    let text = run(luxel(folder.path()).args(["info", "a.gltf", "--mesh-accel", "naive"])).succeeded();
    assert!(text.contains("cameras\n  0 'eye'\n  1 'eye'\n  2 '\\u{1b}[2J'\n"), "{text}");
    assert!(text.contains("0 spheres\n") && !text.contains('\u{1b}'), "{text}");
    let render = |camera: &str| {
        let mut command = luxel(folder.path());
        run(command.args(["render", "a.gltf", "--backend", "cpu", "--camera", camera]).args(SMALL))
    };
    for camera in ["eye", "1"] {
        assert_eq!(render(camera).code, Some(0), "{camera}");
    }
    let stderr = render("3").stderr;
    assert!(stderr.contains("(there is 0 'eye', 1 'eye', 2 '\\u{1b}[2J')"), "{stderr}");
}

#[test]
fn info_lists_the_scenes_of_a_file_that_may_have_several() {
    let folder = tempfile::tempdir().unwrap();
    let model = r#"{"asset": {"version": "2.0"}, "scene": 1, "nodes": [{}],
        "scenes": [{"nodes": [0], "name": "day"}, {"nodes": [0], "name": "night\u001b"}, {"nodes": [0]}]}"#;
    std::fs::write(folder.path().join("a.gltf"), model).unwrap();
    let info = |more: &[&str]| run(luxel(folder.path()).args(["info", "a.gltf"]).args(more)).succeeded();
    let text = info(&[]);
    let listed = "scenes\n  0 'day'\n  1 'night\\u{1b}' (default, shown)\n  2 ''\ncameras";
    assert!(text.contains(listed), "{text}");
    let text = info(&["--scene", "2"]);
    assert!(text.contains("1 'night\\u{1b}' (default)\n  2 '' (shown)\n"), "{text}");
    let scenes = json(&info(&["--json"]))["scenes"].clone();
    assert_eq!(scenes[0], serde_json::json!({"name": "day", "is_default": false, "is_shown": false}));
    assert_eq!((&scenes[1]["is_shown"], &scenes[2]["name"]), (&true.into(), &Value::Null));
    let other = run(luxel(folder.path()).arg("info").arg(asset("empty.ron"))).succeeded();
    assert!(!other.contains("scenes\n"), "a scene file is one scene: {other}");
}
