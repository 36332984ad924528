//! The rules of the house: floors, files, printing, lengths, equations, words.
//!
//! The sources are read as text; a cheap parser is enough because `rustfmt` fixes their layout. Generated pages of the book
//! are compared with what is committed: `ALULA_WRITE=1 cargo test -p alula --test tidy` brings them up to date.
#![allow(clippy::unwrap_used, reason = "it may stop anywhere")]
use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::path::{Path, PathBuf};
use std::process::Command;

/// Modules by floor: each may use strictly lower floors only.
const FLOORS: [(&str, u8); 21] = [
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
    ("verify", 6),
    ("study", 7),
    ("run", 8),
    ("lib", 9),
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
    ("verify", &["math", "case", "exact"]),
];

/// Modules whose files use one another one way only.
const ONE_WAY: [&str; 7] = ["case", "cloud", "scheme", "solid", "problem", "study", "run"];

/// Who may open files.
const OPENS_FILES: [&str; 7] = [
    "crates/case/src/",
    "crates/report/src/",
    "crates/geometry/src/geometry/mod.rs",
    "src/run/folder.rs",
    "src/run/measure/",
    "src/run/verify.rs",
    "src/run/verify/",
];
/// Who may contain `unsafe`: nobody so far.
const UNSAFE: [&str; 0] = [];
/// Who may start threads.
const PARALLEL: [&str; 1] = ["crates/base/src/math/parallel.rs"];
/// Longest file, tests left out.
const LONGEST_FILE: usize = 600;
/// Longest line of a hand-written Markdown table or of a message is free; of code `rustfmt` decides.
const EQUATIONS: [&str; 32] = [
    "conservation of mass",
    "conservation of momentum",
    "conservation of energy",
    "strain rate",
    "stress of a Newtonian fluid",
    "p = (γ − 1) ρ e",
    "split of the Cauchy stress",
    "hypoelastic pressure",
    "deviatoric stress",
    "normal equations of the linear fit, values given (Dirichlet)",
    "linear fit f = a₀ + a₁x + a₂y + a₃z",
    "∂f/∂n = 0 on the interface (Neumann)",
    "the Neumann condition as a row: a·n = 0",
    "overdetermined system of values and Neumann rows",
    "normal equations with Neumann rows",
    "∂Q/∂t + R = 0",
    "Q = (ρ, u, e)",
    "R as internal and external parts",
    "Fourier series of Q",
    "Fourier series of R",
    "series put into the equations",
    "harmonics sorted",
    "ωA Q̂ + R̂ = 0",
    "vectors of Fourier coefficients",
    "matrix A",
    "vectors of time instances",
    "Q̃ = E⁻¹ Q̂",
    "Q̂ = E Q̃",
    "ωD Q̃ + R̃ = 0, D = E⁻¹ A E",
    "matrix E⁻¹",
    "matrix E",
    "∂Q̃/∂τ + ωD Q̃ + R̃ = 0",
];

fn root() -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR"))
}

fn read(path: &str) -> String {
    std::fs::read_to_string(root().join(path)).unwrap_or_else(|e| panic!("{path}: {e}"))
}

/// All files under `folder` whose name ends in `suffix`, sorted, relative to the root.
fn files(folder: &str, suffix: &str) -> Vec<String> {
    let mut found = Vec::new();
    let mut stack = vec![root().join(folder)];
    while let Some(place) = stack.pop() {
        for entry in std::fs::read_dir(&place).unwrap().map(|e| e.unwrap().path()) {
            if entry.is_dir() {
                stack.push(entry);
            } else if entry.to_string_lossy().ends_with(suffix) {
                found.push(entry.strip_prefix(root()).unwrap().to_string_lossy().replace('\\', "/"));
            }
        }
    }
    found.sort();
    found
}

/// Sources of the library: of the crate that users see, and of those that its floors are made of.
fn sources() -> Vec<String> {
    let floors = files("crates", ".rs");
    files("src", ".rs").into_iter().chain(floors.into_iter().filter(|p| p.contains("/src/"))).collect()
}

/// The sources of one module.
fn sources_of(module: &str) -> Vec<String> {
    sources().into_iter().filter(|p| module_of(p) == module).collect()
}

/// Source without its tests and without comments.
fn code(path: &str) -> String {
    let text = read(path);
    if path.ends_with("/tests.rs") {
        return String::new();
    }
    uncommented(text.split("\n#[cfg(test)]\nmod tests {").next().unwrap_or_default())
}

fn uncommented(text: &str) -> String {
    let lines = text.lines().map(|l| l.split("//").next().unwrap_or_default());
    lines.collect::<Vec<_>>().join("\n")
}

fn module_of(path: &str) -> &str {
    let inner = path.split_once("src/").map_or(path, |(_, inner)| inner);
    inner.split('/').next().unwrap_or_default().trim_end_matches(".rs")
}

fn floor(module: &str) -> u8 {
    let known = FLOORS.iter().find(|(m, _)| *m == module);
    known.unwrap_or_else(|| panic!("`{module}` has no floor: add it to tests/tidy.rs and to ARCHITECTURE.md")).1
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

fn assert_none(problems: &[String], rule: &str) {
    assert!(problems.is_empty(), "{rule}:\n  {}", problems.join("\n  "));
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
fn the_project_has_its_papers() {
    let papers = [
        "README.md",
        "ARCHITECTURE.md",
        "CHANGELOG.md",
        "LICENSE-MIT",
        "LICENSE-APACHE",
        "justfile",
        "deny.toml",
        "clippy.toml",
        "rustfmt.toml",
        "book/SUMMARY.md",
        ".ci/run",
    ];
    let missing: Vec<String> = papers.iter().filter(|p| !root().join(p).is_file()).map(|p| (*p).to_string()).collect();
    assert_none(&missing, "missing papers");
    let version = read("Cargo.toml").lines().find_map(|l| l.strip_prefix("version = \"")).map(str::to_string).unwrap();
    assert!(read("CHANGELOG.md").contains(version.trim_end_matches('"')), "CHANGELOG.md does not name {version}");
}

/// Pages people read: README and its like, book, folders of cases.
fn papers() -> Vec<String> {
    let mut all =
        vec!["README.md".to_string(), "ARCHITECTURE.md".into(), "CHANGELOG.md".into(), "python/README.md".into()];
    all.extend(["book", "verification", "cases"].iter().flat_map(|f| files(f, ".md")));
    all
}

/// Markdown without what stands in fences and, where `spans` are to go too, in `code`.
fn prose(text: &str, spans: bool) -> String {
    let outside = text.split("\n```").step_by(2).collect::<Vec<_>>().join("\n");
    if spans { outside.split('`').step_by(2).collect::<Vec<_>>().join(" ") } else { outside }
}

/// What a heading is called in a link: letters and digits in lower case, `-` for each space.
fn anchor(heading: &str) -> String {
    let kept = heading.trim_start_matches('#').trim().chars().filter(|c| c.is_alphanumeric() || " -_".contains(*c));
    kept.map(|c| if c == ' ' { '-' } else { c.to_ascii_lowercase() }).collect()
}

#[test]
fn links_lead_somewhere() {
    let mut lost = Vec::new();
    for page in papers() {
        let text = read(&page);
        let folder = Path::new(&page).parent().unwrap();
        let links = prose(&text, true);
        let links = links.split("](").skip(1).filter_map(|l| l.split(')').next()).filter(|l| !l.contains("://"));
        for link in links {
            let (file, place) = link.split_once('#').unwrap_or((link, ""));
            let target = if file.is_empty() { page.clone() } else { folder.join(file).to_string_lossy().into_owned() };
            let there = root().join(&target).exists();
            let named = || prose(&read(&target), false).lines().any(|l| l.starts_with('#') && anchor(l) == place);
            let found = there && (place.is_empty() || named());
            if !found {
                lost.push(format!("{page}: {link}"));
            }
        }
        for include in text.split("{{#include ").skip(1).filter_map(|i| i.split([':', '}']).next()) {
            if !root().join(folder.join(include)).is_file() {
                lost.push(format!("{page}: {{{{#include {include}}}}}"));
            }
        }
    }
    assert_none(&lost, "links and includes that lead nowhere");
    assert_eq!(anchor("## What `summary.json` holds"), "what-summaryjson-holds");
}

/// mdBook makes pages of those that its summary names only, and takes links to others as they are.
#[test]
fn the_book_is_whole() {
    let named = read("book/SUMMARY.md");
    let mut problems = Vec::new();
    for page in files("book", ".md").iter().filter(|p| *p != "book/SUMMARY.md") {
        let inner = page.trim_start_matches("book/");
        if !named.contains(&format!("]({inner})")) {
            problems.push(format!("{page} is not in book/SUMMARY.md"));
        }
        let text = read(page);
        if ["\\\\(", "\\(", "\\[", "$$"].iter().any(|w| prose(&text, true).contains(w)) {
            problems.push(format!("{page} has a formula that is no code: Markdown would eat its backslashes"));
        }
        if text.lines().any(|l| l.contains("src=\"http") || l.contains("](http") && l.contains("![")) {
            problems.push(format!("{page} asks for a picture from a network"));
        }
    }
    assert_none(
        &problems,
        "the book has all its pages, formulas as code and no picture from elsewhere (book/formulas.py)",
    );
}

/// Each of the twelve rows names a file that has what it says: a function, type or trait of that name.
#[test]
fn questions_lead_to_their_files() {
    let text = read("ARCHITECTURE.md");
    let table = text.split("## Where to look").nth(1).unwrap_or_default().split("\n## ").next().unwrap_or_default();
    let rows: Vec<Vec<&str>> =
        table.lines().filter(|l| l.contains('?')).map(|l| l.split('`').skip(1).step_by(2).collect()).collect();
    assert_eq!(rows.len(), 12, "twelve questions");
    let mut lost = Vec::new();
    for row in &rows {
        let [file, name] = row[..] else { panic!("a row without file and name: {row:?}") };
        let there = root().join(file).is_file();
        let kinds = ["fn", "struct", "trait", "enum"].map(|kind| format!("{kind} {name}"));
        let ends = |rest: &str| !rest.starts_with(|c: char| c == '_' || c.is_alphanumeric());
        let has = |kind: &String| code(file).split(kind.as_str()).skip(1).any(ends);
        if !there || !kinds.iter().any(has) {
            lost.push(format!("{file} has no `{name}`"));
        }
    }
    assert_none(&lost, "ARCHITECTURE.md sends readers where nothing is");
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

#[test]
fn no_machine_paths_or_registries() {
    // spelt in pieces, so that this file passes its own test
    let folders = ["/wo#rk/", "/ro#ot/", "/ho#me/", "/tm#p/", "/Use#rs/"].map(|w| w.replace('#', ""));
    let hosts = ["crates#.io", "pypi#.org", "files.python#hosted"].map(|w| w.replace('#', ""));
    let mut found = Vec::new();
    for path in tracked().into_iter().filter(|p| !p.ends_with("Cargo.lock")) {
        let Ok(text) = std::fs::read_to_string(root().join(&path)) else { continue };
        for (k, line) in text.lines().enumerate() {
            if folders.iter().chain(&hosts).any(|w| line.contains(w.as_str())) {
                found.push(format!("{path}:{}: {}", k + 1, line.trim()));
            }
        }
    }
    assert_none(&found, "machine paths and registry hosts do not belong in the project");
}

/// Tracked files; all files of the main folders where there is no git.
fn tracked() -> Vec<String> {
    let listed = Command::new("git").args(["ls-files", "-z"]).current_dir(root()).output();
    if let Ok(out) = listed
        && out.status.success()
        && !out.stdout.is_empty()
    {
        return String::from_utf8_lossy(&out.stdout)
            .split('\0')
            .filter(|p| !p.is_empty())
            .map(str::to_string)
            .collect();
    }
    ["src", "crates", "cli", "tests", "examples", "benches", "book", "cases", "verification"]
        .iter()
        .flat_map(|f| files(f, ""))
        .collect()
}

/// Where an equation stands: file and the name of what carries it.
fn coded() -> BTreeMap<usize, Vec<(String, String)>> {
    let mut found: BTreeMap<usize, Vec<(String, String)>> = BTreeMap::new();
    for path in sources() {
        let text = read(&path);
        let lines: Vec<&str> = text.lines().map(str::trim).collect();
        for (k, line) in lines.iter().enumerate() {
            let Some(number) = line.strip_prefix("#[doc(alias = \"eq").and_then(|l| l.strip_suffix("\")]")) else {
                continue;
            };
            let item = lines[k..].iter().find(|l| !l.starts_with('#') && !l.starts_with("//")).unwrap();
            let number = number.parse().unwrap_or_else(|_| panic!("{path}: `{line}`"));
            let block = text.lines().take(k).filter(|l| l.starts_with("impl") || *l == "}").last();
            let owner = block.filter(|l| l.starts_with("impl")).map_or_else(String::new, owner_of);
            found.entry(number).or_default().push((path.clone(), owner + &name_of(item)));
        }
    }
    found
}

/// `Type::` of an `impl` line.
fn owner_of(line: &str) -> String {
    let name = line.split(" for ").last().unwrap_or_default().trim_start_matches("impl");
    let name = if name.starts_with('<') { name.split_once("> ").map_or(name, |(_, n)| n) } else { name };
    name.trim().chars().take_while(|c| c.is_alphanumeric()).collect::<String>() + "::"
}

/// Name of the item that a line declares.
fn name_of(line: &str) -> String {
    let words: Vec<&str> = line.split(|c: char| !c.is_alphanumeric() && c != '_').filter(|w| !w.is_empty()).collect();
    let at = words.iter().position(|w| ["fn", "struct", "trait", "enum", "const", "type"].contains(w));
    words
        .get(at.map_or(0, |k| if words[k] == "const" && words.get(k + 1) == Some(&"fn") { k + 2 } else { k + 1 }))
        .map_or_else(String::new, ToString::to_string)
}

/// Tests by the equations they name in the comment beside `#[test]`: `#[test] // eq10, eq15`.
fn proofs() -> BTreeMap<usize, Vec<String>> {
    let mut found: BTreeMap<usize, Vec<String>> = BTreeMap::new();
    for path in sources().into_iter().chain(files("tests", ".rs")) {
        let text = read(&path);
        let lines: Vec<&str> = text.lines().map(str::trim).collect();
        for (k, line) in lines.iter().enumerate() {
            let Some(comment) = line.strip_prefix("#[test] //") else { continue };
            let Some(item) = lines[k..].iter().find(|l| l.starts_with("fn ")) else { continue };
            for word in comment.split([',', ' ', ':', ';']) {
                if let Some(n) = word.strip_prefix("eq").and_then(|n| n.parse().ok()) {
                    found.entry(n).or_default().push(name_of(item));
                }
            }
        }
    }
    found
}

fn excuses() -> BTreeMap<usize, String> {
    let table: toml::Table = toml::from_str(&read("book/equations-not-coded.toml")).unwrap();
    let number = |key: &str| key.strip_prefix("eq").and_then(|n| n.parse().ok()).unwrap_or_else(|| panic!("`{key}`"));
    table.iter().map(|(key, reason)| (number(key), reason.as_str().unwrap().to_string())).collect()
}

#[test]
fn every_equation_is_coded_once_and_proven_or_excused() {
    let (coded, proofs, excuses) = (coded(), proofs(), excuses());
    let mut problems = Vec::new();
    for n in 1..=EQUATIONS.len() {
        match (coded.get(&n).map_or(0, Vec::len), excuses.get(&n)) {
            (1, None) if proofs.contains_key(&n) => {}
            (1, None) => problems.push(format!("eq{n} has no test: write `#[test] // eq{n}` beside one")),
            (1, Some(_)) => problems.push(format!("eq{n} is coded and excused")),
            (0, Some(reason)) if reason.len() > 10 => {}
            (0, _) => problems.push(format!("eq{n} is neither coded nor excused")),
            (k, _) => problems.push(format!("eq{n} stands {k} times")),
        }
    }
    problems.extend(coded.keys().chain(excuses.keys()).filter(|n| **n > EQUATIONS.len()).map(|n| format!("eq{n}?")));
    assert_none(&problems, "each equation stands exactly once in the sources, with a test, or is excused");
    fresh("book/equations.md", &equations_page(&coded, &proofs, &excuses));
}

fn equations_page(
    coded: &BTreeMap<usize, Vec<(String, String)>>,
    proofs: &BTreeMap<usize, Vec<String>>,
    excuses: &BTreeMap<usize, String>,
) -> String {
    let mut page = String::from(
        "# Equations of the paper\n\n<!-- generated by tests/tidy.rs -->\n\nNumbers are those of Hu, Kamakoti, Xue, Wang, Li, Attar and Vedula, AIAA 2010-7604. A function that realises an equation\ncarries its number: search the documentation for `eq10`.\n\n| eq. | statement | function | test |\n|---|---|---|---|\n",
    );
    for (n, statement) in (1..).zip(EQUATIONS) {
        let row = match coded.get(&n).and_then(|places| places.first()) {
            Some((path, name)) => {
                let tests: Vec<String> = proofs.get(&n).into_iter().flatten().map(|t| format!("`{t}`")).collect();
                format!("`{name}` in `{path}` | {}", tests.join(", "))
            }
            None => format!("not coded: {} | ", excuses.get(&n).map_or("", String::as_str)),
        };
        let _ = writeln!(page, "| {n} | {statement} | {row} |");
    }
    page
}

#[test]
fn the_reference_of_the_case_file_is_fresh() {
    fresh("book/reference/case.md", &alula::case::reference_markdown());
}

#[test]
fn the_reference_of_the_tables_is_fresh() {
    fresh("book/reference/tables.md", &alula::observe::columns::reference_markdown());
}

/// Compares a generated page with the committed one, or writes it when `ALULA_WRITE` is set.
fn fresh(path: &str, page: &str) {
    let place = root().join(path);
    if std::env::var_os("ALULA_WRITE").is_some() {
        std::fs::create_dir_all(place.parent().unwrap_or(Path::new("."))).unwrap();
        std::fs::write(&place, page).unwrap();
    }
    let committed = std::fs::read_to_string(&place).unwrap_or_default();
    assert!(committed == page, "`{path}` is stale; hint: `ALULA_WRITE=1 cargo test -p alula --test tidy`");
}
