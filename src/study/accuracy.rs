//! Families of clouds: which stages they take, and when a cloud is fine enough.
//!
//! What the loads change by from one cloud to the next tells how far they are from their limit
//! ([`Convergence`](crate::observe::convergence::Convergence)).
use super::stage::Stage;
use crate::case::{Accuracy, Case};
use crate::problem::spacing::asked;

/// Factors on the spacing of the first clouds, which are halved again and again: in space half a spacing takes six times as many
/// particles, and 4/3 and 3/2 in turn leave whole cells in a domain.
const FIRST: [&[f64]; 2] = [&[4.0], &[8.0 / 3.0, 2.0]];
/// What the number of particles of a cloud may be off what is expected, relative to it.
const UNSURE: f64 = 0.02;
/// How many times the particles a cloud in space has at half the spacing.
const FINER: f64 = 6.0;
/// Clouds that an error bar is drawn from, in 2-D and 3-D: three tell an order, a fourth whether it is one.
pub(crate) const CLOUDS: [usize; 2] = [3, 4];

/// True where the clouds of a family follow what detached shocks slow down. The points of a polar share their clouds.
pub(crate) fn follows_shocks(case: &Case) -> bool {
    case.flow.reference().mach > 1.0 && case.polar.is_none() && case.adapt.cycles == 0
}

/// True where each cloud of a family is refined by what was found on the one before.
fn follows(case: &Case) -> bool {
    follows_shocks(case) || case.adapt.cycles > 0
}

/// Greatest number of particles of the cloud of a family in space with `factor` times the spacing of the case; in the plane clouds of a
/// family grow less.
pub(crate) fn room(asked: &Accuracy, factor: f64) -> f64 {
    asked.particles as f64 / FINER.powf(factor.log2().max(0.0))
}

/// The same where each cloud is adapted: in the plane it may have all that the last one leaves to its like.
pub(crate) fn room_adapted<const D: usize>(particles: usize, factor: f64) -> f64 {
    particles as f64 / factor.max(1.0).powf(D as f64)
}

/// Tells that the clouds that an error bar takes have more particles than are allowed, where the case itself says how many those are.
pub(crate) fn too_few(case: &Case, n: usize) -> Option<String> {
    let asked = asked(case)?.particles;
    let told = case.accuracy.is_some() && n > asked;
    let clouds = CLOUDS[usize::from(crate::geometry::dimension(case)) - 2];
    told.then(|| {
        format!(
            "`accuracy.particles = {asked}` is less than the {n} particles of the last of the {clouds} clouds that an error bar takes: \
             they are used nevertheless; `cloud.spacing` makes them coarser"
        )
    })
}

/// The stages of a family whose clouds have the `sizes`.
pub(crate) fn family(case: &Case, asked: &Accuracy, sizes: &dyn Fn(f64) -> f64, dimension: usize) -> Vec<Stage> {
    let (first, least) = (FIRST[dimension - 2], CLOUDS[dimension - 2]);
    let factors = (0..).flat_map(|k| first.iter().map(move |factor| factor * 0.5f64.powi(k)));
    let fits = |factor: f64| (1.0 + UNSURE) * sizes(factor) <= asked.particles as f64;
    let within = factors.enumerate().take_while(|(k, factor)| *k < least || fits(*factor));
    let cycle = |k: usize| if follows(case) { k as u32 } else { 0 };
    within.map(|(k, factor)| Stage { factor, cycle: cycle(k), ..Stage::PLAIN }).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Factors of the family of a case with at most so many particles, whose own cloud has 10,000 in these dimensions.
    fn factors(particles: usize, dimension: usize) -> Vec<f64> {
        let text = "[flow]\nmach = 0.5\n[[body]]\nnaca = \"0012\"\n";
        let case = crate::case::read(text, "t").unwrap();
        let asked = Accuracy { particles, ..Accuracy::in_dimension(dimension) };
        let sizes = |factor: f64| 1e4 * factor.powi(-(dimension as i32));
        family(&case, &asked, &sizes, dimension).iter().map(|stage| stage.factor).collect()
    }

    #[test]
    fn families_go_on_as_long_as_particles_allow() {
        assert_eq!(factors(39_000, 2), [4.0, 2.0, 1.0]);
        assert_eq!(factors(41_000, 2), [4.0, 2.0, 1.0, 0.5]);
        assert_eq!(factors(20_000, 3), [8.0 / 3.0, 2.0, 4.0 / 3.0, 1.0]);
        assert_eq!(factors(90_000, 3), [8.0 / 3.0, 2.0, 4.0 / 3.0, 1.0, 2.0 / 3.0, 0.5]);
    }
}
