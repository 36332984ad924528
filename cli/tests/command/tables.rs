//! Tables that programs read by name, and what is told of their columns.
use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use std::process::Command;

use serde_json::Value;

const SECTION: &str =
    "[[body]]\nnaca = \"0012\"\n[cloud]\nspacing = 0.0625\nfar_field = 10.0\n[output]\nreport = false\n";

/// Runs a case into `out`; names of its tables, all columns of which are described.
fn tables_of(command: &str, case: &str) -> BTreeSet<String> {
    let folder = tempfile::tempdir().unwrap();
    described(&run(folder.path(), command, &format!("{case}\n{SECTION}")))
}

/// Runs a case in a folder; the folder of the run.
fn run(folder: &Path, command: &str, case: &str) -> PathBuf {
    std::fs::write(folder.join("case.toml"), case).unwrap();
    let run = Command::new(env!("CARGO_BIN_EXE_alula"))
        .args([command, "case.toml", "--out", "out", "--quiet"])
        .current_dir(folder)
        .output()
        .unwrap();
    assert!(matches!(run.status.code(), Some(0 | 1)), "{}", String::from_utf8_lossy(&run.stderr));
    folder.join("out")
}

fn described(out: &Path) -> BTreeSet<String> {
    let read = |name: &str| std::fs::read_to_string(out.join(name)).unwrap();
    let all: Value = serde_json::from_str(&read("csv-metadata.json")).unwrap();
    assert_eq!(all["@context"], "http://www.w3.org/ns/csvw");
    for table in all["tables"].as_array().unwrap() {
        let name = table["url"].as_str().unwrap();
        let columns = table["tableSchema"]["columns"].as_array().unwrap();
        let names: Vec<&str> = columns.iter().map(|c| c["name"].as_str().unwrap()).collect();
        assert_eq!(read(name).lines().next().unwrap(), names.join(","), "{name}");
        for column in columns {
            let is_number = ["number", "integer"].contains(&column["datatype"].as_str().unwrap_or_default());
            assert!(column["dc:description"].is_string(), "{name}: {column}");
            assert_eq!(column["schema:unitText"].is_string(), is_number, "{name}: {column}");
        }
    }
    let told: BTreeSet<String> =
        all["tables"].as_array().unwrap().iter().map(|t| t["url"].as_str().unwrap().to_owned()).collect();
    let there = std::fs::read_dir(out).unwrap().map(|e| e.unwrap().file_name().into_string().unwrap());
    assert_eq!(told, there.filter(|n| n.ends_with(".csv")).collect());
    told
}

fn has(tables: &BTreeSet<String>, names: &[&str]) {
    names.iter().for_each(|n| assert!(tables.contains(*n), "no {n} in {tables:?}"));
}

#[test]
fn every_column_of_a_steady_run_has_its_unit() {
    let air = "pressure = \"1 atm\"\ntemperature = \"15 degC\"";
    let viscous = format!("[flow]\nmach = 0.3\nreynolds = 500\n{air}\n[time.steady]\niterations = 3");
    has(&tables_of("run", &viscous), &["history.csv", "loads.csv", "surface.csv"]);
    let adapted = format!("{viscous}\n[adapt]\ncycles = 1");
    has(&tables_of("run", &adapted), &["history.csv", "loads.csv", "surface.csv", "adapt.csv"]);
    let polar = "[flow]\nmach = 0.4\nalpha = [\"0 deg\", \"1 deg\"]\n[accuracy]\nparticles = 100\n[time.steady]\niterations = 3";
    has(&tables_of("run", polar), &["polar.csv"]);
}

#[test]
fn every_column_of_a_periodic_run_has_its_unit() {
    let swing = "[flow]\nmach = 0.4\n[motion]\nreduced_frequency = 0.3\npitch = \"1 deg\"\npivot = [0.25, 0]\n[time.harmonics]\nnumber = 1\niterations = 3";
    has(&tables_of("run", swing), &["loops.csv", "instances.csv", "surface_harmonics.csv", "momentum.csv"]);
    let gaf = "[flow]\nmach = 0.4\n[gaf]\nreduced_frequencies = [0.5]\npivot = [0.25, 0]";
    has(&tables_of("gaf", gaf), &["gaf.csv"]);
}

#[test]
fn every_column_of_a_structure_has_its_unit() {
    let springs = "[flow]\nmach = 0.6\n[motion]\nparticles = \"rigid\"\n[structure]\nelastic_axis = -0.6\nmass_ratio = 75.0\n\
        x_alpha = 0.25\nr_alpha2 = 0.75\nfrequency_ratio = 0.5\nspeed_index = 0.65\ninitial = { plunge = 0.01 }\n\
        [time.dual]\nstep = 1.0\nuntil = 3.0";
    has(&tables_of("run", springs), &["structure.csv"]);
}

/// A column of numbers of the rows of a table whose first entry is `body`.
fn column(table: &Path, name: &str, body: &str) -> Vec<f64> {
    let text = std::fs::read_to_string(table).unwrap();
    let at = text.lines().next().unwrap().split(',').position(|n| n == name).unwrap();
    let rows = text.lines().skip(1).map(|l| l.split(',').collect::<Vec<_>>()).filter(|r| r[0] == body);
    rows.map(|r| r[at].parse().unwrap()).collect()
}

#[test]
fn strips_of_an_aircraft_add_up_to_the_loads_of_its_parts() {
    let air = "pressure = \"1 atm\"\ntemperature = \"15 degC\"";
    let case = format!(
        "[flow]\nmach = 0.4\nalpha = \"3 deg\"\n{air}\n\
         [[body]]\nname = \"wing\"\nwing = {{ naca = \"0012\", span = \"5 m\", chord = \"1 m\", taper = 0.5, sweep = \"20 deg\" }}\n\
         [[body]]\nname = \"fin\"\nwing = {{ naca = \"0012\", span = \"1.5 m\", chord = \"1 m\", sides = \"one\", dihedral = \"90 deg\" }}\n\
         translate = [3, 0, 0]\n[cloud]\nspacing = \"0.25 m\"\nedge_levels = 0\ncurvature_levels = 0\nfar_field = \"16 m\"\n[time.steady]\niterations = 4\n"
    );
    let folder = tempfile::tempdir().unwrap();
    let out = run(folder.path(), "run", &case);
    has(&described(&out), &["strips.csv"]);
    for body in ["wing", "fin"] {
        for name in ["cl", "cd", "cm", "fx", "fy", "fz"] {
            let [strips, whole] = ["strips.csv", "loads.csv"].map(|table| column(&out.join(table), name, body));
            let size: f64 = strips.iter().map(|v| v.abs()).sum();
            let apart = strips.iter().sum::<f64>() - whole.iter().sum::<f64>();
            assert!(strips.len() > 3 && apart.abs() <= 1e-12 * size, "{body} {name}: {apart:e} of {size}");
        }
    }
    let summary: Value = serde_json::from_str(&std::fs::read_to_string(out.join("summary.json")).unwrap()).unwrap();
    let roots = summary["root_loads"].as_array().unwrap();
    let told: Vec<_> = roots.iter().map(|r| (r["body"].as_str().unwrap(), r["axis"].as_str().unwrap())).collect();
    assert_eq!(told, [("wing", "y"), ("wing", "y"), ("fin", "z")]);
    let sides = [0, 1].map(|k| roots[k]["shear"].as_f64().unwrap());
    let lift: f64 = column(&out.join("loads.csv"), "fz", "wing").iter().sum();
    assert!((sides[0] + sides[1] - lift).abs() <= 1e-12 * lift.abs(), "{sides:?} {lift}");
    for name in ["span-loading.svg", "span-loading.png"] {
        assert!(out.join("pictures").join(name).is_file(), "no `{name}`");
    }
}
