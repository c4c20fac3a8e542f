//! From an object's world transform to its instance record, and whether it can have one.
//!
//! The inverse is computed in f64 and rounded once (I01). An object whose transform cannot be inverted or
//! leaves the range of single precision is left out, alone (I02).
use glam::{DAffine3, DMat3, DVec3};
use luxel_flat::Instance;
use luxel_geom::{Aabb, Affine};

use crate::Disabled;
use crate::lattice::{Extent, LARGEST};

/// Axes that span less than this share of the box with their lengths lie in one plane, as far as single
/// precision can tell.
const FLATTEST: f64 = 1.0 / (1u64 << 40) as f64;

/// A transform that can be inverted, and the box of what it places.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Placement {
    world_from_object: DAffine3,
    object_from_world: DMat3,
    object_box: Aabb<f32>,
}

impl Placement {
    /// Checks a transform for an object of that box.
    pub(crate) fn new(world_from_object: DAffine3, object_box: Aabb<f32>) -> Result<Self, Disabled> {
        let matrix = world_from_object.matrix3;
        if !world_from_object.is_finite() {
            return Err(Disabled::NotFinite);
        }
        if object_box.is_empty() {
            return Err(Disabled::Empty);
        }
        let lengths = [matrix.x_axis, matrix.y_axis, matrix.z_axis].map(|axis| axis.length());
        let is_large = largest_element(&matrix) > LARGEST;
        if !is_large && matrix.determinant().abs() <= lengths.iter().product::<f64>() * FLATTEST {
            return Err(Disabled::Singular);
        }
        let placement = Self { world_from_object, object_from_world: matrix.inverse(), object_box };
        let farthest = world_from_object.translation.abs().max_element() + placement.reach();
        let is_small = largest_element(&placement.object_from_world) > LARGEST;
        if is_large || is_small || farthest > LARGEST { Err(Disabled::OutOfRange) } else { Ok(placement) }
    }

    /// Where the object is, in world space.
    pub(crate) fn world_from_object(&self) -> DAffine3 {
        self.world_from_object
    }

    /// Where the object is and how large.
    pub(crate) fn extent(&self) -> Extent {
        Extent::new(self.world_from_object.translation, self.reach())
    }

    /// How far the object reaches from its origin along any world axis, at most.
    fn reach(&self) -> f64 {
        let far = self.object_box.lo.abs().max(self.object_box.hi.abs()).as_dvec3();
        let rows = self.world_from_object.matrix3.transpose();
        [rows.x_axis, rows.y_axis, rows.z_axis].map(|row| row.abs().dot(far)).into_iter().fold(0.0, f64::max)
    }

    /// The transforms and box of the object's record, relative to the origin of tracer space.
    pub(crate) fn record(&self, anchor: DVec3) -> Result<Instance, Disabled> {
        let translation = self.world_from_object.translation - anchor;
        let inverse_translation = -(self.object_from_world * translation);
        let farthest = translation.abs().max_element().max(inverse_translation.abs().max_element());
        if farthest > LARGEST {
            return Err(Disabled::OutOfRange);
        }
        let affine = |matrix3, translation| Affine::<f32>::from_daffine(&DAffine3 { matrix3, translation });
        let world_from_object = affine(self.world_from_object.matrix3, translation);
        let bounds = world_from_object.bounds(&self.object_box);
        Ok(Instance {
            world_from_object: world_from_object.to_rows(),
            object_from_world: affine(self.object_from_world, inverse_translation).to_rows(),
            lo: bounds.lo.to_array(),
            hi: bounds.hi.to_array(),
            ..Instance::default()
        })
    }
}

fn largest_element(matrix: &DMat3) -> f64 {
    matrix.to_cols_array().into_iter().map(f64::abs).fold(0.0, f64::max)
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::{DQuat, Vec3};

    fn unit_box() -> Aabb<f32> {
        Aabb { lo: Vec3::NEG_ONE, hi: Vec3::ONE }
    }

    fn scaled(scale: DVec3) -> DAffine3 {
        DAffine3::from_scale_rotation_translation(
            scale,
            DQuat::from_rotation_y(0.7),
            DVec3::new(1.0, 2.0, 3.0),
        )
    }

    #[test]
    fn bad_transforms_are_named() {
        let flat_below_turned =
            scaled(DVec3::new(1.0, 1.0, 0.0)) * DAffine3::from_quat(DQuat::from_rotation_x(0.3));
        for (transform, reason) in [
            (scaled(DVec3::new(1.0, 1.0, 0.0)), Disabled::Singular),
            (flat_below_turned, Disabled::Singular),
            (scaled(DVec3::ZERO), Disabled::Singular),
            (scaled(DVec3::splat(1e-200)), Disabled::Singular),
            (scaled(DVec3::NAN), Disabled::NotFinite),
            (DAffine3::from_translation(DVec3::X * f64::INFINITY), Disabled::NotFinite),
            (scaled(DVec3::splat(1e30)), Disabled::OutOfRange),
            (scaled(DVec3::splat(1e200)), Disabled::OutOfRange),
            (scaled(DVec3::splat(1e-30)), Disabled::OutOfRange),
            (DAffine3::from_translation(DVec3::X * 1e30), Disabled::OutOfRange),
        ] {
            assert_eq!(Placement::new(transform, unit_box()).err(), Some(reason), "{transform:?}");
        }
        assert_eq!(Placement::new(DAffine3::IDENTITY, Aabb::empty()).err(), Some(Disabled::Empty));
    }

    #[test]
    fn hard_but_sound_transforms_pass() {
        for scale in
            [DVec3::splat(1e-6), DVec3::splat(1e6), DVec3::new(1.0, 1e3, 1e-3), DVec3::new(-1.0, 1.0, 1.0)]
        {
            let transform = scaled(DVec3::new(1.0, 1e3, 1e-3)) * scaled(scale);
            assert!(Placement::new(transform, unit_box()).is_ok(), "{scale}");
        }
    }

    #[test]
    fn a_record_maps_there_and_back() {
        let transform = scaled(DVec3::new(0.5, 2.0, -3.0));
        let anchor = DVec3::new(1.0, 0.0, 0.0);
        let record = Placement::new(transform, unit_box()).unwrap().record(anchor).unwrap();
        let (forth, back) = (record.world_from_object, record.object_from_world);
        let (forth, back) = (Affine::<f64>::from_rows(&forth), Affine::<f64>::from_rows(&back));
        for corner in [DVec3::NEG_ONE, DVec3::ONE, DVec3::new(1.0, -1.0, 0.5)] {
            let there = forth.point(corner);
            assert!((there + anchor - transform.transform_point3(corner)).length() < 1e-6);
            assert!((back.point(there) - corner).length() < 1e-6);
            let inside = Aabb::<f32> { lo: Vec3::from(record.lo), hi: Vec3::from(record.hi) };
            assert!(inside.contains(&Aabb::<f32>::around(there.as_vec3(), there.as_vec3())));
        }
    }
}
