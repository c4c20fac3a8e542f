//! Affine maps in the flat form that both tracers read, with error bounds.
use crate::{Aabb, Real, Vector};

/// A map `p ↦ M p + t`, stored as the three rows of `[M | t]`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Affine<R: Real> {
    /// Rows of the linear part.
    pub rows: [R::Vec3; 3],
    /// Translation.
    pub translation: R::Vec3,
}

impl<R: Real> Affine<R> {
    /// From glam's column form, rounded.
    pub fn from_daffine(m: &glam::DAffine3) -> Self {
        let rows = m.matrix3.transpose();
        let v = |d: glam::DVec3| R::Vec3::new(R::from_f64(d.x), R::from_f64(d.y), R::from_f64(d.z));
        Self { rows: [v(rows.x_axis), v(rows.y_axis), v(rows.z_axis)], translation: v(m.translation) }
    }

    /// From three rows `[M | t]` of singles.
    pub fn from_rows(rows: &[[f32; 4]; 3]) -> Self {
        Self {
            rows: rows.map(|r| R::Vec3::from_array([r[0], r[1], r[2]])),
            translation: R::Vec3::from_array([rows[0][3], rows[1][3], rows[2][3]]),
        }
    }

    /// The three rows `[M | t]`, rounded to singles.
    pub fn to_rows(&self) -> [[f32; 4]; 3] {
        core::array::from_fn(|i| {
            let r = self.rows[i].to_vec3();
            [r.x, r.y, r.z, self.translation.axis(i).to_f32()]
        })
    }

    /// Maps a direction.
    #[inline]
    pub fn vector(&self, v: R::Vec3) -> R::Vec3 {
        R::Vec3::new(self.rows[0].dot(v), self.rows[1].dot(v), self.rows[2].dot(v))
    }

    /// Maps a point.
    #[inline]
    pub fn point(&self, p: R::Vec3) -> R::Vec3 {
        self.vector(p) + self.translation
    }

    /// Maps a normal by this map's inverse transpose, where `self` is the *inverse* map: `nᵀ M⁻¹`.
    #[inline]
    pub fn normal_by_transpose(&self, n: R::Vec3) -> R::Vec3 {
        self.rows[0] * n.x() + self.rows[1] * n.y() + self.rows[2] * n.z()
    }

    /// Bound on the error of a mapped vector's linear part: `|M| |v|`.
    #[inline]
    pub fn abs_vector(&self, v: R::Vec3) -> R::Vec3 {
        let v = v.abs();
        R::Vec3::new(self.rows[0].abs().dot(v), self.rows[1].abs().dot(v), self.rows[2].abs().dot(v))
    }

    /// Bound on the error of `point(p)` if `p` itself is off by at most `error` per component:
    /// γ(3)(|M||p| + |t|) + (1 + γ(3)) |M| e (pbrt-v4 §6.8.6).
    #[inline]
    pub fn point_error(&self, p: R::Vec3, error: R::Vec3) -> R::Vec3 {
        (self.abs_vector(p) + self.translation.abs()) * R::gamma(3)
            + self.abs_vector(error) * (R::ONE + R::gamma(3))
    }

    /// A box around the image of a box, rounding included.
    pub fn bounds(&self, b: &Aabb<R>) -> Aabb<R> {
        if b.is_empty() {
            return *b;
        }
        let half = R::from_f64(0.5);
        let (center, half_extent) = (b.center(), (b.hi - b.lo) * half);
        let extent = self.abs_vector(half_extent);
        let rounding = self.point_error(b.lo.abs().max(b.hi.abs()), half_extent * R::gamma(2));
        let reach = extent + rounding;
        let p = self.point(center);
        Aabb { lo: p - reach, hi: p + reach }.outset()
    }
}
