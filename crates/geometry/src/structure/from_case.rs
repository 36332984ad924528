//! Structures from the values of a case.
//!
//! The units of the solver are the density ρ∞ and the sound speed a∞ of the free stream and the unit of length of the
//! case. With a dimensional free stream, masses and inertias are divided by ρ∞; stiffnesses, moments and forces by ρ∞
//! a∞²; dampers by ρ∞ a∞; rates and frequencies by a∞; accelerations by a∞²; and time is multiplied by a∞. Otherwise
//! all these factors are 1. With the semichord b, the flutter parameters are m = μ π b², S = m b x_α, I = m b² r_α²,
//! ω_α = U∞/(b V*), V* = V_f √μ, U* = π V*; ω is that of pitch where pitch is an unknown, otherwise that of plunge.
use std::f64::consts::PI;

use super::{
    Coordinate, Flap, Floating, ForceHistory, InertiaLaw, Model, PlanarBody, RigidBody, Spring, Structure,
    StructureError,
};
use crate::case::formula::Formula;
use crate::case::{self, Case, Freedom, Length, SpringShape, StructureModel, Units};

/// Reference dimensions for the flutter parameters.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BodyFrame {
    /// Reference chord; half of it is the default semichord.
    pub chord: f64,
    /// Middle of the chord of the body in its initial placement: the centre of its bounding box.
    pub middle: [f64; 3],
}

/// Data for the construction of one structure.
struct Builder<'a> {
    case: &'a Case,
    data: &'a case::Structure,
    frame: BodyFrame,
    units: Units,
    /// Speed U∞ of the stream in units of the solver, which is the Mach number.
    stream: f64,
    b: f64,
}

impl<const D: usize> Structure<D> {
    /// The structure that `data` of `case` defines, for a body with the reference dimensions `frame`. Fails when the
    /// values do not define one.
    pub fn of_case(case: &Case, data: &case::Structure, frame: BodyFrame) -> Result<Self, StructureError> {
        let b = semichord(data, &frame);
        let (units, stream) = (case.flow.units(), case.flow.reference().mach);
        let builder = Builder { case, data, frame, units, stream, b };
        match data.model {
            StructureModel::Modal => builder.modes(),
            StructureModel::Floating => builder.floating(),
            _ if D == 2 => builder.plane(),
            _ => builder.space(),
        }
    }
}

/// Semichord b of the flutter parameters.
pub(super) fn semichord(data: &case::Structure, frame: &BodyFrame) -> f64 {
    data.semichord.map_or(0.5 * frame.chord, |b| b.0)
}

fn point<const N: usize>(list: &[Length]) -> [f64; N] {
    std::array::from_fn(|d| list.get(d).map_or(0.0, |x| x.0))
}

impl Builder<'_> {
    /// Mass; zero where none is required.
    fn mass(&self) -> f64 {
        let given = self.data.mass.map(|m| m.0 / self.units.density);
        given.or(self.data.mass_ratio.map(|mu| mu * PI * self.b * self.b)).unwrap_or(0.0)
    }

    fn gravity<const N: usize>(&self) -> [f64; N] {
        let list = self.data.gravity.as_deref().unwrap_or_default();
        std::array::from_fn(|d| list.get(d).map_or(0.0, |g| g.0 / self.units.speed.powi(2)))
    }

    /// Pivot and centre of mass; when only one is given, both coincide.
    fn points<const N: usize>(&self) -> [[f64; N]; 2] {
        let centre = self.data.centre_of_mass.as_deref().map(point);
        let axis = self
            .data
            .elastic_axis
            .map(|a| std::array::from_fn(|d| self.frame.middle[d] + if d == 0 { a * self.b } else { 0.0 }));
        let middle = std::array::from_fn(|d| self.frame.middle[d]);
        let pivot: [f64; N] = self.data.pivot.as_deref().map(point).or(axis).or(centre).unwrap_or(middle);
        let unbalance = self.data.x_alpha.unwrap_or(0.0) * self.b;
        let aft = std::array::from_fn(|d| pivot[d] + if d == 0 { unbalance } else { 0.0 });
        [pivot, centre.unwrap_or(aft)]
    }

    fn plane<const D: usize>(&self) -> Result<Structure<D>, StructureError> {
        let (mass, [pivot, centre]) = (self.mass(), self.points::<2>());
        let given = self.data.inertia.as_deref().and_then(<[_]>::first).map(|i| i.0 / self.units.density);
        let per_mass = mass * self.b * self.b;
        let inertia = given.or(self.data.r_alpha2.map(|r2| r2 * per_mass)).unwrap_or(0.0);
        let flap = self.data.flap.as_ref().map(|flap| Flap {
            hinge: flap.hinge_at([self.frame.middle[0], pivot[1]], self.b),
            static_moment: [flap.x_beta * mass * self.b, 0.0],
            inertia: flap.r_beta2 * per_mass,
            blend: flap.blend.0,
        });
        let small = self.data.model == StructureModel::TypicalSection && !self.data.large_angles;
        let body = PlanarBody {
            pivot,
            mass,
            static_moment: std::array::from_fn(|d| mass * (centre[d] - pivot[d])),
            inertia,
            flap,
            gravity: self.gravity(),
            law: if small { InertiaLaw::Linear } else { InertiaLaw::Exact },
        };
        let weight = |f: Freedom| match f {
            Freedom::Flap => flap.map_or(0.0, |flap| flap.inertia),
            f if f.turns() => inertia,
            _ => mass,
        };
        let coordinates = self.coordinates(2, weight);
        Structure::new(Model::Planar(body), coordinates)
    }

    fn space<const D: usize>(&self) -> Result<Structure<D>, StructureError> {
        let (mass, [pivot, centre]) = (self.mass(), self.points::<3>());
        let given = self.data.inertia.as_deref().unwrap_or_default();
        let j = |k: usize| given.get(k).map_or(0.0, |i| i.0 / self.units.density);
        let inertia = [[j(0), j(3), j(5)], [j(3), j(1), j(4)], [j(5), j(4), j(2)]];
        let body = RigidBody {
            pivot,
            mass,
            static_moment: std::array::from_fn(|d| mass * (centre[d] - pivot[d])),
            inertia,
            gravity: self.gravity(),
        };
        let weight = |f: Freedom| match f {
            Freedom::Roll => inertia[0][0],
            Freedom::Pitch => inertia[1][1],
            Freedom::Yaw => inertia[2][2],
            _ => mass,
        };
        let coordinates = self.coordinates(3, weight);
        Structure::new(Model::Spatial(body), coordinates)
    }

    /// Unknown coordinates of a rigid body; `weight` is the mass or inertia of each.
    fn coordinates(&self, dimension: usize, weight: impl Fn(Freedom) -> f64) -> Vec<Coordinate> {
        let free = self.data.freedoms(dimension);
        let unknown = |f: &Freedom| {
            let name = f.name();
            let stiffness = self.stiffness(*f, &free, &weight);
            let ratio = self.data.damping_ratio.get(name).map(|zeta| 2.0 * zeta * (stiffness * weight(*f)).sqrt());
            let damper = self.data.damping.get(name).map(|c| c / (self.units.density * self.units.speed));
            let rate = self.data.initial.get(&format!("{name}_rate")).map_or(0.0, |v| self.units.solver_rate(*v));
            Coordinate {
                name: name.to_owned(),
                spring: spring(stiffness, self.data.springs.get(name)),
                damping: ratio.or(damper).unwrap_or(0.0),
                force: self.force(self.data.force.as_ref().and_then(|f| f.formulas.get(name))),
                initial: self.data.initial.get(name).copied().unwrap_or(0.0),
                initial_rate: rate,
            }
        };
        free.iter().map(unknown).collect()
    }

    /// Stiffness of the spring of a coordinate.
    fn stiffness(&self, f: Freedom, free: &[Freedom], weight: &impl Fn(Freedom) -> f64) -> f64 {
        if let Some(k) = self.data.stiffness.get(f.name()) {
            return k / self.units.pressure();
        }
        let leading = if free.contains(&Freedom::Pitch) { Freedom::Pitch } else { Freedom::Plunge };
        let own = self.data.frequency.get(f.name()).map(|w| self.units.solver_rate(w.0));
        let over_pitch = match f {
            Freedom::Plunge => self.data.frequency_ratio,
            Freedom::Flap => self.data.flap.as_ref().and_then(|flap| flap.frequency_ratio),
            _ => None,
        };
        let of_pitch = || (self.stiffness(Freedom::Pitch, free, weight) / weight(Freedom::Pitch)).sqrt();
        let by_speed = self.reduced_speed().filter(|_| f == leading).map(|v| self.stream / (v * self.b));
        let omega = own.or(over_pitch.map(|ratio| ratio * of_pitch())).or(by_speed);
        omega.map_or(0.0, |omega| weight(f) * omega * omega)
    }

    /// Reduced speed V*.
    fn reduced_speed(&self) -> Option<f64> {
        let mass_ratio = self.mass() / (PI * self.b * self.b);
        let by_index = self.data.speed_index.map(|v| v * mass_ratio.sqrt());
        self.data.reduced_speed.or(self.data.reduced_velocity.map(|u| u / PI)).or(by_index)
    }

    fn force(&self, text: Option<&String>) -> ForceHistory {
        // the reader of the case has verified the formula
        let Some(Ok(formula)) = text.map(|text| Formula::parse(text)) else { return ForceHistory::Zero };
        let frequency = self.data.force.as_ref().and_then(|f| f.angular_frequency(&self.case.flow, self.frame.chord));
        let (omega, factor) = (frequency.unwrap_or(0.0), 1.0 / self.units.pressure());
        ForceHistory::Formula { formula, omega, time: self.units.case_time(1.0), factor }
    }

    /// Plunge and pitch where they are unknowns, followed by the modes.
    fn floating<const D: usize>(&self) -> Result<Structure<D>, StructureError> {
        let pivot = self.data.pivot.as_deref().map_or([0.0; 3], point);
        let modes = || self.data.modes.iter().map(|mode| mode.name.clone());
        let rigid = self.data.free.iter().map(|f| f.name().to_owned());
        let spring = Spring { stiffness: 1.0, ..Spring::default() };
        let unknown = |name| Coordinate { name, spring, ..Coordinate::default() };
        Structure::new(Model::Floating(Floating::new(pivot, modes())), rigid.chain(modes()).map(unknown).collect())
    }

    fn modes<const D: usize>(&self) -> Result<Structure<D>, StructureError> {
        let modes = &self.data.modes;
        let model = modes.iter().map(|mode| (mode.name.clone(), mode.mass / self.units.density)).collect();
        let unknown = |mode: &case::StructureMode| {
            let mass = mode.mass / self.units.density;
            let reduced = mode.reduced_frequency.map(|k| k * self.stream / self.b);
            let omega = mode.frequency.map(|w| self.units.solver_rate(w.0)).or(reduced);
            let given = mode.stiffness.map(|k| k / self.units.pressure());
            let stiffness = given.or(omega.map(|w| mass * w * w)).unwrap_or(0.0);
            Coordinate {
                name: mode.name.clone(),
                spring: spring(stiffness, Some(&SpringShape::of(mode))),
                damping: 2.0 * mode.damping_ratio * (stiffness * mass).sqrt(),
                force: self.force(mode.force.as_ref()),
                initial: mode.initial,
                initial_rate: self.units.solver_rate(mode.initial_rate),
            }
        };
        Structure::new(Model::Modal(model), modes.iter().map(unknown).collect())
    }
}

/// The spring with the force K (e + cubic e³).
fn spring(stiffness: f64, shape: Option<&SpringShape>) -> Spring {
    let SpringShape { cubic, free_play, rest } = shape.copied().unwrap_or_default();
    Spring { stiffness, cubic: cubic * stiffness, play: free_play, rest }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::case::read;

    const FRAME: BodyFrame = BodyFrame { chord: 2.0, middle: [1.0, 0.1, 0.0] };
    const ISOGAI: &str = "elastic_axis = -2.0\nmass_ratio = 60\nx_alpha = 1.8\nr_alpha2 = 3.48\nfrequency_ratio = 1\n";

    fn of_case<const D: usize>(flow: &str, body: &str, keys: &str) -> (Case, Structure<D>) {
        let text = format!(
            "[flow]\n{flow}\n[[body]]\n{body}\n[cloud]\nspacing = 0.01\n[time.dual]\nuntil = 1\nstep = 0.1\n[structure]\n{keys}\n"
        );
        let case = read(&text, "case.toml").unwrap_or_else(|e| panic!("{e}"));
        let structure = Structure::of_case(&case, case.structure_of(0).unwrap(), FRAME).unwrap();
        (case, structure)
    }

    fn close(a: f64, b: f64) {
        assert!((a - b).abs() <= 1e-13 * b.abs().max(1e-3), "{a} is not {b}");
    }

    #[test]
    fn the_numbers_of_flutter_become_masses_and_springs() {
        let keys = format!(
            "{ISOGAI}reduced_speed = 5\ndamping_ratio = {{ plunge = 0.1 }}\nsprings = {{ pitch = {{ cubic = 40 }} }}"
        );
        let (_, s) = of_case::<2>("mach = 0.3", "naca = \"0012\"", &keys);
        let Model::Planar(body) = s.model() else { panic!("{s:?}") };
        let m = 60.0 * PI;
        assert_eq!((body.pivot, body.law), ([-1.0, 0.1], InertiaLaw::Linear));
        close(body.mass, m);
        close(body.static_moment[0], 1.8 * m);
        close(body.inertia, 3.48 * m);
        let omega = 0.3 / 5.0;
        let [plunge, pitch] = s.coordinates() else { panic!("{s:?}") };
        close(plunge.spring.stiffness, m * omega * omega);
        close(plunge.damping, 2.0 * 0.1 * m * omega);
        close(pitch.spring.stiffness, 3.48 * m * omega * omega);
        close(pitch.spring.cubic, 40.0 * 3.48 * m * omega * omega);
        let found = s.natural_frequencies(&[0.0; 2]);
        assert!((found[0] / omega - 0.713).abs() < 5e-4 && (found[1] / omega - 5.34).abs() < 5e-3);
        // the other two ways to say how fast
        let index = 5.0 / 60f64.sqrt();
        for same in [format!("speed_index = {index:?}"), format!("reduced_velocity = {:?}", 5.0 * PI)] {
            let (_, other) = of_case::<2>("mach = 0.3", "naca = \"0012\"", &format!("{ISOGAI}{same}"));
            close(other.coordinates()[1].spring.stiffness, pitch.spring.stiffness);
        }
    }

    #[test] // 101325 Pa and 288.15 K: ρ = 1.225, a = 340.29 m/s
    fn units_leave_with_density_and_sound_speed() {
        let keys = "pivot = [0.5, 0]\nmass = \"12 kg/m\"\ninertia = \"0.5 kg m\"\ncentre_of_mass = [0.6, 0.01]\n\
                    stiffness = { plunge = \"2.8 kN/m2\" }\nfrequency = { pitch = \"5 Hz\" }\ndamping = { plunge = 3 }\n\
                    gravity = [0, \"-9.81 m/s2\"]\ninitial = { plunge_rate = \"2 m/s\", pitch = \"1 deg\" }\n\
                    force = { plunge = \"7*cos(omega*t)\", frequency = \"3 Hz\" }";
        let (case, s) = of_case::<2>("mach = 0.3\npressure = 101325\ntemperature = 288.15", "naca = \"0012\"", keys);
        let (rho, a) = (case.flow.reference().density, case.flow.reference().sound_speed);
        let Model::Planar(body) = s.model() else { panic!("{s:?}") };
        close(body.mass, 12.0 / rho);
        close(body.static_moment[1], 0.12 / rho);
        close(body.gravity[1], -9.81 / (a * a));
        let [plunge, pitch] = s.coordinates() else { panic!("{s:?}") };
        close(plunge.spring.stiffness, 2800.0 / (rho * a * a));
        close(plunge.damping, 3.0 / (rho * a));
        close(plunge.initial_rate, 2.0 / a);
        close((pitch.spring.stiffness / body.inertia).sqrt() * a, 10.0 * PI);
        close(pitch.initial, 1f64.to_radians());
        // a quarter of a period of 1/3 s later
        let t = a / 12.0;
        assert!((s.forces(0.0)[0] - 7.0 / (rho * a * a)).abs() < 1e-18 && s.forces(t)[0].abs() < 1e-18);
        // the weight alone: 9.81 m/s² down
        let still = s.accelerations(0.0, [&[0.0; 2], &[0.0; 2]], &[-s.forces(0.0)[0], 0.0]);
        close(still[0] * a * a, -9.81);
    }

    #[test]
    fn cylinders_bodies_in_space_and_modes_have_their_springs() {
        let keys = "free = \"plunge\"\nmass_ratio = 10\nreduced_velocity = 5";
        let (_, s) = of_case::<2>("mach = 0.2", "circle = { radius = 1 }", keys);
        // f = U/(U* D), D = 2
        close(s.natural_frequencies(&[0.0])[0], 2.0 * PI * 0.2 / (5.0 * 2.0));
        let keys = "model = \"rigid_body\"\nmass = 3\ninertia = [1, 1.5, 2, 0.1, 0, 0]\npivot = [0, 0, 0]\ncentre_of_mass = [0, 0, 0.1]\n\
                    stiffness = { pitch = 0.5 }\nfree = [\"plunge\", \"pitch\"]";
        let (_, s) = of_case::<3>("mach = 0.2", "sphere = { radius = 1 }", keys);
        assert_eq!(s.coordinates().iter().map(|c| c.name.as_str()).collect::<Vec<_>>(), ["plunge", "pitch"]);
        close(s.natural_frequencies(&[0.0; 2])[1], (0.5f64 / 1.5).sqrt());
        let keys = "model = \"modal\"\n[[structure.mode]]\nname = \"first\"\nfile = \"a.csv\"\nmass = 2\nreduced_frequency = 0.3\n\
                    damping_ratio = 0.01\n[[structure.mode]]\nname = \"second\"\nfile = \"b.csv\"\nmass = 4\nstiffness = 9\ncubic = 2";
        let (_, s) = of_case::<3>("mach = 0.2", "sphere = { radius = 1 }", keys);
        let found = s.natural_frequencies(&[0.0; 2]);
        close(found[0], 0.3 * 0.2);
        close(found[1], 1.5);
        close(s.coordinates()[0].damping, 2.0 * 0.01 * 2.0 * 0.06);
        close(s.coordinates()[1].spring.cubic, 18.0);
    }

    #[test]
    fn flaps_stand_where_they_are_told() {
        let keys = format!(
            "{ISOGAI}reduced_speed = 5\nflap = {{ hinge = 0.6, x_beta = 0.01, r_beta2 = 0.02, frequency_ratio = 3 }}"
        );
        let (_, s) = of_case::<2>("mach = 0.3", "naca = \"0012\"", &keys);
        let Model::Planar(body) = s.model() else { panic!("{s:?}") };
        let flap = body.flap.unwrap();
        assert_eq!(flap.hinge, [1.6, 0.1]);
        close(flap.static_moment[0], 0.01 * 60.0 * PI);
        close((s.coordinates()[2].spring.stiffness / flap.inertia).sqrt(), 3.0 * 0.06);
    }
}
