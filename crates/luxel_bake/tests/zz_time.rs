#![allow(clippy::unwrap_used, missing_docs)]
mod common;
use common::Studio;
use glam::DVec3;
use luxel_scene::*;
#[test]
fn time() {
    for n in [10_000u32, 100_000] {
        let mut s = Studio::empty();
        let cube = s.mesh_asset(MeshSource::Icosphere { subdivisions: 7 });
        let m = s.mesh(cube, DVec3::Y * 9.0, Material::default());
        let e: Vec<_> = (0..n).map(|i| {
            let r = luxel_geom::rng::uniform4::<f64>(i, 0, 0, 1);
            s.sphere(DVec3::new(r[0], r[1], r[2]) * 100.0, 0.1, Material::default())
        }).collect();
        let t = std::time::Instant::now();
        s.run();
        eprintln!("{n}: first {:?}", t.elapsed());
        for _ in 0..3 {
            let t = std::time::Instant::now();
            s.run();
            eprintln!("  idle {:?}", t.elapsed());
        }
        for i in 0..3 {
            let t = std::time::Instant::now();
            s.edit(|w| w.get_mut::<Transform>(e[i * 37 + 5]).unwrap().translation.x *= 0.9);
            eprintln!("  sphere {:?}", t.elapsed());
            let t = std::time::Instant::now();
            s.edit(|w| w.get_mut::<Transform>(m).unwrap().translation.x += 0.9);
            eprintln!("  mesh {:?}", t.elapsed());
        }
    }
}
