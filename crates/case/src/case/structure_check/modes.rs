//! Structures by their modes.
use serde_json::Value;

use super::super::schema::one_of;
use super::Look;

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

impl Look<'_, '_> {
    /// Own modes: of a body made of particles, and nothing else beside them.
    pub(super) fn own_modes(&mut self) {
        for key in RIGID.into_iter().chain(["mode"]).filter(|k| self.says(k)).collect::<Vec<_>>() {
            let message = format!("`{key}` does not apply to the natural modes of a body");
            self.draft
                .fail_key(&self.place(key), message)
                .hint("remove it: `[body.solid]` has masses, stiffness, damping, velocity and gravity");
        }
        let wanted = self.draft.get(&self.place("body")).filter(|v| !v.is_null()).cloned();
        let called = |b: &usize| wanted.is_none() || self.draft.get(&format!("body[{b}].name")) == wanted.as_ref();
        let Some(body) = (0..self.draft.count("body")).find(called) else { return };
        let solid = format!("body[{body}].solid");
        if !self.draft.given(&solid) {
            let message = format!("`body[{body}]` is not made of particles: it has no modes of its own");
            let hint = "add `[body.solid]`, or give modes in files: `model = \"modal\"`";
            self.draft.fail(&self.place("model"), message).hint(hint);
            return;
        }
        if self.dimension == 3 {
            let of_particles = ["through", "fill", "jitter", "stabilisation"].map(|k| format!("{solid}.{k}"));
            // a written case repeats its defaults
            let says = |k: &String| self.draft.given(k) && self.draft.number(k) != Some(0.0);
            for place in of_particles.into_iter().filter(says).collect::<Vec<_>>() {
                let message =
                    format!("`{place}` is of particles: own modes in space are found among splines over the body");
                self.draft
                    .fail_key(&place, message)
                    .hint("remove it; `spacing` is the length of a cell of the splines");
            }
        }
        let led = |k: &usize| self.draft.count(&format!("{solid}.support[{k}].motion")) > 0;
        let led = (0..self.draft.count(&format!("{solid}.support"))).find(led);
        let loads = (self.draft.count(&format!("{solid}.load")) > 0).then(|| format!("{solid}.load"));
        for place in led.map(|k| format!("{solid}.support[{k}].motion")).into_iter().chain(loads) {
            let message = format!("`{place}` does not act on a body that moves in own modes");
            self.draft
                .fail_key(&place, message)
                .hint("remove it, or remove the `[structure]`: all particles then move");
        }
        self.deforms();
    }

    /// Modes, and nothing of a rigid body beside them.
    pub(super) fn modes(&mut self) {
        for key in RIGID.into_iter().filter(|k| self.says(k)).collect::<Vec<_>>() {
            let message = format!("`{key}` does not apply to modes");
            self.draft
                .fail_key(&self.place(key), message)
                .hint("give each `[[structure.mode]]` its own, or change `model`");
        }
        let n = self.draft.count(&self.place("mode"));
        if n == 0 {
            self.missing("no modes", "add a `[[structure.mode]]` with `name`, `file`, `mass` and `frequency`");
        }
        self.deforms();
        let mut names: Vec<String> = Vec::new();
        for i in 0..n {
            self.mode(&format!("mode[{i}]"), &mut names);
        }
    }

    /// The cloud follows a body that bends.
    fn deforms(&mut self) {
        let particles = self.draft.get("motion.particles").and_then(Value::as_str).unwrap_or("deforming").to_owned();
        if particles != "deforming" {
            let message = format!("a {particles} cloud cannot follow a body that bends");
            self.draft.fail(&self.place("model"), message).hint("use `particles = \"deforming\"` in `[motion]`");
        }
    }

    pub(super) fn mode(&mut self, mode: &str, names: &mut Vec<String>) {
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
