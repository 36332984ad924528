//! The fields of two runs at the particles of the second: at phases of the period that both have, and harmonic by harmonic.
//! Where the first has other particles, its values are carried there by least squares.
//!
//! Differences are those of the fluid particles, each counted once. Root mean square and greatest difference are told as they
//! are and over half the range of the reference, those of a harmonic over the root mean square of that harmonic in the reference.
use std::path::Path;

use num_complex::Complex64;
use serde_json::Value;

use super::files::RunFolder;
use super::transfer::Transfer;
use crate::observe::vtk::read_collection;
use crate::observe::vtk_read::FieldFile;

/// Quantities that are compared.
const QUANTITIES: [&str; 2] = ["density", "pressure"];
/// Harmonics that are compared at most.
const MOST: usize = 16;
/// Part of a period within which two phases are one.
const SAME_PHASE: f64 = 1e-6;
/// Part of the extent of the cloud within which two particles are one: times of a march are sums of steps.
const SAME_PLACE: f64 = 1e-6;

/// How one quantity differs.
#[derive(Clone, Debug, PartialEq)]
pub struct FieldDifference {
    /// Quantity.
    pub quantity: &'static str,
    /// Phase in parts of the period, or harmonic.
    pub at: At,
    /// Root mean square over the fluid particles.
    pub rms: f64,
    /// Greatest difference.
    pub largest: f64,
    /// Where that is.
    pub place: [f64; 3],
    /// What both are counted against: half the range of the reference, root mean square of its harmonic.
    pub scale: f64,
    /// The runs have different particles: the values of the first were carried to those of the second.
    pub carried: bool,
}

/// Which part of a period a difference belongs to.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum At {
    /// A moment.
    Phase(f64),
    /// A harmonic, 0 for the mean.
    Harmonic(usize),
}

impl At {
    /// In words.
    pub(super) fn words(&self) -> String {
        match self {
            Self::Phase(phase) => format!("phase {phase:.4}"),
            Self::Harmonic(0) => "mean".into(),
            Self::Harmonic(n) => format!("harmonic {n}"),
        }
    }
}

/// Compares the fields of two runs, or says why they cannot be compared.
pub(super) fn differences(runs: &[RunFolder; 2], period: f64) -> Result<Vec<FieldDifference>, String> {
    let lists = runs.each_ref().map(|run| phases(run, period));
    let mut found = Vec::new();
    let mut reason = "the runs have no field at the same phase".to_owned();
    for (phase, file) in &lists[1] {
        let near = |p: f64| (p - phase).abs() < SAME_PHASE;
        let Some((_, other)) = lists[0].iter().find(|(p, _)| near(*p)) else { continue };
        match at_phase([&runs[0].path.join(other), &runs[1].path.join(file)], *phase) {
            Ok(some) => found.extend(some),
            Err(why) => reason = why,
        }
    }
    found.extend(harmonics(runs));
    if found.is_empty() { Err(reason) } else { Ok(found) }
}

/// Phases and files of a run, one file for each phase: the last one.
fn phases(run: &RunFolder, period: f64) -> Vec<(f64, String)> {
    let mut all: Vec<(f64, String)> = Vec::new();
    let lists = ["field.pvd", "series.pvd"].map(|name| read_collection(&run.text(name).unwrap_or_default()));
    for (time, file) in lists.into_iter().flatten() {
        let phase = (time / period).rem_euclid(1.0);
        let phase = if phase > 1.0 - SAME_PHASE { 0.0 } else { phase };
        // the field of the end comes first; of a series, later times replace earlier ones
        match all.iter().position(|(p, _)| (p - phase).abs() < SAME_PHASE) {
            Some(k) if all[k].1 != "field.vtu" => all[k].1 = file,
            Some(_) => {}
            None => all.push((phase, file)),
        }
    }
    all.sort_by(|a, b| a.0.total_cmp(&b.0));
    all
}

fn at_phase(paths: [&Path; 2], phase: f64) -> Result<Vec<FieldDifference>, String> {
    let [a, b] = open(paths)?;
    let both = Both::new(&a, &b)?;
    let fluid = &both.fluid;
    let one = |quantity: &'static str| {
        let (x, y) = (both.carried(a.values(quantity)?), b.values(quantity)?);
        let (low, high) =
            fluid.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |r, i| (r.0.min(y[*i]), r.1.max(y[*i])));
        let size = |i: usize| (x[i] - y[i]).abs();
        Some(both.collected(quantity, At::Phase(phase), size, 0.5 * (high - low)))
    };
    QUANTITIES
        .into_iter()
        .map(one)
        .collect::<Option<_>>()
        .ok_or_else(|| "a field file lacks density or pressure".into())
}

/// Harmonics that both runs hold.
fn harmonics(runs: &[RunFolder; 2]) -> Vec<FieldDifference> {
    let path = |k: usize| runs[k].path.join("field_harmonics.vtu");
    let Ok([a, b]) = open([&path(0), &path(1)]) else { return Vec::new() };
    let Ok(mut both) = Both::new(&a, &b) else { return Vec::new() };
    // the file has no kinds: fluid particles come first
    let n_fluid = FieldFile::open(&runs[1].path.join("field.vtu")).ok().and_then(|f| f.values("kind"));
    both.fluid.truncate(n_fluid.map_or(usize::MAX, |kind| kind.iter().take_while(|k| **k == 0.0).count()));
    let one = |quantity: &'static str, n: usize| {
        let term = |file: &FieldFile| -> Option<Vec<Complex64>> {
            if n == 0 {
                return Some(file.values(&format!("{quantity}_mean"))?.into_iter().map(Complex64::from).collect());
            }
            let (re, im) = (file.values(&format!("{quantity}_{n}_re"))?, file.values(&format!("{quantity}_{n}_im"))?);
            Some(re.into_iter().zip(im).map(|(re, im)| Complex64::new(re, im)).collect())
        };
        let (x, y) = (both.carried(term(&a)?), term(&b)?);
        let scale = root_mean_square(&both.fluid, |i| y[i].norm());
        Some(both.collected(quantity, At::Harmonic(n), |i| (x[i] - y[i]).norm(), scale))
    };
    QUANTITIES.into_iter().flat_map(|q| (0..=MOST).map_while(move |n| one(q, n))).collect()
}

fn open(paths: [&Path; 2]) -> Result<[FieldFile; 2], String> {
    let read = |path: &Path| FieldFile::open(path).map_err(|e| format!("{}: {e}", path.display()));
    Ok([read(paths[0])?, read(paths[1])?])
}

/// The particles of two files.
struct Both {
    /// Places of those of the second.
    points: Vec<[f64; 3]>,
    /// Those that are fluid.
    fluid: Vec<usize>,
    /// From the first to the second, where they are not the same.
    transfer: Option<Transfer>,
}

impl Both {
    fn new(a: &FieldFile, b: &FieldFile) -> Result<Self, String> {
        let broken = || "a field file is cut short".to_owned();
        let (x, y) = (a.points().ok_or_else(broken)?, b.points().ok_or_else(broken)?);
        let far = |p: &[f64; 3], q: &[f64; 3]| (0..3).map(|d| (p[d] - q[d]).abs()).fold(0.0, f64::max);
        let extent = y.first().map_or(0.0, |first| y.iter().map(|p| far(p, first)).fold(0.0, f64::max));
        let apart = x.iter().zip(&y).map(|(p, q)| far(p, q)).fold(0.0, f64::max);
        let same = x.len() == y.len() && apart <= SAME_PLACE * extent;
        let transfer = if same { None } else { Some(Transfer::new(&x, &y).ok_or_else(broken)?) };
        let kind = b.values("kind").unwrap_or_else(|| vec![0.0; y.len()]);
        let fluid = (0..y.len()).filter(|i| kind[*i] == 0.0).collect();
        Ok(Self { points: y, fluid, transfer })
    }

    /// Values of the first file at the particles of the second.
    fn carried<T: Copy + std::ops::Add<Output = T> + std::ops::Mul<f64, Output = T>>(&self, values: Vec<T>) -> Vec<T> {
        match &self.transfer {
            Some(transfer) => transfer.of(&values),
            None => values,
        }
    }

    fn collected(&self, quantity: &'static str, at: At, size: impl Fn(usize) -> f64, scale: f64) -> FieldDifference {
        let most = self.fluid.iter().copied().max_by(|i, j| size(*i).total_cmp(&size(*j)));
        let (largest, place) = most.map_or((f64::NAN, [f64::NAN; 3]), |i| (size(i), self.points[i]));
        let (rms, carried) = (root_mean_square(&self.fluid, size), self.transfer.is_some());
        FieldDifference { quantity, at, rms, largest, place, scale, carried }
    }
}

fn root_mean_square(chosen: &[usize], size: impl Fn(usize) -> f64) -> f64 {
    (chosen.iter().map(|i| size(*i).powi(2)).sum::<f64>() / chosen.len() as f64).sqrt()
}

impl FieldDifference {
    /// Place of the greatest difference in words; the third coordinate only where there is one.
    pub(super) fn where_it_is(&self) -> String {
        let [x, y, z] = self.place;
        if z == 0.0 { format!("({x:.4}, {y:.4})") } else { format!("({x:.4}, {y:.4}, {z:.4})") }
    }
}

/// Period of the motion that a run noted.
pub(super) fn period_of(harmonics: &Value) -> f64 {
    harmonics["period"]
        .as_f64()
        .unwrap_or_else(|| std::f64::consts::TAU / harmonics["omega"].as_f64().unwrap_or(f64::NAN))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::observe::vtk::{About, Cells, Column, write_cells, write_collection};

    fn write(folder: &Path, name: &str, columns: &[(&str, [f64; 3])], shift: f64) {
        let points = [[0.0, 0.0, 0.0], [1.0 + shift, 0.0, 0.0], [0.0, 1.0, 0.0]];
        let columns: Vec<Column<'_>> =
            columns.iter().map(|(name, values)| Column { name, components: 1, values }).collect();
        write_cells(&folder.join(name), &About::default(), &points, Cells::Vertices, &columns).unwrap();
    }

    fn run(folder: &Path, time: f64, density: f64, shift: f64) -> RunFolder {
        std::fs::create_dir_all(folder).unwrap();
        // the last particle is one of a wall
        let columns = [("density", [1.0, density, 9.0]), ("pressure", [1.0, 3.0, 9.0]), ("kind", [0.0, 0.0, 1.0])];
        write(folder, "field.vtu", &columns, shift);
        write_collection(&folder.join("field.pvd"), &[(time, "field.vtu")]).unwrap();
        let first = [("density_1_re", [density, 0.0, 5.0]), ("density_1_im", [0.0, density, 5.0])];
        let all = [&[("density_mean", [1.0, 1.0, 5.0])], &first[..]].concat();
        write(folder, "field_harmonics.vtu", &all, shift);
        RunFolder::new(folder)
    }

    #[test]
    fn fields_differ_by_what_they_differ() {
        let root = tempfile::tempdir().unwrap();
        let at = |name: &str| root.path().join(name);
        let runs = [run(&at("a"), 0.0, 3.5, 0.0), run(&at("b"), 8.0, 3.0, 0.0)];
        let found = differences(&runs, 2.0).unwrap();
        let [density, pressure, mean, first] = &found[..] else { panic!("{found:?}") };
        assert_eq!((density.at, density.largest, density.place), (At::Phase(0.0), 0.5, [1.0, 0.0, 0.0]));
        assert!((density.rms - 0.125f64.sqrt()).abs() < 1e-15 && density.scale == 1.0, "{density:?}");
        assert_eq!((pressure.quantity, pressure.largest, pressure.rms), ("pressure", 0.0, 0.0));
        assert_eq!((mean.at, mean.rms, first.at), (At::Harmonic(0), 0.0, At::Harmonic(1)));
        assert!((first.rms / first.scale - 0.5 / 3.0).abs() < 1e-15, "{first:?}");
        let late = [run(&at("c"), 0.3, 3.5, 0.0), run(&at("d"), 8.0, 3.0, 0.0)];
        let found = differences(&late, 2.0).unwrap();
        assert!(found.iter().all(|d| matches!(d.at, At::Harmonic(_))), "{found:?}");
        let apart = [run(&at("e"), 0.0, 3.5, 0.01), run(&at("f"), 8.0, 3.0, 0.0)];
        let found = differences(&apart, 2.0).unwrap();
        assert!(found.iter().all(|d| d.carried) && (0.4..0.5).contains(&found[0].largest), "{found:?}");
    }
}
