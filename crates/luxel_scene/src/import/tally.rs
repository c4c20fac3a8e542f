//! What a file has and the scene does not show, counted.

use std::collections::BTreeMap;

use super::one_line;

/// How often each thing was met.
#[derive(Debug, Default)]
pub(super) struct Tally(BTreeMap<String, usize>);

impl Tally {
    /// One more `what`.
    pub(super) fn add(&mut self, what: &str) {
        self.add_many(what, 1);
    }

    /// `count` more.
    pub(super) fn add_many(&mut self, what: &str, count: usize) {
        match self.0.get_mut(what) {
            Some(known) => *known += count,
            None if count > 0 => drop(self.0.insert(what.to_owned(), count)),
            None => {}
        }
    }

    /// One line each.
    pub(super) fn lines(&self) -> Vec<String> {
        self.0.iter().map(|(what, count)| format!("{} ({count})", one_line(what))).collect()
    }
}
