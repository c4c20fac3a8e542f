//! Ranges of a growing array, handed out first fit.
//!
//! Invariants: free spans are not empty, do not overlap, do not touch each other, and end before
//! [`SpanAllocator::end`]. So every record below `end` is in exactly one live or one free span.
use std::collections::BTreeMap;

use luxel_flat::Span;

/// Hands out ranges of records and takes them back; knows nothing of the records.
#[derive(Clone, Debug, Default)]
pub struct SpanAllocator {
    /// Free spans: first record to number of records.
    free: BTreeMap<u32, u32>,
    end: u32,
}

impl SpanAllocator {
    /// One past the last live record: the length that the array needs.
    pub fn end(&self) -> u32 {
        self.end
    }

    /// The first free range of `count` records; `None` if it would end beyond `u32::MAX`.
    pub fn allocate(&mut self, count: u32) -> Option<Span> {
        if count == 0 {
            return Some(Span::default());
        }
        let fitting = self.free.iter().find(|(_, free)| **free >= count);
        let Some((&first, &free)) = fitting else {
            let first = self.end;
            self.end = self.end.checked_add(count)?;
            return Some(Span { first, count });
        };
        self.free.remove(&first);
        if free > count {
            self.free.insert(first + count, free - count);
        }
        Some(Span { first, count })
    }

    /// Takes back a range that [`Self::allocate`] gave.
    pub fn release(&mut self, span: Span) {
        if span.count == 0 {
            return;
        }
        let (mut first, mut end) = (span.first, span.first + span.count);
        if let Some((&before, &count)) = self.free.range(..first).next_back()
            && before + count == first
        {
            self.free.remove(&before);
            first = before;
        }
        if let Some(count) = self.free.remove(&end) {
            end += count;
        }
        if end == self.end {
            self.end = first;
        } else {
            self.free.insert(first, end - first);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// Number of records below the end that are in no live range.
    fn free_records(spans: &SpanAllocator) -> u32 {
        spans.free.values().sum()
    }

    #[test]
    fn a_hole_is_used_before_the_end() {
        let mut spans = SpanAllocator::default();
        let first = spans.allocate(4).unwrap();
        spans.allocate(1).unwrap();
        spans.release(first);
        assert_eq!(spans.allocate(5), Some(Span { first: 5, count: 5 }));
        assert_eq!(spans.allocate(3), Some(Span { first: 0, count: 3 }));
        assert_eq!(spans.allocate(1), Some(Span { first: 3, count: 1 }));
    }

    #[test]
    fn neighbours_join_and_the_tail_goes_back() {
        let mut spans = SpanAllocator::default();
        let all: Vec<Span> = (0..3).map(|_| spans.allocate(2).unwrap()).collect();
        spans.release(all[0]);
        spans.release(all[1]);
        assert_eq!(free_records(&spans), 4);
        spans.release(all[2]);
        assert_eq!((spans.end(), free_records(&spans)), (0, 0));
    }

    #[test]
    fn the_end_of_the_index_space_is_an_answer() {
        let mut spans = SpanAllocator::default();
        assert!(spans.allocate(u32::MAX).is_some());
        assert_eq!(spans.allocate(1), None);
        assert_eq!(spans.allocate(0), Some(Span::default()));
    }

    proptest! {
        /// Against the obvious model: one flag per record.
        #[test]
        fn live_spans_never_overlap(
            steps in prop::collection::vec((any::<bool>(), 0u32..20, any::<usize>()), 1..200),
        ) {
            let mut spans = SpanAllocator::default();
            let mut live: Vec<Span> = Vec::new();
            for (take, count, pick) in steps {
                if take || live.is_empty() {
                    live.push(spans.allocate(count).unwrap());
                } else {
                    spans.release(live.swap_remove(pick % live.len()));
                }
                let mut taken = vec![false; spans.end() as usize];
                for record in live.iter().flat_map(|span| span.range()) {
                    let is_taken = std::mem::replace(&mut taken[record], true);
                    prop_assert!(!is_taken, "record {} handed out twice", record);
                }
                let idle = taken.iter().filter(|taken| !**taken).count();
                prop_assert_eq!(idle, free_records(&spans) as usize);
                prop_assert!(taken.last().copied().unwrap_or(true), "the end is not tight");
                prop_assert!(!spans.free.iter().any(|(first, n)| spans.free.contains_key(&(first + n))));
            }
        }
    }
}
