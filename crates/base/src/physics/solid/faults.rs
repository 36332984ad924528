//! Checks of the constants of a material.
use super::flow::{Hardening, Plasticity, Rate, Softening};
use super::{Law, Material, Prony};

/// Messages about inadmissible constants.
struct Faults(Vec<String>);

impl Faults {
    /// Adds a message about the number `x` named `name` unless `holds`; `allowed` describes the permitted values.
    fn unless(&mut self, holds: bool, name: &str, x: f64, allowed: &str) {
        if !holds {
            self.0.push(format!("`{name}` is {x}; it must be {allowed}"));
        }
    }

    /// Adds a message about a number that is not positive and finite.
    fn positive(&mut self, name: &str, x: f64) {
        self.unless(0.0 < x && x.is_finite(), name, x, "positive");
    }

    /// Adds a message about a number that is negative or not finite.
    fn not_negative(&mut self, name: &str, x: f64) {
        self.unless(0.0 <= x && x.is_finite(), name, x, "zero or positive");
    }

    fn plasticity(&mut self, law: &Plasticity) {
        match law.hardening {
            Hardening::Voce { start, linear, saturation, exponent } => {
                self.positive("hardening.start", start);
                self.not_negative("hardening.linear", linear);
                self.not_negative("hardening.saturation", saturation);
                self.not_negative("hardening.exponent", exponent);
            }
            Hardening::Power { start, modulus, exponent } => {
                self.positive("hardening.start", start);
                self.not_negative("hardening.modulus", modulus);
                self.positive("hardening.exponent", exponent);
            }
        }
        self.not_negative("kinematic", law.kinematic);
        match law.rate {
            Rate::Independent => {}
            Rate::Logarithmic { factor, reference } => {
                self.not_negative("rate.factor", factor);
                self.positive("rate.reference", reference);
            }
            Rate::Overstress { viscosity, exponent } => {
                self.not_negative("rate.viscosity", viscosity);
                self.positive("rate.exponent", exponent);
            }
        }
        if let Some(Softening { reference, melting, exponent }) = law.softening {
            self.positive("softening.reference", reference);
            let above = reference < melting && melting.is_finite();
            self.unless(above, "softening.melting", melting, &format!("above `softening.reference`, {reference}"));
            self.positive("softening.exponent", exponent);
        }
    }

    fn prony(&mut self, law: &Prony) {
        let most = law.branches.len();
        self.unless(law.count <= most, "branches.count", law.count as f64, &format!("at most {most}"));
        for branch in law.used() {
            self.not_negative("branches.fraction", branch.fraction);
            self.positive("branches.time", branch.time);
        }
        let total = 1.0 - law.lasting();
        // fractions such as 0.7 + 0.3 may not add up to exactly 1
        self.unless(total <= 1.0 + 1e-12, "sum of branches.fraction", total, "at most 1");
    }
}

impl Material {
    /// One message for each inadmissible constant, with the permitted values; empty for an admissible material.
    pub fn faults(&self) -> Vec<String> {
        let mut faults = Faults(Vec::new());
        faults.positive("density", self.density);
        faults.positive("shear", self.moduli.shear);
        faults.positive("bulk", self.moduli.bulk);
        let heat = &self.thermal;
        faults.positive("heat_capacity", heat.heat_capacity);
        let part = (0.0..=1.0).contains(&heat.heated_fraction);
        faults.unless(part, "heated_fraction", heat.heated_fraction, "within 0 and 1");
        faults.positive("start", heat.start);
        match &self.law {
            Law::Linear | Law::SaintVenantKirchhoff | Law::NeoHookean | Law::Orthotropic(_) | Law::Hypoelastic => {}
            Law::Plastic(law) => faults.plasticity(law),
            Law::Viscoelastic(law) => faults.prony(law),
        }
        faults.0
    }
}

#[cfg(test)]
mod tests {
    use super::super::{Moduli, ROOM_TEMPERATURE};
    use super::*;

    #[test]
    fn faults_name_the_number_and_what_is_allowed() {
        let sound = Material::new(1.0, Moduli::of_young(1.0, 0.4999), Law::Plastic(Plasticity::linear(1.0, 0.0)));
        assert!(sound.faults().is_empty());
        let bad = Material { density: -1.0, moduli: Moduli::of_young(1.0, 0.6), ..sound };
        assert_eq!(bad.faults()[0], "`density` is -1; it must be positive");
        assert!(bad.faults()[1].starts_with("`bulk` is -"), "{:?}", bad.faults());
        let mut law = Plasticity::linear(f64::NAN, -1.0);
        let melting = ROOM_TEMPERATURE;
        law.softening = Some(Softening { reference: ROOM_TEMPERATURE, melting, exponent: 1.0 });
        assert_eq!(sound.with_law(Law::Plastic(law)).faults().len(), 3);
        let series = Prony::new(&[(0.7, 1.0), (0.4, 0.0)]);
        assert_eq!(sound.with_law(Law::Viscoelastic(series)).faults().len(), 2);
        let series = Prony::new(&[(0.7, 1.0), (0.3, 1.0)]);
        assert!(sound.with_law(Law::Viscoelastic(series)).faults().is_empty());
    }
}
