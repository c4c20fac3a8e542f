//! The chunks of a .vox file, looked at before `dot_vox` reads them.
//!
//! `dot_vox` nests as deep as the file says, forgets the ids of nodes and layers, and skips a chunk
//! that it cannot read. So the skeleton is checked first: one MAIN chunk whose children have no
//! children, every length inside the file, every voxel count inside its chunk.
//! Format: MagicaVoxel-file-format-vox.txt and …-vox-extension.txt (ephtracy/voxel-model).

use std::path::Path;

use crate::error::SceneError;

use super::tally::Tally;

/// What the skeleton tells that `dot_vox` does not.
#[derive(Debug, Default)]
pub(super) struct Skeleton {
    /// Ids of the scene graph's nodes, in the file's order.
    pub(super) node_ids: Vec<u32>,
    /// Ids of the layers, in the file's order.
    pub(super) layer_ids: Vec<u32>,
    /// Number of models.
    pub(super) models: usize,
    /// Chunks that this program does not use.
    pub(super) ignored: Tally,
}

/// A model measures at most this many voxels along an edge: a voxel's coordinate is one byte.
const MAX_EDGE: u32 = 256;

/// Length of a chunk's head: name, length of content, length of children.
const HEAD: usize = 12;

/// Checks `bytes`, the content of `path`.
///
/// # Errors
/// Not a .vox file, cut short, nested or damaged; with the position in the file.
pub(super) fn check(path: &Path, bytes: &[u8]) -> Result<Skeleton, SceneError> {
    let fail = |at: usize, message: &str| SceneError::model(path, format!("byte {at}"), message);
    if !bytes.starts_with(b"VOX ") {
        return Err(fail(0, "is not a MagicaVoxel file: it does not begin with \"VOX \""));
    }
    let main = Head::at(bytes, 8).ok_or_else(|| fail(bytes.len(), "the file ends before its MAIN chunk"))?;
    if main.name != *b"MAIN" {
        return Err(fail(8, "a MAIN chunk is expected"));
    }
    let end = main.end();
    if bytes.len() < end {
        return Err(fail(bytes.len(), &format!("the file is cut short: {end} bytes are announced")));
    }
    let mut skeleton = Skeleton::default();
    let mut at = main.children();
    while at < end {
        let head = Head::at(&bytes[..end], at)
            .filter(|head| head.end() <= end)
            .ok_or_else(|| fail(at, "a chunk reaches beyond the end"))?;
        if head.children_bytes > 0 {
            return Err(fail(at, "a chunk inside MAIN has chunks of its own"));
        }
        skeleton.add(&head.name, &bytes[head.content()..head.end()]).map_err(|message| fail(at, &message))?;
        at = head.end();
    }
    Ok(skeleton)
}

impl Skeleton {
    fn add(&mut self, name: &[u8; 4], content: &[u8]) -> Result<(), String> {
        let first = || word(content, 0).ok_or_else(|| "a chunk is too short".to_owned());
        match name {
            b"SIZE" => return check_size(content),
            b"XYZI" => {
                if u64::from(first()?) * 4 + 4 > content.len() as u64 {
                    return Err("announces more voxels than it holds".to_owned());
                }
                self.models += 1;
            }
            b"RGBA" if content.len() != 1024 => {
                return Err("a palette of 256 colours is expected".to_owned());
            }
            b"nTRN" | b"nGRP" | b"nSHP" => self.node_ids.push(first()?),
            b"LAYR" => self.layer_ids.push(first()?),
            b"RGBA" | b"MATL" | b"PACK" => {}
            b"rCAM" => self.ignored.add("cameras"),
            b"rOBJ" => self.ignored.add("settings of the renderer"),
            b"NOTE" => self.ignored.add("notes on the palette"),
            b"IMAP" => self.ignored.add("orders of the palette"),
            other => self.ignored.add(&format!("\"{}\" chunks", other.escape_ascii())),
        }
        Ok(())
    }
}

fn check_size(content: &[u8]) -> Result<(), String> {
    for axis in 0..3 {
        let edge = word(content, axis * 4).ok_or("a model's size is three numbers")?;
        if edge > MAX_EDGE {
            return Err(format!("a model of {edge} voxels along an edge; {MAX_EDGE} is the most"));
        }
    }
    Ok(())
}

/// The head of a chunk at a position.
struct Head {
    at: usize,
    name: [u8; 4],
    content_bytes: u32,
    children_bytes: u32,
}

impl Head {
    fn at(bytes: &[u8], at: usize) -> Option<Self> {
        Some(Self {
            at,
            name: *bytes.get(at..)?.first_chunk()?,
            content_bytes: word(bytes, at + 4)?,
            children_bytes: word(bytes, at + 8)?,
        })
    }

    fn content(&self) -> usize {
        self.at + HEAD
    }

    fn children(&self) -> usize {
        self.content().saturating_add(self.content_bytes as usize)
    }

    fn end(&self) -> usize {
        self.children().saturating_add(self.children_bytes as usize)
    }
}

/// The little-endian word at a position.
fn word(bytes: &[u8], at: usize) -> Option<u32> {
    bytes.get(at..)?.first_chunk().map(|word| u32::from_le_bytes(*word))
}
