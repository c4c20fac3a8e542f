//! The BVH study: the smallest plan that has every figure, measured, and made again from its records.
use std::ops::ControlFlow;
use std::path::Path;
use std::sync::LazyLock;

use luxel_engine::BackendChoice;
use luxel_study::bvh::{self, BunnyModel, Plan, Run, Studied, Sweep};
use luxel_study::{Origin, StudyEvent};
use tempfile::TempDir;

use crate::front_door::{luxel, names, run};
use crate::page::{check_page, refused};

/// Figures of the report's results, then those that it lacks.
const FIRST: u32 = 6;
const REPORTS: u32 = 14;
const ALL: u32 = 24;

/// The study that the tests look at, on both backends, or on the CPU where there is no GPU.
static STUDY: LazyLock<(TempDir, Studied)> = LazyLock::new(|| {
    let folder = tempfile::tempdir().unwrap();
    let plan = Plan::tiny(&[BackendChoice::Cpu, BackendChoice::Gpu], &BunnyModel::Rabbit);
    let origin = Origin::now(Some("test".to_owned()));
    let out = folder.path().join("out");
    let studied = bvh::run(&plan, &origin, &out, &mut |_| ControlFlow::Continue(())).unwrap();
    (folder, studied)
});

fn of(sweep: Sweep) -> Vec<&'static Run> {
    STUDY.1.runs.iter().filter(|run| run.sweep == sweep).collect()
}

#[test]
fn every_figure_has_its_verdict_and_the_page_can_be_made_again() {
    let (folder, studied) = &*STUDY;
    let (out, again) = (folder.path().join("out"), folder.path().join("again"));
    assert!(studied.is_complete);
    assert_eq!(names(&out), ["bvh.html", "runs.csv", "runs.jsonl"]);
    assert!(bvh::read_runs(&out.join("runs.jsonl")).unwrap() == studied.runs);
    let table = std::fs::read_to_string(out.join("runs.csv")).unwrap();
    assert_eq!(table.lines().count(), studied.runs.len() + 1);
    let page = std::fs::read_to_string(out.join("bvh.html")).unwrap();
    if luxel_gpu::testing::gpu_or_fail().is_some() {
        check_page(&page, FIRST..=ALL, REPORTS, &["<svg", "<img", "<table"]);
    }
    let from = ["study", "bvh", "--from", "out/runs.jsonl", "--out", "again"];
    run(luxel(folder.path()).args(from)).succeeded();
    for name in ["bvh.html", "runs.csv"] {
        let read = |folder: &Path| std::fs::read(folder.join(name)).unwrap();
        assert!(read(&out) == read(&again), "{name}");
    }
}

#[test]
fn runs_say_what_was_measured() {
    for run in of(Sweep::Counts) {
        assert!(run.tests_per_ray <= f64::from(run.triangles) && run.build_secs > 0.0, "{run:?}");
        if run.structure == "naive" {
            assert!(run.tests_per_ray > 0.2 * f64::from(run.triangles), "{run:?}");
        } else if run.triangles > 1000 {
            assert!(run.tests_per_ray < 0.1 * f64::from(run.triangles), "{run:?}");
        }
    }
    for run in of(Sweep::Bunny) {
        assert!(run.triangles >= 69_620 && run.nodes > 10_000 && run.sah_cost > 1.0, "{run:?}");
    }
    let lost = of(Sweep::Lost);
    assert!(lost.iter().all(|run| run.lost_pixels.is_some() == (run.structure != "naive")));
    assert!(lost.iter().all(|run| run.lost_pixels.is_none_or(|lost| lost == 0)), "triangles are lost");
    assert!(of(Sweep::PointLights).iter().all(|run| run.shadow_rays > 0.0));
    let half = of(Sweep::Floor).into_iter().find(|run| run.variant == "half").unwrap();
    assert!(half.semi_specular_bounces > 0.0 && half.picture_png.is_some());
    let levels = of(Sweep::Levels);
    assert!(levels.windows(2).all(|pair| pair[0].triangles == pair[1].triangles));
    for level in ["one", "two"] {
        let split =
            |split: &str| levels.iter().find(|run| run.levels == level && run.split == split).unwrap();
        assert_ne!(split("sah").sah_cost, split("largest-axis").sah_cost);
    }
}

#[test]
fn a_stopped_study_keeps_what_it_has() {
    let folder = tempfile::tempdir().unwrap();
    let mut seen = 0;
    let mut observer = |event: &StudyEvent| {
        seen += usize::from(matches!(event, StudyEvent::Progress(_)));
        if seen > 3 { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    };
    let plan = Plan::tiny(&[BackendChoice::Cpu], &BunnyModel::Rabbit);
    let studied = bvh::run(&plan, &Origin::now(None), folder.path(), &mut observer).unwrap();
    assert!(!studied.is_complete && !studied.runs.is_empty());
    let page = std::fs::read_to_string(folder.path().join("bvh.html")).unwrap();
    assert!(page.contains("not measured") && page.contains("id=\"fig-24\"") && page.contains("Incomplete"));
}

/// The heights of boxes, cameras and windows are all nothing.
#[test]
fn a_flat_model_is_studied_like_any_other() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("flat.obj");
    std::fs::write(&path, "v 0 0 0\nv 1 0 0\nv 0 0 1\nf 1 2 3\n").unwrap();
    let plan = Plan::tiny(&[BackendChoice::Cpu], &BunnyModel::from_file(&path).unwrap());
    let out = folder.path().join("out");
    let studied = bvh::run(&plan, &Origin::now(None), &out, &mut |_| ControlFlow::Continue(())).unwrap();
    assert!(studied.is_complete && studied.runs.iter().any(|run| run.model == "flat.obj"));
}

#[test]
fn bad_input_is_one_line() {
    let folder = tempfile::tempdir().unwrap();
    let bvh = |rest: &[&str]| run(luxel(folder.path()).args(["study", "bvh"]).args(rest));
    std::fs::write(folder.path().join("duck.txt"), "v 0 0 0\n").unwrap();
    for (file, reason) in [("none.obj", "cannot be read"), ("duck.txt", ".obj, .ply, .gltf, .glb")] {
        let error = refused(bvh(&[file, "--quick", "--out", "out"]), 2);
        assert!(error.contains(file) && error.contains(reason), "{error}");
        assert!(!folder.path().join("out").exists(), "a refused file leaves a folder");
    }
    std::fs::write(folder.path().join("runs.jsonl"), "{\"study\":\"octree\"}\n").unwrap();
    let error = refused(bvh(&["--from", "runs.jsonl", "--out", "again"]), 2);
    assert!(error.contains("runs.jsonl:1: study 'octree': not of this study"), "{error}");
    std::fs::create_dir(folder.path().join("sales")).unwrap();
    std::fs::write(folder.path().join("sales/bvh.html"), "sales").unwrap();
    let error = refused(bvh(&["--quick", "--out", "sales"]), 2);
    assert!(error.contains("bvh.html was not made by a BVH study"), "{error}");
    let error = refused(bvh(&["a.obj", "--from", "runs.jsonl"]), 2);
    assert!(error.contains("cannot be used with"), "{error}");
}
