//! The answer of a command, on stdout.
use std::io::{self, ErrorKind, Write};

use serde::Serialize;

use crate::error::CliError;

/// Prints the text; a reader that has closed the pipe has seen enough.
pub(crate) fn print_text(text: &str) -> Result<(), CliError> {
    let mut stdout = io::stdout().lock();
    match writeln!(stdout, "{}", text.trim_end()).and_then(|()| stdout.flush()) {
        Err(error) if error.kind() != ErrorKind::BrokenPipe => Err(CliError::Stdout(error)),
        _ => Ok(()),
    }
}

/// Prints one JSON object.
pub(crate) fn print_json(answer: &impl Serialize) -> Result<(), CliError> {
    print_text(&serde_json::to_string_pretty(answer)?)
}

/// A count of bytes for people.
pub(crate) fn bytes(count: u64) -> String {
    scaled(count as f64, 1024.0, &["B", "KiB", "MiB", "GiB", "TiB"])
}

/// A count per second for people.
pub(crate) fn per_second(rate: f64) -> String {
    scaled(rate, 1000.0, &["", "k", "M", "G"])
}

fn scaled(value: f64, step: f64, units: &[&str]) -> String {
    let mut value = value;
    let mut unit = 0;
    while value >= step && unit + 1 < units.len() {
        value /= step;
        unit += 1;
    }
    let digits = if unit == 0 { 0 } else { 1 };
    format!("{value:.digits$} {}", units[unit]).trim_end().to_owned()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_short_and_have_their_unit() {
        assert_eq!([0, 1023, 1536, 5 << 30].map(bytes), ["0 B", "1023 B", "1.5 KiB", "5.0 GiB"]);
        assert_eq!([0.0, 999.0, 12_340.0, 3.21e6].map(per_second), ["0", "999", "12.3 k", "3.2 M"]);
    }
}
