//! Cases and solvers that several tests share.
#![allow(dead_code, reason = "each test uses its own part")]
use std::path::Path;

use alula::case::{Case, read};
use alula::math::Vector;
use alula::math::dual::Dual;
use alula::math::reduce::norm;
use alula::physics::Primitive;
use alula::scheme::{FarField, Fluid};
use alula::system::{Instant, Name, Placed, System, placed};
use alula::time::ordinary::Ordinary;

/// Uniform stream on a jittered cloud with two levels, plane or solid.
pub(crate) fn two_levels(dimension: usize) -> String {
    let list = |v: f64| vec![v.to_string(); dimension].join(", ");
    let box_at = |low: f64, high: f64| format!("min = [{}]\nmax = [{}]", list(low), list(high));
    let spacing = if dimension == 2 { 0.0625 } else { 0.125 };
    let angles = if dimension == 2 { "alpha = \"7 deg\"" } else { "alpha = \"7 deg\"\nbeta = \"-4 deg\"" };
    format!(
        "title = \"two levels\"\ndimension = {dimension}\n[flow]\nmach = 0.6\n{angles}\n[cloud]\nspacing = {spacing}\n\
         jitter = 0.2\n[cloud.domain]\n{}\n[[cloud.box]]\n{}\nspacing = {}\n[time.explicit]\nuntil = 1.0\n",
        box_at(0.0, 1.0),
        box_at(0.25, 0.75),
        0.5 * spacing
    )
}

/// A circle or a sphere in a stream.
pub(crate) fn round_body(dimension: usize) -> String {
    let (body, spacing, reach) = if dimension == 2 { ("circle", 0.0625, 4.0) } else { ("sphere", 0.125, 1.0) };
    format!(
        "title = \"round\"\n[flow]\nmach = 0.3\n[[body]]\n{body} = {{ radius = 0.5 }}\n[cloud]\nspacing = {spacing}\n\
         curvature = 0.25\nfar_field = {reach}\n[scheme]\nlimiter = \"none\"\n"
    )
}

/// Isentropic vortex in a periodic square, carried along its diagonal.
pub(crate) fn vortex(spacing: f64, until: f64) -> String {
    format!(
        "title = \"vortex\"\ndimension = 2\n[flow]\nmach = 1.1952286093343936\nalpha = \"45 deg\"\n[cloud]\n\
         spacing = {spacing}\ndomain = {{ min = [0.0, 0.0], max = [10.0, 10.0] }}\n[boundary]\nx_min = \"periodic\"\n\
         x_max = \"periodic\"\ny_min = \"periodic\"\ny_max = \"periodic\"\n[initial.vortex]\nstrength = 5.0\n\
         centre = [5.0, 5.0]\nvelocity = [1.0, 1.0]\n[scheme]\nlimiter = \"none\"\nkappa = 0.3333333333333333\n\
         [time.explicit]\nuntil = {until}\ncfl = 0.5\n"
    )
}

/// x'' = f(x, x', t) as two equations of the first order, for x' and x.
pub(crate) fn oscillator(f: impl Fn(f64, f64, f64) -> f64 + Sync) -> Ordinary<impl Fn(f64, &[f64], &mut [f64]) + Sync> {
    Ordinary::new(2, 2.0, move |t, u, du| (du[0], du[1]) = (f(u[1], u[0], t), u[0]))
}

/// What a run refuses a case for; `check` refuses it in the same words.
pub(crate) fn refused(case: &Case) -> String {
    let folder = tempfile::tempdir().unwrap();
    let places = alula::run::Places { input: folder.path().to_path_buf(), out: folder.path().join("out") };
    let told = alula::run::run(case, &places, &mut alula::run::Silent).unwrap_err().to_string();
    let inspected = alula::run::inspect(case, folder.path(), None).err();
    let checked = alula::run::refusals(case, folder.path()).into_iter().chain(inspected);
    assert!(checked.map(|p| p.to_string()).any(|p| p == told), "`check` does not refuse: {told}");
    told
}

/// Reads a case.
pub(crate) fn case(text: &str) -> Case {
    read(text, "case.toml").unwrap_or_else(|e| panic!("{e}"))
}

/// The equations of a case and its state at the start.
pub(crate) fn solver<const D: usize>(text: &str) -> (Fluid<D>, Vec<f64>) {
    alula::run::build_solver(&case(text), Path::new("")).unwrap_or_else(|e| panic!("{e}"))
}

/// Runs `f` on a pool of `n` threads.
pub(crate) fn with_threads<T: Send>(n: usize, f: impl FnOnce() -> T + Send) -> T {
    rayon::ThreadPoolBuilder::new().num_threads(n).build().unwrap_or_else(|e| panic!("{e}")).install(f)
}

/// Largest absolute value; infinite when one is NaN.
pub(crate) fn largest(values: impl IntoIterator<Item = f64>) -> f64 {
    values.into_iter().fold(0.0, |m, v| if v.is_nan() { f64::INFINITY } else { m.max(v.abs()) })
}

/// A far field that the bodies do not change.
pub(crate) struct Uniform<const D: usize>(pub(crate) Primitive<D>);

impl<const D: usize> FarField<D> for Uniform<D> {
    fn state(&self, _: &Vector<D>, _: &Vector<D>) -> Primitive<D> {
        self.0
    }

    fn changing(&self, _: &Vector<D>, _: &Vector<D, Dual>) -> Primitive<D, Dual> {
        Primitive::constant(&self.0)
    }

    fn pressure(&self) -> f64 {
        self.0.pressure
    }
}

/// Errors of products with dR/dU, over the size of the product, field by field: against fourth-order differences of the residual with the
/// frame where `place` puts it. `v` is the direction, `u` the state.
pub(crate) fn product_errors<S: System>(
    system: &S,
    [u, v]: [&[f64]; 2],
    place: &dyn Fn(&[f64], &mut S::Frame),
) -> Vec<(Name, f64)> {
    // short, since upwind choices and limiters have kinks
    const STEP: f64 = 1e-7;
    let placed_by = |u: &[f64], frame: &mut S::Frame| place(&system.placing().values(u), frame);
    let mut frame = system.frame(&Instant::still(0.0).with(&system.placing().values(u)), u);
    placed_by(u, &mut frame);
    let (mut work, mut found) = (system.work(), vec![0.0; u.len()]);
    system.jvp_with_frame(&frame, place, [u, v], &mut work, &mut found);
    let mut exact = vec![0.0; u.len()];
    for (part, weight) in [(1.0, 8.0), (-1.0, -8.0), (2.0, -1.0), (-2.0, 1.0)] {
        let moved: Vec<f64> = u.iter().zip(v).map(|(u, v)| u + part * STEP * v).collect();
        let mut there = vec![0.0; u.len()];
        placed_by(&moved, &mut frame);
        system.rhs(&frame, &moved, &mut work, &mut there);
        exact.iter_mut().zip(&there).for_each(|(e, r)| *e += weight * r / (12.0 * STEP));
    }
    let error = |at: Placed| {
        let [found, exact] = [&found[at.unknowns.clone()], &exact[at.unknowns.clone()]];
        let wrong: Vec<f64> = found.iter().zip(exact).map(|(f, e)| f - e).collect();
        (at.field.name, norm(&wrong) / norm(exact).max(f64::MIN_POSITIVE))
    };
    placed(system.fields()).map(error).collect()
}

/// A direction that reaches every unknown of the state `u`.
pub(crate) fn direction(u: &[f64]) -> Vec<f64> {
    u.iter().enumerate().map(|(k, u)| (1.7 * k as f64).sin() * (0.1 + u.abs())).collect()
}
