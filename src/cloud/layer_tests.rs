//! Layers on bodies that break them: thin edges, corners, bends, other walls.
use super::conservative::conservative;
use super::{Cloud, Diagnosis, Operators};
use crate::geometry::load_surface;
use crate::math::Vector;
use crate::scheme::boundary::WallFits;

fn build(body: &str, rest: &str) -> Cloud<2> {
    let text = format!("title = \"t\"\n[flow]\nmach = 0.5\n[[body]]\n{body}\n[cloud]\nfar_field = 4\n{rest}");
    let case = crate::case::read(&text, "test").unwrap();
    let surface = load_surface(&case, std::path::Path::new(".")).unwrap().0;
    Cloud::build(&case, Some(&surface), &[]).unwrap()
}

const CIRCLE: &str = "circle = { radius = 0.5 }";
const NACA: &str = "naca = \"0012\"";
const PLATE: &str = "polygon = [[0, 0], [1, 0], [1, 0.004], [0, 0.004]]";
const SQUARE: &str = "polygon = [[0, 0], [1, 0], [1, 1], [0, 1]]";
const PLUS: &str = "polygon = [[1, 0], [2, 0], [2, 1], [3, 1], [3, 2], [2, 2], [2, 3], [1, 3], [1, 2], [0, 2], [0, 1], [1, 1]]\nscale = 0.4";

/// Largest relative error of the slopes of linear fields over all rows that are not of first order.
fn slope_error(cloud: &Cloud<2>, operators: &Operators<2>) -> f64 {
    let mut slope = vec![[Vector::<2>::ZERO; 2]; cloud.n_rows()];
    for k in 0..operators.parts.len() {
        for e in operators.edges(k) {
            let d = cloud.x[e.j()] - cloud.x[e.i()];
            for axis in 0..2 {
                slope[e.i()][axis] += e.a_i * d[axis];
                if e.both() {
                    slope[e.j()][axis] -= e.a_j * d[axis];
                }
            }
        }
    }
    let exact = |i: &usize| cloud.first_order.binary_search(&(*i as u32)).is_err();
    let error = |i: usize| (0..2).map(|a| (slope[i][a] - Vector::axis(a)).max_abs()).fold(0.0, f64::max);
    (0..cloud.n_rows()).filter(exact).map(error).fold(0.0, f64::max)
}

fn aspect(cloud: &Cloud<2>) -> f64 {
    let ratio = |i: usize| cloud.layers.slot(i).map_or(1.0, |(c, k)| cloud.spacing[i] / cloud.layers.thickness(c, k));
    (0..cloud.n_fluid).map(ratio).fold(0.0, f64::max)
}

#[test]
fn report() {
    for (name, body, spacing) in [
        ("circle", CIRCLE, 0.03),
        ("naca", NACA, 0.0078125),
        ("plate", PLATE, 0.02),
        ("square", SQUARE, 0.03),
        ("plus", PLUS, 0.03),
    ] {
        for ratio in [0.3, 0.1, 0.03, 0.005, 0.001] {
            let mut cloud =
                build(body, &format!("spacing = {spacing}\nwall_layers = {{ first = {} }}", ratio * spacing));
            let mut operators = Operators::new(&cloud);
            let error = slope_error(&cloud, &operators);
            let fits = WallFits::new(&cloud);
            let d = Diagnosis::of(&cloud, fits.n_linear);
            let worst = |m: &str| d.worst.iter().find(|w| w.measure == m).map_or(0.0, |w| w.value);
            let volume: f64 = cloud.volume[..cloud.n_fluid].iter().sum();
            let layered: usize = cloud.layers.columns.iter().map(|c| c.particles.len()).sum();
            let counts: Vec<usize> = cloud.layers.columns.iter().map(|c| c.particles.len()).collect();
            println!(
                "{name} {ratio}: n {} layered {layered} max K {} AR {:.0} error {error:.1e} cond {:.1} onesided {:.2} nearest {:.2} n {} linear {} volume {volume:.4} notes {:?} {:?}",
                cloud.n_fluid,
                counts.iter().max().unwrap(),
                aspect(&cloud),
                worst("condition number"),
                worst("one-sidedness"),
                worst("nearest neighbour"),
                worst("neighbours"),
                fits.n_linear,
                d.notes,
                d.repairs
            );
            println!("   {:?}", conservative(&mut cloud, &mut operators));
        }
    }
}
