//! Static aeroelastic trim: forces about the equilibrium of structure and gas in the stream that the structure begins to flutter in.
//!
//! The equilibrium goes with the stream, and the first crossing with the equilibrium: both are found in turn, from the stream of the case,
//! until the crossing stays where its equilibrium was sought.
use super::super::error::RunError;
use super::super::monitor::Monitor;
use super::record::{FlutterAt, Trim};
use super::scales::Scales;
use crate::case::{Matching, StreamRatio};

/// Equilibria that are sought at most.
const ROUNDS: usize = 8;

/// What is found in a stream; `None` when the monitor says stop.
pub(super) type InStream<'a> = dyn Fn(StreamRatio, &mut dyn Monitor) -> Result<Option<FlutterAt>, RunError> + 'a;

/// The boundary about the equilibrium at its first crossing, which may move by the part `accuracy` with the last one; `None` when the
/// monitor says stop.
pub(super) fn trimmed(
    scales: &Scales,
    accuracy: f64,
    boundary: &InStream<'_>,
    monitor: &mut dyn Monitor,
) -> Result<Option<FlutterAt>, RunError> {
    let (mut x, mut rounds, mut cost) = (1.0, 0, 0.0);
    loop {
        let stream = scales.at(x);
        let Some(mut at) = boundary(ratio(scales, x), monitor)? else { return Ok(None) };
        rounds += 1;
        cost += at.cpu_seconds;
        at.cpu_seconds = cost;
        let next = first(&at, scales);
        let moved = next.map(|next| (next / x - 1.0).abs());
        at.trim = Some(Trim {
            speed_ratio: stream.speed,
            dynamic_pressure: scales.reference.dynamic_pressure() * stream.pressure,
            coordinates: std::mem::take(&mut at.still),
            rounds,
        });
        match (next, moved) {
            (Some(next), Some(moved)) if moved > accuracy && rounds < ROUNDS => x = next,
            (Some(_), Some(moved)) => {
                at.crossings.iter_mut().take(1).for_each(|c| c.error = c.error.max(moved));
                if moved > accuracy {
                    at.warnings.push(format!(
                        "after {rounds} equilibria the first crossing is still {:.1} % from where the last was sought",
                        100.0 * moved
                    ));
                }
                return Ok(Some(at));
            }
            _ => return Ok(Some(at)),
        }
        let told = scales.at(x);
        monitor.note(&format!(
            "equilibrium {rounds}: first crossing at {:.4} of the speed, {:.4} of the dynamic pressure",
            told.speed, told.pressure
        ));
    }
}

/// Pressure and temperature where x is varied.
fn ratio(scales: &Scales, x: f64) -> StreamRatio {
    let stream = scales.at(x);
    let temperature = stream.speed * stream.speed;
    // the dynamic pressure goes with the pressure at constant Mach number
    StreamRatio { pressure: stream.pressure, temperature }
}

/// What is varied at the first crossing that is not one back to decay.
fn first(at: &FlutterAt, scales: &Scales) -> Option<f64> {
    let row = at.crossings.iter().find(|c| c.kind != "restabilised")?;
    Some(match scales.matching {
        Matching::None => row.speed_ratio,
        _ => row.dynamic_pressure / scales.reference.dynamic_pressure(),
    })
}
