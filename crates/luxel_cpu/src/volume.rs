//! Hits in a voxel volume: its sparse octree, front to back by the ray's octant.
//!
//! Boxes come from integer cells, so that a node's box contains its children's exactly. The stack holds one
//! node per level; which sibling is next follows from the cell's low bits.
use luxel_flat::{Counter, Counters, Instance, MAX_SVO_DEPTH, SvoNode};
use luxel_geom::{Real, SlabRay, voxel};

use crate::Exclusion;
use crate::cloud::octant;
use crate::hit::PrimitiveHit;
use crate::query::{Query, Search};

/// The wanted voxel along a ray in the volume's space.
pub fn intersect<R: Real>(query: &Query<'_, R>, counters: &mut Counters) -> Option<PrimitiveHit<R>> {
    let instance = query.instance;
    let nodes = &query.scene.svo_nodes.as_slice()[instance.node_first as usize..];
    let octant = octant(&query.ray);
    let mut search = Search::new(query);
    let mut stack = [0u32; MAX_SVO_DEPTH as usize + 1];
    let (mut depth, mut cell, mut rank) = (0u32, [0u32; 3], 0);
    if instance.node_count == 0 || !enters(cell, 1 << instance.levels, &search.ray, counters) {
        return None;
    }
    loop {
        let node = &nodes[stack[depth as usize] as usize];
        if node.child_mask == 0 {
            counters[Counter::VoxelTests] += 1;
            let slot = instance.node_first + stack[depth as usize];
            search.offer(intersect_voxel(node, slot, cell, instance, &search.ray, &search.exclusion));
            if search.is_over() {
                return search.best;
            }
        }
        let child_edge = (1 << (instance.levels - depth)) / 2;
        if let Some(child) = next_child(node, cell, child_edge, rank, octant, &search.ray, counters) {
            depth += 1;
            stack[depth as usize] = child_node(node, child);
            cell = child_cell(cell, child);
            rank = 0;
        } else if depth == 0 {
            return search.best;
        } else {
            let child = cell[0] & 1 | (cell[1] & 1) << 1 | (cell[2] & 1) << 2;
            rank = (child ^ octant) + 1;
            cell = cell.map(|c| c >> 1);
            depth -= 1;
        }
    }
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
        material: instance.material_first + node.material,
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

/// The node of an existing child, relative to the volume.
#[inline]
pub fn child_node(node: &SvoNode, child: u32) -> u32 {
    node.first_child + (node.child_mask & ((1 << child) - 1)).count_ones()
}

/// The cell of a child, one level down.
#[inline]
pub fn child_cell(cell: [u32; 3], child: u32) -> [u32; 3] {
    [cell[0] << 1 | child & 1, cell[1] << 1 | child >> 1 & 1, cell[2] << 1 | child >> 2]
}

fn enters<R: Real>(cell: [u32; 3], edge: u32, ray: &SlabRay<R>, counters: &mut Counters) -> bool {
    counters[Counter::SvoNodes] += 1;
    voxel::bounds::<R>(cell, edge).interval(ray).overlaps(ray.t_min, ray.t_max)
}

/// The next child that the ray enters, from `rank` on in the ray's order.
fn next_child<R: Real>(
    node: &SvoNode,
    cell: [u32; 3],
    child_edge: u32,
    rank: u32,
    octant: u32,
    ray: &SlabRay<R>,
    counters: &mut Counters,
) -> Option<u32> {
    (rank..8)
        .map(|rank| rank ^ octant)
        .filter(|child| node.child_mask & (1 << child) != 0)
        .find(|child| enters(child_cell(cell, *child), child_edge, ray, counters))
}

#[cfg(test)]
mod tests {
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
