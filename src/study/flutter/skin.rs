//! The surface of the bodies, and how far each coordinate takes its points: what draws a motion.
//!
//! A point goes from X to X + Re(d e^{iωt}) with d = Σ q̂_k ∂x/∂q_k, the tangents of its place where the bodies are as placed; for motions of any
//! size that is a picture of small ones, drawn large. Where the gas was solved, files for ParaView show wall particles in its place, with the
//! unsteady pressure that belongs to the displacement drawn (`wall_motion`).
use std::collections::BTreeMap;

use num_complex::Complex64;

use super::shapes::{amplitudes, moves};
use crate::math::Vector;
use crate::math::rotation::cross;
use crate::problem::reference::chord;
use crate::problem::{Problem, ProblemIn};
use crate::record::flutter::{FlutterRow, Share, WallMotion};

/// Largest displacement that is drawn, over the chord.
const SHOWN: f64 = 0.1;
/// Factor by which the cells in which corners become one grow until few enough triangles are left.
const COARSER: f64 = 1.3;

/// The surface at rest, and its displacement per unit of each coordinate.
#[derive(Clone, Debug, Default)]
pub(crate) struct Skin {
    pub(crate) chord: f64,
    pub(crate) points: Vec<[f64; 3]>,
    pub(crate) lines: Vec<[u32; 2]>,
    pub(crate) triangles: Vec<[u32; 3]>,
    pub(crate) coordinates: Vec<String>,
    pub(crate) moves: Vec<Vec<[f64; 3]>>,
}

/// Points in a motion: where they are at rest, and complex displacements and pressure coefficients, of which the latter may be absent.
pub(crate) struct Moving<'a> {
    pub(crate) points: &'a [[f64; 3]],
    pub(crate) shifts: Vec<[Complex64; 3]>,
    pub(crate) cp: Vec<Complex64>,
}

impl Skin {
    /// That of the bodies of a problem; coordinates are counted in `units`.
    pub(crate) fn of(problem: &Problem, units: &[f64]) -> Self {
        match problem {
            Problem::Plane(problem) => Self::within(problem, units),
            Problem::Space(problem) => Self::within(problem, units),
        }
    }

    fn within<const D: usize>(problem: &ProblemIn<D>, units: &[f64]) -> Self {
        let Some(surface) = problem.surface() else { return Self::default() };
        let mut skin = Self { chord: chord(problem.case(), Some(surface)), ..Self::default() };
        skin.points = surface.vertices.iter().map(Vector::to_3d).collect();
        for element in &surface.elements {
            match element.vertices[..] {
                [a, b] => skin.lines.push([a, b]),
                [a, b, c] => skin.triangles.push([a, b, c]),
                _ => {}
            }
        }
        for body in problem.structures() {
            skin.coordinates.extend(body.structure.coordinates().iter().map(|c| c.name.clone()));
            skin.moves.extend(moves(surface, body, units));
        }
        skin
    }

    /// Displacements in a motion, so large that the largest over a period is that shown.
    fn displaced(&self, shape: &[Share]) -> Vec<[Complex64; 3]> {
        let mut all = vec![[Complex64::new(0.0, 0.0); 3]; self.points.len()];
        for (q, own) in amplitudes(shape).iter().zip(&self.moves) {
            for (d, unit) in all.iter_mut().zip(own) {
                (0..3).for_each(|k| d[k] += q * unit[k]);
            }
        }
        let scale = self.drawn(&all);
        all.iter_mut().flatten().for_each(|d| *d *= scale);
        all
    }

    /// The motion of a crossing: of the walls with the pressure on them where that is known, else of the surface alone.
    pub(crate) fn moving<'a>(&'a self, crossing: &'a FlutterRow) -> Moving<'a> {
        match &crossing.walls {
            Some(walls) => self.walls(walls),
            None => Moving { points: &self.points, shifts: self.displaced(&crossing.shape), cp: Vec::new() },
        }
    }

    /// Walls in a motion, displaced as far as surfaces are, with the pressure that goes with so much.
    fn walls<'a>(&self, walls: &'a WallMotion) -> Moving<'a> {
        let complex = |[re, im]: [f64; 2]| Complex64::new(re, im);
        let mut shifts: Vec<[Complex64; 3]> = walls.displacement.iter().map(|d| d.map(complex)).collect();
        let scale = self.drawn(&shifts);
        shifts.iter_mut().flatten().for_each(|d| *d *= scale);
        Moving { points: &walls.points, shifts, cp: walls.cp.iter().map(|cp| scale * complex(*cp)).collect() }
    }

    /// The factor that makes displacements as large as they are drawn.
    fn drawn(&self, shifts: &[[Complex64; 3]]) -> f64 {
        let largest = shifts.iter().map(greatest).fold(0.0, f64::max);
        if largest > 0.0 { SHOWN * self.chord / largest } else { 0.0 }
    }

    /// With at most so many triangles: corners in a cell of a grid that look the same way become one.
    pub(crate) fn thinned(&self, most: usize) -> Self {
        let [low, high] =
            [f64::min, f64::max].map(|f| [0, 1, 2].map(|d| self.points.iter().map(|x| x[d]).reduce(f).unwrap_or(0.0)));
        let longest = (0..3).map(|d| high[d] - low[d]).fold(0.0, f64::max);
        let mut cell = longest / (most as f64).sqrt();
        let mut found = self.clone();
        while found.triangles.len() > most {
            found = self.clustered(low, cell);
            cell *= COARSER;
        }
        found
    }

    fn clustered(&self, low: [f64; 3], cell: f64) -> Self {
        let mut normals = vec![Vector::<3>::ZERO; self.points.len()];
        for t in &self.triangles {
            let [a, b, c] = t.map(|i| Vector(self.points[i as usize]));
            let area = Vector(cross(&(b - a).0, &(c - a).0));
            t.iter().for_each(|i| normals[*i as usize] += area);
        }
        let mut cells: BTreeMap<([i64; 3], u8), u32> = BTreeMap::new();
        let mut kept: Vec<usize> = Vec::new();
        let number: Vec<u32> = (0..self.points.len())
            .map(|i| {
                let at = [0, 1, 2].map(|d| ((self.points[i][d] - low[d]) / cell) as i64);
                let side = (0..3).map(|d| u8::from(normals[i][d] > 0.0) << d).sum();
                *cells.entry((at, side)).or_insert_with(|| {
                    kept.push(i);
                    kept.len() as u32 - 1
                })
            })
            .collect();
        let mut triangles: Vec<[u32; 3]> = self.triangles.iter().map(|t| t.map(|i| number[i as usize])).collect();
        triangles.retain(|[a, b, c]| a != b && b != c && c != a);
        let chosen = |all: &Vec<[f64; 3]>| kept.iter().map(|i| all[*i]).collect();
        Self {
            points: chosen(&self.points),
            triangles,
            moves: self.moves.iter().map(chosen).collect(),
            lines: Vec::new(),
            coordinates: self.coordinates.clone(),
            chord: self.chord,
        }
    }
}

/// The greatest length of Re(d e^{iφ}) over all phases φ.
fn greatest(d: &[Complex64; 3]) -> f64 {
    let sum = |f: fn(&Complex64) -> f64| d.iter().map(f).sum::<f64>();
    let (a, b, ab) = (sum(|z| z.re * z.re), sum(|z| z.im * z.im), sum(|z| z.re * z.im));
    (0.5 * (a + b) + (0.5 * (a - b)).hypot(ab)).sqrt()
}

#[cfg(test)]
mod tests {
    use super::super::problem_of;
    use super::*;

    const MOST: usize = 5000;
    const CASE: &str = "[flow]\nmach = 0.5\n[[body]]\nnaca = \"0012\"\n[cloud]\nspacing = 0.1\n[flutter]\n[structure]\nelastic_axis = -0.4\n\
                        mass_ratio = 60\nx_alpha = 0.2\nr_alpha2 = 0.25\nfrequency_ratio = 0.5\nreduced_speed = 2\n";

    fn share(coordinate: &str, amplitude: f64, phase_deg: f64) -> Share {
        Share { coordinate: coordinate.into(), amplitude, phase_deg }
    }

    #[test]
    fn a_section_turns_about_its_axis_and_goes_up() {
        let problem = problem_of(CASE);
        let skin = Skin::of(&problem, &[0.5, 1.0]);
        assert_eq!(skin.coordinates, ["plunge", "pitch"]);
        for (x, [up, turn]) in skin.points.iter().zip(skin.moves[0].iter().zip(&skin.moves[1]).map(|(a, b)| [a, b])) {
            assert_eq!(*up, [0.0, 0.5, 0.0]);
            // nose up: what lies aft of the axis at 0.3 goes down
            assert!((turn[1] + (x[0] - 0.3)).abs() < 1e-9 && (turn[0] - x[1]).abs() < 1e-9, "{x:?} {turn:?}");
        }
        let shape = [share("plunge", 1.0, 0.0), share("pitch", 0.4, 90.0)];
        let largest = skin.displaced(&shape).iter().map(greatest).fold(0.0, f64::max);
        assert!((largest - 0.1).abs() < 1e-12, "{largest}");
    }

    #[test]
    fn many_triangles_become_few_without_holes_between_sides() {
        let n = 120_u32;
        let place = |k: u32| f64::from(k) / f64::from(n - 1);
        let mut skin = Skin { chord: 1.0, ..Skin::default() };
        for (z, over) in [(0.01, true), (-0.01, false)] {
            let first = skin.points.len() as u32;
            skin.points.extend((0..n * n).map(|k| [place(k % n), place(k / n), z]));
            for (i, j) in (0..n - 1).flat_map(|i| (0..n - 1).map(move |j| (i, j))) {
                let [a, b, c, d] = [i + n * j, i + 1 + n * j, i + 1 + n * (j + 1), i + n * (j + 1)].map(|k| first + k);
                let both = [[a, b, c], [a, c, d]];
                skin.triangles.extend(both.map(|[a, b, c]| if over { [a, b, c] } else { [a, c, b] }));
            }
        }
        skin.moves = vec![skin.points.clone()];
        let found = skin.thinned(MOST);
        assert!(found.triangles.len() <= MOST && found.triangles.len() > MOST / 4, "{}", found.triangles.len());
        let mixed = found.triangles.iter().filter(|t| t.iter().any(|i| found.points[*i as usize][2] > 0.0));
        assert!(mixed.clone().all(|t| t.iter().all(|i| found.points[*i as usize][2] > 0.0)));
        assert_eq!(found.points, found.moves[0]);
    }
}
