//! The structure in the stream as a linear system.
use num_complex::Complex64;
use serde_json::json;

use super::scales::{Scales, Stream};
use crate::record::flutter::StateSpaceAt;
use crate::structure::Matrices;
use crate::structure::flutter::state_space::Roger;

/// What files say about the system.
const CONVENTIONS: &str = "x' = A x + B f, y = C x + D f in the units of the case; x: coordinates, their rates, lags r with r' + \
                           u beta r = rate of the coordinate; f: generalised forces on the coordinates; y: coordinates and rates. \
                           parts, in units of the solver (density and sound speed of the case one, its unit of length), serve \
                           other speeds: (M - p/u^2 A2) q'' = -(K - p A0) q - (C - p/u A1) q' + p sum B_l r_l, u and p speed and \
                           dynamic pressure over those of the case";

/// The system of a structure with the forces that are known up to the angular frequency `highest`.
pub(super) fn state_space(
    (structure, names): (&Matrices, &[String]),
    forces: &dyn Fn(f64) -> Vec<Complex64>,
    highest: f64,
    (stream, scales): (&Stream, &Scales),
) -> Option<StateSpaceAt> {
    let n = names.len();
    let roger = Roger::fit(forces, highest)?;
    let system = roger.system(structure, stream.speed, stream.pressure)?.in_units(n, scales.rate, scales.force);
    let rows = |a: &[f64], width: usize| a.chunks_exact(width).map(<[f64]>::to_vec).collect::<Vec<_>>();
    let rates = || names.iter().map(|name| format!("{name}_rate"));
    let lags = (0..roger.lags.len()).flat_map(|l| names.iter().map(move |name| format!("{name}_lag_{}", l + 1)));
    let outputs: Vec<String> = names.iter().cloned().chain(rates()).collect();
    let [still, first, second] = roger.polynomial.each_ref().map(|a| rows(a, n));
    let parts = json!({
        "mass": rows(&structure.mass, n),
        "damping": rows(&structure.damping, n),
        "stiffness": rows(&structure.stiffness, n),
        "a0": still,
        "a1": first,
        "a2": second,
        "lags": roger.lags,
        "lagged": roger.lagged.iter().map(|b| rows(b, n)).collect::<Vec<_>>(),
    });
    Some(StateSpaceAt {
        conventions: CONVENTIONS.to_owned(),
        speed_ratio: stream.speed,
        speed: scales.reference.speed * stream.speed,
        density: scales.reference.density * stream.pressure / (stream.speed * stream.speed),
        misfit: roger.misfit,
        states: outputs.iter().cloned().chain(lags).collect(),
        inputs: names.to_vec(),
        outputs,
        a: rows(&system.a, system.states),
        b: rows(&system.b, n),
        c: rows(&system.c, system.states),
        d: rows(&system.d, n),
        parts,
    })
}
