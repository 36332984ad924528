//! Claims: metrics of a run with their reference, tolerance and source.
//!
//! ```toml
//! fast = true                  # part of the quick subset
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
//! Claims whose metric needs a study (`order`, `extrapolated_…`) use the reruns of `[study]`; all others use the case as it
//! stands. The quick subset judges the `fast` cases, without extrapolations: those rerun a case at its finest spacing.
use std::fmt;
use toml::{Table, Value};

/// The contents of a `claim.toml`.
#[derive(Clone, Debug, PartialEq)]
pub struct ClaimFile {
    /// Part of the quick subset.
    pub fast: bool,
    /// Spacings at which the case is rerun.
    pub study: Option<Study>,
    /// The claims, in the order of the file.
    pub claims: Vec<Claim>,
}

/// A convergence study.
#[derive(Clone, Debug, PartialEq)]
pub struct Study {
    /// Values of `cloud.spacing`, coarse to fine; all else stays.
    pub spacings: Vec<f64>,
    /// Also scale the spacing of `[[cloud.box]]` tables by the same factor.
    pub scale_boxes: bool,
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
    /// Another case folder whose result is the reference, for metrics that compare two runs.
    pub other: Option<String>,
    /// Box of samples or wall particles the metric is restricted to: corners of smallest and largest coordinates.
    pub region: Option<[Vec<f64>; 2]>,
    /// Two pressures (over the free stream's) on either side of a wave or front.
    pub levels: Option<[f64; 2]>,
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

/// A judged claim: one row of the verification table.
#[derive(Clone, Debug, PartialEq)]
pub struct ClaimRow {
    /// Name of the case folder.
    pub case: String,
    /// Metric, with its label in brackets.
    pub metric: String,
    /// Measured value.
    pub value: f64,
    /// Reference: the middle of a range, the bound of one-sided claims.
    pub reference: f64,
    /// Value less reference, divided by |reference| for relative claims.
    pub error: f64,
    /// Greatest |error| that passes; half the width of a range, zero for one-sided claims.
    pub tolerance: f64,
    /// The claim holds.
    pub pass: bool,
    /// Where the reference comes from.
    pub source: String,
}

macro_rules! metrics {
    ($($(#[$doc:meta])* $variant:ident = $name:literal),* $(,)?) => {
        /// What a claim measures.
        #[derive(Clone, Copy, Debug, PartialEq, Eq)]
        pub enum Metric { $($(#[$doc])* $variant),* }

        impl Metric {
            /// Every metric.
            pub const ALL: &'static [Metric] = &[$(Metric::$variant),*];

            /// The name in `claim.toml`.
            pub fn name(self) -> &'static str {
                match self { $(Metric::$variant => $name),* }
            }
        }
    };
}

metrics! {
    /// Lift coefficient from wall pressure.
    Cl = "cl",
    /// Drag coefficient from wall pressure.
    Cd = "cd",
    /// Moment coefficient about the reference point, nose up positive.
    Cm = "cm",
    /// Lift coefficient from the momentum through a box around the body.
    ClMomentum = "cl_momentum",
    /// Drag coefficient from the momentum through a box around the body.
    CdMomentum = "cd_momentum",
    /// Orders of magnitude the steady residual fell.
    ResidualDrop = "residual_drop",
    /// One when the run reached its own stopping criterion, zero otherwise.
    Converged = "converged",
    /// Number of particles.
    Particles = "particles",
    /// Root mean square difference of wall Cp to `file` or `exact`.
    CpRms = "cp_rms",
    /// Greatest difference of wall Cp to `file`, `exact` or the case `other`.
    CpMaxDifference = "cp_max_difference",
    /// Chordwise position of the shock on the upper side, x/c.
    ShockUpper = "shock_upper",
    /// Chordwise position of the shock on the lower side, x/c.
    ShockLower = "shock_lower",
    /// Volume-weighted root mean square error of density against the exact solution of `[initial]`.
    ErrorL2Density = "error_l2_density",
    /// Greatest deviation of any conserved variable from the free stream, over its free-stream scale.
    FreeStreamDeviation = "free_stream_deviation",
    /// Least-squares slope of log error_l2_density against log spacing over the study.
    Order = "order",
    /// |Position of the right-most shock − exact| in units of `cloud.spacing`.
    ShockPositionError = "shock_position_error",
    /// |Mass at the end − expected| over mass at the start; what crossed open ends is expected.
    MassDrift = "mass_drift",
    /// |Energy at the end − expected| over energy at the start; what crossed open ends is expected.
    EnergyDrift = "energy_drift",
    /// Angle of a wave to the x axis in degrees, samples in `region`, between pressures `levels`.
    WaveAngle = "wave_angle",
    /// Mean wall pressure in `region` over free-stream pressure.
    PanelPressure = "panel_pressure",
    /// Lift coefficient extrapolated to zero spacing over the study.
    ExtrapolatedCl = "extrapolated_cl",
    /// Drag coefficient extrapolated to zero spacing over the study.
    ExtrapolatedCd = "extrapolated_cd",
}

impl Metric {
    /// The metric of this name.
    pub fn parse(name: &str) -> Option<Self> {
        Self::ALL.iter().copied().find(|m| m.name() == name)
    }

    /// True when the metric needs runs at several spacings.
    pub fn needs_study(self) -> bool {
        matches!(self, Self::Order | Self::ExtrapolatedCl | Self::ExtrapolatedCd)
    }
}

impl Claim {
    /// Judges the measured `value` of the case folder `case`.
    pub fn judge(&self, case: &str, value: f64) -> ClaimRow {
        let (reference, error, tolerance, pass) = self.kind.compare(value);
        let metric = match &self.label {
            Some(label) => format!("{} ({label})", self.metric.name()),
            None => self.metric.name().to_string(),
        };
        ClaimRow {
            case: case.to_string(),
            metric,
            value,
            reference,
            error,
            tolerance,
            pass,
            source: self.source.clone(),
        }
    }
}

impl Kind {
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

impl ClaimFile {
    /// Reads a `claim.toml`; reports every problem at once.
    pub fn parse(text: &str) -> Result<Self, ClaimError> {
        let table: Table = text
            .parse()
            .map_err(|e: toml::de::Error| ClaimError { problems: vec![e.to_string().trim_end().to_string()] })?;
        let mut problems = Vec::new();
        let mut root = Keys::new(&table, String::new(), &mut problems);
        let fast = root.boolean("fast").unwrap_or(false);
        let study = root.table("study");
        let list = root.tables("claim");
        root.finish();
        let study = study.and_then(|t| parse_study(t, &mut problems));
        let claims: Vec<Claim> =
            list.iter().enumerate().filter_map(|(i, t)| parse_claim(t, i + 1, &mut problems)).collect();
        if list.is_empty() {
            problems.push("file has no claim\nhint: add a `[[claim]]` table".into());
        }
        if let (None, Some(claim)) = (&study, claims.iter().find(|c| c.metric.needs_study())) {
            let name = claim.metric.name();
            problems.push(format!("metric `{name}` needs several spacings\nhint: add `[study]` with `spacings`"));
        }
        if problems.is_empty() { Ok(Self { fast, study, claims }) } else { Err(ClaimError { problems }) }
    }
}

fn parse_study(table: &Table, problems: &mut Vec<String>) -> Option<Study> {
    let before = problems.len();
    let mut keys = Keys::new(table, "study: ".into(), problems);
    let spacings = keys.numbers("spacings").unwrap_or_default();
    let scale_boxes = keys.boolean("scale_boxes").unwrap_or(false);
    let falling = spacings.windows(2).all(|w| w[1] < w[0]) && spacings.iter().all(|h| 0.0 < *h && h.is_finite());
    if spacings.len() < 2 || !falling {
        keys.problem("`spacings` must be two or more falling positive numbers\nhint: write them coarse to fine");
    }
    keys.finish();
    (problems.len() == before).then_some(Study { spacings, scale_boxes })
}

fn parse_claim(table: &Table, number: usize, problems: &mut Vec<String>) -> Option<Claim> {
    let before = problems.len();
    let mut keys = Keys::new(table, format!("claim {number}: "), problems);
    let metric = parse_metric(&mut keys);
    let kind = parse_kind(&mut keys);
    let source = keys.string("source");
    if source.as_ref().is_none_or(|s| s.trim().is_empty()) {
        keys.problem("has no `source`\nhint: name author, year and place of the reference");
    }
    let label = keys.string("label");
    let (file, other) = (keys.string("file"), keys.string("other"));
    let exact = parse_exact(&mut keys);
    let region = parse_region(&mut keys);
    let levels = keys.numbers("levels").and_then(|v| <[f64; 2]>::try_from(v).ok());
    if table.contains_key("levels") && levels.is_none() {
        keys.problem("`levels` must be two numbers\nhint: write the pressures ahead and behind, `levels = [1.0, 1.7]`");
    }
    keys.finish();
    if problems.len() > before {
        return None;
    }
    Some(Claim { metric: metric?, kind: kind?, source: source?, label, file, exact, other, region, levels })
}

fn parse_metric(keys: &mut Keys<'_, '_>) -> Option<Metric> {
    let Some(name) = keys.string("metric") else {
        keys.problem("has no `metric`\nhint: add one, such as `metric = \"cl\"`");
        return None;
    };
    let metric = Metric::parse(&name);
    if metric.is_none() {
        let names = Metric::ALL.iter().map(|m| m.name());
        keys.problem(&format!("unknown metric `{name}`\nhint: {}", suggestion(&name, names)));
    }
    metric
}

fn parse_kind(keys: &mut Keys<'_, '_>) -> Option<Kind> {
    const KINDS: [&str; 5] = ["relative", "absolute", "range", "at_most", "at_least"];
    let name = keys.string("kind").unwrap_or_default();
    if !KINDS.contains(&name.as_str()) {
        keys.problem(&format!("unknown kind `{name}`\nhint: {}", suggestion(&name, KINDS.into_iter())));
        keys.skip(&["reference", "tolerance"]);
        return None;
    }
    if name == "range" {
        let bounds = keys.numbers("reference").filter(|b| b.len() == 2 && b[0] <= b[1]);
        if bounds.is_none() {
            keys.problem("`reference` of a range must be [low, high]\nhint: write two numbers");
        }
        return bounds.map(|b| Kind::Range { low: b[0], high: b[1] });
    }
    let reference = keys.number("reference");
    if reference.is_none() {
        keys.problem("has no number as `reference`\nhint: add `reference = ...`");
    }
    if name == "at_most" || name == "at_least" {
        return reference.map(if name == "at_most" { Kind::AtMost } else { Kind::AtLeast });
    }
    let tolerance = keys.number("tolerance").filter(|t| *t >= 0.0);
    if tolerance.is_none() {
        keys.problem("needs `tolerance`, a number that is not negative\nhint: add `tolerance = ...`");
    }
    let (reference, tolerance) = (reference?, tolerance?);
    if name == "absolute" {
        return Some(Kind::Absolute { reference, tolerance });
    }
    if reference == 0.0 {
        keys.problem("relative to a `reference` of 0\nhint: use `kind = \"absolute\"`");
    }
    Some(Kind::Relative { reference, tolerance })
}

fn parse_exact(keys: &mut Keys<'_, '_>) -> Option<Exact> {
    let name = keys.string("exact")?;
    match name.as_str() {
        "circle" => Some(Exact::Circle),
        "sphere" => Some(Exact::Sphere),
        _ => {
            let hint = suggestion(&name, ["circle", "sphere"].into_iter());
            keys.problem(&format!("unknown exact solution `{name}`\nhint: {hint}"));
            None
        }
    }
}

fn parse_region(keys: &mut Keys<'_, '_>) -> Option<[Vec<f64>; 2]> {
    let table = keys.table("region")?;
    let corner = |name: &str| table.get(name).and_then(as_numbers);
    let corners = (table.len() == 2).then(|| corner("min").zip(corner("max"))).flatten();
    let valid = corners
        .filter(|(a, b)| a.len() == b.len() && (2..=3).contains(&a.len()) && a.iter().zip(b).all(|(l, h)| l <= h));
    if valid.is_none() {
        keys.problem("`region` must have `min` below `max`\nhint: `region = { min = [0, 0], max = [1, 1] }`");
    }
    valid.map(|(a, b)| [a, b])
}

/// The keys of one table, ticked off as they are read.
struct Keys<'t, 'p> {
    table: &'t Table,
    place: String,
    known: Vec<&'static str>,
    problems: &'p mut Vec<String>,
}

impl<'t, 'p> Keys<'t, 'p> {
    fn new(table: &'t Table, place: String, problems: &'p mut Vec<String>) -> Self {
        Self { table, place, known: Vec::new(), problems }
    }

    fn problem(&mut self, text: &str) {
        self.problems.push(format!("{}{text}", self.place));
    }

    fn skip(&mut self, names: &[&'static str]) {
        self.known.extend(names);
    }

    /// The value of `key` through `read`; a value of the wrong type is a problem.
    fn read<T>(&mut self, key: &'static str, wanted: &str, read: impl Fn(&'t Value) -> Option<T>) -> Option<T> {
        self.known.push(key);
        let value = self.table.get(key)?;
        let out = read(value);
        if out.is_none() {
            let found = value.type_str();
            self.problem(&format!("`{key}` must be {wanted}, not {found}\nhint: change its value"));
        }
        out
    }

    fn boolean(&mut self, key: &'static str) -> Option<bool> {
        self.read(key, "true or false", Value::as_bool)
    }

    fn string(&mut self, key: &'static str) -> Option<String> {
        self.read(key, "text", |v| v.as_str().map(str::to_string))
    }

    fn number(&mut self, key: &'static str) -> Option<f64> {
        self.read(key, "a finite number", as_number)
    }

    fn numbers(&mut self, key: &'static str) -> Option<Vec<f64>> {
        self.read(key, "a list of finite numbers", as_numbers)
    }

    fn table(&mut self, key: &'static str) -> Option<&'t Table> {
        self.read(key, "a table", Value::as_table)
    }

    fn tables(&mut self, key: &'static str) -> Vec<&'t Table> {
        let read = |v: &'t Value| v.as_array()?.iter().map(Value::as_table).collect::<Option<Vec<_>>>();
        self.read(key, "a list of tables", read).unwrap_or_default()
    }

    /// Reports the keys nobody asked for.
    fn finish(&mut self) {
        let unknown: Vec<&String> = self.table.keys().filter(|k| !self.known.contains(&k.as_str())).collect();
        for key in unknown {
            let hint = suggestion(key, self.known.iter().copied());
            self.problem(&format!("unknown key `{key}`\nhint: {hint}"));
        }
    }
}

fn as_number(value: &Value) -> Option<f64> {
    let number = value.as_float().or_else(|| value.as_integer().map(|i| i as f64))?;
    number.is_finite().then_some(number)
}

fn as_numbers(value: &Value) -> Option<Vec<f64>> {
    value.as_array()?.iter().map(as_number).collect()
}

/// The nearest of `names`, or all of them.
fn suggestion<'a>(name: &str, names: impl Iterator<Item = &'a str> + Clone) -> String {
    /// Similarity (Jaro-Winkler) above which a name is taken for a misspelling.
    const SIMILAR: f64 = 0.8;
    let score = |candidate: &str| strsim::jaro_winkler(name, candidate);
    match names.clone().max_by(|a, b| score(a).total_cmp(&score(b))) {
        Some(best) if score(best) > SIMILAR => format!("did you mean `{best}`"),
        _ => format!("use one of {}", names.map(|n| format!("`{n}`")).collect::<Vec<_>>().join(", ")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    const GOOD: &str = r#"
        fast = true
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
        assert!(file.fast);
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
                    let table = crate::verify::Table::parse(&read(curve)).unwrap();
                    assert!(table.only("surface", "upper").curve("x_c", "Cp").is_ok(), "{folder:?} {curve}");
                }
                if let Some(other) = &claim.other {
                    assert!(folder.with_file_name(other).is_dir(), "{folder:?} {other}");
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
    fn a_row_carries_error_and_tolerance() {
        let row = claim(Kind::Relative { reference: 0.5, tolerance: 0.1 }).judge("naca", 0.52);
        assert!((row.error - 0.04).abs() < 1e-15 && row.tolerance == 0.1 && row.reference == 0.5);
        let row = claim(Kind::Range { low: 1.0, high: 3.0 }).judge("naca", 2.5);
        assert_eq!((row.reference, row.error, row.tolerance), (2.0, 0.5, 1.0));
    }

    #[test]
    fn reports_all_problems_at_once() {
        let text = r#"
            fats = true
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
            "unknown key `fats`\nhint: did you mean `fast`",
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
