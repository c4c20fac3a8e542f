//! What the table of lights is made of, and when it is made anew.
use bevy_ecs::prelude::*;
use glam::{DQuat, DVec3, Vec3};
use luxel_bake::BakeCounters;
use luxel_flat::{
    FlatScene, LIGHT_DISTANT, LIGHT_POINT, LIGHT_SPHERE, LIGHT_SPOT, LIGHT_TRIANGLE, MATERIAL_EMISSIVE, NONE,
};
use luxel_scene::{Material, Opacity, PointLight, RenderSettings, Transform, Visibility};

use crate::scenes::{ball, dark, engine, every_kind_stage, floor, quad};

fn kinds(scene: &FlatScene) -> Vec<u32> {
    scene.lights.as_slice().iter().map(|light| light.kind).collect()
}

#[test]
fn lights_stand_in_their_order() {
    let scene = engine(every_kind_stage()).bake().unwrap();
    let expected =
        [LIGHT_DISTANT, LIGHT_DISTANT, LIGHT_POINT, LIGHT_SPOT, LIGHT_SPHERE, LIGHT_TRIANGLE, LIGHT_TRIANGLE];
    assert_eq!(kinds(&scene), expected);
    let params = &scene.params;
    assert_eq!((params.light_count, params.distant_count, params.light_node_count), (7, 2, 9));
    let firsts: Vec<u32> =
        scene.materials.as_slice().iter().map(|m| m.light_first).filter(|l| *l != NONE).collect();
    assert_eq!(firsts.len(), 2);
    assert!(firsts.contains(&4) && firsts.contains(&5), "{firsts:?}");
}

#[test]
fn what_cannot_be_sampled_evenly_is_not_in_the_table() {
    let mut world = dark(DVec3::new(0.0, 1.0, 4.0), DVec3::ZERO, 0.7, 8);
    let holed = Material { opacity: Opacity::Blend { alpha: 0.5 }, ..Material::lamp(Vec3::ONE) };
    quad(&mut world, DVec3::Y, DQuat::IDENTITY, 1.0, holed);
    let scene = engine(world).bake().unwrap();
    assert!(scene.lights.is_empty() && scene.light_nodes.is_empty());
    let shining = scene.materials.as_slice().iter().filter(|m| m.flags & MATERIAL_EMISSIVE != 0);
    assert!(shining.clone().count() == 1 && shining.clone().all(|m| m.light_first == NONE));
}

#[test]
fn only_what_shines_makes_a_new_table() {
    let mut world = dark(DVec3::new(0.0, 1.0, 4.0), DVec3::ZERO, 0.7, 8);
    let dull = floor(&mut world, 4.0, 0.5);
    let stone = ball(&mut world, DVec3::X, 0.3, Material::default());
    let lamp = quad(&mut world, DVec3::Y, DQuat::IDENTITY, 1.0, Material::lamp(Vec3::ONE));
    let bulb = ball(&mut world, DVec3::NEG_X, 0.1, Material::lamp(Vec3::ONE));
    let point = (PointLight { intensity: Vec3::ONE }, Transform::at(DVec3::Z));
    let point = luxel_scene::spawn(&mut world, point);
    let mut engine = engine(world);
    engine.bake().unwrap();
    let mut tables = |change: &dyn Fn(&mut World)| {
        let before = *engine.world.resource::<BakeCounters>();
        change(&mut engine.world);
        let scene = engine.bake().unwrap();
        (engine.world.resource::<BakeCounters>().since(&before).light_tables, scene.lights.len())
    };
    let shift = |entity: Entity| {
        move |world: &mut World| world.get_mut::<Transform>(entity).unwrap().translation.y += 0.125
    };
    assert_eq!(tables(&shift(dull)), (0, 4));
    assert_eq!(tables(&shift(stone)), (0, 4));
    assert_eq!(tables(&|world| world.resource_mut::<RenderSettings>().seed += 1), (0, 4));
    assert_eq!(tables(&shift(lamp)), (1, 4));
    assert_eq!(tables(&shift(bulb)), (1, 4));
    assert_eq!(tables(&shift(point)), (1, 4));
    assert_eq!(tables(&|world| _ = world.entity_mut(bulb).insert(Visibility(false))), (1, 3));
    assert_eq!(tables(&|world| _ = world.entity_mut(lamp).insert(Material::default())), (1, 1));
    assert_eq!(tables(&|world| _ = world.entity_mut(point).remove::<PointLight>()), (1, 0));
    assert_eq!(tables(&|world| _ = world.entity_mut(stone).insert(Material::lamp(Vec3::ONE))), (1, 1));
}
