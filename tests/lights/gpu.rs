//! The backends agree on a scene with every kind of light, and on each way to find them.
use luxel_cpu::CpuTracer;
use luxel_film::tracer::Tracer;
use luxel_gpu::{SlicePolicy, testing::gpu_or_fail};
use luxel_render::GpuTracer;
use luxel_scene::LightSampling;

use crate::scenes::{crowd_stage, engine, every_kind_stage, sample_by};
use crate::welch::{batches, mean_and_variance, worst_ratio};

#[test]
fn the_backends_agree_on_every_kind_of_light() {
    let Some(gpu) = gpu_or_fail() else { return };
    let cases = [
        ("every kind", every_kind_stage(), &[LightSampling::Mis, LightSampling::Nee][..]),
        ("crowd", crowd_stage(), &[LightSampling::Mis][..]),
    ];
    // One for both worlds, so that what they share of shaders is compiled once.
    let mut tracer = GpuTracer::new(&gpu, SlicePolicy::HEADLESS).unwrap();
    for (name, world, ways) in cases {
        let mut engine = engine(world);
        tracer.leave_world().unwrap();
        for sampling in ways {
            sample_by(&mut engine, *sampling);
            let cpu = batches(&mut engine, &mut CpuTracer::new(), 0x6000, 4);
            let gpu = batches(&mut engine, &mut tracer, 0x7000, 4);
            let ratio = worst_ratio(&cpu, &gpu);
            let means = [&cpu, &gpu].map(|batches| mean_and_variance(batches)[0]);
            println!("{name}, {sampling:?}: |t| at most {ratio:.3} of its limit, means {means:?}");
            assert!(ratio <= 1.0, "{name}, {sampling:?}: {ratio} of the limit");
        }
    }
}
