//! Values that are possible, but hardly meant: mostly those of another unit.
//!
//! Mach number and Reynolds number say how far the molecules of a gas fly between collisions, Kn = M/Re √(πγ/2) lengths: where that
//! is many times the length of the body, the gas is no continuum.
use std::f64::consts::{FRAC_PI_2, PI, TAU};

use serde_json::{Value, json};

use super::Flow;
use super::draft::Draft;
use super::facts::is;
use super::flow::{NEVER_LAMINAR, NO_CONTINUUM};
use super::polar::take_out;
use super::text::rounded;

/// Temperature in kelvin below which a number without unit is taken for one in degrees.
const COLD: f64 = 100.0;
/// Mach number at which a circle has a drag coefficient of 0.1 without viscosity.
const HARDLY_MOVING: f64 = 0.005;
/// Mach number whose square is some times the round-off of one.
const STILL: f64 = 1e-7;
/// Mach number of no gas whose γ is one number: at rest it is 2000 times as hot as in the stream.
const FASTEST: f64 = 100.0;
/// Ratio of specific heats of no gas: 5/3 of one atom, 7 of water taken for a gas.
const STIFFEST: f64 = 10.0;
/// Steps that no march comes to the end of: as many as a day of ten thousand a second.
const ENDLESS: f64 = 1e9;
/// Greatest angle of attack, with what degrees are rounded by.
const HALF_TURN: f64 = PI * (1.0 + 1e-12);

/// Looks for such values.
pub(super) fn doubtful(draft: &mut Draft<'_>) {
    cold(draft);
    slow(draft);
    still(draft);
    angles(draft);
    amplitudes(draft);
    stiff(draft);
    endless(draft);
    let wrong = draft.errors.iter().any(|e| e.path.starts_with("flow"));
    if let Some(flow) = stream(draft).filter(|_| !wrong) {
        fast(draft, &flow);
        viscous(draft, &flow);
    }
}

/// Ratios of specific heats that no gas has.
fn stiff(draft: &mut Draft<'_>) {
    if let Some(gamma) = draft.number("flow.gamma").filter(|gamma| *gamma > STIFFEST) {
        let message = format!("no gas has a ratio of specific heats of {}", number(gamma));
        draft.fail("flow.gamma", message).allowed(format!("at most {STIFFEST}")).hint("air has 1.4");
    }
}

/// Marches of more steps than any computer takes.
fn endless(draft: &mut Draft<'_>) {
    for table in ["time.dual", "time.newmark"] {
        let of = |key: &str| draft.number(&format!("{table}.{key}"));
        let by_time = of("until").zip(of("step")).map(|(until, step)| (until / step, "until"));
        let by_period = of("periods").zip(of("steps_per_period")).map(|(periods, each)| (periods * each, "periods"));
        let Some((steps, key)) = by_time.or(by_period).filter(|(steps, _)| *steps > ENDLESS) else { continue };
        let message = format!("the march would take {} steps", number(steps));
        draft
            .fail(&format!("{table}.{key}"), message)
            .allowed(format!("at most {ENDLESS:e} steps"))
            .hint("take longer steps or an earlier end: check the units of both");
    }
}

/// The free stream of the draft, at the first point of a polar.
fn stream(draft: &Draft<'_>) -> Option<Flow> {
    let mut tree = json!({ "flow": draft.get("flow")? });
    take_out(&mut tree);
    serde_json::from_value(tree["flow"].take()).ok()
}

fn cold(draft: &mut Draft<'_>) {
    let bare = !draft.has_unit("flow.temperature");
    if let Some(t) = draft.number("flow.temperature").filter(|t| bare && *t < COLD) {
        let message = format!("`flow.temperature` is {t} without a unit, which would be {t} K");
        draft.fail("flow.temperature", message).hint(format!("write `\"{t} degC\"` or `\"{t} K\"`"));
    }
}

fn slow(draft: &mut Draft<'_>) {
    let scheme = draft.get("scheme.low_mach").and_then(Value::as_bool) == Some(false) && draft.given("body");
    let steady = is(draft, "time", "steady") || draft.get("time.steady").is_some();
    let slowest = draft.values("flow.mach").into_iter().reduce(f64::min);
    if let Some(mach) = slowest.filter(|m| scheme && steady && *m < HARDLY_MOVING) {
        let message = format!("at M {} the scheme's own drag is larger than any of the body", number(mach));
        draft.fail("flow.mach", message).allowed(format!("at least {HARDLY_MOVING}")).hint(
            "take M 0.1, whose loads are those of incompressible flow within 1 %, or try `scheme.low_mach = true`",
        );
    }
}

/// Mach numbers at which round-off of the gas at rest is larger than all that the stream does, in whatever way it is computed.
fn still(draft: &mut Draft<'_>) {
    let slowest = draft.values("flow.mach").into_iter().reduce(f64::min);
    let told = draft.errors.iter().any(|e| e.path == "flow.mach");
    if let Some(mach) = slowest.filter(|m| !told && *m < STILL) {
        let message = format!("at M {} the dynamic pressure is lost in the round-off of the pressure", number(mach));
        let hint = "take M 0.1, whose loads are those of incompressible flow within 1 %";
        draft.fail("flow.mach", message).allowed(format!("at least {}", number(STILL))).hint(hint);
    }
}

/// Mach numbers that no gas has.
fn fast(draft: &mut Draft<'_>, flow: &Flow) {
    let own = flow.reference().mach;
    let mach = draft.values("flow.mach").into_iter().fold(own, f64::max);
    if mach <= FASTEST {
        return;
    }
    let hot = 1.0 + 0.5 * (flow.gamma - 1.0) * mach * mach;
    let message = format!("at M {} the gas would be {hot:.1e} times as hot at rest as in the stream", number(mach));
    let (path, hint) = match flow.velocity {
        Some(_) => {
            ("flow.velocity", "check the unit of `velocity`, and pressure, temperature and density of the stream")
        }
        None => ("flow.mach", "a Mach number is the speed over the sound speed: a speed is `velocity = \"100 m/s\"`"),
    };
    draft.fail(path, message).allowed(format!("at most M {FASTEST}")).hint(hint);
}

/// Reynolds numbers of layers that are turbulent, and of gases that are none.
fn viscous(draft: &mut Draft<'_>, flow: &Flow) {
    let Some(re) = flow.reynolds.filter(|_| draft.given("body")) else { return };
    if re > NEVER_LAMINAR {
        let message = format!(
            "at a Reynolds number of {re:e} the boundary layers are turbulent, which this program cannot compute"
        );
        draft.fail("flow.reynolds", message).allowed(format!("at most {NEVER_LAMINAR:e}")).hint(
            "leave `reynolds` out for a gas without viscosity, whose pressures are closer to those of so thin a layer",
        );
    }
    let fastest = draft.values("flow.mach").into_iter().fold(flow.reference().mach, f64::max);
    let path = flow.free_path(re, fastest);
    if path > NO_CONTINUUM {
        let least = flow.free_path(1.0, fastest) / NO_CONTINUUM;
        let message = format!(
            "at the Reynolds number {} and M {fastest} molecules fly {path:.0} lengths of the body between collisions: that is no flow \
             of a continuum",
            number(re)
        );
        draft.fail("flow.reynolds", message).allowed(format!("at least {least:.1e} at this Mach number")).hint(
            "a Reynolds number is density times speed times length over viscosity: leave it out for a gas without viscosity",
        );
    }
}

/// Angles of attack beyond a quarter of a turn in radians, beyond half a turn in any unit.
fn angles(draft: &mut Draft<'_>) {
    for path in ["flow.alpha", "flow.beta"] {
        let values = draft.values(path);
        let Some(most) = values.into_iter().max_by(|a, b| a.abs().total_cmp(&b.abs())) else { continue };
        let radians = draft.unit(path).contains("rad");
        if most.abs() <= if radians { FRAC_PI_2 } else { HALF_TURN } {
            continue;
        }
        let degrees = number(most.to_degrees());
        let hint = if radians {
            format!("write `\"{} deg\"`, or `\"{degrees} deg\"` where that is meant", number(most))
        } else {
            let same = most - TAU * (most / TAU).round();
            format!("the same stream is `\"{} deg\"`", number(same.to_degrees()))
        };
        draft.fail(path, format!("`{path}` is {degrees} deg")).allowed("from -180 deg to 180 deg").hint(hint);
    }
}

/// Oscillations by more than a turn to each side.
fn amplitudes(draft: &mut Draft<'_>) {
    let bodies = (0..draft.count("body")).map(|i| format!("body[{i}].motion"));
    let laws: Vec<String> = std::iter::once("motion".to_owned()).chain(bodies).collect();
    let parts = |law: &String| {
        (0..draft.count(&format!("{law}.pitch"))).map(|k| format!("{law}.pitch[{k}].amplitude")).collect::<Vec<_>>()
    };
    let paths: Vec<String> = laws.iter().flat_map(parts).chain(["gaf.pitch".to_owned()]).collect();
    for path in paths {
        let Some(most) = draft.number(&path).filter(|a| a.abs() > TAU) else { continue };
        let message =
            format!("`{path}` is {} deg, {} turns to each side", number(most.to_degrees()), number(most / TAU));
        let hint = "this is the amplitude of an oscillation: check its unit; what turns on and on has `rotation = \"10 deg/s\"`";
        draft.fail(&path, message).allowed("at most 360 deg").hint(hint);
    }
}

/// Five digits are enough to recognise a number.
fn number(value: f64) -> String {
    rounded(value, 5)
}

#[cfg(test)]
mod tests {
    use super::super::read;

    fn told(flow: &str, more: &str) -> String {
        let text = format!("[flow]\n{flow}\n[[body]]\nnaca = \"0012\"\n{more}");
        read(&text, "t").map_or_else(|e| e.to_string(), |_| String::new())
    }

    fn all(text: &str, words: &[&str]) {
        words.iter().for_each(|w| assert!(text.contains(w), "no `{w}` in: {text}"));
    }

    #[test]
    fn mach_numbers_that_no_gas_has_are_refused() {
        all(
            &told("mach = 1e6", ""),
            &["t:2:8", "at M 1e6 the gas would be 2.0e11 times as hot at rest", "at most M 100"],
        );
        all(&told("mach = [0.3, 1000]", ""), &["at M 1000 "]);
        let speed = "velocity = \"300 km/s\"\npressure = 101325\ntemperature = \"15 degC\"";
        all(&told(speed, ""), &["t:2:12", "check the unit of `velocity`"]);
        assert_eq!(told("mach = 12", ""), "");
        let wrong = told("velocity = \"300 m/s\"\npressure = 101325\ntemperature = \"15 degX\"", "");
        assert!(!wrong.contains("as hot"), "{wrong}");
    }

    #[test]
    fn gases_that_there_are_not_and_marches_without_end_are_refused() {
        all(&told("mach = 0.3\ngamma = 1e300", ""), &["t:3:9", "ratio of specific heats of 1e300", "at most 10"]);
        assert_eq!(told("mach = 0.3\ngamma = 1.6667", ""), "");
        let march = |time: &str| told("mach = 0.3", &format!("[time.dual]\n{time}"));
        all(&march("step = 1e-300\nuntil = 10"), &["would take 1e301 steps", "at most 1e9 steps"]);
        assert_eq!(march("step = 1e-3\nuntil = 1e4"), "");
    }

    #[test]
    fn reynolds_numbers_of_turbulent_layers_and_of_no_continuum_are_refused() {
        all(&told("mach = 0.3\nreynolds = 1.2e9", ""), &["t:3:12", "are turbulent", "at most 1e7"]);
        all(&told("mach = 0.3\nreynolds = 1e-3", ""), &["0.001 and M 0.3", "fly 445 lengths", "at least 4.4e-2"]);
        assert_eq!(told("mach = 0.3\nreynolds = 1", ""), "");
    }

    #[test]
    fn angles_in_the_wrong_unit_are_refused() {
        let hint = ["`flow.alpha` is 114.59 deg", "write `\"2 deg\"`, or `\"114.59 deg\"`"];
        all(&told("mach = 0.3\nalpha = \"2 rad\"", ""), &hint);
        all(&told("mach = 0.3\nalpha = \"0:5:1 rad\"", ""), &["`flow.alpha` is 286.48 deg"]);
        all(
            &told("mach = 0.3\nalpha = \"400 deg\"", ""),
            &["from -180 deg to 180 deg", "the same stream is `\"40 deg\"`"],
        );
        all(&told("mach = 0.3\nalpha = \"200 deg\"", ""), &["t:3:9", "is 200 deg", "`\"-160 deg\"`"]);
        all(&told("mach = 0.3\nalpha = \"-180:200:20 deg\"", ""), &["is 200 deg"]);
        for good in ["\"0.03 rad\"", "\"114.59 deg\"", "\"-180:180:90 deg\""] {
            assert_eq!(told(&format!("mach = 0.3\nalpha = {good}"), ""), "");
        }
        let swing = |pitch: &str| {
            told(
                "mach = 0.3",
                &format!("[motion]\nperiod = 9\npivot = [0.25, 0]\npitch = {pitch}\n[time]\nharmonics = 1\n"),
            )
        };
        all(&swing("\"3600 deg\""), &["is 3600 deg, 10 turns to each side", "`rotation = \"10 deg/s\"`"]);
        all(&swing("[\"1 deg\", { amplitude = \"400 deg\" }]"), &["`motion.pitch[1].amplitude` is 400 deg"]);
        assert_eq!(swing("\"360 deg\""), "");
    }

    #[test]
    fn sections_that_are_thicker_than_any_strut_are_refused() {
        let told =
            |body: &str| read(&format!("[flow]\nmach = 0.3\n[[body]]\n{body}\n"), "t").map_err(|e| e.to_string());
        for body in ["naca = \"0099\"", "naca = \"23051\"", "wing = { naca = \"0060\", span = 4, chord = 1 }"] {
            all(&told(body).unwrap_err(), &["% thick", "published sections have 6 to 25"]);
        }
        assert!(told("naca = \"0040\"").is_ok() && told("naca = \"2450\"").is_ok());
    }

    #[test]
    fn designations_may_begin_with_naca() {
        for text in ["NACA0012", "naca 0012", "NACA-0012", "0012"] {
            let case = read(&format!("[flow]\nmach = 0.3\n[[body]]\nnaca = \"{text}\"\n"), "t").unwrap();
            assert!(matches!(&case.bodies[0].shape, super::super::Shape::Naca(n) if n.digits == "0012"), "{text}");
        }
    }
}
