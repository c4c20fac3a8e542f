//! The bodies that a path is in: the list is that of a plain one, whatever is entered and left, and a surface knows what
//! it is to the path that meets it.
#![allow(clippy::unwrap_used)]
use glam::DVec3;
use luxel_cpu::PathState;
use luxel_cpu::bsdf::Bsdf;
use luxel_cpu::medium::{Media, carry_media, met_by};
use luxel_cpu::surface::{Place, Surface};
use luxel_flat::{
    Counter, Counters, Feature, FeatureSet, FlatScene, Heap, MATERIAL_DIELECTRIC, MATERIAL_LAMBERT,
    MATERIAL_NO_BORDER, MATERIAL_PRINCIPLED, MATERIAL_THIN, MaterialRecord, NONE,
};
use luxel_geom::Ray;
use luxel_testkit::Random;

/// Bodies 0 to 7 with indices 1, 1.25, 1.5, ….
fn scene() -> FlatScene {
    let ior = |slot: u8| 1.0 + 0.25 * f32::from(slot);
    let glass =
        |slot| MaterialRecord { kind: MATERIAL_DIELECTRIC, ior: ior(slot), ..MaterialRecord::default() };
    FlatScene { materials: Heap::from_records((0..8).map(glass).collect(), 1), ..FlatScene::default() }
}

fn nested() -> FeatureSet {
    FeatureSet::NONE.with(Feature::NestedMedia, true)
}

/// A path along +Z in these bodies, innermost first.
fn path_in(bodies: &[u32]) -> PathState<f64> {
    let mut media = [NONE; 4];
    media[..bodies.len()].copy_from_slice(bodies);
    let path = PathState::start(0, 0, Ray::new(DVec3::ZERO, DVec3::Z));
    PathState { media: Media(media), ..path }
}

/// A surface of a material in slot `body`; the path along +Z enters its body, or leaves it.
fn border(material: &MaterialRecord, body: u32, enters: bool) -> Surface<f64> {
    let normal = if enters { -DVec3::Z } else { DVec3::Z };
    Surface {
        place: Place { point: DVec3::Z, error: DVec3::ZERO, normal },
        shading_normal: normal,
        bsdf: Bsdf::of(material),
        emission: DVec3::ZERO,
        light: NONE,
        body,
    }
}

/// How a path meets the border of a body of [`scene`].
fn meet(features: FeatureSet, path: &PathState<f64>, body: u32, enters: bool) -> Surface<f64> {
    let scene = scene();
    let surface = border(&scene.materials.as_slice()[body as usize], body, enters);
    met_by(&scene, features, path, &surface)
}

/// The bodies of a path after it crossed what it met.
fn crossed(path: &PathState<f64>, met: &Surface<f64>, counters: &mut Counters) -> [u32; 4] {
    carry_media(path.media, met, &met.facing(DVec3::Z), DVec3::Z, counters).0
}

#[test]
fn the_list_is_a_plain_list_of_the_four_innermost() {
    let mut random = Random::new(7);
    let mut path = path_in(&[]);
    let mut plain: Vec<u32> = Vec::new();
    let mut counters = Counters::default();
    let (mut forgotten, mut not_entered, mut not_innermost) = (0u64, 0u64, 0u64);
    for _ in 0..20_000 {
        let (body, enters) = (random.below(8), random.below(9) < 5);
        let met = meet(nested(), &path, body, enters);
        let at = plain.iter().position(|&other| other == body);
        not_entered += u64::from(!enters && at.is_none());
        not_innermost += u64::from(!enters && at.is_some_and(|at| at > 0));
        let is_no_border = met.bsdf.kind == MATERIAL_NO_BORDER;
        assert_eq!(is_no_border, !enters && at.is_some_and(|at| at > 0));
        if let Some(at) = at.or(if enters || plain.is_empty() { None } else { Some(0) }) {
            plain.remove(at);
        }
        let around = plain.first().map_or(1.0, |&other| 1.0 + 0.25 * f64::from(other));
        assert!(is_no_border || met.bsdf.ior == (1.0 + 0.25 * f64::from(body)) / around);
        // Whoever stays on the side stays in the bodies.
        let back = carry_media(path.media, &met, &met.facing(DVec3::Z), -DVec3::Z, &mut counters);
        assert_eq!(back, path.media);
        if enters {
            plain.insert(0, body);
            forgotten += u64::from(plain.len() > 4);
            plain.truncate(4);
        }
        path.media = Media(crossed(&path, &met, &mut counters));
        assert_eq!(path.media, path_in(&plain).media);
    }
    assert_eq!(counters[Counter::MediaOverflows], forgotten);
    assert!(forgotten.min(not_entered).min(not_innermost) > 300, "{forgotten} {not_entered} {not_innermost}");
}

#[test]
fn absorption_alone_keeps_the_list_and_bends_nothing() {
    let absorbing = FeatureSet::NONE.with(Feature::Absorption, true);
    let path = path_in(&[3, 5]);
    let met = meet(absorbing, &path, 5, false);
    assert_eq!((met.bsdf.kind, met.bsdf.ior), (MATERIAL_DIELECTRIC, 2.25));
    assert_eq!(crossed(&path, &met, &mut Counters::default()), [3, NONE, NONE, NONE]);
    // Nobody asks: nothing is kept.
    let met = meet(FeatureSet::NONE, &path, 5, false);
    assert_eq!((met.bsdf.ior, met.body), (2.25, NONE));
}

#[test]
fn what_is_not_clear_and_sheets_bound_no_body() {
    let clear = MaterialRecord {
        kind: MATERIAL_PRINCIPLED,
        transmission: 0.5,
        ior: 1.5,
        ..MaterialRecord::default()
    };
    let materials = [
        (clear, 2),
        (MaterialRecord { flags: MATERIAL_THIN, ..clear }, NONE),
        (MaterialRecord { transmission: 0.0, ..clear }, NONE),
        (MaterialRecord { kind: MATERIAL_LAMBERT, ..clear }, NONE),
    ];
    let path = path_in(&[3, 2]);
    for (material, body) in materials {
        for enters in [false, true] {
            let met = met_by(&scene(), nested(), &path, &border(&material, 2, enters));
            assert_eq!(met.body, body);
            if body == NONE {
                assert_eq!((met.bsdf.kind, met.bsdf.ior), (material.kind, 1.5));
                assert_eq!(crossed(&path, &met, &mut Counters::default()), path.media.0);
            }
        }
    }
}
