//! Embedding follows the shaders: the crate is compiled again when a file of `shaders/` changes.
fn main() {
    println!("cargo::rerun-if-changed=../../shaders");
}
