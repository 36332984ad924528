//! Springs: the force on one coordinate that depends on it alone.
//!
//! With the elongation e beyond the play, e = 0 for |q − r| ≤ g, else q − r ∓ g, a spring pulls back with k e + k₃ e³. The rest
//! position r is where it is at ease, g is half the gap of the play. Its energy is k e²/2 + k₃ e⁴/4.
use crate::math::jet::Scalar;

/// A spring on one coordinate; all zeros: none.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Spring {
    /// k, force (moment) over displacement (angle).
    pub stiffness: f64,
    /// k₃, force over displacement cubed.
    pub cubic: f64,
    /// g, half the gap in which the spring does nothing.
    pub play: f64,
    /// r, where the spring is at ease.
    pub rest: f64,
}

impl Spring {
    /// A linear spring.
    pub fn linear(stiffness: f64) -> Self {
        Self { stiffness, ..Self::default() }
    }

    /// e of the coordinate `q`.
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

    /// k e + k₃ e³, the force that the spring resists with.
    pub fn force<S: Scalar>(&self, q: S) -> S {
        let e = self.elongation(q);
        e * (S::constant(self.stiffness) + S::constant(self.cubic) * e * e)
    }

    /// Energy stored in the spring.
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
