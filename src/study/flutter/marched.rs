//! A limit cycle as a march finds it: the largest stable one, from where harmonic balance has it at the greatest amplitude.
//!
//! The march begins from the steady flow around the body in that place, so that the gas has to find its motion first; it goes on until the
//! amplitudes of two successive periods agree. What it ends with is told beside what the balance has.
use std::f64::consts::TAU;

use super::super::flow;
use super::super::monitor::Monitor;
use super::super::watch::Alike;
use crate::observe::structure::is_angle;
use crate::observe::swing::Swing;
use crate::problem::{March, Problem, RunError, StreamRatio};
use crate::record::flutter::{FlutterAt, LimitCycle, MarchedCycle, remedy};

/// Periods, at most.
const MOST: f64 = 30.0;

/// Marches the largest stable limit cycle of `at`; false when told to stop.
pub(super) fn march(problem: &Problem, at: &mut FlutterAt, monitor: &mut dyn Monitor) -> Result<bool, RunError> {
    let stable = at.cycles.iter().enumerate().filter(|(_, c)| c.stable);
    let Some(largest) = stable.max_by(|a, b| a.1.amplitude.total_cmp(&b.1.amplitude)).map(|(k, _)| k) else {
        at.warn(("no limit cycle is stable: there is none to march".into(), remedy::CYCLES));
        return Ok(true);
    };
    let cycle = &at.cycles[largest];
    let name = &cycle.coordinate;
    monitor.note(&format!(
        "a march from the limit cycle of amplitude {:.4} of {name} at {:.5} of the speed and {:.5} of the density of the case",
        cycle.amplitude,
        cycle.speed_ratio,
        cycle.density / at.reference.density
    ));
    let stream = StreamRatio {
        pressure: cycle.dynamic_pressure / at.reference.dynamic_pressure,
        temperature: cycle.speed_ratio * cycle.speed_ratio,
    };
    // at a speed x times that of the case times pass x times as fast
    let period = cycle.speed_ratio / cycle.frequency;
    let start = start(cycle, TAU / period);
    let march = March { mach: at.mach, stream, start: &start, borne: &at.borne, period, most: MOST };
    let summary = match flow::in_memory(&problem.march_of(&march)?, monitor) {
        Ok(Some(solution)) => solution.summary,
        Ok(None) => return Ok(false),
        Err(problem) => {
            let what = format!("the march from the limit cycle of amplitude {:.4} failed: {problem}", cycle.amplitude);
            at.warn((what, remedy::MARCH));
            return Ok(true);
        }
    };
    let place = summary.structures.structure.iter().flat_map(|s| &s.coordinates).position(|c| c.name == *name);
    let Some(swing) = place.and_then(|k| summary.structures.swings.get(k).copied().flatten()) else {
        let what = format!("{name} does not swing at the end of the march from its limit cycle");
        at.warn((what, remedy::CYCLES));
        return Ok(true);
    };
    let found = told(cycle, &swing, summary.convergence.time / period, summary.cost.cpu_seconds);
    doubts(&found, cycle.amplitude).into_iter().for_each(|what| at.warn((what, remedy::MARCH)));
    at.cycles[largest].march = Some(found);
    Ok(true)
}

/// Value and rate of every coordinate where the phase is zero; `omega` is the angular frequency in the time of the march.
fn start(cycle: &LimitCycle, omega: f64) -> Vec<[f64; 2]> {
    let of = |(j, mean): (usize, &f64)| {
        let terms = || cycle.motion.iter().enumerate().map(|(n, all)| ((n + 1) as f64, all[j]));
        let value = mean + terms().map(|(_, [re, _])| re).sum::<f64>();
        [value, terms().map(|(n, [_, im])| -n * omega * im).sum()]
    };
    cycle.means.iter().enumerate().map(of).collect()
}

fn told(cycle: &LimitCycle, swing: &Swing, periods: f64, cpu_seconds: f64) -> MarchedCycle {
    let unit = |q: f64| if is_angle(&cycle.coordinate) { q.to_degrees() } else { q };
    let amplitude = unit(swing.amplitude);
    MarchedCycle {
        amplitude,
        mean: unit(swing.mean),
        frequency: swing.frequency / TAU * cycle.speed_ratio,
        periods,
        difference: amplitude / cycle.amplitude - 1.0,
        change: swing.change,
        cpu_seconds,
    }
}

/// What makes the comparison doubtful.
fn doubts(found: &MarchedCycle, balanced: f64) -> Vec<String> {
    let mut all = Vec::new();
    if found.change >= Alike::CHANGE {
        let part = 100.0 * found.change;
        all.push(format!(
            "the march from the limit cycle of amplitude {balanced:.4} has not settled after {:.1} periods: its amplitude still changes by \
             {part:.2} % in one",
            found.periods
        ));
    }
    all
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;

    /// A limit cycle of two degrees of pitch.
    pub(crate) fn cycle() -> LimitCycle {
        LimitCycle {
            mach: 0.8,
            branch: 1,
            coordinate: "pitch".into(),
            amplitude: 2.0,
            speed_ratio: 1.2,
            speed_index: Some(0.72),
            reduced_speed: None,
            speed: 0.96,
            density: 1.0,
            dynamic_pressure: 0.4,
            altitude: None,
            reduced_frequency: 0.1,
            frequency: 0.03,
            stable: true,
            mean: 0.0,
            means: vec![0.01, 0.0],
            harmonics: 2,
            error: 0.001,
            balances: 5,
            motion: vec![vec![[-0.14, 0.03], [0.035, 0.0]], vec![[1e-3, 2e-3], [-1e-3, 5e-4]]],
            extrapolated: false,
            march: None,
        }
    }

    #[test]
    fn a_march_begins_where_the_motion_is_at_phase_zero() {
        let cycle = cycle();
        let omega = 0.5;
        let motion = |j: usize, t: f64| {
            let term = |(n, all): (usize, &Vec<[f64; 2]>)| {
                let (sine, cosine) = ((n + 1) as f64 * omega * t).sin_cos();
                all[j][0] * cosine - all[j][1] * sine
            };
            cycle.means[j] + cycle.motion.iter().enumerate().map(term).sum::<f64>()
        };
        for (j, [value, rate]) in start(&cycle, omega).into_iter().enumerate() {
            let slope = (motion(j, 1e-5) - motion(j, -1e-5)) / 2e-5;
            assert!((value - motion(j, 0.0)).abs() < 1e-14 && (rate - slope).abs() < 1e-9, "{value} {rate} {slope}");
        }
    }

    #[test]
    fn a_march_has_the_structure_of_the_speed_found() {
        use super::super::held::{Held, problem_of};
        const BODY: &str = "[[body]]\nnaca = \"0012\"\n[cloud]\nspacing = 0.1\n[flutter]\n[structure]\nelastic_axis = -0.4\nmass_ratio = 60\n\
                            x_alpha = 0.2\nr_alpha2 = 0.25\ndamping_ratio = { pitch = 0.02 }\nsprings = { pitch = { cubic = 40 } }\n";
        let ways = [
            ("[flow]\nmach = 0.5\n", "frequency_ratio = 0.5\nreduced_speed = 2\n"),
            ("[flow]\nmach = 0.5\n", "stiffness = { plunge = 2.0, pitch = 3.0 }\ndamping = { plunge = 0.3 }\n"),
            (
                "[flow]\nmach = 0.5\ntemperature = 300\npressure = 1e5\n",
                "frequency = { plunge = \"5 Hz\", pitch = \"9 Hz\" }\n",
            ),
        ];
        let faster = StreamRatio { pressure: 1.5 * 1.5, temperature: 1.5 * 1.5 };
        let denser = StreamRatio { pressure: 2.0, temperature: 1.0 };
        for (stream, (flow, keys)) in ways.iter().flat_map(|way| [(faster, way), (denser, way)]) {
            let [stiffness, damping, mass] = stream.structural();
            let problem = problem_of(&format!("{flow}{BODY}{keys}"));
            let (start, borne) = ([[0.1, 2.0], [0.05, 3.0]], [0.5, -0.25]);
            let march = March { mach: 0.5, stream, start: &start, borne: &borne, period: 10.0, most: MOST };
            let marched = problem.march_of(&march).unwrap();
            let own = marched.case();
            let [before, after] = [&problem.about_steady_flow(0.5).unwrap(), &marched].map(Held::of);
            let over = |a: &[f64], b: &[f64], factor: f64| {
                a.iter().zip(b).all(|(a, b)| (a - b * factor).abs() <= 1e-12 * b.abs().max(1e-9))
            };
            assert!(over(&after.matrices.mass, &before.matrices.mass, mass), "{keys}");
            assert!(over(&after.matrices.stiffness, &before.matrices.stiffness, stiffness), "{keys}");
            assert!(over(&after.matrices.damping, &before.matrices.damping, damping), "{keys}");
            let cubic = [&after, &before].map(|h| h.springs[1].cubic);
            assert!(over(&cubic[..1], &cubic[1..], stiffness), "{keys}");
            let initial = &own.structures[0].initial;
            assert_eq!(
                [initial["plunge"], initial["plunge_rate"], initial["pitch"], initial["pitch_rate"]],
                [0.1, 2.0, 0.05, 3.0]
            );
            assert_eq!(own.swing().map(|t| t.0), Some(10.0));
            // held as drawn against the steady flow
            let Problem::Plane(plane) = &marched else { panic!("{keys}") };
            assert!(over(&plane.structures()[0].structure.forces(0.0), &[-0.5, 0.25], 1.0), "{keys}");
        }
    }

    #[test]
    fn a_march_is_told_in_the_units_of_the_branch() {
        let (cycle, frequency) = (cycle(), 0.2);
        let swing = Swing { mean: 0.0, amplitude: 2.02f64.to_radians(), frequency, change: 0.001 };
        let found = told(&cycle, &swing, 7.0, 1.0);
        assert!((found.amplitude - 2.02).abs() < 1e-12 && (found.difference - 0.01).abs() < 1e-12);
        assert!((found.frequency - frequency / TAU * cycle.speed_ratio).abs() < 1e-15);
        assert!(doubts(&found, 2.0).is_empty());
        assert_eq!(doubts(&MarchedCycle { change: 0.01, ..found }, 2.0).len(), 1);
    }
}
