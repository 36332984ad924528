//! The resolved case as a file that [`read`](super::read()) turns into the same case, bit for bit.
//!
//! Numbers are written with the shortest digits that read back to the same value. Angles are written in degrees when
//! that loses nothing, else in radians.
use serde_json::{Map, Value};

use super::CASE;
use super::Case;
use super::quantity::{Angle, exact_degrees};
use super::schema::{Field, Kind, Table};
use super::solid_check::{OF_GAS, OUTPUT_OF_GAS};

/// The case as TOML; lines that only repeat a default say so.
pub fn write(case: &Case) -> String {
    let Ok(Value::Object(mut tree)) = serde_json::to_value(case) else { return String::new() };
    if !case.has_gas() {
        tree.retain(|key, _| key != "flow" && !OF_GAS.contains(&key.as_str()));
        if let Some(Value::Object(output)) = tree.get_mut("output") {
            output.retain(|key, _| !OUTPUT_OF_GAS.contains(&key.as_str()));
        }
    }
    super::polar::put_back(&mut tree);
    super::idle::take_out(&mut tree, case.has_gas());
    let mut text = String::new();
    for field in CASE.fields().filter(|f| !has_header(f, tree.get(f.key))) {
        line(field, tree.get(field.key), &mut text);
    }
    for field in CASE.fields().filter(|f| has_header(f, tree.get(f.key))) {
        match (&field.kind, tree.get(field.key)) {
            (Kind::Table(table), Some(Value::Object(keys))) => {
                section(&format!("[{}]", field.key), table, keys, &mut text)
            }
            (Kind::Tables(table), Some(Value::Array(items))) => {
                for keys in items.iter().filter_map(Value::as_object) {
                    section(&format!("[[{}]]", field.key), table, keys, &mut text);
                }
            }
            (Kind::Choice(variants), Some(Value::Object(chosen))) => {
                for (name, value) in chosen {
                    let table = variants.iter().find(|v| v.name == name).and_then(|v| v.table);
                    if let (Some(table), Some(keys)) = (table, value.as_object()) {
                        section(&format!("[{}.{name}]", field.key), table, keys, &mut text);
                    }
                }
            }
            _ => {}
        }
    }
    text
}

/// A cloud as the section of a case file.
pub fn write_cloud(cloud: &super::Cloud) -> String {
    let field = CASE.fields().find(|f| f.key == "cloud");
    let (Some(Kind::Table(table)), Ok(Value::Object(mut keys))) = (field.map(|f| &f.kind), serde_json::to_value(cloud))
    else {
        return String::new();
    };
    if cloud.domain.is_some() {
        keys.remove("far_field");
    }
    let mut text = String::new();
    section("[cloud]", table, &keys, &mut text);
    text.trim_start().to_owned()
}

/// True for what stands under a header of its own, and so behind all plain keys.
fn has_header(field: &Field, value: Option<&Value>) -> bool {
    match field.kind {
        Kind::Table(_) | Kind::Tables(_) => true,
        Kind::Choice(_) => value.is_some_and(Value::is_object),
        _ => false,
    }
}

fn section(header: &str, table: &Table, keys: &Map<String, Value>, text: &mut String) {
    if keys.values().all(Value::is_null) {
        return;
    }
    text.push_str(&format!("\n{header}\n"));
    for field in table.fields() {
        line(field, keys.get(field.key), text);
    }
}

fn line(field: &Field, value: Option<&Value>, text: &mut String) {
    let Some(value) = value.filter(|v| !v.is_null()) else { return };
    text.push_str(&format!("{} = {}", field.key, inline(&field.kind, value)));
    if field.default_value().is_some_and(|d| d == *value) {
        text.push_str("  # default");
    }
    text.push('\n');
}

/// A value on one line.
fn inline(kind: &Kind, value: &Value) -> String {
    match (kind, value) {
        (Kind::Quantity(dimension, _), Value::Number(x)) if *dimension == Angle::DIMENSION => {
            angle(x.as_f64().unwrap_or_default())
        }
        (Kind::Quantity(dimension, _), Value::Number(x)) if dimension.needs_unit => {
            format!("\"{:?} {}\"", x.as_f64().unwrap_or_default(), dimension.units[0].symbol)
        }
        (Kind::Values(one), Value::Array(items)) => bracket(items.iter().map(|v| inline(one, v))),
        (Kind::Values(one), value) => inline(one, value),
        (Kind::List(list), Value::Array(items)) => bracket(items.iter().map(|v| inline(&list.item, v))),
        (Kind::Table(table) | Kind::TableOr(table, _), Value::Object(keys)) => braces(table, keys),
        (Kind::Tables(table), Value::Array(items)) => {
            bracket(items.iter().filter_map(Value::as_object).map(|keys| braces(table, keys)))
        }
        (Kind::Choice(variants), Value::Object(chosen)) => {
            let Some((name, keys)) = chosen.iter().next() else { return "{}".to_owned() };
            let table = variants.iter().find(|v| v.name == name).and_then(|v| v.table);
            match (table, keys.as_object()) {
                (Some(table), Some(keys)) => format!("{{ {name} = {} }}", braces(table, keys)),
                _ => quoted(name),
            }
        }
        (_, Value::String(text)) => quoted(text),
        // JSON and TOML agree on numbers and truth values.
        (_, plain) => plain.to_string(),
    }
}

fn bracket(items: impl Iterator<Item = String>) -> String {
    format!("[{}]", items.collect::<Vec<_>>().join(", "))
}

fn braces(table: &Table, keys: &Map<String, Value>) -> String {
    let fields = table.fields().filter_map(|f| {
        let value = keys.get(f.key).filter(|v| !v.is_null())?;
        Some(format!("{} = {}", f.key, inline(&f.kind, value)))
    });
    let list = fields.collect::<Vec<_>>().join(", ");
    if list.is_empty() { "{}".to_owned() } else { format!("{{ {list} }}") }
}

fn quoted(text: &str) -> String {
    toml::Value::String(text.to_owned()).to_string()
}

/// The shortest decimal number of degrees that reads back to the same radians, else the radians.
fn angle(radians: f64) -> String {
    let exact = exact_degrees(radians);
    exact.map_or_else(|| format!("\"{radians:?} rad\""), |degrees| format!("\"{degrees} deg\""))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::case::{Side, TEMPLATES, read, template};

    const EVERYTHING: &str = r#"
title = "say \"κ\"\\ twice"
dimension = 2
initial = { riemann = { left = [1, 0.1, 1], right = [0.125, 0, 0.1], axis = 1, position = 0.3 } }
[flow]
velocity = "100 km/h"
temperature = "15 degC"
density = "1.225 kg/m3"
viscosity = "1.8e-5 Pa s"
sutherland = "111 K"
alpha = "1.25 deg"
[[body]]
naca = { digits = "2412", trailing_edge = "extended" }
chord = 12
[[body]]
polygon = [[0, 0], [1, 0.1], [1, -0.1]]
rotate = "-3.3333333333333333 deg"
translate = ["1 ft", "-12 in"]
[[body]]
box = { size = [1, "3 mm"] }
wall = { temperature = "300 K" }
[body.motion]
frequency = "5 Hz"
plunge = { amplitude = "1 mm", phase = "90 deg", direction = [1, 1] }
table = { time = [0, 1e-3], x = [0, "1 mm"] }
[[body.motion.mode]]
file = "bend.csv"
amplitude = 0.1
[motion]
particles = "deforming"
pivot = [0, 0]
formula = { angle = "2 * deg * sin(3*t)" }
rotation = "10 rpm"
translation = ["1 m/s", 0]
[cloud]
spacing = "2 mm"
domain = { min = [-10, -10], max = [10, 10] }
box = [{ min = [0, 0], max = [1, 1], spacing = 0.1 }, { min = [-1, 0], max = [1, 1], spacing = 1e-300 }]
wake = { length = 3, spacing = 0.1 }
wall_layers = { first = "10 um", count = 30 }
[boundary]
x_min = "held"
x_max = { outflow = { pressure = 0.9 } }
y_min.outflow = {}
[scheme]
conservative = false
[time.explicit]
until = "20 ms"
[output]
field_interval = "1 ms"
field_particles = 500
[[hinge]]
name = "flap"
from = [0.75, 0]
[[compare]]
file = "a.csv"
"#;

    #[test]
    fn a_written_case_reads_back_to_itself() {
        let texts = TEMPLATES.iter().map(|(name, _)| template(name).unwrap()).chain([EVERYTHING.to_owned()]);
        for text in texts {
            let case = read(&text, "case.toml").unwrap_or_else(|e| panic!("{e}"));
            let written = write(&case);
            let again = read(&written, "other.toml").unwrap_or_else(|e| panic!("{e}\n{written}"));
            assert_eq!(case, again);
            assert_eq!(write(&again), written);
        }
    }

    #[test]
    fn a_cloud_alone_is_a_section() {
        let case = read(EVERYTHING, "case.toml").unwrap();
        let bare = read("[flow]\nmach = 0.5\n[[body]]\nnaca = \"0012\"\n", "bare.toml").unwrap();
        let text = format!("{}\n{}", write(&bare).split("\n[cloud]").next().unwrap(), write_cloud(&case.cloud));
        assert_eq!(read(&text, "again.toml").unwrap_or_else(|e| panic!("{e}\n{text}")).cloud, case.cloud);
    }

    #[test]
    fn defaults_are_marked_and_angles_stay_readable() {
        let case = read(EVERYTHING, "case.toml").unwrap();
        let written = write(&case);
        assert!(written.contains("alpha = \"1.25 deg\"\n"), "{written}");
        assert!(written.contains("gamma = 1.4  # default\n"), "{written}");
        assert!(written.contains("x_max = { outflow = { pressure = 0.9 } }\n"), "{written}");
        assert_eq!(case.boundary.y_min, Side::Outflow { pressure: None });
    }

    #[test]
    fn angles_survive_bit_for_bit() {
        for radians in [0.0, 1.0, 0.1_f64.to_radians(), -7.3, 1e-9, 1.25_f64.to_radians(), 3.0e7] {
            let text = angle(radians);
            assert_eq!(text.trim_matches('"').parse::<Angle>().unwrap().0, radians, "{text}");
        }
    }
}
