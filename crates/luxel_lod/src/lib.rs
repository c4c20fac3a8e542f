//! Pictures of one voxel octree by few rays: error-aware adaptive ray tracing (seed document 3) and what it is compared
//! with.
//!
//! A picture shows the stored colour of the first node that a ray meets, without any light transport: as many rays as a
//! pixel gets, and on which level of the octree they end, is all that the renderers differ in.
//!
//! | renderer | rays of a pixel |
//! |---|---|
//! | [`plain`] | one, at the level whose nodes are as large as a pixel |
//! | [`adaptive`] | one; where the picture varies, 2×2 or 4×4 more, at the leaves (document 3, §5.1.2) |
//! | [`error_aware`] | one; where showing a node hides too much, 2×2 one level down, each again 2×2 (§5.1.3) |
//! | [`reference()`] | 4×4 at the leaves (§5.1.1) |
//!
//! Invariants: a renderer is a pure function of octree, view and settings, whatever the number of threads; an
//! error-aware picture of threshold infinity is the plain one, and of a negative threshold the reference, bit for bit.
mod adaptive;
mod colors;
mod contrast;
mod error_aware;
mod error_table;
mod eye;
mod fixed;
mod node_error;
mod octree;
mod picture;
mod sun;
mod surroundings;
mod view;

pub use adaptive::{Adaptive, VarianceScale, adaptive, variances};
pub use colors::luminance;
pub use contrast::Contrast;
pub use error_aware::{ErrorAware, LuminanceAware, error_aware};
pub use error_table::ErrorTable;
pub use fixed::{plain, reference};
pub use node_error::NodeError;
pub use octree::{Octree, Seen};
pub use picture::{Cost, MISSED, Picture, Pixel};
pub use sun::{Sun, lit_by};
pub use view::View;

/// Levels above the leaves of the nodes that are as large as a pixel: "the third-lowest level" (seed document 3, §5.1.1).
pub const PIXEL_LEVEL: u32 = 2;
