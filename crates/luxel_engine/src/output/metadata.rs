//! How a picture came to be, for whoever finds the file.
use luxel_film::Backend;

/// What is written into every output file.
#[derive(Clone, Debug, PartialEq)]
pub struct Metadata {
    /// Path of the scene file as it was given.
    pub scene: String,
    /// Hash of the scene as it was loaded, before the job changed its settings.
    pub scene_hash: String,
    /// Samples that every pixel has.
    pub samples: u32,
    /// Backend that traced the picture.
    pub backend: Backend,
    /// Processor or adapter.
    pub device: String,
    /// Seconds spent tracing.
    pub seconds: f64,
    /// Names of the features in use.
    pub features: Vec<String>,
    /// Settings of the render, in words.
    pub settings: String,
}

impl Metadata {
    /// The program and its version.
    pub const SOFTWARE: &str = concat!("Luxel ", env!("CARGO_PKG_VERSION"));

    /// Keys and values, in order; the program stands apart since both formats have their own place for it.
    pub fn entries(&self) -> [(&'static str, String); 8] {
        [
            ("luxel.scene", self.scene.clone()),
            ("luxel.scene_hash", self.scene_hash.clone()),
            ("luxel.samples", self.samples.to_string()),
            ("luxel.backend", self.backend.to_string()),
            ("luxel.device", self.device.clone()),
            ("luxel.seconds", format!("{:.3}", self.seconds)),
            ("luxel.features", self.features.join(" ")),
            ("luxel.settings", self.settings.clone()),
        ]
    }
}

#[cfg(test)]
pub(super) fn example() -> Metadata {
    Metadata {
        scene: "Szenen/Würfel 立方体.ron".to_owned(),
        scene_hash: "0123456789abcdef".to_owned(),
        samples: 64,
        backend: Backend::Cpu,
        device: "a processor".to_owned(),
        seconds: 1.25,
        features: vec!["spheres".to_owned(), "lambert".to_owned()],
        settings: "(max_depth: 8)".to_owned(),
    }
}
