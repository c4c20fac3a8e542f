//! The one table of structures that the sphere cloud may have.
//!
//! Unlike an effect, a structure changes no picture (but for [`SphereAccel::OctreeSeed`], whose errors are what
//! it is kept for). The one that a scene has selects which WESL code and bindings exist (`@if(condition)`).

/// A structure over the spheres of the cloud.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[repr(u32)]
pub enum SphereAccel {
    /// None: every sphere is tested.
    Naive,
    /// The report's octree of cells, searched whole, without early exit (seed 1, II.D, "Base Implementation").
    OctreeBase,
    /// The same octree, front to back by the ray's octant; the first leaf with any hit ends the search (seed 1,
    /// II.D, the heuristic). Fast and sometimes wrong: for comparison only.
    OctreeSeed,
    /// The loose octree with tight boxes, front to back, pruned by the best hit: exact.
    #[default]
    Octree,
    /// A bounding volume hierarchy, the nearer child first: exact.
    Bvh,
}

/// What is known of a structure.
#[derive(Clone, Copy, Debug)]
pub struct SphereAccelRow {
    /// The structure.
    pub accel: SphereAccel,
    /// Name on the command line, in scene files, records and panels.
    pub name: &'static str,
    /// Name in WESL conditions.
    pub condition: &'static str,
    /// False if it may miss the closest sphere. An exact one answers every ray as testing all spheres does, bit for bit;
    /// but for `octree-base`, and rays from farther than ten edges of its root that graze a silhouette, where rounding
    /// decides.
    pub is_exact: bool,
    /// Bindings that it reads.
    pub bindings: &'static [&'static str],
}

/// Every structure, in the order of [`SphereAccel`].
pub const SPHERE_ACCELS: &[SphereAccelRow] = &[
    SphereAccelRow {
        accel: SphereAccel::Naive,
        name: "naive",
        condition: "spheres_naive",
        is_exact: true,
        bindings: &["spheres"],
    },
    SphereAccelRow {
        accel: SphereAccel::OctreeBase,
        name: "octree-base",
        condition: "spheres_octree_base",
        is_exact: true,
        bindings: &["octree_nodes", "leaf_spheres"],
    },
    SphereAccelRow {
        accel: SphereAccel::OctreeSeed,
        name: "octree-seed",
        condition: "spheres_octree_seed",
        is_exact: false,
        bindings: &["octree_nodes", "leaf_spheres"],
    },
    SphereAccelRow {
        accel: SphereAccel::Octree,
        name: "octree",
        condition: "spheres_octree",
        is_exact: true,
        bindings: &["octree_nodes", "spheres"],
    },
    SphereAccelRow {
        accel: SphereAccel::Bvh,
        name: "bvh",
        condition: "spheres_bvh",
        is_exact: true,
        bindings: &["sphere_nodes", "leaf_spheres"],
    },
];

impl SphereAccel {
    /// What is known of it.
    pub fn row(self) -> &'static SphereAccelRow {
        &SPHERE_ACCELS[self as usize]
    }

    /// Name on the command line, in scene files, records and panels.
    pub fn name(self) -> &'static str {
        self.row().name
    }

    /// Every structure's WESL condition with whether it is this one.
    pub fn conditions(self) -> impl Iterator<Item = (&'static str, bool)> {
        SPHERE_ACCELS.iter().map(move |row| (row.condition, row.accel == self))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_stand_in_the_order_of_the_enum() {
        for (i, row) in SPHERE_ACCELS.iter().enumerate() {
            assert_eq!(row.accel as usize, i, "{}", row.name);
            assert_eq!(row.accel.conditions().filter(|(_, on)| *on).count(), 1);
        }
    }
}
