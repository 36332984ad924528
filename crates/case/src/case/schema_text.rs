//! The JSON schema of the case file as editors get it: without white space, and with what stands in it more than once written once,
//! under `$defs`. A law of motion or a unit stands at dozens of places.
use std::collections::HashMap;

use serde_json::{Map, Value, json};

use super::reference::schema;

/// Letters of a part that is worth a name of its own.
const LEAST: usize = 100;

/// The schema as the text of a file.
pub fn schema_text() -> String {
    let mut schema = schema();
    let mut shared = Shared::default();
    shared.count(&schema);
    shared.inside(&mut schema);
    if let Some(whole) = schema.as_object_mut() {
        whole.insert("$defs".to_owned(), Value::Object(shared.parts));
    }
    format!("{schema}\n")
}

/// Parts that stand at several places.
#[derive(Default)]
struct Shared {
    /// How often a part is met; what is inside another counts once for all of its like.
    met: HashMap<String, usize>,
    /// Names of parts that stand under `$defs`.
    names: HashMap<String, String>,
    parts: Map<String, Value>,
}

impl Shared {
    fn count(&mut self, part: &Value) {
        let met = self.met.entry(part.to_string()).or_default();
        *met += 1;
        if *met == 1 {
            for inner in inner(part) {
                self.count(inner);
            }
        }
    }

    /// Puts references where parts inside this one stand at several places.
    fn inside(&mut self, part: &mut Value) {
        for inner in inner_mut(part) {
            self.refer(inner);
        }
    }

    fn refer(&mut self, part: &mut Value) {
        let text = part.to_string();
        if text.len() < LEAST || self.met.get(&text).is_none_or(|met| *met < 2) {
            return self.inside(part);
        }
        let known = self.names.get(&text).cloned();
        let name = known.unwrap_or_else(|| {
            let name = format!("part-{}", self.names.len() + 1);
            self.names.insert(text, name.clone());
            let mut own = part.clone();
            self.inside(&mut own);
            self.parts.insert(name.clone(), own);
            name
        });
        *part = json!({ "$ref": format!("#/$defs/{name}") });
    }
}

/// The schemas in a schema: those of keys, of the items of lists, and alternatives.
fn inner(part: &Value) -> impl Iterator<Item = &Value> {
    let keys = part["properties"].as_object().into_iter().flat_map(Map::values);
    let others = ["anyOf", "oneOf"].into_iter().filter_map(move |key| part[key].as_array()).flatten();
    keys.chain(others).chain(part.get("items"))
}

fn inner_mut(part: &mut Value) -> Vec<&mut Value> {
    let mut all = Vec::new();
    for (key, value) in part.as_object_mut().into_iter().flatten() {
        match (key.as_str(), value) {
            ("properties", Value::Object(keys)) => all.extend(keys.values_mut()),
            ("anyOf" | "oneOf", Value::Array(alternatives)) => all.extend(alternatives),
            ("items", items) => all.push(items),
            _ => {}
        }
    }
    all
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The schema without references.
    fn resolved(part: &mut Value, parts: &Value) {
        if let Some(path) = part.get("$ref").and_then(Value::as_str) {
            *part = parts[path.strip_prefix("#/$defs/").unwrap()].clone();
        }
        inner_mut(part).into_iter().for_each(|inner| resolved(inner, parts));
    }

    #[test]
    fn the_text_says_what_the_schema_says_in_a_fraction_of_its_size() {
        let text = schema_text();
        let mut read: Value = serde_json::from_str(&text).unwrap();
        let parts = read.as_object_mut().unwrap().remove("$defs").unwrap();
        assert!(parts.as_object().unwrap().len() > 10);
        resolved(&mut read, &parts);
        assert!(read == schema());
        assert!(text.len() < 150_000 && 2 * text.len() < schema().to_string().len(), "{}", text.len());
        assert_eq!(text, schema_text(), "names are the same in every run");
    }
}
