//! When edits have done so much to the tree that it is built anew.
use luxel_flat::{BvhNode, Heap};

use super::SphereBvh;
use crate::bvh::MAX_PRIMITIVES;

/// Spheres that may come and go in the smallest tree.
const FEW_EDITS: usize = 64;

/// Records that may be unused in the smallest tree: a page.
const FEW_UNUSED: usize = Heap::<BvhNode>::PAGE_RECORDS;

impl SphereBvh {
    /// True if a rebuild is due: edits did much, or there is more room unused than used.
    ///
    /// Edits did much when the spheres doubled, or a third of them went, or a quarter were exchanged; a build then
    /// costs about what these edits did. So many spheres that there might be more entries, used or
    /// not, than a node can name are not edited in place at all.
    pub(super) fn is_worn(&self) -> bool {
        let count = self.len() as usize;
        let is_changed = 2 * self.edit_count > count + FEW_EDITS;
        let is_too_large = self.edit_count > 0 && count > MAX_PRIMITIVES / 2;
        is_changed
            || is_too_large
            || is_sparse(2 * self.free_pairs.len(), self.nodes.len())
            || is_sparse(self.leaf_spheres.len().saturating_sub(count), self.leaf_spheres.len())
    }
}

fn is_sparse(unused: usize, len: usize) -> bool {
    2 * unused > len + FEW_UNUSED
}
