//! Contradictions in `[structure]`.
mod modes;
mod sane;
mod springs;
#[cfg(test)]
mod tests;
mod units;

use serde_json::Value;

use super::draft::{Draft, closest};
use super::facts::says_something;
use super::schema::one_of;
use super::structure::Freedom;

const SPEEDS: [&str; 3] = ["reduced_speed", "reduced_velocity", "speed_index"];
/// Parts of a motion that prescribe where a body is.
const PARTS: [&str; 7] = ["pitch", "plunge", "rotation", "translation", "table", "formula", "mode"];
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
        match model.as_str() {
            "own_modes" => look.own_modes(),
            "modal" => look.modes(),
            _ => look.rigid(),
        }
        if model != "own_modes" && look.given("number") {
            let place = look.place("number");
            let message = "`number` is that of own modes";
            look.draft.fail_key(&place, message).hint("remove it, or say `model = \"own_modes\"`");
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
        prescribed(draft, body, "a body on springs");
    }
}

/// Nothing prescribes where a body is whose coordinates are unknowns; `what` it is.
pub(super) fn prescribed(draft: &mut Draft<'_>, body: usize, what: &str) {
    let own = format!("body[{body}].motion");
    let law = if draft.given(&own) { own } else { "motion".to_owned() };
    let part = PARTS.iter().map(|part| format!("{law}.{part}")).find(|part| says_something(draft, part));
    if let Some(part) = part {
        let hint = "remove one of the two; `motion = {}` in the `[[body]]` keeps `[motion]` away from it";
        draft.fail_key(&part, format!("{what} cannot have a prescribed motion as well")).hint(hint);
    }
}

/// Coordinates that are unknowns, as [`super::Structure::freedoms`] has them.
fn freedoms(draft: &Draft<'_>, path: &str, model: &str, dimension: usize) -> Vec<Freedom> {
    let listed = draft.get(&format!("{path}.free")).and_then(Value::as_array).cloned().unwrap_or_default();
    let flap = draft.given(&format!("{path}.flap"));
    let free = |f: &Freedom| match (listed.is_empty(), model) {
        (_, "modal" | "own_modes") => false,
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

    /// Given, or filled in.
    fn has(&self, key: &str) -> bool {
        self.draft.get(&self.place(key)).is_some_and(|v| !v.is_null()) || self.given(key)
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
        self.sane();
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
}
