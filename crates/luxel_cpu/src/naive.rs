//! The oracle: every primitive of every instance tested, no structure used.
//!
//! Shares the primitive tests and the tie-break with [`crate::traverse`], and nothing else, so equality of the
//! two, bit for bit, speaks for the structures and their traversal.
use luxel_flat::{Counters, FlatScene, Instance, KIND_MESH, KIND_SPHERES, KIND_VOXELS, SvoNode};
use luxel_geom::triangle::TriangleRay;
use luxel_geom::{Ray, Real, SlabRay};

use crate::alpha::passes_alpha;
use crate::hit::PrimitiveHit;
use crate::{Exclusion, Hit, cloud, instance, mesh, svo_walk, volume};

/// A scene prepared for exhaustive search.
pub struct Naive<'a> {
    scene: &'a FlatScene,
    /// For each instance slot, its solid voxels (empty for other kinds).
    voxels: Vec<Vec<SolidVoxel>>,
}

/// A solid voxel: its node's slot, its cell, its node.
struct SolidVoxel {
    slot: u32,
    cell: [u32; 3],
    node: SvoNode,
}

impl<'a> Naive<'a> {
    /// Lists what there is to test.
    pub fn new(scene: &'a FlatScene) -> Self {
        let voxels = scene.instances.as_slice().iter().map(|i| solid_voxels(scene, i)).collect();
        Self { scene, voxels }
    }

    /// The closest hit with `t_min < t <= t_max`; ties by stable ids. An invalid ray hits nothing.
    pub fn intersect<R: Real>(&self, ray: &Ray<R>, exclusion: &Exclusion) -> Option<Hit<R>> {
        if !ray.is_valid() {
            return None;
        }
        let slab_ray = SlabRay::new(ray);
        let mut best = None;
        for (slot, instance) in self.scene.instances.as_slice().iter().enumerate() {
            if instance.node_count == 0 {
                continue;
            }
            let interval = instance::world_interval(instance, &slab_ray);
            if !interval.overlaps(ray.t_min, ray.t_max) {
                continue;
            }
            let object_ray = instance::object_ray(instance, &slab_ray, ray.t_max);
            let on = self.on_instance(slot as u32, instance, &object_ray, exclusion);
            let hit = on.and_then(|on| instance::finish(slot as u32, instance, on, &interval, &slab_ray));
            best = hit.filter(|hit| hit.precedes(&best)).or(best);
        }
        best
    }

    fn on_instance<R: Real>(
        &self,
        slot: u32,
        instance: &Instance,
        ray: &SlabRay<R>,
        exclusion: &Exclusion,
    ) -> Option<PrimitiveHit<R>> {
        let exclusion = &exclusion.within(slot);
        match instance.kind {
            KIND_SPHERES => {
                let live = self.scene.spheres.as_slice().iter().enumerate().filter(|(_, s)| s.radius > 0.0);
                first(live.filter_map(|(slot, s)| cloud::intersect_sphere(s, slot as u32, ray, exclusion)))
            }
            KIND_MESH => {
                let triangle_ray = TriangleRay::new(ray);
                let slots = instance.primitive_first..instance.primitive_first + instance.primitive_count;
                first(slots.filter_map(|slot| {
                    let record = &self.scene.triangles.as_slice()[slot as usize];
                    let hit =
                        mesh::intersect_triangle(record, slot, instance, ray, &triangle_ray, exclusion)?;
                    let counters = &mut Counters::default();
                    (!passes_alpha(self.scene, instance, &hit, exclusion.coins, counters)).then_some(hit)
                }))
            }
            _ => {
                first(self.voxels[slot as usize].iter().filter_map(|v| {
                    volume::intersect_voxel(&v.node, v.slot, v.cell, instance, ray, exclusion)
                }))
            }
        }
    }
}

fn first<R: Real>(hits: impl Iterator<Item = PrimitiveHit<R>>) -> Option<PrimitiveHit<R>> {
    hits.fold(None, |best, hit| if hit.precedes(&best) { Some(hit) } else { best })
}

fn solid_voxels(scene: &FlatScene, instance: &Instance) -> Vec<SolidVoxel> {
    let mut solid = Vec::new();
    if instance.kind != KIND_VOXELS || instance.node_count == 0 {
        return solid;
    }
    let nodes = &scene.svo_nodes.as_slice()[instance.node_first as usize..];
    let mut open = vec![(0u32, [0u32; 3])];
    while let Some((index, cell)) = open.pop() {
        let node = nodes[index as usize];
        if node.child_mask() == 0 {
            solid.push(SolidVoxel { slot: instance.node_first + index, cell, node });
        }
        for child in (0..8).filter(|child| node.child_mask() & (1 << child) != 0) {
            open.push((svo_walk::child_node(&node, child), svo_walk::child_cell(cell, child)));
        }
    }
    solid
}
