//! Every kernel links and validates for every feature alone, every pair, and all, with every structure over the
//! spheres; nothing of a feature that is left out, nor of another structure, is linked; no kernel grows beyond its
//! bound; layouts are the Rust records'.
#![allow(clippy::unwrap_used, clippy::print_stdout)]
use luxel_flat::{FEATURES, Feature, FeatureSet, SPHERE_ACCELS, SphereAccel};
use luxel_gpu::{LinkedShader, ShaderLibrary};
use luxel_render::{KERNELS, conditions};

/// Most storage buffers of a kernel: the WebGPU default.
const MAX_STORAGE_BUFFERS: usize = 8;

/// Bindings that hold spheres or a structure over them.
const SPHERE_BINDINGS: [&str; 4] = ["spheres", "octree_nodes", "sphere_nodes", "leaf_spheres"];

/// The kernels that run for a set of features and a structure, linked.
fn link_all(library: &ShaderLibrary, features: FeatureSet, accel: SphereAccel) -> Vec<LinkedShader> {
    KERNELS
        .iter()
        .filter(|row| row.feature.is_none_or(|f| features.has(f)))
        .map(|row| match library.link(&row.kernel, &conditions(features, accel)) {
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
    for a in FEATURES {
        for b in FEATURES {
            link_all(&library, [a.feature, b.feature].into_iter().collect(), SphereAccel::default());
        }
    }
}

#[test]
fn a_structure_is_linked_alone() {
    let library = ShaderLibrary::embedded();
    for row in SPHERE_ACCELS {
        for features in [FeatureSet::ALL, FeatureSet::NONE.with(Feature::Spheres, true)] {
            check_intersect(&library, row.accel, features);
            for other in FEATURES {
                check_intersect(&library, row.accel, features.with(other.feature, true));
            }
        }
        let without = FeatureSet::ALL.with(Feature::Spheres, false);
        let shaders = link_all(&library, without, row.accel);
        assert!(SPHERE_BINDINGS.iter().all(|name| !has_binding(&shaders, name)), "{}", row.name);
        assert!(!has_function(&shaders, entry_of(row.accel)), "{}", row.name);
    }
}

/// The kernel that finds hits binds what the structure reads and nothing of another; shading binds the spheres.
fn check_intersect(library: &ShaderLibrary, accel: SphereAccel, features: FeatureSet) {
    let row = accel.row();
    let shaders = link_all(library, features, accel);
    let (intersect, others): (Vec<_>, Vec<_>) =
        shaders.into_iter().partition(|shader| shader.kernel.entry == "intersect");
    for name in SPHERE_BINDINGS {
        assert_eq!(has_binding(&intersect, name), row.bindings.contains(&name), "{}: {name}", row.name);
        assert!(!has_binding(&others, name) || name == "spheres", "{}: {name}", row.name);
    }
    for other in SPHERE_ACCELS {
        let is_own = other.accel == accel;
        assert_eq!(has_function(&intersect, entry_of(other.accel)), is_own, "{} in {}", other.name, row.name);
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
        let without = link_all_structures(&library, FeatureSet::ALL.with(row.feature, false));
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
    let shaders = link_all_structures(&library, FeatureSet::ALL);
    for (row, shader) in KERNELS.iter().cycle().zip(shaders) {
        let functions = shader.functions.len();
        let storage =
            shader.bindings.iter().filter(|b| b.access != luxel_gpu::BindingAccess::Uniform).count();
        println!("{}: {functions} functions, {storage} storage buffers", row.kernel.entry);
        assert!(functions <= row.max_functions, "{}: {functions} functions", row.kernel.entry);
        assert!(storage <= MAX_STORAGE_BUFFERS, "{}: {storage} storage buffers", row.kernel.entry);
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
