//! The one table of the hard cases: how large each is in the normal run and in the soak run, and where it is tested.
use std::fmt;
use std::path::Path;
use std::time::Instant;

/// A hard case.
pub(crate) struct Row {
    /// Its name in robustness.md.
    pub(crate) id: &'static str,
    /// Size in the normal test run.
    ci: u64,
    /// Size in the soak run.
    soak: u64,
    /// What is counted.
    unit: &'static str,
    /// Files that test it, from the root of the project.
    places: &'static [&'static str],
}

const fn row(
    id: &'static str,
    ci: u64,
    soak: u64,
    unit: &'static str,
    places: &'static [&'static str],
) -> Row {
    Row { id, ci, soak, unit, places }
}

const RAYS: &str = "tests/hard_cases/rays.rs";
const EXACT: &str = "tests/hard_cases/exact.rs";
const ODD: &str = "tests/hard_cases/odd.rs";
const SAME: &str = "tests/hard_cases/invariance.rs";
const BVH: &str = "tests/hard_cases/bvh.rs";
const INSTANCES: &str = "tests/hard_cases/instances.rs";
const EDITS: &str = "tests/hard_cases/edits.rs";
const SPAWN: &str = "tests/hard_cases/spawn.rs";
const FLY: &str = "tests/hard_cases/fly.rs";
const GPU: &str = "tests/hard_cases/gpu.rs";
const KERNEL: &str = "crates/luxel_geom/tests/triangle.rs";
const BOX_KERNEL: &str = "crates/luxel_geom/tests/aabb.rs";
const ORACLE: &str = "crates/luxel_cpu/tests/bvh_oracle.rs";
const MIXED: &str = "crates/luxel_cpu/tests/mixed_oracle.rs";
const BUILDER: &str = "crates/luxel_accel/tests/bvh.rs";

/// Every case of the list.
#[rustfmt::skip]
pub(crate) const ROWS: [Row; 77] = [
    row("T01", 1_000_000, 100_000_000, "rays, on each backend; on the GPU 10,000,000 at most", &[RAYS, GPU, KERNEL, "tests/parity/watertight.rs"]),
    row("T02", 1_000_000, 100_000_000, "rays, on each backend; on the GPU 10,000,000 at most", &[RAYS, GPU, KERNEL, "tests/parity/watertight.rs"]),
    row("T03", 1_000_000, 100_000_000, "rays, on each backend; on the GPU 10,000,000 at most", &[RAYS, GPU, KERNEL]),
    row("T04", 20_000, 2_073_600, "pixels of each mesh, and as many of the ear window at most", &[RAYS]),
    row("T05", 1_000_000, 10_000_000, "rays", &[ODD, ORACLE]),
    row("T06", 12, 32, "cubes along an edge of the grid; 26 rays of both zeros through each point", &[EXACT, ORACLE, BOX_KERNEL]),
    row("T07", 1_000_000, 1_000_000, "rays", &[BOX_KERNEL]),
    row("T08", 100_000, 1_000_000, "rays", &[ODD, BOX_KERNEL]),
    row("T09", 100_000, 1_000_000, "rays", &[ODD]),
    row("T10", 100_000, 1_000_000, "rays", &[ODD, ORACLE]),
    row("T11", 20_000, 20_000, "rays", &[KERNEL, ORACLE]),
    row("T12", 100, 100, "shuffles", &[ORACLE, KERNEL]),
    row("T13", 100_000, 100_000, "rays", &[KERNEL]),
    row("T14", 60_000, 60_000, "rays", &[KERNEL, ORACLE]),
    row("T15", 500, 10_000, "meshes of 255 triangles", &[ODD]),
    row("T16", 1_000_000, 10_000_000, "rays", &[RAYS]),
    row("T17", 256, 1024, "vertices along an edge of the height field; four rays for each cell", &[EXACT]),
    row("T18", 1_000_000, 100_000_000, "rays and back", &[SPAWN]),
    row("T19", 20_000, 1_000_000, "rays at each scale and turn; on the GPU 100,000 at most", &[SAME, GPU, ORACLE]),
    row("T20", 1_000_000, 10_000_000, "rays", &[RAYS]),
    row("T21", 1_000_000, 10_000_000, "rays", &[EXACT]),
    row("T22", 1_000_000, 10_000_000, "rays; distances within roundings of the plane, not 2⁻¹²", &[EXACT]),
    row("B01", 33, 33, "numbers of triangles", &[ORACLE, BUILDER]),
    row("B02", 100_000, 100_000, "triangles", &[BUILDER, ORACLE]),
    row("B03", 10_000, 10_000, "spheres", &[BUILDER, "crates/luxel_cpu/tests/cloud_oracle.rs"]),
    row("B04", 10_000, 10_000, "boxes", &[BUILDER, ORACLE]),
    row("B05", 10_000, 10_000, "boxes", &[BUILDER, ORACLE]),
    row("B06", 121, 121, "boxes", &[BUILDER, "crates/luxel_cpu/tests/deep_trees.rs"]),
    row("B07", 1_000, 1_000, "boxes", &[BUILDER]),
    row("B08", 10_000, 10_000, "quads", &[BUILDER, ORACLE]),
    row("B09", 70_000, 1_000_000, "triangles of the small object", &[BVH]),
    row("B10", 2_000, 100_000, "rays at 10,000 sticks", &[BVH]),
    row("B11", 1_000, 1_000, "triangles", &[ORACLE]),
    row("B12", 1_000_000, 50_000_000, "rays over all scenes and trees", &[BVH]),
    row("B13", 10_000, 100_000, "triangles of each shape under each preset", &[BVH, BUILDER]),
    row("B14", 3_000, 10_000, "flipped bits", &[BVH]),
    row("I01", 10_000, 10_000, "rays for each of 8 transforms", &[MIXED]),
    row("I02", 3_000, 3_000, "rays", &[MIXED, "crates/luxel_bake/tests/robust.rs"]),
    row("I03", 5_000, 1_000_000, "instances", &[INSTANCES]),
    row("I04", 5, 5, "files", &[INSTANCES, "crates/luxel_scene/tests/scene_errors.rs", "crates/luxel_bake/tests/robust.rs"]),
    row("E01", 100_000, 1_000_000, "rays after 10,000 edits, and a fiftieth and a hundredth of them after every hundred", &["tests/edit_loop/main.rs", "tests/edit_loop/upkeep.rs", "crates/luxel_accel/tests/quality.rs"]),
    row("E03", 1_000, 1_000, "moves there and back", &[EDITS]),
    row("E04", 20_000, 1_000_000, "rays", &[EDITS]),
    row("F01", 1_000_000, 100_000_000, "starts", &[SPAWN, KERNEL]),
    row("F02", 200_000, 10_000_000, "shadow rays", &[SPAWN]),
    row("F03", 1_000_000, 100_000_000, "starts beside edges", &[SPAWN]),
    row("F04", 2_000_000, 200_000_000, "bounces", &[SPAWN]),
    row("F05", 200_000, 20_000_000, "starts", &[SPAWN]),
    row("X02", 20_000, 1_000_000, "pixels", &[FLY]),
    row("L01", 18, 18, "rooms by wall and albedo; 17 depths of nine of them", &["tests/furnace/walls.rs", "tests/lights/closed_forms.rs"]),
    row("L02", 276, 276, "closures at a roughness, each under six angles, those that light passes from inside as well", &["crates/luxel_cpu/tests/bsdf/furnace.rs", "crates/luxel_geom/tests/albedo.rs"]),
    row("L03", 21, 21, "stacks of slabs by angle, 65,536 paths each; five balls in balls", &["tests/furnace/nested.rs", "crates/luxel_cpu/tests/bsdf/glass.rs"]),
    row("L04", 2_000, 2_000, "steps of 1e-6 rad over the critical angle; a cube from inside", &["crates/luxel_geom/tests/optics.rs", "tests/furnace/glass.rs", "crates/luxel_cpu/tests/bsdf/glass.rs"]),
    row("L05", 1_000_000, 1_000_000, "cosines over ten indices", &["crates/luxel_geom/tests/optics.rs", "crates/luxel_geom/tests/schlick.rs"]),
    row("L06", 20_000, 1_000_000, "pairs of directions for each closure", &["crates/luxel_cpu/tests/bsdf/reciprocity.rs", "crates/luxel_geom/tests/microfacet.rs"]),
    row("L07", 16_384, 16_384, "samples for each of 250 combinations of closure, width and angle, four times as many for 16 that end at the critical angle", &["crates/luxel_cpu/tests/bsdf/densities.rs", "crates/luxel_cpu/tests/camera.rs", "crates/luxel_cpu/tests/choices.rs", "crates/luxel_geom/tests/microfacet.rs", "crates/luxel_geom/tests/sampling.rs", "crates/luxel_geom/tests/emitter.rs", "tests/lights/picks.rs"]),
    row("L08", 30, 30, "views of every closure, at 250 triples of numbers, in the soak run as well; weights within a bound that follows from how lobes are chosen", &["crates/luxel_cpu/tests/bsdf/extremes.rs", "crates/luxel_cpu/tests/bsdf/bounds.rs", "crates/luxel_geom/tests/microfacet.rs", "crates/luxel_geom/tests/normal_guard.rs"]),
    row("L09", 125, 125, "corners of the unit cube for every sampler", &["crates/luxel_cpu/tests/bsdf/extremes.rs", "crates/luxel_geom/tests/sampling.rs", "crates/luxel_geom/tests/emitter.rs", "crates/luxel_geom/tests/microfacet.rs"]),
    row("L10", 10_000_000, 100_000_000, "normals", &["crates/luxel_geom/tests/sampling.rs"]),
    row("L11", 7, 7, "scenes, 32 batches by each of three estimators, of 16 times the samples in the soak run", &["tests/lights/estimators.rs"]),
    row("L12", 1, 16, "times the samples, for each of eight spheres and their neighbours", &["tests/lights/closed_forms.rs", "crates/luxel_geom/tests/emitter.rs"]),
    row("L13", 7, 7, "scenes", &["tests/furnace/walls.rs", "tests/lights/estimators.rs"]),
    row("L14", 2_048, 65_536, "samples per pixel at most, from 64; 32 pictures of five scenes", &["tests/samples/slope.rs"]),
    row("L15", 65_536, 65_536, "pixels that are compared with their neighbours; five scenes in halves", &["tests/samples/seeds.rs", "crates/luxel_geom/tests/rng.rs"]),
    row("L16", 1 << 26, 1 << 26, "samples", &["crates/luxel_film/src/accumulate/tests.rs"]),
    row("L17", 4_096, 4_096, "counts", &["crates/luxel_film/src/accumulate/tests.rs"]),
    row("L18", 8, 8, "numbers that are none, five of them on each backend", &["tests/samples/poison.rs", "crates/luxel_film/src/accumulate/tests.rs"]),
    row("L19", 2_000, 2_000, "samples of each map for its densities; a chi-squared test of each", &["crates/luxel_geom/tests/environment.rs"]),
    // There is no clamp, so that none of its bias can be hidden: the brightest samples count like all others.
    row("L20", 1 << 26, 1 << 26, "samples with fireflies", &["crates/luxel_film/src/accumulate/tests.rs"]),
    row("G01", 10_000_000, 10_000_000, "values", &["tests/parity/integers.rs"]),
    row("G02", 1 << 20, 1 << 20, "calls of each function", &["tests/parity/main.rs"]),
    row("G03", 5, 5, "scenes", &["tests/backends_agree/first_hits.rs", "tests/spheres_gpu/compare.rs"]),
    row("G04", 5, 5, "scenes", &["tests/spheres_gpu/compare.rs", GPU]),
    row("G05", 1, 1, "scene", &["tests/backends_agree/tile_means.rs"]),
    row("G06", 1, 1, "scene", &["tests/backends_agree/slices.rs"]),
    row("G07", 65_536, 65_536, "rays", &["crates/luxel_render/src/watertight.rs"]),
    row("G08", 1, 1, "adapter at hand", &[GPU]),
];

/// True in the soak run (`cargo xtask soak`).
pub(crate) fn is_soak() -> bool {
    std::env::var("LUXEL_SOAK").is_ok_and(|soak| soak == "1")
}

/// A case under way.
pub(crate) struct Case {
    row: &'static Row,
    started: Instant,
}

impl Case {
    /// Begins a case. Part of it may be tested here and part elsewhere.
    pub(crate) fn begin(id: &str) -> Self {
        let row = ROWS.iter().find(|row| row.id == id).unwrap();
        Self { row, started: Instant::now() }
    }

    /// Its size in this run.
    pub(crate) fn size(&self) -> u64 {
        if is_soak() { self.row.soak } else { self.row.ci }
    }

    /// Ends it with one line, which `cargo xtask soak` collects.
    pub(crate) fn end(self, what: impl fmt::Display) {
        println!("HARD-CASE {} | {what} | {:.1} s", self.row.id, self.started.elapsed().as_secs_f64());
    }
}

/// The list of the issue.
fn wanted() -> Vec<String> {
    let group = |letter: char, last: u32| (1..=last).map(move |i| format!("{letter}{i:02}"));
    let some = ["E01", "E03", "E04", "X02"].map(str::to_owned);
    let groups = [('T', 22), ('B', 14), ('I', 4), ('F', 5), ('L', 20), ('G', 6)];
    groups.into_iter().flat_map(|(letter, last)| group(letter, last)).chain(some).collect()
}

#[test]
fn every_case_has_a_row_and_every_row_one_case() {
    for id in wanted() {
        assert_eq!(ROWS.iter().filter(|row| row.id == id).count(), 1, "{id}");
    }
}

/// The number of the case that a text begins with, and what follows.
fn number_of<'a>(text: &'a str, letter: &str) -> Option<(u32, &'a str)> {
    let digits = text.strip_prefix(letter)?;
    let (number, rest) = digits.split_at_checked(2)?;
    Some((number.parse().ok()?, rest))
}

/// Does a file speak of a case: by its name, or as part of a range of names (`T01–T03`)?
fn speaks_of(text: &str, id: &str) -> bool {
    let (letter, number) = id.split_at(1);
    let number: u32 = number.parse().unwrap();
    let in_range = |(at, _): (usize, &str)| {
        let range = number_of(&text[at..], letter);
        let range =
            range.and_then(|(first, rest)| Some(first..=number_of(rest.strip_prefix('–')?, letter)?.0));
        range.is_some_and(|range| range.contains(&number))
    };
    text.contains(id) || text.contains(&id.to_lowercase()) || text.match_indices(letter).any(in_range)
}

#[test]
fn every_place_is_a_file_that_speaks_of_its_case() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    for row in &ROWS {
        for place in row.places {
            let text = std::fs::read_to_string(root.join(place)).unwrap_or_default();
            assert!(speaks_of(&text, row.id), "{}: {place}", row.id);
        }
        assert!(!row.places.is_empty() && !row.unit.is_empty() && row.ci > 0, "{}", row.id);
    }
}

#[test]
fn a_file_that_does_not_speak_of_a_case_is_found() {
    assert!(speaks_of("fn t05_axis_rays", "T05") && speaks_of("over B01–B05, B08", "B03"));
    assert!(!speaks_of("over B01–B05, B08", "B06") && !speaks_of("T01, T03", "T02"));
}
