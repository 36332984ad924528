//! Axes of loads, and the gas at one moment seen in them.
use super::friction::friction_load;
use crate::case::Case;
use crate::cloud::CloudSpec;
use crate::geometry::{Planform, Surface};
use crate::math::jet::Jet;
use crate::math::reduce::{sum, sums};
use crate::math::{Bounds, Vector};
use crate::motion::BodyMotion;
use crate::observe::loads::{Coefficients, Load, LoadAxes, together};
use crate::problem::reference::planform;
use crate::scheme::start::{free_stream, stream_axes};
use crate::scheme::{Fluid, Frame, HasGas, View, Work};

/// The gas at one moment, before it is looked at.
#[derive(Clone, Copy)]
pub(crate) struct GasView<'a, const D: usize> {
    /// Equations.
    pub(crate) fluid: &'a Fluid<D>,
    /// Frame.
    pub(crate) frame: &'a Frame<D>,
    /// State.
    pub(crate) state: &'a [f64],
}

impl<'a, const D: usize> GasView<'a, D> {
    /// The gas of a system.
    pub(crate) fn of<S: HasGas<D>>(system: &'a S, frame: &'a S::Frame, state: &'a [f64]) -> Self {
        Self { fluid: system.gas(), frame: system.gas_frame(frame), state: system.gas_state(state) }
    }

    /// Finds states and gradients.
    pub(crate) fn seen<'b>(&self, work: &'b mut Work<D>) -> View<'b, D>
    where
        'a: 'b,
    {
        self.fluid.view(self.frame, self.state, work)
    }

    /// Finds states and what else wall forces need.
    pub(crate) fn walls<'b>(&self, work: &'b mut Work<D>) -> View<'b, D>
    where
        'a: 'b,
    {
        self.fluid.fill_states(self.frame, self.state, work);
        if self.fluid.viscous_model.is_some() {
            self.fluid.fill_gradients(self.frame, work);
        }
        View::new(self.fluid, self.frame, work)
    }

    /// Coefficients from wall pressure and friction; `None` without bodies.
    pub(crate) fn coefficients(&self, axes: &LoadFrame, work: &mut Work<D>) -> Option<Coefficients> {
        let bodies = !self.fluid.discretisation.cloud.interface.is_empty();
        bodies.then(|| axes.coefficients(&self.walls(work)))
    }
}

/// Angle (radians, nose up), displacement and coordinate of the first mode of the first body that moves.
///
/// `jets` are coordinates of bodies that are unknowns.
pub(crate) fn motion<const D: usize>(fluid: &Fluid<D>, time: f64, jets: &[Jet]) -> [f64; 5] {
    fluid.cloud_motion.law().map_or([0.0; 5], |law: &BodyMotion<D>| {
        let law = law.momentary(time, jets);
        let shift = law.displacement(time).to_3d();
        let mode = law.coordinates(time).first().copied().unwrap_or(0.0);
        [law.angle(time).value, shift[0], shift[1], shift[2], mode]
    })
}

/// Totals of the `n` conserved quantities over fluid particles with these volumes.
pub(crate) fn totals(volume: &[f64], u: &[f64], n: usize) -> Vec<f64> {
    (0..n).map(|c| sum(volume.len(), |i| volume[i] * u[i * n + c])).collect()
}

/// Load axes that still need to know what of the bodies lies in the domain.
#[derive(Clone, Debug)]
pub(crate) struct LoadFrame {
    case: Case,
    /// Corners of the smallest box around the bodies, before they move; absent without bodies.
    bodies: Option<[[f64; 3]; 2]>,
    /// Their reference values; absent where a plane domain cuts them along the stream.
    planform: Option<Planform>,
}

/// The axes of a case; defaults follow from its bodies when loads are computed.
pub(crate) fn load_axes<const D: usize>(case: &Case, surface: Option<&Surface<D>>) -> LoadFrame {
    let corners = |bounds: Bounds<D>| [bounds.min.to_3d(), bounds.max.to_3d()];
    LoadFrame {
        case: case.clone(),
        bodies: surface.map(|s| corners(s.bounds())),
        planform: surface.filter(|s| D == 3 || !cut_along_x(case, &s.bounds())).map(|s| planform(case, s)),
    }
}

/// True where sides of the domain across the stream cut the bodies.
fn cut_along_x<const D: usize>(case: &Case, bodies: &Bounds<D>) -> bool {
    let domain = CloudSpec::<D>::of_case(case).limits();
    bodies.min[0] < domain.min[0] || domain.max[0] < bodies.max[0]
}

impl LoadFrame {
    /// Axes for the bodies in `view`, in the units of the solver: the point of the moment travels with the first body.
    pub(crate) fn axes<const D: usize>(&self, view: &View<'_, D>) -> LoadAxes {
        let seen = Bounds::around(view.fluid.walls_before());
        let bounds = self.bodies_within(&view.fluid.discretisation.cloud.tree.bounds()).unwrap_or(seen);
        let extent = bounds.extent();
        let reference = &self.case.reference;
        // a body of which only a face across the stream lies in the domain is as long as that face is high
        let length = if seen.extent()[0] > 0.0 { extent[0] } else { seen.extent().max_abs() };
        let chord = reference.chord.map_or(length, |c| c.0);
        let quarter = [bounds.min[0] + 0.25 * extent[0], bounds.centre()[1], 0.0];
        let Planform { chord, area, quarter } = self.planform.unwrap_or(Planform { chord, area: chord, quarter });
        let mut point = Vector::from_fn(|d| quarter[d]);
        if let Some(p) = &reference.moment_point {
            point = Vector::from_fn(|d| p.get(d).map_or(0.0, |l| l.0));
        }
        let point = view.carried(0, &point);
        let (drag, lift) = stream_axes::<D>(&self.case);
        let speed = free_stream::<D>(&self.case).velocity.norm();
        LoadAxes {
            dimension: D,
            drag: drag.to_3d(),
            lift: lift.to_3d(),
            moment_point: point.to_3d(),
            force_scale: 0.5 * speed * speed * area,
            chord,
        }
    }

    /// The smallest box around the bodies, cut to the domain: interface particles stay half a spacing away from sharp edges.
    fn bodies_within<const D: usize>(&self, domain: &Bounds<D>) -> Option<Bounds<D>> {
        let [min, max] = self.bodies?;
        Some(Bounds {
            min: Vector::from_fn(|d| min[d].max(domain.min[d])),
            max: Vector::from_fn(|d| max[d].min(domain.max[d])),
        })
    }

    /// Coefficients of all bodies, from the wall states and with friction the gradients.
    pub(crate) fn coefficients<const D: usize>(&self, view: &View<'_, D>) -> Coefficients {
        let axes = self.axes(view);
        let [pressure, friction] = [pressure_load(view, &axes, |_| true), friction_load(view, &axes, |_| true)];
        axes.coefficients(&together(&pressure, &friction))
    }
}

/// Load of the wall pressure on the interface particles chosen.
pub(crate) fn pressure_load<const D: usize>(
    view: &View<'_, D>,
    axes: &LoadAxes,
    chosen: impl Fn(usize) -> bool + Sync,
) -> Load {
    load_on_walls(view, axes, |w| chosen(w).then(|| view.pressure_force(w)))
}

/// Load of the forces `force(w)` on interface particles.
pub(crate) fn load_on_walls<const D: usize>(
    view: &View<'_, D>,
    axes: &LoadAxes,
    force: impl Fn(usize) -> Option<Vector<D>> + Sync,
) -> Load {
    let first = view.cloud().interface_range().start;
    let [x, y, z, moment] = sums(view.cloud().interface.len(), |w| {
        let mut load = Load::default();
        if let Some(force) = force(w) {
            axes.add(&mut load, &view.place(first + w).to_3d(), &force.to_3d());
        }
        let [x, y, z] = load.force;
        [x, y, z, load.moment]
    });
    Load { force: [x, y, z], moment }
}
