//! `shared_struct!`: a Rust record that is also a WGSL struct.
//!
//! The macro emits the `repr(C)` record and a table of its fields as WGSL sees them. A constant check refuses a
//! record whose Rust offsets WGSL would not compute; a test compares the table with what naga computes from
//! the generated text.

/// A field as WGSL sees it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Field {
    /// Name, the same in both languages.
    pub name: &'static str,
    /// WGSL type.
    pub wgsl: &'static str,
    /// Offset in bytes.
    pub offset: usize,
    /// Size in bytes.
    pub size: usize,
    /// WGSL alignment in bytes.
    pub align: usize,
}

/// A record that both languages share.
pub trait SharedStruct: bytemuck::Pod {
    /// Name, the same in both languages.
    const NAME: &'static str;
    /// Fields in order.
    const FIELDS: &'static [Field];
    /// Size in bytes, the stride of an array of these.
    const SIZE: usize = size_of::<Self>();
}

/// A Rust type that has a WGSL twin of the same bytes.
pub trait WgslType {
    /// The WGSL type.
    const NAME: &'static str;
    /// WGSL alignment in bytes.
    const ALIGN: usize;
}

macro_rules! wgsl_type {
    ($($rust:ty => $wgsl:literal, $align:literal;)*) => {
        $(impl WgslType for $rust {
            const NAME: &'static str = $wgsl;
            const ALIGN: usize = $align;
        })*
    };
}

wgsl_type! {
    u32 => "u32", 4;
    f32 => "f32", 4;
    [u32; 3] => "array<u32, 3>", 4;
    [u32; 4] => "vec4u", 16;
    [[u32; 2]; 3] => "array<vec2u, 3>", 8;
    [f32; 2] => "vec2f", 8;
    [[f32; 2]; 3] => "array<vec2f, 3>", 8;
    [f32; 3] => "vec3f", 16;
    [f32; 4] => "vec4f", 16;
    [[f32; 4]; 3] => "array<vec4f, 3>", 16;
}

/// True if WGSL lays the fields out at the Rust offsets, without gaps, and agrees on the size.
pub const fn layout_agrees(fields: &[Field], size: usize) -> bool {
    let (mut end, mut align, mut i) = (0, 4, 0);
    while i < fields.len() {
        let field = fields[i];
        if field.offset != end || !field.offset.is_multiple_of(field.align) {
            return false;
        }
        if field.align > align {
            align = field.align;
        }
        end = field.offset + field.size;
        i += 1;
    }
    end == size && size.is_multiple_of(align)
}

/// Declares a record shared with WGSL; see the module's text.
macro_rules! shared_struct {
    ($(#[$meta:meta])* pub struct $name:ident {
        $($(#[$field_meta:meta])* pub $field:ident: $ty:ty,)*
    }) => {
        $(#[$meta])*
        #[repr(C)]
        #[derive(Clone, Copy, Debug, Default, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
        pub struct $name {
            $($(#[$field_meta])* pub $field: $ty,)*
        }

        impl $crate::layout::SharedStruct for $name {
            const NAME: &'static str = stringify!($name);
            const FIELDS: &'static [$crate::layout::Field] = &[
                $($crate::layout::Field {
                    name: stringify!($field),
                    wgsl: <$ty as $crate::layout::WgslType>::NAME,
                    offset: core::mem::offset_of!($name, $field),
                    size: size_of::<$ty>(),
                    align: <$ty as $crate::layout::WgslType>::ALIGN,
                },)*
            ];
        }

        const _: () = assert!(
            $crate::layout::layout_agrees(
                <$name as $crate::layout::SharedStruct>::FIELDS,
                <$name as $crate::layout::SharedStruct>::SIZE,
            ),
            "WGSL would lay this record out differently: reorder or pad its fields",
        );
    };
}
pub(crate) use shared_struct;

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_misaligned_vector_is_refused() {
        let field = |offset, size, align| Field { name: "f", wgsl: "?", offset, size, align };
        assert!(layout_agrees(&[field(0, 12, 16), field(12, 4, 4)], 16));
        assert!(!layout_agrees(&[field(0, 4, 4), field(4, 12, 16)], 16));
        assert!(!layout_agrees(&[field(0, 12, 16)], 12));
    }
}
