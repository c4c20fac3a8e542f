//! What the corners of a triangle carry, interpolated at a point of it.
use luxel_flat::{
    FlatScene, INSTANCE_ATTRIBUTES, INSTANCE_COLORS, INSTANCE_NORMALS, INSTANCE_TANGENTS, Instance,
    TriangleAttributes,
};
use luxel_geom::{Real, octahedral};

use crate::mesh;
use crate::texture::Rgba;

/// Attributes at a point, vectors in the mesh's space and of any length.
#[derive(Clone, Copy, Debug)]
pub struct Attributes<R: Real> {
    /// Smooth normal, if the mesh has any.
    pub normal: Option<R::Vec3>,
    /// Both sets of texture coordinates.
    pub uv: [[R; 2]; 2],
    /// Linear colour and opacity; white without.
    pub color: Rgba<R>,
}

/// The record of a triangle's attributes, for meshes that have any.
pub fn record<'a>(scene: &'a FlatScene, instance: &Instance, slot: u32) -> Option<&'a TriangleAttributes> {
    if instance.flags & INSTANCE_ATTRIBUTES == 0 {
        return None;
    }
    scene.triangle_attributes.as_slice().get(slot.wrapping_add(instance.attribute_offset) as usize)
}

/// The attributes at a point with barycentric weights `uv` of the second and third vertex.
pub fn vertex_attributes<R: Real>(
    record: &TriangleAttributes,
    instance: &Instance,
    uv: [R; 2],
) -> Attributes<R> {
    let weights = weights(uv);
    let normal = (instance.flags & INSTANCE_NORMALS != 0)
        .then(|| mixed_vector::<R>(record.normals.map(octahedral::decode::<R>), weights));
    Attributes {
        normal,
        uv: [coordinates(&record.uv0, weights), coordinates(&record.uv1, weights)],
        color: color(record, instance, weights),
    }
}

/// The tangent along which the texture's first coordinate grows, and the side of the bitangent: the mesh's own, or
/// from the texture coordinates of the triangle.
pub fn tangent<R: Real>(
    scene: &FlatScene,
    record: &TriangleAttributes,
    instance: &Instance,
    (slot, uv): (u32, [R; 2]),
    set: usize,
) -> (R::Vec3, R) {
    if instance.flags & INSTANCE_TANGENTS == 0 {
        let vertices = mesh::vertices::<R>(&scene.triangles.as_slice()[slot as usize]);
        return tangent_of_coordinates(&vertices, if set == 0 { &record.uv0 } else { &record.uv1 });
    }
    let corners = record.tangents.map(octahedral::decode_tangent::<R>);
    (mixed_vector::<R>(corners.map(|(tangent, _)| tangent), weights(uv)), corners[0].1)
}

/// Direction in which u grows (Lengyel 2001), and the side of the bitangent.
fn tangent_of_coordinates<R: Real>(vertices: &[R::Vec3; 3], uv: &[[f32; 2]; 3]) -> (R::Vec3, R) {
    let corner = uv.map(|c| c.map(R::from_f32));
    let [du1, dv1] = [corner[1][0] - corner[0][0], corner[1][1] - corner[0][1]];
    let [du2, dv2] = [corner[2][0] - corner[0][0], corner[2][1] - corner[0][1]];
    let (edge1, edge2) = (vertices[1] - vertices[0], vertices[2] - vertices[0]);
    // glTF's v runs down the image and a normal map's y up: seen from the front, u and v of an image that is not
    // mirrored turn the other way round.
    let turn = if du1 * dv2 - du2 * dv1 < R::ZERO { -R::ONE } else { R::ONE };
    ((edge1 * dv2 - edge2 * dv1) * turn, -turn)
}

/// Opacity that the corners carry.
pub fn opacity<R: Real>(record: &TriangleAttributes, instance: &Instance, uv: [R; 2]) -> R {
    color(record, instance, weights(uv))[3]
}

/// Both sets of texture coordinates.
pub fn texture_coordinates<R: Real>(record: &TriangleAttributes, uv: [R; 2]) -> [[R; 2]; 2] {
    let weights = weights(uv);
    [coordinates(&record.uv0, weights), coordinates(&record.uv1, weights)]
}

fn weights<R: Real>(uv: [R; 2]) -> [R; 3] {
    [R::ONE - uv[0] - uv[1], uv[0], uv[1]]
}

fn color<R: Real>(record: &TriangleAttributes, instance: &Instance, weights: [R; 3]) -> Rgba<R> {
    if instance.flags & INSTANCE_COLORS == 0 {
        return [R::ONE; 4];
    }
    let corners = record.colors.map(|[rg, ba]| [rg & 0xffff, rg >> 16, ba & 0xffff, ba >> 16]);
    core::array::from_fn(|k| mixed(corners.map(|c| R::from_f64(f64::from(c[k]) / 65535.0)), weights))
}

fn coordinates<R: Real>(corners: &[[f32; 2]; 3], weights: [R; 3]) -> [R; 2] {
    core::array::from_fn(|k| mixed(corners.map(|c| R::from_f32(c[k])), weights))
}

fn mixed<R: Real>(corners: [R; 3], weights: [R; 3]) -> R {
    corners[0] * weights[0] + corners[1] * weights[1] + corners[2] * weights[2]
}

fn mixed_vector<R: Real>(corners: [R::Vec3; 3], weights: [R; 3]) -> R::Vec3 {
    corners[0] * weights[0] + corners[1] * weights[1] + corners[2] * weights[2]
}
