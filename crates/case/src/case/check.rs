//! Contradictions: what single values cannot say.
//!
//! Every check looks at values that passed on their own and stays silent about absent ones, so one mistake is told once.
use serde_json::{Value, json};

use super::body::SHAPES;
use super::draft::{Draft, closest, default_name};
use super::facts::{has_gas, is, is_dimensional};
use super::naca::{Naca, TrailingEdge};
use super::schema::one_of;
use super::sides::SIDES;
use super::{Accuracy, initial};

/// Part of the length of a hinge line that must lie across the stream.
const ALONG_STREAM: f64 = 0.1;

/// Looks for all contradictions, and fills in what follows from other keys: dimension and names of bodies.
pub(super) fn contradictions(draft: &mut Draft<'_>) {
    bodies(draft);
    let dimension = dimension(draft);
    if has_gas(draft) {
        free_stream(draft);
    }
    super::polar::contradictions(draft);
    if let Some(d) = dimension {
        placements(draft, d);
        in_dimension(draft, d);
        initial::check(draft, d);
        if has_gas(draft) {
            sides(draft, d);
        }
    }
    domain(draft);
    accuracy(draft, dimension.unwrap_or(2));
    super::plausible::doubtful(draft);
    time(draft);
    super::motion_check::contradictions(draft, dimension);
    super::motion_check::viscosity(draft);
    super::structure_check::contradictions(draft, dimension);
    super::solid_check::contradictions(draft, dimension);
    super::gaf_check::contradictions(draft);
    super::flutter::check::contradictions(draft);
    super::idle::refuse(draft);
}

/// Each body has one shape, a name of its own and sensible digits.
fn bodies(draft: &mut Draft<'_>) {
    let mut names: Vec<String> = Vec::new();
    for i in 0..draft.count("body") {
        let body = format!("body[{i}]");
        if draft.get(&body).is_none_or(Value::is_null) {
            continue;
        }
        one_shape(draft, &body);
        naca(draft, &format!("{body}.naca"));
        polygon(draft, &format!("{body}.polygon"));
        wing(draft, &format!("{body}.wing"));
        profile(draft, &format!("{body}.revolution.profile"));
        stations(draft, &format!("{body}.loft.stations"));
        let name = draft.get(&format!("{body}.name")).and_then(Value::as_str).map(str::to_owned);
        let name = name.unwrap_or_else(|| default_name(i));
        if names.contains(&name) {
            let message = format!("two bodies are called `{name}`");
            draft.fail(&format!("{body}.name"), message).hint("give each body a name of its own");
        }
        if let Some(Value::Object(table)) = draft.tree.pointer_mut(&format!("/body/{i}")) {
            table.insert("name".to_owned(), json!(name));
        }
        names.push(name);
    }
}

fn one_shape(draft: &mut Draft<'_>, body: &str) {
    let all = SHAPES.map(|s| s.0);
    let given: Vec<_> = all.into_iter().filter(|key| draft.given(&format!("{body}.{key}"))).collect();
    match given[..] {
        [] => {
            let hint = format!("add one of {}", one_of(all.into_iter()));
            draft.fail_key(body, format!("`{body}` has no shape")).hint(hint);
        }
        [_] => {}
        [first, .., last] => {
            let message = format!("`{body}` has {} shapes, `{first}` and `{last}`", given.len());
            let hint = "keep one; a second body needs its own `[[body]]`";
            draft.fail_key(&format!("{body}.{last}"), message).hint(hint);
        }
    }
}

/// The designation of a section can be made.
fn naca(draft: &mut Draft<'_>, path: &str) {
    let Some(digits) = draft.get(&format!("{path}.digits")).and_then(Value::as_str).map(without_naca) else { return };
    if let Some(Value::Object(section)) = draft.get_mut(path) {
        section.insert("digits".to_owned(), json!(digits));
    }
    let place = if draft.given(&format!("{path}.digits")) { format!("{path}.digits") } else { path.to_owned() };
    if let Err(no) = (Naca { digits, trailing_edge: TrailingEdge::Closed }).design() {
        draft.fail(&place, no.what).hint(no.hint);
    }
}

/// A designation without the word NACA before it.
fn without_naca(text: &str) -> String {
    let rest = text.get(..4).filter(|word| word.eq_ignore_ascii_case("naca")).map(|word| &text[word.len()..]);
    rest.map_or(text, |rest| rest.trim_start_matches([' ', '-', '_'])).to_owned()
}

fn polygon(draft: &mut Draft<'_>, path: &str) {
    let Some(points) = draft.get(path).and_then(Value::as_array).cloned() else { return };
    let n = points.len();
    if let Some(i) = (0..n).find(|&i| points[i] == points[(i + 1) % n]) {
        let message = format!("corners {} and {} of `{path}` are the same point", i + 1, (i + 1) % n + 1);
        draft.fail(path, message).hint("the polygon closes by itself: do not repeat the first corner");
    }
}

/// A wing has one section at each end and a chord.
fn wing(draft: &mut Draft<'_>, path: &str) {
    if draft.get(path).is_none_or(Value::is_null) {
        return;
    }
    let given = |draft: &Draft<'_>, key: &str| draft.given(&format!("{path}.{key}"));
    for (end, least) in [("", 1), ("tip_", 0)] {
        let keys = [format!("{end}naca"), format!("{end}airfoil")];
        let count = keys.iter().filter(|key| given(draft, key)).count();
        if count < least {
            draft.fail_key(path, "a wing has no section").hint("add `naca = \"0012\"` or `airfoil = \"FILE\"`");
        } else if count > 1 {
            let message = format!("a wing has two sections at the same end, `{}` and `{}`", keys[0], keys[1]);
            draft.fail_key(&format!("{path}.{}", keys[1]), message).hint("keep one of them");
        }
        naca(draft, &format!("{path}.{}", keys[0]));
    }
    let [chord, ratio] = ["chord", "aspect_ratio"].map(|key| given(draft, key));
    if chord == ratio {
        let message = if chord { "a wing has both a chord and an aspect ratio" } else { "a wing has no chord" };
        draft.fail_key(path, message).hint("give `chord` at the root, or `aspect_ratio`");
    }
}

/// A profile goes from the nose to the rear, on one side of the axis; the first reason why it does not.
fn profile(draft: &mut Draft<'_>, path: &str) {
    let Some(points) = draft.get(path).and_then(Value::as_array).cloned() else { return };
    let at = |i: usize, k: usize| points[i].get(k).and_then(Value::as_f64).unwrap_or(f64::NAN);
    let n = points.len();
    let back = (1..n).find(|&i| at(i, 0) < at(i - 1, 0));
    let same = (1..n).find(|&i| points[i] == points[i - 1]);
    let crossing = (0..n).find(|&i| at(i, 1) < 0.0 || (0 < i && i + 1 < n && at(i, 1) == 0.0));
    let (message, hint) = if let Some(i) = back {
        (
            format!("point {} of the profile lies ahead of the one before", i + 1),
            "list points from the nose to the rear",
        )
    } else if let Some(i) = same {
        (format!("points {i} and {} of the profile are the same", i + 1), "remove one of them")
    } else if let Some(i) = crossing {
        let hint = "radii are positive; only the first and the last point may be on the axis";
        (format!("point {} of the profile does not have a positive radius", i + 1), hint)
    } else if 1 < n && at(n - 1, 0) <= at(0, 0) {
        ("the profile has no length".to_owned(), "list points `[x, r]` from the nose to the rear")
    } else if (0..n).all(|i| at(i, 1) == 0.0) {
        ("the profile runs along the axis".to_owned(), "radii `r` of points `[x, r]` are positive")
    } else {
        return;
    };
    draft.fail(path, message).hint(hint);
}

/// Sections of a loft follow one another, and enclose something.
fn stations(draft: &mut Draft<'_>, path: &str) {
    let Some(stations) = draft.get(path).and_then(Value::as_array).cloned() else { return };
    let at = |i: usize, k: usize| stations[i].get(k).and_then(Value::as_f64).unwrap_or(f64::NAN);
    let n = stations.len();
    let back = (1..n).find(|&i| at(i, 0) <= at(i - 1, 0));
    let empty = |i: usize| at(i, 1) == 0.0 && at(i, 2) == 0.0;
    let flat = (0..n).find(|&i| at(i, 1).min(at(i, 2)) <= 0.0 && !(empty(i) && (i == 0 || i + 1 == n)));
    let (message, hint) = if let Some(i) = back {
        (format!("station {} of the loft does not lie behind the one before", i + 1), "list stations by growing x")
    } else if let Some(i) = flat {
        let hint = "widths and heights must be positive; only the first and the last station may be a point";
        (format!("station {} of the loft has no area", i + 1), hint)
    } else if (0..n).all(empty) {
        ("the loft has no volume".to_owned(), "give a station with width and height between its ends")
    } else {
        return;
    };
    draft.fail(path, message).hint(hint);
}

/// Number of dimensions from the key, the bodies or the domain; they must agree.
fn dimension(draft: &mut Draft<'_>) -> Option<usize> {
    let mut found: Vec<(String, u64)> = Vec::new();
    let written = draft.get("dimension").and_then(Value::as_u64).map(|d| ("dimension".to_owned(), d));
    found.extend(written);
    for i in 0..draft.count("body") {
        for (key, fixed) in SHAPES {
            let path = format!("body[{i}].{key}");
            let d = match fixed {
                0 => draft.count(&format!("{path}.size")) as u64,
                d => d,
            };
            if draft.given(&path) && d > 0 {
                found.push((path, d));
            }
        }
    }
    for corner in ["cloud.domain.min", "cloud.domain.max"] {
        found.extend(draft.numbers(corner).map(|list| (corner.to_owned(), list.len() as u64)));
    }
    let (first, d) = found.first().cloned()?;
    for (path, other) in found.iter().filter(|(_, other)| *other != d) {
        draft
            .fail_key(path, format!("`{path}` is {other}-D, but `{first}` is {d}-D"))
            .hint("a case is all 2-D or all 3-D");
    }
    let agreed = found.iter().all(|(_, other)| *other == d);
    if let Some(tree) = draft.tree.as_object_mut().filter(|_| agreed) {
        tree.insert("dimension".to_owned(), json!(d));
    }
    agreed.then_some(d as usize)
}

/// `mach` or `velocity`; none or two of pressure, temperature and density.
fn free_stream(draft: &mut Draft<'_>) {
    let states = ["flow.pressure", "flow.temperature", "flow.density"];
    let given: Vec<_> = states.into_iter().filter(|key| draft.given(key)).collect();
    let hint = "give two of `pressure`, `temperature` and `density`; the third follows from the gas law";
    let viscous = draft.given("flow.reynolds");
    match given[..] {
        // Sutherland's law asks for the temperature of a stream that needs no other units
        ["flow.temperature"] if viscous => {}
        [only] => {
            draft.fail_key(only, format!("`{only}` alone does not fix a dimensional free stream")).hint(hint);
        }
        [_, _, last] => {
            draft.fail_key(last, "`pressure`, `temperature` and `density` contradict each other").hint(hint);
        }
        _ => {}
    }
    if draft.get("flow.isentropic").and_then(Value::as_bool) == Some(true) && (viscous || draft.given("flow.viscosity"))
    {
        let message = "`isentropic` and viscosity contradict each other";
        draft
            .fail_key("flow.isentropic", message)
            .hint("friction and heat conduction produce entropy: remove one of the two");
    }
    let (mach, velocity) = (draft.given("flow.mach"), draft.given("flow.velocity"));
    if mach && velocity {
        let message = "`mach` and `velocity` are both given";
        draft.fail_key("flow.velocity", message).hint("keep one; the other follows from the sound speed");
    } else if velocity && given.is_empty() {
        let message = "`velocity` needs a dimensional free stream";
        draft.fail_key("flow.velocity", message).hint(format!("use `mach`, or {hint}"));
    } else if !mach && !velocity && needs_stream(draft) {
        draft.fail("flow.mach", "the free stream has no speed").hint("add `mach = 0.8` to `[flow]`");
    }
}

/// Bodies but those made of particles, and the free stream as initial field, need a speed.
fn needs_stream(draft: &Draft<'_>) -> bool {
    (0..draft.count("body")).any(|i| !draft.given(&format!("body[{i}].solid")))
        || draft.get("initial").and_then(Value::as_str) == Some("free_stream")
}

/// Rotations and translations have as many components as the case has room for.
fn placements(draft: &mut Draft<'_>, d: usize) {
    for i in 0..draft.count("body") {
        let rotate = format!("body[{i}].rotate");
        let angles = if d == 2 { 1 } else { 3 };
        let n = draft.count(&rotate);
        if n != 0 && n != angles {
            let message = format!("`{rotate}` has {n} angles, but a {d}-D body turns by {angles}");
            draft.fail(&rotate, message).allowed(if d == 2 { "one angle" } else { "three angles: about x, y, z" });
        }
        length(draft, &format!("body[{i}].translate"), d);
        chord_of_a_file(draft, &format!("body[{i}]"));
        let weld = format!("body[{i}].weld");
        if draft.given(&weld) && !draft.given(&format!("body[{i}].surface")) {
            draft
                .fail_key(&weld, format!("`{weld}` joins vertices of a `surface`, and this body has none"))
                .hint("remove it");
        }
    }
}

/// The chord of a surface file is measured: what is written as one would be the length of a unit of the file.
fn chord_of_a_file(draft: &mut Draft<'_>, body: &str) {
    let scale = format!("{body}.scale");
    if draft.given(&format!("{body}.surface")) && draft.is_written(&scale, "chord") {
        draft
            .fail_key(&scale, format!("`{body}.chord` beside a surface file, whose chord is measured"))
            .hint("`scale = \"1 mm\"` says that the file is in millimetres; the chord of coefficients is `chord` in `[reference]`");
    }
}

/// Points have `d` coordinates; keys of the other dimension are absent.
fn in_dimension(draft: &mut Draft<'_>, d: usize) {
    length(draft, "reference.moment_point", d);
    length(draft, "gaf.pivot", d);
    for i in 0..draft.count("cloud.box") {
        length(draft, &format!("cloud.box[{i}].min"), d);
        length(draft, &format!("cloud.box[{i}].max"), d);
        corners(draft, &format!("cloud.box[{i}]"));
    }
    if d == 2 && draft.number("flow.beta").is_some_and(|beta| beta != 0.0) {
        draft.fail("flow.beta", "`flow.beta` needs a 3-D case").hint("in 2-D only `alpha` turns the flow");
    }
    if d == 2 && draft.given("reference.area") {
        let hint = "in 2-D the coefficients use `reference.chord`";
        draft.fail_key("reference.area", "`reference.area` needs a 3-D case").hint(hint);
    }
    reference_body(draft, d);
    hinges(draft, d);
}

/// Hinges are points in the plane and lines across the stream in space, of bodies of the case.
fn hinges(draft: &mut Draft<'_>, d: usize) {
    for i in 0..draft.count("hinge") {
        let key = |name: &str| format!("hinge[{i}].{name}");
        length(draft, &key("from"), d);
        if d == 2 {
            if draft.given(&key("to")) {
                draft.fail_key(&key("to"), "a hinge has one end in a 2-D case").hint("take out `to`");
            }
        } else if draft.given(&key("to")) {
            length(draft, &key("to"), d);
            hinge_line(draft, &key("from"), &key("to"));
        } else {
            draft.fail_key(&key("from"), "a hinge needs both ends in a 3-D case").hint("give `to = [x, y, z]`");
        }
        known_body(draft, &key("body"));
    }
}

/// A hinge line is long and not along the stream.
fn hinge_line(draft: &mut Draft<'_>, from: &str, to: &str) {
    let [Some(from), Some(ends)] = [from, to].map(|key| draft.numbers(key)) else { return };
    let (&[a, b, c], &[p, q, r]) = (&from[..], &ends[..]) else { return };
    let (x, y, z): (f64, f64, f64) = (p - a, q - b, r - c);
    let across = y.hypot(z);
    if across < ALONG_STREAM * x.hypot(across) || across == 0.0 {
        let hint = "the control surface lies behind the line along x, so the line must not be parallel to x: move one of its ends";
        draft.fail(to, "the hinge line runs along the stream or has no length").hint(hint);
    }
}

/// The body of the reference values is one of the case.
fn reference_body(draft: &mut Draft<'_>, d: usize) {
    let key = "reference.body";
    if d == 2 && draft.given(key) {
        draft.fail_key(key, "`reference.body` needs a 3-D case").hint("in 2-D the coefficients use `reference.chord`");
        return;
    }
    known_body(draft, key);
}

/// A body that a key names is one of the case.
fn known_body(draft: &mut Draft<'_>, key: &str) {
    let Some(wanted) = draft.get(key).and_then(Value::as_str).map(str::to_owned) else { return };
    let name = |i: usize| draft.get(&format!("body[{i}].name")).and_then(Value::as_str).unwrap_or_default().to_owned();
    let names: Vec<String> = (0..draft.count("body")).map(name).collect();
    if !names.contains(&wanted) {
        let close = closest(&wanted, names.iter().map(String::as_str));
        let hint = close.map(|n| format!("did you mean `\"{n}\"`?"));
        let allowed = one_of(names.iter().map(String::as_str));
        draft.fail(key, format!("no body is called `{wanted}`")).allowed(allowed).hint = hint;
    }
}

fn length(draft: &mut Draft<'_>, path: &str, d: usize) {
    let n = draft.count(path);
    if n != 0 && n != d {
        draft.fail(path, format!("`{path}` has {n} coordinates in a {d}-D case")).allowed(format!("{d} values"));
    }
}

/// `min` lies below `max` on every axis.
fn corners(draft: &mut Draft<'_>, path: &str) {
    let corner = |name| draft.numbers(&format!("{path}.{name}"));
    let (Some(min), Some(max)) = (corner("min"), corner("max")) else { return };
    if let Some((a, b)) = min.iter().zip(&max).find(|(a, b)| a >= b) {
        let message = format!("`{path}` is empty: its `min` has {a} where its `max` has {b}");
        draft.fail(&format!("{path}.max"), message).hint("`min` must be smaller than `max` on every axis");
    }
}

/// A spacing is there where the program cannot choose one, and accuracy is asked of loads that do not change.
fn accuracy(draft: &mut Draft<'_>, dimension: usize) {
    if !draft.given("body") && !draft.given("cloud.spacing") {
        let message = "a case without bodies needs `cloud.spacing`";
        let hint = "add `[cloud]` with `spacing`, a hundredth of the body to begin with";
        draft.fail("cloud.spacing", message).hint(hint);
    }
    if !draft.given("accuracy") {
        return;
    }
    let usual = Accuracy::usual(dimension, super::polar::is_polar(draft));
    for (key, value) in [("loads", json!(usual.loads.0)), ("particles", json!(usual.particles))] {
        let left_out = !draft.given(&format!("accuracy.{key}"));
        if let Some(accuracy) = draft.tree.get_mut("accuracy").and_then(Value::as_object_mut).filter(|_| left_out) {
            accuracy.insert(key.to_owned(), value);
        }
    }
    if !draft.given("body") {
        draft.fail_key("accuracy", "`[accuracy]` concerns loads, but the case has no body").hint("remove it");
    }
    accuracy_in_time(draft);
}

/// Steady cases are told how well loads are to be known, others which errors of them are to be found.
fn accuracy_in_time(draft: &mut Draft<'_>) {
    let is = |kind: &str| draft.get("time").is_some_and(|t| t.as_str() == Some(kind) || t.get(kind).is_some());
    let (steady, balance) = (draft.get("time").is_none() || is("steady"), is("harmonics"));
    let structure = is("newmark") || is("modes");
    let error = draft.get("accuracy.error").and_then(Value::as_str).unwrap_or("none").to_owned();
    if steady {
        if error != "none" {
            let hint = "leave it out: `loads` and `particles` are for steady cases, whose error bars come from a family of clouds";
            draft.fail("accuracy.error", "`accuracy.error` is for marches and harmonic balances").hint(hint);
        }
        return;
    }
    if !draft.given("accuracy.error") || structure {
        let hint = "remove it, or `[time]`; for marches and harmonic balances give `accuracy.error`";
        draft.fail_key("accuracy", "`[accuracy]` is for steady cases").hint(hint);
        return;
    }
    // a resolved case has all keys
    let usual = Accuracy::default();
    let particles = [usual.particles, Accuracy::PARTICLES_IN_SPACE].map(|n| n as f64);
    let other = |key: &str, usual: &[f64]| draft.number(key).is_some_and(|value| !usual.contains(&value));
    let of_steady = [
        ("accuracy.loads", other("accuracy.loads", &[usual.loads.0])),
        ("accuracy.particles", other("accuracy.particles", &particles)),
        ("accuracy.time", draft.get("accuracy.time").is_some_and(|t| !t.is_null())),
    ];
    for (key, _) in of_steady.into_iter().filter(|(_, given)| *given) {
        draft.fail_key(key, format!("`{key}` is for steady cases")).hint("leave it out; give `error` only");
    }
    let (own, theirs) = if balance { ("harmonics", "step") } else { ("step", "harmonics") };
    if error == theirs {
        let what =
            if balance { "a harmonic balance has no step in time" } else { "a march has no number of harmonics" };
        let hint = format!("write `error = \"{own}\"`, or \"all\" to include the error of the cloud");
        draft.fail("accuracy.error", format!("`accuracy.error = \"{theirs}\"`, but {what}")).hint(hint);
    }
}

/// A domain is there when nothing else fixes one, and holds more than one particle.
fn domain(draft: &mut Draft<'_>) {
    corners(draft, "cloud.domain");
    if !draft.given("body") && !draft.given("cloud.domain") && draft.get("cloud").is_some() {
        let hint = "add `domain = { min = [0, 0], max = [10, 10] }` to `[cloud]`, or a `[[body]]`";
        draft.fail("cloud.domain", "a case without bodies needs `cloud.domain`").hint(hint);
    }
    if !draft.given("body") && draft.given("cloud.wall_layers") {
        draft.fail_key("cloud.wall_layers", "`cloud.wall_layers` needs a body").hint("layers lie along its surface");
    }
    if !draft.given("body") && draft.given("cloud.wake") {
        draft.fail_key("cloud.wake", "`cloud.wake` needs a body").hint("use `cloud.box` to refine a region");
    }
    let (Some(min), Some(max)) = (draft.numbers("cloud.domain.min"), draft.numbers("cloud.domain.max")) else { return };
    let Some(spacing) = draft.number("cloud.spacing") else { return };
    let shortest = min.iter().zip(&max).map(|(a, b)| b - a).fold(f64::INFINITY, f64::min);
    if 0.0 < shortest && shortest <= spacing {
        let message = format!("`cloud.spacing` is {spacing}, but the domain is only {shortest} wide");
        draft.fail("cloud.spacing", message).hint("choose a spacing many times smaller than the domain");
    }
}

fn sides(draft: &mut Draft<'_>, d: usize) {
    for (axis, (low, high)) in SIDES.into_iter().enumerate() {
        let (low, high) = (format!("boundary.{low}"), format!("boundary.{high}"));
        for side in [&low, &high] {
            one_side(draft, side, axis, d);
        }
        for (side, other) in [(&low, &high), (&high, &low)] {
            if is(draft, side, "periodic") && draft.get(other).is_some() && !is(draft, other, "periodic") {
                let hint = format!("add `{} = \"periodic\"` to `[boundary]`", other.trim_start_matches("boundary."));
                draft.fail(side, format!("`{side}` is periodic, but `{other}` is not")).hint(hint);
            }
        }
    }
}

fn one_side(draft: &mut Draft<'_>, side: &str, axis: usize, d: usize) {
    if axis >= d && draft.given(side) && draft.get(side).is_some() && !is(draft, side, "far_field") {
        draft.fail_key(side, format!("`{side}` needs a 3-D case")).hint("a 2-D domain has the sides of x and y only");
        return;
    }
    for kind in ["symmetry", "periodic"] {
        // around bodies a plane of symmetry passes through the origin of its axis
        let placed = draft.given("cloud.domain") || (kind == "symmetry" && draft.given("body"));
        if is(draft, side, kind) && !placed {
            let hint = "add `domain = { min = [...], max = [...] }` to `[cloud]`";
            draft.fail(side, format!("a {kind} side needs `cloud.domain`, which fixes its position")).hint(hint);
        }
    }
    // The stream must run along a plane of symmetry; x sides are walls for the stream on purpose (impulsive start).
    let turned = match (axis, d) {
        (1, 2) | (2, 3) => "flow.alpha",
        (1, 3) => "flow.beta",
        _ => "",
    };
    if is(draft, side, "symmetry") && draft.values(turned).iter().any(|angle| *angle != 0.0) {
        let hint = format!("turn the body with `rotate`, or remove `{}`", turned.trim_start_matches("flow."));
        draft
            .fail(side, format!("the free stream crosses the symmetry plane `{side}`: `{turned}` is not zero"))
            .hint(hint);
    }
    let stream = draft.given("flow.mach") || draft.given("flow.velocity") || needs_stream(draft);
    if axis < d && is(draft, side, "far_field") && !stream {
        let hint = "give `held`, `outflow` or `periodic`, or add `mach` to `[flow]`";
        draft.fail(side, format!("`{side}` is `far_field`, but the free stream has no speed")).hint(hint);
    }
}

fn time(draft: &mut Draft<'_>) {
    for table in ["time.steady", "time.dual", "time.harmonics"] {
        courant_numbers(draft, table);
    }
    for table in ["time.explicit", "time.dual"] {
        if draft.get(table).is_some() {
            one_of_two(draft, table, "until", "periods");
        }
    }
    if draft.get("time.dual").is_some() {
        one_of_two(draft, "time.dual", "steps_per_period", "step");
    }
    let times = ["time.explicit.until", "time.dual.until", "time.dual.step", "output.field_interval"];
    for path in times.into_iter().filter(|_| !is_dimensional(draft)).collect::<Vec<_>>() {
        if draft.has_unit(path) {
            let message = format!("`{path}` has a unit of time, but the free stream is nondimensional");
            let hint = "use a plain number, in units of length over sound speed, or give two of `pressure`, `temperature` and \
                        `density` in `[flow]`";
            draft.fail(path, message).hint(hint);
        }
    }
    let marches = ["explicit", "dual", "newmark"].iter().any(|march| draft.get(&format!("time.{march}")).is_some());
    if draft.given("output.field_interval") && !marches && draft.get("time").is_some() {
        let message = "`output.field_interval` needs a marching run";
        draft.fail_key("output.field_interval", message).hint("add `[time.explicit]`, or remove the key");
    }
}

fn courant_numbers(draft: &mut Draft<'_>, table: &str) {
    let (first, last) = (format!("{table}.cfl"), format!("{table}.cfl_max"));
    let (cfl, most) = (draft.number(&first), draft.number(&last));
    if let (Some(cfl), Some(most)) = (cfl, most)
        && cfl > most
    {
        let message = format!("`cfl` starts at {cfl}, above `cfl_max` = {most}");
        let place = if draft.given(&first) { &first } else { &last };
        draft.fail(place, message).hint("raise `cfl_max` or lower `cfl`");
    }
}

/// One of two keys that say the same in different terms.
fn one_of_two(draft: &mut Draft<'_>, table: &str, one: &str, other: &str) {
    let (first, second) = (format!("{table}.{one}"), format!("{table}.{other}"));
    match (draft.given(&first), draft.given(&second)) {
        (true, true) => {
            draft.fail_key(&second, format!("`{one}` and `{other}` are both given")).hint("keep one");
        }
        (false, false) => {
            let message = format!("`[{table}]` has neither `{one}` nor `{other}`");
            draft.fail(&first, message).hint(format!("add `{one} = …`, or `{other} = …` in terms of the motion"));
        }
        _ => {}
    }
}
