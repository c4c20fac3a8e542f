//! From a hit to the surface that shading works with: its place, its frame, and its material with textures applied.
//!
//! Twin of the kernel `surface`, which writes one `luxel_flat::SurfacePoint` per path; what a surface is to the path that
//! meets it comes from [`crate::medium::met_by`].
use luxel_flat::{
    Counter, Counters, Feature, FeatureSet, FlatScene, Instance, KIND_MESH, MATERIAL_EMISSIVE,
    MaterialRecord, NONE, TEXTURE_ROLE_NORMAL, TriangleAttributes,
};
use luxel_geom::{Affine, Ray, Real, Vector};

use crate::Hit;
use crate::bsdf::{Bsdf, Geometry};
use attributes::vertex_attributes;

pub mod attributes;
mod normal;
mod place;
pub mod roles;

pub use place::Place;

/// The surface at the end of a ray.
#[derive(Clone, Copy, Debug)]
pub struct Surface<R: Real> {
    /// Where it is.
    pub place: Place<R>,
    /// Unit normal that the material is shaded with, on the side of the geometric one.
    pub shading_normal: R::Vec3,
    /// How it scatters light.
    pub bsdf: Bsdf<R>,
    /// Radiance that it emits, on both sides.
    pub emission: R::Vec3,
    /// Its light in the table of lights, or `NONE`.
    pub light: u32,
    /// The body that it bounds if it bounds one, as a material slot; once it was met, the one that a ray enters or leaves
    /// which goes on beyond, or `NONE`.
    pub body: u32,
}

impl<R: Real> Surface<R> {
    /// The surface at a hit of a ray given in tracer space.
    pub fn at(
        scene: &FlatScene,
        features: FeatureSet,
        ray: &Ray<R>,
        hit: &Hit<R>,
        counters: &mut Counters,
    ) -> Self {
        let instance = &scene.instances.as_slice()[hit.instance as usize];
        let material = &scene.materials.as_slice()[hit.on.material as usize];
        let place = Place::at(scene, ray, hit);
        let mut surface = Self {
            place,
            shading_normal: place.normal,
            bsdf: Bsdf::of(material),
            emission: emitted_radiance::<R>(features, material, counters),
            light: light(scene, hit, material),
            body: hit.on.material,
        };
        if features.has(Feature::Attributes)
            && let Some(record) = attributes::record(scene, instance, hit.on.slot)
        {
            counters[Counter::AttributeReads] += 1;
            let on = OnTriangle { scene, features, instance, material, record, hit };
            surface.dress(&on, ray.direction, counters);
        }
        surface
    }

    /// Puts on what the corners of the triangle carry.
    fn dress(&mut self, on: &OnTriangle<R>, direction: R::Vec3, counters: &mut Counters) {
        let attributes = vertex_attributes(on.record, on.instance, on.hit.on.uv);
        let [red, green, blue, _] = attributes.color;
        self.bsdf.color = self.bsdf.color * R::Vec3::new(red, green, blue);
        if on.features.has(Feature::Textures) {
            let targets = (&mut self.bsdf, &mut self.emission);
            roles::apply_textures(on.scene, on.material, &attributes.uv, targets, counters);
        }
        let mut normal = self.place.normal;
        if let Some(smooth) = attributes.normal {
            let object_from_world = Affine::<R>::from_rows(&on.instance.object_from_world);
            normal = normal::smooth_normal(smooth, &object_from_world, normal);
        }
        let slot = roles::slot(on.scene, on.material, TEXTURE_ROLE_NORMAL)
            .filter(|_| on.features.has(Feature::NormalMaps));
        if let Some(slot) = slot {
            let at = (on.hit.on.slot, on.hit.on.uv);
            normal = normal::apply_normal_map(on.scene, on.instance, slot, at, normal, counters);
        }
        if attributes.normal.is_some() || slot.is_some() {
            self.shading_normal = normal::kept_valid::<R>(normal, self.place.normal, direction);
        }
    }

    /// The surface as seen against a ray.
    pub fn facing(&self, direction: R::Vec3) -> Geometry<R> {
        let wo = -direction;
        let front = wo.dot(self.place.normal) >= R::ZERO;
        let side = if front { R::ONE } else { -R::ONE };
        Geometry { wo, normal: self.shading_normal * side, geometric: self.place.normal * side, front }
    }
}

/// A hit on a triangle that has attributes.
struct OnTriangle<'a, R: Real> {
    scene: &'a FlatScene,
    features: FeatureSet,
    instance: &'a Instance,
    material: &'a MaterialRecord,
    record: &'a TriangleAttributes,
    hit: &'a Hit<R>,
}

/// Radiance that a surface sends out, the same in every direction and on both sides; textures come later.
fn emitted_radiance<R: Real>(
    features: FeatureSet,
    material: &MaterialRecord,
    counters: &mut Counters,
) -> R::Vec3 {
    if !features.has(Feature::Emission) || material.flags & MATERIAL_EMISSIVE == 0 {
        return R::Vec3::splat(R::ZERO);
    }
    counters[Counter::EmissionHits] += 1;
    R::Vec3::from_array(material.emission)
}

/// The light that a surface is in the table of lights; triangles say which of their material's.
fn light<R: Real>(scene: &FlatScene, hit: &Hit<R>, material: &MaterialRecord) -> u32 {
    let kind = scene.instances.as_slice()[hit.instance as usize].kind;
    if material.light_first == NONE || kind != KIND_MESH {
        return material.light_first;
    }
    material.light_first.wrapping_add(scene.triangles.as_slice()[hit.on.slot as usize].light)
}
