//! Writing beside a file's place and moving it there.
use std::fs::{self, File};
use std::io::{ErrorKind, Write as _};
use std::path::{Path, PathBuf, is_separator};

use tempfile::{Builder, NamedTempFile};

use super::OutputError;

/// Finds out whether a file could be written here, without leaving anything behind.
///
/// # Errors
/// As the writers: something else is in its place, the folder is missing or refuses a new file.
pub fn check(path: &Path) -> Result<(), OutputError> {
    beside(path).map(drop)
}

/// Writes a file of some bytes, all of them or none.
///
/// # Errors
/// As [`check`], and when the disk refuses.
pub fn write_file(path: &Path, bytes: &[u8]) -> Result<(), OutputError> {
    write_atomically(path, |file| {
        file.write_all(bytes).map_err(|source| OutputError::Io { path: path.to_owned(), source })
    })
}

/// Lets `write` fill a file beside `path`, then moves it there; a link is followed, a file replaced.
pub(super) fn write_atomically(
    path: &Path,
    write: impl FnOnce(&mut File) -> Result<(), OutputError>,
) -> Result<(), OutputError> {
    let (mut file, target) = beside(path)?;
    write(file.as_file_mut())?;
    file.persist(target)
        .map(drop)
        .map_err(|error| OutputError::Io { path: path.to_owned(), source: error.error })
}

/// A new file in the folder of `path`, which goes away unless it is moved, and where to move it.
fn beside(path: &Path) -> Result<(NamedTempFile, PathBuf), OutputError> {
    let path_buf = || path.to_owned();
    let target = match fs::metadata(path) {
        Ok(there) if there.is_dir() => {
            return Err(OutputError::NotAFile { path: path_buf(), what: "folder" });
        }
        Ok(there) if !there.is_file() => {
            return Err(OutputError::NotAFile { path: path_buf(), what: "device" });
        }
        Ok(_) => fs::canonicalize(path).map_err(|source| OutputError::Io { path: path_buf(), source })?,
        Err(_) if names_a_folder(path) => {
            return Err(OutputError::NotAFile { path: path_buf(), what: "folder's name" });
        }
        Err(source) if source.kind() == ErrorKind::InvalidFilename => {
            return Err(OutputError::Io { path: path_buf(), source });
        }
        Err(_) => path_buf(),
    };
    let folder = match target.parent() {
        Some(folder) if folder != Path::new("") => folder,
        _ => Path::new("."),
    };
    if !folder.is_dir() {
        return Err(OutputError::NoFolder { path: path_buf(), folder: folder.to_owned() });
    }
    let file = new_file(folder).map_err(|source| OutputError::Io { path: path_buf(), source })?;
    Ok((file, target))
}

/// Whether `path` can be no file's: `a.png/` and `a.png/.`, whose parts are those of `a.png`.
fn names_a_folder(path: &Path) -> bool {
    let bytes = path.as_os_str().as_encoded_bytes();
    let last = bytes.strip_suffix(b".").unwrap_or(bytes).last();
    last.is_some_and(|&byte| is_separator(char::from(byte)))
}

/// A file that others may read as far as the user's umask allows; temporary files are private by default.
fn new_file(folder: &Path) -> std::io::Result<NamedTempFile> {
    let mut builder = Builder::new();
    builder.prefix(".luxel-");
    #[cfg(unix)]
    builder.permissions(std::os::unix::fs::PermissionsExt::from_mode(0o666));
    builder.tempfile_in(folder)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn names(folder: &Path) -> Vec<String> {
        let entries = fs::read_dir(folder).unwrap();
        entries.map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect()
    }

    fn write(path: &Path, text: &str) -> Result<(), OutputError> {
        write_atomically(path, |file| {
            file.write_all(text.as_bytes()).unwrap();
            Ok(())
        })
    }

    #[test]
    fn a_file_is_made_and_replaced_whole() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.png");
        write(&path, "first, and longer").unwrap();
        write(&path, "second").unwrap();
        assert_eq!(fs::read_to_string(&path).unwrap(), "second");
        assert_eq!(names(folder.path()), ["a.png"]);
    }

    #[test]
    fn a_failure_on_the_way_leaves_the_old_file_and_nothing_else() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.png");
        write(&path, "old").unwrap();
        let failed = write_atomically(&path, |file| {
            file.write_all(b"half of").unwrap();
            Err(OutputError::Encode { path: path.clone(), message: "disk on fire".to_owned() })
        });
        assert!(failed.unwrap_err().to_string().contains("disk on fire"));
        assert_eq!(fs::read_to_string(&path).unwrap(), "old");
        assert_eq!(names(folder.path()), ["a.png"]);
    }

    #[test]
    fn a_folder_in_its_place_and_a_missing_folder_are_named() {
        let folder = tempfile::tempdir().unwrap();
        let error = check(folder.path()).unwrap_err().to_string();
        assert!(error.ends_with("it is a folder, not a file"), "{error}");
        let missing = folder.path().join("no/such/a.png");
        let error = write(&missing, "").unwrap_err().to_string();
        assert!(error.contains("a.png: there is no folder") && error.ends_with("no/such"), "{error}");
        let under_a_file = folder.path().join("file");
        write(&under_a_file, "").unwrap();
        assert!(matches!(check(&under_a_file.join("a.png")), Err(OutputError::NoFolder { .. })));
        assert_eq!(names(folder.path()), ["file"]);
    }

    #[test]
    fn a_name_that_no_file_can_have_is_found_by_checking() {
        let folder = tempfile::tempdir().unwrap();
        write(&folder.path().join("there.png"), "").unwrap();
        for name in ["a.png/", "a.png//", "a.png/.", "there.png/", "there.png/./"] {
            let error = check(&folder.path().join(name)).unwrap_err();
            assert!(error.is_input() && error.to_string().contains("a folder's name, not a file"), "{error}");
        }
        let error = check(&folder.path().join("a".repeat(300) + ".png")).unwrap_err();
        assert!(error.is_input(), "{error}");
        assert_eq!(names(folder.path()), ["there.png"]);
        check(&folder.path().join("./a.png.")).unwrap();
    }

    #[test]
    fn checking_leaves_nothing_behind() {
        let folder = tempfile::tempdir().unwrap();
        check(&folder.path().join("a.exr")).unwrap();
        assert!(names(folder.path()).is_empty());
    }

    #[cfg(unix)]
    mod unix {
        use std::os::unix::fs::{PermissionsExt, symlink};

        use super::*;

        #[test]
        fn devices_are_left_alone_and_links_followed() {
            assert!(matches!(
                check(Path::new("/dev/null")),
                Err(OutputError::NotAFile { what: "device", .. })
            ));
            let folder = tempfile::tempdir().unwrap();
            let (real, link) = (folder.path().join("real.png"), folder.path().join("link.png"));
            write(&real, "old").unwrap();
            symlink(&real, &link).unwrap();
            write(&link, "new").unwrap();
            assert!(link.is_symlink());
            assert_eq!(fs::read_to_string(&real).unwrap(), "new");
        }

        #[test]
        fn others_may_read_the_file_as_the_umask_says() {
            let folder = tempfile::tempdir().unwrap();
            let (ours, plain) = (folder.path().join("a.png"), folder.path().join("b"));
            write(&ours, "").unwrap();
            File::create(&plain).unwrap();
            let mode = |path: &Path| fs::metadata(path).unwrap().permissions().mode();
            assert_eq!(mode(&ours), mode(&plain));
        }
    }
}
