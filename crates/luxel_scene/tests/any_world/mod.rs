//! Any world that a scene file may hold.

use glam::{DQuat, DVec3, Vec3};
use luxel_scene::*;
use proptest::prelude::*;

/// Any finite number, tiny and huge ones and −0 among them.
pub(crate) fn any_f64() -> impl Strategy<Value = f64> {
    prop_oneof![
        -10.0..10.0,
        proptest::num::f64::NORMAL | proptest::num::f64::SUBNORMAL | proptest::num::f64::ZERO,
    ]
}

pub(crate) fn any_dvec3() -> impl Strategy<Value = DVec3> {
    (any_f64(), any_f64(), any_f64()).prop_map(DVec3::from)
}

pub(crate) fn positive_f64() -> impl Strategy<Value = f64> {
    prop_oneof![
        1e-3..10.0,
        proptest::num::f64::POSITIVE | proptest::num::f64::NORMAL | proptest::num::f64::SUBNORMAL
    ]
}

pub(crate) fn any_colour(max: f32) -> impl Strategy<Value = Vec3> {
    let channel = || prop_oneof![0.0..=max, Just(0.0), Just(max), Just(1e-42f32)];
    (channel(), channel(), channel()).prop_map(Vec3::from)
}

pub(crate) fn any_transform() -> impl Strategy<Value = Transform> {
    let rotation = prop_oneof![
        Just(DQuat::IDENTITY),
        Just(-DQuat::IDENTITY),
        (-1.0..1.0f64, -1.0..1.0f64, -1.0..1.0f64, 0.1..1.0f64)
            .prop_map(|(x, y, z, w)| DQuat::from_xyzw(x, y, z, w).normalize()),
    ];
    let scale = any_dvec3().prop_map(|s| DVec3::select(s.cmpeq(DVec3::ZERO), DVec3::ONE, s));
    prop_oneof![
        1 => Just(Transform::default()),
        4 => (any_dvec3(), rotation, scale).prop_map(|(translation, rotation, scale)| Transform {
            translation,
            rotation,
            scale
        }),
    ]
}

pub(crate) fn share() -> impl Strategy<Value = f32> {
    prop_oneof![0f32..=1.0, Just(0.0), Just(1.0)]
}

pub(crate) fn any_principled() -> impl Strategy<Value = Principled> {
    let volume = (any_colour(1.0), 1e-6f32..1e6).prop_map(|(color, attenuation_distance)| Volume {
        attenuation_color: color.max(Vec3::splat(1e-6)),
        attenuation_distance,
    });
    let colors = (any_colour(1.0), any_colour(1.0));
    let shares = (share(), share(), share(), share(), share(), share());
    (colors, shares, 1f32..4.0, proptest::option::of(volume)).prop_map(
        |((base_color, specular_color), shares, ior, volume)| {
            let (metallic, roughness, specular, transmission, clearcoat, clearcoat_roughness) = shares;
            Principled {
                base_color,
                metallic,
                roughness,
                ior,
                specular,
                specular_color,
                transmission,
                volume,
                clearcoat,
                clearcoat_roughness,
            }
        },
    )
}

pub(crate) fn any_material() -> impl Strategy<Value = Material> {
    let surface = prop_oneof![
        any_colour(1.0).prop_map(|albedo| Surface::Lambert { albedo }),
        (any_colour(1.0), share()).prop_map(|(albedo, fuzz)| Surface::Metal { albedo, fuzz }),
        (1f32..4.0, any::<bool>()).prop_map(|(ior, schlick)| Surface::Dielectric { ior, schlick }),
        (any_colour(1.0), share())
            .prop_map(|(albedo, smoothness)| Surface::SemiSpecular { albedo, smoothness }),
        any_principled().prop_map(Surface::Principled),
        any_colour(1e30).prop_map(|color| Surface::Unlit { color }),
    ];
    let opacity = prop_oneof![
        Just(Opacity::Opaque),
        (share(), share()).prop_map(|(alpha, cutoff)| Opacity::Mask { alpha, cutoff }),
        share().prop_map(|alpha| Opacity::Blend { alpha }),
    ];
    (surface, any_colour(1e30), opacity).prop_map(|(surface, emission, opacity)| Material {
        surface,
        emission,
        opacity,
    })
}

/// A texture of the image that stands at this place of the list, until the list is known.
pub(crate) fn any_texture() -> impl Strategy<Value = TextureRef> {
    let wrap = || prop_oneof![Just(Wrap::Repeat), Just(Wrap::Mirror), Just(Wrap::Clamp)];
    let filter = prop_oneof![Just(Filter::Linear), Just(Filter::Nearest)];
    let pair = || (-1e3f32..1e3, -1e3f32..1e3).prop_map(glam::Vec2::from);
    (0u32..2, 0u32..2, pair(), -10f32..10.0, pair(), wrap(), wrap(), filter, -4f32..4.0).prop_map(
        |(image, uv_set, offset, rotation, scale, wrap_u, wrap_v, filter, normal_scale)| TextureRef {
            image: AssetId(image),
            uv_set,
            offset,
            rotation,
            scale,
            wrap_u,
            wrap_v,
            filter,
            normal_scale,
        },
    )
}

pub(crate) fn any_textures() -> impl Strategy<Value = MaterialTextures> {
    let texture = || proptest::option::of(any_texture());
    let first = (texture(), texture(), texture(), texture(), texture());
    (first, texture(), texture(), texture(), texture()).prop_map(
        |(
            (color, metallic_roughness, normal, emission, transmission),
            specular,
            specular_color,
            clearcoat,
            clearcoat_roughness,
        )| {
            MaterialTextures {
                color,
                metallic_roughness,
                normal,
                emission,
                transmission,
                specular,
                specular_color,
                clearcoat,
                clearcoat_roughness,
            }
        },
    )
}

/// Names the images that there are in place of their places in the list.
pub(crate) fn with_images(mut textures: MaterialTextures, images: &[AssetId]) -> MaterialTextures {
    let roles = [
        &mut textures.color,
        &mut textures.metallic_roughness,
        &mut textures.normal,
        &mut textures.emission,
        &mut textures.transmission,
        &mut textures.specular,
        &mut textures.specular_color,
        &mut textures.clearcoat,
        &mut textures.clearcoat_roughness,
    ];
    for texture in roles.into_iter().flatten() {
        texture.image = images[texture.image.0 as usize];
    }
    textures
}

#[derive(Debug, Clone)]
pub(crate) enum Kind {
    Group,
    Sphere(f64),
    Mesh(usize),
    Volume(usize),
    Camera(Camera),
    Point(PointLight),
    Spot(SpotLight),
    Distant(DistantLight),
}

#[derive(Debug, Clone)]
pub(crate) struct AnyEntity {
    pub(crate) kind: Kind,
    pub(crate) name: Option<String>,
    pub(crate) parent: Option<prop::sample::Index>,
    pub(crate) transform: Transform,
    pub(crate) material: Option<Material>,
    pub(crate) textures: Option<MaterialTextures>,
    pub(crate) smooth: Option<f32>,
    pub(crate) visible: Option<bool>,
    pub(crate) deleted: bool,
}

pub(crate) fn any_entity() -> impl Strategy<Value = AnyEntity> {
    let projection = prop_oneof![
        (1e-6..3.125).prop_map(|vertical_fov| Projection::Perspective { vertical_fov }),
        positive_f64().prop_map(|height| Projection::Orthographic { height }),
    ];
    let camera = (projection, prop_oneof![Just(0.0), 1e-9..1.0], positive_f64());
    let spot = (any_colour(1e9), 1e-3..1.57, 0.0..0.999).prop_map(|(intensity, outer_angle, inner)| {
        SpotLight { intensity, inner_angle: outer_angle * inner, outer_angle }
    });
    let kind = prop_oneof![
        Just(Kind::Group),
        positive_f64().prop_map(Kind::Sphere),
        (0usize..4).prop_map(Kind::Mesh),
        (0usize..3).prop_map(Kind::Volume),
        camera.prop_map(|(projection, lens_radius, focus_distance)| Kind::Camera(Camera {
            projection,
            lens_radius,
            focus_distance,
        })),
        any_colour(1e9).prop_map(|intensity| Kind::Point(PointLight { intensity })),
        spot.prop_map(Kind::Spot),
        (any_colour(1e9), prop_oneof![Just(0.0), 0.0..3.1]).prop_map(|(irradiance, angular_diameter)| {
            Kind::Distant(DistantLight { irradiance, angular_diameter })
        }),
    ];
    (
        kind,
        proptest::option::of(".*"),
        proptest::option::of(any::<prop::sample::Index>()),
        any_transform(),
        proptest::option::of(any_material()),
        (proptest::option::of(any_textures()), proptest::option::of(0f32..3.0)),
        any::<Option<bool>>(),
        proptest::bool::weighted(0.1),
    )
        .prop_map(|(kind, name, parent, transform, material, (textures, smooth), visible, deleted)| {
            AnyEntity { kind, name, parent, transform, material, textures, smooth, visible, deleted }
        })
}

pub(crate) fn any_environment() -> impl Strategy<Value = Environment> {
    let three = (any_colour(1e6), any_colour(1e6), any_colour(1e6));
    prop_oneof![
        any_colour(1e6).prop_map(Environment::Constant),
        three.prop_map(|(zenith, horizon, ground)| Environment::Gradient { zenith, horizon, ground }),
        (0u32..2, any_f64(), 0f32..1e9).prop_map(|(image, rotation, strength)| Environment::Map {
            image: AssetId(image),
            rotation,
            strength
        }),
    ]
}

pub(crate) fn any_settings() -> impl Strategy<Value = RenderSettings> {
    let tone_map = prop_oneof![
        Just(ToneMapping::None),
        Just(ToneMapping::Reinhard),
        Just(ToneMapping::Aces),
        Just(ToneMapping::AgX)
    ];
    let sizes = (1u32..=16384, 1u32..=16384, 1u32.., 0u32..=65535);
    let lights = prop_oneof![Just(LightSampling::Mis), Just(LightSampling::Nee), Just(LightSampling::Bsdf)];
    (sizes, any::<u32>(), any::<u32>(), -64f32..=64.0, tone_map, lights).prop_map(
        |((width, height, spp, max_depth), roulette_depth, seed, exposure, tone_map, light_sampling)| {
            RenderSettings {
                width,
                height,
                spp,
                max_depth,
                roulette_depth,
                seed,
                exposure,
                tone_map,
                light_sampling,
            }
        },
    )
}

pub(crate) fn any_mesh_structure() -> impl Strategy<Value = MeshStructure> {
    let accel = (0..MeshAccel::NAMES.len()).prop_map(|i| MeshAccel::NAMES[i].1);
    let quality = (0..MeshQuality::NAMES.len()).prop_map(|i| MeshQuality::NAMES[i].1);
    let split = prop_oneof![Just(MeshSplit::Sah), Just(MeshSplit::LargestAxis)];
    let levels = (0..MeshLevels::NAMES.len()).prop_map(|i| MeshLevels::NAMES[i].1);
    let given = (accel, quality, split, proptest::option::of(2u32..=64), 1u32..=8, levels);
    let given = given.prop_map(|(accel, quality, split, bins, leaf_size, levels)| MeshStructure {
        accel,
        quality,
        split,
        bins,
        leaf_size,
        levels,
    });
    prop_oneof![1 => Just(MeshStructure::default()), 4 => given]
}

pub(crate) fn any_sphere_cloud() -> impl Strategy<Value = SphereCloud> {
    let accel = prop::sample::select(SphereAccel::NAMES).prop_map(|(_, accel)| accel);
    let given = (accel, 0..=MAX_CLOUD_DEPTH, 0..=MAX_LEAF_SPHERES);
    let given =
        given.prop_map(|(accel, max_depth, min_spheres)| SphereCloud { accel, max_depth, min_spheres });
    prop_oneof![1 => Just(SphereCloud::default()), 4 => given]
}
