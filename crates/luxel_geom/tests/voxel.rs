//! The voxel kernel by itself: faces, starts inside and on the border, and leaving (robustness.md V08).
use glam::{DVec3, Vec3};
use luxel_geom::voxel::{self, VoxelHit};
use luxel_geom::{Exclude, Ray, SlabRay, spawn};
use luxel_testkit::{Random, rays};

fn hit(ray: &Ray<f32>, cell: [u32; 3], exclude: Exclude) -> Option<VoxelHit<f32>> {
    voxel::intersect(&SlabRay::new(ray), cell, exclude)
}

fn center(cell: [u32; 3]) -> Vec3 {
    Vec3::from(cell.map(|c| c as f32 + 0.5))
}

/// A cell near the origin, in the middle, or in the last corner of the largest grid.
fn random_cell(random: &mut Random) -> [u32; 3] {
    let edge = [4, 256, 2048][random.below(3) as usize];
    [(); 3].map(|()| random.below(edge))
}

#[test]
fn each_face_is_met_from_outside_and_from_inside() {
    let cell = [3, 0, 2047];
    for face in 0..6 {
        let normal = voxel::normal::<f32>(face);
        let from_outside = Ray::new(center(cell) + normal * 4.5, -normal);
        let entry = hit(&from_outside, cell, Exclude::Nothing).unwrap();
        assert_eq!((entry.face, (entry.t - 4.0).abs() < 1e-3), (face, true), "{entry:?}");
        let exit = hit(&Ray::new(center(cell), normal), cell, Exclude::Nothing).unwrap();
        assert_eq!((exit.face, (exit.t - 0.5).abs() < 1e-3), (face, true), "{exit:?}");
    }
}

/// What a line meets first, in double precision.
struct Exact {
    enter: f64,
    face: u32,
    /// Length of the line inside the cell, negative for a miss.
    inside: f64,
    /// Distance along the line from the plane that is met next to last.
    lead: f64,
}

fn exact(ray: &Ray<f32>, cell: [u32; 3]) -> Exact {
    let lo = DVec3::from(cell.map(f64::from));
    let (origin, direction) = (ray.origin.as_dvec3(), ray.direction.as_dvec3());
    let (t0, t1) = ((lo - origin) / direction, (lo + DVec3::ONE - origin) / direction);
    let (near, far) = (t0.min(t1), t0.max(t1));
    let axis = (0..3).fold(0, |best, k| if near[k] > near[best] { k } else { best });
    let enter = near[axis];
    let before = near[(axis + 1) % 3].max(near[(axis + 2) % 3]);
    Exact {
        enter,
        face: 2 * axis as u32 + u32::from(direction[axis] < 0.0),
        inside: (far.min_element() - enter) * direction.length(),
        lead: (enter - before) * direction.length(),
    }
}

#[test]
fn faces_and_parameters_equal_double_precision() {
    let mut random = Random::new(1);
    let mut hits = 0;
    for _ in 0..200_000 {
        let cell = random_cell(&mut random);
        let origin = center(cell) + random.direction() * random.log_between(2.0, 100.0);
        let ray: Ray<f32> = Ray::new(origin, center(cell) + random.point(0.8) - origin);
        let Exact { enter, face, inside, lead } = exact(&ray, cell);
        // Rays that pass an edge this closely may go either way.
        if inside.abs() < 0.05 || lead < 0.05 {
            continue;
        }
        let found = hit(&ray, cell, Exclude::Nothing);
        assert_eq!(found.is_some(), inside > 0.0, "{ray:?} {cell:?}");
        if let Some(found) = found {
            hits += 1;
            assert_eq!(found.face, face, "{ray:?} {cell:?}");
            // The plane is off by its outset, and by what `plane - origin` and the product are rounded.
            let plane_off =
                (f64::from(found.t) - enter).abs() * f64::from(ray.direction[face as usize / 2].abs());
            let size = f64::from(ray.origin.abs().max_element() + ray.direction.length());
            assert!(plane_off < 1e-6 * size, "{found:?} {enter} {plane_off:e}");
        }
    }
    assert!(hits > 50_000, "{hits}");
}

#[test]
fn v08_a_ray_from_inside_meets_the_far_side() {
    let mut random = Random::new(8);
    for _ in 0..100_000 {
        let cell = random_cell(&mut random);
        let ray: Ray<f32> = Ray::new(center(cell) + random.point(0.499), random.direction());
        let exit = hit(&ray, cell, Exclude::Nothing).unwrap();
        assert!(exit.t > 0.0 && exit.t < 2.0, "{ray:?} {exit:?}");
        assert!(voxel::normal::<f32>(exit.face).dot(ray.direction) > 0.0, "{ray:?} {exit:?}");
    }
}

#[test]
fn v08_a_ray_from_the_border_meets_a_voxel_that_it_enters() {
    let cell = [5, 6, 7];
    let border =
        rays::lattice_directions().map(|side| (side, center(cell) + 0.5 * rays::direction(side, false)));
    for (side, origin) in border {
        for direction in rays::lattice_directions() {
            let inward = (0..3).all(|k| side[k] == 0 || side[k] == -direction[k]);
            let outward = (0..3).any(|k| side[k] != 0 && side[k] == direction[k]);
            for negative_zeros in [false, true] {
                let ray = Ray::<f32>::new(origin, rays::direction(direction, negative_zeros));
                let found = hit(&ray, cell, Exclude::Nothing);
                assert!(!inward || found.is_some(), "{side:?} {direction:?}");
                // Outward a rounding is left of the voxel at most.
                assert!(!outward || found.is_none_or(|h| h.t < 1e-5), "{side:?} {direction:?} {found:?}");
                assert!(found.is_none_or(|h| h.t > 0.0));
            }
        }
    }
}

/// A ray from a point of a face of a cell, to the outer side (`side` = 1) or the inner side (−1).
fn spawned(random: &mut Random, cell: [u32; 3], face: u32, side: f32) -> Ray<f32> {
    let normal = voxel::normal::<f32>(face);
    let on_face = center(cell) + 0.5 * normal + random.point(0.49) * (Vec3::ONE - normal.abs());
    let (point, error) = voxel::surface::<f32>(on_face, cell, face);
    let any = random.direction();
    let direction = any * (side * any.dot(normal)).signum();
    Ray::new(spawn::offset_origin::<f32>(point, error, normal, direction), direction)
}

#[test]
fn a_ray_that_leaves_a_voxel_starts_outside_its_neighbours() {
    let mut random = Random::new(2);
    for _ in 0..200_000 {
        let cell = random_cell(&mut random).map(|c| c.max(1));
        let face = random.below(6);
        let ray = spawned(&mut random, cell, face, 1.0);
        assert_eq!(hit(&ray, cell, Exclude::Leaving), None);
        assert_eq!(hit(&ray, cell, Exclude::Nothing), None, "{cell:?} {face} {ray:?}");
        // Those beside it, whose faces lie in the same plane.
        let axis = face as usize / 2;
        for beside in (0..3).filter(|k| *k != axis) {
            let mut neighbour = cell;
            neighbour[beside] += 1;
            let bounds = voxel::bounds::<f32>(neighbour, 1);
            let outside = ray.origin[axis] < bounds.lo[axis] || ray.origin[axis] > bounds.hi[axis];
            assert!(outside, "{cell:?} {face} {ray:?}");
        }
    }
}

#[test]
fn a_surface_point_lies_on_its_cell() {
    let mut random = Random::new(5);
    for _ in 0..100_000 {
        let cell = random_cell(&mut random);
        let face = random.below(6);
        let beyond_the_edge = center(cell) + random.point(0.500_1);
        let (point, error) = voxel::surface::<f32>(beyond_the_edge, cell, face);
        let lo = Vec3::from(cell.map(|c| c as f32));
        assert!(point.cmpge(lo).all() && point.cmple(lo + 1.0).all(), "{cell:?} {face} {point}");
        let axis = face as usize / 2;
        assert_eq!(point[axis], lo[axis] + (face & 1) as f32);
        assert!(error.min_element() > 0.0);
    }
}

#[test]
fn a_ray_that_enters_leaves_through_another_face() {
    let mut random = Random::new(3);
    for _ in 0..100_000 {
        let cell = random_cell(&mut random);
        let face = random.below(6);
        let ray = spawned(&mut random, cell, face, -1.0);
        let exit = hit(&ray, cell, Exclude::Entering).unwrap();
        assert!(
            exit.face != face && voxel::normal::<f32>(exit.face).dot(ray.direction) > 0.0,
            "{ray:?} {exit:?}"
        );
    }
}

#[test]
fn a_parent_cell_holds_its_children() {
    let mut random = Random::new(4);
    for _ in 0..10_000 {
        let child = random_cell(&mut random);
        for edge in [1, 2, 4, 64] {
            let bounds = voxel::bounds::<f32>(child.map(|c| c / 2), 2 * edge);
            assert!(bounds.contains(&voxel::bounds::<f32>(child, edge)), "{child:?} {edge}");
        }
    }
}
