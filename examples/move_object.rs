//! Moves one object over 30 frames and shows what each move rebuilds: the TLAS alone, or the structure over
//! the spheres alone. (That one is built anew now and then, when the rays' detours are worth it.)
//!
//! `cargo run --release --example move_object -- [--quick] [--out DIR]`
//!
//! Writes the first and the last frame as PNG and prints a line per frame.
#![allow(clippy::print_stdout, clippy::print_stderr, reason = "an example talks to a terminal")]
use std::ops::ControlFlow;
use std::path::PathBuf;

use anyhow::{Context, bail};
use bevy_ecs::prelude::{Entity, World};
use glam::DVec3;
use luxel_bake::BakeCounters;
use luxel_engine::output::{Picture, write_png};
use luxel_engine::{Engine, RenderJob};
use luxel_film::View;
use luxel_scene::{Name, Transform};

const FRAMES: u32 = 30;

fn main() -> anyhow::Result<()> {
    let quick = std::env::args().any(|arg| arg == "--quick");
    let out =
        std::env::args().skip_while(|arg| arg != "--out").nth(1).map_or_else(PathBuf::new, PathBuf::from);
    let mut engine = Engine::load("assets/showcase.ron".as_ref())?;
    engine.bake()?;

    let knot = named(&mut engine.world, "copper knot")?;
    let ball = named(&mut engine.world, "coral ball")?;

    for frame in 0..FRAMES {
        let (name, entity) = if frame % 2 == 0 { ("mesh", knot) } else { ("sphere", ball) };
        let before = *engine.world.resource::<BakeCounters>();
        let angle = f64::from(frame) / f64::from(FRAMES) * std::f64::consts::TAU;
        if let Some(mut transform) = engine.world.get_mut::<Transform>(entity) {
            transform.translation += DVec3::new(angle.cos(), 0.0, angle.sin()) * 0.02;
        }
        engine.bake()?;
        let work = engine.world.resource::<BakeCounters>().since(&before);
        println!(
            "frame {frame:2}  moved the {name:6}  TLAS builds {}  BVHs built {}  sphere updates {}  sphere rebuilds {}",
            work.tlas_builds, work.blas_built, work.sphere_updates, work.sphere_rebuilds
        );
        let moved_spheres = work.sphere_updates > 0;
        if work.blas_built + work.svo_built > 0 || moved_spheres != (entity == ball) {
            bail!("moving the {name} rebuilt a structure that it should not touch");
        }
        if frame == 0 || frame == FRAMES - 1 {
            render(&mut engine, quick, &out.join(format!("move_object_{frame:02}.png")))?;
        }
    }
    Ok(())
}

fn named(world: &mut World, name: &str) -> anyhow::Result<Entity> {
    let mut entities = world.query::<(Entity, &Name)>();
    let found = entities.iter(world).find(|(_, n)| n.0 == name);
    found.map(|(entity, _)| entity).with_context(|| format!("the scene has nothing named '{name}'"))
}

fn render(engine: &mut Engine, quick: bool, path: &std::path::Path) -> anyhow::Result<()> {
    let job = RenderJob {
        size: Some(if quick { (64, 36) } else { (640, 360) }),
        spp: Some(if quick { 2 } else { 32 }),
        ..RenderJob::default()
    };
    let rendered = engine.render(&job, &mut |_| ControlFlow::Continue(()))?;
    let picture = Picture::of(&rendered.film, engine.display(), View::PathTraced).context("no picture")?;
    write_png(path, &picture, &rendered.metadata(engine))?;
    println!("wrote {}", path.display());
    Ok(())
}
