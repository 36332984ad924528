//! Axes of loads, and the gas at one moment seen in them.
use super::friction::add_friction_in;
use crate::case::Case;
use crate::math::Vector;
use crate::math::jet::Jet;
use crate::math::sweep::sum;
use crate::motion::BodyMotion;
use crate::observe::loads::{Coefficients, Load, LoadAxes, pressure_load};
use crate::scheme::start::{free_stream, stream_axes};
use crate::scheme::{Fluid, Frame, HasGas, Work};

/// The gas at one moment.
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

    /// Coefficients from wall pressure and friction; `None` without bodies.
    pub(crate) fn coefficients(&self, axes: &LoadFrame, work: &mut Work<D>) -> Option<Coefficients> {
        let Self { fluid, frame, state } = self;
        if fluid.discretisation.cloud.interface.is_empty() {
            return None;
        }
        fluid.fill_states(frame, state, work);
        if fluid.viscous_model.is_some() {
            fluid.fill_gradients(frame, work);
        }
        Some(axes.coefficients_in(fluid, frame, work))
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

/// Totals of mass, momentum and energy over the fluid particles.
pub(crate) fn totals<const D: usize>(fluid: &Fluid<D>, u: &[f64]) -> Vec<f64> {
    let n = D + 2;
    let volume = fluid.volumes();
    (0..n).map(|c| sum(fluid.discretisation.cloud.n_fluid, |i| volume[i] * u[i * n + c])).collect()
}

/// Load axes that still need the extent of the bodies.
#[derive(Clone, Debug)]
pub(crate) struct LoadFrame {
    case: Case,
}

/// The axes of a case; defaults follow from the bodies when loads are computed.
pub(crate) fn load_axes(case: &Case) -> LoadFrame {
    LoadFrame { case: case.clone() }
}

impl LoadFrame {
    /// Axes for the bodies of `fluid`, in the units of the solver.
    pub(crate) fn axes<const D: usize>(&self, fluid: &Fluid<D>) -> LoadAxes {
        let bounds = crate::math::Bounds::around(fluid.walls_before());
        let extent = bounds.extent();
        let reference = &self.case.reference;
        // a body of which only a face across the stream lies in the domain is as long as that face is high
        let length = if extent[0] > 0.0 { extent[0] } else { extent.max_abs() };
        let chord = reference.chord.map_or(rounded(length), |c| c.0);
        let area = match D {
            2 => chord,
            _ => reference.area.unwrap_or(extent[1] * extent[D - 1]),
        };
        let mut point = bounds.centre();
        if D == 2 {
            point[0] = bounds.min[0] + 0.25 * extent[0];
        }
        if let Some(p) = &reference.moment_point {
            point = Vector::from_fn(|d| p.get(d).map_or(0.0, |l| l.0));
        }
        // the point of the moment travels with the first body
        let point = fluid.carried(0, &point);
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

    /// The axes at the time of `frame`: the point of the moment travels with the first body.
    pub(crate) fn axes_in<const D: usize>(&self, fluid: &Fluid<D>, frame: &Frame<D>) -> LoadAxes {
        let mut axes = self.axes(fluid);
        let carried =
            fluid.cloud_motion.body(0, frame.time, &frame.jets).point(&Vector::from_fn(|d| axes.moment_point[d]));
        axes.moment_point = carried.to_3d();
        axes
    }

    /// Coefficients of all bodies from the wall states, and with friction the gradients, in `work`: those of `frame`.
    pub(crate) fn coefficients_in<const D: usize>(
        &self,
        fluid: &Fluid<D>,
        frame: &Frame<D>,
        work: &Work<D>,
    ) -> Coefficients {
        let axes = self.axes_in(fluid, frame);
        let (cloud, far) = (&frame.discretisation.cloud, fluid.far_field.pressure());
        let mut load = Load::default();
        for (i, wall) in cloud.interface_range().zip(&cloud.interface) {
            let push = frame.to_inertial_axes(&(wall.area * (far - work.state[i].pressure)));
            axes.add(&mut load, &frame.place(i).to_3d(), &push.to_3d());
        }
        add_friction_in(fluid, (frame, work), &axes, &mut load);
        axes.coefficients(&load)
    }
}

/// The chord that interface particles stand on: they stay half a spacing away from sharp edges, so that their extent is a
/// little short of a chord that is a round number.
pub(crate) fn rounded(extent: f64) -> f64 {
    let step = 10f64.powf(extent.log10().floor() - 1.0);
    let near = (extent / step).round() * step;
    if (near - extent).abs() < 0.02 * extent { near } else { extent }
}

/// Load of the wall pressure on the interface particles chosen.
pub(crate) fn wall_load<const D: usize>(
    fluid: &Fluid<D>,
    work: &Work<D>,
    axes: &LoadAxes,
    chosen: impl Fn(usize) -> bool,
) -> Load {
    let cloud = &fluid.discretisation.cloud;
    let far = fluid.far_field.pressure();
    let (mut points, mut areas, mut excess) = (Vec::new(), Vec::new(), Vec::new());
    for (w, i) in cloud.interface_range().enumerate().filter(|(w, _)| chosen(*w)) {
        points.push(cloud.x[i].to_3d());
        areas.push(cloud.interface[w].area.to_3d());
        excess.push(work.state[i].pressure - far);
    }
    pressure_load(axes, &points, &areas, &excess)
}
