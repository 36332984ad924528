//! What every cloud must satisfy, on bodies that have broken clouds before.
use super::{Cloud, CloudSpec, Diagnosis, Operators};
use crate::geometry::{Shell, Surface, icosphere, load_surface};
use crate::math::Vector;

fn case(text: &str) -> crate::case::Case {
    crate::case::read(&format!("title = \"t\"\n[flow]\nmach = 0.5\n{text}"), "test").unwrap()
}

fn surface_of<const D: usize>(case: &crate::case::Case) -> Surface<D> {
    load_surface(&case.bodies, std::path::Path::new(".")).unwrap().0
}

fn cloud<const D: usize>(text: &str) -> (Cloud<D>, Surface<D>) {
    let case = case(text);
    let surface = surface_of(&case);
    (Cloud::build(&CloudSpec::of_case(&case), Some(&surface), &[]).unwrap(), surface)
}

/// The particle that `j` is, or is the image of, and the transform.
fn source<const D: usize>(cloud: &Cloud<D>, j: u32) -> (usize, Option<u8>) {
    match (j as usize).checked_sub(cloud.n_real()) {
        Some(k) => (cloud.ghosts[k].source as usize, Some(cloud.ghosts[k].transform)),
        None => (j as usize, None),
    }
}

/// Every pair sees one another, through images too, and no line of sight from a fluid particle meets a surface.
fn check_graph<const D: usize>(cloud: &Cloud<D>, surface: &Surface<D>) {
    for i in 0..cloud.n_rows() {
        for j in cloud.neighbours.of(i) {
            let (k, t) = source(cloud, *j);
            assert!(t.is_some() || k != i, "{i} sees itself");
            if k < cloud.n_rows() {
                let back = cloud.neighbours.of(k).iter().any(|b| {
                    let (s, back) = source(cloud, *b);
                    s == i
                        && match (t, back) {
                            (None, None) => true,
                            (Some(t), Some(b)) => cloud.transforms[b as usize].undoes(&cloud.transforms[t as usize]),
                            _ => false,
                        }
                });
                assert!(back, "{i} sees {k} by {t:?} but not the other way round");
            }
            if i < cloud.n_fluid && *j < cloud.n_fluid as u32 {
                assert!(!surface.crosses(&cloud.x[i], &cloud.x[*j as usize]));
            }
        }
    }
}

/// Linear fields have exact gradients, except in rows of first order.
fn check_gradients<const D: usize>(cloud: &Cloud<D>) {
    let operators = Operators::new(cloud);
    let mut gradient = vec![0.0; cloud.n_rows()];
    for k in 0..operators.parts.len() {
        for (e, [a_i, a_j]) in operators.weighed_edges(cloud, k) {
            let d = cloud.x[e.j()] - cloud.x[e.i()];
            gradient[e.i()] += a_i[0] * d[0];
            if e.both() {
                gradient[e.j()] -= a_j[0] * d[0];
            }
        }
    }
    for (i, g) in gradient.iter().enumerate().filter(|(i, _)| cloud.first_order.binary_search(&(*i as u32)).is_err()) {
        assert!((g - 1.0).abs() < 1e-9, "{i} at {:?}: {g}", cloud.x[i]);
    }
}

fn check<const D: usize>(text: &str) -> (Cloud<D>, Diagnosis) {
    let (cloud, surface) = cloud(text);
    check_graph(&cloud, &surface);
    check_gradients(&cloud);
    let diagnosis = Diagnosis::of(&cloud, 0);
    (cloud, diagnosis)
}

/// The worst value of a measure; zero is not listed.
fn worst(diagnosis: &Diagnosis, measure: &str) -> f64 {
    assert!(diagnosis.histograms.iter().any(|h| h.name == measure));
    diagnosis.worst.iter().find(|w| w.measure == measure).map_or(0.0, |w| w.value)
}

fn closure<const D: usize>(cloud: &Cloud<D>) -> f64 {
    cloud.interface.iter().fold(Vector::<D>::ZERO, |s, w| s + w.area).norm()
}

#[test]
fn plain_bodies_need_no_repair() {
    for body in [
        "[[body]]\ncircle = { radius = 0.5 }\n[cloud]\nspacing = 0.04",
        "[[body]]\nnaca = \"0012\"\n[cloud]\nspacing = 0.02",
        "[[body]]\npolygon = [[0, 0], [1, 0], [1, 0.004], [0, 0.004]]\n[cloud]\nspacing = 0.02",
        "[[body]]\npolygon = [[0, 0], [1, 0], [1, 0.3], [0.3, 0.3], [0.3, 1], [0, 1]]\n[cloud]\nspacing = 0.05",
    ] {
        let (cloud, diagnosis) = check::<2>(body);
        assert!(cloud.notes.is_empty() && cloud.first_order.is_empty(), "{:?}", cloud.notes);
        let (condition, empty) = (worst(&diagnosis, "condition number"), worst(&diagnosis, "empty sectors"));
        assert!(condition < 20.0 && empty <= 1.0, "{body}: {condition} {empty}");
        assert!(worst(&diagnosis, "one-sidedness") < 0.5 && worst(&diagnosis, "nearest neighbour") >= 0.3);
        assert!(closure(&cloud) < 1e-12);
    }
}

#[test]
fn a_sphere_and_a_box_need_no_repair() {
    for body in ["sphere = { radius = 0.5 }", "box = { size = [1, 0.6, 0.02] }"] {
        let cloud = check::<3>(&format!("[[body]]\n{body}\n[cloud]\nspacing = 0.12\nfar_field = 3\nedge_levels = 1"));
        assert!(cloud.0.notes.is_empty() && worst(&cloud.1, "condition number") < 20.0);
        assert!(closure(&cloud.0) < 1e-12);
    }
}

#[test]
fn planes_of_symmetry_cut_bodies() {
    let ends = "domain = { min = [-2.56, 0], max = [2.56, 2.56] }\n[boundary]\ny_min = \"symmetry\"";
    for body in ["circle = { radius = 0.5 }", "naca = \"0012\""] {
        let (cloud, diagnosis) = check::<2>(&format!("[[body]]\n{body}\n[cloud]\nspacing = 0.02\n{ends}"));
        assert!(cloud.x[..cloud.n_real()].iter().all(|x| x[1] > 0.0) && cloud.notes.is_empty());
        assert!(worst(&diagnosis, "condition number") < 10.0);
        let along: f64 = cloud.interface.iter().map(|w| w.area[0]).sum();
        assert!(along.abs() < 1e-12, "{along}");
    }
    let ends = "domain = { min = [-1.28, 0, -1.28], max = [1.28, 1.28, 1.28] }\n[boundary]\ny_min = \"symmetry\"";
    let (cloud, _) = check::<3>(&format!("[[body]]\nsphere = {{ radius = 0.5 }}\n[cloud]\nspacing = 0.08\n{ends}"));
    assert!(cloud.x[..cloud.n_real()].iter().all(|x| x[1] > 0.0) && cloud.notes.is_empty());
}

#[test]
fn a_body_beside_a_periodic_side_is_seen_from_the_other_one() {
    let sides = "x_min = \"periodic\"\nx_max = \"periodic\"\ny_min = \"periodic\"\ny_max = \"periodic\"";
    let domain = "domain = { min = [-1.28, -1.28], max = [1.28, 1.28] }";
    let body = "circle = { radius = 0.25 }\ntranslate = [1.02, 0]";
    let (cloud, _) = check::<2>(&format!("[[body]]\n{body}\n[cloud]\nspacing = 0.02\n{domain}\n[boundary]\n{sides}"));
    let left = (0..cloud.n_fluid).filter(|i| cloud.x[*i][0] < -1.25 && cloud.x[*i][1].abs() < 0.05);
    assert!(left.into_iter().all(|i| cloud.wall_distance[i] < 0.1));
}

#[test]
fn crevices_are_repaired_in_words() {
    let text = "[[body]]\ncircle = { radius = 0.5 }\n[[body]]\ncircle = { radius = 0.5 }\ntranslate = [1.004, 0]\n[cloud]\nspacing = 0.02";
    let (cloud, diagnosis) = check::<2>(text);
    assert!(cloud.notes.iter().any(|n| n.contains("first-order")) && diagnosis.repairs == cloud.notes);
    assert!(diagnosis.notes.iter().any(|n| n.contains("face another wall")), "{:?}", diagnosis.notes);
}

#[test]
fn crowded_particles_are_nudged_apart() {
    let (cloud, diagnosis) = check::<2>("[[body]]\ncircle = { radius = 0.5 }\n[cloud]\nspacing = 0.04\njitter = 0.45");
    assert!(cloud.notes.iter().any(|n| n.contains("moved away")), "{:?}", cloud.notes);
    assert!(worst(&diagnosis, "nearest neighbour") > 0.15);
}

#[test]
fn curvature_of_a_faceted_sphere_is_that_of_the_sphere() {
    let case = case("[[body]]\nsphere = { radius = 0.5 }\n[cloud]\nspacing = 0.06\nfar_field = 2");
    let mut shell: Shell<3> = icosphere(0.5, 4);
    shell.exact = crate::geometry::Exact::None;
    let surface = Surface::new(&[("ball".to_string(), shell)]);
    let cloud = Cloud::build(&CloudSpec::of_case(&case), Some(&surface), &[]).unwrap();
    let mut sum = 0.0;
    for (w, x) in cloud.interface.iter().zip(&cloud.x[cloud.n_fluid..]) {
        let n = x.unit();
        let exact = |r: usize, c: usize| (if r == c { 1.0 } else { 0.0 } - n[r] * n[c]) / 0.5;
        let worst = (0..9).map(|e| (w.curvature[e / 3][e % 3] - exact(e / 3, e % 3)).abs()).fold(0.0, f64::max);
        assert!(worst < 0.04 / 0.5, "{x:?}: {worst}");
        sum += worst * worst * 0.25;
    }
    assert!((sum / cloud.interface.len() as f64).sqrt() < 0.02);
}

#[test]
fn the_diagnosis_is_plain_json() {
    let (_, diagnosis) = check::<2>("[[body]]\ncircle = { radius = 0.5 }\n[cloud]\nspacing = 0.04");
    let json = serde_json::to_value(&diagnosis).unwrap();
    for key in ["particles", "interface", "neighbours", "histograms", "worst", "repairs", "notes"] {
        assert!(json.get(key).is_some(), "{key}");
    }
    let rows = diagnosis.histograms[0].counts.iter().sum::<usize>();
    assert_eq!(rows, json["particles"].as_u64().unwrap() as usize - 44);
    for h in &diagnosis.histograms {
        assert_eq!(h.edges.len(), h.counts.len() + 1);
    }
}

/// Why a cloud of a NACA 0012 is refused that may have `most` particles.
fn refused(cloud: &str, most: usize) -> String {
    let case = case(&format!("[[body]]\nnaca = \"0012\"\n[cloud]\n{cloud}"));
    let spec = CloudSpec { most, ..CloudSpec::of_case(&case) };
    Cloud::<2>::build(&spec, Some(&surface_of(&case)), &[]).map(|c| c.n_real()).unwrap_err().to_string()
}

#[test]
fn clouds_that_are_too_large_are_refused_before_they_are_built() {
    let many = refused("spacing = 1e-300\n", 1_000_000);
    assert!(many.contains("countless particles, but only 1000000 fit") && many.contains("(1e-300)"), "{many}");
    let layers = refused("spacing = 0.01\nlayers = 1000\n", 100_000);
    assert!(
        layers.contains("lower `cloud.layers` (1000.0)") || layers.contains("lower `cloud.layers` (1000)"),
        "{layers}"
    );
    let wake = refused("spacing = 0.01\nwake = { length = 40, spacing = 1e-4 }\n", 1_000_000);
    assert!(wake.contains("raise `cloud.wake.spacing` (0.0001)"), "{wake}");
    let scarce = refused("spacing = 0.0005\n", 500);
    assert!(scarce.contains("only 500 fit"), "{scarce}");
}

#[test]
fn spacings_below_the_deepest_cells_are_refused_not_coarsened() {
    let fine = refused("spacing = 0.03\nbox = [{ min = [2, 2], max = [2.0001, 2.0001], spacing = 1e-7 }]\n", 1_000_000);
    assert!(
        fine.contains("the spacing 1.000e-7 is too fine") && fine.contains("the finest possible spacing is"),
        "{fine}"
    );
}

#[test]
fn bodies_across_the_sides_of_the_domain_are_refused() {
    let at = |domain: &str| refused(&format!("spacing = 0.0625\ndomain = {{ {domain} }}\n"), usize::MAX);
    for domain in ["min = [2, 2], max = [4, 4]", "min = [0.5, -2], max = [4.5, 2]"] {
        assert!(at(domain).contains("lies across or beyond the side x = "), "{}", at(domain));
    }
}
