//! Walls of a run in space, as the file of its hull tells them: triangles with the state of the gas at their corners.
//!
//! What is more than a page holds is thinned out: the corners in a cell of a grid become one (Rossignac and Borrel 1993).
use std::collections::BTreeMap;

use super::files::RunFolder;
use super::picture::range_without;
use crate::math::Vector;
use crate::observe::vtk_read::FieldFile;

/// Part of the corners on either side whose values may be far out.
const FAR_OUT: f64 = 0.02;
/// Factor by which the cells of the grid grow until few enough triangles are left.
const COARSER: f64 = 1.3;
/// Names of sides and axes of the domain.
const SIDES: [(&str, usize, &str); 6] = [
    ("x_min", 0, "min"),
    ("x_max", 0, "max"),
    ("y_min", 1, "min"),
    ("y_max", 1, "max"),
    ("z_min", 2, "min"),
    ("z_max", 2, "max"),
];

/// A plane of symmetry across an axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Mirror {
    /// 0, 1 or 2.
    pub(super) axis: usize,
    /// Where the plane stands on it.
    pub(super) at: f64,
}

/// Walls with values at their particles.
#[derive(Clone, Debug, Default)]
pub(super) struct Walls {
    pub(super) points: Vec<Vector<3>>,
    /// Into the gas, of length 1.
    pub(super) normals: Vec<Vector<3>>,
    pub(super) triangles: Vec<[u32; 3]>,
    /// Names and values of fields.
    pub(super) fields: Vec<(&'static str, Vec<f64>)>,
    /// Body of each particle, an index into `bodies`.
    pub(super) body: Vec<u8>,
    pub(super) bodies: Vec<String>,
    /// Planes that mirror the flow.
    pub(super) mirrors: Vec<Mirror>,
    /// Temperatures are in kelvin, else in that of the free stream.
    pub(super) kelvin: bool,
}

/// Fields of the walls that are shown where a run has them.
const FIELDS: [&str; 7] = ["cp", "mach", "total_pressure_loss", "entropy", "temperature", "cf", "heat_flux"];

impl Walls {
    /// Those of a run in space; `None` for others.
    pub(super) fn of(run: &RunFolder) -> Option<Self> {
        let case: toml::Table = run.text("case.toml").ok()?.parse().ok()?;
        let file = FieldFile::open(&run.path.join("hull.vtp")).ok()?;
        let vectors = |name: &str| {
            let values = file.values(name)?;
            Some(values.as_chunks::<3>().0.iter().map(|v| Vector(*v)).collect::<Vec<Vector<3>>>())
        };
        let (points, normals) = (vectors("Points")?, vectors("normal")?);
        let n = points.len();
        let own = |name: &'static str| Some((name, file.values(name)?));
        let fields: Vec<(&'static str, Vec<f64>)> = FIELDS.into_iter().filter_map(own).collect();
        let body: Vec<u8> = file.values("body")?.iter().map(|b| *b as u8).collect();
        let triangles = file.triangles()?;
        let whole = normals.len() == n && body.len() == n && fields.iter().all(|(_, values)| values.len() == n);
        let known = triangles.iter().flatten().all(|i| (*i as usize) < n);
        if triangles.is_empty() || fields.is_empty() || !whole || !known {
            return None;
        }
        let (bodies, mirrors, kelvin) = (names(&case), mirrors(&case), file.unit("temperature") == Some("K"));
        let mut walls = Self { points, normals, triangles, fields, body, bodies, mirrors, kelvin };
        walls.drop_unknown();
        (!walls.triangles.is_empty()).then_some(walls)
    }

    /// Lowest and highest corner of a box around them.
    pub(super) fn bounds(&self) -> [[f64; 3]; 2] {
        let start = [[f64::INFINITY; 3], [f64::NEG_INFINITY; 3]];
        self.points
            .iter()
            .fold(start, |[low, high], x| [[0, 1, 2].map(|d| low[d].min(x[d])), [0, 1, 2].map(|d| high[d].max(x[d]))])
    }

    /// The values of the field called `name`.
    pub(super) fn field(&self, name: &str) -> Option<&[f64]> {
        self.fields.iter().find(|(own, _)| *own == name).map(|(_, values)| &values[..])
    }

    /// Ends of the colours of a field: nearly all of it. A wall particle far out reaches the corners around it, so that more values
    /// are cut than in other pictures.
    pub(super) fn range(values: &[f64]) -> [f64; 2] {
        range_without(values, FAR_OUT)
    }

    /// With all mirror images beside them.
    pub(super) fn mirrored(mut self) -> Self {
        for Mirror { axis, at } in std::mem::take(&mut self.mirrors) {
            let n = self.points.len();
            let turned = |v: &Vector<3>, centre: f64| {
                let mut v = *v;
                v[axis] = 2.0 * centre - v[axis];
                v
            };
            let points: Vec<_> = self.points.iter().map(|x| turned(x, at)).collect();
            let normals: Vec<_> = self.normals.iter().map(|x| turned(x, 0.0)).collect();
            let triangles: Vec<_> = self.triangles.iter().map(|[a, b, c]| [*a, *c, *b].map(|i| i + n as u32)).collect();
            self.points.extend(points);
            self.normals.extend(normals);
            self.triangles.extend(triangles);
            self.fields.iter_mut().for_each(|(_, values)| values.extend_from_within(..));
            self.body.extend_from_within(..);
        }
        self
    }

    /// Few enough: at most so many triangles.
    pub(super) fn thinned(self, most: usize) -> Self {
        let [low, high] = self.bounds();
        let longest = (0..3).map(|d| high[d] - low[d]).fold(0.0, f64::max);
        let mut cell = longest / (most as f64).sqrt();
        let mut found = None;
        while self.triangles.len() > most && found.as_ref().is_none_or(|w: &Self| w.triangles.len() > most) {
            found = Some(self.clustered(low, cell));
            cell *= COARSER;
        }
        found.unwrap_or(self)
    }

    /// The particles of each cell of a grid, of one body and one side of it, as one.
    fn clustered(&self, low: [f64; 3], cell: f64) -> Self {
        let mut cells: BTreeMap<([i64; 3], u8, u8), u32> = BTreeMap::new();
        let mut kept: Vec<usize> = Vec::new();
        let number: Vec<u32> = (0..self.points.len())
            .map(|i| {
                let at = [0, 1, 2].map(|d| ((self.points[i][d] - low[d]) / cell) as i64);
                let side = (0..3).map(|d| u8::from(self.normals[i][d] > 0.0) << d).sum();
                *cells.entry((at, side, self.body[i])).or_insert_with(|| {
                    kept.push(i);
                    kept.len() as u32 - 1
                })
            })
            .collect();
        let mut triangles: Vec<[u32; 3]> = self.triangles.iter().map(|t| t.map(|i| number[i as usize])).collect();
        triangles.retain(|[a, b, c]| a != b && b != c && c != a);
        let chosen = |values: &Vec<f64>| kept.iter().map(|i| values[*i]).collect();
        Self {
            kelvin: self.kelvin,
            points: kept.iter().map(|i| self.points[*i]).collect(),
            normals: kept.iter().map(|i| self.normals[*i]).collect(),
            triangles,
            fields: self.fields.iter().map(|(name, values)| (*name, chosen(values))).collect(),
            body: kept.iter().map(|i| self.body[*i]).collect(),
            bodies: self.bodies.clone(),
            mirrors: self.mirrors.clone(),
        }
    }

    /// Leaves out triangles at whose corners something is not a number.
    fn drop_unknown(&mut self) {
        let known = |i: usize| {
            self.points[i].is_finite()
                && self.normals[i].is_finite()
                && self.fields.iter().all(|(_, values)| values[i].is_finite())
        };
        let known: Vec<bool> = (0..self.points.len()).map(known).collect();
        self.triangles.retain(|t| t.iter().all(|i| known[*i as usize]));
        let zero = Vector::ZERO;
        for i in (0..known.len()).filter(|i| !known[*i]) {
            (self.points[i], self.normals[i]) = (if self.points[i].is_finite() { self.points[i] } else { zero }, zero);
            self.fields.iter_mut().for_each(|(_, values)| values[i] = 0.0);
        }
    }
}

/// Names of the bodies of a case, in their order.
fn names(case: &toml::Table) -> Vec<String> {
    let bodies = case.get("body").and_then(toml::Value::as_array).map_or(&[][..], Vec::as_slice);
    let name = |(k, body): (usize, &toml::Value)| {
        let given = body.get("name").and_then(toml::Value::as_str);
        given.map_or_else(|| format!("body {}", k + 1), str::to_owned)
    };
    bodies.iter().enumerate().map(name).collect()
}

/// Planes of symmetry of a case.
fn mirrors(case: &toml::Table) -> Vec<Mirror> {
    let plane = |(side, axis, end): &(&str, usize, &str)| {
        let symmetric = case.get("boundary")?.get(side)?.as_str()? == "symmetry";
        // without a box around the domain the plane passes through the origin
        let corner = || case.get("cloud")?.get("domain")?.get(end)?.as_array()?.get(*axis);
        let number = |v: &toml::Value| v.as_float().or_else(|| v.as_integer().map(|v| v as f64));
        let at = corner().and_then(number).unwrap_or(0.0);
        symmetric.then_some(Mirror { axis: *axis, at })
    };
    SIDES.iter().filter_map(plane).collect()
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;
    use crate::observe::vtk::{About, Column, Facets, write_surface};
    use std::path::Path;

    /// Half a swept wing of 2 n² triangles as a run leaves it, with a plane of symmetry at y = 0.
    pub(in crate::report) fn fill_wing(run: &Path, n: usize) {
        let (mut points, mut normals, mut cp) = (Vec::new(), Vec::new(), Vec::new());
        for l in 0..=n {
            for k in 0..=n {
                let (span, around) = (l as f64 / n as f64, std::f64::consts::TAU * k as f64 / n as f64);
                points.push([0.5 * span + 0.5 - 0.5 * around.cos(), 1.5 * span, 0.06 * around.sin()]);
                normals.extend([0.0, 0.0, if around < std::f64::consts::PI { 1.0 } else { -1.0 }]);
                cp.push(around.cos() - span);
            }
        }
        let at = |k: usize, l: usize| (l * (n + 1) + k) as u32;
        let cell = |i: usize| (i % n, i / n);
        let triangles: Vec<[u32; 3]> = (0..n * n)
            .map(cell)
            .flat_map(|(k, l)| [[at(k, l), at(k + 1, l), at(k + 1, l + 1)], [at(k, l), at(k + 1, l + 1), at(k, l + 1)]])
            .collect();
        let body = vec![0.0; points.len()];
        let column = |name, components, values| Column { name, components, values };
        let columns = [
            column("normal", 3, &normals[..]),
            column("body", 1, &body[..]),
            column("cp", 1, &cp[..]),
            column("mach", 1, &cp[..]),
        ];
        write_surface(&run.join("hull.vtp"), &About::default(), &points, Facets::Triangles(&triangles), &columns)
            .unwrap();
        let case = "dimension = 3\n[flow]\nmach = 0.8\nalpha = \"3 deg\"\n[[body]]\nname = \"wing\"\n[boundary]\ny_min = \"symmetry\"\n\
                    [[compare]]\nfile = \"cp.csv\"\nlabel = \"measured\"\n";
        std::fs::write(run.join("case.toml"), case).unwrap();
        std::fs::write(run.join("cp.csv"), "eta,x_c,Cp\n0.5,0.1,-0.4\n0.5,0.5,-0.2\n0.9,0.5,-0.1\n").unwrap();
        std::fs::create_dir_all(run.join("pictures")).unwrap();
    }

    #[test]
    fn walls_are_read_mirrored_and_thinned() {
        let folder = tempfile::tempdir().unwrap();
        fill_wing(folder.path(), 40);
        let walls = Walls::of(&RunFolder::new(folder.path())).unwrap();
        assert_eq!((walls.triangles.len(), walls.bodies.clone()), (3200, vec!["wing".to_owned()]));
        assert_eq!(walls.mirrors, [Mirror { axis: 1, at: 0.0 }]);
        let both = walls.clone().mirrored();
        assert_eq!((both.bounds()[0][1], both.bounds()[1][1], both.triangles.len()), (-1.5, 1.5, 6400));
        let few = walls.clone().thinned(500);
        assert!(few.triangles.len() <= 500 && few.triangles.len() > 100, "{}", few.triangles.len());
        assert_eq!(few.field("cp").unwrap().len(), few.points.len());
        assert_eq!(walls.clone().thinned(4000).triangles.len(), 3200);
    }
}
