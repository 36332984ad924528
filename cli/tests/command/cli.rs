//! The command as its users meet it: files, exit codes, signals, bad days.
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Output, Stdio};
use std::time::{Duration, Instant};

use serde_json::Value;

/// What the last line of `run --json` promises, in order.
const PROMISED: [&str; 13] = [
    "event",
    "case",
    "run",
    "particles",
    "iterations",
    "residual_drop",
    "converged",
    "cpu_seconds",
    "wall_seconds",
    "peak_bytes",
    "loads",
    "loads_momentum_balance",
    "ledger",
];
/// What it may add.
const EXTRA: [&str; 34] = [
    "alpha_deg",
    "cloud",
    "loads_at",
    "mach",
    "reference",
    "reynolds",
    "hinge_moments",
    "root_loads",
    "span_load",
    "wake_planes",
    "warnings",
    "polar",
    "work_units",
    "free_stream",
    "generalised_forces",
    "chord",
    "harmonic_balance",
    "time",
    "unconverged_steps",
    "halved_steps",
    "momentum_of_period",
    "re_clouding",
    "first_harmonics",
    "periodic_change",
    "lift_cycles",
    "loads_pressure",
    "loads_friction",
    "separation",
    "bytes_per_particle",
    "cpu_ms_per_particle",
    "linear_iterations",
    "error_l2_density",
    "adapt_change",
    "phases",
];
/// Longest wait for anything.
const PATIENCE: Duration = Duration::from_secs(120);

/// A section in a subsonic stream: a steady case of a second.
const SECTION: &str = "title = \"section\"\n[flow]\nmach = 0.5\nalpha = \"2 deg\"\n[[body]]\nnaca = \"0012\"\n\
    [cloud]\nspacing = 0.03125\nfar_field = 10.0\n[scheme]\nlimiter = \"none\"\n[output]\ncheckpoint = 1\n\
    report = false\n";

/// A vortex in a periodic square: a march of some tens of steps.
const VORTEX: &str = "title = \"vortex\"\ndimension = 2\n[flow]\nmach = 1.1952286093343936\nalpha = \"45 deg\"\n[cloud]\n\
    spacing = 0.15625\ndomain = { min = [0.0, 0.0], max = [10.0, 10.0] }\n[boundary]\nx_min = \"periodic\"\n\
    x_max = \"periodic\"\ny_min = \"periodic\"\ny_max = \"periodic\"\n[initial.vortex]\nstrength = 5.0\n\
    centre = [5.0, 5.0]\nvelocity = [1.0, 1.0]\n[scheme]\nlimiter = \"none\"\n[time.explicit]\nuntil = 1.0\ncfl = 0.5\n\
    [output]\ncheckpoint = 1\nreport = false\n";

/// A cylinder that starts to swing in a stream of particles that travel: they are inserted and removed all the time.
const CYLINDER: &str = "title = \"cylinder\"\n[flow]\nmach = 0.3\n[motion]\nparticles = \"lagrangian\"\nperiod = 4.0\n\
    plunge = 0.1\n[[body]]\ncircle = { radius = 0.5 }\n[cloud]\nspacing = 0.0625\nfar_field = 4.0\n\
    [time.explicit]\nuntil = 1.0\n[output]\ncheckpoint = 1\nreport = false\n";

/// A section that is dropped on springs in a transonic stream.
const DROPPED: &str = "title = \"dropped\"\n[flow]\nmach = 0.8\n[motion]\nparticles = \"rigid\"\n[structure]\n\
    elastic_axis = -0.6\nmass_ratio = 75.0\nx_alpha = 0.25\nr_alpha2 = 0.75\nfrequency_ratio = 0.5\nspeed_index = 0.65\n\
    initial = { plunge = 0.01 }\n[[body]]\nnaca = \"0012\"\n[cloud]\nspacing = 0.0625\nfar_field = 10.0\n\
    [time.dual]\nstep = 1.0\nuntil = 40.0\n[output]\ncheckpoint = 1\nreport = false\n";

/// Two angles at two Mach numbers around a section.
const POLAR: &str = "title = \"polar\"\n[flow]\nmach = [0.4, 0.5]\nalpha = \"0:2:2 deg\"\n[[body]]\nnaca = \"0012\"\n\
    [cloud]\nspacing = 0.0625\nfar_field = 10.0\n[accuracy]\nparticles = 100\n[output]\ncheckpoint = 1\nreport = false\n";

/// A folder with a case in it.
struct Desk {
    folder: tempfile::TempDir,
}

impl Desk {
    fn new(case: &str) -> Self {
        let folder = tempfile::tempdir().unwrap();
        std::fs::write(folder.path().join("case.toml"), case).unwrap();
        Self { folder }
    }

    fn path(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    fn command(&self, args: &[&str]) -> Command {
        let mut command = Command::new(env!("CARGO_BIN_EXE_alula"));
        command.args(args).current_dir(self.folder.path()).stdout(Stdio::piped()).stderr(Stdio::piped());
        command
    }

    fn alula(&self, args: &[&str]) -> Output {
        self.command(args).output().unwrap()
    }

    /// A run that is on its way: its first checkpoint exists.
    fn begun(&self, out: &str) -> Child {
        self.begun_by(self.command(&["run", "case.toml", "--out", out, "--quiet"]), out)
    }

    /// The same with a command of its own.
    fn begun_by(&self, mut command: Command, out: &str) -> Child {
        let mut child = command.spawn().unwrap();
        let checkpoint = self.path(out).join("checkpoint.alula");
        let began = Instant::now();
        while !checkpoint.exists() && child.try_wait().unwrap().is_none() {
            assert!(began.elapsed() < PATIENCE, "no checkpoint");
            std::thread::sleep(Duration::from_millis(2));
        }
        child
    }
}

fn code(output: &Output) -> Option<i32> {
    output.status.code()
}

fn told(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned()
}

/// A moment that differs from run to run, below `limit` milliseconds.
fn random_moment(limit: u32) -> Duration {
    let now = std::time::SystemTime::now().duration_since(std::time::UNIX_EPOCH).unwrap();
    Duration::from_millis(u64::from(now.subsec_micros() % limit))
}

/// The results of two runs are the same to the last bit; histories up to the seconds they took.
fn assert_same_results(a: &Path, b: &Path, what: &str) {
    for name in ["field.vtu", "loads.csv", "surface.csv", "ledger.json", "structure.csv"] {
        let bytes = |folder: &Path| std::fs::read(folder.join(name)).ok();
        assert!(bytes(a).is_some() || name == "structure.csv", "{what}: no `{name}`");
        assert!(bytes(a) == bytes(b), "{what}: `{name}` differs");
    }
    let timeless = |folder: &Path, name: &str| {
        let text = std::fs::read_to_string(folder.join(name)).unwrap_or_default();
        let seconds = text.lines().next().and_then(|head| head.split(',').position(|name| name.ends_with("seconds")));
        let rest =
            |l: &str| l.split(',').enumerate().filter(|c| Some(c.0) != seconds).map(|c| c.1.to_owned()).collect();
        text.lines().map(rest).collect::<Vec<Vec<String>>>()
    };
    assert!(!timeless(a, "history.csv").is_empty(), "{what}: no history");
    for name in ["history.csv", "polar.csv"] {
        assert_eq!(timeless(a, name), timeless(b, name), "{what}: `{name}` differs");
    }
}

#[test]
fn a_run_goes_to_its_end_and_the_summary_keeps_its_promise() {
    let desk = Desk::new(SECTION);
    let output = desk.alula(&["run", "case.toml", "--out", "out", "--json"]);
    assert_eq!(code(&output), Some(0), "{}", told(&output));
    let lines = String::from_utf8(output.stdout).unwrap();
    assert!(lines.lines().all(|l| serde_json::from_str::<Value>(l).is_ok()), "a line is not JSON");
    let summary: Value = serde_json::from_str(lines.lines().last().unwrap()).unwrap();
    let keys: Vec<&str> = summary.as_object().unwrap().keys().map(String::as_str).collect();
    assert_eq!(keys[..PROMISED.len()], PROMISED);
    assert!(keys[PROMISED.len()..].iter().all(|k| EXTRA.contains(k)), "{keys:?}");
    let inner = |key: &str| summary[key].as_object().unwrap().keys().cloned().collect::<Vec<_>>();
    assert_eq!(inner("loads"), ["cl", "cd", "cm"]);
    assert_eq!(inner("loads_momentum_balance"), ["cl", "cd", "cm"]);
    assert_eq!(inner("ledger"), ["mass", "momentum", "energy"]);
    assert!(summary["event"] == "summary" && summary["converged"] == true && summary["case"] == "section");
    assert!(summary["residual_drop"].as_f64().unwrap() >= 6.0);
    for name in ["case.toml", "history.csv", "loads.csv", "ledger.json", "surface.csv", "surface.vtp", "field.vtu"] {
        assert!(desk.path("out").join(name).is_file(), "no `{name}`");
    }
}

#[test]
fn an_earlier_run_is_kept() {
    let desk = Desk::new(SECTION);
    std::fs::create_dir(desk.path("out")).unwrap();
    std::fs::write(desk.path("out/case.toml"), "mine").unwrap();
    let output = desk.alula(&["run", "case.toml", "--out", "out"]);
    let text = told(&output);
    assert_eq!(code(&output), Some(2));
    for word in ["`out` holds an earlier run", "--out", "alula resume out", "--force"] {
        assert!(text.contains(word), "{text}");
    }
    assert_eq!(std::fs::read_to_string(desk.path("out/case.toml")).unwrap(), "mine");
}

#[test]
fn a_place_that_cannot_be_written_is_named() {
    let desk = Desk::new(SECTION);
    std::fs::write(desk.path("file"), "").unwrap();
    let output = desk.alula(&["run", "case.toml", "--out", "file/out"]);
    assert!(code(&output) == Some(2) && told(&output).contains("`file/out`"), "{}", told(&output));
    assert!(told(&output).contains("hint: "), "{}", told(&output));
}

#[cfg(unix)]
#[test]
fn a_read_only_folder_is_named() {
    use std::os::unix::fs::PermissionsExt;
    let desk = Desk::new(SECTION);
    std::fs::create_dir(desk.path("locked")).unwrap();
    std::fs::set_permissions(desk.path("locked"), PermissionsExt::from_mode(0o555)).unwrap();
    if std::fs::write(desk.path("locked/probe"), "").is_ok() {
        return; // the superuser may write everywhere
    }
    let output = desk.alula(&["run", "case.toml", "--out", "locked/out"]);
    assert!(code(&output) == Some(2) && told(&output).contains("`locked/out`"), "{}", told(&output));
    assert!(told(&output).contains("writable"), "{}", told(&output));
}

#[test]
fn mistakes_in_a_case_are_told_with_a_caret() {
    let desk = Desk::new(&SECTION.replace("mach = 0.5", "mach = \"fast\"").replace("limiter", "limitter"));
    for command in ["run", "check"] {
        let output = desk.alula(&[command, "case.toml"]);
        let text = told(&output);
        assert_eq!(code(&output), Some(2), "{text}");
        for word in ["case.toml", "^", "limitter", "`limiter`", "mach"] {
            assert!(text.contains(word), "no {word} in {text}");
        }
    }
    assert!(!desk.path("runs").exists(), "a bad case leaves nothing behind");
    assert_eq!(code(&desk.alula(&["run", "missing.toml"])), Some(2));
    assert_eq!(code(&desk.alula(&["run", "case.toml", "--nonsense"])), Some(2));
}

#[test]
fn what_cannot_be_computed_yet_is_neither_checked_nor_run() {
    let desk = Desk::new(SECTION);
    let output = desk.alula(&["new", "pitching"]);
    assert_eq!(code(&output), Some(0), "{}", told(&output));
    assert_eq!(code(&desk.alula(&["check", "pitching.toml"])), Some(0));
    let file = desk.path("pitching.toml");
    let text = std::fs::read_to_string(&file).unwrap();
    let text = text.replace("particles = \"deforming\"", "particles = \"lagrangian\"");
    std::fs::write(&file, format!("{text}\n[scheme]\nconservative = true\n")).unwrap();
    for command in ["run", "check"] {
        let output = desk.alula(&[command, "pitching.toml"]);
        let text = told(&output);
        assert!(
            code(&output) == Some(2)
                && text.contains("conservative coefficients of particles that travel")
                && text.contains("hint: "),
            "{text}"
        );
    }
    assert!(!desk.path("runs").exists(), "a refused case leaves nothing behind");
}

/// Kills runs of a case at random moments and goes on with them.
fn survives_being_killed(case: &str) {
    let desk = Desk::new(case);
    let whole = desk.alula(&["run", "case.toml", "--out", "whole", "--quiet"]);
    assert_eq!(code(&whole), Some(0), "{}", told(&whole));
    let mut moment = random_moment(200);
    for attempt in 0..20 {
        let out = format!("out-{attempt}");
        let mut child = desk.begun(&out);
        std::thread::sleep(moment);
        child.kill().unwrap();
        if child.wait().unwrap().success() {
            moment /= 2; // too late: it had finished
            continue;
        }
        let output = desk.alula(&["resume", &out, "--quiet", "--threads", "2"]);
        assert_eq!(code(&output), Some(0), "killed after {moment:?}: {}", told(&output));
        assert_same_results(&desk.path("whole"), &desk.path(&out), &format!("killed after {moment:?}"));
        return;
    }
    panic!("every run finished before it could be killed");
}

#[test]
fn a_killed_relaxation_goes_on_to_the_same_bits() {
    survives_being_killed(SECTION);
}

#[test]
fn a_killed_polar_goes_on_to_the_same_bits() {
    survives_being_killed(POLAR);
}

#[test]
fn a_polar_has_a_row_for_each_point_and_check_counts_them() {
    let desk = Desk::new(POLAR);
    let checked = desk.alula(&["check", "case.toml"]);
    let said = String::from_utf8(checked.stdout).unwrap();
    assert!(said.contains("4 points: 2 angles at 2 Mach numbers"), "{said}");
    let output = desk.alula(&["run", "case.toml", "--out", "out"]);
    assert_eq!(code(&output), Some(0), "{}", told(&output));
    let said = String::from_utf8(output.stdout).unwrap();
    assert!(said.contains("0.500    2.000") && said.contains("4 points; "), "{said}");
    let table = std::fs::read_to_string(desk.path("out/polar.csv")).unwrap();
    assert!(table.starts_with("point,mach,alpha_deg,cl,cd,cm,") && table.lines().count() == 5, "{table}");
    let refused = desk.alula(&["run", "case.toml", "--out", "other", "--from", "out"]);
    assert!(code(&refused) == Some(2) && told(&refused).contains("without `--from`"), "{}", told(&refused));
}

#[test]
fn a_killed_march_goes_on_to_the_same_bits() {
    survives_being_killed(VORTEX);
}

#[test]
fn a_killed_march_of_travelling_particles_goes_on_to_the_same_bits() {
    survives_being_killed(CYLINDER);
}

#[test]
fn a_killed_implicit_march_of_travelling_particles_goes_on_to_the_same_bits() {
    survives_being_killed(&CYLINDER.replace("[time.explicit]", "[time.dual]\nstep = 0.1"));
}

#[test]
fn a_killed_march_of_a_body_on_springs_goes_on_to_the_same_bits() {
    survives_being_killed(DROPPED);
}

#[test]
fn a_body_that_goes_where_the_cloud_cannot_follow_is_told_with_its_place() {
    let light =
        DROPPED.replace("mass_ratio = 75.0", "mass_ratio = 10.0").replace("speed_index = 0.65", "speed_index = 6.0");
    // all but free to plunge, so that it leaves whatever the digits of its start are
    let light = light.replace("frequency_ratio = 0.5", "frequency_ratio = 0.05");
    let light = light.replace("rigid", "deforming").replace("until = 40", "until = 100");
    let desk = Desk::new(&light.replace("plunge = 0.01", "pitch_rate = 0.2"));
    let output = desk.alula(&["run", "case.toml", "--out", "out", "--quiet"]);
    let text = told(&output);
    assert_eq!(code(&output), Some(1), "{text}");
    for word in ["the structure had plunge", "pitch", "degrees", "`alula report out`", "last good state"] {
        assert!(text.contains(word), "no {word} in {text}");
    }
    assert_eq!(code(&desk.alula(&["report", "out"])), Some(0));
}

#[cfg(unix)]
#[test]
fn an_interrupted_run_says_how_to_go_on() {
    let desk = Desk::new(VORTEX);
    let whole = desk.alula(&["run", "case.toml", "--out", "whole", "--quiet"]);
    assert_eq!(code(&whole), Some(0), "{}", told(&whole));
    let child = desk.begun("out");
    let signal = Command::new("kill").args(["-INT", &child.id().to_string()]).status().unwrap();
    assert!(signal.success());
    let output = child.wait_with_output().unwrap();
    assert_eq!(code(&output), Some(130), "{}", told(&output));
    assert!(told(&output).contains("`alula resume out`"), "{}", told(&output));
    let output = desk.alula(&["resume", "out", "--quiet"]);
    assert_eq!(code(&output), Some(0), "{}", told(&output));
    assert_same_results(&desk.path("whole"), &desk.path("out"), "interrupted");
}

#[test]
fn a_damaged_checkpoint_is_refused() {
    let desk = Desk::new(SECTION);
    let mut child = desk.begun("out");
    child.kill().unwrap();
    child.wait().unwrap();
    let path = desk.path("out/checkpoint.alula");
    let previous = desk.path("out/checkpoint.alula.previous");
    let good = std::fs::read(&path).or_else(|_| std::fs::read(&previous)).unwrap();
    // it may have been killed between two renames
    let _ = std::fs::remove_file(&previous);
    let mut flipped = good.clone();
    flipped[good.len() / 2] ^= 0x10;
    for (what, bytes) in [("a flipped bit", &flipped[..]), ("a short file", &good[..good.len() / 3]), ("nothing", &[])]
    {
        std::fs::write(&path, bytes).unwrap();
        let output = desk.alula(&["resume", "out"]);
        let text = told(&output);
        assert_eq!(code(&output), Some(2), "{what}: {text}");
        assert!(text.contains("checkpoint.alula"), "{what}: {text}");
    }
    std::fs::remove_file(&path).unwrap();
    let output = desk.alula(&["resume", "out"]);
    assert!(code(&output) == Some(2) && told(&output).contains("checkpoint.alula"), "{}", told(&output));
    std::fs::write(&path, &good[..good.len() / 3]).unwrap();
    std::fs::write(&previous, &good).unwrap();
    let output = desk.alula(&["resume", "out", "--quiet"]);
    assert_eq!(code(&output), Some(0), "{}", told(&output));
    let output = desk.alula(&["resume", "nowhere"]);
    assert!(code(&output) == Some(2) && told(&output).contains("`nowhere` is not a run folder"), "{}", told(&output));
}

/// The nose, sides and tail of a section in a file.
const SHAPE: &str = "1 0\n0.9 0.014\n0.7 0.037\n0.5 0.053\n0.3 0.06\n0.15 0.053\n0.07 0.041\n0.03 0.028\n0.01 0.017\n0 0\n\
    0.01 -0.017\n0.03 -0.028\n0.07 -0.041\n0.15 -0.053\n0.3 -0.06\n0.5 -0.053\n0.7 -0.037\n0.9 -0.014\n1 0\n";

#[test]
fn a_run_that_reads_files_goes_on_from_any_folder() {
    let desk = Desk::new(&SECTION.replace("naca = \"0012\"", "airfoil = \"section.dat\""));
    std::fs::write(desk.path("section.dat"), SHAPE).unwrap();
    let whole = desk.alula(&["run", "case.toml", "--out", "whole", "--quiet"]);
    assert_eq!(code(&whole), Some(0), "{}", told(&whole));
    let mut child = desk.begun("out");
    child.kill().unwrap();
    child.wait().unwrap();
    let elsewhere = tempfile::tempdir().unwrap();
    let out = desk.path("out").display().to_string();
    let resume = || desk.command(&["resume", &out, "--quiet"]).current_dir(elsewhere.path()).output().unwrap();
    // files that have gone are named, with the note that says where they were
    std::fs::rename(desk.path("section.dat"), desk.path("moved.dat")).unwrap();
    let text = told(&resume());
    assert!(text.contains("`section.dat`") && text.contains("origin.txt"), "{text}");
    std::fs::rename(desk.path("moved.dat"), desk.path("section.dat")).unwrap();
    let output = resume();
    assert_eq!(code(&output), Some(0), "{}", told(&output));
    assert_same_results(&desk.path("whole"), &desk.path("out"), "from another folder");
}

/// All files of a folder and the folders in it, with what they hold.
fn contents(folder: &Path) -> std::collections::BTreeMap<PathBuf, Vec<u8>> {
    let mut all = std::collections::BTreeMap::new();
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            all.extend(contents(&path));
        } else {
            all.insert(path.clone(), std::fs::read(&path).unwrap());
        }
    }
    all
}

/// Runs a case to its end, goes on with it and runs it again: nothing changes.
fn stays_as_it_is(case: &str) {
    let desk = Desk::new(case);
    let first = desk.alula(&["run", "case.toml", "--out", "out", "--quiet"]);
    let before = contents(&desk.path("out"));
    assert!(before.contains_key(&desk.path("out/summary.json")), "{}", told(&first));
    let output = desk.alula(&["resume", "out"]);
    assert_eq!(code(&output), code(&first), "{}", told(&output));
    assert!(String::from_utf8_lossy(&output.stdout).contains("is finished"), "{}", told(&output));
    let again = desk.alula(&["run", "case.toml", "--out", "out"]);
    assert!(code(&again) == Some(2) && told(&again).contains("`out` holds a finished run"), "{}", told(&again));
    for (path, bytes) in contents(&desk.path("out")) {
        assert!(before.get(&path) == Some(&bytes), "`{}` differs", path.display());
    }
    // without its mark, as after a power cut at the very end: tables do not grow
    std::fs::remove_file(desk.path("out/finished.txt")).unwrap();
    desk.alula(&["resume", "out", "--quiet"]);
    for name in ["adapt.csv", "structure.csv"] {
        let path = desk.path("out").join(name);
        assert!(before.get(&path) == std::fs::read(&path).ok().as_ref(), "`{name}` differs");
    }
}

#[test]
fn a_finished_adapted_run_stays_as_it_is() {
    stays_as_it_is(&SECTION.replace("[scheme]", "[adapt]\ncycles = 1\n[scheme]"));
}

#[test]
fn a_finished_march_stays_as_it_is() {
    stays_as_it_is(&DROPPED.replace("until = 40.0", "until = 3.0"));
}

#[test]
fn a_finished_equilibrium_of_a_body_on_springs_stays_as_it_is() {
    let steady = DROPPED.split("[time.dual]").next().unwrap();
    let steady = steady.replace("mach = 0.8", "mach = 0.5").replace("initial = { plunge = 0.01 }\n", "");
    let rest = "[time.steady]\niterations = 200\n[output]\ncheckpoint = 1\nreport = false\n";
    stays_as_it_is(&(steady.replace("[motion]\nparticles = \"rigid\"\n", "") + rest));
}

#[test]
fn the_chord_is_that_of_the_geometry() {
    let case = SECTION.replace("naca = \"0012\"", "airfoil = \"section.dat\"\nchord = 0.2875");
    let desk = Desk::new(&case.replace("0.03125", "0.0125").replace("far_field = 10.0", "far_field = 3.0"));
    std::fs::write(desk.path("section.dat"), SHAPE).unwrap();
    let output = desk.alula(&["check", "case.toml"]);
    assert_eq!(code(&output), Some(0), "{}", told(&output));
    let text = String::from_utf8(output.stdout).unwrap();
    let line = text.lines().find(|l| l.starts_with("reference ")).unwrap();
    let chord: f64 = line.split_whitespace().nth(2).unwrap().trim_end_matches(',').parse().unwrap();
    assert!((chord - 0.2875).abs() < 1e-12, "{line}");
}

#[test]
fn a_run_stopped_before_its_first_checkpoint_begins_again() {
    let desk = Desk::new(SECTION);
    let whole = desk.alula(&["run", "case.toml", "--out", "out", "--quiet"]);
    assert_eq!(code(&whole), Some(0), "{}", told(&whole));
    std::fs::rename(desk.path("out"), desk.path("whole")).unwrap();
    std::fs::create_dir_all(desk.path("out/pictures")).unwrap();
    for name in ["origin.txt", "case.toml"] {
        std::fs::copy(desk.path("whole").join(name), desk.path("out").join(name)).unwrap();
    }
    let output = desk.alula(&["resume", "out"]);
    assert!(code(&output) == Some(2) && told(&output).contains("`alula run`"), "{}", told(&output));
    let output = desk.alula(&["run", "case.toml", "--out", "out"]);
    assert_eq!(code(&output), Some(0), "{}", told(&output));
    assert!(told(&output).contains("begins again"), "{}", told(&output));
    assert_same_results(&desk.path("whole"), &desk.path("out"), "begun again");
}

#[cfg(target_os = "linux")]
#[test]
fn a_run_whose_terminal_closes_keeps_a_checkpoint() {
    let desk = Desk::new(VORTEX);
    let hang_up = |child: &Child| {
        assert!(Command::new("kill").args(["-HUP", &child.id().to_string()]).status().unwrap().success());
    };
    // whoever runs the tests may ignore the signal, as `nohup` does
    let mut heard = Command::new("env");
    heard.args(["--default-signal=HUP", env!("CARGO_BIN_EXE_alula"), "run", "case.toml", "--out", "out", "--quiet"]);
    heard.current_dir(desk.folder.path()).stdout(Stdio::piped()).stderr(Stdio::piped());
    let child = desk.begun_by(heard, "out");
    hang_up(&child);
    let output = child.wait_with_output().unwrap();
    assert_eq!(code(&output), Some(130), "{}", told(&output));
    assert!(told(&output).contains("`alula resume out`"), "{}", told(&output));
}

#[test]
fn a_replaced_run_is_kept_under_another_name() {
    let desk = Desk::new(SECTION);
    std::fs::create_dir_all(desk.path("runs/case")).unwrap();
    std::fs::write(desk.path("runs/case/case.toml"), "mine").unwrap();
    let output = desk.alula(&["run", "case.toml", "--force"]);
    assert_eq!(code(&output), Some(0), "{}", told(&output));
    assert!(told(&output).contains("kept in `runs/case.replaced`"), "{}", told(&output));
    assert_eq!(std::fs::read_to_string(desk.path("runs/case.replaced/case.toml")).unwrap(), "mine");
    assert!(desk.path("runs/case/summary.json").is_file());
    // what cannot begin replaces nothing
    std::fs::write(desk.path("case.toml"), format!("{SECTION}[[body]]\nnaca = \"0012\"\n")).unwrap();
    let output = desk.alula(&["run", "case.toml", "--force"]);
    assert_eq!(code(&output), Some(2), "{}", told(&output));
    assert!(told(&output).contains("overlaps or touches"), "{}", told(&output));
    assert!(desk.path("runs/case/summary.json").is_file() && !desk.path("runs/case.replaced-2").exists());
}

#[cfg(unix)]
#[test]
fn a_run_that_goes_on_keeps_its_folder_to_itself() {
    let desk = Desk::new(CYLINDER);
    let child = desk.begun("out");
    let tell = |signal: &str| Command::new("kill").args([signal, &child.id().to_string()]).status().unwrap().success();
    assert!(tell("-STOP"));
    for words in [&["resume", "out"][..], &["run", "case.toml", "--out", "out", "--force"]] {
        let output = desk.alula(words);
        assert_eq!(code(&output), Some(2), "{}", told(&output));
        assert!(told(&output).contains("a run is going on in `out`"), "{}", told(&output));
    }
    assert!(tell("-INT") && tell("-CONT"));
    assert_eq!(code(&child.wait_with_output().unwrap()), Some(130));
    assert_eq!(code(&desk.alula(&["resume", "out"])), Some(0));
}

#[cfg(target_os = "linux")]
#[test]
fn results_that_nobody_receives_are_a_failure() {
    let desk = Desk::new(SECTION);
    let full = || Stdio::from(std::fs::File::options().write(true).open("/dev/full").unwrap());
    for more in [&[][..], &["--json"]] {
        let args = [&["run", "case.toml"][..], more].concat();
        let output = desk.command(&args).stdout(full()).output().unwrap();
        assert_eq!(code(&output), Some(1), "{}", told(&output));
        assert!(told(&output).contains("cannot write to standard output"), "{}", told(&output));
    }
}

#[test]
fn a_run_tells_of_its_cloud_what_check_tells() {
    // a crevice, in which layers end early
    let desk = Desk::new(
        "title = \"crevice\"\n[flow]\nmach = 0.3\nreynolds = 1000\n[[body]]\npolygon = [[-0.5, -0.5], [0.5, -0.5], \
         [0.5, 0.5], [0.079, 0.5], [0, -0.1], [-0.079, 0.5], [-0.5, 0.5]]\n[cloud]\nspacing = 0.06\nfar_field = 2\n\
         edge_levels = 1\nwall_layers = { first = 0.008 }\n[scheme]\nconservative = false\n[time.steady]\n\
         iterations = 1\n[output]\nreport = false\n",
    );
    let checked = String::from_utf8(desk.alula(&["check", "case.toml"]).stdout).unwrap();
    let text = told(&desk.alula(&["run", "case.toml"]));
    let notes: Vec<&str> = checked.lines().filter_map(|l| l.strip_prefix("note: ")).collect();
    assert!(!notes.is_empty(), "{checked}");
    notes.iter().for_each(|note| assert!(text.contains(note), "no {note} in {text}"));
}
