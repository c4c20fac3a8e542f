//! What is measured: pictures asked for, in the order in which they depend on each other.
use luxel_scene::AreaKind;

use super::land::Lighting;
use super::viewpoint::Viewpoint;

/// The decay factors and thresholds of table 5.1.
pub(super) const DECAYS: [f32; 6] = [0.05, 0.1, 0.15, 0.2, 0.25, 0.3];
pub(super) const THRESHOLDS: [f32; 6] = [0.175, 0.15, 0.125, 0.1, 0.075, 0.05];

/// A picture that is asked for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Ask {
    pub(super) sweep: Sweep,
    pub(super) area: AreaKind,
    pub(super) viewpoint: Viewpoint,
    pub(super) lighting: Lighting,
    /// How often the picture's edge is halved.
    pub(super) halvings: u32,
    pub(super) method: Method,
}

/// What a picture is made for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Sweep {
    /// Tables 5.2 to 5.26: renderers side by side.
    Renderers,
    /// Table 5.1: decay factors and thresholds.
    Decays,
    /// Tables 5.27 and 5.28: thresholds at the best decay factor.
    Thresholds,
    /// Tables 5.29 and 5.30.
    Resolutions,
    /// One improvement at a time.
    Improvements,
    /// The least rays for a quality (§5.4), for each decay factor.
    Tuning,
    /// Figures 3.7, 3.8 and 4.2 to 4.5: areas and the slackline from near by.
    Views,
    /// The faces of a light probe.
    Probe,
}

impl Sweep {
    pub(super) fn name(self) -> &'static str {
        match self {
            Self::Renderers => "renderers",
            Self::Decays => "decays",
            Self::Thresholds => "thresholds",
            Self::Resolutions => "resolutions",
            Self::Improvements => "improvements",
            Self::Tuning => "tuning",
            Self::Views => "views",
            Self::Probe => "probe",
        }
    }
}

/// How a picture is made.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Method {
    Plain,
    Reference,
    Adaptive { iterations: u32 },
    ErrorAware { variant: Variant, decay: Decay, goal: Goal },
}

/// What of the document's chapter 6 is on.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Variant {
    /// Errors from the table of directions instead of nine coefficients.
    pub(super) directions: bool,
    pub(super) keeps_ray: bool,
    pub(super) luminance: bool,
}

impl Variant {
    /// As the document has it.
    pub(super) const DOCUMENT: Self = Self { directions: false, keeps_ray: false, luminance: false };
    /// All improvements.
    pub(super) const ALL: Self = Self { directions: true, keeps_ray: true, luminance: true };

    pub(super) fn name(self) -> String {
        let names =
            [(self.directions, "directions"), (self.keeps_ray, "kept ray"), (self.luminance, "luminance")];
        names.iter().filter(|(is_on, _)| *is_on).map(|(_, name)| *name).collect::<Vec<_>>().join("+")
    }
}

/// Which decay factor.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Decay {
    Given(f32),
    /// The one that was best on the desert.
    Tuned,
}

/// How the threshold is chosen.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Goal {
    Given(f32),
    /// The one that was found on the desert.
    Tuned,
    /// As many rays as the adaptive renderer takes for the same picture.
    RaysOfAdaptive,
    /// As near to the reference as the adaptive renderer comes.
    QualityOfAdaptive,
    /// As near to the reference as the document's method comes with the tuned threshold.
    QualityOfErrorAware,
}

impl Goal {
    pub(super) fn name(self) -> &'static str {
        match self {
            Self::Given(_) => "given",
            Self::Tuned => "tuned",
            Self::RaysOfAdaptive => "rays of adaptive",
            Self::QualityOfAdaptive => "quality of adaptive",
            Self::QualityOfErrorAware => "quality of error-aware",
        }
    }
}

impl Ask {
    /// True if the page shows the picture.
    pub(super) fn is_shown(&self) -> bool {
        let is_side_by_side = match self.method {
            Method::Adaptive { iterations } => iterations == 1,
            Method::ErrorAware { goal, .. } => {
                matches!(goal, Goal::Tuned | Goal::QualityOfErrorAware) || self.sweep == Sweep::Thresholds
            }
            Method::Plain | Method::Reference => true,
        };
        is_side_by_side && !matches!(self.sweep, Sweep::Improvements | Sweep::Tuning)
    }
}

impl Ask {
    /// True of the picture by which figure 5.1 shows how the adaptive renderer goes about it.
    pub(super) fn shows_variance(&self) -> bool {
        let wanted =
            (Sweep::Renderers, AreaKind::Desert, Lighting::Albedo, Method::Adaptive { iterations: 1 });
        (self.sweep, self.area, self.lighting, self.method) == wanted
    }
}

/// Everything that is asked of one area; the desert's comes first, since the others use what is tuned there.
pub(super) fn asks(area: AreaKind) -> Vec<Ask> {
    let mut asks = Vec::new();
    let document = |decay, goal| Method::ErrorAware { variant: Variant::DOCUMENT, decay, goal };
    let mut ask = |sweep, lighting, halvings, method| {
        asks.push(Ask { sweep, area, viewpoint: Viewpoint::Above, lighting, halvings, method })
    };
    for lighting in Lighting::ALL {
        let mut compare = |method| ask(Sweep::Renderers, lighting, 0, method);
        compare(Method::Reference);
        compare(Method::Plain);
        (1..=3).for_each(|iterations| compare(Method::Adaptive { iterations }));
        if area == AreaKind::Desert && lighting == Lighting::Albedo {
            for decay in DECAYS {
                ask(Sweep::Decays, lighting, 0, document(Decay::Given(decay), Goal::RaysOfAdaptive));
            }
        }
        let mut compare = |method| ask(Sweep::Renderers, lighting, 0, method);
        compare(document(Decay::Tuned, Goal::Tuned));
        compare(document(Decay::Tuned, Goal::RaysOfAdaptive));
        for goal in [Goal::RaysOfAdaptive, Goal::QualityOfErrorAware] {
            compare(Method::ErrorAware { variant: Variant::ALL, decay: Decay::Tuned, goal });
        }
    }
    if area == AreaKind::Desert {
        let lighting = Lighting::Albedo;
        for (decay, threshold) in DECAYS.iter().flat_map(|d| THRESHOLDS.iter().map(move |t| (*d, *t))) {
            ask(Sweep::Decays, lighting, 0, document(Decay::Given(decay), Goal::Given(threshold)));
        }
        for decay in DECAYS {
            ask(Sweep::Tuning, lighting, 0, document(Decay::Given(decay), Goal::QualityOfAdaptive));
        }
        for threshold in THRESHOLDS {
            ask(Sweep::Thresholds, lighting, 0, document(Decay::Tuned, Goal::Given(threshold)));
        }
        for halvings in 0..4 {
            for method in
                [Method::Reference, Method::Adaptive { iterations: 1 }, document(Decay::Tuned, Goal::Tuned)]
            {
                ask(Sweep::Resolutions, lighting, halvings, method);
            }
        }
        let one = |directions, keeps_ray, luminance| Variant { directions, keeps_ray, luminance };
        for variant in
            [one(true, false, false), one(false, true, false), one(false, false, true), Variant::ALL]
        {
            for goal in [Goal::RaysOfAdaptive, Goal::QualityOfErrorAware] {
                ask(
                    Sweep::Improvements,
                    lighting,
                    0,
                    Method::ErrorAware { variant, decay: Decay::Tuned, goal },
                );
            }
        }
    }
    asks.extend(parts_of(area));
    asks
}

/// Pictures of parts of an area, and of a light probe.
fn parts_of(area: AreaKind) -> Vec<Ask> {
    let mut asks = Vec::new();
    let mut ask = |sweep, viewpoint, method| {
        asks.push(Ask { sweep, area, viewpoint, lighting: Lighting::Albedo, halvings: 0, method });
    };
    for viewpoint in [Viewpoint::Overview, Viewpoint::Near, Viewpoint::East] {
        ask(Sweep::Views, viewpoint, Method::Reference);
    }
    let tuned = |variant| Method::ErrorAware { variant, decay: Decay::Tuned, goal: Goal::Tuned };
    if area == AreaKind::Forest {
        for method in [Method::Reference, Method::Plain, tuned(Variant::DOCUMENT)] {
            ask(Sweep::Views, Viewpoint::Slackline, method);
        }
    }
    for face in Viewpoint::FACES {
        let adaptive = Method::Adaptive { iterations: 1 };
        for method in [Method::Reference, Method::Plain, adaptive, tuned(Variant::DOCUMENT)] {
            ask(Sweep::Probe, face, method);
        }
    }
    asks
}
