//! What a field file holds on planes of symmetry.
//!
//! Particles stand half a spacing off a plane of symmetry, so that cells between them end there and a slice along the plane meets none.
//! The flow on both sides is the same: what stands on the plane itself is what its nearest particles have, without the components that
//! a reflection turns round. Such points are added to field files, a shade beyond the plane, so that slices along it cut cells.
use std::borrow::Cow;

use super::field::Snapshot;
use super::held::Held;
use crate::case::{Case, Side};
use crate::cloud::Cloud;
use crate::math::Vector;

/// Distance from the plane, in spacings, up to which particles are the nearest: they stand in the middle of their cells.
const NEAREST: f64 = 0.8;
/// How far beyond the plane points stand, in spacings.
pub(crate) const SHADE: f64 = 1e-6;
/// Component of a wall's normal along that of the plane above which the wall lies along the plane and does not meet it.
const ALONG: f64 = 0.9;
/// Value of the array `kind` there.
const KIND: f64 = 3.0;

/// A point on a plane.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Foot {
    /// The particle that it is nearest to, or the point on another plane: a row of the file.
    of: usize,
    /// Axis across the plane.
    axis: usize,
    /// Where it stands on this axis.
    at: f64,
}

/// Points on planes of symmetry, in the order of rows of a file behind the particles.
#[derive(Clone, Debug, Default)]
pub(crate) struct Rim {
    feet: Vec<Foot>,
}

impl Rim {
    /// Those of the particles of `cloud` that are held.
    pub(crate) fn of<const D: usize>(case: &Case, cloud: &Cloud<D>, held: &Held) -> Self {
        let mut rim = Self::default();
        let (domain, first) = (cloud.tree.bounds(), held.n_fluid());
        let stretch = held.stretch(D);
        let size = |i: usize| stretch * cloud.spacing[i].max(cloud.tree.leaf_at(&cloud.x[i]).size);
        let mut rows: Vec<(Vector<D>, f64)> = held.numbers().map(|i| (cloud.x[i], size(i))).collect();
        let normal = |row: usize| row.checked_sub(first).and_then(|w| cloud.interface.get(w)).map(|w| w.normal);
        for (axis, plane, outwards) in planes(case, &domain) {
            for row in 0..rows.len() {
                let (x, size) = rows[row];
                let along = normal(rim.particle(row, held.len())).is_some_and(|n| n[axis].abs() > ALONG);
                if along || (x[axis] - plane).abs() > NEAREST * size {
                    continue;
                }
                let foot = Foot { of: row, axis, at: plane + outwards * SHADE * size };
                rows.push((Vector::from_fn(|d| if d == axis { foot.at } else { x[d] }), size));
                rim.feet.push(foot);
            }
        }
        rim
    }

    /// The particle, a row below `n`, that a row of the file goes back to.
    pub(crate) fn particle(&self, mut row: usize, n: usize) -> usize {
        while let Some(foot) = row.checked_sub(n).and_then(|k| self.feet.get(k)) {
            row = foot.of;
        }
        row
    }

    /// Places, and numbers of the dimension in use, with those on the planes.
    pub(crate) fn with_places<const D: usize>(&self, mut places: Vec<[f64; D]>) -> Vec<[f64; D]> {
        for foot in &self.feet {
            let mut x = places[foot.of];
            x[foot.axis] = foot.at;
            places.push(x);
        }
        places
    }

    /// A column with the values on the planes.
    pub(crate) fn with_values<'a>(&self, name: &str, components: usize, values: Cow<'a, [f64]>) -> Cow<'a, [f64]> {
        if self.feet.is_empty() {
            return values;
        }
        let mut all = values.into_owned();
        for foot in &self.feet {
            for c in 0..components {
                let value = all[foot.of * components + c];
                all.push(match name {
                    "kind" => KIND,
                    _ if turns_round(name, components, c, foot.axis) => 0.0,
                    _ => value,
                });
            }
        }
        all.into()
    }

    /// A field with the values on the planes.
    pub(crate) fn with_field<'a>(&self, field: Cow<'a, Snapshot>) -> Cow<'a, Snapshot> {
        if self.feet.is_empty() {
            return field;
        }
        let all = field.into_owned();
        let column = |(name, n, values): (&'static str, usize, Vec<f64>)| {
            (name, n, self.with_values(name, n, values.into()).into_owned())
        };
        Cow::Owned(Snapshot {
            points: self.with_places(all.points),
            columns: all.columns.into_iter().map(column).collect(),
        })
    }
}

/// Planes of symmetry of a case: axis, place, and the sign of the direction out of the domain.
pub(crate) fn planes<const D: usize>(
    case: &Case,
    domain: &crate::math::Bounds<D>,
) -> impl Iterator<Item = (usize, f64, f64)> + use<D> {
    let symmetric = case.boundary.pairs().map(|pair| pair.map(|side| side == Side::Symmetry));
    let (low, high) = (domain.min, domain.max);
    (0..D).flat_map(move |d| {
        let ends = [(low[d], -1.0), (high[d], 1.0)].into_iter().zip(symmetric[d]);
        ends.filter(|(_, is)| *is).map(move |((at, outwards), _)| (d, at, outwards))
    })
}

/// True for a component that a reflection across `axis` turns round: of a vector that along the axis, of the curl of one the others.
fn turns_round(name: &str, components: usize, c: usize, axis: usize) -> bool {
    let of_one = ["_x", "_y", "_z"].iter().position(|end| name.contains(&format!("{end}_")));
    match (components, of_one) {
        (3, _) => (c == axis) != name.starts_with("vorticity"),
        (1, Some(d)) => d == axis,
        _ => false,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::case::read;
    use crate::cloud::CloudSpec;
    use crate::geometry::load_surface;
    use crate::math::rotation::cross;
    use crate::math::triangulation::triangulate;
    use crate::study::look::Mesh;
    use std::path::Path;

    /// Cells of a cloud around half a body of the radius 1 beside the plane y = 0: their corners, and the cells.
    fn half<const D: usize>(body: &str, extent: [&str; 2]) -> (Vec<[f64; 3]>, Mesh) {
        let text = format!(
            "[flow]\nmach = 0.3\n[[body]]\n{body} = {{ radius = 1 }}\n[cloud]\nspacing = 0.25\n\
             domain = {{ min = {}, max = {} }}\n[boundary]\ny_min = \"symmetry\"\n",
            extent[0], extent[1]
        );
        let case = read(&text, "t").unwrap_or_else(|e| panic!("{e}"));
        let surface = load_surface::<D>(&case.bodies, Path::new("")).unwrap().0;
        let cloud = Cloud::build(&CloudSpec::of_case(&case), Some(&surface), &[]).unwrap();
        let held = Held::of(&case, &cloud);
        let rim = Rim::of(&case, &cloud, &held);
        let points = rim.with_places(held.numbers().map(|i| cloud.x[i].to_3d()).collect());
        assert!(points.len() > held.len() + 10);
        (points, Mesh::of(&cloud, &held, &rim))
    }

    /// Area of the convex hull of points, seen along the third axis.
    fn hull(x: &[[f64; 3]], axes: [usize; 2]) -> f64 {
        let points: Vec<Vector<2>> = x.iter().map(|x| Vector(axes.map(|d| x[d]))).collect();
        let area = |t: &[u32; 3]| {
            let [p, q] = [1, 2].map(|k| points[t[k] as usize] - points[t[0] as usize]);
            0.5 * (p[0] * q[1] - p[1] * q[0])
        };
        triangulate(&points, &[]).iter().map(area).sum()
    }

    #[test]
    fn half_models_reach_their_plane_of_symmetry_around_the_body() {
        let (x, mesh) = half::<2>("circle", ["[-3, 0]", "[3, 3]"]);
        let area = |[a, b, c]: &[u32; 3]| {
            let [a, b, c] = [a, b, c].map(|i| x[*i as usize]);
            0.5 * ((b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]))
        };
        let whole: f64 = mesh.triangles.iter().map(area).sum();
        // the hull of the points without the body, whose outline chords are a little inside
        let expected = hull(&x, [0, 1]) - 0.5 * std::f64::consts::PI;
        assert!((whole / expected - 1.0).abs() < 2e-3, "{whole} {expected}");
        assert!(mesh.triangles.iter().all(|t| area(t) > 0.0));
        let least = x.iter().map(|x| x[1]).fold(f64::INFINITY, f64::min);
        assert!(-1e-6 < least && least < 0.0, "{least}");
        let (x, mesh) = half::<3>("sphere", ["[-2, 0, -2]", "[2, 2, 2]"]);
        let volume = |t: &[u32; 4]| {
            let [a, b, c, d] = t.map(|i| Vector(x[i as usize]));
            Vector(cross(&(b - a).0, &(c - a).0)).dot(&(d - a)) / 6.0
        };
        let beside = |t: &&[u32; 4]| t.iter().filter(|i| x[**i as usize][1] < 0.0).count() == 3;
        let foot = |t: &[u32; 4]| {
            let flat: Vec<[f64; 3]> = t.iter().map(|i| x[*i as usize]).filter(|x| x[1] < 0.0).collect();
            let [p, q] = [1, 2].map(|k| [flat[k][0] - flat[0][0], flat[k][2] - flat[0][2]]);
            0.5 * (p[0] * q[1] - p[1] * q[0]).abs()
        };
        assert!(mesh.tetrahedra.iter().all(|t| volume(t) > 0.0));
        let cut: f64 = mesh.tetrahedra.iter().filter(beside).map(foot).sum();
        let feet: Vec<[f64; 3]> = x.iter().filter(|x| x[1] < 0.0).copied().collect();
        let expected = hull(&feet, [0, 2]) - std::f64::consts::PI;
        assert!((cut / expected - 1.0).abs() < 0.02, "{cut} {expected}");
    }

    #[test]
    fn what_a_reflection_turns_round_is_zero_on_the_plane() {
        let rim = Rim { feet: vec![Foot { of: 1, axis: 1, at: -1e-7 }, Foot { of: 2, axis: 2, at: 0.5 }] };
        let points = rim.with_places(vec![[9.0, 9.0, 9.0], [1.0, 0.1, 3.0]]);
        assert_eq!(points[2..], [[1.0, -1e-7, 3.0], [1.0, -1e-7, 0.5]]);
        let column = |name: &str, n: usize, values: &[f64]| rim.with_values(name, n, values.into()).into_owned();
        assert_eq!(column("velocity", 3, &[9.0, 9.0, 9.0, 1.0, 2.0, 3.0])[6..], [1.0, 0.0, 3.0, 1.0, 0.0, 0.0]);
        assert_eq!(column("vorticity", 3, &[9.0, 9.0, 9.0, 1.0, 2.0, 3.0])[6..], [0.0, 2.0, 0.0, 0.0, 0.0, 0.0]);
        assert_eq!(column("pressure", 1, &[9.0, 7.0])[2..], [7.0, 7.0]);
        assert_eq!(column("kind", 1, &[0.0, 1.0])[2..], [3.0, 3.0]);
        assert_eq!(column("velocity_y_1_re", 1, &[9.0, 7.0])[2..], [0.0, 0.0]);
        assert_eq!(column("velocity_z_mean", 1, &[9.0, 7.0])[2..], [7.0, 0.0]);
        assert_eq!(rim.particle(3, 2), 1);
    }
}
