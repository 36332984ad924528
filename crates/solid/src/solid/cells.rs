//! Cells between the particles of solids, for visualisation.
//!
//! Triangles (2-D) and tetrahedra (3-D) connect the particles of each undeformed body: a constrained Delaunay
//! triangulation bounded by the facets of the surface, and a Delaunay tetrahedralisation without the tetrahedra
//! outside. They serve for colour plots, cuts and warping in viewers only; the solver does not use them. They remain
//! the same as the body deforms.
use super::body::{Cells, Solid};
use crate::math::Vector;
use crate::math::tetrahedra::{MOST, tetrahedralise_within};
use crate::math::triangulation::triangulate_within;

impl<const D: usize> Solid<D> {
    /// The cells between the particles; they are computed at the first call.
    pub fn cells(&self) -> &Cells {
        self.cells.get_or_init(|| {
            let mut all = Cells::default();
            let bodies = self.body.iter().max().map_or(0, |b| usize::from(*b) + 1);
            for body in 0..bodies {
                let own: Vec<u32> =
                    (0..self.len() as u32).filter(|i| usize::from(self.body[*i as usize]) == body).collect();
                self.add_cells(&own, &mut all);
            }
            all
        })
    }

    /// The surface as triangles, counterclockwise when viewed from outside; empty in 2-D.
    pub fn skin(&self) -> Vec<[u32; 3]> {
        let of = |corners: &[u32]| match *corners {
            [a, b, c] => vec![[a, b, c]],
            [a, b, c, d] => vec![[a, b, c], [a, c, d]],
            _ => Vec::new(),
        };
        self.particles.facets.iter().flat_map(|facet| of(facet.corners())).collect()
    }

    /// Adds the cells of the body that consists of the particles `own`.
    fn add_cells(&self, own: &[u32], all: &mut Cells) {
        let particles = &self.particles;
        let inwards = |i: u32| {
            let area = particles.area[own[i as usize] as usize];
            (area != Vector::ZERO).then(|| area.unit() * -1.0)
        };
        match D {
            2 => {
                let flat = |x: &Vector<D>| Vector([x[0], x[1]]);
                let points: Vec<Vector<2>> = own.iter().map(|i| flat(&particles.x[*i as usize])).collect();
                let place = |i: &u32| own.binary_search(i).ok().map(|k| k as u32);
                let edge = |corners: &[u32]| match corners {
                    [a, b] => Some([place(a)?, place(b)?]),
                    _ => None,
                };
                let edges: Vec<[u32; 2]> = particles.facets.iter().filter_map(|f| edge(f.corners())).collect();
                let found = triangulate_within(&points, &edges, |i| inwards(i).map(|n| flat(&n)));
                all.triangles.extend(found.into_iter().map(|t| t.map(|i| own[i as usize])));
            }
            3 if own.len() <= MOST => {
                let points: Vec<Vector<3>> = own.iter().map(|i| Vector(particles.x[*i as usize].to_3d())).collect();
                let spacing: Vec<f64> = own.iter().map(|i| particles.spacing[*i as usize]).collect();
                let found = tetrahedralise_within(&points, &spacing, |i| inwards(i).map(|n| Vector(n.to_3d())));
                all.tetrahedra.extend(found.into_iter().map(|t| t.map(|i| own[i as usize])));
            }
            _ => {}
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::body::Parts;
    use super::super::fill::relaxed;
    use super::super::particles::{Fill, Particles};
    use super::super::tests::{lattice, parts, rubber};
    use super::*;
    use crate::geometry::{Surface, icosphere};
    use crate::math::rotation::cross;

    fn solid<const D: usize>(fills: Vec<Fill<D>>) -> Solid<D> {
        let body = fills.iter().zip(0..).flat_map(|(f, k)| std::iter::repeat_n(k, f.x.len())).collect();
        let bar = lattice([1.0; D], [3; D], 0.0);
        let particles = Particles::new(fills).unwrap();
        let material = vec![0; particles.len()];
        Solid::new(Parts { body, material, particles, supports: Vec::new(), ..parts(&bar, rubber(), |_| false) })
    }

    fn area(solid: &Solid<2>) -> f64 {
        let of = |t: &[u32; 3]| {
            let [a, b, c] = t.map(|i| solid.particles.x[i as usize]);
            0.5 * ((b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]))
        };
        assert!(solid.cells().triangles.iter().all(|t| of(t) > 0.0));
        solid.cells().triangles.iter().map(of).sum()
    }

    fn volume(solid: &Solid<3>) -> f64 {
        let of = |t: &[u32; 4]| {
            let [a, b, c, d] = t.map(|i| solid.particles.x[i as usize]);
            Vector(cross(&(b - a).0, &(c - a).0)).dot(&(d - a)) / 6.0
        };
        assert!(solid.cells().tetrahedra.iter().all(|t| of(t) > 0.0));
        solid.cells().tetrahedra.iter().map(of).sum()
    }

    #[test]
    fn plane_bodies_are_covered_and_nothing_joins_them() {
        let mut other = lattice([1.0, 0.5], [9, 5], 0.2).fill();
        other.x.iter_mut().for_each(|x| x[1] += 0.51);
        let two = solid(vec![lattice([1.0, 0.5], [9, 5], 0.0).fill(), other]);
        assert!((area(&two) - 1.0).abs() < 1e-12);
        let apart = |t: &[u32; 3]| t.iter().all(|i| two.body[*i as usize] == two.body[t[0] as usize]);
        assert!(two.cells().triangles.iter().all(apart));
        assert!(two.skin().is_empty() && two.cells().tetrahedra.is_empty());
        // a notch stays open
        let case = "[[body]]\npolygon = [[0, 0], [2, 0], [2, 1], [1, 1], [1, 2], [0, 2]]\n[flow]\nmach = 0.3\n[cloud]\nspacing = 1\n";
        let case = crate::case::read(case, "case").unwrap();
        let (surface, _) = crate::geometry::load_surface::<2>(&case.bodies, std::path::Path::new("")).unwrap();
        assert!((area(&solid(vec![relaxed(&surface, 0.1)])) - 3.0).abs() < 1e-9);
    }

    #[test]
    fn bodies_in_space_are_covered_and_have_a_closed_skin() {
        let bar = solid(vec![lattice([2.0, 1.0, 0.5], [9, 5, 3], 0.0).fill()]);
        assert!((volume(&bar) - 1.0).abs() < 1e-3, "{}", volume(&bar));
        let ball = solid(vec![relaxed(&Surface::new(&[("ball".to_owned(), icosphere(1.0, 3))]), 0.25)]);
        let whole: f64 = ball.particles.volume.iter().sum();
        assert!((volume(&ball) / whole - 1.0).abs() < 0.01, "{} {whole}", volume(&ball));
        for body in [&bar, &ball] {
            let x = &body.particles.x;
            let of = |[a, b, c]: [u32; 3]| {
                let [a, b, c] = [a, b, c].map(|i| x[i as usize]);
                Vector(cross(&(b - a).0, &(c - a).0)) * 0.5
            };
            let skin = body.skin();
            let outwards = skin.iter().all(|t| of(*t).dot(&body.particles.area[t[0] as usize]) > 0.0);
            let left = skin.iter().fold(Vector::ZERO, |sum, t| sum + of(*t)).norm();
            assert!(!skin.is_empty() && outwards && left < 1e-12, "{left}");
        }
    }
}
