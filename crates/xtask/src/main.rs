//! `cargo xtask …`: what the project does around the program.
//!
//! ```text
//! cargo xtask test               set up a fresh machine, then run every test
//! cargo xtask ci                 everything that must pass before a change is accepted
//! cargo xtask generate [--check] write (or compare) the shader module made from the Rust records
//! cargo xtask generate albedo    compute the albedo tables of rough surfaces (eight minutes)
//! cargo xtask soak [NAMES…]      run the hard cases at full size, in release (an hour or so)
//! cargo xtask bench [ARGS…]      run the benches and keep their results in benches/results
//! ```
//!
//! Invariants: nothing is installed without a line that says so; nothing is skipped without a line that says so; the
//! exit code is 0 only if everything asked for was done and passed.

// A command-line tool speaks on the terminal.
#![allow(clippy::print_stdout, clippy::print_stderr)]

mod albedo;
mod bench;
mod ci;
mod generate;
mod machine;
mod soak;
mod summary;
mod test;
mod vulkan;

use std::process::ExitCode;

const USAGE: &str =
    "usage: cargo xtask test | ci | generate [--check | albedo] | soak [NAMES…] | bench [ARGS…]";

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let arguments: Vec<&str> = arguments.iter().map(String::as_str).collect();
    let result = match arguments.as_slice() {
        ["test"] => test::run(),
        ["ci"] => ci::run(),
        ["generate"] => generate::write(),
        ["generate", "--check"] => generate::check().and_then(|()| albedo::check()),
        ["generate", "albedo"] => albedo::write(),
        ["soak", rest @ ..] => soak::run(rest),
        ["bench", rest @ ..] => bench::run(rest),
        _ => {
            eprintln!("{USAGE}");
            return ExitCode::from(2);
        }
    };
    match result {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("xtask: {error:#}");
            ExitCode::FAILURE
        }
    }
}
