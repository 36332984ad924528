//! What is measured of a finished run: the value of each metric of [`crate::claims`].
mod axis;
pub(super) mod boundary;
pub(super) mod forces;
mod kept;
mod numbers;
mod section;
pub(super) mod solid;
mod structure;

use std::path::Path;

use num_complex::Complex64;
pub(super) use numbers::Numbers;

use crate::case::{Case, Shape};
use crate::claims::metric::{ComparisonMetric, EndMetric, FieldMetric, PeriodicMetric, ThinMetric};
use crate::claims::metrics;
use crate::claims::wall::{Wall, contains};
use crate::claims::{Claim, Curve, FieldTruth, Loops, Metric, Table, WallTruth, loops};
use crate::exact::blasius::{layer, skin_friction};
use crate::math::{Bounds, Vector};
use crate::observe::cycles::Cycles;
use crate::physics::{Gas, Primitive};
use crate::problem::files::plain;
use crate::scheme::start::free_stream;
use crate::study::{LastPeriod, Snapshot};

/// Part of the chord in which shocks are looked for: away from the suction peak and the trailing edge.
const SHOCK_WINDOW: (f64, f64) = (0.05, 0.95);

/// Height of the boundary layer of Blasius that profiles are compared in, in √(νx/U).
const LAYER: f64 = 7.0;

/// A finished run, ready to be measured.
pub(super) struct Measured {
    /// The case as it ran.
    pub(super) case: Case,
    /// Its numbers.
    pub(super) numbers: Numbers,
    /// The columns of its solution that claims are about.
    pub(super) field: Snapshot,
    /// Its wall, empty without bodies.
    pub(super) wall: Wall,
    /// Its loads over the last period, empty when nothing repeats.
    pub(super) loops: Loops,
}

/// Weights of values on sections of these thicknesses in the polynomial through all of them, where there is no thickness.
fn at_no_thickness(thickness: &[f64]) -> Result<Vec<f64>, String> {
    let weight = |k: usize| -> f64 {
        let rest = thickness.iter().enumerate().filter(|(j, _)| *j != k);
        rest.map(|(_, t)| t / (t - thickness[k])).product()
    };
    let all: Vec<f64> = (0..thickness.len()).map(weight).collect();
    if all.iter().all(|w| w.is_finite()) { Ok(all) } else { Err("two sections are equally thick".into()) }
}

/// Thickness in parts of the chord that the designation of a NACA section says.
fn designed_thickness(case: &Case) -> Option<f64> {
    match &case.bodies.first()?.shape {
        Shape::Naca(naca) => Some(naca.design().ok()?.thickness),
        _ => None,
    }
}

/// A value, or why there is none.
pub(super) type Value = Result<f64, String>;

impl Measured {
    /// The metric of `claim`, that needs one run only (and `others` where the claim names other cases); of a study, what it measures at each
    /// spacing.
    pub(super) fn value(&self, claim: &Claim, folder: &Path, others: &[&Self]) -> Value {
        let metric = match claim.metric {
            Metric::Study(metric) => metric.at_each_spacing(),
            other => other,
        };
        match metric {
            Metric::End(metric) => self.of_the_end(metric),
            Metric::Periodic(metric) => self.of_periods(metric),
            Metric::Thin(metric) => self.of_thin_sections(metric, others),
            Metric::Comparison(metric) => self.beside_others(metric, (claim, folder), others.first().copied()),
            Metric::Field(metric) => self.of_fields(metric, claim, folder),
            Metric::Structure(metric) => self.of_structure(metric, claim, others),
            Metric::Solid(_) => Err("the case has a gas: this is measured of structures alone".into()),
            Metric::Flutter(_) => Err("this is measured of a flutter boundary, not of a run".into()),
            Metric::Force(_) => Err("this is measured of `[gaf]`, not of a run".into()),
            Metric::Bar(_) | Metric::Study(_) => Err("the metric needs other cases or spacings".into()),
        }
    }

    /// Metrics of the summary: loads and convergence at the end of the run.
    fn of_the_end(&self, metric: EndMetric) -> Value {
        let s = &self.numbers;
        match metric {
            EndMetric::Cl => Ok(s.loads.cl),
            EndMetric::Cd => Ok(s.loads.cd),
            EndMetric::Cm => Ok(s.loads.cm),
            EndMetric::CdPressure => s.loads_pressure.map(|c| c.cd).ok_or_else(no_viscosity),
            EndMetric::CdFriction => s.loads_friction.map(|c| c.cd).ok_or_else(no_viscosity),
            EndMetric::SeparationUpper => {
                s.separation_upper.ok_or_else(|| "friction turns nowhere on the upper side".into())
            }
            EndMetric::ClMomentum => s.loads_momentum_balance.map(|c| c.cl).ok_or_else(no_balance),
            EndMetric::CdMomentum => s.loads_momentum_balance.map(|c| c.cd).ok_or_else(no_balance),
            EndMetric::CdBalance => s.loads_momentum_balance.map(|c| (c.cd - s.loads.cd).abs()).ok_or_else(no_balance),
            EndMetric::ResidualDrop => s.residual_drop.ok_or_else(|| "a march has a residual in each step".into()),
            EndMetric::Converged => Ok(f64::from(u8::from(s.succeeded))),
            EndMetric::Particles => Ok(s.particles as f64),
            EndMetric::MassDrift => s.drift.map(|[mass, _]| mass.abs()).ok_or_else(no_ledger),
            EndMetric::EnergyDrift => s.drift.map(|[_, energy]| energy.abs()).ok_or_else(no_ledger),
            EndMetric::ErrorL2Density => {
                s.error_l2_density.ok_or_else(|| "the case starts from no exact solution".into())
            }
        }
    }

    /// Metrics of loads that repeat: harmonics of a motion, cycles of the flow itself.
    fn of_periods(&self, metric: PeriodicMetric) -> Value {
        match metric {
            PeriodicMetric::LiftAmplitude => self.lift().map(|c| c.norm()),
            PeriodicMetric::LiftPhase => self.lift().map(|c| c.arg().to_degrees()),
            PeriodicMetric::DragAmplitude => self.drag().map(|c| c.norm()),
            PeriodicMetric::DragPhase => self.drag().map(|c| c.arg().to_degrees()),
            PeriodicMetric::DragSecondHarmonic => Ok(harmonic(&self.loops.cd, 2).norm()),
            PeriodicMetric::Strouhal => {
                self.cycles().map(|c| c.frequency * self.chord() / self.case.flow.reference().speed)
            }
            PeriodicMetric::CycleSpread => self.cycles().map(|c| c.spread),
            PeriodicMetric::MeanCd => self.cycles().map(|c| c.mean_cd),
            PeriodicMetric::SwingCd => self.cycles().map(|c| c.amplitude_cd),
            PeriodicMetric::SwingCl => self.cycles().map(|c| c.amplitude_cl),
            PeriodicMetric::MeanCl => self.last_period().map(|p| p.mean_cl),
            PeriodicMetric::PeakCl => self.last_period().map(|p| p.peak_cl),
        }
    }

    /// Metrics extrapolated to a section of no thickness.
    fn of_thin_sections(&self, metric: ThinMetric, others: &[&Self]) -> Value {
        match metric {
            ThinMetric::ThinLiftAmplitude => self.thin(others, Self::lift).map(|c| c.norm()),
            ThinMetric::ThinLiftPhase => self.thin(others, Self::lift).map(|c| c.arg().to_degrees()),
            ThinMetric::ThinMomentAmplitude => self.thin(others, Self::moment).map(|c| c.norm()),
            ThinMetric::ThinMomentPhase => self.thin(others, Self::moment).map(|c| c.arg().to_degrees()),
            ThinMetric::ThinForceAmplitude => self.thin(others, Self::force).map(|c| c.norm()),
            ThinMetric::ThinForcePhase => self.thin(others, Self::force).map(|c| c.arg().to_degrees()),
        }
    }

    /// Metrics that compare with a file, an exact solution or the case `other`.
    fn beside_others(&self, metric: ComparisonMetric, (claim, folder): (&Claim, &Path), other: Option<&Self>) -> Value {
        match metric {
            ComparisonMetric::LiftLoopDifference => self.loop_difference(claim, folder, other, ("CL", |l| &l.cl)),
            ComparisonMetric::DragLoopDifference => self.loop_difference(claim, folder, other, ("CD", |l| &l.cd)),
            ComparisonMetric::LiftHarmonicError => other.ok_or_else(no_other).and_then(|other| self.lift_error(other)),
            ComparisonMetric::LiftMeanError => {
                other.ok_or_else(no_other).and_then(|other| mean_error(&self.loops.cl, &other.loops.cl))
            }
            ComparisonMetric::CpRms => self.cp_differences(claim, folder, other).and_then(|d| mean_of(&d)),
            ComparisonMetric::CpMaxDifference => self.cp_differences(claim, folder, other).and_then(|d| largest_of(&d)),
        }
    }

    /// Metrics of the gas and of the walls of this run alone, and of tables of its sections.
    fn of_fields(&self, metric: FieldMetric, claim: &Claim, folder: &Path) -> Value {
        match metric {
            FieldMetric::CfBlasiusRms => self.blasius_differences(claim).and_then(|d| mean_of(&d)),
            FieldMetric::CfBlasiusMax => self.blasius_differences(claim).and_then(|d| largest_of(&d)),
            FieldMetric::ProfileBlasiusRms => self.blasius_profile(claim),
            FieldMetric::SectionCpRms => self.section_differences(claim, folder).and_then(|d| mean_of(&d)),
            FieldMetric::WakeLength => self.wake_length(),
            FieldMetric::PitotPressure => self.pitot_pressure(),
            FieldMetric::StandOff => self.stand_off(),
            FieldMetric::ShockUpper => self.shock(claim, true),
            FieldMetric::ShockLower => self.shock(claim, false),
            FieldMetric::PanelPressure => self.panel_pressure(claim),
            FieldMetric::FreeStreamDeviation => self.free_stream_deviation(),
            FieldMetric::ShockPositionError => self.shock_position_error(),
            FieldMetric::WaveAngle => self.wave_angle(claim),
        }
    }

    /// |Â₁ − B̂₁|/|B̂₁| of the first harmonics of this lift and of that of the run `other`.
    fn lift_error(&self, other: &Self) -> Value {
        let other = other.lift()?;
        Ok((self.lift()? - other).norm() / other.norm())
    }

    /// First harmonic of the lift over that of the motion.
    fn lift(&self) -> Result<Complex64, String> {
        self.first_harmonic(0)
    }

    /// First harmonic of the drag over that of the motion.
    fn drag(&self) -> Result<Complex64, String> {
        self.first_harmonic(1)
    }

    /// First harmonic of the moment over that of the motion.
    fn moment(&self) -> Result<Complex64, String> {
        self.first_harmonic(2)
    }

    /// That of load number `k` of lift, drag and moment.
    fn first_harmonic(&self, k: usize) -> Result<Complex64, String> {
        let [re, im] = self.numbers.first_harmonics.ok_or("no motion repeats in this case")?[k];
        Ok(Complex64::new(re, im))
    }

    /// Difference of one load over the last period to a file or another case.
    fn loop_difference(
        &self,
        claim: &Claim,
        folder: &Path,
        other: Option<&Self>,
        (name, load): (&str, fn(&Loops) -> &Vec<f64>),
    ) -> Value {
        let own = load(&self.loops);
        let found = match (&claim.file, other) {
            (Some(file), _) => {
                let (path, problem) = (folder.join(file), |e: &dyn std::fmt::Display| format!("`{file}`: {e}"));
                let text = plain(&path).map_err(|e| problem(&e))?;
                let table = Table::parse(&text).map_err(|e| problem(&e))?;
                let column = |name: &str| table.column(name).map_err(|e| problem(&e));
                loops::greatest_difference(own, &column("phase")?, &column(name)?)
            }
            (None, Some(other)) => loops::loop_difference(own, load(&other.loops)),
            (None, None) => return Err("the claim names no `file` or `other`".into()),
        };
        found.ok_or_else(|| "the run has no whole period of a motion that repeats".into())
    }

    /// Last whole cycles of the lift.
    fn cycles(&self) -> Result<Cycles, String> {
        self.numbers.lift_cycles.ok_or_else(|| "the lift does not swing through two whole cycles".into())
    }

    /// Loads over the last period of the motion.
    fn last_period(&self) -> Result<LastPeriod, String> {
        self.numbers.last_period.ok_or_else(|| "the march holds no whole period of a motion".into())
    }

    /// Length of the Reynolds number, and of frequencies.
    fn chord(&self) -> f64 {
        self.numbers.chord
    }

    /// A load on a section of no thickness, by the polynomial through this one and the others.
    fn thin(&self, others: &[&Self], load: impl Fn(&Self) -> Result<Complex64, String>) -> Result<Complex64, String> {
        if others.is_empty() {
            return Err("the claim names no `other` section".into());
        }
        let sections: Vec<&Self> = std::iter::once(self).chain(others.iter().copied()).collect();
        let thickness = sections.iter().map(|s| s.thickness()).collect::<Result<Vec<_>, _>>()?;
        let weights = at_no_thickness(&thickness)?;
        sections.iter().zip(weights).try_fold(Complex64::ZERO, |sum, (section, w)| Ok(sum + load(section)? * w))
    }

    /// First harmonic of the force on the first flexible mode of `[gaf]` over that of the mode that moves.
    fn force(&self) -> Result<Complex64, String> {
        let name = self.case.gaf.as_ref().and_then(|g| g.flexible.first()).map(|m| m.name.clone());
        let force = self.numbers.generalised_forces.iter().find(|f| Some(&f.mode) == name.as_ref());
        let force =
            force.ok_or("the run has no force on a flexible mode: add `[[gaf.mode]]` and `[time] harmonics`")?;
        let moving = self.case.motion_of(0).and_then(|law| law.modes.first());
        let mode = moving.ok_or("no mode of `[motion]` moves the body")?;
        Ok(force.per(mode.amplitude) * Complex64::cis(-mode.phase.0))
    }

    /// Thickness of the section in parts of the chord: of a NACA one by its designation, of others by the extent of their walls.
    fn thickness(&self) -> Result<f64, String> {
        if let Some(thickness) = designed_thickness(&self.case) {
            return Ok(thickness);
        }
        let extent = Bounds::around(&self.wall.x).extent();
        if self.wall.is_empty() { Err(no_wall()) } else { Ok(extent[1] / extent[0]) }
    }

    /// Cp of the wall particles in the region less the reference there.
    fn cp_differences(&self, claim: &Claim, folder: &Path, other: Option<&Self>) -> Result<Vec<f64>, String> {
        let wall = &self.wall;
        let chosen = wall.within(claim.region.as_ref());
        if let Some(file) = &claim.file {
            return self.differences_to_file(&chosen, &folder.join(file));
        }
        if let Some(exact) = claim.exact {
            let flow = &self.case.flow;
            let truth = WallTruth::new(exact, flow.reference().mach, flow.gamma).map_err(|e| e.to_string())?;
            let centre = self.body_centre();
            let stream = self.stream().velocity;
            let at = |i: usize| truth.pressure_coefficient(&(wall.x[i] - centre), &stream);
            return Ok(chosen.iter().map(|&i| wall.cp[i] - at(i)).collect());
        }
        let Some(other) = other else { return Err("the claim names no `file`, `exact` or `other`".into()) };
        let at = |i: usize| other.wall.pressure_coefficient(&wall.x[i], &wall.normal[i]);
        chosen.iter().map(|&i| Ok(wall.cp[i] - at(i).ok_or_else(no_wall)?)).collect()
    }

    /// Centre of the first body. Planes of symmetry may cut it, so that its wall particles do not tell.
    fn body_centre(&self) -> Vector<3> {
        let place = self.case.bodies.first().map(|b| b.placement.translate.as_slice()).unwrap_or_default();
        match self.case.bodies.first().map(|b| &b.shape) {
            Some(Shape::Circle { .. } | Shape::Sphere { .. }) => Vector::from_fn(|d| place.get(d).map_or(0.0, |l| l.0)),
            _ => Bounds::around(&self.wall.x).centre(),
        }
    }

    fn differences_to_file(&self, chosen: &[usize], path: &Path) -> Result<Vec<f64>, String> {
        let problem = |e: &dyn std::fmt::Display| format!("`{}`: {e}", path.display());
        let text = plain(path).map_err(|e| problem(&e))?;
        let table = Table::parse(&text).map_err(|e| problem(&e))?;
        let curve = |side: &str| -> Result<Curve, String> {
            table.only("surface", side).curve("x_c", "Cp").map_err(|e| problem(&e))
        };
        let mut differences = Vec::with_capacity(chosen.len());
        for (upper, name) in [(true, "upper"), (false, "lower")] {
            let reference = curve(name)?;
            let side = self.wall.side(chosen, upper);
            differences.extend(side.iter().map(|&i| self.wall.cp[i] - reference.at(self.wall.x_c[i])));
        }
        Ok(differences)
    }

    /// Reynolds number of a unit of length.
    fn unit_reynolds(&self) -> Value {
        let flow = &self.case.flow;
        let chord = self.case.reference.chord.map_or(1.0, |c| c.0);
        let viscosity = flow.viscous(chord).ok_or_else(no_viscosity)?.viscosity;
        let stream = flow.reference();
        Ok(stream.density * stream.speed / viscosity)
    }

    /// cf/cf_Blasius − 1 on the wall particles in the region.
    fn blasius_differences(&self, claim: &Claim) -> Result<Vec<f64>, String> {
        let reynolds = self.unit_reynolds()?;
        let chosen = self.wall.within(claim.region.as_ref());
        let ratio = |i: &usize| Some(self.wall.cf.get(*i)? / skin_friction(reynolds * self.wall.x[*i][0]) - 1.0);
        Ok(chosen.iter().filter_map(ratio).collect())
    }

    /// Root mean square of u/U − f′(η) over the fluid particles in the region that lie in the boundary layer, heights from the wall.
    fn blasius_profile(&self, claim: &Claim) -> Value {
        let (reynolds, stream, velocity) = (self.unit_reynolds()?, self.stream().velocity, self.column("velocity")?);
        let mut differences = Vec::new();
        for i in self.fluid()? {
            let x = &self.field.points[i];
            let away = |w: &&Vector<3>| (w[0] - x[0]).abs();
            let wall = self.wall.x.iter().min_by(|a, b| away(a).total_cmp(&away(b))).ok_or_else(no_wall)?;
            let eta = (x[1] - wall[1]) * (reynolds / x[0]).sqrt();
            if eta < 0.0 {
                continue;
            }
            if claim.region.as_ref().is_some_and(|[low, high]| !contains(low, high, x)) || eta > LAYER {
                continue;
            }
            let exact = layer(eta).map_err(|e| e.to_string())?.velocity;
            differences.push(velocity[3 * i] / stream[0] - exact);
        }
        metrics::root_mean_square(&differences, None).ok_or_else(|| "no particle lies in the layer".into())
    }

    fn shock(&self, claim: &Claim, upper: bool) -> Value {
        let side = self.wall.side(&self.wall.within(claim.region.as_ref()), upper);
        let take = |column: &[f64]| side.iter().map(|&i| column[i]).collect::<Vec<f64>>();
        metrics::shock_position(&take(&self.wall.x_c), &take(&self.wall.cp), SHOCK_WINDOW)
            .ok_or_else(|| "the wall pressure rises nowhere".into())
    }

    fn panel_pressure(&self, claim: &Claim) -> Value {
        let chosen = self.wall.within(claim.region.as_ref());
        let pressure: Vec<f64> = chosen.iter().map(|&i| self.over_free_pressure(self.wall.cp[i])).collect();
        let areas: Vec<f64> = chosen.iter().map(|&i| self.wall.area[i]).collect();
        metrics::weighted_mean(&pressure, Some(&areas)).ok_or_else(no_wall)
    }

    /// p/p∞ = 1 + γ M² Cp/2.
    fn over_free_pressure(&self, cp: f64) -> f64 {
        let flow = &self.case.flow;
        1.0 + 0.5 * flow.gamma * flow.reference().mach.powi(2) * cp
    }

    /// Free stream in units of the solver.
    fn stream(&self) -> Primitive<3> {
        if self.case.dimension == Some(3) {
            return free_stream::<3>(&self.case);
        }
        let q = free_stream::<2>(&self.case);
        Primitive { density: q.density, velocity: Vector(q.velocity.to_3d()), pressure: q.pressure }
    }

    /// Greatest change of ρ, ρv, E over ρ∞, ρ∞c∞, E∞, in the fluid.
    fn free_stream_deviation(&self) -> Value {
        let free = self.stream();
        let gas = Gas { gamma: self.case.flow.gamma };
        let units = self.case.flow.units();
        let (density, velocity) = (self.column("density")?, self.column("velocity")?);
        let pressure = self.column("pressure")?;
        let expected = gas.conserved(&free);
        let mut greatest: f64 = 0.0;
        for i in self.fluid()? {
            let found = gas.conserved(&Primitive {
                density: density[i] / units.density,
                velocity: Vector::<3>::from_fn(|d| velocity[3 * i + d] / units.speed),
                pressure: pressure[i] / units.pressure(),
            });
            let deviation = [
                (found.density - expected.density) / expected.density,
                (found.momentum - expected.momentum).max_abs() / (expected.density * gas.sound_speed(&free)),
                (found.energy - expected.energy) / expected.energy,
            ];
            if deviation.iter().any(|d| !d.is_finite()) {
                return Err("the solution is not finite".into());
            }
            greatest = deviation.iter().fold(greatest, |g, d| g.max(d.abs()));
        }
        Ok(greatest)
    }

    /// |place of the shock − exact| in spacings of the case.
    fn shock_position_error(&self) -> Value {
        let units = self.case.flow.units();
        let initial = self.case.initial.in_solver_units(&units);
        let truth = FieldTruth::new(&initial, self.case.flow.gamma, None).map_err(|e| e.to_string())?;
        let Some(FieldTruth::Riemann { axis, .. }) = truth else {
            return Err("the case starts from no Riemann problem".into());
        };
        let exact = truth.and_then(|t| t.shock(units.solver_time(self.numbers.time)));
        let (place, levels) = exact.ok_or("the exact solution has no shock")?;
        let pressure = self.column("pressure")?;
        let fluid = self.fluid()?;
        let x: Vec<f64> = fluid.iter().map(|&i| self.field.points[i][axis.min(2)]).collect();
        let p: Vec<f64> = fluid.iter().map(|&i| pressure[i]).collect();
        let everywhere = (f64::NEG_INFINITY, f64::INFINITY);
        let found = metrics::front_position(&x, &p, levels, everywhere).ok_or("the solution has no shock")?;
        Ok((found - place).abs() / self.case.cloud.spacing.map_or(1.0, |l| l.0))
    }

    fn wave_angle(&self, claim: &Claim) -> Value {
        let (Some([low, high]), Some(levels)) = (&claim.region, claim.levels) else {
            return Err("the claim names no `region` and `levels`".into());
        };
        let cp = self.column("cp")?;
        let inside = self.fluid()?.into_iter().filter(|&i| contains(low, high, &self.field.points[i]));
        let space = self.case.dimension == Some(3);
        // in space the wave is one of revolution about the x axis
        let across = |x: &[f64; 3]| if space { x[1].hypot(x[2]) } else { x[1] };
        let point = |i: usize| &self.field.points[i];
        let samples: Vec<[f64; 3]> =
            inside.map(|i| [point(i)[0], across(point(i)), self.over_free_pressure(cp[i])]).collect();
        let angle = metrics::wave_angle(&samples, levels).ok_or("the samples hold no wave")?;
        Ok(angle.to_degrees())
    }

    /// Fluid particles of the field.
    fn fluid(&self) -> Result<Vec<usize>, String> {
        let kind = self.column("kind")?;
        Ok((0..kind.len()).filter(|&i| kind[i] == 0.0).collect())
    }

    fn column(&self, name: &str) -> Result<&[f64], String> {
        let found = self.field.columns.iter().find(|(n, ..)| *n == name);
        found.map(|(_, _, values)| values.as_slice()).ok_or_else(|| format!("the solution has no `{name}`"))
    }
}

/// Harmonic `n` of samples spread evenly over a period.
fn harmonic(samples: &[f64], n: u32) -> Complex64 {
    let count = samples.len().max(1) as f64;
    let turn = |k: usize| Complex64::cis(-std::f64::consts::TAU * f64::from(n) * k as f64 / count);
    samples.iter().enumerate().map(|(k, v)| turn(k) * *v).sum::<Complex64>() * (2.0 / count)
}

fn no_other() -> String {
    "the claim names no `other` case".into()
}

fn no_viscosity() -> String {
    "the case has no viscosity".into()
}

fn no_ledger() -> String {
    "a harmonic balance goes from no time to another".into()
}

fn no_balance() -> String {
    "without bodies there is no momentum balance".into()
}

fn no_wall() -> String {
    "there are no wall particles to compare".into()
}

/// Root mean square of differences on the wall.
fn mean_of(differences: &[f64]) -> Value {
    metrics::root_mean_square(differences, None).ok_or_else(no_wall)
}

/// Greatest of them.
fn largest_of(differences: &[f64]) -> Value {
    metrics::max_difference(differences, &vec![0.0; differences.len()]).ok_or_else(no_wall)
}

/// Difference of the means of two loops of a load, over the first harmonic of the second.
fn mean_error(own: &[f64], far: &[f64]) -> Value {
    let mean = |v: &[f64]| v.iter().sum::<f64>() / v.len().max(1) as f64;
    let first = harmonic(far, 1).norm();
    if own.is_empty() || first == 0.0 {
        return Err("a run has no whole period of a motion that repeats".into());
    }
    Ok((mean(own) - mean(far)).abs() / first)
}
