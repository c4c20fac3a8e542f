//! From WESL modules to one checked WGSL text.
//!
//! `wesl` resolves imports and `@if` and drops what the entry point does not use; naga then parses and validates the text,
//! as wgpu will do again. WESL sees unknown names and syntax; types and argument counts are naga's, in the linked text,
//! whose mangled names (`package_rng_next`) still tell the module.

use naga::valid::{Capabilities, ValidationFlags, Validator};
use wesl::{CompileOptions, Feature, Features, ManglerKind, ModulePath, VirtualResolver, Wesl};

use crate::excerpt::excerpt;
use crate::introspect::{LinkedShader, describe};
use crate::{FeatureSet, GpuError, Kernel, ShaderLibrary};

pub(crate) fn link(
    library: &ShaderLibrary,
    kernel: &Kernel,
    features: &FeatureSet,
) -> Result<LinkedShader, GpuError> {
    let linked = assemble(library, kernel, features)?;
    let wgsl = linked.syntax.to_string();
    let module = parse(kernel, &wgsl)?;
    validate(kernel, &wgsl, &module)?;
    describe(*kernel, wgsl, &module, linked.sourcemap.as_ref())
}

fn assemble(
    library: &ShaderLibrary,
    kernel: &Kernel,
    features: &FeatureSet,
) -> Result<wesl::CompileResult, GpuError> {
    let mut resolver = VirtualResolver::new();
    for (path, source) in library.modules() {
        resolver.add_module(module_path(kernel, path)?, source.into());
    }
    let root = module_path(kernel, kernel.module)?;
    let mut compiler = Wesl::new_barebones().set_custom_resolver(resolver);
    compiler.set_mangler(ManglerKind::Escape).use_sourcemap(true).set_options(CompileOptions {
        keep: Some(vec![kernel.entry.to_owned()]),
        features: Features {
            default: Feature::Error,
            flags: features.iter().map(|(name, on)| (name.to_owned(), on.into())).collect(),
        },
        ..CompileOptions::default()
    });
    compiler.compile(&root).map_err(|error| wesl_error(kernel, error))
}

fn module_path(kernel: &Kernel, path: &str) -> Result<ModulePath, GpuError> {
    path.parse()
        .map_err(|error| shader_error(kernel, format!("module path '{path}': {error}"), String::new()))
}

fn parse(kernel: &Kernel, wgsl: &str) -> Result<naga::Module, GpuError> {
    naga::front::wgsl::parse_str(wgsl).map_err(|error| {
        let span = error.labels().next().and_then(|(span, _)| span.to_range());
        let labels = error.labels().map(|(_, label)| label).filter(|label| !label.is_empty());
        let message = labels.fold(error.message().to_owned(), |message, label| message + ": " + label);
        shader_error(kernel, message, linked_excerpt(kernel, wgsl, span))
    })
}

fn validate(kernel: &Kernel, wgsl: &str, module: &naga::Module) -> Result<(), GpuError> {
    // No capability beyond WebGPU's core, as the device is opened without any.
    let mut validator = Validator::new(ValidationFlags::all(), Capabilities::empty());
    validator.validate(module).map(|_| ()).map_err(|error| {
        let span = error.spans().next().and_then(|(span, _)| span.to_range());
        shader_error(kernel, with_causes(error.as_inner()), linked_excerpt(kernel, wgsl, span))
    })
}

fn linked_excerpt(kernel: &Kernel, wgsl: &str, span: Option<std::ops::Range<usize>>) -> String {
    span.map_or_else(String::new, |span| excerpt(&format!("{kernel} (linked)"), wgsl, span))
}

fn with_causes(error: &dyn std::error::Error) -> String {
    let causes = std::iter::successors(Some(error), |error| error.source());
    causes.map(ToString::to_string).collect::<Vec<_>>().join(": ")
}

fn wesl_error(kernel: &Kernel, error: wesl::Error) -> GpuError {
    let wesl::Error::Error(diagnostic) = error else {
        return shader_error(kernel, error.to_string(), String::new());
    };
    let detail = &diagnostic.detail;
    let place = detail.module_path.as_ref().map_or_else(|| kernel.module.to_owned(), ToString::to_string);
    let excerpt = match (&detail.source, &detail.span) {
        (Some(source), Some(span)) => excerpt(&place, source, span.range()),
        _ => format!("  --> {place}"),
    };
    shader_error(kernel, wesl_message(&diagnostic.error), excerpt)
}

fn wesl_message(error: &wesl::Error) -> String {
    let wesl::Error::ParseError(error) = error else {
        return error.to_string();
    };
    let message = error.error.to_string();
    // A short list of what could follow helps; often it is a list of all tokens.
    match message.split_once(", expected ") {
        Some((unexpected, expected)) if expected.len() > 80 => unexpected.to_owned(),
        _ => message,
    }
}

/// An error about `kernel`.
pub(crate) fn shader_error(kernel: &Kernel, message: String, excerpt: String) -> GpuError {
    GpuError::Shader { kernel: kernel.to_string(), message, excerpt }
}
