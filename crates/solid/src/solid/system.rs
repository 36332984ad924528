//! Solids as dynamical systems: M u″ = f(t, u, u′, history).
#[cfg(test)]
mod tests;

use super::body::Solid;
use super::forces::{State, Tangents, Work};
use crate::math::reduce::{largest_size, minimum};
use crate::math::sparse::Symmetric;
use crate::system::{Damping, Fault, Field, Instant, Mechanical, Moment, Name, System};

/// Greatest number of unknowns of a matrix that is factored, in 2-D and 3-D; a factorisation takes a few seconds and a
/// gigabyte.
const FACTORED: [usize; 2] = [300_000, 45_000];

/// A solid as a dynamical system for the time integrators.
pub struct Structure<const D: usize> {
    /// The solid.
    pub solid: Solid<D>,
    fields: Vec<Field>,
}

impl<const D: usize> Structure<D> {
    /// Makes a dynamical system of a solid.
    pub fn new(solid: Solid<D>) -> Self {
        let n = solid.len();
        let fields = vec![
            Field::new(Name::Other("displacement"), n, D),
            Field::new(Name::Other("velocity"), n, D),
            Field::new(Name::History, n, solid.history_width()),
        ];
        Self { solid, fields }
    }

    /// The undeformed state with the velocity `velocity(i)` for particle i.
    pub fn start(&self, velocity: impl Fn(usize) -> [f64; D]) -> Vec<f64> {
        let n = self.solid.len();
        let mut u = vec![0.0; n * D];
        self.solid.hold(0.0, u.as_chunks_mut().0);
        u.extend((0..n).flat_map(|i| {
            let v = velocity(i);
            std::array::from_fn::<f64, D, _>(|a| if self.solid.is_held(i, a) { 0.0 } else { v[a] })
        }));
        u.extend(self.solid.virgin());
        u
    }

    /// Displacement, velocity and history of the state vector `u` at a time.
    pub fn state<'a>(&self, time: f64, u: &'a [f64]) -> State<'a, D> {
        let n = self.solid.len() * D;
        moment(&Moment { time, step: 0.0, displacement: &u[..n], velocity: &u[n..2 * n], history: &u[2 * n..] })
    }
}

fn moment<'a, const D: usize>(at: &Moment<'a>) -> State<'a, D> {
    State {
        time: at.time,
        step: at.step,
        displacement: at.displacement.as_chunks().0,
        velocity: at.velocity.as_chunks().0,
        history: at.history,
    }
}

impl<const D: usize> System for Structure<D> {
    /// The time (s).
    type Frame = f64;
    type Work = Work<D>;

    fn fields(&self) -> &[Field] {
        &self.fields
    }

    fn work(&self) -> Work<D> {
        self.solid.work()
    }

    fn frame(&self, at: &Instant<'_>, _: &[f64]) -> f64 {
        at.time
    }

    fn place(&self, at: &Instant<'_>, frame: &mut f64) {
        *frame = at.time;
    }

    fn rhs(&self, frame: &f64, u: &[f64], work: &mut Work<D>, du: &mut [f64]) {
        let state = self.state(*frame, u);
        let n = self.displacements();
        let (rates, after) = du.split_at_mut(2 * n);
        self.solid.stress(&state, work, after);
        // the history of materials changes at the end of a step only
        after.fill(0.0);
        let (velocity, acceleration) = rates.split_at_mut(n);
        velocity.copy_from_slice(&u[n..2 * n]);
        self.solid.forces(&state, work, acceleration.as_chunks_mut().0);
        for k in 0..n {
            let held = self.is_held(k);
            acceleration[k] = if held { 0.0 } else { acceleration[k] / self.mass(k) };
            velocity[k] = if held { 0.0 } else { velocity[k] };
        }
    }

    fn rates(&self, _: &f64, u: &[f64], _: &mut Work<D>, rate: &mut [f64]) {
        rate.fill(1.0 / self.stable_step(&u[..self.displacements()]));
    }

    fn largest_change(&self, _: &[f64], du: &[f64]) -> f64 {
        let spacing = &self.solid.particles.spacing;
        largest_size(self.displacements(), |k| du[k]) / minimum(spacing.len(), |i| spacing[i])
    }

    fn check(&self, _: &f64, u: &[f64]) -> Result<(), Fault> {
        let displacement: &[[f64; D]] = u[..self.displacements()].as_chunks().0;
        self.solid.check(displacement)
    }

    fn locate(&self, _: &f64, row: usize) -> Vec<f64> {
        let n = self.solid.len();
        self.solid.particles.x[row % n].0.to_vec()
    }
}

impl<const D: usize> Mechanical for Structure<D> {
    type Stiffness = Tangents<D>;

    fn displacements(&self) -> usize {
        self.solid.len() * D
    }

    fn mass(&self, k: usize) -> f64 {
        self.solid.mass()[k / D]
    }

    fn is_held(&self, k: usize) -> bool {
        self.solid.is_held(k / D, k % D)
    }

    fn hold(&self, time: f64, displacement: &mut [f64]) {
        self.solid.hold(time, displacement.as_chunks_mut().0);
    }

    fn forces(&self, at: &Moment<'_>, work: &mut Work<D>, force: &mut [f64], after: &mut [f64]) {
        let state = moment(at);
        self.solid.stress(&state, work, after);
        self.solid.forces(&state, work, force.as_chunks_mut().0);
    }

    fn check_forces(&self, work: &Work<D>, displacement: &[f64]) -> Result<(), Fault> {
        self.solid.check_stressed(displacement.as_chunks().0, work)
    }

    fn stable_step(&self, displacement: &[f64]) -> f64 {
        self.solid.stable_step(displacement.as_chunks().0)
    }

    fn linearise(&self, at: &Moment<'_>, parts: [f64; 2]) -> Tangents<D> {
        let mut tangents = self.solid.tangents();
        self.solid.linearise(&moment(at), parts, &mut tangents);
        tangents
    }

    fn damping(&self) -> Damping {
        let damping = self.solid.damping;
        Damping { mass: damping.mass, stiffness: damping.stiffness, is_viscous: self.solid.is_viscous() }
    }

    fn stiffness(&self, stiffness: &Tangents<D>, w: &[f64], work: &mut Work<D>, out: &mut [f64]) {
        self.solid.stiffness(stiffness, w.as_chunks().0, work, out.as_chunks_mut().0);
    }

    fn matrix(&self, stiffness: &Tangents<D>, scale: f64, shift: f64) -> Symmetric {
        self.solid.matrix_of(stiffness, scale, shift)
    }

    fn diagonal(&self, stiffness: &Tangents<D>) -> Vec<f64> {
        self.solid.diagonal_of(stiffness)
    }

    fn largest_factored(&self) -> usize {
        FACTORED[D - 2]
    }
}
