//! What a run leaves in its folder: tables, fields, pictures.
mod cuts;
mod period;
mod pictures;
mod solids;
mod state;
mod strips;
mod target;

use std::path::{Path, PathBuf};

use super::about;
use crate::case::Case;
use crate::cloud::{Cloud, Diagnosis};
use crate::coupling::SolidSnapshot;
use crate::geometry::Surface;
use crate::observe::About;
use crate::observe::loads::together as both;
use crate::observe::table::{Entry, write_csv, write_json};
use crate::observe::vtk::{Column, Facets, read_collection, write_cells, write_collection, write_surface};
use crate::problem::RunError;
use crate::problem::files;
use crate::record::summary::Summary;
use crate::report;
use crate::scheme::Work;
use crate::study::found::Found;
use crate::study::keeper::{FILM, FILM_FIELDS};
use crate::study::look::{GasView, Held, Hull, Mesh, Rim, SHADE, Snapshot, WallSnapshot, field, planes};
use crate::study::record::trace::Trace;
use crate::study::record::{Log, passed};

pub(crate) use period::write_period;
pub(crate) use pictures::write_cloud;
pub(crate) use solids::{draw_solid, write_solid};
pub(crate) use state::write_state_script;
pub(crate) use target::{Scene, Target};

/// Columns of the fields of a film, that which it is coloured by first among them.
const FILMED: [&str; 5] = ["density", "velocity", "pressure", "mach", "vorticity"];

/// Writes all files of a run that is over.
pub(crate) fn write_all<const D: usize>(
    found: &Found<'_, D>,
    summary: &mut Summary,
    (all, walls): (&Snapshot, &WallSnapshot),
    solid: Option<&SolidSnapshot<'_, D>>,
    log: &Log<'_>,
    out: &Path,
) -> Result<(), RunError> {
    let files = Files { found, walls, out };
    files.write_tables(&log.record.cycles, summary)?;
    if let Some(period) = log.case_period() {
        write_trace(&log.record.trace, out, period)?;
    }
    files.write_fields(all, log.record.time)?;
    write_state_script(out)?;
    if let Some(solid) = solid {
        let about = about::solid(found.case, Some(log.record.time));
        write_solid((out, "solid"), &about, solid)?;
        if found.case.output.report {
            draw_solid((out, &about), solid)?;
        }
    }
    if found.case.output.report {
        let to = Target { case: found.case, out };
        report::write_polar(out)?;
        let vortex = summary.loads.tip_vortex;
        pictures::write(&Scene { to, view: found.view, surface: found.surface, chord: found.axes.chord, vortex })?;
        strips::write_chart(found, out)?;
        // the page tells the cost of all but itself
        let path = out.join("summary.json");
        summary.cost.spent(log.seconds(), summary.convergence.particles);
        write_json(&path, summary)?;
        report::write_report(out)?;
        summary.cost.spent(log.seconds(), summary.convergence.particles);
        write_json(&path, summary)?;
    }
    Ok(())
}

/// Writes `harmonics.json` and `loops.csv` from the last period; nothing while there is none.
fn write_trace(trace: &Trace, out: &Path, period: f64) -> Result<(), RunError> {
    let Some((harmonics, loops)) = trace.tables(period) else { return Ok(()) };
    write_json(&out.join("harmonics.json"), &harmonics)?;
    let rows = loops.into_iter().map(|row| row.map(Entry::from).to_vec());
    Ok(write_csv(&out.join("loops.csv"), &["phase", "angle_deg", "shift", "cl", "cd", "cm"], rows)?)
}

/// What was found on its way into a folder.
struct Files<'a, const D: usize> {
    found: &'a Found<'a, D>,
    walls: &'a WallSnapshot,
    out: &'a Path,
}

impl<const D: usize> Files<'_, D> {
    fn write_tables(&self, cycles: &[[f64; 5]], summary: &Summary) -> Result<(), RunError> {
        write_json(&self.out.join("summary.json"), summary)?;
        if let Some(ledger) = &summary.convergence.ledger {
            write_json(&self.out.join("ledger.json"), ledger)?;
        }
        write_json(
            &self.out.join("doctor.json"),
            &Diagnosis::of(self.found.view.cloud(), self.found.view.frame.discretisation.walls.n_linear),
        )?;
        self.write_loads()?;
        strips::write_table(self.found, self.out)?;
        self.write_surface_csv()?;
        // a cloud that was never refined has no table of refinements
        if cycles.len() < 2 {
            return Ok(());
        }
        let rows = cycles.iter().enumerate().map(|(k, c)| {
            let before = if k > 0 { cycles[k - 1] } else { *c };
            let numbers = [c[0], c[1], c[2], c[3], c[4], c[2] - before[2], c[3] - before[3]];
            numbers.iter().map(|v| Entry::from(*v)).collect()
        });
        let columns = ["cycle", "particles", "cl", "cd", "cm", "change_cl", "change_cd"];
        Ok(write_csv(&self.out.join("adapt.csv"), &columns, rows)?)
    }

    fn write_loads(&self) -> Result<(), RunError> {
        let cloud = self.found.view.cloud();
        let units = self.found.case.flow.units().pressure();
        let mut rows = Vec::new();
        for (b, body) in self.found.names.bodies.iter().enumerate() {
            for (t, tag) in self.found.names.tags.iter().enumerate() {
                let chosen =
                    |w: usize| usize::from(cloud.interface[w].body) == b && usize::from(cloud.interface[w].tag) == t;
                if !(0..cloud.interface.len()).any(chosen) {
                    continue;
                }
                let (pressure, friction) = self.found.wall_loads(chosen);
                let load = both(&pressure, &friction);
                let c = self.found.axes.coefficients(&load);
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
        let walls = self.walls;
        let told = || walls.on.columns.iter().filter(|(name, ..)| *name != "area_vector");
        let mut columns = vec!["x", "y", "z"];
        for (name, ..) in told() {
            match *name {
                "normal" => columns.extend(["nx", "ny", "nz"]),
                "area" => columns.extend(["area", "body", "tag"]),
                "velocity" => columns.extend(["u", "v", "w"]),
                name => columns.push(name),
            }
        }
        let named = |names: &[String], k: u16| Entry::from(names.get(usize::from(k)).map_or("", String::as_str));
        let rows = walls.on.points.iter().enumerate().map(|(w, x)| {
            let mut row: Vec<Entry> = x.map(Entry::from).to_vec();
            for (name, n, values) in told() {
                row.extend(values[w * n..(w + 1) * n].iter().map(|v| Entry::from(*v)));
                if *name == "area" {
                    row.extend([named(&walls.bodies, walls.body[w]), named(&walls.tags, walls.tag[w])]);
                }
            }
            row
        });
        Ok(write_csv(&self.out.join("surface.csv"), &columns, rows)?)
    }

    fn write_fields(&self, all: &Snapshot, time: f64) -> Result<(), RunError> {
        let to = (self.out.join("field.vtu"), time);
        let mesh = write_field(to, self.found.case, self.found.view.cloud(), all)?;
        write_collection(&self.out.join("field.pvd"), &[(time, "field.vtu")])?;
        let cloud = self.found.view.cloud();
        if cloud.interface.is_empty() {
            return Ok(());
        }
        let range = cloud.interface_range();
        let cut: Vec<(&str, usize, Vec<f64>)> = all
            .columns
            .iter()
            .map(|(name, n, values)| (*name, *n, values[range.start * n..range.end * n].to_vec()))
            .chain([(
                "normal",
                3,
                (0..cloud.interface.len()).flat_map(|w| self.found.view.normal(w).to_3d()).collect(),
            )])
            .chain([(
                "area_vector",
                3,
                (0..cloud.interface.len()).flat_map(|w| self.found.view.area(w).to_3d()).collect(),
            )])
            .collect();
        let columns: Vec<Column<'_>> =
            cut.iter().map(|(name, n, values)| Column { name, components: *n, values }).collect();
        let points = &all.points[range];
        let about = about::gas(self.found.case, "cp", Some(time));
        write_surface(&self.out.join("surface.vtp"), &about, points, mesh.facets(), &columns)?;
        self.write_hull(all, &about)
    }

    /// The triangles of the bodies with the flow at their corners, in space.
    fn write_hull(&self, all: &Snapshot, about: &About) -> Result<(), RunError> {
        let Some(surface) = self.found.surface.filter(|_| D == 3) else { return Ok(()) };
        let mut hull = Hull::of(&self.found.view, surface, (all, self.walls));
        // a slice along a plane of symmetry cuts triangles that reach a shade beyond it
        let cloud = self.found.view.reference();
        for (axis, plane, outwards) in planes(self.found.case, &cloud.tree.bounds()) {
            let beyond = outwards * SHADE * cloud.spacing.iter().copied().fold(f64::INFINITY, f64::min);
            hull.points.iter_mut().filter(|x| x[axis] == plane).for_each(|x| x[axis] = plane + beyond);
        }
        let own = [
            Column { name: "normal", components: 3, values: &hull.normals },
            Column { name: "body", components: 1, values: &hull.body },
        ];
        let told = hull.columns.iter().map(|(name, n, values)| Column { name, components: *n, values });
        let columns: Vec<Column<'_>> = own.into_iter().chain(told).collect();
        let facets = Facets::Triangles(&hull.triangles);
        Ok(write_surface(&self.out.join("hull.vtp"), about, &hull.points, facets, &columns)?)
    }
}

/// Writes what the case wants held of a field at a time, and what it is on planes of symmetry, with the cells between, which it returns;
/// they are vertices where there are none.
fn write_field<const D: usize>(
    (path, time): (PathBuf, f64),
    case: &Case,
    cloud: &Cloud<D>,
    all: &Snapshot,
) -> Result<Mesh, RunError> {
    let held = Held::of(case, cloud);
    let rim = Rim::of(case, cloud, &held);
    let (mesh, few) = (Mesh::of(cloud, &held, &rim), rim.with_field(held.thinned(all)));
    let columns: Vec<Column<'_>> =
        few.columns.iter().map(|(name, components, values)| Column { name, components: *components, values }).collect();
    write_cells(&path, &about::gas(case, "mach", Some(time)), &few.points, mesh.cells(), &columns)?;
    Ok(mesh)
}

/// Writes the field of one moment of a march, and the list of all so far; `interval` is one of the solver.
pub(crate) fn write_series<const D: usize>(
    to: &Target<'_>,
    gas: &GasView<'_, D>,
    work: &mut Work<D>,
    interval: f64,
) -> Result<(), RunError> {
    let view = gas.seen(work);
    let (all, time, out) = (field(to.case, &view), to.case.flow.units().case_time(view.time()), to.out);
    let name = format!("field-{:05}.vtu", passed(view.time(), interval));
    write_field((out.join(&name), time), to.case, view.cloud(), &all)?;
    list(out, "series.pvd", f64::NEG_INFINITY, (time, name))
}

/// The same of bodies made of particles, at the time `time` of the solver.
pub(crate) fn write_solid_series<const D: usize>(
    to: &Target<'_>,
    at: &SolidSnapshot<'_, D>,
    (time, interval): (f64, f64),
) -> Result<(), RunError> {
    let name = format!("solid-{:05}", passed(time, interval));
    let time = to.case.flow.units().case_time(time);
    write_solid((to.out, &name), &about::solid(to.case, Some(time)), at)?;
    list(to.out, "solid.pvd", f64::NEG_INFINITY, (time, format!("{name}.vtu")))
}

/// Adds a field to the list called `name`, in which only those after `since` stay. A run that went on from a checkpoint writes
/// the later ones again.
fn list(out: &Path, name: &str, since: f64, (time, file): (f64, String)) -> Result<(), RunError> {
    let mut files = read_collection(&files::text(out, name).unwrap_or_default());
    files.retain(|(t, f)| *t > since && *t < time && *f != file);
    files.push((time, file));
    let listed: Vec<(f64, &str)> = files.iter().map(|(t, f)| (*t, f.as_str())).collect();
    Ok(write_collection(&out.join(name), &listed)?)
}

/// Draws the flow at the end of part number `part` of the [`FILM`] parts of the periods of the motion; each period replaces the
/// one before.
pub(crate) fn write_film<const D: usize>(
    to: &Target<'_>,
    surface: &Surface<D>,
    gas: &GasView<'_, D>,
    work: &mut Work<D>,
    part: u64,
) -> Result<(), RunError> {
    let scene = Scene { to: *to, view: gas.seen(work), surface: Some(surface), chord: 1.0, vortex: None };
    pictures::write_film(&scene, (part - 1) as u32 % FILM + 1)
}

/// The same of what a viewer of the field needs, at the end of part number `part` of the [`FILM_FIELDS`] parts of `period`.
pub(crate) fn write_film_field<const D: usize>(
    to: &Target<'_>,
    gas: &GasView<'_, D>,
    work: &mut Work<D>,
    period: f64,
    part: u64,
) -> Result<(), RunError> {
    let (view, units) = (gas.seen(work), to.case.flow.units());
    let mut all = field(to.case, &view);
    all.columns.retain(|(name, ..)| FILMED.contains(name));
    let (time, period) = (units.case_time(view.time()), units.case_time(period));
    let name = format!("film-{:02}.vtu", (part - 1) % u64::from(FILM_FIELDS) + 1);
    write_field((to.out.join(&name), time), to.case, view.cloud(), &all)?;
    // one part is as long as a twelfth of the period: half of it is beyond doubt
    list(to.out, "film.pvd", time - period * (1.0 - 0.5 / f64::from(FILM_FIELDS)), (time, name))
}
