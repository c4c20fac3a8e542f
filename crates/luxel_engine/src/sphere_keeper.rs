//! Bakes a world with the right structure over its spheres: chosen by measurement where the scene leaves it open,
//! built anew when that pays.
//!
//! The only way in is [`SphereTuning`]: the keeper tries a structure by baking the world with it. What it decides is a
//! function of the world's history, never of time or machine. Nothing is measured in a run that changed nothing, so
//! a picture in the making is not disturbed.
use std::sync::Arc;

use bevy_ecs::prelude::*;
use luxel_bake::{BakeCounters, BakeError, Baker, SphereTuning};
use luxel_cpu::cloud_cost;
use luxel_flat::{Feature, FlatScene, SphereAccel};
use luxel_scene::SphereCloud;

use crate::sphere_choice::{Basis, Measured, because, candidates, cheapest};
use crate::sphere_upkeep::{Upkeep, build_cost};

/// Rays that a pixel's sample is taken to cost: the camera's and a few bounces.
const RAYS_PER_PIXEL: f64 = 4.0;

/// What is known of the structure that a world's spheres have now.
#[derive(Default)]
pub(crate) struct SphereKeeper {
    revision: u64,
    /// What the structure was chosen for.
    basis: Option<Basis>,
    because: String,
    /// `None` for a structure that moved spheres cannot spoil.
    upkeep: Option<Upkeep>,
    /// [`renewals`] when `upkeep` began.
    renewals: u64,
}

impl SphereKeeper {
    /// Why the structure is what it is, as the end of a sentence that begins with "because".
    pub(crate) fn because(&self) -> &str {
        &self.because
    }

    /// Takes in what changed in the world; the same snapshot as before if nothing did.
    pub(crate) fn bake(&mut self, baker: &mut Baker, world: &mut World) -> Result<Arc<FlatScene>, BakeError> {
        let scene = baker.run(world)?;
        let cloud = *world.resource::<SphereCloud>();
        if scene.revision == self.revision && self.basis.is_some_and(|basis| basis.cloud == cloud) {
            return Ok(scene);
        }
        let spheres = live_spheres(&scene);
        let basis = Basis { cloud, spheres };
        let scene = if self.basis.is_some_and(|old| old.covers(&basis)) {
            self.keep_up(scene, spheres, baker, world)?
        } else {
            self.choose(scene, basis, baker, world)?
        };
        self.revision = scene.revision;
        Ok(scene)
    }

    /// Finds the structure for a scene that is not like the one before.
    fn choose(
        &mut self,
        scene: Arc<FlatScene>,
        basis: Basis,
        baker: &mut Baker,
        world: &mut World,
    ) -> Result<Arc<FlatScene>, BakeError> {
        let is_open = basis.cloud.accel == luxel_scene::SphereAccel::Auto;
        let scene = if is_open || basis.spheres == 0 {
            let (scene, measured) = measure_candidates(scene, basis.spheres, baker, world)?;
            self.because = because(&measured, basis.spheres);
            scene
        } else {
            self.because = "it was asked for".to_owned();
            scene
        };
        self.basis = Some(basis);
        self.begin_upkeep(&scene, world);
        Ok(scene)
    }

    /// Builds the structure anew if the detours of rays since its build are worth it.
    fn keep_up(
        &mut self,
        scene: Arc<FlatScene>,
        spheres: u64,
        baker: &mut Baker,
        world: &mut World,
    ) -> Result<Arc<FlatScene>, BakeError> {
        let counters = *world.resource::<BakeCounters>();
        if renewals(&counters) != self.renewals {
            self.begin_upkeep(&scene, world);
            return Ok(scene);
        }
        let Some(upkeep) = &mut self.upkeep else { return Ok(scene) };
        let touched = touched(&counters);
        if upkeep.is_measurement_due(touched, spheres) {
            upkeep.measured(cloud_cost::measure(&scene).cost_per_ray, touched);
        }
        if !upkeep.pay(scene.pixel_count() as f64 * RAYS_PER_PIXEL, build_cost(spheres)) {
            return Ok(scene);
        }
        world.resource_mut::<SphereTuning>().generation += 1;
        let scene = baker.run(world)?;
        self.begin_upkeep(&scene, world);
        Ok(scene)
    }

    /// Starts to watch a structure that is as good as new.
    fn begin_upkeep(&mut self, scene: &FlatScene, world: &World) {
        let counters = world.resource::<BakeCounters>();
        self.renewals = renewals(counters);
        let spoils = matches!(scene.sphere_accel, SphereAccel::Octree | SphereAccel::Bvh)
            && scene.features.has(Feature::Spheres);
        self.upkeep = spoils.then(|| Upkeep::new(cloud_cost::measure(scene).cost_per_ray, touched(counters)));
    }
}

/// Bakes and measures every candidate, and leaves the world with the cheapest.
fn measure_candidates(
    mut scene: Arc<FlatScene>,
    spheres: u64,
    baker: &mut Baker,
    world: &mut World,
) -> Result<(Arc<FlatScene>, Vec<Measured>), BakeError> {
    let mut measured = Vec::new();
    for &accel in candidates(spheres) {
        scene = bake_with(accel, baker, world)?;
        measured.push(Measured { accel, cost: cloud_cost::measure(&scene).cost_per_ray });
    }
    if let Some(best) = cheapest(&measured) {
        scene = bake_with(best, baker, world)?;
    }
    Ok((scene, measured))
}

fn bake_with(accel: SphereAccel, baker: &mut Baker, world: &mut World) -> Result<Arc<FlatScene>, BakeError> {
    world.resource_mut::<SphereTuning>().auto = accel;
    baker.run(world)
}

fn live_spheres(scene: &FlatScene) -> u64 {
    scene.spheres.as_slice().iter().filter(|sphere| sphere.radius > 0.0).count() as u64
}

/// What has left a structure as good as new, counted since ever: builds, and spheres that came or went. After those a BVH
/// was built anew, and the loose octree has the shape that it would have been built in; only moves spoil one. (The
/// cost of a ray changes with the number of spheres, and that is no detour.)
fn renewals(counters: &BakeCounters) -> u64 {
    counters.sphere_rebuilds + counters.sphere_inserts + counters.sphere_removes
}

/// Spheres that edits have touched since ever.
fn touched(counters: &BakeCounters) -> u64 {
    counters.sphere_updates + counters.sphere_inserts + counters.sphere_removes
}
