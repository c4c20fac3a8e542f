//! State of a path between kernels, and what its first hit looked like.
use crate::layout::shared_struct;

shared_struct! {
    /// A path in flight: its ray, what it has gathered, and the ray's hit.
    ///
    /// Everything that a bounce needs stands here, so that any number of submits may lie between two bounces.
    pub struct Path {
        /// Origin of the current ray, tracer space.
        pub origin: [f32; 3],
        /// Pixel index, `y · width + x`.
        pub pixel: u32,
        /// Direction of the current ray, unit length.
        pub direction: [f32; 3],
        /// Sample index of the pixel.
        pub sample: u32,
        /// Product of the weights so far.
        pub throughput: [f32; 3],
        /// Surfaces met so far.
        pub bounce: u32,
        /// Radiance gathered so far.
        pub radiance: [f32; 3],
        /// `PATH_ALIVE` and how the ray leaves the excluded primitive.
        pub state: u32,
        /// Slot of the instance that the ray starts on, or `NONE`.
        pub exclude_instance: u32,
        /// Slot of the sphere, triangle or SVO node that the ray starts on.
        pub exclude_primitive: u32,
        /// Parameter of the hit; `FAR` if there is none.
        pub hit_t: f32,
        /// Slot of the hit instance, or `NONE`.
        pub hit_instance: u32,
        /// Slot of the hit sphere, triangle or SVO node.
        pub hit_slot: u32,
        /// Stable id of the hit primitive.
        pub hit_primitive: u32,
        /// Material slot of the hit.
        pub hit_material: u32,
        /// Nodes visited and primitives tested by the current ray.
        pub steps: u32,
        /// Barycentric weights of a triangle's second and third vertex; a voxel's face (0…5 = −x,+x,−y,…) and 0.
        pub hit_uv: [f32; 2],
        /// Product of the squared relative indices of refraction: what the roulette leaves out of the throughput.
        pub eta_scale: f32,
        /// Density per solid angle with which the ray's direction was scattered; 0 if no light could have been
        /// sampled instead: camera rays, mirrors, smooth glass.
        pub pdf: f32,
        /// Where the shadow ray starts, tracer space.
        pub shadow_origin: [f32; 3],
        /// 0, or `SHADOW_…` and how the shadow ray leaves the excluded primitive.
        pub shadow_state: u32,
        /// From there to the light; the parameter ends below 1.
        pub shadow_direction: [f32; 3],
        /// Packed unit normal (`luxel_geom::octahedral`) of the surface that the ray left: what the light tree weighed.
        pub normal: u32,
        /// Radiance that the path gathers if nothing is in the way.
        pub shadow_radiance: [f32; 3],
        /// Always 0.
        pub reserved: u32,
        /// Clear bodies that the ray is in, innermost first, as material slots; `NONE` where there are no more.
        pub media: [u32; 4],
    }
}

shared_struct! {
    /// The surface at the end of a path's ray: its place, its frame, its material with textures applied, and what it is
    /// to a path that is in the bodies of [`Path::media`].
    pub struct SurfacePoint {
        /// The point, tracer space.
        pub point: [f32; 3],
        /// Its light in the table of lights, or `NONE`.
        pub light: u32,
        /// Bound on the error of each component of `point`.
        pub error: [f32; 3],
        /// `MATERIAL_LAMBERT`, …, or `MATERIAL_NO_BORDER`.
        pub kind: u32,
        /// Unit geometric normal, outwards.
        pub normal: [f32; 3],
        /// `MATERIAL_EMISSIVE`, ….
        pub flags: u32,
        /// Unit normal that the material is shaded with, on the side of `normal`.
        pub shading_normal: [f32; 3],
        /// As in `MaterialRecord`.
        pub roughness: f32,
        /// Base colour.
        pub color: [f32; 3],
        /// As in `MaterialRecord`.
        pub metallic: f32,
        /// Emitted radiance.
        pub emission: [f32; 3],
        /// As in `MaterialRecord`.
        pub transmission: f32,
        /// As in `MaterialRecord`.
        pub specular_color: [f32; 3],
        /// As in `MaterialRecord`.
        pub specular: f32,
        /// Index of refraction over that of what is around the body.
        pub ior: f32,
        /// As in `MaterialRecord`.
        pub clearcoat: f32,
        /// As in `MaterialRecord`.
        pub clearcoat_roughness: f32,
        /// Material slot of the clear body that a ray enters or leaves which goes on beyond the surface, or `NONE`.
        pub body: u32,
    }
}

shared_struct! {
    /// First-hit outputs of a pixel ("arbitrary output variables").
    pub struct Aov {
        /// Sum over samples of the surface's albedo; 0 for the sky.
        pub albedo: [f32; 3],
        /// Distance from the camera in metres, of the pixel's first sample; 0 for the sky.
        pub depth: f32,
        /// Sum over samples of the unit normal on the camera's side; 0 for the sky.
        pub normal: [f32; 3],
        /// Stable id of the instance plus one, of the first sample; 0 for the sky.
        pub instance: u32,
        /// Hit point of the first sample, tracer space.
        pub position: [f32; 3],
        /// Stable id of the primitive, of the first sample.
        pub primitive: u32,
        /// Nodes visited and primitives tested by the first sample's camera ray.
        pub steps: u32,
        /// Always 0.
        pub reserved0: u32,
        /// Always 0.
        pub reserved1: u32,
        /// Always 0.
        pub reserved2: u32,
    }
}
