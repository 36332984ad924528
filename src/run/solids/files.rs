//! Files of structures alone: fields, histories, modes, summary.
use std::path::{Path, PathBuf};

use super::super::error::RunError;
use super::super::folder;
use super::fields::{columns, history, places, stresses, von_mises};
use super::record::{ModeRow, Row, SolidSummary};
use super::setup::Built;
use crate::case::Case;
use crate::math::{Bounds, Vector};
use crate::observe::table::{Entry, write_csv, write_json};
use crate::observe::vtk::{Cells, Column, write_cells, write_collection};
use crate::report::{Colormap, Dots, Scatter, scatter_png, write_file};
use crate::solid::Solid;
use crate::solid::forces::State;
use crate::solid::modes::Mode;

/// Room around the bodies in a picture, and the greatest displacement of a mode there, in their length.
const MARGIN: f64 = 0.1;
const SHOWN: f64 = 0.1;

/// Where files go.
pub(super) struct Files<'a> {
    pub(super) case: &'a Case,
    pub(super) out: Option<&'a Path>,
}

impl Files<'_> {
    fn path(&self, name: &str) -> Option<PathBuf> {
        self.out.map(|out| out.join(name))
    }

    /// The structure as deformed: `<name>.vtu`.
    pub(super) fn fields<const D: usize>(&self, name: &str, built: &Built<D>, u: &[f64]) -> Result<(), RunError> {
        let Some(path) = self.path(&format!("{name}.vtu")) else { return Ok(()) };
        write(&path, &built.structure.solid, &built.structure.state(0.0, u))
    }

    /// A field file of a series, and the list of all of them.
    pub(super) fn frame<const D: usize>(
        &self,
        number: usize,
        time: f64,
        built: &Built<D>,
        u: &[f64],
    ) -> Result<(), RunError> {
        let Some(list) = self.path("solid.pvd") else { return Ok(()) };
        let name = format!("solid_{number:05}");
        self.fields(&name, built, u)?;
        let known = self.out.map_or_else(String::new, |out| folder::text(out, "solid.pvd").unwrap_or_default());
        let mut all = crate::observe::vtk::read_collection(&known);
        all.retain(|(_, file)| *file != format!("{name}.vtu"));
        all.push((time, format!("{name}.vtu")));
        let files: Vec<(f64, &str)> = all.iter().map(|(t, f)| (*t, f.as_str())).collect();
        Ok(write_collection(&list, &files)?)
    }

    /// `history.csv`.
    pub(super) fn history<const D: usize>(&self, built: &Built<D>, rows: &[Row]) -> Result<(), RunError> {
        let Some(path) = self.path("history.csv") else { return Ok(()) };
        let (names, rows) = history(built, rows);
        let names: Vec<&str> = names.iter().map(String::as_str).collect();
        let line = |row: Vec<f64>| row.into_iter().map(Entry::from).collect();
        Ok(write_csv(&path, &names, rows.into_iter().map(line))?)
    }

    /// A natural mode: `mode-1.vtu` on all particles, `mode-1.csv` on the surface, as `[[structure.mode]]` reads it.
    pub(super) fn mode<const D: usize>(&self, k: usize, built: &Built<D>, mode: &Mode) -> Result<(), RunError> {
        let Some(path) = self.path(&format!("mode-{}.vtu", k + 1)) else { return Ok(()) };
        let particles = &built.structure.solid.particles;
        let shape: &[[f64; D]] = mode.shape.as_chunks().0;
        let raised = |v: &[f64]| -> [f64; 3] { std::array::from_fn(|a| v.get(a).copied().unwrap_or(0.0)) };
        let points: Vec<[f64; 3]> = particles.x.iter().map(|x| raised(&x.0)).collect();
        let values: Vec<f64> = shape.iter().flat_map(|v| raised(v)).collect();
        write_cells(
            &path,
            &points,
            Cells::Vertices,
            &[Column { name: "displacement", components: 3, values: &values }],
        )?;
        self.draw_mode(k, built, mode)?;
        let names = if D == 2 { &["x", "y", "dx", "dy"][..] } else { &["x", "y", "z", "dx", "dy", "dz"] };
        let skin = (0..particles.len()).filter(|i| particles.area[*i] != crate::math::Vector::ZERO);
        let line = |i: usize| particles.x[i].0.iter().chain(&shape[i]).map(|x| Entry::from(*x)).collect();
        let Some(path) = self.path(&format!("mode-{}.csv", k + 1)) else { return Ok(()) };
        Ok(write_csv(&path, names, skin.map(line))?)
    }

    /// The folder of a run that draws pictures.
    fn drawn(&self) -> Option<&Path> {
        self.out.filter(|_| self.case.output.report)
    }

    /// The shape of a plane mode, its greatest displacement a tenth of the body: `pictures/mode-1.png`.
    fn draw_mode<const D: usize>(&self, k: usize, built: &Built<D>, mode: &Mode) -> Result<(), RunError> {
        let Some(out) = self.drawn() else { return Ok(()) };
        let solid = &built.structure.solid;
        let size = SHOWN * Bounds::around(&solid.particles.x).extent().max_abs();
        let shape: &[[f64; D]] = mode.shape.as_chunks().0;
        let moved: Vec<[f64; D]> = shape.iter().map(|v| v.map(|v| size * v)).collect();
        let values: Vec<f64> = shape.iter().map(|v| Vector(*v).norm()).collect();
        let title = format!("Mode {}: {:.6e} Hz", k + 1, mode.omega / std::f64::consts::TAU);
        picture((out, &format!("mode-{}", k + 1)), solid, &moved, (&title, "displacement", &values))
    }

    /// Pictures of the structure as deformed.
    pub(super) fn pictures<const D: usize>(&self, built: &Built<D>, u: &[f64]) -> Result<(), RunError> {
        let Some(out) = self.drawn() else { return Ok(()) };
        draw(out, &built.structure.solid, &built.structure.state(0.0, u))
    }

    /// `summary.json`, and `modes.csv` where there are modes.
    pub(super) fn summary(&self, summary: &SolidSummary) -> Result<(), RunError> {
        let Some(path) = self.path("summary.json") else { return Ok(()) };
        if !summary.modes.is_empty() {
            let Some(table) = self.path("modes.csv") else { return Ok(()) };
            let names = ["mode", "frequency", "omega", "generalised_mass", "residual"];
            let line = |(k, m): (usize, &ModeRow)| {
                [(k + 1) as f64, m.frequency, m.omega, m.generalised_mass, m.residual].map(Entry::from).to_vec()
            };
            write_csv(&table, &names, summary.modes.iter().enumerate().map(line))?;
        }
        debug_assert!(!self.case.has_gas());
        Ok(write_json(&path, summary)?)
    }
}

/// Pictures of plane bodies: the stress in them and, where they move, each component of the velocity.
pub(in crate::run) fn draw<const D: usize>(out: &Path, solid: &Solid<D>, state: &State<'_, D>) -> Result<(), RunError> {
    let mut all = vec![("solid", "Stress in the solid", "von Mises stress", von_mises(solid, state))];
    if state.velocity.iter().flatten().any(|v| *v != 0.0) {
        let along = |a: usize| state.velocity.iter().map(|v| v[a]).collect();
        all.push(("solid-u", "Velocity of the solid along x", "u", along(0)));
        all.push(("solid-v", "Velocity of the solid along y", "v", along(1)));
    }
    all.into_iter().try_for_each(|(file, title, quantity, values)| {
        picture((out, file), solid, state.displacement, (title, quantity, &values))
    })
}

/// A picture of plane bodies where they are displaced by `moved`, with values on their particles; nothing in space.
fn picture<const D: usize>(
    (out, file): (&Path, &str),
    solid: &Solid<D>,
    moved: &[[f64; D]],
    (title, quantity, values): (&str, &str, &[f64]),
) -> Result<(), RunError> {
    if D != 2 {
        return Ok(());
    }
    let place = |i: usize| Vector([0, 1].map(|a| solid.particles.x[i][a] + moved[i][a]));
    let points: Vec<Vector<2>> = (0..solid.len()).map(place).collect();
    let bounds = Bounds::around(&points);
    let window = bounds.padded(MARGIN * bounds.extent().max_abs());
    let dots = Dots::Value { values, quantity, map: Colormap::Sequential };
    let scatter = Scatter { points: &points, dots, interface: &[], outlines: &[] };
    Ok(write_file(&out.join(format!("pictures/{file}.png")), &scatter_png(&scatter, window, title)?)?)
}

/// Writes particles where they are, with displacement, velocity, stress and what materials remember.
pub(in crate::run) fn write<const D: usize>(
    path: &Path,
    solid: &Solid<D>,
    state: &State<'_, D>,
) -> Result<(), RunError> {
    let (points, all) = (places(solid, state), columns(solid, state, &stresses(solid, state)));
    let columns: Vec<Column<'_>> =
        all.iter().map(|(name, components, values)| Column { name, components: *components, values }).collect();
    Ok(write_cells(path, &points, Cells::Vertices, &columns)?)
}
