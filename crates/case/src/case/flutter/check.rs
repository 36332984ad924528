//! Contradictions in `[flutter]` and `[lco]`.
use serde_json::Value;

use super::super::draft::Draft;
use super::super::facts::is_dimensional;

/// Limit cycles are beside a boundary, and of one kind of amplitude, from small to large.
pub(in super::super) fn contradictions(draft: &mut Draft<'_>) {
    frozen(draft);
    if draft.given("flutter.design_speed") && !is_dimensional(draft) {
        draft
            .fail_key("flutter.design_speed", "a design speed, but the free stream has no units")
            .hint("give two of `pressure`, `temperature` and `density` in `[flow]`, or leave `design_speed` out");
    }
    if draft.get("lco").is_none_or(Value::is_null) {
        return;
    }
    if draft.get("flutter").is_none_or(Value::is_null) {
        draft
            .fail_key("lco", "`[lco]` without `[flutter]`")
            .hint("add `[flutter]`: limit cycles begin at its crossings");
    }
    let given = ["amplitude", "displacement"].map(|key| draft.given(&format!("lco.{key}")));
    match given {
        [false, false] => {
            draft
                .fail_key("lco", "`[lco]` does not say how large the motion is")
                .hint("add `amplitude = [\"0.25 deg\", \"4 deg\"]`, or `displacement` for modes and plunge");
        }
        [true, true] => {
            draft.fail_key("lco.displacement", "`amplitude` and `displacement` are both given").hint("keep one");
        }
        _ => {}
    }
    if draft.get("lco.march").and_then(Value::as_bool) == Some(true)
        && draft.get("lco.gas").and_then(Value::as_str) == Some("linear")
    {
        draft
            .fail("lco.march", "a march of limit cycles with a gas that does what it does in small motions")
            .hint("leave out `march`, or `gas = \"linear\"`: what marches is the gas as it is");
    }
    for place in ["lco.amplitude", "lco.displacement"] {
        let ends = draft.get(place).and_then(Value::as_array).cloned().unwrap_or_default();
        let ends: Vec<f64> = ends.iter().filter_map(Value::as_f64).collect();
        if let [first, last] = ends[..]
            && !(first < last)
        {
            draft
                .fail(place, "the greatest amplitude is not greater than the least")
                .hint("give the smaller one first");
        }
    }
}

/// What is frozen is there.
fn frozen(draft: &mut Draft<'_>) {
    let says = |draft: &Draft<'_>, key: &str, word: &str| draft.get(key).and_then(Value::as_str) == Some(word);
    let unlimited = says(draft, "scheme.limiter", "none") || draft.number("scheme.order") == Some(1.0);
    for table in ["flutter", "gaf"] {
        let place = format!("{table}.frozen_limiter");
        if draft.get(&place).and_then(Value::as_bool) != Some(true) {
            continue;
        }
        if unlimited {
            draft.fail_key(&place, "a frozen limiter, but `[scheme]` has none").hint("leave one of the two out");
        }
        if table == "gaf" && says(draft, "gaf.method", "balance") {
            draft
                .fail_key(&place, "a frozen limiter in harmonic balances")
                .hint("leave it out, or use `method = \"linear\"`: balances solve the equations as they are");
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::super::read;

    #[test]
    fn what_is_linear_does_not_march() {
        let case = |keys: &str| {
            let text = "[flow]\nmach = 0.5\n[[body]]\nnaca = \"0012\"\n[cloud]\nspacing = 0.1\n[structure]\nelastic_axis = -0.4\nmass_ratio = 60\n\
                        x_alpha = 0.2\nr_alpha2 = 0.25\nfrequency_ratio = 0.5\nreduced_speed = 2\n[flutter]\n[lco]\n\
                        amplitude = [\"0.5 deg\", \"2 deg\"]\n";
            read(&format!("{text}{keys}"), "case.toml")
        };
        assert!(!case("").unwrap().lco.unwrap().march);
        assert!(case("march = true\n").unwrap().lco.unwrap().march);
        assert!(case("gas = \"linear\"\n").is_ok());
        let refused = case("gas = \"linear\"\nmarch = true\n").unwrap_err().to_string();
        assert!(
            refused.contains("what it does in small motions") && refused.contains("leave out `march`"),
            "{refused}"
        );
        assert!(case("march = 3\n").is_err());
    }
}
