//! Primitives of glTF meshes as triangle meshes.

use glam::{Vec2, Vec3, Vec4};
use gltf::json::accessor::{Accessor, Type};
use gltf::json::mesh::{Mode, Primitive, Semantic};
use gltf::json::validation::Checked;
use gltf::json::{Index, Root};

use crate::assets::{Dropped, TriangleMesh};

use super::super::assemble::{Assembled, assemble};
use super::accessors::Elements;
use super::buffers::Buffers;
use super::extensions::Ignored;

/// How many triangles may still be made: what a file says many times costs it nothing and us memory.
#[derive(Debug)]
pub(super) struct Budget {
    left: u64,
    whole: u64,
}

/// Triangles that any file may have.
const FREE_TRIANGLES: u64 = 1 << 20;

/// Triangles per byte of a file: a triangle takes three bytes of indices, so they may be used a dozen times.
const TRIANGLES_PER_BYTE: u64 = 4;

/// The most triangles of a file.
const MAX_TRIANGLES: u64 = 200_000_000;

impl Budget {
    /// For a file of `bytes`, buffers included.
    pub(super) fn new(bytes: u64) -> Self {
        let whole = bytes.saturating_mul(TRIANGLES_PER_BYTE).clamp(FREE_TRIANGLES, MAX_TRIANGLES);
        Self { left: whole, whole }
    }

    fn take(&mut self, triangles: u64) -> Result<(), String> {
        self.left = self.left.checked_sub(triangles).ok_or_else(|| {
            format!("makes more triangles than a file of its length may have ({})", self.whole)
        })?;
        Ok(())
    }
}

/// A primitive's triangles, and those left out.
#[derive(Debug, Default)]
pub(super) struct Shape {
    pub(super) mesh: TriangleMesh,
    pub(super) dropped: Dropped,
    /// Triangles in the file.
    pub(super) total: u32,
    /// Normals that were none.
    pub(super) mended_normals: u32,
}

/// The triangles of `primitive`; `None` if it has none by its kind, which `ignored` then says.
///
/// # Errors
/// What is wrong with its accessors.
pub(super) fn shape(
    root: &Root,
    buffers: &Buffers,
    primitive: &Primitive,
    budget: &mut Budget,
    ignored: &mut Ignored,
) -> Result<Option<Shape>, String> {
    let Checked::Valid(mode) = primitive.mode else {
        return Err("is of an unknown mode".to_owned());
    };
    if matches!(mode, Mode::Points | Mode::Lines | Mode::LineLoop | Mode::LineStrip) {
        ignored.add("points and lines", "primitive");
        return Ok(None);
    }
    let Some(positions) = attribute(primitive, Semantic::Positions) else {
        ignored.add("no positions", "primitive");
        return Ok(None);
    };
    refuse_compressed(root, primitive, positions)?;
    let positions = Elements::new(root, buffers, positions, &[Type::Vec3])?;
    let order = match primitive.indices {
        Some(indices) => Order::Indices(indices_of(root, buffers, indices)?),
        None => Order::Running(positions.len()),
    };
    let count = triangles_of(mode, order.len());
    budget.take(count as u64)?;
    let position = |index: u32| {
        ((index as usize) < positions.len()).then(|| Vec3::from_array(positions.numbers(index as usize)))
    };
    let triangles = (0..count).map(|n| corners(mode, n).map(|at| order.at(at)));
    let mut assembled = assemble(positions.len(), position, triangles);
    let mended_normals = set_attributes(root, buffers, primitive, &mut assembled, ignored)?;
    let Assembled { mesh, dropped, total, .. } = assembled;
    Ok(Some(Shape { mesh, dropped, total, mended_normals }))
}

/// Compressed meshes leave their accessors empty, which without the extension reads as zeros.
fn refuse_compressed(root: &Root, primitive: &Primitive, positions: Index<Accessor>) -> Result<(), String> {
    let is_empty = root.get(positions).is_some_and(|it| it.buffer_view.is_none() && it.sparse.is_none());
    let extensions = primitive.extensions.as_ref().map(|extensions| &extensions.others);
    let name =
        extensions.into_iter().flat_map(|others| others.keys()).find(|name| name.contains("compression"));
    match name {
        Some(name) if is_empty => {
            Err(format!("is stored by the glTF extension {name}, which this program does not have"))
        }
        _ => Ok(()),
    }
}

fn attribute(primitive: &Primitive, semantic: Semantic) -> Option<Index<Accessor>> {
    primitive.attributes.get(&Checked::Valid(semantic)).copied()
}

fn indices_of<'a>(root: &Root, buffers: &'a Buffers, index: Index<Accessor>) -> Result<Elements<'a>, String> {
    let indices = Elements::new(root, buffers, index, &[Type::Scalar])?;
    if indices.are_indices() {
        Ok(indices)
    } else {
        Err(format!("accessor {} holds no unsigned integers, so they are no indices", index.value()))
    }
}

/// Corners in the order in which triangles use them.
enum Order<'a> {
    Indices(Elements<'a>),
    Running(usize),
}

impl Order<'_> {
    fn len(&self) -> usize {
        match self {
            Self::Indices(indices) => indices.len(),
            Self::Running(count) => *count,
        }
    }

    fn at(&self, place: usize) -> u32 {
        match self {
            Self::Indices(indices) => indices.index(place),
            Self::Running(_) => u32::try_from(place).unwrap_or(u32::MAX),
        }
    }
}

fn triangles_of(mode: Mode, corners: usize) -> usize {
    match mode {
        Mode::TriangleStrip | Mode::TriangleFan => corners.saturating_sub(2),
        _ => corners / 3,
    }
}

/// The places of triangle `n`'s corners (glTF 2.0, section 3.7.2.1).
fn corners(mode: Mode, n: usize) -> [usize; 3] {
    match mode {
        Mode::TriangleStrip => [n, n + 1 + n % 2, n + 2 - n % 2],
        Mode::TriangleFan => [n + 1, n + 2, 0],
        _ => [3 * n, 3 * n + 1, 3 * n + 2],
    }
}

/// Fills in what there is; returns how many normals were none.
fn set_attributes(
    root: &Root,
    buffers: &Buffers,
    primitive: &Primitive,
    assembled: &mut Assembled,
    ignored: &mut Ignored,
) -> Result<u32, String> {
    let read = |semantic, types: &[Type]| -> Result<Option<Elements<'_>>, String> {
        let index = attribute(primitive, semantic);
        index.map(|index| Elements::new(root, buffers, index, types)).transpose()
    };
    let mut mended = 0;
    if let Some(normals) = read(Semantic::Normals, &[Type::Vec3])? {
        mended = assembled.set_normals(|index| Vec3::from_array(normals.numbers(index as usize)));
        if let Some(tangents) = read(Semantic::Tangents, &[Type::Vec4])?
            && !assembled.set_tangents(|index| Vec4::from_array(tangents.numbers(index as usize)))
        {
            ignored.add("tangents that are none", "primitive");
        }
    }
    for set in [0, 1] {
        if let Some(uvs) = read(Semantic::TexCoords(set), &[Type::Vec2])? {
            assembled.set_uvs(set as usize, |index| Vec2::from_array(uvs.numbers(index as usize)));
        }
    }
    if let Some(colors) = read(Semantic::Colors(0), &[Type::Vec3, Type::Vec4])? {
        let has_alpha = colors.width() == 4;
        assembled.set_colors(|index| {
            let color = Vec4::from_array(colors.numbers(index as usize));
            if has_alpha { color } else { color.truncate().extend(1.0) }
        });
    }
    for semantic in primitive.attributes.keys() {
        if let Checked::Valid(Semantic::TexCoords(2..) | Semantic::Colors(1..)) = semantic {
            ignored.add("texture coordinates beyond two sets and colours beyond one", "primitive");
        }
    }
    if primitive.targets.as_ref().is_some_and(|targets| !targets.is_empty()) {
        ignored.add("morph targets, shown in their rest pose", "primitive");
    }
    Ok(mended)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn strips_and_fans_keep_their_winding() {
        let all = |mode, count| (0..triangles_of(mode, count)).map(|n| corners(mode, n)).collect::<Vec<_>>();
        assert_eq!(all(Mode::TriangleStrip, 5), [[0, 1, 2], [1, 3, 2], [2, 3, 4]]);
        assert_eq!(all(Mode::TriangleFan, 5), [[1, 2, 0], [2, 3, 0], [3, 4, 0]]);
        assert_eq!(all(Mode::Triangles, 7), [[0, 1, 2], [3, 4, 5]]);
        assert!(all(Mode::TriangleStrip, 1).is_empty());
    }

    #[test]
    fn a_budget_is_spent_once() {
        let mut budget = Budget::new(10);
        assert!(budget.take(FREE_TRIANGLES - 1).is_ok());
        assert!(budget.take(2).is_err() && budget.take(1).is_ok() && budget.take(1).is_err());
    }
}
