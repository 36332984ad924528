//! Questions about a draft that several checks ask.
use serde_json::Value;

use super::draft::{Draft, closest};
use super::formula::Formula;

/// Keys that give a frequency.
pub(super) const FREQUENCIES: [&str; 3] = ["frequency", "reduced_frequency", "period"];

/// True when `part` is present and is not an empty list of modes.
pub(super) fn says_something(draft: &Draft<'_>, part: &str) -> bool {
    draft.given(part) && draft.get(part).and_then(Value::as_array).is_none_or(|list| !list.is_empty())
}

/// True when some body is a deformable solid of particles.
pub(super) fn has_solids(draft: &Draft<'_>) -> bool {
    (0..draft.count("body")).any(|i| draft.given(&format!("body[{i}].solid")))
}

/// False for a purely structural case: solids of particles without a free stream and without an initial field.
pub(super) fn has_gas(draft: &Draft<'_>) -> bool {
    let field = draft.given("initial") && !is(draft, "initial", "free_stream");
    draft.given("flow") || field || !has_solids(draft)
}

/// True when the free stream is dimensional; purely structural cases are dimensional.
pub(super) fn is_dimensional(draft: &Draft<'_>) -> bool {
    !has_gas(draft)
        || ["pressure", "temperature", "density"].iter().filter(|k| draft.given(&format!("flow.{k}"))).count() > 1
}

/// True when the value at `path` is `word`.
pub(super) fn is(draft: &Draft<'_>, path: &str, word: &str) -> bool {
    draft.get(path).and_then(Value::as_str) == Some(word)
}

/// True when a force on a structure has a frequency, so that the response can be periodic.
pub(super) fn is_shaken(draft: &Draft<'_>) -> bool {
    let mut forces = (0..draft.count("structure")).map(|i| format!("structure[{i}].force"));
    forces.any(|force| FREQUENCIES.iter().any(|f| draft.given(&format!("{force}.{f}"))))
}

/// Checks the formula of time `text` at `path`: it must be valid, and `omega` needs a frequency.
pub(super) fn formula(draft: &mut Draft<'_>, path: &str, text: &str, has_frequency: bool) {
    formula_in(0, draft, path, text, has_frequency);
}

/// Checks a formula that may contain the first `coordinates` of x, y and z.
pub(super) fn formula_in(coordinates: usize, draft: &mut Draft<'_>, path: &str, text: &str, has_frequency: bool) {
    match Formula::parse_in(text, coordinates) {
        Err(e) => {
            let name = text.get(e.span.clone()).unwrap_or_default().to_owned();
            let known = || ["x", "y", "z"].into_iter().take(coordinates).chain(Formula::vocabulary());
            let meant = closest(&name, known()).filter(|_| e.message.contains("unknown"));
            let all = || format!("names are {}", known().collect::<Vec<_>>().join(", "));
            let error = draft.fail_within(path, e.span, format!("`{path}`: {}", e.message));
            error.allowed = e.allowed;
            error.hint = match meant {
                Some(meant) => Some(format!("did you mean `{meant}`?")),
                None => e.message.contains("unknown").then(all),
            };
        }
        Ok(formula) if formula.contains(&Formula::Omega) && !has_frequency => {
            let at = text.find("omega").unwrap_or(0);
            let message = format!("`{path}` uses `omega`, but there is no frequency");
            draft.fail_within(path, at..at + 5, message).hint("add `reduced_frequency`, `frequency` or `period`");
        }
        Ok(_) => {}
    }
}
