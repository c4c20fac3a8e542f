//! Tables 5.2 to 5.17: the four areas without lighting.
use super::{Pair, row};

/// One area's four tables.
pub(in super::super) struct Albedo {
    pub(in super::super) area: &'static str,
    /// The number of its first table; the others follow.
    pub(in super::super) first_table: u32,
    /// The number of its figure.
    pub(in super::super) figure: u32,
    pub(in super::super) pair: Pair,
    /// Of adaptive and of error-aware.
    pub(in super::super) rays_per_pixel: [f64; 2],
    /// Pixels without a hit, of 1, 4 and 16 rays.
    pub(in super::super) adaptive_pixels: [u64; 4],
    /// Pixels without a hit, and those that went down to LOD 2, 1 and 0.
    pub(in super::super) error_aware_pixels: [u64; 4],
}

pub(in super::super) const ALBEDO: [Albedo; 4] = [
    Albedo {
        area: "desert",
        first_table: 2,
        figure: 3,
        pair: Pair {
            adaptive: row(395_162, 3_557_270, 50.913, 0.00285, 0.991),
            error_aware: row(394_242, 3_582_041, 53.937, 0.00201, 0.995),
        },
        rays_per_pixel: [1.888, 1.886],
        adaptive_pixels: [52_886, 169_475, 37_088, 2_347],
        error_aware_pixels: [53_121, 181_380, 14_256, 13_387],
    },
    Albedo {
        area: "forest",
        first_table: 6,
        figure: 4,
        pair: Pair {
            adaptive: row(656_205, 6_562_050, 41.666, 0.00825, 0.939),
            error_aware: row(486_912, 4_172_056, 43.197, 0.00692, 0.957),
        },
        rays_per_pixel: [3.425, 2.545],
        adaptive_pixels: [70_558, 100_733, 74_848, 16_005],
        error_aware_pixels: [70_800, 149_667, 19_330, 22_347],
    },
    Albedo {
        area: "mountain",
        first_table: 10,
        figure: 5,
        pair: Pair {
            adaptive: row(749_468, 6_533_670, 40.684, 0.00924, 0.928),
            error_aware: row(475_532, 4_200_987, 41.890, 0.00804, 0.945),
        },
        rays_per_pixel: [3.762, 2.385],
        adaptive_pixels: [62_908, 103_135, 82_910, 13_662],
        error_aware_pixels: [62_798, 158_857, 20_238, 20_251],
    },
    Albedo {
        area: "biomes",
        first_table: 14,
        figure: 6,
        pair: Pair {
            adaptive: row(616_187, 6_161_870, 41.535, 0.00838, 0.937),
            error_aware: row(456_034, 3_992_801, 44.221, 0.00615, 0.964),
        },
        rays_per_pixel: [2.877, 2.130],
        adaptive_pixels: [47_996, 145_471, 52_343, 16_334],
        error_aware_pixels: [48_087, 179_243, 17_837, 16_977],
    },
];
