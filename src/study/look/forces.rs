//! Generalised forces: the work of the gas on the modes of `[gaf]`.
//!
//! With f_w the force of pressure and friction on the piece of wall w, and x_w(t) where that is,
//!
//! Q_i = Σ_w f_w · ∂x_w/∂q_i / (q∞ S c), q∞ S c: dynamic pressure, reference area (2-D: chord) and chord.
//!
//! The coordinate of plunge is the displacement upwards over L, the length of the reduced frequency: ∂x/∂q = L e. That of pitch
//! is the angle about the pivot, so that Q is the moment coefficient. That of a flexible mode is its own: ∂x/∂q = R φ(X). Bodies
//! with a motion of their own do not take part.
use super::axes::{GasView, LoadFrame, load_axes};
use crate::case::{AnyMode, Case, Mode};
use crate::geometry::Surface;
use crate::math::Vector;
use crate::math::fourier::Series;
use crate::math::reduce::sum;
use crate::motion::Motions;
use crate::observe::loads::{Load, LoadAxes};
use crate::record::summary::GeneralisedForce;
use crate::scheme::{Fluid, View, Work};

/// What a mode does to the walls.
enum Form<const D: usize> {
    Plunge,
    Pitch(Vector<D>),
    /// φ at each interface particle.
    Bend(Vec<Vector<D>>),
}

/// The modes that forces are computed on.
pub(crate) struct ForceModes<const D: usize> {
    all: Vec<(String, Form<D>)>,
    /// Whether each interface particle takes part.
    follows: Vec<bool>,
    /// Length of the coordinate of plunge; absent: half the chord.
    length: Option<f64>,
    axes: LoadFrame,
}

impl<const D: usize> ForceModes<D> {
    /// The modes of `[gaf]`; `None` where a case has none.
    pub(crate) fn of(
        case: &Case,
        surface: Option<&Surface<D>>,
        fluid: &Fluid<D>,
        motions: &Motions<D>,
    ) -> Option<Self> {
        let plan = case.gaf.as_ref()?;
        let cloud = &fluid.discretisation.cloud;
        let mut shapes = motions.shapes_of_forces().iter();
        let form = |mode: AnyMode<'_>| {
            let form = match mode {
                AnyMode::Rigid(Mode::Plunge) => Form::Plunge,
                AnyMode::Rigid(Mode::Pitch) => {
                    let pivot = plan.pivot.as_ref();
                    Form::Pitch(pivot.map_or(Vector::ZERO, |p| Vector::from_fn(|d| p[d].0)))
                }
                AnyMode::Flexible(_) => {
                    let shape = shapes.next()?;
                    Form::Bend(cloud.x[cloud.interface_range()].iter().map(|x| shape.at(x)).collect())
                }
            };
            Some((mode.name().to_owned(), form))
        };
        let all: Option<Vec<_>> = plan.all_modes().map(form).collect();
        let own = |body: u16| case.bodies.get(usize::from(body)).is_some_and(|b| b.motion.is_some());
        let follows = cloud.interface.iter().map(|w| !own(w.body)).collect();
        Some(Self { all: all?, follows, length: plan.reduced_length.map(|l| l.0), axes: load_axes(case, surface) })
    }

    /// Forces on all modes.
    fn at(&self, view: &View<'_, D>) -> Vec<f64> {
        let axes = self.axes.axes(view);
        let forces = wall_forces(view);
        let over = |of: &(dyn Fn(usize, &Vector<D>) -> f64 + Sync)| {
            sum(forces.len(), |w| if self.follows[w] { of(w, &forces[w].1) } else { 0.0 })
        };
        let length = self.length.unwrap_or(0.5 * axes.chord);
        let one = |(_, form): &(String, Form<D>)| {
            let work = match form {
                Form::Plunge => over(&|_, f| length * f[D - 1]),
                Form::Pitch(pivot) => {
                    let moment_point = view.carried(0, pivot).to_3d();
                    let axes = LoadAxes { moment_point, ..axes.clone() };
                    over(&|w, f| {
                        let mut load = Load::default();
                        axes.add(&mut load, &forces[w].0.to_3d(), &f.to_3d());
                        load.moment
                    })
                }
                Form::Bend(shifts) => {
                    let body = |w: usize| usize::from(view.cloud().interface[w].body);
                    over(&|w, f| view.carried_direction(body(w), &shifts[w]).dot(f))
                }
            };
            if axes.force_scale > 0.0 { work / (axes.force_scale * axes.chord) } else { 0.0 }
        };
        self.all.iter().map(one).collect()
    }

    /// Forces on all modes at one moment.
    pub(crate) fn seen(&self, view: &GasView<'_, D>, work: &mut Work<D>) -> Vec<f64> {
        self.at(&view.walls(work))
    }

    /// Mean and first harmonic of all forces, given at the instances of a period.
    pub(crate) fn over_a_period(&self, instances: &[Vec<f64>]) -> Vec<GeneralisedForce> {
        let force = |(k, (name, _)): (usize, &(String, Form<D>))| {
            let values: Vec<f64> = instances.iter().map(|all| all[k]).collect();
            let series = Series::of_values(&values).ok()?;
            let (c, n) = (series.coefficients(), series.instances().harmonics());
            Some(GeneralisedForce { mode: name.clone(), mean: c[0], first: [c[1], -c[n + 1]] })
        };
        self.all.iter().enumerate().filter_map(force).collect()
    }
}

/// Places of the interface particles and the forces on them, in the axes of the case.
fn wall_forces<const D: usize>(view: &View<'_, D>) -> Vec<(Vector<D>, Vector<D>)> {
    view.cloud().interface_range().enumerate().map(|(w, i)| (view.place(i), view.wall_force(w))).collect()
}
