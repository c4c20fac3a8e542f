//! A net under libraries that may panic on a damaged file.

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::Path;

use crate::error::SceneError;

/// What `parse` gives, or an error about `path` if a library panics in it.
///
/// `parse` must own what it changes: what it leaves behind on a panic is thrown away.
pub(super) fn guarded<T>(
    path: &Path,
    parse: impl FnOnce() -> Result<T, SceneError>,
) -> Result<T, SceneError> {
    catch_unwind(AssertUnwindSafe(parse)).unwrap_or_else(|panic| {
        let text = panic.downcast_ref::<String>().map(String::as_str);
        let text = text.or(panic.downcast_ref::<&str>().copied()).unwrap_or("no reason given");
        let text = text.lines().next().unwrap_or_default();
        Err(SceneError::unusable(path, format!("is damaged (its reader gave up: {text})")))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    #[allow(clippy::panic)]
    fn a_panic_is_an_error_about_the_file() {
        let path = Path::new("a.glb");
        let error = guarded::<()>(path, || panic!("index {}\nbacktrace", 7)).map_err(|e| e.to_string());
        assert_eq!(error, Err("a.glb: is damaged (its reader gave up: index 7)".to_owned()));
        assert!(matches!(guarded(path, || Ok(3)), Ok(3)));
    }
}
