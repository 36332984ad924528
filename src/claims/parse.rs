//! The tables of a `claim.toml`, key by key: every problem is noted with a hint.
use toml::{Table, Value};

use super::claim::{Claim, ClaimError, ClaimFile, Exact, Kind, Study};
use super::metric::Metric;

/// Most runs of an ensemble.
const MOST_RUNS: f64 = 64.0;

impl ClaimFile {
    /// Reads a `claim.toml`; reports every problem at once.
    pub fn parse(text: &str) -> Result<Self, ClaimError> {
        let table: Table = text
            .parse()
            .map_err(|e: toml::de::Error| ClaimError { problems: vec![e.to_string().trim_end().to_string()] })?;
        let mut problems = Vec::new();
        let mut root = Keys::new(&table, String::new(), &mut problems);
        let cpu_seconds = root.number("cpu_seconds");
        if cpu_seconds.is_some_and(|seconds| seconds <= 0.0) {
            root.problem(
                "`cpu_seconds` must be positive\nhint: `alula verify --list` has the time that the case took last",
            );
        }
        let study = root.table("study");
        let list = root.tables("claim");
        root.finish();
        let study = study.and_then(|t| parse_study(t, &mut problems));
        let claims: Vec<Claim> =
            list.iter().enumerate().filter_map(|(i, t)| parse_claim(t, i + 1, &mut problems)).collect();
        if list.is_empty() {
            problems.push("file has no claim\nhint: add a `[[claim]]` table".into());
        }
        if let (None, Some(claim)) = (&study, claims.iter().find(|c| matches!(c.metric, Metric::Study(_)))) {
            let name = claim.metric.name();
            problems.push(format!("metric `{name}` needs several spacings\nhint: add `[study]` with `spacings`"));
        }
        if problems.is_empty() { Ok(Self { cpu_seconds, study, claims }) } else { Err(ClaimError { problems }) }
    }
}

fn parse_study(table: &Table, problems: &mut Vec<String>) -> Option<Study> {
    let before = problems.len();
    let mut keys = Keys::new(table, "study: ".into(), problems);
    let spacings = keys.numbers("spacings").unwrap_or_default();
    let scale_boxes = keys.boolean("scale_boxes").unwrap_or(false);
    let scale_layers = keys.boolean("scale_layers").unwrap_or(false);
    let scale_wall_layers = keys.boolean("scale_wall_layers").unwrap_or(false);
    let scale_wake = keys.boolean("scale_wake").unwrap_or(false);
    let falling = spacings.windows(2).all(|w| w[1] < w[0]) && spacings.iter().all(|h| 0.0 < *h && h.is_finite());
    if spacings.len() < 2 || !falling {
        keys.problem("`spacings` must be two or more falling positive numbers\nhint: write them coarse to fine");
    }
    keys.finish();
    (problems.len() == before).then_some(Study { spacings, scale_boxes, scale_layers, scale_wall_layers, scale_wake })
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
    let (file, other, third) = (keys.string("file"), keys.string("other"), keys.string("third"));
    let (case, coordinate) = (keys.string("case"), keys.string("coordinate"));
    let mach = keys.number("mach");
    let exact = parse_exact(&mut keys);
    let region = parse_region(&mut keys);
    let levels = keys.numbers("levels").and_then(|v| <[f64; 2]>::try_from(v).ok());
    if table.contains_key("levels") && levels.is_none() {
        keys.problem("`levels` must be two numbers\nhint: write the pressures ahead and behind, `levels = [1.0, 1.7]`");
    }
    let ensemble = keys.number("ensemble");
    if ensemble.is_some_and(|n| n.fract() != 0.0 || !(2.0..=MOST_RUNS).contains(&n)) {
        keys.problem("`ensemble` must be a whole number from 2 to 64\nhint: four runs tell scatter from chance");
    }
    keys.finish();
    if problems.len() > before {
        return None;
    }
    Some(Claim {
        metric: metric?,
        kind: kind?,
        source: source?,
        label,
        file,
        exact,
        case,
        other,
        third,
        coordinate,
        mach,
        region,
        levels,
        ensemble: ensemble.map(|n| n as usize),
    })
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
