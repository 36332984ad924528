//! What can be written down but makes no sense: told before any particle is placed.
use super::super::error::RunError;
use super::super::look::reference::chord;
use super::super::recipe;
use crate::case::{Case, Temporal};
use crate::geometry::Surface;
use crate::motion::{MOST_PERIODS, Motions};

/// Greatest spacing in lengths of a body.
const COARSE: f64 = 0.5;
/// Spacing in lengths of a body above which loads are a rough guess.
const ROUGH: f64 = 0.07;
/// Least wave length of sound in spacings: no cloud carries a shorter one.
const SHORTEST_WAVE: f64 = 2.0;
/// Mach number below which the scheme as it is adds drag.
const SLOW: f64 = 0.05;
/// Reynolds number above which no boundary layer stays laminar (Schlichting and Gersten, Boundary-Layer Theory, 15.1).
const TURBULENT: f64 = 5e5;

/// Refuses spacings that see no body and periods that no wave can follow; tells what is doubtful.
pub(crate) fn sane<const D: usize>(
    case: &Case,
    surface: Option<&Surface<D>>,
    motions: &Motions<D>,
) -> Result<Vec<String>, RunError> {
    let Some(spacing) = case.cloud.spacing.map(|l| l.0) else { return Ok(Vec::new()) };
    let mut notes = Vec::new();
    frequencies(case, motions)?;
    let fastest = motions.frequencies().last().map(|omega| std::f64::consts::TAU / omega);
    if let Some(period) = fastest.or(motions.period()).filter(|t| *t < SHORTEST_WAVE * spacing) {
        let k = std::f64::consts::PI * chord(case, surface) / (period * case.flow.reference().mach);
        let given = case.flow.units().case_time(period);
        return Err(RunError::Senseless {
            what: format!(
                "the period {given:.3e} is so short that sound goes {:.1e} spacings in it (reduced frequency {k:.1e})",
                period / spacing
            ),
            hint: "check the unit of `period` or `frequency`; a wave needs tens of particles: lower `cloud.spacing` for a motion as fast",
        });
    }
    for (body, name) in surface.iter().flat_map(|s| s.bodies.iter().enumerate()) {
        let length = surface.map_or(0.0, |s| s.bounds_of(body).extent().max_abs());
        if spacing > COARSE * length {
            return Err(RunError::Senseless {
                what: format!("`cloud.spacing` is {spacing}, but body `{name}` is only {length} long"),
                hint: "a hundredth of the body is usual; leave `spacing` out of a steady plane case, and it is chosen",
            });
        }
        if spacing > ROUGH * length {
            notes.push(format!(
                "body `{name}` is only {:.1} spacings long: its loads are a rough guess",
                length / spacing
            ));
        }
    }
    notes.extend(doubtful(case, surface));
    Ok(notes)
}

/// Refuses frequencies that have no common one where a period is needed, and fewer harmonics of it than the motion has.
fn frequencies<const D: usize>(case: &Case, motions: &Motions<D>) -> Result<(), RunError> {
    let Temporal::Harmonics(plan) = &case.time else { return Ok(()) };
    let all = motions.frequencies();
    if let ([first, .., last], None) = (&all[..], motions.period()) {
        return Err(RunError::Senseless {
            what: format!(
                "the motion has frequencies that are no whole multiples of a common one within {MOST_PERIODS} periods (the last is \
                 {:.9} times the first)",
                last / first
            ),
            hint: "harmonic balance finds flows that repeat: write frequencies whose ratio is that of small whole numbers, or march",
        });
    }
    let (Some(&highest), most) = (motions.multiples().last(), recipe::most(plan)) else { return Ok(()) };
    if most >= highest {
        return Ok(());
    }
    Err(RunError::Senseless {
        what: format!(
            "{most} harmonics of the common frequency are wanted, but the motion itself has the harmonic {highest}"
        ),
        hint: "the common frequency of all parts is the first harmonic: ask for as many harmonics as the fastest part has, better \
               twice as many",
    })
}

/// What of the stream is doubtful.
fn doubtful<const D: usize>(case: &Case, surface: Option<&Surface<D>>) -> Vec<String> {
    [slow(case), turbulent(case, surface)].into_iter().flatten().collect()
}

/// Flow too slow for the scheme: its dissipation of velocities grows as 1/M, a circle at M 0.1 has 24 counts of drag too many, at
/// M 0.001 7,800.
fn slow(case: &Case) -> Option<String> {
    let mach = case.flow.reference().mach;
    (!case.bodies.is_empty() && 0.0 < mach && mach < SLOW && !case.scheme.low_mach).then(|| {
        format!(
            "at M {mach} the scheme adds drag: loads of incompressible flow are those of M 0.1 within 1 %, and `scheme.low_mach = true` \
             takes the drag out, but converges slowly"
        )
    })
}

/// Boundary layers that do not stay laminar.
fn turbulent<const D: usize>(case: &Case, surface: Option<&Surface<D>>) -> Option<String> {
    let re = case.flow.reynolds_number(chord(case, surface)).filter(|re| surface.is_some() && *re > TURBULENT)?;
    Some(format!("at the Reynolds number {re:.2e} boundary layers are turbulent, but the gas is computed as laminar"))
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::path::Path;

    fn told(more: &str) -> Result<Vec<String>, String> {
        let case = crate::case::read(&format!("[[body]]\nnaca = \"0012\"\n{more}"), "t").unwrap();
        let (surface, _) = super::super::surface::<2>(&case, Path::new("")).unwrap();
        let motions = super::super::motions(&case, Path::new(""), surface.as_ref()).unwrap();
        sane(&case, surface.as_ref(), &motions).map_err(|e| e.to_string())
    }

    #[test]
    fn spacings_and_periods_out_of_all_measure_are_refused() {
        let stream = "[flow]\nmach = 0.5\n";
        assert_eq!(told(&format!("{stream}[cloud]\nspacing = 0.03\n")), Ok(Vec::new()));
        let coarse = told(&format!("{stream}[cloud]\nspacing = 5\n")).unwrap_err();
        assert!(coarse.contains("`cloud.spacing` is 5, but body `body-1` is only 1 long"), "{coarse}");
        assert!(told(&format!("{stream}[cloud]\nspacing = 0.2\n")).unwrap()[0].contains("5.0 spacings long"));
        let swing = |period: &str| {
            format!(
                "{stream}[motion]\nplunge = 0.01\nperiod = {period}\n[time]\nharmonics = 1\n[cloud]\nspacing = 0.03\n"
            )
        };
        assert!(told(&swing("1e-9")).unwrap_err().contains("the period 1.000e-9 is so short"));
        assert_eq!(told(&swing("20")), Ok(Vec::new()));
    }

    #[test]
    fn turbulent_streams_are_told() {
        let at = |re: &str| told(&format!("[flow]\nmach = 0.5\nreynolds = {re}\n[cloud]\nspacing = 0.03\n"));
        assert_eq!(at("5000"), Ok(Vec::new()));
        assert!(at("2e6").unwrap()[0].contains("2.00e6"));
    }
}
