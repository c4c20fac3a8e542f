//! Everything that a builder, an edit or a validator can refuse.

/// Why a structure could not be built or edited, or what is wrong with one.
#[derive(thiserror::Error, Debug, Clone, PartialEq)]
pub enum AccelError {
    /// Nodes are numbered with 28 bits.
    #[error("{count} primitives in one tree; at most {} are possible", crate::bvh::MAX_PRIMITIVES)]
    TooManyPrimitives {
        /// Number of primitives given.
        count: usize,
    },
    /// A triangle names a vertex that does not exist.
    #[error("triangle {triangle} uses vertex {vertex}, but there are {vertex_count} vertices")]
    VertexOutOfRange {
        /// Position of the triangle in the input.
        triangle: usize,
        /// The index that it uses.
        vertex: u32,
        /// Number of vertices given.
        vertex_count: usize,
    },
    /// A vertex is NaN or infinite, or so far out that boxes overflow.
    #[error("triangle {triangle} has a vertex that is not a finite number below {:e}", luxel_flat::FAR)]
    BadTriangle {
        /// Position of the triangle in the input.
        triangle: usize,
    },
    /// Triangles and triangle ids must correspond.
    #[error("{triangles} triangles, but {ids} triangle ids")]
    IdCount {
        /// Number of triangles.
        triangles: usize,
        /// Number of ids.
        ids: usize,
    },
    /// A TLAS leaf holds its instance slot in 28 bits.
    #[error("instance slot {slot} is too large; slots must be below {}", 1u32 << luxel_flat::LEAF_COUNT_SHIFT)]
    SlotTooLarge {
        /// The slot.
        slot: u32,
    },
    /// A sphere must have a finite centre, a positive normal radius and a box within ±`FAR`.
    #[error(
        "sphere in slot {slot}: the radius must be positive, centre and radius finite and below {:e}",
        luxel_flat::FAR
    )]
    BadSphere {
        /// The sphere's slot.
        slot: u32,
    },
    /// There is a sphere in this slot already.
    #[error("slot {slot} already holds a sphere")]
    SlotTaken {
        /// The slot.
        slot: u32,
    },
    /// There is no sphere in this slot.
    #[error("slot {slot} holds no sphere")]
    SlotEmpty {
        /// The slot.
        slot: u32,
    },
    /// A volume has more cells along an axis than the deepest voxel octree.
    #[error("a volume of {size:?} cells is too large; at most {} per axis", 1u32 << luxel_flat::MAX_SVO_DEPTH)]
    VolumeTooLarge {
        /// Cells per axis.
        size: [u32; 3],
    },
    /// A voxel lies outside its volume.
    #[error("voxel {voxel} at {cell:?} lies outside a volume of {size:?} cells")]
    VoxelOutside {
        /// Position of the voxel in the input.
        voxel: usize,
        /// Its cell.
        cell: [u16; 3],
        /// Cells per axis.
        size: [u32; 3],
    },
    /// The number of voxels does not fit the sort key.
    #[error("{count} voxels in one volume are too many")]
    TooManyVoxels {
        /// Number of voxels given.
        count: usize,
    },
    /// A validator found a rule broken.
    #[error("{structure}: record {index}: {rule}")]
    Broken {
        /// The kind of structure.
        structure: &'static str,
        /// The node or primitive at fault.
        index: u32,
        /// The rule that it breaks.
        rule: &'static str,
    },
}

impl AccelError {
    /// `Ok` if the rule holds for the record, else [`AccelError::Broken`].
    pub(crate) fn require(
        holds: bool,
        structure: &'static str,
        index: usize,
        rule: &'static str,
    ) -> Result<(), AccelError> {
        if holds { Ok(()) } else { Err(AccelError::Broken { structure, index: index as u32, rule }) }
    }
}
