//! Rooms, the top modules of a crate: each imports only from those below it, there are few, and a public type has a name of its own.

use std::collections::BTreeMap;

use host_tests::emulator::toolchain::workspace;

use super::hygiene::{read, sources};

/// The most rooms that a crate has.
const MOST: usize = 12;

/// The rooms of each crate, from the uppermost down.
const ROOMS: [(&str, &[&str]); 3] = [
    ("kernel", &["tests", "flips", "plan", "methods", "bounds", "small", "pendulum", "error", "table", "numbers"]),
    (
        "firmware",
        &["board", "app", "scenes", "job", "motion", "display", "graphics", "protocol", "fault", "config", "prices"],
    ),
    ("host-tests", &["commands", "oracle", "emulator", "console", "link"]),
];
/// Crates in which no two public types have one name.
const NAMED_APART: [&str; 3] = ["kernel", "firmware", "host-tests"];

/// The lines of each room's files; programs and the list of rooms itself stand above all.
fn lines(krate: &str) -> Vec<(String, String)> {
    let source = workspace().join(krate).join("src");
    let mut lines = Vec::new();
    for path in sources(&format!("{krate}/src")) {
        let room = path.strip_prefix(&source).expect("within").iter().next().expect("a file").to_string_lossy();
        let room = room.trim_end_matches(".rs").to_owned();
        if !["lib", "main", "bin"].contains(&&*room) {
            lines.extend(read(path).lines().map(|line| (room.clone(), line.trim().to_owned())));
        }
    }
    lines
}

/// The rooms that a line of code names, in an import or otherwise.
fn named(line: &str) -> impl Iterator<Item = &str> {
    let code = line.split("//").next().unwrap_or_default();
    code.split("crate::").skip(1).filter_map(|rest| rest.split(|c: char| !c.is_alphanumeric() && c != '_').next())
}

#[test]
fn a_room_imports_only_from_those_below_it() {
    for (krate, rooms) in ROOMS {
        let place = |room: &str| rooms.iter().position(|known| *known == room);
        let lines = lines(krate);
        let mut found: Vec<_> = lines.iter().map(|(room, _)| room.as_str()).collect();
        found.dedup();
        let unknown: Vec<_> = found.iter().filter(|room| place(room).is_none()).collect();
        assert!(
            unknown.is_empty() && found.len() == rooms.len(),
            "{krate}: rooms not listed {unknown:?}, of {found:?}"
        );
        assert!(rooms.len() <= MOST, "{krate} has {} rooms", rooms.len());
        let upwards: Vec<_> = lines
            .iter()
            .flat_map(|(room, line)| named(line).map(move |other| (room, other, line)))
            .filter(|(room, other, _)| place(other).is_some() && place(other) < place(room))
            .collect();
        assert!(upwards.is_empty(), "{krate}: {upwards:#?}");
    }
}

#[test]
fn a_public_type_has_a_name_of_its_own() {
    for krate in NAMED_APART {
        let mut places = BTreeMap::<String, Vec<String>>::new();
        for (room, line) in lines(krate) {
            let keyword = ["pub struct ", "pub enum ", "pub trait ", "pub type "].into_iter();
            if let Some(rest) = keyword.filter_map(|keyword| line.strip_prefix(keyword)).next() {
                let name = rest.split(|c: char| !c.is_alphanumeric() && c != '_').next().unwrap_or_default();
                // A macro's placeholder is no name.
                if !name.is_empty() {
                    places.entry(name.to_owned()).or_default().push(room);
                }
            }
        }
        let twice: Vec<_> = places.iter().filter(|(_, rooms)| rooms.len() > 1).collect();
        assert!(twice.is_empty(), "{krate}: {twice:?}");
    }
}
