//! Error bounds of maps and of chains of operations, against double precision.
use glam::{DAffine3, DQuat, DVec3, EulerRot, Vec3};
use luxel_geom::{Aabb, Affine, Real};
use proptest::prelude::*;

/// γ(n) = n·u / (1 − n·u) in double precision.
fn exact_gamma(n: u32) -> f64 {
    let nu = f64::from(n) / f64::from(1 << 24);
    nu / (1.0 - nu)
}

#[test]
fn gamma_is_its_definition() {
    assert_eq!(f32::UNIT_ROUNDOFF, 0.5 * f32::EPSILON);
    assert_eq!(f64::UNIT_ROUNDOFF, 0.5 * f64::EPSILON);
    for n in 0..64 {
        assert!((f64::from(<f32 as Real>::gamma(n)) - exact_gamma(n)).abs() <= 1e-6 * exact_gamma(n), "{n}");
    }
}

#[test]
fn gamma_bounds_a_chain_of_products() {
    let factors = [1.1f32, 0.9, 1.3, 0.7, 1.7, 0.6, 1.01, 0.99];
    let (mut product, mut exact) = (1.0f32, 1.0f64);
    for (n, factor) in (0u32..).zip(factors.into_iter().cycle().take(200)) {
        product *= factor;
        exact *= f64::from(factor);
        let error = (f64::from(product) / exact - 1.0).abs();
        assert!(error <= exact_gamma(n + 1), "{n}: {error:e}");
    }
}

fn point(reach: f64) -> impl Strategy<Value = DVec3> {
    [-reach..reach, -reach..reach, -reach..reach].prop_map(DVec3::from)
}

fn map() -> impl Strategy<Value = DAffine3> {
    let angle = || -3.0..3.0;
    ([-3.0..3.0, -3.0..3.0, -3.0..3.0], angle(), angle(), angle(), point(100.0)).prop_map(
        |(scale, a, b, c, to)| {
            let scale = DVec3::from(scale).exp2();
            DAffine3::from_scale_rotation_translation(scale, DQuat::from_euler(EulerRot::XYZ, a, b, c), to)
        },
    )
}

/// The map that a single-precision one stands for, as it is stored.
fn as_stored(map: &Affine<f32>) -> Affine<f64> {
    Affine::from_rows(&map.to_rows())
}

fn is_within(a: Vec3, b: DVec3, bound: Vec3) -> bool {
    (a.as_dvec3() - b).abs().cmple(bound.as_dvec3() * (1.0 + 1e-6)).all()
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 2000, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn point_error_bounds_the_rounding(map in map(), p in point(100.0)) {
        let (map, p) = (Affine::<f32>::from_daffine(&map), p.as_vec3());
        let exact = as_stored(&map).point(p.as_dvec3());
        prop_assert!(is_within(map.point(p), exact, map.point_error(p, Vec3::ZERO)));
    }

    #[test]
    fn point_error_carries_the_error_of_the_point(map in map(), p in point(100.0), off in point(1.0), size in 0.0..1e-3f32) {
        let (map, p) = (Affine::<f32>::from_daffine(&map), p.as_vec3());
        let error = Vec3::splat(size);
        // The point that was meant lies anywhere within the error.
        let meant = p.as_dvec3() + off * f64::from(size);
        let exact = as_stored(&map).point(meant);
        prop_assert!(is_within(map.point(p), exact, map.point_error(p, error)));
    }

    #[test]
    fn a_mapped_box_holds_every_mapped_point(map in map(), a in point(10.0), b in point(10.0),
                                             weights in [0.0..=1.0f32, 0.0..=1.0, 0.0..=1.0]) {
        let map = Affine::<f32>::from_daffine(&map);
        let bounds = Aabb::<f32>::around(a.as_vec3(), b.as_vec3());
        let image = map.bounds(&bounds);
        let corners = (0..8u32).map(|i| Vec3::from([0, 1, 2].map(|k| (i >> k & 1) as f32)));
        for at in corners.chain([Vec3::from(weights)]) {
            let p = bounds.lo + (bounds.hi - bounds.lo) * at;
            let exact = as_stored(&map).point(p.as_dvec3());
            let (lo, hi) = (image.lo.as_dvec3(), image.hi.as_dvec3());
            prop_assert!(exact.cmpge(lo).all() && exact.cmple(hi).all(), "{exact} {image:?}");
            // Not wider than the linear part makes it, up to rounding.
            let reach = map.abs_vector(bounds.extent());
            prop_assert!((image.extent() - reach).max_element() <= 1e-4 * (1.0 + reach.max_element()));
        }
    }

    #[test]
    fn normals_stay_perpendicular(map in map(), s in point(1.0), t in point(1.0)) {
        let n = s.cross(t);
        prop_assume!(n.length() > 1e-2);
        let inverse = Affine::<f64>::from_daffine(&map.inverse());
        let mapped = inverse.normal_by_transpose(n);
        for tangent in [s, t] {
            let along = map.transform_vector3(tangent);
            prop_assert!(mapped.dot(along).abs() <= 1e-10 * mapped.length() * along.length().max(1e-3));
        }
    }

    #[test]
    fn rows_survive_storage(map in map()) {
        let single = Affine::<f32>::from_daffine(&map);
        prop_assert_eq!(Affine::<f32>::from_rows(&single.to_rows()), single);
        let p = DVec3::new(1.0, -2.0, 3.0);
        let double = Affine::<f64>::from_daffine(&map).point(p);
        prop_assert!((double - map.transform_point3(p)).length() <= 1e-12 * (1.0 + double.length()));
    }
}
