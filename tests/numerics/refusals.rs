//! Refusals and warnings of problems: what a command refuses, `check` refuses as well.
use std::path::Path;

use alula::case::{Case, read};
use alula::problem::{Problem, Remark, RunError};
use alula::run;

/// The same result of a command; where the case is to blame, `check` must have refused it as well.
fn as_checked<T>(case: &Case, input: &Path, seen: Result<T, RunError>) -> Result<T, RunError> {
    if let Err(problem) = &seen {
        let told = problem.messages();
        let checked = run::refusals(case, input).into_iter().chain(run::inspect(case, input, None).err());
        let checked: Vec<String> = checked.map(|p| p.to_string()).collect();
        assert!(told.iter().all(|part| checked.contains(part)), "`check` does not refuse: {told:?}");
    }
    seen
}

/// Warnings of opening the problem of a case, or why it is refused.
fn opened(text: &str) -> Result<Vec<String>, String> {
    let case = read(text, "t").unwrap_or_else(|e| panic!("{e}"));
    let problem = as_checked(&case, Path::new(""), Problem::of_case(&case, "")).map_err(|e| e.to_string())?;
    let warning = |remark: &Remark| if let Remark::Warning(text) = remark { Some(text.clone()) } else { None };
    Ok(problem.remarks().iter().filter_map(warning).collect())
}

mod motion_feasibility {
    use super::*;

    /// What is told of two circles, of which the second moves by `motion`.
    fn told(motion: &str, time: &str) -> Result<Vec<String>, String> {
        let text = format!(
            "[flow]\nmach = 0.3\n[[body]]\nname = \"front\"\ncircle = {{ radius = 0.5 }}\n[[body]]\nname = \"rear\"\n\
             circle = {{ radius = 0.5 }}\ntranslate = [2.0, 0.0]\n[body.motion]\n{motion}\n[cloud]\nspacing = 0.1\n\
             domain = {{ min = [-3.2, -3.2], max = [6.4, 3.2] }}\n[time.dual]\n{time}\n"
        );
        let case = read(&text, "case.toml").unwrap_or_else(|e| panic!("{e}"));
        let moves = |report: run::CloudReport| report.warnings.into_iter().filter(|w| w.contains("moves by")).collect();
        run::inspect(&case, Path::new(""), None).map(moves).map_err(|e| e.to_string())
    }

    #[test]
    fn bodies_that_leave_or_collide_are_refused_before_the_run() {
        let message = told("translation = [0.3, 0.0]", "step = 0.1\nuntil = 20").unwrap_err();
        assert!(message.contains("`rear` leaves the domain at t = 13.0"), "{message}");
        let message = told("translation = [-0.3, 0.0]", "step = 0.1\nuntil = 5").unwrap_err();
        assert!(message.contains("`front` and `rear` run into one another at t = 3.2"), "{message}");
        assert_eq!(told("translation = [-0.3, 0.0]", "step = 0.1\nuntil = 2"), Ok(Vec::new()));
    }

    #[test]
    fn a_step_over_more_than_a_spacing_is_told_with_its_remedy() {
        let swing = "period = 4\nplunge = 0.5";
        // 0.5 sin over an eighth of a period: 0.35 in the fastest step
        let notes = told(swing, "steps_per_period = 8\nperiods = 2").unwrap();
        assert!(notes[0].contains("`rear` moves by") && notes[0].contains("`steps_per_period = "), "{notes:?}");
        let remedy: f64 =
            notes[0].split("steps_per_period = ").nth(1).unwrap().split('`').next().unwrap().parse().unwrap();
        assert_eq!(
            told(swing, &format!("steps_per_period = {}\nperiods = 2", (1.2 * remedy).ceil())).map(|n| n.len()),
            Ok(0)
        );
    }
}

mod sanity {
    use super::*;
    fn told(more: &str) -> Result<Vec<String>, String> {
        opened(&format!("[[body]]\nnaca = \"0012\"\n{more}"))
    }

    #[test]
    fn spacings_and_periods_out_of_all_measure_are_refused() {
        let stream = "[flow]\nmach = 0.5\n";
        assert_eq!(told(&format!("{stream}[cloud]\nspacing = 0.03\n")), Ok(Vec::new()));
        let coarse = told(&format!("{stream}[cloud]\nspacing = 5\n")).unwrap_err();
        assert!(coarse.contains("`cloud.spacing` is 5, but body `body-1` is only 1 long"), "{coarse}");
        assert!(told(&format!("{stream}[cloud]\nspacing = 0.2\n")).unwrap()[0].contains("5.0 spacings long"));
        let boxed = |max: f64| {
            format!("{stream}[cloud]\nspacing = 0.2\n[[cloud.box]]\nmin = [-1, -1]\nmax = [{max}, 1]\nspacing = 0.02\n")
        };
        assert_eq!(told(&boxed(2.0)), Ok(Vec::new()), "the spacing around the body is that of the box");
        assert!(told(&boxed(0.5)).unwrap()[0].contains("5.0 spacings long"), "a box around a part of the body");
        let family = format!("{stream}[cloud]\nspacing = 0.2\n[accuracy]\n");
        assert_eq!(told(&family), Ok(Vec::new()), "which cloud its result is told on is not known yet");
        let swing = |period: &str| {
            format!(
                "{stream}[motion]\nplunge = 0.01\nperiod = {period}\n[time]\nharmonics = 1\n[cloud]\nspacing = 0.03\n"
            )
        };
        assert!(told(&swing("1e-9")).unwrap_err().contains("the period 1.000e-9 is so short"));
        assert_eq!(told(&swing("20")), Ok(Vec::new()));
    }

    #[test]
    fn layers_out_of_all_measure_and_hot_streams_are_told() {
        let layers = "[flow]\nmach = 0.5\nreynolds = 5000\n[cloud]\nspacing = 0.02\nwall_layers = { first = 1e-15 }\n";
        let thin = told(layers).unwrap_err();
        assert!(thin.contains("is 1e-15, 5.0e-14 times the spacing") && thin.contains("8.8e-4 is a fifth"), "{thin}");
        let hot = told("[flow]\nmach = 30\n[cloud]\nspacing = 0.02\n").unwrap();
        assert!(hot[0].contains("181 times as hot"), "{hot:?}");
    }

    #[test]
    fn streams_from_behind_are_told() {
        let at = |alpha: &str| told(&format!("[flow]\nmach = 0.5\nalpha = \"{alpha}\"\n[cloud]\nspacing = 0.03\n"));
        assert!(at("114.59 deg").unwrap()[0].contains("`flow.alpha` is 114.59 deg: the stream comes from behind"));
        assert_eq!(at("-90 deg"), Ok(Vec::new()));
    }

    #[test]
    fn turbulent_streams_are_told() {
        let at = |re: &str| told(&format!("[flow]\nmach = 0.5\nreynolds = {re}\n[cloud]\nspacing = 0.03\n"));
        assert_eq!(at("5000"), Ok(Vec::new()));
        assert!(at("2e6").unwrap()[0].contains("2.00e6"));
        assert!(at("1").unwrap()[0].contains("molecules fly 0.74 lengths"));
        let air = |viscosity: &str| {
            let stream = "velocity = \"100 m/s\"\npressure = 101325\ntemperature = \"15 degC\"";
            told(&format!("[flow]\n{stream}\nviscosity = \"{viscosity} Pa s\"\n[cloud]\nspacing = 0.03\n"))
        };
        assert!(
            air("1e-7")
                .unwrap_err()
                .contains("the Reynolds number is 1.225e9, with the length 1.0: the boundary layers")
        );
        assert!(air("1e5").unwrap_err().contains("no flow of a continuum"));
        assert_eq!(air("0.1"), Ok(Vec::new()));
    }
}

mod assembly {
    use super::*;
    #[test]
    fn a_crevice_without_conservative_coefficients_is_refused_with_its_place() {
        let built = |more: &str| {
            let text = format!(
                "title = \"t\"\n[flow]\nmach = 0.3\nreynolds = 1000\n[[body]]\npolygon = [[-0.5, -0.5], [0.5, -0.5], \
                 [0.5, 0.5], [0.079, 0.5], [0, -0.1], [-0.079, 0.5], [-0.5, 0.5]]\n[cloud]\nspacing = 0.06\nfar_field = 2\n\
                 edge_levels = 1\nwall_layers = {{ first = 0.008 }}\n[scheme]\n{more}"
            );
            let case = read(&text, "t").unwrap();
            let seen = run::build_solver::<2>(&case, Path::new(""));
            as_checked(&case, Path::new(""), seen).map_err(|e| e.to_string())
        };
        let message = built("").map(|_| ()).unwrap_err();
        assert!(message.starts_with("there are no conservative coefficients for the particles at ("), "{message}");
        assert!(message.contains("`scheme.conservative = false`"), "{message}");
        assert!(built("conservative = false").is_ok());
    }

    #[test]
    fn slow_flow_is_refused_without_conservative_coefficients() {
        let told = |more: &str| {
            let text = format!(
                "title = \"t\"\n[flow]\nmach = 0.1\n[[body]]\ncircle = {{ radius = 0.5 }}\n[cloud]\nspacing = 0.1\n[scheme]\n\
                 low_mach = true\n{more}"
            );
            opened(&text)
        };
        assert!(told("").is_ok());
        assert!(told("conservative = false").unwrap_err().contains("`low_mach = true` needs `conservative = true`"));
        let moved = |particles: &str| {
            format!(
                "[motion]\nparticles = \"{particles}\"\nperiod = 10\nplunge = 0.1\n[time.dual]\nsteps_per_period = 20\nperiods = 1"
            )
        };
        assert!(told(&moved("deforming")).is_ok() && told(&moved("rigid")).is_ok());
        assert!(told(&format!("conservative = false\n{}", moved("deforming"))).is_err());
    }
}

mod probes {
    use super::*;

    fn told(at: &str) -> Result<Vec<String>, String> {
        let text = format!(
            "[[body]]\nname = \"plate\"\nbox = {{ size = [1, 0.1] }}\n[body.solid]\nspacing = 0.02\n\
             material = {{ density = 1000, young = 1e6, poisson = 0.3 }}\nprobe = [{{ name = \"tip\", at = {at} }}]\n\
             [time.explicit]\nuntil = 1\n"
        );
        let case = read(&text, "t").unwrap_or_else(|e| panic!("{e}"));
        run::inspect_structure(&case, Path::new(".")).map(|r| r.warnings).map_err(|e| e.to_string())
    }

    #[test]
    fn probes_outside_their_body_are_told_of_or_refused() {
        for inside in ["[0, 0]", "[0.49, 0.049]", "[0.5, 0.05]", "[0.503, 0]"] {
            assert_eq!(told(inside).unwrap(), Vec::<String>::new(), "{inside}");
        }
        let warnings = told("[0.515, 0.05]").unwrap();
        assert!(warnings.len() == 1 && warnings[0].contains("probe `tip` is 1.500e-2 outside `plate`"), "{warnings:?}");
        for outside in ["[0.54, 0]", "[0.9, 0]", "[0, -3]"] {
            let text = told(outside).unwrap_err();
            let words = ["probe `tip` at (", "is not in `plate`", "spacings", "x from -0.500000 to 0.500000"];
            words.iter().for_each(|w| assert!(text.contains(w), "{text}"));
        }
    }
}

mod filling {
    use super::*;

    #[test]
    fn bodies_whose_particles_coordinates_do_not_tell_apart_are_refused() {
        let told = |at: &str| {
            let text = format!(
                "[[body]]\nname = \"plate\"\nbox = {{ size = [1, 0.1] }}\ntranslate = {at}\n[body.solid]\nspacing = 0.02\n\
                 material = {{ density = 1000, young = 1e6, poisson = 0.3 }}\n[time.explicit]\nuntil = 1\n"
            );
            let case = read(&text, "t").unwrap_or_else(|e| panic!("{e}"));
            run::inspect_structure(&case, Path::new(".")).map(|r| r.particles).map_err(|e| e.to_string())
        };
        assert_eq!(told("[0, 0]"), told("[100, -100]"));
        for (at, words) in [
            ("[0, 1e7]", ["`translate` is [0.0, 10000000.0]", "at most 2.000e4 from the origin"]),
            ("[1e16, 0]", ["`translate` is [1e16, 0.0]", "allowed: from -1e8 to 1e8"]),
        ] {
            let refused = told(at).unwrap_err();
            words.iter().for_each(|w| assert!(refused.contains(w), "no `{w}` in {refused}"));
        }
    }
}

mod size {
    use super::*;
    fn case(shape: &str, solid: &str) -> Case {
        let text = format!(
            "[[body]]\nname = \"plate\"\n{shape}\n[body.solid]\nmaterial = {{ density = 1000, young = 1e6, poisson = 0.3 }}\n{solid}\n\
             [time.explicit]\nuntil = 1\n"
        );
        read(&text, "t").unwrap_or_else(|e| panic!("{e}"))
    }

    #[test]
    fn what_would_fill_the_machine_is_refused_before_it_is_made() {
        for (shape, solid) in [
            ("box = { size = [1, 1e-7] }", "through = 100000"),
            ("box = { size = [1, 1, 1] }", "spacing = 1e-6"),
            ("sphere = { radius = 1 }", "spacing = 1e-6"),
            ("circle = { radius = 1 }", "spacing = 1e-9"),
        ] {
            let problem = run::inspect_structure(&case(shape, solid), Path::new(".")).unwrap_err();
            let text = problem.to_string();
            assert!(text.contains("solid particles") && text.contains("take a larger `spacing`"), "{shape}: {text}");
        }
    }
}

#[test]
fn all_bad_files_of_a_case_are_told_at_once() {
    let folder = tempfile::tempdir().unwrap();
    let file = |name: &str, text: &str| std::fs::write(folder.path().join(name), text).unwrap();
    file("one.dat", "one\n1 0\n0 0\n");
    file("two.dat", "two\n1 zero\n");
    file("table.csv", "time,w\n0,0\n1,1\n");
    file("mode.csv", "x,y,dx\n0,0,1\n");
    let text = "[flow]\nmach = 0.5\n[[body]]\nairfoil = \"one.dat\"\n[[body]]\nairfoil = \"two.dat\"\ntranslate = [3, 0]\n\
                motion.mode = { file = \"mode.csv\", amplitude = 0.1 }\nmotion.period = 5\n[motion]\ntable = \"table.csv\"\n\
                [time.dual]\nstep = 0.1\nuntil = 1\n";
    let case = read(text, "t").unwrap_or_else(|e| panic!("{e}"));
    let places = run::Places { input: folder.path().into(), out: folder.path().join("out") };
    let refused = run::run(&case, &places, &mut run::Silent).map(|_| ()).unwrap_err();
    let told = refused.messages();
    for name in ["one.dat", "two.dat", "table.csv", "mode.csv"] {
        assert_eq!(told.iter().filter(|text| text.contains(name)).count(), 1, "{name}: {told:#?}");
    }
    let checked: Vec<String> = run::refusals(&case, folder.path()).iter().map(ToString::to_string).collect();
    assert!(told.iter().all(|text| checked.contains(text)), "{checked:#?}");
}

#[test]
fn references_without_their_columns_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let told = |table: &str, shape: &str| {
        std::fs::write(folder.path().join("cp.csv"), table).unwrap();
        let text = format!("[flow]\nmach = 0.3\n[[body]]\n{shape}\n[[compare]]\nfile = \"cp.csv\"\n");
        let case = read(&text, "t").unwrap();
        run::refusals(&case, folder.path()).first().map(ToString::to_string)
    };
    let (section, sphere) = ("naca = \"0012\"", "sphere = { radius = 1 }");
    let wrong = told("x,cp\n0,1\n", section).unwrap();
    assert!(wrong.contains("`cp.csv` has no column `x_c`, but `x`, `cp`"), "{wrong}");
    assert!(told("x_c,Cp\n0,high\n", section).unwrap().contains("no number in its column `Cp`"));
    assert!(told("x_c,Cp\n0,1\n", sphere).unwrap().contains("no column `eta`"));
    assert!(told("x_c;Cp\n0;1\n", section).is_none() && told("eta,x_c,Cp\n0.5,0,1\n", sphere).is_none());
}
