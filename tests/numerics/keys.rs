//! Every key of the case file has an effect: for each there is a pair of cases, `keys.txt`, that differ in it alone and in what is computed or
//! written, or a reason why it stands in [`ELSEWHERE`].
//!
//! A row of `keys.txt` is `key | base | path = value ; …`: the base case with these values, `-path` for a key that is taken out. A path goes
//! through the first table of an array. Keys of tables that stand in several places (materials, motions, places of loads and supports, conditions
//! on sides) are looked at once.
use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

use alula::case::{self, schema};
use alula::run::{self, Places, Silent};
use rayon::prelude::*;
use serde_json::Value;

const TABLE: &str = include_str!("keys.txt");

/// Keys that steer output or time alone, whose default depends on the machine, or whose cases are too long for this test: tests that look at them.
const ELSEWHERE: [(&str, &str); 5] = [
    ("title", "names the case in files"),
    ("output.checkpoint", "when checkpoints are written: `cli/tests`"),
    ("output.checkpoint_time", "the same"),
    ("gaf.", "`gaf.rs`, `flutter_forces.rs`, `verification/possio_*`"),
    ("flutter.", "`flutter_*.rs`, `verification/flutter_*`"),
];

/// Files of a run that tell its case, when it was or what it took.
const APART: [&str; 6] = ["case.toml", "finished.txt", "origin.txt", "history.csv", "report.html", "csv-metadata.json"];
/// The same of the keys of `summary.json`.
const COST: [&str; 9] = [
    "case",
    "run",
    "cpu_seconds",
    "wall_seconds",
    "peak_bytes",
    "phases",
    "cpu_ms_per_particle",
    "cloud",
    "bytes_per_particle",
];

struct Row<'a> {
    key: &'a str,
    base: &'a str,
    settings: Vec<&'a str>,
}

fn table() -> (BTreeMap<&'static str, toml::Table>, Vec<Row<'static>>) {
    let (mut bases, mut rows) = (BTreeMap::new(), Vec::new());
    for part in TABLE.split("\n== ").skip(1) {
        let (name, text) = part.split_once('\n').unwrap();
        if name != "keys" {
            bases.insert(name, text.parse().unwrap_or_else(|e| panic!("{name}: {e}")));
            continue;
        }
        for line in text.lines().filter(|l| !l.is_empty()) {
            let [key, base, settings] = line.split(" | ").collect::<Vec<_>>()[..] else { panic!("{line}") };
            rows.push(Row { key, base, settings: settings.split(" ; ").collect() });
        }
    }
    (bases, rows)
}

/// The table that holds the last key of a path, and that key.
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
            table.remove(key);
            continue;
        }
        let (path, value) = setting.split_once(" = ").unwrap();
        let value: toml::Table = format!("v = {value}").parse().unwrap_or_else(|e| panic!("{setting}: {e}"));
        let (table, key) = place(&mut case, path);
        table.insert(key.to_owned(), value["v"].clone());
    }
    case
}

/// What a run writes, but what it says of its case and its cost.
fn results(case: &toml::Table, input: &Path) -> Result<BTreeMap<String, Vec<u8>>, String> {
    let case = case::read(&toml::to_string(case).unwrap(), "case").map_err(|e| e.to_string())?;
    let out = tempfile::tempdir().unwrap();
    let places = Places { input: input.into(), out: out.path().join("run") };
    run::run(&case, &places, &mut Silent).map_err(|e| e.to_string())?;
    let mut found = BTreeMap::new();
    collect(&places.out, &mut found);
    Ok(found)
}

fn collect(folder: &Path, found: &mut BTreeMap<String, Vec<u8>>) {
    for entry in std::fs::read_dir(folder).unwrap().map(Result::unwrap) {
        let (path, name) = (entry.path(), entry.file_name().to_string_lossy().into_owned());
        if path.is_dir() {
            collect(&path, found);
        } else if !APART.contains(&name.as_str()) && !name.contains("checkpoint") && !name.ends_with(".alula") {
            let mut bytes = std::fs::read(&path).unwrap();
            if name == "summary.json" {
                let mut summary: Value = serde_json::from_slice(&bytes).unwrap();
                let all = summary.as_object_mut().unwrap();
                COST.iter().for_each(|key| drop(all.remove(*key)));
                bytes = summary.to_string().into_bytes();
            }
            found.insert(name, bytes);
        }
    }
}

/// Files that the cases name.
fn input() -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    let mode = |shape: &dyn Fn(f64) -> f64| {
        let row = |k: u32, y: f64| format!("{},{y},0,{}\n", 0.1 * f64::from(k), shape(0.1 * f64::from(k)));
        let rows = (0..=10).flat_map(|k| [row(k, -0.06), row(k, 0.06)]);
        "x,y,dx,dy\n".to_owned() + &rows.collect::<String>()
    };
    let section = "own\n1 0\n0.75 0.04\n0.5 0.06\n0.25 0.07\n0.1 0.05\n0.02 0.02\n0 0\n0.02 -0.02\n0.1 -0.03\n0.25 -0.04\n0.5 -0.03\n0.75 -0.02\n1 0\n";
    let files = [
        ("table.csv", "time,x\n0,0\n0.5,0.03\n1,0\n1.5,-0.03\n2,0\n".to_owned()),
        ("mode.csv", mode(&|x| x * x)),
        ("mode2.csv", mode(&|x| x)),
        ("cp.csv", "x_c,Cp\n0.1,-0.5\n0.5,-0.2\n0.9,0.1\n".to_owned()),
        ("cp2.csv", "x_c,Cp\n0.1,-0.6\n0.5,-0.2\n0.9,0.1\n".to_owned()),
        ("own.dat", section.to_owned()),
        ("box.stl", cuboid()),
    ];
    files.iter().for_each(|(name, text)| std::fs::write(folder.path().join(name), text).unwrap());
    folder
}

/// A box of 1 × 1 × 0.5 with one corner that two faces put in slightly different places.
fn cuboid() -> String {
    let corner = |k: usize| [[0, 1, 1, 0][k % 4], [0, 0, 1, 1][k % 4], k / 4].map(|c| c as f64);
    let faces = [
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
    let mut text = "solid box\n".to_owned();
    for (n, face) in faces.iter().enumerate() {
        text += "facet normal 0 0 0\nouter loop\n";
        for (k, v) in face.iter().enumerate() {
            let [x, y, z] = corner(*v);
            let x = if n == 0 && k == 2 { x + 2e-5 } else { x };
            text += &format!("vertex {x} {y} {}\n", 0.5 * z);
        }
        text += "endloop\nendfacet\n";
    }
    text + "endsolid box\n"
}

#[test]
#[ignore = "half a thousand short runs: two minutes"]
fn every_key_changes_what_is_found() {
    let (bases, rows) = table();
    let input = input();
    let used: BTreeSet<&str> = rows.iter().map(|r| r.base).collect();
    let of = |name: &&str| {
        let found = results(&bases[*name], input.path());
        (*name, found.unwrap_or_else(|e| panic!("base `{name}`: {e}")))
    };
    let before: BTreeMap<&str, _> = used.par_iter().map(of).collect();
    let fault = |row: &Row<'_>| match results(&changed(&bases[row.base], &row.settings), input.path()) {
        Err(problem) => Some(format!("`{}` on `{}`: {problem}", row.key, row.base)),
        Ok(found) if found == before[row.base] => Some(format!("`{}` on `{}` changes nothing", row.key, row.base)),
        Ok(_) => None,
    };
    let faults: Vec<String> = rows.par_iter().filter_map(fault).collect();
    assert!(faults.is_empty(), "{}", faults.join("\n"));
}

#[test]
fn no_key_is_left_out() {
    let mut keys = Keys::default();
    keys.walk(&schema(), "");
    let (bases, rows) = table();
    assert!(rows.iter().all(|row| bases.contains_key(row.base)));
    let known: BTreeSet<&str> = rows.iter().map(|r| r.key).collect();
    let excused = |key: &str| ELSEWHERE.iter().any(|(e, _)| *e == key || (e.ends_with('.') && key.starts_with(e)));
    let missing: Vec<&String> =
        keys.values.iter().filter(|key| !known.contains(key.as_str()) && !excused(key)).collect();
    assert!(missing.is_empty(), "no pair of cases for {missing:?}");
    let stale: Vec<&&str> = known.iter().filter(|key| !keys.all.contains(**key)).collect();
    assert!(stale.is_empty(), "the case file does not know {stale:?}");
}

/// Keys of the schema, each table once.
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
        for option in options(value) {
            self.walk(option, path);
        }
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

/// The name of a key of a table that stands in several places.
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
    let parts: Vec<&str> = key.split('.').collect();
    match parts[..] {
        ["boundary", _, "outflow", last] => format!("boundary.outflow.{last}"),
        ["structure", "springs", _, last] => format!("structure.springs.{last}"),
        _ => key,
    }
}
