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
    /// Modes, and nothing of a rigid body beside them.
    pub(super) fn modes(&mut self) {
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
