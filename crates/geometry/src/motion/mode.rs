//! Mode shapes: displacement of every point of a body for a modal coordinate of one.
//!
//! A file gives displacements u_k at points X_k. Between them, φ is a cubic radial basis function with a linear part,
//!
//! φ(X) = a + B (X − c) + Σ_k w_k |P (X − X_k)|³, φ(X_k) = u_k, Σ_k w_k = 0, Σ_k w_k (X_k − c) = 0,
//!
//! the interpolant of Duchon (1977). It reproduces linear fields, and hence translations and linearised rotations, to
//! round-off, grows linearly far away, and has two continuous derivatives. P projects onto the line or plane in which
//! the points lie, if they do (a beam or a plate), so that the shape is constant across it; otherwise P is the
//! identity. When a file has more points than a dense system can be solved for, φ interpolates a selection of them,
//! chosen one after another at the greatest error ([`super::mode_points`]).
use super::mode_points;
use crate::case::ModeTable;
use crate::math::least_squares::Fit;
use crate::math::{Vector, dense};

/// Ratio of the extent of the points across a line or plane to the extent along it below which they count as lying in
/// it. The chord of a section is at most a thousand times its camber.
const FLAT: f64 = 1e-3;
/// Greatest number of interpolation points; the dense system has as many unknowns.
pub(super) const MOST_KNOTS: usize = 2000;
/// Error of a linear field, as a fraction of the greatest displacement, below which it is exact within the digits of a
/// file.
const LINEAR: f64 = 1e-12;

/// Displacement field per unit of a modal coordinate.
#[derive(Clone, Debug)]
pub struct ModeShape<const D: usize> {
    centre: Vector<D>,
    /// a.
    offset: Vector<D>,
    /// Rows of B.
    slope: [Vector<D>; D],
    /// P X_k.
    knots: Vec<Vector<D>>,
    /// w_k.
    weights: Vec<Vector<D>>,
    /// Rows of P.
    within: [Vector<D>; D],
    /// Greatest displacement in the file.
    size: f64,
    /// Corners of the bounding box of the points of the file.
    corners: [Vector<D>; 2],
    /// Deflection of a control surface behind a hinge.
    hinge: Option<Hinge<D>>,
    /// File of the points, if there is one.
    pub(super) file: Option<String>,
    /// Remarks about repaired and doubtful points.
    pub(super) remarks: Vec<String>,
}

/// Deflection about a hinge, φ = w(X) M (X − l): the part behind the hinge l moves linearly about it; w = s²(3 − 2s)
/// increases from 0 to 1 along x over the blend length.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hinge<const D: usize> {
    /// Hinge point l.
    pub place: Vector<D>,
    /// Blend length, centred on the hinge.
    pub blend: f64,
    /// Rows of M.
    pub rows: [Vector<D>; D],
}

impl<const D: usize> Hinge<D> {
    /// w with its first and second derivative along x.
    fn weight(&self, x: &Vector<D>) -> [f64; 3] {
        let s = (x[0] - self.place[0]) / self.blend.max(f64::MIN_POSITIVE) + 0.5;
        if s <= 0.0 {
            return [0.0; 3];
        }
        if s >= 1.0 {
            return [1.0, 0.0, 0.0];
        }
        [s * s * (3.0 - 2.0 * s), 6.0 * s * (1.0 - s) / self.blend, (6.0 - 12.0 * s) / self.blend.powi(2)]
    }

    fn moved(&self, x: &Vector<D>) -> Vector<D> {
        let arm = *x - self.place;
        Vector::from_fn(|i| self.rows[i].dot(&arm))
    }

    /// Adds φ and its derivatives.
    fn expand(&self, x: &Vector<D>, at: &mut Expansion<D>) {
        let ([w, slope, bend], moved, along) = (self.weight(x), self.moved(x), Vector::<D>::axis(0));
        for i in 0..D {
            at.gradient[i] += self.rows[i] * w + along * (moved[i] * slope);
            for j in 0..D {
                at.second[i][j] += along * (self.rows[i][j] * slope);
            }
            at.second[i][0] += self.rows[i] * slope + along * (moved[i] * bend);
        }
    }
}

/// Value and derivatives of a mode shape at one point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Expansion<const D: usize> {
    /// Displacement φ.
    pub value: Vector<D>,
    /// Gradient ∂φ_i/∂X_j, rows i.
    pub gradient: [Vector<D>; D],
    /// Second derivatives ∂²φ_i/∂X_j∂X_k.
    pub second: [[Vector<D>; D]; D],
}

impl<const D: usize> ModeShape<D> {
    /// The shape through the points of a table; `None` when points lie so close together that it is not determined.
    pub fn new(table: &ModeTable) -> Option<Self> {
        let plain = |list: &[[f64; 3]]| list.iter().map(|x| Vector::from_fn(|d| x[d])).collect::<Vec<Vector<D>>>();
        let (points, shifts) = (plain(&table.points), plain(&table.displacements));
        let n = points.len() as f64;
        let centre = points.iter().fold(Vector::ZERO, |sum, x| sum + *x) * (1.0 / n);
        let axes = axes(&points, &centre);
        let within = std::array::from_fn(|i| match axes.len() == D {
            true => Vector::axis(i),
            false => axes.iter().fold(Vector::ZERO, |sum, (e, _)| sum + *e * e[i]),
        });
        let bounds = crate::math::Bounds::around(&points);
        let size = shifts.iter().map(Vector::norm).fold(0.0, f64::max);
        let corners = [bounds.min, bounds.max];
        let (offset, slope) = linear(&points, &shifts, (&centre, &axes));
        let mut shape = Self { offset, slope, within, size, corners, ..Self::resting(centre) };
        let rest: Vec<Vector<D>> = points.iter().zip(&shifts).map(|(x, u)| *u - shape.at(x)).collect();
        if rest.iter().all(|r| r.max_abs() <= LINEAR * size) {
            return Some(shape);
        }
        if points.len() > MOST_KNOTS {
            return mode_points::thinned(&shape, (&points, &shifts), &axes);
        }
        shape.interpolate(&points, &rest, &axes)?;
        Some(shape)
    }

    /// The shape of a deflection about a hinge; `size` is its approximate greatest displacement.
    pub fn hinged(hinge: Hinge<D>, size: f64) -> Self {
        Self { size, hinge: Some(hinge), ..Self::resting(hinge.place) }
    }

    /// The zero shape.
    fn resting(centre: Vector<D>) -> Self {
        Self {
            centre,
            offset: Vector::ZERO,
            slope: [Vector::ZERO; D],
            knots: Vec::new(),
            weights: Vec::new(),
            within: std::array::from_fn(Vector::axis),
            size: 0.0,
            corners: [centre; 2],
            hinge: None,
            file: None,
            remarks: Vec::new(),
        }
    }

    /// Adds the interpolant of the displacements `rest` at the points; `None` when it is not determined.
    pub(super) fn interpolate(
        &mut self,
        points: &[Vector<D>],
        rest: &[Vector<D>],
        axes: &[(Vector<D>, f64)],
    ) -> Option<()> {
        let (n, m) = (points.len(), axes.len());
        self.knots = points.iter().map(|x| self.projected(x)).collect();
        // scaled by the extent of the points, so that all blocks of the matrix have similar magnitude
        let length = axes.first()?.1;
        let (width, tail) = (n + 1 + m, |x: &Vector<D>, k: usize| (*x - self.centre).dot(&axes[k].0) / length);
        let mut matrix = vec![0.0; width * width];
        for i in 0..n {
            for j in 0..n {
                matrix[i * width + j] = ((self.knots[i] - self.knots[j]).norm() / length).powi(3);
            }
            for k in 0..=m {
                let basis = if k == 0 { 1.0 } else { tail(&points[i], k - 1) };
                (matrix[i * width + n + k], matrix[(n + k) * width + i]) = (basis, basis);
            }
        }
        let mut right: Vec<[f64; D]> = rest.iter().map(|r| r.0).chain((0..=m).map(|_| [0.0; D])).collect();
        if !dense::solve(&mut matrix, &mut right) {
            return None;
        }
        self.weights = right[..n].iter().map(|w| Vector(*w) * length.powi(-3)).collect();
        self.offset += Vector(right[n]);
        for (k, (axis, _)) in axes.iter().enumerate() {
            let along = Vector(right[n + 1 + k]) * (1.0 / length);
            (0..D).for_each(|i| self.slope[i] += *axis * along[i]);
        }
        Some(())
    }

    fn projected(&self, x: &Vector<D>) -> Vector<D> {
        Vector::from_fn(|i| self.within[i].dot(x))
    }

    /// Displacement φ at `x`.
    pub fn at(&self, x: &Vector<D>) -> Vector<D> {
        let (arm, place) = (*x - self.centre, self.projected(x));
        let behind = self.hinge.as_ref().map_or(Vector::ZERO, |h| h.moved(x) * h.weight(x)[0]);
        let linear = self.offset + Vector::from_fn(|i| self.slope[i].dot(&arm)) + behind;
        self.knots.iter().zip(&self.weights).fold(linear, |sum, (knot, w)| {
            let square = (place - *knot).norm_squared();
            sum + *w * (square * square.sqrt())
        })
    }

    /// φ and its derivatives at `x`: ∇r³ = 3 r d, ∇∇r³ = 3 (r P + d dᵀ/r) with d = P (X − X_k).
    pub fn expand(&self, x: &Vector<D>) -> Expansion<D> {
        let place = self.projected(x);
        let mut at = Expansion { value: self.at(x), gradient: self.slope, second: [[Vector::ZERO; D]; D] };
        for (knot, w) in self.knots.iter().zip(&self.weights) {
            let d = place - *knot;
            let r = d.norm();
            let bend: [Vector<D>; D] =
                std::array::from_fn(|j| (self.within[j] * r + d * (d[j] / r.max(f64::MIN_POSITIVE))) * 3.0);
            for i in 0..D {
                at.gradient[i] += d * (3.0 * r * w[i]);
                (0..D).for_each(|j| at.second[i][j] += bend[j] * w[i]);
            }
        }
        if let Some(hinge) = &self.hinge {
            hinge.expand(x, &mut at);
        }
        at
    }

    /// Greatest displacement in the file.
    pub fn size(&self) -> f64 {
        self.size
    }

    /// Corners of the bounding box of the points of the file.
    pub fn corners(&self) -> [Vector<D>; 2] {
        self.corners
    }

    /// Name of the file of the points, if there is one.
    pub fn file(&self) -> Option<&str> {
        self.file.as_deref()
    }

    /// The points that the shape interpolates; empty for a linear field.
    pub fn knots(&self) -> &[Vector<D>] {
        &self.knots
    }

    /// Remarks about repaired and doubtful points of the file.
    pub fn remarks(&self) -> &[String] {
        &self.remarks
    }
}

/// Principal directions of the points, orthonormal, with half of the extent along each, in descending order.
pub(super) fn axes<const D: usize>(points: &[Vector<D>], centre: &Vector<D>) -> Vec<(Vector<D>, f64)> {
    let mut axes: Vec<(Vector<D>, f64)> = Vec::new();
    let mut left: Vec<Vector<D>> = points.iter().map(|x| *x - *centre).collect();
    while axes.len() < D {
        let far = left.iter().fold(Vector::ZERO, |a: Vector<D>, b| if b.norm() > a.norm() { *b } else { a });
        let extent = far.norm();
        if !(extent > axes.first().map_or(0.0, |a| FLAT * a.1)) {
            break;
        }
        let axis = far.unit();
        axes.push((axis, extent));
        left.iter_mut().for_each(|x| *x -= axis * axis.dot(x));
    }
    axes
}

/// Offset a and rows of B of the best linear approximation of the displacements.
fn linear<const D: usize>(
    points: &[Vector<D>],
    shifts: &[Vector<D>],
    (centre, axes): (&Vector<D>, &[(Vector<D>, f64)]),
) -> (Vector<D>, [Vector<D>; D]) {
    let mut fit = Fit::default();
    fit.reset(1 + axes.len());
    for x in points {
        let row: Vec<f64> =
            std::iter::once(1.0).chain(axes.iter().map(|(e, extent)| e.dot(&(*x - *centre)) / extent)).collect();
        fit.push(&row, 1.0);
    }
    let mut weights = Vec::new();
    let mut coefficient = |k: usize| {
        fit.row_of_inverse(k, &mut weights);
        weights.iter().zip(shifts).fold(Vector::ZERO, |sum, (w, u)| sum + *u * *w)
    };
    let offset = coefficient(0);
    let mut slope = [Vector::ZERO; D];
    for (k, (axis, extent)) in axes.iter().enumerate() {
        let along = coefficient(1 + k) * (1.0 / extent);
        (0..D).for_each(|i| slope[i] += *axis * along[i]);
    }
    (offset, slope)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Points of an ellipse or ellipsoid, displaced by `field`.
    fn shape<const D: usize>(n: usize, field: impl Fn(&Vector<D>) -> Vector<D>) -> ModeShape<D> {
        let point = |k: usize| {
            let (a, b) = (k as f64 * 2.399_963, (k as f64 + 0.5) / n as f64);
            let z = 2.0 * b - 1.0;
            let ring = if D == 2 { 1.0 } else { (1.0 - z * z).sqrt() };
            let x = [0.5 + 0.5 * ring * a.cos(), 0.06 * ring * a.sin(), 1.5 * z];
            Vector::<D>::from_fn(|d| x[d])
        };
        let points: Vec<Vector<D>> = (0..n).map(point).collect();
        through(&points, field)
    }

    fn through<const D: usize>(points: &[Vector<D>], field: impl Fn(&Vector<D>) -> Vector<D>) -> ModeShape<D> {
        let table = ModeTable {
            points: points.iter().map(Vector::to_3d).collect(),
            displacements: points.iter().map(|x| field(x).to_3d()).collect(),
        };
        ModeShape::new(&table).unwrap()
    }

    fn places<const D: usize>() -> impl Iterator<Item = Vector<D>> {
        (0..50).map(|k| Vector::from_fn(|d| 1.5 * ((k * (d + 2)) as f64 * 0.7).sin()))
    }

    #[test]
    fn rigid_modes_come_back_to_round_off_everywhere() {
        fn check<const D: usize>() {
            let turn = |x: &Vector<D>| {
                Vector::from_fn(|d| if d == 0 { x[D - 1] } else { 0.0 }) - Vector::axis(D - 1) * (x[0] - 0.25)
            };
            let shift = |_: &Vector<D>| Vector::from_fn(|d| 0.3 - d as f64);
            for field in [&turn as &dyn Fn(&Vector<D>) -> Vector<D>, &shift] {
                let found = shape(60, field);
                for x in places::<D>() {
                    assert!((found.at(&x) - field(&x)).max_abs() < 1e-14, "{x:?}");
                    let at = found.expand(&x);
                    assert!(at.second.iter().flatten().all(|v| v.max_abs() < 1e-12));
                    for j in 0..D {
                        let change = field(&(x + Vector::axis(j))) - field(&x);
                        assert!((0..D).all(|i| (at.gradient[i][j] - change[i]).abs() < 1e-13), "{at:?}");
                    }
                }
            }
        }
        check::<2>();
        check::<3>();
    }

    #[test]
    fn shapes_pass_through_their_points_and_differentiate_consistently() {
        fn check<const D: usize>() {
            let field = |x: &Vector<D>| Vector::axis(D - 1) * (2.0 * x[0]).sin() + Vector::axis(0) * (x[D - 1] * x[0]);
            let found = shape(80, field);
            let mut points = found.knots.clone();
            points.truncate(20);
            points.iter().for_each(|x| assert!((found.at(x) - field(x)).max_abs() < 1e-9, "{x:?}"));
            let h = 1e-5;
            for x in places::<D>() {
                let at = found.expand(&x);
                assert_eq!(at.value, found.at(&x));
                for j in 0..D {
                    let step = Vector::axis(j) * h;
                    let (a, b) = (found.expand(&(x - step)), found.expand(&(x + step)));
                    for i in 0..D {
                        let slope = (b.value[i] - a.value[i]) / (2.0 * h);
                        assert!((at.gradient[i][j] - slope).abs() < 1e-6 * (1.0 + slope.abs()), "{x:?}");
                        let bend = (b.gradient[i] - a.gradient[i]) * (0.5 / h);
                        assert!((at.second[i][j] - bend).max_abs() < 1e-5 * (1.0 + bend.max_abs()), "{x:?}");
                    }
                }
            }
        }
        check::<2>();
        check::<3>();
    }

    #[test]
    fn beams_and_plates_do_not_change_across() {
        let line: Vec<Vector<2>> = (0..11).map(|k| Vector([0.1 * f64::from(k), 0.2])).collect();
        let beam = through(&line, |x| Vector([0.0, x[0] * x[0]]));
        // the natural cubic spline: curvature falls to zero at the ends only
        assert!((beam.at(&Vector([0.53, 7.0])) - Vector([0.0, 0.53 * 0.53])).max_abs() < 2e-3);
        assert_eq!(beam.at(&Vector([0.3, 0.1])), beam.at(&Vector([0.3, -0.4])));
        let plate: Vec<Vector<3>> =
            (0..24).map(|k| Vector([0.2 * f64::from(k % 4), 0.3 * f64::from(k / 4), 0.0])).collect();
        let bent = through(&plate, |x| Vector([0.0, 0.0, x[1] * x[1]]));
        let (at, above) = (bent.expand(&Vector([0.3, 0.8, 0.0])), bent.expand(&Vector([0.3, 0.8, 0.1])));
        assert!((at.value[2] - 0.64).abs() < 1e-2 && (at.gradient[2][1] - 1.6).abs() < 2e-2, "{at:?}");
        assert_eq!((at, at.gradient[2][2]), (above, 0.0));
        let one = through(&[Vector([0.4, 0.0])], |_| Vector([0.0, 1.0]));
        assert_eq!(one.at(&Vector([3.0, 2.0])), Vector([0.0, 1.0]));
    }
}
