//! `alula verify` keeps what it has computed, goes on after a stop, and lists cases.
#![cfg(unix)]
#![allow(clippy::unwrap_used, reason = "it may stop anywhere")]
use std::io::{BufRead, BufReader};
use std::path::Path;
use std::process::{Child, Command, Output, Stdio};

use serde_json::Value;

const CASE: &str = "title = \"still\"\ndimension = 2\n[flow]\nmach = 0.5\n[cloud]\nspacing = 0.25\n\
    domain = { min = [0.0, 0.0], max = [1.0, 1.0] }\n[time.explicit]\nuntil = 0.1\ncfl = 0.5\n";
const CLAIM: &str = "[[claim]]\nmetric = \"particles\"\nkind = \"at_least\"\nreference = 1\nsource = \"count\"\n";

/// A folder with two short cases and one that lasts for hours.
fn cases() -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    let write = |name: &str, case: &str, claim: &str| {
        let path = folder.path().join("verification").join(name);
        std::fs::create_dir_all(&path).unwrap();
        std::fs::write(path.join("case.toml"), case).unwrap();
        std::fs::write(path.join("claim.toml"), claim).unwrap();
    };
    write("first", CASE, &format!("cpu_seconds = 0.5\n{CLAIM}"));
    write("second", &CASE.replace("0.5\n[cloud]", "0.6\n[cloud]"), CLAIM);
    write("third", &CASE.replace("until = 0.1", "until = 1e6"), CLAIM);
    folder
}

fn command(folder: &Path, args: &[&str]) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_alula"));
    command.arg("verify").args(args).current_dir(folder);
    command
}

fn verify(folder: &Path, args: &[&str]) -> Output {
    command(folder, args).output().unwrap()
}

fn events(output: &[u8], kind: &str) -> Vec<Value> {
    let text = String::from_utf8(output.to_vec()).unwrap();
    let all = text.lines().map(|line| serde_json::from_str::<Value>(line).unwrap());
    all.filter(|event| event["event"] == kind).collect()
}

/// Of each case that was judged its name, and whether all that it needed was kept before.
fn kept(output: &Output) -> Vec<(String, bool)> {
    let told = |case: &Value| {
        let runs = case["runs"].as_array().unwrap();
        (case["case"].as_str().unwrap().to_owned(), !runs.is_empty() && runs.iter().all(|run| run["kept"] == true))
    };
    events(&output.stdout, "case").iter().map(told).collect()
}

/// A verification of all cases that has judged the first two, and has begun the third.
fn in_the_third(folder: &Path) -> Child {
    let mut child = command(folder, &["--json"]).stdout(Stdio::piped()).stderr(Stdio::null()).spawn().unwrap();
    let mut lines = BufReader::new(child.stdout.as_mut().unwrap()).lines().map(Result::unwrap);
    assert!(lines.any(|line| line.contains("\"event\":\"case\",\"case\":\"second\"")));
    child
}

#[test]
fn a_stop_loses_nothing_that_has_ended() {
    let folder = cases();
    // a kill leaves no time to write anything
    let mut killed = in_the_third(folder.path());
    killed.kill().unwrap();
    killed.wait().unwrap();
    let short = ["first", "second", "--json"];
    let went_on = verify(folder.path(), &short);
    assert_eq!(kept(&went_on), [("first".into(), true), ("second".into(), true)]);
    assert_eq!(went_on.status.code(), Some(0));

    let mut stopped = in_the_third(folder.path());
    assert!(Command::new("kill").args(["-INT", &stopped.id().to_string()]).status().unwrap().success());
    assert_eq!(stopped.wait().unwrap().code(), Some(130));
    assert_eq!(kept(&verify(folder.path(), &short)), [("first".into(), true), ("second".into(), true)]);

    let again = verify(folder.path(), &[&short[..], &["--again"]].concat());
    assert_eq!(kept(&again), [("first".into(), false), ("second".into(), false)]);
    let elsewhere = verify(folder.path(), &[&short[..], &["--keep", "mine"]].concat());
    assert_eq!(kept(&elsewhere), [("first".into(), false), ("second".into(), false)]);
    assert!(folder.path().join("mine/times.json").is_file());
    let [whole] = &events(&elsewhere.stdout, "verification")[..] else { panic!() };
    assert_eq!((&whole["cases"], &whole["claims"], &whole["held"]), (&2.into(), &2.into(), &2.into()));
}

#[test]
fn cases_are_listed_with_times_and_claims() {
    let folder = cases();
    let list = |args: &[&str]| String::from_utf8(verify(folder.path(), args).stdout).unwrap();
    let before = list(&["--list"]);
    assert!(before.contains("first  about 0.5 s of processor time\n    particles: ≥ 1\n"), "{before}");
    assert!(
        before.contains("second  time not known")
            && before.contains("1 of 3 cases take 0.5 s of processor time, and 2 of unknown time"),
        "{before}"
    );
    assert!(verify(folder.path(), &["second"]).status.success());
    let after = list(&["--list", "second"]);
    assert!(after.contains("second  ") && after.contains(" of processor time, last"), "{after}");
    assert!(!after.contains("first"), "{after}");
    let told = events(&verify(folder.path(), &["--list", "--json"]).stdout, "listed");
    assert_eq!((told.len(), &told[0]["expected_cpu_seconds"], &told[0]["cpu_seconds"]), (3, &0.5.into(), &Value::Null));
    assert!(told[1]["cpu_seconds"].is_number() && told[1]["claims"][0]["holds"] == "≥ 1", "{told:?}");
    let fast = events(&verify(folder.path(), &["--list", "--json", "--fast"]).stdout, "listed");
    assert_eq!(fast.iter().map(|case| &case["case"]).collect::<Vec<_>>(), ["first"]);
}

#[test]
fn a_filter_that_fits_nothing_is_refused() {
    let folder = cases();
    let output = verify(folder.path(), &["first", "wing"]);
    let told = String::from_utf8_lossy(&output.stderr).into_owned();
    assert_eq!(output.status.code(), Some(2));
    assert!(told.contains("no case is called like `wing`") && told.contains("`third`"), "{told}");
    std::fs::write(folder.path().join("taken"), "").unwrap();
    let output = verify(folder.path(), &["first", "--keep", "taken"]);
    let told = String::from_utf8_lossy(&output.stderr).into_owned();
    assert!(output.status.code() == Some(2) && told.contains("cannot keep measurements in `taken`"), "{told}");
}
