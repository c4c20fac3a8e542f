//! The scene graph of a .vox file: where each model stands.
//!
//! Transforms (48 rotations and mirrorings of the cube, whole-numbered shifts), groups and shapes; a
//! group may be used in several places. The graph is walked with a stack of our own and limits on
//! depth and visits, which end every loop; hidden nodes and layers are left out, and of an animation
//! the first frame is taken.

use std::collections::HashMap;
use std::path::Path;

use dot_vox::{DotVoxData, Frame, SceneNode};

use crate::error::SceneError;

use super::vox_chunks::Skeleton;

/// Deepest nesting of the graph that is followed.
const MAX_DEPTH: u32 = 1024;

/// The most visits of nodes, a node counting once per place where it is used.
const MAX_VISITS: u32 = 1_000_000;

/// A model at its place: `world = rotation · model + shift`, in voxels, Z up.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Instance {
    pub(super) model: usize,
    pub(super) placement: Placement,
}

/// A rotation (perhaps a mirroring) of the cube, then a shift.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Placement {
    /// Rows of a signed permutation matrix.
    rows: [[i64; 3]; 3],
    shift: [i64; 3],
}

impl Placement {
    pub(super) const IDENTITY: Self = Self { rows: [[1, 0, 0], [0, 1, 0], [0, 0, 1]], shift: [0; 3] };

    /// What a frame says. A missing or damaged part changes nothing.
    fn of_frame(frame: &Frame) -> Self {
        let byte = frame.attributes.get("_r").and_then(|r| r.parse().ok());
        Self {
            rows: byte.and_then(rows_of_byte).unwrap_or(Self::IDENTITY.rows),
            shift: frame.position().map_or([0; 3], |t| [t.x.into(), t.y.into(), t.z.into()]),
        }
    }

    fn rotate(&self, v: [i64; 3]) -> [i64; 3] {
        self.rows.map(|row| row[0] * v[0] + row[1] * v[1] + row[2] * v[2])
    }

    /// First `inner`, then `self`.
    fn after(&self, inner: &Self) -> Self {
        let columns = [0, 1, 2].map(|c| self.rotate(inner.rows.map(|row| row[c])));
        let shift = self.rotate(inner.shift);
        Self {
            rows: [0, 1, 2].map(|r| columns.map(|column| column[r])),
            shift: [0, 1, 2].map(|axis| shift[axis] + self.shift[axis]),
        }
    }

    /// The cell of the world that a cell of a model of this `size` fills. A model turns about the
    /// corner of cells at ⌊size / 2⌋; in half voxels all of it is whole-numbered.
    pub(super) fn place(&self, cell: [u8; 3], size: [u32; 3]) -> [i64; 3] {
        let doubled = [0, 1, 2].map(|axis| 2 * i64::from(cell[axis]) + 1 - 2 * i64::from(size[axis] / 2));
        let turned = self.rotate(doubled);
        [0, 1, 2].map(|axis| (turned[axis] - 1) / 2 + self.shift[axis])
    }
}

/// The rows that a ROTATION byte stands for; `None` if two rows point along one axis.
fn rows_of_byte(byte: u8) -> Option<[[i64; 3]; 3]> {
    let (first, second) = (usize::from(byte & 3), usize::from(byte >> 2 & 3));
    if first == second || first == 3 || second == 3 {
        return None;
    }
    let mut rows = [[0; 3]; 3];
    for (row, axis) in [first, second, 3 - first - second].into_iter().enumerate() {
        rows[row][axis] = if byte >> (4 + row) & 1 == 1 { -1 } else { 1 };
    }
    Some(rows)
}

/// All models that are seen, at their places. Without a graph the first model stands at the origin.
///
/// # Errors
/// A graph that is damaged, or deeper or larger than the limits (a loop always is).
pub(super) fn instances(
    path: &Path,
    data: &DotVoxData,
    skeleton: &Skeleton,
) -> Result<Vec<Instance>, SceneError> {
    if data.scenes.is_empty() {
        let only = Instance { model: 0, placement: Placement::IDENTITY };
        return Ok(vec![only]);
    }
    let mut walk = Walk::new(path, data, skeleton)?;
    walk.run()?;
    Ok(walk.found)
}

/// A walk through the graph.
struct Walk<'a> {
    path: &'a Path,
    data: &'a DotVoxData,
    /// Position in the file of each node id.
    index: HashMap<u32, usize>,
    hidden_layers: Vec<u32>,
    visits: u32,
    stack: Vec<(usize, Placement, u32)>,
    found: Vec<Instance>,
}

impl<'a> Walk<'a> {
    fn new(path: &'a Path, data: &'a DotVoxData, skeleton: &Skeleton) -> Result<Self, SceneError> {
        let index: HashMap<u32, usize> = skeleton.node_ids.iter().copied().zip(0..).collect();
        if index.len() != data.scenes.len() || skeleton.layer_ids.len() != data.layers.len() {
            return Err(SceneError::unusable(
                path,
                "the scene graph has damaged nodes, damaged layers or one id twice",
            ));
        }
        let layers = skeleton.layer_ids.iter().zip(&data.layers);
        Ok(Self {
            path,
            data,
            index,
            hidden_layers: layers.filter(|(_, layer)| layer.hidden()).map(|(&id, _)| id).collect(),
            visits: 0,
            stack: Vec::new(),
            found: Vec::new(),
        })
    }

    fn run(&mut self) -> Result<(), SceneError> {
        // The first node is the root.
        self.push(0, Placement::IDENTITY, 0)?;
        let data = self.data;
        while let Some((node, placement, depth)) = self.stack.pop() {
            match &data.scenes[node] {
                SceneNode::Transform { attributes, frames, child, layer_id } => {
                    let hidden = attributes.get("_hidden").is_some_and(|flag| flag == "1");
                    if !hidden && !self.hidden_layers.contains(layer_id) {
                        let local = frames.first().map_or(Placement::IDENTITY, Placement::of_frame);
                        self.push_id(*child, placement.after(&local), depth + 1)?;
                    }
                }
                SceneNode::Group { children, .. } => {
                    for &child in children.iter().rev() {
                        self.push_id(child, placement, depth + 1)?;
                    }
                }
                SceneNode::Shape { models, .. } => {
                    if let Some(model) = models.first() {
                        self.add_model(model.model_id, placement)?;
                    }
                }
            }
        }
        Ok(())
    }

    fn add_model(&mut self, id: u32, placement: Placement) -> Result<(), SceneError> {
        let model = id as usize;
        if model >= self.data.models.len() {
            return Err(self.damaged(format!("names model {id}, which does not exist")));
        }
        self.found.push(Instance { model, placement });
        Ok(())
    }

    fn push_id(&mut self, id: u32, placement: Placement, depth: u32) -> Result<(), SceneError> {
        match self.index.get(&id) {
            Some(&node) => self.push(node, placement, depth),
            None => Err(self.damaged(format!("names node {id}, which does not exist"))),
        }
    }

    fn push(&mut self, node: usize, placement: Placement, depth: u32) -> Result<(), SceneError> {
        if depth > MAX_DEPTH {
            return Err(self.damaged(format!("contains itself or is nested deeper than {MAX_DEPTH}")));
        }
        self.visits += 1;
        if self.visits > MAX_VISITS {
            return Err(self.damaged(format!("shows more than {MAX_VISITS} nodes")));
        }
        self.stack.push((node, placement, depth));
        Ok(())
    }

    fn damaged(&self, message: String) -> SceneError {
        SceneError::unusable(self.path, format!("the scene graph {message}"))
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]

    use super::*;

    #[test]
    fn there_are_48_rotations_and_each_is_a_signed_permutation() {
        let mut all: Vec<_> = (0..128).filter_map(rows_of_byte).collect();
        all.sort_unstable();
        all.dedup();
        assert_eq!(all.len(), 48);
        for rows in all {
            for axis in 0..3 {
                assert_eq!(rows[axis].iter().map(|x| x * x).sum::<i64>(), 1);
                assert_eq!(rows.iter().map(|row| row[axis] * row[axis]).sum::<i64>(), 1);
            }
        }
    }

    #[test]
    fn rotations_read_as_dot_vox_reads_them() {
        for byte in 0..128 {
            if let Some(rows) = rows_of_byte(byte) {
                let columns = dot_vox::Rotation::from_byte(byte).to_cols_array_2d();
                for row in 0..3 {
                    for column in 0..3 {
                        assert_eq!(rows[row][column] as f32, columns[column][row]);
                    }
                }
            }
        }
    }

    #[test]
    fn every_rotation_maps_a_model_onto_distinct_neighbouring_cells() {
        let size = [3, 2, 5];
        for rows in (0..128).filter_map(rows_of_byte) {
            let placement = Placement { rows, shift: [7, -9, 2] };
            let mut cells = Vec::new();
            for x in 0..3 {
                for y in 0..2 {
                    for z in 0..5 {
                        cells.push(placement.place([x, y, z], size));
                    }
                }
            }
            cells.sort_unstable();
            cells.dedup();
            let extent = |axis: usize| {
                let values = || cells.iter().map(|cell| cell[axis]);
                values().max().unwrap() - values().min().unwrap() + 1
            };
            assert_eq!(cells.len(), 30);
            assert_eq!(extent(0) * extent(1) * extent(2), 30);
        }
    }

    #[test]
    fn composition_is_application_in_turn() {
        let some: Vec<_> = (0..128)
            .filter_map(rows_of_byte)
            .zip(0..)
            .map(|(rows, i)| Placement { rows, shift: [i, 2 * i - 9, 5 - i] })
            .collect();
        for a in &some {
            for b in &some {
                // A model of size 0 turns about its cell (0, 0, 0)'s corner, as the world does.
                let at_once = a.after(b).rotate([1, 2, 3]);
                assert_eq!(at_once, a.rotate(b.rotate([1, 2, 3])));
                let moved = a.rotate(b.shift);
                assert_eq!(a.after(b).shift, [0, 1, 2].map(|i| moved[i] + a.shift[i]));
            }
        }
    }
}
