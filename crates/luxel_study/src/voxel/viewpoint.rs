//! Where pictures of an area are taken from.
use glam::Vec3;
use luxel_lod::View;
use luxel_scene::AREA_EXTENT;

/// A place to look from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Viewpoint {
    /// Straight down from above the middle (seed document 3, §5.1.1).
    Above,
    /// The whole area from a corner.
    Overview,
    /// The middle from near by.
    Near,
    /// The eastern part from near by.
    East,
    /// The forest's slackline.
    Slackline,
    /// A face of a light probe where the camera above stands; in the order of [`View::cube`].
    Face(usize),
}

/// The smallest pictures of table 5.29, 64² at full size, are those of a light probe's faces.
const PROBE_HALVINGS: u32 = 3;

/// Of a view of part of an area: eye and target in metres, heights over the mean ground, and the tangent of half the
/// field of view.
const PARTS: [(Viewpoint, Vec3, Vec3, f32); 4] = [
    (Viewpoint::Overview, Vec3::new(120.0, 230.0, 660.0), Vec3::new(250.0, -10.0, 260.0), 0.5),
    (Viewpoint::Near, Vec3::new(190.0, 42.0, 520.0), Vec3::new(240.0, -18.0, 330.0), 0.42),
    (Viewpoint::East, Vec3::new(330.0, 95.0, 480.0), Vec3::new(415.0, 0.0, 250.0), 0.42),
    (Viewpoint::Slackline, Vec3::new(272.0, 57.0, 336.0), Vec3::new(262.0, 43.0, 300.0), 0.55),
];

impl Viewpoint {
    /// The six faces of a light probe.
    pub(super) const FACES: [Self; 6] =
        [Self::Face(0), Self::Face(1), Self::Face(2), Self::Face(3), Self::Face(4), Self::Face(5)];

    /// As records have it.
    pub(super) fn name(self) -> &'static str {
        match self {
            Self::Above => "above",
            Self::Overview => "overview",
            Self::Near => "near",
            Self::East => "east",
            Self::Slackline => "slackline",
            Self::Face(n) => ["face +x", "face -x", "face +y", "face -y", "face +z", "face -z"][n.min(5)],
        }
    }

    /// The view, of an area of `size` voxels whose mean ground is at height `ground`; `above` is that from above.
    pub(super) fn view(self, above: &View, ground: f32, size: u32) -> View {
        if let Self::Face(n) = self {
            return View::cube(above.eye, above.size)[n.min(5)].resized(PROBE_HALVINGS);
        }
        let Some((_, eye, target, half)) = PARTS.iter().find(|(part, ..)| *part == self) else {
            return *above;
        };
        // The slackline's heights are the clearing's, whatever the mean.
        let base = if self == Self::Slackline { 0.0 } else { ground };
        let place = |metres: Vec3| metres * (size as f32 / AREA_EXTENT) + Vec3::Y * base;
        View::toward(place(*eye), place(*target), 2.0 * half.atan(), above.size)
    }
}
