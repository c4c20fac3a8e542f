//! The way of a ray through a sparse voxel octree: the nodes that it enters, front to back.
//!
//! A node's children are told apart by its mid-planes (Revelles, Ureña, Lastra 2000; Laine and Karras 2010): two boxes'
//! worth of planes answer for all eight. The planes come from integer cells, so that nothing accumulates along the ray
//! (robustness.md, A5), and every child's interval is that of its own box, bit for bit: a parent's contains its
//! children's, and no neighbour is lost on the border between two.
use luxel_flat::{MAX_SVO_DEPTH, SvoNode};
use luxel_geom::{Interval, Real, SlabRay, Vector, voxel};

use crate::cloud::octant;

/// A node that the ray has entered.
#[derive(Clone, Copy, Debug)]
pub struct Entered<'a> {
    /// The node.
    pub node: &'a SvoNode,
    /// Its place among the volume's nodes.
    pub index: u32,
    /// Its cell among those of its level.
    pub cell: [u32; 3],
    /// Levels below the root.
    pub depth: u32,
}

/// What is to be done at a node.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Step<R: Real> {
    /// Go on to its children; a leaf has none.
    Down,
    /// Leave its children out; what lies beyond this parameter does not matter any more.
    Past(R),
    /// The walk is over.
    End,
}

/// Walks the nodes that a ray in the volume's space enters, until `visit` ends it. Returns how many were entered.
pub fn walk<R: Real>(
    nodes: &[SvoNode],
    levels: u32,
    ray: &SlabRay<R>,
    mut visit: impl FnMut(&Entered<'_>) -> Step<R>,
) -> u64 {
    let mut ray = *ray;
    let octant = octant(&ray);
    // On every level the node entered last, and which of its children are still to come, by their rank along the ray.
    let mut path = [(0u32, 0u8); MAX_SVO_DEPTH as usize + 1];
    let (mut depth, mut index, mut cell) = (0u32, 0u32, [0u32; 3]);
    let (mut entered, mut is_shorter) = (0, false);
    if nodes.is_empty() || !enters(cell, 1 << levels, &ray) {
        return 0;
    }
    loop {
        entered += 1;
        let node = &nodes[index as usize];
        let edge = (1 << (levels - depth)) / 2;
        let to_come = match visit(&Entered { node, index, cell, depth }) {
            Step::Down => ranked(children_entered(node, cell, edge, &ray), octant),
            Step::Past(t) => {
                is_shorter |= t < ray.t_max;
                ray.t_max = t;
                0
            }
            Step::End => return entered,
        };
        path[depth as usize] = (index, to_come);
        let next = loop {
            let (parent, to_come) = &mut path[depth as usize];
            if *to_come == 0 {
                if depth == 0 {
                    return entered;
                }
                depth -= 1;
                cell = cell.map(|c| c >> 1);
                continue;
            }
            let child = to_come.trailing_zeros() ^ octant;
            *to_come &= *to_come - 1;
            let child_at = child_cell(cell, child);
            if !is_shorter || enters(child_at, (1 << (levels - depth)) / 2, &ray) {
                cell = child_at;
                break child_node(&nodes[*parent as usize], child);
            }
        };
        depth += 1;
        index = next;
    }
}

/// The node of an existing child, relative to the volume.
#[inline]
pub fn child_node(node: &SvoNode, child: u32) -> u32 {
    node.first_child + (node.child_mask() & ((1 << child) - 1)).count_ones()
}

/// The cell of a child, one level down.
#[inline]
pub fn child_cell(cell: [u32; 3], child: u32) -> [u32; 3] {
    [cell[0] << 1 | child & 1, cell[1] << 1 | child >> 1 & 1, cell[2] << 1 | child >> 2]
}

fn enters<R: Real>(cell: [u32; 3], edge: u32, ray: &SlabRay<R>) -> bool {
    voxel::bounds::<R>(cell, edge).interval(ray).overlaps(ray.t_min, ray.t_max)
}

/// The existing children that the ray enters; `edge` is theirs.
#[inline]
fn children_entered<R: Real>(node: &SvoNode, cell: [u32; 3], edge: u32, ray: &SlabRay<R>) -> u8 {
    let mask = node.child_mask();
    if mask == 0 {
        return 0;
    }
    let low = cell.map(|c| c << 1);
    // Of the two halves along each axis: where the ray enters and where it leaves.
    let halves = [low, low.map(|c| c + 1)].map(|corner| {
        let cube = voxel::bounds::<R>(corner, edge);
        let t0 = (cube.lo - ray.origin) * ray.inv_direction;
        let t1 = (cube.hi - ray.origin) * ray.inv_direction;
        (t0.min(t1), t0.max(t1))
    });
    let mut entered = 0;
    for child in 0..8u32 {
        let [x, y, z] = [0, 1, 2].map(|axis| &halves[(child >> axis & 1) as usize]);
        let near = R::Vec3::new(x.0.x(), y.0.y(), z.0.z());
        let far = R::Vec3::new(x.1.x(), y.1.y(), z.1.z());
        entered |= u8::from(Interval::between(near, far).overlaps(ray.t_min, ray.t_max)) << child;
    }
    entered & mask as u8
}

/// A set of children by their rank along rays of an octant: bit `child ^ octant` for each.
#[inline]
fn ranked(children: u8, octant: u32) -> u8 {
    let swap = |set: u8, bit: u32, low: u8| {
        let by = 1 << bit;
        if octant >> bit & 1 == 1 { (set & low) << by | set >> by & low } else { set }
    };
    swap(swap(swap(children, 0, 0x55), 1, 0x33), 2, 0x0f)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn children_are_ranked_by_the_octant() {
        for octant in 0..8 {
            for children in 0..=255u8 {
                let bits = (0..8).filter(|child| children >> child & 1 == 1);
                let expected = bits.fold(0, |ranks, child| ranks | 1 << (child ^ octant));
                assert_eq!(ranked(children, octant), expected, "{children:08b}, {octant}");
            }
        }
    }
}
