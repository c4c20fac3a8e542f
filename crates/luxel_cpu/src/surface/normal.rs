//! The normal that a material is shaded with: interpolated, bent by a normal map, and kept from mirroring light into
//! the surface.
use luxel_flat::{Counter, Counters, FlatScene, Instance, TEXTURE_UV1, TextureSlot};
use luxel_geom::{Affine, Real, Vector, normal_guard};

use super::attributes;
use crate::texture::{Rgba, sample_texture};

/// A direction in tracer space, of length one; `fallback` if it has no length.
fn unit<R: Real>(v: R::Vec3, fallback: R::Vec3) -> R::Vec3 {
    let length = v.length();
    if length > R::ZERO { v * (R::ONE / length) } else { fallback }
}

/// An interpolated normal in tracer space, on the side of the geometric one. `object_from_world` is the instance's.
pub(super) fn smooth_normal<R: Real>(
    normal: R::Vec3,
    object_from_world: &Affine<R>,
    geometric: R::Vec3,
) -> R::Vec3 {
    let smooth = unit::<R>(object_from_world.normal_by_transpose(normal), geometric);
    if smooth.dot(geometric) < R::ZERO { -smooth } else { smooth }
}

/// The normal of a normal map. `normal` is what it would be without.
pub(super) fn apply_normal_map<R: Real>(
    scene: &FlatScene,
    instance: &Instance,
    slot: &TextureSlot,
    (triangle, weights): (u32, [R; 2]),
    normal: R::Vec3,
    counters: &mut Counters,
) -> R::Vec3 {
    let Some(record) = attributes::record(scene, instance, triangle) else { return normal };
    counters[Counter::NormalMapReads] += 1;
    let uv = attributes::texture_coordinates(record, weights);
    let texel = sample_texture(scene, slot, &uv, counters);
    let set = usize::from(slot.flags & TEXTURE_UV1 != 0);
    let (tangent, side) = attributes::tangent(scene, record, instance, (triangle, weights), set);
    bent(instance, slot, texel, (tangent, side), normal)
}

fn bent<R: Real>(
    instance: &Instance,
    slot: &TextureSlot,
    [x, y, z, _]: Rgba<R>,
    (tangent, side): (R::Vec3, R),
    normal: R::Vec3,
) -> R::Vec3 {
    let world_from_object = Affine::<R>::from_rows(&instance.world_from_object);
    let along = world_from_object.vector(tangent);
    let level = along - normal * along.dot(normal);
    if level.length() <= R::ZERO {
        return normal;
    }
    let s = level.normalized();
    // A mirrored object has mirrored maps.
    let [a, b, c] = world_from_object.rows;
    let side = if a.cross(b).dot(c) < R::ZERO { -side } else { side };
    let t = normal.cross(s) * side;
    let signed = |code: R| code * R::from_f64(2.0) - R::ONE;
    let scale = R::from_f32(slot.scale);
    let bent = s * (signed(x) * scale) + t * (signed(y) * scale) + normal * signed(z);
    unit::<R>(bent, normal)
}

/// The shading normal on the side of the geometric one, bent so that it mirrors no light into the surface.
/// `direction` is that of the ray.
pub(super) fn kept_valid<R: Real>(normal: R::Vec3, geometric: R::Vec3, direction: R::Vec3) -> R::Vec3 {
    let wo = -direction;
    let side = if wo.dot(geometric) >= R::ZERO { R::ONE } else { -R::ONE };
    normal_guard::valid_shading_normal::<R>(geometric * side, normal * side, wo) * side
}
