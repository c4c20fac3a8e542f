//! Triangle meshes and where they come from.

use std::fmt;
use std::path::PathBuf;

use glam::{Vec2, Vec3, Vec4};
use serde::{Deserialize, Serialize};

/// A mesh, how to get it again, and what had to be left out.
#[derive(Clone, PartialEq, Debug)]
pub struct MeshAsset {
    /// How to get it again: this, not the triangles, is what a scene file holds.
    pub source: MeshSource,
    /// The triangles.
    pub mesh: TriangleMesh,
    /// The triangles of the source that are not in `mesh`.
    pub dropped: Dropped,
}

/// Where a mesh comes from: a file or a recipe. Recipes are deterministic on every machine up to
/// the last bit of the platform's `sin` and `cos`.
#[derive(Clone, PartialEq, Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub enum MeshSource {
    /// All triangles of an .obj or .ply file. In a scene file the path is relative to the file's folder;
    /// in a world it is absolute.
    File(PathBuf),
    /// Primitive `primitive` of mesh `mesh` of a glTF model, both counted from 0.
    ModelPrimitive {
        /// A .gltf or .glb file; as for `File`.
        path: PathBuf,
        /// Index in the file's `meshes`.
        mesh: u32,
        /// Index in the mesh's `primitives`.
        primitive: u32,
    },
    /// The n-th (object, material) group of an .obj file, counted from 0 over the groups that have
    /// a triangle.
    FilePart(PathBuf, u32),
    /// The square [−½, ½]² of the XZ plane, facing +Y: two triangles.
    Quad,
    /// The cube [−½, ½]³, facing outwards: twelve triangles.
    Cube,
    /// A sphere of radius 1 as an icosahedron whose faces are split in four `subdivisions` times
    /// (at most 8).
    Icosphere {
        /// 0 is the icosahedron; 20 · 4ⁿ triangles.
        subdivisions: u32,
    },
    /// A tube along a torus knot around the Y axis; it fits a radius of 1.
    TorusKnot {
        /// Times round the axis; coprime to `q` for a single knot.
        p: u32,
        /// Times through the hole.
        q: u32,
        /// Radius of the tube, in (0, ½].
        tube: f32,
        /// Rings along the knot, 3..=4096.
        segments: u32,
        /// Corners of a ring, 3..=256.
        sides: u32,
    },
    /// A sitting rabbit, 1 high from y = 0, looking along +Z: a closed mesh with thin ears.
    Rabbit {
        /// 20 · `frequency`² triangles, 1..=512; 59 has those of the Stanford bunny (69,620).
        frequency: u32,
    },
    /// Hills: a height field over [−½, ½]² of XZ.
    Terrain {
        /// Picks the hills.
        seed: u32,
        /// Quads along an edge, 1..=2048.
        cells: u32,
        /// Height of the highest hill.
        height: f32,
    },
}

/// Triangles in object space (metres), counter-clockwise seen from the front.
///
/// Invariants: every index is below `positions.len()`; all positions that a triangle uses are finite, and
/// those from a file within ±2⁶⁰ on each axis; no triangle has two equal corners; `triangle_ids` is
/// strictly rising and as long as `triangles`; attributes are finite, and those that there are as many as positions.
#[derive(Clone, PartialEq, Debug, Default)]
pub struct TriangleMesh {
    /// Corners.
    pub positions: Vec<Vec3>,
    /// Three indices into `positions` each.
    pub triangles: Vec<[u32; 3]>,
    /// Which triangle of the source this is, so that ids outlive dropped neighbours.
    pub triangle_ids: Vec<u32>,
    /// Unit normal of each position, or empty.
    pub normals: Vec<Vec3>,
    /// Unit tangent of each position, and the sign of the bitangent (±1) in w, or empty.
    pub tangents: Vec<Vec4>,
    /// Two sets of texture coordinates of each position (v downwards, as in glTF), each possibly empty.
    pub uvs: [Vec<Vec2>; 2],
    /// Linear colour and opacity of each position, in [0, 1], or empty.
    pub colors: Vec<Vec4>,
}

impl TriangleMesh {
    /// A mesh of all `triangles`, numbered in order.
    pub(crate) fn numbered(positions: Vec<Vec3>, triangles: Vec<[u32; 3]>) -> Self {
        let triangle_ids = (0..).take(triangles.len()).collect();
        Self { positions, triangles, triangle_ids, ..Self::default() }
    }

    /// Smallest and largest coordinates of the corners that triangles use; `None` if there is no
    /// triangle.
    pub fn bounds(&self) -> Option<(Vec3, Vec3)> {
        self.triangles
            .iter()
            .flatten()
            .filter_map(|&index| self.positions.get(index as usize))
            .map(|&p| (p, p))
            .reduce(|(min, max), (p, _)| (min.min(p), max.max(p)))
    }
}

/// Triangles that a file has but a mesh has not, by reason.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default)]
pub struct Dropped {
    /// A corner does not exist.
    pub bad_index: u32,
    /// A corner is NaN, infinite or farther than 2⁶⁰ (about 1e18) from the origin on an axis.
    pub out_of_range: u32,
    /// No area: equal or collinear corners.
    pub zero_area: u32,
}

impl Dropped {
    /// All of them.
    pub fn total(&self) -> u32 {
        self.bad_index.saturating_add(self.out_of_range).saturating_add(self.zero_area)
    }

    /// These and those of another mesh.
    pub fn plus(self, more: Self) -> Self {
        Self {
            bad_index: self.bad_index.saturating_add(more.bad_index),
            out_of_range: self.out_of_range.saturating_add(more.out_of_range),
            zero_area: self.zero_area.saturating_add(more.zero_area),
        }
    }
}

impl fmt::Display for Dropped {
    /// The reasons that occur, as `2 bad index, 1 zero area`.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let mut separator = "";
        for (count, reason) in [
            (self.bad_index, "bad index"),
            (self.out_of_range, "not finite or beyond 1e18"),
            (self.zero_area, "zero area"),
        ] {
            if count > 0 {
                write!(f, "{separator}{count} {reason}")?;
                separator = ", ";
            }
        }
        Ok(())
    }
}
