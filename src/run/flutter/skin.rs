//! Files of motions: what the page reads, and series for ParaView.
use std::path::Path;

use num_complex::Complex64;
use serde::Serialize;

use super::super::folder::make_within;
use crate::observe::vtk::{About, Column, Facets, write_collection, write_surface};
use crate::observe::write_atomic;
use crate::problem::RunError;
use crate::record::flutter::FlutterRow;
use crate::study::flutter::{Moving, Skin};

/// Phases of a period in files.
const PHASES: usize = 16;
/// Triangles on the page, at most.
const MOST: usize = 5000;
/// Part of the chord that places are rounded to on the page.
const ROUNDED: f64 = 1e-5;
/// Folder of the files of a series.
const FOLDER: &str = "modes";

/// What the page reads: numbers one after another.
#[derive(Serialize)]
struct Told<'a> {
    chord: f64,
    coordinates: &'a [String],
    points: Vec<f64>,
    lines: Vec<u32>,
    triangles: Vec<u32>,
    moves: Vec<Vec<f64>>,
}

impl Skin {
    /// Writes what the page reads.
    pub(super) fn write(&self, file: &Path) -> Result<(), RunError> {
        let own = self.thinned(MOST);
        let step = ROUNDED * own.chord;
        // whole multiples of a power of ten are short in text
        let step = 10.0f64.powf(step.log10().floor()).recip().round();
        let round = |x: &f64| (x * step).round() / step + 0.0;
        let flat = |all: &[[f64; 3]]| all.iter().flatten().map(round).collect::<Vec<f64>>();
        let told = Told {
            chord: own.chord,
            coordinates: &own.coordinates,
            points: flat(&own.points),
            lines: own.lines.iter().flatten().copied().collect(),
            triangles: own.triangles.iter().flatten().copied().collect(),
            moves: own.moves.iter().map(|m| flat(m)).collect(),
        };
        // on one line: a number is not worth one
        let text = serde_json::to_vec(&told).unwrap_or_default();
        Ok(write_atomic(file, |w| w.write_all(&text))?)
    }

    /// Writes the motion of a crossing at phases of a period as a series for ParaView, `name`.pvd in `out`: with the pressure on the walls
    /// where that is known, else of the surface alone.
    pub(super) fn write_series(
        &self,
        out: &Path,
        (name, about): (&str, &About),
        crossing: &FlutterRow,
    ) -> Result<(), RunError> {
        let chains: Vec<Vec<u32>> = self.lines.iter().map(|l| l.to_vec()).collect();
        let (lines, triangles) = match &crossing.walls {
            Some(walls) => (&walls.lines, &walls.triangles),
            None => (&chains, &self.triangles),
        };
        let moving = self.moving(crossing);
        let facets = if triangles.is_empty() { Facets::Polylines(lines) } else { Facets::Triangles(triangles) };
        make_within(out, FOLDER)?;
        let mut files = Vec::new();
        for k in 0..PHASES {
            let part = k as f64 / PHASES as f64;
            let file = format!("{FOLDER}/{name}-{k:02}.vtp");
            moving.write(&out.join(&file), about, facets, part)?;
            let time = if crossing.frequency > 0.0 { part / crossing.frequency } else { part };
            files.push((time, file));
        }
        let listed: Vec<(f64, &str)> = files.iter().map(|(time, file)| (*time, file.as_str())).collect();
        Ok(write_collection(&out.join(format!("{name}.pvd")), &listed)?)
    }
}

impl Moving<'_> {
    /// Writes them at the part `part` of the period.
    fn write(&self, path: &Path, about: &About, facets: Facets<'_>, part: f64) -> Result<(), RunError> {
        let wave = Complex64::cis(std::f64::consts::TAU * part);
        let shift: Vec<[f64; 3]> = self.shifts.iter().map(|d| d.map(|d| (d * wave).re)).collect();
        let places: Vec<[f64; 3]> =
            self.points.iter().zip(&shift).map(|(x, d)| [0, 1, 2].map(|k| x[k] + d[k])).collect();
        let values: Vec<f64> = shift.into_iter().flatten().collect();
        let of_pressure = |f: &dyn Fn(&Complex64) -> f64| self.cp.iter().map(f).collect::<Vec<f64>>();
        let now = of_pressure(&|cp| (cp * wave).re);
        let (size, phase) = (of_pressure(&|cp| cp.norm()), of_pressure(&|cp| cp.arg().to_degrees()));
        let mut columns = vec![Column { name: "displacement", components: 3, values: &values }];
        if !self.cp.is_empty() {
            let told = [("cp_unsteady", &now), ("cp_amplitude", &size), ("cp_phase_deg", &phase)];
            columns.extend(told.map(|(name, values)| Column { name, components: 1, values }));
        }
        Ok(write_surface(path, about, &places, facets, &columns)?)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::record::flutter::{Share, WallMotion};
    use crate::run::about;
    use crate::study::flutter::problem_of;

    const CASE: &str = "[flow]\nmach = 0.5\n[[body]]\nnaca = \"0012\"\n[cloud]\nspacing = 0.1\n[flutter]\n[structure]\nelastic_axis = -0.4\n\
                        mass_ratio = 60\nx_alpha = 0.2\nr_alpha2 = 0.25\nfrequency_ratio = 0.5\nreduced_speed = 2\n";

    fn share(coordinate: &str, amplitude: f64, phase_deg: f64) -> Share {
        Share { coordinate: coordinate.into(), amplitude, phase_deg }
    }

    #[test]
    fn a_motion_becomes_a_series_and_a_table_for_the_page() {
        let problem = problem_of(CASE);
        let skin = Skin::of(&problem, &[0.5, 1.0]);
        let folder = tempfile::tempdir().unwrap();
        let shape = [share("plunge", 1.0, 0.0), share("pitch", 0.4, 90.0)];
        let mut row = FlutterRow { frequency: 2.0, shape: shape.to_vec(), ..FlutterRow::default() };
        let named = ("flutter-mode-mach-0.500", &about::gas(problem.case(), "cp_unsteady", None));
        skin.write_series(folder.path(), named, &row).unwrap();
        let text = std::fs::read_to_string(folder.path().join("flutter-mode-mach-0.500.pvd")).unwrap();
        let listed = crate::observe::vtk::read_collection(&text);
        assert!(listed.len() == 16 && listed[8].0 == 0.25);
        assert!(listed.iter().all(|(_, file)| folder.path().join(file).is_file()));
        row.walls = Some(WallMotion {
            points: vec![[0.0; 3], [1.0, 0.0, 0.0]],
            lines: vec![vec![0, 1]],
            displacement: vec![[[0.0; 2], [2.0, 0.0], [0.0; 2]], [[0.0; 2], [0.0, 1.0], [0.0; 2]]],
            cp: vec![[4.0, 0.0], [0.0, -2.0]],
            ..WallMotion::default()
        });
        skin.write_series(folder.path(), named, &row).unwrap();
        let at = |k: usize| crate::observe::vtk_read::FieldFile::open(&folder.path().join(&listed[k].1)).unwrap();
        // the largest displacement, 2, is drawn as a tenth of the chord, and pressures with it
        assert_eq!(at(0).values("cp_unsteady").unwrap(), [0.2, 0.0]);
        assert!((at(4).values("cp_unsteady").unwrap()[1] - 0.1).abs() < 1e-15);
        assert_eq!(at(8).values("cp_amplitude").unwrap(), [0.2, 0.1]);
        assert_eq!(at(0).values("displacement").unwrap()[1], 0.1);
        assert_eq!(at(0).unit("displacement"), Some("L"));
        skin.write(&folder.path().join("modes.json")).unwrap();
        let text = std::fs::read_to_string(folder.path().join("modes.json")).unwrap();
        let told: serde_json::Value = serde_json::from_str(&text).unwrap();
        assert_eq!(told["points"].as_array().unwrap().len(), 3 * skin.points.len());
        assert_eq!(told["moves"][0][1], 0.5);
    }
}
