//! Which stable ids are in use, so that two primitives with one identity are noticed.
use std::collections::{BTreeSet, HashMap};

/// A multiset of stable ids.
#[derive(Clone, Debug, Default)]
pub(crate) struct Identities {
    owners: HashMap<u32, u32>,
    shared: BTreeSet<u32>,
}

impl Identities {
    /// One owner changes its id, comes (no old id) or goes (no new one).
    pub(crate) fn replace(&mut self, old: Option<u32>, new: Option<u32>) {
        if old == new {
            return;
        }
        if let Some(id) = old {
            self.count(id, |owners| owners - 1);
        }
        if let Some(id) = new {
            self.count(id, |owners| owners + 1);
        }
    }

    /// The smallest id with several owners.
    pub(crate) fn shared(&self) -> Option<u32> {
        self.shared.first().copied()
    }

    fn count(&mut self, id: u32, change: impl Fn(u32) -> u32) {
        let owners = change(self.owners.get(&id).copied().unwrap_or(0));
        match owners {
            0 => _ = self.owners.remove(&id),
            _ => _ = self.owners.insert(id, owners),
        }
        match owners {
            0 | 1 => _ = self.shared.remove(&id),
            _ => _ = self.shared.insert(id),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_id_is_shared_while_it_has_two_owners() {
        let mut ids = Identities::default();
        ids.replace(None, Some(7));
        ids.replace(None, Some(9));
        assert_eq!(ids.shared(), None);
        ids.replace(Some(9), Some(7));
        assert_eq!(ids.shared(), Some(7));
        ids.replace(Some(7), None);
        assert_eq!(ids.shared(), None);
    }
}
