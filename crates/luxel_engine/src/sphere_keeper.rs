//! Bakes a world with the right structure over its spheres: chosen by measurement where the scene leaves it open,
//! built anew when that pays.
//!
//! The only way in is [`SphereTuning`]: the keeper tries a structure by baking the world with it. What it decides is a
//! function of the world's history and of the rays that were traced in it, never of time or machine. Nothing is built
//! in a run that changed nothing, so a picture in the making is not disturbed; what its rays cost counts in the next
//! run that does change something.
use std::sync::Arc;

use bevy_ecs::prelude::*;
use luxel_bake::{BakeCounters, BakeError, Baker, SphereTuning};
use luxel_cpu::cloud_cost;
use luxel_flat::{FlatScene, SphereAccel};
use luxel_scene::SphereCloud;

use crate::sphere_choice::{Basis, Measured, because, candidates, cheapest};
use crate::sphere_upkeep::{Upkeep, build_cost};

/// Rays that a pixel's sample is taken to cost where nobody counts them: the camera's and a few bounces.
const RAYS_PER_PIXEL: usize = 4;

/// What is known of the structure that a world's spheres have now.
#[derive(Default)]
pub(crate) struct SphereKeeper {
    /// The scene that was handed out last.
    latest: Option<Arc<FlatScene>>,
    /// Rays that were traced in it; `None` if nobody said.
    traced: Option<u64>,
    /// What the structure was chosen for.
    basis: Option<Basis>,
    because: String,
    /// `None` for a structure that edits cannot spoil.
    upkeep: Option<Upkeep>,
    /// Builds of whole structures when `upkeep` was last renewed.
    builds: u64,
}

impl SphereKeeper {
    /// Why the structure is what it is, as the end of a sentence that begins with "because".
    pub(crate) fn because(&self) -> &str {
        &self.because
    }

    /// Counts rays that were traced in the scene that was baked last.
    pub(crate) fn note_traced(&mut self, rays: u64) {
        self.traced = Some(self.traced.unwrap_or(0).saturating_add(rays));
    }

    /// Takes in what changed in the world; the same snapshot as before if nothing did.
    pub(crate) fn bake(&mut self, baker: &mut Baker, world: &mut World) -> Result<Arc<FlatScene>, BakeError> {
        let before = touched(world);
        let scene = baker.run(world)?;
        let cloud = *world.resource::<SphereCloud>();
        let is_as_before = self.latest.as_ref().is_some_and(|latest| latest.revision == scene.revision);
        if is_as_before && self.basis.is_some_and(|basis| basis.cloud == cloud) {
            return Ok(scene);
        }
        self.pay(before);
        let basis = Basis { cloud, spheres: live_spheres(&scene) };
        let scene = if self.basis.is_some_and(|old| old.covers(&basis)) {
            scene
        } else {
            self.choose(scene, basis, baker, world)?
        };
        let scene = self.keep_up(scene, basis.spheres, baker, world)?;
        self.latest = Some(Arc::clone(&scene));
        Ok(scene)
    }

    /// Takes in the rays that were traced in the latest scene, when so many spheres had been touched.
    fn pay(&mut self, touched: u64) {
        let traced = self.traced.take();
        let (Some(latest), Some(upkeep)) = (&self.latest, &mut self.upkeep) else { return };
        let rays = traced.map_or((latest.pixel_count() * RAYS_PER_PIXEL) as f64, |rays| rays as f64);
        upkeep.trace(rays, touched, || cost(latest));
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
            self.because = because(&measured);
            scene
        } else {
            self.because = "it was asked for".to_owned();
            scene
        };
        self.basis = Some(basis);
        Ok(scene)
    }

    /// Builds the structure anew if that is due.
    fn keep_up(
        &mut self,
        scene: Arc<FlatScene>,
        spheres: u64,
        baker: &mut Baker,
        world: &mut World,
    ) -> Result<Arc<FlatScene>, BakeError> {
        let is_built = builds(world) != self.builds;
        let (Some(upkeep), false) = (&mut self.upkeep, is_built) else {
            self.renew_upkeep(&scene, world);
            return Ok(scene);
        };
        let touched = touched(world);
        let Some(cause) = upkeep.due(build_cost(spheres), touched, spheres) else { return Ok(scene) };
        let before = cost(&scene);
        world.resource_mut::<SphereTuning>().generation += 1;
        let scene = baker.run(world)?;
        upkeep.built(cause, before, cost(&scene), touched);
        self.builds = builds(world);
        Ok(scene)
    }

    /// Starts to watch a structure that was built for other reasons than its upkeep.
    fn renew_upkeep(&mut self, scene: &FlatScene, world: &World) {
        self.builds = builds(world);
        let is_alike = self.latest.as_ref().is_some_and(|old| old.sphere_accel == scene.sphere_accel);
        self.upkeep = match (&self.upkeep, scene.sphere_accel) {
            (_, SphereAccel::Naive | SphereAccel::OctreeBase | SphereAccel::OctreeSeed) => None,
            (Some(old), _) if is_alike => Some(old.renewed(cost(scene), touched(world))),
            (_, accel) => Some(Upkeep::new(accel == SphereAccel::Bvh, cost(scene), touched(world))),
        };
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
        measured.push(Measured { accel, cost: cloud_cost::measure(&scene) });
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

fn cost(scene: &FlatScene) -> f64 {
    cloud_cost::measure(scene).cost_per_ray
}

fn live_spheres(scene: &FlatScene) -> u64 {
    scene.spheres.as_slice().iter().filter(|sphere| sphere.radius > 0.0).count() as u64
}

/// Builds of whole structures since ever.
fn builds(world: &World) -> u64 {
    world.resource::<BakeCounters>().sphere_rebuilds
}

/// Spheres that edits have touched since ever.
fn touched(world: &World) -> u64 {
    let counters = world.resource::<BakeCounters>();
    counters.sphere_updates + counters.sphere_inserts + counters.sphere_removes
}
