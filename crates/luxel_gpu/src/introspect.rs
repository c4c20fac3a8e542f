//! What a linked shader contains, as naga sees it.
//!
//! Pipelines take their layouts from here, and tests compare it with the Rust records and with the features in use.
//! Names are those of the WESL sources, not the mangled ones of the linked text.

use std::collections::BTreeSet;

use naga::{AddressSpace, GlobalVariable, Handle, StorageAccess, TypeInner};
use serde::Serialize;
use wesl::{BasicSourceMap, SourceMap};

use crate::link::shader_error;
use crate::{GpuError, Kernel};

/// How a kernel uses a buffer.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize)]
pub enum BindingAccess {
    /// `var<uniform>`
    Uniform,
    /// `var<storage, read>`
    StorageRead,
    /// `var<storage, read_write>`
    StorageReadWrite,
}

/// A buffer that a kernel uses.
#[derive(Clone, Debug, PartialEq, Eq, Hash, Serialize)]
pub struct Binding {
    /// `@group`
    pub group: u32,
    /// `@binding`
    pub binding: u32,
    /// Name of the variable; unique in a kernel.
    pub name: String,
    /// How it is used.
    pub access: BindingAccess,
    /// Size in bytes of its type, with one element of an array without a length.
    pub min_bytes: u64,
}

/// Where a struct's member lies.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct MemberLayout {
    /// The member's name.
    pub name: String,
    /// Bytes from the struct's start.
    pub offset: u32,
}

/// A struct's layout by WGSL's rules.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct StructLayout {
    /// The struct's name, without its module.
    pub name: String,
    /// Size in bytes, with the padding at its end.
    pub size: u32,
    /// Its members in order.
    pub members: Vec<MemberLayout>,
}

/// A kernel linked for one set of features.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct LinkedShader {
    /// The kernel it was linked for.
    pub kernel: Kernel,
    /// The text, standard WGSL.
    pub wgsl: String,
    /// Functions linked in besides the entry point, with their modules: `package::rng::next`. Compile time on some drivers
    /// grows faster than linearly with these.
    pub functions: Vec<String>,
    /// Buffers, by group and binding.
    pub bindings: Vec<Binding>,
    /// Structs used.
    pub structs: Vec<StructLayout>,
    /// `override` constants: (declared name, the key by which the pipeline knows it).
    pub(crate) override_keys: Vec<(String, String)>,
}

impl LinkedShader {
    /// Declared names of the `override` constants.
    pub fn overrides(&self) -> impl Iterator<Item = &str> {
        self.override_keys.iter().map(|(name, _)| name.as_str())
    }

    /// The binding with this name.
    pub fn binding(&self, name: &str) -> Option<&Binding> {
        self.bindings.iter().find(|binding| binding.name == name)
    }

    /// The struct with this name.
    pub fn layout(&self, name: &str) -> Option<&StructLayout> {
        self.structs.iter().find(|layout| layout.name == name)
    }
}

/// Names of the sources for names of the linked text.
struct Names<'a> {
    kernel: &'a Kernel,
    map: Option<&'a BasicSourceMap>,
}

impl Names<'_> {
    fn declared(&self, linked: &str) -> String {
        let found = self.map.and_then(|map| map.get_decl(linked));
        found.map_or(linked, |(_, name)| name).to_owned()
    }

    fn with_module(&self, linked: &str) -> String {
        match self.map.and_then(|map| map.get_decl(linked)) {
            Some((module, name)) => format!("{module}::{name}"),
            // The root module's declarations keep their names.
            None => format!("{}::{linked}", self.kernel.module),
        }
    }
}

/// Describes a validated module.
pub(crate) fn describe(
    kernel: Kernel,
    wgsl: String,
    module: &naga::Module,
    map: Option<&BasicSourceMap>,
) -> Result<LinkedShader, GpuError> {
    check_entry(&kernel, module)?;
    let names = Names { kernel: &kernel, map };
    let linked_name = |name: &Option<String>| name.clone().unwrap_or_default();
    let functions =
        module.functions.iter().map(|(_, function)| names.with_module(&linked_name(&function.name)));
    let overrides = module.overrides.iter().map(|(_, constant)| {
        let linked = linked_name(&constant.name);
        let key = constant.id.map_or_else(|| linked.clone(), |id| id.to_string());
        (names.declared(&linked), key)
    });
    Ok(LinkedShader {
        functions: functions.collect(),
        bindings: bindings(&names, module)?,
        structs: structs(&names, module),
        override_keys: overrides.collect(),
        kernel,
        wgsl,
    })
}

fn check_entry(kernel: &Kernel, module: &naga::Module) -> Result<(), GpuError> {
    let entry = module.entry_points.iter().find(|entry| entry.name == kernel.entry);
    let problem = match entry {
        None => format!("no entry point '{}' in {}", kernel.entry, kernel.module),
        Some(entry) if entry.workgroup_size_overrides.is_some() => {
            "the workgroup size must not depend on an override".to_owned()
        }
        Some(entry) if entry.workgroup_size != kernel.workgroup_size => format!(
            "the workgroup size is {:?} in the shader and {:?} in Rust",
            entry.workgroup_size, kernel.workgroup_size
        ),
        Some(_) => return Ok(()),
    };
    Err(shader_error(kernel, problem, String::new()))
}

fn bindings(names: &Names<'_>, module: &naga::Module) -> Result<Vec<Binding>, GpuError> {
    let mut bindings = Vec::new();
    let mut seen = BTreeSet::new();
    for (handle, variable) in module.global_variables.iter() {
        let Some(resource) = &variable.binding else {
            continue;
        };
        let name = names.declared(variable.name.as_deref().unwrap_or_default());
        if !seen.insert(name.clone()) {
            return Err(shader_error(
                names.kernel,
                format!("two bindings are named '{name}'"),
                String::new(),
            ));
        }
        bindings.push(Binding {
            group: resource.group,
            binding: resource.binding,
            access: access(names, &name, variable)?,
            min_bytes: size_of_variable(module, handle),
            name,
        });
    }
    bindings.sort_by_key(|binding| (binding.group, binding.binding));
    Ok(bindings)
}

fn access(names: &Names<'_>, name: &str, variable: &GlobalVariable) -> Result<BindingAccess, GpuError> {
    match variable.space {
        AddressSpace::Uniform => Ok(BindingAccess::Uniform),
        AddressSpace::Storage { access } if access.contains(StorageAccess::STORE) => {
            Ok(BindingAccess::StorageReadWrite)
        }
        AddressSpace::Storage { .. } => Ok(BindingAccess::StorageRead),
        _ => Err(shader_error(names.kernel, format!("binding '{name}' is no buffer"), String::new())),
    }
}

fn size_of_variable(module: &naga::Module, variable: Handle<GlobalVariable>) -> u64 {
    let ty = module.global_variables[variable].ty;
    module.types[ty].inner.try_size(module.to_ctx()).unwrap_or(0).into()
}

fn structs(names: &Names<'_>, module: &naga::Module) -> Vec<StructLayout> {
    let layout = |ty: &naga::Type| match &ty.inner {
        TypeInner::Struct { members, span } => Some(StructLayout {
            name: names.declared(ty.name.as_deref().unwrap_or_default()),
            size: *span,
            members: members
                .iter()
                .map(|member| MemberLayout {
                    name: member.name.clone().unwrap_or_default(),
                    offset: member.offset,
                })
                .collect(),
        }),
        _ => None,
    };
    module.types.iter().filter_map(|(_, ty)| layout(ty)).collect()
}
