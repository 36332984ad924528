//! Files of structures alone: fields, histories, modes, summary.
use std::path::{Path, PathBuf};

use super::super::files::write_state_script;
use super::super::{about, folder};
use super::pictures::{Shown, draw, picture};
use super::saved::{Saved, write_march, write_search};
use crate::case::{Case, Harmonics};
use crate::math::fourier::Instances;
use crate::math::{Bounds, Vector};
use crate::observe::About;
use crate::observe::table::{Entry, write_csv, write_json};
use crate::observe::vtk::{Cells, Column, write_cells, write_collection};
use crate::problem::RunError;
use crate::problem::files;
use crate::problem::solids::Built;
use crate::report::write_report;
use crate::solid::Solid;
use crate::solid::forces::State;
use crate::solid::modes::Mode;
use crate::study::record::saved::FILE;
use crate::study::solids::{
    ModeRow, Row, SolidKeeper, SolidSummary, SolidsKeeper, Sought, Standing, Work, columns, history, places, stresses,
};
use crate::time::Past;
use crate::time::forced::Place;

/// The greatest displacement of a mode in a picture, in the length of the bodies.
const SHOWN: f64 = 0.1;

/// The folder of a structure alone.
pub(in crate::run) struct Files<'a> {
    pub(in crate::run) case: &'a Case,
    pub(in crate::run) out: &'a Path,
    /// The checkpoint that it goes on from; from its start without one.
    pub(in crate::run) from: Option<&'a Saved>,
}

impl Files<'_> {
    fn path(&self, name: &str) -> PathBuf {
        self.out.join(name)
    }

    /// The structure as deformed, at a time of those that have one: `<name>.vtu`.
    fn fields<const D: usize>(
        &self,
        (name, time): (&str, Option<f64>),
        built: &Built<D>,
        u: &[f64],
    ) -> Result<(), RunError> {
        let path = self.path(&format!("{name}.vtu"));
        write(&path, &about::solid(self.case, time), &built.structure.solid, &built.structure.state(0.0, u))
    }

    /// A natural mode: `mode-1.vtu` on all particles, `mode-1.csv` on the surface, as `[[structure.mode]]` reads it.
    fn mode<const D: usize>(&self, k: usize, built: &Built<D>, mode: &Mode) -> Result<(), RunError> {
        let path = self.path(&format!("mode-{}.vtu", k + 1));
        let particles = &built.structure.solid.particles;
        let shape: &[[f64; D]] = mode.shape.as_chunks().0;
        let raised = |v: &[f64]| -> [f64; 3] { std::array::from_fn(|a| v.get(a).copied().unwrap_or(0.0)) };
        let points: Vec<[f64; 3]> = particles.x.iter().map(|x| raised(&x.0)).collect();
        let values: Vec<f64> = shape.iter().flat_map(|v| raised(v)).collect();
        let mut about = about::solid(self.case, None);
        about.scalars = about.vectors;
        about.numbers.push(("frequency [Hz]".to_owned(), mode.omega / std::f64::consts::TAU));
        let column = Column { name: "displacement", components: 3, values: &values };
        write_cells(&path, &about, &points, cells(&built.structure.solid), &[column])?;
        self.draw_mode(k, built, mode)?;
        let names = if D == 2 { &["x", "y", "dx", "dy"][..] } else { &["x", "y", "z", "dx", "dy", "dz"] };
        let skin = (0..particles.len()).filter(|i| particles.area[*i] != crate::math::Vector::ZERO);
        let line = |i: usize| particles.x[i].0.iter().chain(&shape[i]).map(|x| Entry::from(*x)).collect();
        let path = self.path(&format!("mode-{}.csv", k + 1));
        Ok(write_csv(&path, names, skin.map(line))?)
    }

    /// The folder of a run that draws pictures.
    fn drawn(&self) -> Option<&Path> {
        self.case.output.report.then_some(self.out)
    }

    /// The shape of a mode, its greatest displacement a tenth of the body: `pictures/mode-1.png`.
    fn draw_mode<const D: usize>(&self, k: usize, built: &Built<D>, mode: &Mode) -> Result<(), RunError> {
        let Some(out) = self.drawn() else { return Ok(()) };
        let solid = &built.structure.solid;
        let size = SHOWN * Bounds::around(&solid.particles.x).extent().max_abs();
        let shape: &[[f64; D]] = mode.shape.as_chunks().0;
        let moved: Vec<[f64; D]> = shape.iter().map(|v| v.map(|v| size * v)).collect();
        let values: Vec<f64> = shape.iter().map(|v| Vector(*v).norm()).collect();
        let title = format!("Mode {}: {} Hz", k + 1, digits(mode.omega / std::f64::consts::TAU));
        let quantity = "displacement".to_owned();
        picture((out, &format!("mode-{}", k + 1)), solid, &moved, &Shown { title, quantity, values })
    }

    /// Pictures of the structure as deformed.
    fn pictures<const D: usize>(&self, built: &Built<D>, u: &[f64]) -> Result<(), RunError> {
        let Some(out) = self.drawn() else { return Ok(()) };
        draw((out, about::solid(self.case, None).scale), &built.structure.solid, &built.structure.state(0.0, u))
    }

    /// `report.html`, of the files that are there.
    fn report(&self) -> Result<(), RunError> {
        self.drawn().map_or(Ok(()), |out| Ok(write_report(out).map(|_| ())?))
    }

    /// `summary.json`, and `modes.csv` where there are modes.
    fn summary(&self, summary: &SolidSummary) -> Result<(), RunError> {
        let path = self.path("summary.json");
        if !summary.modes.is_empty() {
            let table = self.path("modes.csv");
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

impl<const D: usize> SolidKeeper<D> for Files<'_> {
    fn standing(&self, case: &Case, built: &Built<D>) -> Result<Option<Standing>, RunError> {
        self.from.map(|saved| saved.standing(case, built)).transpose()
    }

    fn sought(&self, plan: &Harmonics, built: &Built<D>) -> Result<Option<Sought>, RunError> {
        self.from.map(|saved| saved.sought(plan, built)).transpose()
    }

    fn keep_march(&self, past: Past, state: &[f64], rows: &[Row], work: &Work) -> Result<(), RunError> {
        write_march(past, state, (rows, work), self.case, self.out)
    }

    fn keep_search(&self, place: &Place, held: Instances, before: [u32; 3]) -> Result<(), RunError> {
        write_search(place, (held, before), self.case, self.out)
    }

    fn checkpoint_name(&self) -> String {
        self.path(FILE).display().to_string()
    }

    /// A field file of a series, and the list of all of them.
    fn frame(&self, number: usize, time: f64, built: &Built<D>, u: &[f64]) -> Result<(), RunError> {
        let list = self.path("solid.pvd");
        let name = format!("solid_{number:05}");
        self.fields((&name, Some(time)), built, u)?;
        let known = files::text(self.out, "solid.pvd").unwrap_or_default();
        let mut all = crate::observe::vtk::read_collection(&known);
        all.retain(|(_, file)| *file != format!("{name}.vtu"));
        all.push((time, format!("{name}.vtu")));
        let files: Vec<(f64, &str)> = all.iter().map(|(t, f)| (*t, f.as_str())).collect();
        Ok(write_collection(&list, &files)?)
    }

    /// `history.csv`.
    fn history(&self, built: &Built<D>, rows: &[Row]) -> Result<(), RunError> {
        let path = self.path("history.csv");
        let (names, rows) = history(built, rows);
        let names: Vec<&str> = names.iter().map(String::as_str).collect();
        let line = |row: Vec<f64>| row.into_iter().map(Entry::from).collect();
        Ok(write_csv(&path, &names, rows.into_iter().map(line))?)
    }

    fn end(&self, built: &Built<D>, (state, modes): (&[f64], &[Mode]), summary: &SolidSummary) -> Result<(), RunError> {
        self.fields(("solid", Some(summary.time)), built, state)?;
        if modes.is_empty() {
            self.pictures(built, state)?;
        }
        modes.iter().enumerate().try_for_each(|(k, mode)| self.mode(k, built, mode))?;
        self.summary(summary)?;
        write_state_script(self.out)?;
        self.report()?;
        folder::finish(self.out)
    }
}

impl SolidsKeeper for Files<'_> {}

/// A number in a title: five digits.
fn digits(value: f64) -> String {
    if (1e-3..1e6).contains(&value.abs()) {
        let decimals = (4.0 - value.abs().log10().floor()).clamp(0.0, 7.0) as usize;
        format!("{value:.decimals$}")
    } else {
        format!("{value:.4e}")
    }
}

/// What ties the particles of bodies together in a field file.
fn cells<const D: usize>(solid: &Solid<D>) -> Cells<'_> {
    let cells = solid.cells();
    match (&cells.tetrahedra[..], &cells.triangles[..]) {
        ([], []) => Cells::Vertices,
        ([], triangles) => Cells::Triangles(triangles),
        (tetrahedra, _) => Cells::Tetrahedra(tetrahedra),
    }
}

/// Writes particles where they are and the cells between them, with displacement, velocity, stress and what materials remember.
pub(in crate::run) fn write<const D: usize>(
    path: &Path,
    about: &About,
    solid: &Solid<D>,
    state: &State<'_, D>,
) -> Result<(), RunError> {
    let (points, all) = (places(solid, state), columns(solid, state, &stresses(solid, state)));
    let columns: Vec<Column<'_>> =
        all.iter().map(|(name, components, values)| Column { name, components: *components, values }).collect();
    Ok(write_cells(path, about, &points, cells(solid), &columns)?)
}
