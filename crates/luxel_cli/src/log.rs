//! What is logged on stderr: as `LUXEL_LOG` says, coloured for a terminal only.
use std::env;
use std::ffi::OsStr;
use std::io::{self, IsTerminal};

use tracing_subscriber::EnvFilter;

use crate::error::one_line;
use crate::reply;

/// Names what is logged.
const VARIABLE: &str = "LUXEL_LOG";

/// What is logged when `LUXEL_LOG` says nothing. What bake and the GPU room warn about is told as a notice or an error.
const DEFAULT: &str = "warn,luxel_bake=error,luxel_gpu=error,wgpu_core=off,wgpu_hal=off,naga=off";

/// Logs to stderr from now on. A `LUXEL_LOG` that is no filter stops nothing: that is told, and the default holds.
pub(crate) fn to_stderr() {
    let asked = env::var_os(VARIABLE).unwrap_or_default();
    let filter = filter(&asked).unwrap_or_else(|complaint| {
        reply::note(&one_line(&complaint));
        EnvFilter::new(DEFAULT)
    });
    let is_coloured = is_coloured(io::stderr().is_terminal(), env::var_os("NO_COLOR").as_deref());
    // Fails only where a program that uses this library logs already.
    _ = tracing_subscriber::fmt()
        .with_env_filter(filter)
        .with_writer(io::stderr)
        .with_ansi(is_coloured)
        .without_time()
        .try_init();
}

/// The filter that `asked` (the value of `LUXEL_LOG`, empty where there is none) stands for, or what is wrong with it.
fn filter(asked: &OsStr) -> Result<EnvFilter, String> {
    if asked.is_empty() {
        return Ok(EnvFilter::new(DEFAULT));
    }
    let parsed = asked.to_str().ok_or_else(|| "it is not text".to_owned());
    let parsed = parsed.and_then(|text| EnvFilter::try_new(text).map_err(|error| error.to_string()));
    parsed.map_err(|why| format!("{VARIABLE} '{}' is ignored: {why}", asked.to_string_lossy()))
}

/// Whether log lines have colours: on a terminal, unless `NO_COLOR` is set to something (<https://no-color.org>).
fn is_coloured(is_terminal: bool, no_color: Option<&OsStr>) -> bool {
    is_terminal && no_color.is_none_or(OsStr::is_empty)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_a_terminal_has_colours_and_only_while_nobody_minds() {
        assert!(is_coloured(true, None) && is_coloured(true, Some(OsStr::new(""))));
        assert!(!is_coloured(true, Some(OsStr::new("1"))) && !is_coloured(false, None));
    }

    #[test]
    fn an_empty_variable_says_nothing() {
        let said = |asked: &str| filter(OsStr::new(asked)).map(|filter| filter.to_string());
        assert_eq!(said(""), Ok(EnvFilter::new(DEFAULT).to_string()));
        assert_eq!(said("debug"), Ok("debug".to_owned()));
        assert!(said("[[[").is_err());
    }
}
