//! Loads with their error bars, from cases that leave the cloud to the program.
use std::cell::Cell;
use std::path::Path;

use alula::case::read;
use alula::observe::error_bars::{Bar, ErrorBars};
use alula::run::{self, Monitor, Outcome, Places, Session, Silent, Summary, Tick};

/// A NACA 0012 in a stream, without a cloud; at most 12,000 particles.
fn solved(mach: f64, alpha: f64) -> Summary {
    solved_with(mach, alpha, "")
}

/// The same with more tables.
fn solved_with(mach: f64, alpha: f64, more: &str) -> Summary {
    let body = "[[body]]\nnaca = \"0012\"\n[accuracy]\nparticles = 12000\n";
    let text = format!("[flow]\nmach = {mach}\nalpha = \"{alpha} deg\"\n{body}{more}");
    let case = read(&text, "section.toml").unwrap_or_else(|e| panic!("{e}"));
    let mut session = Session::open(&case, ".").unwrap_or_else(|e| panic!("{e}"));
    session.solve(&mut Silent).unwrap_or_else(|e| panic!("{e}"));
    session.summary().cloned().unwrap_or_else(|| panic!("it is solved"))
}

#[test]
fn exact_lift_lies_within_the_error_bar() {
    // the full potential equation in free air, exact to 1e-8, closed section of unit chord
    for (mach, alpha, exact) in [(0.5, 2.0, 0.28653976), (0.3, 4.0, 0.50954894)] {
        let s = solved(mach, alpha);
        let (bar, family) = (s.grid.loads_error.unwrap(), s.grid.grid_convergence.as_ref().unwrap());
        assert!(
            (s.loads.total.cl - exact).abs() < bar.cl,
            "Mach {mach}: {} ± {} for {exact}",
            s.loads.total.cl,
            bar.cl
        );
        assert!(bar.cl < 0.002 * exact && s.loads.total.cd.abs() < 1e-4, "Mach {mach}: {bar:?}, {:?}", s.loads);
        assert_eq!(family.clouds.len(), 3);
        assert!(family.clouds[2].particles <= 12_000);
        assert!(
            family.clouds.windows(2).all(|c| c[1].factor == 0.5 * c[0].factor && c[1].particles > 2 * c[0].particles)
        );
        let order = |load: &dyn Fn(usize) -> f64| 0.5 * (load(0) / load(2)).abs().log2();
        let lift = order(&|k| family.clouds[k].cl - exact);
        let drag = order(&|k| family.clouds[k].cd);
        assert!(lift > 1.8 && drag > 1.8, "Mach {mach}: order of the lift {lift}, of the drag {drag}");
        assert!(s.convergence.converged == Some(true));
    }
}

#[test]
fn bars_in_space_take_four_clouds_within_the_particles_allowed() {
    let text = "[flow]\nmach = 0.5\nalpha = \"4 deg\"\n[[body]]\nwing = { naca = \"0012\", span = 4, chord = 1 }\n\
                [boundary]\ny_min = \"symmetry\"\n[accuracy]\nparticles = 14000\n\
                [cloud]\nspacing = 0.4\nlayers = 3\nfar_field = 6.4\nedge_levels = 1\ncurvature_levels = 2\n";
    let case = read(text, "wing.toml").unwrap_or_else(|e| panic!("{e}"));
    let mut session = Session::open(&case, ".").unwrap_or_else(|e| panic!("{e}"));
    session.solve(&mut Silent).unwrap_or_else(|e| panic!("{e}"));
    let s = session.summary().unwrap();
    let (bar, family) = (s.grid.loads_error.unwrap(), s.grid.grid_convergence.as_ref().unwrap());
    assert_eq!(family.clouds.len(), 4);
    let finest = family.clouds[3];
    assert!(finest.particles <= 14_000, "{}", finest.particles);
    // Prandtl's lifting line: CL²/(π A) in an elliptic distribution
    let induced = s.loads.total.cl.powi(2) / (std::f64::consts::PI * 4.0);
    assert!((s.loads.total.cd - induced).abs() < bar.cd, "CD {} ± {} for {induced}", s.loads.total.cd, bar.cd);
    assert!(finest.spurious_drag.unwrap() > 0.5 * (s.loads.total.cd - induced), "{finest:?}");
}

#[test]
fn momentum_balances_where_the_zone_runs_along_a_bow_shock() {
    for mach in [3, 6] {
        let body = "[[body]]\ncircle = { radius = 0.5 }\n[cloud]\nspacing = 0.02\n";
        let case = read(&format!("[flow]\nmach = {mach}\n{body}"), "circle.toml").unwrap_or_else(|e| panic!("{e}"));
        let mut session = Session::open(&case, ".").unwrap_or_else(|e| panic!("{e}"));
        session.solve(&mut Silent).unwrap_or_else(|e| panic!("{e}"));
        let s = session.summary().unwrap();
        let through = s.loads.momentum_balance.unwrap();
        assert!(
            (through.cd / s.loads.total.cd - 1.0).abs() < 0.015,
            "Mach {mach}: {} and {}",
            s.loads.total.cd,
            through.cd
        );
        assert!(s.convergence.ledger.unwrap().mass.abs() < 0.01, "Mach {mach}: {:?}", s.convergence.ledger);
    }
}

#[test]
fn momentum_balances_where_sides_cut_the_zone() {
    let body = "[[body]]\nellipsoid = { size = [2, 0.8, 0.4] }\n";
    let cloud = "[cloud]\nspacing = 0.125\nedge_levels = 0\ncurvature_levels = 0\n";
    let domain = "[cloud.domain]\nmin = [-1.5, -0.75, -0.5]\nmax = [1.5, 0.75, 0.5]\n";
    let text = format!("[flow]\nmach = 0.5\nalpha = \"5 deg\"\n{body}{cloud}{domain}");
    let case = read(&text, "box.toml").unwrap_or_else(|e| panic!("{e}"));
    let mut session = Session::open(&case, ".").unwrap_or_else(|e| panic!("{e}"));
    session.solve(&mut Silent).unwrap_or_else(|e| panic!("{e}"));
    let s = session.summary().unwrap();
    let through = s.loads.momentum_balance.unwrap();
    assert!((through.cl / s.loads.total.cl - 1.0).abs() < 0.01, "{:?} and {through:?}", s.loads);
    assert!((through.cd / s.loads.total.cd - 1.0).abs() < 0.01, "{:?} and {through:?}", s.loads);
    assert!(s.convergence.ledger.unwrap().mass.abs() < 1e-4, "{:?}", s.convergence.ledger);
}

#[test]
fn a_symmetric_section_keeps_its_lift_of_zero() {
    let s = solved(0.8, 0.0);
    assert!(s.loads.total.cl.abs() < 1e-6 && s.grid.loads_error.unwrap().cl < 1e-5, "{:?}", s.loads);
}

#[test]
fn adapted_clouds_of_a_family_are_refined_at_the_shock_and_have_an_error_bar() {
    let [plain, adapted] = ["", "[adapt]\ncycles = 1\n"].map(|more| solved_with(0.8, 1.25, more));
    let [even, fine] = [&plain, &adapted].map(|s| s.grid.grid_convergence.clone().unwrap().clouds);
    assert!(fine[0].particles == even[0].particles && fine[2].particles > even[2].particles, "{fine:?}");
    let apart = (plain.loads.total.cl - adapted.loads.total.cl).abs();
    assert!(apart < plain.grid.loads_error.unwrap().cl + adapted.grid.loads_error.unwrap().cl, "{apart}");
}

/// Stops a run some iterations after a note that begins with these words.
struct StopsAfter {
    words: &'static str,
    left: Cell<Option<u32>>,
}

impl Monitor for StopsAfter {
    fn tick(&mut self, _: &Tick) {
        self.left.set(self.left.get().map(|n| n.saturating_sub(1)));
    }

    fn note(&mut self, text: &str) {
        if text.starts_with(self.words) {
            self.left.set(Some(3));
        }
    }

    fn stop(&self) -> bool {
        self.left.get() == Some(0)
    }
}

/// A section that pitches, at a size for tests.
fn pitching(time: &str, error: &str) -> alula::case::Case {
    let text = format!(
        "[flow]\nmach = 0.5\n[[body]]\nnaca = \"0012\"\n[cloud]\nspacing = 0.05\nedge_levels = 1\ncurvature_levels = 1\n\
         layers = 6\nfar_field = 6.4\n[motion]\nreduced_frequency = 0.4\npivot = [0.25, 0]\npitch = \"1 deg\"\n\
         [output]\nreport = false\n[accuracy]\nerror = \"{error}\"\n{time}\n"
    );
    read(&text, "pitching.toml").unwrap_or_else(|e| panic!("{e}"))
}

fn bars_in(out: &Path) -> ErrorBars {
    let text = std::fs::read_to_string(out.join("summary.json")).unwrap();
    let summary: serde_json::Value = serde_json::from_str(&text).unwrap();
    serde_json::from_value(summary["error_bars"].clone()).unwrap()
}

fn bar<'a>(found: &'a ErrorBars, of: &str, quantity: &str) -> &'a Bar {
    found
        .bars
        .iter()
        .find(|b| b.of == of && b.quantity == quantity)
        .unwrap_or_else(|| panic!("{quantity} of {of}: {found:?}"))
}

#[test]
fn a_balance_tells_its_errors_to_the_same_bits_after_a_stop() {
    let (folder, case) = (tempfile::tempdir().unwrap(), pitching("[time]\nharmonics = 2", "all"));
    let places = |name: &str| Places { input: ".".into(), out: folder.path().join(name) };
    run::run(&case, &places("whole"), &mut Silent).unwrap_or_else(|e| panic!("{e}"));
    let whole = bars_in(&places("whole").out);
    let lift = bar(&whole, "CL", "amplitude_1");
    assert!(lift.cloud.unwrap() > 0.0 && lift.harmonics.unwrap() > 0.0 && lift.step.is_none(), "{lift:?}");
    assert!(lift.half_width < 0.5 * lift.value && bar(&whole, "CL", "phase_1_deg").half_width < 30.0, "{lift:?}");
    // the clouds of a run in memory are the same
    let mut session = Session::open(&case, ".").unwrap_or_else(|e| panic!("{e}"));
    run::solve(&mut session, &mut Silent).unwrap_or_else(|e| panic!("{e}"));
    assert_eq!(session.summary().unwrap().error_bars.as_ref().unwrap().bars, whole.bars);
    for words in ["error bars: the same on a cloud", "error bars: the same with"] {
        let stopped = places(words);
        let mut monitor = StopsAfter { words, left: Cell::new(None) };
        let ended = run::run(&case, &stopped, &mut monitor).unwrap_or_else(|e| panic!("{e}"));
        assert!(matches!(ended, Outcome::Interrupted { .. }), "{ended:?}");
        assert!(!run::is_finished(&stopped.out));
        run::resume(&stopped.out, &mut Silent).unwrap_or_else(|e| panic!("{e}"));
        assert_eq!(bars_in(&stopped.out).bars, whole.bars);
    }
}

#[test]
fn a_march_tells_its_errors_where_it_is_periodic() {
    let solved = |periods: u32| {
        let time = format!("[time.dual]\nsteps_per_period = 32\nperiods = {periods}");
        let mut session = Session::open(&pitching(&time, "all"), ".").unwrap_or_else(|e| panic!("{e}"));
        run::solve(&mut session, &mut Silent).unwrap_or_else(|e| panic!("{e}"));
        session.summary().unwrap().error_bars.clone().unwrap()
    };
    let found = solved(3);
    let lift = bar(&found, "CL", "amplitude_1");
    assert!([lift.cloud, lift.step, lift.transient].iter().all(|part| part.unwrap() > 0.0), "{lift:?}");
    let all = [lift.cloud, lift.step, lift.transient].map(Option::unwrap);
    assert!((lift.half_width - all.iter().map(|p| p * p).sum::<f64>().sqrt()).abs() < 1e-12);
    // a single period confirms nothing
    let one = solved(1);
    assert!(one.bars.is_empty() && one.untold.unwrap().contains("march two or more"));
}
