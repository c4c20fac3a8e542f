//! An object of the joined tree: its triangles, and what their corners carry, brought into the tree's coordinates.
//!
//! A transform that mirrors turns the front of a triangle to its back, where an instance's would not: there the second and
//! third corner change places.
use glam::{DAffine3, DMat3, DVec3, Vec3};
use luxel_flat::{
    INSTANCE_ATTRIBUTES, INSTANCE_COLORS, INSTANCE_NORMALS, INSTANCE_TANGENTS, Span, Triangle,
    TriangleAttributes,
};
use luxel_geom::octahedral;

use crate::instances::Source;
use crate::store::Heaps;

/// White, without holes.
const WHITE: [u32; 2] = [u32::MAX; 2];

/// An object of the joined tree.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Piece {
    pub stable_id: u32,
    /// Number of its first triangle among all pieces.
    pub first: u32,
    /// Its triangles in the mesh's coordinates and order.
    pub triangles: Span,
    /// Material slot.
    pub material: u32,
    /// `INSTANCE_…`.
    pub flags: u32,
    /// From the slot of one of its triangles to that of its attributes, modulo 2³².
    attribute_offset: u32,
    world_from_object: DAffine3,
}

impl Piece {
    /// The piece that an object would be an instance of its own as; its number is not known yet.
    pub(super) fn of(source: &Source) -> Self {
        let header = &source.header;
        Self {
            stable_id: header.stable_id,
            first: 0,
            triangles: Span { first: header.primitive_first, count: header.primitive_count },
            material: header.material_first,
            flags: header.flags,
            attribute_offset: header.attribute_offset,
            world_from_object: source.placement.world_from_object(),
        }
    }

    /// The numbers of its triangles.
    pub(super) fn numbers(&self) -> std::ops::Range<usize> {
        Span { first: self.first, count: self.triangles.count }.range()
    }

    /// The corners of its triangles, relative to a point of the world.
    pub(super) fn places<'a>(
        &self,
        heaps: &'a Heaps,
        anchor: DVec3,
    ) -> impl Iterator<Item = [Vec3; 3]> + use<'a> {
        let piece = *self;
        let triangles = heaps.triangles.heap.as_slice().get(self.triangles.range()).unwrap_or_default();
        let DAffine3 { matrix3, translation } = piece.world_from_object;
        let place =
            move |v: [f32; 3]| (matrix3 * Vec3::from(v).as_dvec3() + (translation - anchor)).as_vec3();
        triangles.iter().map(move |triangle| piece.turned(triangle.vertices().map(place)))
    }

    /// What the corners of one of its triangles carry; `joined` is in the tree's coordinates, `flags` say what all do.
    /// What this piece's corners lack changes nothing: normals of the triangle, white.
    pub(super) fn attributes(&self, joined: &Triangle, flags: u32, heaps: &Heaps) -> TriangleAttributes {
        let slot = self.triangles.first + (joined.id - self.first);
        let at = slot.wrapping_add(self.attribute_offset) as usize;
        let own = heaps.triangle_attributes.heap.as_slice().get(at);
        let own = own.filter(|_| self.flags & INSTANCE_ATTRIBUTES != 0).copied().unwrap_or_default();
        let has = |flag: u32| self.flags & flags & flag != 0;
        let face = face_normal(joined);
        let normals = if has(INSTANCE_NORMALS) {
            let matrix = self.world_from_object.matrix3.inverse().transpose();
            self.turned(own.normals)
                .map(|code| octahedral::encode(through(&matrix, octahedral::decode::<f64>(code), face)))
        } else {
            [octahedral::encode(face); 3]
        };
        TriangleAttributes {
            normals,
            tangents: if has(INSTANCE_TANGENTS) { self.tangents(&own) } else { [0; 3] },
            uv0: self.turned(own.uv0),
            uv1: self.turned(own.uv1),
            colors: if has(INSTANCE_COLORS) { self.turned(own.colors) } else { [WHITE; 3] },
        }
    }

    /// A mirrored object has mirrored maps.
    fn tangents(&self, own: &TriangleAttributes) -> [u32; 3] {
        self.turned(own.tangents).map(|code| {
            let (tangent, sign) = octahedral::decode_tangent::<f64>(code);
            let tangent = through(&self.world_from_object.matrix3, tangent, tangent.as_vec3());
            octahedral::encode_tangent(tangent, (sign < 0.0) != self.is_mirrored())
        })
    }

    fn is_mirrored(&self) -> bool {
        self.world_from_object.matrix3.determinant() < 0.0
    }

    fn turned<T>(&self, [a, b, c]: [T; 3]) -> [T; 3] {
        if self.is_mirrored() { [a, c, b] } else { [a, b, c] }
    }
}

/// A direction after a matrix; another one if nothing is left of it.
fn through(matrix: &DMat3, direction: DVec3, otherwise: Vec3) -> Vec3 {
    (*matrix * direction).try_normalize().map_or(otherwise, |unit| unit.as_vec3())
}

/// The unit normal of a triangle; any for one without area.
fn face_normal(triangle: &Triangle) -> Vec3 {
    let [a, b, c] = triangle.vertices().map(|v| Vec3::from(v).as_dvec3());
    (b - a).cross(c - a).try_normalize().unwrap_or(DVec3::Z).as_vec3()
}
