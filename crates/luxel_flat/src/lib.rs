//! Everything that Rust and WGSL must agree on, and the frozen scene that both tracers read.
//!
//! One truth per fact: a record is declared once, by [`shared_struct!`](layout), and the WESL module
//! `shaders/generated/shared.wesl` is written from it ([`wesl::shared_module`]). The same goes for constants,
//! [`Counter`]s and [`FEATURES`].
//!
//! ```
//! use luxel_flat::{BvhNode, layout::SharedStruct};
//!
//! assert_eq!(BvhNode::SIZE, 32);
//! assert!(luxel_flat::wesl::shared_module().contains("struct BvhNode"));
//! ```
pub mod constants;
pub mod counters;
pub mod features;
pub mod film;
pub mod heap;
pub mod layout;
pub mod mesh_accel;
pub mod params;
pub mod path;
pub mod primitives;
pub mod scene;
pub mod sphere_accel;
pub mod wesl;

pub use constants::*;
pub use counters::{Counter, Counters};
pub use features::{FEATURES, Feature, FeatureRow, FeatureSet};
pub use film::{Cascade, FilmPixel};
pub use heap::Heap;
pub use mesh_accel::{MESH_ACCELS, MeshAccel};
pub use params::{CameraRecord, DisplayParams, SceneParams, SliceParams};
pub use path::{Aov, Path, SurfacePoint};
pub use primitives::{
    BvhNode, Instance, LeafSphere, LightNode, LightRecord, MaterialRecord, OctreeNode, SphereRecord, SvoNode,
    TextureSlot, Triangle, TriangleAttributes,
};
pub use scene::{FlatScene, Span};
pub use sphere_accel::{SPHERE_ACCELS, SphereAccel};
