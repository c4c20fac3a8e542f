//! The judge on trial: right answers pass, ties pass, everything else is found out.
use glam::DVec3;
use luxel_flat::{BvhNode, Heap, SvoNode, Triangle};

use super::*;
use crate::spheres::sphere;

const IDENTITY: [[f32; 4]; 3] = [[1.0, 0.0, 0.0, 0.0], [0.0, 1.0, 0.0, 0.0], [0.0, 0.0, 1.0, 0.0]];

/// Along −z before the camera: a square of two triangles (7/1 below its diagonal, 7/2 above) at z = −4, a voxel
/// (8/0) from z = −6 to −5, a sphere (0/9) of radius 1 around z = −8.
fn scene() -> FlatScene {
    let at = |x: f32, y: f32| [x, y, -4.0];
    let lower =
        Triangle { v0: at(-1.0, -1.0), v1: at(1.0, -1.0), v2: at(1.0, 1.0), id: 1, ..Triangle::default() };
    let upper = Triangle { v1: at(1.0, 1.0), v2: at(-1.0, 1.0), id: 2, ..lower };
    let object = |kind, stable_id| Instance {
        world_from_object: IDENTITY,
        object_from_world: IDENTITY,
        kind,
        stable_id,
        node_count: 1,
        ..Instance::default()
    };
    let mut cell = object(KIND_VOXELS, 8);
    for axis in 0..3 {
        cell.object_from_world[axis][3] = [0.5, 0.5, 6.0][axis];
    }
    let mesh = Instance { primitive_count: 2, ..object(KIND_MESH, 7) };
    FlatScene {
        bvh_nodes: Heap::from_records(vec![BvhNode::default()], 1),
        instances: Heap::from_records(vec![object(KIND_SPHERES, 0), mesh, cell], 1),
        spheres: Heap::from_records(vec![sphere(glam::Vec3::new(0.0, 0.0, -8.0), 1.0, 9)], 1),
        triangles: Heap::from_records(vec![lower, upper], 1),
        svo_nodes: Heap::from_records(vec![SvoNode::default()], 1),
        ..FlatScene::default()
    }
}

fn along_z(x: f64, y: f64) -> Ray<f64> {
    Ray::new(DVec3::new(x, y, 0.0), DVec3::NEG_Z)
}

fn answer(instance: u32, primitive: u32) -> Option<Answer> {
    Some(Answer { instance, primitive })
}

const NOTHING: Option<Answer> = None;

/// Which of all answers pass.
fn plausible(scene: &FlatScene, ray: &Ray<f64>) -> Vec<Option<Answer>> {
    let judge = Judge::new(scene);
    let all = [NOTHING, answer(0, 9), answer(7, 1), answer(7, 2), answer(8, 0), answer(7, 9), answer(3, 1)];
    all.into_iter().filter(|a| judge.is_plausible(ray, *a)).collect()
}

#[test]
fn away_from_borders_there_is_one_answer() {
    let scene = scene();
    assert_eq!(plausible(&scene, &along_z(0.5, 0.25)), [answer(7, 1)]);
    assert_eq!(plausible(&scene, &along_z(-0.5, 0.25)), [answer(7, 2)]);
    assert_eq!(plausible(&scene, &along_z(3.0, 0.0)), [NOTHING]);
    let from_behind = Ray::new(DVec3::new(0.25, 0.25, -20.0), DVec3::Z);
    assert_eq!(plausible(&scene, &from_behind), [answer(0, 9)]);
    let between = Ray::new(DVec3::new(0.25, 0.25, -4.5), DVec3::NEG_Z);
    assert_eq!(plausible(&scene, &between), [answer(8, 0)]);
    let from_within = Ray::new(DVec3::new(0.25, 0.25, -5.5), DVec3::NEG_Z);
    assert_eq!(plausible(&scene, &from_within), [answer(8, 0)]);
}

#[test]
fn an_edge_is_a_tie_for_sixteen_ulps() {
    let scene = scene();
    // The largest coordinate is the distance, 4.
    let ulp = 4.0 * (-23f64).exp2();
    let both = [answer(7, 1), answer(7, 2)];
    for x in [-8.0, 0.0, 8.0] {
        assert_eq!(plausible(&scene, &along_z(0.25 + x * ulp, 0.25)), both);
    }
    assert_eq!(plausible(&scene, &along_z(0.25 + 64.0 * ulp, 0.25)), [answer(7, 1)]);
    assert_eq!(plausible(&scene, &along_z(0.25 - 64.0 * ulp, 0.25)), [answer(7, 2)]);
    assert_eq!(plausible(&scene, &along_z(1.0 + 8.0 * ulp, -0.5)), [NOTHING, answer(7, 1)]);
    assert_eq!(plausible(&scene, &along_z(1.0 - 8.0 * ulp, -0.5)), [NOTHING, answer(7, 1)]);
    assert_eq!(plausible(&scene, &along_z(1.0 + 64.0 * ulp, -0.5)), [NOTHING]);
}

#[test]
fn a_cell_and_a_sphere_have_borders_too() {
    let behind = |x: f64, y: f64| Ray::new(DVec3::new(x, y, -4.5), DVec3::NEG_Z);
    let ulp = 8.0 * (-23f64).exp2();
    let scene = scene();
    assert_eq!(plausible(&scene, &behind(0.5 + 2.0 * ulp, 0.0)), [answer(0, 9), answer(8, 0)]);
    assert_eq!(plausible(&scene, &behind(0.5 + 64.0 * ulp, 0.0)), [answer(0, 9)]);
    assert_eq!(plausible(&scene, &behind(0.5 - 64.0 * ulp, 0.0)), [answer(8, 0)]);
    for (x, expected) in [(4.0, vec![NOTHING, answer(0, 9)]), (64.0, vec![NOTHING])] {
        assert_eq!(plausible(&scene, &behind(1.0 + x * ulp, 0.0)), expected);
    }
    assert_eq!(plausible(&scene, &behind(1.0 - 64.0 * ulp, 0.0)), [answer(0, 9)]);
}

/// A tracer that leaks between two triangles is wrong, although each of them alone might be missed.
#[test]
fn what_is_behind_a_shared_border_stays_hidden() {
    let scene = scene();
    let judge = Judge::new(&scene);
    for place in [-0.75, 0.0, 0.25] {
        let ray = along_z(place, place);
        assert!(!judge.is_plausible(&ray, answer(8, 0)) && !judge.is_plausible(&ray, NOTHING));
        assert!(judge.is_plausible(&ray, answer(7, 1)) && judge.is_plausible(&ray, answer(7, 2)));
    }
    let outer_edge = along_z(1.0, 0.0);
    assert!(judge.is_plausible(&outer_edge, NOTHING));
}

#[test]
fn equal_depth_is_a_tie() {
    let mut scene = scene();
    for (gap, ties) in [(-20, true), (-16, false)] {
        let behind = -4.0 * (1.0 + f32::exp2(gap as f32));
        let mut triangles = scene.triangles.as_slice()[..1].to_vec();
        triangles.push(Triangle { id: 2, ..triangles[0] });
        for vertex in [0, 1, 2] {
            let t = &mut triangles[1];
            [&mut t.v0, &mut t.v1, &mut t.v2][vertex][2] = behind;
        }
        scene.triangles = Heap::from_records(triangles, 1);
        let expected = if ties { vec![answer(7, 1), answer(7, 2)] } else { vec![answer(7, 1)] };
        assert_eq!(plausible(&scene, &along_z(0.5, 0.25)), expected);
        assert_eq!(Judge::new(&scene).explains(&along_z(0.5, 0.25), [answer(7, 1), answer(7, 2)]), ties);
    }
}

#[test]
fn a_small_thing_far_away_is_all_border() {
    let scene = scene();
    let far = Ray::new(DVec3::new(0.0, 0.25, 1e7), DVec3::NEG_Z);
    let judge = Judge::new(&scene);
    assert!(judge.explains(&far, [NOTHING, answer(7, 2)]));
    assert!(!judge.is_plausible(&far, answer(7, 9)));
}

#[test]
fn a_record_of_a_film_is_an_answer() {
    assert_eq!(Answer::of_aov(&Aov::default()), None);
    assert_eq!(Answer::of_aov(&Aov { instance: 8, primitive: 2, ..Aov::default() }), answer(7, 2));
}

#[test]
fn a_description_names_what_is_there() {
    let text = Judge::new(&scene()).describe(&along_z(0.25, 0.125));
    assert!(text.contains("7/1: hit") && text.contains("8/0: hit") && text.contains("0/9: hit"), "{text}");
}
