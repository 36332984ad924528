//! The size of a residual over several fields.
//!
//! Each row is measured by the change that its residual would make in one local time; a field by the root mean square over its
//! rows; several fields together so that each counts by what it was at first: the residual of all of them then falls together.
use crate::math::reduce::sum;
use crate::system::{Field, Placed, placed};

/// Least first residual of a field in units of its unknowns: below it a field counts as if it had nothing to do.
const NOTHING: f64 = 1e-10;
/// Least weight of a field in its own units. A body that swings changes the mean particle of a large cloud little: counted in its
/// own units, its motion would hide that the gas is not solved. In the first step from rest only the body moves, and counts.
const LEAST: f64 = 1e-3;

/// Sum over the rows of all fields of the squares of their measured residuals times `scale`, over the rows of the first field.
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

/// Sum of squares of the measured unknowns of row `i`.
#[inline(always)]
fn square(field: &Field, r: &[f64], i: usize) -> f64 {
    let (n, width) = (field.block, field.block / field.instances);
    let row = r[i * n..(i + 1) * n].chunks_exact(width);
    row.map(|r| r[..field.measured].iter().map(|r| r * r).sum::<f64>()).sum::<f64>()
}

/// Multiplies the local times of all fields but the first by what makes each field count as the first does, where `residuals`
/// are those that the fields have at first.
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
