//! Polars: what their points are, against single runs, and what becomes of points that fail.
#![allow(clippy::unwrap_used, reason = "it may stop anywhere")]
use alula::case::read;
use alula::run::{PolarPoint, Session, Silent, Summary};

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
    let (found, alone) = (point.loads.unwrap(), single.loads);
    let apart = (found.cl - alone.cl).abs().max((found.cd - alone.cd).abs()).max((found.cm - alone.cm).abs());
    assert!(point.converged && apart < 2e-5, "{point:?}: {alone:?}");
    let momentum = (point.loads_momentum_balance.unwrap(), single.loads_momentum_balance.unwrap());
    assert!((momentum.0.cl - momentum.1.cl).abs() < 2e-5, "{momentum:?}");
    assert_eq!(point.particles, single.particles);
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
        assert_eq!(polar.loads, polar.polar[5].loads.unwrap());
    }
}

#[test]
fn points_are_adapted_one_by_one() {
    let more = "[adapt]\ncycles = 1\n";
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
