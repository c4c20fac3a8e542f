//! The command line as data: commands, options, their help.
use std::path::PathBuf;

use clap::{Args, Parser, Subcommand};
use luxel_engine::output::Precision;
use luxel_engine::{
    AovKind, BackendChoice, LightSampling, MAX_DEPTH, MeshAccel, MeshLevels, MeshQuality, QUALITIES, Quality,
    SphereAccel, ToneMap, View,
};
use luxel_study::voxel::ErrorMethod;

use crate::values;

const EXIT_CODES: &str = "\
Exit codes:
  0  done (a render that Ctrl-C stopped counts as done: its picture is written)
  1  a comparison exceeded its limit
  2  bad usage or bad input
  3  the machine cannot do it
An error is one line on stderr. LUXEL_LOG sets what is logged there (error, warn, info, debug, or a filter).";

macro_rules! after_help {
    ($examples:literal) => {
        concat!(
            "Examples:\n",
            $examples,
            "\n\nExit codes: 0 done, 1 comparison failed, 2 bad usage or input, 3 the machine cannot do it."
        )
    };
}

/// A path tracer for spheres, triangle meshes and voxel volumes in one scene.
///
/// Without a command: renders the showcase scene for about a minute to showcase.png in the current folder.
#[derive(Parser)]
#[command(name = "luxel", version, after_help = EXIT_CODES)]
pub(crate) struct Cli {
    #[command(subcommand)]
    pub(crate) command: Option<Command>,
}

#[derive(Subcommand)]
pub(crate) enum Command {
    /// Render a scene (.ron) or a model (.gltf, .glb, .obj, .ply, .vox) to a picture
    ///
    /// A model gets what it lacks: a camera that frames it, a ground, a sky, a lamp.
    ///
    /// Stops at the first limit that is reached of --spp, --time and --error; without any, at the scene's samples per
    /// pixel. Ctrl-C stops, writes what there is, says so and exits with 0; a second Ctrl-C ends the program at once
    /// (130) without a picture.
    Render(RenderArgs),
    /// Say what a scene holds, costs and calls for
    ///
    /// Prints counts, memory per heap, the structures with their depths, which one the spheres have and why, features
    /// in use and left out with the reason for each, cameras and the scenes of a glTF file with their numbers, what of a model
    /// is used, ignored and dropped, and warnings.
    Info(InfoArgs),
    /// Show the passes that a scene would run, and why
    ///
    /// Prints the passes of the render graph in order, whether each would run for this scene, and why.
    Graph(GraphArgs),
    /// Measure how far picture B is from the reference A
    ///
    /// Prints RMSE, relMSE, PSNR, SSIM and FLIP of two PNG or two EXR pictures of one size. A limit that is exceeded,
    /// or whose metric does not exist for the pair, makes the exit code 1.
    Compare(CompareArgs),
    /// Measure, and make a page of what comes out
    ///
    /// A study measures one thing on this machine and leaves a record per run, a table and a page that opens without
    /// a network.
    Study(StudyArgs),
    /// Say what this machine offers and what a render would use
    ///
    /// Prints the graphics adapters (with --json their limits too), the backend that auto takes and why, and what the best
    /// adapter's driver does to floating-point numbers.
    Doctor(DoctorArgs),
}

/// Options of `luxel render`.
#[derive(Args)]
#[command(after_help = after_help!("  \
  luxel render assets/showcase.ron
  luxel render bunny.obj -o bunny.png --size 640x480 --spp 128
  luxel render helmet.glb --environment studio.hdr --camera front
  luxel render scene.ron -o scene.exr --aov albedo,normal,depth --error 2%
  luxel render scene.ron -o heat.png --view steps --backend gpu --json
  luxel render assets/random_spheres.ron --quality low --sphere-accel bvh"))]
pub(crate) struct RenderArgs {
    /// Picture to write: .png (tone mapped, sRGB) or .exr (linear); FILE's name with .png in the current folder if not given
    #[arg(short, long, value_name = "OUT")]
    pub(crate) output: Option<PathBuf>,

    /// Width and height in pixels [default: the scene's]
    #[arg(long, value_name = "WxH", value_parser = values::size, allow_hyphen_values = true)]
    pub(crate) size: Option<(u32, u32)>,

    /// Where to trace; auto takes a hardware GPU if there is one, else the CPU
    #[arg(long, default_value = "auto", value_parser = values::named(vec![
        ("auto", BackendChoice::Auto), ("gpu", BackendChoice::Gpu), ("cpu", BackendChoice::Cpu),
    ]))]
    pub(crate) backend: BackendChoice,

    /// Samples and depth together: low is 4 samples per pixel and depth 4, standard 16 and 8, high 32 and 16; --spp and --max-depth win
    #[arg(long, value_name = "PRESET", value_parser = values::named(
        QUALITIES.iter().map(|row| (row.name, row.quality)).collect(),
    ))]
    pub(crate) quality: Option<Quality>,

    /// Stop at this many samples per pixel
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..), allow_negative_numbers = true)]
    pub(crate) spp: Option<u32>,

    /// Stop after this many seconds of tracing (every pixel gets at least one sample, however short the time)
    #[arg(long, value_name = "SECS", value_parser = values::positive, allow_negative_numbers = true)]
    pub(crate) time: Option<f64>,

    /// Stop when the estimated relative error of the picture is this small, such as 2%
    #[arg(long, value_name = "PERCENT", value_parser = values::percent, allow_hyphen_values = true)]
    pub(crate) error: Option<f64>,

    /// Seed of the random numbers; equal seeds give equal pictures [default: the scene's]
    #[arg(long, value_name = "N", allow_negative_numbers = true)]
    pub(crate) seed: Option<u32>,

    /// How often light may scatter after the first hit, 0 to 65535 [default: the scene's]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(..=i64::from(MAX_DEPTH)),
        allow_negative_numbers = true)]
    pub(crate) max_depth: Option<u32>,

    /// How lights are found: mis samples lights and scattering and weights both, nee samples lights alone, bsdf scatters
    /// alone; all three make the same picture, with more or less noise [default: the scene's]
    #[arg(long, value_name = "NAME", value_parser = values::named(vec![
        ("mis", LightSampling::Mis), ("nee", LightSampling::Nee), ("bsdf", LightSampling::Bsdf),
    ]))]
    pub(crate) light_sampling: Option<LightSampling>,

    #[command(flatten)]
    pub(crate) scene: SceneArgs,

    /// Camera to look through, by name or by number from 0 [default: the scene's]
    #[arg(long, value_name = "NAME")]
    pub(crate) camera: Option<String>,

    /// Outputs beside the picture, separated by commas: layers of an EXR, files OUT.NAME.png beside a PNG
    #[arg(long, value_name = "LIST", value_delimiter = ',', value_parser = values::named(
        AovKind::ALL.iter().map(|kind| (kind.name(), *kind)).collect(),
    ))]
    pub(crate) aov: Vec<AovKind>,

    /// What a PNG shows: the path-traced picture, a first-hit output, or the work per camera ray (steps)
    #[arg(long, value_name = "MODE", default_value = View::PathTraced.name(), value_parser = values::named(
        View::ALL.iter().map(|view| (view.name(), *view)).collect(),
    ))]
    pub(crate) view: View,

    /// Curve from radiance to display, for PNG [default: the scene's]
    #[arg(long, value_name = "CURVE", value_parser = values::named(
        ToneMap::ALL.iter().map(|curve| (curve.name(), *curve)).collect(),
    ))]
    pub(crate) tone_map: Option<ToneMap>,

    /// Brightness in stops, for PNG: each doubles it [default: the scene's]
    #[arg(long, value_name = "STOPS", value_parser = values::finite, allow_negative_numbers = true)]
    pub(crate) exposure: Option<f32>,

    /// How an EXR keeps colours [default: half]
    #[arg(long, value_name = "BITS", value_parser = values::named(vec![
        ("half", Precision::Half), ("float", Precision::Float),
    ]))]
    pub(crate) exr_precision: Option<Precision>,

    /// Print one JSON object (times, rays per second, counters, files) instead of a line
    #[arg(long)]
    pub(crate) json: bool,
}

/// A scene and what is asked of its structures, for every command that loads one.
#[derive(Args)]
pub(crate) struct SceneArgs {
    /// Scene (.ron) or model (.gltf, .glb, .obj, .ply, .vox)
    pub(crate) file: PathBuf,

    /// Scene of a glTF model, by name or by number from 0 [default: the model's]
    #[arg(long, value_name = "NAME")]
    pub(crate) scene: Option<String>,

    /// Picture around the scene (.hdr, .exr; a .png or .jpg ends at white) in place of its sky; a model then gets no lamp
    #[arg(long, value_name = "FILE")]
    pub(crate) environment: Option<PathBuf>,

    /// Structure by which rays find spheres; auto measures which costs least. No picture depends on it, but octree-seed's is
    /// for comparison and sometimes wrong [default: the scene's]
    #[arg(long, value_name = "NAME", value_parser = values::named(SphereAccel::NAMES.to_vec()))]
    pub(crate) sphere_accel: Option<SphereAccel>,

    /// How rays find the triangles of a mesh. No picture depends on it [default: the scene's, else bvh]
    #[arg(long, value_name = "NAME", value_parser = values::named(MeshAccel::NAMES.to_vec()))]
    pub(crate) mesh_accel: Option<MeshAccel>,

    /// How much work goes into the trees of meshes. No picture depends on it [default: the scene's, else medium]
    #[arg(long, value_name = "PRESET", value_parser = values::named(MeshQuality::NAMES.to_vec()))]
    pub(crate) mesh_quality: Option<MeshQuality>,

    /// A tree over each mesh and one over their places, or one over all triangles: for comparison, and not for scenes in
    /// which things move. Pictures are the same within rounding, ids are not [default: the scene's, else two]
    #[arg(long, value_name = "NAME", value_parser = values::named(MeshLevels::NAMES.to_vec()))]
    pub(crate) mesh_levels: Option<MeshLevels>,
}

/// Options of `luxel info`.
#[derive(Args)]
#[command(after_help = after_help!("  luxel info assets/showcase.ron\n  luxel info assets/random_spheres.ron --sphere-accel bvh --json"))]
pub(crate) struct InfoArgs {
    #[command(flatten)]
    pub(crate) scene: SceneArgs,

    /// Print one JSON object
    #[arg(long)]
    pub(crate) json: bool,
}

/// Options of `luxel graph`.
#[derive(Args)]
#[command(after_help = after_help!("  luxel graph assets/showcase.ron\n  luxel graph assets/empty.ron --aov --json"))]
pub(crate) struct GraphArgs {
    #[command(flatten)]
    pub(crate) scene: SceneArgs,

    /// As if first-hit outputs were asked for
    #[arg(long)]
    pub(crate) aov: bool,

    /// Print one JSON object
    #[arg(long)]
    pub(crate) json: bool,
}

/// Options of `luxel compare`.
#[derive(Args)]
#[command(after_help = after_help!("  luxel compare reference.exr test.exr\n  luxel compare a.png b.png --max-flip 0.05 --json"))]
pub(crate) struct CompareArgs {
    /// Reference picture (.png or .exr)
    pub(crate) a: PathBuf,

    /// Picture to judge, of the same kind and size
    pub(crate) b: PathBuf,

    /// Largest root mean square error of display values, 0 to 1
    #[arg(long, value_name = "X", value_parser = values::limit, allow_negative_numbers = true)]
    pub(crate) max_rmse: Option<f64>,

    /// Largest relative mean square error of linear values (EXR only)
    #[arg(long, value_name = "X", value_parser = values::limit, allow_negative_numbers = true)]
    pub(crate) max_relmse: Option<f64>,

    /// Smallest peak signal-to-noise ratio, decibels
    #[arg(long, value_name = "X", value_parser = values::limit, allow_negative_numbers = true)]
    pub(crate) min_psnr: Option<f64>,

    /// Smallest structural similarity, 1 when equal
    #[arg(long, value_name = "X", value_parser = values::limit, allow_negative_numbers = true)]
    pub(crate) min_ssim: Option<f64>,

    /// Largest mean FLIP difference, 0 when equal
    #[arg(long, value_name = "X", value_parser = values::limit, allow_negative_numbers = true)]
    pub(crate) max_flip: Option<f64>,

    /// Print one JSON object
    #[arg(long)]
    pub(crate) json: bool,
}

/// Options of `luxel study`.
#[derive(Args)]
#[command(after_help = after_help!("  luxel study octree --quick --out out\n  luxel study bvh --quick\n  luxel study bvh --help"))]
pub(crate) struct StudyArgs {
    #[command(subcommand)]
    pub(crate) study: Study,
}

/// The studies.
#[derive(Subcommand)]
pub(crate) enum Study {
    /// Naive, octrees and BVH over spheres: the assessment of seed document 1, made again
    ///
    /// Writes runs.jsonl (a line per run), runs.csv and octree.html to DIR. Each configuration is measured in up to 50
    /// frames within its time; the whole takes about an hour, with --quick less than two minutes on two cores.
    /// A runs.jsonl of an earlier study in DIR becomes runs.previous-1.jsonl, or the next number that is free; files of
    /// these names that are of no octree study are an error. Ctrl-C stops and writes the page with what there is; a
    /// second one ends the program at once, and what was measured stays in runs.jsonl.part, which the next study
    /// keeps with a number as well.
    Octree(OctreeArgs),
    /// Triangle meshes by BVH, and the materials and lights of seed document 2: its results, made again
    ///
    /// Writes runs.jsonl (a line per run), runs.csv and bvh.html to DIR. Shows a rabbit of our own as the 70,000 triangles
    /// of the bunny, or the model of FILE. The whole takes about half an hour, with --quick less than three minutes on
    /// two cores. Files of an earlier study in DIR, Ctrl-C and runs.jsonl.part are treated as by the octree study.
    Bvh(BvhArgs),
    /// Voxel octrees with error-aware level of detail: seed document 3, made again
    ///
    /// Writes runs.jsonl (a line per picture), runs.csv and voxel.html to DIR. Its four landscapes of 2048³ cells are made
    /// once and kept in the cache folder (LUXEL_CACHE, or luxel in the user's); with --quick it is one of 512³, in less than
    /// three minutes on two cores. Ctrl-C stops and writes the page with what there is; the next study in DIR goes on
    /// from there. With --error-table it writes instead what a node hides from each direction of a file, for every set of
    /// children.
    Voxel(VoxelArgs),
}

/// What every study takes.
#[derive(Args)]
pub(crate) struct StudyOptions {
    /// Smaller pictures, fewer frames and steps, the same figures
    #[arg(long)]
    pub(crate) quick: bool,

    /// Where to trace; a software GPU driver counts as a GPU
    #[arg(long, default_value = "both", value_parser = values::named(vec![
        ("cpu", StudyBackends::Cpu), ("gpu", StudyBackends::Gpu), ("both", StudyBackends::Both),
    ]))]
    pub(crate) backend: StudyBackends,

    /// Seconds of frames per configuration (at least a frame per turn is measured, however short the time)
    #[arg(long, value_name = "SECS", value_parser = values::positive, allow_negative_numbers = true)]
    pub(crate) seconds: Option<f64>,

    /// Measure nothing: make table and page again from this runs.jsonl
    #[arg(long, value_name = "RUNS", conflicts_with_all = ["quick", "backend", "seconds"])]
    pub(crate) from: Option<PathBuf>,
}

/// Options of `luxel study octree`.
#[derive(Args)]
#[command(after_help = after_help!("  \
  luxel study octree --quick
  luxel study octree --backend cpu --out out
  luxel study octree --from out/runs.jsonl --out again"))]
pub(crate) struct OctreeArgs {
    #[command(flatten)]
    pub(crate) options: StudyOptions,

    /// Folder to write to; made if it is missing
    #[arg(long, value_name = "DIR", default_value = "octree-study")]
    pub(crate) out: PathBuf,
}

/// Options of `luxel study bvh`.
#[derive(Args)]
#[command(after_help = after_help!("  \
  luxel study bvh --quick
  luxel study bvh bunny.obj --backend gpu --out out
  luxel study bvh --from out/runs.jsonl --out again"))]
pub(crate) struct BvhArgs {
    /// Model (.obj, .ply, .gltf, .glb) in place of the rabbit; where the number of triangles is varied the rabbit stays
    #[arg(conflicts_with = "from")]
    pub(crate) file: Option<PathBuf>,

    #[command(flatten)]
    pub(crate) options: StudyOptions,

    /// Folder to write to; made if it is missing
    #[arg(long, value_name = "DIR", default_value = "bvh-study")]
    pub(crate) out: PathBuf,
}

/// Options of `luxel study voxel`.
#[derive(Args)]
#[command(after_help = after_help!("  \
  luxel study voxel --quick
  luxel study voxel --out out
  luxel study voxel --from out/runs.jsonl --out again
  luxel study voxel --error-table exact --directions directions.csv -o errors.csv"))]
pub(crate) struct VoxelArgs {
    /// One landscape of 512³ cells instead of four of 2048³
    #[arg(long)]
    pub(crate) quick: bool,

    /// Measure nothing: make table and page again from this runs.jsonl
    #[arg(long, value_name = "RUNS", conflicts_with = "quick")]
    pub(crate) from: Option<PathBuf>,

    /// Folder to write to; made if it is missing
    #[arg(long, value_name = "DIR", default_value = "voxel-study")]
    pub(crate) out: PathBuf,

    /// Write a table of errors: a row for every direction, a column for each of the 256 sets of children (bit i stands for
    /// child i: x lowest, then y, then z). Errors are found by casting 512² rays, from nine coefficients of spherical
    /// harmonics, or by exact areas
    #[arg(long, value_name = "METHOD", requires_all = ["directions", "output"], conflicts_with_all = ["quick", "from", "out"],
        value_parser = values::named(vec![
        ("raycast", ErrorMethod::RayCast), ("sh9", ErrorMethod::Sh9), ("exact", ErrorMethod::Exact),
    ]))]
    pub(crate) error_table: Option<ErrorMethod>,

    /// Directions of the table of errors: rows of x, y, z of any length. If names stand above them, numbers of sets stand
    /// above the table
    #[arg(long, value_name = "CSV", requires = "error_table")]
    pub(crate) directions: Option<PathBuf>,

    /// Where to write the table of errors
    #[arg(short, long, value_name = "CSV", requires = "error_table")]
    pub(crate) output: Option<PathBuf>,
}

/// Backends that a study measures.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum StudyBackends {
    Cpu,
    Gpu,
    Both,
}

/// Options of `luxel doctor`.
#[derive(Args)]
#[command(after_help = after_help!("  luxel doctor\n  luxel doctor --json"))]
pub(crate) struct DoctorArgs {
    /// Print one JSON object
    #[arg(long)]
    pub(crate) json: bool,
}

#[cfg(test)]
mod tests {
    use clap::CommandFactory;

    use super::*;

    #[test]
    fn the_command_line_is_sound() {
        Cli::command().debug_assert();
    }

    #[test]
    fn every_command_shows_examples_and_exit_codes() {
        for command in Cli::command().get_subcommands_mut() {
            let help = command.render_long_help().to_string();
            assert!(help.contains("Examples:") && help.contains("Exit codes: 0 done"), "{help}");
        }
    }

    #[test]
    fn the_help_of_quality_says_what_the_table_says() {
        let help = Cli::command().find_subcommand_mut("render").unwrap().render_long_help().to_string();
        let words = help.split_whitespace().collect::<Vec<_>>().join(" ");
        let [low, standard, high] = [&QUALITIES[0], &QUALITIES[1], &QUALITIES[2]];
        let expected = format!(
            "low is {} samples per pixel and depth {}, standard {} and {}, high {} and {}",
            low.spp, low.max_depth, standard.spp, standard.max_depth, high.spp, high.max_depth
        );
        assert!(words.contains(&expected), "{words}");
    }

    #[test]
    fn options_are_read() {
        let line = "luxel render a.ron -o b.exr --size 8x4 --error 2% --aov depth,ids --exposure -1 --tone-map agx \
                    --quality low --sphere-accel octree-base --mesh-accel bvh-escape --mesh-quality best \
                    --mesh-levels one";
        let Some(Command::Render(args)) = Cli::try_parse_from(line.split_whitespace()).unwrap().command
        else {
            panic!()
        };
        assert_eq!((args.size, args.error, args.exposure), (Some((8, 4)), Some(0.02), Some(-1.0)));
        assert_eq!(args.aov, [AovKind::Depth, AovKind::Ids]);
        assert_eq!((args.tone_map, args.view), (Some(ToneMap::AgX), View::PathTraced));
        assert_eq!(
            (args.quality, args.scene.sphere_accel),
            (Some(Quality::Low), Some(SphereAccel::OctreeBase))
        );
        let meshes = (args.scene.mesh_accel, args.scene.mesh_quality, args.scene.mesh_levels);
        let expected = (Some(MeshAccel::BvhEscape), Some(MeshQuality::Best), Some(MeshLevels::One));
        assert_eq!(meshes, expected);
    }
}
