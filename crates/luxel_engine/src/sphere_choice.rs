//! Which structure a scene's spheres get when the scene leaves the choice open: the cheapest by measurement.
//!
//! The costs are those of [`luxel_cpu::cloud_cost`]: work along fixed rays, counted and weighed, not timed, so that a
//! scene gets the same structure on every machine. A choice costs a build of every candidate; it is made again only when
//! the number of spheres has changed by a factor of two, or the settings of the cloud have.
use luxel_cpu::cloud_cost::CloudCost;
use luxel_flat::SphereAccel;
use luxel_scene::SphereCloud;

/// With more spheres than this, testing all of them is out of the question and not even measured.
pub(crate) const NAIVE_MOST: u64 = 1_000;

/// A structure and what a ray costs with it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Measured {
    pub(crate) accel: SphereAccel,
    pub(crate) cost: CloudCost,
}

/// What a choice was made for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Basis {
    pub(crate) cloud: SphereCloud,
    pub(crate) spheres: u64,
}

impl Basis {
    /// True if a choice that was made for this is good enough for that.
    pub(crate) fn covers(&self, now: &Self) -> bool {
        let (few, many) = (self.spheres.min(now.spheres), self.spheres.max(now.spheres));
        self.cloud == now.cloud && (few == many || few > many / 2)
    }
}

/// The structures to measure for that many spheres, in the order of rising hope: the last one is most often taken,
/// and is then already there.
pub(crate) fn candidates(spheres: u64) -> &'static [SphereAccel] {
    match spheres {
        0 => &[],
        1..=NAIVE_MOST => &[SphereAccel::Octree, SphereAccel::Naive, SphereAccel::Bvh],
        _ => &[SphereAccel::Octree, SphereAccel::Bvh],
    }
}

/// From the cheapest to the dearest; of equals the simplest first.
fn by_cost(measured: &[Measured]) -> Vec<Measured> {
    let mut sorted = measured.to_vec();
    sorted.sort_by(|a, b| {
        a.cost.cost_per_ray.total_cmp(&b.cost.cost_per_ray).then((a.accel as u32).cmp(&(b.accel as u32)))
    });
    sorted
}

/// The cheapest; of equals the simplest.
pub(crate) fn cheapest(measured: &[Measured]) -> Option<SphereAccel> {
    by_cost(measured).first().map(|best| best.accel)
}

/// Why the cheapest was taken, as the end of a sentence that begins with "because".
pub(crate) fn because(measured: &[Measured]) -> String {
    let sorted = by_cost(measured);
    let Some((best, others)) = sorted.split_first() else {
        return "the scene has no spheres".to_owned();
    };
    let CloudCost { nodes_per_ray: nodes, tests_per_ray: tests, .. } = best.cost;
    let other = |m: &Measured| {
        let CloudCost { nodes_per_ray, tests_per_ray, .. } = m.cost;
        format!("{nodes_per_ray:.1} and {tests_per_ray:.1} ({})", m.accel.name())
    };
    let others = others.iter().map(other).collect::<Vec<_>>().join(", ");
    format!(
        "it is estimated to do the least work per ray, counted along sample rays: {nodes:.1} node and {tests:.1} sphere \
         tests, against {others}"
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    fn measured(costs: &[(SphereAccel, f64)]) -> Vec<Measured> {
        let cost_of = |cost| CloudCost { cost_per_ray: cost, ..CloudCost::default() };
        costs.iter().map(|(accel, cost)| Measured { accel: *accel, cost: cost_of(*cost) }).collect()
    }

    #[test]
    fn the_cheapest_is_taken_and_of_equals_the_simplest() {
        use SphereAccel::{Bvh, Naive, Octree};
        assert_eq!(cheapest(&measured(&[(Octree, 3.0), (Naive, 9.0), (Bvh, 2.0)])), Some(Bvh));
        assert_eq!(cheapest(&measured(&[(Octree, 3.0), (Naive, 1.0), (Bvh, 2.0)])), Some(Naive));
        assert_eq!(cheapest(&measured(&[(Bvh, 2.0), (Octree, 2.0), (Naive, 2.0)])), Some(Naive));
        assert_eq!(cheapest(&[]), None);
    }

    #[test]
    fn the_reason_holds_every_number() {
        let counted = |accel, nodes_per_ray: f64, tests_per_ray: f64| {
            let cost_per_ray = 8.0 * (nodes_per_ray + tests_per_ray);
            Measured { accel, cost: CloudCost { rays: 9, nodes_per_ray, tests_per_ray, cost_per_ray } }
        };
        let measured = [
            counted(SphereAccel::Octree, 30.06, 9.9),
            counted(SphereAccel::Naive, 0.0, 100.0),
            counted(SphereAccel::Bvh, 12.3, 5.6),
        ];
        assert_eq!(
            because(&measured),
            "it is estimated to do the least work per ray, counted along sample rays: 12.3 node and 5.6 sphere tests, \
             against 30.1 and 9.9 (octree), 0.0 and 100.0 (naive)"
        );
        assert_eq!(because(&[]), "the scene has no spheres");
    }

    #[test]
    fn a_choice_stands_until_the_number_of_spheres_doubles_or_halves_or_the_settings_change() {
        let basis = |spheres| Basis { cloud: SphereCloud::default(), spheres };
        for (then, now, covers) in [
            (100, 100, true),
            (100, 199, true),
            (100, 200, false),
            (100, 51, true),
            (100, 50, false),
            (0, 1, false),
            (1, 0, false),
            (0, 0, true),
        ] {
            assert_eq!(basis(then).covers(&basis(now)), covers, "{then} {now}");
        }
        let other = Basis { cloud: SphereCloud { max_depth: 3, ..SphereCloud::default() }, spheres: 100 };
        assert!(!basis(100).covers(&other));
    }

    #[test]
    fn testing_every_sphere_is_measured_only_where_it_may_win() {
        assert!(candidates(NAIVE_MOST).contains(&SphereAccel::Naive));
        assert!(!candidates(NAIVE_MOST + 1).contains(&SphereAccel::Naive));
    }
}
