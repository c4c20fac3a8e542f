//! Inputs that break kernels: zeros of both signs, whole and half numbers, planes in common, extreme sizes.
use glam::Vec3;
use luxel_testkit::Random;
use luxel_testkit::rays::{direction, lattice_directions};

use crate::judge::{Input, U};

/// A number of any of the hard kinds.
pub(crate) fn number(random: &mut Random) -> f32 {
    let sign = if random.below(2) == 0 { 1.0 } else { -1.0 };
    sign * match random.below(6) {
        0 => 0.0,
        1 => random.below(5) as f32,
        2 => 0.5 * random.below(9) as f32,
        3 => random.log_between(1e-6, 1e6),
        _ => random.uniform() * 4.0,
    }
}

/// A point of such numbers.
pub(crate) fn point(random: &mut Random) -> Vec3 {
    Vec3::new(number(random), number(random), number(random))
}

/// A size that is not zero.
pub(crate) fn size(random: &mut Random) -> f32 {
    if random.below(2) == 0 { 0.5 * (1 + random.below(8)) as f32 } else { random.log_between(1e-3, 1e3) }
}

/// A unit vector, every third of them along an axis, in a coordinate plane or in a diagonal.
pub(crate) fn unit(random: &mut Random) -> Vec3 {
    if random.below(3) > 0 {
        return random.direction();
    }
    let lattice = lattice_directions().nth(random.below(26) as usize).unwrap();
    direction(lattice, random.below(2) == 0).normalize()
}

/// An origin and a direction: half of the rays aim at a target (their length is what it is), the others anywhere.
pub(crate) fn ray(random: &mut Random, target: Vec3) -> (Vec3, Vec3) {
    match random.below(4) {
        0 => (point(random), unit(random)),
        1 => {
            let along = unit(random);
            (target - along * size(random), along)
        }
        _ => {
            let origin = point(random);
            let aim = target - origin;
            (origin, if aim == Vec3::ZERO { Vec3::X } else { aim })
        }
    }
}

/// An origin beside a target, ahead of it or behind by some of its roundings, and a direction.
pub(crate) fn ray_from_beside(random: &mut Random, target: Vec3) -> (Vec3, Vec3) {
    let (along, away) = (unit(random), random.log_between(U, 1e4 * U) * target.abs().max_element());
    let away = if random.below(2) == 0 { away } else { -away };
    (target - along * away, along)
}

/// Four vectors, each with a fourth number.
pub(crate) fn input(vectors: [(Vec3, f32); 4]) -> Input {
    let [a, b, c, d] = vectors.map(|(v, w)| v.extend(w).to_array());
    Input { a, b, c, d, code: [0; 4] }
}
