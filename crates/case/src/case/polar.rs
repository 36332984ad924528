//! Polars: cases whose `alpha` or `mach` is a list.
//!
//! In the file a list stands where a single value stands, `alpha = "-4:8:1 deg"`. Behind the file the free stream keeps one
//! value, the first, so that whoever looks at a flow sees one; the lists are a part of their own, and
//! [`Case::streams`] makes one plain free stream of each combination.
use serde::{Deserialize, Serialize};
use serde_json::{Map, Value};

use super::draft::Draft;
use super::quantity::Angle;
use super::{Case, Flow};

/// Keys of `[flow]` that may be lists.
const LISTS: [&str; 2] = ["alpha", "mach"];
/// Greatest number of points of a polar.
const MOST: usize = 1000;

/// Values of a polar; an empty list means the single value of the free stream.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Polar {
    /// Angles of attack, nose up positive.
    #[serde(default)]
    pub alpha: Vec<Angle>,
    /// Mach numbers.
    #[serde(default)]
    pub mach: Vec<f64>,
}

impl Case {
    /// The free stream at each point of the polar: all angles at the first Mach number, then all at the next; that of the case
    /// alone when it has no polar.
    pub fn streams(&self) -> Vec<Flow> {
        let none = Polar::default();
        let polar = self.polar.as_ref().unwrap_or(&none);
        let machs = if polar.mach.is_empty() { vec![self.flow.mach] } else { some(&polar.mach) };
        let alphas = if polar.alpha.is_empty() { vec![self.flow.alpha] } else { polar.alpha.clone() };
        let at = |mach: Option<f64>, alpha: Angle| Flow { mach, alpha, ..self.flow.clone() };
        machs.iter().flat_map(|mach| alphas.iter().map(move |alpha| at(*mach, *alpha))).collect()
    }
}

impl Polar {
    /// Number of angles at each Mach number.
    pub fn angles(&self) -> usize {
        self.alpha.len().max(1)
    }

    /// Number of points.
    pub fn len(&self) -> usize {
        self.angles() * self.mach.len().max(1)
    }

    /// Always false: a polar has at least one point.
    pub fn is_empty(&self) -> bool {
        false
    }
}

fn some(values: &[f64]) -> Vec<Option<f64>> {
    values.iter().copied().map(Some).collect()
}

/// Moves the lists out of the free stream of a tree; their first values remain there.
pub(super) fn take_out(tree: &mut Value) {
    let Some(flow) = tree.get_mut("flow").and_then(Value::as_object_mut) else { return };
    let mut polar = Map::new();
    for key in LISTS {
        let Some(list) = flow.get(key).filter(|v| v.is_array()).cloned() else { continue };
        flow.insert(key.to_owned(), list[0].clone());
        polar.insert(key.to_owned(), list);
    }
    if let Some(tree) = tree.as_object_mut().filter(|_| !polar.is_empty()) {
        tree.insert("polar".to_owned(), Value::Object(polar));
    }
}

/// Restores the lists of a tree to its free stream.
pub(super) fn put_back(tree: &mut Map<String, Value>) {
    let Some(Value::Object(polar)) = tree.remove("polar") else { return };
    let Some(flow) = tree.get_mut("flow").and_then(Value::as_object_mut) else { return };
    for (key, list) in polar {
        if list.as_array().is_some_and(|l| !l.is_empty()) {
            flow.insert(key, list);
        }
    }
}

/// True for a case whose free stream contains a list.
pub(super) fn is_polar(draft: &Draft<'_>) -> bool {
    LISTS.iter().any(|key| draft.get(&format!("flow.{key}")).is_some_and(Value::is_array))
}

/// Checks that the lists of a polar are consistent with the rest of the case.
pub(super) fn contradictions(draft: &mut Draft<'_>) {
    let lists: Vec<String> = LISTS.iter().map(|key| format!("flow.{key}")).collect();
    let lists: Vec<&String> = lists.iter().filter(|path| draft.get(path).is_some_and(Value::is_array)).collect();
    let Some(first) = lists.first() else { return };
    for path in &lists {
        twice(draft, path);
    }
    let points: usize = lists.iter().map(|path| draft.count(path)).product();
    if points > MOST {
        let message = format!("a polar of {points} points is too long");
        draft.fail(first, message).allowed(format!("{MOST} points")).hint("take longer steps, or cut it in two cases");
    }
    let marches = ["dual", "explicit", "harmonics"].into_iter().find(|t| draft.get(&format!("time.{t}")).is_some());
    let bodies = draft.count("body");
    let moves = draft.given("motion") || (0..bodies).any(|b| draft.given(&format!("body[{b}].motion")));
    let reasons = [
        (marches.is_some(), "the case is not steady", "give one value, or take out `[time]`"),
        (moves, "something moves", "give one value, or take out `motion`"),
        (draft.count("structure") > 0, "a body hangs on springs", "give one value, or take out `[structure]`"),
        (draft.given("gaf"), "`[gaf]` oscillates about one flow", "give one value, or take out `[gaf]`"),
        (draft.given("accuracy.time"), "`accuracy.time` is for one flow", "bound `accuracy.particles` instead"),
        (bodies == 0, "there is no body that has loads", "give one value, or add a `[[body]]`"),
    ];
    for (_, why, hint) in reasons.iter().filter(|r| r.0) {
        let message = format!("`{first}` is a list, which makes a polar of steady states, but {why}");
        draft.fail_key(first, message).hint(*hint);
    }
}

/// Checks that no value appears twice in the list at `path`.
fn twice(draft: &mut Draft<'_>, path: &str) {
    let values = draft.numbers(path).unwrap_or_default();
    if let Some(k) = (1..values.len()).find(|k| values[..*k].contains(&values[*k])) {
        draft.fail(path, format!("value {} of `{path}` stands there twice", k + 1)).hint("give every value once");
    }
}

/// What is said of commas that may be decimal ones.
const AMBIGUOUS: &str = "`{}` is one value with a decimal comma, or several values: write decimals with a point, and a blank after each comma of a list";

/// The values that a text denotes: `-4:8:1 deg` (first:last:step), `-2, 0, 4 deg` or a single value; a unit at the end
/// applies to all.
pub(super) fn values_of(text: &str) -> Result<Vec<String>, String> {
    let parts = |separator: char| with_last_unit(text.split(separator).map(|part| part.trim().to_owned()).collect());
    if text.contains(',') {
        // `2,5 deg` may be two and a half degrees or two angles
        let dense = text.split(',').skip(1).any(|rest| !rest.starts_with(' '));
        return if dense { Err(AMBIGUOUS.replace("{}", text)) } else { Ok(parts(',')) };
    }
    if !text.contains(':') {
        return Ok(vec![text.to_owned()]);
    }
    let [first, last, step] = &parts(':')[..] else {
        return Err(format!("`{text}` is no series: it has {} parts", text.split(':').count()));
    };
    stepped([first, last, step]).ok_or_else(|| format!("`{text}` is no series that reaches its end"))?
}

/// Values without a unit receive that of the last one.
fn with_last_unit(values: Vec<String>) -> Vec<String> {
    let unit = values.last().map_or("", |last| split(last).1).to_owned();
    let all = values.into_iter().map(|v| if split(&v).1.is_empty() { format!("{v} {unit}") } else { v });
    all.map(|v| v.trim().to_owned()).collect()
}

/// Splits a quantity into number and unit.
pub(super) fn split(text: &str) -> (&str, &str) {
    let exponent = |at: usize| text[at + 1..].starts_with(|c: char| c.is_ascii_digit() || "+-".contains(c));
    let of_number =
        |(at, c): (usize, char)| c.is_ascii_digit() || "+-. ".contains(c) || ("eE".contains(c) && exponent(at));
    let end = text.char_indices().find(|c| !of_number(*c)).map_or(text.len(), |(at, _)| at);
    let (number, unit) = text.split_at(end);
    (number.trim(), unit.trim())
}

/// The values from first to last; `None` when the step is zero or leads away from the last value, an error when the
/// units differ.
fn stepped(parts: [&str; 3]) -> Option<Result<Vec<String>, String>> {
    /// Fraction of a step by which the last value may be missed because of round-off.
    const NEARLY: f64 = 1e-9;
    let [(first, unit), (last, second), (step, third)] = parts.map(split);
    if let Some(k) = [first, last, step].iter().position(|text| text.parse::<f64>().is_err()) {
        return Some(Err(format!("`{}` in `{}` does not begin with a number", parts[k], parts.join(":"))));
    }
    if unit != second || unit != third {
        return Some(Err(format!("the parts of `{}` have different units", parts.join(":"))));
    }
    let number = |text: &str| text.parse::<f64>().ok().filter(|x| x.is_finite());
    let (from, to, by) = (number(first)?, number(last)?, number(step)?);
    let count = ((to - from) / by + NEARLY).floor();
    if !(0.0..1e6).contains(&count) {
        return None;
    }
    // as many decimals as are written, so that each value reads as a user would write it
    let decimals = |text: &str| text.split_once('.').map_or(0, |(_, behind)| behind.len());
    let exact = ![first, step].iter().any(|t| t.contains(['e', 'E']));
    let digits = if exact { decimals(first).max(decimals(step)) } else { 12 };
    let value = |k: usize| format!("{:.digits$} {unit}", from + k as f64 * by).trim().to_owned();
    Some(Ok((0..=count as usize).map(value).collect()))
}

#[cfg(test)]
mod tests {
    use super::super::{read, write};
    use super::*;

    const BODY: &str = "\n[[body]]\nnaca = \"0012\"\n";

    fn case(flow: &str) -> Result<Case, String> {
        read(&format!("[flow]\n{flow}{BODY}"), "t").map_err(|e| e.to_string())
    }

    fn degrees(case: &Case) -> Vec<f64> {
        case.streams().iter().map(|flow| flow.alpha.0.to_degrees()).collect()
    }

    #[test]
    fn series_and_lists_are_what_single_values_would_be() {
        let single = |text: &str| case(&format!("mach = 0.3\nalpha = \"{text}\"")).unwrap().flow.alpha.0;
        for alpha in
            ["\"-0.3:0.6:0.3 deg\"", "[\"-0.3 deg\", 0, \"0.3 deg\", \"0.6 deg\"]", "\"-0.3, 0, 0.3, 0.6 deg\""]
        {
            let c = case(&format!("mach = 0.3\nalpha = {alpha}")).unwrap();
            let found: Vec<f64> = c.streams().iter().map(|flow| flow.alpha.0).collect();
            assert_eq!(found, ["-0.3 deg", "0 deg", "0.3 deg", "0.6 deg"].map(single), "{alpha}");
            assert!(c.streams().iter().all(|flow| flow.mach == Some(0.3)));
        }
        assert!((degrees(&case("mach = 0.3\nalpha = [-2, 0, \"4 deg\"]").unwrap())[0] + 2.0).abs() < 1e-14);
        for plain in ["[-2, 0, 4.0]", "\"-2, 0, 4\"", "[-2, 0, \"4 deg\"]"] {
            assert_eq!(
                case(&format!("mach = 0.3\nalpha = {plain}")),
                case("mach = 0.3\nalpha = \"-2, 0, 4 deg\""),
                "{plain}"
            );
        }
        assert_eq!(case("mach = 0.3\nalpha = \"-4:8:1\""), case("mach = 0.3\nalpha = \"-4:8:1 deg\""));
        assert_eq!(case("mach = \"0.9:0.2:-0.35\"").unwrap().polar.unwrap().mach, [0.9, 0.55, 0.2]);
        assert_eq!(case("mach = \"1e-1:3e-1:1e-1\"").unwrap().polar.unwrap().mach, [0.1, 0.2, 0.3]);
    }

    #[test]
    fn every_combination_is_a_point_and_one_value_is_no_list() {
        let c = case("mach = [0.3, 0.5]\nalpha = \"-2:2:2 deg\"").unwrap();
        let streams = c.streams();
        assert_eq!((streams.len(), c.polar.as_ref().unwrap().len(), c.flow.mach), (6, 6, Some(0.3)));
        assert_eq!((streams[3].mach, streams[3].alpha), (Some(0.5), streams[0].alpha));
        for alpha in ["\"2 deg\"", "[\"2 deg\"]", "\"2:2:1 deg\""] {
            let c = case(&format!("mach = 0.3\nalpha = {alpha}")).unwrap();
            assert!(c.polar.is_none() && c.streams() == [c.flow.clone()], "{alpha}");
        }
        assert_eq!(read(&write(&c), "t").unwrap(), c);
    }

    #[test]
    fn mistakes_are_told_with_what_to_write() {
        let told = |flow: &str, words: &[&str]| {
            let text = case(flow).unwrap_err();
            words.iter().for_each(|w| assert!(text.contains(w), "{flow}: {text}"));
        };
        told("mach = 0.3\nalpha = \"-4:8 deg\"", &["is no series: it has 2 parts"]);
        told("mach = 0.3\nalpha = \"-4:8:-1 deg\"", &["is no series that reaches its end"]);
        told("mach = 0.3\nalpha = \"-4:8:0 deg\"", &["is no series that reaches its end"]);
        told("mach = 0.3\nalpha = \"-4 rad:8:1 deg\"", &["different units"]);
        told("mach = 0.3\nalpha = \"a:b:c\"", &["`a` in `a:b:c` does not begin with a number"]);
        told("mach = 0.3\nalpha = \"0:x:1 deg\"", &["does not begin with a number"]);
        told("mach = [0.3, -1]", &["`flow.mach[1]`", "greater than 0"]);
        told("mach = [0.3, 0.3]", &["stands there twice"]);
        told("mach = []", &["`flow.mach` has no values"]);
        told("mach = \"0.1:3:0.001\"", &["too long", "1000 points"]);
        told("mach = \"0.3, fast\"", &["does not begin with a number"]);
    }

    #[test]
    fn flows_that_change_in_time_have_no_polar() {
        let told = |more: &str, word: &str| {
            let text = format!("[flow]\nmach = [0.3, 0.4]\n{more}");
            let text = read(&text, "t").unwrap_err().to_string();
            assert!(
                text.contains("`flow.mach` is a list, which makes a polar of steady states") && text.contains(word),
                "{text}"
            );
        };
        let motion = format!("{BODY}[motion]\nperiod = 3\nplunge = 0.1\n");
        told(&format!("{motion}[time]\nharmonics = 2\n"), "the case is not steady");
        told(&format!("{motion}[time.dual]\nsteps_per_period = 20\nperiods = 2\n"), "something moves");
        told(&format!("{BODY}[time.explicit]\nuntil = 1\n"), "take out `[time]`");
        told(&format!("{BODY}[gaf]\nreduced_frequencies = [0.1]\npivot = [0.25, 0]\n"), "take out `[gaf]`");
        told("[cloud]\nspacing = 0.1\ndomain = { min = [0, 0], max = [1, 1] }\n", "there is no body");
    }
}
