//! The sections of the report, each made from its own files. A section that lacks its file says so in a word.
use base64::Engine as _;
use base64::engine::general_purpose::STANDARD;
use serde_json::Value;

use super::chart::{Axis, Chart, Marks, Series};
use super::escape;
use super::files::{RunFolder, Table};

/// More points than this are thinned out in charts of the page: a screen has fewer pixels.
const MAX_POINTS: usize = 6000;

/// A number for reading: five significant digits, an exponent for the very large and small.
pub(super) fn number(value: f64) -> String {
    let size = value.abs();
    let text = if value == 0.0 {
        "0".to_owned()
    } else if !value.is_finite() {
        return "–".to_owned();
    } else if (1e-4..1e7).contains(&size) {
        let decimals = (4.0 - size.log10().floor()).clamp(0.0, 6.0) as usize;
        format!("{value:.decimals$}")
    } else {
        format!("{value:.3e}")
    };
    text.replace('-', "\u{2212}")
}

fn number_of(value: Option<&Value>) -> String {
    value.and_then(Value::as_f64).map_or("–".to_owned(), number)
}

/// A paragraph for what is left out.
pub(super) fn word(reason: &str) -> String {
    format!("<p class=\"word\">Left out: {}.</p>\n", code_spans(reason))
}

/// Text with `names` in back quotes as code.
fn code_spans(text: &str) -> String {
    let pieces: Vec<&str> = text.split('`').collect();
    let paired = pieces.len() % 2 == 1;
    let piece = |(k, piece): (usize, &&str)| match k % 2 == 1 && paired {
        true => format!("<code>{}</code>", escape(piece)),
        false => escape(piece),
    };
    pieces.iter().enumerate().map(piece).collect()
}

pub(super) fn loads(run: &RunFolder) -> String {
    let mut html = match run.table("loads.csv") {
        Ok(table) => run_table(&table, 2),
        Err(reason) => word(&reason),
    };
    let Ok(summary) = run.json("summary.json") else { return html };
    let evaluations = [("On the surface", "loads"), ("Momentum balance around the bodies", "loads_momentum_balance")];
    let mut rows: Vec<[String; 4]> = Vec::new();
    for (label, key) in evaluations {
        if let Some(values) = summary.get(key).filter(|v| v.is_object()) {
            rows.push([
                label.to_owned(),
                number_of(values.get("cl")),
                number_of(values.get("cd")),
                number_of(values.get("cm")),
            ]);
        }
    }
    if !rows.is_empty() {
        let title = if rows.len() == 1 { "All bodies together" } else { "Two evaluations of the same loads" };
        html.push_str(&format!("<h3>{title}</h3>\n"));
        html.push_str(&table_html(&["", "CL", "CD", "CM"], rows.into_iter().map(Vec::from)));
    }
    html
}

/// A table of a run as it is, with numbers for reading; the first `text_columns` are names even when they are digits.
fn run_table(table: &Table, text_columns: usize) -> String {
    let columns: Vec<String> = table.columns.iter().map(|name| heading(name)).collect();
    let columns: Vec<&str> = columns.iter().map(String::as_str).collect();
    let entry = |(k, text): (usize, &String)| match text.parse::<f64>() {
        Ok(value) if k >= text_columns => plain_or_number(value),
        _ => text.clone(),
    };
    table_html(&columns, table.rows.iter().map(|row| row.iter().enumerate().map(entry).collect()))
}

/// `change_cl` as a heading: `change CL`.
fn heading(column: &str) -> String {
    let word = |word| match word {
        "cl" | "cd" | "cm" => word.to_uppercase(),
        other => other.to_owned(),
    };
    column.split('_').map(word).collect::<Vec<_>>().join(" ")
}

/// A table; a column is set as numbers when its entries look like them.
pub(super) fn table_html(columns: &[&str], rows: impl Iterator<Item = Vec<String>>) -> String {
    let mut html = String::from("<div class=\"scroll\"><table><thead><tr>");
    columns.iter().for_each(|c| html.push_str(&format!("<th>{}</th>", escape(c))));
    html.push_str("</tr></thead><tbody>\n");
    for row in rows {
        html.push_str("<tr>");
        for entry in row {
            let numeric = entry.starts_with(|c: char| c.is_ascii_digit() || "\u{2212}-+–±".contains(c));
            let class = if numeric { " class=\"n\"" } else { "" };
            html.push_str(&format!("<td{class}>{}</td>", escape(&entry)));
        }
        html.push_str("</tr>\n");
    }
    html.push_str("</tbody></table></div>\n");
    html
}

/// Pictures of the flow, or (`cloud`) those of the particles.
pub(super) fn pictures(run: &RunFolder, cloud: bool) -> String {
    let about_cloud = |name: &str| ["cloud", "particles", "doctor"].iter().any(|start| name.starts_with(start));
    let of_film = |name: &str| name.starts_with(super::periodic::FILM);
    let figures: String = run
        .pictures()
        .iter()
        .filter(|(name, _)| about_cloud(name) == cloud && !of_film(name))
        .map(|(name, bytes)| figure(name, bytes))
        .collect();
    match figures.is_empty() {
        true if cloud => String::new(),
        true => word("there are no pictures in `pictures/`"),
        false => format!("<div class=\"pictures\">\n{figures}</div>\n"),
    }
}

pub(super) fn figure(name: &str, bytes: &[u8]) -> String {
    let kind = if name.ends_with(".svg") { "svg+xml" } else { "png" };
    let caption = name.rsplit_once('.').map_or(name, |(stem, _)| stem).replace(['-', '_'], " ");
    format!(
        "<figure><img alt=\"{caption}\" loading=\"lazy\" src=\"data:image/{kind};base64,{}\"/><figcaption>{caption}</figcaption></figure>\n",
        STANDARD.encode(bytes),
        caption = escape(&caption)
    )
}

pub(super) fn pressure(run: &RunFolder) -> String {
    let (references, missing) = run.references();
    let mut html: String = missing.iter().map(|reason| word(reason)).collect();
    let table = match run.table("surface.csv") {
        Ok(table) => table,
        Err(reason) => return word(&reason) + &html,
    };
    let three_d = table.numbers("nz").is_some_and(|nz| nz.iter().any(|n| n.abs() > 1e-9));
    if three_d && references.is_empty() {
        return word("a curve of Cp needs a two-dimensional body; pictures show the pressure of this one") + &html;
    }
    let mut series = surface_series(&table);
    for reference in references {
        let (x, y) = (reference.x, reference.cp);
        series.push(Series { name: reference.label, marks: Marks::Rings, x, y });
    }
    let chart = Chart { title: "Pressure coefficient".into(), x: Axis::linear("x/c"), y: Axis::reversed("Cp"), series };
    html.push_str(&chart_html(&chart));
    html
}

/// Cp of each body, thinned out when there is too much to see.
fn surface_series(table: &Table) -> Vec<Series> {
    let (Some(x), Some(cp)) = (table.numbers("x_c"), table.numbers("cp")) else { return Vec::new() };
    let bodies = table.column("body").unwrap_or_else(|| vec!["surface"; x.len()]);
    let mut names: Vec<&str> = bodies.clone();
    names.sort_unstable();
    names.dedup();
    let of_body = |name: &str| {
        let at: Vec<usize> = (0..x.len()).filter(|i| bodies[*i] == name).collect();
        let pick = |values: &[f64]| thinned(&at.iter().map(|i| values[*i]).collect::<Vec<_>>());
        let label = if name.parse::<u32>().is_ok() { format!("body {name}") } else { name.to_owned() };
        Series { name: format!("Alula, {label}"), marks: Marks::Dots, x: pick(&x), y: pick(&cp) }
    };
    names.into_iter().map(of_body).collect()
}

fn thinned(values: &[f64]) -> Vec<f64> {
    let stride = values.len().div_ceil(MAX_POINTS).max(1);
    values.iter().copied().step_by(stride).collect()
}

pub(super) fn convergence(run: &RunFolder) -> String {
    let mut html = match run.table("history.csv") {
        Ok(table) => histories(&table),
        Err(reason) => word(&reason),
    };
    if let Ok(table) = run.table("adapt.csv") {
        html.push_str("<h3>Refinement</h3>\n");
        html.push_str(&run_table(&table, 0));
    }
    html
}

fn plain_or_number(value: f64) -> String {
    if value.fract() == 0.0 && value.abs() < 1e15 { grouped(value) } else { number(value) }
}

/// A whole number with thin spaces between thousands.
pub(super) fn grouped(value: f64) -> String {
    let digits = format!("{:.0}", value.abs());
    let mut text = String::from(if value < 0.0 { "\u{2212}" } else { "" });
    for (k, digit) in digits.chars().enumerate() {
        if k > 0 && (digits.len() - k).is_multiple_of(3) {
            text.push('\u{202f}');
        }
        text.push(digit);
    }
    text
}

fn histories(table: &Table) -> String {
    // Rows of all cycles one after another; `iteration` may start again with every cycle, so count rows instead then.
    let iterations = table.numbers("iteration").unwrap_or_default();
    let rising = iterations.windows(2).all(|w| w[0] < w[1]);
    let x =
        if rising && !iterations.is_empty() { iterations } else { (1..=table.rows.len()).map(|k| k as f64).collect() };
    let curve = |name: &str, label: &str| {
        let y = table.numbers(name).filter(|y| y.iter().any(|v| v.is_finite()))?;
        Some(Series { name: label.to_owned(), marks: Marks::Line, x: thinned(&x), y: thinned(&y) })
    };
    let chart = |title: &str, y: Axis, series: Vec<Option<Series>>| {
        let series: Vec<Series> = series.into_iter().flatten().collect();
        let chart = Chart { title: title.to_owned(), x: Axis::linear("iteration"), y, series };
        if chart.series.is_empty() { String::new() } else { chart_html(&chart) }
    };
    chart("Residual", Axis::log("residual"), vec![curve("residual", "residual")])
        + &chart("Loads", Axis::linear("coefficient"), vec![curve("cl", "CL"), curve("cd", "CD"), curve("cm", "CM")])
        + &chart("Courant number", Axis::log("CFL"), vec![curve("cfl", "CFL")])
}

/// An interactive chart: its data for the script of the page, and a picture for readers without scripts.
pub(super) fn chart_html(chart: &Chart) -> String {
    // `<` cannot stand in a script element: it might end it.
    let data = serde_json::to_string(chart).unwrap_or_default().replace('<', "\\u003c");
    let svg = chart.svg().unwrap_or_default();
    format!(
        "<figure class=\"chart\"><div class=\"plot\"></div><script type=\"application/json\">{data}</script>\
         <noscript><img alt=\"{}\" src=\"data:image/svg+xml;base64,{}\"/></noscript></figure>\n",
        escape(&chart.title),
        STANDARD.encode(svg)
    )
}

pub(super) fn doctor(run: &RunFolder) -> String {
    let pictures = pictures(run, true);
    let doctor = match run.json("doctor.json") {
        Ok(doctor) => doctor,
        Err(reason) => return word(&reason) + &pictures,
    };
    let neighbours = doctor.get("neighbours");
    let of = |key: &str| neighbours.and_then(|n| n.get(key)).and_then(Value::as_f64);
    let range = ["min", "mean", "max"].map(|key| of(key).map_or("–".to_owned(), plain_or_number));
    let whole = |key: &str| doctor.get(key).and_then(Value::as_f64).map_or("–".to_owned(), grouped);
    let facts = [
        ("Particles", whole("particles")),
        ("On interfaces", whole("interface")),
        ("Neighbours, least / mean / most", range.join(" / ")),
    ];
    let mut html = facts_html(facts);
    html.push_str(&pictures);
    let histograms = doctor.get("histograms").and_then(Value::as_array).into_iter().flatten();
    html.push_str(&format!("<div class=\"charts\">{}</div>\n", histograms.map(histogram).collect::<String>()));
    html.push_str(&worst_table(&doctor));
    html.push_str(&list_html("Repairs", doctor.get("repairs")));
    html.push_str(&list_html("Notes", doctor.get("notes")));
    html
}

pub(super) fn facts_html<'a>(facts: impl IntoIterator<Item = (&'a str, String)>) -> String {
    let item =
        |(name, value): (&str, String)| format!("<div><dt>{}</dt><dd>{}</dd></div>\n", escape(name), escape(&value));
    format!("<dl class=\"facts\">\n{}</dl>\n", facts.into_iter().map(item).collect::<String>())
}

fn histogram(entry: &Value) -> String {
    let numbers = |key: &str| -> Vec<f64> {
        entry.get(key).and_then(Value::as_array).into_iter().flatten().map(|v| v.as_f64().unwrap_or(f64::NAN)).collect()
    };
    let text = |key: &str| entry.get(key).and_then(Value::as_str).unwrap_or_default();
    let unit = if ["", "1"].contains(&text("unit")) { String::new() } else { format!(" ({})", text("unit")) };
    let (x, y) = (numbers("edges"), numbers("counts"));
    chart_html(&Chart {
        title: text("name").to_owned(),
        x: Axis::linear(&format!("{}{unit}", text("name"))),
        y: Axis::linear("particles"),
        series: vec![Series { name: String::new(), marks: Marks::Bars, x, y }],
    })
}

fn worst_table(doctor: &Value) -> String {
    let worst = doctor.get("worst").and_then(Value::as_array).cloned().unwrap_or_default();
    if worst.is_empty() {
        return String::new();
    }
    let position = |entry: &Value| {
        let x = entry.get("x").and_then(Value::as_array).cloned().unwrap_or_default();
        format!("({})", x.iter().map(|c| number_of(Some(c))).collect::<Vec<_>>().join(", "))
    };
    let row = |entry: &Value| {
        let particle = entry.get("particle").and_then(Value::as_f64).map_or("–".to_owned(), grouped);
        let measure = entry.get("measure").and_then(Value::as_str).unwrap_or("–").to_owned();
        vec![particle, position(entry), measure, number_of(entry.get("value"))]
    };
    let table = table_html(&["particle", "at", "measure", "value"], worst.iter().map(row));
    format!("<h3>Worst particles</h3>\n{table}")
}

fn list_html(title: &str, items: Option<&Value>) -> String {
    let items = items.and_then(Value::as_array).cloned().unwrap_or_default();
    if items.is_empty() {
        return String::new();
    }
    let text = |item: &Value| item.as_str().map_or_else(|| item.to_string(), str::to_owned);
    let items: String = items.iter().map(|item| format!("<li>{}</li>\n", code_spans(&text(item)))).collect();
    format!("<h3>{title}</h3>\n<ul>\n{items}</ul>\n")
}

pub(super) fn ledger(run: &RunFolder) -> String {
    let ledger = match run.json("ledger.json") {
        Ok(ledger) => ledger,
        Err(reason) => return word(&reason),
    };
    let mut rows = Vec::new();
    flatten("", &ledger, &mut rows);
    let rows = rows.into_iter().map(|(name, value)| vec![name, value]);
    "<p>What entered and left through the border of the domain and did not come out even.</p>\n".to_owned()
        + &table_html(&["quantity", "value"], rows)
}

/// Leaves of a JSON value with their path in words.
fn flatten(path: &str, value: &Value, rows: &mut Vec<(String, String)>) {
    let below =
        |key: &str| if path.is_empty() { key.replace('_', " ") } else { format!("{path}, {}", key.replace('_', " ")) };
    match value {
        Value::Object(map) => map.iter().for_each(|(key, value)| flatten(&below(key), value, rows)),
        Value::Array(items) if items.iter().all(Value::is_number) => {
            let text = items.iter().map(|v| number_of(Some(v))).collect::<Vec<_>>().join(", ");
            rows.push((path.to_owned(), text));
        }
        Value::Array(items) => {
            items.iter().enumerate().for_each(|(k, value)| flatten(&below(&(k + 1).to_string()), value, rows));
        }
        Value::Number(_) => rows.push((path.to_owned(), number_of(Some(value)))),
        Value::String(text) => rows.push((path.to_owned(), text.clone())),
        Value::Bool(yes) => rows.push((path.to_owned(), if *yes { "yes" } else { "no" }.to_owned())),
        Value::Null => rows.push((path.to_owned(), "–".to_owned())),
    }
}

pub(super) fn timings(run: &RunFolder) -> String {
    let summary = match run.json("summary.json") {
        Ok(summary) => summary,
        Err(reason) => return word(&reason),
    };
    let get = |key: &str| summary.get(key).and_then(Value::as_f64);
    let particles = get("particles").filter(|n| *n > 0.0);
    let per_particle = |value: Option<f64>, factor: f64| value.zip(particles).map(|(v, n)| factor * v / n);
    let show = |value: Option<f64>, unit: &str| value.map_or("–".to_owned(), |v| format!("{} {unit}", number(v)));
    let steps = get("iterations").filter(|n| *n > 0.0);
    let per_step = per_particle(get("cpu_seconds"), 1e6).zip(steps).map(|(v, n)| v / n);
    let mut html = facts_html([
        ("Wall time", show(get("wall_seconds"), "s")),
        ("Processor time", show(get("cpu_seconds"), "s")),
        ("Wall time per particle", show(per_particle(get("wall_seconds"), 1e3), "ms")),
        ("Processor time per particle and iteration", show(per_step, "µs")),
        ("Greatest memory", show(get("peak_bytes").map(|b| b / 1_048_576.0), "MiB")),
        ("Memory per particle", show(per_particle(get("peak_bytes"), 1.0), "bytes")),
    ]);
    if let Some(phases) = summary.get("phases") {
        let mut rows = Vec::new();
        flatten("", phases, &mut rows);
        html.push_str(&table_html(&["phase", "seconds"], rows.into_iter().map(|(name, value)| vec![name, value])));
    }
    html
}

pub(super) fn case(run: &RunFolder) -> String {
    match run.text("case.toml") {
        Ok(text) => format!("<pre><code>{}</code></pre>\n", escape(text.trim_end())),
        Err(reason) => word(&reason),
    }
}

pub(super) fn citation() -> String {
    let alula = format!(
        "@software{{alula,\n  title   = {{Alula: aeroelastic loads from a surface file, without a mesh}},\n  version = {{{}}},\n  \
         note    = {{Meshless compressible-flow solver on clouds of particles}}\n}}",
        env!("CARGO_PKG_VERSION")
    );
    let paper = "@inproceedings{hu2010meshless,\n  author    = {Hu, Patrick and Kamakoti, Ramji and Xue, Liping and Wang, Zhen and Li, Qingding and \
                 Attar, Peter and Vedula, Prakash},\n  title     = {A Meshless Method for Aeroelastic Applications in {ASTE-P} Toolset},\n  \
                 booktitle = {AIAA Modeling and Simulation Technologies Conference},\n  address   = {Toronto, Ontario},\n  \
                 year      = {2010},\n  note      = {AIAA 2010-7604},\n  doi       = {10.2514/6.2010-7604}\n}";
    format!("<p>The program and the method it builds on:</p>\n<pre><code>{alula}\n\n{paper}</code></pre>\n")
}

pub(super) fn files(run: &RunFolder) -> String {
    let size = |bytes: u64| match bytes {
        0..1024 => format!("{bytes} B"),
        1024..1_048_576 => format!("{:.1} KiB", bytes as f64 / 1024.0),
        _ => format!("{:.1} MiB", bytes as f64 / 1_048_576.0),
    };
    let row = |(name, bytes): &(String, u64)| {
        let link = name.replace('%', "%25").replace('#', "%23").replace('?', "%3F").replace(':', "%3A");
        format!(
            "<tr><td><a href=\"./{}\">{}</a></td><td class=\"n\">{}</td></tr>\n",
            escape(&link),
            escape(name),
            size(*bytes)
        )
    };
    let rows: String = run.files().iter().filter(|(name, _)| name != "report.html").map(row).collect();
    format!("<table><tbody>\n{rows}</tbody></table>\n")
}
