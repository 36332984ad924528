//! Messages about wall layers that end early.
//!
//! Columns end before they fold, cross or meet (module `columns`). Where a column ends while its layers are still much
//! thinner than their spacing along the wall, a shear layer that continues beyond them is resolved by the plain
//! background only. There is one message for each reason, with the number of columns, the place of the thinnest end,
//! its number of layers, and a remedy.
use super::Cloud;
use super::layers::{Column, End};
use crate::math::Vector;

/// A column ends early when the thickness of its last layer is less than this fraction of the distance to the adjacent
/// columns.
const EARLY: f64 = 0.5;

/// Columns that end early for the same reason.
struct Ended {
    n: usize,
    ratio: f64,
    layers: usize,
    at: usize,
}

/// One message for each reason for which columns end early.
pub(super) fn notes<const D: usize>(cloud: &Cloud<D>) -> Vec<String> {
    let columns = &cloud.layers.columns;
    let n = columns.len();
    if n > 0 && columns.iter().all(|c| c.particles.is_empty() && c.end == End::Planned) {
        return vec![
            "there are no wall layers: `cloud.wall_layers.first` is larger than the spacing along the walls; hint: lower it"
                .into(),
        ];
    }
    let most = columns.iter().map(|c| c.particles.len()).max().unwrap_or(0);
    let reasons = [End::Meeting, End::Fold, End::Fan, End::Side];
    reasons.into_iter().filter_map(|end| Some(describe(end, &gathered(cloud, end)?, (n, most), cloud))).collect()
}

impl<const D: usize> Cloud<D> {
    /// Messages about wall layers that end early, one for each reason, with the place and a remedy.
    pub fn early_ends(&self) -> Vec<String> {
        notes(self)
    }
}

/// The columns that end early for one reason; `None` when there are none.
fn gathered<const D: usize>(cloud: &Cloud<D>, end: End) -> Option<Ended> {
    let mut found: Option<Ended> = None;
    for (w, column) in cloud.layers.columns.iter().enumerate().filter(|(_, c)| c.end == end) {
        let ratio = thickness(column) / cloud.spacing[cloud.n_fluid + w];
        if ratio >= EARLY {
            continue;
        }
        let worst = found.get_or_insert(Ended { n: 0, ratio, layers: column.particles.len(), at: w });
        worst.n += 1;
        if ratio < worst.ratio {
            (worst.ratio, worst.layers, worst.at) = (ratio, column.particles.len(), w);
        }
    }
    found
}

/// Distance between the last two layers of a column; zero for a column without layers.
fn thickness(column: &Column) -> f64 {
    match column.heights[..] {
        [] => 0.0,
        [only] => only,
        [.., below, top] => top - below,
    }
}

fn describe<const D: usize>(end: End, found: &Ended, (n, most): (usize, usize), cloud: &Cloud<D>) -> String {
    let (why, hint) = match end {
        End::Meeting => (
            "because they would meet another part of the wall or its layers",
            "to keep more layers, raise `growth` or `first`, refine there (`cloud.box`), round the corner or widen the gap",
        ),
        End::Fold => (
            "because they would fold in a concave bend",
            "raise `growth`, which makes the layers lower; to keep more layers, round the bend or refine there (`cloud.box`)",
        ),
        End::Fan => ("because a convex bend spreads them too far", "raise `cloud.curvature_levels`"),
        End::Side | End::Planned => {
            ("at the side of the domain", "enlarge the domain there, or make the side a plane of symmetry")
        }
    };
    let place = place(&cloud.x[cloud.n_fluid + found.at]);
    format!(
        "wall layers end early over {} of {n} wall particles, {why}; the thinnest one ends after {} of {most} layers, at {place}; \
         hint: {hint}",
        found.n, found.layers
    )
}

/// A position as text for a message.
pub(super) fn place<const D: usize>(x: &Vector<D>) -> String {
    let parts: Vec<String> = x.0.iter().map(|c| format!("{c:.5}")).collect();
    format!("({})", parts.join(", "))
}
