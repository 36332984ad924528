//! Wings and bodies of revolution against the formulas of the books.
use super::super::{Surface, load_surface, naca, outline, primitive};
use super::*;
use crate::case::read;
use crate::math::Bounds;

fn body(shape: &str) -> Surface<3> {
    let text = format!("[flow]\nmach = 0.3\n[[body]]\n{shape}\n");
    let case = read(&text, "t").unwrap_or_else(|e| panic!("{e}"));
    load_surface::<3>(&case.bodies, std::path::Path::new(".")).unwrap_or_else(|e| panic!("{e}")).0
}

fn everywhere() -> Bounds<3> {
    Bounds { min: Vector([-1e3; 3]), max: Vector([1e3; 3]) }
}

fn closed(surface: &Surface<3>) {
    let all = 0..surface.elements.len() as u32;
    let sum = all.map(|e| surface.element_area_vector(e)).fold(Vector::ZERO, |a, b| a + b);
    assert!(surface.is_closed() && sum.norm() < 1e-12 * surface.area() && surface.volume() > 0.0, "{sum:?}");
    assert!(surface.intersection().is_none());
}

#[test]
fn wings_are_closed_whatever_their_ends() {
    for naca in ["0012", "4412", "64A010"] {
        for end in ["closed", "blunt"] {
            for tip in ["round", "flat", "revolved"] {
                for sides in ["both", "one"] {
                    let section = format!("{{ digits = \"{naca}\", trailing_edge = \"{end}\" }}");
                    let more = "span = 3, chord = 1, taper = 0.5, sweep = \"30 deg\", twist = \"-3 deg\", dihedral = \"5 deg\"";
                    closed(&body(&format!(
                        "wing = {{ naca = {section}, {more}, tip = \"{tip}\", sides = \"{sides}\" }}"
                    )));
                }
            }
        }
    }
    let fin = "wing = { naca = \"0008\", span = 2, chord = 1, dihedral = \"90 deg\", sides = \"one\" }";
    let surface = body(fin);
    closed(&surface);
    let bounds = surface.bounds();
    assert!(bounds.min[2].abs() < 1e-12 && (bounds.max[2] - 2.0).abs() < 1e-12 && bounds.max[1] < 0.041, "{bounds:?}");
}

#[test]
fn planforms_are_those_that_were_asked_for() {
    let tapered = body(
        "wing = { naca = \"0010\", span = 6, aspect_ratio = 4.8, taper = 0.3, sweep = \"37 deg\", tip = \"flat\" }",
    );
    // S = b²/A; mean chord of the books, 2/3 (c² + c t + t²)/(c + t)
    let seen = tapered.planform(&everywhere(), None);
    let root = 2.0 * 7.5 / (6.0 * 1.3);
    let mean = 2.0 / 3.0 * root * (1.0 + 0.3 + 0.09) / 1.3;
    assert!((seen.area / 7.5 - 1.0).abs() < 1e-5 && (seen.chord / mean - 1.0).abs() < 1e-5, "{seen:?}");
    let half = tapered.planform(&Bounds { min: Vector([-1e3, 0.0, -1e3]), ..everywhere() }, None);
    assert!((half.area / 3.75 - 1.0).abs() < 1e-5 && (half.chord / mean - 1.0).abs() < 1e-5, "{half:?}");
    let tip = tapered.bounds().max[0] - 0.3 * root;
    assert!((tip - 3.0 * 37f64.to_radians().tan()).abs() < 1e-9, "{tip}");
    let ellipse = body("wing = { naca = \"0012\", span = 6, chord = 1, planform = \"elliptic\", sweep_at = 0.25 }");
    closed(&ellipse);
    let seen = ellipse.planform(&everywhere(), None);
    assert!((seen.area / (0.25 * PI * 6.0) - 1.0).abs() < 2e-3, "{seen:?}");
    // its quarter line is straight
    assert!((seen.quarter[0] - 0.25).abs() < 2e-3, "{seen:?}");
}

#[test] // seen from above a wing is what was typed, whatever its tips
fn round_tips_lie_inside_the_planform() {
    for (more, span) in [("", 8.0), (", dihedral = \"6 deg\"", 8.0), (", naca = \"2424\", twist = \"-4 deg\"", 4.0)] {
        let naca = if more.contains("naca") { "" } else { "naca = \"0012\", " };
        let typed = format!("{naca}span = {span}, chord = 1.5, taper = 0.5, sweep = \"25 deg\"{}", more);
        let wing = body(&format!("wing = {{ {typed} }}"));
        let seen = wing.planform(&everywhere(), None);
        let bounds = wing.bounds();
        assert!((bounds.max[1] - 0.5 * span).abs() < 1e-12 && (bounds.min[1] + 0.5 * span).abs() < 1e-12, "{bounds:?}");
        assert!((seen.area / (1.125 * span) - 1.0).abs() < 2e-3, "{more}: {seen:?}");
        closed(&wing);
        let half = body(&format!("wing = {{ {typed}, sides = \"one\" }}"));
        assert!((half.bounds().max[1] - span).abs() < 1e-12, "{:?}", half.bounds());
    }
    let beyond = body("wing = { naca = \"0012\", span = 8, chord = 1, tip = \"revolved\" }").bounds().max[1];
    assert!((beyond - 4.06).abs() < 1e-4, "{beyond}");
    // thicker than long, and to a point
    closed(&body("wing = { naca = \"0030\", span = 0.2, chord = 1 }"));
    let ellipse = body("wing = { naca = \"0012\", span = 6, chord = 1, planform = \"elliptic\", sweep_at = 0.25 }");
    assert!((ellipse.bounds().max[1] - 3.0).abs() < 1e-12 && ellipse.planform(&everywhere(), None).area > 4.70);
    closed(&body("wing = { naca = \"0012\", span = 6, chord = 1, planform = \"elliptic\", tip = \"flat\" }"));
}

#[test]
fn bodies_do_not_swell_beyond_their_points() {
    let widest = |shape: &str| {
        let bounds = body(shape).bounds();
        [bounds.max[1], bounds.max[2], -bounds.min[1], -bounds.min[2]]
    };
    let same = |shape: &str, radius: f64| {
        let found = widest(shape);
        assert!(found.iter().all(|r| *r < radius + 1e-9 && *r > 0.9999 * radius), "{shape}: {found:?}");
    };
    same("revolution = [[0, 0], [1, 0.5], [9, 0.5], [10, 0]]", 0.5);
    same("revolution = [[0, 0], [0.5, 0.4], [1, 0.5], [4, 0.5]]", 0.5);
    same("loft = { stations = [[0, 0, 0], [2, 1, 1], [8, 1, 1], [10, 0, 0]] }", 0.5);
    same("loft = { stations = [[0, 0, 0], [2, 1, 1], [8, 1, 0.3], [10, 0.2, 0.2]] }", 0.5);
    let inlet = "loft = { stations = [[0, 0, 0], [0.5, 0.5, 0.7], [1.2, 0.8, 0.9], [4, 0.8, 0.9, -0.05], [7, 0.3, 0.4, -0.1]], exponent = 5 }";
    let [right, top, left, bottom] = widest(inlet);
    assert!(
        (right - 0.4).abs() < 1e-4 && (left - 0.4).abs() < 1e-4 && top < 0.4501 && bottom < 0.5001,
        "{top} {bottom}"
    );
    // what is alike in both is the same body
    let round = body("revolution = [[0, 0], [0.5, 0.4], [1, 0.5], [4, 0.3]]");
    let oval = body("loft = [[0, 0, 0], [0.5, 0.8, 0.8], [1, 1, 1], [4, 0.6, 0.6]]");
    assert!((round.volume() / oval.volume() - 1.0).abs() < 1e-12 && (round.area() / oval.area() - 1.0).abs() < 1e-12);
}

#[test]
fn volumes_are_those_of_the_books() {
    // a section of four digits has the area 0.6822 t c², closed; its tip as a body of revolution π/2 ∫ z² dx = 0.00385 π/2 at 12 %
    let wing = body("wing = { naca = \"0012\", span = 8, chord = 1, tip = \"flat\" }");
    assert!((wing.volume() / (8.0 * 0.6822 * 0.12) - 1.0).abs() < 5e-3, "{}", wing.volume());
    let round = body("wing = { naca = \"0012\", span = 8, chord = 1 }");
    // round tips lie inside: of 2 z a depth of z each, half a circle is left
    let lost = wing.volume() - round.volume();
    let area = |k: usize| {
        let x = (k as f64 + 0.5) / 1e4;
        let z = 0.6 * (0.2969 * x.sqrt() + x * (-0.126 + x * (-0.3516 + x * (0.2843 - 0.1036 * x))));
        PI * z * z / 1e4
    };
    let whole: f64 = (0..10_000).map(area).sum();
    // of a polygon
    let part = (PI / CAP as f64).sin() * CAP as f64 / PI;
    let cut = 2.0 * (2.0 / PI - 0.5 * part) * whole;
    assert!((lost / cut - 1.0).abs() < 0.02, "{lost} {cut}");
    let cone = body("revolution = [[0, 0], [1, 0.2]]");
    closed(&cone);
    assert!((cone.volume() / (PI * 0.04 / 3.0) - 1.0).abs() < 2e-3, "{}", cone.volume());
    // a corner stays one: cone and cylinder
    let bullet = body("revolution = { profile = [[0, 0], [1, 0.2], [3, 0.2]], sides = \"straight\" }");
    closed(&bullet);
    assert!((bullet.volume() / (PI * 0.04 * (2.0 + 1.0 / 3.0)) - 1.0).abs() < 2e-3, "{}", bullet.volume());
    let can = body("revolution = [[0, 0.2], [1, 0.2]]");
    closed(&can);
    assert!((can.volume() / (PI * 0.04) - 1.0).abs() < 2e-3, "{}", can.volume());
    let ball: Vec<String> = ball_profile().iter().map(|[x, r]| format!("[{x}, {r}]")).collect();
    let ball = body(&format!("revolution = [{}]", ball.join(", ")));
    closed(&ball);
    assert!((ball.volume() / (PI / 6.0) - 1.0).abs() < 2e-3 && ball.sharp.is_empty(), "{}", ball.volume());
    // a cone of elliptic sections about a line that rises; a box with round corners, 4 Γ(1 + 1/n)² / Γ(1 + 2/n) times the half axes
    let oval = body("loft = [[0, 0, 0, 0], [1, 0.6, 0.4, 0.3]]");
    closed(&oval);
    assert!((oval.volume() / (PI * 0.3 * 0.2 / 3.0) - 1.0).abs() < 2e-3, "{}", oval.volume());
    let can = body("loft = { stations = [[0, 2, 1], [1, 2, 1], [3, 2, 1]], exponent = 4, sides = \"straight\" }");
    closed(&can);
    assert!((can.volume() / (3.0 * 4.0 * 0.5 * 0.927_04) - 1.0).abs() < 2e-3, "{}", can.volume());
    let ball: Vec<String> = ball_profile().iter().map(|[x, r]| format!("[{x}, {}, {}]", 2.0 * r, 2.0 * r)).collect();
    let ball = body(&format!("loft = [{}]", ball.join(", ")));
    closed(&ball);
    assert!((ball.volume() / (PI / 6.0) - 1.0).abs() < 2e-3 && ball.sharp.is_empty(), "{}", ball.volume());
    let egg = body("ellipsoid = { size = [3, 1, 2] }");
    closed(&egg);
    assert!((egg.volume() / PI - 1.0).abs() < 1e-3, "{}", egg.volume());
}

/// Points x, r of half a circle of the diameter 1.
fn ball_profile() -> Vec<[f64; 2]> {
    let at = |k: u32| (PI * f64::from(k) / 20.0).sin_cos();
    (0..=20).map(at).map(|(s, c)| [-0.5 * c, if s < 1e-9 { 0.0 } else { 0.5 * s }]).collect()
}

#[test]
fn a_positive_twist_turns_the_nose_of_the_tip_up() {
    let wing =
        body("wing = { naca = \"0012\", span = 4, chord = 1, twist = \"10 deg\", tip = \"flat\", sides = \"one\" }");
    let tip = |x: &&Vector<3>| (x[1] - 4.0).abs() < 1e-9;
    let (sin, cos) = 10f64.to_radians().sin_cos();
    let nose = Vector([0.25 * (1.0 - cos), 4.0, 0.25 * sin]);
    let nearest = wing.vertices.iter().filter(tip).map(|x| (*x - nose).norm()).fold(f64::INFINITY, f64::min);
    assert!(nearest < 1e-6, "{nearest}");
}

#[test]
fn sections_without_corners_and_with_two_are_split_at_their_ends() {
    let places = clustered(8);
    let round = Sides::of(&primitive::ellipse([0.5, 0.1]), &places);
    assert!(round.is_sharp() && (round.upper[0] - Vector([-0.5, 0.0])).norm() < 1e-3);
    let blunt = crate::case::Naca { digits: "0012".into(), trailing_edge: crate::case::TrailingEdge::Blunt };
    let sides = Sides::of(&naca::shell(&blunt).unwrap(), &places);
    assert!(!sides.is_sharp() && sides.upper[8][1] > 0.001 && sides.lower[8][1] < -0.001);
    let cone = outline::profile(&[Vector([0.0, 0.0]), Vector([1.0, 0.2]), Vector([2.0, 0.2])], true);
    assert_eq!(cone.0.len(), 2);
    let pod =
        outline::profile(&[Vector([0.0, 0.0]), Vector([0.5, 0.4]), Vector([1.0, 0.5]), Vector([2.0, 0.5])], false);
    assert!(pod.0.len() == 1 && pod.0[0][1][1] > 10.0 * pod.0[0][1][0], "a round nose stands across the axis");
}

#[test]
fn skins_stay_on_the_flat_sides_of_a_kink_at_the_root() {
    let surface =
        body("wing = { naca = \"0010\", span = 6, chord = 2, taper = 0.5, sweep = \"30 deg\", tip = \"flat\" }");
    for (x, y, z) in [(1.2, 0.01, 0.1), (1.6, 0.02, 0.05), (1.6, -0.02, -0.05)] {
        let nearest = surface.nearest(&Vector([x, y, z]), f64::INFINITY).unwrap();
        let off = (surface.project(&nearest).point - nearest.point).norm();
        let turn = nearest.normal[1] * f64::signum(y);
        assert!(off < 2e-5 && turn < -0.005, "{x} {y} {z}: {off} {nearest:?}");
    }
}

#[test]
fn sections_from_files_of_any_unit_fill_the_planform_that_is_typed() {
    let folder = tempfile::tempdir().unwrap();
    let half = |x: f64| 0.6 * (0.2969 * x.sqrt() + x * (-0.126 + x * (-0.3516 + x * (0.2843 - 0.1036 * x))));
    let place = |k: i32| 0.5 - 0.5 * (PI * f64::from(k) / 30.0).cos();
    let ring = (-30..=30).map(|k: i32| (place(k), half(place(k)).max(0.0) * if k < 0 { 1.0 } else { -1.0 }));
    let ring: Vec<(f64, f64)> = ring.collect();
    let loaded = |at: &dyn Fn(f64, f64) -> (f64, f64), more: &str| {
        let rows: String = ring.iter().map(|(x, y)| at(*x, *y)).map(|(x, y)| format!("{x} {y}\n")).collect();
        std::fs::write(folder.path().join("s.dat"), rows).unwrap();
        let wing = "wing = { airfoil = \"s.dat\", span = 4, chord = 1, tip = \"flat\" }";
        let case = read(&format!("[flow]\nmach = 0.3\n[[body]]\n{wing}\n{more}\n"), "t").unwrap();
        load_surface::<3>(&case.bodies, folder.path()).map_err(|e| e.to_string())
    };
    let clean = loaded(&|x, y| (x, y), "").unwrap().0;
    for at in [|x: f64, y: f64| (300.0 * x, 300.0 * y), |x: f64, y: f64| (1200.0 + 350.0 * x, 40.0 + 350.0 * y)] {
        let (surface, notes) = loaded(&at, "").unwrap();
        let seen = surface.planform(&everywhere(), None);
        assert!((seen.area / 4.0 - 1.0).abs() < 0.01 && (seen.chord - 1.0).abs() < 0.01, "{seen:?}");
        assert!((surface.volume() / clean.volume() - 1.0).abs() < 1e-6, "{}", surface.volume());
        assert!(notes.iter().any(|n| n.contains("its chord is taken as 1")), "{notes:?}");
    }
    for at in [|x: f64, y: f64| (y, x), |x: f64, y: f64| (1.0 - x, y)] {
        let told = loaded(&at, "").unwrap_err();
        assert!(told.contains("s.dat: the ") && told.contains("nose at smaller x than its trailing edge"), "{told}");
    }
    // turned wings are told
    for (angles, told) in [
        ("[0, 0, \"180 deg\"]", Some("upstream, 180 deg")),
        ("[0, \"180 deg\", 0]", Some("upstream, 180 deg")),
        ("[0, 0, \"90 deg\"]", Some("across the stream, 90 deg")),
        ("[\"90 deg\", 0, 0]", None),
        ("[0, \"20 deg\", \"10 deg\"]", None),
    ] {
        let notes = loaded(&|x, y| (x, y), &format!("rotate = {angles}")).unwrap().1;
        let found = notes.iter().find(|n| n.contains("leading edge at smaller x"));
        assert!(found.is_some() == told.is_some() && found.is_none_or(|n| n.contains(told.unwrap_or(""))), "{notes:?}");
    }
}
