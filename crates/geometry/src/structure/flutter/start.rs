//! Motions that are unstable from the start: at every density, however small.
//!
//! To first order in the dynamic pressure p, the aerodynamic forces shift the root iω of a natural mode φ with φᵀMφ = 1
//! by
//!
//! dλ = p φᵀ Q(iκ) φ/(2iω), κ = ω/u,
//!
//! where the speed u does not vanish with p. The growth rate vanishes with p together with dλ. A motion is unstable
//! where the real part of dλ exceeds a small fraction of |dλ|, however small both are. Such a motion is neutral at p =
//! 0, and its flutter point lies there. Structural damping, which does not vanish with p, moves it to a positive
//! density. Branches that are unstable at the lowest density are therefore followed to lower densities.
//!
//! Limits: at constant density, κ increases without bound as the speed vanishes, and forces are not known there. No
//! flutter point is reported at zero speed then; [`Flutter::grows_from`] tells which motions are unstable from the
//! first reported point on.
//! zero then: [`Flutter::grows_from`] says which motions grow from the first point on that is told.
use num_complex::Complex64;

use super::{Branch, Crossing, FIRST, Flutter, Kind, Modes, NEUTRAL, Place, Point, Root, Varied, ZERO, growth};

/// Smallest ratio of growth rate and shift of the root for certain instability; the error of computed forces is of this
/// order.
const SURE: f64 = 1e-3;
/// Smallest ratio of growth rate and the shift that the largest of all forces would cause: a mode that is hardly
/// excited by the stream contains the errors of the others.
const FELT: f64 = 1e-4;
/// Greatest relative change of the root at the lowest density when it is followed from lower ones; a greater one means
/// another branch.
const SAME: f64 = 1e-6;

impl Flutter<'_> {
    /// Index of the first of the ascending points of natural mode `mode` at which it is unstable for certain and before
    /// which it does not decay; `None` where it decays first or is never unstable.
    pub fn grows_from(&self, mode: usize, points: &[Point]) -> Option<usize> {
        let modes = self.modes.as_ref()?;
        let mut growing = points.iter().take_while(|p| growth(p.lambda) > NEUTRAL);
        growing.position(|p| self.surely_grows(modes, mode, p))
    }

    /// True where the growth rate exceeds the effect of errors of the forces.
    fn surely_grows(&self, modes: &Modes, mode: usize, point: &Point) -> bool {
        let (rate, size) = (point.lambda.re, point.lambda.norm());
        let Some(forces) = self.modal(modes, point.lambda.im / point.speed) else { return false };
        let largest = forces.iter().map(|f| f.norm()).fold(0.0, f64::max);
        let moved = (point.lambda - natural(modes, mode)).norm();
        let would_move = self.pressure(point.x) * largest / (2.0 * size);
        rate > SURE * moved && rate > FELT * would_move
    }

    /// Flutter point at the start of the branch of natural mode `mode`: at zero, or where the instability ceases to be
    /// certain.
    pub(super) fn begun_at_the_start(&self, modes: &Modes, mode: usize, branch: &[Point]) -> Option<Crossing> {
        if let Varied::Speed = self.varied {
            return None;
        }
        let (x, near, frequency) = match self.grows_from(mode, branch)? {
            0 => (0.0, &branch[0], natural(modes, mode).im),
            sure => (branch[sure - 1].x, &branch[sure - 1], branch[sure - 1].lambda.im),
        };
        let (speed, pressure) = (self.speed(x), self.pressure(x));
        let (kind, branch, kappa) = (Kind::Flutter, Branch::Mode(mode), frequency / speed);
        let shape = near.shape.clone();
        Some(Crossing { kind, branch, mode, x, speed, pressure, frequency, kappa, shape })
    }

    /// Roots of natural mode `mode` from lower densities up to and including its first one, `start`; `None` where it is
    /// not unstable there, where the speed is varied, and where the roots belong to another branch.
    pub(super) fn followed_from_below(&self, modes: &Modes, mode: usize, start: &Root) -> Option<Vec<Root>> {
        let varied = matches!(self.varied, Varied::Pressure(_));
        // the root of a mode without stiffness vanishes with the pressure, and its damping ratio tends to a constant or
        // to zero
        let applies = varied && growth(start.lambda) > NEUTRAL && !modes.rigid().contains(&mode);
        let (mut x, last) = (FIRST * start.place.x, start.place.x);
        let mut roots = vec![self.begin(modes, mode, x).filter(|_| applies)?];
        while x < last {
            let next = (2.0 * x).min(last);
            let (path, arrived) = self.follow(modes, roots.last()?.clone(), Place { x: next, on: 1.0 }, x);
            roots.extend(path);
            x = if arrived { next } else { return None };
        }
        let found = roots.last()?.lambda;
        // where round-off hides growth, it hides decay too
        let hidden = roots.iter().take_while(|root| growth(root.lambda).abs() <= NEUTRAL).count();
        roots.drain(..hidden);
        ((found - start.lambda).norm() <= SAME * start.lambda.norm()).then_some(roots)
    }
}

/// Root λ of an undamped natural mode.
fn natural(modes: &Modes, mode: usize) -> Complex64 {
    let is_rigid = modes.rigid().contains(&mode);
    let square = modes.squares.get(mode).filter(|_| !is_rigid);
    square.map_or(ZERO, |square| Complex64::new(0.0, square.max(0.0).sqrt()))
}

#[cfg(test)]
mod tests {
    use super::super::super::Matrices;
    use super::*;

    /// One coordinate with the frequency 1 and the damping coefficient `damping`.
    fn one(damping: f64) -> Matrices {
        Matrices { mass: vec![1.0], damping: vec![damping], stiffness: vec![1.0] }
    }

    /// Crossings up to the density 4 with the constant force `force`.
    fn crossings(m: &Matrices, force: Complex64) -> Vec<Crossing> {
        let (forces, speed) = (|_: f64| vec![force], |_: f64| 0.5);
        let flutter = Flutter::new(m, &forces).varying(Varied::Pressure(&speed));
        flutter.crossings(&flutter.branches(4.0), 4.0)
    }

    #[test] // dλ = p Q/(2i): the part of growth in it is the same at every density, 1e-4 of the root at the first one
    fn damping_in_proportion_to_the_density_is_flutter_from_zero_on() {
        for force in [Complex64::new(-0.5, 0.02), Complex64::new(-5e-4, 2e-5), Complex64::new(0.0, 1e-5)] {
            let found = crossings(&one(0.0), force);
            assert!(found.len() == 1 && found[0].kind == Kind::Flutter, "{force}: {found:?}");
            let c = &found[0];
            assert_eq!((c.x, c.pressure, c.speed, c.frequency, c.kappa), (0.0, 0.0, 0.5, 1.0, 2.0));
            assert!(c.branch == Branch::Mode(0) && (c.shape[0].norm() - 1.0).abs() < 1e-12);
            assert!(crossings(&one(0.0), force.conj()).is_empty());
        }
        // no more than an error of the forces
        assert!(crossings(&one(0.0), Complex64::new(-0.5, 2e-4)).is_empty());
        assert!(crossings(&one(0.0), Complex64::new(-0.5, 0.0)).is_empty());
    }

    #[test] // −ω² + 1 + p/2 = 0 and c ω = p/100
    fn little_structural_damping_moves_it_to_the_density_where_both_are_in_balance() {
        for damping in [1e-7, 2e-6, 2e-5, 2e-4] {
            let found = crossings(&one(damping), Complex64::new(-0.5, 0.01));
            assert!(found.len() == 1 && found[0].kind == Kind::Flutter, "{damping}: {found:?}");
            let (p, omega) = (found[0].x, found[0].frequency);
            assert!((omega * omega - 1.0 - 0.5 * p).abs() < 1e-9, "{found:?}");
            assert!((0.01 * p / (damping * omega) - 1.0).abs() < 1e-5, "{damping}: {found:?}");
        }
    }

    #[test]
    fn a_mode_that_hardly_feels_the_stream_is_not_judged_by_what_is_left_of_others() {
        let unit = |a: f64, b: f64| vec![a, 0.0, 0.0, b];
        let m = Matrices { mass: unit(1.0, 1.0), damping: unit(0.0, 0.0), stiffness: unit(1.0, 4.0) };
        let found = |noise: f64| {
            let forces = |_: f64| {
                let [none, own, small] = [(0.0, 0.0), (-0.5, -0.3), (0.0, noise)].map(|(a, b)| Complex64::new(a, b));
                vec![small, none, none, own]
            };
            let speed = |_: f64| 0.5;
            let flutter = Flutter::new(&m, &forces).varying(Varied::Pressure(&speed));
            flutter.crossings(&flutter.branches(1.0), 1.0)
        };
        assert!(found(1e-5).is_empty(), "{:?}", found(1e-5));
        assert!(found(1e-2).len() == 1 && found(1e-2)[0].x == 0.0, "{:?}", found(1e-2));
    }

    #[test]
    fn speeds_have_no_crossing_at_zero_but_growth_from_the_first_point_on_is_told() {
        let m = one(0.0);
        for (growth, place) in [(0.004, Some(0)), (-0.004, None)] {
            let forces = |kappa: f64| vec![Complex64::new(-0.5, growth * kappa)];
            let flutter = Flutter::new(&m, &forces);
            let branches = flutter.branches(4.0);
            assert!(flutter.crossings(&branches, 4.0).is_empty());
            // growth is a small part of the root there
            let told = &branches[0][60..];
            assert!(growth < 0.0 || told[0].lambda.re < 3e-3 * told[0].lambda.norm());
            assert_eq!(flutter.grows_from(0, told), place);
        }
    }
}
