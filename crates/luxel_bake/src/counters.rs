//! What baking did, counted since the baker was made: how a test knows what an edit rebuilt.
use bevy_ecs::prelude::Resource;

/// Declares the counters: name and meaning.
macro_rules! counters {
    ($($(#[doc = $doc:literal])* $name:ident,)*) => {
        /// Work done by all runs so far; only ever grows.
        #[derive(Resource, Clone, Copy, Debug, Default, PartialEq, Eq, serde::Serialize)]
        pub struct BakeCounters { $($(#[doc = $doc])* pub $name: u64,)* }

        impl BakeCounters {
            /// Work done since an earlier reading.
            #[must_use]
            pub fn since(&self, earlier: &Self) -> Self {
                Self { $($name: self.$name - earlier.$name,)* }
            }

            /// Name and count of every counter.
            pub fn iter(&self) -> impl Iterator<Item = (&'static str, u64)> {
                [$((stringify!($name), self.$name),)*].into_iter()
            }
        }
    };
}

counters! {
    /// `GlobalTransform`s that got a new value.
    transforms_propagated,
    /// Material records that got a new value.
    materials_written,
    /// Texture slots that got a new value.
    textures_written,
    /// Images put among the texels.
    images_placed,
    /// Images taken from the texels, because nothing shows them any more or at another size.
    images_released,
    /// Mesh BVHs built; with one tree over all meshes, meshes put among the triangles.
    blas_built,
    /// Mesh BVHs refitted in place, because their triangles moved.
    blas_refitted,
    /// Mesh BVHs given up because nothing uses their mesh any more.
    blas_freed,
    /// Trees over all meshes built.
    joined_built,
    /// Trees over all meshes refitted in place, because triangles moved.
    joined_refitted,
    /// Attributes of meshes built.
    attributes_built,
    /// Attributes of meshes given up because nothing uses them any more.
    attributes_freed,
    /// Voxel octrees built.
    svo_built,
    /// Voxel octrees given up because nothing uses their volume any more.
    svo_freed,
    /// Spheres put into the cloud's structure, one at a time.
    sphere_inserts,
    /// Spheres taken out of it.
    sphere_removes,
    /// Spheres moved, resized or given another material slot inside it.
    sphere_updates,
    /// Structures built anew from all spheres, because the cloud's anchor, root cell, options or generation changed,
    /// or edits wore them out.
    sphere_rebuilds,
    /// Nodes of the structure that were written.
    sphere_nodes_touched,
    /// Moves of tracer space's origin; each rewrites every instance.
    anchors_moved,
    /// Instance records that got a new value.
    instances_written,
    /// TLAS builds.
    tlas_builds,
    /// Tables of lights made, each with its light tree.
    light_tables,
    /// Changes of the set of features.
    features_changed,
    /// Flat scenes published.
    publishes,
}
