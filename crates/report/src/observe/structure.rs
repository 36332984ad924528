//! The motion of structures: `structure.csv` of a run, and what its tail says.
//!
//! One row per step: of each coordinate its value, rate and generalised force of the gas, then energies and power, and two integrals
//! by the trapezoidal rule of the steps,
//!
//! W = ∫ Σ Q q' dt (`gas_work`, done on the structures) and ∫ (P − Σ Q q') dt (`ledger`), with the power P of pressure and friction on
//! the moving walls as the gas has it: zero where no work is lost between the two.
//!
//! Coordinates are named as in the structure (`plunge`, `plunge_rate`, `plunge_load`), with the body before them (`wing.plunge`)
//! where more than one structure moves. A resumed run goes on to the same bits: the integrals are read back from the last row.
//!
//! Units are those of the case: with a dimensional free stream seconds, metres and radians, rates per second, and in the plane per
//! span N/m and N (forces, moments), J/m (energies, work), W/m (powers); in space N, N m, J, W. Else those of ρ∞, a∞ and the length.
//!
//! The rows of a harmonic balance are two periods of it, and its frequency is known: nothing is fitted.
use std::path::Path;

use serde::{Deserialize, Serialize};

use super::damping::{DampingFit, LastCycles, NoFit, Oscillation, energy_per_cycle};
use super::table::{FileError, History, TableMark, complete_row};
use crate::case::read_regular;

/// Name of the file in the folder of a run.
pub const FILE: &str = "structure.csv";
/// Columns before those of the coordinates.
const BEFORE: [&str; 2] = ["iteration", "time"];
/// What follows the name of a coordinate in its three columns.
const OF_COORDINATE: [&str; 3] = ["", "_rate", "_load"];
/// Columns after those of the coordinates.
const AFTER: [&str; 7] = ["kinetic", "potential", "dissipation", "gas_power", "wall_power", "gas_work", "ledger"];
/// Names of coordinates that are taken for angles where nothing is known but a table.
const ANGLES: [&str; 4] = ["pitch", "flap", "roll", "yaw"];

/// A body on springs and its coordinates.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct StructureNames {
    /// Name of the body.
    pub body: String,
    /// Its coordinates.
    pub coordinates: Vec<CoordinateName>,
    /// True where these are samples of a body made of particles: their loads do not add up to the power that it gets.
    pub samples: bool,
}

/// What a coordinate is called, and what it is.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct CoordinateName {
    /// Its name in the structure.
    pub name: String,
    /// True for an angle, in radians.
    pub angle: bool,
}

/// All structures of a run at the end of a step, in the units of the case.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct StructureSample {
    /// Time.
    pub time: f64,
    /// Coordinates, body after body.
    pub coordinates: Vec<f64>,
    /// Their rates.
    pub rates: Vec<f64>,
    /// Generalised forces of the gas.
    pub loads: Vec<f64>,
    /// Kinetic energy.
    pub kinetic: f64,
    /// Energy of springs and gravity.
    pub potential: f64,
    /// Power that dampers take.
    pub dissipation: f64,
    /// Power of the gas on the structures, Σ Q q', with q' as walls move: by the difference formula of the coordinates.
    pub gas_power: f64,
    /// Power of pressure and friction on the moving walls.
    pub wall_power: f64,
}

/// The table as it grows.
#[derive(Debug)]
pub struct StructureHistory {
    table: History,
    /// Integrals up to the last row.
    last: Option<Totals>,
}

/// Integrals in time and what they go on from.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Totals {
    time: f64,
    gas_power: f64,
    wall_power: f64,
    gas_work: f64,
    ledger: f64,
}

/// A coordinate in a table that was read.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct CoordinateHistory {
    /// Name, with that of the body before it where there are more.
    pub name: String,
    /// Values.
    pub values: Vec<f64>,
    /// Rates.
    pub rates: Vec<f64>,
    /// Generalised forces of the gas.
    pub loads: Vec<f64>,
}

/// A table that was read, column by column.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct StructureTable {
    /// Iterations or steps of the run.
    pub iteration: Vec<f64>,
    /// Times.
    pub time: Vec<f64>,
    /// Coordinates.
    pub coordinates: Vec<CoordinateHistory>,
    /// Kinetic energy.
    pub kinetic: Vec<f64>,
    /// Energy of springs and gravity.
    pub potential: Vec<f64>,
    /// Power that dampers take.
    pub dissipation: Vec<f64>,
    /// Power of the gas on the structures.
    pub gas_power: Vec<f64>,
    /// Power on the moving walls.
    pub wall_power: Vec<f64>,
    /// Integral of `gas_power`.
    pub gas_work: Vec<f64>,
    /// Integral of `wall_power` less `gas_power`.
    pub ledger: Vec<f64>,
}

/// One structure in `summary.json`.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct StructureSummary {
    /// Name of the body.
    pub body: String,
    /// Lines about it: signs, units, the numbers of flutter, frequencies.
    pub description: Vec<String>,
    /// How each coordinate ended.
    pub coordinates: Vec<CoordinateSummary>,
    /// Work of the gas on this structure over the last whole cycle; positive where the motion is fed. None where nothing oscillates.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub energy_per_cycle: Option<f64>,
    /// Greatest difference of the power on the walls and that on the structures at the end of any step, over the greatest power:
    /// zero where all work of the gas arrives. Of all structures together.
    pub lost_power: f64,
}

/// One coordinate in `summary.json`.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct CoordinateSummary {
    /// Name in the structure.
    pub name: String,
    /// True for an angle, in radians.
    pub angle: bool,
    /// Mean over the last whole cycles, of a harmonic balance its two; the last value where nothing oscillates.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub mean: Option<f64>,
    /// Greatest absolute value.
    pub largest: f64,
    /// Half of greatest less smallest value in the last whole cycles, mean of these.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub amplitude: Option<f64>,
    /// Greatest less smallest amplitude of these cycles over their mean.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub amplitude_spread: Option<f64>,
    /// Angular frequency ω of the first of `modes`, or of the harmonic balance.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub frequency: Option<f64>,
    /// Its growth rate σ, zero in a harmonic balance.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub growth_rate: Option<f64>,
    /// Its −σ/√(σ² + ω²).
    #[serde(skip_serializing_if = "Option::is_none")]
    pub damping_ratio: Option<f64>,
    /// Root mean square misfit of the fit over the deviation of the tail.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub fit_residual: Option<f64>,
    /// All oscillations found in the tail.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub modes: Vec<Oscillation>,
    /// Why there is no frequency.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub no_frequency: Option<String>,
}

/// True for names that mostly belong to angles, where a table is all that is known; the name of a body may stand before.
pub fn is_angle(name: &str) -> bool {
    ANGLES.contains(&name.rsplit('.').next().unwrap_or(name))
}

/// Names of all coordinates in the table.
fn full_names(structures: &[StructureNames]) -> Vec<String> {
    let prefix = |s: &StructureNames| if structures.len() > 1 { format!("{}.", s.body) } else { String::new() };
    let own = |s: &StructureNames| s.coordinates.iter().map(|c| prefix(s) + &c.name).collect::<Vec<String>>();
    structures.iter().flat_map(own).collect()
}

/// Names of all columns.
fn columns(structures: &[StructureNames]) -> Vec<String> {
    let of = |name: String| OF_COORDINATE.map(|what| format!("{name}{what}"));
    let coordinates = full_names(structures).into_iter().flat_map(of);
    BEFORE.into_iter().map(str::to_owned).chain(coordinates).chain(AFTER.into_iter().map(str::to_owned)).collect()
}

impl StructureHistory {
    /// Starts an empty table in the folder of a run.
    pub fn create(folder: &Path, structures: &[StructureNames]) -> Result<Self, FileError> {
        let names = columns(structures);
        let names: Vec<&str> = names.iter().map(String::as_str).collect();
        Ok(Self { table: History::create(&folder.join(FILE), &names)?, last: None })
    }

    /// Continues a table after `iteration`, as [`History::resume`] does; the file is created when it does not exist.
    pub fn resume(
        folder: &Path,
        structures: &[StructureNames],
        iteration: u64,
        mark: Option<&TableMark>,
    ) -> Result<Self, FileError> {
        let (names, path) = (columns(structures), folder.join(FILE));
        let names: Vec<&str> = names.iter().map(String::as_str).collect();
        let table = History::resume(&path, &names, iteration, mark)?;
        let last = StructureTable::read(&path)?.and_then(|table| table.totals());
        Ok(Self { table, last })
    }

    /// What the table holds now.
    pub fn mark(&self) -> Result<TableMark, FileError> {
        self.table.mark()
    }

    /// Adds the row of a step.
    pub fn push(&mut self, iteration: u64, sample: &StructureSample) -> Result<(), FileError> {
        let totals = Totals::after(self.last, sample);
        let mut row = vec![iteration as f64, sample.time];
        for ((q, rate), load) in sample.coordinates.iter().zip(&sample.rates).zip(&sample.loads) {
            row.extend([q, rate, load]);
        }
        row.extend([sample.kinetic, sample.potential, sample.dissipation, sample.gas_power, sample.wall_power]);
        row.extend([totals.gas_work, totals.ledger]);
        self.table.append(&row)?;
        self.last = Some(totals);
        Ok(())
    }

    /// Work of the gas on the structures so far.
    pub fn gas_work(&self) -> f64 {
        self.last.map_or(0.0, |totals| totals.gas_work)
    }

    /// Work on the walls as the gas has it less that on the structures, so far.
    pub fn ledger(&self) -> f64 {
        self.last.map_or(0.0, |totals| totals.ledger)
    }
}

impl Totals {
    /// Those after a step to `sample`; they begin at zero with the first.
    fn after(before: Option<Self>, sample: &StructureSample) -> Self {
        let StructureSample { time, gas_power, wall_power, .. } = *sample;
        let Some(b) = before else { return Self { time, gas_power, wall_power, gas_work: 0.0, ledger: 0.0 } };
        let half = 0.5 * (time - b.time);
        let lost = (b.wall_power - b.gas_power) + (wall_power - gas_power);
        let (gas_work, ledger) = (b.gas_work + half * (b.gas_power + gas_power), b.ledger + half * lost);
        Self { time, gas_power, wall_power, gas_work, ledger }
    }
}

impl StructureTable {
    /// The table of a file; nothing when its columns are others.
    pub fn read(path: &Path) -> Result<Option<Self>, FileError> {
        let bytes = read_regular(path).map_err(FileError::io("read", path))?;
        Ok(Self::parse(&String::from_utf8_lossy(&bytes)))
    }

    /// The table of a text up to its first line that is not complete; `None` when its columns are others.
    pub fn parse(text: &str) -> Option<Self> {
        let mut lines = text.split_inclusive('\n');
        let header: Vec<&str> = lines.next()?.trim_end().split(',').collect();
        let inner = header.strip_prefix(&BEFORE)?.strip_suffix(&AFTER)?;
        let named = |c: &[&str]| (0..3).all(|k| c[k].strip_prefix(c[0]) == Some(OF_COORDINATE[k]));
        if !inner.len().is_multiple_of(3) || !inner.chunks_exact(3).all(named) {
            return None;
        }
        let rows: Vec<Vec<f64>> = lines.map_while(|line| complete_row(line, header.len())).collect();
        let column = |k: usize| rows.iter().map(|row| row[k]).collect::<Vec<f64>>();
        let coordinate = |(k, name): (usize, &&str)| {
            let [values, rates, loads] = [2, 3, 4].map(|at| column(at + 3 * k));
            CoordinateHistory { name: (*name).to_owned(), values, rates, loads }
        };
        let coordinates = inner.iter().step_by(3).enumerate().map(coordinate).collect();
        let [iteration, time] = [0, 1].map(column);
        let after: [usize; 7] = std::array::from_fn(|k| BEFORE.len() + inner.len() + k);
        let [kinetic, potential, dissipation, gas_power, wall_power, gas_work, ledger] = after.map(column);
        let mut table = Self { iteration, time, coordinates, kinetic, potential, ..Self::default() };
        (table.dissipation, table.gas_power, table.wall_power) = (dissipation, gas_power, wall_power);
        (table.gas_work, table.ledger) = (gas_work, ledger);
        Some(table)
    }

    /// An empty table of these structures.
    pub fn of(structures: &[StructureNames]) -> Self {
        let named = |name| CoordinateHistory { name, ..CoordinateHistory::default() };
        Self { coordinates: full_names(structures).into_iter().map(named).collect(), ..Self::default() }
    }

    /// Adds the row of a step.
    pub fn push(&mut self, iteration: u64, sample: &StructureSample) {
        let totals = Totals::after(self.totals(), sample);
        for (k, c) in self.coordinates.iter_mut().enumerate() {
            c.values.push(sample.coordinates[k]);
            c.rates.push(sample.rates[k]);
            c.loads.push(sample.loads[k]);
        }
        self.iteration.push(iteration as f64);
        self.time.push(sample.time);
        self.kinetic.push(sample.kinetic);
        self.potential.push(sample.potential);
        self.dissipation.push(sample.dissipation);
        self.gas_power.push(sample.gas_power);
        self.wall_power.push(sample.wall_power);
        self.gas_work.push(totals.gas_work);
        self.ledger.push(totals.ledger);
    }

    /// Number of rows.
    pub fn len(&self) -> usize {
        self.time.len()
    }

    /// True without rows.
    pub fn is_empty(&self) -> bool {
        self.time.is_empty()
    }

    /// True when time passes between the last rows: a march.
    pub fn marches(&self) -> bool {
        matches!(self.time.as_slice(), [.., before, last] if before < last)
    }

    fn totals(&self) -> Option<Totals> {
        Some(Totals {
            time: *self.time.last()?,
            gas_power: *self.gas_power.last()?,
            wall_power: *self.wall_power.last()?,
            gas_work: *self.gas_work.last()?,
            ledger: *self.ledger.last()?,
        })
    }

    /// What became of each structure, without its description; the coordinates are those of the table in their order. `balanced` is the
    /// angular frequency of the harmonic balance whose periods the table holds, where it does.
    pub fn summaries(&self, structures: &[StructureNames], balanced: Option<f64>) -> Vec<StructureSummary> {
        let mut rest = self.coordinates.as_slice();
        let summary = |names: &StructureNames| {
            let (own, others) = rest.split_at(names.coordinates.len().min(rest.len()));
            rest = others;
            self.summary(names, own, balanced, structures.len() == 1)
        };
        structures.iter().map(summary).collect()
    }

    /// Greatest difference of the two powers over the greatest of them.
    fn lost_power(&self) -> f64 {
        let lost = largest(self.wall_power.iter().zip(&self.gas_power).map(|(wall, gas)| wall - gas));
        let all = largest(self.wall_power.iter().chain(&self.gas_power).copied());
        if all > 0.0 { lost / all } else { 0.0 }
    }

    fn summary(
        &self,
        names: &StructureNames,
        own: &[CoordinateHistory],
        balanced: Option<f64>,
        alone: bool,
    ) -> StructureSummary {
        let told = |(name, c): (&CoordinateName, &CoordinateHistory)| match balanced {
            Some(omega) => CoordinateSummary::periodic(name, &self.time, &c.values, omega),
            None => CoordinateSummary::of(name, &self.time, &c.values),
        };
        let coordinates: Vec<_> = names.coordinates.iter().zip(own).map(told).collect();
        // the period is that of the coordinate whose fit is to be believed most
        let fitted = coordinates.iter().filter_map(|c| Some([c.fit_residual?, c.frequency?]));
        let best = fitted.min_by(|a, b| a[0].total_cmp(&b[0])).map(|[_, frequency]| frequency);
        let power = |k: usize| own.iter().map(|c| c.loads[k] * c.rates[k]).sum::<f64>();
        // samples say nothing of the power of all; that of all structures is known
        let power: Option<Vec<f64>> = match (names.samples, alone) {
            (false, _) => Some((0..self.len()).map(power).collect()),
            (true, true) => Some(self.gas_power.clone()),
            (true, false) => None,
        };
        let cycle = |frequency: f64| energy_per_cycle(&self.time, power.as_ref()?, frequency);
        let energy_per_cycle = balanced.or(best).and_then(cycle);
        let lost_power = self.lost_power();
        StructureSummary {
            body: names.body.clone(),
            description: Vec::new(),
            coordinates,
            energy_per_cycle,
            lost_power,
        }
    }
}

/// Greatest absolute value.
fn largest(values: impl Iterator<Item = f64>) -> f64 {
    values.fold(0.0, |m: f64, v| m.max(v.abs()))
}

impl CoordinateSummary {
    /// Mean, amplitude, frequency and damping from the tail of a history.
    pub fn of(name: &CoordinateName, time: &[f64], values: &[f64]) -> Self {
        let mean = values.last().copied().filter(|last| last.is_finite());
        let largest = largest(values.iter().copied());
        let summary = Self { name: name.name.clone(), angle: name.angle, mean, largest, ..Self::default() };
        match DampingFit::of(time, values) {
            Ok(fit) => summary.with(fit, time, values),
            Err(reason) => Self {
                no_frequency: Some(reason.to_string()).filter(|_| reason != NoFit::Still && time.len() > 1),
                ..summary
            },
        }
    }

    /// Mean and amplitude of whole periods of a motion that has the angular frequency `omega` and neither grows nor decays.
    pub fn periodic(name: &CoordinateName, time: &[f64], values: &[f64], omega: f64) -> Self {
        let cycles = LastCycles::of(time, values, omega);
        Self {
            name: name.name.clone(),
            angle: name.angle,
            mean: cycles.map(|c| c.mean),
            largest: largest(values.iter().copied()),
            amplitude: cycles.map(|c| c.amplitude),
            frequency: Some(omega),
            growth_rate: Some(0.0),
            damping_ratio: Some(0.0),
            ..Self::default()
        }
    }

    fn with(self, fit: DampingFit, time: &[f64], values: &[f64]) -> Self {
        let first = fit.modes[0];
        let cycles = LastCycles::of(time, values, first.frequency);
        Self {
            mean: Some(cycles.map_or(fit.constant, |c| c.mean)),
            amplitude: cycles.map(|c| c.amplitude),
            amplitude_spread: cycles.map(|c| c.spread),
            frequency: Some(first.frequency),
            growth_rate: Some(first.growth_rate),
            damping_ratio: Some(first.damping_ratio),
            fit_residual: Some(fit.residual),
            modes: fit.modes,
            ..self
        }
    }
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;

    pub(crate) fn named(name: &str, angle: bool) -> CoordinateName {
        CoordinateName { name: name.into(), angle }
    }

    pub(crate) fn section() -> StructureNames {
        StructureNames {
            body: "wing".into(),
            coordinates: vec![named("plunge", false), named("pitch", true)],
            samples: false,
        }
    }

    /// A section that swings: plunge decays, pitch keeps its amplitude; walls lose a tenth of the power.
    pub(crate) fn sample(step: u64) -> StructureSample {
        let t = 0.1 * step as f64;
        let (h, a) = ((-0.02 * t).exp() * (0.9 * t).cos(), 0.05 * (0.9 * t).sin() + 0.01);
        let rates = vec![-0.02 * h - 0.9 * (-0.02 * t).exp() * (0.9 * t).sin(), 0.045 * (0.9 * t).cos()];
        let loads = vec![0.3 * rates[0], 0.0];
        let gas_power = 0.3 * rates[0] * rates[0];
        StructureSample {
            time: t,
            coordinates: vec![h, a],
            kinetic: 0.5 * rates[0] * rates[0],
            potential: 0.5 * h * h,
            rates,
            loads,
            dissipation: 0.0,
            gas_power,
            wall_power: 0.9 * gas_power,
        }
    }

    /// Writes the file of such a run of 600 steps.
    pub(crate) fn fill(folder: &Path) {
        let mut history = StructureHistory::create(folder, &[section()]).unwrap();
        (0..600).for_each(|k| history.push(k, &sample(k)).unwrap());
    }

    #[test]
    fn a_resumed_table_has_the_same_bits() {
        let [whole, cut] = [tempfile::tempdir().unwrap(), tempfile::tempdir().unwrap()];
        fill(whole.path());
        let mut history = StructureHistory::create(cut.path(), &[section()]).unwrap();
        (0..320).for_each(|k| history.push(k, &sample(k)).unwrap());
        let mut history = StructureHistory::resume(cut.path(), &[section()], 300, None).unwrap();
        (301..600).for_each(|k| history.push(k, &sample(k)).unwrap());
        let text = |folder: &Path| std::fs::read_to_string(folder.join(FILE)).unwrap();
        assert!(text(whole.path()) == text(cut.path()));
        assert!((history.ledger() + 0.1 * history.gas_work()).abs() < 1e-12 && history.gas_work() > 1.0);
        // a table that is not there begins
        let fresh = tempfile::tempdir().unwrap();
        assert_eq!(StructureHistory::resume(fresh.path(), &[section()], 7, None).unwrap().gas_work(), 0.0);
        let wide = StructureSample { coordinates: vec![0.0; 3], rates: vec![0.0; 3], loads: vec![0.0; 3], ..sample(0) };
        assert!(matches!(history.push(600, &wide), Err(FileError::Width { .. })));
    }

    #[test]
    fn names_of_bodies_stand_before_coordinates_where_there_are_more() {
        let tail = StructureNames { body: "tail".into(), coordinates: vec![named("pitch", true)], samples: false };
        let names = columns(&[section(), tail]).join(",");
        assert!(names.starts_with("iteration,time,wing.plunge,wing.plunge_rate,wing.plunge_load,wing.pitch,"));
        assert!(names.ends_with("tail.pitch_load,kinetic,potential,dissipation,gas_power,wall_power,gas_work,ledger"));
        assert!(columns(&[section()]).contains(&"plunge_rate".to_owned()));
        assert!(is_angle("wing.pitch") && is_angle("flap") && !is_angle("plunge") && !is_angle("bending"));
    }

    #[test]
    fn a_table_reads_back_and_is_summed_up() {
        let folder = tempfile::tempdir().unwrap();
        fill(folder.path());
        let table = StructureTable::read(&folder.path().join(FILE)).unwrap().unwrap();
        assert!(table.len() == 600 && table.marches() && table.coordinates.len() == 2);
        assert_eq!(table.coordinates[1].name, "pitch");
        assert_eq!(table.coordinates[0].rates[17], sample(17).rates[0]);
        assert_eq!(table.wall_power[3], sample(3).wall_power);
        let all = table.summaries(&[section()], None);
        let [plunge, pitch] = all[0].coordinates.as_slice() else { panic!("{all:?}") };
        assert!((plunge.frequency.unwrap() - 0.9).abs() < 1e-8 && (plunge.growth_rate.unwrap() + 0.02).abs() < 1e-8);
        assert!(
            pitch.angle && (pitch.mean.unwrap() - 0.01).abs() < 1e-4 && (pitch.amplitude.unwrap() - 0.05).abs() < 1e-5
        );
        assert!(plunge.fit_residual.unwrap() < 1e-9 && pitch.amplitude_spread.unwrap() < 1e-3, "{all:?}");
        // q' = Re s e^{st}, so that ∫ q'² dt = |s|² e^{2σt}/(4σ) + Re(s e^{2st})/4
        let s = num_complex::Complex64::new(-0.02, 0.9);
        let integral = |t: f64| 0.25 * (s.norm_sqr() * (2.0 * s.re * t).exp() / s.re + (s * (2.0 * s * t).exp()).re);
        let expected = 0.3 * (integral(59.9) - integral(59.9 - std::f64::consts::TAU / s.im));
        assert!((all[0].energy_per_cycle.unwrap() / expected - 1.0).abs() < 2e-3, "{all:?} {expected}");
        let text = serde_json::to_string(&all).unwrap();
        assert_eq!(serde_json::from_str::<Vec<StructureSummary>>(&text).unwrap(), all);
    }

    #[test]
    fn periods_of_a_balance_have_its_frequency_and_modes_are_no_angles() {
        let omega = 0.7;
        let names = StructureNames { body: "wing".into(), coordinates: vec![named("pitch", false)], samples: false };
        let mut table = StructureTable::of(std::slice::from_ref(&names));
        for k in 0..=256 {
            let phase = std::f64::consts::TAU * f64::from(k) / 128.0;
            let rate = -0.3 * omega * phase.sin();
            table.push(
                9,
                &StructureSample {
                    time: phase / omega,
                    coordinates: vec![0.1 + 0.3 * phase.cos()],
                    rates: vec![rate],
                    loads: vec![2.0 * rate],
                    ..StructureSample::default()
                },
            );
        }
        let all = table.summaries(&[names], Some(omega));
        let c = &all[0].coordinates[0];
        assert_eq!((c.frequency, c.growth_rate, c.angle, c.fit_residual), (Some(omega), Some(0.0), false, None));
        assert!((c.mean.unwrap() - 0.1).abs() < 1e-12 && (c.amplitude.unwrap() - 0.3).abs() < 1e-6, "{c:?}");
        // ∫ 2 q'² dt = 2 π ω a²
        let work = std::f64::consts::TAU * omega * 0.09;
        assert!((all[0].energy_per_cycle.unwrap() / work - 1.0).abs() < 1e-12, "{all:?}");
    }

    #[test]
    fn tables_of_others_are_not_read_and_an_equilibrium_has_no_frequency() {
        assert_eq!(StructureTable::parse("iteration,time,cl\n1,2,3\n"), None);
        assert_eq!(StructureTable::parse(""), None);
        let header = columns(&[section()]).join(",");
        assert!(StructureTable::parse(&header).unwrap().is_empty());
        assert_eq!(StructureTable::parse(&header.replace("plunge_load", "pitch_load")), None);
        let rest = CoordinateSummary::of(&named("pitch", true), &[0.0; 50], &[0.02; 50]);
        assert!(rest.mean == Some(0.02) && rest.frequency.is_none() && rest.no_frequency.is_some());
    }
}
