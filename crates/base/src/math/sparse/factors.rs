//! Factorisation A = L Lᵀ of a sparse matrix, node by node of the supernode tree.
//!
//! The multifrontal method: the panel of a node and the matrix of its remaining rows collect the entries of A and the
//! update matrices of the children. The columns of the panel are eliminated, and the remaining update matrix is passed
//! to the parent (Duff and Reid 1983, ACM TOMS 9, 302). Subtrees of similar work are eliminated in parallel, each in
//! the same order as by one thread.
use super::number::Number;
use super::panel::{Rows, Target, backward, eliminate, forward, subtract_products};
use super::tree::Tree;
use crate::math::parallel::{sweep_each, sweep_each_chunk};

/// Minimum number of parts into which the work is divided, if there is enough, and the minimum work of a part
/// (multiplications).
const PIECES: f64 = 16.0;
const PIECE: f64 = 1e6;
/// Number of right-hand sides that are solved together.
const ABREAST: usize = 8;

/// Lower triangle of a matrix in the order of elimination, column by column.
pub(super) struct Entries<T> {
    first: Vec<usize>,
    row: Vec<u32>,
    value: Vec<T>,
    /// Pivot of each column below which a pivot may be increased.
    floor: Vec<f64>,
}

impl<T: Number> Entries<T> {
    /// Entries of the matrix whose lower triangle has the columns `first`, `row` and `value`, plus `diagonal(i)`;
    /// pivots below `floor` of their unknown are increased to it.
    pub(super) fn of(
        tree: &Tree,
        (first, row, value): (&[usize], &[usize], &[f64]),
        diagonal: impl Fn(usize) -> T,
        floor: &[f64],
    ) -> Self {
        let n = tree.order.len();
        let mut place = vec![0u32; n];
        tree.order.iter().enumerate().for_each(|(k, i)| place[*i as usize] = k as u32);
        let sorted = |c: usize, r: usize| (place[c].min(place[r]), place[c].max(place[r]));
        let mut starts = vec![0usize; n + 2];
        for c in 0..n {
            row[first[c]..first[c + 1]].iter().for_each(|r| starts[sorted(c, *r).0 as usize + 2] += 1);
        }
        (0..=n).for_each(|c| starts[c + 1] += starts[c]);
        let count = starts[n + 1];
        let (mut rows, mut values) = (vec![0u32; count], vec![T::ZERO; count]);
        for c in 0..n {
            for k in first[c]..first[c + 1] {
                let (low, high) = sorted(c, row[k]);
                let at = &mut starts[low as usize + 1];
                rows[*at] = high;
                values[*at] = T::real(value[k]);
                *at += 1;
            }
        }
        for (k, i) in tree.order.iter().enumerate() {
            let own = (starts[k]..starts[k + 1]).find(|at| rows[*at] == k as u32);
            if let Some(at) = own {
                values[at] += diagonal(*i as usize);
            }
        }
        let floor = tree.order.iter().map(|i| floor[*i as usize]).collect();
        Self { first: starts, row: rows, value: values, floor }
    }
}

/// Result of the elimination of a node: its columns of L, and the update matrix until the parent takes it.
struct Front<T> {
    panel: Vec<T>,
    rest: Vec<T>,
}

/// Fronts of some nodes, each with the index of its node; `None` if a pivot is not valid.
type Fronts<T> = Option<Vec<(usize, Front<T>)>>;

/// The factorisation A = L Lᵀ.
pub(super) struct Factored<T> {
    tree: Tree,
    panels: Vec<Vec<T>>,
}

impl<T: Number> Factored<T> {
    /// Factors the matrix with these entries; `None` if a pivot is not valid.
    pub(super) fn of(tree: Tree, entries: &Entries<T>) -> Option<Self> {
        let pieces = pieces(&tree);
        let mut found: Vec<Fronts<T>> = pieces.iter().map(|_| None).collect();
        sweep_each(&mut found, |k| eliminate_nodes(&tree, entries, &pieces[k], Vec::new()));
        let done: Option<Vec<_>> = found.into_iter().collect();
        let mut below = vec![true; tree.len()];
        pieces.iter().flatten().for_each(|s| below[*s] = false);
        let top: Vec<usize> = (0..tree.len()).filter(|s| below[*s]).collect();
        let all = eliminate_nodes(&tree, entries, &top, done?.into_iter().flatten().collect())?;
        let mut panels: Vec<Vec<T>> = (0..tree.len()).map(|_| Vec::new()).collect();
        all.into_iter().for_each(|(s, front)| panels[s] = front.panel);
        Some(Self { tree, panels })
    }

    /// Replaces the columns of `x`, stored one after another, by A⁻¹ times these columns.
    pub(super) fn solve(&self, x: &mut [T]) {
        let n = self.tree.order.len();
        let columns = x.len() / n.max(1);
        if columns > 1 {
            sweep_each_chunk(x, ABREAST * n.max(1), |_, x| self.solve_abreast::<ABREAST, 1>(x));
        } else if columns == 1 {
            self.solve_abreast::<1, 8>(x);
        }
    }

    /// Solves as [`Factored::solve`] for up to `R` columns; `R` times `G` numbers are summed together.
    fn solve_abreast<const R: usize, const G: usize>(&self, x: &mut [T]) {
        let tree = &self.tree;
        let n = tree.order.len();
        let mut all: Vec<Rows<T, R>> = vec![[T::ZERO; R]; n];
        for (c, x) in x.chunks_exact(n).enumerate() {
            tree.order.iter().zip(&mut all).for_each(|(i, row)| row[c] = x[*i as usize]);
        }
        let mut work = Vec::new();
        for (s, panel) in self.panels.iter().enumerate() {
            let (own, rows) = (tree.columns(s), tree.rows(s));
            work.clear();
            work.extend_from_slice(&all[own.clone()]);
            work.resize(own.len() + rows.len(), [T::ZERO; R]);
            forward::<T, R>(panel, own.len(), &mut work);
            all[own.clone()].copy_from_slice(&work[..own.len()]);
            for (i, less) in rows.iter().zip(&work[own.len()..]) {
                (0..R).for_each(|r| all[*i as usize][r] += less[r]);
            }
        }
        for (s, panel) in self.panels.iter().enumerate().rev() {
            let (own, rows) = (tree.columns(s), tree.rows(s));
            work.clear();
            work.extend_from_slice(&all[own.clone()]);
            work.extend(rows.iter().map(|i| all[*i as usize]));
            backward::<T, R, G>(panel, own.len(), &mut work);
            all[own.clone()].copy_from_slice(&work[..own.len()]);
        }
        for (c, x) in x.chunks_exact_mut(n).enumerate() {
            tree.order.iter().zip(&all).for_each(|(i, row)| x[*i as usize] = row[c]);
        }
    }
}

/// Nodes of subtrees that can be eliminated in parallel, children first, without the nodes above them.
fn pieces(tree: &Tree) -> Vec<Vec<usize>> {
    let mut work: Vec<f64> = (0..tree.len()).map(|s| tree.work(s)).collect();
    let mut start: Vec<usize> = (0..tree.len()).collect();
    for s in 0..tree.len() {
        for c in tree.children[s].iter().map(|c| *c as usize) {
            work[s] += work[c];
            start[s] = start[s].min(start[c]);
        }
    }
    let mut open: Vec<usize> = (0..tree.len()).filter(|s| tree.is_root(*s)).collect();
    let share = (open.iter().map(|s| work[*s]).sum::<f64>() / PIECES).max(PIECE);
    let mut subtrees = Vec::new();
    while let Some(s) = open.pop() {
        if work[s] > share && !tree.children[s].is_empty() {
            open.extend(tree.children[s].iter().map(|c| *c as usize));
        } else {
            subtrees.push(s);
        }
    }
    subtrees.sort_unstable();
    let (mut pieces, mut sum) = (Vec::new(), share);
    for s in subtrees {
        if sum + work[s] > share {
            pieces.push(Vec::new());
            sum = 0.0;
        }
        sum += work[s];
        pieces.last_mut().expect("one was begun").extend(start[s]..=s);
    }
    pieces
}

/// Eliminates nodes, children before parents, starting from those in `done`; returns all of them.
fn eliminate_nodes<T: Number>(
    tree: &Tree,
    entries: &Entries<T>,
    nodes: &[usize],
    mut done: Vec<(usize, Front<T>)>,
) -> Fronts<T> {
    let lowest = nodes.iter().copied().chain(done.iter().map(|d| d.0)).min().unwrap_or(0);
    let mut number = vec![usize::MAX; tree.len() - lowest];
    done.iter().enumerate().for_each(|(k, (s, _))| number[*s - lowest] = k);
    let mut place = vec![0u32; tree.order.len()];
    for s in nodes.iter().copied() {
        let mut front = gathered(tree, entries, s, &mut place);
        let columns = tree.columns(s);
        for c in tree.children[s].iter().map(|c| *c as usize) {
            let rest = std::mem::take(&mut done[number[c - lowest]].1.rest);
            add_rest(&mut front, columns.len(), &rest, (tree.rows(c), &place));
        }
        let (k, r) = (columns.len(), tree.rows(s).len());
        eliminate(&mut front.panel, k + r, &entries.floor[columns])?;
        if r > 0 {
            let behind = Target { values: &mut front.rest, step: r, from: 0 };
            subtract_products(&front.panel, k + r, k, behind);
        }
        number[s - lowest] = done.len();
        done.push((s, front));
    }
    Some(done)
}

/// The front of node `s` with the entries of the matrix; `place` becomes the position of each row in it.
fn gathered<T: Number>(tree: &Tree, entries: &Entries<T>, s: usize, place: &mut [u32]) -> Front<T> {
    let (columns, rows) = (tree.columns(s), tree.rows(s));
    let (k, r) = (columns.len(), rows.len());
    let all = columns.clone().chain(rows.iter().map(|i| *i as usize));
    all.enumerate().for_each(|(at, i)| place[i] = at as u32);
    let mut front = Front { panel: vec![T::ZERO; k * (k + r)], rest: vec![T::ZERO; r * r] };
    for (c, column) in columns.zip(front.panel.chunks_exact_mut(k + r)) {
        for at in entries.first[c]..entries.first[c + 1] {
            column[place[entries.row[at] as usize] as usize] += entries.value[at];
        }
    }
    front
}

/// Adds the update matrix of a child, for the given rows, to a front with `k` columns of its own.
fn add_rest<T: Number>(front: &mut Front<T>, k: usize, rest: &[T], (rows, place): (&[u32], &[u32])) {
    let at: Vec<usize> = rows.iter().map(|i| place[*i as usize] as usize).collect();
    let behind = front.rest.len().isqrt();
    for (j, column) in rest.chunks_exact(rows.len().max(1)).enumerate() {
        let (out, above) = match at[j] {
            c if c < k => (&mut front.panel[c * (k + behind)..(c + 1) * (k + behind)], 0),
            c => (&mut front.rest[(c - k) * behind..(c - k + 1) * behind], k),
        };
        at[j..].iter().zip(&column[j..]).for_each(|(i, x)| out[*i - above] += *x);
    }
}
