//! Springs, dampers and forces of structures.
use serde_json::{Value, json};

use super::super::facts::{FREQUENCIES, formula};
use super::super::structure::Freedom;
use super::{Look, SPEEDS};

impl Look<'_, '_> {
    /// One spring for each coordinate, and what its terms need.
    pub(super) fn stiffness(&mut self) {
        let leading = if self.is_free(Freedom::Pitch) { Freedom::Pitch } else { Freedom::Plunge };
        self.varied_speed(leading);
        let speed = SPEEDS.into_iter().find(|s| self.has(s));
        if let Some(speed) = speed.filter(|_| !self.draft.given("flow.mach") && !self.draft.given("flow.velocity")) {
            let message = format!("`{speed}` needs the speed of the free stream");
            self.draft.fail_key(&self.place(speed), message).hint("add `mach` to `[flow]`");
        }
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
            let given: Vec<String> = keys.into_iter().flatten().filter(|k| self.has(k)).collect();
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

    /// Where the speed is what is sought, a section whose springs nothing else fixes has them at a speed index of one.
    fn varied_speed(&mut self, leading: Freedom) {
        let of_leading = ["stiffness", "frequency"].map(|k| format!("{k}.{}", leading.name()));
        let fixed = of_leading.iter().map(String::as_str).chain(SPEEDS).any(|k| self.given(k));
        let over_pitch = leading == Freedom::Plunge && self.given("frequency_ratio");
        let sought = self.draft.get("flutter").is_some_and(Value::is_object);
        if !(sought && self.section && self.is_free(leading)) || fixed || over_pitch {
            return;
        }
        if let Some(structure) = self.draft.get_mut(&self.path).and_then(Value::as_object_mut) {
            structure.insert("speed_index".to_owned(), json!(1.0));
        }
    }

    pub(super) fn no_spring(&mut self, f: Freedom) {
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
    pub(super) fn damping(&mut self) {
        for name in self.inside("damping_ratio") {
            let place = self.place(&format!("damping_ratio.{name}"));
            if self.given(&format!("damping.{name}")) {
                self.draft.fail_key(&place, format!("the damping of `{name}` is given twice")).hint("keep one");
            }
            let zero = self.draft.number(&self.place(&format!("stiffness.{name}"))) == Some(0.0);
            let none = !self.section && ["stiffness", "frequency"].iter().all(|k| !self.given(&format!("{k}.{name}")));
            let led = SPEEDS.iter().any(|s| self.has(s)) && ["plunge", "pitch"].contains(&name.as_str());
            if zero || (none && !led) {
                let message = format!("a damping ratio of `{name}`, which has no spring");
                self.draft.fail_key(&place, message).hint("use `damping`, or give it a spring");
            }
        }
    }

    /// Formulas can be read, and a frequency is given once.
    pub(super) fn force(&mut self) {
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
}
