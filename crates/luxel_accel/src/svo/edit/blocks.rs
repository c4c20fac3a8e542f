//! Blocks of children that move: who owns which slots.
use crate::AccelError;
use crate::svo::{FREE, Svo};
use luxel_flat::SvoNode;

/// Children of a node, at most.
const MOST: usize = 8;

/// Free blocks by their size. A block is taken for its own size alone, so that the slots of all blocks are at most those
/// of the most blocks of each size that ever were in use at once.
#[derive(Clone, Debug, Default)]
pub(super) struct FreeBlocks {
    /// First slots of blocks of 1, 2, … 8.
    firsts: [Vec<u32>; MOST],
}

impl FreeBlocks {
    /// The free slots of an octree, side by side ones together.
    pub(super) fn of(svo: &Svo) -> Self {
        let mut free = Self::default();
        let mut start = 0;
        for run in svo.nodes.chunk_by(|a, b| (*a == FREE) == (*b == FREE)) {
            if run.first() == Some(&FREE) {
                let blocks = (0..run.len()).step_by(MOST);
                blocks.for_each(|at| free.give((start + at) as u32, MOST.min(run.len() - at)));
            }
            start += run.len();
        }
        free
    }

    pub(super) fn slot_count(&self) -> usize {
        (1..).zip(&self.firsts).map(|(size, firsts)| size * firsts.len()).sum()
    }

    /// Gives a node the children of a mask: those that it has keep what they are, new ones are [`FREE`]. A node without
    /// children is itself [`FREE`].
    pub(super) fn resize(&mut self, svo: &mut Svo, index: usize, mask: u32) {
        let old = svo.nodes[index];
        if old.child_mask() == mask {
            return;
        }
        let first = self.take(svo, mask.count_ones() as usize);
        let (mut from, mut to) = (old.first_child as usize, first as usize);
        for octant in 0..MOST {
            let [was, is] = [old.child_mask(), mask].map(|mask| (mask >> octant & 1) as usize);
            if was & is == 1 {
                svo.nodes[to] = svo.nodes[from];
                svo.colors[to] = svo.colors[from];
            }
            from += was;
            to += is;
        }
        self.release(svo, old);
        svo.nodes[index] = if mask == 0 { FREE } else { SvoNode::inner(first, mask) };
    }

    /// A block of free slots.
    fn take(&mut self, svo: &mut Svo, size: usize) -> u32 {
        let Some(firsts) = size.checked_sub(1).and_then(|i| self.firsts.get_mut(i)) else {
            return 0;
        };
        firsts.pop().unwrap_or_else(|| {
            let first = svo.nodes.len();
            svo.nodes.resize(first + size, FREE);
            svo.colors.resize(first + size, 0);
            first as u32
        })
    }

    /// Frees the children of a node.
    fn release(&mut self, svo: &mut Svo, node: SvoNode) {
        let (first, size) = (node.first_child as usize, node.child_mask().count_ones() as usize);
        if size > 0 {
            svo.nodes[first..first + size].fill(FREE);
            svo.colors[first..first + size].fill(0);
            self.give(node.first_child, size);
        }
    }

    pub(super) fn give(&mut self, first: u32, size: usize) {
        if let Some(firsts) = size.checked_sub(1).and_then(|i| self.firsts.get_mut(i)) {
            firsts.push(first);
        }
    }

    /// Checks that each free slot is in one block, and each slot of a block free.
    pub(super) fn validate(&self, svo: &Svo) -> Result<(), AccelError> {
        let mut is_listed = vec![false; svo.nodes.len()];
        for (size, firsts) in (1..).zip(&self.firsts) {
            for slot in firsts.iter().flat_map(|first| *first as usize..*first as usize + size) {
                let is_new = is_listed.get_mut(slot).is_some_and(|listed| !std::mem::replace(listed, true));
                AccelError::require(is_new, "svo editor", slot, "a slot is in two free blocks, or in none")?;
            }
        }
        let differs = |(node, listed): (&SvoNode, &bool)| (*node == FREE) != *listed;
        let wrong = svo.nodes.iter().zip(&is_listed).position(differs);
        let rule = "a free slot is not listed, or a listed one in use";
        AccelError::require(wrong.is_none(), "svo editor", wrong.unwrap_or(0), rule)
    }
}
