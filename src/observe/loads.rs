//! Forces and moments on the bodies, twice.
//!
//! From wall pressure: F = −Σ (p − p∞) S over interface particles. From the momentum balance of the fluid between the body and
//! a box around it: F = −∮ [ρ v (v·n) + (p − p∞) n] dS, which knows nothing of the wall. The difference is an error estimate
//! that every run reports.
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
        let r: [f64; 3] = std::array::from_fn(|d| x[d] - self.moment_point[d]);
        (0..3).for_each(|d| load.force[d] += f[d]);
        // 2-D: nose up is clockwise for a stream along +x; 3-D: nose up is about +y, lift along +z
        load.moment += match self.dimension {
            2 => r[1] * f[0] - r[0] * f[1],
            _ => r[2] * f[0] - r[0] * f[2],
        };
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

/// Load of excess pressures on area vectors (both into the fluid).
pub fn pressure_load(axes: &LoadAxes, points: &[[f64; 3]], areas: &[[f64; 3]], excess: &[f64]) -> Load {
    let mut load = Load::default();
    for ((x, s), p) in points.iter().zip(areas).zip(excess) {
        axes.add(&mut load, x, &s.map(|c| -c * p));
    }
    load
}

/// A piece of the box around the bodies: state and outward area vector.
#[derive(Clone, Copy, Debug)]
pub struct Patch {
    /// Middle.
    pub x: [f64; 3],
    /// Outward area vector.
    pub area: [f64; 3],
    /// Density.
    pub density: f64,
    /// Velocity.
    pub velocity: [f64; 3],
    /// Pressure minus free-stream pressure.
    pub excess: f64,
    /// Total enthalpy per mass.
    pub enthalpy: f64,
}

/// What passes a closed surface around the bodies.
#[derive(Clone, Copy, Debug, Default)]
pub struct Balance {
    /// Load on what is inside.
    pub load: Load,
    /// Net mass flow outward.
    pub mass: f64,
    /// Net energy flow outward.
    pub energy: f64,
    /// Mass flow inward alone.
    pub mass_in: f64,
    /// Energy flow inward alone.
    pub energy_in: f64,
}

/// Sums the fluxes of mass, momentum and energy over the patches.
pub fn momentum_balance(axes: &LoadAxes, patches: &[Patch]) -> Balance {
    let mut sum = Balance::default();
    for p in patches {
        let flow = p.density * (0..3).map(|d| p.velocity[d] * p.area[d]).sum::<f64>();
        let f = std::array::from_fn(|d| -(flow * p.velocity[d] + p.excess * p.area[d]));
        axes.add(&mut sum.load, &p.x, &f);
        sum.mass += flow;
        sum.energy += flow * p.enthalpy;
        if flow < 0.0 {
            sum.mass_in -= flow;
            sum.energy_in -= flow * p.enthalpy;
        }
    }
    sum
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

    #[test]
    fn uniform_flow_through_a_closed_box_makes_no_load() {
        let side = |x: [f64; 3], area: [f64; 3]| Patch {
            x,
            area,
            density: 1.2,
            velocity: [0.5, 0.1, 0.0],
            excess: 0.0,
            enthalpy: 3.0,
        };
        let patches = [
            side([1.0, 0.0, 0.0], [2.0, 0.0, 0.0]),
            side([-1.0, 0.0, 0.0], [-2.0, 0.0, 0.0]),
            side([0.0, 1.0, 0.0], [0.0, 2.0, 0.0]),
            side([0.0, -1.0, 0.0], [0.0, -2.0, 0.0]),
        ];
        let b = momentum_balance(&axes(), &patches);
        assert!(b.mass.abs() < 1e-15 && b.load.force.iter().all(|f| f.abs() < 1e-15));
    }
}
