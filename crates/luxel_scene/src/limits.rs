//! What a scene may have so that it, and what bake makes of it, stays well below 4 GiB.

/// The most entities of a scene, 2^20: an entity that is a sphere takes 1.8 kB until it is baked.
pub(crate) const MAX_ENTITIES: u64 = 1 << 20;

/// The most of them that show a mesh or a volume, 2^19: one takes 3.3 kB until it is baked.
pub(crate) const MAX_INSTANCES: u64 = 1 << 19;

/// The most bytes that its images may fill together: 768 MiB. Bake holds them and a pyramid of each at a time, and a
/// graphics driver one more.
pub(crate) const MAX_SCENE_IMAGE_BYTES: u64 = 768 << 20;
