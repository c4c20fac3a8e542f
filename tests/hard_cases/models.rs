//! Models from the shared data beside the working copy.
use std::path::Path;

use luxel_scene::{MeshAsset, MeshSource};
use luxel_testkit::TestMesh;

/// The Stanford bunny. Where it is missing the test is left out and counted, except under CI.
pub(crate) fn bunny() -> Option<TestMesh> {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../shared/data/meshes/stanford-bunny.obj");
    if !path.is_file() {
        assert!(std::env::var_os("CI").is_none(), "{} is missing", path.display());
        println!("SKIPPED(1): {} is missing", path.display());
        return None;
    }
    let mesh = MeshAsset::from_source(MeshSource::File(path)).unwrap().mesh;
    Some(TestMesh { positions: mesh.positions, triangles: mesh.triangles })
}
