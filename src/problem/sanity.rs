//! What can be written down but makes no sense: told before any particle is placed.
use super::error::RunError;
use super::numerics;
use super::reference::chord;
use super::scales;
use super::spacing::{ACROSS, asked};
use crate::case::{Case, Cloud, NEVER_LAMINAR, NO_CONTINUUM, RefineBox, Temporal};
use crate::geometry::Surface;
use crate::math::Bounds;
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
/// Mach number above which even gases of one atom are far from ideal behind a shock.
const HYPERSONIC: f64 = 25.0;
/// Free path of the molecules over the length of a body above which a gas is no continuum (Bird, Molecular Gas Dynamics, 1.2).
const RAREFIED: f64 = 0.1;
/// Angle beyond which a stream comes from behind.
const FROM_BEHIND: f64 = std::f64::consts::FRAC_PI_2;
/// Thinnest layer at a wall over the spacing along it: rounding leaves ten digits of what lies across.
const THINNEST: f64 = 1e-6;

/// Refuses spacings that see no body and periods that no wave can follow; tells what is doubtful.
pub(crate) fn sane<const D: usize>(
    case: &Case,
    surface: Option<&Surface<D>>,
    motions: &Motions<D>,
) -> Result<Vec<String>, RunError> {
    laminar(case, surface)?;
    frequencies(case, motions)?;
    let Some(spacing) = case.cloud.spacing.map(|l| l.0) else { return Ok(Vec::new()) };
    thin_layers(case, surface, spacing)?;
    let fastest = motions.frequencies().last().map(|omega| std::f64::consts::TAU / omega);
    if let Some(period) = fastest.or(motions.period()).filter(|t| *t < SHORTEST_WAVE * spacing) {
        let k = std::f64::consts::PI * chord(case, surface) / (period * case.flow.reference().mach);
        let given = case.flow.units().case_time(period);
        return Err(RunError::Senseless {
            what: format!(
                "the period {given:.3e} is so short that sound goes {:.1e} spacings in it (reduced frequency {k:.1e})",
                period / spacing
            ),
            hint: "check the unit of `period` or `frequency`; a wave needs tens of particles: lower `cloud.spacing` for a motion as fast".into(),
        });
    }
    for (body, name) in surface.iter().flat_map(|s| s.bodies.iter().enumerate()) {
        let bounds = surface.map_or(Bounds::EMPTY, |s| s.bounds_of(body));
        let (spacing, length) = (spacing_around(&case.cloud, spacing, &bounds), bounds.extent().max_abs());
        if spacing > COARSE * length {
            return Err(RunError::Senseless {
                what: format!("`cloud.spacing` is {spacing}, but body `{name}` is only {length} long"),
                hint: "a hundredth of the body is usual; leave `spacing` out of a steady plane case, and it is chosen"
                    .into(),
            });
        }
    }
    // the result of a family of clouds is told on one that is not known yet
    let rough = if asked(case).is_none() { rough(&case.cloud, surface) } else { Vec::new() };
    Ok(rough.into_iter().chain(doubtful(case, surface)).collect())
}

/// Bodies whose loads the spacing of a cloud leaves a rough guess.
pub(crate) fn rough<const D: usize>(cloud: &Cloud, surface: Option<&Surface<D>>) -> Vec<String> {
    let (Some(spacing), Some(surface)) = (cloud.spacing.map(|l| l.0), surface) else { return Vec::new() };
    let length = |bounds: Bounds<D>| bounds.extent().max_abs() / spacing_around(cloud, spacing, &bounds);
    let lengths = (0..surface.bodies.len()).map(|body| length(surface.bounds_of(body)));
    let told = |(length, name): (f64, &String)| {
        let words = || format!("body `{name}` is only {length:.1} spacings long: its loads are a rough guess");
        (length * ROUGH < 1.0).then(words)
    };
    lengths.zip(&surface.bodies).filter_map(told).collect()
}

/// Spacing of a cloud around a body: that of the finest box that holds all of it, where one is finer than `spacing`.
fn spacing_around<const D: usize>(cloud: &Cloud, spacing: f64, body: &Bounds<D>) -> f64 {
    let holds = |b: &&RefineBox| (0..D).all(|d| b.min[d].0 <= body.min[d] && body.max[d] <= b.max[d].0);
    cloud.boxes.iter().filter(holds).map(|b| b.spacing.0).fold(spacing, f64::min)
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
            hint: "harmonic balance finds flows that repeat: write frequencies whose ratio is that of small whole numbers, or march".into(),
        });
    }
    let (Some(&highest), most) = (motions.multiples().last(), numerics::most(plan)) else { return Ok(()) };
    if most >= highest {
        return Ok(());
    }
    Err(RunError::Senseless {
        what: format!(
            "{most} harmonics of the common frequency are wanted, but the motion itself has the harmonic {highest}"
        ),
        hint: "the common frequency of all parts is the first harmonic: ask for as many harmonics as the fastest part has, better \
               twice as many".into(),
    })
}

/// What of the stream and of lengths is doubtful.
fn doubtful<const D: usize>(case: &Case, surface: Option<&Surface<D>>) -> Vec<String> {
    let stream = [slow(case), hot(case), backward(case), turbulent(case, surface), rarefied(case, surface)];
    stream.into_iter().flatten().chain(surface.iter().flat_map(|s| scales::doubtful(case, s))).collect()
}

/// Streams that come from behind; points of a polar are meant as they are written.
fn backward(case: &Case) -> Option<String> {
    let angles = [("alpha", case.flow.alpha), ("beta", case.flow.beta)];
    let (key, angle) = angles.into_iter().find(|(_, angle)| angle.0.abs() > FROM_BEHIND && case.polar.is_none())?;
    let degrees = angle.degrees();
    Some(format!(
        "`flow.{key}` is {degrees} deg: the stream comes from behind the bodies, where real flows separate from rounded edges and this one \
         may not"
    ))
}

/// Refuses viscosities of flows that are not laminar, and of gases that are no continuum.
fn laminar<const D: usize>(case: &Case, surface: Option<&Surface<D>>) -> Result<(), RunError> {
    let chord = chord(case, surface);
    let Some(re) = case.flow.reynolds_number(chord).filter(|_| surface.is_some()) else { return Ok(()) };
    let mach = case.flow.reference().mach;
    let path = case.flow.free_path(re, mach);
    let why = if re > NEVER_LAMINAR {
        "the boundary layers are turbulent, which this program cannot compute".to_owned()
    } else if path > NO_CONTINUUM && mach > 0.0 {
        format!("molecules fly {path:.0} lengths of the body between collisions, no flow of a continuum")
    } else {
        return Ok(());
    };
    Err(RunError::Senseless {
        what: format!("the Reynolds number is {re:.3e}, with the length {:?}: {why}", case.flow.viscous_length(chord)),
        hint: format!(
            "check the units of `viscosity`, pressure and temperature; laminar flows have {NEVER_LAMINAR:e} at most; without viscosity there \
             is no such limit"
        ),
    })
}

/// Refuses wall layers so thin that no numbers tell them from the wall.
fn thin_layers<const D: usize>(case: &Case, surface: Option<&Surface<D>>, spacing: f64) -> Result<(), RunError> {
    let Some(layers) = case.cloud.wall_layers.as_ref().filter(|l| l.first.0 < THINNEST * spacing) else {
        return Ok(());
    };
    let chord = chord(case, surface);
    let usual = case.flow.reynolds_number(chord).map(|re| case.flow.viscous_length(chord) / (ACROSS * re.sqrt()));
    let usual =
        usual.map_or_else(String::new, |first| format!("; {first:.1e} is a fifth of a laminar layer of this flow"));
    Err(RunError::Senseless {
        what: format!(
            "`cloud.wall_layers.first` is {:e}, {:.1e} times the spacing along the walls, {spacing}",
            layers.first.0,
            layers.first.0 / spacing
        ),
        hint: format!("leave `wall_layers` out, and they are chosen with the spacing, or raise `first`{usual}"),
    })
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

/// Gas that is too hot at rest to be ideal.
fn hot(case: &Case) -> Option<String> {
    let mach = case.flow.reference().mach;
    let times = 1.0 + 0.5 * (case.flow.gamma - 1.0) * mach * mach;
    (mach > HYPERSONIC).then(|| {
        let mach = scales::short(mach);
        format!("at M {mach} the gas is {times:.0} times as hot at rest as in the stream: real gases break up, this one does not")
    })
}

/// Gas whose molecules fly far.
fn rarefied<const D: usize>(case: &Case, surface: Option<&Surface<D>>) -> Option<String> {
    let re = case.flow.reynolds_number(chord(case, surface)).filter(|_| surface.is_some())?;
    let mach = case.flow.reference().mach;
    let path = case.flow.free_path(re, mach);
    (path > RAREFIED).then(|| {
        let [mach, re] = [mach, re].map(scales::short);
        format!(
            "at M {mach} and the Reynolds number {re} molecules fly {path:.2} lengths of the body between collisions: loads are those \
             of a continuum that the gas hardly is; a lower Mach number makes it one"
        )
    })
}

/// Boundary layers that do not stay laminar.
fn turbulent<const D: usize>(case: &Case, surface: Option<&Surface<D>>) -> Option<String> {
    let re = case.flow.reynolds_number(chord(case, surface)).filter(|re| surface.is_some() && *re > TURBULENT)?;
    Some(format!("at the Reynolds number {re:.2e} boundary layers are turbulent, but the gas is computed as laminar"))
}
