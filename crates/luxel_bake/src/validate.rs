//! Every structure that bake keeps, checked by the rooms that built it.
use bevy_ecs::prelude::World;
use luxel_accel::{Svo, validate_mesh, validate_tlas};
use luxel_geom::Aabb;
use luxel_scene::{MeshAsset, VolumeAsset};

use crate::BakeError;
use crate::assets::Built;
use crate::cloud::Cloud;
use crate::joined::Joined;
use crate::store::Heaps;
use crate::tlas::{Tlas, live_instances};

/// Checks the sphere cloud, the TLAS, and the structure of every asset in use.
pub(crate) fn validate(world: &World) -> Result<(), BakeError> {
    let (Some(heaps), Some(cloud), Some(tlas)) =
        (world.get_resource::<Heaps>(), world.get_resource::<Cloud>(), world.get_resource::<Tlas>())
    else {
        return Ok(());
    };
    cloud.structure().validate()?;
    validate_tlas(tlas.nodes().as_slice(), &live_instances(heaps))?;
    validate_meshes(world, heaps)?;
    validate_volumes(world, heaps)
}

fn validate_meshes(world: &World, heaps: &Heaps) -> Result<(), BakeError> {
    let built = world.get_resource::<Built<MeshAsset>>();
    let trees = built.iter().flat_map(|built| built.iter()).map(|(_, _, mesh)| mesh.tree);
    let joined = world.get_resource::<Joined>().and_then(Joined::tree).copied();
    // Pieces of the joined mesh have no tree.
    for tree in trees.filter(|tree| joined.is_none() || tree.nodes.count > 0).chain(joined) {
        let nodes = &heaps.bvh_nodes.heap.as_slice()[tree.nodes.range()];
        validate_mesh(nodes, &heaps.triangles.heap.as_slice()[tree.triangles.range()])?;
    }
    Ok(())
}

fn validate_volumes(world: &World, heaps: &Heaps) -> Result<(), BakeError> {
    for (_, _, volume) in world.get_resource::<Built<VolumeAsset>>().iter().flat_map(|built| built.iter()) {
        let bounds: Aabb<f32> = volume.bounds;
        let nodes = heaps.svo_nodes.heap.as_slice()[volume.nodes.range()].to_vec();
        let colors = heaps.svo_colors.as_slice()[volume.nodes.range()].to_vec();
        Svo { nodes, colors, levels: volume.levels, bounds }.validate()?;
    }
    Ok(())
}
