//! Contradictions in motion and viscosity.
use serde_json::Value;

use super::draft::Draft;
use super::facts::{FREQUENCIES, formula, has_gas, is_dimensional, is_shaken, says_something};

const PARTS: [&str; 7] = ["pitch", "plunge", "rotation", "translation", "table", "formula", "mode"];
/// The parts that make a body turn, and where in the table.
const TURNS: [&str; 4] = ["pitch", "rotation", "table.angle", "formula.angle"];
const COLUMNS: [&str; 4] = ["x", "y", "z", "angle"];

/// Walls hotter than this, over the free stream, are kelvin taken for a ratio.
const HOTTEST: f64 = 50.0;

/// Looks for contradictions in `[motion]`, in the motions of bodies, and between motion and time.
pub(super) fn contradictions(draft: &mut Draft<'_>, dimension: Option<usize>) {
    let mut laws = vec!["motion".to_owned()];
    laws.extend((0..draft.count("body")).map(|i| format!("body[{i}].motion")));
    laws.retain(|law| draft.given(law));
    for law in &laws {
        frequency(draft, law);
        dimensional(draft, law);
        turning(draft, law, dimension);
        table(draft, law);
        formulas(draft, law);
        flexible(draft, law);
        if let Some(d) = dimension {
            in_dimension(draft, law, d);
        }
    }
    together(draft);
    in_time(draft, &laws);
}

/// One frequency, with what it needs, where something asks for it.
fn frequency(draft: &mut Draft<'_>, law: &str) {
    let given: Vec<_> = FREQUENCIES.into_iter().filter(|f| draft.given(&format!("{law}.{f}"))).collect();
    if let [first, .., last] = given[..] {
        let message = format!("the frequency is given twice, as `{first}` and as `{last}`");
        draft.fail_key(&format!("{law}.{last}"), message).hint("keep one; the others follow from it");
    }
    let own = |part: &str| {
        let path = format!("{law}.{part}");
        (0..draft.count(&path)).any(|i| draft.given(&format!("{path}[{i}].reduced_frequency")))
    };
    let reduced = draft.given(&format!("{law}.reduced_frequency"));
    let needs_length = reduced || own("pitch") || own("plunge");
    let length = format!("{law}.reduced_length");
    if draft.given(&length) && !needs_length {
        let hint = "add `reduced_frequency`, or remove the length";
        draft.fail_key(&length, "`reduced_length` without `reduced_frequency`").hint(hint);
    }
    if reduced {
        let place = format!("{law}.reduced_frequency");
        if !draft.given("flow.mach") && !draft.given("flow.velocity") {
            let hint = "add `mach` to `[flow]`, or give `period`";
            draft.fail_key(&place, "a reduced frequency needs the speed of the free stream").hint(hint);
        }
        if !draft.given(&length) && !draft.given("body") && !draft.given("reference.chord") {
            let message = "without a body a reduced frequency needs its length";
            draft.fail_key(&place, message).hint("add `reduced_length`");
        }
    }
    own_frequencies(draft, law);
    if has_frequency(draft, law) {
        return;
    }
    let hint = "add `reduced_frequency = 0.1`, `frequency = \"5 Hz\"` or `period = 20`";
    for part in ["pitch", "plunge", "mode"].map(|part| format!("{law}.{part}")) {
        let alone = (0..draft.count(&part)).any(|i| own_keys(draft, &format!("{part}[{i}]")).is_empty());
        if says_something(draft, &part) && alone {
            draft.fail_key(&part, format!("`{part}` has no frequency")).hint(hint);
        }
    }
}

/// The keys that give a part a frequency of its own.
fn own_keys(draft: &Draft<'_>, part: &str) -> Vec<&'static str> {
    FREQUENCIES.into_iter().filter(|f| draft.given(&format!("{part}.{f}"))).collect()
}

/// Parts of a motion have one frequency each.
fn own_frequencies(draft: &mut Draft<'_>, law: &str) {
    let parts = ["pitch", "plunge"].map(|part| format!("{law}.{part}"));
    let all: Vec<String> =
        parts.iter().flat_map(|p| (0..draft.count(p)).map(|i| format!("{p}[{i}]")).collect::<Vec<_>>()).collect();
    for part in all {
        let given = own_keys(draft, &part);
        if let [first, .., last] = given[..] {
            let message = format!("the frequency is given twice, as `{first}` and as `{last}`");
            draft.fail_key(&format!("{part}.{last}"), message).hint("keep one; the others follow from it");
        }
        let reduced = format!("{part}.reduced_frequency");
        if draft.given(&reduced) && !draft.given("flow.mach") && !draft.given("flow.velocity") {
            let hint = "add `mach` to `[flow]`, or give `period`";
            draft.fail_key(&reduced, "a reduced frequency needs the speed of the free stream").hint(hint);
        }
        for key in ["frequency", "period"].map(|key| format!("{part}.{key}")) {
            if draft.has_unit(&key) && !is_dimensional(draft) {
                let message = format!("`{key}` has a unit of time, but the free stream is nondimensional");
                let hint = "use `reduced_frequency` or a plain `period`, or give two of `pressure`, `temperature` and `density` in \
                            `[flow]`";
                draft.fail(&key, message).hint(hint);
            }
        }
    }
}

/// True when some part of the motion repeats with a frequency of its own.
fn has_own_frequency(draft: &Draft<'_>, law: &str) -> bool {
    ["pitch", "plunge"].iter().any(|part| {
        let path = format!("{law}.{part}");
        (0..draft.count(&path)).any(|i| !own_keys(draft, &format!("{path}[{i}]")).is_empty())
    })
}

/// A frequency of its own, or that of `[motion]`.
fn has_frequency(draft: &Draft<'_>, law: &str) -> bool {
    [law, "motion"].iter().any(|l| FREQUENCIES.iter().any(|f| draft.given(&format!("{l}.{f}"))))
}

/// Units of time make sense only when the free stream has units.
fn dimensional(draft: &mut Draft<'_>, law: &str) {
    if is_dimensional(draft) {
        return;
    }
    let hint = "give two of `pressure`, `temperature` and `density` in `[flow]`";
    let keys = [
        ("frequency", "", "`reduced_frequency` or a plain `period`"),
        ("period", "", "a plain number, in units of length over sound speed"),
        ("rotation", ".rate", "a plain number, in radians per unit of time"),
        ("translation", ".velocity", "plain numbers, in units of the sound speed"),
        ("table.time", "", "plain numbers, in units of length over sound speed"),
    ];
    for (key, inner, instead) in keys {
        let full = format!("{law}.{key}{inner}");
        // a part may be written as its value alone
        let path = if draft.given(&full) { full } else { format!("{law}.{key}") };
        if draft.has_unit(&path) {
            let message = format!("`{path}` has a unit of time, but the free stream is nondimensional");
            draft.fail(&path, message).hint(format!("use {instead}, or {hint}"));
        }
    }
}

/// What turns has a pivot, and an axis only what turns.
fn turning(draft: &mut Draft<'_>, law: &str, dimension: Option<usize>) {
    let turns = TURNS.map(|part| format!("{law}.{part}"));
    let turn = turns.iter().find(|part| says_something(draft, part)).cloned();
    match turn {
        Some(part) if !draft.given(&format!("{law}.pivot")) => {
            let message = format!("`{part}` turns about no point: `{law}.pivot` is missing");
            draft.fail_key(&part, message).hint("add `pivot = [0.25, 0]`, the place of the axis before any motion");
        }
        None if draft.given(&format!("{law}.axis")) && dimension != Some(2) => {
            draft.fail_key(&format!("{law}.axis"), "an axis, but nothing turns").hint("remove it");
        }
        _ => {}
    }
    let mut lengths = vec![(format!("{law}.axis"), "an axis")];
    lengths.extend(directions(draft, law).map(|path| (path, "a direction")));
    for (path, what) in lengths {
        if draft.numbers(&path).is_some_and(|v| v.iter().all(|c| *c == 0.0)) {
            draft.fail(&path, format!("`{path}` is {what} of no length")).hint("give at least one component");
        }
    }
}

/// Directions of the parts of a plunge.
fn directions(draft: &Draft<'_>, law: &str) -> impl Iterator<Item = String> + use<> {
    let path = format!("{law}.plunge");
    (0..draft.count(&path)).map(move |i| format!("{path}[{i}].direction"))
}

/// Points and directions have `d` components; what lies outside the plane is absent in 2-D.
fn in_dimension(draft: &mut Draft<'_>, law: &str, d: usize) {
    let points = ["pivot", "translation.velocity"].map(|p| format!("{law}.{p}"));
    let all: Vec<String> = points.into_iter().chain(directions(draft, law)).collect();
    for path in all {
        let n = draft.count(&path);
        if n != 0 && n != d {
            draft.fail(&path, format!("`{path}` has {n} components in a {d}-D case")).allowed(format!("{d} values"));
        }
    }
    let axis = format!("{law}.axis");
    if draft.given(&axis) && draft.count(&axis) != 3 && d == 3 {
        draft.fail(&axis, format!("`{axis}` needs 3 components")).allowed("3 values");
    }
    if d == 3 {
        return;
    }
    for path in ["axis", "table.z", "formula.z"].map(|p| format!("{law}.{p}")) {
        if draft.given(&path) {
            let hint = "in the plane, angles are nose up positive and displacements have `x` and `y`";
            draft.fail_key(&path, format!("`{path}` needs a 3-D case")).hint(hint);
        }
    }
}

/// A file or lists of one length, with times that rise.
fn table(draft: &mut Draft<'_>, law: &str) {
    let path = format!("{law}.table");
    if draft.get(&path).is_none_or(Value::is_null) {
        return;
    }
    let key = |name: &str| format!("{path}.{name}");
    let listed: Vec<String> = COLUMNS.map(key).into_iter().filter(|c| draft.given(c)).collect();
    let file = draft.get(&key("file")).is_some_and(Value::is_string);
    if file && (draft.given(&key("time")) || !listed.is_empty()) {
        draft.fail_key(&path, "a table is a `file` or lists, not both").hint("keep one");
        return;
    }
    if !file && (!draft.given(&key("time")) || listed.is_empty()) {
        let hint = "for example `table = { time = [0, 1, 2], y = [0, 0.1, 0] }` or `table = \"motion.csv\"`";
        draft.fail_key(&path, "a table needs a `file`, or `time` and a column").hint(hint);
        return;
    }
    let Some(time) = draft.numbers(&key("time")) else { return };
    if let Some(i) = time.windows(2).position(|t| t[1] <= t[0]) {
        let message = format!("`{}` does not rise: {} is followed by {}", key("time"), time[i], time[i + 1]);
        draft.fail(&key("time"), message);
    }
    let periodic = draft.get(&key("periodic")).and_then(Value::as_bool) == Some(true);
    for column in listed {
        let Some(values) = draft.numbers(&column) else { continue };
        if values.len() != time.len() {
            let message = format!("`{column}` has {} values for {} times", values.len(), time.len());
            draft.fail(&column, message).allowed(format!("{} values", time.len()));
        } else if periodic && values.first() != values.last() {
            let message = format!("`{column}` is periodic, but begins and ends differently");
            draft.fail(&column, message).hint("the last row is the first one a period later: repeat its value");
        }
    }
}

/// Every formula can be read, and knows its frequency.
fn formulas(draft: &mut Draft<'_>, law: &str) {
    let path = format!("{law}.formula");
    let written = draft.get(&path).is_some_and(Value::is_object);
    let texts: Vec<(String, String)> = COLUMNS
        .iter()
        .map(|c| format!("{path}.{c}"))
        .filter_map(|c| Some((draft.get(&c)?.as_str()?.to_owned(), c)))
        .map(|(text, c)| (c, text))
        .collect();
    if written && !COLUMNS.iter().any(|c| draft.given(&format!("{path}.{c}"))) {
        let hint = "for example `formula = { y = \"0.1 * sin(omega * t)\" }`";
        draft.fail_key(&path, format!("`{path}` has no formula")).hint(hint);
    }
    for (column, text) in texts {
        let known = has_frequency(draft, law);
        formula(draft, &column, &text, known);
    }
}

/// Modes move bodies, and need a cloud that can follow them.
fn flexible(draft: &mut Draft<'_>, law: &str) {
    let mode = format!("{law}.mode");
    if draft.count(&mode) == 0 {
        return;
    }
    let particles = draft.get("motion.particles").and_then(Value::as_str).unwrap_or_default().to_owned();
    let reason = match particles.as_str() {
        "rigid" => "a rigid cloud cannot follow a body that bends",
        "lagrangian" => "particles that travel with the fluid cannot follow a body that bends yet",
        _ if !draft.given("body") => "a mode bends a body, but there is none",
        _ => return,
    };
    let hint = "use `particles = \"deforming\"` in `[motion]`, and a `[[body]]`";
    draft.fail_key(&mode, reason).allowed("`particles = \"deforming\"`").hint(hint);
}

/// A rigid cloud can follow one motion only.
fn together(draft: &mut Draft<'_>) {
    let rigid = draft.get("motion.particles").and_then(Value::as_str) == Some("rigid");
    let own = (0..draft.count("body")).map(|i| format!("body[{i}].motion")).find(|m| draft.given(m));
    if let Some(own) = own.filter(|_| rigid && draft.count("body") > 1) {
        let hint = "use `particles = \"deforming\"`, or one `[motion]` for all bodies";
        draft.fail_key(&own, "a rigid cloud cannot follow several motions").hint(hint);
    }
}

/// What moves is marched in time, and periods are counted only where something repeats.
fn in_time(draft: &mut Draft<'_>, laws: &[String]) {
    let moving = laws
        .iter()
        .find_map(|law| PARTS.iter().map(|part| format!("{law}.{part}")).find(|part| says_something(draft, part)));
    let lagrangian = draft.get("motion.particles").and_then(Value::as_str) == Some("lagrangian");
    let mover = moving.clone().or(lagrangian.then(|| "motion.particles".to_owned()));
    if let Some(mover) = mover.filter(|_| draft.get("time.steady").is_some()) {
        let hint = "add `[time.dual]` with `steps_per_period = 64` and `periods = 4`";
        draft.fail_key(&mover, format!("`{mover}` moves, but the case is steady")).hint(hint);
    }
    let repeats = laws.iter().any(|law| {
        let flag = draft.get(&format!("{law}.table.periodic")).and_then(Value::as_bool) == Some(true);
        flag || draft.given(&format!("{law}.rotation"))
            || (moving.is_some() && (has_frequency(draft, law) || has_own_frequency(draft, law)))
    });
    let repeats = repeats || is_shaken(draft);
    if draft.get("time.harmonics").is_some() && !repeats && has_gas(draft) {
        let hint = "give the motion a frequency, or march with `[time.dual]`";
        draft.fail_key("time.harmonics", "`time.harmonics` needs a periodic motion").hint(hint);
    }
    let harmonics = draft.get("time.harmonics").is_some();
    if let Some(tables) = lagrangian.then_some("motion.particles").filter(|_| harmonics) {
        let hint = "use `particles = \"rigid\"` or `\"deforming\"`";
        draft
            .fail_key(tables, "particles that travel with the fluid never come back: nothing is periodic on them")
            .hint(hint);
    }
    for key in [
        "explicit.periods",
        "explicit.periodic_tolerance",
        "dual.periods",
        "dual.steps_per_period",
        "dual.periodic_tolerance",
    ] {
        let path = format!("time.{key}");
        if draft.given(&path) && !repeats {
            let hint = "give the motion a frequency, or use `until` and `step`";
            draft.fail_key(&path, format!("`{path}` needs a periodic motion")).hint(hint);
        }
    }
}

/// Viscosity is given once, with what it needs; walls stick only where there is some.
pub(super) fn viscosity(draft: &mut Draft<'_>) {
    let (reynolds, viscosity) = (draft.given("flow.reynolds"), draft.given("flow.viscosity"));
    if reynolds && viscosity {
        let message = "`reynolds` and `viscosity` are both given";
        draft.fail_key("flow.viscosity", message).hint("keep one; the other follows from it");
    }
    if viscosity && !is_dimensional(draft) {
        let message = "`flow.viscosity` needs a dimensional free stream";
        draft.fail_key("flow.viscosity", message).hint("use `reynolds`, or give `pressure` and `temperature`");
    }
    if reynolds && !draft.given("flow.mach") && !draft.given("flow.velocity") {
        let message = "a Reynolds number needs the speed of the free stream";
        draft.fail_key("flow.reynolds", message).hint("add `mach` to `[flow]`");
    }
    if reynolds && !["flow.reynolds_length", "reference.chord", "body"].iter().any(|k| draft.given(k)) {
        let message = "without a body a Reynolds number needs its length";
        draft.fail_key("flow.reynolds", message).hint("add `reynolds_length`");
    }
    for key in ["reynolds_length", "viscosity_law", "sutherland", "prandtl"].map(|k| format!("flow.{k}")) {
        let needed = reynolds || (viscosity && key != "flow.reynolds_length");
        if draft.given(&key) && !needed {
            let hint = "add `reynolds`, or remove the key";
            draft.fail_key(&key, format!("`{key}`, but the gas has no viscosity")).hint(hint);
        }
    }
    let constant = draft.get("flow.viscosity_law").and_then(Value::as_str) == Some("constant");
    if constant && draft.given("flow.sutherland") {
        draft.fail_key("flow.sutherland", "a constant viscosity has no Sutherland constant").hint("remove it");
    }
    walls(draft, reynolds || viscosity);
}

fn walls(draft: &mut Draft<'_>, viscous: bool) {
    for path in (0..draft.count("body")).map(|i| format!("body[{i}].wall")) {
        let sticks = draft.get(&path).is_some_and(|w| !w.is_null() && w.as_str() != Some("slip"));
        if sticks && !viscous {
            let hint = "add `reynolds` to `[flow]`, or use `wall = \"slip\"`";
            draft.fail(&path, format!("`{path}` needs viscosity")).hint(hint);
        }
        let temperature = format!("{path}.temperature");
        if draft.given(&temperature) && draft.has_unit(&temperature) && !is_dimensional(draft) {
            let message = format!("`{temperature}` has a unit, but the free stream is nondimensional");
            draft.fail(&temperature, message).hint("give it over the temperature of the free stream, `1.05`");
        } else if draft.number(&format!("{temperature}.value")).is_some_and(|t| t > HOTTEST) && !is_dimensional(draft) {
            let message = format!("`{temperature}` is over {HOTTEST} times the temperature of the free stream");
            draft.fail(&temperature, message).hint("without units a temperature is a ratio, for example `1.05`");
        }
    }
}

#[cfg(test)]
mod tests {
    use crate::case::{
        Angle, Case, Frequency, Length, ParticleMotion, Temperature, Temporal, Wall, read, template, write,
    };

    const HEAD: &str =
        "[flow]\nmach = 0.5\n[[body]]\nnaca = \"0012\"\n[cloud]\nspacing = 0.01\n[time.explicit]\nuntil = 1\n";
    const DIMENSIONAL: &str = "[flow]\nmach = 0.5\npressure = 101325\ntemperature = 288.15\n[[body]]\nnaca = \"0012\"\n\
                               [cloud]\nspacing = 0.01\n[time.explicit]\nuntil = 1\n";

    fn case(head: &str, keys: &str) -> Case {
        read(&format!("{head}[motion]\n{keys}\n"), "case.toml").unwrap_or_else(|e| panic!("{e}"))
    }

    /// Exactly one mistake, with all the pieces.
    fn told(text: &str, pieces: &[&str]) {
        let shown = read(text, "case.toml").expect_err(text).render(false);
        for piece in pieces {
            assert!(shown.contains(piece), "`{piece}` is missing in\n{shown}\nfor\n{text}");
        }
        assert_eq!(shown.matches("error: ").count(), 1, "{shown}\nfor\n{text}");
    }

    fn refused(keys: &str, pieces: &[&str]) {
        told(&format!("{HEAD}[motion]\n{keys}\n"), pieces);
    }

    #[test]
    fn a_frequency_is_entered_once_and_everything_follows() {
        let omega = |c: &Case| c.angular_frequency(&c.motion.as_ref().unwrap().law, 2.0).unwrap();
        // k = ω L/U, L half the chord by default: ω = 0.1·0.5/1
        assert!((omega(&case(HEAD, "plunge = 0.1\nreduced_frequency = 0.1")) - 0.05).abs() < 1e-15);
        assert!(
            (omega(&case(HEAD, "plunge = 0.1\nreduced_frequency = 0.1\nreduced_length = 2")) - 0.025).abs() < 1e-15
        );
        assert!((omega(&case(HEAD, "plunge = 0.1\nperiod = 4")) - 0.5 * std::f64::consts::PI).abs() < 1e-15);
        let hertz = case(DIMENSIONAL, "plunge = 0.1\nfrequency = \"5 Hz\"");
        assert!((omega(&hertz) - 10.0 * std::f64::consts::PI).abs() < 1e-12);
        let plain = case(DIMENSIONAL, "plunge = 0.1\nfrequency = \"31.4 rad/s\"");
        assert_eq!(plain.motion.as_ref().unwrap().law.frequency, Some(Frequency(31.4)));
        let u = plain.flow.reference().speed;
        assert!((omega(&case(DIMENSIONAL, "plunge = 0.1\nreduced_frequency = 0.1")) - 0.1 * u).abs() < 1e-12);
        refused("plunge = 0.1\nfrequency = \"5 Hz\"", &["the free stream is nondimensional", "reduced_frequency"]);
        refused("plunge = 0.1\nperiod = \"2 s\"", &["the free stream is nondimensional"]);
        refused("rotation = \"10 deg/s\"\npivot = [0, 0]", &["`motion.rotation` has a unit of time"]);
        refused("rotation = { rate = \"10 deg/s\" }\npivot = [0, 0]", &["`motion.rotation.rate` has a unit of time"]);
        refused("plunge = 0.1\nreduced_frequency = 0.1\nperiod = 3", &["given twice", "keep one"]);
        refused("plunge = 0.1\nreduced_length = 1\nperiod = 3", &["`reduced_length` without `reduced_frequency`"]);
        told(
            &format!("{DIMENSIONAL}[motion]\nplunge = 0.1\nfrequency = 5\n"),
            &["a frequency `5` has no unit", "\"5 Hz\""],
        );
    }

    #[test]
    fn parts_are_read_in_short_and_in_long() {
        let c = case(
            HEAD,
            "period = 3\npivot = [0.25, 0]\npitch = \"2 deg\"\nplunge = { amplitude = 0.1, phase = \"90 deg\" }",
        );
        let law = c.motion_of(0).unwrap();
        assert_eq!(law.pitch[0].amplitude, Angle(2f64.to_radians()));
        assert_eq!(law.plunge[0].amplitude, Length(0.1));
        assert_eq!((c.particles(), c.moves()), (ParticleMotion::Deforming, true));
        let own = "[flow]\nmach = 0.5\n[motion]\nperiod = 3\nplunge = 0.1\n[[body]]\nnaca = \"0012\"\n[[body]]\nnaca = \"0012\"\n\
                   name = \"tail\"\nmotion = {}\n[[body]]\nnaca = \"0006\"\n[body.motion]\nplunge = 0.2\n[cloud]\nspacing = 0.01\n\
                   [time.dual]\nsteps_per_period = 64\nperiods = 3\n";
        let c = read(own, "case.toml").unwrap_or_else(|e| panic!("{e}"));
        assert!(c.motion_of(0).is_some() && c.motion_of(1).is_none());
        let third = c.motion_of(2).unwrap();
        assert_eq!(third.plunge[0].amplitude, Length(0.2));
        assert!((c.angular_frequency(third, 1.0).unwrap() * 3.0 - std::f64::consts::TAU).abs() < 1e-15);
        assert_eq!(read(&write(&c), "c").unwrap_or_else(|e| panic!("{e}\n{}", write(&c))), c);
    }

    #[test]
    fn motions_that_contradict_themselves_are_refused() {
        refused("plunge = 0.1", &["`motion.plunge` has no frequency", "reduced_frequency = 0.1"]);
        refused("pitch = \"1 deg\"\nperiod = 3", &["turns about no point", "pivot = [0.25, 0]"]);
        refused("plunge = 0.1\nperiod = 3\naxis = [0, 0, 1]", &["`motion.axis` needs a 3-D case"]);
        let solid = HEAD.replace("naca = \"0012\"", "sphere = { radius = 1 }");
        told(
            &format!("{solid}[motion]\nplunge = 0.1\nperiod = 3\naxis = [0, 0, 1]\n"),
            &["an axis, but nothing turns"],
        );
        refused("pitch = \"1 deg\"\nperiod = 3\npivot = [0, 0, 0]", &["has 3 components in a 2-D case"]);
        refused("plunge = { amplitude = 1, direction = [0, 0] }\nperiod = 3", &["a direction of no length"]);
        refused("table = { time = [0, 1, 1], y = [0, 1, 0] }", &["does not rise: 1 is followed by 1"]);
        refused("table = { time = [0, 1], y = [0, 1, 0] }", &["has 3 values for 2 times"]);
        refused("table = { time = [0, 1], y = [0, 1], periodic = true }", &["begins and ends differently"]);
        refused("table = { y = [0, 1] }", &["a `file`, or `time` and a column"]);
        refused("table = { file = \"a.csv\", y = [0, 1] }", &["a `file` or lists, not both"]);
        refused("formula = { z = \"t\" }", &["`motion.formula.z` needs a 3-D case"]);
        refused("formula = {}", &["`motion.formula` has no formula"]);
        told(
            &format!("{HEAD}[motion]\nparticles = \"rigid\"\n")
                .replace("[cloud]", "motion.translation = [1, 0]\n[[body]]\nnaca = \"0012\"\n[cloud]"),
            &["a rigid cloud cannot follow several motions"],
        );
    }

    #[test]
    fn mistakes_in_formulas_have_their_caret() {
        let shown = read(&format!("{HEAD}[motion]\nformula = {{ y = \"0.1*sn(2*t)\" }}\n"), "case.toml")
            .unwrap_err()
            .render(false);
        let expected = "error: `motion.formula.y`: unknown name `sn` in a formula
  --> case.toml:10:21
   |
10 | formula = { y = \"0.1*sn(2*t)\" }
   |                      ^^";
        assert!(shown.starts_with(&expected.replace(":21", ":22")), "{shown}");
        refused("formula = { y = \"sin(t\" }", &["this parenthesis is never closed", "^"]);
        refused("formula = { y = \"t +\" }", &["the formula ends where", "^"]);
        refused("formula = { y = \"sin(omega*t)\" }", &["uses `omega`, but there is no frequency", "^^^^^"]);
        refused("formula = { y = \"2 * tan3(t)\" }", &["did you mean `tan`?", "^^^^"]);
    }

    #[test]
    fn what_moves_is_marched_and_periods_need_one() {
        let steady = "[flow]\nmach = 0.5\n[[body]]\nnaca = \"0012\"\n[cloud]\nspacing = 0.01\n[motion]\nplunge = 0.1\nperiod = 3\n";
        told(steady, &["`motion.plunge` moves, but the case is steady", "[time.dual]"]);
        let march = |time: &str, motion: &str| {
            format!(
                "[flow]\nmach = 0.5\n[[body]]\nnaca = \"0012\"\n[cloud]\nspacing = 0.01\n[time.{time}\n[motion]\n{motion}\n"
            )
        };
        told(
            &march("explicit]\nperiods = 2", "particles = \"lagrangian\""),
            &["`time.explicit.periods` needs a periodic"],
        );
        told(&march("dual]\nuntil = 2", "plunge = 1\nperiod = 2"), &["neither `steps_per_period` nor `step`"]);
        told(&march("dual]\nuntil = 2\nperiods = 3\nstep = 1", "plunge = 1\nperiod = 2"), &["are both given"]);
        told(&march("dual]\nuntil = 2\nsteps_per_period = 9", "translation = [1, 0]"), &["needs a periodic motion"]);
        let still = "translation = [1, 0]";
        let of_time = "has a unit of time, but the free stream is nondimensional";
        told(&march("dual]\nuntil = 2\nstep = \"5 ms\"", still), &["`time.dual.step`", of_time]);
        told(&march("explicit]\nuntil = \"2 s\"", still), &["`time.explicit.until`", of_time]);
        let c = read(&march("dual]\nsteps_per_period = 50\nperiods = 3", "plunge = 1\nperiod = 2"), "c").unwrap();
        let Temporal::Dual(dual) = &c.time else { panic!("{:?}", c.time) };
        assert_eq!((dual.order, dual.orders, dual.inner_iterations), (2, 2.0, 50));
        assert_eq!((c.end(Some(2.0)), c.step_length(Some(2.0))), (Some(6.0), Some(0.04)));
        assert_eq!((c.end(None), c.step_length(None)), (None, None));
        let c = read(&march("dual]\nstep = 0.5\nuntil = 3", "translation = [1, 0]"), "c").unwrap();
        assert_eq!((c.end(None), c.step_length(None)), (Some(3.0), Some(0.5)));
        let air = march("dual]\nstep = \"5 ms\"\nuntil = 3", "translation = [1, 0]");
        let c = read(&air.replace("mach = 0.5", "mach = 0.5\npressure = 101325\ntemperature = 288.15"), "c").unwrap();
        let a = c.flow.reference().sound_speed;
        assert_eq!((c.end(None), c.step_length(None)), (Some(3.0 * a), Some(0.005 * a)));
    }

    #[test]
    fn viscosity_and_walls_fit_together() {
        let flow = |keys: &str, body: &str| {
            format!("[flow]\n{keys}\n[[body]]\nnaca = \"0012\"\n{body}\n[cloud]\nspacing = 0.01\n")
        };
        let c = read(&flow("mach = 0.5\nreynolds = 5e3", ""), "c").unwrap();
        assert_eq!(c.flow.wall(&c.bodies[0]), Wall::Adiabatic);
        let c = read(&flow("mach = 0.5\nreynolds = 5e3", "wall = { temperature = 1.05 }"), "c").unwrap();
        assert_eq!(c.bodies[0].wall, Some(Wall::Temperature { value: Temperature(1.05) }));
        assert_eq!(read(&write(&c), "c").unwrap_or_else(|e| panic!("{e}")).bodies, c.bodies);
        assert_eq!(c.flow.wall(&read(&flow("mach = 0.5", ""), "c").unwrap().bodies[0]), Wall::Adiabatic);
        let air = "mach = 0.5\npressure = 101325\ntemperature = 288.15\nviscosity = \"1.8e-5 Pa s\"";
        assert!(read(&flow(air, "wall = { temperature = \"300 K\" }"), "c").is_ok());
        let both = "mach = 0.5\npressure = 1\ndensity = 1\nreynolds = 1\nviscosity = 1";
        told(&flow(both, ""), &["both given"]);
    }

    #[test]
    fn viscosity_that_contradicts_itself_is_refused() {
        let flow = |keys: &str, body: &str| {
            format!("[flow]\n{keys}\n[[body]]\nnaca = \"0012\"\n{body}\n[cloud]\nspacing = 0.01\n")
        };
        told(&flow("mach = 0.5\nviscosity = 1e-5", ""), &["`flow.viscosity` needs a dimensional free stream"]);
        told(&flow("mach = 0.5\nprandtl = 0.7", ""), &["`flow.prandtl`, but the gas has no viscosity"]);
        told(&flow("mach = 0.5\ntemperature = 288", ""), &["`flow.temperature` alone does not fix"]);
        told(&flow("mach = 0.5", "wall = \"adiabatic\""), &["`body-1.wall` needs viscosity"]);
        told(
            &flow("mach = 0.5\nreynolds = 5e3", "wall = { temperature = \"300 K\" }"),
            &["has a unit, but the free stream"],
        );
        told(&flow("mach = 0.5\nreynolds = 5e3", "wall = { temperature = 300 }"), &["over 50 times"]);
        told(&flow("mach = 0.5\nreynolds = 5e3", "wall = \"sticky\""), &["cannot be `sticky`", "adiabatic"]);
        let constant = "mach = 0.5\nreynolds = 5e3\nviscosity_law = \"constant\"\nsutherland = \"110 K\"";
        told(&flow(constant, ""), &["a constant viscosity has no Sutherland constant"]);
    }

    #[test]
    fn the_pitching_template_says_what_it_means() {
        let c = read(&template("pitching").unwrap(), "c").unwrap_or_else(|e| panic!("{e}"));
        let law = c.motion_of(0).unwrap();
        // k = ω c/(2U): ω = 2·0.081·0.6
        assert!((c.angular_frequency(law, 1.0).unwrap() - 2.0 * 0.081 * 0.6).abs() < 1e-15);
    }
}
