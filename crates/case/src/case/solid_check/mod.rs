//! Contradictions in `[body.solid]` and `[contact]`, and between them and what is said of a gas.
mod material;
#[cfg(test)]
mod tests;

use serde_json::Value;

use super::draft::Draft;
use super::facts::{FREQUENCIES, formula, formula_in, has_gas, is, is_dimensional};
use super::structure_check::prescribed;

/// Keys of `[output]` that are of a gas.
pub(super) const OUTPUT_OF_GAS: [&str; 3] = ["field_particles", "loop_periods", "stations"];
/// Tables that say something of a gas, of its loads or of bodies that move in it.
pub(super) const OF_GAS: [&str; 14] = [
    "motion",
    "structure",
    "reference",
    "cloud",
    "accuracy",
    "boundary",
    "initial",
    "scheme",
    "adapt",
    "compare",
    "hinge",
    "gaf",
    "flutter",
    "lco",
];
const AXES: [&str; 3] = ["x", "y", "z"];
/// Keys of a solid that have units of mass or time, but those of materials and loads.
const RATES: [&str; 3] = ["damping", "stiffness_damping", "gravity"];

/// One body made of particles under the eye of the checks.
struct Look<'d, 't> {
    draft: &'d mut Draft<'t>,
    /// Its number.
    body: usize,
    /// Key path of its `solid`.
    path: String,
    /// Number of space dimensions.
    dimension: usize,
}

/// Looks for contradictions in all bodies made of particles.
pub(super) fn contradictions(draft: &mut Draft<'_>, dimension: Option<usize>) {
    let solids: Vec<usize> = (0..draft.count("body")).filter(|i| draft.given(&format!("body[{i}].solid"))).collect();
    let gas = has_gas(draft);
    time(draft, gas);
    if !gas {
        alone(draft);
    }
    contact(draft, solids.is_empty(), dimension);
    probes(draft, &solids);
    alike(draft, &solids);
    let Some(dimension) = dimension else { return };
    for body in solids {
        let path = format!("body[{body}].solid");
        if draft.get(&path).is_none_or(Value::is_null) {
            continue;
        }
        let mut look = Look { draft, body, path, dimension };
        look.moves_by_itself();
        look.particles();
        look.plane();
        look.components();
        look.materials();
        look.supports();
        look.loads();
        look.units();
    }
}

/// What holds for the particles of all bodies together is said alike wherever it is said.
fn alike(draft: &mut Draft<'_>, solids: &[usize]) {
    const OF_ALL: [&str; 7] =
        ["plane", "thickness", "gravity", "damping", "stiffness_damping", "stabilisation", "viscosity"];
    let Some((first, others)) = solids.split_first() else { return };
    for (body, key) in others.iter().flat_map(|body| OF_ALL.map(|key| (body, key))) {
        let [here, there] = [body, first].map(|k| format!("body[{k}].solid.{key}"));
        if draft.given(&here) && draft.get(&here) != draft.get(&there) {
            let message = format!("`{here}` is not what `{there}` says, which holds for all bodies made of particles");
            draft.fail_key(&here, message).hint(format!("give `{key}` at the first of them, or alike"));
        }
    }
}

/// Structures alone: nothing is said of a gas, and every body is made of particles.
fn alone(draft: &mut Draft<'_>) {
    let outputs = OUTPUT_OF_GAS.map(|key| format!("output.{key}"));
    let all = OF_GAS.into_iter().map(str::to_owned).chain(outputs);
    for key in all.filter(|k| draft.given(k)).collect::<Vec<_>>() {
        let message = format!("structures alone: `{key}` is for cases with a gas");
        draft.fail_key(&key, message).hint("remove it, or add the free stream of the gas in `[flow]`");
    }
    for body in (0..draft.count("body")).map(|i| format!("body[{i}]")).collect::<Vec<_>>() {
        if draft.get(&body).is_some_and(|b| !b.is_null()) && !draft.given(&format!("{body}.solid")) {
            let message = format!("structures alone: `{body}` is rigid, and there is no gas around it");
            draft.fail_key(&body, message).hint("add `solid = { material = …, through = 5 }`, or `[flow]`");
        }
    }
}

/// Newmark steps and modes are of structures alone, implicit steps of the gas are not.
fn time(draft: &mut Draft<'_>, gas: bool) {
    let said = |draft: &Draft<'_>, key: &str| draft.get(&format!("time.{key}")).is_some_and(|v| !v.is_null());
    let of_structures = [
        ("newmark", "use `[time.dual]` or `[time.explicit]`: gas and structures march together"),
        ("modes", "leave `[flow]` out of a case of vibrations"),
        ("steady.load_steps", "remove it"),
        ("harmonics.frequency", "remove it: the motion has the frequency"),
        ("harmonics.period", "remove it: the motion has the period"),
    ];
    for (key, hint) in of_structures.into_iter().filter(|(k, _)| gas && said(draft, k)).collect::<Vec<_>>() {
        draft.fail_key(&format!("time.{key}"), format!("`time.{key}` is for structures alone")).hint(hint);
    }
    if gas {
        return;
    }
    if said(draft, "dual") {
        let hint = "use `[time.newmark]` with `step` and `until`";
        draft.fail_key("time.dual", "structures alone: `time.dual` is for cases with a gas").hint(hint);
    }
    for key in ["march", "check"].map(|k| format!("time.harmonics.{k}")) {
        if draft.number(&key).is_some_and(|periods| periods > 0.0) {
            let hint = "remove it; `[time.newmark]` of a case of its own marches";
            draft.fail(&key, format!("structures alone: `{key}` is for cases with a gas")).hint(hint);
        }
    }
    let given: Vec<bool> = ["frequency", "period"].map(|k| draft.given(&format!("time.harmonics.{k}"))).to_vec();
    if said(draft, "harmonics") && given[0] == given[1] {
        let message =
            if given[0] { "`frequency` and `period` are both given" } else { "`time.harmonics` has no frequency" };
        let hint = if given[0] { "keep one" } else { "add `frequency = \"5 Hz\"` or `period = 0.2`" };
        draft.fail_key("time.harmonics", message).hint(hint);
    }
}

/// Contact is of bodies made of particles; planes have a point and a direction.
fn contact(draft: &mut Draft<'_>, rigid: bool, dimension: Option<usize>) {
    if !draft.given("contact") {
        return;
    }
    if rigid {
        draft
            .fail_key("contact", "`[contact]` is of bodies made of particles")
            .hint("give a body `solid`, or remove it");
    }
    for plane in (0..draft.count("contact.planes")).map(|i| format!("contact.planes[{i}]")) {
        for key in ["point", "normal"].map(|k| format!("{plane}.{k}")) {
            count(draft, &key, dimension);
        }
        let normal = format!("{plane}.normal");
        if draft.numbers(&normal).is_some_and(|n| n.iter().all(|c| *c == 0.0)) {
            draft.fail(&normal, format!("`{normal}` is a direction of no length")).hint("give at least one component");
        }
    }
}

/// Probes have names of their own.
fn probes(draft: &mut Draft<'_>, solids: &[usize]) {
    let mut names: Vec<String> = Vec::new();
    for list in solids.iter().map(|i| format!("body[{i}].solid.probe")) {
        for place in (0..draft.count(&list)).map(|k| format!("{list}[{k}].name")) {
            let Some(name) = draft.get(&place).and_then(Value::as_str).map(str::to_owned) else { continue };
            if names.contains(&name) {
                let message = format!("two probes are called `{name}`");
                draft.fail(&place, message).hint("give each probe a name of its own");
            }
            names.push(name);
        }
    }
}

/// The list at `path` has no, or `dimension` components.
fn count(draft: &mut Draft<'_>, path: &str, dimension: Option<usize>) {
    let n = draft.count(path);
    if let Some(d) = dimension.filter(|d| n != 0 && n != *d) {
        draft.fail(path, format!("`{path}` has {n} components in a {d}-D case")).allowed(format!("{d} values"));
    }
}

impl Look<'_, '_> {
    fn place(&self, key: &str) -> String {
        format!("{}.{key}", self.path)
    }

    fn given(&self, key: &str) -> bool {
        self.draft.given(&self.place(key))
    }

    /// Key paths of the tables in the list `key`.
    fn each(&self, key: &str) -> Vec<String> {
        let list = self.place(key);
        let known = |path: &String| self.draft.get(path).is_some_and(|v| !v.is_null());
        (0..self.draft.count(&list)).map(|k| format!("{list}[{k}]")).filter(known).collect()
    }

    fn text(&self, path: &str) -> Option<String> {
        self.draft.get(path)?.as_str().map(str::to_owned)
    }

    /// Where the body is follows from its own equations.
    fn moves_by_itself(&mut self) {
        let (draft, body) = (&mut *self.draft, self.body);
        let gas = has_gas(draft);
        if !gas && draft.given(&format!("body[{body}].motion")) {
            prescribed(draft, body, "a body made of particles");
        }
        let name = draft.get(&format!("body[{body}].name")).cloned();
        for spring in (0..draft.count("structure")).map(|k| format!("structure[{k}]")).filter(|_| gas) {
            let wanted = draft.get(&format!("{spring}.body")).cloned();
            if draft.get(&format!("{spring}.model")).is_some_and(|m| m == "own_modes") {
                continue;
            }
            if wanted.is_none() && draft.count("body") == 1 || wanted.is_some() && wanted == name {
                let hint = "remove `solid` or the structure; supports are in `[[body.solid.support]]`";
                draft.fail_key(&spring, "a body made of particles cannot be on springs as well").hint(hint);
            }
        }
    }

    /// One of the two keys that say how fine the particles are, at most.
    fn particles(&mut self) {
        if self.given("spacing") && self.given("through") {
            let message = "`spacing` and `through` are both given";
            self.draft.fail_key(&self.place("through"), message).hint("keep one");
        }
    }

    /// What is said of the plane is said in the plane.
    fn plane(&mut self) {
        let (plane, thickness) = (self.place("plane"), self.place("thickness"));
        let round = is(self.draft, &plane, "axisymmetric");
        let thick = self.draft.number(&thickness).is_some_and(|t| t != 1.0);
        if self.dimension == 3 && self.draft.get(&plane).is_some() && !is(self.draft, &plane, "strain") {
            self.draft.fail(&plane, format!("`{plane}` needs a 2-D case")).hint("remove it");
        } else if round && has_gas(self.draft) {
            let hint = "use a 3-D case, or leave `[flow]` out";
            self.draft.fail(&plane, "an axisymmetric body cannot be in the plane flow of a gas").hint(hint);
        }
        let gravity = self.place("gravity");
        if round && self.draft.numbers(&gravity).is_some_and(|g| g.first().is_some_and(|x| *x != 0.0)) {
            let message = format!("`{gravity}` across the axis of an axisymmetric body");
            self.draft.fail(&gravity, message).hint("gravity acts along the axis, `gravity = [0, \"-9.81 m/s2\"]`");
        }
        if thick && (self.dimension == 3 || round) {
            let what = if round { "of an axisymmetric body, which is a full turn" } else { "in a 3-D case" };
            self.draft.fail(&thickness, format!("`{thickness}` {what}")).hint("remove it");
        } else if thick && has_gas(self.draft) {
            let message = format!("`{thickness}` beside a gas, which acts on one unit of length across the plane");
            let hint = "remove it: masses, forces and loads are those of one unit of length; divide a `force` by the thickness";
            self.draft.fail(&thickness, message).hint(hint);
        }
    }

    /// Lists have as many components as the case, and velocities are formulas of the place.
    fn components(&mut self) {
        let d = self.dimension;
        let mut lists = ["velocity", "gravity"].map(|k| self.place(k)).to_vec();
        for load in self.each("load") {
            lists.extend(["traction", "force"].map(|k| format!("{load}.{k}")));
        }
        lists.extend(self.each("probe").iter().map(|p| format!("{p}.at")));
        for list in lists {
            count(self.draft, &list, Some(d));
        }
        let velocity = self.place("velocity");
        for path in (0..self.draft.count(&velocity)).map(|k| format!("{velocity}[{k}]")) {
            let Some(text) = self.text(&path) else { continue };
            formula_in(d, self.draft, &path, &text, false);
        }
    }

    /// Supports hold axes that there are, once, and lead each along one path.
    fn supports(&mut self) {
        for support in self.each("support") {
            self.place_of(&support);
            let fix = format!("{support}.fix");
            let axes = self.draft.get(&fix).and_then(Value::as_array).cloned().unwrap_or_default();
            if self.dimension == 2 && axes.iter().any(|a| a == "z") {
                self.draft.fail(&fix, "there is no axis `z` in a 2-D case").allowed("`x` and `y`");
            } else if (1..axes.len()).any(|k| axes[..k].contains(&axes[k])) {
                self.draft.fail(&fix, format!("`{fix}` names an axis twice")).hint("name each axis once");
            }
            let motion = format!("{support}.motion");
            let held = if axes.is_empty() { self.dimension } else { axes.len() };
            let n = self.draft.count(&motion);
            if n != 0 && n != held {
                let message = format!("`{motion}` has {n} displacements, but {held} axes are held");
                self.draft.fail(&motion, message).allowed(format!("{held} values, in the order of `fix`"));
            }
            for path in (0..n).map(|k| format!("{motion}[{k}]")) {
                self.in_time(&path);
            }
        }
        for region in self.each("region") {
            self.place_of(&region);
        }
    }

    /// A load is one of three, with a history that can be read.
    fn loads(&mut self) {
        for load in self.each("load") {
            self.place_of(&load);
            let kinds = ["pressure", "traction", "force"];
            let given: Vec<&str> = kinds.into_iter().filter(|k| self.draft.given(&format!("{load}.{k}"))).collect();
            match given[..] {
                [] => {
                    let message = format!("`{load}` has no load");
                    self.draft.fail_key(&load, message).hint("add one of `pressure`, `traction` and `force`");
                }
                [_] => {}
                [first, .., last] => {
                    let message = format!("`{first}` and `{last}` are both given");
                    self.draft
                        .fail_key(&format!("{load}.{last}"), message)
                        .hint("a second load is a `load` of its own");
                }
            }
            self.in_time(&format!("{load}.history"));
        }
    }

    /// The formula in time at `path`, if there is one, can be read.
    fn in_time(&mut self, path: &str) {
        let Some(text) = self.text(path) else { return };
        let balance = ["frequency", "period"].iter().any(|k| self.draft.given(&format!("time.harmonics.{k}")));
        let moves = FREQUENCIES.iter().any(|f| self.draft.given(&format!("motion.{f}")));
        if balance || moves || !text.contains("omega") {
            return formula(self.draft, path, &text, balance || moves);
        }
        let at = text.find("omega").unwrap_or(0);
        let message = format!("`{path}` uses `omega`, but there is no frequency");
        self.draft
            .fail_within(path, at..at + 5, message)
            .hint("write the frequency as a number, `sin(2 * pi * 5 * t)`");
    }

    /// `where` of the table at `path` is a box with some side and something inside.
    fn place_of(&mut self, path: &str) {
        let place = format!("{path}.where");
        if self.draft.get(&place).is_none_or(|p| !p.is_object()) {
            return;
        }
        let at = |draft: &Draft<'_>, axis: &str, end: &str| draft.number(&format!("{place}.{axis}_{end}"));
        let said = |draft: &Draft<'_>, axis: &str, end: &str| draft.given(&format!("{place}.{axis}_{end}"));
        if !AXES.iter().any(|a| said(self.draft, a, "min") || said(self.draft, a, "max")) {
            let message = format!("`{place}` has no bound");
            self.draft.fail(&place, message).hint("give some of `x_min`, `x_max`, `y_min`, …, or `where = \"all\"`");
        }
        for axis in AXES {
            if self.dimension == 2 && axis == "z" && (said(self.draft, "z", "min") || said(self.draft, "z", "max")) {
                self.draft.fail(&place, format!("`{place}` bounds `z` in a 2-D case")).hint("remove it");
            }
            if let (Some(low), Some(high)) = (at(self.draft, axis, "min"), at(self.draft, axis, "max"))
                && low > high
            {
                let message = format!("`{place}` is empty: `{axis}_min` is {low}, `{axis}_max` is {high}");
                self.draft.fail(&place, message).hint("swap them");
            }
        }
    }

    /// Units of mass and time, and materials of the catalogue, make sense only where the case has units.
    fn units(&mut self) {
        if is_dimensional(self.draft) {
            return;
        }
        let mut paths: Vec<String> = RATES.map(|k| self.place(k)).to_vec();
        for load in self.each("load") {
            paths.extend(["pressure", "traction", "force"].map(|k| format!("{load}.{k}")));
        }
        let mut bases = Vec::new();
        for material in self.material_paths() {
            paths.extend(material::DIMENSIONAL.map(|k| format!("{material}.{k}")));
            bases.extend(self.draft.get(&format!("{material}.base")).is_some().then_some(material));
        }
        let hint = "give two of `pressure`, `temperature` and `density` in `[flow]`";
        for path in paths.into_iter().filter(|p| self.draft.has_unit(p)).collect::<Vec<_>>() {
            let message = format!("`{path}` has a unit of mass or time, but the free stream is nondimensional");
            self.draft.fail(&path, message).hint(hint);
        }
        for base in bases {
            let message =
                format!("`{base}` is one of the catalogue, in SI units, but the free stream is nondimensional");
            self.draft.fail(&base, message).hint(hint);
        }
    }
}
