//! The scene on the GPU: the ids of a film at one sample per pixel, against those of the CPU and of f64.
use std::collections::BTreeSet;
use std::sync::Arc;

use luxel_cpu::{CpuTracer, camera};
use luxel_film::Film;
use luxel_film::tracer::TraceRequest;
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

/// Pictures taken, in the soak run and in others, and the fewest things that each must show.
const VIEWS: [u32; 2] = [24, 8];
const THINGS: usize = 8;

/// What became of a number of pixels.
#[derive(Debug, Default)]
pub(crate) struct Agreement {
    pub(crate) pictures: u32,
    pub(crate) pixels: usize,
    pub(crate) ties: usize,
    /// Wrong answers that the judge was asked about, and how many of them it took for ties.
    pub(crate) wrong: usize,
    pub(crate) fooled: usize,
}

/// Asserts that CPU and GPU see the same ids from many places, ties apart. Leaves the camera where it was.
pub(crate) fn assert_agreement(studio: &mut Studio, gpu: &Gpu) -> Agreement {
    let camera = studio.camera;
    let home = *studio.world.get::<Transform>(camera).unwrap();
    let settings = *studio.world.resource::<RenderSettings>();
    let [width, height] = SIZE;
    *studio.world.resource_mut::<RenderSettings>() =
        RenderSettings { width, height, max_depth: 0, ..settings };
    let mut tracer = GpuTracer::new(gpu, SlicePolicy::HEADLESS).unwrap();
    let mut agreement = Agreement::default();
    let views = VIEWS[usize::from(!crate::is_soak())];
    while agreement.pictures < views {
        *studio.world.get_mut::<Transform>(camera).unwrap() = studio.view();
        let scene = studio.baker.run(&mut studio.world).unwrap();
        let request = TraceRequest::new(Arc::clone(&scene)).with_aovs(true);
        let on_cpu = answers(&trace(&mut CpuTracer::new(), &request, 1).film);
        if on_cpu.iter().collect::<BTreeSet<_>>().len() >= THINGS {
            let on_gpu = answers(&trace(&mut tracer, &request, 1).film);
            agreement.pictures += 1;
            compare(&scene, &on_cpu, &on_gpu, &mut agreement);
        }
    }
    let is_asked = agreement.wrong > 40 * views as usize;
    assert!(is_asked && agreement.fooled * 20 <= agreement.wrong, "{agreement:?}");
    *studio.world.get_mut::<Transform>(camera).unwrap() = home;
    *studio.world.resource_mut::<RenderSettings>() = settings;
    agreement
}

fn compare(
    scene: &FlatScene,
    on_cpu: &[Option<Answer>],
    on_gpu: &[Option<Answer>],
    agreement: &mut Agreement,
) {
    let judge = Judge::new(scene);
    let differing: Vec<usize> = (0..on_cpu.len()).filter(|pixel| on_cpu[*pixel] != on_gpu[*pixel]).collect();
    for &pixel in &differing {
        let ray = ray(scene, pixel);
        let both = [on_cpu[pixel], on_gpu[pixel]];
        assert!(judge.explains(&ray, both), "pixel {pixel}: no tie: {both:?}\n{}", judge.describe(&ray));
    }
    agreement.pixels += on_cpu.len();
    agreement.ties += differing.len();
    control(scene, &judge, on_gpu, agreement);
}

/// Negative control: what is seen passes the judge; what is seen a few pixels farther should not.
fn control(scene: &FlatScene, judge: &Judge, answers: &[Option<Answer>], agreement: &mut Agreement) {
    let pixels: Vec<usize> = (0..answers.len()).step_by(61).collect();
    let refused = |pixel: &&usize| !judge.is_plausible(&ray(scene, **pixel), answers[**pixel]);
    assert_eq!(pixels.par_iter().find_any(refused), None);
    let moved = |pixel: usize| answers[(pixel + 7 * SIZE[0] as usize + 11) % answers.len()];
    let wrong: Vec<usize> = pixels.into_iter().filter(|pixel| answers[*pixel] != moved(*pixel)).collect();
    let passes = |pixel: &&usize| judge.is_plausible(&ray(scene, **pixel), moved(**pixel));
    agreement.wrong += wrong.len();
    agreement.fooled += wrong.par_iter().filter(passes).count();
}

fn answers(film: &Film) -> Vec<Option<Answer>> {
    film.aovs.as_ref().unwrap().iter().map(Answer::of_aov).collect()
}

/// The camera ray of a pixel's first sample, in f64.
fn ray(scene: &FlatScene, pixel: usize) -> Ray<f64> {
    camera::generate::<f64>(&scene.params, scene.features, pixel as u32, 0, &mut Counters::default()).ray
}
