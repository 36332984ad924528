//! Units of structures: of mass and time only in a stream that has them, per span in the plane.
use super::super::facts::is_dimensional;
use super::super::quantity::plain_symbol;
use super::Look;

/// Units of masses, inertias, stiffnesses and dampers per span: those of the plane.
const PER_SPAN: [&str; 24] = [
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
    "N s/m2",
    "kN s/m2",
    "N s/m/m",
    "lbf s/ft2",
    "N s/rad",
    "N m s/rad/m",
    "N s",
    "lbf s/rad",
];
/// What has them, and examples.
const SPREAD: [(&str, &str); 4] = [
    ("mass", "`kg/m`"),
    ("inertia", "`kg m` (kg m² per metre)"),
    ("stiffness", "`N/m2` (N/m per metre), `N/rad` (N m/rad per metre)"),
    ("damping", "`N s/m2` (N s/m per metre), `N s/rad` (N m s/rad per metre)"),
];
/// Keys of a mode that may have units of mass or time.
const OF_MODES: [&str; 4] = ["mass", "frequency", "stiffness", "initial_rate"];

impl Look<'_, '_> {
    /// Units of mass and time make sense only when the free stream has units; per span in the plane.
    pub(super) fn units(&mut self) {
        let dimensional = is_dimensional(self.draft);
        let mut paths: Vec<String> =
            ["mass", "gravity", "force.frequency", "force.period"].map(|k| self.place(k)).into();
        paths.extend((0..6).map(|i| self.place(&format!("inertia[{i}]"))));
        for table in ["stiffness", "frequency", "damping", "initial"] {
            paths.extend(self.inside(table).iter().map(|key| self.place(&format!("{table}.{key}"))));
        }
        for i in 0..self.draft.count(&self.place("mode")) {
            paths.extend(OF_MODES.map(|key| self.place(&format!("mode[{i}].{key}"))));
        }
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
    pub(super) fn per_span(&mut self, path: &str) {
        let own = path.trim_start_matches(&self.path).trim_start_matches('.');
        let own = own.split_once("].").filter(|_| own.starts_with("mode[")).map_or(own, |(_, key)| key);
        let Some((_, example)) = SPREAD.into_iter().find(|(key, _)| own.starts_with(key)) else { return };
        let unit = self.draft.unit(path).to_owned();
        let (plane, spread) = (self.dimension == 2, PER_SPAN.contains(&plain_symbol(&unit).as_str()));
        if plane && !spread {
            let message = format!("`{path}` is in {unit}, but in a 2-D case it is per span");
            self.draft.fail(path, message).hint(format!("divide by the span and write it in {example}"));
        } else if !plane && spread {
            self.draft
                .fail(path, format!("`{path}` is in {unit}, per span, but the case is 3-D"))
                .hint("give that of the whole body");
        }
    }
}
