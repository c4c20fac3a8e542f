//! Volumes in the flat scene: a sparse voxel octree and the palette's materials per volume asset in use.
use std::sync::Arc;

use glam::Vec3;
use luxel_accel::{SvoVoxel, build_svo};
use luxel_flat::Span;
use luxel_geom::Aabb;
use luxel_scene::{AssetId, Assets, Material, MeshStructure, Surface, VolumeAsset};

use crate::assets::BakedAsset;
use crate::journal::{Journal, Topic};
use crate::objects::ObjectItem;
use crate::resample::srgb_encode;
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
            nodes: heaps.svo_nodes.place(&svo.nodes, journal.revision())?,
            levels: svo.levels,
            bounds: svo.bounds,
            palette: heaps.materials.place_palette(&self.grid.palette, journal)?,
            used,
        })
    }

    fn release(built: &BuiltVolume, heaps: &mut Heaps, journal: &mut Journal) {
        heaps.svo_nodes.release(built.nodes, journal.revision());
        heaps.materials.release(built.palette, journal);
    }

    fn counters(counters: &mut BakeCounters) -> (&mut u64, &mut u64) {
        (&mut counters.svo_built, &mut counters.svo_freed)
    }
}

/// The voxels as the octree builder takes them, and the palette entries that they use. A voxel without a
/// palette entry cannot be shown and is left out.
fn voxels(volume: &VolumeAsset) -> (Vec<SvoVoxel>, Vec<u32>) {
    let colors: Vec<[u8; 3]> = volume.grid.palette.iter().map(color).collect();
    let mut is_used = vec![false; colors.len()];
    let voxels = (volume.grid.voxels.iter())
        .filter_map(|voxel| {
            let entry = usize::from(voxel.palette);
            let color = *colors.get(entry)?;
            is_used[entry] = true;
            Some(SvoVoxel { cell: voxel.cell, color, material: entry as u32 })
        })
        .collect();
    (voxels, (0..).zip(is_used).filter_map(|(entry, used)| used.then_some(entry)).collect())
}

/// What averages of voxels are made of: the reflectance in 8-bit sRGB; glass counts as white.
fn color(material: &Material) -> [u8; 3] {
    let reflectance = match material.surface {
        Surface::Lambert { albedo }
        | Surface::Metal { albedo, .. }
        | Surface::SemiSpecular { albedo, .. } => albedo,
        Surface::Principled(principled) => principled.base_color,
        Surface::Unlit { color } => color,
        Surface::Dielectric { .. } => Vec3::ONE,
    };
    reflectance.to_array().map(|linear| (srgb_encode(linear.clamp(0.0, 1.0)) * 255.0).round() as u8)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn colors_are_srgb() {
        let gray = |x: f32| color(&Material::lambert(Vec3::splat(x)))[0];
        assert_eq!(
            [gray(0.0), gray(1.0), gray(0.215_861), gray(0.001), gray(-3.0), gray(f32::NAN)],
            [0, 255, 128, 3, 0, 0]
        );
    }
}
