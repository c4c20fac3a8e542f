//! G01: integer work gives the same bits everywhere: a million addresses of the random numbers.
use luxel_geom::rng;
use luxel_gpu::testing::gpu_or_fail;
use luxel_testkit::Random;

use crate::device::Function;

const ADDRESSES: usize = 1_000_000;

const MODULE: &str = "import package::geom::rng::{bounce_block, pcg4d, uniform4};
struct Input { address: vec4u }
struct Output { hash: vec4u, uniforms: vec4u, block: vec4u }
fn call(in: Input) -> Output {
    let a = in.address;
    return Output(pcg4d(a), bitcast<vec4u>(uniform4(a.x, a.y, a.z, a.w)), vec4u(bounce_block(a.x), 0u, 0u, 0u));
}";

#[test]
fn random_numbers_are_equal_bit_for_bit() {
    let Some(gpu) = gpu_or_fail() else { return };
    let mut random = Random::new(1);
    let mut word = |i: usize| match i % 4 {
        0 => random.word(),
        1 => i as u32,
        2 => u32::MAX - i as u32,
        _ => 1 << random.below(32),
    };
    let addresses: Vec<[u32; 4]> =
        (0..ADDRESSES).map(|i| [word(i), word(i / 4), word(i / 16), word(i / 64)]).collect();
    let found: Vec<[[u32; 4]; 3]> = Function::new(&gpu, MODULE).map(&addresses);
    let twin = |address: &[u32; 4]| {
        let [pixel, sample, block, seed] = *address;
        let uniforms = rng::uniform4::<f32>(pixel, sample, block, seed).map(f32::to_bits);
        let first_block = rng::CAMERA_BLOCKS.wrapping_add(pixel.wrapping_mul(rng::BOUNCE_BLOCKS));
        [rng::pcg4d(*address), uniforms, [first_block, 0, 0, 0]]
    };
    let different = addresses.iter().zip(&found).find(|(address, found)| twin(address) != **found);
    assert_eq!(different, None);
}
