//! Queries of surfaces against brute force and exact shapes, and the loading of cases.
use super::*;
use crate::case::{Angle, Body, Length, Naca, Placement, TrailingEdge};
use proptest::test_runner::{RngAlgorithm, TestRng};
use random::Random;

/// A few uniform random numbers from proptest's generator, with a fixed seed.
mod random {
    use super::*;
    use proptest::prelude::Rng;

    pub(super) struct Random(TestRng);

    impl Random {
        pub(super) fn new() -> Self {
            Self(TestRng::deterministic_rng(RngAlgorithm::ChaCha))
        }

        pub(super) fn number(&mut self) -> f64 {
            (self.0.next_u64() >> 11) as f64 / (1_u64 << 53) as f64
        }

        pub(super) fn point<const D: usize>(&mut self, half: f64) -> Vector<D> {
            Vector::from_fn(|_| half * (2.0 * self.number() - 1.0))
        }
    }
}

fn single<const D: usize>(shell: Shell<D>) -> Surface<D> {
    Surface::new(&[("body".to_string(), shell)])
}

/// A lumpy star around the origin: radius 1 + 0.3 cos 5θ.
fn star(n: usize) -> Surface<2> {
    let at = |i: usize| {
        let angle = 2.0 * PI * i as f64 / n as f64;
        Vector([angle.cos(), angle.sin()]) * (1.0 + 0.3 * (5.0 * angle).cos())
    };
    let points: Vec<Vector<2>> = (0..n).map(at).collect();
    single(outline::polygon("star", &points, POLYGON_CREASE, &mut Vec::new()).unwrap())
}

/// A sphere with a wavy radius, as a plain mesh.
fn potato(subdivisions: u32) -> Surface<3> {
    let mut shell = icosphere(1.0, subdivisions);
    (shell.normals, shell.exact) = (None, Exact::None);
    shell.vertices.iter_mut().for_each(|v| *v = *v * (1.0 + 0.2 * (5.0 * v[0]).sin() * (4.0 * v[1]).cos()));
    single(shell)
}

fn queries_agree_with_brute_force<const D: usize>(surface: &Surface<D>) {
    let mut random = Random::new();
    let all: Vec<_> = (0..surface.elements.len() as u32).map(|e| surface.corners(e)).collect();
    for _ in 0..200 {
        let (x, y) = (random.point::<D>(1.5), random.point::<D>(1.5));
        let distance = |c| (simplex::blend(c, &simplex::closest(&x, c)) - x).norm();
        let least = all.iter().map(distance).fold(f64::INFINITY, f64::min);
        let near = surface.nearest(&x, f64::INFINITY).unwrap();
        assert!((near.distance - least).abs() < 1e-14 && ((near.point - x).norm() - least).abs() < 1e-14);
        assert!(surface.nearest(&x, 0.999 * least).is_none() && surface.nearest(&x, 1.001 * least).is_some());
        let exact: f64 = all.iter().map(|c| simplex::winding(&x, c)).sum();
        assert!((surface.winding(&x) - exact).abs() < 0.1, "{} {exact}", surface.winding(&x));
        assert_eq!(surface.inside(&x), exact > 0.5);
        assert_eq!(surface.crosses(&x, &y), all.iter().any(|c| simplex::crosses(&x, &y, c)));
        let half = x + (y - x) * 0.02;
        assert_eq!(surface.crosses(&x, &half), all.iter().any(|c| simplex::crosses(&x, &half, c)));
        // Different sides imply a crossing; a watertight test never misses it.
        assert!(surface.inside(&x) == surface.inside(&y) || surface.crosses(&x, &y));
    }
}

#[test]
fn queries_in_the_plane_agree_with_brute_force() {
    queries_agree_with_brute_force(&star(400));
}

#[test]
fn queries_in_space_agree_with_brute_force() {
    queries_agree_with_brute_force(&potato(3));
}

#[test]
fn queries_around_slivers_agree_with_brute_force() {
    queries_agree_with_brute_force(&single(double_cone(200)));
}

/// Two cones base to base, of triangles from their tips to the rim between them.
fn double_cone(n: usize) -> Shell<3> {
    let rim = (0..n).map(|k| 2.0 * PI * k as f64 / n as f64).map(|t| Vector([0.0, 0.5 * t.cos(), 0.5 * t.sin()]));
    let vertices = [Vector([-0.8, 0.0, 0.0]), Vector([0.8, 0.0, 0.0])].into_iter().chain(rim).collect();
    let at = |k: usize| (2 + k % n) as u32;
    let elements = (0..n).flat_map(|k| [[0, at(k + 1), at(k)], [1, at(k), at(k + 1)]]).collect();
    Shell { vertices, elements, normals: None, curvature: None, ..primitive::cuboid([1.0; 3]) }
}

#[test]
fn points_hugging_the_wall_fall_on_the_right_side() {
    let surface = potato(4);
    let mut random = Random::new();
    for e in (0..surface.elements.len() as u32).step_by(7) {
        let (a, b) = (random.number(), random.number());
        let w = if a + b < 1.0 { [a, b, 1.0 - a - b] } else { [1.0 - a, 1.0 - b, a + b - 1.0] };
        let (x, _) = surface.element_point(e, &w);
        let n = surface.element_area_vector(e).unit();
        let (out, within) = (x + n * 1e-7, x - n * 1e-7);
        assert!(!surface.inside(&out) && surface.inside(&within) && surface.crosses(&out, &within));
        assert!(!surface.crosses(&x, &(x + n * 1e-3)), "end points on the wall do not count");
    }
}

#[test]
fn circle_and_sphere_are_exact() {
    let circle = single(primitive::circle(0.5));
    assert!((circle.area() / PI - 1.0).abs() < 1e-6 && (circle.volume() / (0.25 * PI) - 1.0).abs() < 1e-6);
    assert!(circle.sharp.is_empty() && circle.radius.iter().all(|r| (r / 0.5 - 1.0).abs() < 1e-6));
    let sphere = single(primitive::sphere(0.5));
    assert!((sphere.area() / PI - 1.0).abs() < 2e-4 && (sphere.volume() * 6.0 / PI - 1.0).abs() < 2e-4);
    assert!(sphere.sharp.is_empty() && sphere.radius.iter().all(|r| (r / 0.5 - 1.0).abs() < 1e-3));
    let near = sphere.nearest(&Vector([0.3, 0.4, 0.5]), 1.0).unwrap();
    let exact = sphere.project(&near);
    assert!((exact.point.norm() - 0.5).abs() < 1e-15 && (exact.normal - exact.point * 2.0).norm() < 1e-15);
    assert!(exact.curvature == 2.0 && (near.point - exact.point).norm() < 3e-5);
}

#[test]
fn an_ellipse_has_its_area_its_ends_and_its_normals() {
    let ellipse = single(primitive::ellipse([0.5, 0.06]));
    assert!((ellipse.volume() / (PI * 0.5 * 0.06) - 1.0).abs() < 1e-6 && ellipse.sharp.is_empty());
    let ends = |d: usize| ellipse.vertices.iter().map(|x| x[d]).fold(0.0, f64::max);
    assert!(ends(0) == 0.5 && (ends(1) - 0.06).abs() < 1e-12);
    let least = ellipse.radius.iter().fold(f64::INFINITY, |a, r| a.min(*r));
    assert!((least / (0.06 * 0.06 / 0.5) - 1.0).abs() < 1e-3, "b²/a at the ends, found {least}");
    let near = ellipse.nearest(&Vector([0.4, 0.2]), 1.0).unwrap();
    let exact = ellipse.project(&near);
    let gradient = Vector([exact.point[0] / 0.25, exact.point[1] / 0.0036]).unit();
    assert!((exact.normal - gradient).norm() < 1e-6, "{:?} {gradient:?}", exact.normal);
}

#[test]
fn curved_patches_recover_a_sphere_from_its_normals() {
    let error = |subdivisions: u32| {
        let mut shell = icosphere(1.0, subdivisions);
        shell.exact = Exact::None;
        let surface = single(shell);
        let middle = |e: u32| {
            let weights = [1.0 / 3.0; 3];
            let (point, normal) = surface.element_point(e, &weights);
            let x = surface.project(&Nearest { point, normal, distance: 0.0, element: e, weights });
            (x.point.norm() - 1.0).abs().max((x.normal - x.point.unit()).norm())
        };
        (0..surface.elements.len() as u32).map(middle).fold(0.0, f64::max)
    };
    assert!(error(3) < 2e-4 && error(4) < 0.4 * error(3), "{} {}", error(3), error(4));
}

#[test]
fn a_meshed_sphere_knows_its_curvature() {
    let mut shell = icosphere(2.0, 4);
    (shell.normals, shell.exact) = (None, Exact::None);
    // Rounding to single precision, as an STL file does.
    shell.vertices.iter_mut().for_each(|v| *v = Vector(v.0.map(|c| f64::from(c as f32))));
    let surface = single(shell);
    for e in 0..surface.elements.len() {
        assert!((surface.curvature[e] * 2.0 - 1.0).abs() < 0.08, "{}", surface.curvature[e]);
        let n = &surface.elements[e].normals[0];
        let miss = (*n - surface.corners(e as u32)[0].unit()).norm();
        assert!(miss < 2e-6, "{miss}");
    }
}

#[test]
fn boxes_have_twelve_edges_and_flat_sides() {
    let surface = single(primitive::cuboid([1.0, 2.0, 3.0]));
    assert!((surface.area() - 22.0).abs() < 1e-14 && (surface.volume() - 6.0).abs() < 1e-14);
    assert!(surface.sharp.len() == 12 && surface.sharp.iter().all(|e| (e.turn - 0.5 * PI).abs() < 1e-12));
    assert!(surface.radius.iter().all(|r| r.is_infinite()));
    for e in 0..12 {
        let n = surface.element_area_vector(e).unit();
        assert!(surface.elements[e as usize].normals.iter().all(|m| (*m - n).norm() < 1e-14));
    }
    assert_eq!(surface.nearest(&Vector([0.0, 0.0, 9.0]), 100.0).unwrap().normal, Vector([0.0, 0.0, 1.0]));
}

#[test]
fn concave_corners_turn_negative() {
    let l = [[0.0, 0.0], [2.0, 0.0], [2.0, 1.0], [1.0, 1.0], [1.0, 2.0], [0.0, 2.0]].map(Vector);
    let surface = single(outline::polygon("l", &l, POLYGON_CREASE, &mut Vec::new()).unwrap());
    let concave: Vec<_> = surface.sharp.iter().filter(|e| e.turn < 0.0).collect();
    assert!(surface.sharp.len() == 6 && concave.len() == 1 && concave[0].ends == [Vector([1.0, 1.0]); 2]);
}

#[test]
fn polygons_are_mended_or_refused() {
    let mut notes = Vec::new();
    let clockwise = [[0.0, 0.0], [0.0, 1.0], [0.0, 1.0], [1.0, 1.0], [1.0, 0.0], [0.0, 0.0]].map(Vector);
    let surface = single(outline::polygon("square", &clockwise, POLYGON_CREASE, &mut notes).unwrap());
    assert!(surface.volume() == 1.0 && surface.sharp.len() == 4 && notes.len() == 2, "{notes:?}");
    let bow = [[0.0, 0.0], [1.0, 1.0], [1.5, 0.0], [0.0, 1.0]].map(Vector);
    let error = outline::polygon("bow", &bow, POLYGON_CREASE, &mut notes).unwrap_err().to_string();
    assert!(error.contains("crosses itself at (0.6") && error.contains("line 1"), "{error}");
    for few in [&bow[..0], &bow[..2], &[Vector([f64::NAN, 0.0]); 4][..]] {
        assert!(outline::polygon("few", few, POLYGON_CREASE, &mut notes).is_err());
    }
}

fn body(shape: Shape, rotate: Vec<f64>, translate: Vec<f64>) -> Body {
    let translate = translate.into_iter().map(Length).collect();
    let placement = Placement { scale: 1.0, rotate: rotate.into_iter().map(Angle).collect(), translate };
    Body { name: None, shape, placement, weld: None, wall: None, motion: None, solid: None }
}

fn case(bodies: Vec<Body>) -> Case {
    let text = r#"{"title":"t","flow":{"mach":0.5,"gas_constant":287.05,"gamma":1.4},"cloud":{"spacing":0.1,"layers":4,
        "edge_levels":0,"curvature":0.1,"curvature_levels":0,"blank":0.5,"radius":2,"jitter":0}}"#;
    Case { bodies, ..serde_json::from_str(text).unwrap() }
}

fn naca() -> Shape {
    Shape::Naca(Naca { digits: "0012".into(), trailing_edge: TrailingEdge::Closed })
}

#[test]
fn bodies_are_placed_and_overlaps_refused() {
    let folder = Path::new("");
    let circle = |x: f64| body(Shape::Circle { radius: Length(0.5) }, vec![], vec![x, 0.0]);
    let two = vec![circle(0.0), circle(1.5)];
    let (surface, _) = load_surface::<2>(&two, folder).unwrap();
    assert!(dimension(&case(two)) == 2 && surface.bodies == ["body-1", "body-2"] && surface.tags.len() == 2);
    assert!(surface.inside(&Vector([1.9, 0.0])) && !surface.inside(&Vector([0.75, 0.0])));
    let exact = surface.project(&surface.nearest(&Vector([2.5, 0.0]), 1.0).unwrap());
    assert!((exact.point - Vector([2.0, 0.0])).norm() < 1e-12);
    let close = load_surface::<2>(&[circle(0.0), circle(0.9)], folder).unwrap_err().to_string();
    assert!(close.contains("body `body-1`: overlaps or touches body `body-2`"), "{close}");
    let three =
        load_surface::<2>(&[circle(0.0), circle(0.9), circle(5.0), circle(5.2)], folder).unwrap_err().to_string();
    assert!(three.contains("touches body `body-2` at") && three.contains("; body `body-3` overlaps"), "{three}");
    let small = body(Shape::Circle { radius: Length(0.1) }, vec![], vec![]);
    assert!(load_surface::<2>(&[circle(0.0), small], folder).is_err());
    let pitched = [body(naca(), vec![0.1], vec![])];
    let (surface, _) = load_surface::<2>(&pitched, folder).unwrap();
    let tail = surface.sharp[0].ends[0];
    assert!((tail - Vector([0.1_f64.cos(), -0.1_f64.sin()])).norm() < 1e-12, "{tail:?}");
}

#[test]
fn wrong_bodies_are_refused_by_name() {
    let folder = Path::new("");
    let sphere = || Shape::Sphere { radius: Length(1.0) };
    assert_eq!(dimension(&case(vec![body(sphere(), vec![], vec![])])), 3);
    let message = |b: Body| load_surface::<2>(&[b], folder).unwrap_err().to_string();
    assert!(message(body(sphere(), vec![], vec![])).contains("not 2-dimensional"));
    assert!(message(body(Shape::Circle { radius: Length(-1.0) }, vec![], vec![])).contains("`radius` is -1"));
    assert!(message(body(naca(), vec![], vec![1.0])).contains("`translate`"));
    assert!(message(body(naca(), vec![1.0, 2.0], vec![])).contains("nose up"));
    assert!(message(body(Shape::Airfoil("none.dat".into()), vec![], vec![])).contains("cannot read `none.dat`"));
    let (empty, _) = load_surface::<2>(&[], folder).unwrap();
    let x = Vector([0.0, 0.0]);
    assert!(!empty.inside(&x) && empty.nearest(&x, 1.0).is_none() && !empty.crosses(&x, &Vector([1.0, 0.0])));
}
