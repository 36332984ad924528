//! The examples of README and book are cases: `alula check` accepts every one, fragments with what they take for granted.
use std::path::{Path, PathBuf};
use std::process::Command;

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

/// What a fragment takes for granted, by a word that only it has; the first that fits.
fn completed(block: &str) -> String {
    let has = |words: &str| block.contains(words);
    let rest: &[&str] = if has("[[hinge]]") {
        &[STREAM, TAIL]
    } else if has("wing = {") {
        &[STREAM, "[cloud]\nspacing = 0.5\nfar_field = 30.0\nedge_levels = 0\ncurvature_levels = 0\n"]
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

/// Markdown files of README and book.
fn pages() -> Vec<PathBuf> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).parent().unwrap().to_path_buf();
    let mut found = vec![root.join("README.md")];
    let mut folders = vec![root.join("book")];
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
