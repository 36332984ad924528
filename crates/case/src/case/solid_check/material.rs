//! Materials of solids: two elastic moduli that fit together, and what the law needs.
use serde_json::Value;

use super::Look;

const MODULI: [&str; 4] = ["young", "poisson", "shear", "bulk"];
/// Keys that only a plastic material has.
const PLASTIC: [&str; 7] =
    ["yield", "hardening", "saturation", "saturation_rate", "kinematic", "johnson_cook", "perzyna"];
/// Keys with units of mass or time.
pub(super) const DIMENSIONAL: [&str; 8] =
    ["density", "young", "shear", "bulk", "yield", "hardening", "saturation", "kinematic"];

impl Look<'_, '_> {
    /// Key paths of all materials of the body.
    pub(super) fn material_paths(&self) -> Vec<String> {
        let mut all = vec![self.place("material")];
        all.extend(self.each("region").iter().map(|region| format!("{region}.material")));
        all.retain(|path| self.draft.get(path).is_some_and(Value::is_object));
        all
    }

    pub(super) fn materials(&mut self) {
        for path in self.material_paths() {
            let based = self.draft.get(&format!("{path}.base")).is_some();
            self.elasticity(&path, based);
            self.plasticity(&path, based);
            self.relaxation(&path, based);
            self.heat(&path, based);
        }
    }

    fn of(&self, path: &str, key: &str) -> Option<f64> {
        self.draft.number(&format!("{path}.{key}"))
    }

    fn said(&self, path: &str, key: &str) -> bool {
        self.draft.given(&format!("{path}.{key}"))
    }

    /// Density, and two moduli that a stable material may have.
    fn elasticity(&mut self, path: &str, based: bool) {
        if !based && !self.said(path, "density") {
            let hint = "add `density = \"2700 kg/m3\"`, or a `base` of the catalogue";
            self.draft.fail(path, format!("`{path}` has no density")).hint(hint);
        }
        let given: Vec<&str> = MODULI.into_iter().filter(|k| self.said(path, k)).collect();
        if self.orthotropic(path, given.first()) {
            return;
        }
        let hint = "give two of `young`, `poisson`, `shear` and `bulk`";
        match given[..] {
            [] | [_] if based => {}
            [] | [_] => {
                let has = given.first().map_or_else(|| "no elastic modulus".to_owned(), |k| format!("`{k}` alone"));
                self.draft
                    .fail(path, format!("`{path}` has {has}"))
                    .hint(format!("{hint}, or a `base` of the catalogue"));
            }
            [_, _] => {}
            [.., last] => {
                let message = format!("`{path}` has {} elastic moduli, which follow from two", given.len());
                self.draft.fail_key(&format!("{path}.{last}"), message).hint(hint);
            }
        }
        let [young, poisson, shear, bulk] = MODULI.map(|k| self.of(path, k));
        let (place, ratio) = match (young, poisson, shear, bulk) {
            (_, Some(nu), _, _) => ("poisson", nu),
            (Some(e), None, Some(g), None) => ("shear", 0.5 * e / g - 1.0),
            (Some(e), None, None, Some(k)) => ("bulk", 0.5 - e / (6.0 * k)),
            _ => return,
        };
        if !(-1.0 < ratio && ratio < 0.5) {
            let message =
                format!("Poisson's ratio of `{path}` is {ratio}, but must be greater than -1 and less than 0.5");
            self.draft.fail(&format!("{path}.{place}"), message).hint("0.49 is nearly incompressible");
        }
    }

    /// True for a material with constants for each axis, which has no others and no other law.
    fn orthotropic(&mut self, path: &str, given: Option<&&str>) -> bool {
        let law = self.text(&format!("{path}.law"));
        if !self.said(path, "orthotropic") {
            if law.as_deref() == Some("orthotropic") {
                let message = format!("`{path}` is orthotropic, but has no constants for each axis");
                let hint = "add `orthotropic = { young = [E1, E2, E3], poisson = [nu12, nu13, nu23], shear = [G12, G13, G23] }`";
                self.draft.fail(&format!("{path}.law"), message).hint(hint);
            }
            return law.as_deref() == Some("orthotropic");
        }
        if let Some(key) = given {
            let message = format!("`{key}` of a material with `orthotropic` constants");
            self.draft.fail_key(&format!("{path}.{key}"), message).hint("remove it, or `orthotropic`");
        }
        if let Some(law) = law.filter(|law| law != "orthotropic") {
            let message = format!("`orthotropic` constants of a material whose law is `{law}`");
            self.draft.fail(&format!("{path}.law"), message).hint("remove `law`, or `orthotropic`");
        }
        true
    }

    /// What yields is plastic, and what is plastic yields somewhere, once.
    fn plasticity(&mut self, path: &str, based: bool) {
        let law = self.text(&format!("{path}.law"));
        let yields = ["yield", "johnson_cook"].into_iter().filter(|k| self.said(path, k)).collect::<Vec<_>>();
        if let [_, second] = yields[..] {
            let message = "`yield` and `johnson_cook` are both given";
            self.draft.fail_key(&format!("{path}.{second}"), message).hint("keep one");
        }
        let plastic = match law.as_deref() {
            Some(law) => law == "plastic",
            None => based || !yields.is_empty(),
        };
        if law.as_deref() == Some("plastic") && yields.is_empty() && !based {
            let message = format!("`{path}` is plastic, but never yields");
            self.draft.fail(&format!("{path}.law"), message).hint("add `yield = \"300 MPa\"` or `johnson_cook`");
        }
        if let Some(key) = PLASTIC.into_iter().find(|k| self.said(path, k)).filter(|_| !plastic) {
            let message = match law {
                Some(law) => format!("`{key}` of a material whose law is `{law}`"),
                None => format!("`{key}` of a material that never yields"),
            };
            let hint = "set `law = \"plastic\"` with `yield`, or remove the key";
            self.draft.fail_key(&format!("{path}.{key}"), message).hint(hint);
        }
        if self.said(path, "saturation") != self.said(path, "saturation_rate") && !based {
            let message = "exponential hardening needs both `saturation` and `saturation_rate`";
            self.draft.fail(path, message).hint("add the other one, or use `hardening`");
        }
        if self.said(path, "johnson_cook") && ["hardening", "saturation"].iter().any(|k| self.said(path, k)) {
            let message = "`johnson_cook` has a hardening of its own";
            self.draft.fail_key(&format!("{path}.johnson_cook"), message).hint("remove `hardening` and `saturation`");
        }
    }

    /// A part of the stress stays, and laws that do not relax have no times.
    fn relaxation(&mut self, path: &str, based: bool) {
        let place = format!("{path}.relaxation");
        let terms = self.draft.get(&place).and_then(Value::as_array).cloned().unwrap_or_default();
        let sum: f64 = terms.iter().filter_map(|t| t.get(0)?.as_f64()).sum();
        if sum >= 1.0 {
            let message = format!("the parts of `{place}` are {sum} in all: nothing of the stress would stay");
            self.draft.fail(&place, message).allowed("less than 1 in all");
        }
        let law = self.text(&format!("{path}.law"));
        let yields = ["yield", "johnson_cook"].iter().any(|k| self.said(path, k));
        let law = law.or_else(|| yields.then(|| "plastic".to_owned()));
        match law.as_deref() {
            Some("viscoelastic") if terms.is_empty() && !based => {
                let message = format!("`{path}` is viscoelastic, but never relaxes");
                let hint = "add `relaxation = [[0.3, 0.01]]`, parts of the modulus and times";
                self.draft.fail(&format!("{path}.law"), message).hint(hint);
            }
            Some("viscoelastic") | None => {}
            Some(law) if !terms.is_empty() => {
                let message = format!("`{place}` of a material whose law is `{law}`");
                self.draft.fail(&place, message).hint("set `law = \"viscoelastic\"`, or remove it");
            }
            Some(_) => {}
        }
    }

    /// Heat has a capacity to go to, and what melts has not melted.
    fn heat(&mut self, path: &str, based: bool) {
        if self.said(path, "heating") && !self.said(path, "heat_capacity") && !based {
            let hint = "add `heat_capacity = \"900 J/kg/K\"`, or remove it";
            self.draft.fail_key(&format!("{path}.heating"), "`heating` without a heat capacity").hint(hint);
        }
        let (melt, room) = (self.of(path, "johnson_cook.melt"), self.of(path, "johnson_cook.room"));
        if let (Some(melt), Some(room)) = (melt, room)
            && melt <= room
        {
            let message = format!("`melt` is {melt} K, not above `room`, {room} K");
            self.draft
                .fail(&format!("{path}.johnson_cook.melt"), message)
                .hint("write temperatures with their unit, `\"500 degC\"`");
        }
        if let (Some(melt), Some(start)) = (melt, self.of(path, "temperature"))
            && melt <= start
        {
            let message = format!("`{path}` has melted at the start: {start} K");
            self.draft.fail(&format!("{path}.temperature"), message).allowed(format!("less than {melt} K"));
        }
    }
}
