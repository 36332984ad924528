//! What `summary.json` says of a run: what the loads are of, what the run understood, the cloud that it chose.
use std::path::Path;
use std::process::{Command, Output};

use serde_json::{Value, json};

const SECTION: &str =
    "title = \"section\"\n[flow]\nmach = 0.5\nalpha = \"2 deg\"\n[[body]]\nnaca = \"0012\"\n[output]\nreport = false\n";

fn alula(folder: &Path, args: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_alula")).args(args).current_dir(folder).output().unwrap()
}

/// Runs a case in the folder, and gives what it tells a terminal and its summary.
fn run(folder: &Path, case: &str) -> (String, Value) {
    std::fs::write(folder.join("case.toml"), case).unwrap();
    let output = alula(folder, &["run", "case.toml", "--out", "out"]);
    let told = String::from_utf8_lossy(&output.stdout).into_owned();
    assert_eq!(output.status.code(), Some(0), "{told}{}", String::from_utf8_lossy(&output.stderr));
    (told, serde_json::from_str(&std::fs::read_to_string(folder.join("out/summary.json")).unwrap()).unwrap())
}

#[test]
fn the_cloud_that_was_chosen_can_be_pasted() {
    let folder = tempfile::tempdir().unwrap();
    let (told, summary) = run(folder.path(), &format!("{SECTION}[accuracy]\nparticles = 1000\nloads = \"50 %\"\n"));
    assert!(told.starts_with("M 0.5, alpha 2 deg, chord 1, moments about (0.25, 0)\n"), "{told}");
    assert_eq!(
        (&summary["mach"], &summary["alpha_deg"], &summary["loads_at"]),
        (&json!(0.5), &json!(2.0), &Value::Null)
    );
    assert_eq!((&summary["reference"]["chord"], &summary["reynolds"]), (&json!(1.0), &Value::Null));
    let chosen = std::fs::read_to_string(folder.path().join("out/cloud.toml")).unwrap();
    assert!(summary["cloud"]["spacing"].is_number() && chosen.contains("\n[cloud]\nspacing = "), "{chosen}");
    std::fs::write(folder.path().join("again.toml"), format!("{SECTION}{chosen}")).unwrap();
    let check = alula(folder.path(), &["check", "again.toml", "--json"]);
    let check: Value = serde_json::from_slice(&check.stdout).unwrap();
    assert_eq!(check["particles"], summary["particles"]);
}

#[test]
fn a_march_of_one_period_has_means_and_harmonics() {
    let folder = tempfile::tempdir().unwrap();
    let march = "[motion]\npivot = [0.25, 0]\npitch = \"1 deg\"\nreduced_frequency = 0.3\n[cloud]\nspacing = 0.0625\nfar_field = 6.0\n\
        [time.dual]\nsteps_per_period = 16\nperiods = 1\norders = 1\n";
    let (told, summary) = run(folder.path(), &format!("{SECTION}{march}"));
    for words in [
        "the last period",
        "first harmonic",
        "per radian",
        "degrees before angle",
        "no period before confirms it",
        "at t = ",
    ] {
        assert!(told.contains(words), "{words}: {told}");
    }
    assert!(summary["converged"].is_null() && summary["residual_drop"].is_null(), "{summary}");
    assert!(summary["loads_at"] == summary["time"] && summary.get("periodic_change").is_none());
    let slope = summary["periodic_loads"]["per_motion"]["cl"].as_f64().unwrap();
    assert!((3.0..7.0).contains(&slope), "{slope}");
    assert!(folder.path().join("out/cloud.toml").metadata().is_err(), "the case gives the cloud");
    let again = alula(folder.path(), &["resume", "out"]);
    assert_eq!(again.status.code(), Some(0), "{}", String::from_utf8_lossy(&again.stderr));
}

#[test]
fn a_uniform_stream_has_nothing_to_converge() {
    let folder = tempfile::tempdir().unwrap();
    let case = "title = \"uniform\"\ndimension = 2\n[flow]\nmach = 0.5\nalpha = \"3 deg\"\n[cloud]\nspacing = 0.1\ndomain = { min = [0, 0], max = [1, 1] }\n";
    let (told, summary) = run(folder.path(), case);
    assert!(told.contains("nothing to converge"), "{told}");
    assert_eq!((&summary["converged"], &summary["iterations"]), (&json!(true), &json!(1)));
    assert!(summary["residual_drop"].is_null() && summary["reference"].is_null());
}

#[test]
fn points_of_a_polar_that_miss_the_accuracy_are_told() {
    let folder = tempfile::tempdir().unwrap();
    let polar = SECTION.replace("\"2 deg\"", "\"0:4:4 deg\"") + "[accuracy]\nparticles = 100\nloads = \"0.01 %\"\n";
    let (told, summary) = run(folder.path(), &polar);
    assert!(told.contains("longer than asked for") && told.contains("of 2 points are longer"), "{told}");
    assert!(summary["polar"].as_array().unwrap().iter().any(|p| p["within_accuracy"] == false), "{summary}");
    assert!(!told.starts_with("M 0.5"), "a point of many");
}
