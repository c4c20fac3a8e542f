//! What the systems write down while they work: the revision of the run, work done, complaints.
//!
//! Complaints are state, not events: each has a place (entity and topic), is looked at again whenever the
//! entity is touched, and goes away with its cause.
use std::collections::BTreeMap;
use std::fmt;

use bevy_ecs::prelude::{Entity, Res, ResMut, Resource};
use bevy_ecs::system::SystemParam;

use crate::objects::ObjectItem;
use crate::{BakeCounters, BakeError};

/// The number that this run stamps what it writes with. Grows with every run.
#[derive(Resource, Default)]
pub(crate) struct Revision(pub u64);

/// What a complaint is about.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum Topic {
    Hierarchy,
    Material,
    Opacity,
    Textures,
    Texels,
    Environment,
    Attributes,
    Lamp,
    Lights,
    Emitters,
    Sphere,
    SphereScale,
    Mesh,
    MeshInstance,
    Volume,
    VolumeInstance,
    Slot,
    Joined,
    Tlas,
}

/// Why an object of the world is not in the picture although it is visible.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Disabled {
    /// Its transform holds a NaN or an infinity.
    NotFinite,
    /// Its transform has no inverse: a scale of zero, or axes in one plane.
    Singular,
    /// It is farther away, larger or smaller than single precision can handle: beyond 2^±60 metres
    /// (2^58 for spheres).
    OutOfRange,
    /// A sphere whose radius is not a positive number.
    BadRadius,
    /// Its asset holds no primitive.
    Empty,
}

impl fmt::Display for Disabled {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::NotFinite => "its transform is not finite",
            Self::Singular => "its transform has no inverse",
            Self::OutOfRange => "it is too far away, too large or too small for single precision",
            Self::BadRadius => "its radius is not a positive number",
            Self::Empty => "there is nothing in it",
        })
    }
}

/// Something that is drawn otherwise than the scene says.
#[derive(Clone, Debug, PartialEq)]
pub enum BakeWarning {
    /// An object is left out.
    Disabled {
        /// The entity.
        entity: String,
        /// Why.
        reason: Disabled,
    },
    /// Textures are left out.
    Textures {
        /// The entity.
        entity: String,
        /// Which, and why.
        faults: String,
    },
    /// Images are shown smaller than they are, so that they fit into memory.
    ShrunkImages {
        /// Bytes that they may take.
        budget: u64,
        /// Asset id, width and height of the image, width and height that it is shown at.
        images: Vec<(u32, [u32; 2], [u32; 2])>,
    },
    /// There is no image of the surroundings; they are black.
    NoEnvironment {
        /// Asset id.
        asset: u32,
    },
    /// There are too many lights to sample them all.
    UnsampledLights {
        /// Triangles that are found by scattering alone.
        triangles: u64,
    },
    /// Surfaces whose emission has a texture, or that have holes, are no lights that can be sampled.
    UnevenLights {
        /// Materials that are found by scattering alone.
        materials: u64,
    },
    /// The opacity of a sphere or of voxels has no effect.
    IgnoredOpacity {
        /// The entity.
        entity: String,
    },
    /// A sphere under a non-uniform scale is drawn as a sphere of the largest axis.
    NonUniformSphere {
        /// The entity.
        entity: String,
    },
}

impl BakeWarning {
    /// Why an object is left out; `None` if it is shown.
    pub fn reason(&self) -> Option<Disabled> {
        match self {
            Self::Disabled { reason, .. } => Some(*reason),
            _ => None,
        }
    }

    /// True if both are of one kind, for one reason.
    pub(crate) fn is_like(&self, other: &Self) -> bool {
        std::mem::discriminant(self) == std::mem::discriminant(other) && self.reason() == other.reason()
    }
}

impl fmt::Display for BakeWarning {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Disabled { entity, reason } => write!(f, "{entity} is not shown: {reason}"),
            Self::Textures { entity, faults } => {
                write!(f, "{entity} is shown without some of its textures ({faults})")
            }
            Self::ShrunkImages { budget, images } => fmt_shrunk(f, *budget, images),
            Self::NoEnvironment { asset } => {
                write!(f, "the surroundings are black: there is no usable image with asset id {asset}")
            }
            Self::UnsampledLights { triangles } => {
                write!(
                    f,
                    "{triangles} shining triangles are too many to be sampled as lights; pictures will be noisy"
                )
            }
            Self::UnevenLights { materials } => {
                let are = if *materials == 1 {
                    "material with a texture or holes is"
                } else {
                    "materials with a texture or holes are"
                };
                write!(f, "{materials} emitting {are} found by scattering only, not sampled as lights")
            }
            Self::IgnoredOpacity { entity } => {
                write!(f, "{entity} is opaque: spheres and voxels have no opacity")
            }
            Self::NonUniformSphere { entity } => {
                write!(
                    f,
                    "{entity} is scaled differently along its axes; it is drawn as a sphere of the largest"
                )
            }
        }
    }
}

/// Images that are told one by one.
const IMAGES_TOLD: usize = 5;

fn fmt_shrunk(f: &mut fmt::Formatter<'_>, budget: u64, images: &[(u32, [u32; 2], [u32; 2])]) -> fmt::Result {
    write!(f, "images do not fit into {budget} bytes; smaller than they are:")?;
    for (i, (id, from, to)) in images.iter().take(IMAGES_TOLD).enumerate() {
        let separator = if i == 0 { "" } else { "," };
        write!(f, "{separator} image {id} ({}×{}) at {}×{}", from[0], from[1], to[0], to[1])?;
    }
    match images.len().saturating_sub(IMAGES_TOLD) {
        0 => Ok(()),
        more => write!(f, ", and {more} more"),
    }
}

/// Why an object gets no place in the flat scene.
#[derive(Clone, Debug)]
pub(crate) enum Refusal {
    /// The scene cannot be shown without it.
    Error(BakeError),
    /// The scene is shown without it.
    Warning(BakeWarning),
}

impl Refusal {
    /// An object that is left out.
    pub(crate) fn disabled(object: &ObjectItem, reason: Disabled) -> Self {
        Self::Warning(BakeWarning::Disabled { entity: object.label(), reason })
    }
}

impl From<BakeError> for Refusal {
    fn from(error: BakeError) -> Self {
        Self::Error(error)
    }
}

/// Complaints by place.
#[derive(Resource, Default)]
pub(crate) struct Complaints {
    pub errors: BTreeMap<(Entity, Topic), BakeError>,
    pub warnings: BTreeMap<(Entity, Topic), BakeWarning>,
}

/// What every system needs in order to write.
#[derive(SystemParam)]
pub(crate) struct Journal<'w> {
    revision: Res<'w, Revision>,
    pub counters: ResMut<'w, BakeCounters>,
    complaints: ResMut<'w, Complaints>,
}

impl Journal<'_> {
    /// The stamp of this run.
    pub(crate) fn revision(&self) -> u64 {
        self.revision.0
    }

    /// States what is wrong at a place, or that nothing is.
    pub(crate) fn error(&mut self, entity: Entity, topic: Topic, error: Option<BakeError>) {
        match error {
            Some(error) => _ = self.complaints.errors.insert((entity, topic), error),
            None => _ = self.complaints.errors.remove(&(entity, topic)),
        }
    }

    /// States what is odd at a place, or that nothing is. Said aloud when it is new.
    pub(crate) fn warning(&mut self, entity: Entity, topic: Topic, warning: Option<BakeWarning>) {
        let place = (entity, topic);
        let Some(warning) = warning else {
            self.complaints.warnings.remove(&place);
            return;
        };
        if self.complaints.warnings.get(&place) != Some(&warning) {
            tracing::warn!("{warning}");
            self.complaints.warnings.insert(place, warning);
        }
    }

    /// Files what was refused at a place, and returns what was not.
    pub(crate) fn settle<T>(
        &mut self,
        entity: Entity,
        topic: Topic,
        outcome: Result<Option<T>, Refusal>,
    ) -> Option<T> {
        let (value, error, warning) = match outcome {
            Ok(value) => (value, None, None),
            Err(Refusal::Error(error)) => (None, Some(error), None),
            Err(Refusal::Warning(warning)) => (None, None, Some(warning)),
        };
        self.error(entity, topic, error);
        self.warning(entity, topic, warning);
        value
    }

    /// The first thing that keeps the scene from being shown, if there is one.
    pub(crate) fn first_error(&self) -> Option<BakeError> {
        self.complaints.errors.values().next().cloned()
    }
}
