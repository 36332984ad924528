//! The flow on a grid of pixels in a plane, by the solver's own fit.
use crate::geometry::Surface;
use crate::math::parallel::sweep_each_chunk;
use crate::math::{Bounds, Vector};
use crate::physics::Primitive;
use crate::scheme::View;
use crate::scheme::probe::{Near, Probe};

/// Pixels from one that is computed by the fit to the next, at most.
const LARGEST_STEP: usize = 4;
/// Size of the background over that distance from which on pixels between are means.
const COARSE: f64 = 3.0;
/// Margin of flow pictures around the bodies in body lengths.
pub(crate) const MARGIN: f64 = 0.6;
/// Pixels along the longer side of a flow picture in the plane.
pub(crate) const PIXELS: usize = 900;
/// The same in space: particles are farther apart than in the plane, and each pixel asks more of them.
pub(crate) const MIDDLE_PIXELS: usize = 480;

/// What a picture shows: the bodies with a margin in body lengths around them, or all of the domain.
pub(crate) fn around<const D: usize>(surface: Option<&Surface<D>>, all: &Bounds<D>, margin: f64) -> Bounds<2> {
    let b = surface.map_or(*all, |s| s.bounds().padded(margin * s.bounds().extent().max_abs()));
    let pick = |v: Vector<D>| Vector([v[0], v[1]]);
    Bounds { min: pick(b.min.max(&all.min)), max: pick(b.max.min(&all.max)) }
}

/// Pixels of a picture of the flow.
pub(crate) fn pixels<const D: usize>(surface: Option<&Surface<D>>, domain: &Bounds<D>) -> f64 {
    let of = |window: Bounds<2>, along: usize| {
        let extent = window.extent();
        (along * along) as f64 * extent[0].min(extent[1]) / extent[0].max(extent[1])
    };
    match D {
        2 => of(around(surface, domain, MARGIN), PIXELS),
        _ => surface.map_or(0.0, |surface| of(middle_window(surface, domain), MIDDLE_PIXELS)),
    }
}

/// The part of the plane x, z that pictures of the middle show.
pub(crate) fn middle_window<const D: usize>(surface: &Surface<D>, domain: &Bounds<D>) -> Bounds<2> {
    let b = surface.bounds();
    let margin = MARGIN * b.extent()[0].max(b.extent()[D - 1]);
    let cut = |d: usize| [(b.min[d] - margin).max(domain.min[d]), (b.max[d] + margin).min(domain.max[d])];
    let [x, z] = [cut(0), cut(D - 1)];
    Bounds { min: Vector([x[0], z[0]]), max: Vector([x[1], z[1]]) }
}

/// The plane of a picture.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Plane<const D: usize> {
    /// Axes that run to the right and upwards.
    pub(crate) axes: [usize; 2],
    /// A point of it.
    pub(crate) through: Vector<D>,
}

impl<const D: usize> Plane<D> {
    /// That of plane flow.
    pub(crate) fn of_motion() -> Self {
        Self { axes: [0, 1], through: Vector::ZERO }
    }

    /// The point at these coordinates along its axes.
    pub(crate) fn place(&self, at: [f64; 2]) -> Vector<D> {
        let mut x = self.through;
        (0..2).for_each(|k| x[self.axes[k]] = at[k]);
        x
    }
}

/// States on a grid of pixels, `pixels` along the longer side: (width, height, states, `None` inside bodies).
pub(crate) fn sampled<const D: usize>(
    (view, surface): (View<'_, D>, Option<&Surface<D>>),
    plane: &Plane<D>,
    w: &Bounds<2>,
    pixels: usize,
) -> (usize, usize, Vec<Option<Primitive<D>>>) {
    let extent = w.extent();
    let scale = pixels as f64 / extent[0].max(extent[1]);
    let size = [0, 1].map(|d| (extent[d] * scale).round().max(1.0) as usize);
    let probe = Probe::new(view, surface);
    let grid = Grid { view, surface, probe, plane: *plane, from: w.min, pixel: 1.0 / scale, size };
    (size[0], size[1], grid.states(1))
}

/// Pixels of a picture.
struct Grid<'a, const D: usize> {
    view: View<'a, D>,
    surface: Option<&'a Surface<D>>,
    probe: Probe<'a, D>,
    plane: Plane<D>,
    /// Lowest corner.
    from: Vector<2>,
    pixel: f64,
    /// Pixels in a row, and rows.
    size: [usize; 2],
}

impl<const D: usize> Grid<'_, D> {
    /// Every `step`th pixel of every `step`th row.
    fn count(&self, step: usize) -> [usize; 2] {
        self.size.map(|n| (n - 1) / step + 1)
    }

    /// The states there: between pixels of twice that step by their mean where particles are far apart, else by the fit.
    fn states(&self, step: usize) -> Vec<Option<Primitive<D>>> {
        let coarse = if step < LARGEST_STEP { self.states(2 * step) } else { Vec::new() };
        let [across, rows] = self.count(step);
        let mut states = vec![None; across * rows];
        sweep_each_chunk(&mut states, across, |row, states| {
            let mut near = Near::default();
            for (k, state) in states.iter_mut().enumerate() {
                let x = self.place([k, row].map(|c| c * step));
                *state = match self.between((&coarse, 2 * step), [k, row], &x, &mut near) {
                    None => self.fitted(&x, &mut near),
                    known => known,
                };
            }
        });
        states
    }

    fn place(&self, pixel: [usize; 2]) -> Vector<D> {
        self.plane.place([0, 1].map(|d| self.from[d] + (pixel[d] as f64 + 0.5) * self.pixel))
    }

    fn fitted(&self, x: &Vector<D>, near: &mut Near<D>) -> Option<Primitive<D>> {
        let solid = self.surface.is_some_and(|s| s.inside(&self.view.origin(x)));
        if solid { None } else { self.probe.beside(x, near) }
    }

    /// The mean of the `coarse` pixels, `step` apart, around the one that is `at` half steps; `None` where particles are near one
    /// another or one of them is solid.
    fn between(
        &self,
        (coarse, step): (&[Option<Primitive<D>>], usize),
        at: [usize; 2],
        x: &Vector<D>,
        near: &mut Near<D>,
    ) -> Option<Primitive<D>> {
        let ([across, rows], [k, row]) = (self.count(step), at);
        let corner =
            |k: usize, row: usize| (k < across && row < rows).then(|| coarse.get(row * across + k).copied()?)?;
        let (low, high) = ([k / 2, row / 2], [k.div_ceil(2), row.div_ceil(2)]);
        if low == high {
            return corner(k / 2, row / 2);
        }
        if coarse.is_empty() || self.probe.spacing(x, near) < COARSE * step as f64 * self.pixel {
            return None;
        }
        let [a, b] = [corner(low[0], low[1])?, corner(high[0], high[1])?];
        let [c, d] = [corner(low[0], high[1])?, corner(high[0], low[1])?];
        Some(Primitive::zip(
            &Primitive::zip(&a, &b, f64::midpoint),
            &Primitive::zip(&c, &d, f64::midpoint),
            f64::midpoint,
        ))
    }
}
