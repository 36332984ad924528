//! Where wall layers end early, in words.
//!
//! Columns stop before they fold, cross or meet (module `columns`). That is safe, but where a column stops while its layers
//! are still much thinner than long, a shear layer beyond them sees the plain background. For every reason there is one note:
//! how many columns, the place of the worst, how many layers it has, and what helps.
use super::Cloud;
use super::layers::{Column, End};
use crate::math::Vector;

/// Last distance between layers over the distance to the columns beside it, below which a column ends early.
const EARLY: f64 = 0.5;

/// Columns that end early for one reason.
struct Ended {
    n: usize,
    ratio: f64,
    layers: usize,
    at: usize,
}

/// One note for each reason for which columns end early.
pub(super) fn notes<const D: usize>(cloud: &Cloud<D>) -> Vec<String> {
    let columns = &cloud.layers.columns;
    let n = columns.len();
    if n > 0 && columns.iter().all(|c| c.particles.is_empty() && c.end == End::Planned) {
        return vec![
            "no wall layer at all: `cloud.wall_layers.first` is larger than the spacing along the walls; hint: lower it"
                .into(),
        ];
    }
    let most = columns.iter().map(|c| c.particles.len()).max().unwrap_or(0);
    let reasons = [End::Meeting, End::Fold, End::Fan, End::Side];
    reasons.into_iter().filter_map(|end| Some(describe(end, &gathered(cloud, end)?, (n, most), cloud))).collect()
}

impl<const D: usize> Cloud<D> {
    /// Where wall layers end early and why, in words.
    pub fn early_ends(&self) -> Vec<String> {
        notes(self)
    }
}

/// The columns that end early for a reason; `None` when there are none.
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

/// Distance between the last two layers of a column; zero without layers.
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
            "before they meet another part of the wall or its layers",
            "a larger `growth` or `first`, a finer spacing there (`cloud.box`), a rounded corner or a wider gap keep more of them",
        ),
        End::Fold => (
            "before they fold in a concave bend",
            "a larger `growth` keeps them lower, a rounder bend or a finer spacing there (`cloud.box`) keep more of them",
        ),
        End::Fan => ("because a convex bend spreads them", "raise `cloud.curvature_levels`"),
        End::Side | End::Planned => ("at the side of the domain", "give the wall more room, or a side of symmetry"),
    };
    let place = place(&cloud.x[cloud.n_fluid + found.at]);
    format!(
        "wall layers end early over {} of {n} wall particles, {why}; the thinnest end is after {} of {most} layers, at {place}; \
         hint: {hint}",
        found.n, found.layers
    )
}

/// A place as a message shows it.
pub(super) fn place<const D: usize>(x: &Vector<D>) -> String {
    let parts: Vec<String> = x.0.iter().map(|c| format!("{c:.5}")).collect();
    format!("({})", parts.join(", "))
}
