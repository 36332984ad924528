//! What is left to the design speed: at constant Mach number an aircraft must be free of flutter and divergence up to 1.15 V_D in equivalent
//! airspeed (EASA CS-25 and 14 CFR 25.629 (b)(1)).
use super::record::FlutterAt;
use super::rows::Clearance;
use super::scales::Scales;

/// Equivalent airspeed that must be free, over the design speed.
const REQUIRED: f64 = 1.15;

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
    let (passes, reason) = match (found, doubt) {
        (Some(v), _) if v < required => (false, format!("{name} begins at {v:.1} m/s")),
        (Some(v), _) if !bar.is_some_and(|bar| v - bar >= required) => {
            let bar = bar.map_or("an unknown error bar".to_owned(), |bar| format!("an error bar of ± {bar:.1} m/s"));
            (false, format!("{name} begins at {v:.1} m/s with {bar}"))
        }
        (_, Some((v, d))) => (false, format!("{} may begin to grow at {v:.1} m/s: the cloud decides", d.branch)),
        _ if !at.growing_from_start.is_empty() => {
            (false, format!("{} grows from the lowest speed on", at.growing_from_start.join(", ")))
        }
        (None, _) if looked < required => {
            (false, format!("nothing begins to grow, but only {looked:.1} m/s were looked at: raise `most`"))
        }
        (None, _) => (true, format!("nothing begins to grow up to {looked:.1} m/s")),
        (Some(v), _) => (true, format!("{name} begins at {v:.1} m/s")),
    };
    let margin = found.map(|v| v / design - 1.0);
    at.clearance =
        Some(Clearance { design_speed: design, required, lowest: found, lowest_error: bar, margin, passes, reason });
}

#[cfg(test)]
mod tests {
    use super::super::rows::{Bars, Doubt, FlutterRow};
    use super::*;
    use crate::case::Matching;

    fn told(speeds: &[(f64, f64)], doubt: Option<f64>) -> (FlutterAt, Clearance) {
        let text = "[flow]\nmach = 0.5\npressure = \"101325 Pa\"\ntemperature = \"288.15 K\"\n[[body]]\nnaca = \"0012\"\n\
                    [structure]\nmass = \"10 kg/m\"\nelastic_axis = -0.4\nr_alpha2 = 0.25\nx_alpha = 0.2\n\
                    frequency = { plunge = \"5 Hz\", pitch = \"10 Hz\" }\n[flutter]\n";
        let case = crate::case::read(text, "case.toml").unwrap_or_else(|e| panic!("{e}"));
        let scales = Scales::of(&case.flutter_case(0.5), 1.0, Matching::None);
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
        tell(&mut at, 100.0, (&scales, 1.0));
        let found = at.clearance.clone().unwrap();
        (at, found)
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
