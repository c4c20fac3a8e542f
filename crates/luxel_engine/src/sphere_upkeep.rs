//! When a structure that was edited is built anew.
//!
//! A refit tree has two kinds of detours. Those that show: a ray costs more than it did after the last build. They
//! are rent, and the rule is that of ski rental (Karlin, Manasse, Rudolph, Sleator 1988, "Competitive Snoopy
//! Caching"): a build is due when the rent that was paid since the last one exceeds its price. And those that cannot
//! be seen without a build: when spheres shrink or part, a ray becomes cheaper, yet less so than in a fresh tree.
//! For those there is doubt: when an eighth of the spheres were touched and tracing has cost [`PATIENCE`] builds since
//! the last one, a build is made to see. If the cost falls by less than a tenth the patience doubles, else it
//! returns to [`PATIENCE`].
//!
//! What holds, in counted work: builds out of rent cost no more than the rent that was paid, builds out of doubt no
//! more than an eighth of tracing. A tree of which an eighth was touched is replaced at the first change after tracing
//! with it has cost the patience times a build. Only a useless build out of doubt doubles the patience: it is never
//! more than [`PATIENCE`], or twice what tracing had cost before the last such build. Not seen, and so borne, are
//! detours that do not show while less than an eighth was touched, and those of less than [`MEASURE_RAYS`] rays.
//!
//! Deviations from ski rental: what a fresh tree would cost now is taken to be what it cost at the last build, so
//! rent is also paid where the scene has become dearer to any tree; the build that it buys ends that. A loose octree
//! keeps the shape that it would be built in and pays no rent at all; it is doubted alike. Every number is counted work,
//! weighed ([`luxel_cpu::cloud_cost`]), none a time: two runs decide alike.

/// Builds that tracing must have cost before a build is made out of doubt, at first.
const PATIENCE: f64 = 8.0;
/// What the cost of a ray must fall to for a build to have been of use, as a part of that before.
const USEFUL: f64 = 0.9;
/// The part of the spheres that must have been touched for doubt.
const DOUBT_SHARE: u64 = 8;
/// Rays for which it is worth measuring what they cost: eight times those of a measurement.
const MEASURE_RAYS: f64 = 8.0 * 1_024.0;
/// Nanoseconds of building a structure, per sphere and level of a balanced binary tree: 100,000 spheres in 0.1 s, which
/// is what the benches ask of the BVH.
const BUILD_COST: f64 = 60.0;

/// Why a build is due.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Cause {
    /// Detours that showed have cost as much.
    Rent,
    /// There may be detours that do not show.
    Doubt,
}

/// What is known of a structure since it was built. Costs of a ray are nanoseconds, as counted.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Upkeep {
    pays_rent: bool,
    patience: f64,
    built_cost: f64,
    /// Touched spheres, counted since ever, at the last build.
    built_touched: u64,
    cost: f64,
    /// The same at the last measurement.
    touched: u64,
    /// Rays of which the cost is not known yet.
    rays: f64,
    /// Cost of all rays since the build, and what of it is more than they would have cost then.
    traced: f64,
    rent: f64,
}

impl Upkeep {
    /// A structure that was just built and measured. `touched` counts touched spheres since ever.
    pub(crate) fn new(pays_rent: bool, cost: f64, touched: u64) -> Self {
        Self {
            pays_rent,
            patience: PATIENCE,
            built_cost: cost,
            built_touched: touched,
            cost,
            touched,
            rays: 0.0,
            traced: 0.0,
            rent: 0.0,
        }
    }

    /// The same structure, just built anew.
    pub(crate) fn renewed(&self, cost: f64, touched: u64) -> Self {
        Self { patience: self.patience, ..Self::new(self.pays_rent, cost, touched) }
    }

    /// Takes in rays that were traced while `touched` spheres had been touched. `measure` says what one of them cost,
    /// and is asked only if something was touched since the last time and the rays are worth it.
    pub(crate) fn trace(&mut self, rays: f64, touched: u64, measure: impl FnOnce() -> f64) {
        self.rays += rays;
        if touched != self.touched {
            if self.rays < MEASURE_RAYS {
                return;
            }
            (self.cost, self.touched) = (measure(), touched);
        }
        let extra = if self.pays_rent { (self.cost - self.built_cost).max(0.0) } else { 0.0 };
        self.rent += extra * self.rays;
        self.traced += self.cost * self.rays;
        self.rays = 0.0;
    }

    /// Why a build at that cost is due; `None` if it is not.
    pub(crate) fn due(&self, build_cost: f64, touched: u64, spheres: u64) -> Option<Cause> {
        let has_changed = touched.saturating_sub(self.built_touched) * DOUBT_SHARE >= spheres.max(1);
        if self.rent > build_cost {
            Some(Cause::Rent)
        } else if has_changed && self.traced > self.patience * build_cost {
            Some(Cause::Doubt)
        } else {
            None
        }
    }

    /// Takes in a build: what a ray cost just before and what it costs now.
    pub(crate) fn built(&mut self, cause: Cause, before: f64, cost: f64, touched: u64) {
        if cost <= USEFUL * before {
            self.patience = PATIENCE;
        } else if cause == Cause::Doubt {
            self.patience *= 2.0;
        }
        *self = self.renewed(cost, touched);
    }
}

/// Nanoseconds of building a structure of that many spheres.
pub(crate) fn build_cost(spheres: u64) -> f64 {
    let spheres = spheres.max(2) as f64;
    BUILD_COST * spheres * spheres.log2()
}

#[cfg(test)]
mod tests {
    use luxel_testkit::Random;

    use super::*;

    const SPHERES: u64 = 1_000;
    const PRICE: f64 = 1e6;

    /// Traces that many rays at a cost after another sphere was touched.
    fn trace(upkeep: &mut Upkeep, rays: f64, cost: f64) {
        upkeep.trace(rays, upkeep.touched + 1, || cost);
    }

    fn due(upkeep: &Upkeep) -> Option<Cause> {
        upkeep.due(PRICE, upkeep.touched, SPHERES)
    }

    #[test]
    fn a_build_is_due_once_the_detours_have_cost_as_much() {
        let mut upkeep = Upkeep::new(true, 10.0, 0);
        trace(&mut upkeep, 1e6, 10.0);
        assert_eq!(due(&upkeep), None, "no detour costs nothing");
        let causes: Vec<_> = (0..4).map(|_| (trace(&mut upkeep, 2e5, 12.0), due(&upkeep)).1).collect();
        assert_eq!(causes, [None, None, Some(Cause::Rent), Some(Cause::Rent)]);
        upkeep.built(Cause::Rent, 12.0, 11.9, upkeep.touched);
        assert_eq!((due(&upkeep), upkeep.patience), (None, PATIENCE));
    }

    #[test]
    fn a_structure_that_became_cheaper_saves_nothing_up_but_is_doubted() {
        let mut upkeep = Upkeep::new(true, 10.0, 0);
        upkeep.trace(4e6, SPHERES / 8 - 1, || 2.0);
        upkeep.trace(1e4, SPHERES / 8 - 1, || 0.0);
        assert_eq!(due(&upkeep), None, "too few were touched");
        upkeep.trace(1e4, SPHERES / 8, || 2.0);
        assert_eq!(due(&upkeep), Some(Cause::Doubt));
        upkeep.trace(6e5, SPHERES, || 12.0);
        assert_eq!(due(&upkeep), Some(Cause::Rent));
    }

    #[test]
    fn rays_are_measured_when_they_are_worth_it_and_then_all_of_them() {
        let mut upkeep = Upkeep::new(true, 10.0, 5);
        upkeep.trace(1e5, 5, || panic!("nothing was touched"));
        upkeep.trace(100.0, 6, || panic!("a hundred rays are not worth it"));
        assert_eq!((upkeep.rays, upkeep.traced), (100.0, 1e6));
        upkeep.trace(MEASURE_RAYS, 7, || 20.0);
        assert_eq!((upkeep.rays, upkeep.traced), (0.0, 1e6 + 20.0 * (MEASURE_RAYS + 100.0)));
    }

    #[test]
    fn useless_builds_become_rarer_and_a_useful_one_brings_doubt_back() {
        let mut upkeep = Upkeep::new(false, 10.0, 0);
        let mut gap_to_next = |fresh: f64| {
            let frames = (1..).find(|_| {
                upkeep.trace(1e5, upkeep.touched + SPHERES, || 10.0);
                due(&upkeep).is_some()
            });
            upkeep.built(Cause::Doubt, 10.0, fresh, upkeep.touched);
            frames
        };
        let gaps = [10.0, 10.0, 9.5, 5.0, 10.0].map(&mut gap_to_next);
        assert_eq!(gaps, [Some(9), Some(17), Some(33), Some(65), Some(9)]);
    }

    #[test]
    fn a_loose_octree_pays_no_rent() {
        let mut upkeep = Upkeep::new(false, 1.0, 0);
        trace(&mut upkeep, PRICE, 7.9);
        assert_eq!(due(&upkeep), None);
    }

    #[test]
    fn a_build_for_another_reason_leaves_the_patience() {
        let mut upkeep = Upkeep::new(true, 10.0, 0);
        upkeep.built(Cause::Doubt, 10.0, 10.0, 0);
        trace(&mut upkeep, 1e6, 20.0);
        let renewed = upkeep.renewed(5.0, 7);
        assert_eq!(renewed, Upkeep { patience: 2.0 * PATIENCE, ..Upkeep::new(true, 5.0, 7) });
    }

    /// Ten thousand frames of costs that wander, and trees that are sometimes better for a build and sometimes not.
    #[test]
    fn builds_cost_no_more_than_the_rent_and_an_eighth_of_tracing() {
        let mut random = Random::new(11);
        for use_of_builds in [1.0, 0.5, 0.0] {
            let (mut upkeep, mut fresh, mut detour) = (Upkeep::new(true, 50.0, 0), 50.0_f64, 1.0_f64);
            let (mut traced, mut rent, mut bought) = (0.0, 0.0, [0.0, 0.0]);
            for _ in 0..10_000 {
                fresh = (fresh * f64::from(random.between(0.95, 1.05))).clamp(5.0, 500.0);
                detour *= 1.0 + 0.02 * f64::from(random.between(0.0, 1.0));
                let (cost, rays) = (fresh * detour, f64::from(random.between(1e4, 4e4)));
                traced += cost * rays;
                rent += (cost - upkeep.built_cost).max(0.0) * rays;
                upkeep.trace(rays, upkeep.touched + SPHERES / 3, || cost);
                let Some(cause) = due(&upkeep) else { continue };
                bought[cause as usize] += PRICE;
                detour = if f64::from(random.between(0.0, 1.0)) < use_of_builds { 1.0 } else { detour };
                upkeep.built(cause, cost, fresh * detour, upkeep.touched);
            }
            assert!(bought[0] <= rent && bought[0] > 0.0, "{bought:?} of {rent}");
            assert!(bought[1] <= traced / PATIENCE, "{bought:?} of {traced}");
        }
    }

    /// Trees that no build betters, under costs that never rise: the builds grow with the logarithm of tracing.
    #[test]
    fn needless_builds_grow_with_the_logarithm_of_tracing() {
        let mut upkeep = Upkeep::new(true, 10.0, 0);
        let mut builds = 0;
        for _ in 0..100_000 {
            upkeep.trace(1e5, upkeep.touched + SPHERES, || 10.0);
            if let Some(cause) = due(&upkeep) {
                builds += 1;
                upkeep.built(cause, 10.0, 10.0, upkeep.touched);
            }
        }
        // 8 + 16 + … + 8 · 2¹² builds' worth of tracing fit into 100,000, one doubling more does not.
        assert_eq!(builds, 13);
    }
}
