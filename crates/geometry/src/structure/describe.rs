//! Description of a structure for reports: sign conventions, flutter parameters, and frequencies in several units.
use std::f64::consts::{PI, TAU};

use super::from_case::semichord;
use super::{BodyFrame, InertiaLaw, Model, Spring, Structure};
use crate::case::{self, Case, Units};

/// Number of significant digits in a report.
const DIGITS: i32 = 6;

/// `x` with [`DIGITS`] significant digits, without an exponent where this is readable.
fn number(x: f64) -> String {
    let places = if x == 0.0 { 0 } else { DIGITS - 1 - x.abs().log10().floor() as i32 };
    match places {
        0..=9 => {
            let text = format!("{x:.*}", places as usize);
            if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.').to_owned() } else { text }
        }
        -3..0 => format!("{x:.0}"),
        _ => format!("{x:.*e}", DIGITS as usize - 1),
    }
}

fn point(x: &[f64]) -> String {
    format!("({})", x.iter().map(|c| number(*c)).collect::<Vec<_>>().join(", "))
}

/// Writer of the lines of a description.
struct Writer<'a, const D: usize> {
    structure: &'a Structure<D>,
    units: Units,
    /// Speed U∞ of the stream in units of the solver.
    stream: f64,
    dimensional: bool,
    b: f64,
    lines: Vec<String>,
}

impl<const D: usize> Structure<D> {
    /// Lines that describe the structure that `data` of `case` defines: signs, units, μ, x_α, r_α², V*, frequencies.
    pub fn description(&self, case: &Case, data: &case::Structure, frame: BodyFrame) -> Vec<String> {
        let (units, stream, b) = (case.flow.units(), case.flow.reference().mach, semichord(data, &frame));
        let dimensional = case.flow.is_dimensional();
        let mut writer = Writer { structure: self, units, stream, dimensional, b, lines: Vec::new() };
        writer.conventions();
        match &self.model {
            Model::Planar(_) => writer.section(),
            Model::Spatial(body) => {
                let moments = [body.inertia[0][0], body.inertia[1][1], body.inertia[2][2]];
                writer.say(format!("pivot {}; mass m = {}", point(&body.pivot), writer.mass(body.mass)));
                let about = moments.map(|j| j * writer.units.density);
                writer.say(format!("moments of inertia about the pivot: Jxx, Jyy, Jzz = {}", point(&about)));
            }
            Model::Modal(modes) => {
                let masses: Vec<String> = modes.iter().map(|(name, m)| format!("{name} {}", writer.mass(*m))).collect();
                writer.say(format!("generalised masses: {}", masses.join(", ")));
            }
            Model::Floating(body) => writer.say(format!("pivot {}", point(&body.pivot[..D]))),
        }
        writer.springs();
        writer.frequencies();
        writer.lines
    }
}

impl<const D: usize> Writer<'_, D> {
    fn say(&mut self, line: String) {
        self.lines.push(line);
    }

    fn mass(&self, m: f64) -> String {
        let unit = match (self.dimensional, D) {
            (true, 2) => "kg/m",
            (true, _) => "kg",
            (false, 2) => "ρ∞L²",
            (false, _) => "ρ∞L³",
        };
        format!("{} {unit}", number(m * self.units.density))
    }

    fn conventions(&mut self) {
        let modal = matches!(self.structure.model, Model::Modal(_));
        let words = self.structure.coordinates.iter().map(|c| match c.name.as_str() {
            mode if modal => mode,
            "plunge" => "plunge (up positive; the h of the literature of flutter is down: h = -plunge)",
            "pitch" => "pitch (nose up positive)",
            "flap" => "flap (trailing edge down positive)",
            other => other,
        });
        let list = words.collect::<Vec<_>>().join(", ");
        self.say(format!("unknown coordinates: {list}"));
        let span = if D == 2 { "per unit span, " } else { "" };
        let units = match self.dimensional {
            true => "SI units, times in s, angles in rad",
            false => "units of ρ∞, a∞ and the length L = 1 of the case, times in L/a∞",
        };
        self.say(format!("masses, stiffnesses, forces and energies: {span}{units}"));
    }

    fn section(&mut self) {
        let Model::Planar(body) = &self.structure.model else { return };
        let (b, m) = (self.b, body.mass);
        let law = match body.law {
            InertiaLaw::Linear => "inertia of small angles",
            InertiaLaw::Exact => "inertia of a rigid body at any angle",
        };
        self.say(format!("elastic axis {}, semichord b = {}; {law}", point(&body.pivot), number(b)));
        if m > 0.0 {
            let (mu, x) = (m / (PI * b * b), body.static_moment[0] / (m * b));
            self.say(format!("mass m = {}, mass ratio μ = m/(π ρ∞ b²) = {}", self.mass(m), number(mu)));
            let r2 = body.inertia / (m * b * b);
            let inertia = number(body.inertia * self.units.density);
            self.say(format!("x_α = S/(m b) = {}, I = {inertia}, r_α² = I/(m b²) = {}", number(x), number(r2)));
            if let Some(flap) = &body.flap {
                let (x, r2) = (flap.static_moment[0] / (m * b), flap.inertia / (m * b * b));
                self.say(format!("flap: hinge {}, x_β = {}, r_β² = {}", point(&flap.hinge), number(x), number(r2)));
            }
        }
        self.speeds();
    }

    /// V* and related parameters, if there is a spring of pitch or plunge.
    fn speeds(&mut self) {
        let Model::Planar(body) = &self.structure.model else { return };
        let find = |name: &str| self.structure.coordinates.iter().find(|c| c.name == name);
        let (name, leading, inertia) = match (find("pitch"), find("plunge")) {
            (Some(pitch), _) => ("ω_α", pitch, body.inertia),
            (None, Some(plunge)) => ("ω_h", plunge, body.mass),
            _ => return,
        };
        let omega = (leading.spring.stiffness / inertia).sqrt();
        if !(omega > 0.0 && self.stream > 0.0) {
            return;
        }
        let v = self.stream / (self.b * omega);
        let index = if body.mass > 0.0 {
            format!(", V_f = V*/√μ = {}", number(v / (body.mass / (PI * self.b * self.b)).sqrt()))
        } else {
            String::new()
        };
        self.say(format!("V* = U∞/(b {name}) = {}{index}, U* = U∞/(f D) = π V* = {}", number(v), number(PI * v)));
    }

    fn springs(&mut self) {
        let stiff = self.units.pressure();
        for c in &self.structure.coordinates {
            let s = &c.spring;
            let mut parts = vec![format!("spring of {}: K = {}", c.name, number(s.stiffness * stiff))];
            if s.cubic != 0.0 {
                parts.push(format!("force K (e + {} e³)", number(s.cubic / s.stiffness)));
            }
            if s.play != 0.0 {
                parts.push(format!("free play ±{}", number(s.play)));
            }
            if s.rest != 0.0 {
                parts.push(format!("at ease at {}", number(s.rest)));
            }
            if c.damping != 0.0 {
                parts.push(format!("damper {}", number(self.units.case_time(c.damping * stiff))));
            }
            self.lines.push(parts.join(", "));
        }
    }

    fn frequencies(&mut self) {
        let mut linear = self.structure.clone();
        linear.coordinates.iter_mut().for_each(|c| c.spring = Spring::linear(c.spring.stiffness));
        let found = linear.natural_frequencies(&vec![0.0; linear.len()]);
        let speed = self.units.speed;
        let unit = if self.dimensional { "rad/s" } else { "a∞/L" };
        for (k, omega) in found.into_iter().enumerate() {
            let mut line = format!(
                "coupled frequency {} without gas, springs linear: ω = {} {unit}",
                k + 1,
                number(omega * speed)
            );
            if self.dimensional {
                line.push_str(&format!(" = {} Hz", number(omega * speed / TAU)));
            }
            if self.stream > 0.0 {
                line.push_str(&format!(", ω b/U∞ = {}", number(omega * self.b / self.stream)));
            }
            self.say(line);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::case::read;

    #[test]
    fn numbers_are_short() {
        let all = [0.0, 60.0, 0.713_412_34, 1234.5678, 123456.7, 2e-9, 1e12, -0.5].map(number);
        assert_eq!(all, ["0", "60", "0.713412", "1234.57", "123457", "2.00000e-9", "1.00000e12", "-0.5"]);
    }

    #[test]
    fn a_section_is_told_by_its_numbers() {
        let text = "[flow]\nmach = 0.3\n[[body]]\nnaca = \"0012\"\n[cloud]\nspacing = 0.01\n[time.dual]\nuntil = 1\nstep = 0.1\n\
                    [structure]\nelastic_axis = -2.0\nmass_ratio = 60\nx_alpha = 1.8\nr_alpha2 = 3.48\nfrequency_ratio = 1\n\
                    reduced_speed = 5\nsprings = { pitch = { cubic = 40, free_play = \"0.5 deg\" } }\n";
        let case = read(text, "case.toml").unwrap();
        let (data, frame) = (case.structure_of(0).unwrap(), BodyFrame { chord: 1.0, middle: [0.5, 0.0, 0.0] });
        let lines = Structure::<2>::of_case(&case, data, frame).unwrap().description(&case, data, frame).join("\n");
        let pieces = [
            "h = -plunge",
            "per unit span, units of ρ∞",
            "elastic axis (-0.5, 0), semichord b = 0.5; inertia of small angles",
            "μ = m/(π ρ∞ b²) = 60",
            "x_α = S/(m b) = 1.8",
            "r_α² = I/(m b²) = 3.48",
            "V* = U∞/(b ω_α) = 5, V_f = V*/√μ = 0.645497",
            "force K (e + 40 e³), free play ±0.00872665",
            "coupled frequency 1 without gas, springs linear: ω = 0.0856",
            "ω b/U∞ = 0.1426",
        ];
        for piece in pieces {
            assert!(lines.contains(piece), "`{piece}` is missing in\n{lines}");
        }
    }
}
