//! Every kernel links and validates for every feature alone, every pair, and all, with every structure over the
//! spheres; nothing of a feature that is left out, nor of another structure, is linked; no kernel grows beyond its
//! bound; layouts are the Rust records'.
#![allow(clippy::unwrap_used, clippy::print_stdout)]
use luxel_flat::{FEATURES, Feature, FeatureSet, MESH_ACCELS, MeshAccel, SPHERE_ACCELS, SphereAccel};
use luxel_gpu::{LinkedShader, ShaderLibrary};
use luxel_render::{KERNELS, conditions};

/// Most storage buffers of a kernel in scenes without textures and see-through surfaces: the WebGPU default.
const MAX_STORAGE_BUFFERS: usize = 8;
/// With them.
const MAX_STORAGE_BUFFERS_WITH_TEXTURES: usize = 12;
/// Kernels that search the scene for hits.
const SEARCHES: [&str; 2] = ["intersect", "shadow"];

/// Bindings that hold spheres or a structure over them.
const SPHERE_BINDINGS: [&str; 4] = ["spheres", "octree_nodes", "sphere_nodes", "leaf_spheres"];

/// The kernels that run for a set of features and a structure, linked.
fn link_all(library: &ShaderLibrary, features: FeatureSet, accel: SphereAccel) -> Vec<LinkedShader> {
    link_with(library, features, accel, MeshAccel::default())
}

fn link_with(
    library: &ShaderLibrary,
    features: FeatureSet,
    accel: SphereAccel,
    meshes: MeshAccel,
) -> Vec<LinkedShader> {
    KERNELS
        .iter()
        .filter(|row| row.feature.is_none_or(|f| features.has(f)))
        .map(|row| match library.link(&row.kernel, &conditions(features, accel, meshes)) {
            Ok(linked) => linked,
            Err(error) => panic!("{} with {features:?}, {accel:?}: {error}", row.kernel.entry),
        })
        .collect()
}

fn has_function(shaders: &[LinkedShader], name: &str) -> bool {
    let suffix = format!("::{name}");
    shaders.iter().flat_map(|s| &s.functions).any(|f| f.ends_with(&suffix))
}

fn has_binding(shaders: &[LinkedShader], name: &str) -> bool {
    shaders.iter().flat_map(|s| &s.bindings).any(|b| b.name == name)
}

#[test]
fn kernels_link_without_features_alone_in_pairs_and_all_together() {
    let library = ShaderLibrary::embedded();
    for row in SPHERE_ACCELS {
        link_all(&library, FeatureSet::NONE, row.accel);
        link_all(&library, FeatureSet::ALL, row.accel);
        for feature in FEATURES {
            let with_spheres = [feature.feature, Feature::Spheres].into_iter().collect();
            link_all(&library, with_spheres, row.accel);
        }
    }
    for (i, a) in FEATURES.iter().enumerate() {
        for b in &FEATURES[..=i] {
            link_all(&library, [a.feature, b.feature].into_iter().collect(), SphereAccel::default());
        }
    }
}

#[test]
fn a_structure_is_linked_alone() {
    let library = ShaderLibrary::embedded();
    for row in SPHERE_ACCELS {
        let spheres = FeatureSet::NONE.with(Feature::Spheres, true);
        check_intersect(&library, row.accel, FeatureSet::ALL);
        for other in FEATURES {
            check_intersect(&library, row.accel, spheres.with(other.feature, true));
        }
        let without = FeatureSet::ALL.with(Feature::Spheres, false);
        let shaders = link_all(&library, without, row.accel);
        assert!(SPHERE_BINDINGS.iter().all(|name| !has_binding(&shaders, name)), "{}", row.name);
        assert!(!has_function(&shaders, entry_of(row.accel)), "{}", row.name);
    }
}

#[test]
fn a_way_through_meshes_is_linked_alone() {
    let library = ShaderLibrary::embedded();
    // The near-first walk goes by skips where its stack is full.
    let functions = ["intersect_all", "intersect_by_skips", "intersect_nearer_first"];
    for features in [FeatureSet::ALL, FeatureSet::NONE.with(Feature::Triangles, true)] {
        for (row, own) in MESH_ACCELS.iter().zip(functions) {
            let shaders = link_with(&library, features, SphereAccel::default(), row.accel);
            for function in functions {
                assert_eq!(has_function(&shaders, function), function == own, "{function} in {}", row.name);
            }
        }
    }
}

/// The kernels that find hits bind what the structure reads and nothing of another; the kernel that looks at the
/// surface binds the spheres.
fn check_intersect(library: &ShaderLibrary, accel: SphereAccel, features: FeatureSet) {
    let row = accel.row();
    let shaders = link_all(library, features, accel);
    let (searches, others): (Vec<_>, Vec<_>) =
        shaders.into_iter().partition(|shader| SEARCHES.contains(&shader.kernel.entry));
    for name in SPHERE_BINDINGS {
        assert!(!has_binding(&others, name) || name == "spheres", "{}: {name}", row.name);
    }
    for search in searches {
        let search = std::slice::from_ref(&search);
        for name in SPHERE_BINDINGS {
            assert_eq!(has_binding(search, name), row.bindings.contains(&name), "{}: {name}", row.name);
        }
        for other in SPHERE_ACCELS {
            let is_own = other.accel == accel;
            assert_eq!(has_function(search, entry_of(other.accel)), is_own, "{} in {}", other.name, row.name);
        }
    }
}

/// The function that searches a structure.
fn entry_of(accel: SphereAccel) -> &'static str {
    match accel {
        SphereAccel::Naive => "intersect_naive",
        SphereAccel::OctreeBase => "intersect_base",
        SphereAccel::OctreeSeed => "intersect_seed",
        SphereAccel::Octree => "intersect_octree",
        SphereAccel::Bvh => "intersect_bvh",
    }
}

/// The kernels with a set of features, once for every structure over the spheres.
fn link_all_structures(library: &ShaderLibrary, features: FeatureSet) -> Vec<LinkedShader> {
    SPHERE_ACCELS.iter().flat_map(|row| link_all(library, features, row.accel)).collect()
}

#[test]
fn a_feature_left_out_leaves_no_function_and_no_binding() {
    let library = ShaderLibrary::embedded();
    let all = link_all_structures(&library, FeatureSet::ALL);
    for row in FEATURES {
        let rest = FeatureSet::ALL.with(row.feature, false);
        // The structure over the spheres makes no difference to the others.
        let without = match row.feature {
            Feature::Spheres => link_all_structures(&library, rest),
            _ => link_all(&library, rest, SphereAccel::default()),
        };
        for symbol in row.symbols {
            assert!(has_function(&all, symbol), "{}: no function {symbol} in the table's sense", row.name);
            assert!(!has_function(&without, symbol), "{symbol} is linked without {}", row.name);
        }
        for binding in row.bindings {
            assert!(has_binding(&all, binding), "{}: no binding {binding}", row.name);
            assert!(!has_binding(&without, binding), "{binding} is bound without {}", row.name);
        }
    }
}

#[test]
fn no_kernel_exceeds_its_bounds() {
    let library = ShaderLibrary::embedded();
    let plain = [Feature::Textures, Feature::NormalMaps, Feature::Alpha];
    let plain = plain.into_iter().fold(FeatureSet::ALL, |set, feature| set.with(feature, false));
    check_bounds(&library, FeatureSet::ALL, MAX_STORAGE_BUFFERS_WITH_TEXTURES);
    check_bounds(&library, plain, MAX_STORAGE_BUFFERS);
}

fn check_bounds(library: &ShaderLibrary, features: FeatureSet, max_storage: usize) {
    let shaders = link_all_structures(library, features);
    for (row, shader) in KERNELS.iter().cycle().zip(shaders) {
        let functions = shader.functions.len();
        let storage =
            shader.bindings.iter().filter(|b| b.access != luxel_gpu::BindingAccess::Uniform).count();
        println!("{}: {functions} functions, {storage} storage buffers", row.kernel.entry);
        assert!(functions <= row.max_functions, "{}: {functions} functions", row.kernel.entry);
        assert!(storage <= max_storage, "{}: {storage} storage buffers", row.kernel.entry);
    }
}

#[test]
fn linked_layouts_are_those_of_the_rust_records() {
    let library = ShaderLibrary::embedded();
    let mut seen = std::collections::BTreeSet::new();
    for shader in link_all_structures(&library, FeatureSet::ALL) {
        for layout in &shader.structs {
            let name = layout.name.rsplit("::").next().unwrap();
            let Some((_, fields, size)) = luxel_flat::wesl::structs().into_iter().find(|row| row.0 == name)
            else {
                continue;
            };
            assert_eq!(layout.size as usize, size, "size of {name}");
            let offsets: Vec<_> =
                layout.members.iter().map(|m| (m.name.as_str(), m.offset as usize)).collect();
            let expected: Vec<_> = fields.iter().map(|f| (f.name, f.offset)).collect();
            assert_eq!(offsets, expected, "{name}");
            seen.insert(name.to_owned());
        }
    }
    assert_eq!(seen.len(), luxel_flat::wesl::structs().len(), "records that no kernel uses: {seen:?}");
}
