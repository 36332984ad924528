//! What is left to the design speed: at constant Mach number an aircraft must be free of flutter and divergence up to 1.15 V_D in equivalent
//! airspeed (EASA CS-25 and 14 CFR 25.629 (b)(1)).
//!
//! Crossings alone do not tell it: a motion may grow from the lowest speed on that is looked at. So every motion below that speed is looked at too.
use super::damping::LEAST;
use super::scales::Scales;
use crate::record::flutter::{Clearance, FlutterAt, MotionRow};

/// Equivalent airspeed that must be free, over the design speed.
const REQUIRED: f64 = 1.15;
/// Part by which a frequency may be above those that forces are known at: digits of files.
const SAME: f64 = 5e-4;

/// Tells margins of `at` against the design speed `design`, an equivalent airspeed in m/s, looked at up to `upto`.
pub(super) fn tell(at: &mut FlutterAt, design: f64, (scales, upto): (&Scales, f64)) {
    for c in &mut at.crossings {
        c.margin = c.equivalent_airspeed.map(|v| v / design - 1.0);
    }
    let begins = at.crossings.iter().filter(|c| c.kind != "restabilised");
    let lowest = begins.filter_map(|c| Some((c.equivalent_airspeed?, c))).min_by(|a, b| a.0.total_cmp(&b.0));
    let (required, looked) = (REQUIRED * design, scales.numbers(upto).equivalent_airspeed.unwrap_or(0.0));
    let doubt = at.doubts.iter().filter(|d| d.kind != "gap");
    let doubt = doubt.filter_map(|d| Some((d.equivalent_airspeed?.into_iter().reduce(f64::min)?, d)));
    let doubt = doubt.min_by(|a, b| a.0.total_cmp(&b.0)).filter(|d| d.0 < required);
    let (found, bar) = (lowest.map(|l| l.0), lowest.and_then(|l| l.1.bars.equivalent_airspeed_error));
    let name = lowest.map_or(String::new(), |l| format!("{} of {}", l.1.kind, l.1.branch));
    // what grows below all that is told to begin has grown from the start
    let growing = grows_below(at, required).filter(|(v, _)| found.is_none_or(|found| *v < found));
    let (passes, reason) = match (found, doubt, growing) {
        (_, _, Some((v, m))) => (false, format!("{} grows at {v:.1} m/s (g {:+.4})", m.branch, m.damping)),
        (Some(v), _, _) if v < required => (false, format!("{name} begins at {v:.1} m/s")),
        (Some(v), _, _) if !bar.is_some_and(|bar| v - bar >= required) => {
            let bar = bar.map_or("an unknown error bar".to_owned(), |bar| format!("an error bar of ± {bar:.1} m/s"));
            (false, format!("{name} begins at {v:.1} m/s with {bar}"))
        }
        (_, Some((v, d)), _) => (false, format!("{} may begin to grow at {v:.1} m/s: the cloud decides", d.branch)),
        _ if !at.growing_from_start.is_empty() => {
            (false, format!("{} grows from the lowest speed on", at.growing_from_start.join(", ")))
        }
        (None, _, _) if looked < required => {
            (false, format!("nothing begins to grow, but only {looked:.1} m/s were looked at: raise `most`"))
        }
        (None, _, _) => (true, format!("nothing begins to grow up to {looked:.1} m/s")),
        (Some(v), _, _) => (true, format!("{name} begins at {v:.1} m/s")),
    };
    let (lowest, bar) = growing.map_or((found, bar), |(v, _)| (Some(v), None));
    let margin = lowest.map(|v| v / design - 1.0);
    at.clearance =
        Some(Clearance { design_speed: design, required, lowest, lowest_error: bar, margin, passes, reason });
}

/// The motion that grows at the lowest equivalent airspeed below `required`, by more than structures hold anyway and by forces that are known.
fn grows_below(at: &FlutterAt, required: f64) -> Option<(f64, &MotionRow)> {
    let known = at.reduced_frequencies.last().map_or(0.0, |k| k * (1.0 + SAME));
    let grows = at.motions.iter().filter(|m| m.damping > LEAST && m.reduced_frequency <= known);
    let placed = grows.filter_map(|m| Some((m.equivalent_airspeed?, m)));
    placed.filter(|(v, _)| *v < required).min_by(|a, b| a.0.total_cmp(&b.0))
}

#[cfg(test)]
mod tests {
    use super::super::held::problem_of;
    use super::*;
    use crate::case::Matching;
    use crate::record::flutter::{Bars, Doubt, FlutterRow};

    fn scales() -> Scales {
        let text = "[flow]\nmach = 0.5\npressure = \"101325 Pa\"\ntemperature = \"288.15 K\"\n[[body]]\nnaca = \"0012\"\n\
                    [structure]\nmass = \"10 kg/m\"\nelastic_axis = -0.4\nr_alpha2 = 0.25\nx_alpha = 0.2\n\
                    frequency = { plunge = \"5 Hz\", pitch = \"10 Hz\" }\n[flutter]\n";
        Scales::of(problem_of(text).about_steady_flow(0.5).unwrap().case(), 1.0, Matching::None)
    }

    fn told(speeds: &[(f64, f64)], doubt: Option<f64>) -> (FlutterAt, Clearance) {
        let row = |(speed, error): &(f64, f64)| FlutterRow {
            kind: "flutter".into(),
            branch: "mode 1".into(),
            equivalent_airspeed: Some(*speed),
            bars: Bars { equivalent_airspeed_error: Some(*error), ..Bars::default() },
            ..FlutterRow::default()
        };
        let doubts = doubt.map(|v| Doubt {
            kind: "nearly".into(),
            equivalent_airspeed: Some([v, v + 10.0]),
            ..Doubt::default()
        });
        let (crossings, doubts) = (speeds.iter().map(row).collect(), doubts.into_iter().collect());
        let mut at = FlutterAt { crossings, doubts, ..FlutterAt::default() };
        tell(&mut at, 100.0, (&scales(), 1.0));
        let found = at.clearance.clone().unwrap();
        (at, found)
    }

    #[test]
    fn what_grows_below_without_a_crossing_does_not_pass() {
        let motion = |speed: f64, damping: f64, reduced_frequency: f64| MotionRow {
            branch: "mode 1".into(),
            mode: Some(1),
            speed_ratio: 1.0,
            speed,
            equivalent_airspeed: Some(speed),
            dynamic_pressure: speed * speed,
            density: 1.0,
            altitude: None,
            reduced_frequency,
            damping,
            frequency: 1.0,
            eigenvalue: [damping, 1.0],
        };
        let of = |motions: Vec<MotionRow>, crossings: &[(f64, f64)]| {
            let mut at = FlutterAt { motions, reduced_frequencies: vec![0.0, 0.5], ..told(crossings, None).0 };
            tell(&mut at, 100.0, (&scales(), 1.0));
            at.clearance.unwrap()
        };
        let found = of(vec![motion(60.0, 0.0004, 0.1), motion(80.0, 0.02, 0.1)], &[(130.0, 1.0)]);
        assert!(
            !found.passes && found.lowest == Some(80.0) && found.reason.contains("mode 1 grows at 80.0"),
            "{found:?}"
        );
        assert!((found.margin.unwrap() + 0.2).abs() < 1e-12 && found.lowest_error.is_none());
        assert!(!of(vec![motion(80.0, 0.02, 0.1)], &[]).passes);
        // above what is required, by forces that are guessed, by no more than structures hold, or beyond its crossing
        assert!(of(vec![motion(120.0, 0.02, 0.1)], &[]).passes);
        assert!(of(vec![motion(80.0, 0.02, 0.8)], &[]).passes);
        assert!(of(vec![motion(80.0, 0.0005, 0.1)], &[]).passes);
        let beyond = of(vec![motion(80.0, 0.02, 0.1)], &[(70.0, 1.0)]);
        assert!(beyond.reason.contains("begins at 70.0") && beyond.lowest == Some(70.0), "{beyond:?}");
    }

    #[test]
    fn fifteen_per_cent_are_to_be_clear_error_bar_and_all() {
        let (at, found) = told(&[(130.0, 2.0), (125.0, 5.0)], None);
        assert!(found.passes && (found.margin.unwrap() - 0.25).abs() < 1e-12 && (found.required - 115.0).abs() < 1e-12);
        assert!((at.crossings[0].margin.unwrap() - 0.3).abs() < 1e-12);
        assert!(!told(&[(114.0, 0.1)], None).1.passes);
        let near = told(&[(117.0, 3.0)], None).1;
        assert!(!near.passes && near.reason.contains("± 3.0 m/s"), "{near:?}");
        assert!(!told(&[(130.0, f64::NAN)], None).1.passes);
        let doubtful = told(&[(130.0, 2.0)], Some(90.0)).1;
        assert!(!doubtful.passes && doubtful.reason.contains("90.0"), "{doubtful:?}");
        // half the sound speed is looked at: 170 m/s
        assert!(told(&[], None).1.passes);
    }
}
