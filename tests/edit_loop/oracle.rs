//! What rays see, compared bit for bit.
use luxel_cpu::naive::Naive;
use luxel_cpu::{Exclusion, Hit, traverse};
use luxel_flat::{Counters, FlatScene, MaterialRecord};
use luxel_geom::Ray;
use rayon::prelude::*;

/// A hit without the slots, which two bakes of one world may choose differently.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Seen {
    t: u32,
    uv: [u32; 2],
    /// Stable id of the instance.
    pub(crate) instance: u32,
    primitive: u32,
    material: [u32; size_of::<MaterialRecord>() / 4],
}

/// What each ray sees by the structures.
pub(crate) fn trace(scene: &FlatScene, rays: &[Ray<f32>]) -> Vec<Option<Seen>> {
    let hit = |ray: &Ray<f32>| traverse::intersect(scene, ray, &Exclusion::NOTHING, &mut Counters::default());
    rays.par_iter().map(|ray| hit(ray).map(|hit| seen(scene, &hit))).collect()
}

/// What each ray sees when every primitive is tested.
pub(crate) fn trace_naive(scene: &FlatScene, rays: &[Ray<f32>]) -> Vec<Option<Seen>> {
    let naive = Naive::new(scene);
    let hit = |ray: &Ray<f32>| naive.intersect(ray, &Exclusion::NOTHING);
    rays.par_iter().map(|ray| hit(ray).map(|hit| seen(scene, &hit))).collect()
}

/// Asserts that two ways to trace the same rays see the same.
#[track_caller]
pub(crate) fn assert_same(what: &str, rays: &[Ray<f32>], a: &[Option<Seen>], b: &[Option<Seen>]) {
    let differing = differing(a, b);
    let text = |i: &usize| format!("ray {i}: {:?}\n  {:?}\n  {:?}", rays[*i], a[*i], b[*i]);
    let some: Vec<String> = differing.iter().take(3).map(text).collect();
    assert!(
        some.is_empty(),
        "{what}: {} of {} rays differ\n{}",
        differing.len(),
        rays.len(),
        some.join("\n")
    );
}

/// Which rays see different things in two traces.
pub(crate) fn differing(a: &[Option<Seen>], b: &[Option<Seen>]) -> Vec<usize> {
    assert_eq!(a.len(), b.len());
    (0..a.len()).filter(|i| a[*i] != b[*i]).collect()
}

fn seen(scene: &FlatScene, hit: &Hit<f32>) -> Seen {
    // Where the entity's lights stand in their table is a matter of history, not of the picture.
    let material = MaterialRecord {
        light_first: 0,
        texture_first: 0,
        ..scene.materials.as_slice()[hit.on.material as usize]
    };
    Seen {
        t: hit.on.t.to_bits(),
        uv: hit.on.uv.map(f32::to_bits),
        instance: hit.instance_id,
        primitive: hit.on.primitive,
        material: bytemuck::cast(material),
    }
}
