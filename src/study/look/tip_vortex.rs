//! The tip vortex: what the lift of a wing leaves behind it, looked at in a plane across the stream.
//!
//! The plane stands half a chord behind the rearmost point of the bodies. The circulation is ∮ v·dx around the half of it on one
//! side of the middle: all vorticity that this half of the wings leaves behind, which is the circulation of the bound vortex at
//! the root, Γ = ∬ ω_x dy dz (Anderson, *Fundamentals of Aerodynamics*, section 5.3), positive where the lift is. The core is the
//! centre of axial vorticity around its greatest value in the outer part.
use super::symmetry::side_of_symmetry;
use crate::case::Case;
use crate::geometry::Surface;
use crate::math::parallel::sweep_each;
use crate::math::{Bounds, Vector};
use crate::record::summary::TipVortex;
use crate::scheme::View;
use crate::scheme::probe::{Near, Probe};

/// Distance of the plane behind the bodies, in chords.
const BEHIND: f64 = 0.5;
/// Lift coefficient from which on there is a vortex to look for.
const LIFTING: f64 = 0.01;
/// Width of the half plane from the middle, and height on both sides of the bodies, in half spans.
const REACH: [f64; 2] = [1.5, 0.75];
/// Part of the half span inside which the core is not looked for.
const INNER: f64 = 0.3;
/// Points along each side of the contour, and of the grid that the core is looked for on.
const POINTS: usize = 120;
/// Radius in which the centre of the core is taken, in spacings of the particles.
const CORE: f64 = 2.0;

/// The half of a plane across the stream behind the bodies.
#[derive(Clone, Copy, Debug)]
pub(crate) struct CrossPlane {
    /// Where it stands.
    pub(crate) x: f64,
    /// y and z of its corners.
    pub(crate) window: Bounds<2>,
    /// 1 where the tip is at its greatest y, -1 where it is at its least.
    side: f64,
    /// From the middle to the tip.
    half: f64,
}

impl CrossPlane {
    /// The plane for these bodies; `None` where the domain ends before it. `chord` is that of the loads.
    pub(crate) fn of<const D: usize>(
        case: &Case,
        surface: &Surface<D>,
        domain: &Bounds<D>,
        chord: f64,
    ) -> Option<Self> {
        if D < 3 {
            return None;
        }
        let b = surface.bounds();
        let (low, high) = (b.min.max(&domain.min), b.max.min(&domain.max));
        let (middle, side) = side_of_symmetry(case, domain).unwrap_or((f64::midpoint(low[1], high[1]), 1.0));
        let half = if side > 0.0 { high[1] - middle } else { middle - low[1] };
        let (x, outer) = (high[0] + BEHIND * chord, middle + side * REACH[0] * half);
        let z = f64::midpoint(low[2], high[2]);
        let within = |v: f64, d: usize| v.clamp(domain.min[d], domain.max[d]);
        let window = Bounds {
            min: Vector([within(middle.min(outer), 1), within(z - REACH[1] * half, 2)]),
            max: Vector([within(middle.max(outer), 1), within(z + REACH[1] * half, 2)]),
        };
        let usable = half > 0.0 && x < domain.max[0] && window.extent()[0] > 0.0 && window.extent()[1] > 0.0;
        usable.then_some(Self { x, window, side, half })
    }

    /// A point of the plane.
    pub(crate) fn place<const D: usize>(&self, y: f64, z: f64) -> Vector<D> {
        Vector::from_fn(|d| [self.x, y, z][d])
    }

    /// ∮ v·dx around it, counterclockwise as seen with y to the right and z up, in the units of the solver.
    fn circulation<const D: usize>(&self, probe: &Probe<'_, D>) -> Option<f64> {
        let Bounds { min, max } = self.window;
        let corners = [[min[0], min[1]], [max[0], min[1]], [max[0], max[1]], [min[0], max[1]]];
        let mut parts: Vec<Option<f64>> = vec![None; corners.len()];
        sweep_each(&mut parts, |k| {
            let (a, b, mut near) = (corners[k], corners[(k + 1) % corners.len()], Near::default());
            let step = [0, 1].map(|d| (b[d] - a[d]) / POINTS as f64);
            let part = |i: usize, near: &mut Near<D>| {
                let at = [0, 1].map(|d| a[d] + (i as f64 + 0.5) * step[d]);
                let v = probe.beside(&self.place(at[0], at[1]), near)?.velocity;
                Some(v[1] * step[0] + v[2] * step[1])
            };
            (0..POINTS).try_fold(0.0, |sum, i| Some(sum + part(i, &mut near)?))
        });
        parts.into_iter().sum()
    }

    /// Where the axial vorticity of this sign is greatest in the outer part, and the centre of it around there.
    fn core<const D: usize>(&self, probe: &Probe<'_, D>, sign: f64) -> Option<[f64; 2]> {
        let (low, extent) = (self.window.min, self.window.extent());
        let at = |k: usize, l: usize| {
            [
                low[0] + extent[0] * (k as f64 + 0.5) / POINTS as f64,
                low[1] + extent[1] * (l as f64 + 0.5) / POINTS as f64,
            ]
        };
        let middle = if self.side > 0.0 { self.window.min[0] } else { self.window.max[0] };
        let mut rows: Vec<Vec<f64>> = vec![Vec::new(); POINTS];
        sweep_each(&mut rows, |l| {
            let mut near = Near::default();
            let mut strength = |k: usize| {
                let [y, z] = at(k, l);
                let outer = (y - middle).abs() > INNER * self.half;
                let found = outer.then(|| probe.vorticity(&self.place(y, z), &mut near)).flatten();
                found.map_or(0.0, |w| (sign * w[0]).max(0.0))
            };
            (0..POINTS).map(&mut strength).collect()
        });
        let all = || (0..POINTS).flat_map(|l| (0..POINTS).map(move |k| (k, l)));
        let (k, l) = all().max_by(|a, b| rows[a.1][a.0].total_cmp(&rows[b.1][b.0]))?;
        let peak = at(k, l);
        let radius = CORE * probe.spacing(&self.place(peak[0], peak[1]), &mut Near::default());
        let near = |p: &[f64; 2]| (p[0] - peak[0]).hypot(p[1] - peak[1]) < radius;
        let sum = all().filter(|(k, l)| near(&at(*k, *l))).fold([0.0; 3], |[s, y, z], (k, l)| {
            let (w, p) = (rows[l][k], at(k, l));
            [s + w, y + w * p[0], z + w * p[1]]
        });
        (sum[0] > 0.0).then(|| [sum[1] / sum[0], sum[2] / sum[0]])
    }
}

/// The vortex behind bodies in space that lift; `chord` is that of the loads, `lift` their coefficient.
pub(crate) fn tip_vortex<const D: usize>(
    case: &Case,
    view: &View<'_, D>,
    surface: Option<&Surface<D>>,
    [chord, lift]: [f64; 2],
) -> Option<TipVortex> {
    let surface = surface.filter(|_| D == 3 && lift.abs() >= LIFTING)?;
    let plane = CrossPlane::of(case, surface, &view.reference().tree.bounds(), chord)?;
    let probe = Probe::new(*view, Some(surface));
    let around = plane.circulation(&probe)?;
    let [y, z] = plane.core(&probe, around.signum())?;
    Some(TipVortex { x: plane.x, y, z, circulation: plane.side * around * case.flow.units().speed })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cloud::{Cloud, CloudSpec};
    use crate::physics::Primitive;
    use crate::scheme::Fluid;
    use crate::scheme::start::FreeStream;
    use crate::system::{Instant, System};
    use std::path::Path;

    #[test] // Lamb-Oseen vortex: v = Γ/(2πr) (1 − exp(−r²/a²))
    fn a_vortex_is_found_with_its_circulation() {
        const GAMMA: f64 = 0.2;
        const CORE: [f64; 2] = [1.6, 0.2];
        let text = "[flow]\nmach = 0.5\n[[body]]\nellipsoid = { size = [0.6, 3.6, 0.3] }\n[cloud]\nspacing = 0.25\n\
                    domain = { min = [-1.5, -4, -2], max = [2.5, 4, 2] }\n[scheme]\nconservative = false\n";
        let case = crate::case::read(text, "case.toml").unwrap_or_else(|e| panic!("{e}"));
        let surface: Surface<3> = crate::geometry::load_surface(&case.bodies, Path::new("")).unwrap().0;
        let cloud = Cloud::build(&CloudSpec::of_case(&case), Some(&surface), &[]).unwrap();
        let fluid = Fluid::new(cloud, &FreeStream::of_case(&case), &case.scheme);
        let frame = fluid.frame(&Instant::still(0.0), &vec![1.0; fluid.len()]);
        let mut work = fluid.work();
        for (q, x) in work.state.iter_mut().zip(&fluid.discretisation.cloud.x) {
            let (dy, dz) = (x[1] - CORE[0], x[2] - CORE[1]);
            let r2 = (dy * dy + dz * dz).max(1e-12);
            let turn = GAMMA / std::f64::consts::TAU * (1.0 - (-r2 / 0.25).exp()) / r2;
            *q = Primitive { density: 1.0, velocity: Vector([0.5, -turn * dz, turn * dy]), pressure: 0.7 };
        }
        fluid.fill_gradients(&frame, &mut work);
        let view = View::new(&fluid, &frame, &work);
        let found = tip_vortex(&case, &view, Some(&surface), [0.6, 0.3]).unwrap();
        assert!((found.x - 0.6).abs() < 0.02, "{found:?}");
        assert!((found.y - CORE[0]).abs() < 0.05 && (found.z - CORE[1]).abs() < 0.05, "{found:?}");
        assert!((found.circulation / GAMMA - 1.0).abs() < 0.02, "{found:?}");
        assert!(tip_vortex(&case, &view, Some(&surface), [0.6, 0.0]).is_none(), "no lift, no vortex");
        assert!(tip_vortex(&case, &view, Some(&surface), [10.0, 0.3]).is_none(), "beyond the domain");
    }
}
