//! What is tested in lanes says what the scalar code says, bit for bit.
use glam::Vec3;
use luxel_geom::sphere::QuadRay;
use luxel_geom::{Aabb, Exclude, PairRay, Ray, Real, SlabRay, Vector, sphere};
use luxel_testkit::Random;

/// A ray whose direction now and then lies in a plane of the axes, and whose interval ends anywhere.
fn any_ray(random: &mut Random) -> Ray<f32> {
    let mut direction = random.direction();
    if random.below(4) == 0 {
        direction[random.below(3) as usize] = if random.below(2) == 0 { 0.0 } else { -0.0 };
    }
    let mut ray = Ray::new(random.point(2.0).round(), direction);
    ray.t_max = random.between(0.0, 4.0);
    ray
}

/// A box with corners on a lattice, so that rays start on its planes.
fn any_box(random: &mut Random) -> Aabb<f32> {
    Aabb::around(random.point(2.0).round(), random.point(2.0).round())
}

fn as_real<R: Real>(ray: &Ray<f32>) -> SlabRay<R> {
    let vector = |v: Vec3| R::Vec3::from_vec3(v);
    SlabRay::new(&Ray {
        origin: vector(ray.origin),
        direction: vector(ray.direction),
        t_min: R::from_f32(ray.t_min),
        t_max: R::from_f32(ray.t_max),
    })
}

fn boxes_agree<R: Real>(ray: &Ray<f32>, boxes: [Aabb<f32>; 2]) -> [bool; 2] {
    let ray = as_real::<R>(ray);
    let corners = boxes.map(|b| [b.lo.to_array(), b.hi.to_array()]);
    let row = |corner: [f32; 3], link: f32| [corner[0], corner[1], corner[2], link];
    let (lo, hi) = (corners.map(|[lo, _]| row(lo, f32::NAN)), corners.map(|[_, hi]| row(hi, f32::MAX)));
    let pair = PairRay::new(&ray).test(lo, hi, ray.t_max);
    let is_hit = [0, 1].map(|i| pair.hits & (1 << i) != 0);
    for (i, [lo, hi]) in corners.into_iter().enumerate() {
        let bounds = Aabb::<R> { lo: R::Vec3::from_array(lo), hi: R::Vec3::from_array(hi) };
        let interval = bounds.interval(&ray);
        assert_eq!(is_hit[i], interval.overlaps(ray.t_min, ray.t_max), "{ray:?} {bounds:?}");
        assert_eq!(pair.enter[i], interval.enter.max(ray.t_min));
    }
    is_hit
}

#[test]
fn two_boxes_at_once() {
    let mut random = Random::new(1);
    let mut hits = 0;
    for _ in 0..100_000 {
        let (ray, boxes) = (any_ray(&mut random), [any_box(&mut random), any_box(&mut random)]);
        hits += boxes_agree::<f32>(&ray, boxes).into_iter().filter(|hit| *hit).count();
        boxes_agree::<f64>(&ray, boxes);
    }
    assert!((20_000..180_000).contains(&hits), "{hits}");
}

/// Every hit is among the candidates, and few others are.
fn spheres_agree<R: Real>(ray: &Ray<f32>, spheres: &[(Vec3, f32); 4]) -> (u32, u32) {
    let ray = as_real::<R>(ray);
    let axis = |k: usize| spheres.map(|(center, _)| center[k]);
    let candidates = QuadRay::new(&ray).can_meet([axis(0), axis(1), axis(2)], spheres.map(|(_, r)| r));
    let mut hits = 0;
    for (i, (center, radius)) in spheres.iter().enumerate() {
        let center = R::Vec3::from_vec3(*center);
        if sphere::intersect(&ray, center, R::from_f32(*radius), Exclude::Nothing).is_some() {
            assert!(candidates & (1 << i) != 0, "{ray:?} {center:?} {radius}");
            hits += 1;
        }
    }
    (hits, candidates.count_ones())
}

#[test]
fn four_spheres_at_once() {
    let mut random = Random::new(2);
    let (mut hits, mut candidates) = (0, 0);
    for _ in 0..100_000 {
        let spheres = [(); 4].map(|()| (random.point(2.0), random.between(0.01, 1.0)));
        let mut ray = any_ray(&mut random);
        // Half of the rays graze the first sphere to within a few roundings.
        if random.below(2) == 0 {
            let (center, radius) = spheres[0];
            let side = ray.direction.cross(random.direction()).normalize();
            ray.origin = center + side * radius - ray.direction;
        }
        ray.t_max = f32::FAR;
        let found = spheres_agree::<f32>(&ray, &spheres);
        (hits, candidates) = (hits + found.0, candidates + found.1);
        spheres_agree::<f64>(&ray, &spheres);
    }
    assert!(hits > 20_000 && candidates < hits + hits / 50, "{hits} {candidates}");
}
