//! Surface scattering: one file per material.
//!
//! Directions point away from the surface. A sample carries its weight `f · |cos| / pdf` as a whole: none of
//! these materials needs its density on its own until light sources are sampled.
use luxel_flat::{Counter, Counters, MATERIAL_DIELECTRIC, MATERIAL_LAMBERT, MaterialRecord};
use luxel_geom::{Real, Vector};

mod dielectric;
mod lambert;
mod metal;

/// What scattering needs to know of the place where it happens.
#[derive(Clone, Copy, Debug)]
pub struct Geometry<R: Real> {
    /// Unit direction back along the ray.
    pub wo: R::Vec3,
    /// Unit normal on `wo`'s side.
    pub normal: R::Vec3,
    /// True if `wo` is on the outer side.
    pub front: bool,
}

/// A scattered direction.
#[derive(Clone, Copy, Debug)]
pub struct BsdfSample<R: Real> {
    /// Unit direction in which the path goes on.
    pub wi: R::Vec3,
    /// `f · |cos| / pdf`.
    pub weight: R::Vec3,
    /// Square of the relative index of refraction if the path was refracted, else 1.
    pub eta_scale: R,
}

impl<R: Real> BsdfSample<R> {
    /// A sample that stays on its side of the surface.
    fn reflected(wi: R::Vec3, weight: R::Vec3) -> Self {
        Self { wi, weight, eta_scale: R::ONE }
    }
}

/// Samples a direction; `None` if the light is absorbed. `u` are three numbers in `[0, 1)`.
pub fn sample<R: Real>(
    material: &MaterialRecord,
    geometry: &Geometry<R>,
    u: [R; 3],
    counters: &mut Counters,
) -> Option<BsdfSample<R>> {
    match material.kind {
        MATERIAL_LAMBERT => {
            counters[Counter::LambertBounces] += 1;
            Some(lambert::sample_lambert(material, geometry, u))
        }
        MATERIAL_DIELECTRIC => {
            counters[Counter::DielectricBounces] += 1;
            Some(dielectric::sample_dielectric(material, geometry, u))
        }
        _ => {
            counters[Counter::MetalBounces] += 1;
            metal::sample_metal(material, geometry, u)
        }
    }
}

/// The albedo that first-hit outputs show.
pub fn albedo<R: Real>(material: &MaterialRecord) -> R::Vec3 {
    if material.kind == MATERIAL_DIELECTRIC {
        R::Vec3::splat(R::ONE)
    } else {
        R::Vec3::from_array(material.color)
    }
}
