//! Edits of voxel octrees beside rebuilds from the edited cells (robustness.md V10).
#![allow(clippy::unwrap_used)]
use std::collections::BTreeMap;

use glam::{UVec3, Vec3};
use luxel_accel::{AccelError, Svo, SvoBrush, SvoEditor, SvoPaint, SvoVoxel, build_svo};
use luxel_testkit::Random;

/// The cells that are there, and the octree that was edited along.
struct Pair {
    cells: BTreeMap<[u16; 3], SvoVoxel>,
    editor: SvoEditor,
    edge: u32,
}

impl Pair {
    fn open(voxels: &[SvoVoxel], edge: u32) -> Self {
        let editor = SvoEditor::open(build_svo(voxels, UVec3::splat(edge)).unwrap()).unwrap();
        Self { cells: voxels.iter().map(|v| (v.cell, *v)).collect(), editor, edge }
    }

    fn set(&mut self, voxels: &[SvoVoxel]) {
        self.editor.set(voxels).unwrap();
        self.cells.extend(voxels.iter().map(|v| (v.cell, *v)));
    }

    fn clear(&mut self, cells: &[[u16; 3]]) {
        self.editor.clear(cells).unwrap();
        cells.iter().for_each(|cell| _ = self.cells.remove(cell));
    }

    fn brush(&mut self, brush: &SvoBrush, paint: Option<SvoPaint>) {
        self.editor.brush(brush, paint).unwrap();
        for cell in brush_cells(brush, self.edge) {
            match paint {
                Some(SvoPaint { color, material }) => {
                    self.cells.insert(cell, SvoVoxel { cell, color, material });
                }
                None => _ = self.cells.remove(&cell),
            }
        }
    }

    fn rebuilt(&self) -> Svo {
        build_svo(&self.cells.values().copied().collect::<Vec<_>>(), UVec3::splat(self.edge)).unwrap()
    }

    /// The same at every node, walked from the root; and, put into order, the same bits.
    fn check(&self) {
        self.editor.validate().unwrap();
        let rebuilt = self.rebuilt();
        assert_same_from(&rebuilt, self.editor.svo());
        assert_eq!(self.editor.svo().bounds, rebuilt.bounds);
        assert_eq!(self.editor.clone().into_compact(), rebuilt);
        assert_eq!(self.editor.svo().nodes.len() - self.editor.free_count(), rebuilt.nodes.len());
    }
}

fn assert_same_from(a: &Svo, b: &Svo) {
    assert_eq!((a.levels, a.nodes.is_empty()), (b.levels, b.nodes.is_empty()));
    let mut open = if a.nodes.is_empty() { vec![] } else { vec![(0, 0)] };
    while let Some((i, j)) = open.pop() {
        let (x, y) = (a.nodes[i], b.nodes[j]);
        assert_eq!((x.bits, a.colors[i]), (y.bits, b.colors[j]));
        let children = 0..x.child_mask().count_ones();
        open.extend(children.map(|k| ((x.first_child + k) as usize, (y.first_child + k) as usize)));
    }
}

/// The cells of a brush, every cell of the volume asked.
fn brush_cells(brush: &SvoBrush, edge: u32) -> Vec<[u16; 3]> {
    let is_in = |cell: UVec3| match *brush {
        SvoBrush::Box { lo, hi } => cell.cmpge(lo).all() && cell.cmplt(hi).all(),
        SvoBrush::Ball { center, radius } => {
            (cell.as_vec3() + 0.5).distance_squared(center) <= radius * radius
        }
    };
    // Only the neighbourhood of a small ball, so that 10,000 of them do not take minutes.
    let (lo, hi) = match *brush {
        SvoBrush::Box { .. } => (UVec3::ZERO, UVec3::splat(edge)),
        SvoBrush::Ball { center, radius } => {
            ((center - radius - 2.0).as_uvec3(), (center + radius + 3.0).as_uvec3().min(UVec3::splat(edge)))
        }
    };
    let rows = (lo.z..hi.z).flat_map(|z| (lo.y..hi.y).map(move |y| (y, z)));
    let cells = rows.flat_map(|(y, z)| (lo.x..hi.x).map(move |x| UVec3::new(x, y, z)));
    cells.filter(|c| is_in(*c)).map(|c| c.to_array().map(|x| x as u16)).collect()
}

struct Source(Random);

impl Source {
    fn cell(&mut self, edge: u32) -> [u16; 3] {
        std::array::from_fn(|_| self.0.below(edge) as u16)
    }

    fn voxel(&mut self, edge: u32) -> SvoVoxel {
        let SvoPaint { color, material } = self.paint();
        SvoVoxel { cell: self.cell(edge), color, material }
    }

    fn paint(&mut self) -> SvoPaint {
        SvoPaint {
            color: std::array::from_fn(|_| self.0.below(256) as u8),
            material: self.0.below(256) as u8,
        }
    }

    /// A ball that may reach over the border, at places that are met again.
    fn ball(&mut self, edge: u32) -> SvoBrush {
        let center = Vec3::from(self.cell(edge / 4).map(|c| 4.0 * f32::from(c)));
        SvoBrush::Ball { center, radius: 0.5 * self.0.below(9) as f32 }
    }

    /// A solid cell now and then, else any.
    fn target(&mut self, pair: &Pair) -> [u16; 3] {
        let cell = self.cell(pair.edge);
        let at_or_behind = pair.cells.range(cell..).next().map(|(cell, _)| *cell);
        if self.0.below(4) > 0 { at_or_behind.unwrap_or(cell) } else { cell }
    }

    fn edit(&mut self, pair: &mut Pair) {
        match self.0.below(5) {
            0 => {
                let ball = self.ball(pair.edge);
                let paint = Some(self.paint());
                pair.brush(&ball, paint);
            }
            1 => {
                let ball = self.ball(pair.edge);
                pair.brush(&ball, None);
            }
            2 => {
                let voxels = [self.voxel(pair.edge), self.voxel(pair.edge)];
                pair.set(&voxels);
            }
            3 => {
                let voxel = SvoVoxel { cell: self.target(pair), ..self.voxel(pair.edge) };
                pair.set(&[voxel]);
            }
            _ => {
                let cells = [self.target(pair), self.target(pair), self.cell(pair.edge)];
                pair.clear(&cells);
            }
        }
    }
}

#[test]
fn v10_ten_thousand_edits_equal_a_rebuild() {
    let mut source = Source(Random::new(10));
    let start: Vec<_> = (0..20_000).map(|_| source.voxel(256)).collect();
    let mut pair = Pair::open(&start, 256);
    for i in 0..10_000 {
        source.edit(&mut pair);
        if i % 1000 == 999 {
            pair.check();
        }
    }
    assert!(pair.cells.len() > 10_000);
}

#[test]
fn every_depth_is_edited_from_nothing_to_nothing() {
    for levels in 0..=11 {
        let edge = 1 << levels;
        let mut source = Source(Random::new(levels));
        let mut pair = Pair::open(&[], edge);
        for _ in 0..30 {
            let voxel = source.voxel(edge);
            pair.set(&[voxel]);
            pair.check();
        }
        while !pair.cells.is_empty() {
            let cell = *pair.cells.keys().nth(pair.cells.len() / 2).unwrap();
            pair.clear(&[cell, cell]);
            pair.check();
        }
        assert!(pair.editor.svo().nodes.is_empty() && pair.editor.svo().bounds.is_empty());
        let voxel = source.voxel(edge);
        pair.set(&[voxel]);
        pair.check();
    }
}

#[test]
fn brushes_fill_and_clear_whole_volumes() {
    let mut source = Source(Random::new(3));
    let mut pair = Pair::open(&[], 32);
    let all = SvoBrush::Box { lo: UVec3::ZERO, hi: UVec3::splat(u32::MAX) };
    for _ in 0..3 {
        let paint = source.paint();
        pair.brush(&all, Some(paint));
        pair.check();
        pair.brush(&SvoBrush::Ball { center: Vec3::splat(16.0), radius: 15.0 }, None);
        pair.check();
        pair.brush(&SvoBrush::Box { lo: UVec3::new(0, 3, 9), hi: UVec3::new(32, 5, 11) }, None);
        pair.check();
        pair.brush(&all, None);
        assert!(pair.editor.svo().nodes.is_empty());
    }
    for radius in [-1.0, f32::NAN, f32::NEG_INFINITY] {
        pair.brush(&SvoBrush::Ball { center: Vec3::splat(16.5), radius }, Some(SvoPaint::default()));
    }
    pair.brush(&SvoBrush::Box { lo: UVec3::splat(9), hi: UVec3::splat(3) }, Some(SvoPaint::default()));
    assert!(pair.editor.svo().nodes.is_empty());
}

#[test]
fn of_several_voxels_in_a_cell_the_last_wins() {
    let mut source = Source(Random::new(4));
    let mut pair = Pair::open(&[], 16);
    let cell = [3, 9, 14];
    let voxels: Vec<_> = (0..50).map(|_| SvoVoxel { cell, ..source.voxel(16) }).collect();
    pair.set(&voxels);
    pair.check();
}

/// Blocks that are freed are used again: however long cells come and go, the array stays as it was after a while.
#[test]
fn memory_stays_bounded() {
    let mut source = Source(Random::new(5));
    let start: Vec<_> = (0..2000).map(|_| source.voxel(64)).collect();
    let mut pair = Pair::open(&start, 64);
    let mut most = 0;
    for round in 0..3000 {
        let voxels: Vec<_> = (0..20).map(|_| source.voxel(64)).collect();
        let added: Vec<_> = voxels.iter().filter(|v| !pair.cells.contains_key(&v.cell)).copied().collect();
        pair.set(&added);
        pair.clear(&added.iter().map(|v| v.cell).collect::<Vec<_>>());
        let slots = pair.editor.svo().nodes.len();
        if round < 500 {
            most = slots;
        }
        assert!(slots <= most + most / 20, "{slots} slots after {most}");
    }
    assert_eq!(pair.cells.len(), pair.rebuilt().nodes.iter().filter(|n| n.child_mask() == 0).count());
    assert!(most < 2 * pair.rebuilt().nodes.len());
    pair.check();
}

#[test]
fn an_edited_octree_opens_again() {
    let mut source = Source(Random::new(6));
    let start: Vec<_> = (0..3000).map(|_| source.voxel(64)).collect();
    let mut pair = Pair::open(&start, 64);
    for round in 0..6 {
        (0..100).for_each(|_| source.edit(&mut pair));
        let (edited, free) = (pair.editor.svo().clone(), pair.editor.free_count());
        pair.editor = SvoEditor::open(edited).unwrap();
        assert_eq!(pair.editor.free_count(), free);
        pair.check();
        if round % 2 == 1 {
            pair.editor = SvoEditor::open(pair.editor.clone().into_compact()).unwrap();
            assert_eq!(pair.editor.free_count(), 0);
        }
    }
}

#[test]
fn edits_outside_and_broken_octrees_are_refused() {
    let mut pair = Pair::open(&[SvoVoxel::default()], 8);
    let outside = SvoVoxel { cell: [0, 8, 0], ..SvoVoxel::default() };
    let refused = AccelError::VoxelOutside { voxel: 1, cell: [0, 8, 0], size: [8; 3] };
    assert_eq!(pair.editor.set(&[SvoVoxel::default(), outside]), Err(refused.clone()));
    assert_eq!(pair.editor.clear(&[[0; 3], outside.cell]), Err(refused));
    pair.check();
    let mut broken = pair.rebuilt();
    broken.nodes[1].first_child = 0;
    assert!(matches!(SvoEditor::open(broken), Err(AccelError::Broken { .. })));
}
