//! The slab test: never misses what the exact answer touches, and grows with its box (robustness.md T06–T08).
use glam::{DVec3, Vec3};
use luxel_geom::{Aabb, Interval, Ray, SlabRay};
use luxel_testkit::{Random, rays};
use proptest::prelude::*;

const FAR: f32 = 1e6;

/// Whether a ray meets a closed box, in whole numbers: all parameters are whole for directions of −1, 0 and 1.
fn touches(point: [i32; 3], direction: [i32; 3], lo: [i32; 3], hi: [i32; 3]) -> bool {
    let (mut enter, mut exit) = (0, i32::MAX);
    for k in 0..3 {
        let (a, b) = (lo[k] - point[k], hi[k] - point[k]);
        if direction[k] == 0 {
            if a > 0 || b < 0 {
                return false;
            }
        } else {
            enter = enter.max((a * direction[k]).min(b * direction[k]));
            exit = exit.min((a * direction[k]).max(b * direction[k]));
        }
    }
    enter <= exit
}

fn corner(p: [i32; 3]) -> Vec3 {
    Vec3::from(p.map(|c| c as f32))
}

#[test]
fn t06_lattice_rays_against_whole_numbers() {
    let boxes = [
        ([16, 16, 16], [17, 17, 17]),
        ([0, 0, 0], [32, 32, 32]),
        ([8, 0, 31], [24, 1, 32]),
        ([5, 9, 3], [6, 9, 30]),
    ];
    let exact: Vec<Aabb<f32>> =
        boxes.iter().map(|&(lo, hi)| Aabb { lo: corner(lo), hi: corner(hi) }).collect();
    let stored: Vec<Aabb<f32>> = exact.iter().map(Aabb::outset).collect();
    let lattice = (0..33i32.pow(3)).map(|i| [i % 33, i / 33 % 33, i / (33 * 33)]);
    for (point, direction) in lattice.flat_map(|p| rays::lattice_directions().map(move |d| (p, d))) {
        for negative_zeros in [false, true] {
            let along = rays::direction(direction, negative_zeros);
            let ray = SlabRay::new(&Ray::<f32>::new(corner(point), along));
            for (bounds, &(lo, hi)) in stored.iter().zip(&boxes) {
                let overlaps = bounds.interval(&ray).overlaps(0.0, FAR);
                assert_eq!(
                    overlaps,
                    touches(point, direction, lo, hi),
                    "{point:?} {direction:?} {lo:?} {hi:?}"
                );
            }
        }
    }
}

/// The slab test in double precision, which decides these rays to 1e-15.
fn touches_in_doubles(bounds: &Aabb<f32>, ray: &Ray<f32>) -> bool {
    let (origin, inverse) = (ray.origin.as_dvec3(), DVec3::ONE / ray.direction.as_dvec3());
    let (t0, t1) = ((bounds.lo.as_dvec3() - origin) * inverse, (bounds.hi.as_dvec3() - origin) * inverse);
    t0.min(t1).max_element().max(0.0) <= t0.max(t1).min_element()
}

/// The same without outset and padding: what rays slip past.
fn touches_unpadded(bounds: &Aabb<f32>, ray: &SlabRay<f32>) -> bool {
    let (t0, t1) =
        ((bounds.lo - ray.origin) * ray.inv_direction, (bounds.hi - ray.origin) * ray.inv_direction);
    t0.min(t1).max_element().max(0.0) <= t0.max(t1).min_element()
}

#[test]
fn t07_rays_to_corners_enter_the_box() {
    let mut random = Random::new(7);
    let (mut touched, mut slipped) = (0, 0);
    for i in 0..1_000_000 {
        let size = if i % 2 == 0 { 1.0 } else { 1e-3 };
        let distance = if i % 4 < 2 { 10.0 } else { 1000.0 };
        let middle = random.point(1.0);
        let [a, b, c] = [(); 3].map(|()| middle + random.point(size));
        let bounds = Aabb::<f32>::around(a, b).union(&Aabb::around(c, c));
        let pick = random.below(8);
        let at = |k: usize| if pick >> k & 1 == 0 { bounds.lo[k] } else { bounds.hi[k] };
        let origin = middle + random.direction() * distance;
        let ray: Ray<f32> = Ray::new(origin, Vec3::new(at(0), at(1), at(2)) - origin);
        if touches_in_doubles(&bounds, &ray) {
            let slab_ray = SlabRay::new(&ray);
            assert!(bounds.outset().interval(&slab_ray).overlaps(0.0, FAR), "{bounds:?} {ray:?}");
            touched += 1;
            slipped += u32::from(!touches_unpadded(&bounds, &slab_ray));
        }
    }
    assert!(touched > 100_000, "{touched}");
    assert!(slipped * 100 > touched, "the rays are too easy: {slipped} of {touched}");
}

#[test]
fn t08_directions_with_tiny_components_stay_finite() {
    let bounds = Aabb { lo: Vec3::splat(-1.0), hi: Vec3::splat(1.0) }.outset();
    let tiny = [0.0, -0.0, 1e-18, 1e-30, -1e-38, f32::from_bits(1)];
    for (y, z) in tiny.into_iter().flat_map(|y| tiny.map(move |z| (y, z))) {
        for (origin, hits) in [(Vec3::new(-4.0, 1.0, 0.5), true), (Vec3::new(-4.0, 1.1, 0.5), false)] {
            let ray = SlabRay::new(&Ray::<f32>::new(origin, Vec3::new(1.0, y, z)));
            let Interval { enter, exit } = bounds.interval(&ray);
            assert!(enter.is_finite() && exit.is_finite(), "{y:e} {z:e}: {enter} {exit}");
            assert_eq!(bounds.interval(&ray).overlaps(0.0, FAR), hits, "{y:e} {z:e}");
        }
    }
}

fn vector(reach: f32) -> impl Strategy<Value = Vec3> {
    let one = move || prop_oneof![-reach..reach, Just(0.0), Just(-0.0), -1e-20f32..1e-20];
    (one(), one(), one()).prop_map(|(x, y, z)| Vec3::new(x, y, z))
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 2000, failure_persistence: None, ..ProptestConfig::default() })]

    /// The invariant that "accelerated equals brute force" rests on.
    #[test]
    fn a_larger_box_has_a_larger_interval(a in vector(8.0), b in vector(8.0), c in vector(20.0),
                                          origin in vector(20.0), direction in vector(1.0)) {
        let ray = Ray::<f32>::new(origin, direction);
        prop_assume!(ray.is_valid());
        let ray = SlabRay::new(&ray);
        let small = Aabb::around(a, b);
        let large = small.union(&Aabb::around(c, c));
        prop_assert!(large.contains(&small) && small.outset().contains(&small));
        let (inner, outer) = (small.interval(&ray), large.interval(&ray));
        prop_assert!(outer.enter <= inner.enter && outer.exit >= inner.exit, "{inner:?} {outer:?}");
    }

    #[test]
    fn the_empty_box_is_neutral(a in vector(8.0), b in vector(8.0)) {
        let bounds = Aabb::<f32>::around(a, b);
        prop_assert_eq!(bounds.union(&Aabb::empty()), bounds);
        prop_assert!(bounds.contains(&Aabb::empty()) && Aabb::<f32>::empty().is_empty());
    }
}
