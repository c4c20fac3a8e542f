//! A scene of nothing but spheres, under a structure that the test names.
use glam::{DAffine3, Vec3};
use luxel_accel::{RootCell, SphereOptions, SphereStructure, build_tlas};
use luxel_flat::{
    Feature, FeatureSet, FlatScene, Heap, Instance, KIND_SPHERES, MaterialRecord, SceneParams, SphereAccel,
    SphereRecord,
};
use luxel_geom::Affine;

/// The scene of these spheres, in slots 0, 1, 2, …, stamped with a revision.
pub(crate) fn scene(accel: SphereAccel, spheres: &[SphereRecord], revision: u64) -> FlatScene {
    scene_with(SphereOptions { accel, ..SphereOptions::default() }, spheres, revision)
}

/// The same, the structure with options.
pub(crate) fn scene_with(options: SphereOptions, spheres: &[SphereRecord], revision: u64) -> FlatScene {
    let in_slots: Vec<_> = (0..).zip(spheres.iter().copied()).collect();
    let structure = SphereStructure::build(options, root_cell(spheres), &in_slots, revision).unwrap();
    of_structure(&structure, revision)
}

/// The scene of a structure.
pub(crate) fn of_structure(structure: &SphereStructure, revision: u64) -> FlatScene {
    structure.validate().unwrap();
    let bounds = structure.bounds();
    let identity = Affine::<f32>::from_daffine(&DAffine3::IDENTITY).to_rows();
    let instance = Instance {
        world_from_object: identity,
        object_from_world: identity,
        lo: bounds.lo.into(),
        hi: bounds.hi.into(),
        kind: KIND_SPHERES,
        node_count: structure.node_count(),
        primitive_count: structure.spheres().len() as u32,
        ..Instance::default()
    };
    let tlas = build_tlas(&[(0, bounds)]).unwrap();
    FlatScene {
        params: SceneParams { tlas_count: tlas.len() as u32, ..SceneParams::default() },
        tlas_nodes: Heap::from_records(tlas, revision),
        instances: Heap::from_records(vec![instance], revision),
        sphere_accel: structure.options().accel,
        spheres: structure.spheres().clone(),
        octree_nodes: structure.octree_nodes().clone(),
        sphere_nodes: structure.sphere_nodes().clone(),
        leaf_spheres: structure.leaf_spheres().clone(),
        materials: Heap::from_records(vec![MaterialRecord::default()], revision),
        features: FeatureSet::NONE.with(Feature::Spheres, true).with(Feature::Lambert, true),
        revision,
        ..FlatScene::default()
    }
}

/// A cell around all centres, its edge a power of two.
pub(crate) fn root_cell(spheres: &[SphereRecord]) -> RootCell {
    let reach = spheres.iter().map(|s| Vec3::from(s.center).abs().max_element()).fold(1e-6, f32::max);
    RootCell { center: Vec3::ZERO, half_extent: reach.log2().ceil().exp2() }
}
