//! Presets of a picture's quality: the three of the octree report (seed document 1, table of quality levels).

/// How good a picture is to be.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u8)]
pub enum Quality {
    /// A first look.
    Low,
    /// A picture to judge a scene by.
    Standard,
    /// A picture to keep.
    High,
}

/// What a preset stands for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct QualityRow {
    /// The preset.
    pub quality: Quality,
    /// Name on the command line and in records.
    pub name: &'static str,
    /// Samples per pixel.
    pub spp: u32,
    /// How often light may scatter after the first hit.
    pub max_depth: u32,
}

/// Every preset, in the order of [`Quality`].
pub const QUALITIES: &[QualityRow] = &[
    QualityRow { quality: Quality::Low, name: "low", spp: 4, max_depth: 4 },
    QualityRow { quality: Quality::Standard, name: "standard", spp: 16, max_depth: 8 },
    QualityRow { quality: Quality::High, name: "high", spp: 32, max_depth: 16 },
];

impl Quality {
    /// What it stands for.
    pub fn row(self) -> &'static QualityRow {
        &QUALITIES[self as usize]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_stand_in_the_order_of_the_enum() {
        for (i, row) in QUALITIES.iter().enumerate() {
            assert_eq!(row.quality as usize, i, "{}", row.name);
            assert_eq!(row.quality.row(), row);
        }
    }
}
