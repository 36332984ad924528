//! Fields at the start, states held on the boundary, and the far field.
use super::fluid::FarField;
pub use super::fluid::Field;
use crate::case::formula::Formula;
use crate::case::{Case, Domain, Initial, Units};
use crate::exact::GasState;
use crate::exact::ringleb::Ringleb;
use crate::exact::vortex::IsentropicVortex;
use crate::exact::vortex_far_field::FarFieldVortex;
use crate::math::Vector;
use crate::math::dual::Dual;
use crate::math::jet::Scalar;
use crate::physics::Primitive;

/// Why a field cannot be set up.
#[derive(Debug, thiserror::Error)]
#[error("{0}")]
pub struct StartError(String);

/// The free stream in units of its own density and sound speed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FreeStream {
    /// Mach number.
    pub mach: f64,
    /// Angle of attack in radians, nose up positive.
    pub alpha: f64,
    /// Sideslip angle in radians, 3-D only.
    pub beta: f64,
    /// Ratio of specific heats.
    pub gamma: f64,
}

impl FreeStream {
    /// Air along the first axis.
    pub fn new(mach: f64) -> Self {
        Self { mach, alpha: 0.0, beta: 0.0, gamma: 1.4 }
    }

    /// What `[flow]` of a case says.
    pub fn of_case(case: &Case) -> Self {
        let flow = &case.flow;
        Self { mach: flow.reference().mach, alpha: flow.alpha.0, beta: flow.beta.0, gamma: flow.gamma }
    }

    /// Unit vectors of drag and lift.
    pub fn axes<const D: usize>(&self) -> (Vector<D>, Vector<D>) {
        let (a, b) = (self.alpha, self.beta);
        if D == 2 {
            let pick = |x: f64, y: f64| Vector::from_fn(|d| if d == 0 { x } else { y });
            return (pick(a.cos(), a.sin()), pick(-a.sin(), a.cos()));
        }
        let drag = [a.cos() * b.cos(), b.sin(), a.sin() * b.cos()];
        let lift = [-a.sin(), 0.0, a.cos()];
        (Vector::from_fn(|d| drag[d]), Vector::from_fn(|d| lift[d]))
    }

    /// Density, velocity and pressure.
    pub fn state<const D: usize>(&self) -> Primitive<D> {
        Primitive { density: 1.0, velocity: self.axes::<D>().0 * self.mach, pressure: 1.0 / self.gamma }
    }
}

/// Unit vectors of drag and lift for the angles of the case.
pub fn stream_axes<const D: usize>(case: &Case) -> (Vector<D>, Vector<D>) {
    FreeStream::of_case(case).axes()
}

/// Free stream of the case in units of its own density and sound speed.
pub fn free_stream<const D: usize>(case: &Case) -> Primitive<D> {
    FreeStream::of_case(case).state()
}

/// The field at the start of a case.
pub fn initial<const D: usize>(case: &Case) -> Result<Field<D>, StartError> {
    let extent = |domain: &Domain| Vector::from_fn(|d| domain.max[d].0 - domain.min[d].0);
    let (units, stream) = (case.flow.units(), FreeStream::of_case(case));
    match &case.initial {
        Initial::Formula { velocity, density, pressure } => {
            formula_field([velocity, density.as_slice(), pressure.as_slice()], &units, &stream)
        }
        other => start_field(&other.in_solver_units(&units), &stream, case.cloud.domain.as_ref().map(extent)),
    }
}

/// A field of formulas of the position, in units of the case: velocity, density and pressure; an empty list is the free stream.
fn formula_field<const D: usize>(
    texts: [&[String]; 3],
    units: &Units,
    stream: &FreeStream,
) -> Result<Field<D>, StartError> {
    let scales = [1.0 / units.speed, 1.0 / units.density, 1.0 / units.pressure()];
    let [velocity, density, pressure] = texts;
    let parse = |text: &String| Formula::parse_in(text, D).map_err(|e| StartError(format!("`{text}`: {}", e.message)));
    let parsed = |texts: &[String]| texts.iter().map(parse).collect::<Result<Vec<_>, _>>();
    let [velocity, density, pressure] = [parsed(velocity)?, parsed(density)?, parsed(pressure)?];
    let free = stream.state::<D>();
    Ok(std::sync::Arc::new(move |x| {
        let value = |formulas: &[Formula], k: usize, free: f64, scale: f64| {
            formulas.get(k).map_or(free, |f| scale * f.value_at(&x.0, 0.0, 0.0))
        };
        Primitive {
            density: value(&density, 0, free.density, scales[1]),
            velocity: Vector::from_fn(|d| value(&velocity, d, 0.0, scales[0])),
            pressure: value(&pressure, 0, free.pressure, scales[2]),
        }
    }))
}

/// A field at the start; a vortex repeats after `period` along each of two axes.
fn start_field<const D: usize>(
    initial: &Initial,
    stream: &FreeStream,
    period: Option<Vector<2>>,
) -> Result<Field<D>, StartError> {
    let free = stream.state::<D>();
    let planar = |x: &Vector<D>| Vector([x[0], x[1]]);
    let lift = |s: GasState<2>| Primitive {
        density: s.density,
        velocity: Vector::from_fn(|d| if d < 2 { s.velocity[d] } else { 0.0 }),
        pressure: s.pressure,
    };
    let wrong = |e: crate::exact::Error| StartError(e.to_string());
    match initial {
        Initial::FreeStream | Initial::Formula { .. } => Ok(std::sync::Arc::new(move |_| free)),
        Initial::Riemann { left, right, position, axis } => {
            let (left, right, position, axis) = (*left, *right, *position, *axis as usize);
            Ok(std::sync::Arc::new(move |x| {
                let [density, velocity, pressure] = if x[axis] < position { left } else { right };
                Primitive { density, velocity: Vector::axis(axis) * velocity, pressure }
            }))
        }
        Initial::Vortex { strength, centre, velocity } => {
            let vortex = IsentropicVortex::new(*strength, Vector(*centre), Vector(*velocity), stream.gamma);
            let vortex = vortex.map_err(wrong)?;
            let vortex = period.map_or(vortex, |p| vortex.periodic(p));
            Ok(std::sync::Arc::new(move |x| lift(vortex.state(&planar(x), 0.0))))
        }
        Initial::Ringleb => {
            let flow = Ringleb::new(stream.gamma).map_err(wrong)?;
            Ok(std::sync::Arc::new(move |x| flow.state(&planar(x)).map_or(free, lift)))
        }
    }
}

/// The free stream, with the vortex of the lift in subsonic plane flow.
pub struct Stream<const D: usize> {
    free: Primitive<D>,
    lift: Vector<D>,
    /// That of subsonic plane flow.
    vortex: Option<FarFieldVortex>,
    lifting: bool,
}

impl<const D: usize> Stream<D> {
    /// Far field of bodies around `centre`. The vortex is left out when `lifting` is false: on a body without a sharp
    /// edge nothing determines the circulation, and a far field that follows it would let it grow.
    pub fn new(stream: &FreeStream, centre: &Vector<D>, lifting: bool) -> Self {
        let free = stream.state::<D>();
        let state =
            GasState { density: 1.0, velocity: Vector([free.velocity[0], free.velocity[1]]), pressure: free.pressure };
        let mach = free.velocity.norm();
        let plane = D == 2 && 0.0 < mach && mach < 1.0;
        let centre = Vector([centre[0], centre[1]]);
        let vortex = plane.then(|| FarFieldVortex::new(state, stream.gamma, 0.0, centre).ok()).flatten();
        Self { free, lift: stream.axes::<D>().1, vortex, lifting }
    }

    /// The circulation of a force: lift = ρ V Γ (Kutta, Joukowski).
    fn circulation<S: Scalar>(&self, force: &Vector<D, S>) -> S {
        force.along(&self.lift) * (1.0 / (self.free.density * self.free.velocity.norm()))
    }

    fn state_of<S: Scalar>(&self, x: &Vector<D>, force: &Vector<D, S>) -> Primitive<D, S> {
        let free = || Primitive::constant(&self.free);
        let Some(vortex) = self.vortex.filter(|_| self.lifting) else { return free() };
        let s = vortex.state_of(&Vector([x[0], x[1]]), self.circulation(force));
        let velocity = Vector::from_fn(|d| s.velocity[d.min(1)]);
        let q = Primitive { density: s.density, velocity, pressure: s.pressure };
        if q.is_physical() { q } else { free() }
    }
}

impl<const D: usize> FarField<D> for Stream<D> {
    fn state(&self, x: &Vector<D>, force: &Vector<D>) -> Primitive<D> {
        self.state_of(x, force)
    }

    fn changing(&self, x: &Vector<D>, force: &Vector<D, Dual>) -> Primitive<D, Dual> {
        self.state_of(x, force)
    }

    fn pressure(&self) -> f64 {
        self.free.pressure
    }

    fn stray_velocity(&self, x: &Vector<D>, force: &Vector<D>) -> Option<Vector<D>> {
        let vortex = self.vortex.filter(|_| !self.lifting)?.with_circulation(self.circulation(force));
        let v = vortex.velocity_increment(&Vector([x[0], x[1]]));
        Some(Vector::from_fn(|d| v[d.min(1)]))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn formulas_of_the_start_are_in_units_of_the_case() {
        let text = "[flow]\nvelocity = \"20 m/s\"\npressure = \"1e5 Pa\"\ndensity = \"1.4 kg/m3\"\n[initial.formula]\n\
                    velocity = [\"10 * y\", \"x\"]\npressure = \"1e5 + 2e4 * x\"\n[cloud]\nspacing = 0.1\n\
                    domain = { min = [0, 0], max = [1, 1] }\n";
        let case = crate::case::read(text, "case.toml").unwrap();
        let sound = (1.4_f64 * 1e5 / 1.4).sqrt();
        let q = initial::<2>(&case).unwrap()(&Vector([0.5, 0.25]));
        assert!((q.density - 1.0).abs() < 1e-15);
        assert!((q.velocity - Vector([2.5, 0.5]) * (1.0 / sound)).norm() < 1e-15);
        assert!((q.pressure - 1.1 / 1.4).abs() < 1e-14, "{}", q.pressure);
    }
}
