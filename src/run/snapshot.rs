//! The solution as plain tables, in the units of the case.
use super::friction::add_friction_in;
use crate::case::Case;
use crate::math::Vector;
use crate::observe::loads::{Coefficients, Load, LoadAxes, pressure_load};
use crate::physics::Primitive;
use crate::scheme::start::{free_stream, stream_axes};
use crate::scheme::{Fluid, Frame, Work};

/// Load axes that still need the extent of the bodies.
#[derive(Clone, Debug)]
pub(super) struct LoadFrame {
    case: Case,
}

/// The axes of a case; defaults follow from the bodies when loads are computed.
pub(super) fn load_axes(case: &Case) -> LoadFrame {
    LoadFrame { case: case.clone() }
}

impl LoadFrame {
    /// Axes for the bodies of `fluid`, in the units of the solver.
    pub(super) fn axes<const D: usize>(&self, fluid: &Fluid<D>) -> LoadAxes {
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
    pub(super) fn axes_in<const D: usize>(&self, fluid: &Fluid<D>, frame: &Frame<D>) -> LoadAxes {
        let mut axes = self.axes(fluid);
        let carried =
            fluid.cloud_motion.body(0, frame.time, &frame.jets).point(&Vector::from_fn(|d| axes.moment_point[d]));
        axes.moment_point = carried.to_3d();
        axes
    }

    /// Coefficients of all bodies from the wall states, and with friction the gradients, in `work`: those of `frame`.
    pub(super) fn coefficients_in<const D: usize>(
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
pub(super) fn rounded(extent: f64) -> f64 {
    let step = 10f64.powf(extent.log10().floor() - 1.0);
    let near = (extent / step).round() * step;
    if (near - extent).abs() < 0.02 * extent { near } else { extent }
}

/// Load of the wall pressure on the interface particles chosen.
pub(super) fn wall_load<const D: usize>(
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

/// Named columns over particles.
#[derive(Clone, Debug)]
pub struct Snapshot {
    /// Positions.
    pub points: Vec<[f64; 3]>,
    /// Columns: name, components, values.
    pub columns: Vec<(&'static str, usize, Vec<f64>)>,
}

/// Factors from the units of the solver to those of the case.
#[derive(Clone, Copy, Debug)]
pub(super) struct Units {
    /// Density.
    pub(super) density: f64,
    /// Speed.
    pub(super) speed: f64,
}

impl Units {
    /// The units of a case; ones when its free stream is nondimensional.
    pub(super) fn of(case: &Case) -> Self {
        let r = case.flow.reference();
        if case.flow.is_dimensional() {
            Self { density: r.density, speed: r.sound_speed }
        } else {
            Self { density: 1.0, speed: 1.0 }
        }
    }

    /// Factor on pressures.
    pub(super) fn pressure(&self) -> f64 {
        self.density * self.speed * self.speed
    }
}

/// Pressure coefficient; zero when there is no stream.
pub(super) fn pressure_coefficient<const D: usize>(q: &Primitive<D>, free: &Primitive<D>) -> f64 {
    let dynamic = 0.5 * free.density * free.velocity.norm_squared();
    if dynamic > 0.0 { (q.pressure - free.pressure) / dynamic } else { 0.0 }
}

/// All particles without images, with everything that a field file holds.
pub(super) fn field<const D: usize>(case: &Case, fluid: &Fluid<D>, work: &Work<D>) -> Snapshot {
    let cloud = &fluid.discretisation.cloud;
    let n = cloud.n_real();
    let (free, units) = (free_stream::<D>(case), Units::of(case));
    let column = |f: &dyn Fn(usize) -> f64| (0..n).map(f).collect::<Vec<f64>>();
    let state = &work.state;
    let velocity = (0..n).flat_map(|i| (state[i].velocity * units.speed).to_3d()).collect();
    let kind = |i: usize| f64::from(u8::from(i >= cloud.n_fluid) + u8::from(i >= cloud.n_rows()));
    let entropy = |i: usize| fluid.gas.entropy(&state[i]) / fluid.gas.entropy(&free) - 1.0;
    let level = |i: usize| (cloud.spacing[i]).log2();
    Snapshot {
        points: cloud.x[..n].iter().map(Vector::to_3d).collect(),
        columns: vec![
            ("density", 1, column(&|i| state[i].density * units.density)),
            ("velocity", 3, velocity),
            ("pressure", 1, column(&|i| state[i].pressure * units.pressure())),
            ("mach", 1, column(&|i| state[i].velocity.norm() / fluid.gas.sound_speed(&state[i]))),
            ("cp", 1, column(&|i| pressure_coefficient(&state[i], &free))),
            ("entropy", 1, column(&entropy)),
            ("spacing", 1, cloud.spacing[..n].to_vec()),
            ("volume", 1, cloud.volume[..n].to_vec()),
            ("level", 1, column(&level)),
            ("kind", 1, column(&kind)),
        ],
    }
}
