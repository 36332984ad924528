//! GMRES with right preconditioning (Saad and Schultz 1986), matrix-free.
//!
//! Basis vectors are stored in single precision, those of large systems to two or three digits; sums use double
//! precision. The basis would otherwise be the largest array of a run, and the linear systems of an implicit step are
//! solved only to a few per cent. A rounded basis spans a slightly different, nearly orthogonal space, in which the
//! solution is equally good; the residual is then known to about 1/500 (Aliaga, Anzt, Grützmacher, Quintana-Ortí and
//! Tomás, *Compressed basis GMRES on high-performance graphics processing units*, Int. J. High Perform. Comput. Appl.
//! 37, 2023).
use std::ops::Range;

use super::parallel::{fill, sweep, sweep_chunks};
use super::reduce::{abreast, norm, sum_each};
use super::rounded::{of_upper_half, upper_half};

/// Number of unknowns above which basis vectors are stored to two or three digits.
const LARGE: usize = 1 << 19;
/// Minimum fraction of a vector that must remain after one pass of Gram-Schmidt, so that no second pass is needed for
/// orthogonality.
const ENOUGH_LEFT: f64 = 0.1;

/// Working storage of GMRES, reused between calls.
pub struct Gmres {
    basis: Vec<Stored>,
    hessenberg: Vec<Vec<f64>>,
    /// Right-hand side in the rotated basis, and the Givens rotations.
    g: Vec<f64>,
    rotations: Vec<(f64, f64)>,
    /// Products with the basis, or coefficients in it, and their sums over chunks.
    products: Vec<f64>,
    chunks: Vec<f64>,
}

/// Convergence criteria of a solve.
#[derive(Clone, Copy, Debug)]
pub struct Goal {
    /// Ratio of the residual to the right-hand side at convergence.
    pub tolerance: f64,
    /// Maximum number of iterations.
    pub most: usize,
}

/// A linear system, given by its products with vectors.
pub struct System<A, P> {
    /// `product(v, out)`: out = A v.
    pub product: A,
    /// `precondition(v, out)`: out ≈ A⁻¹ v.
    pub precondition: P,
}

/// Result of a solve.
#[derive(Clone, Copy, Debug)]
pub struct Solved {
    /// Number of iterations.
    pub iterations: usize,
    /// Ratio of the residual to the right-hand side.
    pub reduction: f64,
}

impl Gmres {
    /// Storage for `n` unknowns and at most `size` basis vectors, which are allocated at their first use.
    pub fn new(n: usize, size: usize) -> Self {
        Self::with(Stored::new(n, n > LARGE), size)
    }

    /// Storage whose basis vectors have the format of `first`.
    fn with(first: Stored, size: usize) -> Self {
        Self {
            basis: vec![first],
            hessenberg: vec![vec![0.0; size + 1]; size],
            g: vec![0.0; size + 1],
            rotations: Vec::with_capacity(size),
            products: vec![0.0; size + 1],
            chunks: Vec::new(),
        }
    }

    /// Memory in use (bytes).
    pub fn bytes(&self) -> usize {
        self.basis.iter().map(Stored::bytes).sum()
    }

    /// Solves A x = b from x = 0 until `goal` is reached or the basis is full; `b` is overwritten.
    pub fn solve(
        &mut self,
        b: &mut [f64],
        x: &mut [f64],
        goal: Goal,
        system: System<impl FnMut(&[f64], &mut [f64]), impl FnMut(Numbers<'_>, &mut [f64])>,
    ) -> Solved {
        self.solve_unless((b, x), goal, &|| false, system)
    }

    /// Solves A x = b for `(b, x)` as [`Gmres::solve`]; ends early with the present solution if `stop`, which is called
    /// in every iteration, returns true.
    pub fn solve_unless(
        &mut self,
        (b, x): (&mut [f64], &mut [f64]),
        goal: Goal,
        stop: &dyn Fn() -> bool,
        system: System<impl FnMut(&[f64], &mut [f64]), impl FnMut(Numbers<'_>, &mut [f64])>,
    ) -> Solved {
        let (Goal { tolerance, most }, System { mut product, mut precondition }) = (goal, system);
        fill(x, 0.0);
        let size = self.hessenberg.len();
        let start = norm(b);
        if start == 0.0 {
            return Solved { iterations: 0, reduction: 0.0 };
        }
        self.basis[0].set(|i| (b[i] / start) as f32);
        self.g.fill(0.0);
        self.g[0] = start;
        self.rotations.clear();
        let mut used = 0;
        for k in 0..size.min(most.max(1)) {
            precondition(self.basis[k].numbers(), x);
            product(x, b);
            let left = self.orthogonalise(k, b);
            self.rotate(k);
            used = k + 1;
            if self.g[k + 1].abs() <= tolerance * start || self.hessenberg[k][k] == 0.0 || used == size || stop() {
                break;
            }
            self.lengthen(used, b, left);
        }
        self.combine(used, b);
        precondition(Numbers::Double(b), x);
        Solved { iterations: used, reduction: self.g[used].abs() / start }
    }

    /// Orthogonalises A z against the basis by Gram-Schmidt, twice if the first pass leaves little of it, and returns
    /// the norm of the rest.
    ///
    /// The classical form reads each chunk of the basis once for all products, the modified form once for each product.
    fn orthogonalise(&mut self, k: usize, w: &mut [f64]) -> f64 {
        let column = &mut self.hessenberg[k];
        column[..=k].fill(0.0);
        let mut before = norm(w);
        let mut after = before;
        for _ in 0..2 {
            let h = &mut self.products[..=k];
            products(w, &self.basis[..=k], h, &mut self.chunks);
            column.iter_mut().zip(&*h).for_each(|(c, h)| *c += h);
            combine(w, &self.basis[..=k], |j| -h[j]);
            after = norm(w);
            if after > ENOUGH_LEFT * before {
                break;
            }
            before = after;
        }
        column[k + 1] = after;
        after
    }

    /// Sets basis vector `k` to `w` divided by its norm `size`.
    fn lengthen(&mut self, k: usize, w: &[f64], size: f64) {
        let scale = if size > 0.0 { 1.0 / size } else { 0.0 };
        if self.basis.len() == k {
            self.basis.push(self.basis[0].like());
        }
        self.basis[k].set(|i| (w[i] * scale) as f32);
    }

    fn rotate(&mut self, k: usize) {
        let (h, g, rotations) = (&mut self.hessenberg[k], &mut self.g, &mut self.rotations);
        for (j, (c, s)) in rotations.iter().enumerate() {
            (h[j], h[j + 1]) = (c * h[j] + s * h[j + 1], -s * h[j] + c * h[j + 1]);
        }
        let r = h[k].hypot(h[k + 1]);
        let (c, s) = if r > 0.0 { (h[k] / r, h[k + 1] / r) } else { (1.0, 0.0) };
        rotations.push((c, s));
        (h[k], h[k + 1]) = (r, 0.0);
        (g[k], g[k + 1]) = (c * g[k], -s * g[k]);
    }

    /// Computes w = Σ y_k v_k, where a triangular solve gives y.
    fn combine(&mut self, used: usize, w: &mut [f64]) {
        let y = &mut self.products[..used];
        y.copy_from_slice(&self.g[..used]);
        for k in (0..used).rev() {
            for j in k + 1..used {
                y[k] -= self.hessenberg[j][k] * y[j];
            }
            y[k] = if self.hessenberg[k][k] != 0.0 { y[k] / self.hessenberg[k][k] } else { 0.0 };
        }
        fill(w, 0.0);
        combine(w, &self.basis[..used], |j| y[j]);
    }
}

/// Sets `all` to the inner products of `w` with the basis vectors.
fn products(w: &[f64], basis: &[Stored], all: &mut [f64], chunks: &mut Vec<f64>) {
    sum_each(w.len(), all, chunks, |range, out| {
        for (out, v) in out.iter_mut().zip(basis) {
            *out = v.dot(&range, &w[range.clone()]);
        }
    })
}

/// Computes w ← w + Σ_j y_j v_j.
fn combine(w: &mut [f64], basis: &[Stored], y: impl Fn(usize) -> f64 + Sync) {
    sweep_chunks(w, |range, out| {
        for (j, v) in basis.iter().enumerate() {
            v.add_to(&range, y(j), out);
        }
    });
}

/// A view of stored numbers.
#[derive(Clone, Copy, Debug)]
pub enum Numbers<'a> {
    /// Values in single precision.
    Single(&'a [f32]),
    /// Upper halves of numbers in single precision.
    Halves(&'a [u16]),
    /// Values in double precision.
    Double(&'a [f64]),
}

impl Numbers<'_> {
    /// View of a range of the numbers.
    pub fn of(&self, range: Range<usize>) -> Numbers<'_> {
        match self {
            Self::Single(v) => Numbers::Single(&v[range]),
            Self::Halves(v) => Numbers::Halves(&v[range]),
            Self::Double(v) => Numbers::Double(&v[range]),
        }
    }

    /// Calls `f` with each entry of `row` and the corresponding number; the first one has the index `at`.
    #[inline(always)]
    pub fn each<T>(&self, at: usize, row: &mut [T], f: impl Fn(&mut T, f32)) {
        match self {
            Self::Single(v) => row.iter_mut().zip(&v[at..]).for_each(|(r, v)| f(r, *v)),
            Self::Halves(v) => row.iter_mut().zip(&v[at..]).for_each(|(r, v)| f(r, of_upper_half(*v))),
            Self::Double(v) => row.iter_mut().zip(&v[at..]).for_each(|(r, v)| f(r, *v as f32)),
        }
    }
}

/// A stored basis vector.
enum Stored {
    /// Values in single precision.
    Single(Vec<f32>),
    /// Upper halves of numbers in single precision.
    Halves(Vec<u16>),
}

impl Stored {
    fn new(n: usize, halves: bool) -> Self {
        if halves { Self::Halves(vec![0; n]) } else { Self::Single(vec![0.0; n]) }
    }

    fn like(&self) -> Self {
        Self::new(self.len(), matches!(self, Self::Halves(_)))
    }

    fn len(&self) -> usize {
        match self {
            Self::Single(v) => v.len(),
            Self::Halves(v) => v.len(),
        }
    }

    fn bytes(&self) -> usize {
        match self {
            Self::Single(v) => 4 * v.len(),
            Self::Halves(v) => 2 * v.len(),
        }
    }

    fn set(&mut self, f: impl Fn(usize) -> f32 + Sync) {
        match self {
            Self::Single(v) => sweep(v, f),
            Self::Halves(v) => sweep(v, |i| upper_half(f(i))),
        }
    }

    fn numbers(&self) -> Numbers<'_> {
        match self {
            Self::Single(v) => Numbers::Single(v),
            Self::Halves(v) => Numbers::Halves(v),
        }
    }

    /// Inner product of a range with `w`.
    fn dot(&self, range: &Range<usize>, w: &[f64]) -> f64 {
        match self {
            Self::Single(v) => {
                let v = &v[range.clone()];
                abreast(0..w.len(), &|k| w[k] * f64::from(v[k]))
            }
            Self::Halves(v) => {
                let v = &v[range.clone()];
                abreast(0..w.len(), &|k| w[k] * f64::from(of_upper_half(v[k])))
            }
        }
    }

    /// Computes w ← w + y v over a range.
    fn add_to(&self, range: &Range<usize>, y: f64, w: &mut [f64]) {
        match self {
            Self::Single(v) => w.iter_mut().zip(&v[range.clone()]).for_each(|(w, v)| *w += y * f64::from(*v)),
            Self::Halves(v) => {
                w.iter_mut().zip(&v[range.clone()]).for_each(|(w, v)| *w += y * f64::from(of_upper_half(*v)));
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn residuals_are_what_is_told_whatever_the_size_of_the_unknowns() {
        const N: usize = 3000;
        // convection and diffusion on a line, with unknowns of very different magnitudes
        let size = |i: usize| if i.is_multiple_of(3) { 1e6 } else { 1.0 };
        let at = |v: &[f64], i: usize| v.get(i).map_or(0.0, |v| v / size(i));
        let product = |v: &[f64], out: &mut [f64]| {
            sweep(out, |i| size(i) * (2.4 * at(v, i) - 1.3 * at(v, i.wrapping_sub(1)) - 0.9 * at(v, i + 1)));
        };
        let b: Vec<f64> = (0..N).map(|i| size(i) * (1.0 + (0.01 * i as f64).sin())).collect();
        for (halves, miss) in [(false, 1e-5), (true, 0.004)] {
            let (mut storage, mut x, mut out) = (b.clone(), vec![0.0; N], vec![0.0; N]);
            let precondition = |r: Numbers<'_>, z: &mut [f64]| r.each(0, z, |z, r| *z = f64::from(r) / 2.4);
            let goal = Goal { tolerance: 0.02, most: usize::MAX };
            let mut gmres = Gmres::with(Stored::new(N, halves), 60);
            let solved = gmres.solve(&mut storage, &mut x, goal, System { product, precondition });
            product(&x, &mut out);
            sweep(&mut storage, |i| b[i] - out[i]);
            let reduction = norm(&storage) / norm(&b);
            assert!(solved.reduction <= 0.02 && (reduction - solved.reduction).abs() < miss, "{solved:?} {reduction}");
        }
    }
}
