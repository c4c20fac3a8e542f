//! When a structure whose spheres have moved is built anew: when the detours that its rays have made are worth a
//! build.
//!
//! The rule is that of ski rental (Karlin, Manasse, Rudolph, Sleator 1988, "Competitive Snoopy Caching"): rent until
//! the rent that was paid equals the price, then buy. Without knowing what moves next, the cost is at most twice that
//! of the best decision. The rent of a frame is what its rays cost more than they did after the last build; the price
//! is the cost of a build.
//!
//! Deviations: the cost of a ray is not measured every frame but when an eighth of the spheres were touched since the
//! last time, and what a fresh build would cost now is taken to be what it cost then. Every number is counted work,
//! weighed ([`luxel_cpu::cloud_cost`]), none a time: two runs decide alike.

/// The part of the spheres that must have been touched for another measurement.
const MEASURE_SHARE: u64 = 8;

/// Nanoseconds of building a structure, per sphere and level of a balanced binary tree: 100,000 spheres in 0.1 s, which
/// is what the benches ask of the BVH.
const BUILD_COST: f64 = 60.0;

/// What is known of a structure since it was built. Costs are nanoseconds per ray, as counted.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Upkeep {
    built_cost: f64,
    cost: f64,
    /// Extra cost of all rays of all frames since the build.
    paid: f64,
    /// Touched spheres, counted since ever, at the last measurement.
    touched: u64,
}

impl Upkeep {
    /// A structure that was just built and measured. `touched` counts touched spheres since ever.
    pub(crate) fn new(cost: f64, touched: u64) -> Self {
        Self { built_cost: cost, cost, paid: 0.0, touched }
    }

    /// True if so much has moved since the last measurement that the cost may be another.
    pub(crate) fn is_measurement_due(&self, touched: u64, spheres: u64) -> bool {
        (touched - self.touched) * MEASURE_SHARE >= spheres.max(1)
    }

    /// Takes in a measurement.
    pub(crate) fn measured(&mut self, cost: f64, touched: u64) {
        (self.cost, self.touched) = (cost, touched);
    }

    /// Takes in a frame of that many rays. True if a build pays now.
    pub(crate) fn pay(&mut self, rays: f64, build_cost: f64) -> bool {
        self.paid += (self.cost - self.built_cost).max(0.0) * rays;
        self.paid > build_cost
    }
}

/// Nanoseconds of building a structure of that many spheres.
pub(crate) fn build_cost(spheres: u64) -> f64 {
    let spheres = spheres.max(2) as f64;
    BUILD_COST * spheres * spheres.log2()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_build_pays_once_the_detours_have_cost_as_much() {
        let mut upkeep = Upkeep::new(10.0, 0);
        assert!(!upkeep.pay(1_000.0, 5_000.0), "no detour costs nothing");
        upkeep.measured(12.0, 100);
        let paid: Vec<bool> = (0..4).map(|_| upkeep.pay(1_000.0, 5_000.0)).collect();
        assert_eq!(paid, [false, false, true, true]);
    }

    #[test]
    fn a_structure_that_became_cheaper_saves_nothing_up() {
        let mut upkeep = Upkeep::new(10.0, 0);
        upkeep.measured(2.0, 100);
        assert!((0..1_000).all(|_| !upkeep.pay(1e6, 1.0)));
        upkeep.measured(11.0, 200);
        assert!(upkeep.pay(2.0, 1.0));
    }

    #[test]
    fn an_eighth_of_the_spheres_makes_a_measurement_due() {
        let mut upkeep = Upkeep::new(10.0, 50);
        assert!(!upkeep.is_measurement_due(50 + 124, 1_000));
        assert!(upkeep.is_measurement_due(50 + 125, 1_000));
        upkeep.measured(10.0, 175);
        assert!(!upkeep.is_measurement_due(175, 1_000));
        assert!(!upkeep.is_measurement_due(175, 0) && upkeep.is_measurement_due(176, 0));
    }

    /// Against every possible moment to build, on a cost that rises with each frame: never more than twice the best.
    #[test]
    fn the_rule_costs_at_most_twice_the_best() {
        let price = 1_000.0;
        for slope in [0.5, 3.0, 40.0, 900.0] {
            let rent = |age: u32| slope * f64::from(age);
            // Builds every `period` frames, the best of them all.
            let of_period = |period: u32| -> f64 {
                (0..2_000)
                    .map(|frame| rent(frame % period) + if frame % period == 0 { price } else { 0.0 })
                    .sum()
            };
            let best = (1..=2_000).map(of_period).fold(f64::MAX, f64::min);
            let (mut upkeep, mut age, mut total) = (Upkeep::new(0.0, 0), 0, price);
            for _ in 0..2_000 {
                upkeep.measured(rent(age), 0);
                total += rent(age);
                age += 1;
                if upkeep.pay(1.0, price) {
                    (upkeep, age, total) = (Upkeep::new(0.0, 0), 0, total + price);
                }
            }
            assert!(total <= 2.0 * best + 2.0 * price, "slope {slope}: {total} against {best}");
        }
    }
}
