//! The report: one page that opens anywhere, offline, for ever.
//!
//! Its top gives the loads, where the motion repeats as means and first harmonics of the last period. Steady loads have three measures of
//! their error: the difference between the pressure on the surface and the balance of momentum around the bodies, the change by the last
//! refinement, their error bar where they were found on a family of clouds, and the difference from a reference where the run knows one.
use std::path::{Path, PathBuf};

use serde_json::Value;

use super::conditions::has_no_bodies;
use super::files::{LOADS, Load, RunFolder};
use super::page::{Block, Card, Fact, Page, Section, Status};
use super::sections;
use super::words::{grouped, number, with_bar};
use super::{
    ReportError, error_bars, flutter, grid, last_period, periodic, polar, pressure, solids, span, structure, write_file,
};

/// Writes `report.html` into a run folder from the files that are there, and gives its path.
pub fn write_report(run: &Path) -> Result<PathBuf, ReportError> {
    // The only failures: no folder to read, or no room to write. Whatever is missing in it becomes a word on the page.
    std::fs::read_dir(run).map_err(|source| ReportError::Io { action: "read", path: run.to_path_buf(), source })?;
    let path = run.join("report.html");
    let folder = RunFolder::new(run);
    let summary = folder.json("summary.json").unwrap_or_default();
    let page = match (flutter::is_flutter(&folder), solids::is_solid(&summary)) {
        (true, _) => flutter::page(&folder),
        (_, true) => solids::page(&folder, &summary),
        _ => report(&folder, &summary),
    };
    write_file(&path, page.html()?.as_bytes())?;
    Ok(path)
}

fn report(run: &RunFolder, summary: &Value) -> Page {
    // a harmonic balance has none
    let none = summary.get("ledger").is_some_and(Value::is_null);
    let ledger = if none { Ok(Vec::new()) } else { sections::ledger(run) };
    let bare = has_no_bodies(summary);
    let of_bodies = |chapter: fn(&RunFolder) -> Result<Vec<Block>, String>| match bare {
        true => Ok(Vec::new()),
        false => chapter(run),
    };
    let loads = polar::last_point(summary).map_or("Loads".to_owned(), |point| format!("Loads at {point}"));
    let sections = [
        Section::new("warnings", "Warnings", Ok(sections::warnings(summary))),
        Section::new("polar", "Polar", Ok(polar::polar(run))),
        Section::new("loads", &loads, of_bodies(sections::loads)),
        Section::new("span", "Load along the span", Ok(span::span(run))),
        Section::new("grid", "Grid convergence", Ok(grid::grid(run))),
        Section::new("bars", "Error bars", Ok(error_bars::error_bars(run))),
        Section::new("flow", "Flow", sections::pictures(run)),
        Section::new("pressure", "Pressure on the surface", of_bodies(pressure::pressure)),
        Section::new("motion", "Motion", Ok(periodic::motion(run))),
        Section::new("structure", "Structure", Ok(structure::structure(run))),
        Section::new("convergence", "Convergence", Ok(sections::convergence(run))),
        Section::new("doctor", "Cloud doctor", Ok(sections::doctor(run))),
        Section::new("ledger", "Conservation", ledger),
        Section::new("cost", "Time and memory", sections::timings(run)),
        Section::new("case", "Case", sections::case(run)),
        Section::new("cite", "How to cite", Ok(sections::citation())),
        Section::new("files", "Files", Ok(sections::files(run))),
    ];
    Page {
        title: sections::case_title(run, summary),
        status: Some(status(summary)),
        cards: if bare { Vec::new() } else { cards(run, summary) },
        sections: sections.into_iter().filter(|s| !s.blocks.is_empty()).collect(),
        ..Page::default()
    }
}

/// One line: converged or not, particles, iterations.
fn status(summary: &Value) -> Status {
    let get = |key: &str| summary.get(key).and_then(Value::as_f64);
    let marched = last_period::at(summary).filter(|_| summary.get("harmonic_balance").is_none());
    let (class, verdict) = match (summary.get("converged").and_then(Value::as_bool), &marched) {
        (Some(true), Some(_)) => ("good", "marched until the loads repeated"),
        (Some(false), Some(_)) => ("bad", "not periodic, or short of its end"),
        (None, Some(_)) => ("good", "marched to its end"),
        (Some(true), None) => ("good", "converged"),
        (Some(false), None) => ("bad", "not converged"),
        (None, None) => ("unknown", "no summary"),
    };
    let missed = get("unconverged_steps").filter(|n| *n > 0.0 && marched.is_some());
    let facts = [
        marched,
        get("particles").map(|n| format!("{} particles", grouped(n))),
        get("iterations").map(|n| format!("{} iterations", grouped(n))),
        missed.map(|n| format!("{} steps short of the goal of their inner iterations", grouped(n))),
        get("residual_drop").filter(|d| *d > 0.0).map(|d| format!("residual down by {} orders", orders(d))),
        summary.get("run").and_then(Value::as_str).map(str::to_owned),
    ];
    let facts = facts.into_iter().flatten().collect::<Vec<_>>().join(" · ");
    Status { class, verdict: verdict.to_owned(), facts }
}

/// `residual_drop` counts orders of magnitude; a fraction below 1 is the ratio itself.
fn orders(drop: f64) -> String {
    format!("{:.1}", if drop < 1.0 { -drop.log10() } else { drop })
}

/// The three coefficients with their errors; means and harmonics where the flow repeats.
fn cards(run: &RunFolder, summary: &Value) -> Vec<Card> {
    if let Some(cards) = last_period::cards(summary) {
        return cards;
    }
    let refinements = last_refinement(run);
    LOADS.iter().zip(refinements).map(|(load, change)| card(summary, load, change)).collect()
}

fn card(summary: &Value, load: &Load, refinement: Option<f64>) -> Card {
    let of = |table: &str| summary.get(table).and_then(|t| t.get(load.column)).and_then(Value::as_f64);
    let value = of("loads");
    let told = |v| of("loads_error").map_or_else(|| number(v), |bar| with_bar(v, bar));
    let difference = |other: Option<f64>| value.zip(other).map(|(a, b)| a - b);
    let fact = |name: &str, change: Option<f64>| Some(Fact::new(name, signed(change?, value)));
    // a march that does not repeat ends at an instant, a polar at a point
    let point = || polar::last_point(summary).map(|point| format!("at {point}"));
    let at = last_period::at(summary).or_else(point).map_or_else(String::new, |at| format!(" {at}"));
    let facts = [
        fact("against momentum balance", difference(of("loads_momentum_balance"))),
        fact("change by last refinement", refinement),
        fact("against reference", difference(of("reference"))),
    ];
    let facts = facts.into_iter().flatten().chain(last_period::cycles(summary, load)).collect();
    Card { name: format!("{}{at}", load.name), value: value.map_or("–".to_owned(), told), facts }
}

/// A difference with its sign, and in per cent of `whole` where that means something.
fn signed(change: f64, whole: Option<f64>) -> String {
    let sign = if change > 0.0 { "+" } else { "" };
    let share = whole.filter(|w| w.abs() > 1e-4).map(|w| 100.0 * change.abs() / w.abs());
    // Three digits of a difference are plenty.
    let size = change.abs();
    let text = if size == 0.0 {
        "0".to_owned()
    } else if size < 1e-6 {
        format!("{change:.1e}")
    } else {
        format!("{change:.6}")
    };
    let text = format!("{sign}{text}").replace('-', "\u{2212}");
    match share {
        Some(share) if share >= 0.005 => format!("{text} ({share:.2} %)"),
        _ => text,
    }
}

/// Change of CL, CD and CM from the last but one row of `adapt.csv` to the last.
fn last_refinement(run: &RunFolder) -> [Option<f64>; 3] {
    let Ok(table) = run.table("adapt.csv") else { return [None; 3] };
    LOADS.map(|load| match table.numbers(load.column).as_deref() {
        Some([.., before, last]) => Some(last - before).filter(|change| change.is_finite()),
        _ => None,
    })
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;
    use std::fs;

    /// Every tag that opens closes again, in order; void elements end in `/>`. Scripts and styles are not looked into.
    pub(crate) fn assert_balanced(page: &str) {
        let mut open: Vec<String> = Vec::new();
        let mut rest = page;
        while let Some(start) = rest.find('<') {
            rest = &rest[start + 1..];
            let end = rest.find('>').expect("a tag ends");
            let tag = &rest[..end];
            rest = &rest[end + 1..];
            if tag.starts_with('!') || tag.starts_with('?') || tag.ends_with('/') {
                continue;
            }
            if let Some(name) = tag.strip_prefix('/') {
                assert_eq!(open.pop().as_deref(), Some(name), "near {:?}", &rest[..rest.len().min(80)]);
                continue;
            }
            let name = tag.split_whitespace().next().unwrap_or_default().to_owned();
            if name == "script" || name == "style" {
                let close = format!("</{name}>");
                rest = &rest[rest.find(&close).expect("closed") + close.len()..];
                continue;
            }
            open.push(name);
        }
        assert!(open.is_empty(), "left open: {open:?}");
    }

    pub(crate) fn assert_self_contained(page: &str) {
        for attribute in ["src=\"", "href=\"", "url("] {
            for piece in page.split(attribute).skip(1) {
                let target: String = piece.chars().take(12).collect();
                let inside = ["data:image/", "#", "./"].iter().any(|start| target.starts_with(start));
                assert!(inside, "{attribute}{target}");
            }
        }
        assert!(!page.contains("@import") && !page.contains("fetch(") && !page.contains("XMLHttpRequest"));
    }

    /// A run folder with everything in it.
    pub(crate) fn fill_run(run: &Path) {
        let put = |name: &str, text: &str| fs::write(run.join(name), text).unwrap();
        put(
            "case.toml",
            "title = \"NACA 0012, M 0.8, α 1.25° <Euler>\"\n\n[flow]\nmach = 0.8\nalpha = 0.0218166\n\n[[compare]]\nfile = \"reference.csv\"\nlabel = \"CFL3D, 80 chords\"\n\n[[compare]]\nfile = \"gone.csv\"\nlabel = \"gone\"\n",
        );
        put(
            "summary.json",
            r#"{"event":"summary","case":"naca0012.toml","run":"runs/naca0012","particles":48211,"iterations":61,"residual_drop":6.4,"converged":true,"cpu_seconds":41.2,"wall_seconds":22.9,"peak_bytes":311000000,"loads":{"cl":0.35213,"cd":0.022841,"cm":-0.03812},"loads_momentum_balance":{"cl":0.35241,"cd":0.022874,"cm":-0.03809},"reference":{"cl":0.349,"cd":0.0224,"source":"CFL3D"},"ledger":{"mass":1e-12,"momentum":2e-12,"energy":3e-12},"phases":{"cloud":1.2,"solve":20.1}}"#,
        );
        put(
            "loads.csv",
            "body,tag,cl,cd,cm,fx,fy,fz,area\naerofoil,upper,0.81,0.034,-0.11,0.1,0.5,0,1.02\naerofoil,lower,-0.45787,-0.011159,0.07188,-0.05,-0.2,0,1.02\naerofoil,all,0.35213,0.022841,-0.03812,0.02,0.22,0,2.04\n",
        );
        put(
            "adapt.csv",
            "cycle,particles,cl,cd,cm,change_cl,change_cd\n0,21034,0.3411,0.02415,-0.0362,NaN,NaN\n1,33102,0.3502,0.02301,-0.0379,0.0091,-0.00114\n2,48211,0.35213,0.022841,-0.03812,0.00193,-0.000169\n",
        );
        put("ledger.json", r#"{"mass":1.2e-12,"momentum":[2e-12,-3e-13],"energy":4.1e-12}"#);
        put(
            "doctor.json",
            r#"{"particles":48211,"interface":412,"neighbours":{"min":7,"mean":12.4,"max":23},"histograms":[{"name":"neighbours","unit":"","edges":[6,8,10,12,14,16,18],"counts":[12,803,21034,20111,5120,1131]},{"name":"condition number","unit":"1","edges":[1,2,3,4,5],"counts":[30000,12000,6000,211]}],"worst":[{"particle":10432,"x":[0.998,0.0012],"measure":"condition number","value":81.2}],"repairs":["3 particles inside `aerofoil` were moved out"],"notes":["trailing edge resolved by 9 particles"]}"#,
        );
        put("reference.csv", "# CFL3D Euler\nx_c,Cp\n0.0,1.1\n0.2,-0.9\n0.5,-1.1\n0.61,-1.15\n0.66,-0.2\n1.0,0.3\n");
        let history: String = (1..=61)
            .map(|k| {
                format!(
                    "{},{k},0,{},{:e},{},{},{},{}\n",
                    k / 25,
                    10.0 * 1.2_f64.powi(k),
                    10.0_f64.powf(-0.1 * f64::from(k)),
                    0.352 * (1.0 - (-0.1 * f64::from(k)).exp()),
                    0.0228 + 0.02 * (-0.12 * f64::from(k)).exp(),
                    -0.038,
                    0.3 * f64::from(k)
                )
            })
            .collect();
        put("history.csv", &format!("cycle,iteration,time,cfl,residual,cl,cd,cm,seconds\n{history}"));
        let surface: String = (0..400)
            .map(|k| {
                let x = 0.5 + 0.5 * (std::f64::consts::TAU * f64::from(k) / 400.0).cos();
                let cp = if k < 200 {
                    if x < 0.62 { -1.2 + (1.0 - x).powi(30) * 2.2 } else { 0.9 * (x - 0.75) }
                } else {
                    -0.5 + 0.7 * (x - 0.4).abs()
                };
                format!("{x},0,0,0,1,0,0.01,aerofoil,wall,{k},{x},0.7,{cp},0.9,1,0.8,0,0\n")
            })
            .collect();
        put("surface.csv", &format!("x,y,z,nx,ny,nz,area,body,tag,arc,x_c,pressure,cp,mach,density,u,v,w\n{surface}"));
        fs::create_dir_all(run.join("pictures")).unwrap();
        let chart = crate::report::Chart { title: "Mach number".into(), ..Default::default() };
        fs::write(run.join("pictures/mach.png"), chart.png().unwrap()).unwrap();
        fs::write(run.join("pictures/mach.svg"), chart.svg().unwrap()).unwrap();
        fs::write(run.join("pictures/cloud-leading-edge.svg"), chart.svg().unwrap()).unwrap();
    }

    #[test]
    fn a_full_run_becomes_one_sound_page() {
        let folder = tempfile::tempdir().unwrap();
        let run =
            std::env::var_os("ALULA_PICTURES").map_or(folder.path().join("run"), |f| PathBuf::from(f).join("run"));
        fs::create_dir_all(&run).unwrap();
        fill_run(&run);
        let page = fs::read_to_string(write_report(&run).unwrap()).unwrap();
        assert_balanced(&page);
        assert_self_contained(&page);
        for text in [
            "0.35213",
            "CFL3D, 80 chords",
            "&#60;Euler&#62;",
            "10.2514/6.2010-7604",
            "+0.001930 (0.55 %)",
            "48\u{202f}211",
        ] {
            assert!(page.contains(text), "{text}");
        }
        assert_eq!(page.matches("alt=\"mach\"").count(), 1, "one of two formats");
        assert_eq!(page.matches("class=\"word\"").count(), 1, "only the reference that is gone");
        assert!(page.contains("the reference <code>gone.csv</code> was not found"));
    }

    #[test]
    fn missing_and_broken_files_are_words_on_the_page() {
        let folder = tempfile::tempdir().unwrap();
        let empty = fs::read_to_string(write_report(folder.path()).unwrap()).unwrap();
        assert_balanced(&empty);
        assert_eq!(empty.matches("class=\"word\"").count(), 8);
        fill_run(folder.path());
        for name in [
            "case.toml",
            "summary.json",
            "loads.csv",
            "adapt.csv",
            "ledger.json",
            "doctor.json",
            "history.csv",
            "surface.csv",
            "reference.csv",
        ] {
            for junk in [
                &b""[..],
                b"\xff\xfe<script>",
                b"{\"loads\": [1], \"worst\": [null], \"histograms\": [7]}",
                b"x_c,cp\n1\n\"2,3",
            ] {
                fs::write(folder.path().join(name), junk).unwrap();
                let page = fs::read_to_string(write_report(folder.path()).unwrap()).unwrap();
                assert_balanced(&page);
                assert!(!page.contains("\u{fffd}<script>"));
            }
        }
        assert!(matches!(write_report(&folder.path().join("nowhere")), Err(ReportError::Io { action: "read", .. })));
    }

    #[test]
    fn differences_are_short_and_signed() {
        assert_eq!(signed(-0.000_28, Some(0.352)), "\u{2212}0.000280 (0.08 %)");
        assert_eq!(signed(0.0, Some(0.3)), "0");
        assert_eq!(signed(3e-9, Some(0.0)), "+3.0e\u{2212}9");
        assert_eq!(orders(1e-6), "6.0");
    }
}
