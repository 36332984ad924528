//! Forces of the gas on the coordinates of bodies that move a little and periodically about a steady flow.
//!
//! With coordinates q = q̂ e^{iωt} the gas obeys (iω − ∂R/∂U) û = ∂R/∂q + iω ∂R/∂q' − ω² ∂R/∂q'', where places, velocities and
//! accelerations of walls and cloud go with q, q' and q''; the generalised forces are Q = ∂F/∂U û + ∂F/∂q + iω ∂F/∂q' − ω² ∂F/∂q''.
//! The cloud, the steady flow and the three derivatives serve all frequencies, one preconditioner all coordinates of a frequency.
use num_complex::Complex64;

use super::super::look::{GasView, Held, LoadFrame, Mesh, Rim};
use super::steady::is_supersonic;
use super::swing::{Flow, swing};
use crate::coupling::{Attached, Marches};
use crate::math::reduce::norm;
use crate::scheme::Fluid;
use crate::structure::limit_cycle::Periodic;
use crate::structure::{Matrices, Spring};
use crate::system::{Hierarchy, Instant, System, Term};
use crate::time::control::Control;
use crate::time::linear::{Ended, Linear};

/// Displacement, rate and acceleration that derivatives are differences over, in units of a coordinate.
const STEP: f64 = 1e-5;
/// Change of the state in derivatives of forces, over its size.
const OF_STATE: f64 = 1e-6;
/// Relative residual of the linear systems, which leaves forces right to a ten-thousandth.
const TOLERANCE: f64 = 1e-5;
/// That above which a column does not count as found.
pub(crate) const SOLVED: f64 = 1e1 * TOLERANCE;
/// Coefficients behind generalised forces: of lift and moment.
const COEFFICIENTS: usize = 2;

/// Frequencies in the order in which forces are asked for: rising, but rest after the lowest one. A solution at rest found from nothing
/// takes four to five times the linear iterations of others, for modes of the flow that hardly decay; from that at a low frequency,
/// which is near to it and has them, no more than others: 22 in place of 110 for a wing of 62,000 particles at Mach 0.6.
pub(crate) fn in_order(frequencies: &[f64]) -> Vec<f64> {
    let mut all = frequencies.to_vec();
    all.sort_by(f64::total_cmp);
    let rest = all.iter().take_while(|k| **k == 0.0).count();
    if rest < all.len() {
        all[..=rest].rotate_left(rest);
    }
    all
}

/// A steady flow that can be asked for forces.
pub(crate) trait ForceSource {
    /// Matrices of the structures about the coordinates of the steady flow, in units of the solver.
    fn matrices(&self) -> Matrices;
    /// Names of the coordinates.
    fn names(&self) -> Vec<String>;
    /// The coordinates of the steady flow.
    fn still(&self) -> Vec<f64>;
    /// Generalised forces of the steady flow on all coordinates.
    fn borne(&self) -> Vec<f64>;
    /// Springs of all coordinates, in displacements from the same.
    fn springs(&self) -> Vec<Spring>;
    /// Generalised forces on all coordinates in the motion `motion` of angular frequency `omega` about the steady flow, beyond those of the latter;
    /// else what stands in the way.
    fn swing(&mut self, motion: &Periodic, omega: f64) -> Result<Periodic, String>;
    /// Forces per coordinate at the angular frequency `omega`; `None` where `stop` says so before all are found.
    fn forces_unless(&mut self, omega: f64, stop: &dyn Fn() -> bool) -> Option<Forces>;
    /// True where the steady flow is faster than sound somewhere: then it has shocks.
    fn is_supersonic(&mut self) -> bool;
    /// The walls of the steady flow, and how each coordinate moves them.
    fn walls(&self) -> MovingWalls;
    /// q∞ S c: free-stream dynamic pressure, reference area (in the plane chord) and chord, in units of the solver.
    fn work_scale(&mut self) -> f64;
}

/// Forces of small motions at one frequency, in units of the solver.
#[derive(Clone, Debug, Default)]
pub(crate) struct Forces {
    /// Generalised forces per coordinate, rows one after another.
    pub(crate) generalised: Vec<Complex64>,
    /// Lift and moment coefficients per coordinate.
    pub(crate) coefficients: Vec<[Complex64; 2]>,
    /// Pressure on each wall particle, per coordinate.
    pub(crate) pressures: Vec<Vec<Complex64>>,
    /// How each column was found.
    pub(crate) ended: Vec<Ended>,
}

/// Wall particles where the steady flow has them, and how they move.
#[derive(Clone, Debug, Default)]
pub(crate) struct MovingWalls {
    /// Places.
    pub(crate) points: Vec<[f64; 3]>,
    /// Outlines in the plane.
    pub(crate) lines: Vec<Vec<u32>>,
    /// Triangles in space.
    pub(crate) triangles: Vec<[u32; 3]>,
    /// Displacement of each per coordinate.
    pub(crate) moves: Vec<Vec<[f64; 3]>>,
}

/// What displacement, rate and acceleration of a coordinate do to the gas and to the forces.
struct Column {
    gas: [Vec<f64>; 3],
    force: [Vec<f64>; 3],
    /// Displacements of wall particles.
    moves: Vec<[f64; 3]>,
}

/// The forces of a system about a state.
pub(crate) struct SmallMotion<'a, S: Marches<D>, const D: usize> {
    system: &'a S,
    frame: S::Frame,
    work: S::Work,
    state: Vec<f64>,
    linear: Linear<'a, Fluid<D>>,
    columns: Vec<Column>,
    axes: LoadFrame,
    /// Forces, coefficients and pressures in the steady flow, and the last periodic one.
    still: Vec<f64>,
    flow: Option<Flow>,
}

impl<'a, S: Marches<D>, const D: usize> SmallMotion<'a, S, D> {
    /// `system` at the steady state `state`; `axes` are those of lift and moment. The limiter stays what it is there where it is `frozen`.
    pub(crate) fn new(system: &'a S, state: &[f64], (axes, frozen): (&LoadFrame, bool)) -> Self {
        let mut work = system.work();
        let frame = system.frame(&Instant::formula(0.0, &[]).with(&system.placing().values(state)), state);
        let (gas, own) = (system.gas(), system.gas_state(state));
        let (gas_frame, mut gas_work) = (system.gas_frame(&frame).clone(), gas.work());
        if frozen {
            gas.freeze_limiter(&gas_frame, own, system.gas_work(&mut work));
            gas.freeze_limiter(&gas_frame, own, &mut gas_work);
        }
        let linear = Linear::new(gas, gas_frame, own, gas_work);
        let (columns, still) = (Vec::new(), Vec::new());
        let mut all =
            Self { system, frame, work, state: state.to_vec(), linear, columns, axes: axes.clone(), still, flow: None };
        all.still = all.loads(state);
        let units = units(system.attached());
        all.columns = units.iter().enumerate().map(|(j, unit)| all.column(j, STEP * unit)).collect();
        all
    }

    /// What the coordinate number `j` does, by central differences over `step`.
    fn column(&mut self, j: usize, step: f64) -> Column {
        let still = self.system.placing().values(&self.state).into_owned();
        let moved = |part: usize, by: f64| {
            let mut all = still.clone();
            all[2 * j + part] += by;
            all
        };
        // elsewhere; there with a rate; there with an acceleration
        let mut places = Vec::new();
        let displaced = [1.0, -1.0].map(|sign| {
            let found = self.response(&moved(0, sign * step), &[]);
            places.push(self.places());
            found
        });
        let by_formula = |this: &mut Self, part: usize, sign: f64| {
            let ends = [moved(part, step), moved(part, -step)];
            let term = |k: usize, c: f64| Term { coefficient: sign * c, time: 0.0, coordinates: &ends[k] };
            this.response(&still, &[term(0, 0.5), term(1, -0.5)])
        };
        let fast = [1.0, -1.0].map(|sign| by_formula(self, 0, sign));
        let hurried = [1.0, -1.0].map(|sign| by_formula(self, 1, sign));
        let slope = |[a, b]: &[(Vec<f64>, Vec<f64>); 2]| {
            let of = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| (a - b) / (2.0 * step)).collect::<Vec<f64>>();
            (of(&a.0, &b.0), of(&a.1, &b.1))
        };
        let [(a, fa), (b, fb), (c, fc)] = [&displaced, &fast, &hurried].map(slope);
        let way = |(a, b): (&[f64; 3], &[f64; 3])| [0, 1, 2].map(|d| (a[d] - b[d]) / (2.0 * step));
        let moves = places[0].iter().zip(&places[1]).map(way).collect();
        Column { gas: [a, b, c], force: [fa, fb, fc], moves }
    }

    /// Places of the wall particles in the frame as it stands.
    fn places(&self) -> Vec<[f64; 3]> {
        let frame = self.system.gas_frame(&self.frame);
        self.system.gas().discretisation.cloud.interface_range().map(|i| frame.place(i).to_3d()).collect()
    }

    /// R and forces where the coordinates are `coordinates` and ∂/∂t is `terms`.
    fn response(&mut self, coordinates: &[f64], terms: &[Term<'_>]) -> (Vec<f64>, Vec<f64>) {
        let mut u = self.state.clone();
        self.system.placing().set(coordinates, &mut u);
        self.system.place(&Instant::formula(0.0, terms).with(coordinates), &mut self.frame);
        let mut du = vec![0.0; u.len()];
        self.system.rhs(&self.frame, &u, &mut self.work, &mut du);
        let loads = self.loads(&u);
        (du[self.system.gas_unknowns()].to_vec(), loads)
    }

    /// Generalised forces on all coordinates at the state `u`, then the coefficients of lift and moment, then the pressures on all wall
    /// particles.
    fn loads(&mut self, u: &[f64]) -> Vec<f64> {
        let mut all = self.system.generalised_forces(&self.frame, u, &mut self.work);
        let (view, work) = (GasView::of(self.system, &self.frame, u), self.system.gas_work(&mut self.work));
        let coefficients = view.coefficients(&self.axes, work).unwrap_or_default();
        all.extend([coefficients.cl, coefficients.cm]);
        // those that the coefficients were found from
        let walls = self.system.gas().discretisation.cloud.interface_range();
        all.extend(walls.map(|i| work.state.get(i).map_or(0.0, |q| q.pressure)));
        all
    }

    /// ∂F/∂U v.
    fn force_of(&mut self, v: &[f64]) -> Vec<f64> {
        let size = norm(v);
        if size == 0.0 {
            return vec![0.0; self.still.len()];
        }
        let (own, step) = (self.system.gas_unknowns(), OF_STATE * norm(self.system.gas_state(&self.state)) / size);
        let sides = [1.0, -1.0].map(|sign| {
            let mut u = self.state.clone();
            u[own.clone()].iter_mut().zip(v).for_each(|(u, v)| *u += sign * step * v);
            self.loads(&u)
        });
        sides[0].iter().zip(&sides[1]).map(|(a, b)| (a - b) / (2.0 * step)).collect()
    }
}

impl<S: Marches<D>, const D: usize> ForceSource for SmallMotion<'_, S, D> {
    fn matrices(&self) -> Matrices {
        let n = self.columns.len();
        let mut all = Matrices { mass: vec![0.0; n * n], damping: vec![0.0; n * n], stiffness: vec![0.0; n * n] };
        for body in Attached::distinct(self.system.attached()) {
            let (m, first) = (body.structure.len(), body.first);
            let own = self.system.placing().values(&self.state);
            let q: Vec<f64> = (0..m).map(|k| own[2 * (first + k)]).collect();
            let own = body.structure.matrices(&q, &vec![0.0; m]);
            let pairs =
                [(&mut all.mass, own.mass), (&mut all.damping, own.damping), (&mut all.stiffness, own.stiffness)];
            for (whole, part) in pairs {
                for (k, x) in part.iter().enumerate() {
                    whole[(first + k / m) * n + first + k % m] = *x;
                }
            }
        }
        all
    }

    fn names(&self) -> Vec<String> {
        let all = Attached::distinct(self.system.attached()).flat_map(|b| b.structure.coordinates());
        all.map(|c| c.name.clone()).collect()
    }

    fn still(&self) -> Vec<f64> {
        self.system.placing().values(&self.state).iter().step_by(2).copied().collect()
    }

    fn springs(&self) -> Vec<Spring> {
        let all = Attached::distinct(self.system.attached()).flat_map(|b| b.structure.coordinates());
        all.zip(self.still()).map(|(c, still)| Spring { rest: c.spring.rest - still, ..c.spring }).collect()
    }

    fn borne(&self) -> Vec<f64> {
        self.still[..self.columns.len()].to_vec()
    }

    fn swing(&mut self, motion: &Periodic, omega: f64) -> Result<Periodic, String> {
        let Some(coupled) = self.system.coupled() else { return Err("nothing is on springs".into()) };
        let (flow, mut forces) = swing(coupled, &self.state, (motion, omega), self.flow.take())?;
        self.flow = Some(flow);
        forces.mean.iter_mut().zip(&self.still).for_each(|(f, still)| *f -= still);
        Ok(forces)
    }

    fn is_supersonic(&mut self) -> bool {
        let work = self.system.gas_work(&mut self.work);
        GasView::of(self.system, &self.frame, &self.state).walls(work);
        is_supersonic(self.system.gas(), work)
    }

    fn walls(&self) -> MovingWalls {
        let gas = self.system.gas();
        let (cloud, held) = (&gas.discretisation.cloud, Held::all(&gas.discretisation.cloud));
        let mesh = Mesh::of(cloud, &held, &Rim::default());
        MovingWalls {
            points: self.places(),
            lines: mesh.outlines,
            triangles: mesh.walls,
            moves: self.columns.iter().map(|c| c.moves.clone()).collect(),
        }
    }

    fn work_scale(&mut self) -> f64 {
        let view = GasView::of(self.system, &self.frame, &self.state);
        let axes = self.axes.axes(&view.seen(self.system.gas_work(&mut self.work)));
        axes.force_scale * axes.chord
    }

    fn forces_unless(&mut self, omega: f64, stop: &dyn Fn() -> bool) -> Option<Forces> {
        let n = self.columns.len();
        let right: Vec<Vec<f64>> = self
            .columns
            .iter()
            .map(|c| {
                let [q, v, a] = &c.gas;
                let real = q.iter().zip(a).map(|(q, a)| q - omega * omega * a);
                real.chain(v.iter().map(|v| omega * v)).collect()
            })
            .collect();
        let control = Control::newton(D);
        let plan = Hierarchy { group: control.group, cycle: control.cycle };
        let solved = self.linear.solve(omega, &right, TOLERANCE, (&plan, stop))?;
        // forces are those at rest: the frame stands where the steady flow has it
        let still = self.system.placing().values(&self.state).into_owned();
        self.system.place(&Instant::formula(0.0, &[]).with(&still), &mut self.frame);
        let mut all = Forces { generalised: vec![Complex64::new(0.0, 0.0); n * n], ..Forces::default() };
        for (j, (x, end)) in solved.into_iter().enumerate() {
            let (re, im) = x.split_at(x.len() / 2);
            let [re, im] = [re, im].map(|part| self.force_of(part));
            let [q, v, a] = &self.columns[j].force;
            let force = |i: usize| Complex64::new(re[i] + q[i] - omega * omega * a[i], im[i] + omega * v[i]);
            (0..n).for_each(|i| all.generalised[i * n + j] = force(i));
            all.coefficients.push([force(n), force(n + 1)]);
            all.pressures.push((n + COEFFICIENTS..self.still.len()).map(force).collect());
            all.ended.push(end);
        }
        Some(all)
    }
}

/// What is a large change of each coordinate.
fn units<const D: usize>(all: &[Attached<D>]) -> Vec<f64> {
    Attached::distinct(all).flat_map(|b| b.units.clone()).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn forces_at_rest_are_asked_for_after_those_of_the_lowest_frequency() {
        assert_eq!(in_order(&[0.0, 0.3, 0.1]), [0.1, 0.0, 0.3]);
        assert_eq!(in_order(&[0.2, 0.1]), [0.1, 0.2]);
        assert_eq!((in_order(&[0.0]), in_order(&[])), (vec![0.0], vec![]));
    }
}
