//! Who uses what, counted: how the first use of a thing and the end of its last one are noticed.
use std::collections::BTreeMap;

use bevy_ecs::entity::EntityHashMap;
use bevy_ecs::prelude::Entity;

/// The things that entities use, each with the number of its uses.
#[derive(Clone, Debug)]
pub(crate) struct Users<K> {
    used: EntityHashMap<Vec<K>>,
    counts: BTreeMap<K, u32>,
}

impl<K> Default for Users<K> {
    fn default() -> Self {
        Self { used: EntityHashMap::default(), counts: BTreeMap::new() }
    }
}

impl<K: Ord + Copy> Users<K> {
    /// Makes the things that an entity uses those.
    pub(crate) fn set(&mut self, entity: Entity, keys: Vec<K>) {
        for key in &keys {
            *self.counts.entry(*key).or_default() += 1;
        }
        let old = if keys.is_empty() { self.used.remove(&entity) } else { self.used.insert(entity, keys) };
        for key in old.into_iter().flatten() {
            if let Some(count) = self.counts.get_mut(&key) {
                *count -= 1;
                if *count == 0 {
                    self.counts.remove(&key);
                }
            }
        }
    }

    /// True if somebody uses it.
    pub(crate) fn contains(&self, key: &K) -> bool {
        self.counts.contains_key(key)
    }

    /// What an entity uses.
    pub(crate) fn of(&self, entity: Entity) -> &[K] {
        self.used.get(&entity).map_or(&[], Vec::as_slice)
    }

    /// Everything that is used, rising.
    pub(crate) fn keys(&self) -> impl Iterator<Item = K> {
        self.counts.keys().copied()
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    #[test]
    fn a_thing_is_used_while_somebody_uses_it() {
        let [a, b] = [1, 2].map(|index| Entity::from_raw_u32(index).unwrap());
        let mut users = Users::default();
        users.set(a, vec![7, 7, 8]);
        users.set(b, vec![7]);
        users.set(a, vec![9]);
        assert_eq!(users.keys().collect::<Vec<i32>>(), [7, 9]);
        assert_eq!(users.of(a), [9]);
        users.set(b, vec![]);
        users.set(a, vec![9]);
        assert!(users.contains(&9) && !users.contains(&7));
        users.set(a, vec![]);
        assert_eq!((users.keys().count(), users.of(a).len()), (0, 0));
    }
}
