//! Options that were given and change nothing.
use std::path::Path;

use luxel_engine::output::Format;
use luxel_engine::{SphereAccel, SphereAccelFacts, View};

use crate::args::RenderArgs;

const LINEAR: &str = "an EXR holds linear light";
const LINEAR_BUT_ERROR: &str = "an EXR holds linear light (only the error estimate takes the exposure in)";
const NOT_PATH: &str = "only --view path is tone mapped";
const NOT_PATH_BUT_ERROR: &str = "only --view path is exposed (and the error estimate takes the exposure in)";
const NOT_EXR: &str = "it is for an EXR";
const NOTHING_LEFT: &str = "--spp and --max-depth say all that it stands for";

/// A note if a structure was asked for and the scene turns out to have no spheres.
pub(crate) fn without_spheres(asked: Option<SphereAccel>, facts: &SphereAccelFacts) -> Option<String> {
    (asked.is_some() && facts.nodes == 0)
        .then(|| "--sphere-accel has no effect: the scene has no spheres".to_owned())
}

/// A note if a scene of a model was asked for and the file is none that has several.
pub(crate) fn without_scenes(is_asked: bool, file: &Path) -> Option<String> {
    let ending = file.extension().unwrap_or_default().to_ascii_lowercase();
    let is_gltf = ending == "gltf" || ending == "glb";
    (is_asked && !is_gltf).then(|| {
        format!("--scene has no effect on {}: only a glTF model has scenes to choose from", file.display())
    })
}

/// One note per option that was given and does not change what is written to `output`.
///
/// `--aov` is never among them: it adds layers to an EXR and files beside a PNG.
pub(crate) fn ignored(args: &RenderArgs, output: &Path) -> Vec<String> {
    let is_exr = matches!(Format::of(output), Ok(Format::Exr));
    let (curve, exposure) = match (is_exr, args.view) {
        (true, _) => (Some(LINEAR), Some(LINEAR_BUT_ERROR)),
        (false, View::PathTraced) => (None, None),
        (false, _) => (Some(NOT_PATH), Some(NOT_PATH_BUT_ERROR)),
    };
    let precision = (!is_exr).then_some(NOT_EXR);
    let quality = (args.spp.is_some() && args.max_depth.is_some()).then_some(NOTHING_LEFT);
    let options = [
        ("--tone-map", args.tone_map.is_some(), curve),
        ("--exposure", args.exposure.is_some(), exposure),
        ("--exr-precision", args.exr_precision.is_some(), precision),
        ("--quality", args.quality.is_some(), quality),
    ];
    let given = options.into_iter().filter(|(_, is_given, _)| *is_given);
    let without_effect = given.filter_map(|(option, _, why)| {
        why.map(|why| format!("{option} has no effect on {}: {why}", output.display()))
    });
    without_scenes(args.scene.scene.is_some(), &args.scene.file).into_iter().chain(without_effect).collect()
}

#[cfg(test)]
mod tests {
    use clap::Parser;

    use super::*;
    use crate::args::{Cli, Command};

    /// The first word of each note on a render to `output` with these options.
    fn options_without_effect(output: &str, options: &str) -> Vec<String> {
        let line = format!("luxel render a.ron {options}");
        let Some(Command::Render(args)) = Cli::try_parse_from(line.split_whitespace()).unwrap().command
        else {
            panic!()
        };
        let notes = ignored(&args, Path::new(output));
        notes.iter().map(|note| note.split(' ').next().unwrap().to_owned()).collect()
    }

    #[test]
    fn an_exr_takes_no_curve_and_a_png_no_precision() {
        let all = "--tone-map agx --exposure 0 --exr-precision half --aov ids";
        assert_eq!(options_without_effect("a.exr", all), ["--tone-map", "--exposure"]);
        assert_eq!(options_without_effect("a.png", all), ["--exr-precision"]);
    }

    #[test]
    fn a_view_of_something_else_is_not_tone_mapped() {
        let all = "--view steps --exposure -1 --tone-map none";
        assert_eq!(options_without_effect("a.png", all), ["--tone-map", "--exposure"]);
    }

    #[test]
    fn a_preset_has_no_effect_where_both_its_numbers_are_given() {
        assert_eq!(options_without_effect("a.png", "--quality low --spp 4 --max-depth 4"), ["--quality"]);
        assert!(options_without_effect("a.png", "--quality low --spp 4").is_empty());
    }

    #[test]
    fn only_a_gltf_model_has_scenes() {
        assert_eq!(options_without_effect("a.png", "--scene 1"), ["--scene"]);
        for (file, has_note) in [("a.obj", true), ("a", true), ("a.GLTF", false), ("a.glb", false)] {
            assert_eq!(without_scenes(true, Path::new(file)).is_some(), has_note, "{file}");
        }
    }

    #[test]
    fn what_was_not_given_is_not_mentioned() {
        for output in ["a.exr", "a.png"] {
            assert!(options_without_effect(output, "--aov albedo").is_empty(), "{output}");
        }
    }
}
