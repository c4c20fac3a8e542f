//! Many cells at once.
use glam::{UVec3, Vec3};

/// A body whose cells are edited together.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum SvoBrush {
    /// Cells from `lo` up to, but without, `hi`.
    Box {
        /// Lowest cell.
        lo: UVec3,
        /// One past the highest cell, along each axis.
        hi: UVec3,
    },
    /// Cells whose centre is no farther than `radius` from `center`; a voxel is one unit long.
    Ball {
        /// Centre, in the volume's coordinates.
        center: Vec3,
        /// Radius; nothing if it is negative or not a number.
        radius: f32,
    },
}

/// What a brush leaves in its cells.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct SvoPaint {
    /// Colour, sRGB.
    pub color: [u8; 3],
    /// Material, counted from the instance's `material_first`.
    pub material: u8,
}

impl SvoBrush {
    /// The cells of a volume of `edge`³ that are in the body, x fastest.
    pub(super) fn cells(&self, edge: u32) -> impl Iterator<Item = [u16; 3]> + use<'_> {
        let (lo, hi) = self.span();
        let hi = hi.min(UVec3::splat(edge));
        let rows = (lo.z..hi.z).flat_map(move |z| (lo.y..hi.y).map(move |y| (y, z)));
        let all = rows.flat_map(move |(y, z)| (lo.x..hi.x).map(move |x| UVec3::new(x, y, z)));
        all.filter(|cell| self.holds(*cell)).map(|cell| cell.to_array().map(|c| c as u16))
    }

    /// A box of cells around the body.
    fn span(&self) -> (UVec3, UVec3) {
        match *self {
            Self::Box { lo, hi } => (lo, hi),
            // Converting to integers saturates, and makes nothing of NaN.
            Self::Ball { center, radius } => {
                ((center - radius).as_uvec3(), (center + radius + 1.0).as_uvec3())
            }
        }
    }

    fn holds(&self, cell: UVec3) -> bool {
        match *self {
            Self::Box { .. } => true,
            Self::Ball { center, radius } => {
                (cell.as_vec3() + 0.5).distance_squared(center) <= radius * radius && radius >= 0.0
            }
        }
    }
}
