//! What a run says while it computes.
//!
//! On a terminal: one line that is drawn over, with the history of the residual as a sparkline. In a pipe: plain lines,
//! at most one a second, and one whenever the residual has fallen by two more orders. With `--json`: one object an
//! iteration. Text goes to stderr, JSON to stdout; a reader that goes away silences the progress, never the run. Lines begin with the time
//! left of the whole run and have at most 80 columns, on narrow terminals what fits: what matters least is left out.
use std::io::{self, IsTerminal, Write};
use std::time::{Duration, Instant};

use alula::math::digits::fixed;
use alula::run::MarchTick;
use indicatif::{ProgressBar, ProgressStyle};
use serde_json::{Value, json};

use crate::arguments::Verbosity;
use crate::output::{event_line, message};

/// Least time between two plain lines.
const LINE_INTERVAL: Duration = Duration::from_secs(1);
/// Orders of magnitude that earn a plain line of their own.
const LINE_ORDERS: f64 = 2.0;
/// Greatest number of values behind the sparkline, twice its width.
const HISTORY: usize = 2 * SPARKS;
/// How often the sign before the line turns while nothing else is told.
const TURN: Duration = Duration::from_millis(200);
/// Width of the sparkline.
const SPARKS: usize = 16;

/// Columns of a plain line at most, and of a terminal whose width is not known.
const COLUMNS: usize = 80;
/// What a terminal shows before the line: a sign that turns, and a space.
const BEFORE: usize = 2;

/// Time left of the whole run.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Left {
    /// Seconds.
    pub(crate) seconds: f64,
    /// The run may end before, when the loads are known well enough.
    pub(crate) at_most: bool,
}

/// What is known after an iteration.
#[derive(Clone, Debug)]
pub(crate) struct Tick {
    /// Iterations so far.
    pub(crate) iteration: u64,
    /// Orders of magnitude the residual has fallen.
    pub(crate) orders: f64,
    /// Norm of the residual.
    pub(crate) residual: f64,
    /// Courant number.
    pub(crate) cfl: f64,
    /// Coefficients of lift, drag and moment.
    pub(crate) loads: Option<[f64; 3]>,
    /// Iterations a second.
    pub(crate) rate: f64,
    /// Number of particles.
    pub(crate) particles: usize,
    /// Time left, as far as one can tell.
    pub(crate) left: Option<Left>,
    /// Where a march stands.
    pub(crate) march: Option<MarchTick>,
    /// Present point of a polar from 0, and their number.
    pub(crate) point: Option<[usize; 2]>,
}

/// Tells the progress of a run.
pub(crate) struct Progress {
    voice: Voice,
    started: Instant,
    throttle: Throttle,
    history: History,
    /// The last tick, as long as it has not been told.
    untold: Option<Tick>,
}

enum Voice {
    Silent,
    Bar(ProgressBar),
    Lines(Box<dyn Write + Send>),
    Json(Box<dyn Write + Send>),
}

impl Progress {
    /// The voice that suits the arguments and the terminal.
    pub(crate) fn new(verbosity: Verbosity) -> Self {
        if verbosity.json {
            return Self::json(Box::new(io::stdout()));
        }
        if verbosity.quiet {
            return Self::with(Voice::Silent);
        }
        if io::stderr().is_terminal() {
            let style = ProgressStyle::with_template("{spinner} {wide_msg}");
            let style = style.unwrap_or_else(|_| ProgressStyle::default_spinner());
            return Self::with(Voice::Bar(ProgressBar::new_spinner().with_style(style)));
        }
        Self::lines(Box::new(io::stderr()))
    }

    /// Plain lines into `sink`.
    pub(crate) fn lines(sink: Box<dyn Write + Send>) -> Self {
        Self::with(Voice::Lines(sink))
    }

    /// JSON lines into `sink`.
    pub(crate) fn json(sink: Box<dyn Write + Send>) -> Self {
        Self::with(Voice::Json(sink))
    }

    fn with(voice: Voice) -> Self {
        let (throttle, history) = (Throttle::default(), History::default());
        Self { voice, started: Instant::now(), throttle, history, untold: None }
    }

    /// Tells an iteration.
    pub(crate) fn tick(&mut self, tick: &Tick) {
        match &self.voice {
            Voice::Silent => {}
            Voice::Json(_) => self.event("iteration", fields(tick)),
            Voice::Bar(bar) => {
                self.history.push(tick.residual);
                bar.set_message(bar_text(tick, &self.history, columns_of_terminal()));
                bar.tick();
            }
            Voice::Lines(_) if self.throttle.due(self.started.elapsed(), tick.orders) => {
                self.untold = None;
                self.say(&line_text(tick));
            }
            Voice::Lines(_) => self.untold = Some(tick.clone()),
        }
    }

    /// Tells what begins that has no iterations.
    pub(crate) fn doing(&mut self, what: &str, left: Option<Left>) {
        match &self.voice {
            Voice::Silent => {}
            Voice::Json(_) => self.event("doing", json!({ "message": what, "eta": left.map(|l| l.seconds) })),
            Voice::Bar(bar) => {
                bar.set_message(fitted(&[(0, left_text(left)), (1, what.to_owned())], columns_of_terminal()));
                bar.enable_steady_tick(TURN);
            }
            Voice::Lines(_) => {
                self.untold = None;
                self.say(&fitted(&[(0, left_text(left)), (0, what.to_owned())], COLUMNS));
            }
        }
    }

    /// Tells something else: an object `{"event": name, ...}` with `--json`, nothing otherwise.
    pub(crate) fn event(&mut self, name: &str, fields: Value) {
        if matches!(self.voice, Voice::Json(_)) {
            self.say(&event_line(name, fields));
        }
    }

    /// Tells a sentence: above the line that is drawn over, or as an event `note`; nothing with `--quiet`.
    pub(crate) fn note(&mut self, text: &str) {
        self.sentence("note", text, text);
    }

    /// Tells what makes results doubtful: as a note with that word, or as an event `warning`.
    pub(crate) fn warn(&mut self, text: &str) {
        self.sentence("warning", text, &format!("warning: {text}"));
    }

    fn sentence(&mut self, event: &str, text: &str, for_people: &str) {
        match &self.voice {
            Voice::Bar(bar) => bar.suspend(|| message(&wrapped(for_people, width_of_terminal()))),
            Voice::Lines(_) => self.say(for_people),
            Voice::Json(_) => self.event(event, json!({ "message": text })),
            Voice::Silent => {}
        }
    }

    /// What leaves the line from another thread.
    pub(crate) fn leaving(&self) -> impl Fn() + Send + 'static + use<> {
        let bar = if let Voice::Bar(bar) = &self.voice { Some(bar.clone()) } else { None };
        move || {
            if let Some(bar) = &bar {
                bar.abandon();
            }
        }
    }

    /// Tells the last iteration and leaves the line.
    pub(crate) fn finish(&mut self) {
        if let Some(tick) = self.untold.take() {
            self.say(&line_text(&tick));
        }
        if let Voice::Bar(bar) = &self.voice {
            bar.abandon();
        }
    }

    /// Writes a line; a closed pipe silences everything that follows.
    fn say(&mut self, text: &str) {
        let (Voice::Lines(sink) | Voice::Json(sink)) = &mut self.voice else { return };
        if writeln!(sink, "{text}").and_then(|()| sink.flush()).is_err() {
            self.voice = Voice::Silent;
        }
    }
}

fn fields(tick: &Tick) -> Value {
    json!({
        "iteration": tick.iteration,
        "orders": tick.orders,
        "residual": tick.residual,
        "cfl": tick.cfl,
        "loads": tick.loads,
        "rate": tick.rate,
        "particles": tick.particles,
        "eta": tick.left.map(|left| left.seconds),
    })
}

/// The texts that fit into so many columns, in their order: those with the highest numbers are left out first.
fn fitted(texts: &[(u8, String)], columns: usize) -> String {
    let mut kept: Vec<&(u8, String)> = texts.iter().filter(|t| !t.1.is_empty()).collect();
    loop {
        let line = kept.iter().map(|t| t.1.as_str()).collect::<Vec<_>>().join("  ");
        let least = kept.iter().enumerate().max_by_key(|(_, t)| t.0);
        match least.filter(|(_, t)| t.0 > 0) {
            Some((k, _)) if line.chars().count() > columns => drop(kept.remove(k)),
            _ => return line,
        }
    }
}

/// Columns of the terminal.
fn width_of_terminal() -> usize {
    console::Term::stderr().size_checked().map_or(COLUMNS, |(_, columns)| usize::from(columns))
}

/// Columns of the terminal that are left for a line.
fn columns_of_terminal() -> usize {
    width_of_terminal().min(COLUMNS).saturating_sub(BEFORE)
}

/// The text in lines of so many columns, where words allow it; lines that go on are indented.
fn wrapped(text: &str, columns: usize) -> String {
    const INDENT: &str = "  ";
    let mut lines: Vec<String> = Vec::new();
    for line in text.lines() {
        let mut now = String::new();
        for word in line.split(' ') {
            let length = now.chars().count();
            if !now.trim_start().is_empty() && length + 1 + word.chars().count() > columns {
                lines.push(std::mem::replace(&mut now, INDENT.to_owned() + word));
            } else {
                now += if length == 0 { "" } else { " " };
                now += word;
            }
        }
        lines.push(now);
    }
    lines.join("\n")
}

/// What is left of the whole run.
fn left_text(left: Option<Left>) -> String {
    match left {
        Some(Left { seconds, at_most }) if seconds.is_finite() && seconds >= 0.0 => {
            format!("{}{} left", if at_most { "≤ " } else { "" }, clock(seconds))
        }
        _ => "–:–– left".to_owned(),
    }
}

/// Lift, drag and moment, in the order in which they are left out from behind.
fn loads_texts(tick: &Tick) -> Vec<(u8, String)> {
    let Some([lift, drag, moment]) = tick.loads else { return Vec::new() };
    vec![
        (1, format!("CL {}", fixed(lift, 4))),
        (3, format!("CD {}", fixed(drag, 4))),
        (5, format!("CM {}", fixed(moment, 4))),
    ]
}

/// A march.
fn march_texts(march: &MarchTick, tick: &Tick) -> Vec<(u8, String)> {
    let way = match march.period {
        Some(period) => {
            let all = march.until / period;
            let decimals = if (all - all.round()).abs() < 5e-3 { 0 } else { 2 };
            format!("period {:.2} of {all:.decimals$}", march.time / period)
        }
        None => format!("to t {}", short(march.until)),
    };
    let mut texts = vec![(0, left_text(tick.left)), (2, way), (1, format!("t {}", short(march.time)))];
    texts.extend(march.angle.map(|angle| (4, format!("α {}°", fixed(angle.to_degrees(), 2)))));
    if let Some([lift, ..]) = tick.loads {
        let before = march.lift_before.map_or_else(String::new, |lift| format!(" (before {})", fixed(lift, 4)));
        texts.push((3, format!("CL {}{before}", fixed(lift, 4))));
    }
    texts
}

/// A time with four digits.
fn short(time: f64) -> String {
    let decimals = (3.0 - time.abs().max(f64::MIN_POSITIVE).log10().floor()).clamp(0.0, 8.0) as usize;
    if time.abs() < 1e6 { format!("{time:.decimals$}") } else { format!("{time:.3e}") }
}

/// Which point of a polar the line is about.
fn point_text(tick: &Tick) -> String {
    tick.point.map_or_else(String::new, |[point, all]| format!("point {} of {all}", point + 1))
}

fn line_text(tick: &Tick) -> String {
    if let Some(march) = &tick.march {
        return fitted(&march_texts(march, tick), COLUMNS);
    }
    let mut texts = vec![
        (0, left_text(tick.left)),
        (1, point_text(tick)),
        (0, format!("iteration {:>5}", tick.iteration)),
        (2, format!("residual {:.1e}", tick.residual)),
    ];
    texts.extend(loads_texts(tick));
    texts.push((6, format!("cfl {:.0e}", tick.cfl)));
    fitted(&texts, COLUMNS)
}

fn bar_text(tick: &Tick, history: &History, columns: usize) -> String {
    if let Some(march) = &tick.march {
        return fitted(&march_texts(march, tick), columns);
    }
    let mut texts = vec![
        (0, left_text(tick.left)),
        (1, point_text(tick)),
        (0, tick.iteration.to_string()),
        (4, history.sparkline()),
        (2, format!("{:.1e}", tick.residual)),
    ];
    texts.extend(loads_texts(tick));
    texts.extend([(6, rate(tick)), (7, format!("{} particles", tick.particles)), (8, format!("cfl {:.0e}", tick.cfl))]);
    fitted(&texts, columns)
}

fn rate(tick: &Tick) -> String {
    if tick.rate >= 10.0 { format!("{:.0}/s", tick.rate) } else { format!("{:.2}/s", tick.rate) }
}

/// Seconds as `0:42` or `1:02:03`.
fn clock(seconds: f64) -> String {
    let s = seconds.round() as u64;
    let (hours, minutes, seconds) = (s / 3600, s / 60 % 60, s % 60);
    if hours > 0 { format!("{hours}:{minutes:02}:{seconds:02}") } else { format!("{minutes}:{seconds:02}") }
}

/// Decides which iterations earn a plain line.
#[derive(Default)]
struct Throttle {
    last: Option<Duration>,
    step: f64,
}

impl Throttle {
    fn due(&mut self, now: Duration, orders: f64) -> bool {
        let step = (orders / LINE_ORDERS).floor();
        let fell = step > self.step;
        if self.last.is_some_and(|last| now.saturating_sub(last) < LINE_INTERVAL) && !fell {
            return false;
        }
        self.last = Some(now);
        self.step = if fell { step } else { self.step };
        true
    }
}

/// Logarithms of the residual; when the memory is full every second value goes and the stride doubles.
struct History {
    values: Vec<f64>,
    stride: usize,
    skipped: usize,
}

impl Default for History {
    fn default() -> Self {
        Self { values: Vec::with_capacity(HISTORY), stride: 1, skipped: 0 }
    }
}

impl History {
    fn push(&mut self, residual: f64) {
        self.skipped += 1;
        if self.skipped < self.stride || !residual.is_finite() || residual <= 0.0 {
            return;
        }
        self.skipped = 0;
        if self.values.len() == HISTORY {
            let mut keep = false;
            self.values.retain(|_| {
                keep = !keep;
                keep
            });
            self.stride *= 2;
        }
        self.values.push(residual.log10());
    }

    fn sparkline(&self) -> String {
        const BARS: [char; 8] = ['▁', '▂', '▃', '▄', '▅', '▆', '▇', '█'];
        let n = self.values.len();
        let top = self.values.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        let floor = self.values.iter().copied().fold(f64::INFINITY, f64::min);
        let width = n.min(SPARKS);
        let bar = |i: usize| {
            let height = (self.values[i * n / width] - floor) / (top - floor).max(f64::MIN_POSITIVE);
            BARS[((height * 7.0).round() as usize).min(7)]
        };
        (0..width).map(bar).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::{Arc, Mutex};

    #[derive(Clone, Default)]
    struct Page(Arc<Mutex<Vec<u8>>>);

    impl Page {
        fn text(&self) -> String {
            String::from_utf8(self.0.lock().unwrap().clone()).unwrap()
        }
    }

    impl Write for Page {
        fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
            self.0.lock().unwrap().extend_from_slice(bytes);
            Ok(bytes.len())
        }
        fn flush(&mut self) -> io::Result<()> {
            Ok(())
        }
    }

    fn tick(iteration: u64, orders: f64) -> Tick {
        Tick {
            iteration,
            orders,
            residual: 10_f64.powf(-orders),
            cfl: 100.0,
            loads: Some([0.35, 0.022, -0.04]),
            rate: 8.1,
            particles: 20_000,
            left: Some(Left { seconds: 3723.0, at_most: false }),
            march: None,
            point: None,
        }
    }

    #[test]
    fn sentences_are_wrapped_at_words() {
        let point =
            "point 1 of 7: M 0.4, alpha -3 deg: CL -0.41143 ± 0.00165, CD 0.00006 ± 0.00018, CM 0.00585 ± 0.00012";
        assert_eq!(wrapped(point, 200), point);
        let lines = wrapped(point, 80);
        assert!(lines.lines().count() == 2 && lines.lines().all(|l| l.chars().count() <= 80), "{lines}");
        assert_eq!(lines.replace("\n  ", " "), point);
        assert_eq!(wrapped("a longword b\nnext", 6), "a\n  longword\n  b\nnext");
    }

    #[test]
    fn a_march_tells_what_is_left_in_eighty_columns() {
        let march = MarchTick {
            time: 123.456,
            until: 216.1,
            period: Some(54.03),
            angle: Some(-0.0178),
            lift_before: Some(-0.28611),
        };
        let told = line_text(&Tick { march: Some(march), ..tick(700, 5.0) });
        assert_eq!(told, "1:02:03 left  period 2.28 of 4  t 123.5  α -1.02°  CL 0.3500 (before -0.2861)");
        assert!(told.chars().count() <= 80, "{}", told.chars().count());
        let free = MarchTick { period: None, angle: None, lift_before: None, ..march };
        let told = line_text(&Tick { march: Some(free), left: None, ..tick(7, 5.0) });
        assert_eq!(told, "–:–– left  to t 216.1  t 123.5  CL 0.3500");
    }

    #[test]
    fn lines_fit_into_terminals_of_any_width_and_begin_with_the_time_left() {
        let left = Some(Left { seconds: 36_000.0, at_most: true });
        let polar = Tick { point: Some([121, 312]), left, iteration: 123_456, ..tick(1, 5.0) };
        let march = MarchTick {
            time: -1.2345e7,
            until: 2.1610e7,
            period: Some(54.03),
            angle: Some(-0.5),
            lift_before: Some(-0.28611),
        };
        let marched = Tick { march: Some(march), ..polar.clone() };
        let mut history = History::default();
        (0..100).for_each(|i| history.push(10_f64.powf(-f64::from(i) / 10.0)));
        for columns in [78, 58, 38] {
            for tick in [&polar, &marched] {
                let told = bar_text(tick, &history, columns);
                assert!(told.chars().count() <= columns && told.starts_with("≤ 10:00:00 left  "), "{columns}: {told}");
            }
        }
        assert!(bar_text(&polar, &history, 58).contains("point 122 of 312  123456  "));
        assert!([&polar, &marched].iter().all(|tick| line_text(tick).chars().count() <= COLUMNS));
        let building = fitted(&[(0, left_text(left)), (1, "building the cloud".into())], 58);
        assert_eq!(building, "≤ 10:00:00 left  building the cloud");
    }

    #[test]
    fn json_tells_every_iteration() {
        let page = Page::default();
        let mut progress = Progress::json(Box::new(page.clone()));
        progress.event("start", json!({ "case": "a" }));
        progress.tick(&tick(1, 0.0));
        progress.tick(&Tick { residual: f64::NAN, loads: None, ..tick(2, 0.1) });
        progress.note("for all");
        progress.warn("doubtful");
        progress.finish();
        let lines: Vec<Value> = page.text().lines().map(|l| serde_json::from_str(l).unwrap()).collect();
        assert_eq!(lines.len(), 5);
        assert_eq!(lines[3], json!({ "event": "note", "message": "for all" }));
        assert_eq!(lines[4], json!({ "event": "warning", "message": "doubtful" }));
        assert_eq!(lines[0], json!({ "event": "start", "case": "a" }));
        assert_eq!((&lines[1]["event"], &lines[1]["loads"][1]), (&json!("iteration"), &json!(0.022)));
        assert_eq!((&lines[2]["residual"], &lines[2]["loads"]), (&Value::Null, &Value::Null));
    }

    #[test]
    fn lines_are_few_and_end_with_the_last_iteration() {
        let page = Page::default();
        let mut progress = Progress::lines(Box::new(page.clone()));
        for i in 0..=50 {
            progress.tick(&tick(i, i as f64 / 10.0));
        }
        progress.finish();
        progress.finish();
        let text = page.text();
        let told: Vec<&str> = text.lines().map(|l| l.split_whitespace().nth(3).unwrap()).collect();
        assert_eq!(told, ["0", "20", "40", "50"]);
        assert!(
            text.ends_with("1:02:03 left  iteration    50  residual 1.0e-5  CL 0.3500  CD 0.0220  CM -0.0400\n"),
            "{text}"
        );
    }

    #[test]
    fn lines_come_once_a_second() {
        let mut throttle = Throttle::default();
        let told = (0..40).filter(|i| throttle.due(Duration::from_millis(100 * i), 0.0)).count();
        assert_eq!(told, 4);
    }

    #[test]
    fn a_reader_that_goes_away_silences_the_progress() {
        struct Closed(Arc<Mutex<usize>>);
        impl Write for Closed {
            fn write(&mut self, _: &[u8]) -> io::Result<usize> {
                *self.0.lock().unwrap() += 1;
                Err(io::ErrorKind::BrokenPipe.into())
            }
            fn flush(&mut self) -> io::Result<()> {
                Ok(())
            }
        }
        let tries = Arc::new(Mutex::new(0));
        let mut progress = Progress::json(Box::new(Closed(Arc::clone(&tries))));
        progress.tick(&tick(1, 0.0));
        progress.tick(&tick(2, 0.0));
        assert_eq!(*tries.lock().unwrap(), 1);
    }

    #[test]
    fn sparkline_falls_with_the_residual() {
        let mut history = History::default();
        assert_eq!(history.sparkline(), "");
        for i in 0..1000 {
            history.push(10_f64.powf(-f64::from(i) / 100.0));
            assert!(history.sparkline().chars().count() <= SPARKS);
        }
        let sparks: Vec<char> = history.sparkline().chars().collect();
        assert_eq!((sparks[0], sparks.len()), ('█', SPARKS));
        assert!(sparks.windows(2).all(|pair| pair[1] <= pair[0]));
        history.push(f64::NAN);
        let told = bar_text(&tick(9, 3.0), &history, 78);
        assert!(
            told.starts_with("1:02:03 left  9  █") && told.ends_with("1.0e-3  CL 0.3500  CD 0.0220  CM -0.0400"),
            "{told}"
        );
    }
}
