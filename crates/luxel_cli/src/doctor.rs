//! `luxel doctor`: what this machine offers, what a render would use, and what its numbers are worth.
use luxel_engine::{ExitCode, doctor};

use crate::args::DoctorArgs;
use crate::error::CliError;
use crate::reply;

/// Examines the machine.
pub(crate) fn doctor(args: &DoctorArgs) -> Result<ExitCode, CliError> {
    let diagnosis = doctor::examine();
    if args.json {
        reply::print_json(&diagnosis)?;
    } else {
        reply::print_text(&diagnosis.to_string())?;
    }
    Ok(ExitCode::Done)
}
