//! What a case file may contain: as JSON schema for editors and as a page for readers.
use serde_json::{Map, Value, json};

use super::CASE;
use super::quantity::{Dimension, plain_symbol};
use super::schema::{Absent, Field, Kind, Range, Table, Variant};

/// JSON schema (draft 2020-12) of the case file.
pub fn schema() -> Value {
    let mut schema = table_schema(&CASE);
    schema.insert("$schema".to_owned(), json!("https://json-schema.org/draft/2020-12/schema"));
    schema.insert("title".to_owned(), json!("Alula case"));
    schema.insert("description".to_owned(), json!("What to compute: free stream, bodies, particles, scheme, time."));
    Value::Object(schema)
}

fn table_schema(table: &Table) -> Map<String, Value> {
    let mut properties = Map::new();
    for field in table.fields() {
        properties.insert(field.key.to_owned(), field_schema(field, None));
        if let Some(alias) = field.alias {
            properties.insert(alias.to_owned(), field_schema(field, Some(field.key)));
        }
    }
    if let Some(name) = table.within {
        let within = json!({ "type": "object", "properties": properties, "additionalProperties": false });
        properties.insert(name.to_owned(), within);
    }
    let required = table.fields().filter(|f| matches!(f.default, Absent::Required)).map(|f| f.key);
    let schema = json!({
        "type": "object",
        "properties": properties,
        "required": required.collect::<Vec<_>>(),
        "additionalProperties": false,
    });
    let Value::Object(mut schema) = schema else { return Map::new() };
    if !table.one_of.is_empty() {
        let given = |key: &&str| json!({ "required": [key] });
        schema.insert("oneOf".to_owned(), table.one_of.iter().map(given).collect());
    }
    schema
}

fn field_schema(field: &Field, alias_of: Option<&str>) -> Value {
    let mut schema = kind_schema(&field.kind);
    let mut doc = field.doc.to_owned();
    if let Some(key) = alias_of {
        doc = format!("The same as `{key}`. {doc}");
    }
    if let Absent::Nothing(meaning) = field.default {
        doc = format!("{doc} When absent: {meaning}.");
    }
    schema["description"] = json!(doc);
    let default = match (&field.default, &field.kind) {
        (Absent::Filled, Kind::Table(_)) => None,
        (Absent::Word(word), _) => Some(json!(word)),
        _ => field.default_value(),
    };
    if let Some(default) = default {
        schema["default"] = default;
    }
    schema
}

fn kind_schema(kind: &Kind) -> Value {
    match kind {
        Kind::Number(range) => number_schema(range),
        Kind::Quantity(dimension, range) => quantity_schema(dimension, range),
        Kind::Values(one) => {
            let items = json!({ "anyOf": [kind_schema(one), { "type": "number" }] });
            let list = json!({ "type": "array", "items": items, "minItems": 1 });
            json!({ "anyOf": [kind_schema(one), list, { "type": "string", "pattern": "[:,]" }] })
        }
        Kind::Integer(min, max) => json!({ "type": "integer", "minimum": min, "maximum": max }),
        Kind::IntegerOr(min, max, word) => {
            json!({ "anyOf": [{ "type": "integer", "minimum": min, "maximum": max }, { "const": word }] })
        }
        Kind::Flag => json!({ "type": "boolean" }),
        Kind::Formula => json!({ "anyOf": [{ "type": "string", "minLength": 1 }, { "type": "number" }] }),
        Kind::TableOr(table, word) => json!({ "anyOf": [{ "const": word }, table_schema(table)] }),
        Kind::Text | Kind::File => json!({ "type": "string", "minLength": 1 }),
        Kind::Matching(pattern) => json!({ "type": "string", "pattern": pattern }),
        Kind::Words(words) => {
            json!({ "oneOf": words.iter().map(|w| json!({ "const": w.0, "description": w.1 })).collect::<Vec<_>>() })
        }
        Kind::List(list) => {
            let mut schema = json!({ "type": "array", "items": kind_schema(&list.item), "minItems": list.min });
            if list.max < usize::MAX {
                schema["maxItems"] = json!(list.max);
            }
            if list.single { json!({ "anyOf": [schema, kind_schema(&list.item)] }) } else { schema }
        }
        Kind::Table(table) => short_or_whole(table),
        Kind::Tables(table) => {
            let one = short_or_whole(table);
            json!({ "anyOf": [{ "type": "array", "items": one }, one] })
        }
        Kind::Choice(variants) => {
            json!({ "anyOf": variants.iter().flat_map(|v| variant_schemas(v, variants)).collect::<Vec<_>>() })
        }
    }
}

fn number_schema(range: &Range) -> Value {
    let mut schema = json!({ "type": "number" });
    if range.min.is_finite() {
        schema[if range.closed { "minimum" } else { "exclusiveMinimum" }] = json!(range.min);
    }
    if range.max.is_finite() {
        schema["maximum"] = json!(range.max);
    }
    schema
}

fn quantity_schema(dimension: &Dimension, range: &Range) -> Value {
    let units: Vec<_> = dimension.units.iter().map(|u| symbol_pattern(u.symbol)).collect();
    let (open, close) = if dimension.needs_unit { ("", "") } else { ("(", ")?") };
    let pattern = format!("^\\s*[+-]?[0-9.]+([eE][+-]?[0-9]+)?\\s*{open}({}){close}\\s*$", units.join("|"));
    let text = json!({ "type": "string", "pattern": pattern, "examples": [dimension.example] });
    let plain = if dimension.needs_unit { json!({ "const": 0 }) } else { number_schema(range) };
    json!({ "anyOf": [text, plain] })
}

/// A regular expression of all ways to write a unit, see [`plain_symbol`].
fn symbol_pattern(symbol: &str) -> String {
    let one = |c: char| match c {
        ' ' => "[ *·⋅]".to_owned(),
        '2' => "(\\^?2|²)".to_owned(),
        '3' => "(\\^?3|³)".to_owned(),
        other => other.to_string(),
    };
    plain_symbol(symbol).chars().map(one).collect()
}

/// A table, or the bare value that stands for it.
fn short_or_whole(table: &Table) -> Value {
    match table.shorthand.and_then(|key| table.field(key)) {
        Some(field) => json!({ "anyOf": [kind_schema(&field.kind), table_schema(table)] }),
        None => Value::Object(table_schema(table)),
    }
}

/// One of several alternatives: the word, or its one key with what stands behind it.
fn variant_schemas(variant: &Variant, all: &[Variant]) -> Vec<Value> {
    let mut schemas = Vec::new();
    if variant.is_word() {
        schemas.push(json!({ "const": variant.name, "description": variant.doc }));
    }
    let nothing = || json!({ "anyOf": [{ "const": true }, { "type": "object", "maxProperties": 0 }] });
    let content = |v: &Variant| v.table.map_or_else(nothing, short_or_whole);
    let mut properties = Map::new();
    // others are left aside where one rules
    for other in all.iter().filter(|v| variant.rules || v.name == variant.name) {
        properties.insert(other.name.to_owned(), content(other));
    }
    schemas.push(json!({
        "type": "object",
        "description": variant.doc,
        "properties": properties,
        "required": [variant.name],
        "additionalProperties": false,
    }));
    schemas
}

/// The reference page of the case file in Markdown.
pub fn reference_markdown() -> String {
    let mut page = String::from(
        "# Case file\n\nA case file is TOML. Quantities may carry a unit (`\"1.25 deg\"`, `\"35 kPa\"`); a plain number is \
         in base units, except for angles and \
         frequencies, which need their unit unless they are zero. Keys without default must be \
         given. Unknown keys are mistakes.\n\n## Top level\n\n",
    );
    key_table(&CASE, &mut page);
    let mut told = Vec::new();
    for field in CASE.fields() {
        sections(field, field.key, &mut told, &mut page);
    }
    page.push_str("## Units\n\n| quantity | units, the base unit first |\n|---|---|\n");
    for dimension in dimensions() {
        let units = dimension.units.iter().map(|u| format!("`{}`", u.symbol)).collect::<Vec<_>>().join(" ");
        page.push_str(&format!("| {} | {units} |\n", dimension.name));
    }
    page
}

fn dimensions() -> [&'static Dimension; 19] {
    use super::quantity::{
        Acceleration, Angle, AngularStiffness, Density, Force, Frequency, Inertia, Length, Mass, PerTime, Pressure,
        Rate, SpecificHeat, Stiffness, Temperature, Time, Velocity, Viscosity, WallTime,
    };
    [
        Angle::DIMENSION,
        Length::DIMENSION,
        Time::DIMENSION,
        Frequency::DIMENSION,
        Rate::DIMENSION,
        Velocity::DIMENSION,
        Pressure::DIMENSION,
        Temperature::DIMENSION,
        Density::DIMENSION,
        Viscosity::DIMENSION,
        Acceleration::DIMENSION,
        Mass::DIMENSION,
        Inertia::DIMENSION,
        Stiffness::DIMENSION,
        AngularStiffness::DIMENSION,
        Force::DIMENSION,
        PerTime::DIMENSION,
        SpecificHeat::DIMENSION,
        WallTime::DIMENSION,
    ]
}

/// A section for every table below `field` that has none in `told`: tables with several places (the conditions on the
/// sides of the domain, the parts of a motion) are described at the first.
fn sections(field: &'static Field, path: &str, told: &mut Vec<&'static Table>, page: &mut String) {
    match &field.kind {
        Kind::Table(table) | Kind::TableOr(table, _) => {
            section(&format!("[{path}]"), (field.doc, table), path, told, page)
        }
        Kind::Tables(table) => section(&format!("[[{path}]]"), (field.doc, table), path, told, page),
        Kind::Choice(variants) => {
            for variant in *variants {
                let Some(table) = variant.table else { continue };
                section(&format!("[{path}.{}]", variant.name), (&sentence(variant.doc), table), path, told, page);
            }
        }
        _ => {}
    }
}

fn section(
    header: &str,
    (doc, table): (&str, &'static Table),
    path: &str,
    told: &mut Vec<&'static Table>,
    page: &mut String,
) {
    if told.iter().any(|t| std::ptr::eq(*t, table)) {
        return;
    }
    told.push(table);
    page.push_str(&format!("## `{header}`\n\n{doc}\n\n"));
    key_table(table, page);
    if let Some(name) = table.within {
        page.push_str(&format!("These keys may stand in `[{path}.{name}]` as well.\n\n"));
    }
    for field in table.fields() {
        sections(field, &format!("{path}.{}", field.key), told, page);
    }
}

fn key_table(table: &Table, page: &mut String) {
    page.push_str("| key | value | default | meaning |\n|---|---|---|---|\n");
    for field in table.fields() {
        let default = field.default_words().unwrap_or_else(|| "must be given".to_owned());
        let alias = field.alias.map_or_else(String::new, |alias| format!(", `{alias}`"));
        let words = match field.kind {
            Kind::Words(words) => options(words.iter().map(|w| (w.0, w.1))),
            Kind::Choice(variants) => options(variants.iter().map(|v| (v.name, v.doc))),
            _ => String::new(),
        };
        let value = field.kind.words();
        page.push_str(&format!("| `{}`{alias} | {value} | {default} | {}{words} |\n", field.key, field.doc));
    }
    page.push('\n');
}

fn options<'a>(words: impl Iterator<Item = (&'a str, &'a str)>) -> String {
    words.map(|(name, doc)| format!("<br>`{name}`: {doc}.")).collect()
}

fn sentence(doc: &str) -> String {
    let mut chars = doc.chars();
    chars.next().map_or_else(String::new, |c| c.to_uppercase().chain(chars).chain(['.']).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Every leaf of the schema that names a type, with its path.
    fn walk(value: &Value, path: &str, keys: &mut Vec<String>) {
        for (key, field) in value["properties"].as_object().into_iter().flatten() {
            let here = format!("{path}.{key}");
            walk(field, &here, keys);
            for option in field["anyOf"].as_array().into_iter().flatten() {
                walk(option, &here, keys);
            }
            keys.push(here);
        }
    }

    #[test]
    fn schema_knows_every_level() {
        let mut keys = Vec::new();
        walk(&schema(), "", &mut keys);
        for key in [".flow.mach", ".body.naca.digits", ".body.chord", ".cloud.box.spacing", ".time.steady.orders"] {
            assert!(keys.iter().any(|k| k == key), "{key} is missing in {keys:?}");
        }
        assert!(keys.iter().any(|k| k == ".boundary.x_max.outflow.pressure"));
        let schema = schema();
        assert_eq!(schema["properties"]["cloud"]["properties"]["blank"]["default"], json!(0.4));
        assert_eq!(schema["properties"]["cloud"]["properties"]["blank"]["maximum"], json!(0.6));
        assert_eq!(schema["required"], json!([]));
        assert_eq!(schema["properties"]["time"]["default"], json!("steady"));
    }

    #[test]
    fn every_key_is_described() {
        let page = reference_markdown();
        for text in ["## `[flow]`", "## `[[body]]`", "## `[time.explicit]`", "## `[boundary.x_min.outflow]`"] {
            assert_eq!(page.matches(text).count(), 1, "{text} in\n{page}");
        }
        assert!(page.contains("| `blank` | a number from 0.3 to 0.6 | `0.4` |"), "{page}");
        assert!(page.contains("| `scale`, `chord` |"), "{page}");
        assert!(page.lines().filter(|l| l.starts_with('|')).all(|l| l.matches(" | ").count() <= 3), "{page}");
    }

    #[test]
    fn alternatives_may_be_written_in_every_way_that_is_read() {
        let schema = schema();
        let time = schema["properties"]["time"]["anyOf"].as_array().unwrap();
        let harmonics = time.iter().find(|v| v["required"][0] == "harmonics").unwrap();
        let short = &harmonics["properties"]["harmonics"]["anyOf"];
        assert!(short.as_array().unwrap().iter().any(|v| v["type"] == "object") && short.as_array().unwrap().len() > 1);
        let body = &schema["properties"]["body"]["anyOf"][0]["items"];
        assert!(body["oneOf"].as_array().unwrap().contains(&json!({ "required": ["naca"] })), "{body}");
    }
}
