//! Laws of motion against formulas worked out by hand.
use std::f64::consts::{FRAC_PI_2, PI, TAU};

use super::*;
use crate::case::read;
use crate::math::Vector;

const CLOUD: &str = "[cloud]\nspacing = 0.1\n[time.explicit]\nuntil = 1\n";

fn no_file(name: &str) -> std::io::Result<String> {
    Err(std::io::Error::new(std::io::ErrorKind::NotFound, name))
}

fn motions<const D: usize>(shape: &str, motion: &str) -> Motions<D> {
    let text = format!("[flow]\nmach = 0.5\n[[body]]\n{shape}\n{CLOUD}[motion]\n{motion}\n");
    let case = read(&text, "case.toml").unwrap_or_else(|e| panic!("{e}"));
    Motions::of_case(&case, 1.0, &no_file).unwrap_or_else(|e| panic!("{e}"))
}

fn plane(motion: &str) -> Motions<2> {
    motions("naca = \"0012\"", motion)
}

fn assert_near<const D: usize>(a: Vector<D>, b: [f64; D], tolerance: f64) {
    assert!((a - Vector(b)).norm() <= tolerance, "{a:?} is not {b:?}");
}

#[test]
fn positive_pitch_lifts_the_nose() {
    let m = plane("period = 4\npivot = [0.25, 0]\npitch = \"90 deg\"");
    let pose = m.of(0).pose(1.0);
    // a quarter period: the section stands on its tail
    assert_near(pose.point(&Vector([0.0, 0.0])), [0.25, 0.25], 1e-15);
    assert_near(pose.point(&Vector([1.0, 0.0])), [0.25, -0.75], 1e-15);
    assert_near(pose.direction(&Vector([-1.0, 0.0])), [0.0, 1.0], 1e-15);
    assert!((m.of(0).angle(1.0).value - FRAC_PI_2).abs() < 1e-15 && m.of(0).angle(1.0).first.abs() < 1e-15);
    // in space: nose up about +y, the nose moves along +z
    let m: Motions<3> = motions("sphere = { radius = 1 }", "period = 4\npivot = [0, 5, 0]\npitch = \"90 deg\"");
    assert_near(m.of(0).pose(1.0).point(&Vector([-1.0, 7.0, 0.0])), [0.0, 7.0, 1.0], 1e-15);
}

#[test]
fn the_sign_of_pitch_is_that_of_the_placement_and_of_the_moment() {
    // `rotate` of a body is nose up positive as well: the same point by both
    let m = plane("period = 4\npivot = [0, 0]\npitch = \"10 deg\"");
    let a = 10f64.to_radians();
    assert_near(m.of(0).pose(1.0).point(&Vector([1.0, 0.0])), [a.cos(), -a.sin()], 1e-15);
}

#[test]
fn plunge_is_up_positive_and_parts_add_up() {
    let m = plane(
        "reduced_frequency = 0.5\npivot = [0.25, 0]\npitch = \"2 deg\"\nplunge = { amplitude = 0.1, phase = \"90 deg\" }",
    );
    // k = ω (c/2)/U: ω = 0.5·0.5/0.5
    let omega = 0.5;
    assert!((m.period().unwrap() - TAU / omega).abs() < 1e-12);
    for t in [0.0, 0.3, 7.7] {
        let a = 2f64.to_radians() * (omega * t).sin();
        let h = 0.1 * (omega * t + FRAC_PI_2).sin();
        let x = m.of(0).pose(t).point(&Vector([1.25, 0.0]));
        assert_near(x, [0.25 + a.cos(), h - a.sin()], 1e-15);
        assert_near(m.of(0).displacement(t), [0.0, h], 1e-15);
    }
    let m = plane("period = 1\nplunge = { amplitude = 0.1, direction = [3, 4] }");
    assert_near(m.of(0).pose(0.25).shift, [0.06, 0.08], 1e-15);
    let m: Motions<3> = motions("sphere = { radius = 1 }", "period = 1\nplunge = 0.1");
    assert_near(m.of(0).pose(0.25).shift, [0.0, 0.0, 0.1], 1e-15);
}

#[test]
fn velocities_are_derivatives_of_positions() {
    let m: Motions<3> = motions(
        "sphere = { radius = 1 }",
        "period = 3\npivot = [0.1, -0.2, 0.3]\naxis = [1, 2, -1]\npitch = { amplitude = \"50 deg\", phase = \"20 deg\" }\n\
         plunge = 0.4\nrotation = 0.7\ntranslation = [0.1, 0.2, 0.3]\n\
         formula = { x = \"exp(-t) * sin(omega * t)\", angle = \"0.1 * t^2\" }\n\
         table = { time = [0, 1, 3], y = [0, 1, 0.5], angle = [0, \"5 deg\", 0] }",
    );
    let (law, x, h) = (m.of(0), Vector([1.0, 0.4, -0.7]), 1e-4);
    for t in [0.2, 1.1, 2.9, 5.0] {
        let k = law.kinematics(t, &x);
        let at = |t: f64| law.pose(t).point(&x);
        assert!((k.position - at(t)).norm() < 1e-14);
        assert!((k.velocity - (at(t + h) - at(t - h)) * (0.5 / h)).norm() < 1e-6, "{t}");
        let bend = (at(t + h) - at(t) * 2.0 + at(t - h)) * (1.0 / (h * h));
        assert!((k.acceleration - bend).norm() < 1e-5, "{t}");
        assert_eq!(law.velocity(t, &x), k.velocity);
    }
    assert_eq!(m.period(), None);
}

#[test]
fn poses_compose_and_invert() {
    let m: Motions<3> = motions(
        "sphere = { radius = 1 }",
        "period = 3\npivot = [1, 2, 3]\naxis = [1, 1, 0]\npitch = \"80 deg\"\nplunge = 2",
    );
    let (a, b) = (m.of(0).pose(0.4), m.of(0).pose(1.7));
    let (x, v) = (Vector([0.3, -2.0, 5.0]), Vector([1.0, 0.5, 0.25]));
    let close = |p: Vector<3>, q: Vector<3>| assert!((p - q).norm() < 1e-13, "{p:?} {q:?}");
    close(a.inverse_point(&a.point(&x)), x);
    close(a.inverse().point(&a.point(&x)), x);
    close(a.inverse_direction(&a.direction(&v)), v);
    close(a.then(&b).point(&x), b.point(&a.point(&x)));
    close(b.relative_to(&a).point(&a.point(&x)), b.point(&x));
    close(RigidPose::identity().then(&a).point(&x), a.point(&x));
    assert!((a.direction(&v).norm() - v.norm()).abs() < 1e-14);
    // the axis itself does not turn
    close(a.direction(&Vector([1.0, 1.0, 0.0])), Vector([1.0, 1.0, 0.0]));
}

#[test]
fn a_steady_rotation_repeats_after_each_turn() {
    let m = plane("rotation = 0.5\npivot = [0, 0]");
    assert!((m.period().unwrap() - 4.0 * PI).abs() < 1e-14);
    assert_near(m.of(0).velocity(0.0, &Vector([1.0, 0.0])), [0.0, -0.5], 1e-15);
    assert_eq!(plane("translation = [0.1, 0]").period(), None);
    let still = Motions::<2>::fixed(2);
    assert!(!still.moves() && still.period().is_none() && still.len() == 2 && !still.is_empty());
    assert_eq!(still.of(1).pose(3.0), RigidPose::identity());
}

#[test]
fn bodies_have_motions_of_their_own_and_a_common_period() {
    let text = "[flow]\nmach = 0.5\n[motion]\nperiod = 2\nplunge = 0.1\n[[body]]\nnaca = \"0012\"\n[[body]]\nnaca = \"0012\"\n\
                motion = {}\n[[body]]\nnaca = \"0012\"\nmotion = { period = 3, plunge = 0.2 }\n";
    let case = read(&format!("{text}{CLOUD}"), "c").unwrap_or_else(|e| panic!("{e}"));
    let m = Motions::<2>::of_case(&case, 1.0, &no_file).unwrap();
    assert_eq!((m.of(0).is_fixed(), m.of(1).is_fixed(), m.period()), (false, true, Some(6.0)));
    assert_near(m.of(2).pose(0.75).shift, [0.0, 0.2], 1e-15);
    assert!(m.moves());
}

#[test]
fn a_cloud_without_bodies_can_move() {
    let text = "[flow]\nmach = 0.5\n[cloud]\nspacing = 0.1\ndomain = { min = [0, 0], max = [1, 1] }\n\
                [time.explicit]\nuntil = 1\n[motion]\nparticles = \"rigid\"\nperiod = 2\nplunge = 0.1\n";
    let case = read(text, "c").unwrap_or_else(|e| panic!("{e}"));
    let m = Motions::<2>::of_case(&case, 1.0, &no_file).unwrap();
    assert!(m.moves() && case.moves() && m.is_empty());
    assert_near(m.cloud().pose(0.5).shift, [0.0, 0.1], 1e-15);
}

#[test]
fn tables_come_from_files_too() {
    let text =
        format!("[flow]\nmach = 0.5\n[[body]]\nnaca = \"0012\"\n{CLOUD}[motion]\npivot = [0, 0]\ntable = \"m.csv\"\n");
    let case = |periodic: bool| {
        let long = text.replace("\"m.csv\"", "{ file = \"m.csv\", periodic = true }");
        read(if periodic { &long } else { &text }, "c").unwrap_or_else(|e| panic!("{e}"))
    };
    let build = |file: &'static str, periodic: bool| {
        Motions::<2>::of_case(&case(periodic), 1.0, &move |name: &str| {
            assert_eq!(name, "m.csv");
            Ok(file.to_owned())
        })
    };
    let m = build("# a table\ntime, y, angle_deg\n0, 0, 0\n1, 0.1, 90\n2, 0.3, 0\n", false).unwrap();
    assert_near(m.of(0).pose(1.0).point(&Vector([-1.0, 0.0])), [0.0, 1.1], 1e-14);
    assert_eq!(m.period(), None);
    let m = build("time,x\n0,0\n1,1\n2,-1\n3,0.5\n4,0\n", true).unwrap();
    assert_eq!(m.period(), Some(4.0));
    assert_near(m.of(0).displacement(6.0), [-1.0, 0.0], 1e-14);
    let told = |file: &'static str| build(file, true).unwrap_err().to_string();
    assert!(told("time,x\n0,0\n0,1\n").contains("times do not rise"));
    assert!(told("time,x\n0,0\n1,1\n").contains("last row differs"));
    assert!(told("time,x\n0,zero\n1,1\n").contains("`zero` is not a number"));
    assert!(told("time;x\n0;0\n1;0,5\n").contains("line 3: `0,5` has a decimal comma"));
    assert_near(build("time;x\n0;0\n1;1\n2;0\n", true).unwrap().of(0).displacement(1.0), [1.0, 0.0], 1e-14);
    assert!(told("time,w\n0,0\n1,1\n").contains("column `w` has no meaning"));
    assert!(told("time\n0\n1\n").contains("nothing moves"));
    assert!(told("x\n0\n1\n").contains("column `time`"));
    let gone = Motions::<2>::of_case(&case(false), 1.0, &no_file).unwrap_err().to_string();
    assert!(gone.contains("cannot read the motion table `m.csv`"), "{gone}");
}

#[test]
fn laws_of_a_dimensional_stream_are_in_the_time_of_the_solver() {
    let air = "mach = 0.5\npressure = 101325\ntemperature = 288.15";
    let motions = |motion: &str, file: &'static str| {
        let text = format!("[flow]\n{air}\n[[body]]\nnaca = \"0012\"\n{CLOUD}[motion]\n{motion}\n");
        let case = read(&text, "c").unwrap_or_else(|e| panic!("{e}"));
        let motions = Motions::<2>::of_case(&case, 1.0, &move |_| Ok(file.to_owned()));
        (motions.unwrap_or_else(|e| panic!("{e}")), case.flow.reference().sound_speed)
    };
    // a quarter of a period of 0.2 s, at a rate over the sound speed
    let sine = "frequency = \"5 Hz\"\nplunge = 0.1";
    let formula = "frequency = \"5 Hz\"\nformula = { y = \"0.1 * sin(10 * pi * t) + 0 * omega\" }";
    let table = "table = { file = \"m.csv\", periodic = true }";
    for motion in [sine, formula, table] {
        let (m, a) = motions(motion, "time,y\n0,0\n0.05,0.1\n0.1,0\n0.15,-0.1\n0.2,0\n");
        assert!((m.period().unwrap() / (0.2 * a) - 1.0).abs() < 1e-14, "{motion}");
        assert_near(m.of(0).pose(0.05 * a).shift, [0.0, 0.1], 1e-14);
        let rate = m.of(0).velocity(0.0, &Vector([0.0, 0.0]))[1] * a;
        let wanted = if motion == table { 3.0 } else { PI };
        assert!((rate - wanted).abs() < 1e-12, "{motion}: {rate}");
    }
    let (m, a) = motions("pivot = [0, 0]\nrotation = \"90 deg/s\"\ntranslation = [\"2 m/s\", 0]", "");
    assert_near(m.of(0).pose(a).point(&Vector([0.0, 1.0])), [3.0, 0.0], 1e-14);
    let (m, a) = motions("formula = { y = \"0.3 * t^2\" }", "");
    assert_near(m.of(0).pose(2.0 * a).shift, [0.0, 1.2], 1e-14);
}

#[test]
fn motions_that_make_no_sense_are_refused() {
    let refuse = |motion: &str| {
        let text = format!("[flow]\nmach = 0.5\n[[body]]\nnaca = \"0012\"\n{CLOUD}[motion]\n{motion}\n");
        Motions::<2>::of_case(&read(&text, "c").unwrap(), 1.0, &no_file).unwrap_err().to_string()
    };
    assert!(refuse("formula = { y = \"1 / t\" }").contains("not finite at t = 0"));
    let file = |_: &str| Ok("time,angle_rad\n0,0\n1,1\n".to_owned());
    let text = format!("[flow]\nmach = 0.5\n[[body]]\nnaca = \"0012\"\n{CLOUD}[motion]\ntable = \"a.csv\"\n");
    let error = Motions::<2>::of_case(&read(&text, "c").unwrap(), 1.0, &file).unwrap_err().to_string();
    assert!(error.contains("`body-1` turns, but has no pivot"), "{error}");
}
