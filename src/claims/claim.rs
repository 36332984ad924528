//! Claims: metrics of a run with their reference, tolerance and source.
//!
//! ```toml
//! cpu_seconds = 12             # what the whole case takes, about; the quick subset is chosen by it
//!
//! [study]                      # rerun the case at these spacings, coarse to fine
//! spacings = [0.02, 0.01, 0.005]
//!
//! [[claim]]
//! metric = "cl"
//! reference = 0.28451
//! tolerance = 0.01
//! kind = "relative"
//! source = "CFL3D 6.7, Euler, 785 x 137"
//! ```
//!
//! Kinds: `relative` |v − r| ≤ t|r| · `absolute` |v − r| ≤ t · `range` r = [low, high], low ≤ v ≤ high · `at_most` v ≤ r ·
//! `at_least` v ≥ r. A value that is not a number fails every claim.
//!
//! Claims whose metric needs a study (`order`, `cp_rms_order`, `extrapolated_…`) use the reruns of `[study]`; all others use the case as it
//! stands.
use std::fmt;

use super::metric::Metric;
use crate::case::ClaimRow;

/// The contents of a `claim.toml`.
#[derive(Clone, Debug, PartialEq)]
pub struct ClaimFile {
    /// Processor seconds of the whole case, about; absent where it has not been measured. The quick subset is chosen by it.
    pub cpu_seconds: Option<f64>,
    /// Spacings at which the case is rerun.
    pub study: Option<Study>,
    /// The claims, in the order of the file.
    pub claims: Vec<Claim>,
}

/// A convergence study.
#[derive(Clone, Debug, PartialEq)]
pub struct Study {
    /// Values of `cloud.spacing`, coarse to fine; all else stays but for what the next keys name.
    pub spacings: Vec<f64>,
    /// Also scale the spacing of `[[cloud.box]]` tables by the same factor.
    pub scale_boxes: bool,
    /// Also divide `cloud.layers` by that factor, so that the background becomes finer everywhere and not at the bodies only.
    pub scale_layers: bool,
    /// Also scale `first` of the wall layers.
    pub scale_wall_layers: bool,
    /// Also scale the spacing of the wake.
    pub scale_wake: bool,
}

/// One claim.
#[derive(Clone, Debug, PartialEq)]
pub struct Claim {
    /// What is measured.
    pub metric: Metric,
    /// How value and reference are compared.
    pub kind: Kind,
    /// Where the reference comes from.
    pub source: String,
    /// Words that tell apart two claims of the same metric.
    pub label: Option<String>,
    /// Reference curve in the same folder, for metrics that compare curves.
    pub file: Option<String>,
    /// Named exact solution, for metrics that compare with one.
    pub exact: Option<Exact>,
    /// Another case file of the same folder that is measured instead of `case.toml`.
    pub case: Option<String>,
    /// Another case folder whose result is the reference, for metrics that compare two runs.
    pub other: Option<String>,
    /// A third one, for metrics that draw a parabola.
    pub third: Option<String>,
    /// Coordinate of the structure, where there is more than one.
    pub coordinate: Option<String>,
    /// Mach number of a flutter boundary, where that has more than one.
    pub mach: Option<f64>,
    /// Box of samples or wall particles the metric is restricted to: corners of smallest and largest coordinates.
    pub region: Option<[Vec<f64>; 2]>,
    /// Two pressures (over the free stream's) on either side of a wave or front.
    pub levels: Option<[f64; 2]>,
    /// Number of runs that differ by next to nothing, for flows that are chaotic: their mean is judged, with its scatter.
    pub ensemble: Option<usize>,
}

/// The same metric of several runs.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sample {
    /// Number of runs.
    pub count: usize,
    /// Their mean.
    pub mean: f64,
    /// Twice the standard error of the mean.
    pub scatter: f64,
}

impl Sample {
    /// Mean and scatter; of one value it is zero.
    pub fn of(values: &[f64]) -> Self {
        let count = values.len();
        let n = count as f64;
        let mean = values.iter().sum::<f64>() / n;
        let squares: f64 = values.iter().map(|v| (v - mean).powi(2)).sum();
        let scatter = if count > 1 { 2.0 * (squares / (n - 1.0) / n).sqrt() } else { 0.0 };
        Self { count, mean, scatter }
    }
}

/// A body whose wall pressure is known exactly.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Exact {
    /// Circle in subcritical flow.
    Circle,
    /// Sphere in subcritical flow.
    Sphere,
}

/// How a value is compared with its reference.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Kind {
    /// |v − r| ≤ t |r|.
    Relative {
        /// r.
        reference: f64,
        /// t.
        tolerance: f64,
    },
    /// |v − r| ≤ t.
    Absolute {
        /// r.
        reference: f64,
        /// t.
        tolerance: f64,
    },
    /// Between two bounds.
    Range {
        /// Lower bound.
        low: f64,
        /// Upper bound.
        high: f64,
    },
    /// v ≤ bound.
    AtMost(f64),
    /// v ≥ bound.
    AtLeast(f64),
}

impl Claim {
    /// Judges the measured `value` of the case folder `case`.
    pub fn judge(&self, case: &str, value: f64) -> ClaimRow {
        self.judge_sample(case, Sample { count: 1, mean: value, scatter: 0.0 })
    }

    /// The row of the mean of several runs; it passes where the mean does at both ends of its scatter.
    pub fn judge_sample(&self, case: &str, sample: Sample) -> ClaimRow {
        let value = sample.mean;
        let ends = [value - sample.scatter, value + sample.scatter];
        let (reference, error, tolerance, _) = self.kind.compare(value);
        let pass = ends.iter().all(|end| self.kind.compare(*end).3);
        let several = (sample.count > 1).then(|| format!("mean of {} runs, ± {:.1e}", sample.count, sample.scatter));
        ClaimRow {
            case: case.to_string(),
            metric: self.title(several.as_deref()),
            name: self.metric.name(),
            label: self.label.clone(),
            kind: self.kind.name(),
            runs: sample.count,
            scatter: sample.scatter,
            value,
            reference,
            error,
            tolerance,
            pass,
            source: self.source.clone(),
        }
    }

    /// The metric, with its label and `more` in brackets.
    pub fn title(&self, more: Option<&str>) -> String {
        let words: Vec<&str> = self.label.as_deref().into_iter().chain(more).collect();
        let words = if words.is_empty() { String::new() } else { format!(" ({})", words.join("; ")) };
        format!("{}{words}", self.metric.name())
    }
}

impl fmt::Display for Kind {
    /// What must hold: `0.5 ± 1 %`, `0 ± 0.001`, `0.3 to 0.4`, `≤ 1`, `≥ 6`.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            // ten digits, so that 0.07 is no 7.000000000000001 %
            Self::Relative { reference, tolerance } => {
                let percent: f64 = format!("{:.9e}", 100.0 * tolerance).parse().unwrap_or(100.0 * tolerance);
                write!(f, "{reference} ± {percent} %")
            }
            Self::Absolute { reference, tolerance } => write!(f, "{reference} ± {}", plain(*tolerance)),
            Self::Range { low, high } => write!(f, "{low} to {high}"),
            Self::AtMost(bound) => write!(f, "≤ {}", plain(*bound)),
            Self::AtLeast(bound) => write!(f, "≥ {}", plain(*bound)),
        }
    }
}

/// A number with as many digits as it has, and an exponent where it is very small or large.
fn plain(number: f64) -> String {
    if number == 0.0 || (1e-4..1e7).contains(&number.abs()) { number.to_string() } else { format!("{number:e}") }
}

impl Kind {
    /// Its name in a claim file.
    pub fn name(&self) -> &'static str {
        match self {
            Self::Relative { .. } => "relative",
            Self::Absolute { .. } => "absolute",
            Self::Range { .. } => "range",
            Self::AtMost(_) => "at_most",
            Self::AtLeast(_) => "at_least",
        }
    }

    /// Reference, error, tolerance and verdict for `value`.
    fn compare(&self, value: f64) -> (f64, f64, f64, bool) {
        match *self {
            Self::Relative { reference, tolerance } => {
                let error = (value - reference) / reference.abs();
                (reference, error, tolerance, error.abs() <= tolerance)
            }
            Self::Absolute { reference, tolerance } => {
                let error = value - reference;
                (reference, error, tolerance, error.abs() <= tolerance)
            }
            Self::Range { low, high } => {
                let middle = 0.5 * (low + high);
                (middle, value - middle, 0.5 * (high - low), low <= value && value <= high)
            }
            Self::AtMost(bound) => (bound, value - bound, 0.0, value <= bound),
            Self::AtLeast(bound) => (bound, value - bound, 0.0, value >= bound),
        }
    }
}

/// Everything that is wrong with a `claim.toml`.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub struct ClaimError {
    /// One message a problem, each with its remedy.
    pub problems: Vec<String>,
}

impl fmt::Display for ClaimError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.problems.join("\n"))
    }
}

#[cfg(test)]
mod tests {
    use super::super::metric::{ComparisonMetric, FieldMetric};
    use super::*;
    use proptest::prelude::*;
    use toml::Table;

    const GOOD: &str = r#"
        cpu_seconds = 12
        [study]
        spacings = [0.02, 0.01, 0.005]
        [[claim]]
        metric = "cl"
        reference = 0.28451
        tolerance = 0.01
        kind = "relative"
        source = "CFL3D"
        [[claim]]
        metric = "cd"
        label = "wave drag"
        reference = [0.02, 0.03]
        kind = "range"
        source = "CFL3D"
        region = { min = [0, 0], max = [1, 1] }
    "#;

    fn claim(kind: Kind) -> Claim {
        let file = ClaimFile::parse(GOOD).unwrap();
        Claim { kind, ..file.claims[0].clone() }
    }

    #[test]
    fn reads_a_file() {
        let file = ClaimFile::parse(GOOD).unwrap();
        assert_eq!(file.cpu_seconds, Some(12.0));
        assert_eq!(file.study.unwrap().spacings.len(), 3);
        assert_eq!(file.claims[0].kind, Kind::Relative { reference: 0.28451, tolerance: 0.01 });
        assert_eq!(file.claims[1].judge("a", 0.021).metric, "cd (wave drag)");
        assert_eq!(file.claims[1].region, Some([vec![0.0, 0.0], vec![1.0, 1.0]]));
    }

    #[test]
    fn every_case_of_the_project_is_readable() {
        let root = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("verification");
        let mut cases = 0;
        for entry in std::fs::read_dir(root).unwrap() {
            let folder = entry.unwrap().path();
            if !folder.is_dir() {
                continue;
            }
            cases += 1;
            let read = |name: &str| {
                std::fs::read_to_string(folder.join(name)).unwrap_or_else(|e| panic!("{folder:?} {name}: {e}"))
            };
            let file = ClaimFile::parse(&read("claim.toml")).unwrap_or_else(|e| panic!("{folder:?}: {e}"));
            assert!(read("case.toml").parse::<Table>().is_ok(), "{folder:?}");
            assert!(read("README.md").contains("**Authority"), "{folder:?}");
            for claim in &file.claims {
                if let Some(curve) = &claim.file {
                    let table = crate::claims::Table::parse(&read(curve)).unwrap();
                    let columns: &[&str] = match claim.metric {
                        Metric::Comparison(ComparisonMetric::LiftLoopDifference) => &["phase", "CL"],
                        Metric::Comparison(ComparisonMetric::DragLoopDifference) => &["phase", "CD"],
                        Metric::Field(FieldMetric::SectionCpRms) => &["y", "x_c", "Cp"],
                        Metric::Bar(_) => &["exact"],
                        Metric::Force(_) => &["k", "re", "im"],
                        _ => &["x_c", "Cp"],
                    };
                    let upper = table.only("surface", "upper");
                    assert!(columns.iter().all(|c| upper.column(c).is_ok()) && upper.len() > 1, "{folder:?} {curve}");
                }
                for other in claim.other.iter().chain(&claim.third) {
                    let there = folder.join(other).is_file() || folder.with_file_name(other).is_dir();
                    assert!(there, "{folder:?} {other}");
                }
            }
        }
        assert!(cases >= 20, "{cases}");
    }

    #[test]
    fn judges_every_kind() {
        let verdict = |kind, value| claim(kind).judge("case", value).pass;
        let relative = Kind::Relative { reference: -2.0, tolerance: 0.1 };
        assert!(verdict(relative, -2.19) && !verdict(relative, -2.21) && !verdict(relative, 2.0));
        let absolute = Kind::Absolute { reference: 0.0, tolerance: 3e-4 };
        assert!(verdict(absolute, -3e-4) && !verdict(absolute, 3.1e-4));
        let range = Kind::Range { low: 0.338, high: 0.365 };
        assert!(verdict(range, 0.338) && verdict(range, 0.365) && !verdict(range, 0.3651));
        assert!(verdict(Kind::AtMost(1.0), 0.0) && !verdict(Kind::AtMost(1.0), 1.1));
        assert!(verdict(Kind::AtLeast(6.0), 6.0) && !verdict(Kind::AtLeast(6.0), 5.9));
        for kind in [relative, absolute, range, Kind::AtMost(1.0), Kind::AtLeast(1.0)] {
            assert!(!verdict(kind, f64::NAN));
        }
    }

    #[test]
    fn what_must_hold_is_told_in_words() {
        let told = |kind: Kind| format!("{} {kind}", kind.name());
        let kinds = [
            Kind::Relative { reference: 0.28451, tolerance: 0.07 },
            Kind::Absolute { reference: 0.0, tolerance: 1e-4 },
            Kind::Range { low: 0.3, high: 0.4 },
            Kind::AtMost(1e-11),
            Kind::AtLeast(6.0),
        ];
        let words =
            ["relative 0.28451 ± 7 %", "absolute 0 ± 0.0001", "range 0.3 to 0.4", "at_most ≤ 1e-11", "at_least ≥ 6"];
        assert_eq!(kinds.map(told), words);
        let file = ClaimFile::parse(GOOD).unwrap();
        assert_eq!(file.claims[1].title(Some("more")), "cd (wave drag; more)");
    }

    #[test]
    fn a_mean_is_judged_with_its_scatter() {
        let sample = Sample::of(&[1.0, 1.2, 0.8, 1.0]);
        assert!((sample.mean - 1.0).abs() < 1e-15 && (sample.scatter - 0.163_299).abs() < 1e-6);
        let verdict = |bound: f64| claim(Kind::AtMost(bound)).judge_sample("case", sample);
        assert!(verdict(1.17).pass && !verdict(1.16).pass && verdict(2.0).metric.contains("mean of 4 runs, ± 1.6e-1"));
        assert_eq!(Sample::of(&[3.0]).scatter, 0.0);
        assert!(!claim(Kind::AtMost(1.0)).judge_sample("case", Sample::of(&[f64::NAN, 0.0])).pass);
    }

    #[test]
    fn a_row_carries_error_and_tolerance() {
        let row = claim(Kind::Relative { reference: 0.5, tolerance: 0.1 }).judge("naca", 0.52);
        assert!((row.error - 0.04).abs() < 1e-15 && row.tolerance == 0.1 && row.reference == 0.5);
        let row = claim(Kind::Range { low: 1.0, high: 3.0 }).judge("naca", 2.5);
        assert_eq!((row.reference, row.error, row.tolerance), (2.0, 0.5, 1.0));
    }

    #[test]
    fn reports_all_problems_at_once() {
        let text = r#"
            cpu_second = 3
            [[claim]]
            metric = "shock_uper"
            reference = 1
            kind = "at_most"
            source = ""
            [[claim]]
            metric = "order"
            kind = "relativ"
            source = "Shu"
            [[claim]]
            metric = "cl"
            reference = 0
            tolerance = -1
            kind = "absolute"
            source = "x"
            [[claim]]
            metric = "order"
            reference = 1.9
            kind = "at_least"
            source = "Shu"
        "#;
        let text = ClaimFile::parse(text).unwrap_err().to_string();
        for expected in [
            "unknown key `cpu_second`\nhint: did you mean `cpu_seconds`",
            "claim 1: unknown metric `shock_uper`\nhint: did you mean `shock_upper`",
            "claim 1: has no `source`",
            "claim 2: unknown kind `relativ`\nhint: did you mean `relative`",
            "claim 3: needs `tolerance`",
            "metric `order` needs several spacings",
        ] {
            assert!(text.contains(expected), "{expected} not in\n{text}");
        }
        assert!(ClaimFile::parse("claim = 3").is_err());
        assert!(ClaimFile::parse("= nonsense").is_err());
        assert!(ClaimFile::parse("").is_err());
    }

    proptest! {
        #[test]
        fn never_panics(text in "\\PC{0,200}") {
            let _ = ClaimFile::parse(&text);
        }

        #[test]
        fn never_panics_on_nearly_good_files(at in 0usize..600, byte in "[a-z0-9=\\[\\]\"\\n.]") {
            let at = at.min(GOOD.len());
            let _ = ClaimFile::parse(&format!("{}{byte}{}", &GOOD[..at], &GOOD[at..]));
        }
    }
}
