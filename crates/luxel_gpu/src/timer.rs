//! Times of passes, from timestamp queries.
//!
//! Queries come in blocks of a fixed number of passes. A submit takes as many blocks from the pool as it has passes for,
//! resolves them at its end, and gives them back when its times have been read; so blocks rotate among the submits in
//! flight and the pool grows to the largest number ever in flight.

use std::sync::{Mutex, PoisonError};

use serde::Serialize;

use crate::{Gpu, GpuError};

/// Passes that one block can time.
const PASSES_PER_BLOCK: u32 = 32;
const QUERIES_PER_BLOCK: u32 = 2 * PASSES_PER_BLOCK;
const BLOCK_BYTES: u64 = QUERIES_PER_BLOCK as u64 * wgpu::QUERY_SIZE as u64;

/// Time of one pass.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct PassTime {
    /// The pass's label.
    pub label: &'static str,
    /// Milliseconds on the GPU; `None` where the adapter has no timestamps.
    pub gpu_ms: Option<f64>,
}

/// Times of one submit.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct PassTimes {
    /// One entry for each pass, in the order they were recorded.
    pub passes: Vec<PassTime>,
    /// Milliseconds from the submit to the end of the wait for it, on the host's clock.
    pub wall_ms: f64,
}

impl PassTimes {
    /// What the submit cost, in milliseconds: the sum over its passes where all were timed, else wall time.
    pub fn busy_ms(&self) -> f64 {
        let timed: Option<f64> = self.passes.iter().map(|pass| pass.gpu_ms).sum();
        match timed {
            Some(ms) if !self.passes.is_empty() => ms,
            _ => self.wall_ms,
        }
    }
}

/// Queries for up to [`PASSES_PER_BLOCK`] passes and the buffers that bring their values home.
#[derive(Debug)]
pub(crate) struct TimerBlock {
    queries: wgpu::QuerySet,
    resolved: wgpu::Buffer,
    readback: wgpu::Buffer,
    passes: u32,
}

impl TimerBlock {
    /// The queries of the next pass, or `None` when the block is full.
    pub(crate) fn next_pass(&mut self) -> Option<wgpu::ComputePassTimestampWrites<'_>> {
        let pass = self.passes;
        if pass == PASSES_PER_BLOCK {
            return None;
        }
        self.passes += 1;
        Some(wgpu::ComputePassTimestampWrites {
            query_set: &self.queries,
            beginning_of_pass_write_index: Some(2 * pass),
            end_of_pass_write_index: Some(2 * pass + 1),
        })
    }

    /// Whether [`Self::next_pass`] would have none.
    pub(crate) fn is_full(&self) -> bool {
        self.passes == PASSES_PER_BLOCK
    }

    /// Records the way of the values from the queries to the readback buffer.
    pub(crate) fn resolve(&self, encoder: &mut wgpu::CommandEncoder) {
        let bytes = u64::from(2 * self.passes) * u64::from(wgpu::QUERY_SIZE);
        encoder.resolve_query_set(&self.queries, 0..2 * self.passes, &self.resolved, 0);
        encoder.copy_buffer_to_buffer(&self.resolved, 0, &self.readback, 0, bytes);
    }

    /// Asks for the readback buffer to be mapped, once the submit with [`Self::resolve`] in it is under way.
    pub(crate) fn request(&self) {
        // Whether the mapping worked shows when its range is asked for.
        self.readback.map_async(wgpu::MapMode::Read, .., |_| ());
    }

    /// Milliseconds of each pass, after the submit is done. A pass whose clock ran backwards counts as zero.
    fn read(&self, tick_ms: f64) -> Option<Vec<f64>> {
        let view = self.readback.get_mapped_range(..).ok()?;
        let ticks: Vec<u64> = bytemuck::pod_collect_to_vec(&view);
        drop(view);
        self.readback.unmap();
        let pairs = ticks.chunks_exact(2).take(self.passes as usize);
        Some(pairs.map(|pair| pair[1].saturating_sub(pair[0]) as f64 * tick_ms).collect())
    }
}

/// The device's free blocks.
#[derive(Debug)]
pub(crate) struct TimerPool {
    enabled: bool,
    tick_ms: f64,
    free: Mutex<Vec<TimerBlock>>,
}

impl TimerPool {
    /// `tick_ns`: nanoseconds per tick of the device's clock.
    pub(crate) fn new(enabled: bool, tick_ns: f32) -> Self {
        Self { enabled, tick_ms: f64::from(tick_ns) * 1e-6, free: Mutex::new(Vec::new()) }
    }

    /// A block to time passes with; `None` where the adapter has no timestamps.
    pub(crate) fn take(&self, gpu: &Gpu) -> Result<Option<TimerBlock>, GpuError> {
        if !self.enabled {
            return Ok(None);
        }
        let free = self.free.lock().unwrap_or_else(PoisonError::into_inner).pop();
        match free {
            Some(block) => Ok(Some(block)),
            None => new_block(gpu).map(Some),
        }
    }

    /// Milliseconds of each pass of the blocks (in order), which return to the pool. `None` for passes without a time.
    pub(crate) fn read(&self, blocks: Vec<TimerBlock>, passes: usize) -> Vec<Option<f64>> {
        let mut times = Vec::with_capacity(passes);
        for mut block in blocks {
            let Some(ms) = block.read(self.tick_ms) else {
                times.extend((0..block.passes).map(|_| None));
                continue;
            };
            times.extend(ms.into_iter().map(Some));
            block.passes = 0;
            self.free.lock().unwrap_or_else(PoisonError::into_inner).push(block);
        }
        times.resize(passes, None);
        times
    }
}

fn new_block(gpu: &Gpu) -> Result<TimerBlock, GpuError> {
    gpu.scoped("pass timers", 2 * BLOCK_BYTES, |device| {
        let buffer = |usage| {
            device.create_buffer(&wgpu::BufferDescriptor {
                label: Some("pass timers"),
                size: BLOCK_BYTES,
                usage,
                mapped_at_creation: false,
            })
        };
        TimerBlock {
            queries: device.create_query_set(&wgpu::QuerySetDescriptor {
                label: Some("pass timers"),
                ty: wgpu::QueryType::Timestamp,
                count: QUERIES_PER_BLOCK,
            }),
            resolved: buffer(wgpu::BufferUsages::QUERY_RESOLVE | wgpu::BufferUsages::COPY_SRC),
            readback: buffer(wgpu::BufferUsages::COPY_DST | wgpu::BufferUsages::MAP_READ),
            passes: 0,
        }
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn busy_time_is_the_sum_of_passes_or_else_wall_time() {
        let pass = |gpu_ms| PassTime { label: "p", gpu_ms };
        let times = |passes| PassTimes { passes, wall_ms: 9.0 };
        assert_eq!(times(vec![pass(Some(1.0)), pass(Some(2.5))]).busy_ms(), 3.5);
        assert_eq!(times(vec![pass(Some(1.0)), pass(None)]).busy_ms(), 9.0);
        assert_eq!(times(vec![]).busy_ms(), 9.0);
    }
}
