//! GMRES with right preconditioning (Saad and Schultz 1986), matrix-free.
//!
//! Basis vectors are kept in single precision, sums are made in double: the linear systems of an implicit step are solved to
//! a few per cent, and the basis is the largest array of a run.
use super::sweep::{abreast, fill, norm, sum_each, sweep, sweep_chunks};

/// Part of a vector that must be left by a pass of Gram-Schmidt for the rest to be orthogonal enough.
const ENOUGH_LEFT: f64 = 0.1;

/// Storage of GMRES, reused between calls.
pub struct Gmres {
    basis: Vec<Vec<f32>>,
    hessenberg: Vec<Vec<f64>>,
    /// What is left of the right-hand side in the turned basis, and the rotations that turn it.
    g: Vec<f64>,
    rotations: Vec<(f64, f64)>,
    /// Products with the basis, or coefficients in it, and their sums over chunks.
    products: Vec<f64>,
    chunks: Vec<f64>,
}

/// When a solve ends.
#[derive(Clone, Copy, Debug)]
pub struct Goal {
    /// Residual over right-hand side that is asked for.
    pub tolerance: f64,
    /// Greatest number of iterations.
    pub most: usize,
}

/// A linear system by what it does to vectors.
pub struct System<A, P> {
    /// `product(v, out)`: out = A v.
    pub product: A,
    /// `precondition(v, out)`: out ≈ A⁻¹ v.
    pub precondition: P,
}

/// How a solve ended.
#[derive(Clone, Copy, Debug)]
pub struct Solved {
    /// Iterations used.
    pub iterations: usize,
    /// Residual over right-hand side.
    pub reduction: f64,
}

impl Gmres {
    /// Storage for `n` unknowns and at most `size` basis vectors; those are made when they are needed for the first time.
    pub fn new(n: usize, size: usize) -> Self {
        Self {
            basis: vec![vec![0.0; n]],
            hessenberg: vec![vec![0.0; size + 1]; size],
            g: vec![0.0; size + 1],
            rotations: Vec::with_capacity(size),
            products: vec![0.0; size + 1],
            chunks: Vec::new(),
        }
    }

    /// Bytes held.
    pub fn bytes(&self) -> usize {
        4 * self.basis.iter().map(Vec::len).sum::<usize>()
    }

    /// Solves A x = b from x = 0 until the residual has fallen to what `goal` asks, after as many iterations as it
    /// allows, or when the basis is full; `b` is storage afterwards.
    pub fn solve(
        &mut self,
        b: &mut [f64],
        x: &mut [f64],
        goal: Goal,
        system: System<impl FnMut(&[f64], &mut [f64]), impl FnMut(&[f32], &mut [f64])>,
    ) -> Solved {
        let (Goal { tolerance, most }, System { mut product, mut precondition }) = (goal, system);
        fill(x, 0.0);
        let size = self.hessenberg.len();
        let start = norm(b);
        if start == 0.0 {
            return Solved { iterations: 0, reduction: 0.0 };
        }
        sweep(&mut self.basis[0], |i| (b[i] / start) as f32);
        self.g.fill(0.0);
        self.g[0] = start;
        self.rotations.clear();
        let mut used = 0;
        for k in 0..size.min(most.max(1)) {
            precondition(&self.basis[k], x);
            product(x, b);
            self.orthogonalise(k, b);
            self.rotate(k);
            used = k + 1;
            if self.g[k + 1].abs() <= tolerance * start || self.hessenberg[k][k] == 0.0 {
                break;
            }
        }
        self.combine(used, b);
        // the next basis vector is not needed any more: it takes the combination to the preconditioner
        let w = &*b;
        sweep(&mut self.basis[used], |i| w[i] as f32);
        precondition(&self.basis[used], x);
        Solved { iterations: used, reduction: self.g[used].abs() / start }
    }

    /// Gram-Schmidt of A z against the basis; once more where the first pass left little of it.
    ///
    /// The classical form reads each chunk of the basis once for all products, the modified form once for each.
    fn orthogonalise(&mut self, k: usize, w: &mut [f64]) {
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
        let scale = if after > 0.0 { 1.0 / after } else { 0.0 };
        if self.basis.len() == k + 1 {
            self.basis.push(vec![0.0; w.len()]);
        }
        let w = &*w;
        sweep(&mut self.basis[k + 1], |i| (w[i] * scale) as f32);
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

    /// w = Σ y_k v_k with the triangular solve for y.
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

/// Sets `all` to the inner products of `w` with the vectors of the basis.
fn products(w: &[f64], basis: &[Vec<f32>], all: &mut [f64], chunks: &mut Vec<f64>) {
    sum_each(w.len(), all, chunks, |range, out| {
        for (out, v) in out.iter_mut().zip(basis) {
            let (w, v) = (&w[range.clone()], &v[range.clone()]);
            *out = abreast(0..w.len(), &|k| w[k] * f64::from(v[k]));
        }
    })
}

/// w ← w + Σ_j y_j v_j.
fn combine(w: &mut [f64], basis: &[Vec<f32>], y: impl Fn(usize) -> f64 + Sync) {
    sweep_chunks(w, |range, out| {
        for (j, v) in basis.iter().enumerate() {
            let y = y(j);
            out.iter_mut().zip(&v[range.clone()]).for_each(|(w, v)| *w += y * f64::from(*v));
        }
    });
}
