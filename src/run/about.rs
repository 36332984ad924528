//! What field files tell of their case: conditions with units, and what is seen first.
use crate::case::{Case, PlaneState};
use crate::geometry::dimension;
use crate::observe::About;
use crate::observe::columns::Scale;

/// Name that VTK gives the time of a file.
const TIME: &str = "TimeValue";

/// Of the gas of `case`, coloured by the array `scalars` first, at the time `time`.
pub(crate) fn gas(case: &Case, scalars: &'static str, time: Option<f64>) -> About {
    let (flow, stream) = (&case.flow, case.flow.reference());
    let has_units = flow.is_dimensional();
    let name = |what: &str, si: &str, own: &str| format!("{what} [{}]", if has_units { si } else { own });
    let mut numbers = vec![
        ("Mach number".to_owned(), stream.mach),
        ("alpha [deg]".to_owned(), flow.alpha.0.to_degrees()),
        ("beta [deg]".to_owned(), flow.beta.0.to_degrees()),
        (name("free-stream density", "kg/m3", "rho"), stream.density),
        (name("free-stream speed", "m/s", "a"), stream.speed),
        (name("free-stream pressure", "Pa", "rho.a2"), stream.pressure),
        (name("free-stream temperature", "K", "T"), if has_units { flow.kelvin() } else { 1.0 }),
        ("ratio of specific heats".to_owned(), flow.gamma),
    ];
    numbers.extend(time.map(|t| (TIME.to_owned(), t)));
    About { numbers, scalars, vectors: "velocity", ..of(case, has_units) }
}

/// Of bodies made of particles, whose units are those of SI; in a gas without units those of the case.
pub(crate) fn solid(case: &Case, time: Option<f64>) -> About {
    let numbers = time.map(|t| (TIME.to_owned(), t)).into_iter().collect();
    let has_units = !case.has_gas() || case.flow.is_dimensional();
    let mut about = About { numbers, scalars: "von_mises_stress", vectors: "displacement", ..of(case, has_units) };
    // particles of a section that is turned about an axis stand for rings
    if case.solids().any(|(_, _, solid)| solid.plane == PlaneState::Axisymmetric) {
        about.scale = about.scale.map(|scale| Scale { dimension: 3, ..scale });
    }
    about
}

fn of(case: &Case, dimensional: bool) -> About {
    let convention = match dimensional {
        true => "SI",
        false => "free stream: L unit of the geometry, rho its density, a its sound speed, T its temperature",
    };
    About {
        scale: Some(Scale { dimensional, dimension: usize::from(dimension(case)) }),
        words: vec![("title", case.title.clone()), ("unit system", convention.to_owned())],
        ..About::default()
    }
}
