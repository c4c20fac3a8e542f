//! Files that a model names: only those in its own folder or below it.
//!
//! A model comes from anywhere, so it must not be able to name a file of the user's (robustness.md D2).

use std::path::{Component, Path, PathBuf};

/// Names that are devices on Windows, whatever ending they have.
const DEVICES: [&str; 4] = ["con", "prn", "aux", "nul"];

/// The file that the model at `model` calls `name` (backslashes count as slashes).
///
/// # Errors
/// Why the name is not followed, as the end of a sentence that begins with it.
pub(super) fn confined(model: &Path, name: &str) -> Result<PathBuf, String> {
    let relative = name.replace('\\', "/");
    let is_inside = Path::new(&relative)
        .components()
        .all(|part| matches!(part, Component::Normal(_) | Component::CurDir));
    if relative.is_empty() || relative.contains([':', '\0']) || !is_inside {
        return Err("is outside the model's folder".to_owned());
    }
    if relative.split('/').any(is_device) {
        return Err("is the name of a device".to_owned());
    }
    let folder = match model.parent() {
        Some(folder) if folder != Path::new("") => folder,
        _ => Path::new("."),
    };
    let unreadable = |error| format!("cannot be read ({error})");
    let folder = folder.canonicalize().map_err(unreadable)?;
    let path = folder.join(relative).canonicalize().map_err(unreadable)?;
    // A link may lead out although the name does not.
    if path.starts_with(&folder) { Ok(path) } else { Err("is outside the model's folder".to_owned()) }
}

fn is_device(part: &str) -> bool {
    let stem = part.split('.').next().unwrap_or_default().trim_end().to_ascii_lowercase();
    let numbered = |prefix: &str| {
        stem.strip_prefix(prefix).is_some_and(|n| n.len() == 1 && n.bytes().all(|b| b.is_ascii_digit()))
    };
    DEVICES.contains(&stem.as_str()) || numbered("com") || numbered("lpt")
}

/// `%20` and the like as the characters that they stand for; what is no such code stays as it is.
pub(super) fn percent_decoded(uri: &str) -> String {
    let bytes = uri.as_bytes();
    let mut decoded = Vec::with_capacity(bytes.len());
    let mut at = 0;
    while let Some(&byte) = bytes.get(at) {
        let code = uri.get(at + 1..at + 3).filter(|code| code.bytes().all(|b| b.is_ascii_hexdigit()));
        match code.and_then(|code| u8::from_str_radix(code, 16).ok()) {
            Some(code) if byte == b'%' => {
                decoded.push(code);
                at += 3;
            }
            _ => {
                decoded.push(byte);
                at += 1;
            }
        }
    }
    String::from_utf8_lossy(&decoded).into_owned()
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;

    #[test]
    fn codes_are_decoded_once() {
        for (uri, expected) in [
            ("a%20b", "a b"),
            ("%2e%2E/a", "../a"),
            ("50%", "50%"),
            ("%zz%4", "%zz%4"),
            ("é%C3%A9", "éé"),
            ("%2520", "%20"),
        ] {
            assert_eq!(percent_decoded(uri), expected);
        }
    }

    #[test]
    fn no_name_leads_out_of_the_folder() {
        let folder = tempfile::tempdir().unwrap();
        let inside = folder.path().join("models");
        std::fs::create_dir_all(inside.join("textures")).unwrap();
        std::fs::write(inside.join("textures/a b.png"), "x").unwrap();
        std::fs::write(folder.path().join("secret"), "x").unwrap();
        let model = inside.join("a.gltf");
        for good in ["textures/a b.png", "textures\\a b.png", "./textures/a b.png"] {
            assert!(confined(&model, good).unwrap().ends_with("textures/a b.png"), "{good}");
        }
        let mut bad: Vec<String> = [
            "../secret",
            "/etc/passwd",
            "textures/../../secret",
            "file:///etc/passwd",
            "http://a/b",
            "C:\\a",
            "\\\\host\\share",
            "//host/share",
            "",
            "con",
            "AUX.png",
            "textures/lpt1.txt",
            "nul ",
            "a\0b",
            "..\\secret",
            "~/../x",
            "none.png",
        ]
        .map(str::to_owned)
        .to_vec();
        bad.push(folder.path().join("secret").display().to_string());
        #[cfg(unix)]
        {
            std::os::unix::fs::symlink("../secret", inside.join("link")).unwrap();
            std::os::unix::fs::symlink("..", inside.join("up")).unwrap();
            bad.extend(["link".to_owned(), "up/secret".to_owned()]);
        }
        for name in bad {
            assert!(confined(&model, &name).is_err(), "{name}");
        }
    }
}
