//! Where local coordinates begin: power-of-two lattices that follow from the content alone.
//!
//! Worlds are in f64, tracers in f32. Everything that a tracer sees is relative to an anchor on a lattice
//! of powers of two, so that subtracting it is exact for coordinates that are not absurdly fine, and a
//! world moved by a multiple of the lattice's step gives the same bits (design.md §3, X01).
//!
//! The extent is built from origins and reaches, not from boxes: differences of origins survive a translation
//! exactly, rounded box corners do not.
use glam::DVec3;

/// Farthest coordinate, largest scale and largest inverse scale that single precision gets along with: its
/// square, summed three times, is still finite.
pub(crate) const LARGEST: f64 = (1u64 << 60) as f64;

/// Farthest that a sphere reaches and a camera stands from the world's origin: so that the way from the
/// tracers' anchor to the cloud's, and from there to its last sphere, stays below [`LARGEST`].
pub(crate) const FARTHEST: f64 = LARGEST / 4.0;

/// Where things are: the box of their origins, and how far the largest reaches from its own.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Extent {
    lo: DVec3,
    hi: DVec3,
    reach: f64,
}

impl Extent {
    /// One thing.
    pub(crate) fn new(origin: DVec3, reach: f64) -> Self {
        Self { lo: origin, hi: origin, reach }
    }

    /// All of several things; `None` for nothing.
    pub(crate) fn of(things: impl IntoIterator<Item = Self>) -> Option<Self> {
        things.into_iter().reduce(|a, b| a.union(&b))
    }

    /// How far it reaches from the world's origin along any axis, at most.
    pub(crate) fn farthest(&self) -> f64 {
        self.lo.abs().max(self.hi.abs()).max_element() + self.reach
    }

    /// Both.
    pub(crate) fn union(&self, other: &Self) -> Self {
        Self { lo: self.lo.min(other.lo), hi: self.hi.max(other.hi), reach: self.reach.max(other.reach) }
    }

    /// True if this extent might be smaller without that part of it.
    pub(crate) fn rests_on(&self, part: &Self) -> bool {
        part.lo.cmple(self.lo).any() || part.hi.cmpge(self.hi).any() || part.reach >= self.reach
    }

    fn center(&self) -> DVec3 {
        self.lo + (self.hi - self.lo) * 0.5
    }

    /// Longest edge of a box around everything.
    fn size(&self) -> f64 {
        (self.hi - self.lo).max_element() + 2.0 * self.reach
    }
}

/// The sphere cloud's own coordinates: a pure function of its content.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct CloudFrame {
    /// Origin in world space.
    pub anchor: DVec3,
    /// The root cell is the cube of this half edge around the origin: it holds every sphere.
    pub half_extent: f32,
}

impl CloudFrame {
    /// The frame of a cloud. Its anchor lies at most half a step from the centre, and the spheres another
    /// half step from there, so a half edge of one step holds them.
    pub(crate) fn of(extent: Option<&Extent>) -> Self {
        let Some(extent) = extent else { return Self { anchor: DVec3::ZERO, half_extent: 1.0 } };
        let step = power_of_two_at_least(extent.size());
        Self { anchor: snap(extent.center(), step), half_extent: step as f32 }
    }
}

/// The origin of tracer space: the eye, snapped to a lattice of about a thousandth of the content's extent.
/// Within a cell the camera moves without touching any instance.
pub(crate) fn tracer_anchor(eye: DVec3, extent: Option<&Extent>) -> DVec3 {
    let size = extent.map_or(1.0, Extent::size);
    snap(eye, power_of_two_at_least(size) * 2f64.powi(-10))
}

/// The nearest lattice point. Ties go up on both sides of zero, so that snapping commutes with translation.
fn snap(point: DVec3, step: f64) -> DVec3 {
    (point / step + 0.5).floor() * step
}

/// The smallest power of two that is not below a positive number; numbers beyond [`LARGEST`] and below its
/// inverse count as those.
fn power_of_two_at_least(x: f64) -> f64 {
    let x = x.clamp(1.0 / LARGEST, 4.0 * LARGEST);
    let below = f64::from_bits(x.to_bits() & (0x7ff << 52));
    if below == x { x } else { 2.0 * below }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn powers_of_two_are_exact() {
        for (x, expected) in [(1.0, 1.0), (1.1, 2.0), (0.75, 1.0), (0.5, 0.5), (1e-3, 1.0 / 512.0)] {
            assert_eq!(power_of_two_at_least(x), expected, "{x}");
        }
        assert_eq!(power_of_two_at_least(f64::MAX), 4.0 * LARGEST);
        assert_eq!(power_of_two_at_least(0.0), 1.0 / LARGEST);
    }

    #[test]
    fn the_root_cell_holds_the_cloud() {
        for (lo, hi, reach) in
            [(-3.0, 900.0, 0.25), (1e6, 1e6 + 1.0, 1000.0), (5.0, 5.0, 1e-3), (0.0, 1.0, 0.0)]
        {
            let extent = Extent { lo: DVec3::splat(lo), hi: DVec3::new(lo, lo, hi), reach };
            let frame = CloudFrame::of(Some(&extent));
            let far = (extent.lo - reach - frame.anchor).abs().max((extent.hi + reach - frame.anchor).abs());
            assert!(far.max_element() <= f64::from(frame.half_extent), "{extent:?} {frame:?}");
        }
    }

    #[test]
    fn frames_move_with_their_content() {
        let move_by = DVec3::splat((1 << 20) as f64);
        for origin in [DVec3::new(-0.5, 0.5, 1.5), DVec3::new(-7.25, 3.0, 0.0)] {
            let extent = Extent::new(origin, 0.3).union(&Extent::new(origin + 1.0, 0.1));
            let moved = Extent { lo: extent.lo + move_by, hi: extent.hi + move_by, ..extent };
            let (here, there) = (CloudFrame::of(Some(&extent)), CloudFrame::of(Some(&moved)));
            assert_eq!(there, CloudFrame { anchor: here.anchor + move_by, ..here });
            assert_eq!(
                tracer_anchor(origin + move_by, Some(&moved)),
                tracer_anchor(origin, Some(&extent)) + move_by
            );
        }
    }

    #[test]
    fn an_extent_knows_what_it_rests_on() {
        let all = Extent::of([0.0, 1.0, 2.0].map(|x| Extent::new(DVec3::splat(x), x))).unwrap();
        assert!(all.rests_on(&Extent::new(DVec3::ZERO, 0.0)));
        assert!(!all.rests_on(&Extent::new(DVec3::ONE, 1.0)));
        assert!(all.rests_on(&Extent::new(DVec3::ONE, 2.0)));
    }
}
