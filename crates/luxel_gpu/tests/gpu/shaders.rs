//! Linking, introspection, and what shader errors look like. No GPU is needed, but for the last ones.

use luxel_gpu::testing::gpu_or_fail;
use luxel_gpu::{BindingAccess, FeatureSet, GpuError, Kernel, Overrides, PipelineCache, ShaderLibrary};

use crate::kernels::{SCALE, features, library};

#[test]
fn a_feature_left_out_leaves_no_code_and_no_binding() {
    let without = library().link(&SCALE, &features(false)).unwrap();
    let names: Vec<_> = without.bindings.iter().map(|binding| binding.name.as_str()).collect();
    assert_eq!(names, ["shift", "values"]);
    assert!(!without.wgsl.contains("extra"));
    let mut functions = without.functions.clone();
    functions.sort();
    assert_eq!(functions, ["package::maths::scaled", "package::scale::second"]);

    let with = library().link(&SCALE, &features(true)).unwrap();
    let extra = with.binding("extra").unwrap();
    assert_eq!((extra.group, extra.binding, extra.min_bytes), (1, 0, 16));
    assert_eq!(extra.access, BindingAccess::StorageRead);
}

#[test]
fn introspection_names_what_the_source_names() {
    let shader = library().link(&SCALE, &features(false)).unwrap();
    let shift = shader.binding("shift").unwrap();
    assert_eq!((shift.access, shift.min_bytes), (BindingAccess::Uniform, 16));
    let values = shader.binding("values").unwrap();
    assert_eq!((values.access, values.min_bytes), (BindingAccess::StorageReadWrite, 4));
    let layout = shader.layout("Shift").unwrap();
    assert_eq!(layout.size, 16);
    let members: Vec<_> = layout.members.iter().map(|m| (m.name.as_str(), m.offset)).collect();
    assert_eq!(members, [("x", 0), ("y", 4), ("z", 8), ("w", 12)]);
    assert_eq!(shader.overrides().collect::<Vec<_>>(), ["factor"]);
}

/// Links `source` as `package::main` and returns the error's message and excerpt.
fn error_of(source: &'static str, features: &FeatureSet) -> (String, String) {
    let library = ShaderLibrary::from_modules([
        ("package::main", source),
        ("package::rng", "fn next() -> u32 { return 1u; }"),
    ]);
    let kernel = Kernel { module: "package::main", entry: "run", workgroup_size: [1, 1, 1] };
    match library.link(&kernel, features) {
        Err(GpuError::Shader { kernel, message, excerpt }) => {
            assert_eq!(kernel, "package::main::run");
            assert!(!message.contains('\u{1b}') && !excerpt.contains('\u{1b}'), "no colours");
            (message, excerpt)
        }
        other => panic!("expected a shader error, got {other:?}"),
    }
}

#[test]
fn a_syntax_error_names_file_line_and_place() {
    let (message, excerpt) =
        error_of("\n@compute @workgroup_size(1) fn run() { let a = ; }", &FeatureSet::default());
    assert_eq!(message, "unexpected token `;`");
    assert!(excerpt.starts_with("  --> package::main:2:48\n"), "{message}\n{excerpt}");
}

#[test]
fn an_unknown_name_is_named() {
    let (message, excerpt) =
        error_of("@compute @workgroup_size(1) fn run() { let a = missing(1u); }", &FeatureSet::default());
    assert!(message.contains("missing"), "{message}\n{excerpt}");
    assert!(excerpt.contains("package::main"), "{message}\n{excerpt}");
}

#[test]
fn a_type_error_shows_the_linked_text() {
    let (message, excerpt) = error_of(
        "import package::rng::next;\n@compute @workgroup_size(1) fn run() { let a: f32 = next(); }",
        &FeatureSet::default(),
    );
    assert!(message.contains("f32"), "{message}\n{excerpt}");
    assert!(excerpt.contains("package_rng_next") && excerpt.contains('^'), "{message}\n{excerpt}");
    assert!(excerpt.contains("package::main::run (linked)"), "{message}\n{excerpt}");
}

#[test]
fn an_invalid_program_shows_the_linked_text() {
    let (message, excerpt) = error_of(
        "@group(0) @binding(0) var<storage, read> data: array<u32>;\n@compute @workgroup_size(1) fn run() { data[0] = 1u; }",
        &FeatureSet::default(),
    );
    assert!(excerpt.contains("data"), "{message}\n{excerpt}");
}

#[test]
fn a_missing_feature_is_an_error_and_a_surplus_one_is_not() {
    let source = "@if(fog) fn fog() {}\n@compute @workgroup_size(1) fn run() { @if(fog) { fog(); } }";
    let (message, _) = error_of(source, &FeatureSet::from_iter([("rain", true)]));
    assert!(message.contains("fog"), "{message}");
    let surplus = FeatureSet::from_iter([("twice", false), ("rain", true)]);
    assert!(library().link(&SCALE, &surplus).is_ok());
}

#[test]
fn entry_module_and_workgroup_size_are_checked() {
    let source = "@compute @workgroup_size(2) fn run() {}";
    let (message, _) = error_of(source, &FeatureSet::default());
    assert_eq!(message, "the workgroup size is [2, 1, 1] in the shader and [1, 1, 1] in Rust");
    let (message, _) = error_of("@compute @workgroup_size(1) fn other() {}", &FeatureSet::default());
    assert_eq!(message, "no entry point 'run' in package::main");
    let nowhere = Kernel { module: "package::nowhere", ..SCALE };
    let error = library().link(&nowhere, &features(false)).unwrap_err();
    assert!(error.to_string().contains("package::nowhere"), "{error}");
    let (message, _) = error_of(
        "override wide: u32 = 1u;\n@compute @workgroup_size(wide) fn run() {}",
        &FeatureSet::default(),
    );
    assert!(message.contains("override"), "{message}");
}

#[test]
fn every_embedded_module_has_its_path() {
    let library = ShaderLibrary::embedded();
    assert!(library.modules().any(|(path, _)| path == "package::probe"));
    let shaders = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../../shaders");
    let (mut folders, mut files) = (vec![shaders], 0);
    while let Some(folder) = folders.pop() {
        for entry in std::fs::read_dir(folder).unwrap() {
            let path = entry.unwrap().path();
            if path.is_dir() {
                folders.push(path);
            } else if path.extension().is_some_and(|extension| extension == "wesl") {
                files += 1;
            }
        }
    }
    assert_eq!(library.modules().count(), files);
}

#[test]
fn the_cache_compiles_each_text_once() {
    let Some(gpu) = gpu_or_fail() else { return };
    let mut cache = PipelineCache::new(library());
    let none = Overrides::default();
    let first = cache.get(&gpu, &SCALE, &features(false), &none).unwrap();
    let same = cache.get(&gpu, &SCALE, &features(false), &none).unwrap();
    assert!(std::sync::Arc::ptr_eq(&first, &same));
    let surplus = FeatureSet::from_iter([("twice", false), ("unread", true)]);
    let shared = cache.get(&gpu, &SCALE, &surplus, &none).unwrap();
    assert!(
        std::sync::Arc::ptr_eq(&first, &shared),
        "a flag that the kernel does not read makes no new pipeline"
    );
    cache.get(&gpu, &SCALE, &features(true), &none).unwrap();
    cache.get(&gpu, &SCALE, &features(false), &Overrides::from_iter([("factor", 5.0)])).unwrap();
    let records = cache.compile_records();
    assert_eq!(records.len(), 3);
    assert_eq!((records[0].functions, records[0].bindings), (2, 2));
    assert!(records.iter().all(|record| record.wall_ms > 0.0 && record.cpu_ms.is_some_and(|ms| ms > 0.0)));
}

#[test]
fn an_unknown_override_and_too_many_buffers_are_errors() {
    let Some(gpu) = gpu_or_fail() else { return };
    let unknown = Overrides::from_iter([("fcator", 5.0)]);
    let error = PipelineCache::new(library()).get(&gpu, &SCALE, &features(false), &unknown).unwrap_err();
    assert!(error.to_string().contains("'fcator'"), "{error}");

    let has = gpu.limits().max_storage_buffers_per_stage;
    let declarations: String = (0..=has)
        .map(|i| format!("@group(0) @binding({i}) var<storage, read_write> b{i}: array<u32>;\n"))
        .collect();
    let uses: String = (0..=has).map(|i| format!("b{i}[0] = 1u;")).collect();
    let source = format!("{declarations}@compute @workgroup_size(1) fn run() {{ {uses} }}");
    let library = ShaderLibrary::from_modules([("package::main", source)]);
    let kernel = Kernel { module: "package::main", entry: "run", workgroup_size: [1, 1, 1] };
    let error = PipelineCache::new(library)
        .get(&gpu, &kernel, &FeatureSet::default(), &Overrides::default())
        .unwrap_err();
    assert_eq!(
        error,
        GpuError::LimitExceeded {
            what: "kernel package::main::run in storage buffers".to_owned(),
            needs: u64::from(has) + 1,
            has: has.into()
        }
    );
}
