//! The same rays in f64: single precision is right, or cannot know better.
use luxel_cpu::{Exclusion, traverse};
use luxel_flat::{Counters, FlatScene};
use luxel_geom::{Ray, Real};
use luxel_testkit::ties::{Answer, Judge};
use rayon::prelude::*;

/// Asserts that where single and double precision see different primitives, each is a tie. Returns their number.
pub(crate) fn assert_right_in_f64(scene: &FlatScene, rays: &[Ray<f32>]) -> usize {
    let judge = Judge::new(scene);
    let doubtful = rays.par_iter().filter(|ray| {
        let precise = Ray::<f64>::new(ray.origin.as_dvec3(), ray.direction.as_dvec3());
        let both = [answer(scene, ray), answer(scene, &precise)];
        let differ = both[0] != both[1];
        let explained = !differ || judge.explains(&precise, both);
        assert!(explained, "no tie: {both:?}\n{}", judge.describe(&precise));
        differ
    });
    doubtful.count()
}

fn answer<R: Real>(scene: &FlatScene, ray: &Ray<R>) -> Option<Answer> {
    let hit = traverse::intersect(scene, ray, &Exclusion::NOTHING, &mut Counters::default())?;
    Some(Answer { instance: hit.instance_id, primitive: hit.on.primitive })
}
