//! Embree 4 through its C interface, loaded at run time: single rays against its sphere geometry, medium quality.
//!
//! Constants and layouts as in Embree's public headers `rtcore_*.h`, version 4.
use std::ffi::{CStr, c_char, c_uint, c_void};
use std::ptr::null;

use libloading::{Library, Symbol};
use luxel_flat::SphereRecord;
use luxel_geom::Ray;

use crate::{Engine, Hit};

const GEOMETRY_TYPE_SPHERE_POINT: c_uint = 50;
const BUFFER_TYPE_VERTEX: c_uint = 1;
const FORMAT_FLOAT4: c_uint = 0x9004;
const INVALID_ID: u32 = u32::MAX;
const ONE_THREAD: &CStr = c"threads=1,user_threads=1";

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

/// A committed scene of spheres.
pub struct Embree {
    scene: Handle,
    /// Centre and radius; the scene reads them in place.
    _spheres: Vec<[f32; 4]>,
    intersect: unsafe extern "C" fn(Handle, *mut RayHit, *const c_void),
    release_scene: unsafe extern "C" fn(Handle),
}

impl Embree {
    pub fn build(records: &[SphereRecord]) -> Self {
        let spheres: Vec<[f32; 4]> =
            records.iter().map(|r| [r.center[0], r.center[1], r.center[2], r.radius]).collect();
        // SAFETY: the signatures are those of Embree 4, and the buffer outlives the scene.
        unsafe {
            let scene = function::<unsafe extern "C" fn(Handle) -> Handle>(b"rtcNewScene")(device());
            let new_geometry: unsafe extern "C" fn(Handle, c_uint) -> Handle = function(b"rtcNewGeometry");
            let geometry = new_geometry(device(), GEOMETRY_TYPE_SPHERE_POINT);
            let set_buffer: unsafe extern "C" fn(
                Handle,
                c_uint,
                c_uint,
                c_uint,
                *const c_void,
                usize,
                usize,
                usize,
            ) = function(b"rtcSetSharedGeometryBuffer");
            let data = spheres.as_ptr().cast();
            set_buffer(geometry, BUFFER_TYPE_VERTEX, 0, FORMAT_FLOAT4, data, 0, 16, spheres.len());
            function::<unsafe extern "C" fn(Handle)>(b"rtcCommitGeometry")(geometry);
            function::<unsafe extern "C" fn(Handle, Handle) -> c_uint>(b"rtcAttachGeometry")(scene, geometry);
            function::<unsafe extern "C" fn(Handle)>(b"rtcReleaseGeometry")(geometry);
            function::<unsafe extern "C" fn(Handle)>(b"rtcCommitScene")(scene);
            let (intersect, release_scene) = (function(b"rtcIntersect1"), function(b"rtcReleaseScene"));
            Self { scene, _spheres: spheres, intersect, release_scene }
        }
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

/// The device of one thread, made at the first call.
fn device() -> Handle {
    static DEVICE: std::sync::OnceLock<usize> = std::sync::OnceLock::new();
    // SAFETY: the signature is that of Embree 4.
    let new = || unsafe {
        function::<unsafe extern "C" fn(*const c_char) -> Handle>(b"rtcNewDevice")(ONE_THREAD.as_ptr())
    };
    *DEVICE.get_or_init(|| new() as usize) as Handle
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
