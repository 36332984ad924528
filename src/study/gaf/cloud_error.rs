//! Error bars of forces in small motion, from the same forces on coarser clouds.
//!
//! An entry f on a cloud of spacing h differs from its limit by C hᵖ, so that with Δ = |f(rh) − f(h)| the error of f(h) is Δ/(rᵖ − 1): with
//! r = 2 Δ of first order, Δ/3 of second. Observed are orders of about 1.1 for lift and 2.3 for the moment about the quarter chord (sections
//! of 1 to 12 % against clouds four times as fine), so that that of first order is the estimate and [`SAFETY`] what it may be short of. Where
//! shocks are captured loads scatter from cloud to cloud, and the greater of two estimates counts. Δ of one entry can vanish where errors change their sign along the frequency; those of a row, over the size of their columns, are alike: no bar is shorter than
//! that of the middle one of them. The bar is the radius of a circle in the complex plane.
use num_complex::Complex64;

use super::{Column, Errors};
use crate::case::{Case, Gaf};

/// Bar over estimate: nine of ten entries hold.
const SAFETY: f64 = 1.25;

/// Columns on a coarser cloud.
pub(super) struct OnCoarser {
    /// How much coarser it is, see [`refinement`](crate::problem::coarser::refinement).
    pub(super) ratio: f64,
    pub(super) columns: Vec<Column>,
}

/// Gives the bars of all `columns` that have their like among those of coarser clouds; a bar
/// of what did not converge says nothing.
pub(super) fn tell(columns: &mut [Column], others: &[OnCoarser]) {
    let like = |c: &Column, coarse: &[Column]| -> Option<Vec<f64>> {
        coarse.iter().find(|o| o.k == c.k && o.mode == c.mode && o.converged).map(|o| change(c, o))
    };
    let estimates = |c: &Column| {
        let all = others.iter().filter_map(|OnCoarser { ratio, columns }| {
            Some(like(c, columns)?.into_iter().map(|d| d / (ratio - 1.0)).collect::<Vec<f64>>())
        });
        all.reduce(|a, b| a.iter().zip(&b).map(|(a, b)| a.max(*b)).collect())
    };
    let changes: Vec<Option<Vec<f64>>> = columns.iter().map(estimates).collect();
    let rows = columns.first().map_or(0, |c| entries(c).count());
    let usual: Vec<f64> = (0..rows)
        .map(|row| {
            let parts = changes.iter().zip(columns.iter());
            median(
                parts.filter_map(|(change, c)| Some(change.as_ref()?[row] / size(c).max(f64::MIN_POSITIVE))).collect(),
            )
        })
        .collect();
    for (column, change) in columns.iter_mut().zip(&changes) {
        let Some(change) = change else { continue };
        let size = size(column);
        let bars: Vec<f64> = change.iter().zip(&usual).map(|(d, u)| SAFETY * d.max(u * size)).collect();
        column.errors = Some(Errors { cl_error: bars[0], cm_error: bars[1], q_error: bars[2..].to_vec() });
    }
}

/// A sentence on why there are no bars; `None` where none are asked for.
pub(super) fn untold(plan: &Gaf, case: &Case) -> Option<String> {
    let why = match case.adapt.cycles {
        0 => "no cloud with twice the spacing fits into the domain",
        _ => "`[adapt]` makes another cloud of each spacing",
    };
    plan.cloud_error.then(|| format!("the error of the cloud is not told: {why}"))
}

/// Lift, moment and generalised forces.
fn entries(column: &Column) -> impl Iterator<Item = Complex64> {
    [column.cl, column.cm].into_iter().chain(column.q.iter().copied()).map(|[re, im]| Complex64::new(re, im))
}

/// What an entry changes by.
fn change(fine: &Column, coarse: &Column) -> Vec<f64> {
    entries(fine).zip(entries(coarse)).map(|(a, b)| (a - b).norm()).collect()
}

/// Root of the sum of squares of all entries of a column.
fn size(column: &Column) -> f64 {
    entries(column).map(|f| f.norm_sqr()).sum::<f64>().sqrt()
}

/// Middle one of some numbers, of two the mean; zero of none.
fn median(mut all: Vec<f64>) -> f64 {
    all.sort_by(f64::total_cmp);
    let n = all.len();
    if n == 0 { 0.0 } else { 0.5 * (all[(n - 1) / 2] + all[n / 2]) }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn column(k: f64, cl: f64, cm: f64) -> Column {
        Column {
            k,
            mode: "pitch".into(),
            cl: [cl, 0.0],
            cm: [0.0, cm],
            q: vec![[0.0, cm]],
            converged: true,
            ..Column::default()
        }
    }

    #[test]
    fn bars_are_the_change_and_at_least_what_is_usual_of_their_row() {
        let mut fine = [column(0.1, 4.0, 0.3), column(0.2, 4.0, 0.3), column(0.3, 4.0, 0.3)];
        // changes of lift of 0.1, 0.2 and none
        let coarse = [column(0.1, 4.1, 0.3), column(0.2, 3.8, 0.3), column(0.3, 4.0, 0.31)];
        tell(&mut fine, &[OnCoarser { ratio: 2.0, columns: coarse.to_vec() }]);
        let lift: Vec<f64> = fine.iter().map(|c| c.errors.as_ref().unwrap().cl_error / SAFETY).collect();
        for (found, expected) in lift.iter().zip([0.1, 0.2, 0.1]) {
            assert!((found - expected).abs() < 1e-12, "{lift:?}");
        }
        let moment: Vec<f64> = fine.iter().map(|c| c.errors.as_ref().unwrap().q_error[0] / SAFETY).collect();
        assert!(moment[0] == 0.0 && (moment[2] - 0.01).abs() < 1e-12, "{moment:?}");
    }

    #[test]
    fn what_did_not_converge_on_the_coarser_cloud_tells_nothing() {
        let mut fine = [column(0.1, 4.0, 0.3), column(0.2, 4.0, 0.3)];
        let coarse = [Column { converged: false, ..column(0.1, 9.0, 0.3) }, column(0.2, 4.2, 0.3)];
        tell(&mut fine, &[OnCoarser { ratio: 2.0, columns: coarse.to_vec() }]);
        assert!(fine[0].errors.is_none() && fine[1].errors.is_some());
    }
}
