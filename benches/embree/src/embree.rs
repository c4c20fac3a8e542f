//! Embree 4 through its C interface, loaded at run time: single rays against its spheres or triangles.
//!
//! Constants and layouts as in Embree's public headers `rtcore_*.h`, version 4.
use std::ffi::{CStr, c_char, c_uint, c_void};
use std::ptr::null;

use libloading::{Library, Symbol};
use luxel_flat::SphereRecord;
use luxel_geom::Ray;

use crate::model::Model;
use crate::{AnyHit, Engine, Hit};

const GEOMETRY_TYPE_TRIANGLE: c_uint = 0;
const GEOMETRY_TYPE_SPHERE_POINT: c_uint = 50;
const BUFFER_TYPE_INDEX: c_uint = 0;
const BUFFER_TYPE_VERTEX: c_uint = 1;
const FORMAT_UINT3: c_uint = 0x5003;
const FORMAT_FLOAT3: c_uint = 0x9003;
const FORMAT_FLOAT4: c_uint = 0x9004;
const INVALID_ID: u32 = u32::MAX;
const THREADS: [&CStr; 2] = [c"threads=1,user_threads=1", c"threads=2,user_threads=2"];

/// `RTCBuildQuality`.
#[derive(Clone, Copy)]
pub enum Quality {
    Medium = 1,
    High = 2,
}

type Handle = *mut c_void;

/// `RTCRayHit`.
#[repr(C, align(16))]
struct RayHit {
    origin: [f32; 3],
    t_near: f32,
    direction: [f32; 3],
    time: f32,
    t_far: f32,
    mask: u32,
    id: u32,
    flags: u32,
    normal: [f32; 3],
    uv: [f32; 2],
    primitive: u32,
    geometry: u32,
    instances: [u32; 2],
}

/// A committed scene of one geometry.
pub struct Embree {
    scene: Handle,
    /// The scene reads them in place.
    _buffers: Vec<Vec<[f32; 4]>>,
    _indices: Vec<[u32; 3]>,
    intersect: unsafe extern "C" fn(Handle, *mut RayHit, *const c_void),
    occluded: unsafe extern "C" fn(Handle, *mut RayHit, *const c_void),
    release_scene: unsafe extern "C" fn(Handle),
}

// SAFETY: a committed scene is only read.
unsafe impl Sync for Embree {}

/// A shared buffer: type, format, address, bytes per item, items.
type Buffer = (c_uint, c_uint, *const c_void, usize, usize);

impl Embree {
    pub fn build(records: &[SphereRecord]) -> Self {
        let spheres: Vec<[f32; 4]> =
            records.iter().map(|r| [r.center[0], r.center[1], r.center[2], r.radius]).collect();
        let buffer = (BUFFER_TYPE_VERTEX, FORMAT_FLOAT4, spheres.as_ptr().cast(), 16, spheres.len());
        let scene = commit(device(1), GEOMETRY_TYPE_SPHERE_POINT, Quality::Medium, &[buffer]);
        Self::over(scene, vec![spheres], Vec::new())
    }

    pub fn mesh(model: &Model, quality: Quality, threads: usize) -> Self {
        let positions: Vec<[f32; 4]> = model.positions.iter().map(|p| p.extend(0.0).to_array()).collect();
        let indices = model.indices.clone();
        let buffers = [
            (BUFFER_TYPE_VERTEX, FORMAT_FLOAT3, positions.as_ptr().cast(), 16, positions.len()),
            (BUFFER_TYPE_INDEX, FORMAT_UINT3, indices.as_ptr().cast(), 12, indices.len()),
        ];
        let scene = commit(device(threads), GEOMETRY_TYPE_TRIANGLE, quality, &buffers);
        Self::over(scene, vec![positions], indices)
    }

    fn over(scene: Handle, buffers: Vec<Vec<[f32; 4]>>, indices: Vec<[u32; 3]>) -> Self {
        // SAFETY: the signatures are those of Embree 4.
        unsafe {
            let (intersect, occluded) = (function(b"rtcIntersect1"), function(b"rtcOccluded1"));
            let release_scene = function(b"rtcReleaseScene");
            Self { scene, _buffers: buffers, _indices: indices, intersect, occluded, release_scene }
        }
    }
}

/// A scene of one geometry over buffers that outlive it.
fn commit(device: Handle, kind: c_uint, quality: Quality, buffers: &[Buffer]) -> Handle {
    type SetBuffer = unsafe extern "C" fn(Handle, c_uint, c_uint, c_uint, *const c_void, usize, usize, usize);
    // SAFETY: the signatures are those of Embree 4.
    unsafe {
        let scene = function::<unsafe extern "C" fn(Handle) -> Handle>(b"rtcNewScene")(device);
        function::<unsafe extern "C" fn(Handle, c_uint)>(b"rtcSetSceneBuildQuality")(
            scene,
            quality as c_uint,
        );
        let new_geometry: unsafe extern "C" fn(Handle, c_uint) -> Handle = function(b"rtcNewGeometry");
        let geometry = new_geometry(device, kind);
        for &(buffer, format, data, stride, count) in buffers {
            let set_buffer: SetBuffer = function(b"rtcSetSharedGeometryBuffer");
            set_buffer(geometry, buffer, 0, format, data, 0, stride, count);
        }
        function::<unsafe extern "C" fn(Handle)>(b"rtcCommitGeometry")(geometry);
        function::<unsafe extern "C" fn(Handle, Handle) -> c_uint>(b"rtcAttachGeometry")(scene, geometry);
        function::<unsafe extern "C" fn(Handle)>(b"rtcReleaseGeometry")(geometry);
        function::<unsafe extern "C" fn(Handle)>(b"rtcCommitScene")(scene);
        scene
    }
}

impl Drop for Embree {
    fn drop(&mut self) {
        // SAFETY: the scene was made by this library and is used no more.
        unsafe { (self.release_scene)(self.scene) }
    }
}

impl Engine for Embree {
    fn trace(&self, rays: &[Ray<f32>], hits: &mut [Hit]) {
        for (ray, hit) in rays.iter().zip(hits) {
            let mut query = query(ray);
            // SAFETY: the query has the layout of `RTCRayHit`; no arguments means the defaults.
            unsafe { (self.intersect)(self.scene, &mut query, null()) };
            *hit = (query.geometry != INVALID_ID).then_some((query.t_far, query.primitive));
        }
    }
}

impl AnyHit for Embree {
    fn count_occluded(&self, rays: &[Ray<f32>]) -> usize {
        let is_occluded = |ray: &&Ray<f32>| {
            let mut query = query(ray);
            // SAFETY: `RTCRay` is the first part of `RTCRayHit`; no arguments means the defaults.
            unsafe { (self.occluded)(self.scene, &mut query, null()) };
            query.t_far < 0.0
        };
        rays.iter().filter(is_occluded).count()
    }
}

fn query(ray: &Ray<f32>) -> RayHit {
    RayHit {
        origin: ray.origin.into(),
        t_near: ray.t_min,
        direction: ray.direction.into(),
        time: 0.0,
        t_far: ray.t_max,
        mask: u32::MAX,
        id: 0,
        flags: 0,
        normal: [0.0; 3],
        uv: [0.0; 2],
        primitive: INVALID_ID,
        geometry: INVALID_ID,
        instances: [INVALID_ID; 2],
    }
}

/// The device of one or two threads, made at the first call.
fn device(threads: usize) -> Handle {
    static DEVICES: [std::sync::OnceLock<usize>; 2] = [const { std::sync::OnceLock::new() }; 2];
    // SAFETY: the signature is that of Embree 4.
    let new = || unsafe {
        let configuration = THREADS[threads - 1].as_ptr();
        function::<unsafe extern "C" fn(*const c_char) -> Handle>(b"rtcNewDevice")(configuration)
    };
    *DEVICES[threads - 1].get_or_init(|| new() as usize) as Handle
}

/// A function of the library that `EMBREE4_SO` names.
///
/// # Safety
/// `F` must be the function's type.
unsafe fn function<F: Copy>(name: &[u8]) -> F {
    static LIBRARY: std::sync::OnceLock<Library> = std::sync::OnceLock::new();
    // SAFETY: loading Embree runs its initialisers only; the caller answers for the type.
    unsafe {
        let open = || Library::new(std::env::var_os("EMBREE4_SO").expect("EMBREE4_SO is not set")).unwrap();
        let symbol: Symbol<'_, F> = LIBRARY.get_or_init(open).get(name).unwrap();
        *symbol
    }
}
