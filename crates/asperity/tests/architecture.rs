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
    ("trajectory", &["contact", "stepper"]),
    ("simulate", &["solver", "stepper", "system", "trajectory"]),
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
