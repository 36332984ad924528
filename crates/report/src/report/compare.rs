//! Two runs of a periodic flow side by side: loads over the period, harmonics, walls, fields, cost.
//!
//! The second run is the reference. With first harmonics Â of the first and B̂ of the second run, e_1 = |Â − B̂|/|B̂|,
//! e_0 is the difference of the means over |B̂|, and e_∞ the greatest difference over the period over half the range of the
//! reference. Times are those since phase zero of the motion, which is the same in both. Cost is told in seconds and in work units,
//! evaluations of the residual of one instance on the whole cloud: a step of a march needs some, an iteration of a harmonic balance
//! as many as there are instances.
use std::path::{Path, PathBuf};

use num_complex::Complex64;
use serde_json::Value;

use super::chart::Chart;
use super::fields::{self, FieldDifference};
use super::files::{LOADS, Load, RunFolder};
use super::page::{Block, Page, Section, Table};
use super::periodic::{Period, loop_charts};
use super::words::{grouped, number};
use super::{ReportError, write_file};

/// Harmonics in the table.
const SHOWN: usize = 3;

/// How one load of two runs differs.
#[derive(Clone, Debug, PartialEq)]
pub struct LoadDifference {
    /// Name.
    pub name: &'static str,
    /// Means.
    pub mean: [f64; 2],
    /// Harmonics 1, 2, ... of both.
    pub harmonics: Vec<[Complex64; 2]>,
    /// Difference of the means over the first harmonic of the reference.
    pub e0: f64,
    /// Difference of the first harmonics (complex) over that of the reference.
    pub e1: f64,
    /// Greatest difference over the period over half the range of the reference.
    pub largest: f64,
    /// Root mean square of it.
    pub rms: f64,
}

/// What a finished run of a motion that repeats left behind.
struct Finished {
    summary: Value,
    harmonics: Value,
    period: Period,
}

impl Finished {
    fn of(run: &RunFolder) -> Result<Self, String> {
        let told = |e: String| format!("{}: {e}", run.path.display());
        let name = run.path.file_name().map_or_else(String::new, |n| n.to_string_lossy().into_owned());
        let (loops, instances) = (run.table("loops.csv").map_err(told)?, run.table("instances.csv").ok());
        Ok(Self {
            summary: run.json("summary.json").map_err(told)?,
            harmonics: run.json("harmonics.json").map_err(told)?,
            period: Period { name, loops, instances },
        })
    }
}

/// Two runs side by side.
#[derive(Clone, Debug)]
pub struct Comparison {
    /// Folders.
    pub runs: [PathBuf; 2],
    /// Loads.
    pub loads: Vec<LoadDifference>,
    /// Processor seconds.
    pub cpu: [f64; 2],
    /// Wall seconds.
    pub wall_clock: [f64; 2],
    /// Evaluations of the residual of one instance; not a number for runs that did not count them.
    pub work: [f64; 2],
    /// Particles.
    pub particles: [f64; 2],
    /// Root mean square and greatest difference of the wall pressure coefficient at the end of the period, when both runs
    /// have the same wall particles.
    pub wall: Option<[f64; 2]>,
    /// Differences of the fields, or why they cannot be compared.
    pub fields: Result<Vec<FieldDifference>, String>,
    charts: Vec<(Load, Chart)>,
}

impl Comparison {
    /// Reads two run folders; every reason why they cannot be compared is told.
    pub fn of(a: &Path, b: &Path) -> Result<Self, String> {
        let folders = [RunFolder::new(a), RunFolder::new(b)];
        let runs = match folders.each_ref().map(Finished::of) {
            [Ok(a), Ok(b)] => [a, b],
            all => {
                let problems: Vec<String> = all.into_iter().filter_map(Result::err).collect();
                let hint = "both must be finished runs of a motion that repeats";
                return Err(format!("{}\nhint: {hint}", problems.join("\n")));
            }
        };
        let omegas = runs.each_ref().map(|run| run.harmonics["omega"].as_f64().unwrap_or(f64::NAN));
        if (omegas[0] / omegas[1] - 1.0).abs() > 1e-6 || omegas.iter().any(|o| o.is_nan()) {
            return Err(format!(
                "the runs have the angular frequencies {} and {}\nhint: compare runs of the same motion",
                omegas[0], omegas[1]
            ));
        }
        let both = |key: &str| runs.each_ref().map(|run| run.summary[key].as_f64().unwrap_or(f64::NAN));
        Ok(Self {
            loads: LOADS.iter().filter_map(|load| difference(load, &runs)).collect(),
            cpu: both("cpu_seconds"),
            wall_clock: both("wall_seconds"),
            work: both("work_units"),
            particles: both("particles"),
            wall: walls(&folders),
            fields: fields::differences(&folders, fields::period_of(&runs[1].harmonics)),
            charts: loop_charts(&runs.map(|run| run.period)),
            runs: [a.to_path_buf(), b.to_path_buf()],
        })
    }

    /// The comparison as lines of text.
    pub fn text(&self) -> String {
        self.page().text()
    }

    /// What the runs took: name and value for both.
    fn costs(&self) -> [(&'static str, [f64; 2]); 3] {
        [
            ("processor time, s", self.cpu),
            ("wall time, s", self.wall_clock),
            ("work, evaluations of an instance", self.work),
        ]
    }

    /// The comparison as comma-separated values.
    pub fn csv(&self) -> String {
        let mut text =
            "# harmonics f_n of f(t) = mean + Re sum f_n exp(+i n omega t), time from phase zero of the motion\n\
             # units: loads, e and parts 1, places and fields those of the runs (`csv-metadata.json`), seconds s\n\
                        load,quantity,a,b\n"
                .to_owned();
        for l in &self.loads {
            text.push_str(&format!("{},mean,{},{}\n", l.name, l.mean[0], l.mean[1]));
            for (k, [a, b]) in l.harmonics.iter().enumerate() {
                let n = k + 1;
                text.push_str(&format!("{0},re {n},{1},{2}\n{0},im {n},{3},{4}\n", l.name, a.re, b.re, a.im, b.im));
            }
            for (name, value) in [("e0", l.e0), ("e1", l.e1), ("e_max", l.largest), ("e_rms", l.rms)] {
                text.push_str(&format!("{},{name},{value},\n", l.name));
            }
        }
        for d in self.fields.iter().flatten() {
            let (name, at, [x, y, z]) = (d.quantity, d.at.words(), d.place);
            text.push_str(&format!("{name},{at} rms,{},\n{name},{at} rms part,{},\n", d.rms, d.rms / d.scale));
            text.push_str(&format!("{name},{at} greatest,{},\n{name},{at} place,{x} {y} {z},\n", d.largest));
        }
        let costs = [("cpu_seconds", self.cpu), ("wall_seconds", self.wall_clock), ("work_units", self.work)];
        for (name, [a, b]) in costs {
            text.push_str(&format!("cost,{name},{a},{b}\ncost,speed-up in {name},{},\n", b / a));
        }
        text
    }

    /// Writes `comparison.html` and `comparison.csv` into a folder.
    pub fn write(&self, folder: &Path) -> Result<PathBuf, ReportError> {
        std::fs::create_dir_all(folder).map_err(|source| ReportError::Io {
            action: "make",
            path: folder.to_path_buf(),
            source,
        })?;
        write_file(&folder.join("comparison.csv"), self.csv().as_bytes())?;
        for (load, chart) in &self.charts {
            write_file(&folder.join(format!("loop-{}.svg", load.column)), chart.svg()?.as_bytes())?;
        }
        let path = folder.join("comparison.html");
        write_file(&path, self.page().html()?.as_bytes())?;
        Ok(path)
    }

    fn page(&self) -> Page {
        let [a, b] = self.runs.each_ref().map(|run| run.display());
        let charts = self.charts.iter().map(|(_, chart)| Block::chart(chart.clone()));
        let wall = match self.wall {
            Some([rms, most]) => {
                format!("Wall Cp at the end of the period differs by {rms:.4} (root mean square), {most:.4} at most.")
            }
            None => "The runs have different wall particles.".to_owned(),
        };
        let loads = [Block::Table(self.loads_table()), Block::Text(wall)].into_iter().chain(charts).collect();
        let fields = self.fields.as_ref().map(|differences| fields_blocks(differences));
        Page {
            title: "Comparison".to_owned(),
            lead: Some(format!("a = `{a}`, b = `{b}` (the reference)")),
            sections: vec![
                Section::new("", "Loads", Ok(loads)),
                Section::new("", "Fields", fields.or_else(|why| Ok(vec![Block::Text(why.clone())]))),
                Section::new("", "Cost", Ok(vec![Block::Table(self.costs_table())])),
            ],
            ..Page::default()
        }
    }

    fn loads_table(&self) -> Table {
        let row = |l: &LoadDifference| {
            let [a, b] = l.harmonics.first().copied().unwrap_or_default();
            vec![
                l.name.to_owned(),
                number(l.mean[0]),
                number(l.mean[1]),
                number(a.norm()),
                number(b.norm()),
                percent(a.norm() / b.norm() - 1.0),
                number((a / b).arg().to_degrees()),
                percent(l.e0),
                percent(l.e1),
                percent(l.largest),
            ]
        };
        let columns = [
            "load",
            "mean a",
            "mean b",
            "first harmonic a",
            "first harmonic b",
            "amplitude",
            "phase, degrees",
            "e0",
            "e1",
            "greatest",
        ];
        Table::new(&columns, self.loads.iter().map(row))
    }

    fn costs_table(&self) -> Table {
        let told = |v: f64| if v.is_finite() { number(v) } else { "not counted".to_owned() };
        let cost = self.costs().map(|(name, [a, b])| vec![name.to_owned(), told(a), told(b), told(b / a)]);
        let [a, b] = self.particles.map(grouped);
        let particles = vec!["particles".to_owned(), a, b, String::new()];
        Table::new(&["", "a", "b", "speed-up of a"], cost.into_iter().chain([particles]))
    }
}

fn percent(v: f64) -> String {
    format!("{} %", number(100.0 * v))
}

fn fields_blocks(differences: &[FieldDifference]) -> Vec<Block> {
    let row = |d: &FieldDifference| {
        let sizes = [number(d.rms), percent(d.rms / d.scale), number(d.largest), percent(d.largest / d.scale)];
        [d.quantity.to_owned(), d.at.words()].into_iter().chain(sizes).chain([d.where_it_is()]).collect()
    };
    let columns = ["field", "of", "root mean square", "part", "greatest", "part", "at"];
    let mut blocks = vec![Block::Table(Table::new(&columns, differences.iter().map(row)))];
    if differences.iter().any(|d| d.carried) {
        let text = "The runs have different particles: values of a are carried to those of b by least squares.";
        blocks.push(Block::Text(text.to_owned()));
    }
    let text = "Over the fluid particles; parts are those of half the range of b, for harmonics of the root mean square of \
                that harmonic in b.";
    blocks.push(Block::Text(text.to_owned()));
    blocks
}

/// One load of both runs.
fn difference(load: &Load, runs: &[Finished; 2]) -> Option<LoadDifference> {
    let own = runs.each_ref().map(|run| &run.harmonics["loads"][load.column]);
    let mean = [own[0]["mean"].as_f64()?, own[1]["mean"].as_f64()?];
    let term = |load: &Value, k: usize| {
        let h = &load["harmonics"][k];
        Some(Complex64::new(h["re"].as_f64()?, h["im"].as_f64()?))
    };
    let harmonics: Vec<[Complex64; 2]> = (0..SHOWN).map_while(|k| Some([term(own[0], k)?, term(own[1], k)?])).collect();
    let [a, b] = *harmonics.first()?;
    let [x, y] = runs.each_ref().map(|run| run.period.loops.numbers(load.column));
    let (x, y) = (x?, y?);
    let low = y.iter().copied().fold(f64::INFINITY, f64::min);
    let high = y.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    let differences: Vec<f64> =
        if x.len() == y.len() { x.iter().zip(&y).map(|(a, b)| (a - b).abs()).collect() } else { Vec::new() };
    let half = 0.5 * (high - low);
    let largest = differences.iter().copied().reduce(f64::max).unwrap_or(f64::NAN) / half;
    let square = differences.iter().map(|d| d * d).sum::<f64>() / differences.len() as f64;
    let (e0, e1) = ((mean[0] - mean[1]).abs() / b.norm(), (a - b).norm() / b.norm());
    Some(LoadDifference { name: load.name, mean, harmonics, e0, e1, largest, rms: square.sqrt() / half })
}

/// Differences of the wall pressure where both runs have the same wall particles.
fn walls(runs: &[RunFolder; 2]) -> Option<[f64; 2]> {
    let tables = [runs[0].table("surface.csv").ok()?, runs[1].table("surface.csv").ok()?];
    let column = |name: &str| Some([tables[0].numbers(name)?, tables[1].numbers(name)?]);
    let ([x, y], [cp_a, cp_b]) = (column("x_c")?, column("cp")?);
    let same = x.len() == y.len() && x.iter().zip(&y).all(|(a, b)| (a - b).abs() < 1e-9);
    if !same || x.is_empty() {
        return None;
    }
    let differences: Vec<f64> = cp_a.iter().zip(&cp_b).map(|(a, b)| (a - b).abs()).collect();
    let square = differences.iter().map(|d| d * d).sum::<f64>() / differences.len() as f64;
    Some([square.sqrt(), differences.iter().copied().fold(0.0, f64::max)])
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::report::overview::tests::assert_balanced;

    fn run(folder: &Path, amplitude: f64, (cpu, work): (f64, f64)) {
        std::fs::create_dir_all(folder).unwrap();
        let write = |name: &str, text: &str| std::fs::write(folder.join(name), text).unwrap();
        let load = format!("{{\"mean\":0.1,\"harmonics\":[{{\"re\":0.0,\"im\":-{amplitude}}}]}}");
        write("harmonics.json", &format!("{{\"omega\":2.0,\"loads\":{{\"cl\":{load},\"cd\":{load},\"cm\":{load}}}}}"));
        write("summary.json", &format!("{{\"cpu_seconds\":{cpu},\"particles\":100,\"work_units\":{work}}}"));
        let rows = (0..8).map(|k| {
            let phase = f64::from(k) / 8.0;
            let sine = (phase * std::f64::consts::TAU).sin();
            let load = 0.1 + amplitude * sine;
            format!("{phase},{sine},0,{load},{load},{load}\n")
        });
        write("loops.csv", &format!("phase,angle_deg,shift,cl,cd,cm\n{}", rows.collect::<String>()));
        write("surface.csv", "x_c,cp\n0.1,1\n0.2,0.5\n");
    }

    #[test]
    fn two_runs_are_set_side_by_side() {
        let root = tempfile::tempdir().unwrap();
        let (a, b) = (root.path().join("a"), root.path().join("b"));
        run(&a, 1.01, (2.0, 10.0));
        run(&b, 1.0, (20.0, 40.0));
        let found = Comparison::of(&a, &b).unwrap();
        assert_eq!(found.loads.len(), 3);
        let lift = &found.loads[0];
        assert!((lift.e1 - 0.01).abs() < 1e-12 && lift.e0 == 0.0 && (lift.largest - 0.01).abs() < 1e-12, "{lift:?}");
        assert_eq!(found.wall, Some([0.0, 0.0]));
        let text = found.text();
        let line = |start: &str| {
            let line = text.lines().find(|line| line.starts_with(start)).unwrap();
            line[start.len()..].split_whitespace().map(str::to_owned).collect::<Vec<_>>()
        };
        assert_eq!(line("processor time, s"), ["2.0000", "20.000", "10.000"]);
        assert_eq!(line("work, evaluations of an instance"), ["10.000", "40.000", "4.0000"]);
        assert_eq!(line("wall time, s").join(" "), ["not counted"; 3].join(" "));
        assert!(text.contains(" 1.0000 %"), "{text}");
        assert!(text.contains("\nFields\nthe runs have no field at the same phase\n"), "{text}");
        let csv = found.csv();
        assert!(csv.contains("cost,speed-up in work_units,4,") && csv.contains("cost,wall_seconds,NaN,NaN"), "{csv}");
        let page = std::fs::read_to_string(found.write(&root.path().join("c")).unwrap()).unwrap();
        assert_balanced(&page);
        assert!(root.path().join("c/comparison.csv").is_file());
        let missing = Comparison::of(&a, &root.path().join("nothing")).unwrap_err();
        assert!(missing.contains("nothing") && missing.contains("hint"), "{missing}");
    }
}
