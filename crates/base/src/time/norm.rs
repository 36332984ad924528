//! Norm of a residual over several fields.
//!
//! The residual of a row is multiplied by its local time; the norm of a field is the root mean square over its rows.
//! Fields are weighted by the inverse of their initial norms, so that the residuals of all fields must fall together.
use crate::math::reduce::sum;
use crate::system::{Field, Placed, placed};

/// Minimum initial residual of a field in units of its unknowns: a field with a smaller one is regarded as solved.
const NOTHING: f64 = 1e-10;
/// Minimum weight of a field in its own units. A moving body changes the average particle of a large cloud only little;
/// with weight 1, its residual would mask an unconverged gas. In the first step from rest only the body moves, and it
/// determines the norm.
const LEAST: f64 = 1e-3;

/// Sum over all rows of the squared residuals (of the components in the norm) times `scale`, divided by the number of
/// rows of the first field.
pub(super) fn norm(fields: &[Field], r: &[f64], scale: &[f64]) -> f64 {
    let Some(first) = fields.first() else { return 0.0 };
    let total: f64 = placed(fields)
        .map(|at| {
            let (r, scale) = (&r[at.unknowns], &scale[at.rows]);
            sum(at.field.rows, |i| square(&at.field, r, i) * scale[i].powi(2))
        })
        .sum();
    (total / (first.rows * first.instances) as f64).sqrt()
}

/// Sum of the squared residuals of row `i`, of the components in the norm.
#[inline(always)]
fn square(field: &Field, r: &[f64], i: usize) -> f64 {
    let (n, width) = (field.block, field.block / field.instances);
    let row = r[i * n..(i + 1) * n].chunks_exact(width);
    row.map(|r| r[..field.measured].iter().map(|r| r * r).sum::<f64>()).sum::<f64>()
}

/// Multiplies the local times of all fields after the first by the factor that gives each field the weight of the
/// first, for the initial `residuals` of the fields.
pub(super) fn weigh(fields: &[Field], scale: &mut [f64], residuals: &[&[f64]]) {
    let size = |at: &Placed, scale: &[f64]| {
        let count = (at.field.rows * at.field.instances) as f64;
        let one = |r: &&[f64]| {
            let (r, scale) = (&r[at.unknowns.clone()], &scale[at.rows.clone()]);
            (sum(at.field.rows, |i| square(&at.field, r, i) * scale[i].powi(2)) / count).sqrt()
        };
        (residuals.iter().map(one).fold(NOTHING, f64::max), count)
    };
    let mut all = placed(fields);
    let Some((reference, count)) = all.next().map(|at| size(&at, scale)) else { return };
    for at in all {
        let (own, own_count) = size(&at, scale);
        let weight = (reference / own).max(LEAST) * (count / own_count).sqrt();
        scale[at.rows].iter_mut().for_each(|s| *s *= weight);
    }
}
