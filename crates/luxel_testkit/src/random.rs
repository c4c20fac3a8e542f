//! A stream of random numbers from a seed.
use glam::Vec3;
use luxel_geom::rng;

/// Numbers drawn one after the other; two streams of one seed are equal.
#[derive(Clone, Debug)]
pub struct Random {
    seed: u32,
    drawn: u32,
}

impl Random {
    /// The stream of a seed.
    pub fn new(seed: u32) -> Self {
        Self { seed, drawn: 0 }
    }

    /// The next 32 bits.
    pub fn word(&mut self) -> u32 {
        self.drawn += 1;
        rng::pcg4d([self.drawn, self.seed, 0x6c75_7865, 0x6c74_6573])[0]
    }

    /// A number in `[0, 1)`.
    pub fn uniform(&mut self) -> f32 {
        rng::uniform(self.word())
    }

    /// A number in `[lo, hi)`, up to rounding.
    pub fn between(&mut self, lo: f32, hi: f32) -> f32 {
        lo + (hi - lo) * self.uniform()
    }

    /// A number between `lo` and `hi`, every order of magnitude equally likely; both must be positive.
    pub fn log_between(&mut self, lo: f32, hi: f32) -> f32 {
        self.between(lo.log2(), hi.log2()).exp2()
    }

    /// A whole number below `end`.
    pub fn below(&mut self, end: u32) -> u32 {
        ((u64::from(self.word()) * u64::from(end)) >> 32) as u32
    }

    /// A point in the cube `[-reach, reach)³`.
    pub fn point(&mut self, reach: f32) -> Vec3 {
        Vec3::new(self.between(-reach, reach), self.between(-reach, reach), self.between(-reach, reach))
    }

    /// A direction of length about one.
    pub fn direction(&mut self) -> Vec3 {
        loop {
            let p = self.point(1.0);
            let length = p.length();
            if length > 0.1 && length <= 1.0 {
                return p / length;
            }
        }
    }

    /// A seeded permutation of a slice (Fisher and Yates).
    pub fn shuffle<T>(&mut self, items: &mut [T]) {
        for i in (1..items.len()).rev() {
            items.swap(i, self.below(i as u32 + 1) as usize);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_seed_names_a_stream() {
        let draw = |seed| {
            let mut random = Random::new(seed);
            [(); 8].map(|()| random.word())
        };
        assert_eq!(draw(1), draw(1));
        assert_ne!(draw(1), draw(2));
    }

    #[test]
    fn numbers_keep_their_bounds() {
        let mut random = Random::new(3);
        for _ in 0..1000 {
            assert!(random.below(7) < 7);
            assert!((0.0..1.0).contains(&random.uniform()));
            assert!((0.99..101.0).contains(&random.log_between(1.0, 100.0)));
            assert!((random.direction().length() - 1.0).abs() < 1e-5);
        }
    }

    #[test]
    fn a_shuffle_is_a_permutation() {
        let mut items: Vec<u32> = (0..100).collect();
        Random::new(4).shuffle(&mut items);
        assert_ne!(items, (0..100).collect::<Vec<_>>());
        items.sort_unstable();
        assert_eq!(items, (0..100).collect::<Vec<_>>());
    }
}
