//! The schedule of systems, and how it is run.
use std::sync::Arc;

use bevy_ecs::prelude::*;
use bevy_ecs::schedule::{LogLevel, ScheduleBuildSettings, SingleThreadedExecutor};
use bevy_ecs::world::WorldId;
use luxel_flat::FlatScene;
use luxel_scene::{Assets, Environment, MeshAsset, MeshStructure, RenderSettings, SphereCloud, VolumeAsset};

use crate::albedo_tables::place_albedo_tables;
use crate::assets::{Built, build_assets};
use crate::attributes::{Attributes, build_attributes};
use crate::camera::{View, find_camera};
use crate::cloud::Cloud;
use crate::environment::{Surroundings, place_environment};
use crate::features::{Features, find_features};
use crate::images::{Images, place_images};
use crate::instances::{Instances, place_objects, write_instances};
use crate::joined::{Joined, join_meshes};
use crate::journal::{Complaints, Revision};
use crate::lights::{Lights, place_lights};
use crate::materials::{MaterialSlots, shade};
use crate::objects::{Touched, find_touched};
use crate::propagate::propagate;
use crate::publish::{Published, publish};
use crate::report::{BakeReport, report};
use crate::spheres::place_spheres;
use crate::store::Heaps;
use crate::textures::{Textures, find_textures, write_textures};
use crate::tlas::{Tlas, update_tlas};
use crate::validate::validate;
use crate::{BakeCounters, BakeError, SphereTuning, TextureBudget};

/// The steps of a run, one after the other.
///
/// `Shading` comes before `Geometry` and `Instances`, because their records name material slots.
#[derive(SystemSet, Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum BakeSet {
    /// World transforms and visibility; which objects changed.
    Propagate,
    /// Images, texture slots, material slots and records; the surroundings.
    Shading,
    /// Structures of meshes, volumes and the sphere cloud; attributes.
    Geometry,
    /// Camera, origin of tracer space, instance records, TLAS.
    Instances,
    /// What the scene calls for.
    Features,
    /// The snapshot.
    Publish,
}

/// Puts what baking keeps between runs into a world, empty, and the scene's resources if they are missing.
pub fn install(world: &mut World) {
    ensure_scene_resources(world);
    world.insert_resource(Revision::default());
    world.insert_resource(BakeCounters::default());
    world.insert_resource(Complaints::default());
    world.insert_resource(Touched::default());
    world.insert_resource(MaterialSlots::default());
    world.insert_resource(Textures::default());
    world.insert_resource(Images::default());
    world.insert_resource(Surroundings::default());
    world.insert_resource(Attributes::default());
    world.insert_resource(Heaps::default());
    world.insert_resource(Built::<MeshAsset>::default());
    world.insert_resource(Built::<VolumeAsset>::default());
    world.insert_resource(Cloud::default());
    world.insert_resource(View::default());
    world.insert_resource(Instances::default());
    world.insert_resource(Joined::default());
    world.insert_resource(Lights::default());
    world.insert_resource(Tlas::default());
    world.insert_resource(Features::default());
    world.insert_resource(Published::default());
}

fn ensure_scene_resources(world: &mut World) {
    world.init_resource::<Assets>();
    world.init_resource::<Environment>();
    world.init_resource::<RenderSettings>();
    world.init_resource::<SphereCloud>();
    world.init_resource::<MeshStructure>();
    world.init_resource::<SphereTuning>();
    world.init_resource::<TextureBudget>();
}

/// Keeps the flat scene of one world up to date; see the crate's text.
pub struct Baker {
    schedule: Schedule,
    world: WorldId,
}

impl Baker {
    /// A baker for a world, which it [`install`]s itself into. The first run takes in everything that is
    /// there.
    ///
    /// # Errors
    /// [`BakeError::Schedule`] if the systems contradict each other.
    pub fn new(world: &mut World) -> Result<Self, BakeError> {
        install(world);
        let mut schedule = schedule();
        if let Err(error) = schedule.initialize(world) {
            return Err(BakeError::Schedule(error.to_string(schedule.graph(), world)));
        }
        Ok(Self { schedule, world: world.id() })
    }

    /// Takes in what changed since the last run. Returns the same `Arc` if nothing did.
    ///
    /// Calls [`World::clear_trackers`]; nobody else may, or removals could be missed.
    ///
    /// # Errors
    /// What keeps the scene from being shown. [`Self::latest`] stays what it was, nothing is lost, and the
    /// next run goes on from there.
    pub fn run(&mut self, world: &mut World) -> Result<Arc<FlatScene>, BakeError> {
        if world.id() != self.world {
            return Err(BakeError::OtherWorld);
        }
        ensure_scene_resources(world);
        world.resource_mut::<Revision>().0 += 1;
        self.schedule.run(world);
        world.clear_trackers();
        world.resource::<Published>().outcome.clone()
    }

    /// The last good scene, if there was one.
    pub fn latest(&self, world: &World) -> Option<Arc<FlatScene>> {
        world.get_resource::<Published>()?.latest.clone()
    }

    /// Facts about the last good scene. Costs a walk through every structure.
    pub fn report(&self, world: &World) -> BakeReport {
        report(world)
    }

    /// Checks every structure: for tests, and for suspicious users.
    ///
    /// # Errors
    /// [`BakeError::Structure`] with the first fault.
    pub fn validate(&self, world: &World) -> Result<(), BakeError> {
        validate(world)
    }
}

fn schedule() -> Schedule {
    let mut schedule = Schedule::default();
    schedule.set_executor(SingleThreadedExecutor::new());
    schedule.set_build_settings(ScheduleBuildSettings {
        ambiguity_detection: LogLevel::Error,
        ..ScheduleBuildSettings::default()
    });
    schedule.configure_sets(
        (
            BakeSet::Propagate,
            BakeSet::Shading,
            BakeSet::Geometry,
            BakeSet::Instances,
            BakeSet::Features,
            BakeSet::Publish,
        )
            .chain(),
    );
    let shading = (find_textures, place_images, write_textures, shade, place_environment);
    let geometry = (build_assets::<MeshAsset>, build_assets::<VolumeAsset>, build_attributes, place_spheres);
    let instances = (find_camera, place_objects, join_meshes, write_instances, place_lights, update_tlas);
    schedule.add_systems((propagate, find_touched).chain().in_set(BakeSet::Propagate));
    schedule.add_systems(shading.chain().in_set(BakeSet::Shading));
    schedule.add_systems(geometry.chain().in_set(BakeSet::Geometry));
    schedule.add_systems(instances.chain().in_set(BakeSet::Instances));
    schedule.add_systems((find_features, place_albedo_tables).chain().in_set(BakeSet::Features));
    schedule.add_systems(publish.in_set(BakeSet::Publish));
    schedule
}
