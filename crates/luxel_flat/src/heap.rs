//! A flat array with a revision per page.
//!
//! A heap is a shared, copy-on-write `Vec`: a snapshot of it costs two reference counts, and a tracer that
//! knows up to which revision it has read uploads only the pages written since.
use std::ops::Range;
use std::sync::Arc;

/// Bytes that share one revision.
const PAGE_BYTES: usize = 16 * 1024;

/// A flat array of records; see the module's text.
#[derive(Clone, Debug)]
pub struct Heap<T> {
    records: Arc<Vec<T>>,
    page_revisions: Arc<Vec<u64>>,
}

impl<T> Default for Heap<T> {
    fn default() -> Self {
        Self { records: Arc::default(), page_revisions: Arc::default() }
    }
}

impl<T: Copy + Default> Heap<T> {
    /// Records that share one revision.
    pub const PAGE_RECORDS: usize = if PAGE_BYTES > size_of::<T>() { PAGE_BYTES / size_of::<T>() } else { 1 };

    /// A heap with the given records, all stamped with one revision.
    pub fn from_records(records: Vec<T>, revision: u64) -> Self {
        let pages = records.len().div_ceil(Self::PAGE_RECORDS);
        Self { records: Arc::new(records), page_revisions: Arc::new(vec![revision; pages]) }
    }

    /// The records.
    #[inline]
    pub fn as_slice(&self) -> &[T] {
        &self.records
    }

    /// Number of records.
    pub fn len(&self) -> usize {
        self.records.len()
    }

    /// True if there is no record.
    pub fn is_empty(&self) -> bool {
        self.records.is_empty()
    }

    /// Size in bytes.
    pub fn bytes(&self) -> usize {
        self.len() * size_of::<T>()
    }

    /// The latest revision of any page; 0 for an empty heap.
    pub fn revision(&self) -> u64 {
        self.page_revisions.iter().copied().max().unwrap_or(0)
    }

    /// Sets the length; new records are zero.
    pub fn resize(&mut self, len: usize, revision: u64) {
        let old = self.records.len();
        if len == old {
            return;
        }
        Arc::make_mut(&mut self.records).resize(len, T::default());
        let pages = len.div_ceil(Self::PAGE_RECORDS);
        Arc::make_mut(&mut self.page_revisions).resize(pages, revision);
        self.touch(old.min(len)..len, revision);
    }

    /// A record to write to; its page is stamped.
    ///
    /// # Panics
    /// If `index` is out of range.
    pub fn get_mut(&mut self, index: usize, revision: u64) -> &mut T {
        self.touch(index..index + 1, revision);
        &mut Arc::make_mut(&mut self.records)[index]
    }

    /// Writes a record, unless it holds that value already. Returns true if it was written.
    ///
    /// # Panics
    /// If `index` is out of range.
    pub fn set(&mut self, index: usize, record: T, revision: u64) -> bool
    where
        T: PartialEq,
    {
        let changed = self.records[index] != record;
        if changed {
            *self.get_mut(index, revision) = record;
        }
        changed
    }

    /// Overwrites consecutive records from `first`, growing the heap if need be.
    pub fn write(&mut self, first: usize, records: &[T], revision: u64) {
        let end = first + records.len();
        if end > self.len() {
            self.resize(end, revision);
        }
        Arc::make_mut(&mut self.records)[first..end].copy_from_slice(records);
        self.touch(first..end, revision);
    }

    /// Ranges of records written after a revision, neighbouring pages joined.
    pub fn newer_than(&self, revision: u64) -> Vec<Range<usize>> {
        let mut ranges: Vec<Range<usize>> = Vec::new();
        for (page, _) in self.page_revisions.iter().enumerate().filter(|(_, r)| **r > revision) {
            let first = page * Self::PAGE_RECORDS;
            let end = (first + Self::PAGE_RECORDS).min(self.len());
            match ranges.last_mut() {
                Some(last) if last.end == first => last.end = end,
                _ => ranges.push(first..end),
            }
        }
        ranges
    }

    fn touch(&mut self, range: Range<usize>, revision: u64) {
        if range.is_empty() {
            return;
        }
        let pages = range.start / Self::PAGE_RECORDS..=(range.end - 1) / Self::PAGE_RECORDS;
        Arc::make_mut(&mut self.page_revisions)[pages].fill(revision);
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::single_range_in_vec_init, reason = "the ranges themselves are compared")]
    use super::*;

    #[test]
    fn a_snapshot_keeps_its_content() {
        let mut heap = Heap::from_records(vec![1u32, 2, 3], 1);
        let snapshot = heap.clone();
        *heap.get_mut(1, 2) = 9;
        assert_eq!(snapshot.as_slice(), [1, 2, 3]);
        assert_eq!(heap.as_slice(), [1, 9, 3]);
    }

    #[test]
    fn only_written_pages_are_newer() {
        let page = Heap::<u32>::PAGE_RECORDS;
        let mut heap = Heap::from_records(vec![0u32; 5 * page], 1);
        assert!(heap.newer_than(1).is_empty());
        heap.write(page + 3, &[7; 4], 2);
        assert_eq!(heap.newer_than(1), [page..2 * page]);
        heap.write(2 * page, &[7], 3);
        assert_eq!(heap.newer_than(1), [page..3 * page]);
        assert_eq!(heap.newer_than(2), [2 * page..3 * page]);
    }

    #[test]
    fn growing_marks_the_new_records() {
        let mut heap = Heap::<u32>::default();
        heap.resize(10, 1);
        heap.write(8, &[1, 2, 3, 4], 2);
        assert_eq!(heap.len(), 12);
        assert_eq!(heap.newer_than(1), [0..12]);
    }

    #[test]
    fn an_equal_value_is_not_a_change() {
        let mut heap = Heap::from_records(vec![5u32], 1);
        assert!(!heap.set(0, 5, 2));
        assert!(heap.newer_than(1).is_empty());
        assert!(heap.set(0, 6, 2));
        assert_eq!(heap.newer_than(1), [0..1]);
    }
}
