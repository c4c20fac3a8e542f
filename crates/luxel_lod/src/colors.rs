//! Colours of nodes, and of pixels.
use glam::Vec3;
use luxel_geom::srgb::srgb_decode_byte;

/// Linear light of packed sRGB colours.
pub(crate) struct Linear([f32; 256]);

impl Linear {
    pub(crate) fn new() -> Self {
        Self(std::array::from_fn(|byte| srgb_decode_byte(byte as u8)))
    }

    pub(crate) fn of(&self, color: u32) -> Vec3 {
        let [red, green, blue, _] = color.to_le_bytes();
        Vec3::from([red, green, blue].map(|byte| self.0[usize::from(byte)]))
    }
}

/// Rec.709 luminance, of linear light or of code values.
#[must_use]
pub fn luminance(rgb: Vec3) -> f32 {
    rgb.dot(Vec3::new(0.2126, 0.7152, 0.0722))
}
