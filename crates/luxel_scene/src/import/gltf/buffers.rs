//! The buffers of a glTF file: in the file itself, in data URIs, or in files beside it.

use std::path::Path;

use base64::Engine as _;
use base64::alphabet::STANDARD;
use base64::engine::DecodePaddingMode;
use base64::engine::general_purpose::{GeneralPurpose, GeneralPurposeConfig};
use gltf::json::Index;
use gltf::json::Root;
use gltf::json::buffer::View;

use super::super::confined::{confined, percent_decoded};
use super::super::{one_line, read_file};

/// The most bytes that all buffers of a file may have together: 2 GiB.
const MAX_BUFFER_BYTES: u64 = 1 << 31;

/// The content of every buffer, or why there is none: that matters only to who uses it.
#[derive(Debug, Default)]
pub(super) struct Buffers(Vec<Result<Vec<u8>, String>>);

/// Bytes, and the distance from one element to the next if the view says one.
pub(super) type ViewBytes<'a> = (&'a [u8], Option<usize>);

impl Buffers {
    /// Reads every buffer of the file at `path`; `binary` is its binary chunk.
    pub(super) fn read(path: &Path, root: &Root, mut binary: Option<Vec<u8>>) -> Self {
        let mut left = MAX_BUFFER_BYTES;
        let read = root.buffers.iter().enumerate().map(|(index, buffer)| {
            let length = buffer.byte_length.0;
            let content = match (&buffer.uri, index) {
                (Some(uri), _) => resolve(path, uri, left),
                (None, 0) => binary.take().ok_or_else(|| "has no binary chunk to lie in".to_owned()),
                (None, _) => Err("has no content".to_owned()),
            };
            let content = content.map_err(|reason| format!("buffer {index} {reason}"))?;
            let have = content.len() as u64;
            left = left.saturating_sub(have);
            if have < length {
                return Err(format!("buffer {index} has {have} bytes, but {length} are announced"));
            }
            Ok(content)
        });
        Self(read.collect())
    }

    /// Bytes of all buffers.
    pub(super) fn bytes(&self) -> u64 {
        self.0.iter().flatten().map(|content| content.len() as u64).sum()
    }

    /// The bytes of a view, all of which are there.
    pub(super) fn view(&self, root: &Root, index: Index<View>) -> Result<ViewBytes<'_>, String> {
        let number = index.value();
        let view = root.get(index).ok_or_else(|| format!("buffer view {number} does not exist"))?;
        let content = self.0.get(view.buffer.value());
        let content = content.ok_or_else(|| format!("buffer {} does not exist", view.buffer.value()))?;
        let content = content.as_ref().map_err(Clone::clone)?;
        let start = view.byte_offset.map_or(0, |offset| offset.0);
        let bytes = start
            .checked_add(view.byte_length.0)
            .and_then(|end| content.get(usize::try_from(start).ok()?..usize::try_from(end).ok()?))
            .ok_or_else(|| format!("buffer view {number} leaves its buffer"))?;
        Ok((bytes, view.byte_stride.map(|stride| stride.0).filter(|&stride| stride > 0)))
    }
}

/// The content that a URI stands for: base64 in itself, or a file below the model's folder of at most `limit` bytes.
///
/// # Errors
/// Why there is none, as the end of a sentence.
pub(super) fn resolve(model: &Path, uri: &str, limit: u64) -> Result<Vec<u8>, String> {
    if let Some(data) = uri.strip_prefix("data:") {
        return data_uri(data);
    }
    let name = percent_decoded(uri);
    let path = confined(model, &name).map_err(|reason| format!("\"{}\" {reason}", short(&name)))?;
    read_file(&path, limit).map_err(|error| match error {
        crate::SceneError::Read { source, .. } => format!("\"{}\" cannot be read ({source})", short(&name)),
        other => format!("cannot be used ({other})"),
    })
}

/// What a name from a file looks like in a message: one line of at most 80 characters.
pub(super) fn short(name: &str) -> String {
    one_line(name).chars().take(80).collect()
}

/// The content of a data URI after `data:`, which must be base64.
fn data_uri(data: &str) -> Result<Vec<u8>, String> {
    let Some((head, body)) = data.split_once(',') else {
        return Err("has a data URI without content".to_owned());
    };
    if !head.ends_with(";base64") {
        return Err("has a data URI that is not base64".to_owned());
    }
    let lenient = GeneralPurposeConfig::new()
        .with_decode_padding_mode(DecodePaddingMode::Indifferent)
        .with_decode_allow_trailing_bits(true);
    let decoded = GeneralPurpose::new(&STANDARD, lenient).decode(body.trim());
    decoded.map_err(|error| format!("has a data URI that is no base64 ({error})"))
}
