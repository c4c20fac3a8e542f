//! Hits in a voxel volume: the solid cells that a ray meets on its way through the octree.
use luxel_flat::{Counter, Counters, Instance, SvoNode};
use luxel_geom::{Real, SlabRay, voxel};

use crate::Exclusion;
use crate::hit::PrimitiveHit;
use crate::query::{Query, Search};
use crate::svo_walk::{Step, walk};

/// The wanted voxel along a ray in the volume's space.
pub fn intersect<R: Real>(query: &Query<'_, R>, counters: &mut Counters) -> Option<PrimitiveHit<R>> {
    let instance = query.instance;
    let all = query.scene.svo_nodes.as_slice();
    let nodes = &all[instance.node_first as usize..][..instance.node_count as usize];
    let mut search = Search::new(query);
    let (mut node_count, mut test_count) = (0, 0);
    walk(nodes, instance.levels, &query.ray, |entered| {
        node_count += 1;
        if entered.node.child_mask() != 0 {
            return Step::Down;
        }
        test_count += 1;
        let slot = instance.node_first + entered.index;
        let (ray, exclusion) = (&search.ray, &search.exclusion);
        search.offer(intersect_voxel(entered.node, slot, entered.cell, instance, ray, exclusion));
        if search.is_over() { Step::End } else { Step::Past(search.ray.t_max) }
    });
    counters[Counter::SvoNodes] += node_count;
    counters[Counter::VoxelTests] += test_count;
    search.best
}

/// Tests one solid voxel.
#[inline]
pub fn intersect_voxel<R: Real>(
    node: &SvoNode,
    slot: u32,
    cell: [u32; 3],
    instance: &Instance,
    ray: &SlabRay<R>,
    exclusion: &Exclusion,
) -> Option<PrimitiveHit<R>> {
    let primitive = voxel_id(cell, instance.levels);
    let hit = voxel::intersect(ray, cell, exclusion.of(slot))?;
    Some(PrimitiveHit {
        t: hit.t,
        uv: [R::from_f64(f64::from(hit.face)), R::ZERO],
        slot,
        primitive,
        material: instance.material_first + node.material(),
    })
}

/// Stable id of a voxel: its cell, x lowest. At 2048³ the top bit of z is lost: see [`voxel_cell`].
#[inline]
pub fn voxel_id(cell: [u32; 3], levels: u32) -> u32 {
    cell[0] | cell[1] << levels | cell[2] << (2 * levels)
}

/// The cell of a voxel with an id. What the id does not tell of z is known from `z`, the coordinate of a point of
/// the cell up to rounding.
#[inline]
pub fn voxel_cell(id: u32, levels: u32, z: f32) -> [u32; 3] {
    let mask = (1 << levels) - 1;
    let (low, known) = (id >> (2 * levels), (32 - 2 * levels).min(levels));
    let lost = ((z - low as f32) / (1 << known) as f32).round().max(0.0) as u32;
    [id & mask, id >> levels & mask, low | lost << known & mask]
}

#[cfg(test)]
mod tests {
    use luxel_flat::MAX_SVO_DEPTH;

    use super::*;

    #[test]
    fn a_cell_is_known_from_its_id_and_a_point() {
        for levels in 0..=MAX_SVO_DEPTH {
            let top = (1u32 << levels) - 1;
            for z in [0, 1, top / 2, top / 2 + 1, top].map(|z| z.min(top)) {
                let cell = [top, top / 3, z];
                for at in [0.0, 0.5, 1.0, -1e-3, 1.001] {
                    assert_eq!(voxel_cell(voxel_id(cell, levels), levels, z as f32 + at), cell);
                }
            }
        }
    }
}
