//! Uniforms: what is the same for every path of a scene, and for every path of a dispatch.
use crate::layout::{WgslType, shared_struct};

shared_struct! {
    /// A perspective camera with a thin lens, in tracer space.
    ///
    /// The ray through film position `(x, y)` in pixels (y downwards) has the direction
    /// `corner + x · dx + y · dy`; its third coordinate along the optical axis is 1.
    pub struct CameraRecord {
        /// Centre of the lens.
        pub origin: [f32; 3],
        /// Radius of the lens in metres; 0 for a pinhole.
        pub lens_radius: f32,
        /// Direction to the upper left corner of the film.
        pub corner: [f32; 3],
        /// Distance along the optical axis that is sharp, in metres; 1 for a pinhole.
        pub focus_distance: f32,
        /// Step from a pixel to the next on its right.
        pub dx: [f32; 3],
        /// Film width in pixels.
        pub width: u32,
        /// Step from a pixel to the next below it.
        pub dy: [f32; 3],
        /// Film height in pixels.
        pub height: u32,
        /// Unit vector to the right.
        pub right: [f32; 3],
        /// Always 0.
        pub reserved0: u32,
        /// Unit vector upwards.
        pub up: [f32; 3],
        /// Always 0.
        pub reserved1: u32,
    }
}

impl WgslType for CameraRecord {
    const NAME: &'static str = "CameraRecord";
    const ALIGN: usize = 16;
}

shared_struct! {
    /// What a snapshot of the scene fixes for every path.
    pub struct SceneParams {
        /// The camera.
        pub camera: CameraRecord,
        /// Radiance of the constant sky, and of the gradient's horizon.
        pub sky: [f32; 3],
        /// First node of the TLAS in the BVH heap.
        pub tlas_first: u32,
        /// Radiance of the gradient straight up.
        pub sky_zenith: [f32; 3],
        /// Number of nodes of the TLAS; 0 for an empty scene.
        pub tlas_count: u32,
        /// Radiance of the gradient straight down.
        pub sky_ground: [f32; 3],
        /// Seed of the random numbers.
        pub seed: u32,
        /// Number of surfaces a path may meet.
        pub max_depth: u32,
        /// Number of surfaces after which Russian roulette begins.
        pub roulette_depth: u32,
        /// Always 0.
        pub reserved0: u32,
        /// Always 0.
        pub reserved1: u32,
    }
}

shared_struct! {
    /// What one dispatch works on: consecutive pixels, one sample each.
    pub struct SliceParams {
        /// First pixel of the slice.
        pub pixel_first: u32,
        /// Number of pixels of the slice.
        pub pixel_count: u32,
        /// Sample index of every path of the slice.
        pub sample: u32,
        /// First pixel of the film tile that is bound.
        pub tile_first: u32,
    }
}

shared_struct! {
    /// How radiance becomes the picture that is shown.
    pub struct DisplayParams {
        /// Factor on radiance: 2 to the power of the exposure in stops.
        pub exposure: f32,
        /// `TONE_MAP_NONE`, `TONE_MAP_REINHARD`, `TONE_MAP_ACES` or `TONE_MAP_AGX`.
        pub tone_map: u32,
        /// Always 0.
        pub reserved0: u32,
        /// Always 0.
        pub reserved1: u32,
    }
}
