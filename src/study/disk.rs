//! Bytes that a run writes.
//!
//! Fitted to the run folders of sections on 2,500 to 36,000 particles, and of a wing, a wing in motion and a fighter on 26,000 to
//! 276,000 (November 2026).
use super::keeper::FILM_FIELDS;
use crate::case::{Case, Temporal};
use crate::problem::numerics::harmonics;

/// Bytes of each particle in a file of a field, in the plane and in space.
const FIELD: [f64; 2] = [105.0, 172.0];
/// Part of it that a field of a film takes.
const FILMED: f64 = 0.7;
/// Bytes of each particle in a checkpoint for each state that it holds.
const STATE: f64 = 45.0;
/// States of a checkpoint of implicit steps in time.
const STEPPED: f64 = 2.5;
/// Bytes of tables and surfaces: in the plane for each particle, in space for each of their number to the power of two thirds.
const WALL: [f64; 2] = [15.0, 1e4];
/// Bytes of pictures and report.
const PICTURES: f64 = 8e6;

/// Bytes that a run on so many particles holds on disk at most; `period` and the end of a march are in the time of the solver.
pub(crate) fn bytes(case: &Case, particles: f64, dimension: usize, period: Option<f64>) -> f64 {
    let units = case.flow.units();
    let end = case.end(period).unwrap_or_default();
    let series = case.output.field_interval.map_or(0.0, |t| (end / units.solver_time(t.0)).floor());
    let filmed = if case.moves() && period.is_some() { FILMED * f64::from(FILM_FIELDS) } else { 0.0 };
    let states = match case.time {
        Temporal::Steady(_) | Temporal::Explicit(_) | Temporal::Newmark(_) | Temporal::Modes(_) => 1.0,
        Temporal::Dual(_) => STEPPED,
        Temporal::Harmonics(_) => 1.0 + 2.0 * f64::from(harmonics(case)),
    };
    // a checkpoint is written beside the one that it takes the place of
    let held = case.output.field_particles.map_or(1.0, |most| (f64::from(most) / particles).min(1.0));
    let each = FIELD[dimension - 2] * (1.0 + series + filmed) * held + 2.0 * STATE * states;
    let wall = if dimension == 2 { WALL[0] * particles } else { WALL[1] * particles.powf(2.0 / 3.0) };
    particles * each + wall + if case.output.report { PICTURES } else { 0.0 }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn told(more: &str, particles: f64, dimension: usize) -> f64 {
        let text = format!("[flow]\nmach = 0.5\n[[body]]\nnaca = \"0012\"\n[cloud]\nspacing = 0.01\n{more}");
        bytes(&crate::case::read(&text, "t").unwrap(), particles, dimension, Some(10.0))
    }

    #[test] // megabytes of whole run folders, a second checkpoint for the moment of writing included
    fn measured_folders_are_met() {
        for (particles, dimension, found) in
            [(32_561.0, 2, 14.9), (57_081.0, 3, 42.0), (175_261.0, 3, 76.5), (276_235.0, 3, 111.0)]
        {
            let told = 1e-6 * told("", particles, dimension);
            assert!((told / found - 1.0).abs() < 0.2, "{particles}: {told} MB for {found}");
        }
    }

    #[test]
    fn every_field_of_a_series_counts() {
        let march = |interval: f64| {
            let time = "[time.explicit]\nuntil = 10.0\n";
            told(&format!("{time}[output]\nreport = false\nfield_interval = {interval}\n"), 1e4, 2)
        };
        let field = 1e4 * FIELD[0];
        assert!((march(0.1) - march(1.0) - 90.0 * field).abs() < 0.1 * field);
    }
}
