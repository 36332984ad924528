//! Every key of the case file has an effect: `keys.txt` has for each a case, and another that differs from it in this key alone. What is
//! computed, written or told must differ as well, or the other case must be refused where its row says so.
//!
//! A key of a table that stands in several places (materials, motions, places of loads and supports, sides of the domain) is looked at in
//! one of them, see [`named_once`]. One case of each kind is run twice, so that what differs by chance is no effect.
use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};

use alula::case::{self, schema};
use alula::run::{self, Monitor, Places, Tick};
use serde_json::Value;

const TABLE: &str = include_str!("keys.txt");

/// Files that repeat the case or tell when it was run and what it took: of them only the names count.
const APART: [&str; 8] = [
    "case.toml",
    "finished.txt",
    "checksums.txt",
    "origin.txt",
    "history.csv",
    "report.html",
    "csv-metadata.json",
    "paraview-state.py",
];

/// The same of the keys of JSON files.
const COST: [&str; 9] = [
    "case",
    "run",
    "cloud",
    "cpu_seconds",
    "wall_seconds",
    "peak_bytes",
    "bytes_per_particle",
    "cpu_ms_per_particle",
    "phases",
];

/// Cases that are run twice: together they write all kinds of files.
const TWICE: [&str; 9] = ["gas", "compared", "wing", "waves", "springs", "beam", "swinging", "forces", "cycles"];

/// A case, and what is changed in it.
struct Base {
    name: &'static str,
    case: toml::Table,
    rows: Vec<Row>,
}

/// Values that are given or taken out, `path = value` or `-path`, the first of the key that the row is about; and what the message says
/// where the changed case is refused.
struct Row {
    settings: Vec<&'static str>,
    refused: Option<&'static str>,
}

impl Row {
    fn read(line: &'static str) -> Self {
        let (settings, refused) = match line.split_once(" | refused: ") {
            Some((settings, message)) => (settings, Some(message)),
            None => (line, None),
        };
        Self { settings: settings.split(" ; ").collect(), refused }
    }

    fn key(&self) -> String {
        let first = self.settings[0];
        named_once(first.split_once(" = ").map_or(first, |(path, _)| path))
    }
}

/// The cases of `keys.txt`.
fn bases() -> Vec<Base> {
    let mut all: Vec<Base> = Vec::new();
    for part in TABLE.split("\n== ").skip(1) {
        let (head, text) = part.split_once('\n').unwrap();
        let (name, parent) = head.split_once(" < ").map_or((head, None), |(name, parent)| (name, Some(parent)));
        let (case, rows) = text.split_once("\n--\n").unwrap_or((text, ""));
        let of_parent = |parent: &str| all.iter().find(|b| b.name == parent).unwrap().case.clone();
        let mut whole = parent.map(of_parent).unwrap_or_default();
        lay_over(&mut whole, case.parse::<toml::Table>().unwrap_or_else(|e| panic!("`{name}`: {e}")));
        let rows = rows.lines().filter(|l| !l.is_empty() && !l.starts_with('#')).map(Row::read).collect();
        all.push(Base { name, case: whole, rows });
    }
    all
}

/// Puts the values of one table into another, table by table.
fn lay_over(case: &mut toml::Table, other: toml::Table) {
    for (key, value) in other {
        let place = case.entry(key).or_insert_with(|| toml::Value::Table(toml::Table::new()));
        match (place, value) {
            (toml::Value::Table(inner), toml::Value::Table(value)) => lay_over(inner, value),
            (place, value) => *place = value,
        }
    }
}

/// The table that holds the last key of a path, and that key. A path goes through the first table of an array.
fn place<'a>(case: &'a mut toml::Table, path: &'a str) -> (&'a mut toml::Table, &'a str) {
    let Some((first, rest)) = path.split_once('.') else { return (case, path) };
    let next = case.entry(first).or_insert_with(|| toml::Value::Table(toml::Table::new()));
    let next = if let toml::Value::Array(all) = next { &mut all[0] } else { next };
    place(next.as_table_mut().unwrap(), rest)
}

fn changed(base: &toml::Table, settings: &[&str]) -> toml::Table {
    let mut case = base.clone();
    for setting in settings {
        if let Some(path) = setting.strip_prefix('-') {
            let (table, key) = place(&mut case, path);
            assert!(table.remove(key).is_some(), "`{setting}` takes out what is not there");
            continue;
        }
        let (path, value) = setting.split_once(" = ").unwrap();
        let value = format!("v = {value}").parse::<toml::Table>().unwrap_or_else(|e| panic!("{setting}: {e}"));
        let (table, key) = place(&mut case, path);
        table.insert(key.to_owned(), value["v"].clone());
    }
    case
}

/// Keeps the warnings of a run, and counts the checkpoints that it finds between iterations.
struct Witness {
    out: PathBuf,
    warnings: String,
    checkpoint: Vec<u8>,
    checkpoints: usize,
}

impl Monitor for Witness {
    fn tick(&mut self, _: &Tick) {
        let now = std::fs::read(self.out.join("checkpoint.alula")).unwrap_or_default();
        if now != self.checkpoint {
            (self.checkpoint, self.checkpoints) = (now, self.checkpoints + 1);
        }
    }

    fn note(&mut self, _: &str) {}

    fn warn(&mut self, text: &str) {
        self.warnings += &text.replace(&self.out.display().to_string(), "out");
        self.warnings.push('\n');
    }
}

/// What a case gives, by name: its files, and what it told.
type Found = BTreeMap<String, Vec<u8>>;

fn results(case: &toml::Table, input: &Path) -> Result<Found, String> {
    let read = case::read(&toml::to_string(case).unwrap(), "case").map_err(|e| e.to_string())?;
    let folder = tempfile::tempdir().unwrap();
    let places = Places { input: input.into(), out: folder.path().join("out") };
    let mut witness =
        Witness { out: places.out.clone(), warnings: String::new(), checkpoint: Vec::new(), checkpoints: 0 };
    let mut found = Found::new();
    if case.contains_key("gaf") {
        let matrices = run::gaf::gaf(&read, &places, &mut witness).map_err(|e| e.to_string())?.unwrap();
        // the program ends with an error where forces are not linear
        let linear = |n: f64| n <= matrices.linearity;
        let judged: Vec<bool> = matrices.columns.iter().map(|c| c.nonlinearity.is_none_or(linear)).collect();
        found.insert("linear".to_owned(), format!("{judged:?}").into_bytes());
    } else if case.contains_key("flutter") {
        run::flutter::flutter(&read, &places, &mut witness).map_err(|e| e.to_string())?;
    } else {
        run::run(&read, &places, &mut witness).map_err(|e| e.to_string())?;
    }
    collect(&places.out, "", &mut found);
    found.insert("warnings".to_owned(), witness.warnings.into_bytes());
    found.insert("checkpoints".to_owned(), witness.checkpoints.to_string().into_bytes());
    Ok(found)
}

fn collect(folder: &Path, within: &str, found: &mut Found) {
    for entry in std::fs::read_dir(folder).unwrap().map(Result::unwrap) {
        let (path, name) = (entry.path(), entry.file_name().to_string_lossy().into_owned());
        let here = format!("{within}{name}");
        if path.is_dir() {
            collect(&path, &format!("{here}/"), found);
        } else if name.ends_with(".alula") {
            // states to go on from: they hold the time that was spent
        } else if APART.contains(&name.as_str()) {
            found.insert(here, Vec::new());
        } else {
            let bytes = std::fs::read(&path).unwrap();
            found.insert(here, if name.ends_with(".json") { without_cost(&bytes) } else { bytes });
        }
    }
}

fn without_cost(json: &[u8]) -> Vec<u8> {
    fn strip(value: &mut Value) {
        match value {
            Value::Object(all) => {
                all.retain(|key, _| !COST.contains(&key.as_str()));
                all.values_mut().for_each(strip);
            }
            Value::Array(all) => all.iter_mut().for_each(strip),
            _ => {}
        }
    }
    let mut value: Value = serde_json::from_slice(json).unwrap();
    strip(&mut value);
    value.to_string().into_bytes()
}

/// What a case that is run again gives otherwise than `before`.
fn by_chance(base: &Base, before: &Found, input: &Path) -> Option<String> {
    let again = results(&base.case, input).unwrap_or_default();
    let differs = |file: &&String| again.get(*file) != before.get(*file);
    let names: BTreeSet<&String> = before.keys().chain(again.keys()).filter(differs).collect();
    (!names.is_empty()).then(|| format!("`{}` run again gives another {names:?}", base.name))
}

/// What is wrong with a case and its rows.
fn faults(base: &Base, input: &Path) -> Vec<String> {
    let name = base.name;
    let before = match results(&base.case, input) {
        Ok(before) => before,
        Err(problem) => return vec![format!("`{name}` is refused: {problem}")],
    };
    let by_chance = TWICE.contains(&name).then(|| by_chance(base, &before, input)).flatten();
    let fault = |row: &Row| {
        let what = format!("`{}` in `{name}`", row.settings.join(" ; "));
        match (results(&changed(&base.case, &row.settings), input), row.refused) {
            (Err(problem), None) => Some(format!("{what} is refused: {problem}")),
            (Err(problem), Some(words)) => {
                (!problem.contains(words)).then(|| format!("{what} is refused with other words: {problem}"))
            }
            (Ok(_), Some(_)) => Some(format!("{what} is not refused")),
            (Ok(found), None) => (found == before).then(|| format!("{what} changes nothing")),
        }
    };
    by_chance.into_iter().chain(base.rows.iter().filter_map(fault)).collect()
}

#[test]
#[ignore = "long, four hundred small runs: `.ci/run` and `cargo test -- --ignored` run it"]
fn every_key_changes_what_is_found_or_is_refused() {
    let (bases, folder) = (bases(), tempfile::tempdir().unwrap());
    write_input(folder.path());
    let asked: Vec<&Base> = bases.iter().filter(|b| !b.rows.is_empty()).collect();
    let (next, all) = (AtomicUsize::new(0), Mutex::new(Vec::new()));
    let work = || {
        while let Some(base) = asked.get(next.fetch_add(1, Ordering::Relaxed)) {
            let found = faults(base, folder.path());
            all.lock().unwrap().extend(found);
        }
    };
    std::thread::scope(|scope| {
        let threads = std::thread::available_parallelism().map_or(1, |n| n.get().min(asked.len()));
        (0..threads).for_each(|_| drop(scope.spawn(work)));
    });
    let all = all.into_inner().unwrap();
    assert!(all.is_empty(), "{}", all.join("\n"));
}

/// Files that the cases name.
fn write_input(folder: &Path) {
    let mode = |shape: &dyn Fn(f64) -> f64| {
        let row = |k: u32, y: f64| format!("{},{y},0,{}\n", 0.1 * f64::from(k), shape(0.1 * f64::from(k)));
        let rows = (0..=10).flat_map(|k| [row(k, -0.06), row(k, 0.06)]);
        "x,y,dx,dy\n".to_owned() + &rows.collect::<String>()
    };
    let section = "own\n1 0\n0.75 0.04\n0.5 0.06\n0.25 0.07\n0.1 0.05\n0.02 0.02\n0 0\n0.02 -0.02\n0.1 -0.03\n\
                   0.25 -0.04\n0.5 -0.03\n0.75 -0.02\n1 0\n";
    let files = [
        ("table.csv", "time,x\n0,0\n0.5,0.03\n1,0\n1.5,-0.03\n2,0\n".to_owned()),
        ("mode.csv", mode(&|x| x * x)),
        ("mode2.csv", mode(&|x| x)),
        ("cp.csv", "x_c,Cp\n0.1,-0.5\n0.5,-0.2\n0.9,0.1\n".to_owned()),
        ("cp2.csv", "x_c,Cp\n0.1,-0.6\n0.5,-0.2\n0.9,0.1\n".to_owned()),
        ("own.dat", section.to_owned()),
        ("box.stl", cracked_box()),
    ];
    files.iter().for_each(|(name, text)| std::fs::write(folder.join(name), text).unwrap());
}

/// A box of 1 × 1 × 0.5 of which one corner is not quite in the same place in all faces.
fn cracked_box() -> String {
    const CRACK: f64 = 2e-5;
    const FACES: [[usize; 3]; 12] = [
        [0, 2, 1],
        [0, 3, 2],
        [4, 5, 6],
        [4, 6, 7],
        [0, 1, 5],
        [0, 5, 4],
        [1, 2, 6],
        [1, 6, 5],
        [2, 3, 7],
        [2, 7, 6],
        [3, 0, 4],
        [3, 4, 7],
    ];
    let corner = |k: usize| [[0.0, 1.0, 1.0, 0.0][k % 4], [0.0, 0.0, 1.0, 1.0][k % 4], [0.0, 0.5][k / 4]];
    let vertex = |face: usize, k: usize| {
        let [x, y, z] = corner(k);
        format!("vertex {} {y} {z}\n", if (face, k) == (0, 2) { x + CRACK } else { x })
    };
    let facet = |(n, face): (usize, &[usize; 3])| {
        let vertices: String = face.iter().map(|k| vertex(n, *k)).collect();
        format!("facet normal 0 0 0\nouter loop\n{vertices}endloop\nendfacet\n")
    };
    format!("solid box\n{}endsolid box\n", FACES.iter().enumerate().map(facet).collect::<String>())
}

#[test]
fn no_key_is_left_out() {
    let mut keys = Keys::default();
    keys.walk(&schema(), "");
    let bases = bases();
    assert!(TWICE.iter().all(|name| bases.iter().any(|b| b.name == *name && !b.rows.is_empty())));
    let known: BTreeSet<String> = bases.iter().flat_map(|b| &b.rows).map(Row::key).collect();
    let missing: Vec<&String> = keys.values.difference(&known).collect();
    assert!(missing.is_empty(), "`keys.txt` has no row for {missing:?}");
    let stale: Vec<&String> = known.difference(&keys.all).collect();
    assert!(stale.is_empty(), "the case file does not know {stale:?}");
}

/// Keys of the schema, by [`named_once`].
#[derive(Default)]
struct Keys {
    all: BTreeSet<String>,
    /// Those that are more than tables of others.
    values: BTreeSet<String>,
}

impl Keys {
    fn walk(&mut self, value: &Value, path: &str) {
        for (key, field) in value["properties"].as_object().into_iter().flatten() {
            let told = field["description"].as_str().unwrap_or_default();
            // a second name, or a word as a table
            if told.starts_with("The same as `") || field["anyOf"][0]["const"] == Value::Bool(true) {
                continue;
            }
            let here = if path.is_empty() { key.clone() } else { format!("{path}.{key}") };
            let name = named_once(&here);
            let words = field["anyOf"].as_array().into_iter().flatten().any(|o| o["const"].is_string());
            if words || !has_keys(field) {
                self.values.insert(name.clone());
            }
            self.all.insert(name);
            self.walk(field, &here);
        }
        options(value).for_each(|option| self.walk(option, path));
    }
}

/// What a value may be, and the items of lists.
fn options(value: &Value) -> impl Iterator<Item = &Value> {
    let all = ["anyOf", "oneOf"].into_iter().filter_map(|k| value[k].as_array()).flatten();
    all.chain([&value["items"]]).filter(|option| option.is_object())
}

/// True where a value may be a table with keys.
fn has_keys(value: &Value) -> bool {
    value["properties"].as_object().is_some_and(|p| !p.is_empty()) || options(value).any(has_keys)
}

/// The name of a key, the same for all places of a table that stands in several.
fn named_once(path: &str) -> String {
    let mut key = path.replace("structure.section.", "structure.").replace("body.motion.", "motion.");
    for material in ["body.solid.region.material.", "body.solid.material."] {
        key = key.replace(material, "material.");
    }
    if let Some((_, rest)) = key.split_once(".where.") {
        return format!("place.{rest}");
    }
    for section in ["body.wing.tip_naca.", "body.wing.naca."] {
        key = key.replace(section, "body.naca.");
    }
    match key.split('.').collect::<Vec<_>>()[..] {
        ["boundary", _, "outflow", last] => format!("boundary.outflow.{last}"),
        ["structure", "springs", _, last] => format!("structure.springs.{last}"),
        _ => key,
    }
}
