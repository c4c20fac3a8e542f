//! The one place that records and submits GPU work.
//!
//! A [`Frame`] owns the open command encoder. Passes are recorded into it, [`Frame::submit`] ends it, and the next pass
//! opens another: a frame may be many short submits, so that no watchdog fires.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Instant;

use crate::timer::TimerBlock;
use crate::{BindSet, Gpu, GpuBuffer, GpuError, GpuLimits, PassTime, PassTimes, Pipeline};

/// Bytes of the three workgroup counts that an indirect pass reads.
const INDIRECT_BYTES: u64 = 12;

/// Records passes and submits them.
#[derive(Debug)]
pub struct Frame {
    gpu: Gpu,
    open: Option<Recording>,
}

#[derive(Debug)]
struct Recording {
    encoder: wgpu::CommandEncoder,
    labels: Vec<&'static str>,
    timers: Vec<TimerBlock>,
}

impl Frame {
    /// A frame with nothing recorded.
    pub fn new(gpu: &Gpu) -> Self {
        Self { gpu: gpu.clone(), open: None }
    }

    /// Records a pass of `workgroups` of the kernel (zero in any dimension runs nothing, and is timed).
    ///
    /// # Errors
    /// [`GpuError::LimitExceeded`] for more workgroups than one dimension may have; [`GpuError::Lost`].
    pub fn compute(
        &mut self,
        label: &'static str,
        pipeline: &Pipeline,
        bindings: &BindSet,
        workgroups: [u32; 3],
    ) -> Result<(), GpuError> {
        let has = self.gpu.limits().max_workgroups_per_dimension;
        if let Some(&needs) = workgroups.iter().find(|&&count| count > has) {
            return Err(GpuError::LimitExceeded {
                what: format!("one dimension of pass '{label}' in workgroups"),
                needs: needs.into(),
                has: has.into(),
            });
        }
        let [x, y, z] = workgroups;
        self.pass(label, pipeline, bindings, |pass| pass.dispatch_workgroups(x, y, z))
    }

    /// Records a pass that reads its three workgroup counts (`u32` each) from `counts` at byte `offset` when it runs.
    /// Counts beyond the device's limit run nothing.
    ///
    /// # Errors
    /// [`GpuError::BadRange`] for an offset outside the buffer or not aligned to 4; [`GpuError::Lost`].
    pub fn compute_indirect(
        &mut self,
        label: &'static str,
        pipeline: &Pipeline,
        bindings: &BindSet,
        counts: &GpuBuffer,
        offset: u64,
    ) -> Result<(), GpuError> {
        counts.check_range(offset, INDIRECT_BYTES)?;
        self.pass(label, pipeline, bindings, |pass| {
            pass.dispatch_workgroups_indirect(counts.raw(), offset);
        })
    }

    /// Records setting all of `buffer` to zero.
    ///
    /// # Errors
    /// [`GpuError::Lost`].
    pub fn clear(&mut self, buffer: &GpuBuffer) -> Result<(), GpuError> {
        self.recording()?.encoder.clear_buffer(buffer.raw(), 0, None);
        Ok(())
    }

    /// Records a copy of `bytes` from `source` (first, offset in bytes) to `target`, which must be another buffer.
    ///
    /// # Errors
    /// [`GpuError::BadRange`] for a range outside its buffer or not aligned to 4; [`GpuError::Lost`].
    pub fn copy(
        &mut self,
        (source, source_offset): (&GpuBuffer, u64),
        (target, target_offset): (&GpuBuffer, u64),
        bytes: u64,
    ) -> Result<(), GpuError> {
        source.check_range(source_offset, bytes)?;
        target.check_range(target_offset, bytes)?;
        let encoder = &mut self.recording()?.encoder;
        encoder.copy_buffer_to_buffer(source.raw(), source_offset, target.raw(), target_offset, bytes);
        Ok(())
    }

    /// Submits what was recorded; the frame is then empty.
    ///
    /// # Errors
    /// [`GpuError::Validation`] naming the passes when one of them was invalid; [`GpuError::Lost`], …
    pub fn submit(&mut self) -> Result<Submission, GpuError> {
        let Recording { mut encoder, labels, timers } = self.take_recording()?;
        let what = format!("passes {}", labels.join(", "));
        let queue = self.gpu.queue();
        let started = Instant::now();
        let index = self.gpu.scoped(&what, 0, |_| {
            for block in &timers {
                block.resolve(&mut encoder);
            }
            let index = queue.submit([encoder.finish()]);
            timers.iter().for_each(TimerBlock::request);
            index
        })?;
        let done = Arc::new(AtomicBool::new(false));
        let flag = Arc::clone(&done);
        queue.on_submitted_work_done(move || flag.store(true, Ordering::Release));
        Ok(Submission { index, labels, timers, started, done })
    }

    fn pass(
        &mut self,
        label: &'static str,
        pipeline: &Pipeline,
        bindings: &BindSet,
        dispatch: impl FnOnce(&mut wgpu::ComputePass<'_>),
    ) -> Result<(), GpuError> {
        let gpu = self.gpu.clone();
        let Recording { encoder, labels, timers } = self.recording()?;
        if timers.last().is_none_or(TimerBlock::is_full) {
            timers.extend(gpu.timers().take(&gpu)?);
        }
        labels.push(label);
        // The label is the pass's debug group. A group pushed on the encoder around the pass would begin and end in
        // different command buffers of wgpu's, upon which Mesa 22.3 crashes (its label stack underflows).
        let mut pass = encoder.begin_compute_pass(&wgpu::ComputePassDescriptor {
            label: Some(label),
            timestamp_writes: timers.last_mut().and_then(TimerBlock::next_pass),
        });
        pass.set_pipeline(pipeline.raw());
        for (group, bind_group) in bindings.groups() {
            pass.set_bind_group(group, bind_group, &[]);
        }
        dispatch(&mut pass);
        Ok(())
    }

    fn recording(&mut self) -> Result<&mut Recording, GpuError> {
        let recording = self.take_recording()?;
        Ok(self.open.insert(recording))
    }

    fn take_recording(&mut self) -> Result<Recording, GpuError> {
        if let Some(recording) = self.open.take() {
            return Ok(recording);
        }
        let encoder = self.gpu.scoped("command encoder", 0, |device| {
            device.create_command_encoder(&wgpu::CommandEncoderDescriptor { label: Some("frame") })
        })?;
        Ok(Recording { encoder, labels: Vec::new(), timers: Vec::new() })
    }
}

/// Work under way on the GPU.
#[derive(Debug)]
pub struct Submission {
    index: wgpu::SubmissionIndex,
    labels: Vec<&'static str>,
    timers: Vec<TimerBlock>,
    started: Instant,
    done: Arc<AtomicBool>,
}

impl Submission {
    /// Whether the work is done; does not wait.
    ///
    /// # Errors
    /// What [`Gpu::check`] finds.
    pub fn is_done(&self, gpu: &Gpu) -> Result<bool, GpuError> {
        gpu.check()?;
        Ok(self.done.load(Ordering::Acquire))
    }

    /// Waits for the work and tells the times of its passes.
    ///
    /// # Errors
    /// [`GpuError::Timeout`], or what [`Gpu::check`] finds.
    pub fn wait(self, gpu: &Gpu) -> Result<PassTimes, GpuError> {
        gpu.wait_for(Some(self.index), &format!("passes {}", self.labels.join(", ")))?;
        let wall_ms = self.started.elapsed().as_secs_f64() * 1e3;
        let times = gpu.timers().read(self.timers, self.labels.len());
        let passes = self.labels.into_iter().zip(times);
        let passes = passes.map(|(label, gpu_ms)| PassTime { label, gpu_ms }).collect();
        Ok(PassTimes { passes, wall_ms })
    }
}

/// Workgroups for `items` in workgroups of `width` items (in x), spread over y where x alone would pass the limit: the
/// item is `global_id.x + global_id.y * num_workgroups.x * width`, and may lie beyond `items`.
///
/// # Errors
/// [`GpuError::LimitExceeded`] when two dimensions do not suffice.
pub fn workgroups_for(items: u64, width: u32, limits: &GpuLimits) -> Result<[u32; 3], GpuError> {
    let max = u64::from(limits.max_workgroups_per_dimension);
    let groups = items.div_ceil(u64::from(width.max(1)));
    let rows = groups.div_ceil(max);
    if rows > max {
        return Err(GpuError::LimitExceeded {
            what: format!("a dispatch of {items} items in workgroups"),
            needs: groups,
            has: max * max,
        });
    }
    let columns = groups.div_ceil(rows.max(1));
    // Both are at most `max`, a u32.
    Ok([columns as u32, rows as u32, 1])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn workgroups_cover_all_items_with_little_waste() {
        let limits = GpuLimits::from(&wgpu::Limits::default());
        for items in [0, 1, 63, 64, 65, 65_535 * 64, 65_535 * 64 + 1, 1 << 32, 123_456_789_012] {
            let [x, y, z] = workgroups_for(items, 64, &limits).unwrap();
            let covered = u64::from(x) * u64::from(y) * 64;
            assert!(x <= 65_535 && y <= 65_535 && z == 1);
            assert!(covered >= items, "{items} items, {covered} covered");
            assert!(covered < items + 64 * u64::from(y.max(1)) + 64, "{items} items, {covered} covered");
        }
        assert_eq!(workgroups_for(0, 64, &limits).unwrap(), [0, 0, 1]);
        assert!(matches!(workgroups_for(1 << 40, 64, &limits), Err(GpuError::LimitExceeded { .. })));
    }
}
