//! Tables 3.1, 4.1, 5.1 and 5.27 to 5.30.
use super::{Pair, Row, row};

/// Table 3.1: the edge of the picture that is cast, and the bound of the error.
pub(in super::super) const RAY_CAST_BOUNDS: [(u32, f64); 4] =
    [(512, 0.09375), (256, 0.1875), (128, 0.375), (64, 0.75)];

/// Table 4.1: area, voxels and octree nodes.
pub(in super::super) const VOXELS_AND_NODES: [(&str, [u64; 2]); 4] = [
    ("desert", [18_625_873, 26_012_147]),
    ("forest", [28_115_001, 40_829_320]),
    ("mountain", [26_437_357, 38_335_931]),
    ("biomes", [14_592_384, 21_162_056]),
];

/// Table 5.1: rays on the desert; a row for each decay factor, a column for each threshold.
pub(in super::super) const BY_DECAY: [[u64; 6]; 6] = [
    [135_677, 285_193, 478_125, 810_805, 2_029_727, 2_379_774],
    [142_195, 292_495, 510_337, 849_472, 2_137_759, 2_506_243],
    [157_248, 327_704, 566_407, 943_173, 2_378_533, 2_784_862],
    [195_622, 418_090, 682_518, 1_113_927, 2_584_319, 3_108_818],
    [248_535, 515_262, 898_454, 1_291_458, 2_964_559, 3_835_181],
    [375_238, 768_187, 1_358_136, 2_087_938, 4_321_629, 5_103_326],
];

/// The decay factor and threshold that were found best (§5.1.4).
pub(in super::super) const BEST: [f64; 2] = [0.2, 0.154];

/// The adaptive renderer on the desert, in every row of tables 5.27 and 5.28.
pub(in super::super) const ADAPTIVE: Row = row(395_162, 3_557_270, 50.913, 0.00285, 0.991);

/// Tables 5.27 and 5.28: the error-aware renderer on the desert, by threshold.
pub(in super::super) const BY_THRESHOLD: [(f64, Row); 6] = [
    (0.175, row(180_622, 1_952_953, 52.710, 0.00231, 0.993)),
    (0.15, row(418_090, 3_756_873, 54.081, 0.00197, 0.995)),
    (0.125, row(652_518, 6_172_597, 55.443, 0.00169, 0.997)),
    (0.1, row(1_083_927, 9_708_443, 56.513, 0.00149, 0.997)),
    (0.075, row(2_744_319, 23_598_582, 59.718, 0.00103, 0.999)),
    (0.05, row(3_208_818, 27_444_396, 61.634, 0.00083, 0.999)),
];

/// Tables 5.29 and 5.30: the desert by the edge of the picture.
pub(in super::super) const BY_RESOLUTION: [(u32, Pair); 4] = [
    (
        512,
        Pair {
            adaptive: row(395_162, 3_557_270, 50.913, 0.00285, 0.991),
            error_aware: row(394_242, 3_582_041, 53.937, 0.00201, 0.995),
        },
    ),
    (
        256,
        Pair {
            adaptive: row(135_032, 1_076_390, 50.436, 0.00301, 0.989),
            error_aware: row(93_899, 799_302, 52.700, 0.00232, 0.993),
        },
    ),
    (
        128,
        Pair {
            adaptive: row(58_016, 481_370, 50.433, 0.00301, 0.989),
            error_aware: row(23_894, 202_114, 51.553, 0.00264, 0.991),
        },
    ),
    (
        64,
        Pair {
            adaptive: row(6_452, 52_310, 48.638, 0.00370, 0.983),
            error_aware: row(6_155, 51_834, 50.578, 0.00296, 0.988),
        },
    ),
];
