//! `luxel info`: what a scene holds, what it costs, which features it calls for, and what was left out.
use std::fmt::Write;

use luxel_engine::info::SceneInfo;
use luxel_engine::{ExitCode, SceneEntry, SphereAccelFacts};

use crate::args::InfoArgs;
use crate::error::{CliError, one_line};
use crate::reply;

/// How many cameras and scenes are listed, besides the scenes that matter.
const MOST_NAMES: usize = 32;

/// Describes a scene.
pub(crate) fn info(args: &InfoArgs) -> Result<ExitCode, CliError> {
    let mut engine = args.scene.open()?;
    // Of the scene as it is in its file, whatever is asked for besides.
    let scene_hash = engine.scene_hash()?;
    args.scene.ask(&mut engine);
    let info = SceneInfo { scene_hash, ..engine.info()? };
    if args.json {
        reply::print_json(&info)?;
    } else {
        reply::print_text(&text(&info))?;
    }
    Ok(ExitCode::Done)
}

fn text(info: &SceneInfo) -> String {
    let mut sections = vec![head(info), structures(info), memory(info), features(info)];
    if !info.scenes.is_empty() {
        sections.push(lines("scenes", &scenes(&info.scenes)));
    }
    sections.push(lines("cameras", &first_few(info.cameras.iter().map(|name| (quoted(name), false)))));
    sections.push(lines("used of the model", &info.used));
    sections.push(lines("ignored", &info.ignored));
    sections.push(lines("dropped", &info.dropped));
    let warnings: Vec<String> = info.warnings.iter().chain(&info.baked.warnings).cloned().collect();
    sections.push(lines("warnings", &warnings));
    sections.join("\n")
}

fn head(info: &SceneInfo) -> String {
    let baked = &info.baked;
    format!(
        "{}  hash {}\nloaded in {:.3} s, built in {:.3} s\n\ncounts\n  {}\n  {} with {}\n  {}\n  {}\n",
        info.scene,
        info.scene_hash,
        info.load_secs,
        info.bake_secs,
        counted(baked.spheres, "sphere"),
        counted(baked.mesh_instances, "mesh instance"),
        counted(baked.instanced_triangles, "triangle"),
        counted(baked.volume_instances, "voxel volume"),
        counted(baked.materials, "material")
    )
}

/// `1 sphere`, `2 spheres`.
fn counted(count: impl Into<u64>, unit: &str) -> String {
    let count = count.into();
    if count == 1 { format!("1 {unit}") } else { format!("{count} {unit}s") }
}

/// The first of what can be asked for by number, and those further on that matter, with their numbers, and how many more
/// there are.
fn first_few(all: impl Iterator<Item = (String, bool)>) -> Vec<String> {
    let mut lines = Vec::new();
    let mut more = 0;
    for (number, (said, matters)) in all.enumerate() {
        if number < MOST_NAMES || matters {
            lines.push(format!("{number} {said}"));
        } else {
            more += 1;
        }
    }
    if more > 0 {
        lines.push(format!("and {more} more"));
    }
    lines
}

/// The first scenes, the default one and the one that is shown.
fn scenes(all: &[SceneEntry]) -> Vec<String> {
    first_few(all.iter().map(|entry| (scene(entry), entry.is_default || entry.is_shown)))
}

fn quoted(name: &str) -> String {
    format!("'{}'", one_line(name))
}

/// `'name' (default, shown)`.
fn scene(entry: &SceneEntry) -> String {
    let name = entry.name.as_deref().unwrap_or_default();
    let marks = [(entry.is_default, "default"), (entry.is_shown, "shown")];
    let marks: Vec<_> = marks.iter().filter(|(holds, _)| *holds).map(|(_, mark)| *mark).collect();
    match marks[..] {
        [] => quoted(name),
        _ => format!("{} ({})", quoted(name), marks.join(", ")),
    }
}

fn structures(info: &SceneInfo) -> String {
    let baked = &info.baked;
    let SphereAccelFacts { name, because, nodes, depth, bytes, .. } = &info.sphere_accel;
    let mut text = format!(
        "structures\n  TLAS depth {}\n  spheres: {name} of {}, depth {depth}, {}, because {because}\n",
        baked.tlas_depth,
        counted(*nodes, "node"),
        reply::bytes(*bytes)
    );
    for mesh in &baked.meshes {
        let (asset, triangles, nodes, depth) = (mesh.asset, mesh.triangles, mesh.nodes, mesh.depth);
        let name = if asset == 0 { "all meshes".to_owned() } else { format!("mesh {asset}") };
        let tree = match nodes {
            0 => format!("{}, in the tree over all meshes", counted(triangles, "triangle")),
            _ => format!(
                "BVH of {}, {}, depth {depth}",
                counted(triangles, "triangle"),
                counted(nodes, "node")
            ),
        };
        put(&mut text, format_args!("  {name}: {tree}"));
    }
    for volume in &baked.volumes {
        let of = [
            counted(volume.voxels, "voxel"),
            counted(volume.nodes, "node"),
            counted(volume.levels, "level"),
            counted(volume.materials, "material"),
        ];
        put(&mut text, format_args!("  volume {}: octree of {}", volume.asset, of.join(", ")));
    }
    text
}

fn memory(info: &SceneInfo) -> String {
    let heaps = &info.baked.bytes;
    let width = heaps.iter().map(|(name, _)| name.len()).max().unwrap_or(0).max("total".len());
    let total = heaps.iter().map(|(_, count)| count).sum();
    let mut text = "memory\n".to_owned();
    for (name, count) in heaps.iter().copied().chain([("total", total)]) {
        put(&mut text, format_args!("  {name:width$}  {:>10}", reply::bytes(count)));
    }
    text
}

fn features(info: &SceneInfo) -> String {
    let width = info.features.iter().map(|feature| feature.name.len()).max().unwrap_or(0);
    let mut text = String::new();
    for (title, used) in [("features in use", true), ("features left out", false)] {
        put(&mut text, format_args!("{title}"));
        for feature in info.features.iter().filter(|feature| feature.used == used) {
            put(&mut text, format_args!("  {:width$}  because {}", feature.name, feature.because));
        }
    }
    text
}

fn lines(title: &str, of: &[String]) -> String {
    if of.is_empty() {
        return format!("{title}: none");
    }
    of.iter().fold(title.to_owned(), |text, line| text + "\n  " + line)
}

/// Adds a line; a `String` takes all that it is given.
fn put(text: &mut String, line: std::fmt::Arguments<'_>) {
    _ = writeln!(text, "{line}");
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_default_scene_and_the_shown_one_are_listed_however_many_there_are() {
        let listed = |count, default, shown| {
            let entry = |at| SceneEntry { name: None, is_default: at == default, is_shown: at == shown };
            scenes(&(0..count).map(entry).collect::<Vec<_>>())
        };
        let lines = listed(100, 99, 40);
        assert_eq!(lines[31..], ["31 ''", "40 '' (shown)", "99 '' (default)", "and 66 more"]);
        assert_eq!(listed(34, 33, 33)[32..], ["33 '' (default, shown)", "and 1 more"]);
        assert_eq!(listed(33, 32, 0)[32..], ["32 '' (default)"]);
        assert_eq!(listed(32, 1, 1)[1..2], ["1 '' (default, shown)"]);
    }
}
