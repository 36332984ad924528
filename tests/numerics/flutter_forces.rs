//! Forces of small motions against harmonic balance with small amplitudes, and the boundary they give.
use std::path::Path;

use alula::case;
use alula::math::eigenvalues::eigenvalues;
use alula::physics::atmosphere;
use alula::run::flutter::{Boundary, FlutterRow};
use alula::run::{self, Places, Silent};

const SECTION: &str = "title = \"section\"\n[flow]\nmach = 0.6\nalpha = \"1 deg\"\n[[body]]\nnaca = \"0012\"\n[cloud]\n\
                       spacing = 0.03125\nfar_field = 20.0\n";

#[test]
fn forces_of_small_motions_are_those_of_harmonic_balance_and_give_a_boundary() {
    let folder = tempfile::tempdir().unwrap();
    let places = |name: &str| Places { input: folder.path().into(), out: folder.path().join(name) };
    let structure = "[structure]\nelastic_axis = -0.5\nmass_ratio = 100\nx_alpha = 0.25\nr_alpha2 = 0.25\n\
                     frequency_ratio = 0.2\nreduced_speed = 4.0\n[flutter]\ncloud_error = false\nreduced_frequencies = [0.05, 0.1, 0.2]\n";
    let case = case::read(&format!("{SECTION}{structure}"), "flutter").unwrap_or_else(|e| panic!("{e}"));
    let boundary = run::flutter::flutter(&case, &places("flutter"), &mut Silent).unwrap().unwrap();
    let at = &boundary.flutter[0];
    // thin sections begin at 6.26 without and at 6.15 with compressibility at Mach 0.3
    let first = at.crossings.iter().find(|c| c.kind == "flutter").unwrap();
    let speed = first.reduced_speed.unwrap();
    assert!((4.5..6.5).contains(&speed) && first.error < 0.005, "{first:?}");

    assert!(first.g_method.is_some_and(|g| g.abs() < 1e-6), "{first:?}");
    stored_forces_serve_again(folder.path(), structure, first);

    let swing = "[gaf]\nreduced_frequencies = [0.1]\npivot = [0.25, 0]\nparticles = \"deforming\"\npitch = \"0.01 deg\"\nplunge = 1e-4\n";
    let case = case::read(&format!("{SECTION}{swing}"), "gaf").unwrap_or_else(|e| panic!("{e}"));
    let balance = run::gaf::gaf(&case, &places("gaf"), &mut Silent).unwrap().unwrap();
    let conditions = &balance.conditions;
    assert!(conditions.mach == 0.6 && (conditions.chord - 1.0).abs() < 1e-9 && conditions.pivot.is_some());
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

/// The boundary of another case from the forces of the first.
fn again(folder: &Path, name: &str, text: &str) -> Result<Boundary, String> {
    let case = case::read(text, name).unwrap_or_else(|e| panic!("{e}"));
    let places = Places { input: folder.into(), out: folder.join(name) };
    let found = run::flutter::again(&case, &places, &folder.join("flutter/flutter.json"), &mut Silent);
    found.map_err(|e| e.to_string()).map(|boundary| boundary.unwrap())
}

fn flutter_of(boundary: &Boundary) -> FlutterRow {
    boundary.flutter[0].crossings.iter().find(|c| c.kind == "flutter").unwrap().clone()
}

fn stored_forces_serve_again(folder: &Path, structure: &str, first: &FlutterRow) {
    let (speed, index) = (first.reduced_speed.unwrap(), first.speed_index.unwrap());
    let same = again(folder, "same", &format!("{SECTION}{structure}state_space = true\n")).unwrap();
    let found = flutter_of(&same);
    assert!((found.reduced_speed.unwrap() / speed - 1.0).abs() < 1e-9, "{found:?} {first:?}");
    assert!(same.flutter[0].read.is_some() && found.error < 0.05 && !found.extrapolated, "{same:?}");
    // the linear system has the neutral motion as an eigenvalue
    let system = same.flutter[0].state_space.clone().unwrap();
    let a: Vec<f64> = system.a.iter().flatten().copied().collect();
    let values = eigenvalues(&a, system.states.len()).unwrap();
    let omega = std::f64::consts::TAU * found.frequency;
    let nearest = values.iter().map(|z| (z.re).hypot(z.im - omega)).fold(f64::INFINITY, f64::min);
    assert!(nearest < 0.01 * omega && system.misfit < 0.01, "{nearest} {omega} {values:?}");
    assert!(folder.join("same/state-space-mach-0.600-a.csv").is_file());
    // at the speed found, the density found is that of the case
    let at_speed = structure.replace("reduced_speed = 4.0", &format!("reduced_speed = {speed}"));
    let tunnel = flutter_of(&again(folder, "tunnel", &format!("{SECTION}{at_speed}match = \"density\"\n")).unwrap());
    assert!((tunnel.density - 1.0).abs() < 1e-8 && (tunnel.mass_ratio.unwrap() - 100.0).abs() < 1e-6, "{tunnel:?}");
    assert!(tunnel.speed_ratio == 1.0 && (tunnel.speed_index.unwrap() / index - 1.0).abs() < 1e-8, "{tunnel:?}");
    in_the_atmosphere(folder);
    // what does not fit is told
    let refused =
        |name: &str, section: &str, structure: &str| again(folder, name, &format!("{section}{structure}")).unwrap_err();
    let elsewhere = structure.replace("elastic_axis = -0.5", "elastic_axis = -0.4");
    assert!(refused("axis", SECTION, &elsewhere).contains("another `plunge`"));
    assert!(refused("mach", &SECTION.replace("mach = 0.6", "mach = 0.5"), structure).contains("no forces at Mach 0.5"));
    let high = format!("{structure}match = \"altitude\"\n");
    assert!(refused("high", SECTION, &high).contains("a stream without units"));
}

/// The altitude of flutter is where a stream of that density and temperature makes it flutter at its own speed.
fn in_the_atmosphere(folder: &Path) {
    let wing = "[structure]\nelastic_axis = -0.5\nmass = \"60 kg/m\"\nx_alpha = 0.25\nr_alpha2 = 0.25\n\
                frequency = { plunge = \"2 Hz\", pitch = \"10 Hz\" }\n[flutter]\ncloud_error = false\nreduced_frequencies = [0.05, 0.1, 0.2]\n";
    let stream = |pressure: f64, temperature: f64| {
        let units = format!("[flow]\npressure = {pressure:e}\ntemperature = \"{temperature} K\"");
        SECTION.replace("[flow]", &units)
    };
    let sought = format!("{}{wing}match = \"altitude\"\n", stream(101_325.0, 288.15));
    let found = flutter_of(&again(folder, "altitude", &sought).unwrap());
    let air = atmosphere::at(found.altitude.unwrap()).unwrap();
    assert!((found.density / air.density - 1.0).abs() < 1e-3, "{found:?} {air:?}");
    assert!((found.speed / (0.6 * air.sound_speed) - 1.0).abs() < 1e-3, "{found:?} {air:?}");
    let there =
        flutter_of(&again(folder, "there", &format!("{}{wing}", stream(air.pressure, air.temperature))).unwrap());
    assert!(
        (there.speed_ratio - 1.0).abs() < 1e-3 && (there.frequency / found.frequency - 1.0).abs() < 1e-3,
        "{there:?}"
    );
}
