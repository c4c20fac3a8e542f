//! Orthonormal frames around a normal.
//!
//! Theory: Duff et al. 2017, "Building an Orthonormal Basis, Revisited" (JCGT 6(1)). Worst error over all
//! normals, `-z` included: 2e-7 (Frisvad's older form: 0.6).
use crate::{Real, Vector};

/// Two unit tangents that make a right-handed frame with `n`.
#[derive(Clone, Copy, Debug)]
pub struct Frame<R: Real> {
    /// First tangent.
    pub s: R::Vec3,
    /// Second tangent.
    pub t: R::Vec3,
    /// The normal itself.
    pub n: R::Vec3,
}

impl<R: Real> Frame<R> {
    /// A frame around a unit normal.
    #[inline]
    pub fn around(n: R::Vec3) -> Self {
        // A comparison, because `sign(0)` is 0 and WGSL may lose the sign of zero.
        let sign = if n.z() >= R::ZERO { R::ONE } else { -R::ONE };
        let a = -R::ONE / (sign + n.z());
        let b = n.x() * n.y() * a;
        Self {
            s: R::Vec3::new(R::ONE + sign * n.x() * n.x() * a, sign * b, -sign * n.x()),
            t: R::Vec3::new(b, sign + n.y() * n.y() * a, -n.y()),
            n,
        }
    }

    /// A vector given in this frame, in world axes.
    #[inline]
    pub fn to_world(&self, v: R::Vec3) -> R::Vec3 {
        self.s * v.x() + self.t * v.y() + self.n * v.z()
    }
}
