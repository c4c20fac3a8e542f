//! How much light one scattering at a rough surface keeps: tables by direction and roughness, for the compensation of
//! lost energy (Kulla and Conty 2017) and for what lies under a coat.
//!
//! Single scattering between microfacets loses the light that would hit a second one. The tables hold, for the lobes of
//! [`crate::microfacet`]:
//!
//! | table | entry | axes |
//! |---|---|---|
//! | conductor | loss: 1 − albedo, all light being reflected (F = 1) | roughness, cosine |
//! | rim | albedo of a reflection by Schlick's weight, (1 − cos)⁵, less that weight at [`lookup::typical_cosine`] | roughness, cosine |
//! | coat | albedo of a dielectric's reflection (exact Fresnel) over the reflectance at [`lookup::typical_cosine`] | index, roughness, cosine |
//! | glass | loss: 1 − albedo of reflection and transmission together, as energy (no factor η²) | index, roughness, cosine |
//!
//! and, for each, the cosine-weighted average over directions, 2 ∫ · cos dcos (for the rim of the albedo itself, for the
//! coat of the albedo less [`lookup::level_average`]). Losses, not albedos, so that a small loss keeps its digits. Of an average loss the square root is stored, at
//! many roughnesses, so that it is in step with the losses even where they grow with the fourth power of the roughness.
//!
//! `cargo xtask generate albedo` computes them by quadrature in f64 (`crates/xtask/src/albedo.rs`). The lookups are in
//! [`lookup`], the warps of the axes in [`axes`]; `shaders/geom/albedo.wesl` reads the same numbers from a buffer.
pub mod axes;
pub mod lookup;

/// Cosines in the conductor's table.
pub const CONDUCTOR_COSINES: u32 = 64;
/// Roughnesses in the conductor's table.
pub const CONDUCTOR_ROUGHNESSES: u32 = 32;
/// Cosines in the tables of rim, coat and glass.
pub const COSINES: u32 = 32;
/// Roughnesses in the tables of rim, coat and glass.
pub const ROUGHNESSES: u32 = 24;
/// Indices of refraction in the coat's table, from 1 to infinity.
pub const COAT_INDICES: u32 = 24;
/// Relative indices in the glass table, from 0 to infinity; 1 is at [`axes::GLASS_MIDDLE`].
pub const GLASS_INDICES: u32 = 65;
/// Roughnesses in the conductor's averages: those of its table, and 15 between any two.
pub const CONDUCTOR_AVERAGE_ROUGHNESSES: u32 = 16 * (CONDUCTOR_ROUGHNESSES - 1) + 1;
/// Roughnesses in the averages of rim, coat and glass, likewise.
pub const AVERAGE_ROUGHNESSES: u32 = 16 * (ROUGHNESSES - 1) + 1;

/// Where the conductor's averages start; its table starts at 0.
pub const CONDUCTOR_AVERAGES: u32 = CONDUCTOR_COSINES * CONDUCTOR_ROUGHNESSES;
/// Where the rim's table starts.
pub const RIM: u32 = CONDUCTOR_AVERAGES + CONDUCTOR_AVERAGE_ROUGHNESSES;
/// Where the rim's averages start.
pub const RIM_AVERAGES: u32 = RIM + COSINES * ROUGHNESSES;
/// Where the coat's table starts.
pub const COAT: u32 = RIM_AVERAGES + AVERAGE_ROUGHNESSES;
/// Where the coat's averages start.
pub const COAT_AVERAGES: u32 = COAT + COSINES * ROUGHNESSES * COAT_INDICES;
/// Where the glass table starts.
pub const GLASS: u32 = COAT_AVERAGES + AVERAGE_ROUGHNESSES * COAT_INDICES;
/// Where the averages of glass start.
pub const GLASS_AVERAGES: u32 = GLASS + COSINES * ROUGHNESSES * GLASS_INDICES;
/// Number of entries of all tables.
pub const LENGTH: u32 = GLASS_AVERAGES + AVERAGE_ROUGHNESSES * GLASS_INDICES;

/// The generated file: [`LENGTH`] singles, lowest byte first.
const FILE: &[u8] = include_bytes!("tables.bin");

/// Every table, one after the other: what the lookups and the shaders' buffer read.
pub static TABLES: [f32; LENGTH as usize] = decode(FILE);

/// The entries of a file. What is missing is zero, so that the generator can be built while there is no file yet.
const fn decode(bytes: &[u8]) -> [f32; LENGTH as usize] {
    let mut entries = [0.0; LENGTH as usize];
    let mut i = 0;
    while i < entries.len() && 4 * i + 3 < bytes.len() {
        let at = 4 * i;
        entries[i] = f32::from_le_bytes([bytes[at], bytes[at + 1], bytes[at + 2], bytes[at + 3]]);
        i += 1;
    }
    entries
}
