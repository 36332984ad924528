//! Conditions as rows of the fit.
//!
//! *Slip walls.* The state of an interface particle follows from the fluid particles in front of it by a quadratic fit in
//! which the normal derivative at the wall is imposed exactly (a Neumann row taken into the fit, eqs (12)-(15)): with
//! coordinates t along and n across the wall, f(t, n) = f_w + g n + (linear in t, quadratic in t, n). Solved once per cloud it
//! gives f_w = Σ_k W_k f_k − g Σ_k W_k n_k. Imposed are
//!
//! - ∂(p/ρ^γ)/∂n = 0: entropy does not vary across the wall;
//! - ∂u_t/∂n = −κ u_t: the flow at the wall is irrotational (Crocco), κ the curvature of the wall (tensor in 3-D);
//! - ∂p/∂n = ρ κ u_t²: the centrifugal balance; walls that move add the rate of rotation and the acceleration.
//!
//! *Walls that the gas sticks to* give it their velocity and temperature or ∂θ/∂n = 0; ∂p/∂n = −ρ n·a_w.
//!
//! *Outer sides* hold a state or copy the particle inward of them; *images* copy their source through a reflection or shift.
use super::viscous::lowest_two;
use crate::cloud::Cloud;
use crate::math::Vector;
use crate::math::least_squares::Fit;
use crate::math::sweep::sweep;
use crate::physics::{Gas, Primitive};

/// Sum of absolute weights above which a quadratic fit is replaced by a linear one.
const LARGEST_AMPLIFICATION: f64 = 6.0;
/// Round-off of the sum of weights, which is one.
const CONSTANT_TOLERANCE: f64 = 1e-9;
/// Rows that a quadratic fit must have beyond its coefficients.
const SPARE_ROWS: usize = 3;
/// Smallest fraction of the lowest pressure and entropy in front of a wall that its state may have.
const FLOOR: f64 = 0.2;
/// Most coefficients of a constrained fit: three dimensions, quadratic.
const MOST: usize = 9;

/// Fits of all interface particles.
#[derive(Clone, Debug, Default)]
pub struct WallFits {
    weight: Vec<f64>,
    normal_offset: Vec<f64>,
    /// Number of fits that fell back to linear.
    pub n_linear: usize,
}

impl WallFits {
    /// Fits every interface particle of the cloud.
    #[doc(alias = "eq12")]
    pub fn new<const D: usize>(cloud: &Cloud<D>) -> Self {
        let mut fits = vec![(Vec::new(), 0.0, false); cloud.interface.len()];
        sweep(&mut fits, |w| fit_wall(cloud, w));
        let normal_offset = fits.iter().map(|f| f.1).collect();
        let n_linear = fits.iter().filter(|f| f.2).count();
        Self { weight: fits.into_iter().flat_map(|f| f.0).collect(), normal_offset, n_linear }
    }

    /// Bytes held.
    pub fn bytes(&self) -> usize {
        8 * (self.weight.len() + self.normal_offset.len())
    }
}

/// Weights of one interface particle: (W, Σ W n, fell back to linear).
fn fit_wall<const D: usize>(cloud: &Cloud<D>, w: usize) -> (Vec<f64>, f64, bool) {
    let i = cloud.n_fluid + w;
    let (h, normal) = (cloud.spacing[i], cloud.interface[w].normal);
    let axes = tangents(&normal);
    let (offsets, stretch) = wall_offsets(cloud, w, &axes[0]);
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
    // a crevice: too little fluid for a slope, or all of it far away
    if offsets.len() <= D || !is_sound(&weights) {
        solve_fit(&offsets, (&normal, &axes), h, 1, &mut weights);
    }
    let normal_offset = weights.iter().zip(&offsets).map(|(w, d)| w * d.dot(&normal)).sum::<f64>() / stretch;
    (weights, normal_offset, linear)
}

/// Offsets to the particles of a fit, and the factor by which they are stretched across the wall: where all of them lie in
/// layers, distances along the wall and heights above it, so that a thin layer on a curved wall stays a layer.
fn wall_offsets<const D: usize>(cloud: &Cloud<D>, w: usize, along: &Vector<D>) -> (Vec<Vector<D>>, f64) {
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
        let sign = if d.dot(along) < 0.0 { -1.0 } else { 1.0 };
        *along * (sign * d.norm()) + *normal * (layers.height(column, layer) * stretch)
    };
    (list.iter().map(place).collect(), stretch)
}

/// Weights that reproduce constants, which a rank-deficient fit need not do, without amplifying differences.
fn is_sound(weights: &[f64]) -> bool {
    let (sum, size) = weights.iter().fold((0.0, 0.0), |(sum, size), w| (sum + w, size + w.abs()));
    (sum - 1.0f64).abs() < CONSTANT_TOLERANCE && size <= LARGEST_AMPLIFICATION
}

/// The row that gives f_w from the values of the fluid particles; `n` coefficients, weights 1/r².
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

/// Basis functions without the one whose coefficient the condition fixes: 1, tangents, then all squares and products.
fn basis<const D: usize>(d: &Vector<D>, frame: (&Vector<D>, &[Vector<D>; D]), h: f64) -> [f64; MOST] {
    let (normal, axes) = frame;
    let mut c = [0.0; D];
    (0..D - 1).for_each(|a| c[a] = d.dot(&axes[a]) / h);
    c[D - 1] = d.dot(normal) / h;
    let mut b = [0.0; MOST];
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

/// `D` − 1 unit vectors across the normal; the last entry is unused.
fn tangents<const D: usize>(normal: &Vector<D>) -> [Vector<D>; D] {
    let mut axes = [Vector::ZERO; D];
    if D == 2 {
        (axes[0][0], axes[0][1]) = (-normal[1], normal[0]);
        return axes;
    }
    let smallest = (0..D).fold(0, |a, d| if normal[d].abs() < normal[a].abs() { d } else { a });
    let e = Vector::axis(smallest);
    axes[0] = (e - *normal * e.dot(normal)).unit();
    axes[1] = Vector::from_fn(|d| {
        let (a, b) = ((d + 1) % D, (d + 2) % D);
        normal[a] * axes[0][b] - normal[b] * axes[0][a]
    });
    axes
}

/// How a wall moves near an interface particle, beside its velocity.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WallMotion<const D: usize> {
    /// Rows of ∂w/∂x: the rate of rotation, and of stretching where the wall bends.
    pub wall_velocity_gradient: [Vector<D>; D],
    /// Acceleration.
    pub acceleration: Vector<D>,
}

impl<const D: usize> WallMotion<D> {
    /// A wall that does not move.
    pub const AT_REST: Self = Self { wall_velocity_gradient: [Vector::ZERO; D], acceleration: Vector::ZERO };

    /// The same in axes that `turn` leads to from those of `self` and `back` from there.
    pub(super) fn turned(
        &self,
        turn: impl Fn(&Vector<D>) -> Vector<D>,
        back: impl Fn(&Vector<D>) -> Vector<D>,
    ) -> Self {
        let times = |v: &Vector<D>| Vector::from_fn(|i| self.wall_velocity_gradient[i].dot(v));
        let columns: [Vector<D>; D] = std::array::from_fn(|j| turn(&times(&back(&Vector::axis(j)))));
        let wall_velocity_gradient = std::array::from_fn(|i| Vector::from_fn(|j| columns[j][i]));
        Self { wall_velocity_gradient, acceleration: turn(&self.acceleration) }
    }
}

/// State of interface particle `w` on a slip wall that moves with `velocity` and `motion`.
///
/// With r = v − w the velocity along the wall, G = ∂w/∂x, K the curvature and a_w the acceleration of the wall:
///
/// - the flow at the wall is irrotational: ∂v_t/∂n = Gᵀn − K r, tangential part;
/// - momentum across the wall: ∂p/∂n = ρ [r·K r − 2 n·G r − n·a_w].
///
/// Extrapolation may not bring pressure or entropy below a fraction of the lowest value in front of the wall.
pub fn slip_wall<const D: usize>(
    shape: (&Cloud<D>, &WallFits),
    gas: &Gas,
    w: usize,
    (velocity, motion): (Vector<D>, Option<&WallMotion<D>>),
    q: impl Fn(usize) -> Primitive<D>,
) -> Primitive<D> {
    let (cloud, fits) = shape;
    let (mut p, mut s, mut v) = (0.0, 0.0, Vector::<D>::ZERO);
    let mut lowest = (f64::INFINITY, f64::INFINITY);
    for (k, weight) in cloud.wall_stencils.of(w).iter().zip(&fits.weight[cloud.wall_stencils.range(w)]) {
        let state = q(*k as usize);
        let entropy = gas.entropy(&state);
        p += weight * state.pressure;
        s += weight * entropy;
        v += state.velocity * *weight;
        lowest = (lowest.0.min(state.pressure), lowest.1.min(entropy));
    }
    let (wall, normal_offset) = (&cloud.interface[w], fits.normal_offset[w]);
    let gradient_times =
        |v: &Vector<D>| motion.map_or(Vector::ZERO, |m| Vector::from_fn(|i| m.wall_velocity_gradient[i].dot(v)));
    let normal = &wall.normal;
    let slope = motion
        .map_or(Vector::ZERO, |m| (0..D).fold(Vector::ZERO, |sum, i| sum + m.wall_velocity_gradient[i] * normal[i]));
    let along = along_wall(&(v - velocity - slope * normal_offset), normal);
    let relative = irrotational(&along, wall, normal_offset);
    let s = s.max(FLOOR * lowest.1);
    let density = |p: f64| (p / s).powf(1.0 / gas.gamma);
    let inertia = motion.map_or(0.0, |m| 2.0 * normal.dot(&gradient_times(&relative)) + normal.dot(&m.acceleration));
    let pull = normal_offset * (bending(wall, &relative) - inertia);
    // the density follows the pressure at constant entropy, three rounds settle it
    let mut pressure = p.max(FLOOR * lowest.0);
    for _ in 0..3 {
        pressure = (p - pull * density(pressure)).max(FLOOR * lowest.0);
    }
    let across = *normal * velocity.dot(normal);
    Primitive { density: density(pressure), velocity: relative + along_wall(&velocity, normal) + across, pressure }
}

/// State of interface particle `w` on a wall that the gas sticks to, with ∂p/∂n = −ρ n·a_w and ∂θ/∂n = 0, or at the given
/// temperature: parabolas through the first two layers, or the fit without layers.
pub(super) fn no_slip_wall<const D: usize>(
    (cloud, fits): (&Cloud<D>, &WallFits),
    gas: &Gas,
    w: usize,
    ((velocity, motion), temperature): ((Vector<D>, Option<&WallMotion<D>>), Option<f64>),
    q: impl Fn(usize) -> Primitive<D>,
) -> Primitive<D> {
    let mut sum = (0.0, 0.0);
    let mut lowest = (f64::INFINITY, f64::INFINITY);
    let mut take = |k: usize, weight: f64| {
        let state = q(k);
        let own = (state.pressure, gas.temperature(&state));
        sum = (sum.0 + weight * own.0, sum.1 + weight * own.1);
        lowest = (lowest.0.min(own.0), lowest.1.min(own.1));
    };
    let normal_offset = match lowest_two(cloud, w) {
        Some(([a, b], [low, high])) => {
            let part = low * low / (high * high - low * low);
            take(a, 1.0 + part);
            take(b, -part);
            low * high / (low + high)
        }
        None => {
            let weights = &fits.weight[cloud.wall_stencils.range(w)];
            cloud.wall_stencils.of(w).iter().zip(weights).for_each(|(k, weight)| take(*k as usize, *weight));
            fits.normal_offset[w]
        }
    };
    let (p, floor) = (sum.0, FLOOR * lowest.0);
    let theta = temperature.unwrap_or(sum.1.max(FLOOR * lowest.1));
    let inertia = motion.map_or(0.0, |m| cloud.interface[w].normal.dot(&m.acceleration));
    // p_w = p + normal_offset ρ_w n·a_w with ρ_w = γ p_w/θ
    let pressure = (p / (1.0 - (normal_offset * inertia * gas.gamma / theta).min(0.5))).max(floor);
    Primitive { density: gas.gamma * pressure / theta, velocity, pressure }
}

fn along_wall<const D: usize>(v: &Vector<D>, normal: &Vector<D>) -> Vector<D> {
    *v - *normal * v.dot(normal)
}

/// Solves (I − B K) r = `along`: the tangential velocity with slope −K r across the wall.
fn irrotational<const D: usize>(along: &Vector<D>, wall: &crate::cloud::Interface<D>, normal_offset: f64) -> Vector<D> {
    // B K is small (spacing over radius of curvature): six terms of the Neumann series are plenty
    let apply = |u: &Vector<D>| Vector::from_fn(|r| normal_offset * wall.curvature[r].dot(u));
    let mut u = *along;
    for _ in 0..6 {
        u = along_wall(&(*along + apply(&u)), &wall.normal);
    }
    u
}

/// r·K r.
fn bending<const D: usize>(wall: &crate::cloud::Interface<D>, r: &Vector<D>) -> f64 {
    (0..D).map(|d| r[d] * wall.curvature[d].dot(r)).sum()
}
