//! What structures over spheres tell about their edits.

/// What the edits of a structure over spheres have cost since it was made: evidence that an edit rebuilt nothing.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct StructureWork {
    /// Nodes descended through, written, or read for the box of their parent.
    pub nodes_touched: u64,
    /// Spheres linked, unlinked, copied, or looked at on the way along a chain.
    pub spheres_touched: u64,
    /// Groups of nodes taken: an octree's blocks of eight children, a BVH's pairs.
    pub blocks_allocated: u64,
    /// Groups of nodes given back.
    pub blocks_freed: u64,
    /// Times that edits led to building all nodes anew.
    pub rebuilds: u64,
}
