//! What programs are told: events, one JSON object a line.
use std::path::Path;
use std::process::{Command, Output};

use serde_json::{Value, json};

const SECTION: &str = "title = \"section\"\n[flow]\nmach = 0.03\nalpha = \"2 deg\"\n[[body]]\nnaca = \"0012\"\n[cloud]\n\
    spacing = 0.0625\nfar_field = 10.0\n[time.steady]\niterations = 2\n[output]\nreport = false\n";

fn alula(folder: &Path, args: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_alula")).args(args).current_dir(folder).output().unwrap()
}

fn folder_with(case: &str) -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("case.toml"), case).unwrap();
    folder
}

/// All events; nothing else is told.
fn events(output: &Output) -> Vec<Value> {
    assert!(output.stderr.is_empty(), "{}", String::from_utf8_lossy(&output.stderr));
    let lines = String::from_utf8(output.stdout.clone()).unwrap();
    lines.lines().map(|line| serde_json::from_str(line).unwrap()).collect()
}

fn of_kind<'a>(events: &'a [Value], kind: &str) -> Vec<&'a Value> {
    events.iter().filter(|e| e["event"] == kind).collect()
}

#[test]
fn every_mistake_is_an_event_with_its_place() {
    let folder = folder_with(&SECTION.replace("0.0625", "\"wide\"").replace("mach = 0.03", "mach = -1"));
    for command in ["run", "check"] {
        let output = alula(folder.path(), &[command, "case.toml", "--json"]);
        assert_eq!(output.status.code(), Some(2));
        let told = events(&output);
        assert_eq!(told.len(), 2, "{told:?}");
        let [mach, spacing] = &told[..] else { panic!() };
        assert_eq!((&mach["event"], &mach["key"], &mach["line"]), (&json!("error"), &json!("flow.mach"), &json!(3)));
        assert_eq!((&spacing["file"], &spacing["key"]), (&json!("case.toml"), &json!("cloud.spacing")));
        assert_eq!((&spacing["line"], &spacing["column"], &spacing["end_column"]), (&json!(8), &json!(11), &json!(17)));
        assert_eq!(spacing["value"], "\"wide\"");
        assert!(spacing["allowed"].as_str().unwrap().contains("length"), "{spacing}");
    }
    let missing = events(&alula(folder.path(), &["check", "none.toml", "--json"]));
    assert_eq!(missing[0]["file"], "none.toml");
    assert!(missing[0]["hint"].as_str().unwrap().contains("alula new"));
}

#[test]
fn notes_warnings_and_errors_come_before_the_summary() {
    let folder = folder_with(SECTION);
    let output = alula(folder.path(), &["run", "case.toml", "--json"]);
    assert_eq!(output.status.code(), Some(1));
    let told = events(&output);
    let warned = of_kind(&told, "warning");
    assert!(warned.iter().any(|w| w["message"].as_str().unwrap().contains("adds drag")), "{told:?}");
    assert!(of_kind(&told, "note").iter().any(|n| n["message"].as_str().unwrap().contains("fluid particles")));
    assert!(!of_kind(&told, "iteration").is_empty());
    let [.., error, summary] = &told[..] else { panic!() };
    assert_eq!((&error["event"], &summary["event"]), (&json!("error"), &json!("summary")));
    assert!(error["message"].as_str().unwrap().starts_with("not converged"));
    assert!(error["hint"].as_str().unwrap().contains("time.steady.iterations"));
    let again = alula(folder.path(), &["resume", "runs/case", "--json"]);
    assert_eq!(again.status.code(), Some(1));
    assert_eq!(events(&again).last().unwrap()["event"], "summary");
    let occupied = alula(folder.path(), &["run", "case.toml", "--out", "runs/case", "--json"]);
    assert_eq!(occupied.status.code(), Some(2));
    assert!(events(&occupied)[0]["message"].as_str().unwrap().contains("finished run"));
}

#[test]
fn check_tells_what_it_understood_in_one_object() {
    let case =
        SECTION.replace("mach = 0.03", "mach = 0.03\npressure = \"1 atm\"\ntemperature = \"15 degC\"\nreynolds = 1e4");
    let folder = folder_with(&case);
    let output = alula(folder.path(), &["check", "case.toml", "--json"]);
    assert_eq!(output.status.code(), Some(0));
    let told = events(&output);
    assert_eq!(told.len(), 1);
    let (check, meant) = (&told[0], &told[0]["understood"]);
    assert_eq!(
        (&check["event"], &check["file"], &check["title"]),
        (&json!("check"), &json!("case.toml"), &json!("section"))
    );
    let close = |value: &Value, expected: f64| (value.as_f64().unwrap() / expected - 1.0).abs() < 1e-12;
    assert!(close(&meant["sound_speed"], (1.4 * 287.05f64 * 288.15).sqrt()), "{meant}");
    assert!(close(&meant["dynamic_pressure"], 0.5 * 1.4 * 101_325.0 * 0.0009), "{meant}");
    assert!(close(&meant["reynolds"], 1e4) && close(&meant["reference"]["chord"], 1.0), "{meant}");
    assert_eq!(meant["bodies"][0]["name"], "body-1");
    assert!(close(&meant["bodies"][0]["max"][0], 1.0), "{meant}");
    assert!(check["cost"]["bytes"].as_f64().unwrap() > 1e6 && check["cost"]["seconds"].as_f64().unwrap() > 0.0);
    assert_eq!(check["warnings"].as_array().unwrap().len(), 1, "{check}");
    let refused = alula(folder.path(), &["check", "case.toml", "--json", "--resolved"]);
    assert_eq!(refused.status.code(), Some(2));
}

#[test]
fn matrices_are_the_last_event_of_gaf() {
    let case = SECTION.replace("mach = 0.03", "mach = 0.5").replace("[time.steady]\niterations = 2\n", "");
    let folder = folder_with(&(case + "[gaf]\nreduced_frequencies = [0.5]\npivot = [0.25, 0]\n"));
    let output = alula(folder.path(), &["gaf", "case.toml", "--out", "out", "--json"]);
    let told = events(&output);
    let last = told.last().unwrap();
    assert_eq!((&last["event"], &last["run"]), (&json!("gaf"), &json!("out")));
    assert_eq!(last["columns"].as_array().unwrap().len(), last["modes"].as_array().unwrap().len());
    for what in ["gaf", "cloud"] {
        let again = alula(folder.path(), &[what, "case.toml", "--out", "out"]);
        let told = String::from_utf8_lossy(&again.stderr).into_owned();
        assert_eq!(again.status.code(), Some(2), "{told}");
        assert!(told.contains("`out` holds earlier results") && told.contains("--force"), "{told}");
    }
    let replaced = alula(folder.path(), &["cloud", "case.toml", "--out", "out", "--force"]);
    let told = String::from_utf8_lossy(&replaced.stderr).into_owned();
    assert!(replaced.status.success() && told.contains("kept in `out.replaced`"), "{told}");
    assert!(folder.path().join("out.replaced/gaf.csv").is_file() && !folder.path().join("out/gaf.csv").exists());
    let out = folder.path().join("out");
    std::fs::remove_dir_all(&out).unwrap();
    std::fs::rename(folder.path().join("out.replaced"), &out).unwrap();
    let resumed = alula(folder.path(), &["resume", "out"]);
    assert!(String::from_utf8_lossy(&resumed.stderr).contains("`alula gaf`, which is not resumed"));
}
