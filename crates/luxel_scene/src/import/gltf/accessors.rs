//! Typed reading of buffers: nothing is allocated, and nothing read, that is not there.

use std::collections::HashMap;

use gltf::json::Index;
use gltf::json::Root;
use gltf::json::accessor::{Accessor, ComponentType, IndexComponentType, Type};
use gltf::json::validation::Checked;

use super::buffers::Buffers;

/// An accessor whose bytes are all there.
#[derive(Debug)]
pub(super) struct Elements<'a> {
    count: usize,
    kind: ComponentType,
    width: usize,
    is_normalized: bool,
    base: Option<Strided<'a>>,
    /// Elements that sparse storage puts in place of the base.
    replaced: HashMap<usize, &'a [u8]>,
}

#[derive(Debug)]
struct Strided<'a> {
    bytes: &'a [u8],
    stride: usize,
}

/// Elements of an accessor without any content, which are zeros, that a file may have at least.
const FREE_ZEROS: u64 = 1 << 16;

impl<'a> Elements<'a> {
    /// The accessor `index`, if it is of one of `types`.
    ///
    /// # Errors
    /// What is wrong with it.
    pub(super) fn new(
        root: &Root,
        buffers: &'a Buffers,
        index: Index<Accessor>,
        types: &[Type],
    ) -> Result<Self, String> {
        let number = index.value();
        let accessor = root.get(index).ok_or_else(|| format!("accessor {number} does not exist"))?;
        Self::open(root, buffers, accessor, types).map_err(|reason| format!("accessor {number} {reason}"))
    }

    fn open(root: &Root, buffers: &'a Buffers, accessor: &Accessor, types: &[Type]) -> Result<Self, String> {
        let (Checked::Valid(component), Checked::Valid(kind)) = (accessor.component_type, accessor.type_)
        else {
            return Err("is of an unknown type".to_owned());
        };
        if !types.contains(&kind) {
            return Err(format!("is of type {kind:?}, which does not fit its use"));
        }
        let count = usize::try_from(accessor.count.0).map_err(|_| "is too long".to_owned())?;
        let mut elements = Self {
            count,
            kind: component.0,
            width: kind.multiplicity(),
            is_normalized: accessor.normalized,
            base: None,
            replaced: HashMap::new(),
        };
        match accessor.buffer_view {
            Some(view) => {
                let (bytes, stride) = buffers.view(root, view)?;
                let offset = accessor.byte_offset.map_or(0, |offset| offset.0);
                elements.base = Some(elements.strided(bytes, offset, stride, count)?);
            }
            None if accessor.count.0 > buffers.bytes().max(FREE_ZEROS) => {
                return Err(format!("has {count} elements that are nowhere in the file"));
            }
            None => {}
        }
        if let Some(sparse) = &accessor.sparse {
            elements.replace(root, buffers, sparse)?;
        }
        Ok(elements)
    }

    /// `count` elements in `bytes` from `offset`, all of them inside.
    fn strided(
        &self,
        bytes: &'a [u8],
        offset: u64,
        stride: Option<usize>,
        count: usize,
    ) -> Result<Strided<'a>, String> {
        let size = self.size();
        let stride = stride.unwrap_or(size);
        if stride < size {
            return Err(format!("has elements of {size} bytes, {stride} apart"));
        }
        let leaves = || format!("has {count} elements that leave their buffer view");
        let bytes = usize::try_from(offset).ok().and_then(|offset| bytes.get(offset..)).ok_or_else(leaves)?;
        let needed = match count {
            0 => Some(0),
            count => stride.checked_mul(count - 1).and_then(|start| start.checked_add(size)),
        };
        if needed.is_none_or(|needed| needed > bytes.len()) {
            return Err(leaves());
        }
        Ok(Strided { bytes, stride })
    }

    fn replace(
        &mut self,
        root: &Root,
        buffers: &'a Buffers,
        sparse: &gltf::json::accessor::sparse::Sparse,
    ) -> Result<(), String> {
        let count = usize::try_from(sparse.count.0).unwrap_or(usize::MAX);
        if count > self.count {
            return Err("replaces more elements than it has".to_owned());
        }
        let Checked::Valid(IndexComponentType(kind)) = sparse.indices.component_type else {
            return Err("has sparse indices of an unknown type".to_owned());
        };
        let places =
            Elements { kind, width: 1, is_normalized: false, base: None, replaced: HashMap::new(), count };
        let (bytes, _) = buffers.view(root, sparse.indices.buffer_view)?;
        let strided = places.strided(bytes, sparse.indices.byte_offset.0, None, count)?;
        let places = Elements { base: Some(strided), ..places };
        let (bytes, _) = buffers.view(root, sparse.values.buffer_view)?;
        let values = self.strided(bytes, sparse.values.byte_offset.0, None, count)?;
        for (at, value) in values.bytes.chunks_exact(self.size()).take(count).enumerate() {
            let place = places.index(at) as usize;
            if place >= self.count {
                return Err("replaces an element that it does not have".to_owned());
            }
            self.replaced.insert(place, value);
        }
        Ok(())
    }

    /// Elements.
    pub(super) fn len(&self) -> usize {
        self.count
    }

    fn size(&self) -> usize {
        self.kind.size() * self.width
    }

    fn bytes(&self, index: usize) -> Option<&'a [u8]> {
        if let Some(bytes) = self.replaced.get(&index) {
            return Some(bytes);
        }
        let base = self.base.as_ref().filter(|_| index < self.count)?;
        let start = base.stride.checked_mul(index)?;
        base.bytes.get(start..start.checked_add(self.size())?)
    }

    /// Element `index` as numbers; zeros where the file has nothing, and beyond the element's own width.
    pub(super) fn numbers<const N: usize>(&self, index: usize) -> [f32; N] {
        let mut numbers = [0.0; N];
        let Some(bytes) = self.bytes(index) else { return numbers };
        for (number, bytes) in numbers.iter_mut().zip(bytes.chunks_exact(self.kind.size())).take(self.width) {
            *number = self.number(bytes);
        }
        numbers
    }

    /// The components of an element: 1 to 16.
    pub(super) fn width(&self) -> usize {
        self.width
    }

    fn number(&self, bytes: &[u8]) -> f32 {
        // A signed one has two codes for −1: that is glTF's rule.
        let shared = |value: f32, max: f32| if self.is_normalized { (value / max).max(-1.0) } else { value };
        match (self.kind, bytes) {
            (ComponentType::I8, &[a]) => shared(f32::from(a as i8), 127.0),
            (ComponentType::U8, &[a]) => shared(f32::from(a), 255.0),
            (ComponentType::I16, &[a, b]) => shared(f32::from(i16::from_le_bytes([a, b])), 32767.0),
            (ComponentType::U16, &[a, b]) => shared(f32::from(u16::from_le_bytes([a, b])), 65535.0),
            (ComponentType::U32, &[a, b, c, d]) => u32::from_le_bytes([a, b, c, d]) as f32,
            (ComponentType::F32, &[a, b, c, d]) => f32::from_le_bytes([a, b, c, d]),
            _ => 0.0,
        }
    }

    /// Whether the elements can be indices: unsigned integers.
    pub(super) fn are_indices(&self) -> bool {
        matches!(self.kind, ComponentType::U8 | ComponentType::U16 | ComponentType::U32) && self.width == 1
    }

    /// Element `index` of an accessor of indices.
    pub(super) fn index(&self, index: usize) -> u32 {
        match self.bytes(index) {
            Some(&[a]) => u32::from(a),
            Some(&[a, b]) => u32::from(u16::from_le_bytes([a, b])),
            Some(&[a, b, c, d]) => u32::from_le_bytes([a, b, c, d]),
            _ => 0,
        }
    }
}
