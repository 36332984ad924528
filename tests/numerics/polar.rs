//! Polars: what their points are, against single runs, and what becomes of points that fail.
use alula::case::read;
use alula::observe::checkpoint;
use alula::run::{Monitor, Outcome, Places, PolarPoint, Session, Silent, Summary, Tick, resume, run};
use serde_json::json;

const SECTION: &str =
    "[[body]]\nnaca = \"0012\"\n[cloud]\nspacing = 0.0625\nfar_field = 10\n[output]\nreport = false\n";

fn solved(flow: &str, more: &str) -> Summary {
    let case = read(&format!("[flow]\n{flow}\n{SECTION}{more}"), "polar.toml").unwrap_or_else(|e| panic!("{e}"));
    let mut session = Session::open(&case, ".").unwrap_or_else(|e| panic!("{e}"));
    session.solve(&mut Silent).unwrap_or_else(|e| panic!("{e}"));
    session.summary().cloned().unwrap_or_else(|| panic!("it is solved"))
}

/// The single run at a point finds the same flow as far as the residual goes.
fn assert_is_single(point: &PolarPoint, more: &str) {
    let single = solved(&format!("mach = {}\nalpha = \"{} deg\"", point.mach, point.alpha_deg), more);
    let (found, alone) = (point.loads.unwrap(), &single.loads);
    let apart =
        (found.cl - alone.total.cl).abs().max((found.cd - alone.total.cd).abs()).max((found.cm - alone.total.cm).abs());
    assert!(point.converged && apart < 2e-5, "{point:?}: {alone:?}");
    let momentum = (point.loads_momentum_balance.unwrap(), single.loads.momentum_balance.unwrap());
    assert!((momentum.0.cl - momentum.1.cl).abs() < 2e-5, "{momentum:?}");
    assert_eq!(point.particles, single.convergence.particles);
}

#[test]
fn points_are_what_single_runs_find_with_fewer_iterations() {
    for more in ["", "[accuracy]\nparticles = 100\n"] {
        // six orders leave the loads of two starts 2e-5 apart
        let further = format!("{more}[time.steady]\norders = 7\n");
        let polar = solved("mach = [0.4, 0.6]\nalpha = \"0:4:2 deg\"", &further);
        let at: Vec<[f64; 2]> = polar.polar.iter().map(|p| [p.mach, p.alpha_deg]).collect();
        assert_eq!(at, [[0.4, 0.0], [0.4, 2.0], [0.4, 4.0], [0.6, 0.0], [0.6, 2.0], [0.6, 4.0]]);
        assert!(polar.succeeded() && polar.polar[0].from_rest && polar.polar[1..].iter().all(|p| !p.from_rest));
        // on clouds as coarse as those of a family here a neighbour knows little
        let fewer = polar.polar[2].iterations < polar.polar[0].iterations;
        assert!(fewer || !more.is_empty(), "{:?}", polar.polar);
        assert_eq!(polar.polar[0].loads_error.is_some(), !more.is_empty());
        for k in [0, 2, 4] {
            assert_is_single(&polar.polar[k], &further);
        }
        assert_eq!(polar.loads.total, polar.polar[5].loads.unwrap());
    }
}

#[test]
fn points_are_adapted_one_by_one() {
    // what six orders leave of the residual shifts a shock by more than the loads may be apart
    let more = "[adapt]\ncycles = 1\n[time.steady]\norders = 8\n";
    let polar = solved("mach = [0.7, 0.8]\nalpha = \"1 deg\"", more);
    assert!(polar.polar[0].particles != polar.polar[1].particles, "{:?}", polar.polar);
    assert_is_single(&polar.polar[1], more);
}

#[test]
fn a_point_that_does_not_converge_is_told_and_the_polar_goes_on() {
    let polar = solved("mach = [0.5, 0.55]", "[time.steady]\niterations = 6\n");
    assert!(polar.polar.len() == 2 && !polar.succeeded());
    for point in &polar.polar {
        assert!(!point.converged && point.reason.contains("after all 6 iterations"), "{point:?}");
        assert!(point.loads.is_some() && point.from_rest, "{point:?}");
    }
}

/// Stops when a point is over and the next one has begun.
#[derive(Default)]
struct OnePoint {
    points: usize,
    ticks: usize,
}

impl Monitor for OnePoint {
    fn tick(&mut self, _: &Tick) {
        self.ticks += usize::from(self.points > 0);
    }
    fn note(&mut self, text: &str) {
        self.points += usize::from(text.starts_with("point 1 of"));
    }
    fn stop(&self) -> bool {
        self.ticks > 1
    }
}

#[test]
fn points_that_a_run_did_not_find_are_refused_however_good_the_checksum() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("out");
    let text = format!("[flow]\nmach = 0.5\nalpha = [0, 2]\n{SECTION}");
    let case = read(&text, "polar.toml").unwrap_or_else(|e| panic!("{e}"));
    let places = Places { input: folder.path().into(), out: out.clone() };
    let cut = run(&case, &places, &mut OnePoint::default()).unwrap_or_else(|e| panic!("{e}"));
    assert!(matches!(cut, Outcome::Interrupted { .. }));
    let file = out.join("checkpoint.alula");
    let whole = checkpoint::read(&file).unwrap();
    let forged = |change: &dyn Fn(&mut serde_json::Value)| {
        let mut other = whole.clone();
        change(&mut other.meta["saved"]["polar"]["points"][0]);
        assert!(other.meta != whole.meta);
        checkpoint::write(&file, &other).unwrap();
        resume(&out, &mut Silent).map(|_| ()).unwrap_err().to_string()
    };
    assert!(forged(&|point| point["loads"]["cl"] = json!(0.7)).contains("other loads than its last iteration"));
    assert!(forged(&|point| point["alpha_deg"] = json!(1.0)).contains("at other angles or Mach numbers"));
    assert!(forged(&|point| point["particles"] = json!(0)).contains("numbers that no point has"));
    assert!(forged(&|point| point["iterations"] = json!(1_000_000)).contains("more iterations than the run"));
    checkpoint::write(&file, &whole).unwrap();
    // a table that was changed by hand
    let history = out.join("history.csv");
    let table = std::fs::read_to_string(&history).unwrap();
    std::fs::write(&history, table.replacen("0,2,", "0,3,", 1)).unwrap();
    let refused = resume(&out, &mut Silent).map(|_| ()).unwrap_err().to_string();
    assert!(refused.contains("history.csv` was changed or removed"), "{refused}");
    std::fs::write(&history, table).unwrap();
    assert!(matches!(resume(&out, &mut Silent).unwrap_or_else(|e| panic!("{e}")), Outcome::Finished(_)));
    // so is the last line of a run that is finished
    let summary = out.join("summary.json");
    std::fs::write(&summary, std::fs::read_to_string(&summary).unwrap().replacen("0.5", "0.6", 1)).unwrap();
    assert!(resume(&out, &mut Silent).map(|_| ()).unwrap_err().to_string().contains("summary.json` was changed"));
}
