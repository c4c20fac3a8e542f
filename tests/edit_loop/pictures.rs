//! The scene on the GPU: the ids of a film at one sample per pixel, against those of the CPU and of f64.
use std::collections::BTreeSet;
use std::sync::Arc;

use glam::DVec3;
use luxel_cpu::{CpuTracer, camera};
use luxel_film::Film;
use luxel_film::tracer::{TraceRequest, Tracer};
use luxel_flat::{Counters, FlatScene};
use luxel_geom::Ray;
use luxel_gpu::{Gpu, SlicePolicy};
use luxel_render::GpuTracer;
use luxel_scene::{RenderSettings, Transform};
use luxel_testkit::ties::{Answer, Judge};
use rayon::prelude::*;

use crate::studio::Studio;
use crate::traced::trace;

const SIZE: [u32; 2] = [160, 120];

/// What became of a number of pixels.
#[derive(Debug, Default)]
pub(crate) struct Agreement {
    pub(crate) pixels: usize,
    pub(crate) ties: usize,
    pub(crate) ids: usize,
}

/// Asserts that CPU and GPU see the same ids from several places, ties apart. Leaves the camera where it was.
pub(crate) fn assert_agreement(studio: &mut Studio, gpu: &Gpu) -> Agreement {
    let camera = studio.camera;
    let (home, settings) =
        (*studio.world.get::<Transform>(camera).unwrap(), *studio.world.resource::<RenderSettings>());
    let [width, height] = SIZE;
    *studio.world.resource_mut::<RenderSettings>() =
        RenderSettings { width, height, max_depth: 0, ..settings };
    let mut tracer = GpuTracer::new(gpu, SlicePolicy::HEADLESS).unwrap();
    let mut agreement = Agreement::default();
    for (eye, target) in [
        ([0.0, 300.0, 4000.0], [0.0; 3]),
        ([2.0, 3.0, 7.0], [0.0; 3]),
        ([30.0, 20.0, -60.0], [-9.0, 1.0, 40.0]),
    ] {
        *studio.world.get_mut::<Transform>(camera).unwrap() =
            Transform::looking_at(DVec3::from(eye), DVec3::from(target));
        let scene = studio.baker.run(&mut studio.world).unwrap();
        compare(&scene, &mut tracer, &mut agreement);
    }
    *studio.world.get_mut::<Transform>(camera).unwrap() = home;
    *studio.world.resource_mut::<RenderSettings>() = settings;
    agreement
}

fn compare(scene: &Arc<FlatScene>, gpu: &mut dyn Tracer, agreement: &mut Agreement) {
    let request = TraceRequest::new(Arc::clone(scene)).with_aovs(true);
    let on_gpu = answers(&trace(gpu, &request, 1).film);
    let on_cpu = answers(&trace(&mut CpuTracer::new(), &request, 1).film);
    let judge = Judge::new(scene);
    let differing: Vec<usize> = (0..on_cpu.len()).filter(|pixel| on_cpu[*pixel] != on_gpu[*pixel]).collect();
    for &pixel in &differing {
        let ray = ray(scene, pixel);
        let both = [on_cpu[pixel], on_gpu[pixel]];
        assert!(judge.explains(&ray, both), "pixel {pixel}: no tie: {both:?}\n{}", judge.describe(&ray));
    }
    assert_the_judge_is_awake(scene, &judge, &on_gpu);
    agreement.pixels += on_cpu.len();
    agreement.ties += differing.len();
    agreement.ids += on_cpu.iter().flatten().collect::<BTreeSet<_>>().len();
}

/// Negative control: the judge passes what is seen, and not what is seen a few pixels farther.
fn assert_the_judge_is_awake(scene: &FlatScene, judge: &Judge, answers: &[Option<Answer>]) {
    let pixels: Vec<usize> = (0..answers.len()).step_by(61).collect();
    let wrong = pixels.par_iter().filter(|pixel| !judge.is_plausible(&ray(scene, **pixel), answers[**pixel]));
    assert_eq!(wrong.count(), 0);
    let moved = |pixel: usize| answers[(pixel + 7 * SIZE[0] as usize + 11) % answers.len()];
    let other: Vec<usize> = pixels.into_iter().filter(|pixel| answers[*pixel] != moved(*pixel)).collect();
    let fooled =
        other.par_iter().filter(|pixel| judge.is_plausible(&ray(scene, **pixel), moved(**pixel))).count();
    assert!(other.len() > 30 && fooled * 20 <= other.len(), "{fooled} of {} wrong answers pass", other.len());
}

fn answers(film: &Film) -> Vec<Option<Answer>> {
    film.aovs.as_ref().unwrap().iter().map(Answer::of_aov).collect()
}

/// The camera ray of a pixel's first sample, in f64.
fn ray(scene: &FlatScene, pixel: usize) -> Ray<f64> {
    camera::generate::<f64>(&scene.params, scene.features, pixel as u32, 0, &mut Counters::default()).ray
}
