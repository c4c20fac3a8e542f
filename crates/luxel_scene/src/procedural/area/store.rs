//! Sorted voxels as bytes: child masks of the octree's inner nodes, depth first, then a palette entry per voxel.

use super::keys::Key;

/// Masks and palette entries of sorted keys below `1 << (3 * levels + 8)`.
pub(super) fn encode(keys: &[Key], levels: u32) -> (Vec<u8>, Vec<u8>) {
    let mut masks = Vec::with_capacity(keys.len() / 2);
    if !keys.is_empty() {
        add_masks(keys, levels, &mut masks);
    }
    (masks, keys.iter().map(|key| (key & 0xff) as u8).collect())
}

fn octant(key: Key, level: u32) -> u32 {
    (key >> (8 + 3 * (level - 1))) as u32 & 7
}

fn add_masks(keys: &[Key], level: u32, masks: &mut Vec<u8>) {
    if level == 0 {
        return;
    }
    let at = masks.len();
    masks.push(0);
    let mut mask = 0;
    for child in keys.chunk_by(|a, b| octant(*a, level) == octant(*b, level)) {
        mask |= child.first().map_or(0, |key| 1 << octant(*key, level));
        add_masks(child, level - 1, masks);
    }
    masks[at] = mask;
}

/// The keys again; `None` if the bytes are no such octree, or a palette entry is not below `entries`.
pub(super) fn decode(masks: &[u8], contents: &[u8], levels: u32, entries: usize) -> Option<Vec<Key>> {
    let mut reader =
        Reader { masks: masks.iter(), contents: contents.iter(), keys: Vec::with_capacity(contents.len()) };
    if !contents.is_empty() {
        reader.node(0, levels, entries)?;
    }
    let is_all = reader.masks.len() == 0 && reader.contents.len() == 0;
    is_all.then_some(reader.keys)
}

struct Reader<'a> {
    masks: std::slice::Iter<'a, u8>,
    contents: std::slice::Iter<'a, u8>,
    keys: Vec<Key>,
}

impl Reader<'_> {
    /// Never deeper than `level`, whatever the bytes are.
    fn node(&mut self, code: u64, level: u32, entries: usize) -> Option<()> {
        if level == 0 {
            let entry = *self.contents.next()?;
            self.keys.push(code << 8 | u64::from(entry));
            return (usize::from(entry) < entries).then_some(());
        }
        let mask = *self.masks.next().filter(|mask| **mask != 0)?;
        for octant in (0..8).filter(|octant| mask >> octant & 1 == 1) {
            self.node(code << 3 | octant, level - 1, entries)?;
        }
        Some(())
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;
    use crate::procedural::area::field::random;
    use crate::procedural::area::keys::key;

    fn keys(count: u32, levels: u32) -> Vec<Key> {
        let cell = |roll: f32| (roll * (1 << levels) as f32) as u16;
        let mut keys: Vec<Key> = (0..count)
            .map(|index| random([index, 1, 2, 3]))
            .map(|[x, y, z, entry]| key([cell(x), cell(y), cell(z)], (entry * 9.0) as u8))
            .collect();
        keys.sort_unstable();
        keys.dedup_by_key(|key| *key >> 8);
        keys
    }

    #[test]
    fn what_was_encoded_comes_back() {
        for (count, levels) in [(0, 6), (1, 6), (1, 0), (500, 3), (5000, 11)] {
            let keys = keys(count, levels);
            let (masks, contents) = encode(&keys, levels);
            assert_eq!(decode(&masks, &contents, levels, 9).unwrap(), keys);
        }
    }

    #[test]
    fn damaged_bytes_are_refused_or_another_octree_but_never_a_panic() {
        let keys = keys(300, 5);
        let (masks, contents) = encode(&keys, 5);
        assert_eq!(decode(&masks[1..], &contents, 5, 9), None);
        assert_eq!(decode(&masks, &contents[1..], 5, 9), None);
        assert_eq!(decode(&masks, &contents, 5, 8), None);
        assert_eq!(decode(&[&masks[..], &[1]].concat(), &contents, 5, 9), None);
        for at in 0..masks.len() {
            let mut broken = masks.clone();
            broken[at] ^= 1 << (at % 8);
            assert_ne!(decode(&broken, &contents, 5, 9).as_ref(), Some(&keys));
        }
    }
}
