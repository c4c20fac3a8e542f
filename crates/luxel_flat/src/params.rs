//! Uniforms: what is the same for every path of a scene, and for every path of a dispatch.
use crate::layout::{WgslType, shared_struct};

shared_struct! {
    /// A camera in tracer space.
    ///
    /// Let `p = corner + x · dx + y · dy` for the film position `(x, y)` in pixels, y downwards. In perspective it is
    /// the direction of the ray, whose coordinate along the optical axis is 1. An orthographic camera's ray starts at
    /// `origin + p` and goes `forward`.
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
        /// `CAMERA_PERSPECTIVE` or `CAMERA_ORTHOGRAPHIC`.
        pub kind: u32,
        /// Unit vector upwards.
        pub up: [f32; 3],
        /// Always 0.
        pub reserved0: u32,
        /// Unit vector along the optical axis, away from the camera.
        pub forward: [f32; 3],
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
        /// First node of the TLAS in the GPU's buffer of BVH nodes: it stands behind those of the meshes.
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
        /// Number of lights that can be sampled one by one; the environment is not among them.
        pub light_count: u32,
        /// How many of them, the first, are infinitely far away.
        pub distant_count: u32,
        /// Width of the environment map in texels; 0 if there is none.
        pub environment_width: u32,
        /// Height of the environment map in texels.
        pub environment_height: u32,
        /// Cosine of the environment's turn about +Y.
        pub environment_cos: f32,
        /// Sine of the environment's turn about +Y.
        pub environment_sin: f32,
        /// Factor on the environment map's radiance.
        pub environment_strength: f32,
        /// Number of nodes of the light tree over the lights that are not infinitely far away.
        pub light_node_count: u32,
        /// `LIGHT_SAMPLING_…`.
        pub light_sampling: u32,
        /// Always 0.
        pub reserved0: u32,
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
