//! X02: a flight over a million units. What a pixel shows is what doubles say, wherever the camera is.
use glam::{DVec3, Vec3};
use luxel_bake::Baker;
use luxel_cpu::{Exclusion, traverse};
use luxel_flat::{Counters, FlatScene};
use luxel_geom::{Ray, Real, Vector};
use luxel_scene::{
    ActiveCamera, Assets, Camera, Material, MeshAsset, MeshInstance, MeshSource, Transform, empty_world,
    spawn,
};

use crate::many::tally;
use crate::table::Case;

/// No cube that is seen is farther away.
const FARTHEST: f64 = 128.0;
/// Cubes of edge 4 stand along the way, ten units apart, around each of these places.
const PLACES: [f64; 6] = [0.0, 1e3, 1e4, 123_456.0, 524_288.0, 1e6];
/// Steps of a tenth of a unit at each place.
const STEPS: u64 = 20;

/// What a ray meets first: instance and primitive.
fn id<R: Real>(scene: &FlatScene, ray: &Ray<R>) -> Option<(u32, u32)> {
    let hit = traverse::intersect(scene, ray, &Exclusion::NOTHING, &mut Counters::default());
    hit.map(|hit| (hit.instance_id, hit.on.primitive))
}

/// A tie: doubles say the same of a ray that starts up to 16 ulp of the largest coordinate beside, on any axis.
fn is_tie(scene: &FlatScene, ray: &Ray<f64>, found: Option<(u32, u32)>) -> bool {
    let reach = ray.origin.abs().max_element() + FARTHEST;
    let by = 16.0 * f64::from(f32::EPSILON) * reach;
    let beside = |by: DVec3| id::<f64>(scene, &Ray::new(ray.origin + by, ray.direction)) == found;
    let steps = || [-by, 0.0, by].into_iter();
    steps().any(|x| steps().any(|y| steps().any(|z| beside(DVec3::new(x, y, z)))))
}

/// Does a pixel show what doubles say? First: another primitive; second: another one although no tie explains it.
fn pixel(scene: &FlatScene, ray: &Ray<f32>) -> [u64; 3] {
    let exact: Ray<f64> = Ray::new(Vector::from_vec3(ray.origin), Vector::from_vec3(ray.direction));
    let (found, truth) = (id(scene, ray), id(scene, &exact));
    let differs = found != truth;
    let is_unexplained = differs && !is_tie(scene, &exact, found);
    [u64::from(differs), u64::from(is_unexplained), u64::from(truth.is_some())]
}

#[test]
fn x02_a_flight_over_a_million_units_shows_what_doubles_say() {
    let case = Case::begin("X02");
    let mut world = empty_world();
    let camera = spawn(&mut world, (Camera::default(), ActiveCamera, Transform::at(DVec3::ZERO)));
    let mesh = world.resource_mut::<Assets>().insert_mesh(MeshAsset::from_source(MeshSource::Cube).unwrap());
    for place in PLACES {
        for i in -10i32..=10 {
            let at =
                DVec3::new(place + 10.0 * f64::from(i), f64::from(i % 3), -6.0 - f64::from(i.rem_euclid(4)));
            let place = Transform { scale: DVec3::splat(4.0), ..Transform::at(at) };
            spawn(&mut world, (MeshInstance { mesh }, place, Material::default()));
        }
    }
    let mut baker = Baker::new(&mut world).unwrap();
    let pixels = case.size() / (PLACES.len() as u64 * STEPS);
    let mut sum = [0; 3];
    let mut seen = Vec::new();
    for (number, place) in PLACES.into_iter().enumerate() {
        for step in 0..STEPS {
            let eye = DVec3::new(place + 0.1 * step as f64, 0.0, 0.0);
            world.get_mut::<Transform>(camera).unwrap().translation = eye;
            let scene = baker.run(&mut world).unwrap();
            let origin = (eye - DVec3::from(scene.anchor)).as_vec3();
            let one = tally(number as u32, pixels, |random| {
                let target = Vec3::new(random.between(-1.0, 1.0), random.between(-0.5, 0.5), -1.0);
                pixel(&scene, &Ray::new(origin, target))
            });
            sum = std::array::from_fn(|i| sum[i] + one[i]);
            seen.push(one[2]);
        }
    }
    let [other, unexplained, hits] = sum;
    assert_eq!(unexplained, 0, "{other} of {hits} are others");
    assert!(other * 10_000 <= case.size(), "{other} of {hits} are others");
    assert!(seen.iter().all(|hits| *hits > pixels / 20), "{seen:?}");
    let size = case.size();
    case.end(format_args!("{size} pixels, {hits} hits, {other} at ties"));
}
