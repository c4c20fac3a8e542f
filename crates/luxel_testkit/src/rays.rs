//! Rays that break tracers: through corners, in planes, from inside, with zeros of both signs.
use glam::Vec3;
use luxel_geom::Ray;

use crate::Random;

/// Random rays; origins in `[-reach, reach)³`, every other one aimed at a point of the cube, the rest anywhere.
pub fn random(seed: u32, count: u32, reach: f32) -> Vec<Ray<f32>> {
    let mut random = Random::new(seed);
    (0..count)
        .map(|i| {
            let origin = random.point(reach);
            let direction = if i % 2 == 0 { random.point(0.5 * reach) - origin } else { random.direction() };
            Ray::new(origin, direction)
        })
        .collect()
}

/// The 26 directions along axes, face diagonals and space diagonals.
pub fn lattice_directions() -> impl Iterator<Item = [i32; 3]> {
    let axis = |k: i32, axis: u32| k / 3i32.pow(axis) % 3 - 1;
    (0..27).map(move |k| [axis(k, 0), axis(k, 1), axis(k, 2)]).filter(|d| *d != [0; 3])
}

/// A direction of whole numbers, its zeros positive or negative.
pub fn direction(d: [i32; 3], negative_zeros: bool) -> Vec3 {
    let zero = if negative_zeros { -0.0 } else { 0.0 };
    Vec3::from(d.map(|c| if c == 0 { zero } else { c as f32 }))
}

/// T05: the six rays along the axes that pass exactly through a point, from `distance` away.
pub fn along_axes_through(point: Vec3, distance: f32, negative_zeros: bool) -> Vec<Ray<f32>> {
    let along = lattice_directions().filter(|d| d.iter().map(|c| c.abs()).sum::<i32>() == 1);
    let ray = |d: [i32; 3]| {
        let step = direction(d, false) * distance;
        Ray::new(point - step, direction(d, negative_zeros))
    };
    along.map(ray).collect()
}

/// T06, O05: rays along the 26 directions through each lattice point of `[-half, half]³ · spacing`, starting
/// outside the cube.
pub fn through_lattice(half: i32, spacing: f32, negative_zeros: bool) -> impl Iterator<Item = Ray<f32>> {
    let points = (-half..=half).flat_map(move |x| (-half..=half).map(move |y| [x, y]));
    let points = points.flat_map(move |[x, y]| (-half..=half).map(move |z| [x, y, z]));
    points.flat_map(move |point| {
        lattice_directions().map(move |d| {
            let at = |axis: usize| (point[axis] - (2 * half + 3) * d[axis]) as f32 * spacing;
            Ray::new(Vec3::new(at(0), at(1), at(2)), direction(d, negative_zeros))
        })
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn there_are_26_directions() {
        let all: Vec<[i32; 3]> = lattice_directions().collect();
        assert_eq!(all.len(), 26);
        assert!(all.iter().all(|d| all.contains(&d.map(|c| -c))));
    }

    #[test]
    fn zeros_carry_their_sign() {
        assert!(direction([0, 1, 0], true).x.is_sign_negative());
        assert!(direction([0, 1, 0], false).x.is_sign_positive());
    }

    #[test]
    fn lattice_rays_meet_their_point() {
        let rays: Vec<Ray<f32>> = through_lattice(1, 0.5, false).collect();
        assert_eq!(rays.len(), 27 * 26);
        assert!(rays[..26].iter().all(|ray| ray.at(2.5) == Vec3::splat(-0.5)));
    }
}
