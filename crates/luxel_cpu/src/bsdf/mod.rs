//! Surface scattering: one file per material.
//!
//! Directions are unit vectors that point away from the surface. A [`sample`] carries its weight `f · |cos| / pdf` as a
//! whole; [`evaluate`] gives `f · |cos|` and the density with which [`sample`] takes a direction, for the part of the
//! material that is no mirror. That is all that next-event estimation and its weights need.
use luxel_flat::{
    Counter, Counters, MATERIAL_DIELECTRIC, MATERIAL_LAMBERT, MATERIAL_METAL, MATERIAL_PRINCIPLED,
    MATERIAL_SEMI_SPECULAR, MaterialRecord,
};
use luxel_geom::{Real, Vector};

mod dielectric;
mod lambert;
mod metal;
mod principled;
mod semi_specular;

/// A material at a point, textures applied. The fields mean what they mean in `luxel_flat::MaterialRecord`.
#[derive(Clone, Copy, Debug)]
pub struct Bsdf<R: Real> {
    /// `MATERIAL_LAMBERT`, ….
    pub kind: u32,
    /// `MATERIAL_EMISSIVE`, ….
    pub flags: u32,
    /// Base colour.
    pub color: R::Vec3,
    /// Fuzz, smoothness or roughness.
    pub roughness: R,
    /// Share of the base that is metal.
    pub metallic: R,
    /// Index of refraction.
    pub ior: R,
    /// Share of the dielectric base that is clear.
    pub transmission: R,
    /// Strength of the dielectric reflection.
    pub specular: R,
    /// Tint of the dielectric reflection at normal incidence.
    pub specular_color: R::Vec3,
    /// Strength of the clear coat.
    pub clearcoat: R,
    /// Roughness of the clear coat.
    pub clearcoat_roughness: R,
}

/// What scattering needs to know of the place where it happens.
#[derive(Clone, Copy, Debug)]
pub struct Geometry<R: Real> {
    /// Unit direction back along the ray.
    pub wo: R::Vec3,
    /// Unit normal that the material is shaded with, on the side of `geometric`.
    pub normal: R::Vec3,
    /// Unit geometric normal on `wo`'s side.
    pub geometric: R::Vec3,
    /// True if `wo` is on the outer side.
    pub front: bool,
}

/// A scattered direction.
#[derive(Clone, Copy, Debug)]
pub struct BsdfSample<R: Real> {
    /// Unit direction in which the path goes on.
    pub wi: R::Vec3,
    /// `f · |cos| / pdf`; for a mirror-like lobe its reflectance over the probability that it was taken.
    pub weight: R::Vec3,
    /// Density per solid angle, as [`evaluate`] has it; 0 if the direction came from a mirror-like lobe.
    pub pdf: R,
    /// Square of the relative index of refraction if the path was refracted, else 1.
    pub eta_scale: R,
}

/// What a material does with light between two given directions, mirror-like lobes left out.
#[derive(Clone, Copy, Debug)]
pub struct BsdfValue<R: Real> {
    /// `f · |cos|`.
    pub f_cos: R::Vec3,
    /// Density per solid angle with which [`sample`] takes the direction.
    pub pdf: R,
}

impl<R: Real> Bsdf<R> {
    /// A material as its record says.
    pub fn of(material: &MaterialRecord) -> Self {
        Self {
            kind: material.kind,
            flags: material.flags,
            color: R::Vec3::from_array(material.color),
            roughness: R::from_f32(material.roughness),
            metallic: R::from_f32(material.metallic),
            ior: R::from_f32(material.ior),
            transmission: R::from_f32(material.transmission),
            specular: R::from_f32(material.specular),
            specular_color: R::Vec3::from_array(material.specular_color),
            clearcoat: R::from_f32(material.clearcoat),
            clearcoat_roughness: R::from_f32(material.clearcoat_roughness),
        }
    }
}

impl<R: Real> Geometry<R> {
    /// True if a direction is on the same side of the true surface as of the shaded one. Between the two lies what
    /// would leak through the surface, or into it.
    fn is_on_one_side(&self, wi: R::Vec3) -> bool {
        self.is_above(wi) == (wi.dot(self.normal) > R::ZERO)
    }

    /// True if a direction is on `wo`'s side of the true surface.
    fn is_above(&self, wi: R::Vec3) -> bool {
        wi.dot(self.geometric) > R::ZERO
    }
}

impl<R: Real> BsdfSample<R> {
    /// A mirror-like sample that stays on its side of the surface.
    fn mirrored(wi: R::Vec3, weight: R::Vec3) -> Self {
        Self { wi, weight, pdf: R::ZERO, eta_scale: R::ONE }
    }
}

impl<R: Real> BsdfValue<R> {
    /// No light.
    fn black() -> Self {
        Self { f_cos: R::Vec3::splat(R::ZERO), pdf: R::ZERO }
    }
}

/// Samples a direction; `None` if the light is absorbed. `u` are three numbers in `[0, 1)`, `tables` the scene's
/// `albedo_tables`.
pub fn sample<R: Real>(
    bsdf: &Bsdf<R>,
    geometry: &Geometry<R>,
    u: [R; 3],
    tables: &[f32],
    counters: &mut Counters,
) -> Option<BsdfSample<R>> {
    let sample = match bsdf.kind {
        MATERIAL_LAMBERT => {
            counters[Counter::LambertBounces] += 1;
            Some(lambert::sample_lambert(bsdf, geometry, u))
        }
        MATERIAL_METAL => {
            counters[Counter::MetalBounces] += 1;
            metal::sample_metal(bsdf, geometry, u)
        }
        MATERIAL_DIELECTRIC => {
            counters[Counter::DielectricBounces] += 1;
            Some(dielectric::sample_dielectric(bsdf, geometry, u))
        }
        MATERIAL_SEMI_SPECULAR => {
            counters[Counter::SemiSpecularBounces] += 1;
            Some(semi_specular::sample_semi_specular(bsdf, geometry, u))
        }
        MATERIAL_PRINCIPLED => {
            counters[Counter::PrincipledBounces] += 1;
            principled::sample_principled(bsdf, geometry, u, tables, counters)
        }
        _ => None,
    };
    let can_pass = matches!(bsdf.kind, MATERIAL_DIELECTRIC | MATERIAL_PRINCIPLED);
    sample.filter(|sample| geometry.is_on_one_side(sample.wi) && (can_pass || geometry.is_above(sample.wi)))
}

/// The material's part that is no mirror, for light between `geometry.wo` and `wi`.
pub fn evaluate<R: Real>(
    bsdf: &Bsdf<R>,
    geometry: &Geometry<R>,
    wi: R::Vec3,
    tables: &[f32],
) -> BsdfValue<R> {
    if !geometry.is_on_one_side(wi) {
        return BsdfValue::black();
    }
    match bsdf.kind {
        MATERIAL_LAMBERT => lambert::evaluate_lambert(bsdf, geometry, wi),
        MATERIAL_SEMI_SPECULAR => semi_specular::evaluate_semi_specular(bsdf, geometry, wi),
        MATERIAL_PRINCIPLED => principled::evaluate_principled(bsdf, geometry, wi, tables),
        _ => BsdfValue::black(),
    }
}

/// True if [`evaluate`] is black for all directions: no light needs to be sampled.
pub fn is_delta<R: Real>(bsdf: &Bsdf<R>) -> bool {
    match bsdf.kind {
        MATERIAL_LAMBERT => false,
        MATERIAL_SEMI_SPECULAR => bsdf.roughness >= R::ONE,
        MATERIAL_PRINCIPLED => principled::is_delta(bsdf),
        _ => true,
    }
}

/// The albedo that first-hit outputs show.
pub fn albedo<R: Real>(bsdf: &Bsdf<R>) -> R::Vec3 {
    if bsdf.kind == MATERIAL_DIELECTRIC { R::Vec3::splat(R::ONE) } else { bsdf.color }
}
