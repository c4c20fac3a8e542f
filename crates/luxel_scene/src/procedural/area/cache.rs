//! Areas on disk: a header that says what a file is of, and a checksum. A file that is damaged, foreign or out of date is
//! as good as none.

use std::ffi::OsString;
use std::fs;
use std::io::{self, Write as _};
use std::path::{Path, PathBuf};

use xxhash_rust::xxh3::{Xxh3, xxh3_64};

use super::Area;
use super::keys::Key;
use super::store::{decode, encode};
use super::stuff::palette;

const MAGIC: [u8; 8] = *b"LUXELARE";
/// Of the layout of the file.
const VERSION: u32 = 1;
/// Magic; version and levels; recipe, seed and size; masks, voxels and checksum.
const HEADER: usize = 8 + 4 + 4 + 8 + 4 + 4 + 8 + 8 + 8;

/// What a file of this area begins with, up to the number of masks.
fn title(area: &Area) -> Vec<u8> {
    let numbers = [VERSION, area.size.trailing_zeros()];
    let mut title = MAGIC.to_vec();
    numbers.iter().for_each(|number| title.extend(number.to_le_bytes()));
    title.extend(area.kind.recipe_hash().to_le_bytes());
    [area.seed, area.size].iter().for_each(|number| title.extend(number.to_le_bytes()));
    title
}

fn checksum(masks: &[u8], contents: &[u8]) -> u64 {
    let mut hash = Xxh3::new();
    hash.update(masks);
    hash.update(&xxh3_64(contents).to_le_bytes());
    hash.digest()
}

/// The area's voxels from its file in `folder`; `None` if there is none that can be trusted.
pub(super) fn read(area: &Area, folder: &Path) -> Option<Vec<Key>> {
    let bytes = fs::read(area.cache_file(folder)).ok()?;
    let (header, content) = bytes.split_at_checked(HEADER)?;
    let counts = header.strip_prefix(&title(area)[..])?;
    let number =
        |index: usize| Some(u64::from_le_bytes(counts.get(8 * index..8 * index + 8)?.try_into().ok()?));
    let (masks, contents) = content.split_at_checked(usize::try_from(number(0)?).ok()?)?;
    let is_sound = contents.len() as u64 == number(1)? && checksum(masks, contents) == number(2)?;
    let entries = palette(1.0).len();
    is_sound.then(|| decode(masks, contents, area.size.trailing_zeros(), entries))?
}

/// Keeps the area in `folder` if it can: beside, and then renamed. If it cannot, the next one makes it again.
pub(super) fn write(area: &Area, folder: &Path, keys: &[Key]) {
    // Whoever asked has the area; a cache that cannot be written costs only time.
    let _ = try_write(area, folder, keys);
}

fn try_write(area: &Area, folder: &Path, keys: &[Key]) -> io::Result<()> {
    let (masks, contents) = encode(keys, area.size.trailing_zeros());
    fs::create_dir_all(folder)?;
    let mut file = tempfile::NamedTempFile::new_in(folder)?;
    file.write_all(&title(area))?;
    for number in [masks.len() as u64, contents.len() as u64, checksum(&masks, &contents)] {
        file.write_all(&number.to_le_bytes())?;
    }
    file.write_all(&masks)?;
    file.write_all(&contents)?;
    file.persist(area.cache_file(folder))?;
    Ok(())
}

/// The cache folder that environment variables name.
pub(super) fn folder(variable: impl Fn(&str) -> Option<OsString>) -> Option<PathBuf> {
    let named = |name: &str| variable(name).filter(|value| !value.is_empty()).map(PathBuf::from);
    let shared = || named("XDG_CACHE_HOME").or_else(|| named("HOME").map(|home| home.join(".cache")));
    named("LUXEL_CACHE").or_else(|| shared().map(|folder| folder.join("luxel")))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_folder_is_the_first_that_is_named() {
        let of = |names: &[(&str, &str)]| {
            let named = names.to_vec();
            folder(move |name| {
                named.iter().find(|(key, _)| *key == name).map(|(_, value)| OsString::from(*value))
            })
        };
        assert_eq!(of(&[]), None);
        assert_eq!(of(&[("HOME", "/h")]), Some(PathBuf::from("/h/.cache/luxel")));
        assert_eq!(of(&[("HOME", "/h"), ("XDG_CACHE_HOME", "/x")]), Some(PathBuf::from("/x/luxel")));
        assert_eq!(of(&[("LUXEL_CACHE", "/l"), ("XDG_CACHE_HOME", "/x")]), Some(PathBuf::from("/l")));
        assert_eq!(of(&[("LUXEL_CACHE", ""), ("XDG_CACHE_HOME", "/x")]), Some(PathBuf::from("/x/luxel")));
    }
}
