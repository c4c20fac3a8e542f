//! What keeps a world from being baked.
use thiserror::Error;

/// Why a world has no up-to-date flat scene. The last good one stays; once the cause is removed, the next run
/// goes on from there.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum BakeError {
    /// No entity has a `Camera`.
    #[error("the scene has no camera")]
    NoCamera,
    /// A camera that no picture can be taken with.
    #[error("{entity}: {message}")]
    BadCamera {
        /// The camera's entity.
        entity: String,
        /// What is wrong with it.
        message: &'static str,
    },
    /// A film without pixels.
    #[error("render settings: a film of {width} × {height} pixels holds no picture")]
    EmptyFilm {
        /// Pixels.
        width: u32,
        /// Pixels.
        height: u32,
    },
    /// An entity shows an asset that does not exist.
    #[error("{entity}: there is no {kind} with asset id {asset}")]
    MissingAsset {
        /// The entity.
        entity: String,
        /// `mesh` or `volume`.
        kind: &'static str,
        /// The id that it names.
        asset: u32,
    },
    /// An asset that no structure can be built for.
    #[error("{entity}: the {kind} with asset id {asset} cannot be used: {message}")]
    BadAsset {
        /// An entity that shows it.
        entity: String,
        /// `mesh` or `volume`.
        kind: &'static str,
        /// The asset.
        asset: u32,
        /// Why not.
        message: String,
    },
    /// A visible object without identity.
    #[error("{entity} has no StableId; create entities with luxel_scene::spawn")]
    NoStableId {
        /// The entity.
        entity: String,
    },
    /// Two spheres, or two placed objects, with one identity.
    #[error("stable id {id} belongs to two {kind}; every one needs an entity and an id of its own")]
    SharedStableId {
        /// The id.
        id: u32,
        /// `spheres` or `placed objects`.
        kind: &'static str,
    },
    /// A hierarchy that bites its tail.
    #[error("{entity} is its own ancestor, or descends from one that is")]
    CyclicHierarchy {
        /// The entity.
        entity: String,
    },
    /// More than 2³² − 1 records of a kind.
    #[error("the scene has more than {} records of one kind", u32::MAX)]
    HeapFull,
    /// A structure was refused; the message says which and why.
    #[error("acceleration structure: {0}")]
    Structure(#[from] luxel_accel::AccelError),
    /// The systems contradict each other: a fault of this crate.
    #[error("bake schedule: {0}")]
    Schedule(String),
    /// A baker works for the one world that it was made for.
    #[error("this baker was made for another world")]
    OtherWorld,
}
