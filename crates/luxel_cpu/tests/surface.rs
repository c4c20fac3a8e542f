//! What a hit on a dressed triangle looks like: smooth normals and normal maps under mirrored and sheared transforms,
//! against the frame of the world-space triangle; and surfaces that let rays pass, accelerated against exhaustive search.
#![allow(clippy::unwrap_used, clippy::print_stdout)]
mod common;

use common::{SceneBuilder, bits, differences, trace};
use glam::{DAffine3, DMat3, DQuat, DVec2, DVec3, Vec3};
use luxel_cpu::surface::Surface;
use luxel_cpu::{Exclusion, traverse};
use luxel_flat::{
    Counters, FeatureSet, FlatScene, Heap, INSTANCE_ALPHA, INSTANCE_ATTRIBUTES, INSTANCE_COLORS,
    INSTANCE_NORMALS, INSTANCE_TANGENTS, Instance, MATERIAL_ALPHA_BLEND, MATERIAL_ALPHA_MASK,
    MATERIAL_LAMBERT, MaterialRecord, NONE, TEXTURE_NEAREST, TEXTURE_ROLE_COLOR, TEXTURE_ROLE_NORMAL,
    TextureSlot, TriangleAttributes,
};
use luxel_geom::{Ray, octahedral};
use luxel_testkit::{Random, TestMesh, meshes, rays};

/// Records before the first that belongs to a triangle.
const OFFSET: u32 = 3;

/// Gives every triangle of a scene attributes, one material, and one texture.
fn dressed(
    mut scene: FlatScene,
    flags: u32,
    attributes: impl FnMut(u32) -> TriangleAttributes,
    material: MaterialRecord,
    (texture, texels): (TextureSlot, Vec<[u8; 4]>),
) -> FlatScene {
    let dress =
        |i: &Instance| Instance { flags: flags | INSTANCE_ATTRIBUTES, attribute_offset: OFFSET, ..*i };
    let instances: Vec<Instance> = scene.instances.as_slice().iter().map(dress).collect();
    scene.instances.write(0, &instances, 1);
    let count = scene.triangles.len() as u32;
    let unused = (0..OFFSET).map(|_| TriangleAttributes::default());
    let records = unused.chain((0..count).map(attributes)).collect();
    scene.triangle_attributes = Heap::from_records(records, 1);
    scene.materials = Heap::from_records(vec![material], 1);
    scene.textures = Heap::from_records(vec![texture], 1);
    scene.texels = Heap::from_records(texels.into_iter().map(u32::from_le_bytes).collect(), 1);
    scene
}

fn texture([width, height]: [u32; 2]) -> TextureSlot {
    TextureSlot {
        row_u: [1.0, 0.0, 0.0],
        row_v: [0.0, 1.0, 0.0],
        size: height << 16 | width,
        flags: TEXTURE_NEAREST,
        scale: 1.0,
        ..TextureSlot::default()
    }
}

fn material(role: u32) -> MaterialRecord {
    MaterialRecord {
        kind: MATERIAL_LAMBERT,
        color: [1.0; 3],
        alpha: 1.0,
        light_first: NONE,
        texture_mask: role,
        ..MaterialRecord::default()
    }
}

/// A turn, a mirroring in half of the cases, uneven scales, and a shift.
fn placement(random: &mut Random, is_mirrored: bool, is_even: bool) -> DAffine3 {
    let turn =
        DQuat::from_axis_angle(random.direction().as_dvec3().normalize(), f64::from(random.uniform()) * 6.0);
    let size = f64::from(random.log_between(0.2, 5.0));
    let [a, b] = if is_even { [1.0; 2] } else { [0.5 + f64::from(random.uniform()), 1.6] };
    let scale = DVec3::new(if is_mirrored { -size } else { size }, size * a, size * b);
    DAffine3::from_scale_rotation_translation(scale, turn, random.point(2.0).as_dvec3())
}

/// A triangle, where it is in the world, and what its corners carry.
struct Case {
    place: DAffine3,
    corners: [Vec3; 3],
    record: TriangleAttributes,
    weights: [f64; 3],
}

impl Case {
    fn new(random: &mut Random, number: u32) -> Self {
        let corners = [(); 3].map(|()| random.point(1.0));
        let up = (corners[1] - corners[0]).cross(corners[2] - corners[0]).normalize();
        let normals = [(); 3].map(|()| (up + 0.3 * random.direction()).normalize());
        let mut number_in = || random.between(-1.0, 1.0);
        let uv0 = [(); 3].map(|()| [number_in(), number_in()]);
        let record = TriangleAttributes {
            normals: normals.map(octahedral::encode),
            uv0,
            ..TriangleAttributes::default()
        };
        let [a, b] = [random.between(0.1, 0.5), random.between(0.1, 0.4)].map(f64::from);
        let place = placement(random, number % 2 == 1, number % 4 < 2);
        Self { place, corners, record, weights: [1.0 - a - b, a, b] }
    }

    /// Corners in the world.
    fn world(&self) -> [DVec3; 3] {
        self.corners.map(|p| self.place.transform_point3(p.as_dvec3()))
    }

    /// The outward normal in the world: outside goes along with a mirroring.
    fn normal(&self) -> DVec3 {
        let [a, b, c] = self.world();
        let normal = (b - a).cross(c - a).normalize();
        if self.place.matrix3.determinant() < 0.0 { -normal } else { normal }
    }

    fn point(&self) -> DVec3 {
        let [a, b, c] = self.world();
        a * self.weights[0] + b * self.weights[1] + c * self.weights[2]
    }

    /// dP/du and dP/dv in the world.
    fn derivatives(&self) -> [DVec3; 2] {
        let [a, b, c] = self.world();
        let uv = self.record.uv0.map(|[u, v]| DVec2::new(f64::from(u), f64::from(v)));
        let (d1, d2) = (uv[1] - uv[0], uv[2] - uv[0]);
        let determinant = d1.perp_dot(d2);
        [((b - a) * d2.y - (c - a) * d1.y) / determinant, ((c - a) * d1.x - (b - a) * d2.x) / determinant]
    }

    /// The surface that a ray against the normal, or from behind, sees.
    fn seen(&self, flags: u32, role: u32, texel: [u8; 4], from_behind: bool) -> Surface<f32> {
        let mesh = TestMesh::from_triangles([self.corners]);
        let scene = SceneBuilder::default().mesh(&mesh, self.place).build();
        let scene = dressed(scene, flags, |_| self.record, material(role), (texture([1, 1]), vec![texel]));
        let normal = if from_behind { -self.normal() } else { self.normal() };
        let ray = Ray::new((self.point() + normal).as_vec3(), -normal.as_vec3());
        let hit = trace(&scene, &ray).unwrap();
        Surface::at(&scene, FeatureSet::ALL, &ray, &hit, &mut Counters::default())
    }
}

/// True for triangles so thin, in space or on the texture, that single precision tells little.
fn is_thin(case: &Case) -> bool {
    let [a, b, c] = case.corners;
    let [du, dv] = case.derivatives();
    let sine = du.cross(dv).length() / (du.length() * dv.length());
    let height = (b - a).cross(c - a).length() / (b - a).length().max((c - a).length()).max((c - b).length());
    height < 0.1 || sine < 0.1 || du.cross(dv).length() > 1e3 * du.length().min(dv.length())
}

#[test]
fn smooth_normals_are_those_of_the_world() {
    let mut random = Random::new(1);
    let mut worst: f64 = 0.0;
    for number in 0..400 {
        let case = Case::new(&mut random, number);
        if is_thin(&case) {
            continue;
        }
        let corner = case.record.normals.map(octahedral::decode::<f64>);
        let mixed = (0..3).fold(DVec3::ZERO, |sum, k| sum + corner[k] * case.weights[k]);
        let covector: DMat3 = case.place.matrix3.inverse().transpose();
        let expected = (covector * mixed).normalize();
        if expected.dot(case.normal()) < 0.75 {
            // So slanted that it is bent to keep mirrored light outside.
            continue;
        }
        for from_behind in [false, true] {
            let surface = case.seen(INSTANCE_NORMALS, 0, [0; 4], from_behind);
            let off = (surface.shading_normal.as_dvec3() - expected).length();
            worst = worst.max(off);
            assert!(off < 1e-4, "{number}: {} instead of {expected}", surface.shading_normal);
            assert!((surface.place.normal.as_dvec3() - case.normal()).length() < 1e-4);
        }
    }
    println!("largest deviation of a smooth normal {worst:.1e}");
}

#[test]
fn normal_maps_lean_as_their_pictures_lie_mirrored_or_not() {
    let mut random = Random::new(2);
    let mut worst: f64 = 0.0;
    let mut seen = 0;
    for number in 0..400 {
        let case = Case::new(&mut random, number);
        if is_thin(&case) {
            continue;
        }
        let texel = [90 + random.below(75) as u8, 90 + random.below(75) as u8, 240, 255];
        let [x, y, z] = [0, 1, 2].map(|k| 2.0 * f64::from(texel[k]) / 255.0 - 1.0);
        let (normal, [du, dv]) = (case.normal(), case.derivatives());
        let s = (du - normal * du.dot(normal)).normalize();
        // Green is up, v runs down.
        let t = normal.cross(s) * -normal.cross(s).dot(dv).signum();
        let expected = (s * x + t * y + normal * z).normalize();
        for from_behind in [false, true] {
            let surface = case.seen(0, TEXTURE_ROLE_NORMAL, texel, from_behind);
            let off = (surface.shading_normal.as_dvec3() - expected).length();
            worst = worst.max(off);
            assert!(off < 1e-3, "{number}: {} instead of {expected}", surface.shading_normal);
            seen += 1;
        }
    }
    println!("largest deviation of a mapped normal {worst:.1e}, of {seen}");
    assert!(seen > 300, "{seen}");
}

#[test]
fn tangents_of_the_file_are_followed_mirrored_or_not() {
    let mut random = Random::new(3);
    for number in 0..200 {
        let mut case = Case::new(&mut random, number);
        if is_thin(&case) {
            continue;
        }
        // The object's own frame, as a file would have it.
        let [a, b, c] = case.corners;
        let normal = (b - a).cross(c - a).normalize();
        let tangent = (random.direction().cross(normal)).normalize();
        let is_left = number % 3 == 0;
        case.record.tangents = [octahedral::encode_tangent(tangent, is_left); 3];
        let surface = case.seen(INSTANCE_TANGENTS, TEXTURE_ROLE_NORMAL, [160, 150, 240, 255], false);
        let shading = surface.shading_normal.as_dvec3();
        let (decoded, _) = octahedral::decode_tangent::<f64>(case.record.tangents[0]);
        let bitangent = normal.as_dvec3().cross(decoded) * if is_left { -1.0 } else { 1.0 };
        let world = |v: DVec3| case.place.matrix3 * v;
        let along = world(decoded);
        let s = (along - case.normal() * along.dot(case.normal())).normalize();
        let t = case.normal().cross(s);
        let t = t * t.dot(world(bitangent)).signum();
        let [x, y] = [160.0, 150.0].map(|code: f64| 2.0 * code / 255.0 - 1.0);
        let lean = [shading.dot(s), shading.dot(t)].map(|l| l / shading.dot(case.normal()));
        let z = 2.0 * 240.0 / 255.0 - 1.0;
        let off = (lean[0] - x / z).abs().max((lean[1] - y / z).abs());
        assert!(off < 2e-3, "{number}: leans by {lean:?} instead of {:?}", [x / z, y / z]);
    }
}

/// Triangles in several places, one of them mirrored, with texture coordinates and opacities of chance.
fn see_through(seed: u32, material: MaterialRecord) -> FlatScene {
    let mut random = Random::new(seed);
    let mut builder = SceneBuilder::default();
    for i in 0..3 {
        let mesh = meshes::soup(seed + i, 300, 0.5);
        builder = builder.mesh(&mesh, placement(&mut random, i == 1, false));
    }
    let mut chance = Random::new(seed + 9);
    let attributes = |_| TriangleAttributes {
        uv0: [(); 3].map(|()| [chance.between(-2.0, 2.0), chance.between(-2.0, 2.0)]),
        colors: [(); 3].map(|()| [chance.word(), 0xc000_0000 | chance.word()]),
        ..TriangleAttributes::default()
    };
    let mut noise = Random::new(seed + 10);
    let texels = (0..16 * 8).map(|_| noise.word().to_le_bytes()).collect();
    dressed(
        builder.build(),
        INSTANCE_COLORS | INSTANCE_ALPHA,
        attributes,
        material,
        (texture([16, 8]), texels),
    )
}

/// Rays through the scene, and the coins of each.
fn shots(count: u32) -> (Vec<Ray<f32>>, impl Fn(usize) -> Exclusion + Sync) {
    let coins = |i: usize| Exclusion { coins: (i as u32).wrapping_mul(0x9e37_79b9), ..Exclusion::NOTHING };
    (rays::random(7, count, 4.0), coins)
}

fn hits(scene: &FlatScene, rays: &[Ray<f32>], coins: impl Fn(usize) -> Exclusion) -> Vec<Option<[u32; 8]>> {
    let hit = |(i, ray)| bits(&traverse::intersect(scene, ray, &coins(i), &mut Counters::default()));
    rays.iter().enumerate().map(hit).collect()
}

#[test]
fn what_lets_rays_pass_is_the_same_for_every_structure_and_for_any_hit() {
    let textured = material(TEXTURE_ROLE_COLOR);
    let materials = [
        MaterialRecord { flags: MATERIAL_ALPHA_MASK, alpha_cutoff: 0.5, ..textured },
        MaterialRecord { flags: MATERIAL_ALPHA_BLEND, alpha: 0.7, ..textured },
    ];
    let (rays, coins) = shots(6000);
    for (seed, material) in (20..).zip(materials) {
        let scene = see_through(seed, material);
        let wrong = differences(&scene, &rays, &coins);
        assert!(wrong.is_empty(), "{} of {} rays differ: {}", wrong.len(), rays.len(), wrong[0]);
        let opaque = see_through(seed, textured);
        let [some, all] = [&scene, &opaque].map(|scene| hits(scene, &rays, &coins));
        let met = |hits: &[Option<[u32; 8]>]| hits.iter().flatten().count();
        let changed = some.iter().zip(&all).filter(|(a, b)| a != b).count();
        println!(
            "{} of {} rays hit, {} opaque ones; {changed} hits differ",
            met(&some),
            rays.len(),
            met(&all)
        );
        assert!(met(&some) > 300 && changed > 300, "{} hits, {changed} changed", met(&some));
    }
}

#[test]
fn what_is_not_there_stops_nothing_and_what_is_stops_all() {
    let (rays, coins) = shots(2000);
    let plain = material(0);
    let opaque = hits(&see_through(30, plain), &rays, &coins);
    let with = |flags, alpha, alpha_cutoff| {
        let material = MaterialRecord { flags, alpha, alpha_cutoff, ..plain };
        // Without the colours' opacity.
        let mut scene = see_through(30, material);
        let instances: Vec<Instance> = scene
            .instances
            .as_slice()
            .iter()
            .map(|i| Instance { flags: i.flags & !INSTANCE_COLORS, ..*i })
            .collect();
        scene.instances.write(0, &instances, 1);
        hits(&scene, &rays, &coins)
    };
    assert!(with(MATERIAL_ALPHA_BLEND, 0.0, 0.0).iter().all(Option::is_none));
    assert!(with(MATERIAL_ALPHA_MASK, 0.4, 0.5).iter().all(Option::is_none));
    assert_eq!(with(MATERIAL_ALPHA_BLEND, 1.0, 0.0), opaque);
    assert_eq!(with(MATERIAL_ALPHA_MASK, 0.5, 0.5), opaque);
}

#[test]
fn a_share_of_the_rays_passes_as_the_opacity_says() {
    let wall = TestMesh::from_triangles([[
        Vec3::new(-9.0, -9.0, 0.0),
        Vec3::new(9.0, -9.0, 0.0),
        Vec3::new(0.0, 9.0, 0.0),
    ]]);
    let record = MaterialRecord { flags: MATERIAL_ALPHA_BLEND, alpha: 0.3, ..material(0) };
    let scene = SceneBuilder::default().mesh(&wall, DAffine3::IDENTITY).build();
    let bare = |_| TriangleAttributes::default();
    let scene = dressed(scene, INSTANCE_ALPHA, bare, record, (texture([1, 1]), vec![[255; 4]]));
    let ray: Ray<f32> = Ray::new(Vec3::Z, -Vec3::Z);
    let count = 100_000u32;
    let stopped = (0..count).filter(|i| {
        let coins = luxel_cpu::alpha::ray_coins(5, i % 317, i / 317, 2);
        traverse::occluded(&scene, &ray, &Exclusion { coins, ..Exclusion::NOTHING }, &mut Counters::default())
    });
    let share = stopped.count() as f64 / f64::from(count);
    println!("{share} of the rays are stopped");
    // Five deviations of a binomial share.
    assert!((share - 0.3).abs() < 5.0 * (0.3 * 0.7 / f64::from(count)).sqrt(), "{share}");
}
