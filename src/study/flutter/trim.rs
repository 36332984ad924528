//! Static aeroelastic trim: forces about the equilibrium of structure and gas in the stream that the structure begins to flutter in.
//!
//! The equilibrium goes with the stream, and the first crossing with the equilibrium: both are found in turn, from the stream of the case,
//! until the crossing stays where its equilibrium was sought. Springs that become much stiffer or softer under load make it leap from one side
//! to the other: between the two the false position is taken (Illinois, Dowell and Jarratt 1971, doi:10.1007/BF01934364).
use super::super::monitor::{Monitor, Within};
use super::super::time_left::Portion;
use super::scales::Scales;
use crate::case::{Flutter as Plan, Matching};
use crate::problem::RunError;
use crate::problem::StreamRatio;
use crate::record::flutter::{FlutterAt, Trim, remedy};

/// Equilibria that are sought at most.
const ROUNDS: usize = 12;
/// Those that it usually takes.
const USUAL_ROUNDS: usize = 4;

/// What is found in a stream, with limit cycles or without; `None` when the monitor says stop.
pub(super) type InStream<'a> = dyn Fn(StreamRatio, bool, &mut dyn Monitor) -> Result<Option<FlutterAt>, RunError> + 'a;

/// The boundary about the equilibrium at its first crossing, which may move by the part `plan.accuracy` with the last one, and the limit cycles
/// about it where these are asked for; `None` when the monitor says stop.
pub(super) fn trimmed(
    scales: &Scales,
    (plan, cycles): (&Plan, bool),
    boundary: &InStream<'_>,
    monitor: &mut dyn Monitor,
) -> Result<Option<FlutterAt>, RunError> {
    let (mut x, mut rounds, mut cost) = (1.0, 0, 0.0);
    let mut between = Between::default();
    let mut at = loop {
        let stream = scales.at(x);
        let outer = Portion::of(rounds.min(USUAL_ROUNDS - 1), &[1.0; USUAL_ROUNDS]);
        let within = &mut Within { outer, monitor: &mut *monitor };
        let Some(mut at) = boundary(scales.ratio(x), false, within)? else { return Ok(None) };
        rounds += 1;
        cost += at.cpu_seconds;
        at.cpu_seconds = cost;
        // where others had a crossing, one that has none has it beyond all that is looked at
        let next = first(&at, scales).or((rounds > 1).then(|| scales.upto(plan.most)));
        let moved = next.map(|next| (next / x - 1.0).abs());
        at.trim = Some(Trim {
            speed_ratio: stream.speed,
            dynamic_pressure: scales.reference.dynamic_pressure() * stream.pressure,
            coordinates: std::mem::take(&mut at.still),
            rounds,
        });
        match (next, moved) {
            (Some(next), Some(moved)) if moved > plan.accuracy && rounds < ROUNDS => x = between.next(x, next),
            (Some(_), Some(moved)) => {
                let first = at.crossings.iter_mut().find(|c| c.kind != "restabilised" && c.dynamic_pressure > 0.0);
                first.into_iter().for_each(|c| c.error = c.error.max(moved));
                if moved > plan.accuracy {
                    let what = format!(
                        "after {rounds} equilibria the first crossing is still {:.1} % from where the last was sought",
                        100.0 * moved
                    );
                    at.warn((what, remedy::EQUILIBRIA));
                }
                break at;
            }
            _ => break at,
        }
        let told = scales.at(x);
        monitor.note(&format!(
            "equilibrium {rounds}: the next is sought at {:.4} of the speed, {:.4} of the dynamic pressure",
            told.speed, told.pressure
        ));
    };
    if cycles {
        let Some(about) = boundary(scales.ratio(x), true, monitor)? else { return Ok(None) };
        at.cpu_seconds += about.cpu_seconds;
        at.warn_of(&about);
        (at.cycles, at.borne) = (about.cycles, about.borne);
    }
    Ok(Some(at))
}

/// Where crossings were found beyond their equilibrium and before it: the logarithm of x, and how far the crossing is from it.
#[derive(Default)]
struct Between {
    beyond: Option<[f64; 2]>,
    before: Option<[f64; 2]>,
}

impl Between {
    /// Where the next equilibrium is sought, when one at `x` has its crossing at `found`.
    fn next(&mut self, x: f64, found: f64) -> f64 {
        let (at, off) = (x.ln(), (found / x).ln());
        let (own, other) = match off > 0.0 {
            true => (&mut self.beyond, &mut self.before),
            false => (&mut self.before, &mut self.beyond),
        };
        // an end that stays counts for half each time
        if let (Some(_), Some([_, far])) = (&own, other) {
            *far *= 0.5;
        }
        *own = Some([at, off]);
        match (self.beyond, self.before) {
            (Some([a, up]), Some([b, down])) => (a + (b - a) * up / (up - down)).exp(),
            _ => found,
        }
    }
}

/// What is varied at the first crossing that is not one back to decay.
fn first(at: &FlutterAt, scales: &Scales) -> Option<f64> {
    // what diverges at any speed has no equilibrium there
    let row = at.crossings.iter().find(|c| c.kind != "restabilised" && c.dynamic_pressure > 0.0)?;
    Some(match scales.matching {
        Matching::None => row.speed_ratio,
        _ => row.dynamic_pressure / scales.reference.dynamic_pressure(),
    })
}

#[cfg(test)]
mod tests {
    use super::super::held::{Held, problem_of};
    use super::*;
    use std::f64::consts::{PI, TAU};

    #[test]
    fn equilibria_that_leap_over_their_crossing_are_found() {
        // a spring that stiffens under load, one that softens, and a crossing that hardly moves
        for slope in [-3.0, -1.0, -0.2, 0.7] {
            let crossing = |x: f64| 0.8 * (x / 0.8f64).powf(slope);
            let (mut x, mut between, mut rounds) = (2.0, Between::default(), 0);
            while (crossing(x) / x - 1.0).abs() > 1e-3 {
                x = between.next(x, crossing(x));
                rounds += 1;
                assert!(rounds <= 20, "{slope}: {x}");
            }
            assert!((x / 0.8 - 1.0).abs() < 5e-3, "{slope}: {x}");
        }
    }

    /// With units the stream changes, without them the structure: both are the same to the solver.
    #[test]
    fn a_structure_in_another_stream_is_the_same_with_and_without_units() {
        const BODY: &str = "[[body]]\nnaca = \"0012\"\n[cloud]\nspacing = 0.1\n[structure]\nelastic_axis = -0.4\nx_alpha = 0.2\n\
                            r_alpha2 = 0.25\ndamping_ratio = { pitch = 0.02 }\n";
        let (density, sound, b, mu, speed) = (1.2, 340.0f64, 0.5, 30.0, 2.0);
        let temperature = sound * sound / (1.4 * 287.05);
        let pitch = 0.5 * sound / (b * speed) / TAU;
        let mass = mu * PI * density * b * b;
        let plain =
            format!("[flow]\nmach = 0.5\n{BODY}mass_ratio = {mu}\nfrequency_ratio = 0.4\nreduced_speed = {speed}\n");
        let units = format!(
            "[flow]\nmach = 0.5\ndensity = \"{density} kg/m3\"\ntemperature = \"{temperature} K\"\ngas_constant = 287.05\n{BODY}\
             mass = \"{mass} kg/m\"\nfrequency = {{ plunge = \"{} Hz\", pitch = \"{pitch} Hz\" }}\n",
            0.4 * pitch
        );
        for stream in [StreamRatio::SAME, StreamRatio { pressure: 2.0, temperature: 1.3 }] {
            let [a, b] = [&plain, &units].map(|text| Held::of(&problem_of(text).in_stream(stream).unwrap()).matrices);
            for (a, b) in [(&a.mass, &b.mass), (&a.damping, &b.damping), (&a.stiffness, &b.stiffness)] {
                let size = b.iter().fold(0.0f64, |m, x| m.max(x.abs()));
                assert!(a.iter().zip(b).all(|(a, b)| (a - b).abs() < 1e-6 * size), "{a:?} {b:?}");
            }
        }
    }
}
