//! A tree over triangles in the heaps: built and placed, or brought back out and refitted where it stands.
use glam::Vec3;
use luxel_accel::MeshBvh;
use luxel_flat::Span;
use luxel_geom::Aabb;

use crate::BakeError;
use crate::store::Heaps;

/// Where a tree and its triangles stand.
#[derive(Clone, Copy, Debug)]
pub(crate) struct MeshTree {
    /// No node for triangles without a tree of their own.
    pub nodes: Span,
    pub triangles: Span,
    /// Box of the root, in the coordinates of the triangles.
    pub bounds: Aabb<f32>,
    /// What the tree cost when it was last built, what of that no tree could have saved, and half the surface of its box.
    built_cost: f64,
    built_floor: f64,
    built_area: f64,
    /// Refits since then.
    refits: u32,
}

impl MeshTree {
    /// Puts a tree as built into the heaps.
    pub(crate) fn place(bvh: &MeshBvh, heaps: &mut Heaps, revision: u64) -> Result<Self, BakeError> {
        let nodes = heaps.bvh_nodes.place(&bvh.nodes, revision)?;
        let triangles = heaps.triangles.place(&bvh.triangles, revision).inspect_err(|_| {
            heaps.bvh_nodes.release(nodes, revision);
        })?;
        Ok(Self {
            nodes,
            triangles,
            bounds: bvh.bounds,
            built_cost: bvh.built_cost,
            built_floor: bvh.built_floor,
            built_area: bvh.built_area,
            refits: bvh.refits,
        })
    }

    /// Gives its place in the heaps back.
    pub(crate) fn release(&self, heaps: &mut Heaps, revision: u64) {
        heaps.bvh_nodes.release(self.nodes, revision);
        heaps.triangles.release(self.triangles, revision);
    }

    /// Lets the tree follow its triangles to other places, in the slots that they have; `number` tells where in `indices`
    /// the triangle of an id stands, `mark` has the last word on each triangle.
    ///
    /// `None`, with everything as it was, if the tree should be built: there is none, it has other triangles, a place is
    /// no place (a build then says so), or rays would pay for the old shape: its nodes cost by the surface area heuristic
    /// more than [`REBUILD_RATIO`](luxel_accel::REBUILD_RATIO) times those of the last build, that build was over quite
    /// another shape, or it was long ago. The cost is counted in the tree, not timed, so that two runs decide alike.
    pub(crate) fn refitted(
        &self,
        (positions, indices): (&[Vec3], &[[u32; 3]]),
        number: impl Fn(u32) -> Option<u32>,
        mark: impl Fn(&mut luxel_flat::Triangle),
        heaps: &mut Heaps,
        revision: u64,
    ) -> Option<Self> {
        if self.nodes.count == 0 {
            return None;
        }
        let triangles = heaps.triangles.heap.as_slice().get(self.triangles.range())?.to_vec();
        let mut bvh = MeshBvh {
            nodes: heaps.bvh_nodes.heap.as_slice().get(self.nodes.range())?.to_vec(),
            order: triangles.iter().map(|triangle| number(triangle.id)).collect::<Option<_>>()?,
            triangles,
            bounds: self.bounds,
            built_cost: self.built_cost,
            built_floor: self.built_floor,
            built_area: self.built_area,
            refits: self.refits,
        };
        let refit = bvh.refit(positions, indices).ok()?;
        if refit.is_rebuild_due() {
            return None;
        }
        bvh.triangles.iter_mut().for_each(mark);
        heaps.bvh_nodes.overwrite(self.nodes, &bvh.nodes, revision);
        heaps.triangles.overwrite(self.triangles, &bvh.triangles, revision);
        Some(Self { bounds: bvh.bounds, refits: bvh.refits, ..*self })
    }
}
