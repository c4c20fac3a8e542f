//! The shader sources, and the names by which kernels, features and constants are asked for.

use std::borrow::Cow;
use std::collections::BTreeMap;
use std::fmt;

use include_dir::{Dir, include_dir};
use serde::Serialize;

use crate::{GpuError, LinkedShader, link};

/// All of `/shaders`, as it was when the crate was built.
static SHADERS: Dir<'static> = include_dir!("$CARGO_MANIFEST_DIR/../../shaders");

/// One compute entry point.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize)]
pub struct Kernel {
    /// Module that declares the entry point, from the library's root: `package::generate`.
    pub module: &'static str,
    /// Name of the entry point in that module.
    pub entry: &'static str,
    /// Invocations per workgroup; linking fails when the shader says otherwise.
    pub workgroup_size: [u32; 3],
}

impl fmt::Display for Kernel {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}::{}", self.module, self.entry)
    }
}

/// Which features are on. A flag that a module names in `@if` but that is not in the set is a link error; flags that no
/// module names do no harm.
#[derive(Clone, Debug, Default, PartialEq, Eq, Hash)]
pub struct FeatureSet(BTreeMap<&'static str, bool>);

impl FeatureSet {
    /// The flags with their values, by name.
    pub fn iter(&self) -> impl Iterator<Item = (&'static str, bool)> + '_ {
        self.0.iter().map(|(&name, &on)| (name, on))
    }
}

impl FromIterator<(&'static str, bool)> for FeatureSet {
    fn from_iter<I: IntoIterator<Item = (&'static str, bool)>>(flags: I) -> Self {
        Self(flags.into_iter().collect())
    }
}

/// Values for the shader's `override` constants. They set numbers only: which code exists is the features' affair.
#[derive(Clone, Debug, Default, PartialEq, Eq, Hash)]
pub struct Overrides(BTreeMap<&'static str, u64>);

impl Overrides {
    /// The constants by declared name.
    pub fn iter(&self) -> impl Iterator<Item = (&'static str, f64)> + '_ {
        self.0.iter().map(|(&name, &bits)| (name, f64::from_bits(bits)))
    }
}

impl FromIterator<(&'static str, f64)> for Overrides {
    fn from_iter<I: IntoIterator<Item = (&'static str, f64)>>(constants: I) -> Self {
        // As bits, so that the set can be a key.
        Self(constants.into_iter().map(|(name, value)| (name, value.to_bits())).collect())
    }
}

/// A tree of WESL modules.
#[derive(Clone, Debug, Default)]
pub struct ShaderLibrary {
    modules: BTreeMap<String, Cow<'static, str>>,
}

impl ShaderLibrary {
    /// The modules of `/shaders`; the file `a/b.wesl` is the module `package::a::b`.
    pub fn embedded() -> Self {
        let mut library = Self::default();
        library.add_dir(&SHADERS);
        library
    }

    /// Modules by path (`package::a::b`).
    pub fn from_modules<S: Into<Cow<'static, str>>>(
        modules: impl IntoIterator<Item = (&'static str, S)>,
    ) -> Self {
        modules.into_iter().fold(Self::default(), |library, (path, source)| library.with_module(path, source))
    }

    /// The library with one module added or replaced.
    #[must_use]
    pub fn with_module(mut self, path: &str, source: impl Into<Cow<'static, str>>) -> Self {
        self.modules.insert(path.to_owned(), source.into());
        self
    }

    /// Paths and sources, by path.
    pub fn modules(&self) -> impl Iterator<Item = (&str, &str)> {
        self.modules.iter().map(|(path, source)| (path.as_str(), source.as_ref()))
    }

    /// Links `kernel` with what it uses under `features` into one WGSL text, and checks it with naga.
    ///
    /// # Errors
    /// [`GpuError::Shader`] for an unknown module, entry point, name or feature, a syntax or type error, another workgroup
    /// size than the kernel's, or a binding that is no buffer.
    pub fn link(&self, kernel: &Kernel, features: &FeatureSet) -> Result<LinkedShader, GpuError> {
        link::link(self, kernel, features)
    }

    fn add_dir(&mut self, dir: &Dir<'static>) {
        for file in dir.files() {
            let path = file.path();
            let is_wesl = path.extension().is_some_and(|extension| extension == "wesl");
            if let (true, Some(source)) = (is_wesl, file.contents_utf8()) {
                let stem = path.with_extension("");
                let parts = stem.iter().map(|part| part.to_string_lossy());
                let module = parts.fold("package".to_owned(), |module, part| module + "::" + &part);
                self.modules.insert(module, Cow::Borrowed(source));
            }
        }
        dir.dirs().for_each(|dir| self.add_dir(dir));
    }
}
