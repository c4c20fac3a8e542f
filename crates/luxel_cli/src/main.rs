//! The program `luxel`; everything it does is in the library.
use std::path::Path;
use std::process::ExitCode;

fn main() -> ExitCode {
    luxel_cli::run(std::env::args_os(), Path::new(env!("CARGO_MANIFEST_DIR")))
}
