//! Every kernel links and validates for every feature alone, every pair, and all; nothing of a feature that is
//! left out is linked; no kernel grows beyond its bound; layouts are the Rust records'.
#![allow(clippy::unwrap_used, clippy::print_stdout)]
use luxel_flat::{FEATURES, FeatureSet};
use luxel_gpu::{LinkedShader, ShaderLibrary};
use luxel_render::{KERNELS, conditions};

/// Most storage buffers of a kernel: the WebGPU default.
const MAX_STORAGE_BUFFERS: usize = 8;

/// The kernels that run for a set of features, linked.
fn link_all(library: &ShaderLibrary, features: FeatureSet) -> Vec<LinkedShader> {
    KERNELS
        .iter()
        .filter(|row| row.feature.is_none_or(|f| features.has(f)))
        .map(|row| match library.link(&row.kernel, &conditions(features)) {
            Ok(linked) => linked,
            Err(error) => panic!("{} with {features:?}: {error}", row.kernel.entry),
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
    link_all(&library, FeatureSet::NONE);
    link_all(&library, FeatureSet::ALL);
    for a in FEATURES {
        for b in FEATURES {
            link_all(&library, [a.feature, b.feature].into_iter().collect());
        }
    }
}

#[test]
fn a_feature_left_out_leaves_no_function_and_no_binding() {
    let library = ShaderLibrary::embedded();
    let all = link_all(&library, FeatureSet::ALL);
    for row in FEATURES {
        let without = link_all(&library, FeatureSet::ALL.with(row.feature, false));
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
    for (row, shader) in KERNELS.iter().zip(link_all(&library, FeatureSet::ALL)) {
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
    for shader in link_all(&library, FeatureSet::ALL) {
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
