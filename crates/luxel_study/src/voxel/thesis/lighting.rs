//! Tables 5.18 to 5.26: the four areas at four times of day.
use super::{Pair, row};

/// One area at the four times of day.
pub(in super::super) struct Lit {
    pub(in super::super) area: &'static str,
    /// The tables of counts and of similarities.
    pub(in super::super) tables: [u32; 2],
    /// The number of its figure.
    pub(in super::super) figure: u32,
    pub(in super::super) times: [Pair; 4],
}

/// Table 5.19: mean luminance of the desert at the four times of day.
pub(in super::super) const LUMINANCE: [f64; 4] = [0.0864, 0.0324, 0.0732, 0.0541];

pub(in super::super) const LIGHTING: [Lit; 4] = [
    Lit {
        area: "desert",
        tables: [18, 20],
        figure: 7,
        times: [
            Pair {
                adaptive: row(702_412, 5_838_850, 49.955, 0.00318, 0.988),
                error_aware: row(394_242, 3_582_041, 52.411, 0.00239, 0.993),
            },
            Pair {
                adaptive: row(709_204, 6_055_420, 53.116, 0.00221, 0.994),
                error_aware: row(394_242, 3_582_041, 54.901, 0.00179, 0.996),
            },
            Pair {
                adaptive: row(488_808, 3_172_754, 50.291, 0.00306, 0.989),
                error_aware: row(394_242, 3_582_041, 52.551, 0.00236, 0.993),
            },
            Pair {
                adaptive: row(705_836, 5_970_920, 51.551, 0.00265, 0.992),
                error_aware: row(394_242, 3_582_041, 54.528, 0.00188, 0.996),
            },
        ],
    },
    Lit {
        area: "forest",
        tables: [21, 22],
        figure: 8,
        times: [
            Pair {
                adaptive: row(688_756, 5_572_030, 41.339, 0.00857, 0.941),
                error_aware: row(486_912, 4_172_056, 42.659, 0.00736, 0.957),
            },
            Pair {
                adaptive: row(472_644, 3_655_450, 43.928, 0.00636, 0.963),
                error_aware: row(486_912, 4_172_056, 44.697, 0.00582, 0.970),
            },
            Pair {
                adaptive: row(507_992, 3_938_220, 42.359, 0.00762, 0.949),
                error_aware: row(486_912, 4_172_056, 43.930, 0.00636, 0.964),
            },
            Pair {
                adaptive: row(390_532, 2_967_970, 44.364, 0.00605, 0.966),
                error_aware: row(486_912, 4_172_056, 47.204, 0.00436, 0.982),
            },
        ],
    },
    Lit {
        area: "mountain",
        tables: [23, 24],
        figure: 9,
        times: [
            Pair {
                adaptive: row(544_532, 4_386_570, 42.548, 0.00746, 0.954),
                error_aware: row(475_532, 4_200_987, 44.436, 0.00600, 0.970),
            },
            Pair {
                adaptive: row(423_948, 3_338_230, 44.869, 0.00571, 0.972),
                error_aware: row(475_532, 4_200_987, 45.704, 0.00519, 0.977),
            },
            Pair {
                adaptive: row(878_388, 7_283_190, 38.647, 0.01168, 0.899),
                error_aware: row(475_532, 4_200_987, 40.597, 0.00934, 0.935),
            },
            Pair {
                adaptive: row(473_056, 3_761_310, 42.507, 0.00749, 0.956),
                error_aware: row(475_532, 4_200_987, 45.404, 0.00537, 0.977),
            },
        ],
    },
    Lit {
        area: "biomes",
        tables: [25, 26],
        figure: 10,
        times: [
            Pair {
                adaptive: row(391_904, 3_213_830, 43.624, 0.00659, 0.959),
                error_aware: row(456_034, 3_992_801, 46.472, 0.00475, 0.978),
            },
            Pair {
                adaptive: row(299_252, 2_449_060, 49.561, 0.00333, 0.988),
                error_aware: row(456_034, 3_992_801, 51.263, 0.00273, 0.992),
            },
            Pair {
                adaptive: row(500_552, 4_139_100, 40.966, 0.00895, 0.935),
                error_aware: row(456_034, 3_992_801, 43.755, 0.00649, 0.964),
            },
            Pair {
                adaptive: row(447_968, 3_676_840, 41.757, 0.00817, 0.944),
                error_aware: row(456_034, 3_992_801, 45.336, 0.00541, 0.974),
            },
        ],
    },
];
