//! The wall of a finished run: what `surface.csv` holds of it, and its pressure between particles.
//!
//! Between particles Cp is the constant term of a quadratic fit Cp(a, b) = c0 + c1 a + c2 b + c3 a² + c4 ab + c5 b² in
//! coordinates (a, b) of the tangent plane, to the nearest particles of the same side: third order in the spacing, so that
//! two clouds on one body can be compared to a small part of the differences between neighbours.
use super::curve::{Table, TableError};
use crate::math::Vector;
use crate::math::least_squares::Fit;

/// Nearest particles of a fit: two to three times its coefficients, 3 in 2-D and 6 in 3-D.
const NEIGHBOURS: [usize; 2] = [6, 16];
/// Cosine between normals below which two particles lie on different sides of an edge.
const SAME_SIDE: f64 = 0.5;

/// Columns of the wall particles of a run.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Wall {
    /// Positions.
    pub x: Vec<Vector<3>>,
    /// Normals, out of the body.
    pub normal: Vec<Vector<3>>,
    /// Areas.
    pub area: Vec<f64>,
    /// Distance from the nose over chord.
    pub x_c: Vec<f64>,
    /// Pressure coefficients.
    pub cp: Vec<f64>,
    /// Friction coefficients; empty without viscosity.
    pub cf: Vec<f64>,
}

impl Wall {
    /// Reads a `surface.csv`.
    pub fn parse(text: &str) -> Result<Self, TableError> {
        let table = Table::parse(text)?;
        let vectors = |names: [&str; 3]| -> Result<Vec<Vector<3>>, TableError> {
            let [a, b, c] = [table.column(names[0])?, table.column(names[1])?, table.column(names[2])?];
            Ok((0..a.len()).map(|i| Vector([a[i], b[i], c[i]])).collect())
        };
        Ok(Self {
            x: vectors(["x", "y", "z"])?,
            normal: vectors(["nx", "ny", "nz"])?,
            area: table.column("area")?,
            x_c: table.column("x_c")?,
            cp: table.column("cp")?,
            cf: table.column("cf").unwrap_or_default(),
        })
    }

    /// Number of particles.
    pub fn len(&self) -> usize {
        self.x.len()
    }

    /// True without a wall.
    pub fn is_empty(&self) -> bool {
        self.x.is_empty()
    }

    /// Particles inside the box with these corners of two or three coordinates; all without a box.
    pub fn within(&self, region: Option<&[Vec<f64>; 2]>) -> Vec<usize> {
        (0..self.len()).filter(|&i| region.is_none_or(|[low, high]| contains(low, high, &self.x[i].0))).collect()
    }

    /// Those of `chosen` whose normal points up, or down.
    pub fn side(&self, chosen: &[usize], upper: bool) -> Vec<usize> {
        chosen.iter().copied().filter(|&i| (self.normal[i][1] > 0.0) == upper).collect()
    }

    /// Pressure coefficient at `x` on a wall with this normal; `None` where too few particles are near.
    pub fn pressure_coefficient(&self, x: &Vector<3>, normal: &Vector<3>) -> Option<f64> {
        let flat = self.normal.iter().all(|n| n[2] == 0.0);
        let mut near: Vec<(f64, usize)> = (0..self.len())
            .filter(|&i| self.normal[i].dot(normal) > SAME_SIDE)
            .map(|i| ((self.x[i] - *x).norm_squared(), i))
            .collect();
        let count = NEIGHBOURS[usize::from(!flat)];
        if near.len() < count {
            return None;
        }
        near.select_nth_unstable_by(count - 1, |a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        near.truncate(count);
        near.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        let [first, second] = tangents(normal, flat);
        let size = near[count - 1].0.sqrt();
        let mut fit = Fit::default();
        fit.reset(if flat { 3 } else { 6 });
        for &(d2, i) in &near {
            let offset = (self.x[i] - *x) * (1.0 / size);
            let (a, b) = (offset.dot(&first), offset.dot(&second));
            let weight = (-2.0 * d2 / (size * size)).exp();
            if flat {
                fit.push(&[1.0, a, a * a], weight);
            } else {
                fit.push(&[1.0, a, b, a * a, a * b, b * b], weight);
            }
        }
        let mut row = Vec::new();
        fit.row_of_inverse(0, &mut row);
        Some(row.iter().zip(&near).map(|(r, (_, i))| r * self.cp[*i]).sum())
    }
}

/// True when `x` lies in the box; coordinates that the corners leave out are free.
pub fn contains(low: &[f64], high: &[f64], x: &[f64; 3]) -> bool {
    low.iter().zip(high).zip(x).all(|((low, high), x)| low <= x && x <= high)
}

/// Two unit vectors across `normal`, the first in the x-y plane when that is all there is.
fn tangents(normal: &Vector<3>, flat: bool) -> [Vector<3>; 2] {
    if flat {
        return [Vector([normal[1], -normal[0], 0.0]), Vector::axis(2)];
    }
    let across = (0..3).fold(0, |least, d| if normal[d].abs() < normal[least].abs() { d } else { least });
    let axis = Vector::axis(across);
    let first = (axis - *normal * normal[across]).unit();
    let cross = |a: &Vector<3>, b: &Vector<3>| {
        Vector([a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]])
    };
    [first, cross(normal, &first)]
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sphere(n: usize, phase: f64) -> Wall {
        let mut wall = Wall::default();
        let golden = std::f64::consts::PI * (3.0 - 5f64.sqrt());
        for i in 0..n {
            let z = 1.0 - (2.0 * i as f64 + 1.0) / n as f64;
            let (r, angle) = ((1.0 - z * z).sqrt(), golden * i as f64 + phase);
            let normal = Vector([r * angle.cos(), r * angle.sin(), z]);
            wall.x.push(normal * 0.5);
            wall.normal.push(normal);
            wall.cp.push(1.0 - 2.25 * (1.0 - normal[0] * normal[0]));
        }
        wall
    }

    #[test]
    fn two_clouds_on_a_sphere_agree() {
        let (coarse, other) = (sphere(2000, 0.0), sphere(2000, 0.3));
        for i in 0..other.len() {
            let cp = coarse.pressure_coefficient(&other.x[i], &other.normal[i]).unwrap();
            assert!((cp - other.cp[i]).abs() < 1e-3, "{cp} {}", other.cp[i]);
        }
        assert_eq!(sphere(10, 0.0).pressure_coefficient(&other.x[0], &other.normal[0]), None);
    }

    #[test]
    fn columns_boxes_and_sides() {
        let text = "x,y,z,nx,ny,nz,area,x_c,cp,tag\n0,1,0,0,1,0,0.5,0.25,-1,a\n2,-1,0,0,-1,0,0.5,0.75,1,b\n";
        let wall = Wall::parse(text).unwrap();
        assert_eq!((wall.len(), wall.is_empty(), wall.x_c[1], wall.cp[0]), (2, false, 0.75, -1.0));
        assert_eq!(wall.within(Some(&[vec![1.0, -2.0], vec![3.0, 2.0]])), vec![1]);
        assert_eq!(wall.side(&wall.within(None), true), vec![0]);
        assert!(Wall::parse("x,y\n1,2\n").is_err());
    }
}
