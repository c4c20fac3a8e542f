//! A world with one of everything, and a way to look at a flat scene that forgets slots.
#![allow(clippy::unwrap_used, dead_code, unreachable_pub)]
use std::collections::BTreeMap;
use std::sync::Arc;

use bevy_ecs::prelude::*;
use glam::{DVec3, Vec3};
use luxel_bake::{BakeCounters, BakeError, Baker};
use luxel_flat::{
    FlatScene, INSTANCE_ATTRIBUTES, Instance, KIND_MESH, KIND_SPHERES, KIND_VOXELS, MaterialRecord,
};
use luxel_scene::{
    ActiveCamera, AssetId, Assets, Camera, DistantLight, ImageAsset, ImagePixels, ImageSource, Material,
    MaterialTextures, MeshAsset, MeshInstance, MeshSource, PointLight, SmoothNormals, Sphere, SpotLight,
    Transform, TriangleMesh, VolumeAsset, VolumeSource, VoxelVolume, empty_world, spawn,
};

/// A world and its baker.
pub struct Studio {
    pub world: World,
    pub baker: Baker,
    pub camera: Entity,
}

impl Studio {
    /// Only a camera, at (0, 0, 10).
    pub fn empty() -> Self {
        let mut world = empty_world();
        let lens = Camera { lens_radius: 0.1, focus_distance: 9.0, ..Camera::default() };
        let camera = spawn(&mut world, (lens, ActiveCamera, Transform::at(DVec3::Z * 10.0)));
        let baker = Baker::new(&mut world).unwrap();
        Self { world, baker, camera }
    }

    pub fn mesh_asset(&mut self, source: MeshSource) -> AssetId {
        self.world.resource_mut::<Assets>().insert_mesh(MeshAsset::from_source(source).unwrap())
    }

    pub fn volume_asset(&mut self, source: VolumeSource) -> AssetId {
        self.world.resource_mut::<Assets>().insert_volume(VolumeAsset::from_source(source).unwrap())
    }

    /// An image of 8-bit noise, opaque unless `alpha` is another number than 255.
    pub fn image_asset(&mut self, width: u32, height: u32, alpha: u8) -> AssetId {
        let noise = |i: u32| (i.wrapping_mul(0x9e37_79b9) >> 24) as u8;
        let pixels = (0..width * height).map(|i| [noise(i), noise(i + 7), noise(i + 99), alpha]);
        self.image(width, height, ImagePixels::Rgba8(pixels.collect()))
    }

    /// An image of radiance.
    pub fn radiance_asset(&mut self, width: u32, height: u32) -> AssetId {
        let pixels = (0..width * height).map(|i| [i as f32, 0.5, 2.0]);
        self.image(width, height, ImagePixels::RgbF32(pixels.collect()))
    }

    fn image(&mut self, width: u32, height: u32, pixels: ImagePixels) -> AssetId {
        let source = ImageSource::Checker { squares: 1, a: [0; 3], b: [0; 3] };
        self.world.resource_mut::<Assets>().insert_image(ImageAsset { source, width, height, pixels })
    }

    /// A recipe's mesh with texture coordinates, made from x and y; what else it carries is up to `change`.
    pub fn decorated_asset(&mut self, source: MeshSource, change: impl FnOnce(&mut TriangleMesh)) -> AssetId {
        let mut asset = MeshAsset::from_source(source).unwrap();
        let uvs = asset.mesh.positions.iter().map(|p| p.truncate() * 2.0).collect();
        asset.mesh.uvs[0] = uvs;
        change(&mut asset.mesh);
        self.world.resource_mut::<Assets>().insert_mesh(asset)
    }

    pub fn sphere(&mut self, at: DVec3, radius: f64, material: Material) -> Entity {
        spawn(&mut self.world, (Sphere { radius }, Transform::at(at), material))
    }

    pub fn mesh(&mut self, mesh: AssetId, at: DVec3, material: Material) -> Entity {
        spawn(&mut self.world, (MeshInstance { mesh }, Transform::at(at), material))
    }

    pub fn volume(&mut self, volume: AssetId, at: DVec3) -> Entity {
        spawn(&mut self.world, (VoxelVolume { volume }, Transform::at(at)))
    }

    pub fn run(&mut self) -> Arc<FlatScene> {
        self.try_run().unwrap()
    }

    pub fn try_run(&mut self) -> Result<Arc<FlatScene>, BakeError> {
        self.baker.run(&mut self.world)
    }

    /// The scene after an edit, and what the edit cost.
    pub fn edit(&mut self, change: impl FnOnce(&mut World)) -> (Arc<FlatScene>, BakeCounters) {
        let before = *self.world.resource::<BakeCounters>();
        change(&mut self.world);
        let scene = self.run();
        (scene, self.world.resource::<BakeCounters>().since(&before))
    }

    /// The scene that a new baker makes of the same world.
    pub fn fresh(&mut self) -> Arc<FlatScene> {
        let mut copy = copy_of(&mut self.world);
        Baker::new(&mut copy).unwrap().run(&mut copy).unwrap()
    }
}

/// Another world with the same scene.
fn copy_of(world: &mut World) -> World {
    let mut copy = empty_world();
    copy.insert_resource(world.resource::<Assets>().clone());
    copy.insert_resource(*world.resource::<luxel_scene::Environment>());
    copy.insert_resource(*world.resource::<luxel_scene::RenderSettings>());
    copy.insert_resource(*world.resource::<luxel_scene::SphereCloud>());
    copy.insert_resource(*world.resource::<luxel_scene::MeshStructure>());
    copy.insert_resource(*world.resource::<luxel_bake::TextureBudget>());
    let entities: Vec<Entity> =
        world.query_filtered::<Entity, With<luxel_scene::StableId>>().iter(world).collect();
    // Spawned in another order, so that entity numbers and slots differ.
    let twins: BTreeMap<Entity, Entity> =
        entities.iter().rev().map(|e| (*e, copy.spawn_empty().id())).collect();
    for (old, new) in &twins {
        let old = world.entity(*old);
        let mut new = copy.entity_mut(*new);
        macro_rules! clone { ($($component:ty),*) => { $(if let Some(c) = old.get::<$component>() { new.insert(c.clone()); })* } }
        clone!(
            luxel_scene::StableId,
            Transform,
            Sphere,
            MeshInstance,
            VoxelVolume,
            Material,
            Camera,
            ActiveCamera
        );
        clone!(luxel_scene::Visibility, MaterialTextures, SmoothNormals, PointLight, SpotLight, DistantLight);
        if let Some(parent) = old.get::<ChildOf>() {
            new.insert(ChildOf(twins[&parent.parent()]));
        }
        if old.get::<Material>().is_none() {
            new.remove::<Material>();
        }
    }
    copy
}

/// What a ray can find out about a scene, by stable ids, as text: floats in full.
pub fn visible(scene: &FlatScene) -> BTreeMap<String, String> {
    let mut seen = BTreeMap::new();
    let mut params = scene.params;
    params.tlas_first = 0;
    seen.insert("params".into(), format!("{params:?} {:?} {:?}", scene.features, scene.anchor));
    seen.insert("environment".into(), format!("{:?}", scene.environment.as_slice()));
    seen.insert("albedo tables".into(), scene.albedo_tables.len().to_string());
    let reachable = scene
        .tlas()
        .iter()
        .filter(|n| n.is_leaf())
        .map(|n| scene.instances.as_slice()[n.primitives().0 as usize]);
    for instance in reachable {
        let old = seen
            .insert(format!("instance {} {}", instance.kind, instance.stable_id), describe(scene, &instance));
        assert_eq!(old, None, "two instances with one id");
        if instance.kind == KIND_SPHERES {
            for sphere in scene.spheres.as_slice().iter().filter(|s| s.radius > 0.0) {
                let text =
                    format!("{:?} {} {}", sphere.center, sphere.radius, material(scene, sphere.material));
                assert_eq!(seen.insert(format!("sphere {}", sphere.stable_id), text), None);
            }
        }
    }
    seen
}

fn describe(scene: &FlatScene, i: &Instance) -> String {
    let place =
        format!("{:?} {:?} {:?} {:?} {}", i.world_from_object, i.object_from_world, i.lo, i.hi, i.levels);
    let range = |first: u32, count: u32| first as usize..(first + count) as usize;
    let nodes = range(i.node_first, i.node_count);
    match i.kind {
        KIND_MESH => {
            let triangles = &scene.triangles.as_slice()[range(i.primitive_first, i.primitive_count)];
            let nodes = &scene.bvh_nodes.as_slice()[nodes];
            let attributes = attributes(scene, i);
            format!("{place} {nodes:?} {triangles:?} {attributes} {}", material(scene, i.material_first))
        }
        KIND_VOXELS => {
            let nodes = &scene.svo_nodes.as_slice()[nodes];
            let leaves = nodes.iter().filter(|node| node.child_mask() == 0);
            let materials: Vec<String> =
                leaves.map(|n| material(scene, i.material_first + n.material())).collect();
            let colors = &scene.svo_colors.as_slice()[range(i.node_first, i.node_count)];
            format!("{place} {nodes:?} {colors:?} {materials:?}")
        }
        // The cloud's octree may have another shape; its spheres are listed one by one.
        _ => place,
    }
}

fn attributes(scene: &FlatScene, i: &Instance) -> String {
    if i.flags & INSTANCE_ATTRIBUTES == 0 {
        return i.flags.to_string();
    }
    let first = i.primitive_first.wrapping_add(i.attribute_offset) as usize;
    let all = &scene.triangle_attributes.as_slice()[first..first + i.primitive_count as usize];
    format!("{} {all:?}", i.flags)
}

fn material(scene: &FlatScene, slot: u32) -> String {
    let record = scene.materials.as_slice()[slot as usize];
    let textures: Vec<String> = (record.texture_first..)
        .take(record.texture_mask.count_ones() as usize)
        .map(|slot| {
            let texture = scene.textures.as_slice()[slot as usize];
            let count = (texture.size >> 16) * (texture.size & 0xffff);
            let texels = &scene.texels.as_slice()[texture.texel_first as usize..][..count as usize];
            format!("{:?} {texels:?}", luxel_flat::TextureSlot { texel_first: 0, ..texture })
        })
        .collect();
    format!("{:?} {textures:?}", MaterialRecord { texture_first: 0, light_first: 0, ..record })
}

/// One of everything: two spheres, two instances of a cube, a lantern.
pub struct OneOfEach {
    pub ball: Entity,
    pub cubes: [Entity; 2],
    pub lantern: Entity,
    pub cube: AssetId,
    pub lantern_asset: AssetId,
}

impl OneOfEach {
    pub fn new(studio: &mut Studio) -> Self {
        let cube = studio.mesh_asset(MeshSource::Cube);
        let lantern_asset = studio.volume_asset(VolumeSource::Lantern { size: 5 });
        let gray = Material::lambert(Vec3::splat(0.5));
        studio.sphere(DVec3::new(-4.0, -4.0, -4.0), 1.0, Material::dielectric(1.5));
        studio.sphere(DVec3::new(4.0, 4.0, 4.0), 1.0, gray);
        Self {
            ball: studio.sphere(DVec3::ONE, 0.5, Material::metal(Vec3::ONE, 0.1)),
            cubes: [DVec3::X, DVec3::Y].map(|at| studio.mesh(cube, at, gray)),
            lantern: studio.volume(lantern_asset, DVec3::NEG_X * 8.0),
            cube,
            lantern_asset,
        }
    }
}
