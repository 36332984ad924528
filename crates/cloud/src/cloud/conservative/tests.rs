//! Tests of the search for conservative coefficients.
use super::*;
use crate::cloud::CloudSpec;
use crate::cloud::operators::Reverse;
use std::collections::HashMap;

fn cloud<const D: usize>(text: &str) -> Cloud<D> {
    let text = format!("title = \"x\"\ndimension = {D}\n[flow]\nmach = 0.5\n{text}");
    let case = crate::case::read(&text, "test").map_err(|e| e.render(false)).unwrap();
    let surface = (!case.bodies.is_empty())
        .then(|| crate::geometry::load_surface::<D>(&case.bodies, std::path::Path::new(".")).unwrap().0);
    Cloud::build(&CloudSpec::of_case(&case), surface.as_ref(), &[]).unwrap()
}

/// A shaken tube of two levels between planes of symmetry, or periodic.
fn tube(x_sides: &str, y_sides: &str, jitter: f64) -> Cloud<2> {
    cloud(&format!(
        "[cloud]\nspacing = 0.0625\ndomain = {{ min = [0.0, 0.0], max = [1.0, 0.5] }}\njitter = {jitter}\n\
         [[cloud.box]]\nmin = [0.0, 0.0]\nmax = [0.5, 0.5]\nspacing = 0.03125\n\
         [boundary]\nx_min = \"{x_sides}\"\nx_max = \"{x_sides}\"\ny_min = \"{y_sides}\"\ny_max = \"{y_sides}\"\n"
    ))
}

fn solve<const D: usize>(cloud: &mut Cloud<D>) -> (Operators<D>, ConservativeReport) {
    let mut operators = Operators::new(cloud);
    let report = conservative(cloud, &mut operators);
    (operators, report)
}

/// Area vectors by (first end, second end), images by their own indices.
fn areas<const D: usize>(cloud: &Cloud<D>, operators: &Operators<D>) -> HashMap<(usize, usize), Vector<D>> {
    let mut all = HashMap::new();
    for e in (0..operators.n_fluid_parts).flat_map(|k| operators.edges(k)) {
        assert!(e.i() < cloud.n_fluid);
        all.insert((e.i(), e.j()), e.s);
        if e.both() {
            all.insert((e.j(), e.i()), -e.s);
        }
    }
    all
}

#[test]
fn a_uniform_lattice_keeps_its_coefficients() {
    let text = "[cloud]\nspacing = 0.0625\ndomain = { min = [0.0, 0.0], max = [1.0, 0.5] }\n[boundary]\n\
                x_min = \"symmetry\"\nx_max = \"symmetry\"\ny_min = \"periodic\"\ny_max = \"periodic\"";
    let mut cloud = cloud::<2>(text);
    let before = areas(&cloud, &Operators::new(&cloud));
    let (operators, report) = solve(&mut cloud);
    assert!(report.closure_defect < 1e-14 && report.linear_error_max < 1e-12, "{report:?}");
    let after = areas(&cloud, &operators);
    assert!(before.iter().all(|(k, s)| (after[k] - *s).norm() < 1e-15));
}

#[test]
fn clouds_close_and_pairs_are_antisymmetric_through_images() {
    for (x, y) in [("symmetry", "periodic"), ("periodic", "periodic"), ("symmetry", "symmetry")] {
        let mut cloud = tube(x, y, 0.2);
        let (operators, report) = solve(&mut cloud);
        assert!(report.closure_defect < 1e-13 && report.linear_error_rms < 0.02, "{report:?}");
        assert!(report.min_volume_ratio > 0.5 && report.n_softened == 0, "{report:?}");
        let areas = areas(&cloud, &operators);
        let reverse = Reverse::new(&cloud);
        let mut rows = vec![Vector::ZERO; cloud.n_fluid];
        for ((i, j), s) in &areas {
            rows[*i] += *s;
            let (entry, transform) = reverse.position(*i, *j).unwrap();
            let back = cloud.neighbours.index[entry] as usize;
            let k = if *j < cloud.n_fluid { *j } else { cloud.ghosts[*j - cloud.n_real()].source as usize };
            let turned = match transform {
                Some(t) => cloud.transforms[t as usize].direction(&areas[&(k, back)]),
                None => areas[&(k, back)],
            };
            assert_eq!(*s, -turned, "{i} {j}");
        }
        assert!(rows.iter().all(|s| s.norm() < 1e-14));
    }
}

#[test]
fn volumes_fill_the_domain() {
    let mut cloud = tube("symmetry", "symmetry", 0.2);
    solve(&mut cloud);
    let total: f64 = cloud.volume[..cloud.n_fluid].iter().sum();
    // linear consistency is soft, and a common factor on all volumes and areas costs little
    assert!((total / 0.5 - 1.0).abs() < 0.04, "{total}");
}

#[test]
fn every_wall_is_shared_out_and_its_pressure_closes() {
    let mut cloud = cloud::<2>("[[body]]\ncircle = { radius = 0.5 }\n[cloud]\nspacing = 0.125\nfar_field = 4.0\n");
    let (operators, report) = solve(&mut cloud);
    assert!(report.closure_defect < 1e-13 && report.min_volume_ratio > SMALLEST_VOLUME, "{report:?}");
    let mut shared = vec![Vector::ZERO; cloud.interface.len()];
    for face in (0..operators.n_fluid_parts).flat_map(|k| operators.wall_faces(k)) {
        shared[face.wall as usize - cloud.n_fluid] += face.area;
    }
    assert!(shared.iter().zip(&cloud.interface).all(|(s, w)| (*s + w.area).norm() < 1e-13));
}

#[test]
fn spheres_cut_by_a_plane_of_symmetry_close() {
    let text = "[[body]]\nsphere = { radius = 0.5 }\n[cloud]\nspacing = 0.25\ncurvature = 0.25\n\
                domain = { min = [-1.0, -1.0, 0.0], max = [1.0, 1.0, 1.0] }\n\
                [boundary]\nz_min = \"symmetry\"\n";
    let mut cloud = cloud::<3>(text);
    let (_, report) = solve(&mut cloud);
    assert!(report.closure_defect < 1e-13 && report.min_volume_ratio > SMALLEST_VOLUME, "{report:?}");
}

#[test]
fn results_do_not_depend_on_the_number_of_threads() {
    let pool = |n| rayon::ThreadPoolBuilder::new().num_threads(n).build().unwrap();
    let run = || {
        let mut cloud = tube("symmetry", "periodic", 0.2);
        solve(&mut cloud);
        cloud.volume
    };
    let (one, three) = (pool(1).install(run), pool(3).install(run));
    assert!(one.iter().zip(&three).all(|(a, b)| a.to_bits() == b.to_bits()));
}
