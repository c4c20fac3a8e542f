//! Builders and validators of every acceleration structure: slices in, node arrays out.
//!
//! | structure | builder | records |
//! |---|---|---|
//! | mesh BVH | [`build_mesh`] over [`build_bvh`] | [`BvhNode`](luxel_flat::BvhNode), [`Triangle`](luxel_flat::Triangle) |
//! | TLAS | [`build_tlas`] | [`BvhNode`](luxel_flat::BvhNode) |
//! | loose octree of spheres | [`SphereOctree`], edited in place | [`OctreeNode`](luxel_flat::OctreeNode) |
//! | octree of cells over spheres | [`CellOctree`] | [`OctreeNode`](luxel_flat::OctreeNode), [`LeafSphere`](luxel_flat::LeafSphere) |
//! | BVH over spheres | [`SphereBvh`], edited in place | [`BvhNode`](luxel_flat::BvhNode), [`LeafSphere`](luxel_flat::LeafSphere) |
//! | any of these three, or none | [`SphereStructure`] | as above |
//! | light tree | [`build_light_tree`] | [`LightNode`](luxel_flat::LightNode) |
//! | voxel octree | [`build_svo`], edited in place by [`SvoEditor`] | [`SvoNode`](luxel_flat::SvoNode) |
//!
//! Exactness rule: a stored box is the exact union (component-wise minimum and maximum) of the outset boxes
//! that `luxel_geom` gives its primitives. Parents therefore contain their children exactly, and the interval of
//! a parent contains the intervals of its children (see [`luxel_geom::aabb`]): an accelerated ray meets what a
//! ray tested against every primitive meets, bit for bit, whatever the shape of the tree.
//!
//! Every builder is deterministic: its result depends on its input alone, not on the number of threads.
//!
//! ```
//! use glam::Vec3;
//! use luxel_accel::{BvhOptions, build_mesh};
//!
//! let positions = [Vec3::ZERO, Vec3::X, Vec3::Y];
//! let mesh = build_mesh(&positions, &[[0, 1, 2]], &[7], &BvhOptions::default())?;
//! assert_eq!(mesh.nodes.len(), 1);
//! assert_eq!(mesh.triangles[0].id, 7);
//! mesh.validate()?;
//! # Ok::<(), luxel_accel::AccelError>(())
//! ```
mod bvh;
mod cells;
mod error;
mod light_tree;
pub mod lod_error;
mod mesh;
mod octree;
mod slots;
mod sphere_bvh;
mod sphere_list;
mod sphere_structure;
mod svo;
mod tlas;
mod work;

pub use bvh::{
    Bvh, BvhOptions, BvhQuality, BvhSplit, MAX_BINS, MAX_BVH_DEPTH, Reinsertion, build_bvh, depth, sah_cost,
};
pub use cells::{CELL_BUDGET_BYTES, CellOctree};
pub use error::AccelError;
pub use light_tree::{
    LightBounds, LightTree, MAX_LIGHT_DEPTH, MAX_TREE_LIGHTS, build_light_tree, validate_light_tree,
};
pub use mesh::{MAX_REFITS, MeshBvh, REBUILD_RATIO, Refit, build_mesh, mesh_triangles, validate_mesh};
pub use octree::{OctreeOptions, RootCell, SphereOctree, octree_depth, validate_octree};
pub use sphere_bvh::SphereBvh;
pub use sphere_structure::{SphereOptions, SphereStructure};
pub use svo::{Svo, SvoBrush, SvoEditor, SvoPaint, SvoVoxel, build_svo, solid_share};
pub use tlas::{build_tlas, validate_tlas};
pub use work::StructureWork;
