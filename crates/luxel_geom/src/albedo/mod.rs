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
//! | odds | odds that light which meets one microfacet of a dielectric is reflected (exact Fresnel), over those at [`lookup::typical_cosine`] | index, roughness, cosine |
//! | glass | loss: 1 − albedo of reflection and transmission together, as energy (no factor η²) | [`Facets`], index, roughness, cosine |
//!
//! and, for each, the cosine-weighted average over directions, 2 ∫ · cos dcos (for the rim of the albedo itself, for the
//! odds of what passes, over what passes head-on). Losses and odds, not albedos, so that what is left of a surface that
//! reflects nearly all keeps its digits. Of an average loss the square root is stored, at many roughnesses, so that it is
//! in step with the losses even where they grow with the fourth power of the roughness.
//!
//! `cargo xtask generate albedo` computes them by quadrature in f64 (`crates/xtask/src/albedo.rs`). The lookups are in
//! [`lookup`], the warps of the axes in [`axes`]; `shaders/geom/albedo.wesl` reads the same numbers from a buffer.
use std::sync::LazyLock;

pub mod axes;
pub mod lookup;

/// Cosines in every table.
pub const COSINES: u32 = 40;
/// Roughnesses in every table.
pub const ROUGHNESSES: u32 = 64;
/// Entries of a table with the axes roughness and cosine.
pub const PLANE: u32 = ROUGHNESSES * COSINES;
/// Indices of refraction in the table of odds, from 1 to infinity.
pub const ODDS_INDICES: u32 = 41;
/// Relative indices in each glass table, from 0 to infinity; 1 is at [`axes::GLASS_MIDDLE`].
pub const GLASS_INDICES: u32 = 169;
/// Roughnesses in the averages: those of the tables, and 7 between any two.
pub const AVERAGE_ROUGHNESSES: u32 = 8 * (ROUGHNESSES - 1) + 1;

/// What clear microfacets reflect; what they do not reflect they let pass, and where nothing can pass they reflect all.
///
/// A loss is linear in the reflectance, so that of any mixture is the mixture of theirs and the conductor's.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u32)]
pub enum Facets {
    /// By Fresnel's equations.
    Exact,
    /// Nothing.
    Clear,
    /// By Schlick's weight of the angle on the thinner side.
    Rim,
}

impl Facets {
    /// All, in the order of their tables.
    pub const ALL: [Self; 3] = [Self::Exact, Self::Clear, Self::Rim];
}

/// Where the conductor's averages start; its table starts at 0.
pub const CONDUCTOR_AVERAGES: u32 = PLANE;
/// Where the rim's table starts.
pub const RIM: u32 = CONDUCTOR_AVERAGES + AVERAGE_ROUGHNESSES;
/// Where the rim's averages start.
pub const RIM_AVERAGES: u32 = RIM + PLANE;
/// Where the table of odds starts.
pub const ODDS: u32 = RIM_AVERAGES + AVERAGE_ROUGHNESSES;
/// Where the averages of what passes start.
pub const PASSING_AVERAGES: u32 = ODDS + PLANE * ODDS_INDICES;
/// Where the first glass table starts.
pub const GLASS: u32 = PASSING_AVERAGES + AVERAGE_ROUGHNESSES * ODDS_INDICES;
/// Where the averages of glass start.
pub const GLASS_AVERAGES: u32 = GLASS + PLANE * GLASS_INDICES * Facets::ALL.len() as u32;
/// Number of entries of all tables.
pub const LENGTH: u32 = GLASS_AVERAGES + AVERAGE_ROUGHNESSES * GLASS_INDICES * Facets::ALL.len() as u32;

/// The generated file: [`LENGTH`] singles, lowest byte first.
const FILE: &[u8] = include_bytes!("tables.bin");

/// Every table, one after the other: what the lookups and the shaders' buffer read.
pub static TABLES: LazyLock<Box<[f32]>> =
    LazyLock::new(|| FILE.as_chunks().0.iter().copied().map(f32::from_le_bytes).collect());
