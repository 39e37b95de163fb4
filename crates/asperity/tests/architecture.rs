//! Data walks one way: set ← law ← contact ← {solver, system} ← integrator ← simulate; and within rooms no two files use
//! each other, in however many steps. The crate of sets and the binding are read in the same way.

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};

/// The rooms of the solvers and what they may use.
const SOLVER: [(&str, &[&str]); 16] = [
    ("measure", &[]),
    ("one_contact", &["measure"]),
    ("infeasible", &["measure", "one_contact"]),
    ("newton_matrix", &[]),
    ("report", &["measure"]),
    ("gauss_seidel", &["measure", "one_contact", "infeasible", "newton_matrix", "report"]),
    ("incumbent", &["measure", "one_contact", "infeasible", "report", "gauss_seidel"]),
    ("method", &["measure", "newton_matrix", "report", "gauss_seidel", "incumbent"]),
    ("settings", &["method"]),
    ("findings", &["measure", "infeasible", "report", "gauss_seidel"]),
    (
        "cascade",
        &[
            "infeasible",
            "newton_matrix",
            "report",
            "gauss_seidel",
            "incumbent",
            "method",
            "settings",
        ],
    ),
    (
        "island",
        &[
            "measure",
            "infeasible",
            "report",
            "gauss_seidel",
            "method",
            "settings",
            "findings",
            "cascade",
        ],
    ),
    ("list", &["measure", "report", "gauss_seidel", "settings", "island"]),
    (
        "solve",
        &[
            "measure",
            "one_contact",
            "infeasible",
            "report",
            "gauss_seidel",
            "method",
            "settings",
            "island",
            "list",
        ],
    ),
    ("equal_compliance", &["measure", "report", "settings", "solve"]),
    ("solution", &["measure", "infeasible", "island", "report", "settings", "solve"]),
];

/// The rooms of the event-driven integrator; each may use those before it.
const EVENT: [&str; 10] = [
    "resolution",
    "state",
    "outcome",
    "options",
    "dynamics",
    "motion",
    "collocation",
    "event_function",
    "contact_problem",
    "integration",
];

/// Rooms within which no circle of imports is allowed, crate by crate; all files of the binding are one room.
const WITHOUT_CIRCLES: [(&str, &[&str]); 3] = [
    ("asperity-set", &["combine", "numeric", "project", "questions", "shapes"]),
    ("asperity", &["law", "contact", "linear", "solver", "system", "integrator"]),
    ("asperity-py", &[""]),
];

/// What goes back in the picture of the sets: the provided methods of `ConvexSet` are algorithms over the trait, and the
/// members of a sum or a union are the enums that have sums and unions among their arms.
const RECURSION: [(&str, &[&str]); 2] =
    [("convex", &["numeric", "cone", "project"]), ("any", &["combine"])];

/// The sources of a crate.
fn root(of: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("..").join(of).join("src")
}

fn sources(path: &Path) -> Vec<PathBuf> {
    if path.is_file() {
        return vec![path.to_path_buf()];
    }
    let entries = fs::read_dir(path).unwrap();
    entries.flat_map(|entry| sources(&entry.unwrap().path())).collect()
}

/// The path of a module from the root of the crate: `solver/mod.rs` is `solver`.
fn module_of(root: &Path, file: &Path) -> Vec<String> {
    let relative = file.strip_prefix(root).unwrap().with_extension("");
    let mut path: Vec<String> =
        relative.iter().map(|part| part.to_str().unwrap().to_owned()).collect();
    if path.last().is_some_and(|last| last == "mod" || last == "lib") {
        path.pop();
    }
    path
}

/// The code of a file without comments and attributes.
fn code(file: &Path) -> String {
    let text = fs::read_to_string(file).unwrap();
    let lines = text.lines().filter(|line| !line.trim_start().starts_with("#["));
    let code = lines.map(|line| line.split("//").next().unwrap_or(""));
    code.collect::<Vec<_>>().join("\n")
}

/// The paths from the root of the crate that a file names, in use declarations and elsewhere.
fn used(root: &Path, file: &Path) -> Vec<Vec<String>> {
    let (code, own) = (code(file), module_of(root, file));
    let mut found = Vec::new();
    let starts = code.match_indices("crate::").chain(code.match_indices("super::"));
    for (at, _) in starts {
        // The middle of a path has been seen from its beginning.
        if code[..at].ends_with("::") || code[..at].ends_with(char::is_alphanumeric) {
            continue;
        }
        let path: String = code[at..]
            .chars()
            .take_while(|c| c.is_alphanumeric() || matches!(c, ':' | '_'))
            .collect();
        let names: Vec<&str> = path.trim_end_matches(':').split("::").collect();
        let mut place = if names[0] == "crate" { Vec::new() } else { own.clone() };
        for name in names {
            match name {
                "crate" => {}
                "super" => {
                    place.pop();
                }
                name => place.push(name.to_owned()),
            }
        }
        let rest = &code[at + path.len()..];
        // What a test within a file takes from it, and what a file tells its tests.
        if rest.starts_with('*') || path.contains("::tests") {
            continue;
        }
        // Of a group every member counts that is a module.
        match path.ends_with("::").then(|| rest.strip_prefix('{')).flatten() {
            Some(group) => {
                let names = group.split('}').next().unwrap_or("").split(',');
                for name in names {
                    let name = name.trim().split("::").next().unwrap_or("");
                    // After the last comma.
                    if name.is_empty() {
                        continue;
                    }
                    found.push([place.clone(), vec![name.to_owned()]].concat());
                }
            }
            None => found.push(place),
        }
    }
    found
}

/// What stands to the left of every name in a picture like `a ← { b ← c, d } ← e`: what it may use.
fn picture(text: &str) -> BTreeMap<String, Vec<String>> {
    let (mut found, mut left) = (BTreeMap::new(), vec![Vec::<String>::new()]);
    // At the beginning of every group: what stands to the left of it.
    let mut outside: Vec<Vec<String>> = Vec::new();
    let spaced = text.replace('{', " { ").replace('}', " } ").replace(',', " , ");
    for word in spaced.split_whitespace() {
        match word {
            "←" => {}
            "{" => {
                let here = left.last().unwrap().clone();
                outside.push(here.clone());
                left.push(here);
            }
            "," => *left.last_mut().unwrap() = outside.last().unwrap().clone(),
            "}" => {
                left.pop();
                let before = outside.pop().unwrap();
                // All that the group has is to the left of what follows.
                let names = found.iter().filter(|(_, uses): &(&String, &Vec<String>)| {
                    before.iter().all(|name| uses.contains(name))
                });
                let names: Vec<String> = names.map(|(name, _)| name.clone()).collect();
                left.last_mut().unwrap().extend(names);
            }
            name => {
                let here = left.last_mut().unwrap();
                found.insert(name.to_owned(), here.clone());
                here.push(name.to_owned());
            }
        }
    }
    found
}

/// The picture in `ARCHITECTURE.md` that begins with these words, up to the end of the line or of the code.
fn drawn(beginning: &str) -> String {
    let page = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../ARCHITECTURE.md");
    let page = fs::read_to_string(page).unwrap();
    let (_, rest) = page.split_once(beginning).unwrap_or_else(|| panic!("no picture: {beginning}"));
    // Within a sentence a picture may go on in the next line.
    let end = if beginning.starts_with('`') { '`' } else { '\n' };
    let rest = rest.split([end, '`']).next().unwrap_or("");
    // What the words name belongs to the picture.
    let first = beginning.rsplit([':', '`']).next().unwrap_or("");
    format!("{first} {rest}")
}

#[test]
fn pictures_are_read() {
    let found = picture("a ← { b ← c, d } ← e");
    let uses = |name: &str| found[name].join(" ");
    assert_eq!(["a", "b", "c", "d", "e"].map(uses), ["", "a", "a b", "a", "a b c d"]);
}

/// Checks what stands at the door of a crate against a picture, with what `besides` allows.
fn check_picture(of: &str, beginning: &str, besides: &[(&str, &[&str])]) {
    let (root, allowed) = (root(of), picture(&drawn(beginning)));
    let exports = re_exports(&root.join("lib.rs"));
    for entry in fs::read_dir(&root).unwrap() {
        let place = entry.unwrap().path();
        let module = place.file_stem().unwrap().to_str().unwrap().to_owned();
        if module == "lib" {
            continue;
        }
        let Some(allowed) = allowed.get(&module) else { panic!("{module} is not in the picture") };
        let besides = besides.iter().find(|(name, _)| *name == module).map_or(&[][..], |b| b.1);
        for file in sources(&place).iter().filter(|file| !is_test(file)) {
            for path in used(&root, file) {
                let Some(name) = path.first() else { continue };
                let name = exports.get(name).unwrap_or(name);
                // The names of types that the door of the crate defines itself.
                let at_the_door = name.starts_with(char::is_uppercase);
                let known = *name == module || allowed.contains(name) || at_the_door;
                let known = known || besides.contains(&name.as_str());
                assert!(known, "{} uses crate::{name}", file.display());
            }
        }
    }
}

#[test]
fn modules_depend_as_the_picture_says() {
    check_picture("asperity", "    argument ←", &[]);
}

#[test]
fn rooms_of_sets_and_of_the_binding_depend_as_the_pictures_say() {
    check_picture("asperity-set", "`error ←", &RECURSION);
    check_picture("asperity-py", "`errors ←", &[]);
}

#[test]
fn pictures_of_rooms_agree_with_what_is_checked() {
    let event = picture(drawn("integrator::event: dynamics ←").trim());
    let place = |name: &str| EVENT.iter().position(|room| *room == name);
    for (room, before) in &event {
        assert!(place(room).is_some(), "{room} is drawn, but there is no such room");
        assert!(before.iter().all(|other| place(other) < place(room)), "{room}");
    }
    for drawing in ["`measure ←", "`newton_matrix ←"] {
        for (room, before) in picture(&drawn(drawing)) {
            let allowed = |of: &str| SOLVER.iter().find(|(name, _)| *name == of).unwrap().1;
            for other in &before {
                assert!(!allowed(other).contains(&room.as_str()), "{other} may use {room}");
            }
            let Some(last) = before.last() else { continue };
            assert!(allowed(&room).contains(&last.as_str()), "{room} may not use {last}");
        }
    }
}

#[test]
fn rooms_of_the_solvers_depend_in_one_direction() {
    let root = root("asperity");
    // Tests ask the front, too.
    for file in sources(&root.join("solver")).into_iter().filter(|file| !is_test(file)) {
        let own = module_of(&root, &file);
        // The front uses everything.
        let Some(room) = own.get(1) else { continue };
        let Some((_, allowed)) = SOLVER.iter().find(|(name, _)| name == room) else {
            panic!("{} has no place in the order", file.display());
        };
        for path in used(&root, &file).iter().filter(|path| path[0] == "solver") {
            let name = path.get(1).map_or("", String::as_str);
            let known = name == room || allowed.contains(&name);
            assert!(known, "{} uses {}", file.display(), path.join("::"));
        }
    }
}

#[test]
fn rooms_of_the_event_driven_integrator_depend_in_one_direction() {
    let root = root("asperity");
    for (number, room) in EVENT.iter().enumerate() {
        let inside = root.join("integrator/event").join(room);
        let place = if inside.is_dir() { inside } else { inside.with_extension("rs") };
        for file in sources(&place) {
            for path in
                used(&root, &file).iter().filter(|path| path[..].len() > 2 && path[1] == "event")
            {
                let known = EVENT[..=number].contains(&path[2].as_str());
                assert!(known, "{} uses {}", file.display(), path.join("::"));
            }
        }
    }
}

#[test]
fn no_files_of_a_room_use_each_other_in_a_circle() {
    for (of, rooms) in WITHOUT_CIRCLES {
        rooms.iter().for_each(|room| check_circles(&root(of), room));
    }
}

fn check_circles(root: &Path, room: &str) {
    let door = root.join("lib.rs");
    let files = sources(&root.join(room));
    let kept = |file: &PathBuf| !is_test(file) && *file != door;
    // The door knows where the names of the crate are defined.
    let files: Vec<PathBuf> = files.into_iter().filter(kept).chain([door.clone()]).collect();
    let modules: Vec<Vec<String>> = files.iter().map(|file| module_of(root, file)).collect();
    let exports: Vec<_> = files.iter().map(|file| re_exports(file)).collect();
    // The file that defines what a path names.
    let definition = |mut path: Vec<String>| loop {
        let within = |&j: &usize| path.starts_with(&modules[j]);
        let file = (0..modules.len()).filter(within).max_by_key(|&j| modules[j].len())?;
        let depth = modules[file].len();
        let Some(child) = path.get(depth).and_then(|name| exports[file].get(name)) else {
            return Some(file);
        };
        path.insert(depth, child.clone());
    };
    let uses: Vec<Vec<usize>> = files
        .iter()
        .enumerate()
        .map(|(i, file)| {
            let paths = used(root, file).into_iter().chain(used_children(root, file));
            paths.filter_map(definition).filter(|&j| j != i && j + 1 < files.len()).collect()
        })
        .collect();
    for start in 0..files.len() - 1 {
        let (mut reached, mut stack) = (vec![false; files.len()], vec![start]);
        while let Some(i) = stack.pop() {
            for &j in &uses[i] {
                let (from, to) = (files[i].display(), files[j].display());
                assert!(j != start, "{to} is part of a circle, closed by {from}");
                if !std::mem::replace(&mut reached[j], true) {
                    stack.push(j);
                }
            }
        }
    }
}

/// The names that a file hands on from its children, with the children.
fn re_exports(file: &Path) -> BTreeMap<String, String> {
    let (code, mut found) = (code(file), BTreeMap::new());
    for statement in code.split(';').map(str::trim).filter(|s| s.starts_with("pub")) {
        let Some((_, path)) = statement.split_once(" use ") else { continue };
        let Some((child, names)) = path.split_once("::") else { continue };
        for name in names.trim_matches(['{', '}']).split(',') {
            let name = name.rsplit([' ', ':']).next().unwrap_or("").trim();
            // After the last comma.
            if name.is_empty() {
                continue;
            }
            // Of features that exclude each other the first one counts.
            found.entry(name.to_owned()).or_insert_with(|| child.to_owned());
        }
    }
    found
}

/// The children that the code of a file uses itself.
fn used_children(root: &Path, file: &Path) -> Vec<Vec<String>> {
    let (code, own) = (code(file), module_of(root, file));
    let statements = code.split(';').map(str::trim);
    let children = statements.clone().filter_map(|s| Some(s.split_once("mod ")?.1));
    let children: Vec<&str> =
        children.filter(|name| name.chars().all(|c| c.is_alphanumeric() || c == '_')).collect();
    let hands_on = |s: &&str| s.starts_with("pub") && s.contains(" use ");
    let own_code: Vec<&str> = statements.filter(|s| !hands_on(s)).collect();
    let words = own_code.join(";");
    let is_used = |child: &&&str| {
        let path = format!("{child}::");
        words.match_indices(&path).any(|(at, _)| {
            !words[..at].ends_with([':', '_']) && !words[..at].ends_with(char::is_alphanumeric)
        })
    };
    let used = children.iter().filter(is_used);
    used.map(|child| [own.clone(), vec![(*child).to_owned()]].concat()).collect()
}

fn is_test(file: &Path) -> bool {
    file.file_stem().is_some_and(|name| name == "tests")
}

#[test]
fn no_source_file_holds_its_tests() {
    for file in sources(&root("asperity")) {
        let inline = code(&file).lines().any(|line| line.trim_start().starts_with("mod tests {"));
        assert!(!inline, "the tests of {} belong in a file beside it", file.display());
    }
}
