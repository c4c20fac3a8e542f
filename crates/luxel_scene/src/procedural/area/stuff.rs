//! What an area is made of: families of eight shades.

use glam::Vec3;

use crate::material::Material;

/// Shades of a family, from dark to light.
pub(super) const SHADES: u8 = 8;

/// A family of albedos.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
#[repr(u8)]
pub(super) enum Stuff {
    Sand,
    Earth,
    RedRock,
    Rock,
    DarkRock,
    Snow,
    Grass,
    DryGrass,
    Moss,
    Litter,
    Bark,
    Conifer,
    Leaves,
    OliveLeaves,
    GoldLeaves,
    Plaster,
    Stone,
    Tile,
    Wood,
    Rust,
    Window,
    Cloth,
    Teal,
    Road,
    /// Snow that lets the ground through.
    Slush,
    /// Needles under hoarfrost.
    Frost,
}

/// Linear albedo of the middle of each family, and how far (as a share of it) its darkest and lightest are from it.
const FAMILIES: [([f32; 3], f32); 26] = [
    ([0.50, 0.36, 0.21], 0.45),
    ([0.27, 0.185, 0.11], 0.5),
    ([0.34, 0.17, 0.095], 0.65),
    ([0.20, 0.185, 0.17], 0.75),
    ([0.105, 0.101, 0.10], 0.7),
    ([0.66, 0.70, 0.76], 0.33),
    ([0.085, 0.13, 0.035], 0.55),
    ([0.30, 0.25, 0.10], 0.5),
    ([0.055, 0.085, 0.025], 0.5),
    ([0.060, 0.046, 0.028], 0.5),
    ([0.065, 0.042, 0.027], 0.5),
    ([0.022, 0.050, 0.024], 0.6),
    ([0.040, 0.085, 0.018], 0.6),
    ([0.085, 0.095, 0.035], 0.6),
    ([0.22, 0.15, 0.030], 0.6),
    ([0.56, 0.44, 0.31], 0.4),
    ([0.34, 0.28, 0.21], 0.5),
    ([0.33, 0.12, 0.065], 0.5),
    ([0.15, 0.085, 0.045], 0.6),
    ([0.20, 0.105, 0.060], 0.8),
    ([0.030, 0.028, 0.030], 0.6),
    ([0.45, 0.060, 0.045], 0.4),
    ([0.060, 0.26, 0.26], 0.4),
    ([0.38, 0.29, 0.19], 0.4),
    ([0.42, 0.43, 0.45], 0.35),
    ([0.17, 0.205, 0.20], 0.5),
];

impl Stuff {
    /// The palette entry of a shade; `tone` runs from −1 (dark) to 1 (light).
    pub(super) fn shade(self, tone: f32) -> u8 {
        let shade = (4.0 + 4.0 * tone).clamp(0.0, 7.0) as u8;
        self as u8 * SHADES + shade
    }
}

/// All shades of all families; `contrast` widens or narrows every family.
pub(super) fn palette(contrast: f32) -> Vec<Material> {
    let shades = |(albedo, spread): ([f32; 3], f32)| {
        (0..SHADES).map(move |shade| {
            let tone = (f32::from(shade) - 3.5) / 3.5;
            let light = (1.0 + contrast * spread * tone).max(0.05);
            Material::lambert((Vec3::from(albedo) * light).clamp(Vec3::ZERO, Vec3::splat(0.94)))
        })
    };
    FAMILIES.into_iter().flat_map(shades).collect()
}
