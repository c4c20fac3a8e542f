//! Materials to test, and the places where they are tested.
use luxel_cpu::bsdf::{self, Bsdf, BsdfSample, BsdfValue, Geometry};
use luxel_flat::{
    Counters, MATERIAL_DIELECTRIC, MATERIAL_LAMBERT, MATERIAL_METAL, MATERIAL_PRINCIPLED,
    MATERIAL_SEMI_SPECULAR, MATERIAL_THIN, MaterialRecord,
};
use luxel_geom::albedo::TABLES;
use luxel_geom::{Real, Vector};

/// What importers take for an infinite index (glTF's 0).
const INFINITE_INDEX: f32 = 1e4;

/// White, with glTF's defaults.
pub(crate) fn white(kind: u32) -> MaterialRecord {
    MaterialRecord {
        kind,
        color: [1.0; 3],
        specular: 1.0,
        specular_color: [1.0; 3],
        ior: 1.5,
        ..MaterialRecord::default()
    }
}

pub(crate) fn principled(roughness: f32) -> MaterialRecord {
    MaterialRecord { roughness, ..white(MATERIAL_PRINCIPLED) }
}

pub(crate) fn metal(roughness: f32) -> MaterialRecord {
    MaterialRecord { metallic: 1.0, ..principled(roughness) }
}

pub(crate) fn glass(roughness: f32, ior: f32) -> MaterialRecord {
    MaterialRecord { transmission: 1.0, ior, ..principled(roughness) }
}

/// Paint on half of a clear body.
fn half_clear(roughness: f32, ior: f32) -> MaterialRecord {
    MaterialRecord { transmission: 0.5, ..glass(roughness, ior) }
}

fn opaque(roughness: f32, ior: f32) -> MaterialRecord {
    MaterialRecord { ior, ..principled(roughness) }
}

fn tinted(specular_color: [f32; 3], base: MaterialRecord) -> MaterialRecord {
    MaterialRecord { specular_color, ..base }
}

pub(crate) fn thin(roughness: f32) -> MaterialRecord {
    MaterialRecord { flags: MATERIAL_THIN, ..glass(roughness, 1.5) }
}

pub(crate) fn coated(base: MaterialRecord, clearcoat: f32, clearcoat_roughness: f32) -> MaterialRecord {
    MaterialRecord { clearcoat, clearcoat_roughness, ..base }
}

/// Everything at once, in colour.
pub(crate) fn mixed(roughness: f32) -> MaterialRecord {
    MaterialRecord {
        color: [0.9, 0.5, 0.2],
        metallic: 0.3,
        transmission: 0.4,
        specular: 0.8,
        specular_color: [1.0, 0.7, 0.4],
        ..coated(principled(roughness), 0.6, 0.5 * roughness)
    }
}

/// Materials that keep all light, by name; `roughness` is that of whatever they have.
pub(crate) fn lossless(roughness: f32) -> Vec<(&'static str, MaterialRecord)> {
    vec![
        ("lambert", white(MATERIAL_LAMBERT)),
        ("mirror", white(MATERIAL_METAL)),
        ("dielectric", white(MATERIAL_DIELECTRIC)),
        ("semi-specular", MaterialRecord { roughness, ..white(MATERIAL_SEMI_SPECULAR) }),
        ("principled", principled(roughness)),
        ("metal", metal(roughness)),
        ("half metal", MaterialRecord { metallic: 0.5, ..principled(roughness) }),
        ("no reflection", MaterialRecord { specular: 0.0, ..principled(roughness) }),
        ("tinted reflection", tinted([1.0, 0.5, 0.0], opaque(roughness, 1.5))),
        ("stronger reflection", tinted([2.0, 5.0, 30.0], opaque(roughness, 1.5))),
        ("tinted reflection of index 10", tinted([1.0, 0.5, 0.0], opaque(roughness, 10.0))),
        ("glass", glass(roughness, 1.5)),
        ("water", glass(roughness, 1.33)),
        ("diamond", glass(roughness, 2.4)),
        ("index 1.05", opaque(roughness, 1.05)),
        ("index 3", opaque(roughness, 3.0)),
        ("index 10", opaque(roughness, 10.0)),
        ("infinite index", opaque(roughness, INFINITE_INDEX)),
        ("glass of index 1.002", glass(roughness, 1.002)),
        ("glass of index 1.01", glass(roughness, 1.01)),
        ("glass of index 1.05", glass(roughness, 1.05)),
        ("glass of index 3", glass(roughness, 3.0)),
        ("glass of index 10", glass(roughness, 10.0)),
        ("glass of infinite index", glass(roughness, INFINITE_INDEX)),
        ("thin glass", thin(roughness)),
        ("glass without reflection", MaterialRecord { specular: 0.0, ..glass(roughness, 1.5) }),
        ("weak glass", tinted([1.0, 0.5, 0.0], MaterialRecord { specular: 0.5, ..glass(roughness, 1.5) })),
        ("tinted glass of index 10", tinted([1.0, 0.5, 0.0], glass(roughness, 10.0))),
        ("glass of stronger reflection", tinted([2.0, 5.0, 30.0], glass(roughness, 1.33))),
        ("half clear", half_clear(roughness, 1.5)),
        ("half clear of index 1.05", half_clear(roughness, 1.05)),
        ("half clear in what is denser", half_clear(roughness, 0.8)),
        ("weak thin glass", tinted([1.0, 0.5, 0.0], MaterialRecord { specular: 0.5, ..thin(roughness) })),
    ]
}

/// Materials that may lose light, by name.
pub(crate) fn layered(roughness: f32) -> Vec<(&'static str, MaterialRecord)> {
    vec![
        ("coated", coated(principled(roughness), 1.0, 0.0)),
        ("rough coat", coated(principled(0.3), 1.0, roughness)),
        ("half a coat", coated(principled(roughness), 0.5, 0.4)),
        ("coated metal", coated(metal(roughness), 1.0, 0.2)),
        ("coated glass", coated(glass(roughness, 1.5), 1.0, 0.3)),
        ("coated thin", coated(thin(roughness), 1.0, 0.3)),
        ("coated half clear", coated(half_clear(roughness, 1.5), 1.0, 0.3)),
        ("mixed", mixed(roughness)),
        ("white mixed", MaterialRecord { color: [1.0; 3], ..mixed(roughness) }),
    ]
}

/// A place where the light arrives under a cosine; `front` tells from which side.
pub(crate) fn geometry<R: Real>(cos: f64, front: bool) -> Geometry<R> {
    let sin = (1.0 - cos * cos).sqrt();
    let v = |x: f64, y: f64, z: f64| R::Vec3::new(R::from_f64(x), R::from_f64(y), R::from_f64(z));
    let normal = v(0.0, 0.0, 1.0);
    Geometry { wo: v(sin * 0.6, sin * 0.8, cos), normal, geometric: normal, front }
}

pub(crate) fn sample<R: Real>(
    record: &MaterialRecord,
    geometry: &Geometry<R>,
    u: [R; 3],
) -> Option<BsdfSample<R>> {
    bsdf::sample(&Bsdf::of(record), geometry, u, &TABLES, &mut Counters::default())
}

pub(crate) fn evaluate<R: Real>(
    record: &MaterialRecord,
    geometry: &Geometry<R>,
    wi: R::Vec3,
) -> BsdfValue<R> {
    bsdf::evaluate(&Bsdf::of(record), geometry, wi, &TABLES)
}

/// Random numbers.
pub(crate) struct Numbers(u32);

impl Numbers {
    pub(crate) fn new(seed: u32) -> Self {
        Self(seed << 24)
    }

    /// Three numbers in [0, 1).
    pub(crate) fn three(&mut self) -> [f32; 3] {
        self.0 += 1;
        let [a, b, c, _] = luxel_geom::rng::uniform4::<f32>(self.0, 0, 0, 0);
        [a, b, c]
    }

    /// A unit vector, uniform over the sphere.
    pub(crate) fn direction(&mut self) -> glam::DVec3 {
        let [a, b, _] = self.three();
        luxel_geom::warp::uniform_sphere(f64::from(a), f64::from(b))
    }
}
