//! The flat arrays that bake keeps, each with the allocator that hands out its ranges.
use bevy_ecs::prelude::Resource;
use luxel_accel::Svo;
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
    /// What each of those nodes shows, in the same slots.
    pub svo_colors: Heap<u32>,
    pub instances: Store<Instance>,
    pub materials: MaterialStore,
    pub textures: Store<TextureSlot>,
    pub texels: Store<u32>,
    pub albedo_tables: Heap<f32>,
    pub lights: Heap<LightRecord>,
    pub light_nodes: Heap<LightNode>,
    pub environment: Heap<[f32; 4]>,
}

impl Heaps {
    /// Copies an octree to a free range, which answers for its nodes and for what they show.
    pub(crate) fn place_octree(&mut self, svo: &Svo, revision: u64) -> Result<Span, BakeError> {
        let span = self.svo_nodes.place(&svo.nodes, revision)?;
        self.fit_colors(revision);
        self.svo_colors.write(span.first as usize, &svo.colors, revision);
        Ok(span)
    }

    /// Gives the range of an octree back.
    pub(crate) fn release_octree(&mut self, span: Span, revision: u64) {
        self.svo_nodes.release(span, revision);
        self.fit_colors(revision);
    }

    fn fit_colors(&mut self, revision: u64) {
        self.svo_colors.resize(self.svo_nodes.heap.len(), revision);
    }
}

#[cfg(test)]
mod tests {
    use glam::UVec3;
    use luxel_accel::{SvoVoxel, build_svo};

    use super::*;

    /// An octree of one colour and material, told apart by `number`.
    fn octree(number: u8, count: u16) -> Svo {
        let cell = |i: u16| [i % 16, i / 16 % 16, i / 256].map(|c| 3 * c);
        let voxel = |i| SvoVoxel { cell: cell(i), color: [number, i as u8, 7], material: number };
        build_svo(&(0..count).map(voxel).collect::<Vec<_>>(), UVec3::splat(64)).unwrap()
    }

    /// Whatever comes and goes, each node stands with what it shows, and both heaps are equally long.
    #[test]
    fn colours_stand_with_their_nodes() {
        let (mut heaps, mut placed) = (Heaps::default(), Vec::new());
        let check = |heaps: &Heaps, placed: &[(Span, Svo)]| {
            assert_eq!(heaps.svo_colors.len(), heaps.svo_nodes.heap.len());
            for (span, svo) in placed {
                assert_eq!(heaps.svo_nodes.heap.as_slice()[span.range()], svo.nodes);
                assert_eq!(heaps.svo_colors.as_slice()[span.range()], svo.colors);
            }
        };
        for round in 0u8..60 {
            let svo = octree(round, 1 + u16::from(round) * 37 % 400);
            let span = heaps.place_octree(&svo, u64::from(round) + 1).unwrap();
            placed.push((span, svo));
            check(&heaps, &placed);
            // Now and then the oldest, a middle one or the last goes: a gap, or a shorter heap.
            if round % 3 > 0 {
                let (span, _) =
                    placed.remove([0, placed.len() / 2, placed.len() - 1][usize::from(round / 3 % 3)]);
                heaps.release_octree(span, u64::from(round) + 1);
                check(&heaps, &placed);
            }
        }
        while let Some((span, _)) = placed.pop() {
            heaps.release_octree(span, 100);
            check(&heaps, &placed);
        }
        assert!(heaps.svo_nodes.heap.is_empty());
    }
}
