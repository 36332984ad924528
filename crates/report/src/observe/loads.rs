//! Forces and moments on the bodies, twice.
//!
//! From wall pressure: F = −Σ (p − p∞) S over interface particles, with friction Σ τ·S besides. From the momentum balance of the
//! gas around the bodies (`scheme::balance`), which knows nothing of the wall. The difference is an error estimate that every
//! run reports.
use serde::Serialize;

/// Force and moment coefficients.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, serde::Deserialize)]
pub struct Coefficients {
    /// Lift.
    pub cl: f64,
    /// Drag.
    pub cd: f64,
    /// Moment about the reference point, nose up positive.
    pub cm: f64,
}

/// What turns forces into coefficients; everything in the units of the solver.
#[derive(Clone, Debug)]
pub struct LoadAxes {
    /// 2 or 3.
    pub dimension: usize,
    /// Direction of drag.
    pub drag: [f64; 3],
    /// Direction of lift.
    pub lift: [f64; 3],
    /// Point of the moment.
    pub moment_point: [f64; 3],
    /// Free-stream dynamic pressure times reference area (2-D: length).
    pub force_scale: f64,
    /// Reference length of the moment.
    pub chord: f64,
}

/// A force and its moment about the reference point.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Load {
    /// Force.
    pub force: [f64; 3],
    /// Moment, nose up positive.
    pub moment: f64,
}

impl LoadAxes {
    /// Adds the force `f` acting at `x`.
    pub fn add(&self, load: &mut Load, x: &[f64; 3], f: &[f64; 3]) {
        (0..3).for_each(|d| load.force[d] += f[d]);
        self.turn(load, &std::array::from_fn(|d| x[d] - self.moment_point[d]), f);
    }

    /// Adds the moment r × f alone.
    pub fn turn(&self, load: &mut Load, r: &[f64; 3], f: &[f64; 3]) {
        // 2-D: nose up is clockwise for a stream along +x; 3-D: nose up is about +y, lift along +z
        load.moment += match self.dimension {
            2 => r[1] * f[0] - r[0] * f[1],
            _ => r[2] * f[0] - r[0] * f[2],
        };
    }

    /// Adds a couple; in the plane there is none but about the third axis, which a vector in the plane does not hold.
    pub fn twist(&self, load: &mut Load, couple: &[f64; 3]) {
        load.moment += if self.dimension == 2 { 0.0 } else { couple[1] };
    }

    /// Coefficients of a load; zeros when there is no stream.
    pub fn coefficients(&self, load: &Load) -> Coefficients {
        if self.force_scale == 0.0 {
            return Coefficients::default();
        }
        let along = |d: &[f64; 3]| (0..3).map(|k| load.force[k] * d[k]).sum::<f64>() / self.force_scale;
        Coefficients { cl: along(&self.lift), cd: along(&self.drag), cm: load.moment / (self.force_scale * self.chord) }
    }
}

/// Sum of two loads.
pub fn together(a: &Load, b: &Load) -> Load {
    Load { force: std::array::from_fn(|d| a.force[d] + b.force[d]), moment: a.moment + b.moment }
}

/// What passes a zone around the bodies.
#[derive(Clone, Copy, Debug, Default)]
pub struct Balance {
    /// Load on what is inside.
    pub load: Load,
    /// Net mass flow outward.
    pub mass: f64,
    /// Net energy flow outward.
    pub energy: f64,
    /// Mass and energy that pass, inward and outward together.
    pub passed: [f64; 2],
}

#[cfg(test)]
mod tests {
    use super::*;

    fn axes() -> LoadAxes {
        LoadAxes {
            dimension: 2,
            drag: [1.0, 0.0, 0.0],
            lift: [0.0, 1.0, 0.0],
            moment_point: [0.25, 0.0, 0.0],
            force_scale: 0.5,
            chord: 1.0,
        }
    }

    #[test]
    fn lift_behind_the_reference_point_is_nose_down() {
        let mut load = Load::default();
        axes().add(&mut load, &[0.75, 0.0, 0.0], &[0.0, 1.0, 0.0]);
        let c = axes().coefficients(&load);
        assert_eq!((c.cl, c.cd, c.cm), (2.0, 0.0, -1.0));
    }
}
