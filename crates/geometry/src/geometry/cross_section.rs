//! Cross-sections: intersections of the walls of 3-D bodies with planes normal to the span.
//!
//! A point of a section is identified by its side and by x/c, counted from the foremost to the rearmost point of the
//! section. A face that looks downstream, such as the base of a blunt trailing edge, belongs to neither side.
use super::Surface;
use crate::math::Vector;

/// Component of the normal along x above which a face is a base.
const BASE: f64 = 0.9;

/// A section as line segments, one for each facet that the plane cuts.
#[derive(Clone, Debug, Default)]
pub struct CrossSection {
    pieces: Vec<[Point; 2]>,
    front: f64,
    chord: f64,
}

/// A point of a wall with its outward normal.
#[derive(Clone, Copy, Debug)]
struct Point {
    x: Vector<3>,
    normal: Vector<3>,
}

impl Surface<3> {
    /// The section in the plane y = `at`; `None` where the plane cuts nothing.
    pub fn cross_section(&self, at: f64) -> Option<CrossSection> {
        let pieces: Vec<[Point; 2]> = (0..self.elements.len()).filter_map(|e| self.piece(e as u32, at)).collect();
        let ends = pieces
            .iter()
            .flatten()
            .fold([f64::INFINITY, f64::NEG_INFINITY], |[a, b], p| [a.min(p.x[0]), b.max(p.x[0])]);
        let [front, rear] = ends;
        (front < rear).then_some(CrossSection { pieces, front, chord: rear - front })
    }

    fn piece(&self, element: u32, at: f64) -> Option<[Point; 2]> {
        let (corners, normals) = (self.corners(element), self.elements[element as usize].normals);
        let mut found = (0..3).filter_map(|k| {
            let (a, b) = (k, (k + 1) % 3);
            let part = (at - corners[a][1]) / (corners[b][1] - corners[a][1]);
            let between = |v: &[Vector<3>; 3]| v[a] + (v[b] - v[a]) * part;
            let crosses = (corners[a][1] <= at) != (corners[b][1] <= at);
            crosses.then(|| Point { x: between(&corners), normal: between(&normals).unit() })
        });
        Some([found.next()?, found.next()?])
    }
}

impl CrossSection {
    /// Length from the foremost to the rearmost point.
    pub fn chord(&self) -> f64 {
        self.chord
    }

    /// Point and normal at x/c on the upper or lower side; `None` where this side has no such point.
    pub fn at(&self, x_c: f64, upper: bool) -> Option<(Vector<3>, Vector<3>)> {
        let x = self.front + x_c * self.chord;
        let away = |piece: &&[Point; 2]| {
            let [a, b] = piece.map(|p| p.x[0]);
            (a.min(b) - x).max(x - a.max(b)).max(0.0)
        };
        let own = self.pieces.iter().filter(|[a, b]| {
            let normal = a.normal + b.normal;
            normal[0] < BASE * normal.norm() && (normal[2] > 0.0) == upper
        });
        let [a, b] = own.min_by(|p, q| away(p).total_cmp(&away(q)))?;
        let extent = b.x[0] - a.x[0];
        let part = if extent == 0.0 { 0.5 } else { ((x - a.x[0]) / extent).clamp(0.0, 1.0) };
        Some((a.x + (b.x - a.x) * part, (a.normal + (b.normal - a.normal) * part).unit()))
    }
}

#[cfg(test)]
mod tests {
    use crate::case::read;
    use crate::geometry::load_surface;

    #[test]
    fn points_of_a_swept_wing_are_those_of_its_section() {
        let text = "[flow]\nmach = 0.5\n[[body]]\n\
                    wing = { naca = \"0012\", span = 4, chord = 1, taper = 0.5, sweep = \"30 deg\" }\n\
                    [cloud]\nspacing = 0.1\n";
        let case = read(text, "case.toml").unwrap();
        let surface = load_surface::<3>(&case.bodies, std::path::Path::new(".")).unwrap().0;
        let section = surface.cross_section(1.0).unwrap();
        let chord = 0.75;
        assert!((section.chord() - chord).abs() < 1e-6, "{}", section.chord());
        for (upper, sign) in [(true, 1.0), (false, -1.0)] {
            let (x, normal) = section.at(0.3, upper).unwrap();
            let nose = 30f64.to_radians().tan();
            assert!((x[0] - nose - 0.3 * chord).abs() < 1e-6 && (x[1] - 1.0).abs() < 1e-12, "{x:?}");
            assert!((x[2] - sign * 0.06 * chord).abs() < 1e-4 && sign * normal[2] > 0.99, "{x:?} {normal:?}");
            let (nose, _) = section.at(0.0, upper).unwrap();
            assert!(nose[2].abs() < 0.01 * chord, "{nose:?}");
        }
        assert!(surface.cross_section(3.0).is_none());
    }
}
