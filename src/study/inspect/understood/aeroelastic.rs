//! What the program understood of `[structure]`, `[flutter]`, `[lco]` and `[gaf]`.

use serde::Serialize;

use super::{list, short};
use crate::case::{AnyMode, Case, Gaf, GafMethod, Matching};
use crate::problem::ProblemIn;
use crate::problem::reference::chord;

/// A body on springs, or one that moves in modes.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct UnderstoodStructure {
    /// Its body.
    pub body: String,
    /// Names of its coordinates.
    pub coordinates: Vec<String>,
    /// Units, masses, springs and frequencies in words.
    pub description: Vec<String>,
}

/// What `alula flutter` seeks.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct UnderstoodFlutter {
    /// Mach numbers.
    pub mach: Vec<f64>,
    /// Reduced frequencies at which forces are computed first.
    pub reduced_frequencies: Vec<f64>,
    /// Greatest number of frequencies.
    pub frequencies: u32,
    /// What is varied.
    #[serde(rename = "match")]
    pub matching: Matching,
    /// Greatest speed or density that is looked at, over that of the structure or the case.
    pub most: f64,
    /// Forces are those about the static equilibrium.
    pub trim: bool,
    /// Crossings are held against those on a coarser cloud.
    pub cloud_error: bool,
    /// Coordinates whose motions are looked at.
    pub coordinates: Vec<String>,
    /// Amplitudes of the limit cycles that are sought, in radians or in the unit of the coordinate; empty without `[lco]`.
    pub amplitudes: Vec<f64>,
}

/// What `alula gaf` computes.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct UnderstoodGaf {
    /// Reduced frequencies.
    pub reduced_frequencies: Vec<f64>,
    /// Their length L.
    pub reduced_length: f64,
    /// Modes, in the order of rows and columns.
    pub modes: Vec<String>,
    /// Point about which the body pitches.
    pub pivot: Option<Vec<f64>>,
    /// How forces are found.
    pub method: GafMethod,
    /// Entries have error bars from a coarser cloud.
    pub cloud_error: bool,
}

/// All of that.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Aeroelastic {
    /// Structures, each once.
    pub structures: Vec<UnderstoodStructure>,
    /// `[flutter]`; absent without it.
    pub flutter: Option<UnderstoodFlutter>,
    /// `[gaf]`; absent without it.
    pub gaf: Option<UnderstoodGaf>,
}

impl Aeroelastic {
    /// What a problem means.
    pub(crate) fn of<const D: usize>(problem: &ProblemIn<D>) -> Self {
        let (case, surface, bodies) = (problem.case(), problem.surface(), problem.structures());
        let described = problem.described().iter().cloned();
        let structures = described.map(|d| UnderstoodStructure {
            body: d.names.body,
            coordinates: d.names.coordinates.into_iter().map(|c| c.name).collect(),
            description: d.lines,
        });
        let names = bodies.iter().flat_map(|b| b.structure.coordinates()).map(|c| c.name.clone()).collect();
        Self {
            structures: structures.collect(),
            flutter: UnderstoodFlutter::of(case, names),
            gaf: case.gaf.as_ref().map(|gaf| UnderstoodGaf::of(gaf, chord(case, surface))),
        }
    }

    /// The same in lines for people: what, and in which words.
    pub(super) fn lines(&self) -> Vec<(&'static str, String)> {
        let of = |s: &UnderstoodStructure| {
            let named = ("structure", format!("`{}` with {}", s.body, s.coordinates.join(", ")));
            std::iter::once(named).chain(s.description.iter().map(|line| ("", line.clone()))).collect::<Vec<_>>()
        };
        let structures = self.structures.iter().flat_map(of);
        let flutter = self.flutter.iter().flat_map(UnderstoodFlutter::lines);
        structures.chain(flutter).chain(self.gaf.iter().flat_map(UnderstoodGaf::lines)).collect()
    }
}

impl UnderstoodFlutter {
    fn of(case: &Case, coordinates: Vec<String>) -> Option<Self> {
        let plan = case.flutter.as_ref()?;
        let own = || vec![case.flow.reference().mach];
        Some(Self {
            mach: if plan.mach.is_empty() { own() } else { plan.mach.clone() },
            reduced_frequencies: std::iter::once(0.0).chain(plan.first()).collect(),
            frequencies: plan.frequencies,
            matching: plan.matching,
            most: plan.most,
            trim: plan.trim,
            cloud_error: plan.cloud_error,
            coordinates,
            amplitudes: case.lco.as_ref().map(|lco| lco.amplitudes()).unwrap_or_default(),
        })
    }

    fn lines(&self) -> Vec<(&'static str, String)> {
        let varied = match self.matching {
            Matching::None => {
                format!("speeds up to {} times that of the structure, at the density of the case", short(self.most))
            }
            Matching::Density => {
                format!("densities up to {} times that of the case, at its sound speed", short(self.most))
            }
            Matching::Altitude => "altitudes of the standard atmosphere".to_owned(),
        };
        let about = if self.trim { "static equilibrium" } else { "bodies as drawn" };
        let mut lines = vec![
            ("flutter", format!("Mach {}: {varied}", numbers(&self.mach))),
            ("", format!("modes of {}, about the {about}", self.coordinates.join(", "))),
            (
                "",
                format!(
                    "forces at k = {} first, {} frequencies at most",
                    numbers(&self.reduced_frequencies),
                    self.frequencies
                ),
            ),
            ("", error(self.cloud_error)),
        ];
        if let ([first, .., last], n) = (&self.amplitudes[..], self.amplitudes.len()) {
            let told = format!("{n} amplitudes from {} to {} (angles in radians)", short(*first), short(*last));
            lines.push(("limit cycles", told));
        }
        lines
    }
}

impl UnderstoodGaf {
    fn of(gaf: &Gaf, chord: f64) -> Self {
        Self {
            reduced_frequencies: gaf.reduced_frequencies.clone(),
            reduced_length: gaf.reduced_length.map_or(0.5 * chord, |l| l.0),
            modes: gaf.all_modes().map(|mode: AnyMode<'_>| mode.name().to_owned()).collect(),
            pivot: gaf.pivot.as_ref().map(|p| p.iter().map(|x| x.0).collect()),
            method: gaf.method,
            cloud_error: gaf.cloud_error,
        }
    }

    fn lines(&self) -> Vec<(&'static str, String)> {
        let how = match self.method {
            GafMethod::Linear => "small motions about one steady flow",
            GafMethod::Balance => "two harmonic balances for each mode and frequency",
        };
        let about = self.pivot.as_ref().map_or_else(String::new, |p| format!(", pitch and moments about {}", list(p)));
        vec![
            ("gaf", format!("modes {}{about}", self.modes.join(", "))),
            (
                "",
                format!(
                    "k = ωL/U∞ = {}, L = {}; {how}",
                    numbers(&self.reduced_frequencies),
                    short(self.reduced_length)
                ),
            ),
            ("", error(self.cloud_error)),
        ]
    }
}

/// Where errors come from.
fn error(of_cloud: bool) -> String {
    let told = if of_cloud { "told from a cloud with twice the spacing" } else { "not told (`cloud_error = false`)" };
    format!("error of the cloud {told}")
}

fn numbers(all: &[f64]) -> String {
    all.iter().map(|x| short(*x)).collect::<Vec<_>>().join(", ")
}
