//! Springs: force on a single coordinate that depends on this coordinate only.
//!
//! With the elongation e beyond the free play, e = 0 for |q − r| ≤ g, otherwise q − r ∓ g, the restoring force of a
//! spring is k e + k₃ e³. r is the rest position and g half the free play. The energy is k e²/2 + k₃ e⁴/4.
use crate::math::jet::Scalar;

/// A spring on one coordinate; without a spring, all values are zero.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Spring {
    /// Linear stiffness k, force (moment) divided by displacement (angle).
    pub stiffness: f64,
    /// Cubic coefficient k₃, force divided by displacement cubed.
    pub cubic: f64,
    /// Half the free play g, in which the force is zero.
    pub play: f64,
    /// Rest position r.
    pub rest: f64,
}

impl Spring {
    /// A linear spring.
    pub fn linear(stiffness: f64) -> Self {
        Self { stiffness, ..Self::default() }
    }

    /// Elongation e at the coordinate `q`.
    fn elongation<S: Scalar>(&self, q: S) -> S {
        let from_rest = q - S::constant(self.rest);
        if self.play == 0.0 {
            return from_rest;
        }
        from_rest.map(|x| {
            let beyond = x.abs() - self.play;
            if beyond > 0.0 { [beyond.copysign(x), 1.0, 0.0] } else { [0.0; 3] }
        })
    }

    /// Restoring force k e + k₃ e³ at the coordinate `q`.
    pub fn force<S: Scalar>(&self, q: S) -> S {
        let e = self.elongation(q);
        e * (S::constant(self.stiffness) + S::constant(self.cubic) * e * e)
    }

    /// Elastic energy at the coordinate `q`.
    pub fn energy(&self, q: f64) -> f64 {
        let square = self.elongation(q).powi(2);
        square * (0.5 * self.stiffness + 0.25 * self.cubic * square)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn forces_are_slopes_of_energies() {
        let spring = Spring { stiffness: 2.0, cubic: 5.0, play: 0.3, rest: 0.1 };
        let h = 1e-5;
        for q in [-1.0, -0.25, 0.0, 0.39, 0.5, 1.3] {
            let slope = (spring.energy(q + h) - spring.energy(q - h)) / (2.0 * h);
            assert!((spring.force(q) - slope).abs() < 1e-8, "{q}");
        }
        assert_eq!(spring.force(0.35), 0.0);
        assert!((spring.force(0.5) - (2.0 * 0.1 + 5.0 * 1e-3)).abs() < 1e-15);
        assert!((spring.force(-0.3) + (2.0 * 0.1 + 5.0 * 1e-3)).abs() < 1e-15);
        assert_eq!(Spring::default().force(3.0), 0.0);
    }
}
