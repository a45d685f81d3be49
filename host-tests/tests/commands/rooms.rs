//! Rooms are the top modules of a crate, or the crates of a folder. Each room imports only from the
//! rooms below it. There are few rooms, and the name of a public type is unique.

use std::collections::BTreeSet;

use emulator::toolchain::workspace;

use super::hygiene::{read, sources};

/// The largest number of rooms in a folder.
const MOST: usize = 12;

/// The folders of sources, each with its rooms from top to bottom.
const ROOMS: [(&str, &[&str]); 4] = [
    (
        "kernel/src",
        &[
            "tests", "golden", "flips", "plan", "methods", "bounds", "small", "pendulum", "error",
            "table", "numbers",
        ],
    ),
    (
        "firmware/src",
        &[
            "board", "app", "protocol", "scenes", "job", "motion", "display", "graphics", "fault",
            "config",
        ],
    ),
    (
        "host-tests/tools",
        &["commands", "oracle", "demo", "vectors", "console"],
    ),
    (
        "host-tests/emulator/src",
        &[
            "pico",
            "qemu",
            "toolchain",
            "budgets",
            "host",
            "flash",
            "boards",
            "out_file",
            "scratch",
            "process",
            "stream",
            "link",
        ],
    ),
];

/// Groups of folders. The name of a public type is unique within a group.
const NAMESPACES: [&[&str]; 3] = [
    &["kernel/src"],
    &["firmware/src"],
    &["host-tests/tools", "host-tests/emulator/src"],
];

/// Returns the lines of each room's files. Programs and the list of rooms itself are above all
/// rooms.
fn lines(folder: &str) -> Vec<(String, String)> {
    let source = workspace().join(folder);
    let mut lines = Vec::new();
    for path in sources(folder) {
        // A room is the first component of the path: a file or a folder.
        let room = path
            .strip_prefix(&source)
            .expect("within")
            .iter()
            .next()
            .expect("a file")
            .to_string_lossy();
        let room = room.trim_end_matches(".rs").to_owned();
        if !["lib", "main", "bin"].contains(&&*room) {
            lines.extend(
                read(path)
                    .lines()
                    .map(|line| (room.clone(), line.trim().to_owned())),
            );
        }
    }
    lines
}

/// Returns the name at the beginning of a text.
fn name(text: &str) -> &str {
    text.split(|c: char| !c.is_alphanumeric() && c != '_')
        .next()
        .unwrap_or_default()
}

/// The rooms in the sources are exactly those of [`ROOMS`], at most [`MOST`] in a folder, and no
/// `crate::` path names a room above the one it is in.
#[test]
fn a_room_imports_only_from_those_below_it() {
    for (folder, rooms) in ROOMS {
        let place = |room: &str| rooms.iter().position(|known| *known == room);
        let lines = lines(folder);
        let found: BTreeSet<_> = lines.iter().map(|(room, _)| room.as_str()).collect();
        assert_eq!(found, rooms.iter().copied().collect(), "{folder}");
        assert!(rooms.len() <= MOST, "{folder} has {} rooms", rooms.len());

        // The name of a room may be in an import or elsewhere.
        let code = lines
            .iter()
            .map(|(room, line)| (room, line.split("//").next().unwrap_or_default()));
        assert!(
            code.clone().all(|(_, code)| !code.contains("crate::{")),
            "{folder}: rooms in one import are not seen"
        );
        let imports = code.flat_map(|(room, code)| {
            code.split("crate::")
                .skip(1)
                .map(move |rest| (room, name(rest)))
        });
        let upwards: Vec<_> = imports
            .filter(|(room, other)| place(other).is_some() && place(other) < place(room))
            .collect();
        assert!(upwards.is_empty(), "{folder}: {upwards:#?}");
    }
}

/// No two public types of a group of [`NAMESPACES`] have the same name.
#[test]
fn a_public_type_has_a_name_of_its_own() {
    for folders in NAMESPACES {
        let mut seen = BTreeSet::new();
        let lines: Vec<_> = folders.iter().flat_map(|folder| lines(folder)).collect();
        let types = ["pub struct ", "pub enum ", "pub trait ", "pub type "];
        let declared = lines
            .iter()
            .filter_map(|(_, line)| types.iter().find_map(|keyword| line.strip_prefix(keyword)));

        // The placeholder of a macro is not a name.
        let twice: Vec<_> = declared
            .map(name)
            .filter(|name| !name.is_empty() && !seen.insert(*name))
            .collect();
        assert!(twice.is_empty(), "{folders:?}: {twice:?}");
    }
}
