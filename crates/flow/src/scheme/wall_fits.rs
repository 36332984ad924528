//! Constrained fits for the states on walls: the weights, which depend on the cloud only.
//!
//! The state of an interface particle follows from the fluid particles in front of it by a quadratic fit in which the
//! normal derivative at the wall is imposed exactly (a Neumann condition in the fit, eqs (12)-(15)). With coordinates t
//! along and n across the wall, f(t, n) = f_w + g n + (linear in t, quadratic in t, n). Solved once per cloud, it gives
//! f_w = Σ_k W_k f_k − g Σ_k W_k n_k. The slopes g are defined in `wall_state`.
use crate::cloud::Cloud;
use crate::math::Vector;
use crate::math::least_squares::Fit;
use crate::math::parallel::sweep;
use crate::math::square::frame_of;

/// Sum of the absolute weights above which a quadratic fit is replaced by a linear one.
const LARGEST_AMPLIFICATION: f64 = 6.0;
/// Round-off of the sum of the weights, which is one.
const CONSTANT_TOLERANCE: f64 = 1e-9;
/// Number of rows that a quadratic fit must have in excess of its coefficients.
const SPARE_ROWS: usize = 3;
/// Greatest number of coefficients of a constrained fit: quadratic in 3-D.
const MAX_COEFFICIENTS: usize = 9;

/// Fits of all interface particles.
#[derive(Clone, Debug, Default)]
pub struct WallFits {
    weight: Vec<f64>,
    normal_offset: Vec<f64>,
    /// Number of fits that are linear instead of quadratic.
    pub n_linear: usize,
}

impl WallFits {
    /// Computes the fit of every interface particle of the cloud.
    #[doc(alias = "eq12")]
    pub fn new<const D: usize>(cloud: &Cloud<D>) -> Self {
        let mut fits = vec![(Vec::new(), 0.0, false); cloud.interface.len()];
        sweep(&mut fits, |w| fit_wall(cloud, w));
        let normal_offset = fits.iter().map(|f| f.1).collect();
        let n_linear = fits.iter().filter(|f| f.2).count();
        Self { weight: fits.into_iter().flat_map(|f| f.0).collect(), normal_offset, n_linear }
    }

    /// Particles in front of interface particle `w` with their weights W.
    pub fn row<'a, const D: usize>(&'a self, cloud: &'a Cloud<D>, w: usize) -> impl Iterator<Item = (usize, f64)> + 'a {
        let weights = &self.weight[cloud.wall_stencils.range(w)];
        cloud.wall_stencils.of(w).iter().zip(weights).map(|(k, weight)| (*k as usize, *weight))
    }

    /// Offset Σ W n of interface particle `w`.
    pub fn normal_offset(&self, w: usize) -> f64 {
        self.normal_offset[w]
    }

    /// Memory of the fits in bytes.
    pub fn bytes(&self) -> usize {
        8 * (self.weight.len() + self.normal_offset.len())
    }
}

/// Weights of one interface particle: (W, Σ W n, true for a linear fit).
fn fit_wall<const D: usize>(cloud: &Cloud<D>, w: usize) -> (Vec<f64>, f64, bool) {
    let i = cloud.n_fluid + w;
    let (h, normal) = (cloud.spacing[i], cloud.interface[w].normal);
    let axes = frame_of(&normal);
    let (offsets, stretch) = wall_offsets(cloud, w, &axes);
    let mut weights = Vec::new();
    let mut linear = false;
    let quadratic = if D == 2 { 5 } else { 9 };
    if offsets.len() >= quadratic + SPARE_ROWS {
        solve_fit(&offsets, (&normal, &axes), h, quadratic, &mut weights);
    }
    if !is_sound(&weights) {
        linear = true;
        solve_fit(&offsets, (&normal, &axes), h, D, &mut weights);
    }
    // a crevice: too few fluid particles for a slope, or all of them far away
    if offsets.len() <= D || !is_sound(&weights) {
        solve_fit(&offsets, (&normal, &axes), h, 1, &mut weights);
    }
    let normal_offset = weights.iter().zip(&offsets).map(|(w, d)| w * d.dot(&normal)).sum::<f64>() / stretch;
    (weights, normal_offset, linear)
}

/// Offsets to the particles of a fit, and the factor by which they are stretched across the wall. Where all of them lie
/// in layers, the offsets are distances along the wall and heights above it, so that a thin layer on a curved wall
/// remains a layer.
fn wall_offsets<const D: usize>(cloud: &Cloud<D>, w: usize, axes: &[Vector<D>; D]) -> (Vec<Vector<D>>, f64) {
    let (i, list) = (cloud.n_fluid + w, cloud.wall_stencils.of(w));
    let normal = &cloud.interface[w].normal;
    let layers = &cloud.layers;
    let source = |k: &u32| cloud.source(*k as usize);
    if layers.slot(i).is_none() || list.iter().any(|k| layers.slot(source(k).index).is_none()) {
        return (list.iter().map(|k| cloud.x[*k as usize] - cloud.x[i]).collect(), 1.0);
    }
    let stretch = cloud.spacing[i] / layers.thickness(w, 0);
    let place = |k: &u32| {
        let s = source(k);
        let Some((column, layer)) = layers.slot(s.index) else { return Vector::ZERO };
        let foot = cloud.n_fluid + column;
        let d = match s.image {
            // the foot of the image of a column
            true => cloud.x[*k as usize] - *normal * (cloud.x[*k as usize] - cloud.x[i]).dot(normal) - cloud.x[i],
            false => cloud.x[foot] - cloud.x[i],
        };
        let aside = (0..D - 1).fold(Vector::ZERO, |s, a| s + axes[a] * d.dot(&axes[a]));
        aside.unit() * d.norm() + *normal * (layers.height(column, layer) * stretch)
    };
    (list.iter().map(place).collect(), stretch)
}

/// True for weights that reproduce constants, which a rank-deficient fit need not do, and do not amplify differences.
fn is_sound(weights: &[f64]) -> bool {
    let (sum, size) = weights.iter().fold((0.0, 0.0), |(sum, size), w| (sum + w, size + w.abs()));
    (sum - 1.0f64).abs() < CONSTANT_TOLERANCE && size <= LARGEST_AMPLIFICATION
}

/// The weights that give f_w from the values of the fluid particles, for a fit with `n` coefficients and the weights
/// 1/r².
fn solve_fit<const D: usize>(
    offsets: &[Vector<D>],
    frame: (&Vector<D>, &[Vector<D>; D]),
    h: f64,
    n: usize,
    weights: &mut Vec<f64>,
) {
    let mut fit = Fit::default();
    fit.reset(n);
    for d in offsets {
        fit.push(&basis(d, frame, h)[..n], h * h / d.norm_squared());
    }
    fit.row_of_inverse(0, weights);
}

/// Basis functions without the one whose coefficient the condition determines: 1, tangential coordinates, then all
/// squares and products.
fn basis<const D: usize>(d: &Vector<D>, frame: (&Vector<D>, &[Vector<D>; D]), h: f64) -> [f64; MAX_COEFFICIENTS] {
    let (normal, axes) = frame;
    let mut c = [0.0; D];
    (0..D - 1).for_each(|a| c[a] = d.dot(&axes[a]) / h);
    c[D - 1] = d.dot(normal) / h;
    let mut b = [0.0; MAX_COEFFICIENTS];
    b[0] = 1.0;
    b[1..D].copy_from_slice(&c[..D - 1]);
    let mut k = D;
    for p in 0..D {
        for q in p..D {
            b[k] = c[p] * c[q];
            k += 1;
        }
    }
    b
}

/// The two particles next to the wall in the column of interface particle `w`, with their heights.
#[inline]
pub(super) fn lowest_two<const D: usize>(cloud: &Cloud<D>, w: usize) -> Option<([usize; 2], [f64; 2])> {
    let column = cloud.layers.columns.get(w)?;
    let ([a, b, ..], [low, high, ..]) = (column.particles.as_slice(), column.heights.as_slice()) else { return None };
    Some(([*a as usize, *b as usize], [*low, *high]))
}

/// Weights W at two heights, and Σ W n, of a parabola through them with a given slope at the wall.
pub(super) fn parabola([low, high]: [f64; 2]) -> ([f64; 2], f64) {
    let part = low * low / (high * high - low * low);
    ([1.0 + part, -part], low * high / (low + high))
}
