//! Commands that seek forces in small motion obey signals within a linear iteration, and say what is there.
#![cfg(unix)]
use std::io::{BufRead, BufReader};
use std::path::Path;
use std::process::{Command, Stdio};

const SECTION: &str = "[flow]\nmach = 0.5\n[[body]]\nnaca = \"0012\"\n[cloud]\nspacing = 0.03125\nfar_field = 20.0\n";
const FLUTTER: &str = "[structure]\nmodel = \"typical_section\"\nelastic_axis = -0.2\nx_alpha = 0.2\nr_alpha2 = 0.25\nmass_ratio = 50\n\
    frequency_ratio = 0.4\nspeed_index = 0.5\n[flutter]\nmach = [0.5]\n";
const GAF: &str =
    "[gaf]\nreduced_frequencies = [0.1, 0.2, 0.4, 0.8]\nmodes = [\"plunge\", \"pitch\"]\npivot = [0.25, 0.0]\n";

/// A body whose cloud takes some seconds to build.
const LARGE: &str =
    "[flow]\nmach = 0.3\n[[body]]\nsphere = { radius = 0.5 }\n[cloud]\nspacing = 0.02\nfar_field = 8.0\n";

/// Interrupts `alula COMMAND` by a signal as soon as it tells of forces; what it says from then on.
fn interrupted(folder: &Path, command: &str, case: &str, signal: &str) -> String {
    interrupted_at("forces at k", folder, command, &format!("{SECTION}{case}"), signal)
}

/// The same as soon as it says `when`.
fn interrupted_at(when: &str, folder: &Path, command: &str, case: &str, signal: &str) -> String {
    std::fs::write(folder.join("case.toml"), case).unwrap();
    let mut child = Command::new(env!("CARGO_BIN_EXE_alula"))
        .args([command, "case.toml", "--out", "out"])
        .current_dir(folder)
        .stdout(Stdio::null())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    let mut lines = BufReader::new(child.stderr.take().unwrap()).lines().map(Result::unwrap);
    let seen = lines.find(|line| line.contains(when));
    assert!(seen.is_some(), "`{when}` was not told");
    assert!(Command::new("kill").args([signal, &child.id().to_string()]).status().unwrap().success());
    let rest = lines.collect::<Vec<_>>().join("\n");
    assert_eq!(child.wait().unwrap().code(), Some(130), "{rest}");
    rest
}

/// Files that a message names are there.
fn names_what_is_there(folder: &Path, told: &str) {
    let named = told.split('`').skip(1).step_by(2).filter(|name| name.ends_with(".csv"));
    named.for_each(|name| assert!(folder.join(name).is_file(), "{name} is not there: {told}"));
}

#[test]
fn a_flutter_boundary_that_is_interrupted_at_its_forces_goes_on() {
    let folder = tempfile::tempdir().unwrap();
    let told = interrupted(folder.path(), "flutter", FLUTTER, "-TERM");
    assert!(
        told.contains("before the first Mach number was finished") && told.contains("`alula resume out`"),
        "{told}"
    );
    names_what_is_there(folder.path(), &told);
    let resumed =
        Command::new(env!("CARGO_BIN_EXE_alula")).args(["resume", "out"]).current_dir(folder.path()).output().unwrap();
    assert_ne!(resumed.status.code(), Some(2), "{}", String::from_utf8_lossy(&resumed.stderr));
    let page = std::fs::read_to_string(folder.path().join("out/report.html")).unwrap();
    let links = page.split("href=\"./").skip(1).map(|rest| rest.split('"').next().unwrap());
    let gone: Vec<&str> = links.filter(|name| !folder.path().join("out").join(name).exists()).collect();
    assert!(gone.is_empty(), "the page links files that are not there: {gone:?}");
    // what cannot begin replaces nothing; what can is kept under another name
    let replace = |case: &str| {
        std::fs::write(folder.path().join("case.toml"), format!("{SECTION}{case}")).unwrap();
        let words = ["flutter", "case.toml", "--out", "out", "--force", "--forces", "out/flutter.json"];
        Command::new(env!("CARGO_BIN_EXE_alula")).args(words).current_dir(folder.path()).output().unwrap()
    };
    let refused = replace(&FLUTTER.replace("[flutter]", "[flutter]\ntrim = true"));
    assert!(refused.status.code() == Some(2) && folder.path().join("out/flutter.json").is_file());
    let replaced = replace(FLUTTER);
    let told = String::from_utf8_lossy(&replaced.stderr).into_owned();
    assert!(told.contains("kept in `out.replaced`") && replaced.status.code() != Some(2), "{told}");
    assert!(
        folder.path().join("out.replaced/flutter.json").is_file() && folder.path().join("out/flutter.json").is_file()
    );
}

#[test]
fn matrices_that_are_interrupted_at_their_forces_say_what_is_there() {
    let folder = tempfile::tempdir().unwrap();
    let told = interrupted(folder.path(), "gaf", GAF, "-INT");
    assert!(told.contains("interrupted"), "{told}");
    names_what_is_there(folder.path(), &told);
}

#[test]
fn clouds_that_are_built_keep_no_signal_waiting() {
    for (command, more, told) in [
        ("run", "", "begin it again, in the same folder with `--out out`"),
        ("gaf", &*GAF.replace("0.0]", "0.0, 0.0]"), "begin it again with the same case, in the same folder"),
    ] {
        let folder = tempfile::tempdir().unwrap();
        let case = format!("{LARGE}{more}");
        let said = interrupted_at("building the cloud", folder.path(), command, &case, "-TERM");
        assert!(said.contains(told), "{said}");
        // nothing was iterated, and nothing keeps the folder
        assert!(!folder.path().join("out/checkpoint.alula").exists() && !said.contains("iteration  "), "{said}");
    }
}
