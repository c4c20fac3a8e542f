//! For tests of every room that need a GPU.

use std::io::Write;
use std::sync::atomic::{AtomicU32, Ordering};

use crate::{Gpu, GpuRequest, SoftwarePolicy};

/// Set to `1`, it lets GPU tests pass without an adapter.
pub const ALLOW_NO_GPU: &str = "LUXEL_ALLOW_NO_GPU";

/// How a line on stderr about a skipped test begins; a runner can count these.
pub const SKIP_MARK: &str = "LUXEL-GPU-SKIP";

/// A device for a test: hardware or software, or the adapter that `LUXEL_ADAPTER` names.
///
/// Without one the test fails, unless the environment says `LUXEL_ALLOW_NO_GPU=1`: then it writes a numbered line that
/// begins with [`SKIP_MARK`] to stderr (past the capture of the test harness) and gives `None`.
///
/// # Panics
/// Without a device and without that permission: a GPU test never passes silently.
pub fn gpu_or_fail() -> Option<Gpu> {
    static SKIPPED: AtomicU32 = AtomicU32::new(0);
    let request = GpuRequest { software: SoftwarePolicy::Allow, ..GpuRequest::from_env() };
    match Gpu::open(&request) {
        Ok(gpu) => Some(gpu),
        Err(error) if std::env::var(ALLOW_NO_GPU).is_ok_and(|value| value == "1") => {
            let count = SKIPPED.fetch_add(1, Ordering::Relaxed) + 1;
            let line = format!("{SKIP_MARK} {count}: {error}\n");
            // A test without a stderr has nobody to tell.
            let _ = std::io::stderr().write_all(line.as_bytes());
            None
        }
        Err(error) => panic!("this test needs a GPU ({ALLOW_NO_GPU}=1 skips it): {error}"),
    }
}
