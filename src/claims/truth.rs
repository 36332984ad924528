//! Exact solutions by name: what a claim's `exact` and a case's `[initial]` stand for.
use super::claim::Exact;
use crate::case::Initial;
use crate::exact::potential::{CircleFlow, SphereFlow};
use crate::exact::riemann::{RiemannProblem, State};
use crate::exact::ringleb::Ringleb;
use crate::exact::vortex::IsentropicVortex;
use crate::exact::{Error, GasState};
use crate::math::Vector;

/// Exact wall pressure of a named body.
#[derive(Clone, Debug)]
pub enum WallTruth {
    /// Circle.
    Circle(CircleFlow),
    /// Sphere.
    Sphere(SphereFlow),
}

impl WallTruth {
    /// The solution that `exact` names at free-stream Mach number `mach`.
    pub fn new(exact: Exact, mach: f64, gamma: f64) -> Result<Self, Error> {
        Ok(match exact {
            Exact::Circle => Self::Circle(CircleFlow::new(mach, gamma)?),
            Exact::Sphere => Self::Sphere(SphereFlow::new(mach, gamma)?),
        })
    }

    /// Pressure coefficient at `offset` from the centre of the body in a stream along `direction`.
    pub fn pressure_coefficient<const D: usize>(&self, offset: &Vector<D>, direction: &Vector<D>) -> f64 {
        let theta = offset.unit().dot(&direction.unit()).clamp(-1.0, 1.0).acos();
        match self {
            Self::Circle(flow) => flow.surface_pressure_coefficient(theta),
            Self::Sphere(flow) => flow.surface_pressure_coefficient(theta),
        }
    }
}

/// Exact field that starts as a case's `[initial]`.
#[derive(Clone, Copy, Debug)]
pub enum FieldTruth {
    /// Riemann problem across `axis`, membrane at `position`.
    Riemann {
        /// The solved problem.
        problem: RiemannProblem,
        /// Place of the membrane at the start.
        position: f64,
        /// Axis across it.
        axis: usize,
    },
    /// Advected vortex.
    Vortex(IsentropicVortex),
    /// Ringleb's steady flow.
    Ringleb(Ringleb),
}

impl FieldTruth {
    /// The exact solution that starts as `initial`; `None` for a free stream and for formulas. `period` is the extent of a periodic domain.
    pub fn new(initial: &Initial, gamma: f64, period: Option<Vector<2>>) -> Result<Option<Self>, Error> {
        Ok(match initial {
            Initial::FreeStream | Initial::Formula { .. } => None,
            Initial::Riemann { left, right, position, axis } => {
                let state = |s: &[f64; 3]| State::new(s[0], s[1], s[2]);
                let problem = RiemannProblem::new(state(left), state(right), gamma)?;
                Some(Self::Riemann { problem, position: *position, axis: usize::from(*axis) })
            }
            Initial::Vortex { strength, centre, velocity } => {
                let vortex = IsentropicVortex::new(*strength, Vector(*centre), Vector(*velocity), gamma)?;
                Some(Self::Vortex(period.map_or(vortex, |p| vortex.periodic(p))))
            }
            Initial::Ringleb => Some(Self::Ringleb(Ringleb::new(gamma)?)),
        })
    }

    /// The gas at `x` and time `t`.
    pub fn state(&self, x: &Vector<2>, t: f64) -> Result<GasState<2>, Error> {
        match self {
            Self::Riemann { problem, position, axis } => {
                let along = (*axis).min(1);
                let s = problem.state(x[along], t, *position);
                let velocity = Vector::axis(along) * s.velocity;
                Ok(GasState { density: s.density, velocity, pressure: s.pressure })
            }
            Self::Vortex(vortex) => Ok(vortex.state(x, t)),
            Self::Ringleb(flow) => flow.state(x),
        }
    }

    /// Where the right-most shock stands at time `t`, with the pressures behind and ahead of it.
    ///
    /// The left wave stands in when the right one is a rarefaction or has no strength.
    pub fn shock(&self, t: f64) -> Option<(f64, [f64; 2])> {
        /// Relative jump of pressure below which a wave has no strength.
        const NO_JUMP: f64 = 1e-3;
        let Self::Riemann { problem, position, .. } = self else { return None };
        let star = problem.star().pressure;
        let strong = |outer: f64| (star / outer - 1.0).abs() > NO_JUMP;
        let (left, right) = (problem.left().pressure, problem.right().pressure);
        let from_right =
            problem.right_shock_position(*position, t).filter(|_| strong(right)).map(|x| (x, [star, right]));
        from_right
            .or_else(|| problem.left_shock_position(*position, t).filter(|_| strong(left)).map(|x| (x, [left, star])))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn riemann(left: [f64; 3], right: [f64; 3]) -> FieldTruth {
        let initial = Initial::Riemann { left, right, position: 0.5, axis: 0 };
        FieldTruth::new(&initial, 1.4, None).unwrap().unwrap()
    }

    #[test]
    fn shocks_of_the_tubes() {
        let (x, levels) = riemann([1.0, 0.0, 1.0], [0.125, 0.0, 0.1]).shock(0.2).unwrap();
        assert!((x - 0.85043114).abs() < 1e-7 && (levels[0] - 0.3031301781).abs() < 1e-9 && levels[1] == 0.1);
        // a shock at rest at Mach 1.3: it faces left, the right wave has no strength
        let u = 1.3 * 1.4_f64.sqrt();
        let (density, pressure) = (1.515_695_067_264_574, 1.805);
        let (x, levels) = riemann([1.0, u, 1.0], [density, u / density, pressure]).shock(2.0).unwrap();
        assert!((x - 0.5).abs() < 1e-9 && levels[0] == 1.0, "{x} {levels:?}");
        assert!(riemann([1.0, -2.0, 0.4], [1.0, 2.0, 0.4]).shock(0.1).is_none());
    }

    #[test]
    fn fields_by_name() {
        assert!(FieldTruth::new(&Initial::FreeStream, 1.4, None).unwrap().is_none());
        let vortex = Initial::Vortex { strength: 5.0, centre: [5.0, 5.0], velocity: [1.0, 1.0] };
        let field = FieldTruth::new(&vortex, 1.4, Some(Vector([10.0, 10.0]))).unwrap().unwrap();
        assert!((field.state(&Vector([0.0, 0.0]), 5.0).unwrap().density - 0.4938073).abs() < 1e-7);
        let ringleb = FieldTruth::new(&Initial::Ringleb, 1.4, None).unwrap().unwrap();
        assert!(ringleb.state(&Vector([-1.25, 0.5]), 0.0).unwrap().density < 1.0);
    }

    #[test]
    fn wall_pressure_by_name() {
        let sphere = WallTruth::new(Exact::Sphere, 0.3, 1.4).unwrap();
        let stream = Vector([1.0, 0.0, 0.0]);
        assert!((sphere.pressure_coefficient(&Vector([-0.5, 0.0, 0.0]), &stream) - 1.022703).abs() < 1e-6);
        let circle = WallTruth::new(Exact::Circle, 0.3, 1.4).unwrap();
        assert!((circle.pressure_coefficient(&Vector([0.0, 0.5]), &Vector([2.0, 0.0])) + 3.2785967).abs() < 1e-5);
    }
}
