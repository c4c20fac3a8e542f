//! The flat arrays that bake keeps, each with the allocator that hands out its ranges.
use bevy_ecs::prelude::Resource;
use luxel_flat::{
    BvhNode, Heap, Instance, LightNode, LightRecord, Span, SvoNode, TextureSlot, Triangle, TriangleAttributes,
};

use crate::materials::MaterialStore;
use crate::{BakeError, SpanAllocator};

/// A heap and who owns which part of it.
#[derive(Clone, Debug)]
pub(crate) struct Store<T> {
    pub heap: Heap<T>,
    spans: SpanAllocator,
}

impl<T> Default for Store<T> {
    fn default() -> Self {
        Self { heap: Heap::default(), spans: SpanAllocator::default() }
    }
}

impl<T: Copy + Default + PartialEq> Store<T> {
    /// Copies records to a free range.
    pub(crate) fn place(&mut self, records: &[T], revision: u64) -> Result<Span, BakeError> {
        let count = u32::try_from(records.len()).map_err(|_| BakeError::HeapFull)?;
        let span = self.reserve(count, revision)?;
        self.heap.write(span.first as usize, records, revision);
        Ok(span)
    }

    /// Writes a whole range that is in use.
    pub(crate) fn overwrite(&mut self, span: Span, records: &[T], revision: u64) {
        self.heap.write(span.first as usize, records, revision);
    }

    /// A free range; its records are zero or what was last there.
    pub(crate) fn reserve(&mut self, count: u32, revision: u64) -> Result<Span, BakeError> {
        let span = self.spans.allocate(count).ok_or(BakeError::HeapFull)?;
        self.fit(revision);
        Ok(span)
    }

    /// Gives a range back. Its records keep their content, unless the heap shrinks.
    pub(crate) fn release(&mut self, span: Span, revision: u64) {
        self.spans.release(span);
        self.fit(revision);
    }

    /// The record in a slot.
    pub(crate) fn get(&self, slot: u32) -> T {
        self.heap.as_slice()[slot as usize]
    }

    /// Writes a record if it differs; true if it did.
    pub(crate) fn set(&mut self, slot: u32, record: T, revision: u64) -> bool {
        self.heap.set(slot as usize, record, revision)
    }

    fn fit(&mut self, revision: u64) {
        self.heap.resize(self.spans.end() as usize, revision);
    }
}

/// Every array of the flat scene but those of the sphere cloud and the TLAS, which own theirs.
#[derive(Resource, Default)]
pub(crate) struct Heaps {
    /// One BVH per mesh.
    pub bvh_nodes: Store<BvhNode>,
    pub triangles: Store<Triangle>,
    pub triangle_attributes: Store<TriangleAttributes>,
    pub svo_nodes: Store<SvoNode>,
    pub instances: Store<Instance>,
    pub materials: MaterialStore,
    pub textures: Store<TextureSlot>,
    pub texels: Store<u32>,
    pub albedo_tables: Heap<f32>,
    pub lights: Heap<LightRecord>,
    pub light_nodes: Heap<LightNode>,
    pub environment: Heap<[f32; 4]>,
}
