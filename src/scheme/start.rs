//! Fields at the start, states held on the boundary, and the far field.
use super::fluid::FarField;
pub use super::fluid::Field;
use crate::case::{Case, Initial};
use crate::exact::GasState;
use crate::exact::ringleb::Ringleb;
use crate::exact::vortex::IsentropicVortex;
use crate::exact::vortex_far_field::FarFieldVortex;
use crate::math::Vector;
use crate::physics::Primitive;

/// Why a field cannot be set up.
#[derive(Debug, thiserror::Error)]
#[error("{0}")]
pub struct StartError(String);

/// Unit vectors of drag and lift for the angles of the case.
pub fn stream_axes<const D: usize>(case: &Case) -> (Vector<D>, Vector<D>) {
    let (a, b) = (case.flow.alpha.0, case.flow.beta.0);
    if D == 2 {
        let pick = |x: f64, y: f64| Vector::from_fn(|d| if d == 0 { x } else { y });
        return (pick(a.cos(), a.sin()), pick(-a.sin(), a.cos()));
    }
    let drag = [a.cos() * b.cos(), b.sin(), a.sin() * b.cos()];
    let lift = [-a.sin(), 0.0, a.cos()];
    (Vector::from_fn(|d| drag[d]), Vector::from_fn(|d| lift[d]))
}

/// Free stream in units of its own density and sound speed.
pub fn free_stream<const D: usize>(case: &Case) -> Primitive<D> {
    let mach = case.flow.reference().mach;
    Primitive { density: 1.0, velocity: stream_axes::<D>(case).0 * mach, pressure: 1.0 / case.flow.gamma }
}

/// The field at the start.
pub fn initial<const D: usize>(case: &Case) -> Result<Field<D>, StartError> {
    let free = free_stream::<D>(case);
    let gamma = case.flow.gamma;
    let planar = |x: &Vector<D>| Vector([x[0], x[1]]);
    let lift = |s: GasState<2>| Primitive {
        density: s.density,
        velocity: Vector::from_fn(|d| if d < 2 { s.velocity[d] } else { 0.0 }),
        pressure: s.pressure,
    };
    let wrong = |e: crate::exact::Error| StartError(e.to_string());
    match &case.initial {
        Initial::FreeStream => Ok(std::sync::Arc::new(move |_| free)),
        Initial::Riemann { left, right, position, axis } => {
            let (left, right, position, axis) = (*left, *right, *position, *axis as usize);
            Ok(std::sync::Arc::new(move |x| {
                let [density, velocity, pressure] = if x[axis] < position { left } else { right };
                Primitive { density, velocity: Vector::axis(axis) * velocity, pressure }
            }))
        }
        Initial::Vortex { strength, centre, velocity } => {
            let mut vortex =
                IsentropicVortex::new(*strength, Vector(*centre), Vector(*velocity), gamma).map_err(wrong)?;
            if let Some(domain) = &case.cloud.domain {
                vortex = vortex.periodic(Vector::from_fn(|d| domain.max[d].0 - domain.min[d].0));
            }
            Ok(std::sync::Arc::new(move |x| lift(vortex.state(&planar(x), 0.0))))
        }
        Initial::Ringleb => {
            let flow = Ringleb::new(gamma).map_err(wrong)?;
            Ok(std::sync::Arc::new(move |x| flow.state(&planar(x)).map_or(free, lift)))
        }
    }
}

/// The free stream, with the vortex of the lift in subsonic plane flow.
pub struct Stream<const D: usize> {
    free: Primitive<D>,
    lift: Vector<D>,
    vortex: Option<FarFieldVortex>,
}

impl<const D: usize> Stream<D> {
    /// Far field of the bodies around `centre`. The vortex is left out when `lifting` is false: on a body without a sharp
    /// edge nothing determines the circulation, and a far field that follows it would let it grow.
    pub fn new(case: &Case, centre: &Vector<D>, lifting: bool) -> Self {
        let free = free_stream::<D>(case);
        let state =
            GasState { density: 1.0, velocity: Vector([free.velocity[0], free.velocity[1]]), pressure: free.pressure };
        let mach = free.velocity.norm();
        let plane = lifting && D == 2 && 0.0 < mach && mach < 1.0;
        let centre = Vector([centre[0], centre[1]]);
        let vortex = plane.then(|| FarFieldVortex::new(state, case.flow.gamma, 0.0, centre).ok()).flatten();
        Self { free, lift: stream_axes::<D>(case).1, vortex }
    }
}

impl<const D: usize> FarField<D> for Stream<D> {
    fn state(&self, x: &Vector<D>, force: &Vector<D>) -> Primitive<D> {
        let Some(vortex) = self.vortex else { return self.free };
        // Kutta-Joukowski: lift = ρ V Γ
        let circulation = force.dot(&self.lift) / (self.free.density * self.free.velocity.norm());
        let s = vortex.with_circulation(circulation).state(&Vector([x[0], x[1]]));
        let velocity = Vector::from_fn(|d| s.velocity[d.min(1)]);
        let q = Primitive { density: s.density, velocity, pressure: s.pressure };
        if q.is_physical() { q } else { self.free }
    }

    fn pressure(&self) -> f64 {
        self.free.pressure
    }
}
