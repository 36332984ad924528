//! Columns of what does not evolve, in rows of the linearised scheme.
//!
//! A wall state follows the particle in front of it: its column is folded into the row with the mirror that removes the normal
//! velocity. An image follows its source.
use super::fluid::{Fluid, Work};
use super::frame::Frame;
use crate::math::Vector;
use crate::math::block_matrix::Rows;

/// Adds the block of `column`, a wall, an outer particle or an image, to `row`: to the particle that rules it.
#[inline(always)]
pub(super) fn couple<const D: usize>(
    fluid: &Fluid<D>,
    rows: &mut Rows<'_>,
    (frame, work): (&Frame<D>, &Work<D>),
    (row, column): (usize, usize),
    coupling: impl Fn(usize, usize) -> f64,
) {
    let cloud = &frame.discretisation.cloud;
    if cloud.interface_range().contains(&column) {
        let wall = &cloud.interface[column - cloud.n_fluid];
        let slips = fluid.wall_condition(wall.body).slips();
        match slips {
            true => rows.add(row, row, |r, c| folded(&coupling, &wall.normal, r, c)),
            false => {
                let ends = (&work.state[row].velocity, &work.state[column].velocity);
                rows.add(row, row, |r, c| no_slip_entry(&coupling, ends, r, c));
            }
        }
    } else if column >= cloud.n_real() {
        let image = cloud.ghosts[column - cloud.n_real()];
        let sign = cloud.transforms[image.transform as usize].sign;
        let flip = |c: usize| if (1..=D).contains(&c) { sign[c - 1] } else { 1.0 };
        if (image.source as usize) < cloud.n_fluid {
            rows.add(row, image.source as usize, |r, c| coupling(r, c) * flip(c));
        }
    }
}

/// Entry (r, c) of coupling · P, where P removes the normal velocity of the particle in front of the wall.
fn folded<const D: usize>(coupling: &impl Fn(usize, usize) -> f64, normal: &Vector<D>, r: usize, c: usize) -> f64 {
    if !(1..=D).contains(&c) {
        return coupling(r, c);
    }
    let along: f64 = (0..D).map(|d| coupling(r, 1 + d) * normal[d]).sum();
    coupling(r, c) - along * normal[c - 1]
}

/// Entry (r, c) of coupling · P, where P gives density and pressure of the particle in front of a wall, moving with v, to a
/// state with the velocity w of the wall.
fn no_slip_entry<const D: usize>(
    coupling: &impl Fn(usize, usize) -> f64,
    (v, w): (&Vector<D>, &Vector<D>),
    r: usize,
    c: usize,
) -> f64 {
    let energy = coupling(r, D + 1);
    match c {
        0 => {
            let carried: f64 = (0..D).map(|d| coupling(r, 1 + d) * w[d]).sum();
            coupling(r, 0) + carried + 0.5 * (v.norm_squared() + w.norm_squared()) * energy
        }
        c if c <= D => -energy * v[c - 1],
        _ => energy,
    }
}
