//! What loads belong to: stream and reference values as the run understood them.
use serde_json::Value;

use super::page::Fact;
use super::words::plain;

/// Mach number, angle of attack, Reynolds number, and what loads are divided by; nothing of what the summary does not tell.
pub(super) fn conditions(summary: &Value) -> Vec<Fact> {
    let reference = &summary["reference"];
    let known = [
        ("Mach number", &summary["mach"]),
        ("Angle of attack, degrees", &summary["alpha_deg"]),
        ("Reynolds number", &summary["reynolds"]),
        ("Reference chord", &reference["chord"]),
        ("Reference area", &reference["area"]),
    ];
    let known = known.into_iter().filter(|(_, value)| value.is_number());
    let mut facts: Vec<Fact> = known.map(|(name, value)| Fact::new(name, told(value))).collect();
    if let Some(point) = reference["moment_point"].as_array() {
        let told = point.iter().map(told).collect::<Vec<_>>().join(", ");
        facts.push(Fact::new("Moments about", format!("({told})")));
    }
    facts
}

fn told(value: &Value) -> String {
    value.as_f64().map_or("–".to_owned(), plain)
}

/// True of a run without bodies: its summary tells that there is nothing to refer loads to.
pub(super) fn has_no_bodies(summary: &Value) -> bool {
    summary.get("reference").is_some_and(Value::is_null)
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    #[test]
    fn what_is_not_known_is_not_told() {
        let summary = json!({ "mach": 0.5, "alpha_deg": 0.0, "reynolds": null,
            "reference": { "chord": 2.0, "area": null, "moment_point": [0.5, 0.0] } });
        let facts: Vec<(String, String)> = conditions(&summary).into_iter().map(|f| (f.name, f.value)).collect();
        let told = |name: &str| facts.iter().find(|f| f.0 == name).map(|f| f.1.as_str());
        assert_eq!(told("Angle of attack, degrees"), Some("0"));
        assert_eq!(told("Reference chord"), Some("2"));
        assert_eq!(told("Moments about"), Some("(0.5, 0)"));
        assert_eq!(facts.len(), 4);
        assert!(conditions(&json!({})).is_empty());
    }
}
