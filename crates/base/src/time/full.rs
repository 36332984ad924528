//! Linear systems of few unknowns: a dense matrix from differences, solved by elimination.
//!
//! The matrix is −∂R/∂U, column by column, averaged over the points that are added. For the instances of a period it is
//! (shift − ∂R/∂U) ⊗ 1 + ωD, which couples the instances. It serves structures, oscillators and other small systems.
use crate::math::dense::Factors;
use crate::system::{Field, Period, Placed, Preconditioner, RightHandSide, Shift, System, placed, unknowns};

/// Relative change of an unknown in central differences: the cube root of round-off, which balances truncation and
/// rounding.
const CHANGE: f64 = 6e-6;

/// A dense matrix and its factors.
pub struct Full {
    fields: Vec<Placed>,
    n: usize,
    period: Option<Period>,
    points: f64,
    matrix: Vec<f64>,
    factors: Option<Factors>,
    right: Vec<f64>,
}

impl Full {
    /// An empty matrix for `system`.
    pub fn new<S: System>(system: &S, period: Option<Period>) -> Self {
        Self::of_fields(system.fields(), period)
    }

    /// An empty matrix for the unknowns of `fields`.
    pub fn of_fields(fields: &[Field], period: Option<Period>) -> Self {
        let n = unknowns(fields);
        let count = period.map_or(1, |p| p.instances.count());
        let fields = placed(fields).collect();
        Self { fields, n, period, points: 1.0, matrix: vec![0.0; n * n], factors: None, right: vec![0.0; n * count] }
    }

    /// Clears the matrix and starts the average of `points` matrices.
    pub fn clear(&mut self, points: usize) {
        self.points = points as f64;
        self.matrix.fill(0.0);
    }

    /// Adds a matrix −∂R/∂U, stored row by row, to the average.
    pub fn add_matrix(&mut self, matrix: &[f64]) {
        self.matrix.iter_mut().zip(matrix).for_each(|(m, a)| *m += a / self.points);
    }

    /// Adds the shift of every row and the time derivative, and factors the sum.
    pub fn complete(&mut self, shift: &Shift<'_>) {
        let count = self.period.map_or(1, |p| p.instances.count());
        let size = self.n * count;
        let mut all = vec![0.0; size * size];
        for i in 0..self.n {
            for n in 0..count {
                let (row, at) = self.place(i, n, count);
                (0..self.n).for_each(|j| all[at * size + self.place(j, n, count).1] += self.matrix[i * self.n + j]);
                all[at * size + at] += shift.of(row);
            }
            if let Some(period) = &self.period {
                let derivative = period.instances.derivative(period.omega);
                for n in 0..count {
                    let at = self.place(i, n, count).1;
                    (0..count).for_each(|m| all[at * size + self.place(i, m, count).1] += derivative.row(n)[m]);
                }
            }
        }
        self.factors = Factors::new(size, all);
    }

    /// Computes z = A⁻¹ r; z = r if the matrix is singular.
    pub fn solve(&mut self, r: &RightHandSide<'_>, z: &mut [f64]) {
        let count = self.period.map_or(1, |p| p.instances.count());
        for at in &self.fields {
            let b = at.field.block * count;
            for i in 0..at.field.rows {
                let first = at.unknowns.start * count + i * b;
                r.row_in_full(at.rows.start + i, first, &mut self.right[first..first + b]);
            }
        }
        match &self.factors {
            Some(factors) => factors.solve(&self.right, z),
            None => z.copy_from_slice(&self.right),
        }
    }

    /// Memory in use (bytes).
    pub fn held(&self) -> usize {
        8 * (self.matrix.len() + self.right.len() + self.factors.as_ref().map_or(0, |f| f.len() * f.len()))
    }

    /// Row of the unknown `k` of one instance, and its index at instance `n` in the state of all instances.
    fn place(&self, k: usize, n: usize, count: usize) -> (usize, usize) {
        let at = self.fields.iter().find(|at| at.unknowns.contains(&k));
        at.map_or((0, 0), |at| {
            let (b, own) = (at.field.block, k - at.unknowns.start);
            (at.rows.start + own / b, (at.unknowns.start + own / b * b) * count + n * b + own % b)
        })
    }
}

impl<S: System> Preconditioner<S> for Full {
    fn begin(&mut self, points: usize) {
        self.clear(points);
    }

    fn add(&mut self, system: &S, frame: &S::Frame, u: &[f64], work: &mut S::Work) {
        let n = self.n;
        let (mut ahead, mut behind, mut state) = (vec![0.0; n], vec![0.0; n], u.to_vec());
        let mut matrix = vec![0.0; n * n];
        for k in 0..n {
            let change = CHANGE * (1.0 + u[k].abs());
            state[k] = u[k] + change;
            system.rhs(frame, &state, work, &mut ahead);
            state[k] = u[k] - change;
            system.rhs(frame, &state, work, &mut behind);
            state[k] = u[k];
            (0..n).for_each(|i| matrix[i * n + k] = (behind[i] - ahead[i]) / (2.0 * change));
        }
        self.add_matrix(&matrix);
    }

    fn finish(&mut self, shift: &Shift<'_>) {
        self.complete(shift);
    }

    fn apply(&mut self, _: &S, _: &[&S::Frame], r: &RightHandSide<'_>, z: &mut [f64]) {
        self.solve(r, z);
    }

    fn bytes(&self) -> usize {
        self.held()
    }
}
