//! What README and book show is true: `alula check` accepts every case, the parser of arguments every command, fragments with what they
//! take for granted. Blocks of Rust are programs of `examples/`, which the tests compile, and pictures are there.
//!
//! `ALULA_WRITE=1 cargo test -p alula-cli --test command book` brings the page of the commands up to date.
use std::fmt::Write as _;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

/// A stream, a section and a cloud that is made quickly.
const STREAM: &str = "[flow]\nmach = 0.5\n";
const SECTION: &str = "[[body]]\nnaca = \"0012\"\n[cloud]\nspacing = 0.0625\nfar_field = 10.0\n";
const CLOUD: &str = "[cloud]\nspacing = 0.0625\nfar_field = 10.0\n";
const PITCH: &str = "[motion]\nreduced_frequency = 0.1\npivot = [0.25, 0]\npitch = \"1 deg\"\n";
const MARCH: &str = "[time.dual]\nsteps_per_period = 16\nperiods = 1\n";
const SPRINGS: &str = "[structure]\nelastic_axis = -0.5\nmass = \"50 kg/m\"\nx_alpha = 0.2\nr_alpha2 = 0.25\n\
                       frequency = { plunge = \"5 Hz\", pitch = \"10 Hz\" }\n";
const AIR: &str = "[flow]\nmach = 0.5\npressure = \"101 kPa\"\ntemperature = \"288 K\"\n";
const BEAM: &str = "[[body]]\nbox = { size = [0.4, 0.02] }\ntranslate = [0.4, 0]\n";
const CLAMPED: &str = "[[body.solid.support]]\nwhere = { x_max = 0.2 }\nfix = [\"x\", \"y\"]\n";
const STEEL: &str = "[body.solid.material]\ndensity = \"7800 kg/m3\"\nyoung = \"210 GPa\"\npoisson = 0.3\n";
const TAIL: &str = "[[body]]\nname = \"horizontal-tail\"\nwing = { naca = \"0008\", span = 5.2, chord = 1.2 }\ntranslate = [15, 0, 0]\n\
                    [cloud]\nspacing = 0.3\nfar_field = 20.0\nedge_levels = 0\ncurvature_levels = 0\n";
/// A cloud around a wing that is made quickly.
const COARSE: &str = "[cloud]\nspacing = 0.5\nfar_field = 30.0\nedge_levels = 0\ncurvature_levels = 0\n";

/// What a fragment takes for granted, by a word that only it has; the first that fits.
fn completed(block: &str) -> String {
    let has = |words: &str| block.contains(words);
    let whole = has("[flow]\n") && has("[[body]]");
    let rest: &[&str] = if whole && has("wing = {") && !has("[cloud]") {
        &[COARSE]
    } else if whole {
        &[]
    } else if has("[[hinge]]") {
        &[STREAM, TAIL]
    } else if has("wing = {") {
        &[STREAM, COARSE]
    } else if has("design_speed") {
        &["mach = [0.5]\n", AIR, SECTION, SPRINGS]
    } else if has("[lco]") {
        &["[flutter]\nmach = [0.5]\n", AIR, SECTION, SPRINGS]
    } else if has("[[gaf.mode]]") {
        &[STREAM, SECTION, "[gaf]\nreduced_frequencies = [0.1]\npivot = [0.25, 0]\n"]
    } else if has("[gaf]") {
        &[STREAM, SECTION]
    } else if has("error = \"all\"") {
        &[STREAM, SECTION, PITCH, MARCH]
    } else if has("own_modes") {
        &[AIR, "[[body]]\nnaca = \"0012\"\n[body.solid]\nthrough = 5\n", CLAMPED, STEEL, CLOUD]
    } else if has("[body.solid.material]") {
        return format!("{BEAM}{block}{CLAMPED}[time.modes]\nnumber = 2\n");
    } else if has("[body.solid]") {
        let (solid, time) = block.split_once("[time").unwrap();
        return format!("{BEAM}{solid}{CLAMPED}{STEEL}[time{time}");
    } else if has("reynolds") {
        &["[[body]]\nnaca = \"0012\"\n"]
    } else if has("[cloud.wall_layers]") {
        &["[flow]\nmach = 0.5\nreynolds = 5000\n[[body]]\nnaca = \"0012\"\n"]
    } else if has("[motion]") && has("[[body]]") {
        &[STREAM, CLOUD, MARCH]
    } else if has("[motion]") {
        &[STREAM, SECTION, MARCH]
    } else if has("[time") {
        &[STREAM, SECTION, PITCH]
    } else {
        &[]
    };
    format!("{block}{}", rest.concat())
}

/// Blocks of the kind `language` in a page, with the line each begins at.
fn blocks(page: &str, language: &str) -> Vec<(usize, String)> {
    let (mut found, mut inside) = (Vec::new(), None::<(usize, String)>);
    for (k, line) in page.lines().enumerate() {
        let fence = line.starts_with("```");
        if let Some((_, text)) = &mut inside {
            if fence {
                found.extend(inside.take());
            } else {
                *text += &format!("{line}\n");
            }
        } else if fence {
            // of another kind: up to its end
            let first = if line == format!("```{language}") { k + 2 } else { 0 };
            inside = Some((first, String::new()));
        }
    }
    found.retain(|(line, _)| *line > 0);
    found
}

/// Root of the repository.
fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).parent().unwrap().to_path_buf()
}

/// Markdown files of README and book.
fn pages() -> Vec<PathBuf> {
    let mut found = vec![root().join("README.md")];
    let mut folders = vec![root().join("book")];
    while let Some(folder) = folders.pop() {
        for entry in std::fs::read_dir(folder).unwrap().map(|e| e.unwrap().path()) {
            if entry.is_dir() {
                folders.push(entry);
            } else if entry.extension().is_some_and(|e| e == "md") {
                found.push(entry);
            }
        }
    }
    found.sort();
    found
}

#[test]
fn examples_of_the_book_are_cases() {
    let folder = tempfile::tempdir().unwrap();
    let mut wrong = Vec::new();
    let mut n = 0;
    for page in pages() {
        let text = std::fs::read_to_string(&page).unwrap();
        // the shape of a mode stands on its page
        for (_, table) in blocks(&text, "text").into_iter().filter(|(_, t)| t.contains("x,y,dx,dy")) {
            std::fs::write(folder.path().join("bending.csv"), table).unwrap();
        }
        for (line, block) in blocks(&text, "toml") {
            n += 1;
            if block.contains("torsion.csv") {
                // the template writes the shapes of its modes beside itself
                alula(folder.path(), &["new", "flutter-wing", "--force"].map(String::from));
            }
            std::fs::write(folder.path().join("case.toml"), completed(&block)).unwrap();
            let checked = Command::new(env!("CARGO_BIN_EXE_alula"))
                .args(["check", "case.toml"])
                .current_dir(folder.path())
                .output()
                .unwrap();
            if checked.status.code() != Some(0) {
                wrong.push(format!("{}:{line}\n{}", page.display(), String::from_utf8_lossy(&checked.stderr)));
            }
        }
    }
    assert!(n > 20 && wrong.is_empty(), "{n} examples, of them wrong:\n{}", wrong.join("\n"));
}

/// Page with the `--help` of all commands, between two marks.
const HELP_PAGE: &str = "book/reference/commands.md";
const HELP_BEGIN: &str =
    "<!-- help: begin, written by the tests: ALULA_WRITE=1 cargo test -p alula-cli --test command book -->\n";
const HELP_END: &str = "<!-- help: end -->";
/// Commands whose help is on the page, in its order.
const COMMANDS: [&str; 13] = [
    "run",
    "new",
    "check",
    "cloud",
    "geometry",
    "resume",
    "flutter",
    "gaf",
    "compare",
    "report",
    "verify",
    "schema",
    "completions",
];

/// Output of `alula` with the arguments, in the folder.
fn alula(folder: &Path, arguments: &[String]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_alula")).args(arguments).current_dir(folder).output().unwrap()
}

/// What `alula COMMAND --help` prints.
fn help(command: &str) -> String {
    let output = alula(Path::new("."), &[command.to_string(), "--help".into()]);
    assert!(output.status.success(), "`alula {command} --help`");
    String::from_utf8(output.stdout).unwrap()
}

#[test]
fn page_of_the_commands_is_what_they_print() {
    let path = root().join(HELP_PAGE);
    let text = std::fs::read_to_string(&path).unwrap();
    let (before, rest) = text.split_once(HELP_BEGIN).unwrap();
    let (_, after) = rest.split_once(HELP_END).unwrap();
    let mut wanted = format!("{before}{HELP_BEGIN}");
    for command in COMMANDS {
        let lines: Vec<String> = help(command).lines().map(|l| l.trim_end().to_string()).collect();
        write!(wanted, "\n## alula {command}\n\n```text\n{}\n```\n", lines.join("\n").trim_end()).unwrap();
    }
    write!(wanted, "\n{HELP_END}{after}").unwrap();
    if std::env::var_os("ALULA_WRITE").is_some() {
        std::fs::write(&path, &wanted).unwrap();
    }
    let hint = "bring it up to date: ALULA_WRITE=1 cargo test -p alula-cli --test command book";
    assert!(std::fs::read_to_string(&path).unwrap() == wanted, "{HELP_PAGE} differs from `--help`; {hint}");
    let all = String::from_utf8(alula(Path::new("."), &["--help".into()]).stdout).unwrap();
    let named = all.lines().filter(|l| l.starts_with("  ") && !l.starts_with("  -")).map(|l| l.trim_start());
    let listed = named.filter(|l| COMMANDS.iter().any(|c| l.split_whitespace().next() == Some(c))).count();
    assert_eq!(listed, COMMANDS.len(), "{all}");
}

/// Arguments of the command lines of `alula` in a page, with the line of each: those of blocks `sh`, and those in `code`, of which
/// fragments without arguments are whole.
fn command_lines(page: &str) -> Vec<(usize, Vec<String>)> {
    let mut found = Vec::new();
    for (first, block) in blocks(page, "sh") {
        found.extend(block.lines().enumerate().map(|(k, line)| (first + k, line.to_string())));
    }
    let mut inside = false;
    for (k, line) in page.lines().enumerate() {
        inside ^= line.starts_with("```");
        if !inside {
            found.extend(line.split('`').skip(1).step_by(2).map(|code| (k + 1, code.to_string())));
        }
    }
    found.into_iter().filter_map(|(line, text)| Some((line, arguments(&text)?))).collect()
}

/// Arguments of `alula` in a line of a shell, without remarks, redirections and dots; none where the line calls another program.
fn arguments(line: &str) -> Option<Vec<String>> {
    let line = line.split(" #").next()?;
    let line = line.split([';', '|', '>', '&']).next()?.trim();
    let rest = line.strip_prefix("alula ").or_else(|| {
        let (cargo, rest) = line.split_once(" -- ")?;
        (cargo.starts_with("cargo run") && !cargo.contains("--example")).then_some(rest)
    })?;
    let words = rest.split_whitespace().filter(|w| !["…", "..."].contains(w));
    Some(words.map(|w| w.trim_matches(['[', ']', '"', '\'']).to_string()).collect())
}

/// What is wrong with a command line: an unknown command or flag, a missing or a superfluous argument. The command runs in an empty
/// folder, in which it finds no case.
fn mistake(arguments: &[String]) -> Option<String> {
    let (command, rest) = arguments.split_first()?;
    if !COMMANDS.contains(&command.as_str()) {
        return (!["--version", "--help"].contains(&command.as_str())).then(|| format!("no command `{command}`"));
    }
    let printed = help(command);
    let flags = printed.split([' ', ',', '\n']).collect::<Vec<_>>();
    let unknown = rest.iter().find(|w| w.starts_with('-') && w.len() > 1 && !flags.contains(&w.as_str()));
    if let Some(flag) = unknown {
        return Some(format!("no flag `{flag}`"));
    }
    if rest.iter().all(|w| w.starts_with('-')) {
        return None;
    }
    let words = |w: &String| match w.as_str() {
        "SHELL" => "bash".to_string(),
        "TEMPLATE" => "airfoil".into(),
        "N" => "2".into(),
        _ => w.clone(),
    };
    let lost =
        rest.iter().find(|w| ["cases/", "verification/"].iter().any(|f| w.starts_with(f)) && !root().join(w).exists());
    if let Some(path) = lost {
        return Some(format!("no file `{path}`"));
    }
    let folder = tempfile::tempdir().unwrap();
    let output = alula(folder.path(), &arguments.iter().map(words).collect::<Vec<_>>());
    let told = String::from_utf8_lossy(&output.stderr).into_owned();
    told.contains("try '--help'").then_some(told)
}

#[test]
fn commands_of_the_book_are_accepted() {
    let mut wrong = Vec::new();
    let mut n = 0;
    let mut papers = pages();
    papers.extend(["ARCHITECTURE.md", "python/README.md", "verification/README.md"].map(|p| root().join(p)));
    for page in papers {
        for (line, arguments) in command_lines(&std::fs::read_to_string(&page).unwrap()) {
            n += 1;
            if let Some(why) = mistake(&arguments) {
                wrong.push(format!("{}:{line}: alula {}: {why}", page.display(), arguments.join(" ")));
            }
        }
    }
    assert!(n > 60 && wrong.is_empty(), "{n} commands, of them wrong:\n{}", wrong.join("\n"));
}

#[test]
fn mistakes_of_commands_are_seen() {
    let line = |text: &str| mistake(&arguments(text).unwrap());
    let right = [
        "alula run case.toml --out o  # there",
        "cargo run --release -- check a.toml",
        "alula verify",
        "alula completions SHELL",
    ];
    assert!(right.iter().all(|text| line(text).is_none()));
    let wrong = [
        "alula fly",
        "alula run a.toml --fast",
        "alula run a b",
        "alula new wing",
        "cargo run -- check cases/none.toml",
    ];
    assert!(wrong.iter().all(|text| line(text).is_some()));
    assert!(arguments("cargo run --release -p alula --example polar").is_none() && arguments("paraview a").is_none());
}

#[test]
fn programs_and_pictures_of_the_book_are_there() {
    let mut wrong = Vec::new();
    for page in pages() {
        let text = std::fs::read_to_string(&page).unwrap();
        let include = |block: &str| block.trim_start().starts_with("{{#include ../../examples/");
        let programs = ["rust", "rust,ignore"].into_iter().flat_map(|language| blocks(&text, language));
        let loose = programs.filter(|(_, block)| !include(block));
        wrong.extend(
            loose.map(|(line, _)| format!("{}:{line}: Rust that is no program of `examples/`", page.display())),
        );
        let pictures = text.split("src=\"").skip(1).filter_map(|rest| rest.split('"').next());
        let lost = pictures.filter(|p| !page.parent().unwrap().join(p).is_file());
        wrong.extend(lost.map(|p| format!("{}: no picture `{p}`", page.display())));
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}
