//! Meshes of the shared data, read as they stand: no welding, no repair.
use std::path::Path;

use glam::Vec3;

/// Corners, and three of them for each triangle.
pub(crate) struct Model {
    pub(crate) name: String,
    pub(crate) positions: Vec<Vec3>,
    pub(crate) indices: Vec<[u32; 3]>,
}

impl Model {
    /// Reads an OBJ, or a PLY in binary little-endian form with no properties but positions and triangles.
    pub(crate) fn read(path: &Path) -> Self {
        let name = path.file_stem().unwrap().to_string_lossy().into_owned();
        let is_ply = path.extension().is_some_and(|extension| extension == "ply");
        let (positions, indices) = if is_ply { read_ply(path) } else { read_obj(path) };
        Self { name, positions, indices }
    }

    /// The model at another size.
    pub(crate) fn scaled(&self, factor: f32) -> Self {
        let positions = self.positions.iter().map(|&p| p * factor).collect();
        Self { name: format!("{} × {factor}", self.name), positions, indices: self.indices.clone() }
    }
}

fn read_obj(path: &Path) -> (Vec<Vec3>, Vec<[u32; 3]>) {
    let options = tobj::LoadOptions { triangulate: true, ..tobj::LoadOptions::default() };
    let (parts, _) = tobj::load_obj_buf(
        &mut std::io::BufReader::new(std::fs::File::open(path).unwrap()),
        &options,
        |_| Err(tobj::LoadError::GenericFailure),
    )
    .unwrap();
    let (mut positions, mut indices) = (Vec::new(), Vec::new());
    for part in parts {
        let first = positions.len() as u32;
        positions.extend(part.mesh.positions.chunks(3).map(Vec3::from_slice));
        indices.extend(part.mesh.indices.chunks(3).map(|t| [t[0] + first, t[1] + first, t[2] + first]));
    }
    (positions, indices)
}

fn read_ply(path: &Path) -> (Vec<Vec3>, Vec<[u32; 3]>) {
    let bytes = std::fs::read(path).unwrap();
    let end = b"end_header\n";
    let start = bytes.windows(end.len()).position(|w| w == end).unwrap() + end.len();
    let header = std::str::from_utf8(&bytes[..start]).unwrap();
    assert!(header.contains("binary_little_endian"), "{}: another kind of PLY", path.display());
    let count = |element: &str| -> usize {
        let line = header.lines().find_map(|line| line.strip_prefix(element)).unwrap();
        line.trim().parse().unwrap()
    };
    let (vertices, faces) = bytes[start..].split_at(12 * count("element vertex"));
    let word = |bytes: &[u8], i: usize| <[u8; 4]>::try_from(&bytes[4 * i..4 * i + 4]).unwrap();
    let position = |v: &[u8]| Vec3::from([0, 1, 2].map(|i| f32::from_le_bytes(word(v, i))));
    let face = |f: &[u8]| {
        assert_eq!(f[0], 3, "not a triangle");
        [0, 1, 2].map(|i| u32::from_le_bytes(word(&f[1..], i)))
    };
    let faces = faces.chunks_exact(13).take(count("element face")).map(face);
    (vertices.chunks_exact(12).map(position).collect(), faces.collect())
}
