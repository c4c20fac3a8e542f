//! T01, T02, T05 on the device at hand: no ray slips between two triangles. (`luxel_render::watertight` has the control.)
use std::time::Instant;

use luxel_gpu::testing::gpu_or_fail;
use luxel_render::{WATERTIGHT_RAYS, watertight_misses};

#[test]
fn no_ray_slips_through_a_closed_mesh() {
    let Some(gpu) = gpu_or_fail() else { return };
    let start = Instant::now();
    let misses = watertight_misses(&gpu).unwrap();
    println!("{misses} of {WATERTIGHT_RAYS} rays miss; {:.2} s", start.elapsed().as_secs_f64());
    assert_eq!(misses, 0);
}
