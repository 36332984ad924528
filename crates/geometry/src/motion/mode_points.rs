//! Preparation of the points of a mode file: merging, plausibility, and selection.
//!
//! An interpolant reproduces every error of its points and amplifies it: two neighbouring points with different
//! displacements are a steep slope. Points that coincide within the digits of a file are merged. The others are
//! compared with the values predicted by their neighbours (leave-one-out, S. Rippa, Advances in Computational
//! Mathematics 11, 1999). When there are many points, those are selected at which the shape through the previous ones
//! has the greatest error (T. Rendall and C. Allen, Journal of Computational Physics 228, 2009).
use std::collections::HashSet;

use rstar::RTree;
use rstar::primitives::GeomWithData;

use super::mode::{MOST_KNOTS, ModeShape, axes};
use crate::case::{ModeFile, ModeTable};
use crate::math::{Bounds, Vector};

/// Prefix of a remark about a point that makes results doubtful.
pub const WARNING: &str = "warning: ";
/// Distance, as a fraction of the extent of all points, below which points coincide.
const NEAR: f64 = 1e-4;
/// Permitted difference of the displacements of coincident points, as a fraction of the greatest displacement.
const ALIKE: f64 = 0.01;
/// Permitted error of an interpolant at its own points, as a fraction of the greatest displacement.
const MISSED: f64 = 1e-6;
/// Error at the other points at which the selection of points ends, as a fraction of the greatest displacement.
const CLOSE: f64 = 1e-5;
/// Error at the other points above which the shape is doubtful, as a fraction of the greatest displacement.
const OFF: f64 = 0.01;
/// Number of points of the first selection.
const FIRST: usize = 64;
/// Number of neighbours from which the displacement of a point is predicted.
const NEIGHBOURS: usize = 16;
/// Greatest number of points that are compared with their neighbours.
const MOST_HELD: usize = 2000;
/// Difference from the prediction, as a fraction of the greatest displacement, above which a point is doubtful.
const DOUBTFUL: f64 = 0.05;
/// Fraction of this difference below which its neighbours must agree among themselves without the point.
const ALONE: f64 = 0.25;
/// Typical difference from the prediction, as a fraction of the greatest displacement, above which there are too few
/// points.
const COARSE: f64 = 0.1;

/// Reason why the points of a file do not define a shape.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Flaw {
    /// The points do not determine a shape.
    Crowded,
    /// Two coincident points have different displacements.
    Jump {
        /// Line numbers of both points.
        lines: [usize; 2],
        /// Distance between the points.
        distance: f64,
        /// Difference of their displacements.
        difference: f64,
        /// Greatest displacement of all points.
        greatest: f64,
    },
}

/// The shape through the points of the file `name`.
pub(super) fn shape<const D: usize>(name: &str, file: &ModeFile) -> Result<ModeShape<D>, Flaw> {
    let (table, lines, mut remarks) = joined(name, file)?;
    let mut shape = ModeShape::<D>::new(&table).ok_or(Flaw::Crowded)?;
    let points: Vec<Vector<D>> = table.points.iter().map(vector).collect();
    let misses = |k: usize| (shape.at(&points[k]) - vector(&table.displacements[k])).norm();
    let worst = (0..points.len()).map(|k| (misses(k), k)).fold((0.0, 0), |a, b| if b.0 > a.0 { b } else { a });
    let size = shape.size();
    if points.len() <= MOST_KNOTS && !(worst.0 <= MISSED * size) {
        return Err(Flaw::Crowded);
    }
    if worst.0 > CLOSE * size {
        let doubt = if worst.0 > OFF * size { WARNING } else { "" };
        remarks.push(format!(
            "{doubt}{name}: the shape passes through {} of {} points and misses the others by {:.1e} of the greatest displacement at most, in \
             line {}",
            shape.knots().len(),
            points.len(),
            worst.0 / size,
            lines[worst.1]
        ));
    }
    let centre = points.iter().fold(Vector::ZERO, |sum, x| sum + *x) * (1.0 / points.len() as f64);
    if D == 3 && points.len() > 1 && axes(&points, &centre).len() == 1 {
        remarks.push(format!(
            "{WARNING}{name}: all points lie on a line, about which the shape then does not turn: add points beside it"
        ));
    }
    remarks.extend(doubt::<D>(&table, &lines, size).map(|told| format!("{WARNING}{name}{told}")));
    remarks.extend(file.notes.iter().cloned());
    shape.file = Some(name.to_owned());
    shape.remarks = remarks;
    Ok(shape)
}

fn vector<const D: usize>(x: &[f64; 3]) -> Vector<D> {
    Vector::from_fn(|d| x[d])
}

fn distance(a: &[f64; 3], b: &[f64; 3]) -> f64 {
    (0..3).map(|d| (a[d] - b[d]).powi(2)).sum::<f64>().sqrt()
}

/// A search tree for the points near a position, with their indices.
fn tree(points: &[[f64; 3]]) -> RTree<GeomWithData<[f64; 3], usize>> {
    RTree::bulk_load(points.iter().enumerate().map(|(k, x)| GeomWithData::new(*x, k)).collect())
}

/// The points, with coincident ones merged at their mean, and the line number of each remaining point.
fn joined(name: &str, file: &ModeFile) -> Result<(ModeTable, Vec<usize>, Vec<String>), Flaw> {
    let ModeFile { table, lines, .. } = file;
    let extent = Bounds::around(&table.points.iter().map(|x| Vector(*x)).collect::<Vec<_>>()).extent().norm();
    let greatest = table.displacements.iter().map(|u| distance(u, &[0.0; 3])).fold(0.0, f64::max);
    let (tree, reach) = (tree(&table.points), NEAR * extent);
    let (mut out, mut remarks) = (vec![false; lines.len()], Vec::new());
    let (mut points, mut displacements) = (table.points.clone(), table.displacements.clone());
    for k in 0..lines.len() {
        let x = &table.points[k];
        for other in tree.locate_within_distance(*x, reach * reach).map(|p| p.data).filter(|other| *other > k) {
            if out[k] || out[other] {
                continue;
            }
            let (apart, difference) =
                (distance(x, &table.points[other]), distance(&table.displacements[k], &table.displacements[other]));
            if difference > ALIKE * greatest {
                return Err(Flaw::Jump { lines: [lines[k], lines[other]], distance: apart, difference, greatest });
            }
            out[other] = true;
            let middle = |a: &[f64; 3], b: &[f64; 3]| std::array::from_fn(|d| 0.5 * (a[d] + b[d]));
            (points[k], displacements[k]) =
                (middle(x, &table.points[other]), middle(&table.displacements[k], &table.displacements[other]));
            remarks.push(format!(
                "{WARNING}{name}: the points of lines {} and {} are {apart:.1e} apart and their displacements differ by {difference:.1e}: they \
                 are taken as one",
                lines[k], lines[other]
            ));
        }
    }
    if remarks.len() > 1 {
        let more = remarks.len() - 1;
        remarks.truncate(1);
        remarks[0] += &format!("; so are {more} more pairs");
    }
    let left = || (0..lines.len()).filter(|k| !out[*k]);
    let table = ModeTable {
        points: left().map(|k| points[k]).collect(),
        displacements: left().map(|k| displacements[k]).collect(),
    };
    Ok((table, left().map(|k| lines[k]).collect(), remarks))
}

/// A remark when a point, or the set of points, disagrees with the prediction by the neighbours.
fn doubt<const D: usize>(table: &ModeTable, lines: &[usize], size: f64) -> Option<String> {
    let n = table.points.len();
    if n <= NEIGHBOURS {
        return None;
    }
    let tree = tree(&table.points);
    let near = |k: usize| tree.nearest_neighbor_iter(&table.points[k]).map(|p| p.data).filter(move |j| *j != k);
    // displacement of point `k` as predicted by the points around it, except `but`
    let said = |k: usize, but: Option<usize>| {
        let around: Vec<usize> = near(k).filter(|j| Some(*j) != but).take(NEIGHBOURS).collect();
        let of = |list: &[[f64; 3]]| around.iter().map(|j| list[*j]).collect();
        let shape =
            ModeShape::<D>::new(&ModeTable { points: of(&table.points), displacements: of(&table.displacements) })?;
        Some(shape.at(&vector(&table.points[k])))
    };
    let off = |k: usize, but| said(k, but).map_or(0.0, |u: Vector<D>| (u - vector(&table.displacements[k])).norm());
    let mut errors: Vec<(f64, usize)> = (0..n).step_by(n.div_ceil(MOST_HELD)).map(|k| (off(k, None), k)).collect();
    errors.sort_by(|a, b| b.0.total_cmp(&a.0));
    let ((worst, k), median) = (errors[0], errors[errors.len() / 2].0);
    if median > COARSE * size {
        let part = 100.0 * median / size;
        return Some(format!(
            ": its points are too few for its shape: what their neighbours say of them is {part:.0} % off as a rule"
        ));
    }
    if worst <= DOUBTFUL * size || near(k).take(NEIGHBOURS).any(|j| off(j, Some(k)) > ALONE * worst) {
        return None;
    }
    let expected = said(k, None).map_or(Vec::new(), |u| u.0.iter().map(|v| format!("{v:.3e}")).collect());
    let found: Vec<String> = table.displacements[k][..D].iter().map(|v| format!("{v:.3e}")).collect();
    Some(format!(
        ", line {}: the displacement is ({}), but the points around it say ({})",
        lines[k],
        found.join(", "),
        expected.join(", ")
    ))
}

/// The shape through a selection of many points; `linear` is the best linear approximation of all of them.
pub(super) fn thinned<const D: usize>(
    linear: &ModeShape<D>,
    (points, shifts): (&[Vector<D>], &[Vector<D>]),
    axes: &[(Vector<D>, f64)],
) -> Option<ModeShape<D>> {
    let rest: Vec<Vector<D>> = points.iter().zip(shifts).map(|(x, u)| *u - linear.at(x)).collect();
    let mut chosen: Vec<usize> = Vec::new();
    // the outermost points, so that no linear field vanishes at all selected points
    for (axis, _) in axes {
        let along = |k: &usize| points[*k].dot(axis);
        chosen.extend((0..points.len()).max_by(|a, b| along(a).total_cmp(&along(b))));
        chosen.extend((0..points.len()).min_by(|a, b| along(a).total_cmp(&along(b))));
    }
    let mut errors: Vec<f64> = rest.iter().map(Vector::norm).collect();
    let mut target = FIRST;
    loop {
        take(&mut chosen, points, &errors, (target, axes));
        let mut shape = linear.clone();
        let of = |list: &[Vector<D>]| chosen.iter().map(|k| list[*k]).collect::<Vec<_>>();
        shape.interpolate(&of(points), &of(&rest), axes)?;
        crate::math::parallel::sweep(&mut errors, |k| (shape.at(&points[k]) - shifts[k]).norm());
        let worst = errors.iter().copied().fold(0.0, f64::max);
        if worst <= CLOSE * linear.size() || target >= MOST_KNOTS {
            return Some(shape);
        }
        target = (2 * target).min(MOST_KNOTS);
    }
}

/// Adds points with the greatest errors until there are `target`, but not two neighbours at the same time.
fn take<const D: usize>(
    chosen: &mut Vec<usize>,
    points: &[Vector<D>],
    errors: &[f64],
    (target, axes): (usize, &[(Vector<D>, f64)]),
) {
    let cell = axes[0].1 * (target as f64).powf(-1.0 / axes.len().min(2) as f64);
    let place = |k: usize| points[k].0.map(|x| (x / cell).floor() as i64);
    let mut known: HashSet<usize> = chosen.iter().copied().collect();
    chosen.retain({
        let mut seen = HashSet::new();
        move |k| seen.insert(*k)
    });
    let mut order: Vec<usize> = (0..points.len()).filter(|k| !known.contains(k)).collect();
    order.sort_by(|a, b| errors[*b].total_cmp(&errors[*a]).then(a.cmp(b)));
    let mut cells = HashSet::new();
    for k in order {
        if chosen.len() >= target {
            break;
        }
        if cells.insert(place(k)) && known.insert(k) {
            chosen.push(k);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::case::read_mode;

    /// Two rows of `n` points along a section, displaced by `bend`; `more` rows follow.
    fn file(n: usize, bend: impl Fn(f64) -> f64, more: &str) -> ModeFile {
        let row = |k: usize, y: f64| (k as f64 / (n - 1) as f64, y);
        let rows = (0..n).flat_map(|k| [row(k, -0.06), row(k, 0.06)]).map(|(x, y)| format!("{x},{y},0,{}\n", bend(x)));
        read_mode(&format!("x,y,dx,dy\n{}{more}", rows.collect::<String>()), "m.csv", 2).unwrap()
    }

    fn made(file: &ModeFile) -> ModeShape<2> {
        shape("m.csv", file).unwrap_or_else(|flaw| panic!("{flaw:?}"))
    }

    fn square(x: f64) -> f64 {
        x * x
    }

    #[test]
    fn points_that_are_one_are_joined_or_refused() {
        let clean = made(&file(11, square, ""));
        assert!(clean.remarks().is_empty(), "{:?}", clean.remarks());
        let near = made(&file(11, square, "0.200001,0.06,0,0.0401004\n"));
        let told = "the points of lines 7 and 24 are 1.0e-6 apart and their displacements differ by 1.0e-4";
        assert!(near.remarks().len() == 1 && near.remarks()[0].contains(told), "{:?}", near.remarks());
        for k in 0..20 {
            let x = Vector([0.05 * f64::from(k), 0.03]);
            assert!((near.at(&x) - clean.at(&x)).norm() < 1e-4);
        }
        let apart = shape::<2>("m.csv", &file(11, square, "0.200001,0.06,0,0.5\n")).map(|_| ());
        assert!(matches!(apart, Err(Flaw::Jump { lines: [7, 24], .. })), "{apart:?}");
    }

    #[test]
    fn a_wrong_row_is_told_and_a_hinge_is_not() {
        let wrong = |x: f64| if x == 0.5 { -0.25 } else { x * x };
        let mut table = file(21, square, "");
        let k = table.table.points.iter().position(|x| x[0] == 0.5).unwrap();
        table.table.displacements[k][1] = wrong(0.5);
        let told = made(&table).remarks().to_vec();
        assert!(told.len() == 1 && told[0].contains("line 22: the displacement is (0.000e0, -2.500e-1)"), "{told:?}");
        let hinge = made(&file(21, |x| if x > 0.7 { x - 0.7 } else { 0.0 }, ""));
        assert!(hinge.remarks().is_empty(), "{:?}", hinge.remarks());
    }

    #[test]
    fn many_points_are_passed_near_enough() {
        // a wing with a bend and a twist, upper and lower side
        let point = |k: usize| {
            let (i, j, side) = (k % 50, (k / 50) % 60, k / 3000);
            let z = if side == 0 { 0.05 } else { -0.05 };
            Vector([0.02 * i as f64 + 1e-4 * (7 * k % 11) as f64, 0.05 * j as f64, z])
        };
        let points: Vec<Vector<3>> = (0..6000).map(point).collect();
        let up = |x: &Vector<3>| 0.1 * x[1] * x[1] + 0.2 * (x[0] - 0.4) * (0.5 * x[1]).sin();
        let rows: String = points.iter().map(|x| format!("{},{},{},0,0,{}\n", x[0], x[1], x[2], up(x))).collect();
        let file = read_mode(&format!("X,Y,Z,DX,DY,DZ\n{rows}"), "wing.csv", 3).unwrap();
        let shape = shape::<3>("wing.csv", &file).unwrap();
        let worst = points.iter().map(|x| (shape.at(x)[2] - up(x)).abs()).fold(0.0, f64::max);
        assert!(shape.knots().len() <= MOST_KNOTS && worst < 1e-4 * shape.size(), "{} {worst}", shape.knots().len());
        assert!(shape.remarks().iter().all(|r| !r.starts_with(WARNING)), "{:?}", shape.remarks());
    }

    #[test]
    fn a_line_in_space_does_not_tell_how_a_wing_turns() {
        let rows: String = (0..9).map(|k| format!("0.3,{},0,0,0,{}\n", k, k * k)).collect();
        let file = read_mode(&format!("x,y,z,dx,dy,dz\n{rows}"), "beam.csv", 3).unwrap();
        let told = shape::<3>("beam.csv", &file).unwrap().remarks().to_vec();
        assert!(told.len() == 1 && told[0].contains("all points lie on a line"), "{told:?}");
    }
}
