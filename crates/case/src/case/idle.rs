//! Keys that have no effect beside what else a case says: refused where a file gives them, left out where a case is written.
//!
//! A key that does nothing is believed to have done something. Each rule names what the key would act on and is not there. Rules look at
//! the tree of values alone, with all defaults, so that reader and writer ask the same ones; a value that itself says that nothing
//! happens (`limiter = "none"`, `cubic = 0`) passes.
use serde_json::{Map, Value};

use super::draft::{Draft, pointer};
use super::error::CaseError;
use super::facts::{FREQUENCIES, has_gas};
use super::naca::{Naca, ThicknessForm, TrailingEdge};

/// Parts of a motion that turn a body, and those that shift or bend it.
const TURNS: [&str; 4] = ["pitch", "rotation", "table.angle", "formula.angle"];
const SHIFTS: [&str; 6] = ["plunge", "translation", "table.file", "table.time", "formula", "mode"];
/// Coordinates of bodies that keep their shape.
const FREEDOMS: [&str; 7] = ["surge", "sway", "plunge", "roll", "pitch", "yaw", "flap"];
/// Gas constant of air, J/(kg K), the default.
const AIR: f64 = 287.05;

/// A key without effect.
struct Idle {
    path: String,
    /// Why it has none.
    why: String,
    /// What to do.
    hint: String,
}

/// The values of a case and the keys without effect that were found among them.
struct Search<'a> {
    tree: &'a Value,
    /// False for structures alone.
    gas: bool,
    found: Vec<Idle>,
}

/// Refuses keys that are given and have no effect.
pub(super) fn refuse(draft: &mut Draft<'_>) {
    let gas = has_gas(draft);
    for Idle { path, why, hint } in search(&draft.tree, gas) {
        // what is wrong there, or around it, comes first
        let told = |e: &CaseError| is_within(&e.path, &path) || is_within(&path, &e.path);
        if !draft.given(&path) || draft.errors.iter().any(told) {
            continue;
        }
        let message = format!("`{path}` has no effect: {why}");
        let table = |v: &Value| v.is_object() || v.as_array().is_some_and(|list| list.iter().any(Value::is_object));
        let error = if draft.get(&path).is_some_and(table) {
            draft.fail_key(&path, message)
        } else {
            draft.fail(&path, message)
        };
        error.hint(hint);
    }
}

/// True for a key path that is `outer`, or goes on from it.
fn is_within(path: &str, outer: &str) -> bool {
    path.strip_prefix(outer).is_some_and(|rest| rest.is_empty() || rest.starts_with(['.', '[']))
}

/// Takes keys without effect out of the values of a case that is written.
pub(super) fn take_out(tree: &mut Map<String, Value>, gas: bool) {
    let mut whole = Value::Object(std::mem::take(tree));
    for idle in search(&whole, gas) {
        let place = pointer(&idle.path);
        let Some((table, key)) = place.rsplit_once('/') else { continue };
        if let Some(Value::Object(keys)) = whole.pointer_mut(table) {
            keys.remove(key);
        }
    }
    // own modes are found, not given
    let structures = whole.get_mut("structure").and_then(Value::as_array_mut).into_iter().flatten();
    for keys in structures.filter_map(Value::as_object_mut) {
        if keys.get("model").is_some_and(|model| model == "own_modes") {
            keys.remove("mode");
        }
    }
    if let Value::Object(rest) = whole {
        *tree = rest;
    }
}

fn search(tree: &Value, gas: bool) -> Vec<Idle> {
    let mut search = Search { tree, gas, found: Vec::new() };
    search.shapes();
    search.solids();
    search.steps();
    search.outputs();
    if gas {
        search.stream();
        search.cloud();
        search.motions();
        search.structures();
        search.small_motions();
    }
    search.found
}

impl Search<'_> {
    fn get(&self, path: &str) -> Option<&Value> {
        self.tree.pointer(&pointer(path)).filter(|v| !v.is_null())
    }

    /// There, and no empty list.
    fn has(&self, path: &str) -> bool {
        self.get(path).is_some_and(|v| v.as_array().is_none_or(|list| !list.is_empty()))
    }

    fn number(&self, path: &str) -> Option<f64> {
        self.get(path)?.as_f64()
    }

    fn is(&self, path: &str, word: &str) -> bool {
        self.get(path).and_then(Value::as_str) == Some(word)
    }

    fn flag(&self, path: &str) -> Option<bool> {
        self.get(path)?.as_bool()
    }

    /// Paths of the tables in the list at `path`.
    fn each(&self, path: &str) -> Vec<String> {
        let n = self.get(path).and_then(Value::as_array).map_or(0, Vec::len);
        (0..n).map(|i| format!("{path}[{i}]")).collect()
    }

    /// Notes the keys of the table `at` (empty: the case) that are there, `when` they have no effect.
    fn note(&mut self, when: bool, at: &str, keys: &[&str], (why, hint): (&str, &str)) {
        if !when {
            return;
        }
        let path = |key: &&str| if at.is_empty() { (*key).to_owned() } else { format!("{at}.{key}") };
        for path in keys.iter().map(path) {
            if self.has(&path) {
                self.found.push(Idle { path, why: why.to_owned(), hint: hint.to_owned() });
            }
        }
    }

    /// Shapes: what of a wing its planform leaves no room for, and ends of sections that have only one form.
    fn shapes(&mut self) {
        for body in self.each("body") {
            let wing = format!("{body}.wing");
            let elliptic = self.is(&format!("{wing}.planform"), "elliptic");
            let why = ("the chord of an elliptic planform is that of the ellipse", "remove it, or `planform`");
            self.note(elliptic, &wing, &["taper"], why);
            let straight = !elliptic && self.number(&format!("{wing}.taper")) == Some(1.0);
            let why = ("with `taper = 1` all lines along the span are swept alike", "remove it");
            self.note(straight, &wing, &["sweep_at"], why);
            for section in [format!("{body}.naca"), format!("{wing}.naca"), format!("{wing}.tip_naca")] {
                let open = !self.is(&format!("{section}.trailing_edge"), "closed") && self.closes_by_itself(&section);
                let why = ("this section of the 6-series is closed as it is published", "remove it");
                self.note(open, &section, &["trailing_edge"], why);
            }
        }
    }

    /// True for sections of the 6-series without a straight rear.
    fn closes_by_itself(&self, section: &str) -> bool {
        let Some(digits) = self.get(&format!("{section}.digits")).and_then(Value::as_str) else { return false };
        let design = Naca { digits: digits.to_owned(), trailing_edge: TrailingEdge::Closed }.design();
        design.is_ok_and(|d| matches!(d.form, ThicknessForm::Six(series) if !series.straight))
    }

    /// The stream, the scheme and reference values.
    fn stream(&mut self) {
        let states = ["pressure", "temperature", "density"].map(|k| self.has(&format!("flow.{k}")));
        let given = states.iter().filter(|s| **s).count();
        let why = ("the free stream has no units", "remove it, or give two of `pressure`, `temperature` and `density`");
        self.note(given < 2 && self.number("flow.gas_constant") != Some(AIR), "flow", &["gas_constant"], why);
        let constant = self.is("flow.viscosity_law", "constant");
        let why = ("it is that of Sutherland's law, and the viscosity is constant", "remove it, or `viscosity_law`");
        self.note(given == 1 && constant, "flow", &["temperature"], why);
        let first = self.number("scheme.order") == Some(1.0);
        let unlimited = self.is("scheme.limiter", "none");
        let why = ("a scheme of first order reconstructs nothing", "remove it, or `order = 1`");
        self.note(first && !unlimited, "scheme", &["limiter"], why);
        self.note(first, "scheme", &["limiter_threshold", "kappa"], why);
        let why = ("there is no limiter", "remove it, or `limiter = \"none\"`");
        self.note(unlimited && !first, "scheme", &["limiter_threshold"], why);
        let bodies = self.has("body");
        let why = ("there is no body that has loads", "remove it, or add a `[[body]]`");
        self.note(!bodies, "reference", &["area", "body", "moment_point"], why);
        let all = ["chord", "area", "moment_point"].iter().all(|k| self.has(&format!("reference.{k}")));
        let why = ("`chord`, `area` and `moment_point` leave nothing to it", "remove it, or one of them");
        self.note(bodies && all, "reference", &["body"], why);
        let why = ("there is no body with a control surface", "remove it, or add a `[[body]]`");
        self.note(!bodies, "", &["hinge"], why);
    }

    /// The cloud, and its refinement.
    fn cloud(&mut self) {
        let (bodies, domain) = (self.has("body"), self.has("cloud.domain"));
        let why = ("`cloud.domain` says where the far field is", "remove one of the two");
        self.note(domain, "cloud", &["far_field"], why);
        let why = ("there is no body whose surface would be refined", "remove it; `[[cloud.box]]` refines a place");
        self.note(!bodies, "cloud", &["edge_levels", "curvature", "curvature_levels", "blank"], why);
        let levels = ["box", "wake"].iter().any(|k| self.has(&format!("cloud.{k}")));
        let adapts = self.number("adapt.cycles").is_none_or(|n| n > 0.0);
        let why = ("all of the cloud has one spacing", "remove it, or add a `[[cloud.box]]`");
        self.note(!bodies && !levels && !adapts, "cloud", &["layers"], why);
        let none = |search: &Self, key: &str| search.number(&format!("cloud.{key}")) == Some(0.0);
        let why = ("`curvature_levels = 0` refines nothing", "remove one of the two");
        self.note(bodies && none(self, "curvature_levels"), "cloud", &["curvature"], why);
        let one = self.number("cloud.wall_layers.count") == Some(1.0);
        let why = ("there is one layer (`count = 1`)", "remove it, or `count`");
        self.note(one, "cloud.wall_layers", &["growth"], why);
        for place in self.each("cloud.box") {
            let outside = self.is_outside(&place);
            let why = ("the box lies outside of `cloud.domain`", "move the box, or remove it");
            self.note(outside, "", &[&place], why);
        }
        let why = ("nothing is adapted (`cycles = 0`)", "add `cycles = 2`, or remove it");
        self.note(!adapts, "adapt", &["spacing", "particles", "sensors"], why);
        let explicit = self.get("time.explicit").is_some();
        let started = self.get("time.dual").is_some() && (!bodies || !self.is("initial", "free_stream"));
        let why = ("this march begins without a steady flow that the cloud could follow", "remove it");
        self.note(adapts && (explicit || started), "adapt", &["cycles"], why);
        let why = ("this march begins from `initial`, not from a steady flow", "remove it");
        self.note(started, "time.dual", &["start_orders"], why);
    }

    /// True for a box that has nothing in common with the domain that the case gives.
    fn is_outside(&self, place: &str) -> bool {
        let corner = |path: String| -> Vec<f64> {
            let list = self.get(&path).and_then(Value::as_array);
            list.into_iter().flatten().filter_map(Value::as_f64).collect()
        };
        let [low, high] = ["min", "max"].map(|k| corner(format!("{place}.{k}")));
        let [from, to] = ["min", "max"].map(|k| corner(format!("cloud.domain.{k}")));
        let axes = low.iter().zip(&high).zip(from.iter().zip(&to));
        axes.into_iter().any(|((low, high), (from, to))| high <= from || to <= low)
    }

    /// Numbers of methods that do not use them.
    fn steps(&mut self) {
        let fixed = self.get("time.harmonics.number").is_some_and(|n| !n.is_string());
        let why = ("`number` says how many harmonics there are", "remove it, or use `number = \"auto\"`");
        self.note(fixed, "time.harmonics", &["most"], why);
        if self.gas {
            return;
        }
        let why = ("structures alone are solved by Newton's method with tolerances of its own", "remove it");
        let relaxed = ["method", "orders", "iterations", "cfl", "cfl_max"];
        self.note(true, "time.steady", &relaxed, why);
        self.note(true, "time.harmonics", &["method", "cfl", "cfl_max"], why);
        let why = ("structures alone are marched by the symplectic Euler method until `until`", "remove it");
        self.note(true, "time.explicit", &["method", "steps"], why);
    }

    /// What is written or drawn.
    fn outputs(&mut self) {
        let marches = ["explicit", "dual"].iter().any(|t| self.get(&format!("time.{t}")).is_some())
            || self.number("time.harmonics.check").is_some_and(|n| n > 0.0);
        let periodic = marches && self.repeats();
        let why = ("it is of marches of a periodic motion", "remove it, or march a periodic motion");
        self.note(self.gas && !periodic, "output", &["loop_periods"], why);
        let plane = self.number("dimension") == Some(2.0);
        let why = ("it is of wings in space, and the case is 2-D", "remove it");
        self.note(plane, "output", &["stations"], why);
        let why = ("there is no body with a pressure along its chord", "remove it, or add a `[[body]]`");
        self.note(!self.has("body"), "output", &["stations"], why);
        self.note(!self.has("body"), "", &["compare"], why);
    }

    /// Something has a period.
    fn repeats(&self) -> bool {
        let mut laws = vec!["motion".to_owned()];
        laws.extend(self.each("body").iter().map(|b| format!("{b}.motion")));
        laws.extend(self.each("structure").iter().map(|s| format!("{s}.force")));
        let parts = |law: &String| ["pitch", "plunge"].map(|p| self.each(&format!("{law}.{p}"))).concat();
        let parts: Vec<String> = laws.iter().flat_map(parts).collect();
        let turns = |law: &String| {
            self.has(&format!("{law}.rotation")) || self.flag(&format!("{law}.table.periodic")) == Some(true)
        };
        let counted = |law: &String| FREQUENCIES.iter().any(|f| self.has(&format!("{law}.{f}")));
        laws.iter().chain(&parts).any(counted) || laws.iter().any(turns)
    }

    /// Motions: frequencies and the way of particles are of what moves.
    fn motions(&mut self) {
        let mut laws: Vec<String> = self.each("body").iter().map(|b| format!("{b}.motion")).collect();
        laws.push("motion".to_owned());
        let says = |search: &Self, law: &str, parts: &[&str]| parts.iter().any(|p| search.has(&format!("{law}.{p}")));
        let moving = laws.iter().any(|law| says(self, law, &TURNS) || says(self, law, &SHIFTS));
        let solids = self.each("body").iter().any(|b| self.has(&format!("{b}.solid")));
        let still = !moving && !solids && !self.has("structure");
        let why = ("nothing moves", "remove it, or say what moves: `pitch`, `plunge`, …");
        let keys = ["frequency", "reduced_frequency", "reduced_length", "period"];
        self.note(still, "motion", &keys, why);
        let lagrangian = self.is("motion.particles", "lagrangian");
        self.note(still && !lagrangian, "motion", &["particles"], why);
    }

    /// Springs without stiffness, and what turns about an axis where nothing turns.
    fn structures(&mut self) {
        for structure in self.each("structure") {
            let at = |key: &str| format!("{structure}.{key}");
            let rigid = self.is(&at("model"), "rigid_body") || self.is(&at("model"), "typical_section");
            let free: Vec<&str> = self
                .get(&at("free"))
                .and_then(Value::as_array)
                .into_iter()
                .flatten()
                .filter_map(Value::as_str)
                .collect();
            let still = rigid && !free.is_empty() && !free.iter().any(|f| ["roll", "pitch", "yaw", "flap"].contains(f));
            let turning = ["pivot", "elastic_axis", "centre_of_mass", "x_alpha", "inertia", "r_alpha2"];
            let why = ("none of the coordinates in `free` turns", "remove it, or add `\"pitch\"` to `free`");
            self.note(still, &structure, &turning, why);
            for name in FREEDOMS {
                let loose = self.number(&at(&format!("stiffness.{name}"))) == Some(0.0);
                self.loose(loose, &at(&format!("springs.{name}")), &["cubic", "free_play", "rest"]);
                let why =
                    ("a body in modes has no such coordinate", "remove it; a `[[structure.mode]]` has its `force`");
                self.note(!rigid, &at("force"), &[name], why);
            }
            for mode in self.each(&at("mode")) {
                let loose = self.number(&format!("{mode}.stiffness")) == Some(0.0);
                self.loose(loose, &mode, &["cubic", "free_play", "damping_ratio"]);
            }
        }
    }

    /// Notes what a spring without stiffness has no use for, where it says something.
    fn loose(&mut self, loose: bool, at: &str, keys: &[&str]) {
        let why = ("the spring has no stiffness", "give it one, or remove the key");
        for key in keys {
            let says = self.number(&format!("{at}.{key}")).is_some_and(|x| x != 0.0);
            self.note(loose && says, at, &[key], why);
        }
    }

    /// Forces of small motions, boundaries and limit cycles.
    fn small_motions(&mut self) {
        let balance = self.is("gaf.method", "balance");
        let modes = self.get("gaf.modes").and_then(Value::as_array).cloned().unwrap_or_default();
        for key in ["pitch", "plunge"] {
            let absent = balance && !modes.iter().any(|m| m == key);
            let why = ("`modes` does not name this motion", "add it to `modes`, or remove it");
            self.note(absent, "gaf", &[key], why);
        }
        let why = ("only `method = \"linear\"` tells errors of the cloud", "remove it, or use `method = \"linear\"`");
        self.note(balance && self.flag("gaf.cloud_error") == Some(true), "gaf", &["cloud_error"], why);
        let altitude = self.is("flutter.match", "altitude");
        let why = ("altitudes are looked at from 5 km below the sea, whatever the speed", "remove it");
        self.note(altitude, "flutter", &["most"], why);
        let one = self.number("lco.harmonics") == Some(1.0);
        let why = ("there is one harmonic (`harmonics = 1`)", "remove it, or `harmonics`");
        self.note(one, "lco", &["accuracy"], why);
    }

    /// Bodies made of particles: what the kind of study, and what the law of the material, has no use for.
    fn solids(&mut self) {
        let of = |search: &Self, kind: &str| !search.gas && search.get(&format!("time.{kind}")).is_some();
        let (steady, modes) = (of(self, "steady"), of(self, "modes"));
        let preload = self.flag("time.modes.preload") == Some(true);
        let solids: Vec<String> = self.each("body").iter().map(|b| format!("{b}.solid")).collect();
        let loads = |search: &Self, solid: &String| {
            let led = search.each(&format!("{solid}.support")).iter().any(|s| search.has(&format!("{s}.motion")));
            led || search.has(&format!("{solid}.load")) || search.has(&format!("{solid}.gravity"))
        };
        let loaded = solids.iter().any(|s| loads(self, s));
        let why = ("no body has a load", "remove it, or add a `[[body.solid.load]]`");
        self.note(modes && preload && !loaded, "time.modes", &["preload"], why);
        for solid in &solids {
            let why = ("nothing moves in an equilibrium", "remove it, or march with `[time.newmark]`");
            self.note(steady, solid, &["velocity", "viscosity"], why);
            let damped = |s: &Self, key: &str| s.number(&format!("{solid}.{key}")).is_some_and(|x| x != 0.0);
            for key in ["damping", "stiffness_damping"] {
                self.note(steady && damped(self, key), solid, &[key], why);
            }
            let why = ("free vibrations have the shape and the size that they have", "remove it, or march");
            self.note(modes, solid, &["velocity", "viscosity"], why);
            let material = format!("{solid}.material");
            self.material(&material);
            for region in self.each(&format!("{solid}.region")) {
                self.material(&format!("{region}.material"));
            }
        }
        let why = ("no plane and no other body is touched", "add `planes`, or remove it");
        let alone = self.flag("contact.bodies") == Some(false) && !self.has("contact.planes");
        self.note(alone, "contact", &["stiffness", "friction"], why);
    }

    /// Heat without plastic work, and temperatures that nothing depends on.
    fn material(&mut self, material: &str) {
        let at = |key: &str| format!("{material}.{key}");
        if self.has(&at("base")) {
            return;
        }
        let plastic = ["yield", "johnson_cook"].iter().any(|k| self.has(&at(k)));
        let why = ("only plastic work heats a material, and this one never yields", "remove it, or add `yield`");
        self.note(!plastic, material, &["heat_capacity", "heating"], why);
        let cook = at("johnson_cook");
        let melts = self.has(&format!("{cook}.melt"));
        let why = ("the yield stress depends on no temperature without `melt`", "add `melt`, or remove it");
        let other = |x: Option<f64>, usual: f64| x.is_some_and(|x| x != usual);
        let exponent = other(self.number(&format!("{cook}.m")), 1.0);
        self.note(!melts && exponent, &cook, &["m"], why);
        let hot = melts || self.has(&at("heat_capacity"));
        let why = ("nothing depends on the temperature", "remove it, or add `heat_capacity` or `melt`");
        self.note(!hot, material, &["temperature"], why);
        let slow = self.number(&format!("{cook}.c")) == Some(0.0) && other(self.number(&format!("{cook}.rate")), 1.0);
        let why = ("the yield stress does not depend on the rate of strain (`c = 0`)", "add `c`, or remove it");
        self.note(slow, &cook, &["rate"], why);
    }
}

#[cfg(test)]
mod tests {
    use super::super::{read, write};

    const PLANE: &str = "[flow]\nmach = 0.5\n[[body]]\nnaca = \"0012\"\n";
    const SPACE: &str = "[flow]\nmach = 0.5\n[[body]]\n";
    const BEAM: &str = "[[body]]\nbox = { size = [1, 0.1] }\n[body.solid]\nthrough = 5\n";
    const STEEL: &str = "material = { density = 7800, young = \"200 GPa\", poisson = 0.3 }\n";
    const ALUMINIUM: &str = "density = 2700\nyoung = \"70 GPa\"\npoisson = 0.3\n";
    const SPRINGS: &str = "[[body]]\nnaca = \"0012\"\n[time.dual]\nstep = 0.1\nuntil = 1\n[structure]\nmodel = \"rigid_body\"\nmass = 5\n";

    /// One mistake, of this key, with these words.
    fn refused(text: &str, key: &str, words: &str) {
        let errors = read(text, "t").expect_err(text);
        assert_eq!(errors.errors.len(), 1, "{errors}\n{text}");
        let told = &errors.errors[0];
        assert_eq!(told.path, key, "{errors}");
        assert!(told.message.contains("has no effect: ") && told.message.contains(words), "{errors}");
        assert!(told.hint.is_some() && told.line > 1, "{errors}");
    }

    #[test]
    fn keys_without_effect_are_refused() {
        let plane = |more: &str, key: &str, words: &str| refused(&format!("{PLANE}{more}\n"), key, words);
        let wing = |more: &str| format!("{SPACE}wing = {{ naca = \"0012\", span = 6, chord = 1, {more} }}\n");
        refused(&wing("planform = \"elliptic\", taper = 0.5"), "body[0].wing.taper", "that of the ellipse");
        refused(&wing("sweep = \"20 deg\", sweep_at = 0.25"), "body[0].wing.sweep_at", "swept alike");
        refused(
            "[flow]\nmach = 0.5\n[[body]]\nnaca = { digits = \"63-415\", trailing_edge = \"blunt\" }\n",
            "body[0].naca.trailing_edge",
            "6-series",
        );
        plane(
            "[cloud]\nfar_field = 20\ndomain = { min = [-4, -4], max = [4, 4] }",
            "cloud.far_field",
            "`cloud.domain`",
        );
        plane("[cloud]\ncurvature = 0.2\ncurvature_levels = 0", "cloud.curvature", "refines nothing");
        plane(
            "[cloud]\nwall_layers = { first = 1e-3, growth = 1.3, count = 1 }",
            "cloud.wall_layers.growth",
            "one layer",
        );
        let boxed =
            "[cloud]\ndomain = { min = [-4, -4], max = [4, 4] }\nbox = [{ min = [5, 0], max = [6, 1], spacing = 0.1 }]";
        plane(boxed, "cloud.box[0]", "outside of `cloud.domain`");
        plane("[scheme]\norder = 1\nlimiter = \"venkatakrishnan\"", "scheme.limiter", "first order");
        plane("[scheme]\norder = 1\nkappa = 0.3", "scheme.kappa", "first order");
        plane("[scheme]\nlimiter = \"none\"\nlimiter_threshold = 0.3", "scheme.limiter_threshold", "no limiter");
        plane("[adapt]\nsensors = [\"shear\"]", "adapt.sensors", "nothing is adapted");
        plane("[output]\nloop_periods = 2", "output.loop_periods", "periodic motion");
        plane("[output]\nstations = [0.5]", "output.stations", "2-D");
        plane("[motion]\nreduced_frequency = 0.2", "motion.reduced_frequency", "nothing moves");
        plane("[motion]\nparticles = \"rigid\"", "motion.particles", "nothing moves");
        let swing = "[motion]\nperiod = 9\nplunge = 0.1\n[time.harmonics]\nnumber = 2\nmost = 5";
        plane(swing, "time.harmonics.most", "how many harmonics");
        refused(&PLANE.replace("mach = 0.5", "mach = 0.5\ngas_constant = 290"), "flow.gas_constant", "no units");
        let constant = "mach = 0.5\nreynolds = 500\ntemperature = 300\nviscosity_law = \"constant\"";
        refused(&PLANE.replace("mach = 0.5", constant), "flow.temperature", "Sutherland");
        let sphere = format!("{SPACE}sphere = {{ radius = 1 }}\n");
        let given = "[reference]\nbody = \"body-1\"\nchord = 1\narea = 2\nmoment_point = [0, 0, 0]\n";
        refused(&format!("{sphere}{given}"), "reference.body", "leave nothing");
        plane(
            "[gaf]\nmodes = \"plunge\"\nmethod = \"balance\"\nreduced_frequencies = [0.1]\npitch = \"1 deg\"",
            "gaf.pitch",
            "`modes`",
        );
    }

    #[test]
    fn keys_of_structures_without_effect_are_refused() {
        let flow = "[flow]\nmach = 0.3\n";
        let springs = |more: &str, key: &str, words: &str| refused(&format!("{flow}{SPRINGS}{more}\n"), key, words);
        springs("free = \"plunge\"\nstiffness = { plunge = 1 }\ninertia = 2", "structure[0].inertia", "turns");
        let loose = "free = \"plunge\"\nstiffness = { plunge = 0 }\nsprings = { plunge = { cubic = 4 } }";
        springs(loose, "structure[0].springs.plunge.cubic", "no stiffness");
        refused(
            &format!("{BEAM}{STEEL}velocity = [1, 0]\n[time.steady]\nload_steps = 1\n"),
            "body[0].solid.velocity",
            "equilibrium",
        );
        refused(&format!("{BEAM}{STEEL}[time.steady]\norders = 4\n"), "time.steady.orders", "structures alone");
        refused(
            &format!("{BEAM}{STEEL}[time.explicit]\nuntil = 1\nmethod = \"rk4\"\n"),
            "time.explicit.method",
            "symplectic",
        );
        let law = |more: &str, key: &str, words: &str| {
            let text = format!("{BEAM}[body.solid.material]\n{ALUMINIUM}{more}\n[time.explicit]\nuntil = 1\n");
            refused(&text, &format!("body[0].solid.material.{key}"), words);
        };
        law("heat_capacity = 900", "heat_capacity", "never yields");
        law("johnson_cook = { a = 1e8, b = 1e8, n = 0.3, m = 2 }", "johnson_cook.m", "`melt`");
        law("johnson_cook = { a = 1e8, b = 1e8, n = 0.3, rate = 10 }", "johnson_cook.rate", "`c = 0`");
    }

    #[test]
    fn what_says_that_nothing_happens_passes_and_what_is_written_is_read_again() {
        let wing = "wing = { naca = \"0012\", span = 6, chord = 1, planform = \"elliptic\" }\n";
        for good in [
            format!(
                "{PLANE}[scheme]\norder = 1\nlimiter = \"none\"\n[cloud]\ndomain = {{ min = [-4, -4], max = [4, 4] }}\n"
            ),
            format!("{SPACE}{wing}[scheme]\nlimiter = \"none\"\n[output]\nreport = false\n"),
            format!("{BEAM}{STEEL}[time.modes]\nnumber = 3\n"),
            format!(
                "[flow]\nmach = 0.3\n{SPRINGS}free = \"plunge\"\nstiffness = {{ plunge = 1 }}\nsprings = {{ plunge = {{}} }}\n"
            ),
        ] {
            let case = read(&good, "t").unwrap_or_else(|e| panic!("{e}\n{good}"));
            let written = write(&case);
            assert_eq!(read(&written, "w").unwrap_or_else(|e| panic!("{e}\n{written}")), case, "{written}");
        }
    }

    #[test]
    fn own_modes_are_written_as_they_are_read() {
        let text = "[flow]\nmach = 0.5\npressure = 1e5\ntemperature = 288\n[[body]]\nbox = { size = [1, 0.1] }\n[body.solid]\nthrough = 5\n\
                    material = \"aluminium 2024-T3\"\nsupport = { where = { x_max = -0.4 } }\n[structure]\nmodel = \"own_modes\"\n\
                    [cloud]\nspacing = 0.02\n[time.dual]\nstep = 1e-4\nuntil = 1e-3\n";
        let case = read(text, "t").unwrap_or_else(|e| panic!("{e}"));
        assert_eq!(read(&write(&case), "w").unwrap_or_else(|e| panic!("{e}")), case);
    }
}
