//! What `luxel info` tells of a baked scene: counts, bytes, depths, and what is drawn otherwise than asked.
use bevy_ecs::prelude::World;
use luxel_accel::SphereStructure;
use luxel_flat::{FlatScene, KIND_MESH, KIND_SPHERES, KIND_VOXELS};
use luxel_scene::{AssetId, MeshAsset, VolumeAsset};
use serde::Serialize;

use crate::assets::Built;
use crate::attributes::Attributes;
use crate::cloud::Cloud;
use crate::images::Images;
use crate::joined::Joined;
use crate::journal::{BakeWarning, Complaints};
use crate::materials::MaterialSlots;
use crate::mesh_tree::MeshTree;
use crate::publish::Published;

/// Facts about the last published scene.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct BakeReport {
    /// Spheres in the picture.
    pub spheres: u64,
    /// Mesh instances in the picture; 1 if there is one tree over all of them.
    pub mesh_instances: u64,
    /// Volume instances in the picture.
    pub volume_instances: u64,
    /// Triangles in the picture, each instance counted.
    pub instanced_triangles: u64,
    /// Entities with a material of their own.
    pub materials: u64,
    /// Deepest level of the TLAS; the root is level 0.
    pub tlas_depth: u32,
    /// The structure over the spheres.
    pub sphere_cloud: SphereFacts,
    /// Meshes in use; if there is one tree over all of them, that as the last.
    pub meshes: Vec<MeshFacts>,
    /// Volumes in use.
    pub volumes: Vec<VolumeFacts>,
    /// Images that textures show.
    pub images: Vec<ImageFacts>,
    /// Lights that can be sampled one by one.
    pub lights: u64,
    /// Bytes of every heap, by name.
    pub bytes: Vec<(&'static str, u64)>,
    /// What is drawn otherwise than the scene says, one line each.
    pub warnings: Vec<String>,
}

/// Warnings of one kind that are told one by one.
const WARNINGS_ALIKE: usize = 5;

/// Facts about the structure over the spheres.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
pub struct SphereFacts {
    /// Which structure, by its name in [`luxel_flat::SPHERE_ACCELS`]; empty before anything was published.
    pub name: &'static str,
    /// Nodes; 0 without spheres.
    pub nodes: u32,
    /// Deepest level; the root is level 0.
    pub depth: u32,
    /// Bytes of its heaps: spheres, nodes and leaves.
    pub bytes: u64,
    /// True if nodes stayed leaves that should have been divided, because references ran out.
    pub cut_off: bool,
}

/// Facts about a mesh in use.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct MeshFacts {
    /// Asset id; 0 for the tree over all meshes.
    pub asset: u32,
    /// Triangles.
    pub triangles: u32,
    /// Nodes of its BVH; 0 if it has none of its own.
    pub nodes: u32,
    /// Deepest level of its BVH; the root is level 0.
    pub depth: u32,
    /// Triangles whose normals were of no length or on the wrong side and were put right.
    pub mended_normals: u32,
}

/// Facts about an image that textures show.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct ImageFacts {
    /// Asset id.
    pub asset: u32,
    /// Width and height of the image in pixels.
    pub size: [u32; 2],
    /// Width and height that it is shown at.
    pub shown_size: [u32; 2],
}

/// Facts about a volume in use.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct VolumeFacts {
    /// Asset id.
    pub asset: u32,
    /// Solid voxels.
    pub voxels: u64,
    /// Nodes of its octree.
    pub nodes: u32,
    /// Levels of its octree below the root.
    pub levels: u32,
    /// Palette entries that a voxel uses.
    pub materials: u32,
}

/// The facts of a world that a baker ran on. Costs a walk through every structure.
pub(crate) fn report(world: &World) -> BakeReport {
    let complaints = world.get_resource::<Complaints>();
    let warnings = complaints.map_or(Vec::new(), |c| told(c.warnings.values()));
    let Some(scene) = world.get_resource::<Published>().and_then(|published| published.latest.as_ref())
    else {
        return BakeReport { warnings, ..BakeReport::default() };
    };
    let live =
        |kind: u32| scene.instances.as_slice().iter().filter(move |i| i.kind == kind && i.node_count > 0);
    BakeReport {
        spheres: scene.spheres.as_slice().iter().filter(|sphere| sphere.radius > 0.0).count() as u64,
        mesh_instances: live(KIND_MESH).count() as u64,
        volume_instances: live(KIND_VOXELS).count() as u64,
        instanced_triangles: live(KIND_MESH).map(|mesh| u64::from(mesh.primitive_count)).sum(),
        materials: world.get_resource::<MaterialSlots>().map_or(0, |slots| slots.len() as u64),
        tlas_depth: luxel_accel::depth(scene.tlas()),
        sphere_cloud: sphere_facts(world, scene),
        meshes: meshes(world, scene),
        volumes: volumes(world),
        images: images(world),
        lights: u64::from(scene.params.light_count),
        bytes: bytes(scene),
        warnings,
    }
}

/// The warnings in words: of each kind the first few, then how many more there are.
fn told<'a>(warnings: impl Iterator<Item = &'a BakeWarning>) -> Vec<String> {
    let mut kinds: Vec<Vec<&BakeWarning>> = Vec::new();
    for warning in warnings {
        match kinds.iter_mut().find(|alike| alike.first().is_some_and(|first| first.is_like(warning))) {
            Some(alike) => alike.push(warning),
            None => kinds.push(vec![warning]),
        }
    }
    let lines = kinds.into_iter().flat_map(|alike| {
        let more = alike.len().saturating_sub(WARNINGS_ALIKE);
        let rest = (more > 0).then(|| format!("and {more} more objects likewise"));
        alike.into_iter().take(WARNINGS_ALIKE).map(ToString::to_string).chain(rest)
    });
    lines.collect()
}

fn meshes(world: &World, scene: &FlatScene) -> Vec<MeshFacts> {
    let Some(built) = world.get_resource::<Built<MeshAsset>>() else { return Vec::new() };
    let attributes = world.get_resource::<Attributes>();
    let facts = |asset: u32, tree: &MeshTree, mended_normals| MeshFacts {
        asset,
        triangles: tree.triangles.count,
        nodes: tree.nodes.count,
        depth: scene.bvh_nodes.as_slice().get(tree.nodes.range()).map_or(0, luxel_accel::depth),
        mended_normals,
    };
    let mended = |id: AssetId| attributes.map_or(0, |attributes| attributes.mended(id));
    let joined = world.get_resource::<Joined>().and_then(Joined::tree);
    let of_assets = built.iter().map(|(id, _, mesh)| facts(id.0, &mesh.tree, mended(id)));
    of_assets.chain(joined.map(|tree| facts(0, tree, 0))).collect()
}

fn images(world: &World) -> Vec<ImageFacts> {
    let images = world.get_resource::<Images>().into_iter().flat_map(Images::iter);
    images
        .map(|(id, image)| ImageFacts { asset: id.0, size: image.original_size(), shown_size: image.size() })
        .collect()
}

fn volumes(world: &World) -> Vec<VolumeFacts> {
    let Some(built) = world.get_resource::<Built<VolumeAsset>>() else { return Vec::new() };
    (built.iter())
        .map(|(id, asset, volume)| VolumeFacts {
            asset: id.0,
            voxels: asset.grid.voxels.len() as u64,
            nodes: volume.nodes.count,
            levels: volume.levels,
            materials: volume.used.len() as u32,
        })
        .collect()
}

fn sphere_facts(world: &World, scene: &FlatScene) -> SphereFacts {
    let cloud = scene.instances.as_slice().iter().find(|i| i.kind == KIND_SPHERES && i.node_count > 0);
    let heaps = [
        scene.spheres.bytes(),
        scene.octree_nodes.bytes(),
        scene.sphere_nodes.bytes(),
        scene.leaf_spheres.bytes(),
    ];
    let structure = world.get_resource::<Cloud>().map(Cloud::structure);
    SphereFacts {
        name: scene.sphere_accel.name(),
        nodes: cloud.map_or(0, |cloud| cloud.node_count),
        depth: structure.map_or(0, SphereStructure::depth),
        bytes: heaps.iter().sum::<usize>() as u64,
        cut_off: structure.is_some_and(SphereStructure::is_cut_off),
    }
}

fn bytes(scene: &FlatScene) -> Vec<(&'static str, u64)> {
    [
        ("tlas_nodes", scene.tlas_nodes.bytes()),
        ("bvh_nodes", scene.bvh_nodes.bytes()),
        ("instances", scene.instances.bytes()),
        ("octree_nodes", scene.octree_nodes.bytes()),
        ("spheres", scene.spheres.bytes()),
        ("sphere_nodes", scene.sphere_nodes.bytes()),
        ("leaf_spheres", scene.leaf_spheres.bytes()),
        ("triangles", scene.triangles.bytes()),
        ("svo_nodes", scene.svo_nodes.bytes()),
        ("svo_colors", scene.svo_colors.bytes()),
        ("materials", scene.materials.bytes()),
        ("triangle_attributes", scene.triangle_attributes.bytes()),
        ("textures", scene.textures.bytes()),
        ("texels", scene.texels.bytes()),
        ("albedo_tables", scene.albedo_tables.bytes()),
        ("lights", scene.lights.bytes()),
        ("light_nodes", scene.light_nodes.bytes()),
        ("environment", scene.environment.bytes()),
    ]
    .map(|(name, bytes)| (name, bytes as u64))
    .to_vec()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Disabled;

    #[test]
    fn many_warnings_of_a_kind_are_counted() {
        let hidden =
            |i: u32| BakeWarning::Disabled { entity: format!("ball {i}"), reason: Disabled::BadRadius };
        let odd = BakeWarning::NonUniformSphere { entity: "egg".to_owned() };
        let warnings: Vec<BakeWarning> = (0..20).map(hidden).chain([odd]).collect();
        let told = told(warnings.iter());
        assert_eq!(told.len(), WARNINGS_ALIKE + 2);
        assert_eq!(told[WARNINGS_ALIKE], "and 15 more objects likewise");
        assert!(told[0].starts_with("ball 0") && told[WARNINGS_ALIKE + 1].starts_with("egg"));
    }
}
