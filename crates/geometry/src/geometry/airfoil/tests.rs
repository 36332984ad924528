//! Airfoil files as programs and people write them, against clean ones, formulas and published sections.
use super::super::surface::Surface;
use super::*;
use proptest::prelude::*;
use std::f64::consts::PI;

const RAE_2822: &str = include_str!("../testdata/rae2822_agard_ar138.csv");
const NACA_64A010: &str = include_str!("../testdata/naca64a010_bmp_design.csv");
const NACA_64A010_LOOP: &str = include_str!("../testdata/naca64a010_isogai_su2.csv");
const NACA_0012: &str = include_str!("../testdata/naca0012_formula_variants.csv");

fn load(text: &str) -> Result<(Surface<2>, Vec<String>), GeometryError> {
    let mut notes = Vec::new();
    let shell = read("wing.dat", text.as_bytes(), 1.0, &mut notes)?;
    Ok((Surface::new(&[("wing".into(), shell)]), notes))
}

fn error(text: &str) -> String {
    load(text).unwrap_err().to_string()
}

#[test]
fn commas_and_encodings_of_other_programs_are_read_or_told() {
    let rows = "1 0\n0.5 0.05\n0 0\n0.5 -0.05\n1 0\n";
    let told = error(&rows.replace('.', ","));
    assert!(told.contains("line 2") && told.contains("`0,5` has a decimal comma"), "{told}");
    assert_eq!(load(&rows.replace('\n', "\r")).is_ok(), load(rows).is_ok());
    assert!(load(&rows.replace(' ', ",")).is_ok() == load(rows).is_ok());
    let wide: Vec<u8> = [0xff, 0xfe].into_iter().chain(rows.bytes().flat_map(|b| [b, 0])).collect();
    assert_eq!(read("wing.dat", &wide[..], 1.0, &mut Vec::new()).is_ok(), load(rows).is_ok());
    let broken = [&wide[..], &[0x00, 0xd8]].concat();
    let told = read("wing.dat", &broken[..], 1.0, &mut Vec::new()).map(|_| ()).unwrap_err().to_string();
    assert!(told.contains("broken UTF-16"), "{told}");
}

/// Greatest distance of the file's points from the surface.
fn miss(surface: &Surface<2>, text: &str) -> f64 {
    let table = table::read("", text, &mut Vec::new()).unwrap();
    let distance = |r: &table::Row| surface.nearest(&r.mark.point, 1.0).unwrap().distance;
    table.rows.iter().map(distance).fold(0.0, f64::max)
}

#[test]
fn published_sections_load() {
    let (rae, notes) = load(RAE_2822).unwrap();
    assert!(rae.sharp.len() == 1 && miss(&rae, RAE_2822) < 1e-12, "{notes:?}");
    // The convex parts bulge beyond the polygon of the published points by less than a thousandth of its area.
    let ring = around("", &table::read("", RAE_2822, &mut Vec::new()).unwrap(), &mut Vec::new()).unwrap();
    let twice = |w: &[Mark]| w[0].point[0] * w[1].point[1] - w[1].point[0] * w[0].point[1];
    let polygon = 0.5 * ring.windows(2).map(twice).sum::<f64>();
    assert!((0.0..1e-3).contains(&(rae.volume() / polygon - 1.0)), "{} {polygon}", rae.volume());
    assert!((rae.bounds().extent()[1] - 0.122).abs() < 1e-4, "height of the box around the section");
    let (design, notes) = load(NACA_64A010).unwrap();
    assert!(notes.iter().any(|n| n.contains("wavy")), "four decimals: {notes:?}");
    assert!(design.sharp.len() == 2 && miss(&design, NACA_64A010) < 1e-12, "{notes:?}");
    assert!(notes.iter().any(|n| n.contains("half thickness")), "{notes:?}");
    assert!((design.bounds().extent()[1] - 0.1).abs() < 1e-4);
    let (ring, notes) = load(NACA_64A010_LOOP).unwrap();
    assert!(ring.sharp.len() == 1 && notes.iter().any(|n| n.contains("Selig")), "{notes:?}");
    // Nose radius of 64A010: 0.687 % chord (Abbott and von Doenhoff 1959, appendix III).
    let nose = ring.nearest(&Vector([-0.1, 0.0]), 1.0).unwrap();
    assert!((ring.radius[nose.element as usize] / 0.00687 - 1.0).abs() < 0.2, "{}", ring.radius[nose.element as usize]);
}

#[test]
fn the_spline_recovers_the_formula() {
    let (surface, notes) = load(NACA_0012).unwrap();
    assert!(notes.iter().any(|n| n.contains("`x_c` and `z_closed`")), "{notes:?}");
    let thickness =
        |x: f64| 0.6 * (0.2969 * x.sqrt() - 0.1260 * x - 0.3516 * x * x + 0.2843 * x.powi(3) - 0.1036 * x.powi(4));
    let mut worst = 0.0_f64;
    for i in 0..4000 {
        let x = (0.5 * std::f64::consts::PI * f64::from(i) / 4000.0).sin().powi(2);
        worst = worst.max(surface.nearest(&Vector([x, thickness(x)]), 1.0).unwrap().distance);
    }
    // 81 points over half the section, eight digits.
    assert!(worst < 2e-6, "{worst}");
    let nose = surface.nearest(&Vector([-0.1, 0.0]), 1.0).unwrap();
    assert!((surface.radius[nose.element as usize] / 0.015867 - 1.0).abs() < 0.02);
}

/// Points of a symmetric section of half thickness 0.1 sin(πx) without its nose rounded: upper side front to rear.
fn lens(i: usize, n: usize) -> (f64, f64) {
    let x = i as f64 / n as f64;
    (x, 0.2 * x * (1.0 - x))
}

fn rows(points: impl Iterator<Item = (f64, f64)>) -> String {
    points.map(|(x, y)| format!("{x} {y}\n")).collect()
}

#[test]
fn every_order_gives_the_same_outline() {
    let (front, rear) = ((0..=40).map(|i| lens(i, 40)), (0..=40).rev().map(|i| lens(i, 40)));
    let flip = |(x, y): (f64, f64)| (x, -y);
    let upper_lower = rows(front.clone()) + "\n" + &rows(front.clone().map(flip));
    let orders = [
        "lens\n".to_string() + &rows(rear.clone().chain(front.clone().skip(1).map(flip))),
        "lens\n".to_string() + &rows(rear.clone().map(flip).chain(front.clone().skip(1))),
        "lens\n 41. 41.\n\n".to_string() + &upper_lower,
        upper_lower.clone(),
        rows(front.clone().chain(rear.map(flip).skip(1))),
        rows(front.clone()),
        "x,y\r\n".to_string() + &rows(front).replace(' ', ",").replace('\n', "\r\n"),
    ];
    let areas: Vec<f64> = orders.iter().map(|text| load(text).unwrap().0.volume()).collect();
    assert!(areas.iter().all(|a| (a - 0.4 / 6.0).abs() < 1e-5), "{areas:?}");
    let (sharp, _) = load(&orders[0]).unwrap();
    assert_eq!(sharp.sharp.len(), 2, "the nose of a lens is sharp");
    let noted = |k: usize, word: &str| load(&orders[k]).unwrap().1.iter().any(|n| n.contains(word));
    assert!(noted(1, "clockwise") && noted(2, "41 and 41") && noted(3, "without counts") && noted(5, "symmetric"));
}

/// A cambered section of six digits with a sharp trailing edge: upper side from the rear to the nose, lower side back.
fn section(n: usize) -> [Vec<(f64, f64)>; 2] {
    let digits = |v: f64| (1e6 * v).round() / 1e6 + 0.0;
    let x = |k: usize| 0.5 + 0.5 * (PI * k as f64 / n as f64).cos();
    let half =
        |x: f64| 0.5 * (0.2969 * x.sqrt() - 0.1260 * x - 0.3516 * x * x + 0.2843 * x.powi(3) - 0.1036 * x.powi(4));
    let line = |x: f64| 0.08 * x * (1.0 - x);
    let side = |sign: f64| (0..=n).map(x).map(|x| (digits(x), digits(line(x) + sign * half(x)))).collect::<Vec<_>>();
    let lower = side(-1.0).into_iter().rev().collect();
    [side(1.0), lower]
}

fn area(text: &str) -> (f64, Vec<String>) {
    let (surface, notes) = load(text).unwrap_or_else(|e| panic!("{e}\n{text}"));
    (surface.volume(), notes)
}

#[test]
fn what_public_files_have_beside_coordinates_changes_no_outline() {
    let [upper, lower] = section(40);
    let ring: Vec<(f64, f64)> = upper.iter().chain(&lower[1..]).copied().collect();
    let clean = rows(ring.iter().copied());
    let (exact, _) = area(&clean);
    let reversed = |side: &[(f64, f64)]| side.iter().rev().copied().collect::<Vec<_>>();
    let turned: Vec<_> = ring[20..80].iter().chain(&ring[..=20]).copied().collect();
    let text = |points: &[(f64, f64)]| rows(points.iter().copied());
    let nose_first = [reversed(&upper), lower.clone()].concat();
    let both_from_rear = text(&upper) + &text(&reversed(&lower));
    let percent: String = ring.iter().map(|(x, y)| format!("{:.6} {:.6}\n", 100.0 * x, 100.0 * y + 7.0)).collect();
    let pairs = |f: &dyn Fn(f64, f64, f64) -> String| -> String {
        upper.iter().zip(reversed(&lower)).map(|(u, l)| f(u.0, u.1, l.1)).collect()
    };
    let numbered: String = ring.iter().zip(1..).map(|((x, y), k)| format!("{k} {x} {y}\n")).collect();
    for (text, told) in [
        (
            format!("t\n{clean}\nReference: somebody 1998\n1 May 2003\n"),
            "2 lines are text and are left out, the first is line 84",
        ),
        (format!("t\n{}# c\nlower\n{}", text(&upper), text(&lower[1..])), "line 44 is text and is left out: `lower`"),
        (
            format!("MYFOIL\n -1.75 2.75 -2.0 2.5\n{clean}"),
            "line 2, `-1.75 2.75 -2.0 2.5`, is left out: limits of a grid",
        ),
        (format!("2412 10\n{clean}"), "line 1, two numbers far from all points, is taken as the title"),
        (format!("2412 10\n41 41\n{}", text(&nose_first)), "Lednicer order, 41 and 41 points"),
        (format!("t\n40 41\n{}", text(&nose_first)), "line 2: announces 40 and 41 points but 82 follow"),
        (both_from_rear, "both sides from the trailing edge, 41 and 41 points, the second side begins in line 42"),
        (text(&ring[..80]), "the first point is not repeated at the end: the outline is closed from"),
        (text(&turned), "once around from (0.5"),
        (percent.replacen("100.000000 7.000000", "100 7", 2), "coordinates are taken as percent of the chord"),
        (clean.replacen("1 0\n", "1.000009 0\n", 1), "is closed"),
        (clean.replacen("1 0\n", "1 1e-5\n", 1), "the trailing edge, open by 1.0e-5 chords from (1, 0) in line 81"),
        (pairs(&|x, u, l| format!("{x} {u} {l}\n")), "columns 1 and 2 are the upper side, 1 and 3 the lower one"),
        (pairs(&|x, u, l| format!("{x} {u} {x} {l}\n")), "columns 1 and 2 are the upper side, 3 and 4 the lower one"),
        (format!("x,y_upper,y_lower\n{}", pairs(&|x, u, l| format!("{x},{u},{l}\n"))), "`y_lower` for the lower side"),
        (numbered, "coordinates from columns 2 and 3 of 3"),
        (clean.replace('\n', " 0\n"), "coordinates from columns 1 and 2 of 3"),
        (clean.replace("-0.", "\u{2212}.").replace("0.5 ", "5.D-1 "), "Selig order"),
    ] {
        let (found, notes) = area(&text);
        assert!((found / exact - 1.0).abs() < 2e-5, "{told}: {found} {exact} {notes:?}");
        assert!(notes.iter().any(|n| n.contains(told)), "{told}: {notes:?}");
    }
}

#[test]
fn thick_bases_and_unclosed_smooth_outlines_are_told_from_one_another() {
    let flatback = "1 0.1099\n0.9 0.14\n0.6 0.22\n0.3 0.24\n0.1 0.16\n0.02 0.07\n0 0\n0.02 -0.07\n0.1 -0.16\n0.3 -0.24\n\
                    0.6 -0.23\n0.9 -0.15\n1 -0.12402\n";
    let (surface, notes) = load(flatback).unwrap();
    assert!(surface.sharp.len() == 2 && notes.iter().any(|n| n.contains("blunt base")), "{notes:?}");
    let angle = |i: usize| 2.0 * PI * i as f64 / 200.0;
    let (surface, notes) = load(&rows((0..200).map(|i| (0.5 + 0.5 * angle(i).cos(), 0.06 * angle(i).sin())))).unwrap();
    assert!(
        (surface.volume() / (0.03 * PI) - 1.0).abs() < 1e-5 && notes.iter().any(|n| n.contains("not repeated")),
        "{notes:?}"
    );
    // a file that is cut short
    let [upper, lower] = section(40);
    let cut = rows(upper.into_iter().chain(lower.into_iter().skip(1).take(28)));
    assert!(error(&cut).contains("along its side"), "{}", error(&cut));
}

#[test]
fn rows_that_are_damaged_are_never_left_out() {
    let rows = "a\n1 0\n0.5 0.05\n0.1 0.03\n0 0\n0.1 -0.03\n0.5 -0.05\n1 0\n";
    assert!(load(rows).is_ok());
    for (damage, told) in [
        (rows.replacen("0.5 0.05", "O.5 0.05", 1), "line 3: `O.5`"),
        (rows.replacen("0.5 0.05", "0.5 ......", 1), "line 3: `......`"),
        (rows.replacen("0.5 0.05", "0.5 nan", 1), "line 3: `nan`"),
        (rows.replacen("0.5 0.05", "0.5 (0.05)", 1), "line 3: `(0.05)`"),
        (rows.replacen("1 0\n", "1 0.o\n", 1), "line 2: `0.o`"),
        (rows.replacen("-0.05\n1 0\n", "-0.05\n1 0.0.0\n", 1), "line 8: `0.0.0`"),
        (rows.replacen("0.5 0.05\n", "0.5 0.05 ", 1), "line 3: has 4 numbers where the other rows have 2"),
        (rows.replacen("0 0\n0.1 -", "0 0\n999 999\n0.1 -", 1), "line 6: another element begins after 999"),
    ] {
        assert!(error(&damage).contains(told), "{told}: {}", error(&damage));
    }
}

#[test]
fn an_ellipse_without_corners_stays_smooth() {
    let angle = |i: usize| 2.0 * std::f64::consts::PI * i as f64 / 80.0;
    let text = rows((0..=80).map(|i| (0.5 + 0.5 * angle(i).cos(), 0.2 * angle(i).sin())));
    let (surface, _) = load(&text).unwrap();
    assert!(surface.sharp.is_empty() && (surface.volume() / (0.1 * std::f64::consts::PI) - 1.0).abs() < 1e-4);
}

#[test]
fn points_missing_on_a_side_are_told() {
    let angle = |i: usize| 2.0 * std::f64::consts::PI * i as f64 / 100.0;
    let ellipse = |left_out: std::ops::Range<usize>| {
        let kept = (0..=100).filter(move |i| !left_out.contains(i));
        load(&rows(kept.map(|i| (0.5 + 0.5 * angle(i).cos(), 0.1 * angle(i).sin())))).unwrap().1
    };
    let told = |notes: &[String]| notes.iter().filter(|n| n.contains("points missing")).count();
    let notes = ellipse(23..28);
    assert!(notes.iter().any(|n| n.contains("6.1 times as far") && n.contains("line 23")), "{notes:?}");
    assert_eq!((told(&ellipse(0..0)), told(&notes), told(&ellipse(47..51))), (0, 1, 1));
    assert_eq!(told(&load(RAE_2822).unwrap().1) + told(&load(NACA_0012).unwrap().1), 0);
}

#[test]
fn mistakes_are_refused_with_their_place() {
    assert!(error("").contains("holds 0 points"));
    assert!(error("a\n1 0\n0.5 x\n0 0").contains("wing.dat, line 3: `x` is not a finite number"));
    assert!(error("a\n1 0\n0.5\n0 0").contains("line 3: has 1 value"));
    assert!(error("a\n3 4\n0 0\n0.5 0.1\n1 0\n").contains("announces 3 and 4 points but 3 follow"));
    assert!(error("0 0\n0.5 0.1\n0.7 -0.1\n1 0").contains("line 3: one side only"));
    assert!(error("1 0\n0.5 0.1\n0 0\n0.5 -0.1\n0.8 0.3\n1 0").contains("crosses itself at"));
    assert!(error("1 0\n0.8 0\n0.5 0\n0 0\n0.5 0\n1 0").contains("no area"));
    assert!(error("surface,x_c,z_c\nupper,0,0\nmiddle,1,0\nlower,1,0").contains("`middle` is not a side"));
    assert!(error("section,x_c,z_c\n0,1,0\n0,0,0.1\n1,1,0").contains("one section per file"));
}

/// The ring of [`section`] in rows that `row` writes of number, x and y.
fn ring(n: usize, row: impl Fn(usize, f64, f64) -> String) -> String {
    let [upper, lower] = section(n);
    upper.iter().chain(&lower[1..]).enumerate().map(|(k, (x, y))| row(k, *x, *y) + "\n").collect()
}

#[test]
fn numbers_of_points_are_no_coordinates() {
    let (exact, _) = area(&ring(30, |_, x, y| format!("{x} {y}")));
    let counted = |first: i32, step: i32| ring(30, |k, x, y| format!("{} {x} {y}", first + step * k as i32));
    for (first, step) in [(1, 1), (0, 1), (101, 1), (10, 10), (0, 10), (500, -1)] {
        for text in [counted(first, step), counted(first, step).replace('\n', " 0.0\n")] {
            let (found, notes) = area(&text);
            assert!((found / exact - 1.0).abs() < 1e-12, "{first} {step}: {found} {exact}");
            assert!(notes.iter().any(|n| n.contains("coordinates from columns 2 and 3")), "{notes:?}");
        }
    }
    // percent of the chord in equal steps is a coordinate
    let half = |x: f64| 12.0 * (x / 100.0).sqrt() * (1.0 - x / 100.0);
    let table = |row: &dyn Fn(f64) -> String| (0..=20).map(|k| row(5.0 * f64::from(k)) + "\n").collect::<String>();
    for (text, told) in [
        (table(&|x| format!("{x} {} {}", 2.0 + half(x), 2.0 - half(x))), "columns 1 and 2 are the upper side"),
        (table(&|x| format!("{x} {} {}", half(x) - 1.0, -half(x) - 1.0)), "columns 1 and 2 are the upper side"),
        (
            table(&|x| format!("{x} {} {}", half(x), 0.1 * half(x) * (50.0 - x))),
            "coordinates from columns 1 and 2 of 3",
        ),
        (table(&|x| format!("{x} {} {x} {}", half(x), -half(x))), "columns 1 and 2 are the upper side, 3 and 4"),
    ] {
        let notes = load(&text).unwrap_or_else(|e| panic!("{e}\n{text}")).1;
        assert!(notes.iter().any(|n| n.contains(told)), "{told}: {notes:?}");
    }
}

#[test]
fn headers_may_have_words_ahead_of_the_names() {
    let clean = ring(30, |_, x, y| format!("{x} {y}"));
    let (exact, _) = area(&clean);
    for header in [
        "TITLE = \"foil\"\nVARIABLES = \"X\" \"Y\"\nZONE I=61",
        "VARIABLES = \"X\", \"Y\"\nZONE",
        "VARIABLES=\"X\",\"Y\"",
        "% x y",
        "%x y",
        "* x y",
        "// x y",
        "# x y",
        "! x y",
        "coordinates of the section: x/c y/c",
        "x y",
    ] {
        let (found, notes) = area(&format!("{header}\n{clean}"));
        assert!((found / exact - 1.0).abs() < 1e-12, "{header}: {found} {notes:?}");
    }
    let more = [
        ("no. x y remark\n", ring(30, |k, x, y| format!("{k} {x} {y}"))),
        ("% x y z\n", ring(30, |_, x, y| format!("{x} {y} 0.0"))),
    ];
    for (header, rows) in more {
        let (found, notes) = area(&(header.to_owned() + &rows));
        assert!((found / exact - 1.0).abs() < 1e-12, "{header}: {found} {notes:?}");
    }
    assert!(error(&format!("x y_upper y_lower\n{clean}")).contains("line 2: has 2 values where the header has 3"));
}

#[test]
fn sides_are_found_in_any_order_and_sections_in_any_plane() {
    let [upper, lower] = section(30);
    let (exact, _) = area(&ring(30, |_, x, y| format!("{x} {y}")));
    let sides = |row: &dyn Fn(f64, f64, f64) -> String| -> String {
        upper.iter().rev().zip(&lower).map(|(u, l)| row(u.0, u.1, l.1) + "\n").collect()
    };
    let space = |row: &dyn Fn(f64, f64) -> String| ring(30, |_, x, y| row(x, y));
    for text in [
        "x lower upper\n".to_owned() + &sides(&|x, u, l| format!("{x} {l} {u}")),
        "x,y_l,y_u\n".to_owned() + &sides(&|x, u, l| format!("{x},{l},{u}")),
        "xl yl xu yu\n".to_owned() + &sides(&|x, u, l| format!("{x} {l} {x} {u}")),
        "t\n".to_owned() + &sides(&|x, u, l| format!("{x} {l} {u}")),
        "t\n".to_owned() + &sides(&|x, u, l| format!("{x} {u} {l}")),
        "x y z\n".to_owned() + &space(&|x, y| format!("{x} 0.0 {y}")),
        "x y z\n".to_owned() + &space(&|x, y| format!("{x} {y} 0.0")),
        "id x y z\n".to_owned() + &space(&|x, y| format!("7 0.5 {x} {y}")),
    ] {
        let (found, notes) = area(&text);
        assert!((found / exact - 1.0).abs() < 2e-5, "{found} {exact} {notes:?}\n{text}");
    }
    // pressures beside the lower side alone are no upper side
    let pressures = sides(&|x, _, l| format!("{x} {l} {}", 1.0 - x + 0.5 * x * x));
    assert!(error(&pressures).contains("half thickness"), "{}", error(&pressures));
}

#[test]
fn rows_whose_numbers_are_lost_are_refused_and_rules_are_not() {
    let rows = "a\n1 0\n0.5 0.05\n0.1 0.03\n0 0\n0.1 -0.03\n0.5 -0.05\n1 0\n";
    for lost in ["******** ********", "nan nan", "NaN ********", "-nan 0.05", "inf inf"] {
        let told = error(&rows.replacen("0.5 0.05", lost, 1));
        assert!(told.contains("line 3: `") && told.contains("is not a finite number"), "{lost}: {told}");
    }
    for text in ["-----", "----- -----", "* * upper side"] {
        let notes = load(&rows.replacen("0 0\n", &format!("{text}\n0 0\n"), 1)).unwrap().1;
        assert!(notes.iter().any(|n| n.contains("line 5 is text and is left out")), "{text}: {notes:?}");
    }
}

#[test]
fn second_elements_and_camber_lines_are_told_with_their_line() {
    let first = ring(30, |_, x, y| format!("{x} {y}"));
    let flap = ring(30, |_, x, y| format!("{} {}", 0.98 + 0.3 * x, 0.3 * y - 0.05));
    for (second, line) in [
        (format!("\n{flap}"), 64),
        (format!("flap\n{flap}"), 64),
        ("\ncamber\n0 0\n0.2 0\n0.5 0\n1 0\n".to_owned(), 65),
    ] {
        let told = error(&format!("t\n{first}{second}"));
        let place = format!(
            "wing.dat, line {line}: a second line of points begins after the outline that is closed in line 62"
        );
        assert!(told.contains(&place) && told.contains("one element per file"), "{told}");
    }
    // blank lines within one outline are nothing
    let rows: Vec<&str> = first.lines().collect();
    for k in 1..rows.len() {
        let divided = format!("t\n{}\n\n{}\n", rows[..k].join("\n"), rows[k..].join("\n"));
        assert!(load(&divided).is_ok(), "{k}");
    }
}

#[test]
fn outlines_that_are_drawn_twice_are_read_once() {
    let once = ring(30, |_, x, y| format!("{x} {y}"));
    let (exact, _) = area(&once);
    let open: String = once.lines().skip(1).map(|l| format!("{l}\n")).collect();
    for text in [once.repeat(2), format!("{once}\n{once}"), once.clone() + &open, once.repeat(3)] {
        let (found, notes) = area(&text);
        assert!((found / exact - 1.0).abs() < 1e-12, "{found} {exact}");
        assert!(notes.iter().any(|n| n.contains("the outline is drawn ")), "{notes:?}");
    }
}

#[test]
fn points_beside_others_by_rounding_are_one() {
    let rows = ring(30, |k, x, y| {
        let near = if k == 10 { format!("\n{} {}", x + 1e-7, y - 1e-7) } else { String::new() };
        format!("{x} {y}{near}")
    });
    let (surface, notes) = load(&rows).unwrap();
    assert!(surface.sharp.len() == 1 && notes.iter().any(|n| n.contains("the point of line 12 repeats")), "{notes:?}");
}

#[test]
fn files_in_small_units_take_no_length_of_a_chord() {
    let read = |unit: f64, scale: f64| {
        let mut notes = Vec::new();
        let text = ring(30, |_, x, y| format!("{} {}", unit * x, unit * y));
        read("wing.dat", text.as_bytes(), scale, &mut notes).map(|_| notes).map_err(|e| e.to_string())
    };
    let told = read(300.0, 0.3).unwrap_err();
    assert!(told.contains("wing.dat: its section is 300 long") && told.contains("`scale = \"1 mm\"`"), "{told}");
    let tells = |unit: f64, scale: f64| read(unit, scale).unwrap().iter().any(|n| n.contains("multiplies it"));
    assert!(tells(0.7, 0.3) && tells(12.0, 0.3));
    for (unit, scale) in
        [(1.0, 0.3), (1.01, 0.3), (300.0, 0.001), (12.0, 0.0254), (3.0, 0.3048), (300.0, 1.0), (100.0, 0.3)]
    {
        assert!(!tells(unit, scale), "{unit} {scale}");
    }
}

proptest! {
    #[test]
    fn no_bytes_panic(bytes in proptest::collection::vec(any::<u8>(), 0..400)) {
        let _ = read("x.dat", bytes.as_slice(), 1.0, &mut Vec::new());
    }

    #[test]
    fn no_mutation_panics(place in 0..3000_usize, byte in any::<u8>(), cut in 0..3000_usize, drop in 0..60_usize) {
        let mut bytes = RAE_2822.as_bytes().to_vec();
        let place = place % bytes.len();
        bytes[place] = byte;
        bytes.drain(place..(place + drop).min(bytes.len()));
        bytes.truncate(cut.max(300));
        let _ = read("x.dat", bytes.as_slice(), 1.0, &mut Vec::new());
    }

    #[test]
    fn no_numbers_panic(v in proptest::collection::vec((-3..4_i32, -3..4_i32), 3..12), scale in -200..200_i32) {
        let unit = 10_f64.powi(scale);
        let text = rows(v.iter().map(|(x, y)| (f64::from(*x) * unit, f64::from(*y) * unit)));
        let _ = read("x.dat", text.as_bytes(), 1.0, &mut Vec::new());
    }
}
