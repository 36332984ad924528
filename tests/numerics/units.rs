//! One physical case, with numbers and with units: what the solver does is the same.
//!
//! In air whose density and sound speed are powers of two the numbers that reach the solver are the same to the last bit, and so is
//! what it does. Where round-off is left, differences of residuals in Newton's products make it some 1e-8 of the loads.

use alula::case::Case;
use alula::observe::structure::StructureTable;
use alula::run::{Monitor, Outcome, Places, Session, Silent, Summary, Tick, resume, run};

/// Air with ρ = 1/2 kg/m³ and a = 256 m/s.
const AIR: &str = "pressure = 23405.714285714286\ndensity = 0.5";
/// Sea level.
const SEA_LEVEL: &str = "pressure = 101325\ntemperature = 288.15";
/// Relative difference of runs with the same numbers.
const SAME: f64 = 1e-9;
/// The same where the last bits differ.
const NEARLY: f64 = 1e-6;

/// A small section.
const SECTION: &str =
    "[[body]]\nnaca = \"0012\"\n[cloud]\nspacing = 0.12\nfar_field = 4.0\nedge_levels = 0\n[output]\nreport = false\n";

/// What both ways of saying a case need of the stream.
struct Stream {
    air: &'static str,
    mach: f64,
    density: f64,
    sound: f64,
}

impl Stream {
    fn of(air: &'static str) -> Self {
        let text = format!("[flow]\nmach = 0.5\n{air}\n[[body]]\nnaca = \"0012\"\n[cloud]\nspacing = 0.1\n");
        let r = crate::common::case(&text).flow.reference();
        Self { air, mach: 0.5, density: r.density, sound: r.sound_speed }
    }

    /// Air in which all factors are powers of two.
    fn even() -> Self {
        let stream = Self::of(AIR);
        assert_eq!((stream.density, stream.sound), (0.5, 256.0));
        stream
    }

    /// `[flow]` by its Mach number, and by speed and air.
    fn tables(&self) -> [String; 2] {
        let Self { air, mach, sound, .. } = self;
        [format!("[flow]\nmach = {mach}\n"), format!("[flow]\nvelocity = {:?}\n{air}\n", mach * sound)]
    }

    /// A time of lengths over sound speed in seconds.
    fn seconds(&self, time: f64) -> f64 {
        time / self.sound
    }

    /// A force or a stiffness of ρ∞a∞² in N, N/m or N/m².
    fn force(&self, value: f64) -> f64 {
        value * self.density * self.sound * self.sound
    }
}

/// Keeps what is told of every iteration.
#[derive(Default)]
struct Ticks {
    loads: Vec<[f64; 3]>,
    times: Vec<f64>,
    notes: Vec<String>,
}

impl Monitor for Ticks {
    fn tick(&mut self, tick: &Tick) {
        self.loads.push(tick.loads.unwrap_or_default());
        self.times.extend(tick.march.map(|march| march.time));
    }
    fn note(&mut self, text: &str) {
        self.notes.push(text.to_owned());
    }
}

/// A run in memory.
struct Ran {
    summary: Summary,
    ticks: Ticks,
}

fn ran(case: &Case) -> Ran {
    let mut ticks = Ticks::default();
    let mut session = Session::open(case, ".").unwrap_or_else(|e| panic!("{e}"));
    match session.solve(&mut ticks).unwrap_or_else(|e| panic!("{e}")) {
        Outcome::Finished(summary) => Ran { summary: *summary, ticks },
        other => panic!("{other:?}"),
    }
}

/// A small section in both streams; `rest` is what follows `[flow]`, in numbers and in units.
fn both(stream: &Stream, rest: [&str; 2]) -> [Ran; 2] {
    let [plain, air] = stream.tables();
    [(plain, rest[0]), (air, rest[1])].map(|(flow, rest)| ran(&crate::common::case(&format!("{flow}{SECTION}{rest}"))))
}

/// Loads of every iteration are those of the other run.
fn same_loads([a, b]: &[Ran; 2], tolerance: f64) {
    assert_eq!(a.ticks.loads.len(), b.ticks.loads.len(), "{:?} {:?}", a.ticks.notes, b.ticks.notes);
    let size = crate::common::largest(a.ticks.loads.iter().flatten().copied());
    let apart = a.ticks.loads.iter().flatten().zip(b.ticks.loads.iter().flatten()).map(|(a, b)| a - b);
    let worst = crate::common::largest(apart);
    assert!(worst <= tolerance * size, "{worst:e} of {size:e}");
}

fn near(a: f64, b: f64) {
    assert!((a - b).abs() <= SAME * b.abs(), "{a:e} is not {b:e}");
}

#[test]
fn a_pitching_march_is_the_same_in_seconds() {
    let stream = Stream::even();
    let omega = 0.4;
    let motion = |speed: f64, step: f64| {
        format!(
            "pivot = [0.25, 0]\npitch = \"2 deg\"\ntranslation = [0, {speed:?}]\n\
             rotation = {:?}\nformula = {{ y = \"0.01 * sin(omega * t) + {:?} * t\" }}\n\
             [time.dual]\nstep = {step:?}\nuntil = {:?}\n",
            0.1 * speed,
            0.3 * speed,
            6.0 * step
        )
    };
    let shaken = |frequency: &str, rest: &str| format!("[motion]\nparticles = \"rigid\"\n{frequency}\n{rest}");
    let plain = shaken(&format!("reduced_frequency = {omega:?}\nreduced_length = 0.5"), &motion(0.01, 0.5));
    let air = shaken(
        &format!("frequency = \"{:?} rad/s\"", omega * stream.sound),
        &motion(0.01 * stream.sound, stream.seconds(0.5)),
    );
    let runs = both(&stream, [&plain, &air]);
    same_loads(&runs, SAME);
    let [a, b] = &runs;
    assert_eq!(a.summary.convergence.time, 3.0);
    near(b.summary.convergence.time, stream.seconds(3.0));
    near(*b.ticks.times.last().unwrap(), stream.seconds(3.0));
}

#[test]
fn tables_of_motion_and_periods_are_in_seconds() {
    let stream = Stream::even();
    let motion = |time: [f64; 5]| {
        format!(
            "[motion]\nparticles = \"rigid\"\n[motion.table]\ntime = {time:?}\ny = [0, 0.02, 0, -0.02, 0]\nperiodic = true\n\
             [time.dual]\nsteps_per_period = 12\nperiods = 3\n"
        )
    };
    let times = [0.0, 2.0, 4.0, 6.0, 8.0];
    let runs = both(&stream, [&motion(times), &motion(times.map(|t| stream.seconds(t)))]);
    same_loads(&runs, SAME);
    let [a, b] = &runs;
    near(b.summary.convergence.time, stream.seconds(a.summary.convergence.time));
    near(b.summary.periodic.periodic_change.unwrap().periods, 3.0);
    near(b.summary.periodic.last_period.unwrap().peak_cl, a.summary.periodic.last_period.unwrap().peak_cl);
}

#[test]
fn a_harmonic_balance_is_the_same_by_reduced_frequency_and_in_hertz() {
    let rest = |frequency: &str| {
        format!(
            "[motion]\nparticles = \"rigid\"\npivot = [0.25, 0]\npitch = \"1 deg\"\n{frequency}\n[time.harmonics]\nnumber = 1\n"
        )
    };
    // k = ω L/U
    let (k, length) = (0.2, 0.5);
    let by_number = rest(&format!("reduced_frequency = {k}\nreduced_length = {length}"));
    for (stream, tolerance) in [(Stream::even(), SAME), (Stream::of(SEA_LEVEL), NEARLY)] {
        let omega = k * stream.mach * stream.sound / length;
        let unit = if tolerance == SAME { ("rad/s", 1.0) } else { ("Hz", std::f64::consts::TAU) };
        let with_unit = rest(&format!("frequency = \"{:?} {}\"", omega / unit.1, unit.0));
        let runs = both(&stream, [&by_number, &with_unit]);
        same_loads(&runs, tolerance);
        let [x, y] = runs.map(|r| r.summary.periodic.first_harmonics[0].cl);
        assert!((x[0] - y[0]).hypot(x[1] - y[1]) < tolerance * x[0].hypot(x[1]), "{x:?} {y:?}");
    }
}

/// μ = 40, x_α = 0.2, r_α² = 0.3, ω_h/ω_α = 0.7, V* = 2, b = 0.5.
fn section(stream: &Stream) -> [String; 2] {
    let (b, mu, x_alpha, r2, ratio, v) = (0.5, 40.0, 0.2, 0.3, 0.7, 2.0);
    let mass = mu * std::f64::consts::PI * b * b;
    let omega = stream.mach / (v * b);
    let inertia = r2 * mass * b * b;
    let plain = format!(
        "[motion]\nparticles = \"rigid\"\n[structure]\nelastic_axis = -0.2\nsemichord = {b}\nmass_ratio = {mu}\nx_alpha = {x_alpha}\n\
         r_alpha2 = {r2}\nfrequency_ratio = {ratio}\nreduced_speed = {v}\ndamping_ratio = {{ pitch = 0.01 }}\n"
    );
    let (rho, a) = (stream.density, stream.sound);
    let air = format!(
        "[motion]\nparticles = \"rigid\"\n[structure]\nelastic_axis = -0.2\nsemichord = \"500 mm\"\nmass = \"{:?} kg/m\"\nx_alpha = {x_alpha}\n\
         inertia = \"{:?} kg m\"\nstiffness = {{ plunge = \"{:?} N/m2\" }}\nfrequency = {{ pitch = \"{:?} Hz\" }}\n\
         damping = {{ pitch = {:?} }}\n",
        rho * mass,
        rho * inertia,
        stream.force(mass * (ratio * omega).powi(2)),
        omega * a / std::f64::consts::TAU,
        rho * a * 2.0 * 0.01 * inertia * omega,
    );
    [plain, air]
}

#[test]
fn a_released_section_is_the_same_by_its_numbers_and_in_units() {
    let stream = Stream::even();
    let [numbers, units] = section(&stream);
    let step = 0.6;
    let tail = |rate: f64, step: f64| {
        let start = format!("initial = {{ pitch = \"1 deg\", plunge_rate = {rate:?} }}\n");
        format!("{start}[time.dual]\nstep = {step:?}\nuntil = {:?}\norders = 4\n", 60.0 * step)
    };
    let plain = format!("{numbers}{}", tail(0.002, step));
    let end = tail(0.002 * stream.sound, stream.seconds(step));
    for (air, tolerance) in [(format!("{numbers}{end}"), SAME), (format!("{units}{end}"), NEARLY)] {
        let runs = both(&stream, [&plain, &air]);
        same_loads(&runs, tolerance);
        let [a, b] = &runs.map(|r| r.summary.structures.structure[0].clone());
        for (a, b) in a.coordinates.iter().zip(&b.coordinates) {
            assert!((a.mean.unwrap() - b.mean.unwrap()).abs() < tolerance);
            let omega = a.frequency.unwrap();
            // a fit asks more of a tail than its loads
            let off = [
                b.frequency.unwrap() / stream.sound - omega,
                b.growth_rate.unwrap() / stream.sound - a.growth_rate.unwrap(),
            ];
            assert!(crate::common::largest(off) < 10.0 * tolerance * omega, "{a:?} {b:?}");
        }
        let work = b.energy_per_cycle.unwrap() / stream.force(a.energy_per_cycle.unwrap());
        assert!((work - 1.0).abs() < 100.0 * tolerance, "{a:?} {b:?}");
    }
}

#[test]
fn a_balance_of_a_shaken_section_has_its_frequency() {
    let stream = Stream::even();
    let [numbers, units] = section(&stream);
    let omega = 0.25;
    let plain = format!(
        "{numbers}force = {{ pitch = \"0.001 * cos(omega * t)\", reduced_frequency = {omega}, reduced_length = {} }}\n\
         [time.harmonics]\nnumber = 1\n",
        stream.mach
    );
    let air = format!(
        "{units}force = {{ pitch = \"{:?} * cos(omega * t)\", frequency = \"{:?} rad/s\" }}\n[time.harmonics]\nnumber = 1\n",
        stream.force(0.001),
        omega * stream.sound
    );
    let runs = both(&stream, [&plain, &air]);
    same_loads(&runs, NEARLY);
    let [a, b] = &runs.map(|r| r.summary.structures.structure[0].clone());
    for (a, b) in a.coordinates.iter().zip(&b.coordinates) {
        near(a.frequency.unwrap(), omega);
        near(b.frequency.unwrap(), omega * stream.sound);
        assert!(a.growth_rate == Some(0.0) && b.damping_ratio == Some(0.0) && a.amplitude.unwrap() > 1e-5, "{a:?}");
        assert!((b.amplitude.unwrap() / a.amplitude.unwrap() - 1.0).abs() < 1e-5, "{a:?} {b:?}");
    }
    let [x, y] = [b.energy_per_cycle.unwrap(), stream.force(a.energy_per_cycle.unwrap())];
    assert!((x / y - 1.0).abs() < 1e-4, "{x:e} {y:e}");
}

/// A section of 60 kg/m on springs of 200 kN/m² and 20 kN, shaken by 50 N m/m at 40 rad/s.
const SHAKEN: &str = "[motion]\nparticles = \"rigid\"\n[structure]\npivot = [0.3, 0]\nmass = \"60 kg/m\"\ninertia = \"8 kg m\"\n\
                      stiffness = { plunge = \"200 kN/m2\", pitch = \"20000 N/rad\" }\nforce = { pitch = \"50 * cos(omega * t)\", frequency = \"40 rad/s\" }\n\
                      [time.harmonics]\nnumber = 1\n";

#[test]
fn a_balance_writes_two_periods_of_its_structures_in_units_of_the_case() {
    let root = tempfile::tempdir().unwrap();
    let places = Places { input: root.path().to_path_buf(), out: root.path().join("out") };
    let [_, flow] = Stream::of(SEA_LEVEL).tables();
    let text = format!("{flow}{SECTION}{SHAKEN}").replace("report = false", "report = true");
    let Outcome::Finished(summary) = run(&crate::common::case(&text), &places, &mut Silent).unwrap() else { panic!() };
    let table = StructureTable::read(&places.out.join("structure.csv")).unwrap().unwrap();
    let (omega, period) = (40.0, std::f64::consts::TAU / 40.0);
    assert!(table.len() == 257 && table.marches(), "{}", table.len());
    near(*table.time.last().unwrap(), 2.0 * period);
    let [h, a] = &table.coordinates[..] else { panic!("{table:?}") };
    let strongest = crate::common::largest(table.gas_power.iter().copied());
    for k in 0..table.len() {
        let springs = 0.5 * (2e5 * h.values[k].powi(2) + 2e4 * a.values[k].powi(2));
        assert!((table.potential[k] - springs).abs() < 1e-10, "{} {springs}", table.potential[k]);
        let power = h.loads[k] * h.rates[k] + a.loads[k] * a.rates[k];
        // rates and differences of coordinates, which the power goes by, meet as far as the balance is solved
        assert!((table.gas_power[k] - power).abs() < 1e-5 * strongest, "{} {power}", table.gas_power[k]);
    }
    let structure = &summary.structures.structure[0];
    for (c, column) in structure.coordinates.iter().zip([h, a]) {
        near(c.frequency.unwrap(), omega);
        // the rate of one harmonic
        let rate = crate::common::largest(column.rates.iter().copied()) / omega;
        assert!((c.amplitude.unwrap() / rate - 1.0).abs() < 2e-3, "{c:?} {rate}");
    }
    let (middle, end) = (table.gas_work[128], table.gas_work[256]);
    let cycle = structure.energy_per_cycle.unwrap();
    assert!((cycle - (end - middle)).abs() < 1e-5 * cycle.abs(), "{cycle:e} {:e}", end - middle);
    let json = std::fs::read_to_string(places.out.join("summary.json")).unwrap();
    assert!(json.contains("\"energy_per_cycle\""), "{json}");
    let page = std::fs::read_to_string(places.out.join("report.html")).unwrap();
    if let Some(to) = std::env::var_os("ALULA_PICTURES") {
        std::fs::write(std::path::Path::new(&to).join("balance.html"), &page).unwrap();
    }
    for part in [
        "Phase plane of plunge",
        "pitch (degrees)",
        "40.000",
        "SI units, times in s",
        "that of the harmonic balance",
        "Work of the gas over the last cycle",
    ] {
        assert!(page.contains(part), "{part}");
    }
}

/// Stops after a number of iterations.
struct After(u64, u64);
impl Monitor for After {
    fn tick(&mut self, _: &Tick) {
        self.1 += 1;
    }
    fn note(&mut self, _: &str) {}
    fn stop(&self) -> bool {
        self.1 >= self.0
    }
}

#[test]
fn interrupted_runs_in_seconds_go_on_to_the_same_tables() {
    let [_, flow] = Stream::of(SEA_LEVEL).tables();
    let march = SHAKEN.replace("[time.harmonics]\nnumber = 1", "[time.dual]\nsteps_per_period = 16\nperiods = 1");
    for (text, stop) in [(march.as_str(), 24), (SHAKEN, 14)] {
        let case = crate::common::case(&format!("{flow}{SECTION}{text}"));
        let root = tempfile::tempdir().unwrap();
        let places = |name: &str| Places { input: root.path().to_path_buf(), out: root.path().join(name) };
        let (whole, cut) = (places("whole"), places("cut"));
        let Outcome::Finished(one) = run(&case, &whole, &mut Silent).unwrap() else { panic!() };
        assert!(matches!(run(&case, &cut, &mut After(stop, 0)).unwrap(), Outcome::Interrupted { .. }));
        let Outcome::Finished(other) = resume(&cut.out, &mut Silent).unwrap() else { panic!() };
        let table = |at: &Places| std::fs::read_to_string(at.out.join("structure.csv")).unwrap();
        assert!(
            table(&whole) == table(&cut)
                && one.structures.structure == other.structures.structure
                && one.convergence.time == other.convergence.time
        );
        // once more from the end, as if the last files had not been written
        std::fs::remove_file(cut.out.join("finished.txt")).unwrap();
        let Outcome::Finished(again) = resume(&cut.out, &mut Silent).unwrap() else { panic!() };
        assert!(table(&whole) == table(&cut) && one.structures.structure == again.structures.structure);
    }
}

#[test]
fn tables_of_a_march_are_in_seconds() {
    let root = tempfile::tempdir().unwrap();
    let places = Places { input: root.path().to_path_buf(), out: root.path().join("out") };
    let [_, flow] = Stream::even().tables();
    let motion = "[motion]\nparticles = \"rigid\"\nperiod = \"20 ms\"\nplunge = 0.01\n[time.dual]\nsteps_per_period = 24\nperiods = 2\n\
                  [output]\nfield_interval = \"10 ms\"\nreport = false\n";
    let text = format!("{flow}{SECTION}{motion}").replacen("[output]\nreport = false\n", "", 1);
    run(&crate::common::case(&text), &places, &mut Silent).unwrap();
    let file = |name: &str| std::fs::read_to_string(places.out.join(name)).unwrap();
    let history = file("history.csv");
    let time: f64 = history.lines().last().unwrap().split(',').nth(2).unwrap().parse().unwrap();
    near(time, 0.04);
    let moments = file("momentum.csv");
    let time: f64 = moments.lines().nth(1).unwrap().split(',').nth(1).unwrap().parse().unwrap();
    near(time, 0.02 / 12.0);
    let harmonics: serde_json::Value = serde_json::from_str(&file("harmonics.json")).unwrap();
    assert!((harmonics["period"].as_f64().unwrap() - 0.02).abs() < 1e-12, "{harmonics}");
    let series = file("series.pvd");
    assert_eq!(series.matches("<DataSet").count(), 4, "{series}");
    assert!(series.contains("field-00004.vtu"), "{series}");
}

#[test]
fn an_explicit_run_ends_after_as_many_seconds() {
    let stream = Stream::even();
    let explicit = |until: f64| format!("[time.explicit]\nuntil = {until:?}\n");
    let runs = both(&stream, [&explicit(0.4), &explicit(stream.seconds(0.4))]);
    same_loads(&runs, SAME);
    near(runs[1].summary.convergence.time, stream.seconds(0.4));
    near(runs[1].summary.loads.total.cd, runs[0].summary.loads.total.cd);
}

#[test]
fn a_shock_tube_in_pascals_has_the_error_of_that_in_numbers() {
    let stream = Stream::even();
    let tube = |flow: &str, states: [[f64; 3]; 2], until: f64| {
        ran(&crate::common::case(&format!(
            "dimension = 2\n[flow]\n{flow}\n[cloud]\nspacing = 0.02\ndomain = {{ min = [0, 0], max = [1, 0.1] }}\n[boundary]\n\
             x_min = \"held\"\nx_max = \"held\"\ny_min = \"periodic\"\ny_max = \"periodic\"\n[initial.riemann]\nleft = {:?}\n\
             right = {:?}\nposition = 0.5\n[time.explicit]\nuntil = {until:?}\n[output]\nreport = false\n",
            states[0], states[1]
        )))
    };
    let states = [[1.0, 0.1, 0.8], [0.5, 0.0, 0.4]];
    let si = states.map(|[d, v, p]| [d * stream.density, v * stream.sound, stream.force(p)]);
    let [a, b] = [tube("gamma = 1.4", states, 0.2), tube(AIR, si, stream.seconds(0.2))];
    let [a, b] = [a, b].map(|r| r.summary.convergence.error_l2_density.unwrap());
    assert!(a > 1e-4 && (a / b - 1.0).abs() < 1e-8, "{a:e} {b:e}");
}
