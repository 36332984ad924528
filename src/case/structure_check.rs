//! Contradictions in `[structure]`.
use serde_json::Value;

use super::draft::{Draft, closest};
use super::facts::{FREQUENCIES, formula, is_dimensional, says_something};
use super::schema::one_of;
use super::structure::Freedom;

const SPEEDS: [&str; 3] = ["reduced_speed", "reduced_velocity", "speed_index"];
/// Parts of a motion that prescribe where a body is.
const PARTS: [&str; 7] = ["pitch", "plunge", "rotation", "translation", "table", "formula", "mode"];
/// Keys of bodies that are rigid, meaningless for modes.
const RIGID: [&str; 22] = [
    "free",
    "pivot",
    "elastic_axis",
    "mass",
    "mass_ratio",
    "centre_of_mass",
    "x_alpha",
    "inertia",
    "r_alpha2",
    "large_angles",
    "stiffness",
    "frequency",
    "frequency_ratio",
    "reduced_speed",
    "reduced_velocity",
    "speed_index",
    "damping_ratio",
    "damping",
    "flap",
    "springs",
    "initial",
    "gravity",
];
/// Keys that say something in semichords or of a section: 2-D only.
const PLANE: [&str; 9] = [
    "elastic_axis",
    "mass_ratio",
    "x_alpha",
    "r_alpha2",
    "frequency_ratio",
    "reduced_speed",
    "reduced_velocity",
    "speed_index",
    "flap",
];
/// Keys that say the same in different terms.
const ALTERNATIVES: [[&str; 2]; 5] = [
    ["pivot", "elastic_axis"],
    ["mass", "mass_ratio"],
    ["centre_of_mass", "x_alpha"],
    ["inertia", "r_alpha2"],
    ["flap.hinge", "flap.hinge_point"],
];
/// Units of masses, inertias and stiffnesses per span: those of the plane.
const PER_SPAN: [&str; 16] = [
    "kg/m",
    "g/m",
    "lb/ft",
    "slug/ft",
    "kg m",
    "kg m2/m",
    "slug ft",
    "slug ft2/ft",
    "N/m2",
    "kN/m2",
    "N/m/m",
    "lbf/ft2",
    "N/rad",
    "N m/rad/m",
    "N",
    "lbf/rad",
];

/// One structure under the eye of the checks.
struct Look<'d, 't> {
    draft: &'d mut Draft<'t>,
    /// Its key path.
    path: String,
    /// Number of space dimensions.
    dimension: usize,
    free: Vec<Freedom>,
    section: bool,
}

/// Looks for contradictions in all structures.
pub(super) fn contradictions(draft: &mut Draft<'_>, dimension: Option<usize>) {
    bodies(draft);
    let Some(dimension) = dimension else { return };
    for i in 0..draft.count("structure") {
        let path = format!("structure[{i}]");
        let Some(model) = draft.get(&format!("{path}.model")).and_then(Value::as_str).map(str::to_owned) else {
            continue;
        };
        let free = freedoms(draft, &path, &model, dimension);
        let mut look = Look { draft, path, dimension, free, section: model == "typical_section" };
        look.force();
        look.units();
        if model == "modal" {
            look.modes();
        } else {
            look.rigid();
        }
    }
}

/// Every structure has a body, every body one structure, and no motion beside it.
fn bodies(draft: &mut Draft<'_>) {
    let n = draft.count("body");
    let name = |draft: &Draft<'_>, i: usize| {
        draft.get(&format!("body[{i}].name")).and_then(Value::as_str).unwrap_or_default().to_owned()
    };
    let names: Vec<String> = (0..n).map(|i| name(draft, i)).collect();
    let mut taken: Vec<usize> = Vec::new();
    for i in 0..draft.count("structure") {
        let path = format!("structure[{i}]");
        let place = format!("{path}.body");
        let wanted = draft.get(&place).and_then(Value::as_str).map(str::to_owned);
        let body = match wanted {
            _ if n == 0 => {
                draft.fail_key(&path, format!("`{path}` has no body")).hint("add a `[[body]]`");
                continue;
            }
            None if n > 1 => {
                let message = format!("`{path}` does not say which body it is");
                draft.fail_key(&path, message).allowed(one_of(names.iter().map(String::as_str))).hint("add `body = …`");
                continue;
            }
            None => 0,
            Some(wanted) => match names.iter().position(|n| *n == wanted) {
                Some(body) => body,
                None => {
                    let allowed = one_of(names.iter().map(String::as_str));
                    let close = closest(&wanted, names.iter().map(String::as_str));
                    let hint = close.map(|n| format!("did you mean `\"{n}\"`?"));
                    draft.fail(&place, format!("no body is called `{wanted}`")).allowed(allowed).hint = hint;
                    continue;
                }
            },
        };
        if taken.contains(&body) {
            let message = format!("the body `{}` has two structures", names[body]);
            draft.fail_key(&path, message).hint("keep one, or name another body");
        }
        taken.push(body);
        prescribed(draft, body);
    }
}

/// Nothing prescribes where a body is whose coordinates are unknowns.
fn prescribed(draft: &mut Draft<'_>, body: usize) {
    let own = format!("body[{body}].motion");
    let law = if draft.given(&own) { own } else { "motion".to_owned() };
    let part = PARTS.iter().map(|part| format!("{law}.{part}")).find(|part| says_something(draft, part));
    if let Some(part) = part {
        let hint = "remove one of the two; `motion = {}` in the `[[body]]` keeps `[motion]` away from it";
        draft.fail_key(&part, "a body on springs cannot have a prescribed motion as well").hint(hint);
    }
}

/// Coordinates that are unknowns, as [`super::Structure::freedoms`] has them.
fn freedoms(draft: &Draft<'_>, path: &str, model: &str, dimension: usize) -> Vec<Freedom> {
    let listed = draft.get(&format!("{path}.free")).and_then(Value::as_array).cloned().unwrap_or_default();
    let flap = draft.given(&format!("{path}.flap"));
    let free = |f: &Freedom| match (listed.is_empty(), model) {
        (_, "modal") => false,
        (false, _) => listed.iter().any(|word| word == f.name()),
        (true, "typical_section") => match f {
            Freedom::Plunge | Freedom::Pitch => true,
            Freedom::Flap => flap,
            _ => false,
        },
        (true, _) => *f != Freedom::Flap && f.exists_in(dimension),
    };
    Freedom::ALL.into_iter().filter(free).collect()
}

impl Look<'_, '_> {
    fn place(&self, key: &str) -> String {
        format!("{}.{key}", self.path)
    }

    fn given(&self, key: &str) -> bool {
        self.draft.given(&self.place(key))
    }

    /// Given, and neither `false` nor an empty list: a written case repeats its defaults.
    fn says(&self, key: &str) -> bool {
        let silent = |v: &Value| *v == Value::Bool(false) || v.as_array().is_some_and(Vec::is_empty);
        self.given(key) && !self.draft.get(&self.place(key)).is_some_and(silent)
    }

    fn is_free(&self, freedom: Freedom) -> bool {
        self.free.contains(&freedom)
    }

    /// Keys that were given inside the table `key`.
    fn inside(&self, key: &str) -> Vec<String> {
        let table = self.draft.get(&self.place(key)).and_then(Value::as_object);
        table.map(|t| t.keys().cloned().collect()).unwrap_or_default()
    }

    /// Complains that `key` is missing.
    fn missing(&mut self, message: &str, hint: &str) {
        let message = format!("`{}` has {message}", self.path);
        self.draft.fail_key(&self.path, message).hint(hint);
    }

    /// Everything about bodies that keep their shape.
    fn rigid(&mut self) {
        if self.draft.count(&self.place("mode")) > 0 {
            let message = "modes need `model = \"modal\"`";
            self.draft.fail_key(&self.place("mode"), message).hint("set the model, or remove the modes");
        }
        self.model_fits();
        self.alternatives();
        self.points();
        self.inertia();
        self.stiffness();
        self.damping();
        self.coordinates_exist();
    }

    /// The model fits the dimension, and each coordinate the model.
    fn model_fits(&mut self) {
        let d = self.dimension;
        if self.section && d == 3 {
            let message = "a typical section needs a 2-D case";
            self.draft.fail(&self.place("model"), message).hint("in 3-D use `model = \"rigid_body\"` or `\"modal\"`");
        }
        for f in self.free.clone() {
            if !f.exists_in(d) {
                let allowed = one_of(Freedom::ALL.into_iter().filter(|f| f.exists_in(d)).map(Freedom::name));
                let message = format!("there is no `{}` in a {d}-D case", f.name());
                self.draft.fail(&self.place("free"), message).allowed(allowed);
            }
        }
        if self.is_free(Freedom::Flap) && !self.given("flap") {
            let hint = "add `flap = { hinge = 0.6, x_beta = 0.01, r_beta2 = 0.005 }`";
            self.draft.fail(&self.place("free"), "`flap` is free, but there is no flap").hint(hint);
        }
        if d == 3 && !self.section {
            for key in PLANE.into_iter().filter(|k| self.given(k)).collect::<Vec<_>>() {
                let hint = "in 3-D give `mass`, `centre_of_mass`, `inertia`, `stiffness` or `frequency`";
                self.draft.fail_key(&self.place(key), format!("`{key}` needs a 2-D case")).hint(hint);
            }
        }
        if !self.section && self.given("flap") {
            let message = "a flap needs `model = \"typical_section\"`";
            self.draft
                .fail_key(&self.place("flap"), message)
                .hint("a section has `surge` as well, if it is named in `free`");
        }
        if !self.section && self.says("large_angles") {
            let message = "`large_angles` is for typical sections";
            self.draft
                .fail_key(&self.place("large_angles"), message)
                .hint("a rigid body has its inertia at any angle: remove the key");
        }
    }

    /// Nothing is said twice.
    fn alternatives(&mut self) {
        for [one, other] in ALTERNATIVES {
            if self.given(one) && self.given(other) {
                let message = format!("`{one}` and `{other}` are both given");
                self.draft.fail_key(&self.place(other), message).hint("keep one");
            }
        }
        let speeds: Vec<&str> = SPEEDS.into_iter().filter(|s| self.given(s)).collect();
        if let [first, .., last] = speeds[..] {
            let message = format!("`{first}` and `{last}` are both given");
            self.draft.fail_key(&self.place(last), message).hint("keep one; the others follow from it");
        }
    }

    /// Points have as many coordinates as the case, and those that are needed are there.
    fn points(&mut self) {
        let d = self.dimension;
        for key in ["pivot", "centre_of_mass", "flap.hinge_point", "gravity"] {
            let n = self.draft.count(&self.place(key));
            if n != 0 && n != d {
                let message = format!("`{}` has {n} components in a {d}-D case", self.place(key));
                self.draft.fail(&self.place(key), message).allowed(format!("{d} values"));
            }
        }
        let turns = self.free.iter().any(|f| f.turns() && *f != Freedom::Flap);
        if turns
            && !self.given("pivot")
            && !self.given("elastic_axis")
            && (self.section || !self.given("centre_of_mass"))
        {
            let hint = "add `elastic_axis = -0.5` (semichords aft of the middle of the chord) or `pivot = [0.25, 0]`";
            self.missing("no elastic axis to turn about", hint);
        }
        if self.given("flap") && !self.given("flap.hinge") && !self.given("flap.hinge_point") {
            let hint = "add `hinge = 0.6` (semichords aft of the middle of the chord) or `hinge_point = [0.8, 0]`";
            self.draft.fail_key(&self.place("flap"), "the flap has no hinge").hint(hint);
        }
        let one = self.draft.count(&self.place("inertia"));
        let allowed = if d == 2 { &[1][..] } else { &[3, 6] };
        if one != 0 && !allowed.contains(&one) {
            let message = format!("`{}` has {one} values in a {d}-D case", self.place("inertia"));
            let words = if d == 2 { "1 value" } else { "3 values Jxx, Jyy, Jzz or 6 with Jxy, Jyz, Jzx" };
            self.draft.fail(&self.place("inertia"), message).allowed(words);
        }
    }

    /// Masses and moments of inertia of what moves.
    fn inertia(&mut self) {
        let turns = self.free.iter().any(|f| f.turns());
        let shifts = self.free.iter().any(|f| !f.turns());
        let relative = ["r_alpha2", "x_alpha", "gravity", "flap", "speed_index"].into_iter().any(|k| self.given(k));
        if (shifts || relative) && !self.given("mass") && !self.given("mass_ratio") {
            let hint = match self.dimension {
                2 => "add `mass_ratio = 60` (μ = m/(πρ∞b²)) or `mass = \"3 kg/m\"`",
                _ => "add `mass = \"3 kg\"`",
            };
            self.missing("no mass", hint);
        }
        if turns && !self.given("inertia") && !self.given("r_alpha2") {
            let hint = match self.dimension {
                2 => "add `r_alpha2 = 0.25` (I_α/(m b²)) or `inertia = \"0.2 kg m\"`, about the elastic axis",
                _ => "add `inertia = [Jxx, Jyy, Jzz]`, about the pivot",
            };
            self.missing("no moment of inertia", hint);
        }
    }

    /// One spring for each coordinate, and what its terms need.
    fn stiffness(&mut self) {
        let speed = SPEEDS.into_iter().find(|s| self.given(s));
        if let Some(speed) = speed.filter(|_| !self.draft.given("flow.mach") && !self.draft.given("flow.velocity")) {
            let message = format!("`{speed}` needs the speed of the free stream");
            self.draft.fail_key(&self.place(speed), message).hint("add `mach` to `[flow]`");
        }
        let leading = if self.is_free(Freedom::Pitch) { Freedom::Pitch } else { Freedom::Plunge };
        if let Some(speed) = speed.filter(|_| !self.is_free(leading)) {
            let message = format!("`{speed}` fixes the spring of pitch or plunge, but neither is free");
            self.draft.fail_key(&self.place(speed), message).hint("use `stiffness` or `frequency`");
        }
        let ratios = [("frequency_ratio", Freedom::Plunge), ("flap.frequency_ratio", Freedom::Flap)];
        let turned = speed.is_some() || self.given("stiffness.pitch") || self.given("frequency.pitch");
        for (ratio, _) in ratios.iter().filter(|(ratio, _)| self.given(ratio)).collect::<Vec<_>>() {
            if !(turned && self.is_free(Freedom::Pitch)) {
                let message = format!("`{ratio}` is over the frequency of pitch, which is not known");
                self.draft
                    .fail_key(&self.place(ratio), message)
                    .hint("add `reduced_speed = 5`, or `frequency` of `pitch`");
            }
        }
        for f in self.free.clone() {
            let keys = [
                Some(format!("stiffness.{}", f.name())),
                Some(format!("frequency.{}", f.name())),
                speed.filter(|_| f == leading).map(str::to_owned),
                ratios.iter().find(|(_, of)| *of == f).map(|(ratio, _)| (*ratio).to_owned()),
            ];
            let given: Vec<String> = keys.into_iter().flatten().filter(|k| self.given(k)).collect();
            match &given[..] {
                [first, .., last] => {
                    let message = format!("the spring of `{}` is given twice, by `{first}` and by `{last}`", f.name());
                    self.draft.fail_key(&self.place(last), message).hint("keep one");
                }
                [] if self.section => self.no_spring(f),
                _ => {}
            }
        }
    }

    fn no_spring(&mut self, f: Freedom) {
        let terms = match f {
            Freedom::Pitch => "`reduced_speed = 5`",
            Freedom::Flap => "`frequency_ratio` in `flap`",
            _ if self.is_free(Freedom::Pitch) => "`frequency_ratio = 0.5`",
            _ => "`reduced_velocity = 5`",
        };
        let name = f.name();
        let hint = format!(
            "add {terms}, `frequency` or `stiffness = {{ {name} = … }}`; `stiffness = {{ {name} = 0 }}` leaves it free"
        );
        self.missing(&format!("no spring for `{name}`"), &hint);
    }

    /// Dampers are given once, and ratios where there is a spring.
    fn damping(&mut self) {
        for name in self.inside("damping_ratio") {
            let place = self.place(&format!("damping_ratio.{name}"));
            if self.given(&format!("damping.{name}")) {
                self.draft.fail_key(&place, format!("the damping of `{name}` is given twice")).hint("keep one");
            }
            let zero = self.draft.number(&self.place(&format!("stiffness.{name}"))) == Some(0.0);
            let none = !self.section && ["stiffness", "frequency"].iter().all(|k| !self.given(&format!("{k}.{name}")));
            let led = SPEEDS.iter().any(|s| self.given(s)) && ["plunge", "pitch"].contains(&name.as_str());
            if zero || (none && !led) {
                let message = format!("a damping ratio of `{name}`, which has no spring");
                self.draft.fail_key(&place, message).hint("use `damping`, or give it a spring");
            }
        }
    }

    /// What is said of a coordinate is said of one that is free.
    fn coordinates_exist(&mut self) {
        for table in ["stiffness", "frequency", "damping_ratio", "damping", "springs", "initial", "force"] {
            for key in self.inside(table) {
                let Some(f) = Freedom::ALL.into_iter().find(|f| key.trim_end_matches("_rate") == f.name()) else {
                    continue;
                };
                if !self.is_free(f) {
                    let allowed = one_of(self.free.iter().map(|f| f.name()));
                    let message = format!("`{table}` of `{}`, which is not free", f.name());
                    let place = self.place(&format!("{table}.{key}"));
                    self.draft.fail_key(&place, message).allowed(allowed).hint("add it to `free`, or remove it");
                }
            }
        }
    }

    /// Formulas can be read, and a frequency is given once.
    fn force(&mut self) {
        let given: Vec<&str> = FREQUENCIES.into_iter().filter(|f| self.given(&format!("force.{f}"))).collect();
        if let [first, .., last] = given[..] {
            let message = format!("the frequency is given twice, as `{first}` and as `{last}`");
            self.draft.fail_key(&self.place(&format!("force.{last}")), message).hint("keep one");
        }
        if self.given("force.reduced_length") && !self.given("force.reduced_frequency") {
            let message = "`reduced_length` without `reduced_frequency`";
            self.draft.fail_key(&self.place("force.reduced_length"), message).hint("add `reduced_frequency`");
        }
        let streams = self.draft.given("flow.mach") || self.draft.given("flow.velocity");
        if self.given("force.reduced_frequency") && !streams {
            let message = "a reduced frequency needs the speed of the free stream";
            self.draft
                .fail_key(&self.place("force.reduced_frequency"), message)
                .hint("add `mach` to `[flow]`, or give `period`");
        }
        let single = Freedom::ALL.map(|f| self.place(&format!("force.{}", f.name())));
        let modes = (0..self.draft.count(&self.place("mode"))).map(|i| self.place(&format!("mode[{i}].force")));
        for path in single.into_iter().chain(modes.collect::<Vec<_>>()) {
            if let Some(text) = self.draft.get(&path).and_then(Value::as_str).map(str::to_owned) {
                formula(self.draft, &path, &text, !given.is_empty());
            }
        }
    }

    /// Units of mass and time make sense only when the free stream has units; per span in the plane.
    fn units(&mut self) {
        let dimensional = is_dimensional(self.draft);
        let mut paths: Vec<String> =
            ["mass", "inertia", "gravity", "force.frequency", "force.period"].map(|k| self.place(k)).into();
        paths.extend((0..6).map(|i| self.place(&format!("inertia[{i}]"))));
        for table in ["stiffness", "frequency", "initial"] {
            paths.extend(self.inside(table).iter().map(|key| self.place(&format!("{table}.{key}"))));
        }
        paths.extend((0..self.draft.count(&self.place("mode"))).map(|i| self.place(&format!("mode[{i}].frequency"))));
        // a length is one in any case, and so is an angle
        let plain = |path: &str| path.contains(".initial.") && !path.ends_with("_rate");
        for path in paths.into_iter().filter(|p| !plain(p) && self.draft.has_unit(p)).collect::<Vec<_>>() {
            if !dimensional {
                let message = format!("`{path}` has a unit of mass or time, but the free stream is nondimensional");
                let hint = "use the numbers of flutter (`mass_ratio`, `reduced_speed`, …) or plain numbers in units of density, sound \
                            speed and length, or give two of `pressure`, `temperature` and `density` in `[flow]`";
                self.draft.fail(&path, message).hint(hint);
            }
            self.per_span(&path);
        }
    }

    /// Masses, inertias and stiffnesses of the plane are per span, those of space are not.
    fn per_span(&mut self, path: &str) {
        let kind = ["mass", "inertia", "stiffness"].into_iter().find(|k| path.starts_with(&self.place(k)));
        let Some(kind) = kind else { return };
        let unit = self.draft.unit(path).to_owned();
        let (plane, spread) = (self.dimension == 2, PER_SPAN.contains(&unit.as_str()));
        if plane && !spread {
            let message = format!("`{path}` is in {unit}, but in a 2-D case it is per span");
            let example = match kind {
                "mass" => "`kg/m`",
                "inertia" => "`kg m` (kg m² per metre)",
                _ => "`N/m2` (N/m per metre), `N/rad` (N m/rad per metre)",
            };
            self.draft.fail(path, message).hint(format!("divide by the span and write it in {example}"));
        } else if !plane && spread {
            self.draft
                .fail(path, format!("`{path}` is in {unit}, per span, but the case is 3-D"))
                .hint("give that of the whole body");
        }
    }

    /// Modes, and nothing of a rigid body beside them.
    fn modes(&mut self) {
        for key in RIGID.into_iter().filter(|k| self.says(k)).collect::<Vec<_>>() {
            let message = format!("`{key}` says nothing about modes");
            self.draft
                .fail_key(&self.place(key), message)
                .hint("give each `[[structure.mode]]` its own, or change `model`");
        }
        let n = self.draft.count(&self.place("mode"));
        if n == 0 {
            self.missing("no modes", "add a `[[structure.mode]]` with `name`, `file`, `mass` and `frequency`");
        }
        let particles = self.draft.get("motion.particles").and_then(Value::as_str).unwrap_or("deforming").to_owned();
        if particles != "deforming" {
            let message = format!("a {particles} cloud cannot follow a body that bends");
            self.draft.fail(&self.place("model"), message).hint("use `particles = \"deforming\"` in `[motion]`");
        }
        let mut names: Vec<String> = Vec::new();
        for i in 0..n {
            self.mode(&format!("mode[{i}]"), &mut names);
        }
    }

    fn mode(&mut self, mode: &str, names: &mut Vec<String>) {
        let place = self.place(&format!("{mode}.name"));
        if let Some(name) = self.draft.get(&place).and_then(Value::as_str).map(str::to_owned) {
            if !name.chars().all(|c| c.is_ascii_alphanumeric() || "-_".contains(c)) {
                let message = format!("`{name}` cannot be the name of a mode: it names a column");
                self.draft.fail(&place, message).allowed("letters, digits, `-` and `_`");
            }
            if names.contains(&name) {
                let message = format!("two modes are called `{name}`");
                self.draft.fail(&place, message).hint("give each mode a name of its own");
            }
            names.push(name);
        }
        let terms = ["frequency", "reduced_frequency", "stiffness"];
        let given: Vec<&str> = terms.into_iter().filter(|t| self.given(&format!("{mode}.{t}"))).collect();
        match given[..] {
            [] => {
                let message = format!("`{}` has no spring", self.place(mode));
                self.draft.fail_key(&self.place(mode), message).allowed(one_of(terms.into_iter())).hint(
                    "add `frequency = \"9.6 Hz\"`, `reduced_frequency = 0.1` or `stiffness`, zero for a rigid mode",
                );
            }
            [first, .., last] => {
                let message = format!("the spring is given twice, as `{first}` and as `{last}`");
                self.draft.fail_key(&self.place(&format!("{mode}.{last}")), message).hint("keep one");
            }
            _ => {}
        }
    }
}

#[cfg(test)]
mod tests {
    use crate::case::{Case, Freedom, Frequency, Mass, StructureModel, read, write};

    const HEAD: &str = "[flow]\nmach = 0.3\n[[body]]\nname = \"wing\"\nnaca = \"0012\"\n[cloud]\nspacing = 0.01\n[time.dual]\n\
                        until = 1\nstep = 0.1\n";
    const ISOGAI: &str = "elastic_axis = -2.0\nmass_ratio = 60\nx_alpha = 1.8\nr_alpha2 = 3.48\nfrequency_ratio = 1\n\
                          reduced_speed = 18.4\n";
    const AIR: &str = "mach = 0.3\npressure = 101325\ntemperature = 288.15\n";

    fn case(text: &str) -> Case {
        let case = read(text, "case.toml").unwrap_or_else(|e| panic!("{e}"));
        assert_eq!(read(&write(&case), "c").unwrap_or_else(|e| panic!("{e}\n{}", write(&case))), case);
        case
    }

    fn structure(keys: &str) -> String {
        format!("{HEAD}[structure]\n{keys}\n")
    }

    fn solid(keys: &str) -> String {
        structure(keys).replace("naca = \"0012\"", "sphere = { radius = 1 }")
    }

    /// As many mistakes as pieces, each with a hint or what is allowed.
    fn told(text: &str, pieces: &[&str]) {
        let errors = read(text, "case.toml").expect_err(text);
        let shown = errors.render(false);
        for piece in pieces {
            assert!(shown.contains(piece), "`{piece}` is missing in\n{shown}\nfor\n{text}");
        }
        assert_eq!(errors.errors.len(), pieces.len(), "{shown}\nfor\n{text}");
        assert!(errors.errors.iter().all(|e| e.hint.is_some() || e.allowed.is_some()), "{shown}");
    }

    #[test]
    fn sections_are_read_by_the_numbers_of_flutter() {
        let c = case(&structure(&format!(
            "{ISOGAI}damping_ratio = {{ pitch = 0.01 }}\ninitial = {{ pitch = \"1 deg\", plunge_rate = 0.02 }}\n\
             springs = {{ pitch = {{ cubic = 40, free_play = \"0.5 deg\" }} }}\nforce = {{ pitch = \"1e-3*cos(omega*t)\", \
             reduced_frequency = 0.1 }}"
        )));
        let s = c.structure_of(0).unwrap();
        assert_eq!((s.model, s.freedoms(2)), (StructureModel::TypicalSection, vec![Freedom::Plunge, Freedom::Pitch]));
        assert_eq!((s.elastic_axis, s.mass_ratio, s.reduced_speed), (Some(-2.0), Some(60.0), Some(18.4)));
        assert_eq!((s.initial["pitch"], s.initial["plunge_rate"]), (1f64.to_radians(), 0.02));
        assert_eq!((s.springs["pitch"].cubic, s.springs["pitch"].free_play), (40.0, 0.5f64.to_radians()));
        // k = ωL/U with L half the chord of 2
        assert!((c.force_frequency(2.0).unwrap() - 0.1 * 0.3).abs() < 1e-16);
        assert!(c.structure_of(1).is_none());
    }

    #[test]
    fn sections_are_read_with_their_units() {
        let air = HEAD.replace("mach = 0.3\n", AIR);
        let keys = "[[structure]]\nbody = \"wing\"\nfree = [\"plunge\", \"pitch\", \"flap\"]\npivot = [0.4, 0]\nmass = \"12 kg/m\"\n\
                    inertia = \"0.5 kg m\"\ncentre_of_mass = [0.45, 0]\nstiffness = { plunge = \"2.8 kN/m2\" }\n\
                    frequency = { pitch = \"5 Hz\", flap = \"20 Hz\" }\ngravity = [0, \"-9.81 m/s2\"]\n\
                    flap = { hinge_point = [0.8, 0], x_beta = 0.01, r_beta2 = 0.005, blend = 0.02 }\n";
        let c = case(&format!("{air}{keys}"));
        let s = c.structure_of(0).unwrap();
        assert_eq!((s.mass, s.stiffness["plunge"]), (Some(Mass(12.0)), 2800.0));
        assert_eq!(s.frequency["pitch"], Frequency(10.0 * std::f64::consts::PI));
        assert_eq!(s.freedoms(2).last(), Some(&Freedom::Flap));
        let wrong = keys.replace("12 kg/m", "12 kg").replace("0.5 kg m", "0.5 kg m2").replace("kN/m2", "kN/m");
        told(
            &format!("{air}{wrong}"),
            &["`structure[0].mass` is in kg,", "is in kg m2,", "is in kN/m, but in a 2-D case"],
        );
    }

    #[test]
    fn cylinders_and_bodies_in_space_are_read() {
        let c = case(
            &structure("free = \"plunge\"\nmass_ratio = 10\nreduced_velocity = 5")
                .replace("naca = \"0012\"", "circle = { radius = 0.5 }"),
        );
        assert_eq!(c.structure_of(0).unwrap().freedoms(2), [Freedom::Plunge]);
        let c = case(&solid(
            "model = \"rigid_body\"\nmass = 3\ninertia = [1, 1, 2]\ncentre_of_mass = [0, 0, 0.1]\n\
             stiffness = { plunge = 0.2, pitch = 0.1 }\ndamping = { yaw = 0.3 }\ngravity = [0, 0, -0.01]",
        ));
        assert_eq!(c.structure_of(0).unwrap().freedoms(3).len(), 6);
        let modes = "model = \"modal\"\n[[structure.mode]]\nname = \"bending\"\nfile = \"bend.csv\"\nmass = 2\nreduced_frequency = 0.3\n\
                     force = \"sin(t)\"\n[[structure.mode]]\nname = \"torsion\"\nfile = \"twist.csv\"\nmass = 1\nstiffness = 3\n";
        let c = case(&solid(modes));
        assert_eq!(c.structure_of(0).unwrap().modes.len(), 2);
        assert_eq!(c.files().collect::<Vec<_>>(), ["bend.csv", "twist.csv"]);
    }

    #[test]
    fn structures_without_what_they_need_are_refused() {
        let pieces = [
            "no elastic axis",
            "has no mass",
            "no moment of inertia",
            "no spring for `plunge`",
            "no spring for `pitch`",
        ];
        told(&structure(""), &pieces);
        told(&structure("model = \"modal\""), &["has no modes"]);
        told(&solid("model = \"rigid_body\"\nmass = 1\ncentre_of_mass = [0, 0, 0]"), &["no moment of inertia"]);
        told(
            &solid(""),
            &["a typical section needs a 2-D case", "no elastic axis", "no mass", "no moment", "`plunge`", "`pitch`"],
        );
        let mode = "model = \"modal\"\nmass = 3\n[[structure.mode]]\nname = \"a b\"\nfile = \"f\"\nmass = 1\n";
        told(&structure(mode), &["`mass` says nothing about modes", "cannot be the name of a mode", "has no spring"]);
        let flap = format!("{ISOGAI}flap = {{ x_beta = 0.1, r_beta2 = 0.1 }}");
        told(&structure(&flap), &["the flap has no hinge", "no spring for `flap`"]);
        told(
            &structure(&format!("{ISOGAI}free = [\"plunge\", \"pitch\", \"flap\"]")),
            &["there is no flap", "no spring for `flap`"],
        );
    }

    #[test]
    fn structures_that_contradict_themselves_are_refused() {
        told(
            &structure(&format!("{ISOGAI}mass = 3\npivot = [0, 0]\nspeed_index = 2")),
            &[
                "`pivot` and `elastic_axis` are both given",
                "`mass` and `mass_ratio` are both given",
                "`reduced_speed` and `speed_index` are both given",
            ],
        );
        told(&structure(&format!("{ISOGAI}stiffness = {{ pitch = 3 }}")), &["the spring of `pitch` is given twice"]);
        told(
            &structure(&format!("{ISOGAI}damping_ratio = {{ pitch = 0.1 }}\ndamping = {{ pitch = 1 }}")),
            &["damping of `pitch` is given twice"],
        );
        told(&structure(&format!("{ISOGAI}initial = {{ surge = 1 }}")), &["`initial` of `surge`, which is not free"]);
        told(
            &structure(&format!("{ISOGAI}free = [\"sway\"]")),
            &[
                "there is no `sway` in a 2-D case",
                "fixes the spring of pitch or plunge",
                "over the frequency of pitch",
                "no spring for `sway`",
            ],
        );
        told(&structure(&ISOGAI.replace("mass_ratio = 60", "mass = \"3 kg/m\"")), &["has a unit of mass or time"]);
        told(
            &structure(&format!("{ISOGAI}force = {{ pitch = \"sn(t)\", plunge = \"cos(omega*t)\" }}")),
            &["unknown name `sn`", "uses `omega`, but there is no frequency"],
        );
        told(&structure(&format!("{ISOGAI}stifness = {{ pitch = 3 }}")), &["did you mean `stiffness`?"]);
        told(
            &structure(&format!("{ISOGAI}pivot = [0, 0, 0]").replace("elastic_axis = -2.0\n", "")),
            &["has 3 components in a 2-D case"],
        );
    }

    #[test]
    fn structures_belong_to_bodies() {
        let other = "[[body]]\nnaca = \"0006\"\n";
        told(&format!("{}{other}", structure(ISOGAI)), &["does not say which body it is"]);
        told(&structure(&format!("body = \"wng\"\n{ISOGAI}")), &["did you mean `\"wing\"`?"]);
        let twice = format!("{HEAD}[[structure]]\n{ISOGAI}[[structure]]\n{ISOGAI}");
        told(&twice, &["the body `wing` has two structures"]);
        told(
            &format!("{}[motion]\nplunge = 0.1\nperiod = 3\n", structure(ISOGAI)),
            &["cannot have a prescribed motion as well"],
        );
        let bare = "[flow]\nmach = 0.3\n[cloud]\nspacing = 0.1\ndomain = { min = [0, 0], max = [1, 1] }\n[structure]\n";
        told(&format!("{bare}{ISOGAI}"), &["has no body"]);
    }

    #[test]
    fn a_force_with_a_frequency_makes_periods() {
        let march = "steps_per_period = 64\nperiods = 3\n";
        let text = structure(ISOGAI).replace("until = 1\nstep = 0.1\n", march);
        told(
            &text,
            &["`time.dual.periods` needs a periodic motion", "`time.dual.steps_per_period` needs a periodic motion"],
        );
        case(&format!("{text}force = {{ pitch = \"cos(omega*t)\", period = 20 }}\n"));
    }
}
