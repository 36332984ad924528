//! Contradictions in `[gaf]`, and the method where it names none.
use serde_json::{Value, json};

use super::draft::Draft;

/// Keys that only a harmonic balance has a use for.
const OF_BALANCE: [&str; 4] = ["pitch", "plunge", "harmonics", "linearity"];

/// Modes have what they need.
pub(super) fn contradictions(draft: &mut Draft<'_>) {
    if draft.get("gaf").is_none_or(Value::is_null) {
        return;
    }
    if !draft.given("body") {
        draft.fail_key("gaf", "`[gaf]` needs a body").hint("add a `[[body]]`");
    }
    let pitches = draft.get("gaf.modes").and_then(Value::as_array).is_some_and(|m| m.iter().any(|m| m == "pitch"));
    if pitches && !draft.given("gaf.pivot") {
        draft
            .fail_key("gaf", "`[gaf]` pitches about no point")
            .hint("add `pivot = [0.25, 0]`, or `modes = \"plunge\"`");
    }
    if draft.count("gaf.modes") + draft.count("gaf.mode") == 0 {
        draft.fail("gaf.modes", "`[gaf]` has no modes").hint("name rigid ones in `modes`, or add a `[[gaf.mode]]`");
    }
    names(draft);
    method(draft);
}

/// Each mode has a name of its own.
fn names(draft: &mut Draft<'_>) {
    let mut names = vec!["plunge".to_owned(), "pitch".to_owned()];
    for place in (0..draft.count("gaf.mode")).map(|i| format!("gaf.mode[{i}].name")) {
        let Some(name) = draft.get(&place).and_then(Value::as_str).map(str::to_owned) else { continue };
        if !name.chars().all(|c| c.is_ascii_alphanumeric() || "-_".contains(c)) {
            let message = format!("`{name}` cannot be the name of a mode: it names a folder and a column");
            draft.fail(&place, message).allowed("letters, digits, `-` and `_`");
        }
        if names.contains(&name) {
            draft.fail(&place, format!("two modes are called `{name}`")).hint("give each mode a name of its own");
        }
        names.push(name);
    }
}

/// A method that is named fits the keys; one that is not follows from them.
fn method(draft: &mut Draft<'_>) {
    let places = |draft: &Draft<'_>, table: &str, key: &str| {
        let all = (0..draft.count(table)).map(|i| format!("{table}[{i}].{key}"));
        all.filter(|place| draft.given(place)).collect::<Vec<_>>()
    };
    let amplitudes = places(draft, "gaf.mode", "amplitude");
    let keys = OF_BALANCE.map(|key| format!("gaf.{key}")).into_iter().filter(|place| draft.given(place));
    let sizes: Vec<String> = keys.chain(amplitudes).collect();
    let own = places(draft, "body", "motion");
    let named = draft.get("gaf.method").and_then(Value::as_str).map(str::to_owned);
    let balance = named.as_deref().map_or(!sizes.is_empty() || !own.is_empty(), |method| method == "balance");
    if balance {
        of_balance(draft);
    } else if named.is_some() {
        for place in &sizes {
            let key = place.rsplit('.').next().unwrap_or_default();
            draft
                .fail_key(
                    place,
                    format!("`{key}` of `[gaf]` has no use with `method = \"linear\"`: motion is infinitely small"),
                )
                .hint(format!("take out `{key}`, or give `method = \"balance\"`"));
        }
        for place in &own {
            draft
                .fail_key(
                    place,
                    "a body has a motion of its own, which a steady flow cannot have (`[gaf]`, `method = \"linear\"`)",
                )
                .hint("take out the motion of the body, or give `method = \"balance\"`");
        }
    }
    if let Some(gaf) = draft.get_mut("gaf").and_then(Value::as_object_mut) {
        gaf.insert("method".to_owned(), json!(if balance { "balance" } else { "linear" }));
    }
}

/// A balance has amplitudes and periods.
fn of_balance(draft: &mut Draft<'_>) {
    for i in 0..draft.count("gaf.mode") {
        let place = format!("gaf.mode[{i}]");
        if !draft.given(&format!("{place}.amplitude")) {
            draft
                .fail_key(&place, "a mode of `[gaf]` has no `amplitude`, which a harmonic balance needs")
                .hint("add `amplitude`, or give `method = \"linear\"` and leave out all amplitudes");
        }
    }
    if draft.values("gaf.reduced_frequencies").contains(&0.0) {
        draft
            .fail("gaf.reduced_frequencies", "a harmonic balance has no period at a reduced frequency of 0")
            .hint("take out 0, or give `method = \"linear\"`");
    }
}
