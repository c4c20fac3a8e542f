//! Packed unit vectors: how far they come back, and that what is exact stays exact.
use glam::{DVec3, Vec3};
use luxel_geom::octahedral::{decode, decode_tangent, encode, encode_tangent};
use luxel_testkit::Random;
use luxel_testkit::rays::{direction, lattice_directions};

/// Angle between two unit vectors in degrees.
fn degrees(a: DVec3, b: DVec3) -> f64 {
    a.cross(b).length().atan2(a.dot(b)).to_degrees()
}

#[test]
fn directions_come_back() {
    let mut random = Random::new(1);
    let (mut worst, mut worst_tangent) = (0.0f64, 0.0f64);
    for k in 0..1_000_000 {
        let v = random.direction().normalize();
        let exact = v.as_dvec3().normalize();
        worst = worst.max(degrees(decode::<f64>(encode(v)), exact));
        let (tangent, sign) = decode_tangent::<f64>(encode_tangent(v, k % 2 == 1));
        worst_tangent = worst_tangent.max(degrees(tangent, exact));
        assert_eq!(sign, if k % 2 == 1 { -1.0 } else { 1.0 });
    }
    assert!(worst < 0.0025 && worst_tangent < 0.0045, "{worst} {worst_tangent}");
}

#[test]
fn axes_and_diagonals_are_exact() {
    for lattice in lattice_directions() {
        let v = direction(lattice, false).normalize();
        let back: Vec3 = decode::<f32>(encode(v));
        let zeros = lattice.iter().filter(|&&c| c == 0).count();
        // Eight diagonals of space have coordinates of thirds, which 16 bits only come close to.
        if zeros > 0 {
            assert!((back - v).length() < 2e-7 || zeros == 1 && (back - v).length() < 4e-5, "{v}: {back}");
        }
        if zeros == 2 {
            assert_eq!(back, v);
            assert_eq!(decode_tangent::<f32>(encode_tangent(v, true)), (v, -1.0));
        }
    }
}

#[test]
fn every_word_is_a_unit_vector() {
    let mut random = Random::new(2);
    for k in 0..1_000_000 {
        let corner = [0x8000u32, 0x7fff, 0, 0xffff, 0x4000, 0xc000][random.below(6) as usize];
        let word = if k % 2 == 0 { random.word() } else { corner | (corner.rotate_left(random.below(32))) };
        for v in [decode::<f32>(word), decode_tangent::<f32>(word).0] {
            assert!((v.length() - 1.0).abs() < 3e-7, "{word:x}: {v}");
        }
    }
}
