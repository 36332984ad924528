//! How many particles fill bodies, before they do: what does not fit into memory is refused before it is made.
use super::super::error::RunError;
use crate::case::{Case, Temporal};
use crate::geometry::Surface;
use crate::observe::usage::available_bytes;

/// Bytes of each particle while its neighbours and gradients are found, in the plane and in space. Of boxes of 260,000 particles in the
/// plane, of boxes and spheres of 80,000 in space; smaller bodies take more, for factors of matrices that larger ones have not.
const EACH: [f64; 2] = [800.0, 2700.0];
/// Part of the memory that a run surely takes of what is expected.
const SURELY: f64 = 0.8;
/// Particles whose neighbours can be numbered: there are 8 and 26 of each at most in rows, and 2³² numbers.
const MOST: [f64; 2] = [500e6, 150e6];
/// Particles of a relaxed body for each h^D of its volume, and for each h^(D−1) of its surface, in the plane and in space: a square and a
/// body-centred lattice with the length of an edge of √3/2 of its cubes, and what the surface has more than the lattice leaves clear
/// beside it. Met within a per cent by circles of 88,000 and 197,000 particles and a sphere of 88,000, within four by one of 11,500.
const INSIDE: [f64; 2] = [1.0, 1.299];
const BESIDE: [f64; 2] = [0.4, 0.5];
/// Bytes of a place of the lattice that a body is cut out of, and of those for each h² of a surface in space that particles on it are
/// chosen from.
const PLACE: f64 = 24.0;
const CHOSEN_FROM: f64 = 1200.0;

/// Bytes of each of so many particles that the factors of a matrix take, and growth with their number, in the plane and in space. Of equilibrium
/// and implicit marches of beams of 4,681 and 24,921 particles in the plane (7.6 and 10.9 kB), 525 and 10,309 in space (24 and 102 kB).
const OF_FACTORS: [(f64, f64, f64); 2] = [(8e3, 5e3, 0.22), (102e3, 1e4, 0.45)];
/// Part of that for natural modes.
const OF_MODES: f64 = 0.6;
/// Bytes of a process that holds no particle, and of each particle of an explicit march, in the plane and in space.
const PROGRAM: f64 = 19.5e6;
const MARCHED: [f64; 2] = [2100.0, 10e3];

/// Memory that the study of a structure alone takes beside that of making its particles.
#[derive(Clone, Copy, Debug)]
pub(super) struct Factors {
    /// Part of what an equilibrium takes.
    part: f64,
    dimension: usize,
}

impl Factors {
    /// Of the study of a case.
    pub(super) fn of(case: &Case, dimension: usize) -> Self {
        let part = match &case.time {
            _ if case.has_gas() => 0.0,
            Temporal::Explicit(_) => 0.0,
            Temporal::Modes(_) => OF_MODES,
            _ => 1.0,
        };
        Self { part, dimension }
    }

    /// Bytes of so many particles.
    fn bytes(&self, particles: f64) -> f64 {
        let (each, usual, growth) = OF_FACTORS[self.dimension - 2];
        self.part * particles * each * (particles / usual).powf(growth)
    }

    /// Power of the number of particles that the bytes go with.
    fn power(&self) -> f64 {
        if self.part > 0.0 { 1.0 + OF_FACTORS[self.dimension - 2].2 } else { 1.0 }
    }

    /// Greatest memory of a process that studies bodies of this size.
    pub(super) fn process(&self, size: &Size) -> f64 {
        let marched = MARCHED[self.dimension - 2] * size.particles;
        PROGRAM + marched.max(size.bytes).max(self.bytes(size.particles))
    }
}

/// How many particles a body has, and the memory that they take to be made.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Size {
    /// Particles.
    pub(super) particles: f64,
    /// Bytes.
    pub(super) bytes: f64,
}

impl Size {
    /// Of rows with so many spacings along each of the axes.
    pub(super) fn of_rows(spacings: impl Iterator<Item = f64>, dimension: usize) -> Self {
        let particles = spacings.map(|n| n.round().max(1.0) + 1.0).product::<f64>();
        Self { particles, bytes: particles * EACH[dimension - 2] }
    }

    /// Of particles within a surface.
    pub(super) fn of_relaxed<const D: usize>(surface: &Surface<D>, spacing: f64) -> Self {
        let (volume, area) = (surface.volume().abs(), surface.area());
        let skin = area / spacing.powi(D as i32 - 1);
        let particles = INSIDE[D - 2] * volume / spacing.powi(D as i32) + BESIDE[D - 2] * skin;
        let extent = surface.bounds().extent();
        let places: f64 = (0..D).map(|d| extent[d] / spacing + 1.0).product();
        let chosen_from = if D == 3 { CHOSEN_FROM * skin } else { 0.0 };
        Self { particles, bytes: particles * EACH[D - 2] + PLACE * places + chosen_from }
    }
}

/// A body that is to be filled.
pub(super) struct Wanted<'a> {
    /// Its name.
    pub(super) name: &'a str,
    /// Distance of its particles.
    pub(super) spacing: f64,
    /// What it takes.
    pub(super) size: Size,
}

/// All bodies together.
pub(super) fn together(bodies: &[Wanted<'_>]) -> Size {
    let sum = |of: fn(&Size) -> f64| bodies.iter().map(|b| of(&b.size)).sum::<f64>();
    Size { particles: sum(|s| s.particles), bytes: sum(|s| s.bytes) }
}

/// Refuses bodies that memory does not hold, or not the factors of their matrices.
pub(super) fn fit(bodies: &[Wanted<'_>], factors: &Factors) -> Result<(), RunError> {
    fit_into(bodies, available_bytes().map(|bytes| bytes as f64), factors)
}

/// The same where so many bytes are free; as if there were no end of them where that is not known.
fn fit_into(bodies: &[Wanted<'_>], free: Option<f64>, factors: &Factors) -> Result<(), RunError> {
    let Size { particles, bytes } = together(bodies);
    let bytes = bytes.max(factors.bytes(particles));
    let (held, most) = (free.unwrap_or(f64::INFINITY), MOST[factors.dimension - 2]);
    // what is no number fits nowhere
    let beyond = (SURELY * bytes / held).powf(factors.power().recip()).max(particles / most);
    if beyond <= 1.0 {
        return Ok(());
    }
    let Some(largest) = bodies.iter().max_by(|a, b| a.size.bytes.total_cmp(&b.size.bytes)) else { return Ok(()) };
    let whose = match bodies {
        [only] => format!("`{}`", only.name),
        _ => format!("the bodies, `{}` most of all,", largest.name),
    };
    let limit = match free {
        Some(free) if SURELY * bytes > free => {
            format!("which take {:.3} GB of memory; {:.3} GB are free", 1e-9 * bytes, 1e-9 * free)
        }
        _ => format!("but no more than {most:e} can be numbered"),
    };
    let spacing = largest.spacing;
    let coarser = beyond.powf(1.0 / factors.dimension as f64) * spacing;
    let enough = if coarser.is_finite() { format!(", {coarser:.2e} or more") } else { String::new() };
    Err(RunError::Solid {
        what: format!("{whose} would have about {particles:.2e} solid particles, {limit}"),
        hint: format!("take a larger `spacing` (now {spacing:.4e}){enough}, or fewer particles `through` the body"),
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::case::read;
    use crate::geometry::load_surface;

    fn case(shape: &str, solid: &str) -> Case {
        let text = format!(
            "[[body]]\nname = \"plate\"\n{shape}\n[body.solid]\nmaterial = {{ density = 1000, young = 1e6, poisson = 0.3 }}\n{solid}\n\
             [time.explicit]\nuntil = 1\n"
        );
        read(&text, "t").unwrap_or_else(|e| panic!("{e}"))
    }

    /// The number of particles expected over those that there are.
    fn expected<const D: usize>(shape: &str, solid: &str, expected: impl Fn(&Case) -> f64) -> f64 {
        let case = case(shape, solid);
        let built = super::super::Filling::of(&case, std::path::Path::new(".")).build::<D>().unwrap();
        expected(&case) / built.structure.solid.len() as f64
    }

    #[test]
    fn relaxed_bodies_have_as_many_particles_as_expected() {
        fn of<const D: usize>(case: &Case, spacing: f64) -> f64 {
            let (surface, _) = load_surface::<D>(&case.bodies, std::path::Path::new(".")).unwrap();
            Size::of_relaxed(&surface, spacing).particles
        }
        let circle = expected::<2>("circle = { radius = 0.5 }", "spacing = 0.02", |c| of::<2>(c, 0.02));
        assert!((circle - 1.0).abs() < 0.03, "{circle}");
        let sphere = expected::<3>("sphere = { radius = 0.5 }", "spacing = 0.1", |c| of::<3>(c, 0.1));
        assert!((sphere - 1.0).abs() < 0.15, "{sphere}");
        let plate = expected::<2>("box = { size = [1, 0.1] }", "through = 6", |_| {
            Size::of_rows([50.0, 5.0].into_iter(), 2).particles
        });
        assert_eq!(plate, 1.0);
    }

    #[test]
    fn bodies_that_round_off_has_closed_are_refused() {
        for solid in ["through = 3", "spacing = 0.1"] {
            let case = case("box = { size = [1e-20, 0.25, 0.25] }\ntranslate = [0.5, 0, 0]", solid);
            assert!(super::super::Filling::of(&case, std::path::Path::new(".")).build::<3>().is_err(), "{solid}");
        }
    }

    #[test]
    fn bodies_that_memory_does_not_hold_are_refused_with_the_spacing_that_it_holds() {
        let size = Size::of_rows([10_000.0, 1000.0].into_iter(), 2);
        let one = |size| [Wanted { name: "plate", spacing: 1e-4, size }];
        let none = Factors { part: 0.0, dimension: 2 };
        let told = |free| fit_into(&one(size), Some(free), &none).map_err(|e| e.to_string());
        assert!(told(1e10).is_ok());
        let refused = told(1.6e9).unwrap_err();
        let words = ["`plate` would have about 1.00e7 solid", "8.009 GB of memory; 1.600 GB are free", "now 1.0000e-4"];
        words.iter().for_each(|w| assert!(refused.contains(w), "{refused}"));
        // a quarter of the memory is that of twice the spacing
        assert!(refused.contains("2.00e-4 or more"), "{refused}");
        let endless = Size { particles: f64::INFINITY, bytes: f64::INFINITY };
        assert!(fit_into(&one(endless), None, &none).is_err_and(|e| e.to_string().contains("can be numbered")));
        assert!(fit_into(&one(endless), Some(1e9), &none).is_err());
    }
    #[test]
    fn implicit_studies_need_memory_for_the_factors_of_their_matrices() {
        let of = |time: &str| {
            let text = format!(
                "[[body]]\nbox = {{ size = [1, 0.2, 0.2] }}\n[body.solid]\nthrough = 3\n\
                 material = {{ density = 1000, young = 1e6, poisson = 0.3 }}\n[time.{time}]\n"
            );
            Factors::of(&read(&text, "t").unwrap(), 3)
        };
        let (rest, march, modes) = (of("steady"), of("explicit]\nuntil = 1\n[output"), of("modes"));
        let size = |n: f64| Size::of_rows([5.0 * n, n, n].into_iter(), 3);
        // resident megabytes of runs of beams with 5 and 13 particles through their thickness
        for (factors, n, megabytes) in
            [(rest, 4.0, 32.0), (rest, 12.0, 1068.0), (modes, 12.0, 631.0), (march, 4.0, 22.0), (march, 12.0, 123.0)]
        {
            let found = factors.process(&size(n)) / 1e6;
            assert!((found / megabytes - 1.0).abs() < 0.15, "{n}: {found} for {megabytes}");
        }
        let one = [Wanted { name: "beam", spacing: 0.005, size: size(40.0) }];
        assert!(fit_into(&one, Some(2e10), &march).is_ok());
        let refused = fit_into(&one, Some(2e10), &rest).unwrap_err().to_string();
        assert!(refused.contains("`beam` would have about 3.38e5 solid particles"), "{refused}");
    }
}
