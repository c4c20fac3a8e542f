//! The device's state of health: lost or not, and the errors that no scope caught.
//!
//! wgpu calls back from whatever thread polls, so both are shared behind locks.

use std::collections::VecDeque;
use std::sync::{Mutex, MutexGuard, OnceLock, PoisonError};

use crate::GpuError;

/// Errors kept beyond this number are dropped: the first ones tell the story.
const MAX_KEPT_ERRORS: usize = 64;

/// Shared between the device's callbacks and its owner.
#[derive(Debug, Default)]
pub(crate) struct Health {
    lost: OnceLock<String>,
    uncaptured: Mutex<VecDeque<GpuError>>,
}

impl Health {
    /// Marks the device as lost; the first reason stays.
    pub(crate) fn lose(&self, reason: String) {
        tracing::warn!(%reason, "GPU device lost");
        // A second loss tells nothing new.
        let _ = self.lost.set(reason);
    }

    /// Whether the device is gone.
    pub(crate) fn is_lost(&self) -> bool {
        self.lost.get().is_some()
    }

    /// An error if the device is gone.
    pub(crate) fn check_lost(&self) -> Result<(), GpuError> {
        match self.lost.get() {
            Some(reason) => Err(GpuError::Lost { reason: reason.clone() }),
            None => Ok(()),
        }
    }

    /// Keeps an error for the owner.
    pub(crate) fn push(&self, error: GpuError) {
        tracing::warn!(%error, "uncaptured GPU error");
        let mut errors = self.errors();
        if errors.len() < MAX_KEPT_ERRORS {
            errors.push_back(error);
        }
    }

    /// Takes the oldest kept error.
    pub(crate) fn pop(&self) -> Option<GpuError> {
        self.errors().pop_front()
    }

    fn errors(&self) -> MutexGuard<'_, VecDeque<GpuError>> {
        self.uncaptured.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn first_loss_stays_and_errors_are_bounded() {
        let health = Health::default();
        assert_eq!(health.check_lost(), Ok(()));
        health.lose("first".to_owned());
        health.lose("second".to_owned());
        assert_eq!(health.check_lost(), Err(GpuError::Lost { reason: "first".to_owned() }));
        for i in 0..1000 {
            health.push(GpuError::Lost { reason: i.to_string() });
        }
        assert_eq!(health.pop(), Some(GpuError::Lost { reason: "0".to_owned() }));
        assert_eq!(std::iter::from_fn(|| health.pop()).count(), MAX_KEPT_ERRORS - 1);
    }
}
