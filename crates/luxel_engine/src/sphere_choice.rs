//! Which structure a scene's spheres get when the scene leaves the choice open: the cheapest by measurement.
//!
//! The costs are those of [`luxel_cpu::cloud_cost`]: work along fixed rays, counted and weighed, not timed, so that a
//! scene gets the same structure on every machine. A measurement costs about as much as a build; it is made again only when the
//! number of spheres has changed by a factor of two, or the settings of the cloud have.
use luxel_flat::SphereAccel;
use luxel_scene::SphereCloud;

/// With more spheres than this, testing all of them is out of the question and not even measured.
pub(crate) const NAIVE_MOST: u64 = 1_000;

/// A structure and what a ray costs with it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Measured {
    pub(crate) accel: SphereAccel,
    /// Cost per ray in the weights of [`luxel_cpu::cloud_cost`]: about nanoseconds.
    pub(crate) cost: f64,
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

/// The cheapest; of equals the simplest.
pub(crate) fn cheapest(measured: &[Measured]) -> Option<SphereAccel> {
    let key = |m: &&Measured| (m.cost, m.accel as u32);
    let best = measured.iter().min_by(|a, b| {
        let (a, b) = (key(a), key(b));
        a.0.total_cmp(&b.0).then(a.1.cmp(&b.1))
    });
    best.map(|measured| measured.accel)
}

/// Why the cheapest was taken, as the end of a sentence that begins with "because".
pub(crate) fn because(measured: &[Measured], spheres: u64) -> String {
    let mut by_cost = measured.to_vec();
    by_cost.sort_by(|a, b| a.cost.total_cmp(&b.cost).then((a.accel as u32).cmp(&(b.accel as u32))));
    let Some((best, others)) = by_cost.split_first() else {
        return "the scene has no spheres".to_owned();
    };
    let spheres = if spheres == 1 { "1 sphere".to_owned() } else { format!("{spheres} spheres") };
    let others: Vec<String> =
        others.iter().map(|m| format!("{:.1} with {}", m.cost, m.accel.name())).collect();
    format!("a ray among {spheres} costs about {:.1} ns with it, {}", best.cost, others.join(", "))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn measured(costs: &[(SphereAccel, f64)]) -> Vec<Measured> {
        costs.iter().map(|(accel, cost)| Measured { accel: *accel, cost: *cost }).collect()
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
        let measured =
            measured(&[(SphereAccel::Octree, 31.26), (SphereAccel::Naive, 100.0), (SphereAccel::Bvh, 28.0)]);
        assert_eq!(
            because(&measured, 100),
            "a ray among 100 spheres costs about 28.0 ns with it, 31.3 with octree, 100.0 with naive"
        );
        assert_eq!(because(&[], 0), "the scene has no spheres");
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
