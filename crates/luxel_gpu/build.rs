//! Rebuilds the crate when a shader file is added or removed: `include_dir!` tracks only the files it has seen.

fn main() {
    println!("cargo::rerun-if-changed=../../shaders");
}
