//! The corners of a mesh's triangles with everything that they carry, and their packed records.
use glam::{DVec3, Vec2, Vec3, Vec4};
use luxel_flat::{Triangle, TriangleAttributes};
use luxel_geom::{frame::Frame, octahedral};
use luxel_scene::TriangleMesh;
use rayon::prelude::*;

use super::{Normals, smooth, tangents};

/// A tangent, and whether the bitangent is on the negative side.
pub(super) type Tangent = (Vec3, bool);

/// What corners carry that is not just copied, by triangle of the mesh.
pub(super) struct Corners {
    normals: Option<Vec<[Vec3; 3]>>,
    tangents: Option<Vec<[Tangent; 3]>>,
    mended: u32,
}

/// An attribute that every position has; `None` if they have none.
pub(super) fn of_each<'a, T>(values: &'a [T], mesh: &TriangleMesh) -> Option<&'a [T]> {
    (!values.is_empty() && values.len() == mesh.positions.len()).then_some(values)
}

/// The values at a triangle's corners.
pub(super) fn at<T: Copy + Default>(values: &[T], triangle: [u32; 3]) -> [T; 3] {
    triangle.map(|corner| values.get(corner as usize).copied().unwrap_or_default())
}

/// The unit normal of a triangle; zero for one without area.
pub(super) fn face_normal(mesh: &TriangleMesh, triangle: [u32; 3]) -> DVec3 {
    let [a, b, c] = at(&mesh.positions, triangle).map(|p| p.as_dvec3());
    (b - a).cross(c - a).normalize_or_zero()
}

impl Corners {
    /// Normals of that kind, all of unit length and on their triangle's side.
    pub(super) fn of(mesh: &TriangleMesh, normals: Normals) -> Self {
        let mut corners = match normals {
            Normals::Flat => return Self { normals: None, tangents: None, mended: 0 },
            Normals::Own => mesh.triangles.iter().map(|triangle| at(&mesh.normals, *triangle)).collect(),
            Normals::Smooth(crease_angle) => smooth::normals(mesh, f32::from_bits(crease_angle)),
        };
        let with_faces = corners.iter_mut().zip(&mesh.triangles);
        let mended =
            with_faces.filter_map(|(c, triangle)| mend(c, face_normal(mesh, *triangle)).then_some(()));
        let mended = mended.count() as u32;
        Self { normals: Some(corners), tangents: None, mended }
    }

    /// Tangents for a set of texture coordinates: the file's, if its normals are in use, else computed.
    pub(super) fn find_tangents(&mut self, mesh: &TriangleMesh, uv_set: u32, normals: Normals) {
        let normals_at = |triangle: usize| match &self.normals {
            Some(normals) => normals[triangle],
            None => [face_normal(mesh, mesh.triangles[triangle]).as_vec3(); 3],
        };
        let own = of_each(&mesh.tangents, mesh).filter(|_| normals == Normals::Own);
        let uvs = mesh.uvs.get(uv_set as usize).and_then(|uvs| of_each(uvs, mesh));
        let found = match (own, uvs) {
            (Some(own), _) => mesh.triangles.iter().map(|t| at(own, *t).map(of_file)).collect(),
            (None, Some(uvs)) => tangents::compute(mesh, uvs, normals_at),
            (None, None) => return,
        };
        let mended = found.into_iter().enumerate().map(|(i, tangents): (usize, [Option<Tangent>; 3])| {
            let normals = normals_at(i);
            // Where there is none, any will do.
            std::array::from_fn(|k| tangents[k].unwrap_or((Frame::<f32>::around(normals[k]).s, false)))
        });
        self.tangents = Some(mended.collect());
    }

    pub(super) fn has_normals(&self) -> bool {
        self.normals.is_some()
    }

    pub(super) fn has_tangents(&self) -> bool {
        self.tangents.is_some()
    }

    /// Triangles whose normals had to be put right.
    pub(super) fn mended(&self) -> u32 {
        self.mended
    }

    /// The records of triangles of the mesh, in the order that they stand in.
    pub(super) fn records(&self, mesh: &TriangleMesh, triangles: &[Triangle]) -> Vec<TriangleAttributes> {
        let record = |triangle: &Triangle| {
            let index = mesh.triangle_ids.binary_search(&triangle.id).ok();
            index.map_or(TriangleAttributes::default(), |index| self.record(mesh, index))
        };
        triangles.par_iter().map(record).collect()
    }

    fn record(&self, mesh: &TriangleMesh, index: usize) -> TriangleAttributes {
        let triangle = mesh.triangles[index];
        let places = |uvs: &[Vec2]| at(uvs, triangle).map(|uv| uv.to_array());
        let normals = self.normals.as_ref().map(|normals| normals[index].map(octahedral::encode));
        let tangents = self.tangents.as_ref().map(|tangents| {
            tangents[index].map(|(tangent, negative)| octahedral::encode_tangent(tangent, negative))
        });
        TriangleAttributes {
            normals: normals.unwrap_or_default(),
            tangents: tangents.unwrap_or_default(),
            uv0: places(&mesh.uvs[0]),
            uv1: places(&mesh.uvs[1]),
            colors: at(&mesh.colors, triangle).map(pack_color),
        }
    }
}

/// Puts the normals of a triangle right: unit length, not all on the far side. True if more than a length was wrong.
fn mend(normals: &mut [Vec3; 3], face: DVec3) -> bool {
    let mut is_mended = false;
    for normal in normals.iter_mut() {
        let unit = normal.as_dvec3().try_normalize();
        is_mended |= unit.is_none();
        *normal = unit.unwrap_or(face).as_vec3();
    }
    let sides = normals.map(|normal| normal.as_dvec3().dot(face));
    if sides.iter().all(|side| *side <= 0.0) {
        is_mended = true;
        let is_reversed = sides.iter().any(|side| *side < 0.0);
        *normals = if is_reversed { normals.map(|normal| -normal) } else { [face.as_vec3(); 3] };
    }
    is_mended
}

fn of_file(tangent: Vec4) -> Option<Tangent> {
    Some((tangent.truncate().try_normalize()?, tangent.w < 0.0))
}

/// Red and green, blue and alpha, as 16-bit fractions.
fn pack_color(color: Vec4) -> [u32; 2] {
    let [r, g, b, a] = color.to_array().map(|c| (c.clamp(0.0, 1.0) * 65535.0).round() as u32);
    [g << 16 | r, a << 16 | b]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn normals_are_mended_only_where_they_are_wrong() {
        let mended = |normals: [Vec3; 3]| {
            let mut normals = normals;
            let is_mended = mend(&mut normals, DVec3::Z);
            (is_mended, normals)
        };
        let tilted = Vec3::new(0.6, 0.0, 0.8);
        assert_eq!(mended([tilted * 3.0; 3]), (false, [tilted; 3]));
        assert_eq!(mended([tilted, -Vec3::Z, Vec3::Z]), (false, [tilted, -Vec3::Z, Vec3::Z]));
        assert_eq!(mended([tilted, Vec3::ZERO, Vec3::NAN]), (true, [tilted, Vec3::Z, Vec3::Z]));
        assert_eq!(mended([-tilted, -Vec3::Z, Vec3::X]), (true, [tilted, Vec3::Z, Vec3::NEG_X]));
        assert_eq!(mended([Vec3::X; 3]), (true, [Vec3::Z; 3]));
    }

    #[test]
    fn colors_are_fractions_of_65535() {
        assert_eq!(pack_color(Vec4::new(0.0, 1.0, 0.5, 2.0)), [0xffff_0000, 0xffff_8000]);
    }
}
