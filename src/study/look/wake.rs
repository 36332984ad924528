//! Lift and drag from the wake of bodies in a steady subsonic stream: what far-field methods see in a plane behind them.
//!
//! With the stream U along e_D, Oswatitsch's part of the drag is what the entropy of the gas that passes a plane with the normal n takes,
//!
//! D_s = ∫ ρ (v·n)(U − ū) dS, ū² = U² − 2a²/(γ − 1) ((K/K∞)^(1/γ) − 1), K = p/ρ^γ,
//!
//! where ū is the speed that the gas would have at the pressure of the free stream (van der Vooren and Destarac 2004); total enthalpy is
//! that of the free stream. The rest is induced drag; with v' = v − ū e_D and its part u' along e_D it is to second order
//!
//! D_i = ρ∞ ∫ [(n·e_D)(v'·v' + M² u'²)/2 − (v'·n) u'] dS,
//!
//! which for n = e_D is Maskell's (1972) crossflow energy ρ∞/2 ∫ (v² + w² − (1 − M²) u²) dS and does not depend on the distance from
//! the body. Lift is that of the vorticity ω of the wake at y along the span, L = ρ∞ U ∫ y ω·n dS (Kutta and Joukowski), the
//! circulation around tiles of the plane. The wake is looked for near the bodies alone: far away particles are wide apart, and what
//! rounding leaves there adds up over large areas. A captured wake decays: its crossflow becomes entropy, so that the sum of both
//! drags stays.
use super::momentum::tile;
use super::symmetry::side_of_symmetry;
use crate::case::Case;
use crate::geometry::Surface;
use crate::math::reduce::sums;
use crate::math::{Bounds, Vector};
use crate::observe::loads::LoadAxes;
use crate::physics::Primitive;
use crate::record::summary::WakePlane;
use crate::scheme::View;
use crate::scheme::probe::{Near, Probe};
use crate::scheme::start::free_stream;

/// Distances of the planes behind the bodies in reference chords.
const DISTANCES: [f64; 3] = [0.5, 0.75, 1.0];

/// How far beyond the bodies across the stream the wake is looked for, in reference chords.
const MARGIN: f64 = 1.2;

/// Lift and drag from planes behind the bodies, the nearest first; none without bodies or a subsonic stream, or in the plane.
pub(crate) fn wake_planes<const D: usize>(
    view: &View<'_, D>,
    surface: Option<&Surface<D>>,
    case: &Case,
    axes: &LoadAxes,
) -> Vec<WakePlane> {
    surface.map_or_else(Vec::new, |surface| planes_at(view, &surface.bounds(), case, axes, &DISTANCES))
}

/// Drag coefficient of the entropy in the nearest plane; `None` without bodies or a subsonic stream, or in the plane.
pub(crate) fn entropy_drag<const D: usize>(view: &View<'_, D>, case: &Case, axes: &LoadAxes) -> Option<f64> {
    let bodies = Bounds::around(view.fluid.walls_before());
    planes_at(view, &bodies, case, axes, &DISTANCES[..1]).first().map(|plane| plane.cd_entropy)
}

/// The same in planes at these distances behind `bodies`.
fn planes_at<const D: usize>(
    view: &View<'_, D>,
    bodies: &Bounds<D>,
    case: &Case,
    axes: &LoadAxes,
    distances: &[f64],
) -> Vec<WakePlane> {
    let free = &free_stream(case);
    let mach = free.velocity.norm();
    if D != 3 || view.cloud().interface.is_empty() || !(0.0 < mach && mach < 1.0) {
        return Vec::new();
    }
    let domain = view.reference().tree.bounds();
    let rear = bodies.max[0];
    let near = bodies.padded(MARGIN * axes.chord);
    let middle = side_of_symmetry(case, &domain).map_or(0.0, |side| side.0);
    let wake = Wake { view, probe: Probe::new(*view, None), free, mach, axes, near, middle };
    let inside = |distance: &f64| rear + distance * axes.chord < domain.max[0];
    distances.iter().copied().filter(inside).map(|d| wake.plane(d, rear + d * axes.chord, &domain)).collect()
}

/// A flow whose wake is looked at.
struct Wake<'a, const D: usize> {
    view: &'a View<'a, D>,
    probe: Probe<'a, D>,
    free: &'a Primitive<D>,
    mach: f64,
    axes: &'a LoadAxes,
    /// Where the wake is looked for, across the stream.
    near: Bounds<D>,
    /// Where along the span its vorticity is counted from: the plane of symmetry of a half model.
    middle: f64,
}

impl<const D: usize> Wake<'_, D> {
    fn plane(&self, distance: f64, x: f64, domain: &Bounds<D>) -> WakePlane {
        let mut tiles: Vec<(Vector<D>, Vector<D>)> = Vec::new();
        tile(self.view, domain, (0, x), &mut |middle, extent| tiles.push((middle, extent)));
        let all = sums(tiles.len(), |k| self.tile(&tiles[k]).unwrap_or_default());
        let [cl, cd_induced, cd_entropy] = all.map(|sum| sum / self.axes.force_scale);
        WakePlane { distance, x, cl, cd_induced, cd_entropy, cd: cd_induced + cd_entropy }
    }

    /// Lift, induced drag and drag of entropy of a tile; `None` where there is no gas.
    fn tile(&self, (middle, extent): &(Vector<D>, Vector<D>)) -> Option<[f64; 3]> {
        let mut near = Near::default();
        let mut corner = |y: f64, z: f64| {
            let shift = Vector::from_fn(|d| [0.0, y, z][d] * extent[d]);
            self.probe.beside(&(*middle + shift), &mut near)
        };
        let [a, b, c, d] = [corner(-0.5, -0.5)?, corner(0.5, -0.5)?, corner(0.5, 0.5)?, corner(-0.5, 0.5)?];
        let side =
            |p: &Primitive<D>, q: &Primitive<D>, d: usize| f64::midpoint(p.velocity[d], q.velocity[d]) * extent[d];
        let circulation = side(&a, &b, 1) + side(&b, &c, 2) - side(&d, &c, 1) - side(&a, &d, 2);
        let area = extent[1] * extent[2];
        let drags = [a, b, c, d].iter().map(|q| self.drags(q)).fold([0.0; 2], |s, d| [s[0] + d[0], s[1] + d[1]]);
        let lift = self.free.density * self.mach * (middle[1] - self.middle) * circulation;
        let inside = (1..D).all(|d| self.near.min[d] < middle[d] && middle[d] < self.near.max[d]);
        let wake = if inside { [lift, 0.25 * area * drags[1]] } else { [0.0; 2] };
        Some([wake[0], 0.25 * area * drags[0], wake[1]])
    }

    /// Induced drag and drag of entropy for a unit of area.
    fn drags(&self, q: &Primitive<D>) -> [f64; 2] {
        let (gas, free, mach) = (&self.view.fluid.gas, self.free, self.mach);
        let along = Vector::<D>::from_fn(|d| self.axes.drag[d]);
        let sound2 = gas.sound_speed(free).powi(2);
        // at the pressure of the free stream the temperature has grown as exp((γ−1)/γ Δs/R)
        let warmer = (gas.entropy(q) / gas.entropy(free)).powf(1.0 / gas.gamma) - 1.0;
        let left = (mach * mach - 2.0 * sound2 / (gas.gamma - 1.0) * warmer).max(0.0).sqrt();
        let rest = q.velocity - along * left;
        let u = rest.dot(&along);
        let induced = 0.5 * along[0] * (rest.norm_squared() + mach * mach * u * u) - rest[0] * u;
        [free.density * induced, q.density * q.velocity[0] * (mach - left)]
    }
}
