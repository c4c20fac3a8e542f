//! One tree over the triangles of all meshes that are seen, in world space ([`MeshLevels::One`](luxel_scene::MeshLevels)).
//!
//! The pieces stand one after the other by rising stable id, each in its mesh's own order; a triangle's number in that row
//! is its primitive id, so that ties are decided as between instances. Materials, textures and lights stay those of the
//! objects: a joined triangle names its object's material slot and which of that material's lights it is.
//!
//! The key is what the tree was made of: pieces with their places, settings, and the stamps of the heaps that the pieces
//! were read from. While only places differ, the tree is refitted as that of a deformed mesh.
mod piece;

use bevy_ecs::prelude::*;
use glam::{DAffine3, DVec3, Vec3};
use luxel_accel::{BvhOptions, build_mesh};
use luxel_flat::{
    INSTANCE_ALPHA, INSTANCE_ATTRIBUTES, INSTANCE_COLORS, INSTANCE_NORMALS, INSTANCE_TANGENTS, Instance,
    KIND_MESH, Span, Triangle, TriangleAttributes,
};
use luxel_scene::MeshStructure;
use rayon::prelude::*;

use crate::BakeError;
use crate::instances::{Instances, Source};
use crate::journal::{Journal, Topic};
use crate::lattice::{CloudFrame, Extent};
use crate::mesh_options::build_options;
use crate::mesh_tree::MeshTree;
use crate::placement::Placement;
use crate::store::Heaps;
use piece::Piece;

/// What the corners of joined triangles carry: everything that a piece's do.
const CARRIED: u32 =
    INSTANCE_ATTRIBUTES | INSTANCE_NORMALS | INSTANCE_TANGENTS | INSTANCE_COLORS | INSTANCE_ALPHA;

/// The joined tree, and what it was made of.
#[derive(Resource, Default)]
pub(crate) struct Joined {
    /// `None` if there is no tree.
    key: Option<Key>,
    placed: Option<Placed>,
    /// The run that last wrote it.
    revision: u64,
}

/// What a joined tree is made of.
#[derive(PartialEq)]
struct Key {
    pieces: Vec<Piece>,
    options: BvhOptions,
    /// Origin of its coordinates in world space.
    anchor: DVec3,
    /// Stamps of the triangles and their attributes.
    stamps: [u64; 2],
}

/// Where the joined triangles are.
struct Placed {
    tree: MeshTree,
    attributes: Span,
    /// For each joined triangle, by its number, how far its slot is from the first.
    slots: Vec<u32>,
}

impl Joined {
    /// The run that last wrote it; 0 if there never was one.
    pub(crate) fn revision(&self) -> u64 {
        self.revision
    }

    /// The tree over all meshes, if there is one.
    pub(crate) fn tree(&self) -> Option<&MeshTree> {
        self.placed.as_ref().map(|placed| &placed.tree)
    }

    /// Every mesh that is seen, with its first material slot: instances of their own, or pieces, by rising stable id.
    pub(crate) fn surfaces<'a>(&'a self, heaps: &'a Heaps) -> impl Iterator<Item = (Instance, u32)> + 'a {
        let instances = heaps.instances.heap.as_slice().iter();
        let meshes = instances.filter(|i| i.kind == KIND_MESH && i.node_count > 0);
        meshes.flat_map(|mesh| {
            let pieces = self.key.iter().flat_map(|key| &key.pieces);
            let alone = self.key.is_none().then_some(mesh.material_first);
            alone.into_iter().chain(pieces.map(|piece| piece.material)).map(|material| (*mesh, material))
        })
    }

    /// Slots of the joined triangles of a material, by rising number; `None` if it is no piece's.
    pub(crate) fn slots_of(&self, material: u32) -> Option<impl Iterator<Item = u32> + '_> {
        let (key, placed) = (self.key.as_ref()?, self.placed.as_ref()?);
        let piece = key.pieces.iter().find(|piece| piece.material == material)?;
        let first = placed.tree.triangles.first;
        Some(placed.slots.get(piece.numbers())?.iter().map(move |slot| first + slot))
    }

    fn release(&mut self, heaps: &mut Heaps, revision: u64) {
        self.key = None;
        if let Some(placed) = self.placed.take() {
            placed.tree.release(heaps, revision);
            heaps.triangle_attributes.release(placed.attributes, revision);
            self.revision = revision;
        }
    }
}

impl Key {
    /// True if only places differ.
    fn has_shape_of(&self, other: &Self) -> bool {
        let sizes =
            |key: &Self| key.pieces.iter().map(|p| (p.stable_id, p.triangles.count)).collect::<Vec<_>>();
        sizes(self) == sizes(other) && self.options == other.options
    }
}

/// Brings the joined tree up to date with the pieces, and gives it its instance.
pub(crate) fn join_meshes(
    wish: Res<MeshStructure>,
    mut joined: ResMut<Joined>,
    mut instances: ResMut<Instances>,
    mut heaps: ResMut<Heaps>,
    mut journal: Journal,
) {
    let key = key(&wish, &instances, &heaps);
    if joined.key == key {
        return;
    }
    let made = match key {
        None => {
            joined.release(&mut heaps, journal.revision());
            Ok(())
        }
        Some(key) => joined.make(key, &mut heaps, &mut journal),
    };
    let noted = instances.note_joined(joined.source(), &mut heaps.instances, journal.revision());
    journal.error(Entity::PLACEHOLDER, Topic::Joined, made.and(noted).err());
}

/// What the tree should be made of; `None` without pieces.
fn key(wish: &MeshStructure, instances: &Instances, heaps: &Heaps) -> Option<Key> {
    let extent = Extent::of(instances.pieces().map(|source| source.placement.extent()))?;
    let mut pieces: Vec<Piece> = instances.pieces().map(Piece::of).collect();
    pieces.sort_by_key(|piece| piece.stable_id);
    let mut number: u32 = 0;
    for piece in &mut pieces {
        piece.first = number;
        number = number.saturating_add(piece.triangles.count);
    }
    let anchor = CloudFrame::of(Some(&extent)).anchor;
    Some(Key { pieces, options: build_options(wish), anchor, stamps: stamps(heaps) })
}

fn stamps(heaps: &Heaps) -> [u64; 2] {
    [heaps.triangles.heap.revision(), heaps.triangle_attributes.heap.revision()]
}

impl Joined {
    /// Refits or builds the tree, and puts what its corners carry beside it.
    fn make(&mut self, key: Key, heaps: &mut Heaps, journal: &mut Journal) -> Result<(), BakeError> {
        let revision = journal.revision();
        let places: Vec<Vec3> =
            key.pieces.iter().flat_map(|piece| piece.places(heaps, key.anchor)).flatten().collect();
        let count = (places.len() / 3) as u32;
        let indices: Vec<[u32; 3]> = (0..count).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect();
        let mark = |triangle: &mut Triangle| mark(triangle, &key.pieces);

        let old = self.placed.as_ref().filter(|_| self.key.as_ref().is_some_and(|k| k.has_shape_of(&key)));
        let refitted =
            old.and_then(|old| old.tree.refitted((&places, &indices), Some, mark, heaps, revision));
        let tree = if let Some(tree) = refitted {
            journal.counters.joined_refitted += 1;
            tree
        } else {
            self.release(heaps, revision);
            let numbers: Vec<u32> = (0..count).collect();
            let mut bvh = build_mesh(&places, &indices, &numbers, &key.options)?;
            bvh.triangles.iter_mut().for_each(mark);
            journal.counters.joined_built += 1;
            MeshTree::place(&bvh, heaps, revision)?
        };
        // Until all of it stands, it is made of nothing.
        (self.key, self.revision) = (None, revision);
        let old = self.placed.replace(Placed { tree, attributes: Span::default(), slots: Vec::new() });
        heaps.triangle_attributes.release(old.map_or(Span::default(), |old| old.attributes), revision);
        self.carry(key, tree, heaps, revision)
    }

    /// Places what the corners of the joined triangles carry.
    fn carry(&mut self, key: Key, tree: MeshTree, heaps: &mut Heaps, revision: u64) -> Result<(), BakeError> {
        let flags = carried(&key.pieces);
        let triangles = &heaps.triangles.heap.as_slice()[tree.triangles.range()];
        let mut slots = vec![0; triangles.len()];
        for (slot, triangle) in (0..).zip(triangles) {
            slots[triangle.id as usize] = slot;
        }
        let records: Vec<TriangleAttributes> = if flags & INSTANCE_ATTRIBUTES == 0 {
            Vec::new()
        } else {
            let of = |t: &Triangle| owner(t.id, &key.pieces).map(|piece| piece.attributes(t, flags, heaps));
            triangles.par_iter().map(|triangle| of(triangle).unwrap_or_default()).collect()
        };
        let attributes = heaps.triangle_attributes.place(&records, revision)?;
        self.placed = Some(Placed { tree, attributes, slots });
        self.key = Some(Key { stamps: stamps(heaps), ..key });
        Ok(())
    }

    /// What its instance is made of.
    fn source(&self) -> Option<Source> {
        let (key, placed) = (self.key.as_ref()?, self.placed.as_ref()?);
        let header = Instance {
            kind: KIND_MESH,
            stable_id: key.pieces.first()?.stable_id,
            node_first: placed.tree.nodes.first,
            node_count: placed.tree.nodes.count,
            primitive_first: placed.tree.triangles.first,
            primitive_count: placed.tree.triangles.count,
            flags: carried(&key.pieces),
            attribute_offset: placed.attributes.first.wrapping_sub(placed.tree.triangles.first),
            ..Instance::default()
        };
        let placement = Placement::new(DAffine3::from_translation(key.anchor), placed.tree.bounds).ok()?;
        Some(Source::new(placement, header))
    }
}

/// `INSTANCE_…` of all pieces together.
fn carried(pieces: &[Piece]) -> u32 {
    pieces.iter().fold(0, |flags, piece| flags | piece.flags) & CARRIED
}

/// The piece that a joined triangle belongs to, by its number.
fn owner(number: u32, pieces: &[Piece]) -> Option<&Piece> {
    pieces.get(pieces.partition_point(|piece| piece.first <= number).checked_sub(1)?)
}

/// Says of a joined triangle which material it has, and which of that material's lights it is.
fn mark(triangle: &mut Triangle, pieces: &[Piece]) {
    if let Some(piece) = owner(triangle.id, pieces) {
        triangle.material = piece.material;
        triangle.light = triangle.id - piece.first;
    }
}
