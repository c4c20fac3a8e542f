//! Shading normals: none mirrors a view into the surface, valid ones stay, and the change is continuous.
use glam::{DVec3, Vec3};
use luxel_geom::normal_guard::valid_shading_normal;
use luxel_geom::optics::reflect;
use luxel_testkit::Random;

/// A view at a cosine from a normal.
fn view(random: &mut Random, ng: Vec3, cos: f32) -> Vec3 {
    let side = ng.cross(random.direction()).normalize();
    (side * (1.0 - cos * cos).sqrt() + ng * cos).normalize()
}

#[test]
fn l08_no_view_is_mirrored_into_the_surface() {
    let mut random = Random::new(1);
    let mut bent = 0;
    for k in 0..1_000_000 {
        let ng = random.direction().normalize();
        let cos = [1e-7, 0.0, 1e-3, 1.0, random.uniform()][k % 5];
        let wo = view(&mut random, ng, cos);
        let ns = (ng + random.direction() * random.uniform() * 2.0).normalize();
        let n = valid_shading_normal::<f32>(ng, ns, wo);
        assert!((n.length() - 1.0).abs() < 1e-6, "{ng} {ns} {wo}: {n}");
        if wo.dot(ng) > 0.0 {
            // The mirror about the geometric normal is valid but for the rounding of the normal's own length.
            let above = reflect::<f32>(wo, n).dot(ng);
            assert!(above > if n == ng { -3e-7 } else { 0.0 }, "{ng} {ns} {wo}: {n} {above}");
        } else {
            assert_eq!(n, ng);
        }
        bent += u32::from(n != ng && n != ns);
    }
    assert!(bent > 100_000, "{bent}");
}

#[test]
fn valid_normals_are_not_touched() {
    let mut random = Random::new(2);
    for _ in 0..100_000 {
        let ng = random.direction().normalize();
        let cos = random.between(0.02, 1.0);
        let wo = view(&mut random, ng, cos);
        let ns = (ng + random.direction() * 0.5).normalize();
        if reflect::<f32>(wo, ns).dot(ng) > 0.0101 && wo.dot(ns) > 0.0 {
            assert_eq!(valid_shading_normal::<f32>(ng, ns, wo), ns);
        }
    }
}

#[test]
fn a_bent_normal_mirrors_to_the_least_cosine() {
    let mut random = Random::new(3);
    let mut bent = 0;
    for _ in 0..100_000 {
        let ng = random.direction().as_dvec3().normalize();
        let wo = random.direction().as_dvec3().normalize();
        let wo = if wo.dot(ng) < 0.0 { -wo } else { wo };
        let ns = (ng + random.direction().as_dvec3() * 0.9).normalize();
        let n = valid_shading_normal::<f64>(ng, ns, wo);
        if n == ns || n == ng {
            continue;
        }
        bent += 1;
        let cos = reflect::<f64>(wo, n).dot(ng);
        assert!((cos - (0.9 * wo.dot(ng)).min(0.01)).abs() < 1e-9, "{cos}");
    }
    assert!(bent > 1000, "{bent}");
}

#[test]
fn bending_starts_continuously() {
    let (ng, wo) = (DVec3::Z, DVec3::new(0.8, 0.0, 0.6));
    let at = |tilt: f64| valid_shading_normal::<f64>(ng, DVec3::new(tilt.sin(), 0.0, tilt.cos()), wo);
    let step = 1e-4;
    for k in -7000..7000 {
        let tilt = f64::from(k) * step;
        assert!((at(tilt + step) - at(tilt)).length() < 2.0 * step, "{tilt}");
    }
}

/// Seen from the side to which it falls off or from the other, a steep face of a normal map leans its own way.
#[test]
fn a_steep_normal_leans_the_way_that_it_did() {
    let mut random = Random::new(4);
    for _ in 0..100_000 {
        let ng = random.direction().normalize();
        let (high, steep) = (random.between(0.87, 1.0), random.between(-0.2, 0.1));
        let wo = view(&mut random, ng, high);
        let ns = view(&mut random, ng, steep);
        let n = valid_shading_normal::<f32>(ng, ns, wo);
        let (level, before) = (n - ng * n.dot(ng), ns - ng * ns.dot(ng));
        assert!(level.dot(before) > 0.3, "{ng} {ns} {wo}: {n}");
    }
}
