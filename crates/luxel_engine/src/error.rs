//! Everything that can stop a job, and the one table of exit codes.
use luxel_bake::BakeError;
use luxel_film::TraceError;
use luxel_gpu::GpuError;
use luxel_scene::SceneError;
use thiserror::Error;

use crate::output::OutputError;

/// Why a job came to no result. One line, which names the file and the place where there is one.
#[derive(Debug, Error)]
pub enum EngineError {
    /// The scene or model cannot be read or written.
    #[error(transparent)]
    Scene(#[from] SceneError),
    /// The scene cannot be turned into what the tracers read.
    #[error("{scene}: {source}")]
    Bake {
        /// The scene file.
        scene: String,
        /// What is wrong with it.
        source: BakeError,
    },
    /// The output cannot be written.
    #[error(transparent)]
    Output(#[from] OutputError),
    /// A camera was asked for that the scene does not have.
    #[error("{scene}: no camera is named '{name}' (there is {known})")]
    NoSuchCamera {
        /// The scene file.
        scene: String,
        /// What was asked for.
        name: String,
        /// The cameras there are.
        known: String,
    },
    /// A setting out of its range.
    #[error("{0}")]
    Setting(String),
    /// No graphics adapter can be used.
    #[error("{0} (--backend cpu renders without one)")]
    Gpu(#[from] GpuError),
    /// Neither backend could go on.
    #[error(transparent)]
    Trace(#[from] TraceError),
}

/// The program's exit codes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u8)]
pub enum ExitCode {
    /// Done.
    Done = 0,
    /// A comparison exceeded its limit.
    ComparisonFailed = 1,
    /// Bad usage or bad input.
    BadInput = 2,
    /// The machine cannot do it.
    Machine = 3,
}

impl EngineError {
    /// The exit code that the error leads to.
    pub fn exit_code(&self) -> ExitCode {
        match self {
            Self::Scene(_) | Self::Bake { .. } | Self::NoSuchCamera { .. } | Self::Setting(_) => {
                ExitCode::BadInput
            }
            Self::Output(OutputError::Io { .. } | OutputError::Encode { .. }) => ExitCode::Machine,
            Self::Output(_) => ExitCode::BadInput,
            Self::Gpu(_) | Self::Trace(_) => ExitCode::Machine,
        }
    }
}
