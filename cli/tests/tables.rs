//! Tables that programs read by name, and what is told of their columns.
#![allow(clippy::unwrap_used, reason = "it may stop anywhere")]
use std::collections::BTreeSet;
use std::path::Path;
use std::process::Command;

use serde_json::Value;

const SECTION: &str =
    "[[body]]\nnaca = \"0012\"\n[cloud]\nspacing = 0.0625\nfar_field = 10.0\n[output]\nreport = false\n";

/// Runs a case into `out`; names of its tables, all columns of which are described.
fn tables_of(command: &str, case: &str) -> BTreeSet<String> {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("case.toml"), format!("{case}\n{SECTION}")).unwrap();
    let run = Command::new(env!("CARGO_BIN_EXE_alula"))
        .args([command, "case.toml", "--out", "out", "--quiet"])
        .current_dir(folder.path())
        .output()
        .unwrap();
    assert!(matches!(run.status.code(), Some(0 | 1)), "{}", String::from_utf8_lossy(&run.stderr));
    described(&folder.path().join("out"))
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
    has(&tables_of("run", &viscous), &["history.csv", "loads.csv", "surface.csv", "adapt.csv"]);
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
