//! The gas between a detached shock and the body ahead of which it stands: where it is, and the particles that it needs.
//!
//! A captured shock is a few particles thick, and what leaves it sideways takes more momentum along than gas behind the shock would:
//! the pressure at the stagnation point is too low by about (d − 1) h/(2 R) in d dimensions, R the radius of the shock, whatever the
//! scheme. By the correlations of Billig (1967) that radius is between 5 and 8 times the thickness δ of the layer, so that δ/[`ACROSS`]
//! keeps it within 1 %. Where the cloud is that fine already, nothing is asked.
use super::super::look::Snapshot;
use crate::case::Case;
use crate::cloud::sources::Source;
use crate::exact::shock::normal_shock;
use crate::geometry::Surface;
use crate::math::Vector;

/// Particles across the layer on the cloud of the case itself, in 2-D and 3-D.
const ACROSS: [f64; 2] = [10.0, 16.0];
/// Least pressure of its gas over that behind a normal shock: for a sphere at Mach 3 that holds up to 30° from the axis.
const COMPRESSED: f64 = 0.85;
/// Greatest factor by which it is finer than the walls.
const MOST: f64 = 4.0;
/// Cells of each size around a particle of the layer: those of the cloud it was found on are up to four times as far apart.
const LAYERS: f64 = 2.0;

/// The gas that a shock has slowed down to nearly rest ahead of bodies.
pub(crate) struct ShockLayer<const D: usize> {
    /// Places of the particles in it, and the body each is nearest to.
    places: Vec<(Vector<D>, usize)>,
    /// Thickness of the layer ahead of each body; NaN where there is none.
    thickness: Vec<f64>,
}

impl<const D: usize> ShockLayer<D> {
    /// Finds the layer in a steady solution: gas nearly as compressed as by a normal shock, or more. `None` where the stream is not
    /// faster than sound or there is no such gas.
    pub(crate) fn of(case: &Case, surface: &Surface<D>, field: &Snapshot) -> Option<Self> {
        let least = least_pressure_coefficient(case)?;
        let [pressure, volume, kind] = ["cp", "volume", "kind"].map(|name| field.column(name));
        let (pressure, volume, kind) = (pressure?, volume?, kind?);
        let far = surface.bounds().extent().norm();
        let mut sums = vec![[0.0; 2]; surface.bodies.len()];
        let mut places = Vec::new();
        for i in (0..field.points.len()).filter(|i| kind[*i] == 0.0 && pressure[*i] >= least) {
            let x = Vector::from_fn(|d| field.points[i][d]);
            let Some(near) = surface.nearest(&x, far) else { continue };
            let body = usize::from(surface.elements[near.element as usize].body);
            sums[body][0] += volume[i];
            sums[body][1] += volume[i] * near.distance;
            places.push((x, body));
        }
        // particles of an even layer are half its thickness away from the wall
        let thickness = sums.iter().map(|[all, away]| 2.0 * away / all).collect();
        (!places.is_empty()).then_some(Self { places, thickness })
    }

    /// What the layer asks of the cloud with `factor` times the spacing of the case, and `coarser` than it should be; empty where that
    /// is fine enough.
    pub(crate) fn sources(&self, wall: f64, factor: f64, coarser: f64) -> Vec<Source<D>> {
        let spacing = |body: usize| coarser * (factor * self.thickness[body] / ACROSS[D - 2]).max(wall / MOST);
        let finer = self.places.iter().filter(|(_, body)| spacing(*body) < wall);
        finer.map(|(x, b)| Source { x: *x, spacing: spacing(*b), layers: LAYERS }).collect()
    }
}

/// Least pressure coefficient of the gas in the layer.
fn least_pressure_coefficient(case: &Case) -> Option<f64> {
    let (mach, gamma) = (case.flow.reference().mach, case.flow.gamma);
    let behind = normal_shock(mach, gamma).ok()?.pressure;
    Some((COMPRESSED * behind - 1.0) / (0.5 * gamma * mach * mach))
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use super::*;
    use crate::problem::surface;

    /// Gas compressed as by a normal shock up to `thickness` ahead of a circle of radius 1/2.
    fn field(thickness: f64) -> Snapshot {
        let place = |i: i32, j: i32| [0.02 * f64::from(i) - 1.0, 0.02 * (f64::from(j) + 0.5), 0.0];
        let points: Vec<[f64; 3]> = (0..50).flat_map(|i| (-15..15).map(move |j| place(i, j))).collect();
        let away = |p: &[f64; 3]| p[0].hypot(p[1]) - 0.5;
        let cp = points.iter().map(|p| f64::from(u8::from((0.0..thickness).contains(&away(p))))).map(|c| 1.8 * c);
        let columns = vec![
            ("cp", 1, cp.collect()),
            ("volume", 1, vec![4e-4; points.len()]),
            ("kind", 1, vec![0.0; points.len()]),
        ];
        Snapshot { points, columns }
    }

    fn case(mach: f64, spacing: f64) -> Case {
        let cloud = format!("[cloud]\nspacing = {spacing}\n");
        crate::case::read(&format!("[flow]\nmach = {mach}\n{cloud}[[body]]\ncircle = {{ radius = 0.5 }}\n"), "t")
            .unwrap()
    }

    #[test]
    fn a_thin_layer_asks_for_particles_across_it_and_a_thick_one_does_not() {
        let case = case(6.0, 0.0625);
        let body = surface::<2>(&case, Path::new(".")).unwrap().0.unwrap();
        let layer = ShockLayer::<2>::of(&case, &body, &field(0.2)).unwrap();
        assert!((layer.thickness[0] / 0.2 - 1.0).abs() < 0.1, "{:?}", layer.thickness);
        let sources = layer.sources(0.0625, 1.0, 1.0);
        assert!(sources.len() == layer.places.len() && sources.iter().all(|s| (s.spacing / 0.02 - 1.0).abs() < 0.1));
        assert!(layer.sources(0.0625, 1.0, 4.0).is_empty(), "that coarse it asks for nothing");
        let thick = ShockLayer::<2>::of(&case, &body, &field(0.4)).unwrap();
        assert!(thick.sources(0.03125, 1.0, 1.0).is_empty(), "it has enough");
    }

    #[test]
    fn gas_that_is_not_faster_than_sound_has_none() {
        let case = case(0.9, 0.0625);
        let body = surface::<2>(&case, Path::new(".")).unwrap().0.unwrap();
        assert!(ShockLayer::<2>::of(&case, &body, &field(0.2)).is_none());
        assert!(ShockLayer::<2>::of(&self::case(3.0, 0.0625), &body, &field(0.0)).is_none());
    }
}
