//! Which particles field files hold.
use std::borrow::Cow;

use super::field::Snapshot;
use crate::case::Case;
use crate::cloud::Cloud;

/// The particles of a cloud that its field files hold: all, or as many fluid particles as the case asks for at most, and all others.
///
/// Of fluid particles every second, third and so on stays, in the order of the cloud: it winds through space (Hilbert 1891), so that
/// what is fine stays finer than what is coarse.
pub(crate) struct Held {
    every: usize,
    /// Fluid particles of the cloud, and all without images.
    n: [usize; 2],
}

impl Held {
    /// Those that `[output] field_particles` leaves.
    pub(crate) fn of<const D: usize>(case: &Case, cloud: &Cloud<D>) -> Self {
        let every = case.output.field_particles.map_or(1, |most| cloud.n_fluid.div_ceil(most as usize));
        Self { every: every.max(1), n: [cloud.n_fluid, cloud.n_real()] }
    }

    /// All.
    pub(crate) fn all<const D: usize>(cloud: &Cloud<D>) -> Self {
        Self { every: 1, n: [cloud.n_fluid, cloud.n_real()] }
    }

    /// Their numbers in the cloud, fluid particles first.
    pub(crate) fn numbers(&self) -> impl Iterator<Item = usize> + '_ {
        (0..self.n[0]).step_by(self.every).chain(self.n[0]..self.n[1])
    }

    /// How many fluid particles are held.
    pub(crate) fn n_fluid(&self) -> usize {
        self.n[0].div_ceil(self.every)
    }

    /// How many particles are held.
    pub(crate) fn len(&self) -> usize {
        self.n_fluid() + self.n[1] - self.n[0]
    }

    /// How much farther apart held particles are than all, in `d` dimensions.
    pub(crate) fn stretch(&self, d: usize) -> f64 {
        (self.every as f64).powf(1.0 / d as f64)
    }

    /// A field of all particles without images, of those that are held.
    pub(crate) fn thinned<'a>(&self, all: &'a Snapshot) -> Cow<'a, Snapshot> {
        if self.every == 1 {
            return Cow::Borrowed(all);
        }
        let columns = all.columns.iter().map(|(name, n, values)| (*name, *n, self.rows(*n, values).into_owned()));
        Cow::Owned(Snapshot { points: self.numbers().map(|i| all.points[i]).collect(), columns: columns.collect() })
    }

    /// A column of all particles without images, with so many numbers of each, of those that are held.
    pub(crate) fn rows<'a>(&self, components: usize, values: &'a [f64]) -> Cow<'a, [f64]> {
        if self.every == 1 {
            return Cow::Borrowed(values);
        }
        self.numbers().flat_map(|i| &values[i * components..(i + 1) * components]).copied().collect::<Vec<f64>>().into()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn fluid_particles_are_thinned_and_others_stay() {
        let held = Held { every: 3, n: [7, 9] };
        assert_eq!(held.numbers().collect::<Vec<_>>(), [0, 3, 6, 7, 8]);
        assert_eq!((held.n_fluid(), held.len()), (3, 5));
        let number: Vec<f64> = (0..9).map(f64::from).collect();
        assert_eq!(*held.rows(1, &number), [0.0, 3.0, 6.0, 7.0, 8.0]);
        let all = Snapshot { points: number.iter().map(|x| [*x; 3]).collect(), columns: vec![("x", 1, number)] };
        let few = held.thinned(&all);
        assert_eq!(few.points.len(), 5);
        assert_eq!(few.column("x"), Some(&[0.0, 3.0, 6.0, 7.0, 8.0][..]));
        assert_eq!(Held { every: 1, n: [7, 9] }.thinned(&all).points.len(), 9);
    }
}
