//! The one table of ways in which rays find the triangles of a mesh.
//!
//! Like a structure over spheres ([`crate::SphereAccel`]) a way changes no picture; it selects which WESL code exists
//! (`@if(condition)`).

/// How a mesh is searched.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[repr(u32)]
pub enum MeshAccel {
    /// Every triangle is tested.
    Naive,
    /// Its BVH in depth-first order by escape index, without a stack (seed 2, 2.6.3).
    Escape,
    /// Its BVH, the nearer child first.
    #[default]
    Bvh,
}

/// What is known of a way.
#[derive(Clone, Copy, Debug)]
pub struct MeshAccelRow {
    /// The way.
    pub accel: MeshAccel,
    /// Name on the command line, in scene files, records and panels.
    pub name: &'static str,
    /// Name in WESL conditions.
    pub condition: &'static str,
}

/// Every way, in the order of [`MeshAccel`]. All of them answer every ray alike, bit for bit.
pub const MESH_ACCELS: &[MeshAccelRow] = &[
    MeshAccelRow { accel: MeshAccel::Naive, name: "naive", condition: "meshes_naive" },
    MeshAccelRow { accel: MeshAccel::Escape, name: "bvh-escape", condition: "meshes_bvh_escape" },
    MeshAccelRow { accel: MeshAccel::Bvh, name: "bvh", condition: "meshes_bvh" },
];

impl MeshAccel {
    /// What is known of it.
    pub fn row(self) -> &'static MeshAccelRow {
        &MESH_ACCELS[self as usize]
    }

    /// Name on the command line, in scene files, records and panels.
    pub fn name(self) -> &'static str {
        self.row().name
    }

    /// Every way's WESL condition with whether it is this one.
    pub fn conditions(self) -> impl Iterator<Item = (&'static str, bool)> {
        MESH_ACCELS.iter().map(move |row| (row.condition, row.accel == self))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_stand_in_the_order_of_the_enum() {
        for (i, row) in MESH_ACCELS.iter().enumerate() {
            assert_eq!(row.accel as usize, i, "{}", row.name);
            assert_eq!(row.accel.conditions().filter(|(_, on)| *on).count(), 1);
        }
    }
}
