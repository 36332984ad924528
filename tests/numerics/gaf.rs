//! Generalised forces of small motions: against harmonic balance, rigid and flexible modes together, and what cases may say of them.
use std::path::Path;

use alula::case::{self, GafMethod};
use alula::run::gaf::{Matrices, gaf};
use alula::run::{Places, Silent};

const SECTION: &str = "title = \"section\"\n[flow]\nmach = 0.5\nalpha = \"1 deg\"\n[[body]]\nnaca = \"0012\"\n[cloud]\n\
                       spacing = 0.03125\nfar_field = 20.0\n";

fn matrices(folder: &Path, name: &str, table: &str) -> Matrices {
    let case = case::read(&format!("{SECTION}{table}"), name).unwrap_or_else(|e| panic!("{e}"));
    let places = Places { input: folder.into(), out: folder.join(name) };
    gaf(&case, &places, &mut Silent).unwrap_or_else(|e| panic!("{e}")).unwrap()
}

fn apart(a: [f64; 2], b: [f64; 2]) -> f64 {
    (a[0] - b[0]).hypot(a[1] - b[1])
}

fn size(a: [f64; 2]) -> f64 {
    a[0].hypot(a[1])
}

#[test]
fn forces_of_small_motions_are_those_of_a_harmonic_balance() {
    let folder = tempfile::tempdir().unwrap();
    let swing = "[gaf]\nreduced_frequencies = 0.2\npivot = [0.3, 0.01]\nmodes = \"pitch\"\n";
    let linear = matrices(folder.path(), "linear", swing);
    let balance = matrices(folder.path(), "balance", &format!("{swing}pitch = \"0.02 deg\"\n"));
    let ([a], [b]) = (&linear.columns[..], &balance.columns[..]) else { panic!("{linear:?} {balance:?}") };
    assert!(a.converged && b.converged && a.nonlinearity.is_none() && b.solved.is_none(), "{a:?} {b:?}");
    for (found, other) in [(a.cl, b.cl), (a.cm, b.cm), (a.q[0], b.q[0])] {
        assert!(apart(found, other) < 1e-3 * size(other), "{found:?} {other:?}");
    }
    assert!(apart(a.q[0], a.cm) < 1e-9 * size(a.cm), "{a:?}");
    // bars of both methods are those of one cloud
    let (of_a, of_b) = (a.errors.as_ref().unwrap(), b.errors.as_ref().unwrap());
    assert!(
        (of_a.cl_error / of_b.cl_error - 1.0).abs() < 0.1 && of_a.cl_error < 0.05 * size(a.cl),
        "{of_a:?} {of_b:?}"
    );
    let bare = matrices(folder.path(), "bare", &format!("{swing}cloud_error = false\n"));
    assert!(bare.columns[0].errors.is_none() && bare.columns[0].cl == a.cl, "{bare:?}");
}

#[test]
fn rigid_and_flexible_modes_stand_in_one_matrix() {
    let folder = tempfile::tempdir().unwrap();
    let rows = |f: &dyn Fn(f64, f64) -> [f64; 2]| {
        let points = [-0.06, 0.06].into_iter().flat_map(|y| [0.0, 0.5, 1.0].map(|x| (x, y)));
        let row = |(x, y): (f64, f64)| format!("{x},{y},{},{}\n", f(x, y)[0], f(x, y)[1]);
        format!("x,y,dx,dy\n{}", points.map(row).collect::<String>())
    };
    let put = |name: &str, text: String| std::fs::write(folder.path().join(name), text).unwrap();
    put("heave.csv", rows(&|_, _| [0.0, 0.5]));
    put("turn.csv", rows(&|x, y| [y, 0.25 - x]));
    let table = "[gaf]\nreduced_frequencies = [0, 0.2]\npivot = [0.25, 0]\n[[gaf.mode]]\nname = \"heave\"\nfile = \"heave.csv\"\n\
                 [[gaf.mode]]\nname = \"turn\"\nfile = \"turn.csv\"\n";
    let all = matrices(folder.path(), "all", table);
    assert_eq!((all.modes.len(), all.columns.len()), (4, 8));
    for at in all.columns.chunks(4) {
        let [plunge, pitch, heave, turn] = at else { panic!("{at:?}") };
        assert!(at.iter().all(|c| c.converged && c.solved.is_some_and(|s| s.left < 1e-3)), "{at:?}");
        // half a chord up is the plunge of its coordinate
        let largest = size(pitch.q[0]);
        for i in 0..4 {
            assert!(apart(plunge.q[i], heave.q[i]) < 1e-3 * largest, "{i} {plunge:?} {heave:?}");
        }
        assert!(apart(plunge.cl, heave.cl) < 1e-3 * size(pitch.cl) && apart(pitch.cl, turn.cl) < 1e-3 * size(pitch.cl));
        // a field of displacements does not turn the forces of the steady flow: rows of lift and plunge are those of pitch all the same
        assert!(apart(pitch.q[0], turn.q[0]) < 1e-3 * largest && apart(pitch.cm, pitch.q[1]) < 1e-9, "{pitch:?}");
    }
    // steady lift by a small turn is the slope of the lift curve: 2π over √(1 − M²), and thickness
    let slope = all.columns[1].cl;
    assert!((6.5..8.5).contains(&slope[0]) && slope[1].abs() < 1e-6, "{slope:?}");
    let text = std::fs::read_to_string(folder.path().join("all/gaf.csv")).unwrap();
    assert!(text.lines().next().is_some_and(|l| l.contains("q_turn_im,iterations,left,cl_error,")), "{text}");
}

#[test]
fn the_method_follows_from_the_keys_and_contradicts_none() {
    let table = |keys: &str| format!("{SECTION}[gaf]\nreduced_frequencies = [0.1]\npivot = [0.25, 0]\n{keys}");
    let method = |keys: &str| case::read(&table(keys), "case").unwrap_or_else(|e| panic!("{e}")).gaf.unwrap().method;
    assert_eq!(method(""), GafMethod::Linear);
    for key in ["pitch = \"0.1 deg\"", "plunge = 0.01", "harmonics = 2", "linearity = 0.01", "method = \"balance\""] {
        assert_eq!(method(key), GafMethod::Balance, "{key}");
    }
    let told = |keys: &str| case::read(&table(keys), "case").unwrap_err().to_string();
    let mode = "[[gaf.mode]]\nname = \"bend\"\nfile = \"bend.csv\"\n";
    let all = told(&format!("method = \"linear\"\npitch = \"0.1 deg\"\nharmonics = 2\n{mode}amplitude = 0.1\n"));
    for key in ["`pitch` of `[gaf]`", "`harmonics` of `[gaf]`", "`amplitude` of `[gaf]`"] {
        assert!(all.contains(key), "{all}");
    }
    assert!(told(&format!("method = \"balance\"\n{mode}")).contains("has no `amplitude`"));
    let still = table("harmonics = 1").replace("[0.1]", "[0, 0.1]");
    assert!(case::read(&still, "case").unwrap_err().to_string().contains("no period at a reduced frequency of 0"));
    // a case that was written means the same when it is read again
    let read = |text: &str| case::read(text, "case").unwrap_or_else(|e| panic!("{e}"));
    for keys in ["", "pitch = \"0.1 deg\"\n"] {
        let once = read(&table(keys));
        assert_eq!(read(&case::write(&once)), once, "{keys}");
    }
}
