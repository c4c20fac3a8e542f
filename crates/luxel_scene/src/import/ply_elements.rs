//! The elements of a .ply file as its reader fills them.

use ply_rs_bw::ply::{Property, PropertyAccess, PropertyAccessResult};

use super::srgb::linear;

/// Whether a property of a vertex or a face is understood.
pub(super) fn is_known(element: &str, property: &str) -> bool {
    match element {
        "vertex" => slot(property).is_some(),
        _ => is_indices(property),
    }
}

fn is_indices(property: &str) -> bool {
    matches!(property, "vertex_indices" | "vertex_index")
}

/// What an element is read as whose content nobody wants.
#[derive(Debug)]
pub(super) struct Skipped;

impl PropertyAccess for Skipped {
    fn new() -> Self {
        Self
    }
}

/// A corner. Colours are linear; integers among them are taken for sRGB of 255 steps, as most files mean it.
#[derive(Debug)]
pub(super) struct Vertex {
    pub(super) position: [f32; 3],
    pub(super) normal: [f32; 3],
    /// v upwards.
    pub(super) uv: [f32; 2],
    pub(super) color: [f32; 4],
}

/// Where a number of a vertex goes.
#[derive(Clone, Copy)]
enum Slot {
    Position(usize),
    Normal(usize),
    Uv(usize),
    Color(usize),
}

fn slot(property: &str) -> Option<Slot> {
    Some(match property {
        "x" => Slot::Position(0),
        "y" => Slot::Position(1),
        "z" => Slot::Position(2),
        "nx" => Slot::Normal(0),
        "ny" => Slot::Normal(1),
        "nz" => Slot::Normal(2),
        "s" | "u" | "texture_u" | "texture_s" => Slot::Uv(0),
        "t" | "v" | "texture_v" | "texture_t" => Slot::Uv(1),
        "red" | "diffuse_red" | "r" => Slot::Color(0),
        "green" | "diffuse_green" | "g" => Slot::Color(1),
        "blue" | "diffuse_blue" | "b" => Slot::Color(2),
        "alpha" | "a" => Slot::Color(3),
        _ => return None,
    })
}

impl PropertyAccess for Vertex {
    fn new() -> Self {
        Self { position: [0.0; 3], normal: [0.0; 3], uv: [0.0; 2], color: [1.0; 4] }
    }

    fn set_property(&mut self, name: &str, property: Property) -> PropertyAccessResult {
        let Some(slot) = slot(name) else { return PropertyAccessResult::Ignored };
        let Some((value, is_integer)) = number(&property) else {
            return PropertyAccessResult::UnsupportedType;
        };
        match slot {
            Slot::Position(axis) => self.position[axis] = value,
            Slot::Normal(axis) => self.normal[axis] = value,
            Slot::Uv(axis) => self.uv[axis] = value,
            Slot::Color(3) => self.color[3] = if is_integer { value / 255.0 } else { value },
            Slot::Color(channel) => {
                self.color[channel] = if is_integer { linear(value / 255.0) } else { value };
            }
        }
        PropertyAccessResult::Set
    }

    fn set_float(&mut self, name: &str, value: f32) -> PropertyAccessResult {
        self.set_property(name, Property::Float(value))
    }
}

/// A scalar, and whether its type is an integer.
fn number(property: &Property) -> Option<(f32, bool)> {
    Some(match *property {
        Property::Char(value) => (f32::from(value), true),
        Property::UChar(value) => (f32::from(value), true),
        Property::Short(value) => (f32::from(value), true),
        Property::UShort(value) => (f32::from(value), true),
        Property::Int(value) => (value as f32, true),
        Property::UInt(value) => (value as f32, true),
        Property::Float(value) => (value, false),
        Property::Double(value) => (value as f32, false),
        _ => return None,
    })
}

/// A polygon.
#[derive(Debug)]
pub(super) struct Face {
    /// An index that cannot be one is the largest.
    corners: Vec<u32>,
}

impl Face {
    /// Adds the polygon's fan of triangles; false if there would be more than `limit`. Two corners or fewer are a
    /// triangle that cannot be used.
    pub(super) fn triangulate(self, triangles: &mut Vec<[u32; 3]>, limit: usize) -> bool {
        match self.corners.as_slice() {
            [first, others @ ..] if others.len() >= 2 => {
                let pairs = others.windows(2);
                if triangles.len() + pairs.len() > limit {
                    return false;
                }
                triangles.extend(pairs.map(|pair| [*first, pair[0], pair[1]]));
            }
            _ => triangles.push([u32::MAX; 3]),
        }
        triangles.len() <= limit
    }
}

impl PropertyAccess for Face {
    fn new() -> Self {
        Self { corners: Vec::new() }
    }

    fn set_property(&mut self, name: &str, property: Property) -> PropertyAccessResult {
        if !is_indices(name) {
            return PropertyAccessResult::Ignored;
        }
        let index = |value: i64| u32::try_from(value).unwrap_or(u32::MAX);
        self.corners = match property {
            Property::ListChar(list) => list.into_iter().map(|it| index(it.into())).collect(),
            Property::ListUChar(list) => list.into_iter().map(u32::from).collect(),
            Property::ListShort(list) => list.into_iter().map(|it| index(it.into())).collect(),
            Property::ListUShort(list) => list.into_iter().map(u32::from).collect(),
            Property::ListInt(list) => list.into_iter().map(|it| index(it.into())).collect(),
            Property::ListUInt(list) => list,
            _ => return PropertyAccessResult::UnsupportedType,
        };
        PropertyAccessResult::Set
    }
}
