//! Equirectangular maps and sRGB code values.
use glam::{DVec3, Vec3};
use luxel_geom::equirect::{direction_to_equirect, equirect_jacobian, equirect_to_direction};
use luxel_geom::srgb::{srgb_decode, srgb_decode_byte};
use luxel_testkit::Random;

#[test]
fn the_axes_are_where_the_document_says() {
    for (direction, place) in [
        (DVec3::NEG_Z, (0.5, 0.5)),
        (DVec3::X, (0.75, 0.5)),
        (DVec3::NEG_X, (0.25, 0.5)),
        (DVec3::Y, (0.5, 0.0)),
        (DVec3::NEG_Y, (0.5, 1.0)),
    ] {
        let (u, v) = direction_to_equirect::<f64>(direction);
        assert!(
            (v - place.1).abs() < 1e-15 && (direction.y != 0.0 || (u - place.0).abs() < 1e-15),
            "{u} {v}"
        );
        assert!((equirect_to_direction::<f64>(place.0, place.1) - direction).length() < 1e-15);
    }
    let (u, _) = direction_to_equirect::<f64>(DVec3::new(1e-9, 0.0, 1.0));
    assert!((u - 1.0).abs() < 1e-9);
}

#[test]
fn places_come_back() {
    let mut random = Random::new(1);
    for k in 0..100_000 {
        // A third of them within a ten-thousandth of a pole.
        let near = if k % 3 == 0 { 1e-4 } else { 1.0 };
        let d = (random.direction() * Vec3::new(near, 1.0, near)).normalize();
        let (u, v) = direction_to_equirect::<f32>(d);
        assert!((0.0..=1.0).contains(&u) && (0.0..=1.0).contains(&v), "{d}: {u} {v}");
        assert!((equirect_to_direction::<f32>(u, v) - d).length() < 2e-6, "{d}");
        let double = direction_to_equirect::<f64>(d.as_dvec3());
        let back: DVec3 = equirect_to_direction(double.0, double.1);
        assert!((back - d.as_dvec3().normalize()).length() < 1e-14, "{d}");
    }
}

#[test]
fn the_jacobian_is_that_of_the_map() {
    for k in 1..100 {
        let (u, v, step) = (0.3, f64::from(k) / 100.0, 1e-6);
        let at = |u, v| equirect_to_direction::<f64>(u, v);
        let (du, dv) = (at(u + step, v) - at(u - step, v), at(u, v + step) - at(u, v - step));
        let measured = du.cross(dv).length() / (4.0 * step * step);
        assert!((equirect_jacobian(v) / measured - 1.0).abs() < 1e-6, "{v}");
    }
    // The whole map is the whole sphere.
    let sphere: f64 = (0..1000).map(|k| equirect_jacobian((f64::from(k) + 0.5) / 1000.0) / 1000.0).sum();
    assert!((sphere - 4.0 * std::f64::consts::PI).abs() < 1e-4);
    assert_eq!(equirect_jacobian(1.0f32), 0.0);
}

#[test]
fn code_values_are_decoded() {
    assert_eq!((srgb_decode_byte::<f64>(0), srgb_decode_byte::<f32>(0)), (0.0, 0.0));
    assert!((srgb_decode_byte::<f64>(255) - 1.0).abs() < 1e-15);
    assert!((srgb_decode_byte::<f64>(10) - 10.0 / 255.0 / 12.92).abs() < 1e-15);
    // The standard's own example: half of the code range is 21.4 % of the light.
    assert!((srgb_decode(0.5f64) - 0.214_041_14).abs() < 1e-8);
    let mut last = -1.0;
    for byte in 0..=255 {
        let (single, double) = (srgb_decode_byte::<f32>(byte), srgb_decode_byte::<f64>(byte));
        // Three roundings of the base, to the power of 2.4, and one of the result: 9.4 u.
        assert!((f64::from(single) - double).abs() < 6e-7 * double + 1e-12, "{byte}");
        // Back by the inverse, which is written for encoding.
        let code =
            if double <= 0.003_130_8 { 12.92 * double } else { 1.055 * double.powf(1.0 / 2.4) - 0.055 };
        assert!((code * 255.0 - f64::from(byte)).abs() < 1e-4 && double > last, "{byte}: {code}");
        last = double;
    }
}
