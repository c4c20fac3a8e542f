//! Which room may depend on which, and which library belongs where.

use cargo_metadata::{DependencyKind, MetadataCommand};

use crate::root;

/// What one crate may depend on (ARCHITECTURE.md, "Rooms").
struct Room {
    name: &'static str,
    /// Crates of this workspace.
    rooms: &'static [&'static str],
    /// Those of the [`GUARDED`] libraries that belong in this room.
    guarded: &'static [&'static str],
}

/// Libraries that are welcome only where the table says so, with everything named after them (`egui_plot`, `wgpu-hal`).
const GUARDED: [&str; 6] = ["wgpu", "naga", "bevy_ecs", "egui", "winit", "clap"];

#[rustfmt::skip]
const ROOMS: [Room; 16] = [
    Room { name: "luxel_geom", rooms: &[], guarded: &[] },
    Room { name: "luxel_flat", rooms: &["luxel_geom"], guarded: &[] },
    Room { name: "luxel_accel", rooms: &["luxel_geom", "luxel_flat"], guarded: &[] },
    Room { name: "luxel_scene", rooms: &["luxel_geom"], guarded: &["bevy_ecs"] },
    Room { name: "luxel_bake", rooms: &["luxel_scene", "luxel_accel", "luxel_flat", "luxel_geom"], guarded: &["bevy_ecs"] },
    Room { name: "luxel_film", rooms: &["luxel_geom", "luxel_flat"], guarded: &[] },
    Room { name: "luxel_cpu", rooms: &["luxel_geom", "luxel_flat", "luxel_film"], guarded: &[] },
    Room { name: "luxel_gpu", rooms: &["luxel_flat"], guarded: &["wgpu", "naga"] },
    Room { name: "luxel_render", rooms: &["luxel_geom", "luxel_gpu", "luxel_flat", "luxel_film"], guarded: &["bevy_ecs"] },
    Room {
        name: "luxel_engine",
        rooms: &[
            "luxel_geom", "luxel_flat", "luxel_accel", "luxel_scene", "luxel_bake",
            "luxel_film", "luxel_cpu", "luxel_gpu", "luxel_render",
        ],
        guarded: &["bevy_ecs"],
    },
    Room { name: "luxel_lod", rooms: &["luxel_geom", "luxel_flat", "luxel_accel", "luxel_cpu"], guarded: &[] },
    Room {
        name: "luxel_study",
        rooms: &["luxel_engine", "luxel_lod", "luxel_accel", "luxel_scene", "luxel_geom"],
        guarded: &["bevy_ecs"],
    },
    Room { name: "luxel_testkit", rooms: &["luxel_geom", "luxel_flat"], guarded: &[] },
    Room { name: "luxel_cli", rooms: &["luxel_engine", "luxel_study"], guarded: &["clap"] },
    Room { name: "luxel", rooms: &["luxel_cli"], guarded: &[] },
    Room { name: "xtask", rooms: &["luxel_flat", "luxel_geom"], guarded: &[] },
];

/// Tests may use other rooms as oracles; only the room that all tests share must stay out of their way.
const DEV_DEPENDENCIES_COUNT: &str = "luxel_testkit";

/// One line `from` → `to` of a manifest.
#[derive(Clone)]
struct Door {
    from: String,
    to: String,
    kind: DependencyKind,
}

fn doors() -> Vec<Door> {
    let metadata = MetadataCommand::new().manifest_path(root().join("Cargo.toml")).no_deps().exec().unwrap();
    let of_package = |package: cargo_metadata::Package| {
        let from = package.name.to_string();
        package.dependencies.into_iter().map(move |to| Door {
            from: from.clone(),
            to: to.name,
            kind: to.kind,
        })
    };
    metadata.packages.into_iter().flat_map(of_package).collect()
}

fn forbidden_doors(doors: &[Door]) -> Vec<String> {
    let counts =
        |door: &&Door| door.kind != DependencyKind::Development || door.from == DEV_DEPENDENCIES_COUNT;
    let complaint = |door: &Door| format!("{} may not depend on {}", door.from, door.to);
    doors.iter().filter(counts).filter(|door| !is_allowed(door)).map(complaint).collect()
}

fn is_allowed(door: &Door) -> bool {
    let room = ROOMS.iter().find(|room| room.name == door.from);
    let family = GUARDED.into_iter().find(|guarded| is_of_family(&door.to, guarded));
    let is_room = door.to.starts_with("luxel") || door.to == "xtask";
    match room {
        None => false,
        Some(room) if is_room => room.rooms.contains(&door.to.as_str()),
        Some(room) => family.is_none_or(|family| room.guarded.contains(&family)),
    }
}

fn is_of_family(name: &str, guarded: &str) -> bool {
    name.strip_prefix(guarded).is_some_and(|rest| rest.is_empty() || rest.starts_with(['-', '_']))
}

#[test]
fn rooms_open_only_their_own_doors() {
    let doors = doors();
    let is_there = |from: &str, to: &str| doors.iter().any(|door| door.from == from && door.to == to);
    assert!(
        is_there("luxel_cpu", "luxel_flat") && is_there("luxel_gpu", "wgpu"),
        "the manifests were not read"
    );
    assert_eq!(forbidden_doors(&doors), Vec::<String>::new());
}

#[test]
fn a_forbidden_door_is_found() {
    use DependencyKind::{Build, Development, Normal};
    let door = |from: &str, to: &str, kind| Door { from: from.to_owned(), to: to.to_owned(), kind };
    let forbidden = [
        door("luxel_cpu", "luxel_accel", Normal),
        door("luxel_accel", "bevy_ecs", Normal),
        door("luxel_render", "luxel_scene", Build),
        door("luxel_bake", "wgpu-hal", Normal),
        door("luxel_engine", "clap", Normal),
        door("luxel_study", "egui_plot", Normal),
        door("luxel_testkit", "luxel_bake", Development),
        door("luxel_geom", "luxel_new_room", Normal),
        door("luxel_new_room", "luxel_geom", Normal),
    ];
    for door in forbidden {
        assert_eq!(forbidden_doors(std::slice::from_ref(&door)).len(), 1, "{} → {}", door.from, door.to);
    }
    let allowed = [
        door("luxel_cpu", "luxel_accel", Development),
        door("luxel_cpu", "rayon", Normal),
        door("luxel_gpu", "wgpu", Normal),
        door("luxel_geom", "wgputils", Normal),
    ];
    assert_eq!(forbidden_doors(&allowed), Vec::<String>::new());
}
