//! Reading textures: wrapped, decoded, filtered.
//!
//! Coordinates are brought into one period first and texels are addressed by integers, so that no coordinate, however
//! large, leaves the image. sRGB is decoded before texels are mixed.
use luxel_flat::{
    Counter, Counters, FlatScene, TEXTURE_CLAMP_U, TEXTURE_CLAMP_V, TEXTURE_MIRROR_U, TEXTURE_MIRROR_V,
    TEXTURE_NEAREST, TEXTURE_SRGB, TEXTURE_UV1, TextureSlot,
};
use luxel_geom::{Real, Vector, srgb};

/// Coordinates beyond this are held there; at it a single no longer tells two texels apart.
const LARGEST: f64 = 16_777_216.0;

/// Red, green, blue and alpha, in `[0, 1]`.
pub type Rgba<R> = [R; 4];

/// How an axis goes on beyond the image.
#[derive(Clone, Copy)]
enum Wrap {
    Repeat,
    Clamp,
    Mirror,
}

/// The texture at the coordinates that its slot asks for; `uv` are both sets.
pub fn sample_texture<R: Real>(
    scene: &FlatScene,
    slot: &TextureSlot,
    uv: &[[R; 2]; 2],
    counters: &mut Counters,
) -> Rgba<R> {
    counters[Counter::TextureReads] += 1;
    let [u, v] = uv[usize::from(slot.flags & TEXTURE_UV1 != 0)];
    let place = R::Vec3::new(u, v, R::ONE);
    let x = R::Vec3::from_array(slot.row_u).dot(place);
    let y = R::Vec3::from_array(slot.row_v).dot(place);
    // A texel's place would be made of it, and nobody would drop the sample.
    if x.to_f64().is_nan() || y.to_f64().is_nan() {
        return [x + y; 4];
    }
    let (width, height) = (slot.size & 0xffff, slot.size >> 16);
    let is_nearest = slot.flags & TEXTURE_NEAREST != 0;
    let across = along(x, width, wrap(slot.flags, TEXTURE_CLAMP_U, TEXTURE_MIRROR_U), is_nearest);
    let down = along(y, height, wrap(slot.flags, TEXTURE_CLAMP_V, TEXTURE_MIRROR_V), is_nearest);
    let row = |j: u32| {
        let texel = |i: u32| texel::<R>(scene, slot, j * width + i);
        mix(texel(across.first), texel(across.second), across.share)
    };
    if is_nearest {
        return texel(scene, slot, down.first * width + across.first);
    }
    mix(row(down.first), row(down.second), down.share)
}

/// Two neighbouring texels of an axis, and the share of the second.
struct Neighbours<R> {
    first: u32,
    second: u32,
    share: R,
}

fn wrap(flags: u32, clamp: u32, mirror: u32) -> Wrap {
    match (flags & clamp != 0, flags & mirror != 0) {
        (true, _) => Wrap::Clamp,
        (_, true) => Wrap::Mirror,
        _ => Wrap::Repeat,
    }
}

fn along<R: Real>(coordinate: R, count: u32, wrap: Wrap, is_nearest: bool) -> Neighbours<R> {
    let held = coordinate.clamped(R::from_f64(-LARGEST), R::from_f64(LARGEST));
    let two = R::from_f64(2.0);
    let within = match wrap {
        Wrap::Repeat => held - held.floor(),
        Wrap::Clamp => held.clamped(R::ZERO, R::ONE),
        Wrap::Mirror => held - (held / two).floor() * two,
    };
    let half = if is_nearest { R::ZERO } else { R::from_f64(0.5) };
    let steps = within * R::from_f64(f64::from(count)) - half;
    let first = steps.floor();
    let index = first.to_f64() as i64;
    Neighbours {
        first: texel_index(index, count, wrap),
        second: texel_index(index + 1, count, wrap),
        share: steps - first,
    }
}

/// The texel that stands for one of the two periods of an axis, or beside them.
fn texel_index(index: i64, count: u32, wrap: Wrap) -> u32 {
    let count = i64::from(count.max(1));
    let wrapped = match wrap {
        Wrap::Repeat => index.rem_euclid(count),
        Wrap::Clamp => index.clamp(0, count - 1),
        Wrap::Mirror => {
            let place = index.rem_euclid(2 * count);
            place.min(2 * count - 1 - place)
        }
    };
    wrapped as u32
}

fn texel<R: Real>(scene: &FlatScene, slot: &TextureSlot, index: u32) -> Rgba<R> {
    let word = scene.texels.as_slice().get((slot.texel_first + index) as usize).copied().unwrap_or(0);
    let [r, g, b, a] = word.to_le_bytes();
    let linear = |byte: u8| R::from_f64(f64::from(byte) / 255.0);
    if slot.flags & TEXTURE_SRGB == 0 {
        return [r, g, b, a].map(linear);
    }
    [srgb::srgb_decode_byte(r), srgb::srgb_decode_byte(g), srgb::srgb_decode_byte(b), linear(a)]
}

fn mix<R: Real>(a: Rgba<R>, b: Rgba<R>, share: R) -> Rgba<R> {
    core::array::from_fn(|k| a[k] + (b[k] - a[k]) * share)
}
