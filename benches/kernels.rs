//! Speed of the kernels in particles a second (`item/s` in the table).
//!
//!     cargo bench -p alula
//!     cargo bench -p alula -- residual
//!
//! What is measured with a number of threads runs once on one and once on two of them: the rates give the speed-up. All else
//! uses as many as the machine has, or `RAYON_NUM_THREADS`. Last come the bytes that a particle takes while it marches in time,
//! and [`ratios`] of times.
#![allow(clippy::unwrap_used, reason = "it may stop anywhere")]
mod ratios;
mod solids;

use std::path::Path;

use alula::case::{Case, read};
use alula::cloud::conservative::conservative;
use alula::cloud::{Cloud, CloudSpec, Operators};
use alula::geometry::load_surface;
use alula::math::Vector;
use alula::math::parallel::{sweep, sweep_each};
use alula::physics::Primitive;
use alula::scheme::{Fluid, RemapLedger};
use alula::system::{Hierarchy, Implicit, Instant, Preconditioner, Reach, RightHandSide, Shift, System};
use alula::time::control::Control;
use alula::time::explicit::{self, Explicit};
use alula::time::relax::Relax;
use alula::time::{Integrator, Past};
use divan::counter::ItemsCount;
use divan::{Bencher, black_box};
use multiversion::multiversion;

/// Threads in the measurements that compare them.
const THREADS: [usize; 2] = [1, 2];

/// A sphere.
const SPHERE: &str = "title = \"bench\"\n[flow]\nmach = 0.3\n[[body]]\nsphere = { radius = 0.5 }\n\
                      [cloud]\nspacing = 0.025\nfar_field = 10.0\nlayers = 12.0\n[time.steady]\norders = 6\n";

fn main() {
    divan::main();
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    if arguments.iter().all(|a| a != "--list" && a != "--test") {
        print_bytes::<2>();
        print_bytes::<3>();
        let filters: Vec<String> = arguments.into_iter().filter(|a| !a.starts_with('-')).collect();
        ratios::run(&filters);
    }
}

/// Prints the bytes per particle of the edges and of all that an explicit march holds.
#[allow(clippy::print_stdout, reason = "a benchmark prints")]
fn print_bytes<const D: usize>() {
    let cloud = Cloud::<D>::build(&CloudSpec::of_case(&case::<D>()), None, &[]).unwrap();
    let operators = Operators::new(&cloud);
    let n = cloud.n_fluid as f64;
    let points = cloud.len() * (size_of::<Vector<D>>() + 2 * size_of::<f64>());
    let rows = 4 * (cloud.neighbours.first.len() + cloud.neighbours.index.len());
    // state, start and rate of change; state and gradients of the primitive variables; signal speed
    let march = 8 * cloud.len() * (3 * (D + 2) + (D + 2) * (1 + D) + 1);
    let all = points + rows + operators.bytes() + march;
    println!(
        "{D}-D bytes per particle: edges {:.0}, explicit march {:.0}",
        operators.bytes() as f64 / n,
        all as f64 / n
    );
}

/// A pool of this many threads.
fn pool(threads: usize) -> rayon::ThreadPool {
    rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap()
}

/// A square or a cube filled with displaced particles on two levels: about 52,000 in 2-D, 78,000 in 3-D.
fn case<const D: usize>() -> Case {
    let (spacing, half) = if D == 2 { (0.0078125, "0.25, 0.0") } else { (0.03125, "0.75, 0.0, 0.0") };
    let list = |v: f64| vec![v.to_string(); D].join(", ");
    let text = format!(
        "title = \"bench\"\ndimension = {D}\n[flow]\nmach = 0.6\nalpha = \"3 deg\"\n[cloud]\nspacing = {spacing}\n\
         jitter = 0.1\n[cloud.domain]\nmin = [{}]\nmax = [{}]\n[[cloud.box]]\nmin = [{half}]\nmax = [{}]\n\
         spacing = {}\n[time.steady]\norders = 6\n",
        list(0.0),
        list(1.0),
        list(1.0),
        0.5 * spacing
    );
    read(&text, "bench.toml").unwrap_or_else(|e| panic!("{e}"))
}

/// The equations with a state that is smooth but nowhere uniform, so that the limiter has work.
fn solver<const D: usize>() -> (Fluid<D>, Vec<f64>) {
    let (fluid, mut u) = alula::run::build_solver::<D>(&case::<D>(), Path::new("")).unwrap();
    for (x, row) in fluid.discretisation.cloud.x.iter().zip(u.chunks_exact_mut(D + 2)) {
        let wave = (7.0 * x[0] + 5.0 * x[1]).sin();
        let velocity = Vector::<D>::from_fn(|d| if d == 0 { 0.6 + 0.1 * wave } else { 0.05 * wave });
        let q = Primitive { density: 1.0 + 0.1 * wave, velocity, pressure: (1.0 - 0.1 * wave) / 1.4 };
        fluid.gas.conserved(&q).store(row);
    }
    (fluid, u)
}

/// Fluxes with reconstruction and limiter: R(u).
#[divan::bench(consts = [2, 3], args = THREADS)]
fn residual<const D: usize>(bencher: Bencher<'_, '_>, threads: usize) {
    let (fluid, u) = solver::<D>();
    let pool = pool(threads);
    let (frame, mut work, mut du) = (fluid.frame(&Instant::still(0.0), &u), fluid.work(), vec![0.0; u.len()]);
    bencher
        .counter(ItemsCount::new(fluid.discretisation.cloud.n_fluid))
        .bench_local(|| pool.install(|| fluid.rhs(black_box(&frame), black_box(&u), &mut work, &mut du)));
}

/// Bandwidth: a = b + s c on arrays far beyond the caches. An item is a number, for which 24 bytes pass (32 where what is written is
/// read before).
#[divan::bench(args = THREADS, sample_count = 10)]
fn triad(bencher: Bencher<'_, '_>, threads: usize) {
    const N: usize = 1 << 25;
    let (mut a, b, c) = (vec![0.0f64; N], vec![1.0f64; N], vec![2.0f64; N]);
    let pool = pool(threads);
    bencher
        .counter(ItemsCount::new(N))
        .bench_local(|| pool.install(|| sweep(black_box(&mut a), |i| b[i] + 3.0 * c[i])));
}

/// Products and sums one after the other in registers, in double precision: the most that kernels without fused operations can reach.
/// An item is one of either.
#[divan::bench(args = THREADS, sample_count = 10)]
fn arithmetic(bencher: Bencher<'_, '_>, threads: usize) {
    const ROUNDS: usize = 1 << 16;
    const TASKS: usize = 64;
    let (mut sums, pool) = (vec![0.0; TASKS], pool(threads));
    bencher
        .counter(ItemsCount::new(2 * CHAINS * ROUNDS * TASKS))
        .bench_local(|| pool.install(|| sweep_each(black_box(&mut sums), |i| chains(1.0 + 1e-9 * i as f64, ROUNDS))));
}

/// Numbers that are worked on at once: enough to hide how long an operation takes.
const CHAINS: usize = 128;

#[multiversion(targets("x86_64+avx512f+avx512vl+avx512dq", "x86_64+avx2"))]
#[allow(unsafe_code, reason = "the attribute calls the version that the processor has just been asked for")]
fn chains(factor: f64, rounds: usize) -> f64 {
    let mut x = [1.0; CHAINS];
    for _ in 0..rounds {
        for x in &mut x {
            *x = *x * factor + 1e-9;
        }
    }
    x.iter().sum()
}

/// An empty preconditioner as Newton's method has it.
fn empty_preconditioner<const D: usize>(fluid: &Fluid<D>) -> <Fluid<D> as Implicit>::Preconditioner {
    let control = Control::newton(D);
    fluid.preconditioner(&Hierarchy { group: control.group, cycle: control.cycle }, None)
}

/// Blocks of −∂R/∂U on the finest level and all coarser ones.
#[divan::bench(consts = [2, 3], args = THREADS, sample_count = 10)]
fn linearisation<const D: usize>(bencher: Bencher<'_, '_>, threads: usize) {
    let (fluid, u) = solver::<D>();
    let (frame, mut work, pool) = (fluid.frame(&Instant::still(0.0), &u), fluid.work(), pool(threads));
    fluid.fill_states(&frame, &u, &mut work);
    let mut preconditioner = empty_preconditioner(&fluid);
    bencher.counter(ItemsCount::new(fluid.discretisation.cloud.n_fluid)).bench_local(|| {
        pool.install(|| {
            Preconditioner::<Fluid<D>>::begin(&mut preconditioner, 1);
            preconditioner.add(&fluid, black_box(&frame), &u, &mut work);
        });
    });
}

/// One application of the preconditioner: sweeps on all levels.
#[divan::bench(consts = [2, 3], args = THREADS, sample_count = 10)]
fn cycle<const D: usize>(bencher: Bencher<'_, '_>, threads: usize) {
    let (fluid, u) = solver::<D>();
    let (frame, mut work, pool) = (fluid.frame(&Instant::still(0.0), &u), fluid.work(), pool(threads));
    fluid.fill_states(&frame, &u, &mut work);
    let n = fluid.discretisation.cloud.n_fluid;
    let (mut preconditioner, shift) = (empty_preconditioner(&fluid), vec![1.0; n]);
    preconditioner.update(
        &fluid,
        (&frame, &u),
        &mut work,
        &Shift { rates: &shift, cfl: 1.0, coefficient: 0.0, reach: Reach::Far },
    );
    let mut z = vec![0.0; u.len()];
    bencher.counter(ItemsCount::new(n)).bench_local(|| {
        let r = RightHandSide::Plain(black_box(&u));
        pool.install(|| preconditioner.apply(&fluid, &[&frame], &r, &mut z));
    });
}

/// Conservative coefficients of the cloud around a sphere.
#[divan::bench(args = THREADS, sample_count = 3, sample_size = 1)]
fn coefficients(bencher: Bencher<'_, '_>, threads: usize) {
    let case = read(SPHERE, "bench.toml").unwrap_or_else(|e| panic!("{e}"));
    let surface = load_surface::<3>(&case.bodies, Path::new("")).unwrap().0;
    let cloud = Cloud::<3>::build(&CloudSpec::of_case(&case), Some(&surface), &[]).unwrap();
    let pool = pool(threads);
    let start = || (cloud.clone(), Operators::new(&cloud));
    bencher
        .with_inputs(start)
        .counter(ItemsCount::new(cloud.n_fluid))
        .bench_local_values(|(mut cloud, mut operators)| pool.install(|| conservative(&mut cloud, &mut operators)));
}

/// Gradients of all primitive variables.
#[divan::bench(consts = [2, 3])]
fn gradient<const D: usize>(bencher: Bencher<'_, '_>) {
    let (fluid, u) = solver::<D>();
    let mut work = fluid.work();
    let frame = fluid.frame(&Instant::still(0.0), &u);
    fluid.fill_states(&frame, &u, &mut work);
    bencher
        .counter(ItemsCount::new(fluid.discretisation.cloud.n_fluid))
        .bench_local(|| fluid.fill_gradients(&frame, &mut work));
}

/// From the case to particles with neighbours.
#[divan::bench(consts = [2, 3], args = THREADS, sample_count = 10)]
fn cloud<const D: usize>(bencher: Bencher<'_, '_>, threads: usize) {
    let (case, pool) = (case::<D>(), pool(threads));
    let spec = CloudSpec::of_case(&case);
    let n = Cloud::<D>::build(&spec, None, &[]).unwrap().n_fluid;
    let build = || Cloud::<D>::build(black_box(&spec), None, &[]).unwrap();
    bencher.counter(ItemsCount::new(n)).bench_local(|| pool.install(build));
}

/// The same around a sphere: interface particles, lines of sight, balls near the wall.
#[divan::bench(args = THREADS, sample_count = 5)]
fn cloud_around_sphere(bencher: Bencher<'_, '_>, threads: usize) {
    let case = read(SPHERE, "bench.toml").unwrap_or_else(|e| panic!("{e}"));
    let surface = load_surface::<3>(&case.bodies, Path::new("")).unwrap().0;
    let spec = CloudSpec::of_case(&case);
    let build = || Cloud::<3>::build(black_box(&spec), Some(&surface), &[]).unwrap();
    let pool = pool(threads);
    bencher.counter(ItemsCount::new(build().n_fluid)).bench_local(|| pool.install(build));
}

/// Least-squares weights and edges.
#[divan::bench(consts = [2, 3], args = THREADS, sample_count = 20)]
fn weights<const D: usize>(bencher: Bencher<'_, '_>, threads: usize) {
    let cloud = Cloud::<D>::build(&CloudSpec::of_case(&case::<D>()), None, &[]).unwrap();
    let pool = pool(threads);
    bencher.counter(ItemsCount::new(cloud.n_fluid)).bench_local(|| pool.install(|| Operators::new(black_box(&cloud))));
}

/// The same case with particles that travel, after one step.
fn travelling<const D: usize>() -> (Fluid<D>, Vec<f64>) {
    let mut case = case::<D>();
    let motion = "title = \"x\"\ndimension = 2\n[flow]\nmach = 0.5\n[motion]\nparticles = \"lagrangian\"\n[cloud]\n\
                  spacing = 1.0\ndomain = { min = [0, 0], max = [4, 4] }\n[time.explicit]\nuntil = 1.0\n";
    let other = read(motion, "bench.toml").unwrap_or_else(|e| panic!("{e}"));
    (case.motion, case.time) = (other.motion, other.time);
    let (fluid, _) = alula::run::build_solver::<D>(&case, Path::new("")).unwrap();
    (fluid, solver::<D>().1)
}

/// A cloud of travelling particles built anew: who comes and goes, neighbours, weights, transfer.
#[divan::bench(consts = [2, 3], args = THREADS, sample_count = 10)]
fn re_clouding<const D: usize>(bencher: Bencher<'_, '_>, threads: usize) {
    let (fluid, u) = travelling::<D>();
    let (pool, frame, mut work) = (pool(threads), fluid.frame(&Instant::still(0.0), &u), fluid.work());
    let mut ledger = RemapLedger::default();
    bencher.counter(ItemsCount::new(fluid.discretisation.cloud.n_fluid)).bench_local(|| {
        pool.install(|| fluid.reclouded(black_box(&frame), (&u, [&[], &[]]), &mut work, &mut ledger)).is_ok()
    });
}

/// A whole step of three stages on particles that travel, without building the cloud anew.
#[divan::bench(consts = [2, 3], args = THREADS, sample_count = 10, sample_size = 1)]
fn travelling_step<const D: usize>(bencher: Bencher<'_, '_>, threads: usize) {
    let (fluid, u) = travelling::<D>();
    let pool = pool(threads);
    let mut march = Explicit::new(
        &fluid,
        explicit::Plan { method: explicit::Method::Ssprk3, cfl: 0.1, until: 1e9 },
        Past::default(),
        u,
    );
    bencher
        .counter(ItemsCount::new(fluid.discretisation.cloud.n_fluid))
        .bench_local(|| pool.install(|| march.advance()).is_ok());
}

/// Weights of a cloud fitted anew on the same lists.
#[divan::bench(consts = [2, 3], args = THREADS, sample_count = 20)]
fn weights_anew<const D: usize>(bencher: Bencher<'_, '_>, threads: usize) {
    let (fluid, _) = travelling::<D>();
    let (pool, mut operators) = (pool(threads), fluid.discretisation.operators.clone());
    let cloud = &fluid.discretisation.cloud;
    bencher.counter(ItemsCount::new(cloud.n_fluid)).bench_local(|| pool.install(|| operators.refit(black_box(cloud))));
}

/// One Newton step: linearisation, preconditioner, GMRES, line search.
#[divan::bench(consts = [2, 3], sample_count = 5, sample_size = 1)]
fn implicit_step<const D: usize>(bencher: Bencher<'_, '_>) {
    let (fluid, u) = solver::<D>();
    let origin = fluid.discretisation.cloud.x[..fluid.discretisation.cloud.n_fluid]
        .iter()
        .flat_map(|_| u[..D + 2].to_vec())
        .collect::<Vec<_>>();
    let control = Control { cfl: 20.0, ..Control::newton(D) };
    let start = || {
        let mut resume = Relax::new(&fluid, control, u.clone(), &origin, None).resume();
        resume.phase.newton = true;
        Relax::new(&fluid, control, u.clone(), &origin, Some(resume))
    };
    let counter = ItemsCount::new(fluid.discretisation.cloud.n_fluid);
    bencher.with_inputs(start).counter(counter).bench_local_values(|mut relax| relax.advance().map(|s| s.linear));
}
