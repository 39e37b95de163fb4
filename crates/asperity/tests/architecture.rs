//! Data walks one way: set ← law ← contact ← {solver, system} ← stepper ← simulate.

use std::fs;
use std::path::{Path, PathBuf};

/// Modules and what they may use.
const ALLOWED: [(&str, &[&str]); 9] = [
    ("law", &[]),
    ("contact", &["law"]),
    ("linear", &["contact"]),
    ("solver", &["law", "contact", "linear"]),
    ("system", &["law", "contact"]),
    ("stepper", &["law", "contact", "solver", "system"]),
    ("integrator", &["law", "contact", "linear", "solver", "system", "stepper"]),
    ("trajectory", &["contact", "integrator", "stepper"]),
    ("simulate", &["integrator", "solver", "stepper", "system", "trajectory"]),
];

/// Rooms of the event-driven integrator; each may use itself and those before it.
const EVENT_ROOMS: [&str; 11] = [
    "vectors",
    "state",
    "outcome",
    "observer",
    "options",
    "dynamics",
    "motion",
    "collocation",
    "event_function",
    "contact_problem",
    "integration",
];

/// Files of `integrator/event/integration`, likewise.
const INTEGRATION_FILES: [&str; 11] = [
    "variables",
    "attempt",
    "sampling",
    "detection",
    "location",
    "decision",
    "release",
    "impact",
    "transition",
    "start",
    "time_loop",
];

fn sources(path: &Path) -> Vec<PathBuf> {
    if path.is_file() {
        return vec![path.to_path_buf()];
    }
    let entries = fs::read_dir(path).unwrap();
    entries.flat_map(|entry| sources(&entry.unwrap().path())).collect()
}

#[test]
fn modules_depend_in_one_direction() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("src");
    for (module, allowed) in ALLOWED {
        let folder = root.join(module);
        let place = if folder.is_dir() { folder } else { root.join(module).with_extension("rs") };
        for file in sources(&place) {
            let text = fs::read_to_string(&file).unwrap();
            for used in text.split("crate::").skip(1) {
                let name: String = used.chars().take_while(|c| c.is_alphanumeric()).collect();
                let known = name == module || allowed.contains(&name.as_str());
                assert!(known, "{} uses crate::{name}", file.display());
            }
        }
    }
}

/// Every room of a folder uses only itself and the rooms before it.
fn check_order(folder: &str, rooms: &[&str]) {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("src").join(folder);
    let prefix = format!("crate::{}::", folder.replace('/', "::"));
    for (number, room) in rooms.iter().enumerate() {
        let inside = root.join(room);
        let place = if inside.is_dir() { inside } else { root.join(room).with_extension("rs") };
        for file in sources(&place) {
            let text = fs::read_to_string(&file).unwrap();
            for used in text.split(&prefix).skip(1) {
                let name: String =
                    used.chars().take_while(|c| c.is_alphanumeric() || *c == '_').collect();
                let before = rooms[..=number].contains(&name.as_str());
                assert!(before, "{} uses {prefix}{name}", file.display());
            }
        }
    }
}

#[test]
fn rooms_depend_in_one_direction() {
    check_order("integrator/event", &EVENT_ROOMS);
    check_order("integrator/event/integration", &INTEGRATION_FILES);
}
