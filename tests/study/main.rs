//! The studies: for each the smallest plan that has every figure, measured, and made again from its records.
#![allow(clippy::unwrap_used)]

mod bvh;
#[path = "../front_door/mod.rs"]
mod front_door;
#[cfg(unix)]
mod full_disk;
mod octree;
mod page;

/// Whoever asks for a GPU where there is none gets one line, and no folder.
#[test]
fn a_study_without_a_device_leaves_nothing_behind() {
    for study in ["octree", "bvh"] {
        let folder = tempfile::tempdir().unwrap();
        let mut command = front_door::luxel(folder.path());
        command.args(["study", study, "--quick", "--backend", "gpu", "--out", "new/out"]);
        // No Vulkan driver, and no other kind of one.
        command.env("VK_DRIVER_FILES", "/dev/null").env("VK_ICD_FILENAMES", "/dev/null");
        let error = page::refused(front_door::run(command.env("WGPU_BACKEND", "vulkan")), 3);
        assert!(error.contains("GPU"), "{error}");
        assert!(front_door::names(folder.path()).is_empty(), "{error}");
    }
}
