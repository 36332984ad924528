//! The chapters of the report, each made from its own files. A chapter that lacks its file says so in a word.
use serde_json::Value;

use super::chart::{Axis, Chart, Marks, Series};
use super::conditions::conditions;
use super::files::{Csv, FILM, LOADS, RunFolder};
use super::last_period;
use super::page::{Block, Cell, Fact, Picture, Table};
use super::pressure;
use super::surface_viewer::surface_viewer;
use super::viewer::viewer;
use super::words::{grouped, number, number_of};
use crate::math::digits::fixed;

/// What pictures of the particles begin with.
const OF_CLOUD: [&str; 3] = ["cloud", "particles", "doctor"];
/// How to cite the paper.
const PAPER: &str = "@inproceedings{hu2010meshless,
  author    = {Hu, Patrick and Kamakoti, Ramji and Xue, Liping and Wang, Zhen and Li, Qingding and Attar, Peter and Vedula, Prakash},
  title     = {A Meshless Method for Aeroelastic Applications in {ASTE-P} Toolset},
  booktitle = {AIAA Modeling and Simulation Technologies Conference},
  address   = {Toronto, Ontario},
  year      = {2010},
  note      = {AIAA 2010-7604},
  doi       = {10.2514/6.2010-7604}
}";

/// What the names of pictures of Cp along the chord begin with.
const CHORDWISE: &str = "cp-chord";
/// The chapter on the load along the span draws that.
const SPANWISE: &str = "span-loading";
/// The sheet of the same at stations of the span, whose charts stand in the chapter on pressure.
const STATIONS: &str = "cp-stations";
/// Histograms whose ends differ by more than this factor have a logarithmic axis.
const WIDE: f64 = 50.0;

fn plain_or_number(value: f64) -> String {
    if value.fract() == 0.0 && value.abs() < 1e15 { grouped(value) } else { number(value) }
}

pub(super) fn loads(run: &RunFolder) -> Result<Vec<Block>, String> {
    let table = run.table("loads.csv").map(|table| Block::Table(run_table(&table, 2)));
    let summary = run.json("summary.json").unwrap_or_default();
    let conditions = conditions(&summary);
    let mut blocks: Vec<Block> = (!conditions.is_empty()).then_some(Block::Facts(conditions)).into_iter().collect();
    blocks.extend(last_period::blocks(&summary));
    let instant = last_period::at(&summary);
    blocks.extend(instant.map(|at| Block::Heading(format!("The instant {at}"))));
    blocks.push(table.unwrap_or_else(Block::LeftOut));
    let evaluations = [("On the surface", "loads"), ("Momentum balance around the bodies", "loads_momentum_balance")];
    let known = evaluations.into_iter().filter(|(_, key)| summary[key].is_object());
    let row = |(name, key): (&str, &str)| {
        let loads = LOADS.iter().map(|load| number_of(&summary[key][load.column]));
        std::iter::once(name.to_owned()).chain(loads).collect()
    };
    let rows: Vec<Vec<String>> = known.map(row).collect();
    let title = match rows.len() {
        0 => return Ok(blocks),
        1 => "All bodies together",
        _ => "Two evaluations of the same loads",
    };
    blocks.extend([Block::Heading(title.to_owned()), Block::Table(Table::new(&["", "CL", "CD", "CM"], rows))]);
    blocks.extend(hinges(&summary));
    Ok(blocks)
}

/// Moments about hinges.
fn hinges(summary: &Value) -> Vec<Block> {
    let row = |hinge: &Value| {
        let numbers = ["moment", "coefficient", "area", "chord"].map(|key| number_of(&hinge[key]));
        std::iter::once(hinge["name"].as_str().unwrap_or_default().to_owned()).chain(numbers).collect()
    };
    let rows: Vec<Vec<String>> = summary["hinge_moments"].as_array().into_iter().flatten().map(row).collect();
    if rows.is_empty() {
        return Vec::new();
    }
    let text = "By the right-hand rule about the line from its first end to the other (left to right, and in the plane: trailing edge down), in the \
                units of the case. The coefficient is the moment over dynamic pressure, area and mean chord of what lies behind the line.";
    let columns = ["hinge", "moment", "coefficient", "area behind", "chord behind"];
    vec![
        Block::Heading("Hinge moments".to_owned()),
        Block::Text(text.to_owned()),
        Block::Table(Table::new(&columns, rows)),
    ]
}

/// A table of a run as it is, with numbers for reading; the first `text_columns` are names even when they are digits.
fn run_table(table: &Csv, text_columns: usize) -> Table {
    let columns: Vec<String> = table.columns.iter().map(|name| heading(name)).collect();
    let columns: Vec<&str> = columns.iter().map(String::as_str).collect();
    let entry = |(k, text): (usize, &String)| match text.parse::<f64>() {
        Ok(value) if k >= text_columns => plain_or_number(value),
        _ => text.clone(),
    };
    Table::new(&columns, table.rows.iter().map(|row| row.iter().enumerate().map(entry).collect()))
}

/// `change_cl` as a heading: `change CL`.
fn heading(column: &str) -> String {
    let word = |word| match word {
        "cl" | "cd" | "cm" => word.to_uppercase(),
        other => other.to_owned(),
    };
    column.split('_').map(word).collect::<Vec<_>>().join(" ")
}

/// Pictures of the flow: all but those of the particles and of the last period.
pub(super) fn pictures(run: &RunFolder) -> Result<Vec<Block>, String> {
    // the chapter on pressure draws the same curve where it can
    let drawn = pressure::chart(run, Vec::new()).is_ok();
    let elsewhere = |name: &str| {
        OF_CLOUD.iter().chain([&FILM]).any(|start| name.starts_with(start))
            || drawn && name.starts_with(CHORDWISE)
            || name.starts_with(STATIONS)
    };
    let block = pictures_of(run, |name| !elsewhere(name) && !name.starts_with(SPANWISE));
    let block = block.unwrap_or_else(|| Block::LeftOut("there are no pictures in `pictures/`".to_owned()));
    Ok(viewer(run).into_iter().chain(surface_viewer(run)).chain([block]).collect())
}

/// The pictures whose names are `wanted`, if any; of a picture in both formats the SVG.
pub(super) fn pictures_of(run: &RunFolder, wanted: impl Fn(&str) -> bool) -> Option<Block> {
    let pictures = run.pictures();
    let twin = |name: &str| name.ends_with(".png").then(|| name.replace(".png", ".svg"));
    let only = |name: &str| twin(name).is_none_or(|twin| pictures.iter().all(|(other, _)| *other != twin));
    let wanted = pictures.iter().filter(|(name, _)| wanted(name) && only(name));
    let pictures: Vec<Picture> = wanted.map(|(name, bytes)| Picture::new(name, bytes)).collect();
    (!pictures.is_empty()).then_some(Block::Pictures(pictures))
}

pub(super) fn convergence(run: &RunFolder) -> Vec<Block> {
    let mut blocks = run.table("history.csv").map_or_else(|reason| vec![Block::LeftOut(reason)], histories);
    if let Ok(table) = run.table("adapt.csv") {
        blocks.extend([Block::Heading("Refinement".to_owned()), Block::Table(run_table(&table, 0))]);
    }
    blocks
}

fn histories(mut table: Csv) -> Vec<Block> {
    // Rows of all cycles one after another; `iteration` may start again with every cycle, so count rows instead then.
    let iterations = table.numbers("iteration").unwrap_or_default();
    if iterations.is_empty() || !iterations.windows(2).all(|w| w[0] < w[1]) {
        table.number_rows("iteration");
    }
    let curve = |column: &str, name: &str| table.curve("iteration", column, name).into_iter().collect();
    let chart = |title: &str, y: Axis, series: Vec<Series>| {
        let chart = Chart { title: title.to_owned(), x: Axis::linear("iteration"), y, series };
        (!chart.series.is_empty()).then(|| Block::chart(chart))
    };
    let charts = [
        chart("Residual", Axis::log("residual"), curve("residual", "residual")),
        chart("Loads", Axis::linear("coefficient"), table.loads("iteration")),
        chart("Courant number", Axis::log("CFL"), curve("cfl", "CFL")),
        chart("Fluid particles", Axis::linear("particles"), changing(curve("fluid_particles", "particles"))),
    ];
    charts.into_iter().flatten().collect()
}

/// The curves that are not level.
fn changing(mut curves: Vec<Series>) -> Vec<Series> {
    curves.retain(|curve| curve.y.windows(2).any(|w| w[0] != w[1]));
    curves
}

pub(super) fn doctor(run: &RunFolder) -> Vec<Block> {
    let pictures = pictures_of(run, |name| OF_CLOUD.iter().any(|start| name.starts_with(start)));
    let doctor = match run.json("doctor.json") {
        Ok(doctor) => doctor,
        Err(reason) => return std::iter::once(Block::LeftOut(reason)).chain(pictures).collect(),
    };
    type Told = fn(f64) -> String;
    let value = |value: &Value, told: Told| value.as_f64().map_or("–".to_owned(), told);
    let mean: Told = |mean| fixed(mean, 1);
    let range = [("min", grouped as Told), ("mean", mean), ("max", grouped)];
    let range = range.map(|(key, told)| value(&doctor["neighbours"][key], told));
    let mut blocks = vec![Block::Facts(vec![
        Fact::new("Particles", value(&doctor["particles"], grouped)),
        Fact::new("On interfaces", value(&doctor["interface"], grouped)),
        Fact::new("Neighbours, least / mean / most", range.join(" / ")),
    ])];
    blocks.extend(pictures);
    blocks.push(Block::charts(items(&doctor["histograms"]).iter().map(histogram)));
    blocks.extend(worst(&doctor));
    blocks.extend(list("Repairs", &doctor["repairs"]));
    blocks.extend(list("Notes", &doctor["notes"]));
    blocks
}

/// The entries of a list, none of what is not one.
fn items(list: &Value) -> &[Value] {
    list.as_array().map_or(&[], Vec::as_slice)
}

fn histogram(entry: &Value) -> Chart {
    let numbers =
        |key: &str| -> Vec<f64> { items(&entry[key]).iter().map(|v| v.as_f64().unwrap_or(f64::NAN)).collect() };
    let (mut edges, mut counts) = (numbers("edges"), numbers("counts"));
    // bins that nothing is in, at both ends, would leave no room for the others
    if let (Some(first), Some(last)) = (counts.iter().position(|c| *c > 0.0), counts.iter().rposition(|c| *c > 0.0)) {
        counts = counts[first..=last].to_vec();
        edges = edges.into_iter().skip(first).take(last + 2 - first).collect();
    }
    let wide = matches!(edges[..], [low, .., high] if low > 0.0 && high > WIDE * low);
    let text = |key: &str| entry[key].as_str().unwrap_or_default();
    let unit = if ["", "1"].contains(&text("unit")) { String::new() } else { format!(" ({})", text("unit")) };
    Chart {
        title: text("name").to_owned(),
        x: Axis { log: wide, ..Axis::linear(&format!("{}{unit}", text("name"))) },
        y: Axis::linear("particles"),
        series: vec![Series::new("", Marks::Bars, edges, counts)],
    }
}

fn worst(doctor: &Value) -> Vec<Block> {
    let row = |entry: &Value| {
        let particle = entry["particle"].as_f64().map_or("–".to_owned(), grouped);
        let place = items(&entry["x"]).iter().map(number_of).collect::<Vec<_>>().join(", ");
        let measure = entry["measure"].as_str().unwrap_or("–").to_owned();
        vec![particle, format!("({place})"), measure, number_of(&entry["value"])]
    };
    let rows: Vec<_> = items(&doctor["worst"]).iter().map(row).collect();
    let table = |rows| Block::Table(Table::new(&["particle", "at", "measure", "value"], rows));
    if rows.is_empty() { Vec::new() } else { vec![Block::Heading("Worst particles".to_owned()), table(rows)] }
}

/// A heading and the lines below it, or nothing.
fn list(title: &str, lines: &Value) -> Vec<Block> {
    let text = |item: &Value| item.as_str().map_or_else(|| item.to_string(), str::to_owned);
    let lines: Vec<String> = items(lines).iter().map(text).collect();
    if lines.is_empty() { Vec::new() } else { vec![Block::Heading(title.to_owned()), Block::List(lines)] }
}

pub(super) fn ledger(run: &RunFolder) -> Result<Vec<Block>, String> {
    let rows = leaves("", &run.json("ledger.json")?);
    let text = "What entered and left through the border of the domain and did not come out even.";
    Ok(vec![Block::Text(text.to_owned()), Block::Table(Table::new(&["quantity", "value"], rows))])
}

/// Leaves of a JSON value: path in words, value.
fn leaves(path: &str, value: &Value) -> Vec<Vec<String>> {
    let below =
        |key: &str| if path.is_empty() { key.replace('_', " ") } else { format!("{path}, {}", key.replace('_', " ")) };
    let text = match value {
        Value::Object(map) => return map.iter().flat_map(|(key, value)| leaves(&below(key), value)).collect(),
        Value::Array(items) if !items.iter().all(Value::is_number) => {
            let item = |(k, value): (usize, &Value)| leaves(&below(&(k + 1).to_string()), value);
            return items.iter().enumerate().flat_map(item).collect();
        }
        Value::Array(items) => items.iter().map(number_of).collect::<Vec<_>>().join(", "),
        Value::Number(_) | Value::Null => number_of(value),
        Value::String(text) => text.clone(),
        Value::Bool(yes) => if *yes { "yes" } else { "no" }.to_owned(),
    };
    vec![vec![path.to_owned(), text]]
}

pub(super) fn timings(run: &RunFolder) -> Result<Vec<Block>, String> {
    let summary = run.json("summary.json")?;
    let get = |key: &str| summary.get(key).and_then(Value::as_f64);
    let particles = get("particles").filter(|n| *n > 0.0);
    let per_particle = |value: Option<f64>, factor: f64| value.zip(particles).map(|(v, n)| factor * v / n);
    let steps = get("iterations").filter(|n| *n > 0.0);
    let per_step = per_particle(get("cpu_seconds"), 1e6).zip(steps).map(|(v, n)| v / n);
    let fact = |name: &str, value: Option<f64>, unit: &str| {
        Fact::new(name, value.map_or("–".to_owned(), |v| format!("{} {unit}", number(v))))
    };
    let mut blocks = vec![Block::Facts(vec![
        fact("Wall time", get("wall_seconds"), "s"),
        fact("Processor time", get("cpu_seconds"), "s"),
        fact("Wall time per particle", per_particle(get("wall_seconds"), 1e3), "ms"),
        fact("Processor time per particle and iteration", per_step, "µs"),
        fact("Greatest memory", get("peak_bytes").map(|b| b / 1_048_576.0), "MiB"),
        fact("Arrays of the solver per particle", get("bytes_per_particle"), "bytes"),
    ])];
    let phases = phases(&summary["phases"]);
    blocks.extend((!phases.is_empty()).then(|| Block::Table(Table::new(&["phase", "seconds"], phases))));
    Ok(blocks)
}

/// Rows of phase and seconds, from a list of pairs or from an object.
fn phases(phases: &Value) -> Vec<Vec<String>> {
    let row = |pair: &Value| Some(vec![pair.get(0)?.as_str()?.to_owned(), number_of(pair.get(1)?)]);
    match phases {
        Value::Array(pairs) => pairs.iter().filter_map(row).collect(),
        Value::Object(_) => leaves("", phases),
        _ => Vec::new(),
    }
}

pub(super) fn case(run: &RunFolder) -> Result<Vec<Block>, String> {
    let code = |text: String| Block::Code(text.trim_end().to_owned());
    let mut blocks = vec![code(run.text("case.toml")?)];
    if let Ok(cloud) = run.text("cloud.toml") {
        blocks.extend([Block::Heading("Cloud as chosen".to_owned()), code(cloud)]);
    }
    Ok(blocks)
}

pub(super) fn citation() -> Vec<Block> {
    let alula = format!(
        "@software{{alula,\n  title   = {{Alula: aeroelastic loads from a surface file, without a mesh}},\n  version = {{{}}},\n  \
         note    = {{Meshless compressible-flow solver on clouds of particles}}\n}}",
        env!("CARGO_PKG_VERSION")
    );
    let text = "The program and the method it builds on:";
    vec![Block::Text(text.to_owned()), Block::Code(format!("{alula}\n\n{PAPER}"))]
}

pub(super) fn files(run: &RunFolder) -> Vec<Block> {
    let size = |bytes: u64| match bytes {
        0..1024 => format!("{bytes} B"),
        1024..1_048_576 => format!("{:.1} KiB", bytes as f64 / 1024.0),
        _ => format!("{:.1} MiB", bytes as f64 / 1_048_576.0),
    };
    let row = |(name, bytes): &(String, u64)| {
        let link = name.replace('%', "%25").replace('#', "%23").replace('?', "%3F").replace(':', "%3A");
        vec![Cell { text: name.clone(), class: "", link: Some(format!("./{link}")) }, Cell::from(size(*bytes))]
    };
    let rows = run.files().iter().filter(|(name, _)| name != "report.html").map(row).collect();
    vec![Block::Table(Table { columns: Vec::new(), rows })]
}

/// What makes the results doubtful.
pub(super) fn warnings(summary: &Value) -> Vec<Block> {
    let told = summary.get("warnings").and_then(Value::as_array).into_iter().flatten();
    told.filter_map(Value::as_str).map(|text| Block::Text(text.to_owned())).collect()
}

/// Title of the case, else its name.
pub(super) fn case_title(run: &RunFolder, summary: &Value) -> String {
    let case = run.text("case.toml").ok().and_then(|text| text.parse::<toml::Table>().ok());
    let title = case.as_ref().and_then(|c| c.get("title")).and_then(|t| t.as_str());
    let title = title.or_else(|| summary.get("case").and_then(Value::as_str)).filter(|t| !t.trim().is_empty());
    title.unwrap_or("Run without a title").to_owned()
}
