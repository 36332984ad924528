//! Structures alone: steps that `check` expects, runs that are stopped, killed and gone on with, checkpoints that are none of theirs.
use std::path::Path;

use alula::case::{Case, read};
use alula::observe::checkpoint::{self, Array, Checkpoint};
use alula::run::{Monitor, Outcome, Places, SolidReport, Tick, inspect_structure, resume, run};

/// A bar on a wall that is pulled at its end.
fn bar(time: &str, output: &str) -> String {
    format!(
        "[[body]]\nname = \"bar\"\nbox = {{ size = [0.3, 0.1] }}\n[body.solid]\nspacing = 0.025\n\
         material = {{ density = 1000, young = 1e6, poisson = 0.3 }}\nsupport = {{ where = {{ x_max = -0.1499 }} }}\n\
         load = {{ where = {{ x_min = 0.1499 }}, traction = [1e3, 0], history = \"min(t/0.01, 1)\" }}\n\
         probe = [{{ name = \"tip\", at = [0.15, 0] }}]\n{time}\n[output]\nreport = false\n{output}\n"
    )
}

const EXPLICIT: &str = "[time.explicit]\nuntil = 0.02";
const NEWMARK: &str = "[time.newmark]\nstep = 5e-4\nuntil = 0.02";

fn case(text: &str) -> Case {
    read(text, "t").unwrap_or_else(|e| panic!("{e}"))
}

/// Stops a run after so many ticks.
struct Patience {
    left: u32,
}

impl Monitor for Patience {
    fn tick(&mut self, _: &Tick) {
        self.left = self.left.saturating_sub(1);
    }
    fn note(&mut self, _: &str) {}
    fn stop(&self) -> bool {
        self.left == 0
    }
}

/// Runs a case in a folder, for so many ticks.
fn began(text: &str, out: &Path, ticks: u32) -> Outcome {
    let places = Places { input: out.parent().unwrap().to_path_buf(), out: out.to_path_buf() };
    run(&case(text), &places, &mut Patience { left: ticks }).unwrap_or_else(|e| panic!("{e}"))
}

fn gone_on(out: &Path) -> Result<Outcome, String> {
    resume(out, &mut Patience { left: u32::MAX }).map_err(|e| e.to_string())
}

fn file(out: &Path, name: &str) -> String {
    std::fs::read_to_string(out.join(name)).unwrap_or_else(|e| panic!("{name}: {e}"))
}

fn kept(out: &Path) -> Checkpoint<'static> {
    checkpoint::read(&out.join("checkpoint.alula")).unwrap_or_else(|e| panic!("{e}"))
}

/// The case of a run folder becomes this one.
fn put(out: &Path, text: &str) {
    std::fs::write(out.join("case.toml"), text).unwrap();
}

/// The same with a part of it in other words.
fn changed(out: &Path, from: &str, to: &str) {
    let text = file(out, "case.toml");
    assert!(text.contains(from), "no `{from}` in {text}");
    put(out, &text.replace(from, to));
}

#[test]
fn marches_go_on_to_the_same_bits() {
    let folder = tempfile::tempdir().unwrap();
    for (k, time) in [EXPLICIT, NEWMARK].into_iter().enumerate() {
        let [whole, parted] = ["whole", "parted"].map(|name| folder.path().join(format!("{name}-{k}")));
        began(&bar(time, ""), &whole, u32::MAX);
        assert!(matches!(began(&bar(time, ""), &parted, 7), Outcome::Interrupted { .. }));
        assert!(matches!(gone_on(&parted), Ok(Outcome::Structure(_))));
        assert_eq!(file(&whole, "history.csv"), file(&parted, "history.csv"), "{time}");
    }
}

#[test]
fn marches_write_checkpoints_every_so_many_steps() {
    let folder = tempfile::tempdir().unwrap();
    let [often, never] = ["often", "never"].map(|name| folder.path().join(name));
    began(&bar(NEWMARK, "checkpoint = 5"), &often, u32::MAX);
    let step = kept(&often).meta["iteration"].as_u64().unwrap();
    assert!((5..=40).contains(&step), "{step}");
    began(&bar(NEWMARK, "checkpoint = 1000"), &never, u32::MAX);
    assert!(!never.join("checkpoint.alula").exists());
}

#[test]
fn runs_whose_case_became_another_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("out");
    began(&bar(EXPLICIT, ""), &out, 3);
    let original = file(&out, "case.toml");
    for (from, to, word) in [
        ("spacing = 0.025", "spacing = 0.02", "other bodies"),
        ("young = 1000000.0", "young = 2000000.0", "other bodies"),
        ("density = 1000.0", "density = 1100.0", "other bodies"),
        ("name = \"tip\"", "name = \"end\"", "other bodies"),
    ] {
        changed(&out, from, to);
        let refused = gone_on(&out).unwrap_err();
        assert!(refused.contains(word) && refused.contains("hint: "), "{to}: {refused}");
        put(&out, &original);
    }
    let other = alula::case::write(&case(&bar(NEWMARK, "")));
    put(&out, &other);
    let refused = gone_on(&out).unwrap_err();
    assert!(refused.contains("asks for `[time.newmark]`, but the run began with `[time.explicit]`"), "{refused}");
    // how long it goes on may change
    put(&out, &original.replace("until = 0.02", "until = 0.01"));
    assert!(matches!(gone_on(&out), Ok(Outcome::Structure(_))));
}

/// What is told of a checkpoint that was changed.
fn told(out: &Path, change: impl Fn(&mut Checkpoint<'static>)) -> String {
    let good = kept(out);
    let mut bad = good.clone();
    change(&mut bad);
    checkpoint::write(&out.join("checkpoint.alula"), &bad).unwrap();
    let told = gone_on(out).map(|_| ()).expect_err("it went on");
    checkpoint::write(&out.join("checkpoint.alula"), &good).unwrap();
    told
}

/// Changes the numbers of a field.
fn of(name: &'static str, change: impl Fn(&mut Vec<f64>)) -> impl Fn(&mut Checkpoint<'static>) {
    move |file| {
        let field = file.fields.iter_mut().find(|f| f.name == name).unwrap();
        let Array::F64(numbers) = &mut field.data else { panic!("`{name}` holds no numbers") };
        change(numbers.to_mut());
        field.shape = vec![numbers.len()];
    }
}

#[test]
fn checkpoints_with_numbers_that_no_run_writes_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    for (k, time) in [EXPLICIT, NEWMARK].into_iter().enumerate() {
        let out = folder.path().join(format!("{k}"));
        began(&bar(time, ""), &out, 3);
        let wrong =
            |word: &str, told: String| assert!(told.contains(word) && told.contains("hint: "), "{word}: {told}");
        wrong("its state is of another structure", told(&out, of("state", |v| v.truncate(v.len() - 1))));
        wrong("its forces are of another structure", told(&out, of("before", |v| v.truncate(3))));
        wrong("its history has other probes", told(&out, of("history", |v| v.push(0.0))));
        wrong("its clock is broken", told(&out, of("clock", |v| v.push(0.0))));
        wrong("its clock does not run forwards", told(&out, of("clock", |v| v[0] = -1.0)));
        for name in ["state", "before", "clock", "history"] {
            for bad in [f64::NAN, f64::INFINITY] {
                wrong("not a finite number", told(&out, of(name, |v| v[0] = bad)));
            }
        }
        wrong("it does not say how far it came", told(&out, |file| file.meta["iteration"] = (1u64 << 40).into()));
        wrong("another kind of study", told(&out, |file| file.meta["kind"] = "periodic".into()));
        assert!(told(&out, |file| file.fields.truncate(1)).contains("has no field"));
        // what it does not say of itself is not believed
        let without = |lost: &'static str| {
            move |file: &mut Checkpoint<'static>| file.meta.as_object_mut().unwrap().retain(|name, _| name != lost)
        };
        wrong("other bodies or contact", told(&out, without("equations")));
        wrong("the run began with `[time.another]`", told(&out, without("method")));
        // numbers of several places contradict one another
        let lead = "its history does not lead to its state";
        for k in 3..6 {
            wrong(lead, told(&out, of("clock", move |v| v[k] += 1.0)));
        }
        for forged in [1e300, 1e-300] {
            wrong(lead, told(&out, of("clock", move |v| v[0] = forged)));
        }
        wrong(lead, told(&out, of("state", |v| v[5] += 1e-3)));
        wrong(lead, told(&out, of("history", Vec::clear)));
        wrong(lead, told(&out, |file| file.meta["iteration"] = 1_000_000.into()));
        wrong("its history does not run forwards", told(&out, of("history", |v| v.fill(7.5))));
        assert!(gone_on(&out).is_ok());
    }
    let out = folder.path().join("explicit");
    began(&bar(EXPLICIT, ""), &out, 3);
    assert!(told(&out, of("clock", |v| v[2] = 0.0)).contains("does not run forwards"));
    for k in 1..3 {
        assert!(told(&out, of("clock", move |v| v[k] = 1e300)).contains("its steps are longer"));
    }
}

#[test]
fn searches_for_periodic_motions_go_on_from_checkpoints_of_their_own() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("out");
    let time = "[time.harmonics]\nnumber = 3\nfrequency = \"2 Hz\"\norders = 10";
    let text = bar(time, "").replace("min(t/0.01, 1)", "cos(omega * t)");
    if !matches!(began(&text, &out, 1), Outcome::Interrupted { .. }) {
        panic!("it was found at once");
    }
    let wrong = |word: &str, told: String| assert!(told.contains(word), "{word}: {told}");
    wrong("more harmonics than the case asks for", told(&out, |file| file.meta["harmonics"] = 4_000_000_000u64.into()));
    wrong("it is of another structure", told(&out, of("start", |v| v.truncate(v.len() - 1))));
    wrong("its parts of the load are none", told(&out, of("parts", |v| v[1] = 2.0)));
    wrong("not a finite number", told(&out, of("state", |v| v[0] = f64::NAN)));
    wrong("another kind of study", told(&out, |file| file.meta["kind"] = "structure".into()));
    assert!(matches!(gone_on(&out), Ok(Outcome::Structure(_))));
}

#[test]
fn a_march_that_breaks_off_leaves_numbers_that_a_later_one_goes_on_from() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("out");
    let text = bar(EXPLICIT, "").replace("traction = [1e3, 0]", "traction = [-1e9, 0]");
    let places = Places { input: folder.path().to_path_buf(), out: out.clone() };
    let broken = run(&case(&text), &places, &mut Patience { left: u32::MAX }).unwrap_err().to_string();
    assert!(broken.contains("the last good state is in"), "{broken}");
    let again = gone_on(&out).unwrap_err();
    assert!(again.contains("the last good state is in"), "{again}");
}

/// What is told of the march of a bar that is squeezed, and its number of steps were they as long as the first one.
fn squeezed(until: f64, through: u32, velocity: f64) -> (SolidReport, f64) {
    let text = format!(
        "[[body]]\nname = \"bar\"\nbox = {{ size = [0.02, 0.01] }}\n[body.solid]\nthrough = {through}\n\
         material = {{ density = 8930, young = 117e9, poisson = 0.35, yield = 4e8, hardening = 1e8 }}\n\
         velocity = [\"{velocity} * x\", \"0\"]\n[time.explicit]\nuntil = {until}\ncfl = 0.5\n"
    );
    let report = inspect_structure(&case(&text), Path::new("")).unwrap_or_else(|e| panic!("{e}"));
    let at_rest = until / (0.5 * report.stable_step);
    (report, at_rest)
}

#[test]
fn steps_of_a_body_that_is_squeezed_are_those_that_it_takes() {
    let (slow, at_rest) = squeezed(2e-6, 5, -1.0);
    assert!(!slow.more_steps && (slow.steps.unwrap() / at_rest - 1.0).abs() < 0.2, "{slow:?} {at_rest}");
    // squeezed to a third of its length
    let (fast, at_rest) = squeezed(2e-5, 5, -40_000.0);
    assert!(fast.steps.unwrap() > 1.2 * at_rest, "{fast:?} {at_rest}");
}

#[test]
fn a_march_without_end_has_at_least_so_many_steps() {
    let (endless, at_rest) = squeezed(1e3, 9, -1.0);
    assert!(endless.more_steps && endless.steps.unwrap() >= 0.99 * at_rest, "{endless:?} {at_rest}");
}

#[test]
fn very_large_bodies_are_looked_at_with_fewer_particles() {
    let of = |spacing: &str| {
        let text = bar(EXPLICIT, "").replace("spacing = 0.025", &format!("spacing = {spacing}"));
        inspect_structure(&case(&text), Path::new("")).unwrap()
    };
    let (large, small) = (of("0.0005"), of("0.0025"));
    assert_eq!((large.particles, small.particles), (601 * 201, 121 * 41));
    assert!(large.seen_on.is_some_and(|factor| factor > 1.0) && small.seen_on.is_none());
    assert!(
        (large.mass / small.mass - 1.0).abs() < 1e-9
            && (5.0 * large.stable_step / small.stable_step - 1.0).abs() < 0.05
    );
    assert!(large.bytes > small.bytes && large.seconds > small.seconds, "{large:?} {small:?}");
}
