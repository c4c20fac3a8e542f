//! `cargo xtask generate`: the shader module that holds every record, constant and counter shared with Rust.

use std::path::PathBuf;

use anyhow::{Context, Result, bail};

use crate::machine;

fn path() -> PathBuf {
    machine::root().join("shaders/generated/shared.wesl")
}

/// Writes the module; a reader sees the old one or the new one, never a part.
pub(crate) fn write() -> Result<()> {
    let path = path();
    let beside = path.with_extension("wesl.tmp");
    let folder = path.parent().context("the module has no folder")?;
    std::fs::create_dir_all(folder)
        .and_then(|()| std::fs::write(&beside, luxel_flat::wesl::shared_module()))
        .and_then(|()| std::fs::rename(&beside, &path))
        .with_context(|| format!("cannot write {}", path.display()))?;
    println!("wrote {}", path.display());
    Ok(())
}

/// Fails if the committed module is not what the Rust records say.
pub(crate) fn check() -> Result<()> {
    let path = path();
    let committed =
        std::fs::read_to_string(&path).with_context(|| format!("cannot read {}", path.display()))?;
    if committed != luxel_flat::wesl::shared_module() {
        bail!("{} is out of date: run `cargo xtask generate` and commit it", path.display());
    }
    Ok(())
}
