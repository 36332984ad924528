//! Forces of small motions against harmonic balance with small amplitudes, and the boundary they give.
use alula::case;
use alula::run::{self, Places, Silent};

const SECTION: &str = "title = \"section\"\n[flow]\nmach = 0.6\nalpha = \"1 deg\"\n[[body]]\nnaca = \"0012\"\n[cloud]\n\
                       spacing = 0.03125\nfar_field = 20.0\n";

#[test]
fn forces_of_small_motions_are_those_of_harmonic_balance_and_give_a_boundary() {
    let folder = tempfile::tempdir().unwrap();
    let places = |name: &str| Places { input: folder.path().into(), out: folder.path().join(name) };
    let structure = "[structure]\nelastic_axis = -0.5\nmass_ratio = 100\nx_alpha = 0.25\nr_alpha2 = 0.25\n\
                     frequency_ratio = 0.2\nreduced_speed = 4.0\n[flutter]\nreduced_frequencies = [0.05, 0.1, 0.2]\n";
    let case = case::read(&format!("{SECTION}{structure}"), "flutter").unwrap_or_else(|e| panic!("{e}"));
    let boundary = run::flutter::flutter(&case, &places("flutter"), &mut Silent).unwrap().unwrap();
    let at = &boundary.flutter[0];
    // thin sections begin at 6.26 without and at 6.15 with compressibility at Mach 0.3
    let first = at.crossings.iter().find(|c| c.kind == "flutter").unwrap();
    let speed = first.reduced_speed.unwrap();
    assert!((4.5..6.5).contains(&speed) && first.error < 0.005, "{first:?}");

    let swing = "[gaf]\nreduced_frequencies = [0.1]\npivot = [0.25, 0]\nparticles = \"deforming\"\npitch = \"0.01 deg\"\nplunge = 1e-4\n";
    let case = case::read(&format!("{SECTION}{swing}"), "gaf").unwrap_or_else(|e| panic!("{e}"));
    let balance = run::gaf::gaf(&case, &places("gaf"), &mut Silent).unwrap().unwrap();
    let k = at.reduced_frequencies.iter().position(|k| (k - 0.1).abs() < 1e-9).unwrap();
    // dynamic pressure; plunge is counted in half chords there
    let q = 0.5 * 0.6 * 0.6;
    for (j, column) in balance.columns.iter().enumerate() {
        let unit = if j == 0 { 0.5 } else { 1.0 };
        for (i, load) in [column.cl, column.cm].into_iter().enumerate() {
            let found = at.forces[k][2 * i + j];
            let size = found[0].hypot(found[1]);
            for part in 0..2 {
                let other = q * load[part] / unit;
                assert!((found[part] - other).abs() < 2e-3 * size, "{i} {j}: {found:?}, {other}");
            }
        }
    }
}
