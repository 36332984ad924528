//! Flutter about the static equilibrium of structure and gas.
use alula::case::{self, Case};
use alula::run::flutter::FlutterAt;
use alula::run::{self, Places, Session, Silent};

const SECTION: &str = "title = \"section\"\n[flow]\nmach = 0.5\nalpha = \"2 deg\"\n[[body]]\nnaca = \"0012\"\n[cloud]\n\
                       spacing = 0.1\nfar_field = 20.0\n";
const NUMBERS: &str =
    "[structure]\nelastic_axis = -0.2\nmass_ratio = 30.0\nx_alpha = 0.2\nr_alpha2 = 0.25\nfrequency_ratio = 0.4\n";

fn read(text: &str) -> Case {
    case::read(text, "trim").unwrap_or_else(|e| panic!("{e}"))
}

fn trimmed(case: &Case, name: &str) -> FlutterAt {
    let folder = tempfile::tempdir().unwrap();
    let places = Places { input: folder.path().into(), out: folder.path().join(name) };
    let found = run::flutter::flutter(case, &places, &mut Silent).unwrap().unwrap();
    found.flutter.into_iter().next().unwrap()
}

/// Pitch and plunge of the static equilibrium.
fn standing(case: &Case) -> Vec<f64> {
    let mut session = Session::open(case, std::path::Path::new(".")).unwrap();
    session.solve(&mut Silent).unwrap();
    let summary = session.summary().unwrap();
    let all = summary.structures.structure.iter().flat_map(|s| &s.coordinates);
    all.map(|c| c.mean.unwrap()).collect()
}

#[test]
fn forces_are_those_about_the_equilibrium_where_flutter_begins() {
    let case = read(&format!(
        "{SECTION}{NUMBERS}speed_index = 0.3\n[flutter]\ncloud_error = false\ntrim = true\nreduced_frequencies = [0.1, 0.3]\nfrequencies = 3\n"
    ));
    let at = trimmed(&case, "out");
    let (trim, first) = (at.trim.clone().unwrap(), &at.crossings[0]);
    assert!(trim.rounds > 1 && (first.speed_ratio / trim.speed_ratio - 1.0).abs() < 0.005, "{trim:?} {first:?}");
    // a steady run at that speed stands there
    let there = standing(&read(&format!("{SECTION}{NUMBERS}speed_index = {}\n", 0.3 * trim.speed_ratio)));
    for (found, other) in trim.coordinates.iter().zip(&there) {
        assert!((found - other).abs() < 2e-3 * other.abs(), "{trim:?} {there:?}");
    }
}
