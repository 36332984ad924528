//! Transfer of the state of Lagrangian particles to a rebuilt cloud.
//!
//! Particles that remain keep their state. The state of an inserted particle is a quadratic least-squares fit of the
//! conserved quantities through its neighbours, limited to the range of the fitted values; linear fields are
//! transferred exactly. An inserted particle takes its volume from its neighbours in proportion to the weights of its
//! fit, and a removed particle leaves its volume to them. The conservation error, V (fit − U) for each removed
//! particle, is recorded.
//!
//! *History.* The velocity of a new particle is a linear fit of the velocities of its neighbours. Its state some steps
//! ago is its present state minus the same fit of their changes: U(t − Δt) at x − w Δt, so that a linear field at rest
//! is preserved by a difference formula of any number of time levels.
use super::fluid::{Fluid, Work};
use crate::cloud::travel::{NEW, Recloud};
use crate::cloud::{Cloud, CloudError};
use crate::math::Vector;
use crate::math::least_squares::Fit;
use crate::physics::{Conserved, n_variables};

/// Sum of the absolute weights above which a fit is replaced by one of lower degree.
const LARGEST_AMPLIFICATION: f64 = 3.0;
/// Number of rows that a quadratic fit must have in excess of its coefficients.
const SPARE_ROWS: usize = 2;
/// Fraction of the range of the fitted values by which the result may exceed it: next to a smooth extremum, a parabola
/// exceeds the nearest values by an eighth of the range over three spacings.
const MARGIN: f64 = 0.3;

/// Record of all rebuilds of the cloud.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct RemapLedger {
    /// Number of rebuilds.
    pub renewals: u32,
    /// Number of inserted particles.
    pub inserted: u64,
    /// Number of removed particles.
    pub removed: u64,
    /// Amount by which these rebuilds reduced the total of each conserved quantity.
    pub lost: Vec<f64>,
    /// Sum of the absolute values of these amounts.
    pub exchanged: Vec<f64>,
    /// Largest number of first-order rows in a cloud.
    pub first_order: u32,
}

/// Data for the transfer of the state to a rebuilt cloud.
pub(super) struct Transfer<'a, const D: usize> {
    pub(super) fluid: &'a Fluid<D>,
    pub(super) old: &'a Cloud<D>,
    pub(super) work: &'a Work<D>,
    pub(super) recloud: &'a Recloud<D>,
    pub(super) before: &'a [f64],
}

/// Contribution of a particle of the previous cloud to a new one: its index, its image, and the weight.
pub(super) struct Share {
    from: usize,
    transform: Option<u8>,
    weight: f64,
}

/// Position and state of a nearby particle.
type Sample<const D: usize> = (Vector<D>, Conserved<D>);

impl<const D: usize> Transfer<'_, D> {
    pub(super) fn state(&self, ledger: &mut RemapLedger) -> Result<Vec<f64>, CloudError> {
        let cloud = &self.recloud.cloud;
        let n = n_variables(D);
        let mut u = vec![0.0; n * cloud.n_fluid];
        let from = &self.recloud.from;
        crate::math::parallel::sweep_rows(&mut u, n, |i, row| match from[i] {
            NEW => row.fill(f64::NAN),
            k => row.copy_from_slice(&self.before[k as usize * n..(k as usize + 1) * n]),
        });
        let mut inserted = 0;
        for i in (0..cloud.n_fluid).filter(|i| from[*i] == NEW) {
            let value = self.fitted(&self.around_new(i), cloud.spacing[i]).ok_or_else(|| {
                let problem = format!("nothing is near particle {i} at {}, which fills a hole", cloud.x[i]);
                CloudError::Quality(vec![problem])
            })?;
            value.store(&mut u[i * n..(i + 1) * n]);
            inserted += 1;
        }
        self.count(inserted, ledger);
        Ok(u)
    }

    /// For each new particle, in order, the contributions of previous particles by a linear fit.
    pub(super) fn lines(&self) -> Vec<Vec<Share>> {
        let cloud = &self.recloud.cloud;
        let share = |j: usize| {
            let transform = j.checked_sub(cloud.n_real()).map(|k| cloud.ghosts[k].transform);
            let from = *self.recloud.from.get(cloud.source(j).index).filter(|k| **k != NEW)? as usize;
            Some((cloud.x[j], Share { from, transform, weight: 0.0 }))
        };
        let line = |i: usize| {
            let (x, mut shares): (Vec<Vector<D>>, Vec<Share>) =
                self.near(i).into_iter().filter_map(|j| share(j as usize)).map(|(x, s)| (x - cloud.x[i], s)).unzip();
            let mut weights = Vec::new();
            for (degree, least) in [(1 + D, n_variables(D)), (1, 1)] {
                if x.len() >= least && weigh(&x, cloud.spacing[i], degree, &mut weights) {
                    shares.iter_mut().zip(&weights).for_each(|(s, w)| s.weight = *w);
                    break;
                }
            }
            shares
        };
        (0..cloud.n_fluid).filter(|i| self.recloud.from[*i] == NEW).map(line).collect()
    }

    /// Vectors of the fluid particles on the rebuilt cloud; empty when there were none.
    pub(super) fn directions(&self, before: &[Vector<D>], lines: &[Vec<Share>]) -> Vec<Vector<D>> {
        let transforms = &self.recloud.cloud.transforms;
        let seen =
            |s: &Share| s.transform.map_or(before[s.from], |t| transforms[t as usize].direction(&before[s.from]));
        let fitted = |line: &Vec<Share>| {
            let first = line.first().map_or(Vector::ZERO, seen);
            line.iter().fold(first, |v, s| v + (seen(s) - first) * s.weight)
        };
        let mut lines = lines.iter();
        let mut of = |k: &u32| match *k {
            NEW => lines.next().map_or(Vector::ZERO, fitted),
            k => before[k as usize],
        };
        if before.is_empty() { Vec::new() } else { self.recloud.from.iter().map(&mut of).collect() }
    }

    /// A state of previous time levels, `then` on the previous cloud, transferred to the rebuilt one, where the present
    /// state is `now`: new particles changed as their neighbours did. Empty when there was none.
    pub(super) fn past(&self, then: &[f64], now: &[f64], lines: &[Vec<Share>]) -> Vec<f64> {
        let n = n_variables(D);
        let load = |u: &[f64], k: usize| Conserved::<D>::load(&u[k * n..]);
        let change = |s: &Share| {
            let mut change = load(self.before, s.from).plus(-1.0, &load(then, s.from));
            if let Some(t) = s.transform {
                change.momentum = self.recloud.cloud.transforms[t as usize].direction(&change.momentum);
            }
            change
        };
        let mut lines = lines.iter();
        let mut past = if then.is_empty() { Vec::new() } else { now.to_vec() };
        for (i, (k, row)) in self.recloud.from.iter().zip(past.chunks_exact_mut(n)).enumerate() {
            match *k {
                NEW => {
                    let line = lines.next().into_iter().flatten();
                    line.fold(load(now, i), |u, s| u.plus(-s.weight, &change(s))).store(row);
                }
                k => row.copy_from_slice(&then[k as usize * n..(k as usize + 1) * n]),
            }
        }
        past
    }

    /// Records this rebuild.
    fn count(&self, inserted: u64, ledger: &mut RemapLedger) {
        let n = n_variables(D);
        ledger.renewals += 1;
        ledger.inserted += inserted;
        ledger.removed += self.recloud.removed.len() as u64;
        ledger.lost.resize(n, 0.0);
        ledger.exchanged.resize(n, 0.0);
        ledger.first_order = ledger.first_order.max(self.recloud.cloud.first_order.len() as u32);
        for i in &self.recloud.removed {
            let i = *i as usize;
            let Some(fit) = self.fitted(&self.around_removed(i), self.old.spacing[i]) else { continue };
            let volume = self.old.spacing[i].powi(D as i32);
            let mut row = vec![0.0; n];
            fit.plus(-1.0, &Conserved::load(&self.before[i * n..])).store(&mut row);
            for (c, r) in row.iter().enumerate() {
                ledger.lost[c] += volume * r;
                ledger.exchanged[c] += (volume * r).abs();
            }
        }
    }

    /// Neighbours of a new particle, and their neighbours, that existed in the previous cloud.
    fn around_new(&self, i: usize) -> Vec<Sample<D>> {
        let cloud = &self.recloud.cloud;
        let sample = |j: u32| Some((cloud.x[j as usize] - cloud.x[i], self.known(j as usize)?));
        self.near(i).into_iter().filter_map(sample).collect()
    }

    /// Neighbours of particle `i` of the rebuilt cloud, and their neighbours.
    fn near(&self, i: usize) -> Vec<u32> {
        let cloud = &self.recloud.cloud;
        let own = cloud.neighbours.of(i);
        let rows = own.iter().filter(|j| (**j as usize) < cloud.n_rows());
        let mut list: Vec<u32> = rows.flat_map(|j| cloud.neighbours.of(*j as usize)).chain(own).copied().collect();
        list.sort_unstable();
        list.dedup();
        list
    }

    /// State of particle `j` of the rebuilt cloud, if it existed before.
    fn known(&self, j: usize) -> Option<Conserved<D>> {
        let (cloud, old) = (&self.recloud.cloud, self.old);
        let source = cloud.source(j).index;
        let before = match self.recloud.from.get(source) {
            Some(&NEW) => return None,
            Some(k) => *k as usize,
            None => source - cloud.n_fluid + old.n_fluid,
        };
        let mut q = self.work.state[before];
        if let Some(image) = j.checked_sub(cloud.n_real()).map(|k| cloud.ghosts[k]) {
            q.velocity = cloud.transforms[image.transform as usize].direction(&q.velocity);
        }
        Some(self.fluid.gas.conserved(&q))
    }

    /// Remaining neighbours of a removed particle.
    fn around_removed(&self, i: usize) -> Vec<Sample<D>> {
        let stays =
            |j: &&u32| self.recloud.removed.binary_search(&(self.old.source(**j as usize).index as u32)).is_err();
        let row = self.old.neighbours.of(i).iter().filter(stays);
        row.map(|j| {
            let j = *j as usize;
            (self.old.x[j] - self.old.x[i], self.fluid.gas.conserved(&self.work.state[j]))
        })
        .collect()
    }

    /// Fitted value at the centre of the samples; `None` without samples.
    fn fitted(&self, samples: &[Sample<D>], h: f64) -> Option<Conserved<D>> {
        let quadratic = 1 + D + D * (D + 1) / 2;
        let x: Vec<Vector<D>> = samples.iter().map(|s| s.0).collect();
        let mut weights = Vec::new();
        for (degree, least) in [(quadratic, quadratic + SPARE_ROWS), (1 + D, n_variables(D)), (1, 1)] {
            if samples.len() < least {
                continue;
            }
            if !weigh(&x, h, degree, &mut weights) {
                continue;
            }
            // differences from the nearest sample preserve a uniform state to the last bit
            let nearest = samples.iter().min_by(|a, b| a.0.norm_squared().total_cmp(&b.0.norm_squared()))?.1;
            let fit = samples.iter().zip(&weights).fold(nearest, |s, ((_, u), w)| s.plus(*w, &u.plus(-1.0, &nearest)));
            if degree == 1 || self.is_within(&fit, samples) {
                return Some(fit);
            }
        }
        None
    }

    /// True when density and pressure lie within the range of the samples plus a margin.
    fn is_within(&self, u: &Conserved<D>, samples: &[Sample<D>]) -> bool {
        let gas = &self.fluid.gas;
        let of = |u: &Conserved<D>| {
            let q = gas.primitive(u);
            [q.density, q.pressure]
        };
        let all: Vec<[f64; 2]> = samples.iter().map(|s| of(&s.1)).collect();
        let found = of(u);
        (0..2).all(|k| {
            let (low, high) = all.iter().fold((f64::INFINITY, 0.0f64), |(l, h), v| (l.min(v[k]), h.max(v[k])));
            let slack = MARGIN * (high - low);
            // round-off of a uniform state
            let slack = slack.max(1e-12 * high);
            found[k] > 0.0 && low - slack <= found[k] && found[k] <= high + slack
        })
    }
}

/// Weights for the value at the centre of samples at the relative positions `places`, by a fit with `degree`
/// coefficients; false when the sum of absolute weights is too large, which cannot happen for a mean value.
fn weigh<const D: usize>(places: &[Vector<D>], h: f64, degree: usize, weights: &mut Vec<f64>) -> bool {
    let mut fit = Fit::default();
    fit.reset(degree);
    for d in places {
        let x = *d * (1.0 / h);
        let mut basis = vec![1.0];
        basis.extend(x.0);
        basis.extend((0..D).flat_map(|r| (r..D).map(move |c| (r, c))).map(|(r, c)| x[r] * x[c]));
        fit.push(&basis[..degree], 1.0 / x.norm_squared().max(f64::MIN_POSITIVE));
    }
    fit.row_of_inverse(0, weights);
    let sum: f64 = weights.iter().sum();
    let size: f64 = weights.iter().map(|w| w.abs()).sum();
    degree == 1 || (sum - 1.0).abs() < 1e-9 && size <= LARGEST_AMPLIFICATION
}
