//! The nodes: each a system that records its passes into the frame.
use bevy_ecs::prelude::*;
use luxel_flat::{Feature, SliceParams, WORKGROUP_SIZE};
use luxel_gpu::{Frame, Gpu, GpuError, Kernel, workgroups_for};

use crate::graph::ActiveFeatures;
use crate::kernels::{
    ACCUMULATE, FIRST_HITS, GENERATE, INTERSECT, Pipelines, RESOLVE, SCATTER, SHADE, SHADOW, SURFACE,
};
use crate::{GpuFilm, GpuScene};

/// The device.
#[derive(Resource)]
pub(crate) struct Device(pub(crate) Gpu);

/// The open frame.
#[derive(Resource)]
pub(crate) struct OpenFrame(pub(crate) Frame);

/// What a frame is for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Purpose {
    /// Adding a sample to the slice's pixels, or a part of that.
    Trace {
        /// Paths start here.
        starts: bool,
        /// Surfaces that are shaded.
        bounces: u32,
        /// Paths end here and go to the film.
        finishes: bool,
    },
    /// Making the picture.
    Resolve,
}

impl Default for Purpose {
    fn default() -> Self {
        Self::Trace { starts: false, bounces: 0, finishes: false }
    }
}

/// What this frame works on.
#[derive(Resource, Default)]
pub(crate) struct Work {
    /// Pixels and sample.
    pub(crate) slice: SliceParams,
    /// The film tile they belong to.
    pub(crate) tile: usize,
    /// What is done for them in this frame.
    pub(crate) purpose: Purpose,
}

/// What every node that dispatches needs.
#[derive(bevy_ecs::system::SystemParam)]
pub(crate) struct Dispatch<'w> {
    device: Res<'w, Device>,
    frame: ResMut<'w, OpenFrame>,
    pipelines: Res<'w, Pipelines>,
    scene: Res<'w, GpuScene>,
    film: Res<'w, GpuFilm>,
    work: Res<'w, Work>,
}

impl Dispatch<'_> {
    /// Records one pass of a kernel, one thread per pixel of the slice.
    fn over_slice(&mut self, kernel: &Kernel) -> Result<(), GpuError> {
        let gpu = &self.device.0;
        let pipeline = self.pipelines.get(kernel)?;
        let resources = self.film.resources(self.scene.resources(), self.work.tile);
        let bindings = pipeline.bind(gpu, &resources)?;
        let pixels = self.work.slice.pixel_count.into();
        let workgroups = workgroups_for(pixels, WORKGROUP_SIZE, gpu.limits())?;
        self.frame.0.compute(kernel.entry, pipeline, &bindings, workgroups)
    }

    /// Traces the paths' rays up to the surfaces that they meet.
    fn rays(&mut self) -> Result<(), GpuError> {
        self.over_slice(&INTERSECT)?;
        self.over_slice(&SURFACE)
    }
}

/// Tells the kernels which pixels and which sample they work on.
pub(crate) fn begin(device: Res<Device>, scene: Res<GpuScene>, work: Res<Work>) -> Result<(), GpuError> {
    scene.write_slice(&device.0, &work.slice)
}

/// Starts a path per pixel.
pub(crate) fn generate(mut dispatch: Dispatch) -> Result<(), GpuError> {
    dispatch.over_slice(&GENERATE)
}

/// Traces the camera's rays.
pub(crate) fn camera_rays(mut dispatch: Dispatch) -> Result<(), GpuError> {
    dispatch.rays()
}

/// Writes what they met.
pub(crate) fn first_hits(mut dispatch: Dispatch) -> Result<(), GpuError> {
    dispatch.over_slice(&FIRST_HITS)
}

/// Shades, and traces what was scattered, as often as this frame is to. The shadow rays of a bounce are a node in the
/// table, but no system: they stand between two passes of this one.
pub(crate) fn bounces(mut dispatch: Dispatch, features: Res<ActiveFeatures>) -> Result<(), GpuError> {
    let Purpose::Trace { starts, bounces, .. } = dispatch.work.purpose else { return Ok(()) };
    for bounce in 0..bounces {
        if bounce > 0 || !starts {
            dispatch.rays()?;
        }
        dispatch.over_slice(&SHADE)?;
        if features.0.has(Feature::Lights) {
            dispatch.over_slice(&SHADOW)?;
        }
        dispatch.over_slice(&SCATTER)?;
    }
    Ok(())
}

/// Adds the finished paths to the film.
pub(crate) fn accumulate(mut dispatch: Dispatch) -> Result<(), GpuError> {
    dispatch.over_slice(&ACCUMULATE)
}

/// Makes the picture of a tile.
pub(crate) fn resolve(mut dispatch: Dispatch) -> Result<(), GpuError> {
    dispatch.over_slice(&RESOLVE)
}
