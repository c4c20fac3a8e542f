//! Volumes in the flat scene: a sparse voxel octree and the palette's materials per volume asset in use.
use std::sync::Arc;

use luxel_accel::{SvoVoxel, build_svo};
use luxel_flat::Span;
use luxel_geom::Aabb;
use luxel_scene::{AssetId, Assets, Material, MeshStructure, VolumeAsset};

use crate::assets::BakedAsset;
use crate::journal::{Journal, Topic};
use crate::objects::ObjectItem;
use crate::store::Heaps;
use crate::{BakeCounters, BakeError};

/// Where a volume stands.
#[derive(Clone, Debug)]
pub(crate) struct BuiltVolume {
    pub nodes: Span,
    pub levels: u32,
    /// Box of the solid voxels, in the volume's coordinates.
    pub bounds: Aabb<f32>,
    /// Material slots of the palette.
    pub palette: Span,
    /// Palette entries that a voxel uses, rising.
    pub used: Vec<u32>,
}

impl BakedAsset for VolumeAsset {
    const KIND: &'static str = "volume";
    const TOPIC: Topic = Topic::Volume;
    type Built = BuiltVolume;
    type Settings = ();

    fn shown_by(object: &ObjectItem) -> Option<AssetId> {
        object.volume.map(|instance| instance.volume)
    }

    fn find(assets: &Assets, id: AssetId) -> Option<&Arc<Self>> {
        assets.volume(id)
    }

    fn settings(_: &MeshStructure) {}

    fn build(&self, (): &(), heaps: &mut Heaps, journal: &mut Journal) -> Result<BuiltVolume, BakeError> {
        let (voxels, used) = voxels(self);
        let svo = build_svo(&voxels, self.grid.size)?;
        Ok(BuiltVolume {
            nodes: heaps.place_octree(&svo, journal.revision())?,
            levels: svo.levels,
            bounds: svo.bounds,
            palette: heaps.materials.place_palette(&self.grid.palette, journal)?,
            used,
        })
    }

    fn release(built: &BuiltVolume, heaps: &mut Heaps, journal: &mut Journal) {
        heaps.release_octree(built.nodes, journal.revision());
        heaps.materials.release(built.palette, journal);
    }

    fn counters(counters: &mut BakeCounters) -> (&mut u64, &mut u64) {
        (&mut counters.svo_built, &mut counters.svo_freed)
    }
}

/// The voxels as the octree builder takes them, and the palette entries that they use. A voxel without a
/// palette entry cannot be shown and is left out.
fn voxels(volume: &VolumeAsset) -> (Vec<SvoVoxel>, Vec<u32>) {
    let colors: Vec<[u8; 3]> = volume.grid.palette.iter().map(Material::display_color).collect();
    let mut is_used = vec![false; colors.len()];
    let voxels = (volume.grid.voxels.iter())
        .filter_map(|voxel| {
            let entry = usize::from(voxel.palette);
            let color = *colors.get(entry)?;
            is_used[entry] = true;
            Some(SvoVoxel { cell: voxel.cell, color, material: voxel.palette })
        })
        .collect();
    (voxels, (0..).zip(is_used).filter_map(|(entry, used)| used.then_some(entry)).collect())
}
