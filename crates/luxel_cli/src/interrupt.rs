//! Ctrl-C: the first asks the render to stop and to keep what there is, the second ends the program.
use std::process;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use crate::error::CliError;

/// What a shell reports for a program that Ctrl-C killed: 128 plus the number of the signal.
const KILLED: i32 = 130;

/// Whether the user wants the render to stop.
#[derive(Clone)]
pub(crate) struct Interrupt(Arc<AtomicBool>);

impl Interrupt {
    /// Listens for Ctrl-C and for a polite request to end (SIGTERM, SIGHUP) from now on.
    pub(crate) fn listen() -> Result<Self, CliError> {
        let asked = Arc::new(AtomicBool::new(false));
        let heard = Arc::clone(&asked);
        ctrlc::set_handler(move || {
            if heard.swap(true, Ordering::Relaxed) {
                process::exit(KILLED);
            }
        })?;
        Ok(Self(asked))
    }

    /// Has the user asked?
    pub(crate) fn is_asked(&self) -> bool {
        self.0.load(Ordering::Relaxed)
    }
}
