//! Random numbers by address: the published function, uniform, and without a trace of the address (L15).
use luxel_geom::rng::{self, bounce_block, pcg4d, uniform, uniform4};

#[test]
fn pcg4d_is_the_published_function() {
    // From the definition in Jarzynski and Olano 2020, listing 3, evaluated apart from this code (in Python).
    let known = [
        ([0, 0, 0, 0], [0x0f02_f829, 0x2d56_8769, 0x32b0_c43b, 0xd325_48ea]),
        ([1, 2, 3, 4], [0x3622_cd16, 0xf114_71d8, 0xe110_9b3f, 0x02b9_4c2f]),
        ([u32::MAX; 4], [0x974e_d892, 0xc015_dc67, 0x9f95_5760, 0xa1bb_a208]),
        ([307_199, 63, 6, 1], [0x3369_eecc, 0x334c_f0cd, 0xf4ae_d5ba, 0x04c2_0b8c]),
    ];
    for (address, words) in known {
        assert_eq!(pcg4d(address), words, "{address:?}");
    }
}

#[test]
fn a_uniform_number_is_never_one() {
    for word in [0, 1, 255, 256, u32::MAX / 2, u32::MAX - 1, u32::MAX] {
        let single: f32 = uniform(word);
        let double: f64 = uniform(word);
        assert!((0.0..1.0).contains(&single));
        assert_eq!(f64::from(single), double, "both precisions draw the same number");
    }
    assert_eq!(uniform::<f32>(u32::MAX), 1.0f32.next_down());
}

#[test]
fn blocks_do_not_overlap() {
    assert_eq!(bounce_block(0), rng::CAMERA_BLOCKS);
    assert!((0..100).all(|k| bounce_block(k + 1) - bounce_block(k) == rng::BOUNCE_BLOCKS));
}

/// Addresses as a renderer forms them: neighbouring pixels, few samples, few blocks.
fn address(i: u32) -> [u32; 4] {
    [i / 16, i % 4, i / 4 % 4, 1]
}

fn draw([pixel, sample, block, seed]: [u32; 4]) -> [f32; 4] {
    uniform4(pixel, sample, block, seed)
}

const COUNT: u32 = 1 << 20;

/// χ² of 256 equal bins; its mean is 255, its standard deviation 22.6.
fn chi_squared(numbers: impl Iterator<Item = f32>) -> f64 {
    let mut bins = [0u32; 256];
    numbers.for_each(|u| bins[(u * 256.0) as usize] += 1);
    let expected = f64::from(COUNT) / 256.0;
    bins.iter().map(|b| (f64::from(*b) - expected).powi(2) / expected).sum()
}

#[test]
fn every_dimension_is_uniform() {
    for dimension in 0..4 {
        let chi_squared = chi_squared((0..COUNT).map(|i| draw(address(i))[dimension]));
        assert!((chi_squared - 255.0).abs() < 5.0 * 22.6, "{dimension}: {chi_squared}");
    }
    let broken = chi_squared((0..COUNT).map(|i| 0.99 * draw(address(i))[0]));
    assert!(broken > 1000.0, "the test finds nothing: {broken}");
}

/// Correlation coefficient of pairs of uniform numbers.
fn correlation(pairs: impl Iterator<Item = (f32, f32)>) -> f64 {
    let products = pairs.map(|(a, b)| (f64::from(a) - 0.5) * (f64::from(b) - 0.5));
    12.0 * products.sum::<f64>() / f64::from(COUNT)
}

#[test]
fn neighbouring_addresses_are_uncorrelated() {
    let limit = 5.0 / f64::from(COUNT).sqrt();
    for (axis, step) in (0..4).flat_map(|axis| [1, 2, 640].map(|step| (axis, step))) {
        let neighbour = |mut address: [u32; 4]| {
            address[axis] += step;
            address
        };
        for dimension in 0..4 {
            let pair = |i| (draw(address(i))[dimension], draw(neighbour(address(i)))[dimension]);
            let r = correlation((0..COUNT).map(pair));
            assert!(r.abs() <= limit, "axis {axis}, step {step}, dimension {dimension}: {r}");
        }
    }
}

#[test]
fn dimensions_of_one_address_are_uncorrelated() {
    let limit = 5.0 / f64::from(COUNT).sqrt();
    for (a, b) in [(0, 1), (0, 2), (0, 3), (1, 2), (1, 3), (2, 3)] {
        let r = correlation((0..COUNT).map(|i| (draw(address(i))[a], draw(address(i))[b])));
        assert!(r.abs() <= limit, "{a} {b}: {r}");
    }
}
