//! Error bars of the loads of marches and harmonic balances.
//!
//! A number f of a run with spacing h, step Δt or N harmonics is held against the same number of a run that has one of these coarser. Of a
//! harmonic of a load, a complex number f_n, what counts is |δf_n|: half width of its amplitude, and asin(|δf_n|/|f_n|) that of its phase,
//! so that no error hides in the other one of both. Two runs show no order of convergence: the half width is the change times a factor that
//! whoever made the other run knows (Roache 1994, doi:10.1115/1.2910291). What a number changed by since the period before is a part
//! of its own. Parts that know nothing of one another add as squares.
use num_complex::Complex64;
use serde::{Deserialize, Serialize};

/// Names of the loads.
pub const LOADS: [&str; 3] = ["CL", "CD", "CM"];
/// Change of all loads from period to period, over their harmonics, above which a flow is not periodic.
pub const NOT_PERIODIC: f64 = 0.05;

/// What a number says of a history.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Quantity {
    /// Mean over time.
    Mean,
    /// A harmonic of the motion, by its number: a complex number, when time starts at the greatest value of the motion.
    Harmonic(usize),
    /// Half of greatest less smallest value.
    Amplitude,
    /// Cycles in a unit of time; of coordinates of structures the angular frequency.
    Frequency,
    /// Damping ratio.
    Damping,
    /// Root mean square of what differs from the mean.
    Rms,
    /// Value of the greatest size.
    Peak,
    /// Value at the end.
    Final,
}

/// Which part of a history numbers are of.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Window {
    /// The last period of a motion, or the last of them that loops are the mean of.
    LastPeriod,
    /// The last whole cycles of the lift.
    Cycles,
    /// All of a march.
    March,
}

/// A number that a run tells of a history.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Measure {
    /// `CL`, `CD`, `CM`, or the name of a coordinate of a structure.
    pub of: String,
    /// What of it.
    pub quantity: Quantity,
    /// Real and imaginary part; the latter of harmonics alone.
    pub value: [f64; 2],
    /// The same a period before, where the flow repeats.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub before: Option<[f64; 2]>,
}

/// All such numbers of a run.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Measured {
    /// The part of the history that they are of.
    pub window: Window,
    /// Its beginning, in the time of the case.
    pub from: f64,
    /// Its end.
    pub until: f64,
    /// The numbers.
    pub values: Vec<Measure>,
}

/// What another run differs in.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Part {
    /// Spacing of the cloud.
    Cloud,
    /// Step in time.
    Step,
    /// Number of harmonics.
    Harmonics,
}

/// A run that tells a part of the error bars.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct OtherRun {
    /// What it differs in.
    pub part: Part,
    /// That of it over that of the run: spacings, steps or numbers of harmonics.
    pub ratio: f64,
    /// Half width over the change.
    pub factor: f64,
    /// Particles.
    pub particles: usize,
    /// Processor time, in seconds.
    pub cpu_seconds: f64,
    /// Its numbers.
    pub values: Vec<Measure>,
}

/// A number with its error bar.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Bar {
    /// `CL`, `CD`, `CM`, or the name of a coordinate of a structure.
    pub of: String,
    /// What of it: `mean`, `amplitude_1`, `phase_1_deg`, `rms`, …
    pub quantity: String,
    /// The number.
    pub value: f64,
    /// Half width of its error bar: root of the sum of the squares of its parts.
    pub half_width: f64,
    /// Part of the cloud; null where it was not asked for.
    pub cloud: Option<f64>,
    /// Part of the step in time.
    pub step: Option<f64>,
    /// Part of the number of harmonics.
    pub harmonics: Option<f64>,
    /// Part of what still changes from period to period; null of a balance, and where nothing repeats.
    pub transient: Option<f64>,
}

/// The numbers of a run with their error bars.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ErrorBars {
    /// The numbers.
    pub measured: Measured,
    /// The runs that they are held against.
    pub runs: Vec<OtherRun>,
    /// The same numbers with error bars: those that all runs tell.
    pub bars: Vec<Bar>,
    /// Why there are none.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub untold: Option<String>,
}

impl Measured {
    /// What all loads changed by from the period before to the last one, over their harmonics or amplitudes; `None` where that is not known.
    pub fn change(&self) -> Option<f64> {
        let (mut moved, mut size) = (0.0, 0.0);
        for m in self.values.iter().filter(|m| LOADS.contains(&m.of.as_str())) {
            let Some(before) = &m.before else { continue };
            let change = m.distance(before);
            match m.quantity {
                Quantity::Harmonic(_) | Quantity::Amplitude => {
                    size += m.size();
                    moved += change;
                }
                Quantity::Mean => moved += change,
                _ => {}
            }
        }
        (size > 0.0).then(|| moved / size)
    }
}

impl Measure {
    fn size(&self) -> f64 {
        self.value[0].hypot(self.value[1])
    }

    fn distance(&self, other: &[f64; 2]) -> f64 {
        (self.value[0] - other[0]).hypot(self.value[1] - other[1])
    }

    /// Its bar, of a harmonic those of amplitude and phase; `None` where a run does not tell it.
    fn bars(&self, runs: &[OtherRun]) -> Option<Vec<Bar>> {
        let mut bar = Bar {
            of: self.of.clone(),
            quantity: self.quantity.name().to_owned(),
            value: self.value[0],
            half_width: 0.0,
            cloud: None,
            step: None,
            harmonics: None,
            transient: self.before.map(|before| self.distance(&before)),
        };
        for run in runs {
            let other = run.values.iter().find(|m| m.of == self.of && m.quantity == self.quantity)?;
            let part = Some(run.factor * self.distance(&other.value));
            match run.part {
                Part::Cloud => bar.cloud = part,
                Part::Step => bar.step = part,
                Part::Harmonics => bar.harmonics = part,
            }
        }
        bar.half_width = bar.parts().map(|p| p * p).sum::<f64>().sqrt();
        let Quantity::Harmonic(n) = self.quantity else { return Some(vec![bar]) };
        let size = self.size();
        let amplitude = Bar { quantity: format!("amplitude_{n}"), value: size, ..bar };
        Some(
            std::iter::once(amplitude.clone())
                .chain(amplitude.phase(n, Complex64::new(self.value[0], self.value[1])))
                .collect(),
        )
    }
}

impl Bar {
    fn parts(&self) -> impl Iterator<Item = f64> {
        [self.cloud, self.step, self.harmonics, self.transient].into_iter().flatten()
    }

    /// The bar of the phase of harmonic `n` whose amplitude this is of; `None` where that may be zero, so that any phase may be.
    fn phase(&self, n: usize, value: Complex64) -> Option<Self> {
        let turned = |part: f64| (part / self.value).min(1.0).asin().to_degrees();
        let of = |part: Option<f64>| part.map(turned);
        (self.half_width < self.value).then(|| Self {
            of: self.of.clone(),
            quantity: format!("phase_{n}_deg"),
            value: value.arg().to_degrees(),
            half_width: turned(self.half_width),
            cloud: of(self.cloud),
            step: of(self.step),
            harmonics: of(self.harmonics),
            transient: of(self.transient),
        })
    }

    /// What it is the bar of, in words.
    pub fn name(&self) -> String {
        let words: Vec<&str> = self.quantity.split('_').collect();
        match words[..] {
            ["amplitude", n] => format!("harmonic {n}, amplitude"),
            ["phase", n, _] => format!("harmonic {n}, phase [deg]"),
            _ => words.join(" "),
        }
    }
}

impl Quantity {
    /// Its name in files.
    fn name(self) -> &'static str {
        match self {
            Self::Mean => "mean",
            Self::Harmonic(_) => "harmonic",
            Self::Amplitude => "amplitude",
            Self::Frequency => "frequency",
            Self::Damping => "damping_ratio",
            Self::Rms => "rms",
            Self::Peak => "peak",
            Self::Final => "final",
        }
    }
}

impl ErrorBars {
    /// The numbers of a run whose error is not known, and perhaps why.
    pub fn untold(measured: Measured, why: Option<String>) -> Self {
        Self { measured, runs: Vec::new(), bars: Vec::new(), untold: why }
    }

    /// The numbers of a run against those of others.
    pub fn of(measured: Measured, runs: Vec<OtherRun>) -> Self {
        let bars: Vec<Bar> = measured.values.iter().filter_map(|m| m.bars(&runs)).flatten().collect();
        let why = bars
            .is_empty()
            .then(|| "the other runs tell other numbers: one of them repeats, and another one does not".to_owned());
        Self { measured, runs, bars, untold: why }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn measure(quantity: Quantity, value: [f64; 2], before: Option<[f64; 2]>) -> Measure {
        Measure { of: "CL".into(), quantity, value, before }
    }

    fn run(part: Part, factor: f64, values: Vec<Measure>) -> OtherRun {
        OtherRun { part, ratio: 2.0, factor, particles: 7, cpu_seconds: 0.0, values }
    }

    fn measured(values: Vec<Measure>) -> Measured {
        Measured { window: Window::LastPeriod, from: 1.0, until: 2.0, values }
    }

    #[test]
    fn parts_add_as_squares_and_are_no_shorter_than_the_change_of_a_harmonic() {
        let own = vec![
            measure(Quantity::Mean, [1.0, 0.0], Some([1.0, 0.0])),
            measure(Quantity::Harmonic(1), [0.0, 2.0], Some([0.0, 2.0])),
        ];
        let other = |mean: f64, harmonic: [f64; 2]| {
            vec![measure(Quantity::Mean, [mean, 0.0], None), measure(Quantity::Harmonic(1), harmonic, None)]
        };
        // the amplitude of the harmonic is the same on the other cloud, its phase is not
        let (s, c) = 0.1f64.sin_cos();
        let runs =
            vec![run(Part::Cloud, 2.0, other(1.03, [2.0 * s, 2.0 * c])), run(Part::Step, 1.0, other(0.92, [0.0, 2.0]))];
        let found = ErrorBars::of(measured(own), runs);
        let [mean, amplitude, phase] = &found.bars[..] else { panic!("{found:?}") };
        assert!((mean.half_width - 0.1).abs() < 1e-12 && (mean.step.unwrap() - 0.08).abs() < 1e-12, "{mean:?}");
        let chord = 4.0 * 2.0 * 0.05f64.sin();
        assert!((amplitude.half_width - chord).abs() < 1e-12 && amplitude.value == 2.0, "{amplitude:?}");
        assert_eq!((amplitude.quantity.as_str(), phase.name().as_str()), ("amplitude_1", "harmonic 1, phase [deg]"));
        let turned = (chord / 2.0).asin().to_degrees();
        assert!(
            (phase.half_width - turned).abs() < 1e-9 && phase.value == 90.0 && phase.harmonics.is_none(),
            "{phase:?}"
        );
    }

    #[test]
    fn a_harmonic_that_may_be_zero_has_no_phase() {
        let own = vec![measure(Quantity::Harmonic(2), [1e-9, 0.0], None)];
        let found = ErrorBars::of(
            measured(own.clone()),
            vec![run(Part::Cloud, 1.0, vec![measure(Quantity::Harmonic(2), [3e-9, 0.0], None)])],
        );
        assert_eq!(found.bars.len(), 1);
        // numbers that another run lacks have no bar
        let found = ErrorBars::of(measured(own), vec![run(Part::Cloud, 1.0, Vec::new())]);
        assert!(found.bars.is_empty() && found.untold.is_some());
    }

    #[test]
    fn what_changes_from_period_to_period_is_over_the_harmonics() {
        let values = |before: f64| {
            vec![
                measure(Quantity::Mean, [5.0, 0.0], Some([5.0, 0.0])),
                measure(Quantity::Harmonic(1), [0.0, 2.0], Some([0.0, before])),
            ]
        };
        assert!((measured(values(1.8)).change().unwrap() - 0.1).abs() < 1e-12);
        assert_eq!(measured(vec![measure(Quantity::Mean, [5.0, 0.0], None)]).change(), None);
    }
}
