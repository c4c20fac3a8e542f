//! Is there a Vulkan driver, and if not, may one be installed?
//!
//! A driver is there when the loader (`libvulkan.so.1`) and at least one driver manifest are: the files that the loader
//! itself looks for. Whether the driver also finds an adapter is for the GPU tests to say, which fail when it does not.
//! Systems other than Linux bring their own driver and are not looked at.

use std::path::{Path, PathBuf};
use std::process::Command;

use anyhow::{Context, Result, bail};

use crate::machine::{output_of, run};

/// Set by a user who accepts that GPU tests are skipped (and counted as such).
pub(crate) const ALLOW_NO_GPU: &str = "LUXEL_ALLOW_NO_GPU";

const PACKAGES: [&str; 2] = ["mesa-vulkan-drivers", "libvulkan1"];

const HOW_TO_GO_ON: &str = "\
No Vulkan driver was found, and it cannot be installed from here. Either install one:
  Debian, Ubuntu  apt-get install --no-install-recommends mesa-vulkan-drivers libvulkan1
  Fedora          dnf install mesa-vulkan-drivers vulkan-loader
  Arch            pacman -S vulkan-swrast vulkan-icd-loader
or run again with LUXEL_ALLOW_NO_GPU=1 to skip the GPU tests.";

/// Makes sure that there is a Vulkan driver, or that the user wants to go on without.
pub(crate) fn ensure() -> Result<()> {
    if !cfg!(target_os = "linux") || is_there() {
        return Ok(());
    }
    if std::env::var(ALLOW_NO_GPU).is_ok_and(|value| value == "1") {
        println!(
            "xtask: no Vulkan driver; {ALLOW_NO_GPU}=1 is set, so GPU tests will be skipped and counted"
        );
        return Ok(());
    }
    let Some(prefix) = apt_prefix() else { bail!("{HOW_TO_GO_ON}") };
    println!(
        "xtask: no Vulkan driver was found; installing Mesa's software driver ({})",
        PACKAGES.join(", ")
    );
    install(prefix).context(HOW_TO_GO_ON)?;
    if !is_there() {
        bail!("the packages were installed, but there is still no Vulkan driver\n{HOW_TO_GO_ON}");
    }
    Ok(())
}

fn is_there() -> bool {
    has_loader() && has_manifest()
}

fn has_loader() -> bool {
    let listed = ["ldconfig", "/sbin/ldconfig"].iter().find_map(|program| output_of(program, &["-p"]));
    listed.is_some_and(|libraries| libraries.contains("libvulkan.so.1"))
}

fn has_manifest() -> bool {
    match ["VK_DRIVER_FILES", "VK_ICD_FILENAMES"].iter().find_map(std::env::var_os) {
        Some(chosen) => std::env::split_paths(&chosen).any(|path| path.is_file() || has_json(&path)),
        None => manifest_folders().iter().any(|folder| has_json(folder)),
    }
}

/// The folders that the loader searches.
fn manifest_folders() -> Vec<PathBuf> {
    let home = std::env::var_os("HOME").map(|home| Path::new(&home).join(".local/share"));
    let data = std::env::var_os("XDG_DATA_DIRS").unwrap_or_else(|| "/usr/local/share:/usr/share".into());
    let bases = std::env::split_paths(&data).chain(home).chain(["/etc".into(), "/usr/share".into()]);
    bases.map(|base: PathBuf| base.join("vulkan/icd.d")).collect()
}

fn has_json(folder: &Path) -> bool {
    let entries = std::fs::read_dir(folder).into_iter().flatten().flatten();
    entries
        .map(|entry| entry.path())
        .any(|path| path.extension().is_some_and(|extension| extension == "json"))
}

/// The words before `apt-get` with which packages can be installed without asking anyone; `None` if they cannot.
fn apt_prefix() -> Option<&'static [&'static str]> {
    output_of("apt-get", &["--version"])?;
    if output_of("id", &["-u"])? == "0" {
        return Some(&[]);
    }
    output_of("sudo", &["-n", "true"]).map(|_| ["sudo", "-n"].as_slice())
}

fn install(prefix: &[&str]) -> Result<()> {
    let apt_get = |arguments: &[&str]| {
        let environment = ["env", "DEBIAN_FRONTEND=noninteractive", "apt-get", "-q"];
        let words: Vec<&str> = prefix.iter().chain(&environment).chain(arguments).copied().collect();
        run(Command::new(words[0]).args(&words[1..]))
    };
    apt_get(&["update"])?;
    apt_get(&[&["install", "-y", "--no-install-recommends"], PACKAGES.as_slice()].concat())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_folder_counts_only_with_a_manifest_in_it() {
        let folder = tempfile::tempdir().unwrap();
        assert!(!has_json(folder.path()) && !has_json(&folder.path().join("missing")));
        std::fs::write(folder.path().join("readme.txt"), "").unwrap();
        assert!(!has_json(folder.path()));
        std::fs::write(folder.path().join("lvp_icd.json"), "{}").unwrap();
        assert!(has_json(folder.path()));
    }
}
