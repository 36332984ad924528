//! Layers on bodies that break them: thin edges, corners, bends, other walls.

use std::sync::Arc;

use crate::common::Uniform;
use alula::cloud::conservative::conservative;
use alula::cloud::layers::End;
use alula::cloud::{Cloud, CloudSpec, Diagnosis, Operators};
use alula::geometry::load_surface;
use alula::math::Vector;
use alula::physics::Primitive;
use alula::scheme::Fluid;
use alula::scheme::wall_fits::WallFits;
use alula::system::{Instant, System};

fn build<const D: usize>(body: &str, rest: &str) -> Cloud<D> {
    let text = format!("title = \"t\"\n[flow]\nmach = 0.5\n[[body]]\n{body}\n[cloud]\nfar_field = 4\n{rest}");
    let case = alula::case::read(&text, "test").unwrap();
    let surface = load_surface(&case.bodies, std::path::Path::new(".")).unwrap().0;
    Cloud::build(&CloudSpec::of_case(&case), Some(&surface), &[]).unwrap()
}

const CIRCLE: &str = "circle = { radius = 0.5 }";
const NACA: &str = "naca = \"0012\"";
const PLATE: &str = "polygon = [[0, 0], [1, 0], [1, 0.004], [0, 0.004]]";
const SQUARE: &str = "polygon = [[0, 0], [1, 0], [1, 1], [0, 1]]";
const PLUS: &str = "polygon = [[1, 0], [2, 0], [2, 1], [3, 1], [3, 2], [2, 2], [2, 3], [1, 3], [1, 2], [0, 2], [0, 1], [1, 1]]\nscale = 0.4";

/// Largest relative error of the slopes of linear fields over all rows that are not of first order.
fn slope_error<const D: usize>(cloud: &Cloud<D>, operators: &Operators<D>) -> f64 {
    let mut slope = vec![[Vector::<D>::ZERO; D]; cloud.n_rows()];
    for k in 0..operators.parts.len() {
        for (e, [a_i, a_j]) in operators.weighed_edges(cloud, k) {
            let d = cloud.x[e.j()] - cloud.x[e.i()];
            for axis in 0..D {
                slope[e.i()][axis] += a_i * d[axis];
                if e.both() {
                    slope[e.j()][axis] -= a_j * d[axis];
                }
            }
        }
    }
    let exact = |i: &usize| cloud.first_order.binary_search(&(*i as u32)).is_err();
    let error = |i: usize| (0..D).map(|a| (slope[i][a] - Vector::axis(a)).max_abs()).fold(0.0, f64::max);
    (0..cloud.n_rows()).filter(exact).map(error).fold(0.0, f64::max)
}

fn aspect<const D: usize>(cloud: &Cloud<D>) -> f64 {
    let ratio = |i: usize| cloud.layers.slot(i).map_or(1.0, |(c, k)| cloud.spacing[i] / cloud.layers.thickness(c, k));
    (0..cloud.n_fluid).map(ratio).fold(0.0, f64::max)
}

fn worst(diagnosis: &Diagnosis, measure: &str) -> f64 {
    diagnosis.worst.iter().find(|w| w.measure == measure).map_or(0.0, |w| w.value)
}

/// Area of the interior of the domain, without the leaves that carry the outer particles and without the body.
fn free_area(cloud: &Cloud<2>, body: f64) -> f64 {
    let extent = cloud.tree.bounds().extent();
    let rim: f64 = cloud.outer_range().map(|i| cloud.spacing[i] * cloud.spacing[i]).sum();
    extent[0] * extent[1] - rim - body
}

/// Builds a cloud, checks all that must hold, and returns it with its diagnosis.
fn check(body: &str, area: f64, (spacing, first): (f64, f64)) -> (Cloud<2>, Diagnosis) {
    let mut cloud = build(body, &format!("spacing = {spacing}\nwall_layers = {{ first = {first} }}"));
    let mut operators = Operators::new(&cloud);
    assert!(slope_error(&cloud, &operators) < 1e-10);
    let fits = WallFits::new(&cloud);
    let diagnosis = Diagnosis::of(&cloud, fits.n_linear);
    assert!(cloud.volume[..cloud.n_fluid].iter().all(|v| *v > 0.0));
    let (sum, free) = (cloud.volume[..cloud.n_fluid].iter().sum::<f64>(), free_area(&cloud, area));
    // what the volumes miss is counted against the neighbourhood of the body, not against the far field
    assert!((sum - free).abs() < 0.05 * area.max(0.5), "{body}: {sum} {free}");
    let report = conservative(&mut cloud, &mut operators);
    assert!(report.closure_defect < 1e-13 && report.min_volume_ratio > 0.2 && report.n_softened == 0, "{report:?}");
    assert!(report.linear_error_rms < 0.07, "{report:?}");
    assert!(cloud.first_order.is_empty());
    (cloud, diagnosis)
}

#[test]
fn layers_are_healthy_at_any_aspect_ratio() {
    let cases = [
        (CIRCLE, std::f64::consts::PI * 0.25, 0.03),
        (NACA, 0.0815, 0.0078125),
        (PLATE, 0.004, 0.02),
        (SQUARE, 1.0, 0.03),
        (PLUS, 5.0 * 0.16, 0.03),
    ];
    for (body, area, spacing) in cases {
        for ratio in [0.1, 0.005] {
            let (cloud, diagnosis) = check(body, area, (spacing, ratio * spacing));
            assert!(aspect(&cloud) > 0.7 / ratio);
            let early = |note: &String| note.starts_with("wall layers end early");
            assert!(diagnosis.notes.iter().all(early) && diagnosis.repairs.is_empty(), "{body}: {diagnosis:?}");
            // only the concave corners of the cross cut columns short
            assert_eq!(diagnosis.notes.is_empty(), body != PLUS, "{body}: {diagnosis:?}");
            assert!(worst(&diagnosis, "condition number") < 20.0 && worst(&diagnosis, "one-sidedness") < 0.7);
            assert!(worst(&diagnosis, "nearest neighbour") >= 0.3);
        }
    }
}

#[test]
fn linear_fields_are_exact_on_a_curved_wall_at_an_aspect_ratio_of_1000() {
    let cloud = build::<2>(CIRCLE, "spacing = 0.03\nwall_layers = { first = 2.2e-5 }");
    assert!(aspect(&cloud) > 1000.0);
    assert!(slope_error(&cloud, &Operators::new(&cloud)) < 1e-10);
    let fits = WallFits::new(&cloud);
    assert_eq!(fits.n_linear, 0);
    // heights follow the growth, and rows inside the layers are crosses
    for column in &cloud.layers.columns {
        let exact = |k: usize| 2.2e-5 * (1.2f64.powi(k as i32 + 1) - 1.0) / 0.2;
        assert!(column.heights.iter().enumerate().all(|(k, h)| (h / exact(k) - 1.0).abs() < 1e-12));
        let top = column.particles.len();
        assert!(column.particles[..top - 2].iter().all(|i| cloud.neighbours.of(*i as usize).len() == 4));
    }
}

const SPHERE: &str = "sphere = { radius = 0.5 }";
const BRICK: &str = "box = { size = [1, 0.7, 0.4] }";

#[test]
fn linear_fields_are_exact_in_prisms() {
    for (body, ratio) in [(SPHERE, 0.002), (SPHERE, 0.05), (BRICK, 0.02), (BRICK, 0.2)] {
        let rest = "spacing = 0.1\nlayers = 4\nedge_levels = 0\ncurvature_levels = 0\n";
        let mut cloud = build::<3>(body, &format!("{rest}wall_layers = {{ first = {} }}", 0.1 * ratio));
        assert!(aspect(&cloud) > 0.4 / ratio, "{body}: {}", aspect(&cloud));
        let mut operators = Operators::new(&cloud);
        assert!(slope_error(&cloud, &operators) < 1e-10, "{body}: {}", slope_error(&cloud, &operators));
        assert!(cloud.volume[..cloud.n_fluid].iter().all(|v| *v > 0.0));
        let report = conservative(&mut cloud, &mut operators);
        assert!(report.closure_defect < 1e-12 && report.min_volume_ratio > 0.1, "{body}: {report:?}");
    }
}

#[test]
fn prisms_fill_the_shell_that_they_take_the_place_of() {
    let cloud = build::<3>(
        SPHERE,
        "spacing = 0.1\nlayers = 4\ncurvature_levels = 0\nwall_layers = { first = 0.004, count = 6 }",
    );
    let top = cloud.layers.columns[0].heights[5];
    let below = |i: &usize| cloud.layers.slot(*i).is_some_and(|(_, k)| k <= 5);
    let volume: f64 = (0..cloud.n_fluid).filter(below).map(|i| cloud.volume[i]).sum();
    let walls: f64 = cloud.interface_range().map(|i| cloud.volume[i]).sum();
    // up to the middle between the fifth layer and the sixth
    let middle = 0.5 * (top + cloud.layers.columns[0].heights[4]);
    let shell = 4.0 / 3.0 * std::f64::consts::PI * ((0.5 + middle).powi(3) - 0.125);
    assert!(((volume + walls) / shell - 1.0).abs() < 0.01, "{volume} {walls} {shell}");
    // around every column of a smooth wall stand about six
    let n = cloud.layers.columns.len();
    let beside: usize = cloud.layers.columns.iter().map(|c| c.beside.len()).sum();
    // Euler's formula for a triangulated sphere, less what four feet on a circle leave out
    let all = 2 * (3 * n - 6);
    assert!(beside <= all && beside * 10 > all * 9, "{beside} of {all}");
    assert!(cloud.layers.columns.iter().all(|c| !c.open));
}

#[test]
fn gas_at_rest_stays_so_between_prisms_and_beside_a_plane_of_symmetry() {
    let rest = "spacing = 0.1\nlayers = 4\ncurvature_levels = 0\nwall_layers = { first = 0.01 }\n[boundary]\ny_min = \"symmetry\"";
    let cloud = build::<3>(SPHERE, rest);
    assert!(slope_error(&cloud, &Operators::new(&cloud)) < 1e-10 && cloud.notes.is_empty(), "{:?}", cloud.notes);
    assert!(cloud.layers.columns.iter().any(|c| c.beside.iter().any(|b| b.image.is_some())));
    assert!(cloud.layers.columns.iter().all(|c| !c.open));
    assert!(rest_residual::<3>(SPHERE, rest) < 1e-11);
}

#[test]
fn adjacent_columns_differ_by_one_layer_at_most() {
    for body in [NACA, SQUARE, PLUS] {
        let cloud = build::<2>(body, "spacing = 0.02\nwall_layers = { first = 0.0005 }");
        for (w, column) in cloud.layers.columns.iter().enumerate() {
            for other in &column.beside {
                assert!(cloud.layers.count(other.column as usize).abs_diff(column.particles.len()) <= 1);
            }
            for (k, i) in column.particles.iter().enumerate() {
                assert_eq!(cloud.layers.slot(*i as usize), Some((w, k + 1)));
                assert_eq!(cloud.wall_distance[*i as usize], column.heights[k]);
            }
        }
    }
}

#[test]
fn columns_stop_where_walls_face_one_another() {
    for gap in [0.3, 0.05, 0.004] {
        let text = format!(
            "title = \"t\"\n[flow]\nmach = 0.5\n[[body]]\n{CIRCLE}\n[[body]]\n{CIRCLE}\ntranslate = [{}, 0]\n[cloud]\nfar_field = 4\nspacing = 0.02\nwall_layers = {{ first = 0.001 }}",
            1.0 + gap
        );
        let case = alula::case::read(&text, "test").unwrap();
        let surface = load_surface::<2>(&case.bodies, std::path::Path::new(".")).unwrap().0;
        let cloud = Cloud::build(&CloudSpec::of_case(&case), Some(&surface), &[]).unwrap();
        assert!(slope_error(&cloud, &Operators::new(&cloud)) < 1e-10);
        for i in (0..cloud.n_fluid).filter(|i| cloud.layers.slot(*i).is_some()) {
            let x = &cloud.x[i];
            assert!(!surface.inside(x) && surface.nearest(x, 0.8 * cloud.wall_distance[i]).is_none());
        }
    }
}

#[test]
fn layers_go_on_across_a_plane_of_symmetry() {
    let text = format!(
        "title = \"t\"\n[flow]\nmach = 0.5\n[[body]]\n{NACA}\n[cloud]\nfar_field = 4\nspacing = 0.01\nwall_layers = {{ first = 0.0003 }}\n[boundary]\ny_min = \"symmetry\""
    );
    let case = alula::case::read(&text, "test").unwrap();
    let surface = load_surface::<2>(&case.bodies, std::path::Path::new(".")).unwrap().0;
    let mut cloud = Cloud::build(&CloudSpec::of_case(&case), Some(&surface), &[]).unwrap();
    let mut operators = Operators::new(&cloud);
    assert!(slope_error(&cloud, &operators) < 1e-10 && cloud.notes.is_empty());
    let nose = (0..cloud.interface.len())
        .find(|w| cloud.layers.columns[*w].beside.iter().any(|b| b.column as usize == *w))
        .unwrap();
    let second = cloud.layers.columns[nose].particles[1] as usize;
    assert!(cloud.x[second][0] < 0.0 && cloud.neighbours.of(second).len() == 4);
    assert!(cloud.neighbours.of(second).iter().any(|j| *j as usize >= cloud.n_real()));
    assert!(conservative(&mut cloud, &mut operators).closure_defect < 1e-13);
}

#[test]
fn a_number_of_layers_is_kept() {
    let cloud = build::<2>(CIRCLE, "spacing = 0.03\nwall_layers = { first = 0.002, growth = 1.1, count = 5 }");
    assert!(cloud.layers.columns.iter().all(|c| c.particles.len() == 5));
    let none = build::<2>(CIRCLE, "spacing = 0.03");
    assert!(none.layers.is_empty() && none.layers.columns.is_empty());
}

/// A square with a notch of an opening angle cut into its upper side, `lean` moves the tip of the notch aside.
fn notch(opening: f64, lean: f64) -> (String, f64) {
    let (depth, half) = (0.6, 0.6 * (0.5 * opening.to_radians()).tan());
    let body = format!(
        "polygon = [[-0.5, -0.5], [0.5, -0.5], [0.5, 0.5], [{half}, 0.5], [{lean}, {}], [{}, 0.5], [-0.5, 0.5]]",
        0.5 - depth,
        -half
    );
    (body, 1.0 - depth * half)
}

/// Gas at rest around a body with walls that hold it: largest change in time.
fn rest_residual<const D: usize>(body: &str, rest: &str) -> f64 {
    let text =
        format!("title = \"t\"\n[flow]\nmach = 0.3\nreynolds = 1000\n[[body]]\n{body}\n[cloud]\nfar_field = 4\n{rest}");
    let case = alula::case::read(&text, "test").unwrap();
    let (fluid, mut u) = alula::run::build_solver::<D>(&case, std::path::Path::new(".")).unwrap();
    let still = Primitive { density: 1.0, velocity: Vector::ZERO, pressure: 1.0 / fluid.gas.gamma };
    u.chunks_exact_mut(D + 2).for_each(|row| fluid.gas.conserved(&still).store(row));
    let fluid = Fluid { far_field: Arc::new(Uniform(still)), ..fluid };
    let frame = fluid.frame(&Instant::still(0.0), &u);
    let (mut work, mut du) = (fluid.work(), vec![0.0; u.len()]);
    fluid.rhs(&frame, &u, &mut work, &mut du);
    du.iter().fold(0.0, |m: f64, v| if v.is_nan() { f64::INFINITY } else { m.max(v.abs()) })
}

/// Smallest distance between fluid particles of two columns, in parts of the distance between layers there.
fn closest(cloud: &Cloud<2>) -> f64 {
    let slots = (0..cloud.n_fluid).filter_map(|i| Some((i, cloud.layers.slot(i)?))).collect::<Vec<_>>();
    let mut least = f64::INFINITY;
    for (i, (c, k)) in &slots {
        let thin = cloud.layers.thickness(*c, *k).min(cloud.spacing[*i]);
        let others = slots.iter().filter(|(_, slot)| slot.0 != *c);
        least = others.map(|(j, _)| (cloud.x[*j] - cloud.x[*i]).norm() / thin).fold(least, f64::min);
    }
    least
}

#[test]
fn layers_stop_before_they_meet_in_a_notch_and_the_gas_stays_at_rest() {
    for (opening, lean, first) in [
        (70.0, 0.0, 0.004),
        (60.0, 0.1, 0.0005),
        (30.0, 0.3, 0.004),
        (15.0, 0.0, 0.004),
        (15.0, -0.2, 0.002),
        (8.0, 0.1, 0.004),
    ] {
        let (body, area) = notch(opening, lean);
        let rest = format!("spacing = 0.03\nwall_layers = {{ first = {first} }}");
        let cloud = build(&body, &rest);
        let what = format!("{opening} {lean} {first}");
        let (sum, free) = (cloud.volume[..cloud.n_fluid].iter().sum::<f64>(), free_area(&cloud, area));
        assert!((sum - free).abs() < 0.05 * area, "{what}: {sum} {free}");
        assert!(closest(&cloud) > 0.6, "{what}: {}", closest(&cloud));
        assert!(slope_error(&cloud, &Operators::new(&cloud)) < 1e-10, "{what}");
        let diagnosis = Diagnosis::of(&cloud, WallFits::new(&cloud).n_linear);
        assert!(diagnosis.notes.iter().any(|n| n.starts_with("wall layers end early")), "{what}: {diagnosis:?}");
        // narrower than the spacing for most of its depth, a notch has no conservative coefficients
        let scheme = if opening < 20.0 { "\n[scheme]\nconservative = false\n" } else { "" };
        let residual = rest_residual::<2>(&body, &format!("{rest}{scheme}"));
        assert!(residual < 2e-12, "{what}: {residual:e}");
    }
}

#[test]
fn a_first_layer_beyond_the_spacing_is_told() {
    let cloud = build::<2>(CIRCLE, "spacing = 0.03\nwall_layers = { first = 0.1 }");
    let notes = Diagnosis::of(&cloud, 0).notes;
    assert!(notes.iter().any(|n| n.starts_with("there are no wall layers: `cloud.wall_layers.first`")), "{notes:?}");
}

#[test]
fn the_end_of_columns_is_told_with_its_reason() {
    let ends = |body: &str| {
        let cloud = build::<2>(body, "spacing = 0.02\nwall_layers = { first = 0.0005 }");
        cloud.layers.columns.iter().map(|c| c.end).collect::<Vec<_>>()
    };
    assert!(ends(CIRCLE).iter().all(|e| *e == End::Planned));
    assert!(ends(PLUS).contains(&End::Meeting));
}

/// Behind a sharp edge the gas may come back around it: the last column must see it as what comes along the wall.
#[test]
fn the_last_column_before_a_sharp_edge_looks_both_ways() {
    let cloud = build::<2>(NACA, "spacing = 0.015625\nwall_layers = { first = 0.0003 }");
    let operators = Operators::new(&cloud);
    let mut shares = Vec::new();
    for (c, column) in cloud.layers.columns.iter().enumerate().filter(|(_, c)| c.open) {
        let (i, along) = (column.particles[0] as usize, cloud.layers.axes(c)[0]);
        let edges = (0..operators.fluid_parts().len()).flat_map(|k| operators.weighed_edges(&cloud, k));
        let rows = edges.flat_map(|(e, [a_i, a_j])| {
            [(e.i(), e.j(), a_i), (e.j(), e.i(), a_j)].into_iter().take(1 + usize::from(e.both()))
        });
        let behind = rows.filter(|(own, other, _)| *own == i && cloud.layers.slot(*other).is_none());
        let share: f64 = behind.map(|(_, j, a)| a.dot(&along) * (cloud.x[j] - cloud.x[i]).dot(&along)).sum();
        shares.push(share);
    }
    // the rest of the slope along the wall is that towards the column before it
    assert!(shares.len() == 2 && shares.iter().all(|s| (0.3..0.7).contains(s)), "{shares:?}");
}

#[test]
fn walls_that_face_one_another_are_fitted_by_planes() {
    let text = "title = \"t\"\n[flow]\nmach = 0.5\n[[body]]\ncircle = { radius = 0.5 }\n[[body]]\ncircle = { radius = 0.5 }\n\
                translate = [1.004, 0]\n[cloud]\nspacing = 0.02\n";
    let case = alula::case::read(text, "test").unwrap();
    let surface = load_surface::<2>(&case.bodies, std::path::Path::new(".")).unwrap().0;
    let cloud = Cloud::build(&CloudSpec::of_case(&case), Some(&surface), &[]).unwrap();
    assert!(WallFits::new(&cloud).n_linear > 0);
}
