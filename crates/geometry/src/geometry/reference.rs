//! Reference values of the bodies of a case: chord, area and the point of moments.
//!
//! They belong to a body as it is drawn: turning it, moving it or scaling it takes the point along and leaves chord and area what they are. A section
//! has its chord line; a wing has the planform that is typed, whatever section, tip or twist it has. Other bodies are measured as they are
//! seen from above, with angles below 45° taken out of their placement: larger ones bring files of other axes into those of the case. What
//! stands upright, as a wing does that is drawn with its span along z, is measured as it is seen from the side.
//! Of several bodies the largest wing that lies counts; without wings all that is seen from above, but no fin.
use std::sync::{Arc, Mutex};

use super::placement::{placed, shift, turned};
use super::planform::{Planform, QUARTER, planform_of};
use super::{Surface, loft};
use crate::case::{Body, Placement, Shape, Wing};
use crate::math::{Bounds, Vector};

/// Area seen from one side over that seen from above from which on a body is a fin.
const UPRIGHT: f64 = 2.0;

/// Reference values of body number `body`, or of all: of what lies `within` a box.
pub fn reference<const D: usize>(
    bodies: &[Body],
    surface: &Surface<D>,
    within: &Bounds<D>,
    body: Option<usize>,
) -> Planform {
    surface.measured.find(format!("{bodies:?} {within:?} {body:?}"), || measure(bodies, surface, within, body))
}

fn measure<const D: usize>(bodies: &[Body], surface: &Surface<D>, within: &Bounds<D>, body: Option<usize>) -> Planform {
    let main = body.or_else(|| main_body(bodies, surface, within));
    match main.and_then(|k| Some((k, bodies.get(k)?))) {
        Some((k, body)) => of_body(body, k, surface, within),
        None => {
            let seen = planform_across(&seen(surface), within);
            let lengths = bodies.iter().enumerate().map(|(k, body)| of_body(body, k, surface, within).chord);
            let round = !bodies.is_empty() && bodies.iter().all(is_round);
            Planform { chord: if round { lengths.fold(0.0, f64::max) } else { seen.chord }, ..seen }
        }
    }
}

/// Reference values that were found of a surface, by what they are of: a case asks for the same ones several times.
#[derive(Clone, Debug, Default)]
pub(super) struct Measured(Arc<Mutex<Vec<(String, Planform)>>>);

impl Measured {
    fn find(&self, key: String, measure: impl FnOnce() -> Planform) -> Planform {
        let known = self.0.lock().ok().and_then(|all| all.iter().find(|(of, _)| *of == key).map(|(_, seen)| *seen));
        // not while the list is locked: measuring is parallel work
        known.unwrap_or_else(|| {
            let seen = measure();
            self.0.lock().into_iter().for_each(|mut all| all.push((key.clone(), seen)));
            seen
        })
    }
}

/// True for spheres, ellipsoids, bodies of revolution and lofts. Their reference chord is their length, of a sphere its diameter, which Reynolds
/// numbers are told with, not the mean chord of their shadow.
fn is_round(body: &Body) -> bool {
    matches!(body.shape, Shape::Sphere { .. } | Shape::Ellipsoid { .. } | Shape::Revolution { .. } | Shape::Loft { .. })
}

/// The only body, or the largest wing that lies, or the largest of fins alone; `None` where all count.
fn main_body<const D: usize>(bodies: &[Body], surface: &Surface<D>, within: &Bounds<D>) -> Option<usize> {
    if bodies.len() == 1 {
        return Some(0);
    }
    let typed: Vec<(usize, bool)> = (0..bodies.len())
        .filter_map(|k| Some((k, placed_span(&bodies[k])?)))
        .map(|(k, span)| (k, span[2].abs() > span[1].abs()))
        .collect();
    let fins = typed.len() == bodies.len() && typed.iter().all(|(_, upright)| *upright);
    let area = |k: &usize| of_body(&bodies[*k], *k, surface, within).area;
    let counted = typed.iter().filter(|(_, upright)| fins || !upright).map(|(k, _)| *k);
    // the first of equal ones
    counted.fold(None, |best: Option<usize>, k| if best.is_some_and(|b| area(&b) >= area(&k)) { best } else { Some(k) })
}

fn of_body<const D: usize>(body: &Body, k: usize, surface: &Surface<D>, within: &Bounds<D>) -> Planform {
    if let Some([nose, tail]) = surface.chord_lines.get(k).copied().flatten() {
        let chord = (tail - nose).norm();
        return Planform { chord, area: chord, quarter: (nose + (tail - nose) * QUARTER).to_3d() };
    }
    typed(body, within).unwrap_or_else(|| measured(&surface.corners_of(Some(k)), body, within))
}

/// The planform of a wing as it is typed, where it is placed.
fn typed<const D: usize>(body: &Body, within: &Bounds<D>) -> Option<Planform> {
    let (Shape::Wing(wing), Some(span)) = (&body.shape, placed_span(body)) else { return None };
    let scale = body.placement.scale;
    let axis = if span[2].abs() > span[1].abs() { 2 } else { 1 };
    // sides of the domain in parts of the half span
    let part = |side: f64| (side - shift::<3>(&body.placement)[axis]) / (scale * span[axis]);
    let [a, b] = [within.min, within.max].map(|x| part(x.to_3d()[axis]));
    let own = loft::typed_planform(wing, [a.min(b).max(-1.0), a.max(b).min(1.0)])?;
    let quarter = placed(&Vector(own.quarter), &body.placement).0;
    Some(Planform { chord: scale * own.chord, area: scale * scale * own.area, quarter })
}

/// From root to tip of a wing that is turned as it is placed.
fn placed_span(body: &Body) -> Option<Vector<3>> {
    let wing: &Wing = if let Shape::Wing(wing) = &body.shape { wing } else { return None };
    Some(turned(&loft::span_of(wing)?, &body.placement))
}

/// The planform of triangles of a body, measured before it was turned by less than 45°.
fn measured<const D: usize>(corners: &[[Vector<D>; D]], body: &Body, within: &Bounds<D>) -> Planform {
    let origin: Vector<D> = shift(&body.placement);
    let axes = small_turn::<D>(&body.placement);
    let back = |x: &Vector<D>| Vector::<D>::from_fn(|d| axes[d].dot(&(*x - origin))) + origin;
    let turned = (0..D).any(|d| axes[d] != Vector::axis(d));
    let before: Vec<[Vector<D>; D]> =
        if turned { corners.iter().map(|c| c.map(|x| back(&x))).collect() } else { corners.to_vec() };
    let seen = planform_across(&before, within);
    let chord = if is_round(body) { Bounds::around(before.iter().flatten()).extent()[0] } else { seen.chord };
    if !turned {
        return Planform { chord, ..seen };
    }
    let arm = Vector::<D>::from_fn(|d| seen.quarter[d] - origin[d]);
    let quarter = (0..D).fold(origin, |x, d| x + axes[d] * arm[d]);
    Planform { chord, quarter: quarter.to_3d(), ..seen }
}

/// The planform of triangles as they are seen from above, of those that stand upright from the side.
fn planform_across<const D: usize>(all: &[[Vector<D>; D]], within: &Bounds<D>) -> Planform {
    if !is_upright(all.iter().copied()) {
        return planform_of(all, within);
    }
    let lying = |x: &Vector<D>| Vector::from_fn(|d| x[[0, 2, 1][d]]);
    let turned: Vec<[Vector<D>; D]> = all.iter().map(|corners| corners.map(|x| lying(&x))).collect();
    let seen = planform_of(&turned, &Bounds { min: lying(&within.min), max: lying(&within.max) });
    let [x, y, z] = seen.quarter;
    Planform { quarter: [x, z, y], ..seen }
}

/// True for triangles in space that show much more of themselves to the side than upwards: fins, and wings with their span along z.
fn is_upright<const D: usize>(all: impl Iterator<Item = [Vector<D>; D]>) -> bool {
    let mut areas = [0.0; 2];
    for corners in all.filter(|_| D == 3) {
        let [a, b] = [1, 2].map(|k| (corners[k % D] - corners[0]).to_3d());
        areas[0] += (a[2] * b[0] - a[0] * b[2]).abs();
        areas[1] += (a[0] * b[1] - a[1] * b[0]).abs();
    }
    areas[0] > UPRIGHT * areas[1]
}

/// Where the axes point after the part of a turn that is left when it is undone by the nearest turn of axes into axes.
fn small_turn<const D: usize>(placement: &Placement) -> [Vector<D>; D] {
    /// Difference of directions that rounding leaves.
    const SAME: f64 = 1e-14;
    let turned_axes: [Vector<D>; D] = std::array::from_fn(|d| turned(&Vector::axis(d), placement));
    let mut best = (f64::NEG_INFINITY, turned_axes);
    for order in orders::<D>() {
        for signs in 0..1_u32 << D {
            // own axis d goes to the axis order[d]
            let sign = |d: usize| if signs >> d & 1 == 1 { -1.0 } else { 1.0 };
            let close: f64 = (0..D).map(|d| sign(d) * turned_axes[d][order[d]]).sum();
            if close > best.0 {
                let own = |axis: usize| (0..D).find(|own| order[*own] == axis).unwrap_or(axis);
                best = (close, std::array::from_fn(|axis| turned_axes[own(axis)] * sign(own(axis))));
            }
        }
    }
    let rounded = |d: usize| (best.1[d] - Vector::axis(d)).norm() <= SAME;
    if (0..D).all(rounded) { std::array::from_fn(Vector::axis) } else { best.1 }
}

/// All orders of axes.
fn orders<const D: usize>() -> Vec<[usize; D]> {
    let all = (0..D.pow(D as u32)).map(|n| std::array::from_fn(|d| n / D.pow(d as u32) % D));
    all.filter(|order: &[usize; D]| (0..D).all(|axis| order.contains(&axis))).collect()
}

/// Corners of all that is seen from above, without fins beside other bodies.
fn seen<const D: usize>(surface: &Surface<D>) -> Vec<[Vector<D>; D]> {
    let of = |k: usize| (0..surface.elements.len()).filter(move |e| usize::from(surface.elements[*e].body) == k);
    let fin = |k: usize| is_upright(of(k).map(|e| surface.corners(e as u32)));
    let fins: Vec<bool> = (0..surface.bodies.len()).map(fin).collect();
    let all = fins.iter().all(|fin| *fin);
    let counted = |e: &usize| all || !fins[usize::from(surface.elements[*e].body)];
    (0..surface.elements.len()).filter(counted).map(|e| surface.corners(e as u32)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::case::read;
    use crate::geometry::load_surface;

    fn of<const D: usize>(bodies: &str) -> (Planform, Vec<String>) {
        let case = read(&format!("[flow]\nmach = 0.3\n{bodies}"), "t").unwrap_or_else(|e| panic!("{e}"));
        let folder = tempfile::tempdir().unwrap();
        let flat = "s\n1 0.02\n0.5 0.11\n0.1 0.08\n0 0.02\n0.05 -0.01\n0.5 0.02\n1 0.02\n";
        std::fs::write(folder.path().join("own.dat"), flat).unwrap();
        let turned = "s\n0 1\n0.1 0.5\n0.07 0.1\n0 0\n-0.03 0.1\n-0.05 0.5\n0 1\n";
        std::fs::write(folder.path().join("upright.dat"), turned).unwrap();
        let half = |k: u32| f64::from(k) / 20.0;
        let at = |k: u32, side: f64| {
            // a half ellipse behind a wedge
            let x = half(k);
            let y = 0.06 * if x < 0.7 { x / 0.7 } else { (1.0 - ((x - 0.7) / 0.3).powi(2)).max(0.0).sqrt() };
            format!("{x} {}\n", side * y)
        };
        let backwards = (0..=20).map(|k| at(k, 1.0)).chain((0..20).rev().map(|k| at(k, -1.0)));
        let backwards = "s\n".to_owned() + &backwards.collect::<String>();
        std::fs::write(folder.path().join("backwards.dat"), backwards).unwrap();
        let (surface, notes) = load_surface::<D>(&case.bodies, folder.path()).unwrap_or_else(|e| panic!("{e}"));
        let all = Bounds { min: Vector([f64::NEG_INFINITY; D]), max: Vector([f64::INFINITY; D]) };
        (reference(&case.bodies, &surface, &all, None), notes)
    }

    fn close(found: &Planform, chord: f64, quarter: [f64; 3], tolerance: f64) {
        let off = (0..3).map(|d| (found.quarter[d] - quarter[d]).abs()).fold((found.chord - chord).abs(), f64::max);
        assert!(off <= tolerance, "{found:?}, wanted {chord} {quarter:?}");
    }

    #[test]
    fn sections_have_their_chord_line_however_they_are_placed() {
        for naca in ["0012", "2412", "23012", "64A010"] {
            close(&of::<2>(&format!("[[body]]\nnaca = \"{naca}\"\n")).0, 1.0, [0.25, 0.0, 0.0], 0.0);
        }
        let (sin, cos) = 30f64.to_radians().sin_cos();
        let turned = of::<2>("[[body]]\nnaca = \"4412\"\nrotate = \"30 deg\"\nscale = 2\ntranslate = [1, 2]\n").0;
        close(&turned, 2.0, [1.0 + 0.5 * cos, 2.0 - 0.5 * sin, 0.0], 1e-14);
        // of a file of its own the trailing edge and the point farthest from it
        close(&of::<2>("[[body]]\nairfoil = \"own.dat\"\n").0, 1.0, [0.25, 0.02, 0.0], 6e-3);
        let (up, told) = of::<2>("[[body]]\nairfoil = \"upright.dat\"\nrotate = \"90 deg\"\n");
        close(&up, 1.0, [0.25, 0.0, 0.0], 6e-3);
        assert!(!told.iter().any(|t| t.contains("chord line")), "{told:?}");
        let told = |body: &str| of::<2>(&format!("[[body]]\n{body}\n")).1.join(" ");
        assert!(told("airfoil = \"upright.dat\"").contains("runs across the stream, 90 deg"));
        assert!(told("airfoil = \"backwards.dat\"").contains("its trailing edge is upstream"));
        assert!(told("naca = \"2412\"\nrotate = \"180 deg\"").contains("its trailing edge is upstream"));
        // other shapes by their foremost and rearmost points
        close(&of::<2>("[[body]]\ncircle = { radius = 0.5 }\n").0, 1.0, [-0.25, 0.0, 0.0], 1e-6);
        close(
            &of::<2>("[[body]]\nbox = { size = [2, 0.1] }\nrotate = \"10 deg\"\n").0,
            2.0,
            [-0.5 * 10f64.to_radians().cos(), 0.5 * 10f64.to_radians().sin(), 0.0],
            1e-12,
        );
        let wedge = "[[body]]\npolygon = [[0, 0], [0.7, 0.05], [1, 0], [0.7, -0.03]]\n";
        close(&of::<2>(wedge).0, 1.0, [0.25, 0.0, 0.0], 0.0);
    }

    #[test]
    fn wings_have_the_planform_that_is_typed() {
        let wing = "[[body]]\nname = \"wing\"\nwing = { naca = \"2415\", span = 6, chord = 1, taper = 0.5, sweep = \"20 deg\", twist = \"-3 deg\" }\n";
        let alone = of::<3>(wing).0;
        let mean = 2.0 / 3.0 * 1.75 / 1.5;
        let middle = 3.0 / 3.0 * 2.0 / 1.5;
        close(&alone, mean, [middle * 20f64.to_radians().tan() + 0.25 * mean, 0.0, 0.0], 1e-12);
        assert!((alone.area - 4.5).abs() < 1e-12, "{alone:?}");
        let fin = "[[body]]\nname = \"fin\"\nwing = { naca = \"0012\", span = 1.5, chord = 1, sides = \"one\", dihedral = \"90 deg\" }\ntranslate = [4, 0, 0]\n";
        assert_eq!(of::<3>(&format!("{wing}{fin}")).0, alone);
        let pod = "[[body]]\nname = \"pod\"\nellipsoid = { size = [9, 0.5, 0.5] }\n";
        assert_eq!(of::<3>(&format!("{pod}{wing}")).0, alone);
        // it goes along with the wing
        let (sin, cos) = 5f64.to_radians().sin_cos();
        let turned = of::<3>(&format!("{wing}rotate = [0, \"5 deg\", 0]\nscale = 2\ntranslate = [1, 0, 3]\n")).0;
        let x = 2.0 * alone.quarter[0];
        close(&turned, 2.0 * mean, [1.0 + x * cos, 0.0, 3.0 - x * sin], 1e-12);
        assert!((turned.area - 18.0).abs() < 1e-12);
        let raised =
            "[[body]]\nwing = { naca = \"0012\", span = 4, chord = 1, dihedral = \"10 deg\", sides = \"one\" }\n";
        close(&of::<3>(raised).0, 1.0, [0.25, 2.0, 2.0 * 10f64.to_radians().tan()], 1e-12);
        let upright = of::<3>(&fin.replace("translate = [4, 0, 0]\n", "")).0;
        close(&upright, 1.0, [0.25, 0.0, 0.75], 1e-12);
        let ellipse = of::<3>("[[body]]\nwing = { naca = \"0012\", span = 6, chord = 1, planform = \"elliptic\" }\n").0;
        assert!(
            (ellipse.area - 1.5 * std::f64::consts::PI).abs() < 1e-6
                && (ellipse.chord - 8.0 / (3.0 * std::f64::consts::PI)).abs() < 1e-6,
            "{ellipse:?}"
        );
    }

    #[test]
    fn other_bodies_are_measured_before_small_turns() {
        let slab = |more: &str| of::<3>(&format!("[[body]]\nbox = {{ size = [2, 5, 0.2] }}\n{more}")).0;
        let flat = slab("");
        close(&flat, 2.0, [-0.5, 0.0, 0.0], 1e-9);
        let (sin, cos) = 10f64.to_radians().sin_cos();
        let turned = slab("rotate = [0, \"10 deg\", 0]\n");
        close(&turned, 2.0, [-0.5 * cos, 0.0, 0.5 * sin], 1e-9);
        assert!((turned.area - flat.area).abs() < 1e-9);
        // axes of another program are brought into those of the case
        let drawn = of::<3>("[[body]]\nbox = { size = [2, 0.2, 5] }\nrotate = [\"93 deg\", 0, 0]\n").0;
        assert!((drawn.area - 10.0).abs() < 1e-6 && (drawn.chord - 2.0).abs() < 1e-9, "{drawn:?}");
        // what stands upright has the values of what lies, as drawn and as turned
        for upright in ["box = { size = [2, 0.2, 5] }\n", "box = { size = [2, 5, 0.2] }\nrotate = [\"90 deg\", 0, 0]\n"]
        {
            let upright = of::<3>(&format!("[[body]]\n{upright}")).0;
            close(&upright, flat.chord, [-0.5, 0.0, 0.0], 1e-9);
            assert!((upright.area - flat.area).abs() < 1e-9, "{upright:?}");
        }
        let egg = of::<3>("[[body]]\nellipsoid = { size = [3, 1, 1] }\nrotate = [0, \"20 deg\", 0]\n").0;
        assert!((egg.chord - 3.0).abs() < 1e-3, "{egg:?}");
    }
}
