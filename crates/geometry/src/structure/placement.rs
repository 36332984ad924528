//! Positions of the points of a body for given coordinates, and virtual work of forces.
//!
//! x(X, q) = p + d + R (X' + Σ q_m φ_m(X) − p). Ahead of a hinge X' = X; behind it X' = X + w (R_β − 1)(X − l), where w
//! increases from 0 to 1 over the blend length. By virtual work, a force F at the point X has the generalised forces
//! Q_k = F · ∂x/∂q_k. The caller evaluates the mode shapes φ_m: they are passed as the list `bends` of displacements at
//! X for unit coordinates, empty for rigid bodies.
use crate::math::Vector;

/// A rotation followed by a translation, x = R X + s.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pose<const D: usize> {
    /// Rows of R.
    pub rotation: [Vector<D>; D],
    /// Translation s.
    pub shift: Vector<D>,
}

/// Effect of a coordinate on the points.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Effect<const D: usize> {
    /// The same displacement of all points along this direction.
    Shift(Vector<D>),
    /// A rotation with these rows of the derivative of R.
    Turn([Vector<D>; D]),
    /// Rotation of the flap.
    Flap,
    /// Displacement in this mode.
    Mode(usize),
}

/// A deflected flap.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct TurnedFlap<const D: usize> {
    pub(super) hinge: Vector<D>,
    pub(super) blend: f64,
    /// Rows of R_β.
    pub(super) rotation: [Vector<D>; D],
    /// Rows of dR_β/dβ.
    pub(super) derivative: [Vector<D>; D],
}

/// The position of a body for given coordinates.
#[derive(Clone, Debug, PartialEq)]
pub struct Placement<const D: usize> {
    pub(super) pivot: Vector<D>,
    pub(super) rotation: [Vector<D>; D],
    pub(super) shift: Vector<D>,
    pub(super) flap: Option<TurnedFlap<D>>,
    pub(super) amplitudes: Vec<f64>,
    pub(super) effects: Vec<Effect<D>>,
}

fn times<const D: usize>(rows: &[Vector<D>; D], x: &Vector<D>) -> Vector<D> {
    Vector::from_fn(|d| rows[d].dot(x))
}

impl<const D: usize> TurnedFlap<D> {
    /// Blend weight w at `x`: 0 ahead of the hinge, 1 behind it, a cubic in between.
    fn weight(&self, x: &Vector<D>) -> f64 {
        let behind = x[0] - self.hinge[0];
        if self.blend == 0.0 {
            return if behind > 0.0 { 1.0 } else { 0.0 };
        }
        let part = (behind / self.blend + 0.5).clamp(0.0, 1.0);
        part * part * (3.0 - 2.0 * part)
    }

    fn displacement(&self, x: &Vector<D>) -> Vector<D> {
        let arm = *x - self.hinge;
        (times(&self.rotation, &arm) - arm) * self.weight(x)
    }
}

impl<const D: usize> Placement<D> {
    /// Rigid motion of the body, without flap and modes.
    pub fn pose(&self) -> Pose<D> {
        Pose { rotation: self.rotation, shift: self.pivot + self.shift - times(&self.rotation, &self.pivot) }
    }

    /// Coordinates of all modes, in their order.
    pub fn amplitudes(&self) -> &[f64] {
        &self.amplitudes
    }

    /// True when the body deforms, by a flap or by modes.
    pub fn bends(&self) -> bool {
        self.flap.is_some() || !self.amplitudes.is_empty()
    }

    /// The point `x` in body axes, after deformation.
    fn bent(&self, x: &Vector<D>, bends: &[Vector<D>]) -> Vector<D> {
        let flap = self.flap.as_ref().map_or(Vector::ZERO, |f| f.displacement(x));
        self.amplitudes.iter().zip(bends).fold(*x + flap, |sum, (q, bend)| sum + *bend * *q)
    }

    /// Position of the point that is at `x` in the initial placement.
    pub fn point(&self, x: &Vector<D>, bends: &[Vector<D>]) -> Vector<D> {
        let bent = self.bent(x, bends);
        let arm = bent - self.pivot;
        // in this order, a body that has not moved keeps its position to the last bit
        bent + self.shift + (times(&self.rotation, &arm) - arm)
    }

    /// ∂x/∂q_k at the point that is at `x` in the initial placement, for every unknown coordinate.
    pub fn tangents<'a>(
        &'a self,
        x: &'a Vector<D>,
        bends: &'a [Vector<D>],
    ) -> impl Iterator<Item = Vector<D>> + use<'a, D> {
        let arm = self.bent(x, bends) - self.pivot;
        self.effects.iter().map(move |effect| match effect {
            Effect::Shift(direction) => *direction,
            Effect::Turn(derivative) => times(derivative, &arm),
            Effect::Mode(m) => times(&self.rotation, &bends[*m]),
            Effect::Flap => self.flap.as_ref().map_or(Vector::ZERO, |flap| {
                times(&self.rotation, &(times(&flap.derivative, &(*x - flap.hinge)) * flap.weight(x)))
            }),
        })
    }

    /// Velocity of this point for the given rates of the coordinates.
    pub fn velocity(&self, x: &Vector<D>, bends: &[Vector<D>], rates: &[f64]) -> Vector<D> {
        self.tangents(x, bends).zip(rates).fold(Vector::ZERO, |sum, (tangent, rate)| sum + tangent * *rate)
    }

    /// Adds the generalised forces of the force `force` at this point to `load`.
    pub fn add_work(&self, x: &Vector<D>, bends: &[Vector<D>], force: &Vector<D>, load: &mut [f64]) {
        for (tangent, load) in self.tangents(x, bends).zip(load) {
            *load += force.dot(&tangent);
        }
    }
}
