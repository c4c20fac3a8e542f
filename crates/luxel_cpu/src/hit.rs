//! What a ray met, and what it must not meet again.
use luxel_flat::NONE;
use luxel_geom::{Exclude, Real};

/// The closest hit within one instance, in the instance's own terms.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PrimitiveHit<R: Real> {
    /// Ray parameter.
    pub t: R,
    /// Barycentric weights of a triangle's second and third vertex; a voxel's face and 0; 0 for a sphere.
    pub uv: [R; 2],
    /// Slot of the sphere, triangle or SVO node in its heap.
    pub slot: u32,
    /// Stable id of the primitive.
    pub primitive: u32,
    /// Material slot.
    pub material: u32,
}

/// The closest hit of a ray in the scene.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hit<R: Real> {
    /// Slot of the instance.
    pub instance: u32,
    /// Stable id of the instance.
    pub instance_id: u32,
    /// The hit within it.
    pub on: PrimitiveHit<R>,
}

impl<R: Real> PrimitiveHit<R> {
    /// The order of hits within an instance: by `t`, then by stable id. It does not depend on the order in
    /// which a structure offers them.
    #[inline]
    pub fn precedes(&self, other: &Option<Self>) -> bool {
        other.is_none_or(|o| self.t < o.t || (self.t == o.t && self.primitive < o.primitive))
    }
}

impl<R: Real> Hit<R> {
    /// The order of hits in the scene: by `t`, then stable instance, then stable primitive.
    #[inline]
    pub fn precedes(&self, other: &Option<Self>) -> bool {
        other.is_none_or(|o| {
            self.on.t < o.on.t
                || (self.on.t == o.on.t
                    && (self.instance_id, self.on.primitive) < (o.instance_id, o.on.primitive))
        })
    }
}

/// What a ray does not meet: the primitive that it starts on, and what its coins let it pass.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Exclusion {
    /// Slot of its instance, or `NONE`.
    pub instance: u32,
    /// Slot of the sphere, triangle or SVO node in its heap.
    pub primitive: u32,
    /// How the ray leaves it.
    pub how: Exclude,
    /// Decides which see-through surfaces the ray passes (`alpha`): a hash of pixel, sample and bounce.
    pub coins: u32,
}

impl Exclusion {
    /// The ray starts in free space.
    pub const NOTHING: Self = Self { instance: NONE, primitive: NONE, how: Exclude::Nothing, coins: 0 };

    /// This exclusion as seen from inside an instance.
    #[inline]
    pub fn within(&self, instance: u32) -> Self {
        if self.instance == instance { *self } else { Self { coins: self.coins, ..Self::NOTHING } }
    }

    /// What to exclude when testing a primitive.
    #[inline]
    pub fn of(&self, primitive: u32) -> Exclude {
        if self.primitive == primitive { self.how } else { Exclude::Nothing }
    }
}
