//! The answer of a command, on stdout.
use std::borrow::Cow;
use std::io::{self, ErrorKind, Write};

use serde::Serialize;

use crate::error::CliError;

/// Prints the text; a reader that has closed the pipe has seen enough.
pub(crate) fn print_text(text: &str) -> Result<(), CliError> {
    let mut stdout = io::stdout().lock();
    match writeln!(stdout, "{}", printable(text.trim_end())).and_then(|()| stdout.flush()) {
        Err(error) if error.kind() != ErrorKind::BrokenPipe => Err(CliError::Stdout(error)),
        _ => Ok(()),
    }
}

/// Prints a line on stderr that is no error.
#[expect(clippy::print_stderr, reason = "notices belong on stderr")]
pub(crate) fn note(notice: &str) {
    eprintln!("note: {notice}");
}

/// The text with control characters, but line feeds, and those that turn the direction of writing as codes: what is
/// in a file must not steer a terminal.
pub(crate) fn printable(text: &str) -> Cow<'_, str> {
    let steers = |letter: char| {
        letter.is_control() && letter != '\n'
            || matches!(letter, '\u{200e}' | '\u{200f}' | '\u{202a}'..='\u{202e}' | '\u{2066}'..='\u{2069}')
    };
    if !text.contains(steers) {
        return Cow::Borrowed(text);
    }
    let visible =
        |letter: char| if steers(letter) { letter.escape_default().to_string() } else { letter.to_string() };
    Cow::Owned(text.chars().map(visible).collect())
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
    fn nothing_that_is_printed_steers_a_terminal() {
        assert_eq!(printable("a\n  ü b"), "a\n  ü b");
        assert_eq!(printable("\u{1b}[2J\u{7}\u{9b}\r\u{202e}"), "\\u{1b}[2J\\u{7}\\u{9b}\\r\\u{202e}");
    }

    #[test]
    fn numbers_are_short_and_have_their_unit() {
        assert_eq!([0, 1023, 1536, 5 << 30].map(bytes), ["0 B", "1023 B", "1.5 KiB", "5.0 GiB"]);
        assert_eq!([0.0, 999.0, 12_340.0, 3.21e6].map(per_second), ["0", "999", "12.3 k", "3.2 M"]);
    }
}
