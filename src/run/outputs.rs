//! What a finished run leaves behind.
use std::path::Path;

use super::balance;
use super::friction::{Separation, friction_load, separations, wall_friction};
use super::run_recorder::{NEARLY, RunRecorder};
use super::setup::Solver;
use super::snapshot::{self, LoadFrame, Snapshot, Units, load_axes, pressure_coefficient, wall_load};
use super::solve::totals;
use super::summary::{Clock, Ledger, Reclouding, Summary};
use super::{Places, RunError, marches};
use crate::case::{Case, Initial};
use crate::cloud::Diagnosis;
use crate::geometry::Surface;
use crate::math::{Bounds, Vector};
use crate::observe::loads::{Balance, Coefficients, Load, LoadAxes, together};
use crate::observe::table::{Entry, write_csv, write_json};
use crate::observe::usage::peak_bytes;
use crate::observe::vtk::{Column, Facets, read_collection, write_collection, write_points, write_surface};
use crate::report;
use crate::scheme::start::free_stream;
use crate::scheme::{Fluid, Frame, Work};
use crate::system::System;
use crate::verify::truth::FieldTruth;

/// Everything that the writers need.
struct Finished<'a, const D: usize> {
    case: &'a Case,
    out: &'a Path,
    fluid: &'a Fluid<D>,
    work: &'a Work<D>,
    surface: Option<&'a Surface<D>>,
    axes: LoadAxes,
    names: Names,
    balance: Option<Balance>,
}

/// Names of bodies and tags.
struct Names {
    bodies: Vec<String>,
    tags: Vec<String>,
}

/// Writes all files of a run and returns its summary.
pub(super) fn write_all<const D: usize>(
    case: &Case,
    places: &Places,
    ((solver, state), frame): &((Solver<D>, Vec<f64>), Frame<D>),
    surface: Option<&Surface<D>>,
    recorder: &mut RunRecorder<'_>,
    clock: &Clock,
) -> Result<Summary, RunError> {
    let solved = clock.wall_seconds();
    let mut work = solver.fluid.work();
    let frame_of_loads: LoadFrame = load_axes(case);
    let at = (frame, state.as_slice(), &mut work);
    let balance = balance::around(case, &frame_of_loads, &solver.fluid, at, marches(case));
    solver.fluid.fill_states(frame, state, &mut work);
    solver.fluid.fill_gradients(frame, &mut work);
    let seen = solver.fluid.seen(frame, &work);
    let (fluid, work) = seen.as_ref().map_or((&solver.fluid, &work), |(fluid, work)| (fluid, work));
    let names = surface.map_or(Names { bodies: Vec::new(), tags: Vec::new() }, |s| Names {
        bodies: s.bodies.clone(),
        tags: s.tags.clone(),
    });
    let r = Finished { case, out: &places.out, fluid, work, surface, axes: frame_of_loads.axes(fluid), names, balance };
    let summary = r.summary(recorder, state, (solved, clock));
    r.write_tables(&recorder.cycles, &summary)?;
    if let Some(period) = recorder.period {
        recorder.trace.write(&places.out, period)?;
    }
    let all = snapshot::field(r.case, r.fluid, r.work);
    recorder.show(&all);
    r.write_fields(&all, recorder.time)?;
    if case.output.report {
        super::pictures::write(&r.view())?;
        report::write_report(&places.out)?;
    }
    Ok(summary)
}

/// What the pictures are drawn from.
pub(super) struct View<'a, const D: usize> {
    pub(super) case: &'a Case,
    pub(super) out: &'a Path,
    pub(super) fluid: &'a Fluid<D>,
    pub(super) work: &'a Work<D>,
    pub(super) surface: Option<&'a Surface<D>>,
}

/// Bytes of a solver, its state and its integrator.
pub(super) fn bytes_of<const D: usize>(fluid: &Fluid<D>, integrator: usize) -> usize {
    let cloud = &fluid.discretisation.cloud;
    let rows = cloud.neighbours.index.len() * 4 + cloud.neighbours.first.len() * 4;
    let points = cloud.len() * (8 * D + 8 + 8) + cloud.n_fluid * 8;
    let states = cloud.len() * (8 * (D + 2) + 8 * D * (D + 2)) + 2 * 8 * fluid.len();
    rows + points + states + fluid.discretisation.operators.bytes() + fluid.discretisation.walls.bytes() + integrator
}

fn last_change(cycles: &[[f64; 5]]) -> Option<Coefficients> {
    let [.., a, b] = cycles else { return None };
    Some(Coefficients { cl: b[2] - a[2], cd: b[3] - a[3], cm: b[4] - a[4] })
}

/// Relative change of the totals of a march.
fn drift<const D: usize>(fluid: &Fluid<D>, state: &[f64], start: &[f64]) -> Ledger {
    let end = totals(fluid, state);
    if start.len() != end.len() {
        return Ledger::default();
    }
    let relative = |c: usize| (end[c] - start[c]) / start[c].abs().max(f64::MIN_POSITIVE);
    let momentum = (1..=D).map(|c| (end[c] - start[c]).abs()).fold(0.0, f64::max) / start[0];
    Ledger { mass: relative(0), momentum, energy: relative(D + 1) }
}

impl<'a, const D: usize> Finished<'a, D> {
    /// The last line of the run; `state` is that of the solver, `solved` the wall seconds until it was found.
    fn summary(&self, recorder: &RunRecorder<'_>, state: &[f64], (solved, clock): (f64, &Clock)) -> Summary {
        let (case, fluid) = (self.case, self.fluid);
        let (pressure, friction) = self.wall_loads(|_| true);
        let loads = self.axes.coefficients(&together(&pressure, &friction));
        let part = |load: &Load| fluid.viscous_model.as_ref().map(|_| self.axes.coefficients(load));
        let balance = self.balance.unwrap_or_default();
        let through = self.axes.coefficients(&balance.load);
        let ledger = if marches(case) {
            drift(fluid, state, &recorder.start_totals)
        } else {
            self.steady_ledger(&balance, &loads, &through)
        };
        let (cpu, wall) = recorder.seconds();
        let n = fluid.discretisation.cloud.n_real();
        Summary {
            event: "summary",
            case: case.title.clone(),
            run: self.out.display().to_string(),
            particles: n,
            iterations: recorder.iteration(),
            residual_drop: if marches(case) && recorder.balance.is_none() { 0.0 } else { -recorder.drop.log10() },
            converged: recorder.converged,
            cpu_seconds: cpu,
            wall_seconds: wall,
            peak_bytes: peak_bytes(),
            work_units: recorder.work.total as f64 / self.fluid.discretisation.cloud.n_fluid as f64,
            chord: self.axes.chord,
            loads,
            loads_pressure: part(&pressure),
            loads_friction: part(&friction),
            separation: self.separations(),
            loads_momentum_balance: self.balance.map(|_| through),
            harmonic_balance: recorder.balance.clone(),
            generalised_forces: recorder.forces.clone(),
            ledger,
            time: recorder.time,
            unconverged_steps: recorder.unconverged,
            halved_steps: recorder.halved,
            re_clouding: self.re_clouding(recorder),
            first_harmonics: recorder.period.map_or_else(Vec::new, |p| recorder.trace.first_harmonics(p)),
            momentum_of_period: recorder.period.and_then(|p| recorder.twofold.last(p)),
            last_period: recorder.period.and_then(|p| recorder.trace.last_period(p)),
            lift_cycles: recorder.trace.cycles(),
            periodic_change: recorder.period.and_then(|p| recorder.trace.change(p)),
            bytes_per_particle: bytes_of(fluid, recorder.bytes) as f64 / n as f64,
            cpu_ms_per_particle: 1e3 * cpu / n as f64,
            linear_iterations: recorder.linear,
            error_l2_density: self.exact_error(recorder.time),
            adapt_change: last_change(&recorder.cycles),
            phases: vec![("solve".into(), solved), ("files so far".into(), clock.wall_seconds() - solved)],
        }
    }

    /// What re-clouding did, where particles travel with the fluid.
    fn re_clouding(&self, recorder: &RunRecorder<'_>) -> Option<Reclouding> {
        let t = &recorder.ledger;
        if t.renewals == 0 {
            return None;
        }
        let start = &recorder.start_totals;
        let over = |c: usize, scale: usize| t.lost[c] / start[scale].abs().max(f64::MIN_POSITIVE);
        let momentum = (1..=D).map(|c| over(c, 0).powi(2)).sum::<f64>().sqrt();
        Some(Reclouding {
            renewals: t.renewals,
            inserted: t.inserted,
            removed: t.removed,
            first_order: t.first_order,
            transfer: Ledger { mass: over(0, 0), momentum, energy: over(D + 1, D + 1) },
        })
    }

    fn view(&self) -> View<'a, D> {
        View { case: self.case, out: self.out, fluid: self.fluid, work: self.work, surface: self.surface }
    }

    /// Loads of pressure and friction on the interface particles chosen.
    fn wall_loads(&self, chosen: impl Fn(usize) -> bool) -> (Load, Load) {
        let pressure = wall_load(self.fluid, self.work, &self.axes, &chosen);
        (pressure, friction_load(self.fluid, self.work, &self.axes, &chosen))
    }

    /// Distances of the interface particles from the nose, over the extent of the bodies.
    fn chordwise(&self) -> Vec<f64> {
        let bounds = self.surface.map_or(Bounds { min: Vector::ZERO, max: Vector::splat(1.0) }, Surface::bounds);
        let x_c = |x: &Vector<D>| (x[0] - bounds.min[0]) / bounds.extent()[0];
        self.fluid.walls_before().iter().map(x_c).collect()
    }

    fn separations(&self) -> Vec<Separation> {
        let friction = wall_friction(self.case, self.fluid, self.work);
        friction.map_or_else(Vec::new, |f| separations(self.case, self.fluid, &f, &self.chordwise()))
    }

    fn steady_ledger(&self, balance: &Balance, wall: &Coefficients, through: &Coefficients) -> Ledger {
        // half of what passes comes in
        let over = |net: f64, passed: f64| if passed > 0.0 { 2.0 * net / passed } else { 0.0 };
        Ledger {
            mass: over(balance.mass, balance.passed[0]),
            momentum: (wall.cl - through.cl).hypot(wall.cd - through.cd),
            energy: over(balance.energy, balance.passed[1]),
        }
    }

    /// Error of the density against the exact solution that the case starts from, when it has one.
    fn exact_error(&self, time: f64) -> Option<f64> {
        if matches!(self.case.initial, Initial::FreeStream) || !self.case.bodies.is_empty() {
            return None;
        }
        let cloud = &self.fluid.discretisation.cloud;
        let extent = cloud.tree.bounds().extent();
        let period = Some(Vector([extent[0], extent[1]]));
        let truth = FieldTruth::new(&self.case.initial, self.case.flow.gamma, period).ok()??;
        let (mut sum, mut volume) = (0.0, 0.0);
        let volumes = self.fluid.volumes();
        for i in 0..cloud.n_fluid {
            let exact = truth.state(&Vector([cloud.x[i][0], cloud.x[i][1]]), time).ok()?;
            let error = self.work.state[i].density - exact.density;
            sum += volumes[i] * error * error;
            volume += volumes[i];
        }
        Some((sum / volume).sqrt())
    }

    fn write_tables(&self, cycles: &[[f64; 5]], summary: &Summary) -> Result<(), RunError> {
        write_json(&self.out.join("summary.json"), summary)?;
        write_json(&self.out.join("ledger.json"), &summary.ledger)?;
        write_json(
            &self.out.join("doctor.json"),
            &Diagnosis::of(&self.fluid.discretisation.cloud, self.fluid.discretisation.walls.n_linear),
        )?;
        self.write_loads()?;
        self.write_surface_csv()?;
        let rows = cycles.iter().enumerate().map(|(k, c)| {
            let before = if k > 0 { cycles[k - 1] } else { *c };
            let numbers = [c[0], c[1], c[2], c[3], c[4], c[2] - before[2], c[3] - before[3]];
            numbers.iter().map(|v| Entry::from(*v)).collect()
        });
        let columns = ["cycle", "particles", "cl", "cd", "cm", "change_cl", "change_cd"];
        Ok(write_csv(&self.out.join("adapt.csv"), &columns, rows)?)
    }

    fn write_loads(&self) -> Result<(), RunError> {
        let cloud = &self.fluid.discretisation.cloud;
        let units = Units::of(self.case).pressure();
        let mut rows = Vec::new();
        for (b, body) in self.names.bodies.iter().enumerate() {
            for (t, tag) in self.names.tags.iter().enumerate() {
                let chosen =
                    |w: usize| usize::from(cloud.interface[w].body) == b && usize::from(cloud.interface[w].tag) == t;
                if !(0..cloud.interface.len()).any(chosen) {
                    continue;
                }
                let (pressure, friction) = self.wall_loads(chosen);
                let load = together(&pressure, &friction);
                let c = self.axes.coefficients(&load);
                let area: f64 =
                    (0..cloud.interface.len()).filter(|w| chosen(*w)).map(|w| cloud.interface[w].area.norm()).sum();
                let mut row = vec![Entry::from(body.as_str()), Entry::from(tag.as_str())];
                row.extend([c.cl, c.cd, c.cm].map(Entry::from));
                row.extend(load.force.map(|f| Entry::from(f * units)));
                row.push(Entry::from(area));
                rows.push(row);
            }
        }
        let columns = ["body", "tag", "cl", "cd", "cm", "fx", "fy", "fz", "area"];
        Ok(write_csv(&self.out.join("loads.csv"), &columns, rows)?)
    }

    fn write_surface_csv(&self) -> Result<(), RunError> {
        let cloud = &self.fluid.discretisation.cloud;
        let free = free_stream::<D>(self.case);
        let units = Units::of(self.case);
        let friction = wall_friction(self.case, self.fluid, self.work);
        let mut columns = vec![
            "x", "y", "z", "nx", "ny", "nz", "area", "body", "tag", "arc", "x_c", "pressure", "cp", "mach", "density",
            "u", "v", "w",
        ];
        if friction.is_some() {
            columns.extend(["cf", "heat_flux", "y_plus"]);
        }
        let chordwise = self.chordwise();
        let rows = cloud.interface_range().zip(&cloud.interface).map(|(i, w)| {
            let k = i - cloud.n_fluid;
            let q = &self.work.state[i];
            let mut row: Vec<Entry> = cloud.x[i].to_3d().map(Entry::from).to_vec();
            row.extend(w.normal.to_3d().map(Entry::from));
            row.push(Entry::from(w.area.norm()));
            row.push(Entry::from(self.names.bodies.get(usize::from(w.body)).map_or("", String::as_str)));
            row.push(Entry::from(self.names.tags.get(usize::from(w.tag)).map_or("", String::as_str)));
            let mach = q.velocity.norm() / self.fluid.gas.sound_speed(q);
            let cp = pressure_coefficient(q, &free);
            row.extend(
                [w.arc, chordwise[k], q.pressure * units.pressure(), cp, mach, q.density * units.density]
                    .map(Entry::from),
            );
            row.extend((q.velocity * units.speed).to_3d().map(Entry::from));
            row.extend(friction.iter().flat_map(|f| [f[k].cf, f[k].heat_flux, f[k].y_plus]).map(Entry::from));
            row
        });
        Ok(write_csv(&self.out.join("surface.csv"), &columns, rows.collect::<Vec<_>>())?)
    }

    fn write_fields(&self, all: &Snapshot, time: f64) -> Result<(), RunError> {
        let columns: Vec<Column<'_>> = all
            .columns
            .iter()
            .map(|(name, components, values)| Column { name, components: *components, values })
            .collect();
        write_points(&self.out.join("field.vtu"), &all.points, &columns)?;
        write_collection(&self.out.join("field.pvd"), &[(time, "field.vtu")])?;
        let cloud = &self.fluid.discretisation.cloud;
        if cloud.interface.is_empty() {
            return Ok(());
        }
        let range = cloud.interface_range();
        let cut: Vec<(&str, usize, Vec<f64>)> = all
            .columns
            .iter()
            .map(|(name, n, values)| (*name, *n, values[range.start * n..range.end * n].to_vec()))
            .chain([("normal", 3, cloud.interface.iter().flat_map(|w| w.normal.to_3d()).collect())])
            .collect();
        let columns: Vec<Column<'_>> =
            cut.iter().map(|(name, n, values)| Column { name, components: *n, values }).collect();
        let points = &all.points[range];
        let lines = outlines(cloud);
        let facets = if D == 2 { Facets::Polylines(&lines) } else { Facets::Vertices };
        Ok(write_surface(&self.out.join("surface.vtp"), points, facets, &columns, &[])?)
    }
}

/// Writes the field of one moment of a march, and the list of all so far.
pub(super) fn write_series<const D: usize>(
    case: &Case,
    out: &Path,
    fluid: &Fluid<D>,
    (frame, work): (&Frame<D>, &Work<D>),
    interval: f64,
) -> Result<(), RunError> {
    let seen = fluid.seen(frame, work);
    let (fluid, work) = seen.as_ref().map_or((fluid, work), |(fluid, work)| (fluid, work));
    let (all, time) = (snapshot::field(case, fluid, work), frame.time);
    let columns: Vec<Column<'_>> =
        all.columns.iter().map(|(name, components, values)| Column { name, components: *components, values }).collect();
    let number = (time / interval + NEARLY).floor() as u64;
    write_points(&out.join(series_name(number)), &all.points, &columns)?;
    // a run that went on from a checkpoint writes the later ones again
    let mut files = read_collection(&super::folder::text(out, "series.pvd").unwrap_or_default());
    files.retain(|(t, f)| *t < time && *f != series_name(number));
    files.push((time, series_name(number)));
    let listed: Vec<(f64, &str)> = files.iter().map(|(t, f)| (*t, f.as_str())).collect();
    Ok(write_collection(&out.join("series.pvd"), &listed)?)
}

/// Pictures of one period of a motion.
pub(super) const FILM: u32 = 6;

/// Draws the flow at the end of part number `part` of the periods of the motion; each period replaces the one before.
pub(super) fn write_film<const D: usize>(
    case: &Case,
    out: &Path,
    (fluid, surface): (&Fluid<D>, &Surface<D>),
    (frame, work): (&Frame<D>, &mut Work<D>),
    part: u64,
) -> Result<(), RunError> {
    fluid.fill_gradients(frame, work);
    let seen = fluid.seen(frame, work);
    let (fluid, work) = seen.as_ref().map_or((fluid, &*work), |(fluid, work)| (fluid, work));
    let view = View { case, out, fluid, work, surface: Some(surface) };
    super::pictures::write_film(&view, (part - 1) as u32 % FILM + 1)
}

fn series_name(number: u64) -> String {
    format!("field-{number:05}.vtu")
}

/// Interface particles of each smooth piece of outline, in order.
fn outlines<const D: usize>(cloud: &crate::cloud::Cloud<D>) -> Vec<Vec<u32>> {
    let mut lines: Vec<Vec<u32>> = Vec::new();
    let mut piece = u32::MAX;
    for (k, w) in cloud.interface.iter().enumerate() {
        if w.piece != piece {
            lines.push(Vec::new());
            piece = w.piece;
        }
        if let Some(line) = lines.last_mut() {
            line.push(k as u32);
        }
    }
    lines
}
