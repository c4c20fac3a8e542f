//! From changes in the world to an up-to-date [`FlatScene`](luxel_flat::FlatScene).
//!
//! ```text
//! World ──changes──▶ Propagate ▶ Shading ▶ Geometry ▶ Instances ▶ Features ▶ Publish ──▶ Arc<FlatScene>
//! ```
//!
//! A [`Baker`] is a schedule of systems (the sets are [`BakeSet`]s). One system asks bevy_ecs's change
//! detection which objects were touched; the others make what they keep of a touched object equal to what
//! it says now. Work that depends on several objects has a key: the TLAS the boxes that it was built over,
//! the sphere cloud its options and root cell, the records their origin, an asset's structure the asset, the tree over all
//! meshes its pieces, attributes the
//! mesh as it was built and the kind of normals, texels the images in use and the [`TextureBudget`].
//!
//! ▪ Invariants. There is no dirty flag: a changed component or a changed key is the only trigger. What is
//! published is a function of the world alone, but for slots and the shape of the spheres' structure: an edited world
//! and a fresh one look the same to every ray. A problem of one object never touches another: it is left
//! out with a warning ([`BakeWarning`]), or named in a [`BakeError`] that goes away with its cause.
//! [`BakeCounters`] say what was done.
//!
//! Deviation from the house plan: `Shading` runs before `Geometry`, because sphere and instance records name
//! material slots.
//!
//! ```
//! use bevy_ecs::prelude::*;
//! use glam::DVec3;
//! use luxel_bake::{BakeCounters, Baker};
//! use luxel_scene::{Camera, Sphere, Transform, empty_world, spawn};
//!
//! let mut world = empty_world();
//! spawn(&mut world, (Camera::default(), Transform::at(DVec3::Z * 5.0)));
//! let ball = spawn(&mut world, Sphere { radius: 1.0 });
//!
//! let mut baker = Baker::new(&mut world)?;
//! let first = baker.run(&mut world)?;
//! assert_eq!(first.spheres.len(), 1);
//!
//! let before = *world.resource::<BakeCounters>();
//! world.entity_mut(ball).insert(Transform::at(DVec3::X * 0.25));
//! let second = baker.run(&mut world)?;
//! let work = world.resource::<BakeCounters>().since(&before);
//! assert!(second.revision > first.revision);
//! assert_eq!((work.sphere_updates, work.materials_written), (1, 0));
//! # Ok::<(), luxel_bake::BakeError>(())
//! ```
mod albedo_tables;
mod assets;
mod attributes;
mod baker;
mod camera;
mod cloud;
mod counters;
mod environment;
mod error;
mod features;
mod identities;
mod images;
mod instances;
mod joined;
mod journal;
mod lattice;
mod lights;
mod material_record;
mod materials;
mod mesh_options;
mod mesh_tree;
mod meshes;
mod objects;
mod placement;
mod propagate;
mod publish;
mod report;
mod resample;
mod spans;
mod spheres;
mod store;
mod textures;
mod tlas;
mod tuning;
mod users;
mod validate;
mod volumes;

pub use baker::{BakeSet, Baker, install};
pub use counters::BakeCounters;
pub use error::BakeError;
pub use images::TextureBudget;
pub use journal::{BakeWarning, Disabled};
pub use mesh_options::build_options;
pub use objects::Shown;
pub use report::{BakeReport, ImageFacts, MeshFacts, SphereFacts, VolumeFacts};
pub use spans::SpanAllocator;
pub use tuning::SphereTuning;
