//! Rules of the sources: floors, who opens files, prints, starts threads, sums over rows; lengths of files.
use std::collections::BTreeMap;

use crate::{assert_none, code, files, module_of, read, sources, sources_of, uncommented};

/// Modules by floor: each may use strictly lower floors only.
const FLOORS: [(&str, u8); 22] = [
    ("math", 0),
    ("case", 0),
    ("system", 1),
    ("geometry", 1),
    ("motion", 1),
    ("structure", 1),
    ("physics", 1),
    ("exact", 1),
    ("cloud", 2),
    ("time", 2),
    ("scheme", 3),
    ("solid", 3),
    ("coupling", 4),
    ("observe", 4),
    ("problem", 5),
    ("record", 5),
    ("report", 6),
    ("claims", 6),
    ("study", 7),
    ("run", 8),
    ("verification", 9),
    ("lib", 10),
];

/// Modules that may use less than their floor allows.
const NARROW: [(&str, &[&str]); 10] = [
    ("system", &["math"]),
    ("motion", &["math", "case"]),
    ("structure", &["math", "case"]),
    ("physics", &["math"]),
    ("exact", &["math"]),
    ("time", &["math", "system"]),
    ("observe", &["math", "case"]),
    ("record", &["math", "case", "observe"]),
    ("report", &["math", "case", "observe", "record"]),
    ("claims", &["math", "case", "exact"]),
];

/// Modules whose files use one another one way only.
const ONE_WAY: [&str; 7] = ["case", "cloud", "scheme", "solid", "problem", "study", "run"];

/// Who may open files.
const OPENS_FILES: [&str; 5] = [
    "crates/case/src/",
    "crates/report/src/",
    "crates/geometry/src/geometry/mod.rs",
    "src/run/folder.rs",
    "src/verification/",
];
/// Who may change a case: the room that reads and writes it, problems that change their own, and verification, which reruns cases with other
/// spacings as a user would.
const CHANGES_CASES: [&str; 3] = ["crates/case/src/", "src/problem/in_dimension.rs", "src/verification/"];
/// Who may contain `unsafe`: nobody so far.
const UNSAFE: [&str; 0] = [];
/// Who may start threads.
const PARALLEL: [&str; 1] = ["crates/base/src/math/parallel.rs"];
/// Longest file, tests left out.
const LONGEST_FILE: usize = 600;

fn floor(module: &str) -> u8 {
    let known = FLOORS.iter().find(|(m, _)| *m == module);
    known.unwrap_or_else(|| panic!("`{module}` has no floor: add it to tests/tidy and to ARCHITECTURE.md")).1
}

/// Modules named after `crate::`, also in braces.
fn uses(text: &str) -> Vec<String> {
    let word = |s: &str| s.trim().chars().take_while(|c| c.is_ascii_lowercase() || *c == '_').collect::<String>();
    let mut found = Vec::new();
    for part in text.split("crate::").skip(1) {
        match part.strip_prefix('{') {
            Some(list) => found.extend(top_level(list).iter().map(|s| word(s))),
            None => found.push(word(part)),
        }
    }
    found.retain(|m| !m.is_empty());
    found
}

/// Parts of `a, b::{c, d}, e}` at the outer level.
fn top_level(list: &str) -> Vec<String> {
    let mut parts = vec![String::new()];
    let mut depth = 0;
    for c in list.chars() {
        match c {
            '{' => depth += 1,
            '}' if depth == 0 => break,
            '}' => depth -= 1,
            ',' if depth == 0 => {
                parts.push(String::new());
                continue;
            }
            _ => {}
        }
        parts.last_mut().unwrap().push(c);
    }
    parts
}

/// Unit tests too: what needs a higher floor is a test of that floor, or of the whole library in `tests/`.
#[test]
fn modules_use_lower_floors_only() {
    let mut problems = Vec::new();
    for path in sources() {
        let own = module_of(&path);
        for used in uses(&uncommented(&read(&path))).into_iter().filter(|u| u != own) {
            let narrow = NARROW.iter().find(|(m, _)| *m == own);
            let allowed = narrow.is_none_or(|(_, list)| list.contains(&used.as_str()));
            if floor(&used) >= floor(own) || !allowed {
                problems.push(format!("{path} uses `{used}`"));
            }
        }
    }
    assert_none(&problems, "a module may use strictly lower floors only (ARCHITECTURE.md)");
    assert_eq!(uses("use crate::{a::B, c::{d, e}, f}; crate::g::h()"), ["a", "c", "f", "g"]);
}

/// Files of `module` that each of its files names after `super::`.
fn uses_within(module: &str) -> BTreeMap<String, Vec<String>> {
    let folder = format!("src/{module}/");
    let name = |path: &str| path.split_once(&folder).map_or(path, |(_, p)| p).trim_end_matches(".rs").to_owned();
    let all: Vec<String> = sources_of(module).iter().map(|p| name(p)).collect();
    let of = |path: &String| {
        let text = code(path);
        let named = text.split("super::").skip(1).map(|t| t.split(|c: char| c != '_' && !c.is_alphanumeric()).next());
        let others = named.flatten().filter(|m| all.iter().any(|n| n == m) && *m != name(path));
        (name(path), others.map(str::to_owned).collect())
    };
    sources_of(module).iter().map(of).collect()
}

#[test]
fn files_of_a_module_form_no_circle() {
    for module in ONE_WAY {
        let mut left = uses_within(module);
        // take away what uses nothing that is left, until nothing is
        loop {
            let free: Vec<String> =
                left.keys().filter(|k| !left[*k].iter().any(|u| left.contains_key(u))).cloned().collect();
            if free.is_empty() {
                break;
            }
            free.iter().for_each(|k| drop(left.remove(k)));
        }
        assert!(
            left.is_empty(),
            "files of `{module}` that use one another in a circle, or what does: {:?}",
            left.keys()
        );
    }
}

#[test]
fn files_are_opened_where_it_is_allowed() {
    let words = ["std::fs", "File::", "OpenOptions", "TcpStream", "std::net"];
    let mut problems = offenders(sources(), &words, &OPENS_FILES);
    problems.retain(|p| !p.contains("ClaimFile::"));
    assert_none(
        &problems,
        "only case, observe, report, geometry::load_surface, run::folder and verification open files",
    );
}

/// Another stream, cloud, method or motion is another problem, which a problem gives: nothing else makes a case from a case.
#[test]
fn cases_are_changed_by_problems_alone() {
    let words = ["mut case = case.clone()", "Case { ", "..case.clone()", "Case::clone("];
    let problems = offenders(sources(), &words, &CHANGES_CASES);
    assert_none(&problems, "a case is not rewritten into another one: ask its problem for another problem");
}

#[test]
fn only_the_command_prints() {
    let words = ["println!", "print!(", "eprintln!", "eprint!(", "stdout()", "stderr()"];
    assert_none(&offenders(sources(), &words, &[]), "the library does not print");
}

#[test]
fn nothing_is_unsafe_and_only_sweeps_are_parallel() {
    assert_none(&offenders(sources(), &["unsafe "], &UNSAFE), "`unsafe` needs an audit");
    let words = ["rayon::", "thread::spawn"];
    assert_none(&offenders(sources(), &words, &PARALLEL), "every parallel loop is in math::parallel");
}

/// What makes one number of many, and what holds a number of every row: particles, interface particles, unknowns.
const FOLDS: [&str; 6] = [".fold(", ".sum()", ".sum::<", ".reduce(", ".max_by(", ".min_by("];
const ROWS: [&str; 24] = [
    "u.iter()",
    "du.iter()",
    "rate.iter()",
    "residual.iter()",
    "state.iter()",
    "interface.iter()",
    "walls.iter()",
    "wall.iter()",
    "spacing.iter()",
    "volume.iter()",
    "mass.iter()",
    "mass().iter()",
    "force.iter()",
    "load.iter()",
    "particles.iter()",
    "velocity.iter()",
    "displacement.iter()",
    "interface_range()",
    "particles.clone()",
    "0..n_fluid",
    "n_fluid)",
    "n_rows())",
    "self.len())",
    "interface.len())",
];

/// Rooms whose numbers go on: what they make of all rows decides on the next step.
#[test]
fn sums_over_rows_are_in_one_place() {
    let mut problems = Vec::new();
    let rooms = ["time", "scheme", "solid", "coupling"].iter().flat_map(|m| sources_of(m));
    for path in rooms.filter(|p| !p.contains("/tests")) {
        let text: String = code(&path).split_whitespace().collect();
        let all = text.split([';', '{', '}']).filter(|s| FOLDS.iter().any(|w| s.contains(w)));
        let over_rows = all.filter(|s| {
            let before = s.split(FOLDS.iter().find(|w| s.contains(*w)).unwrap()).next().unwrap();
            ROWS.iter().any(|w| before.contains(w))
        });
        problems.extend(over_rows.map(|s| format!("{path}: {s}")));
    }
    assert_none(&problems, "sums, norms and largest values over rows are those of math::reduce");
}

#[test]
fn integrators_know_no_physics_and_physics_no_particles() {
    let words = ["density", "Primitive", "Conserved", "pressure"];
    let mut problems = offenders(sources_of("time"), &words, &[]);
    problems.extend(offenders(sources_of("physics"), &["usize]", "particle", "neighbour"], &[]));
    problems.retain(|p| !p.contains("hint"));
    assert_none(&problems, "time names no physics, physics no particles");
}

/// Lines of code outside the places allowed that hold one of the words.
fn offenders(sources: Vec<String>, words: &[&str], allowed: &[&str]) -> Vec<String> {
    let mut found = Vec::new();
    for path in sources.into_iter().filter(|p| !allowed.iter().any(|a| p.starts_with(a))) {
        for line in code(&path).lines().filter(|l| words.iter().any(|w| l.contains(w))) {
            found.push(format!("{path}: {}", line.trim()));
        }
    }
    found
}

#[test]
fn files_are_short() {
    let mut long = Vec::new();
    for path in sources().into_iter().chain(files("cli/src", ".rs")) {
        let n = code(&path).lines().count();
        if n > LONGEST_FILE {
            long.push(format!("{path}: {n} lines"));
        }
    }
    assert_none(&long, "a file has at most 600 lines without its tests");
}

#[test]
fn every_file_says_what_it_is() {
    let all = sources().into_iter().chain(files("cli/src", ".rs")).chain(files("tests", ".rs"));
    let all = all.chain(files("examples", ".rs"));
    let silent: Vec<String> = all.filter(|p| !read(p).starts_with("//!")).collect();
    assert_none(&silent, "a file starts with its page, `//! ...`");
}

#[test]
fn architecture_names_every_module_on_its_floor() {
    let text = read("ARCHITECTURE.md");
    for (module, floor) in FLOORS.iter().filter(|(m, _)| *m != "lib") {
        let line = text.lines().find(|l| l.starts_with(&format!("{floor}  ")));
        let line = line.unwrap_or_else(|| panic!("ARCHITECTURE.md has no floor {floor}"));
        assert!(line.split(|c: char| !c.is_alphanumeric()).any(|w| w == *module), "floor {floor} lacks `{module}`");
    }
}
