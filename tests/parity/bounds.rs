//! How far a WGSL function may be from its Rust twin, and why: the one table of these bounds.
//!
//! Unit: u = 2⁻²⁴, the unit round-off. What WGSL allows (§15.7.4): +, −, × rounded to either neighbour (2u), `/` 2.5 ulp
//! (5u), `inverseSqrt` 2 ulp, `sqrt` as 1 / inverseSqrt (10u), fusing and reordering. Rust rounds each operation
//! once (1u). `forward` is a share of the result's own scale; where the errors of a function differ from call to call, its
//! case counts them itself, in u and up to `most`, and `forward` is one. Where the result is ill-conditioned (a tangent
//! ray, a grazing triangle, the critical angle), the result must be that of inputs which differ by `backward` u each.
//! Errors that are within neither are told, so the largest of a function that is ill-conditioned anywhere comes close to
//! `forward`.
use luxel_testkit::Random;

use crate::judge::{Input, jitter};
use crate::lighting::near_sky;

/// WGSL's sin and cos: 2⁻¹¹, absolute, between −π and π.
pub(crate) const SINE: f32 = 8192.0;
/// WGSL's atan2: 4096 ulp, in parts of the angle.
pub(crate) const ATAN2: f32 = 8192.0;
/// Decoding a number by the sRGB curve: a sum, a product and the constant (5u, times the exponent), log2 (3 ulp of up to
/// 4.3, times the exponent, 58u), the product (20u), both through exp2's slope of 0.69, and exp2 itself ((3 + 2 · 10.2) ulp,
/// 47u): 113u, and Rust 8u.
pub(crate) const SRGB: f32 = 128.0;
/// No call of [`crate::surfaces`]'s `level_hemisphere` may be wrong by more, whatever its case counts.
pub(crate) const LEVEL: f32 = 16384.0;
/// As [`LEVEL`], for `valid_shading_normal`: two mirrors and two lengths.
pub(crate) const GUARD: f32 = 128.0;
/// As [`LEVEL`], for textures, and for what surfaces take from them.
pub(crate) const TEXTURE: f32 = 256.0;
/// As [`LEVEL`], for `sky_light`.
pub(crate) const SKY: f32 = 8192.0;
/// As [`LEVEL`], for `medium_transmittance`: 8 + 7 · 80, the exponent at which light is black.
pub(crate) const ABSORPTION: f32 = 568.0;
const BY_SINE: &str = "WGSL's sin and cos of an angle";

/// The bound of a function.
pub(crate) struct Bound {
    pub(crate) function: &'static str,
    /// Largest error in u of the result's scale.
    pub(crate) forward: f32,
    /// The same in u of a result itself: those that are off by eight times as much are told.
    pub(crate) most: f32,
    /// Largest relative change in u of inputs that explains a larger error.
    pub(crate) backward: f32,
    /// An input that differs from one by no more than a share.
    pub(crate) near: fn(&Input, f32, &mut Random) -> Input,
    #[expect(dead_code, reason = "for the reader of the table")]
    because: &'static str,
}

const fn bound(function: &'static str, forward: f32, backward: f32, because: &'static str) -> Bound {
    Bound { function, forward, most: forward, backward, near: jitter, because }
}

/// The bound of a function whose case counts its errors itself, none larger than `most`.
const fn counted(function: &'static str, most: f32, backward: f32, because: &'static str) -> Bound {
    Bound { most, ..bound(function, 1.0, backward, because) }
}

/// In the order of the cases.
pub(crate) const BOUNDS: [Bound; 48] = [
    bound("box_interval", 16.0, 4.0, "difference 2u, reciprocal 5u, product 2u, pad 2u; Rust 4u"),
    bound(
        "intersect_sphere",
        64.0,
        16.0,
        "two lengths, a root and two quotients: 40u and Rust 16u; tangents",
    ),
    bound(
        "intersect_triangle",
        64.0,
        16.0,
        "shear 7u, edges 6u, three quotients 10u, sums 12u; grazing rays",
    ),
    bound("intersect_voxel", 16.0, 4.0, "as box_interval; on edges the face may differ"),
    bound(
        "to_world",
        32.0,
        0.0,
        "a quotient and three products and sums per component, in parts of the length",
    ),
    bound(
        "fresnel_dielectric",
        64.0,
        8.0,
        "a root and three quotients: 30u and Rust 10u, doubled by the squares",
    ),
    bound("concentric_disk", SINE, 4.0, BY_SINE),
    bound("uniform_sphere", SINE, 4.0, BY_SINE),
    bound("offset_origin", 16.0, 0.0, "a scalar product, a product, a sum, a neighbour: 10u and Rust 6u"),
    bound("transform_point", 24.0, 0.0, "four products and three sums, in parts of the sum of their sizes"),
    bound("transform_point_error", 32.0, 0.0, "all terms are positive: eight operations, gamma itself 9u"),
    bound(
        "tone_map",
        512.0,
        0.0,
        "log2 and exp2: 2^-21 each, through slopes of up to 13; a code value is 65,536u",
    ),
    bound(
        "masking_shadowing",
        96.0,
        0.0,
        "two roots and a quotient: 30u; the root of both in a sum of positive terms",
    ),
    bound(
        "visible_normal_pdf",
        96.0,
        0.0,
        "a spread of positive terms (12u), squared, a quotient and a root; Rust half of it",
    ),
    bound("sample_visible_normal", 2.0 * SINE, 8.0, "WGSL's sin and cos, of which a root is one more"),
    bound(
        "refraction_normal",
        64.0,
        8.0,
        "a length and a quotient, in parts of the summands; turned over at the horizon",
    ),
    bound(
        "refraction_jacobian",
        64.0,
        0.0,
        "scalar products in parts of their summands, squares and a quotient",
    ),
    bound("fresnel_schlick", 48.0, 0.0, "a fifth power of a difference: 2u of 1, five times, and a blend"),
    bound(
        "fresnel_dielectric_schlick",
        96.0,
        8.0,
        "as fresnel_dielectric, and a fifth power; the critical angle",
    ),
    bound(
        "conductor_loss",
        2048.0,
        0.0,
        "a place is wrong by 30u, of 64 entries that differ by less than one",
    ),
    bound("mean_reflectance", 2048.0, 0.0, "as conductor_loss, times Fresnel's 64u"),
    bound(
        "glass_loss",
        4096.0,
        16.0,
        "as conductor_loss; near an index of one the place is the root of a difference",
    ),
    bound("uniform_triangle", 4.0, 0.0, "a product by half is exact, a difference 2u"),
    bound("uniform_cone", SINE, 0.0, BY_SINE),
    bound("sphere_opening", 64.0, 8.0, "a length 14u, its difference to the radius, a root, two quotients"),
    bound("sample_sphere", SINE, 8.0, "WGSL's sin and cos of an angle; half chords at the rim"),
    bound("triangle_pdf", 64.0, 0.0, "three factors of a length, in parts of the scalar product's summands"),
    bound("decode_direction", 32.0, 0.0, "unpack 3u, two differences, a length and a quotient"),
    bound("decode_tangent", 32.0, 0.0, "as decode_direction"),
    bound("srgb_decode", SRGB, 0.0, "counted at SRGB"),
    bound("direction_to_equirect", ATAN2, 0.0, "WGSL's atan2, and sin and cos of angles"),
    counted("valid_shading_normal", GUARD, 16.0, "counted at guard_errors; whether a normal is bent"),
    bound(
        "area_normal",
        32.0,
        0.0,
        "two edges, two products and a difference, in parts of the longest edge's square",
    ),
    bound("triangle_point_inside", 64.0, 16.0, "weights 20u and their sum; a margin in parts of the reach"),
    counted("level_hemisphere", LEVEL, 16.0, "counted at level_errors; the sine is a root near zero"),
    bound(
        "evaluate_bsdf",
        1024.0,
        64.0,
        "a dozen of the above in turn; tables at places that are wrong by 30u",
    ),
    bound(
        "sample_bsdf",
        2.0 * SINE,
        64.0,
        "as sample_visible_normal; weights as evaluate_bsdf, at grazing angles as the cosine",
    ),
    counted("sample_texture", TEXTURE, 4.0, "counted at texture_errors; which texel is nearest"),
    bound("vertex_attributes", 32.0, 0.0, "three unpacked numbers (3u), products and sums; decode_direction"),
    counted(
        "surface_at",
        TEXTURE,
        16.0,
        "counted at surface_part; which texel is nearest, whether a normal is bent",
    ),
    bound("passes_alpha", 1.0, 16.0, "integers; a surface that lets rays pass with a chance wrong by 16u"),
    bound(
        "sample_light_tree",
        8192.0,
        16.0,
        "cosines of 30u against the least that counts, 1/256; a level each",
    ),
    bound(
        "sample_light",
        2.0 * SINE,
        16.0,
        "WGSL's sin and cos of an angle, on cones and half chords; as sample_light_tree",
    ),
    bound("light_pdf", 8192.0, 16.0, "as sample_light_tree, triangle_pdf, sphere_opening"),
    Bound {
        near: near_sky,
        ..counted("sky_light", SKY, 16.0, "counted at sky_errors; inside or outside a sun's rim, which cell")
    },
    bound("met_by", 8.0, 16.0, "a quotient: 5u and Rust 1u; which side of a surface seen edge-on"),
    bound("media_towards", 1.0, 16.0, "integers; which side of a surface seen edge-on"),
    counted("medium_transmittance", ABSORPTION, 0.0, "counted at its case"),
];
