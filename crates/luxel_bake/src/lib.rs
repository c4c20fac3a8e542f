//! From changes in the world to an up-to-date [`FlatScene`](luxel_flat::FlatScene).
//!
//! ```text
//! World ──changes──▶ Propagate ▶ Shading ▶ Geometry ▶ Instances ▶ Features ▶ Publish ──▶ Arc<FlatScene>
//! ```
//!
//! A [`Baker`] is a schedule of systems (the sets are [`BakeSet`]s). One system asks bevy_ecs's change
//! detection which objects were touched; the others make what they keep of a touched object equal to what
//! it says now. Work that depends on several objects has a key: the TLAS the boxes that it was built over,
//! the sphere cloud its options and root cell, the records their origin, an asset's structure the asset.
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
mod assets;
mod baker;
mod camera;
mod cloud;
mod counters;
mod error;
mod features;
mod identities;
mod instances;
mod journal;
mod lattice;
mod materials;
mod meshes;
mod objects;
mod placement;
mod propagate;
mod publish;
mod report;
mod spans;
mod spheres;
mod store;
mod tlas;
mod tuning;
mod validate;
mod volumes;

pub use baker::{BakeSet, Baker, install};
pub use counters::BakeCounters;
pub use error::BakeError;
pub use journal::{BakeWarning, Disabled};
pub use objects::Shown;
pub use report::{BakeReport, MeshFacts, SphereFacts, VolumeFacts};
pub use spans::SpanAllocator;
pub use tuning::SphereTuning;
