//! Figure 14: the same picture from the CPU and from the GPU.
use super::super::record::{Run, Sweep};
use super::super::select::{Runs, setting};
use crate::kit::figure::{Figure, Part};
use crate::kit::picture::flip;
use crate::kit::text::{short, times};
use crate::kit::verdict::{Case, Verdict};

/// Mean FLIP difference up to which two pictures count as the same: both backends draw the same random numbers.
const ALIKE: f64 = 0.02;

pub(crate) fn figure(runs: &Runs<'_>) -> Figure {
    let reference = runs.of(Sweep::Reference);
    let of = |backend: &str| reference.on(backend).first();
    let verdict = match (of("cpu"), of("gpu")) {
        (Some(cpu), Some(gpu)) => compared(&reference, cpu, gpu),
        _ => Verdict::not_measured(),
    };
    let pictures = reference.iter().filter_map(|run| {
        let text = format!("{}, {} per frame of one sample", run.place(), ms(run));
        Some((run.picture_png.clone()?, text))
    });
    let pictures: Vec<(String, String)> = pictures.collect();
    Figure {
        number: 14,
        title: "The CPU path tracer as comparison".to_owned(),
        shows: format!(
            "The same room by both backends ({}).",
            setting(reference.first())
        ),
        claim: Some(
            "Path tracing on the GPU is very fast and can be made to work in real time; on the CPU such a picture took \
             one and a half to two hours. Expected: both show the same."
                .to_owned(),
        ),
        verdict,
        parts: if pictures.is_empty() { Vec::new() } else { vec![Part::Pictures(pictures)] },
    }
}

fn ms(run: &Run) -> String {
    format!("{} ms", short(run.frame_ms))
}

/// What the picture would take at the report's size.
fn minutes_text(cpu: &Run) -> String {
    let minutes = f64::from(cpu.picture_spp) / cpu.fps_of_report() / 60.0;
    format!(
        "At 1920×1080 with {} samples per pixel the picture is {} minutes on this CPU, if time goes with the samples. ",
        cpu.picture_spp,
        short(minutes)
    )
}

fn compared(runs: &Runs<'_>, cpu: &Run, gpu: &Run) -> Verdict {
    let ratio = gpu.fps / cpu.fps;
    // A software driver is no GPU, so it says nothing about one.
    let is_faster = if gpu.hardware_gpu {
        runs.noise_of(&[runs.on("cpu"), runs.on("gpu")]).faster(ratio)
    } else {
        Case::Open
    };
    let mut cases = vec![is_faster];
    let mut because =
        format!("The {} makes {} the frames of the CPU. {}", gpu.place(), times(ratio), minutes_text(cpu));
    if let (Some(a), Some(b)) = (cpu.picture_png.as_deref(), gpu.picture_png.as_deref())
        && let Some(difference) = flip(a, b)
    {
        // Alike they are in vain where the speed cannot be told; different they refute the claim in any case.
        if gpu.hardware_gpu || difference >= ALIKE {
            cases.push(Case::from(difference < ALIKE));
        }
        because +=
            &format!("The pictures differ by {} (mean FLIP; same random numbers). ", short(difference));
    }
    Verdict::of(&cases, because)
}
