//! What users see: whole files with mistakes, and files that must never break the reader.
use proptest::prelude::*;

use super::*;

const GOOD: &str = "title = \"t\"\n[flow]\nmach = 0.8\n[[body]]\nnaca = \"0012\"\n[cloud]\nspacing = 0.01\n";

/// The messages about `text`, rendered.
fn mistakes(text: &str) -> String {
    match read(text, "case.toml") {
        Ok(case) => panic!("no mistake found in\n{text}\n{case:#?}"),
        Err(errors) => errors.render(false),
    }
}

/// `GOOD` without body, on a square domain, with `extra` behind.
fn open(extra: &str) -> String {
    format!("[flow]\nmach = 0.5\n[cloud]\nspacing = 0.1\ndomain = {{ min = [0, 0], max = [1, 1] }}\n{extra}\n")
}

fn assert_shows(text: &str, pieces: &[&str]) {
    let shown = mistakes(text);
    for piece in pieces {
        assert!(shown.contains(piece), "`{piece}` is missing in\n{shown}\nfor\n{text}");
    }
    let (count, said) = (shown.matches("error: ").count(), pieces.len());
    assert!(count <= said, "{count} mistakes told, {said} expected in\n{shown}");
}

#[test]
fn defaults_are_the_documented_ones() {
    let case = read(GOOD, "case.toml").unwrap();
    assert_eq!(case.dimension, Some(2));
    assert_eq!(case.bodies[0].name.as_deref(), Some("body-1"));
    assert_eq!(case.bodies[0].placement, Placement { scale: 1.0, rotate: vec![], translate: vec![] });
    assert_eq!((case.flow.gamma, case.flow.gas_constant, case.flow.alpha), (1.4, 287.05, Angle(0.0)));
    let c = &case.cloud;
    assert_eq!((c.particles_per_level(), c.edge_levels, c.curvature, c.curvature_levels), (6.0, 2, 0.125, 3));
    assert_eq!((c.blank, c.radius, c.jitter), (0.4, 1.6, 0.0));
    assert_eq!(case.scheme, Scheme::default());
    assert_eq!(case.time, Temporal::default());
    assert_eq!(case.adapt, Adapt::default());
    assert_eq!(case.output, Output::default());
    assert_eq!(case.boundary, Sides::default());
    assert_eq!(case.initial, Initial::default());
    assert_eq!(case.reference, Reference::default());
}

#[test]
fn conveniences_mean_what_they_say() {
    let text = "[flow]\nmach = 0.8\npressure = \"1 atm\"\ntemperature = 300\nalpha = \"1.25 deg\"\n\
                [[body]]\nnaca = { digits = \"0012\", trailing_edge = \"blunt\" }\nchord = 2\nrotate = \"3 deg\"\ntranslate = [\"1 ft\", 2]\n[cloud]\nspacing = \"10 mm\"\n[boundary]\n\
                x_min = \"held\"\nx_max = { outflow = { pressure = 0.9 } }\ny_max = \"outflow\"\n\
                [time.explicit]\nuntil = \"20 ms\"\n[output]\nfield_particles = 2e6\n[[compare]]\nfile = \"a.csv\"\n";
    let case = read(text, "dir/wing.toml").unwrap_or_else(|e| panic!("{e}"));
    assert_eq!(case.title, "wing");
    let Shape::Naca(naca) = &case.bodies[0].shape else { panic!("{:?}", case.bodies) };
    assert_eq!((naca.digits.as_str(), naca.trailing_edge), ("0012", TrailingEdge::Blunt));
    let placement = &case.bodies[0].placement;
    assert_eq!((placement.scale, placement.rotate.len(), placement.translate[0].0), (2.0, 1, 0.3048));
    assert_eq!(case.boundary.x_max, Side::Outflow { pressure: Some(0.9) });
    assert_eq!(case.boundary.y_max, Side::Outflow { pressure: None });
    let Temporal::Explicit(march) = &case.time else { panic!("{:?}", case.time) };
    assert_eq!((march.until, march.method), (Some(Time(0.02)), RungeKutta::Ssprk3));
}

#[test]
fn fields_at_the_start_are_read() {
    let vortex = open("[initial]\nvortex = { strength = 5, centre = [0, 0], velocity = [1, 0] }");
    let vortex = read(&vortex, "c").unwrap().initial;
    assert_eq!(vortex, Initial::Vortex { strength: 5.0, centre: [0.0, 0.0], velocity: [1.0, 0.0] });
    for text in ["[initial]\nringleb = {}", "[initial.ringleb]"] {
        assert_eq!(read(&open(text), "c").unwrap().initial, Initial::Ringleb);
    }
    let air = "[flow]\nmach = 0.5\npressure = 101325\ntemperature = 288.15";
    for field in ["vortex = { strength = 5, centre = [0, 0], velocity = [1, 0] }", "ringleb = {}"] {
        let text = open(&format!("[initial]\n{field}")).replace("[flow]\nmach = 0.5", air);
        assert!(text.contains("101325"));
        assert_shows(&text, &["this initial field is nondimensional"]);
    }
    let tube = "initial.riemann = { left = [1, 0, 1], right = [0.125, 0, 0.1] }\n[cloud]\nspacing = 0.01\n\
                domain = { min = [0, 0], max = [1, 0.1] }\n[boundary]\nx_min = \"held\"\nx_max = \"outflow\"\n\
                y_min = \"periodic\"\ny_max = \"periodic\"\n";
    let case = read(tube, "c").unwrap_or_else(|e| panic!("{e}"));
    assert_eq!(case.flow.reference().speed, 0.0);
    assert_shows(
        &tube.replace("x_min = \"held\"\n", ""),
        &["`boundary.x_min` is `far_field`, but the free stream has"],
    );
}

#[test]
fn all_mistakes_are_told_at_once_with_their_places() {
    let text = "[flow]\nmach = -1\nalpha = 1.25\n[[body]]\nnacca = \"0012\"\n[cloud]\nspacng = 0.01\nblank = 0.9\n\
                layers = \"six\"\n[scheme]\nflux = \"hlc\"\norder = 3\n[time.steady]\nmach = 1\n";
    assert_shows(
        text,
        &[
            "case.toml:2:8",
            "allowed: greater than 0",
            "an angle `1.25` has no unit",
            "hint: write `\"1.25 deg\"` with one of the units rad, deg, °, mrad",
            "did you mean `naca`?",
            "did you mean `spacing`?",
            "case.toml:8:9",
            "`cloud.blank` is 0.9, but must be from 0.3 to 0.6",
            "`cloud.layers` must be a number from 3 to 1000, not a text",
            "did you mean `\"hllc\"`?",
            "`scheme.order` is 3, but must be a whole number from 1 to 2",
            "`mach` belongs in `[flow]`",
            "9 mistakes in `case.toml`",
        ],
    );
}

#[test]
fn rendering_points_at_the_value() {
    let shown = mistakes(&GOOD.replace("0.01", "0.01\nblank = 0.9"));
    let expected = "error: `cloud.blank` is 0.9, but must be from 0.3 to 0.6
 --> case.toml:8:9
  |
8 | blank = 0.9
  |         ^^^ allowed: from 0.3 to 0.6

1 mistake in `case.toml`";
    assert_eq!(shown, expected);
    assert!(read("[cloud]\nspacing = 0", "c").unwrap_err().render(true).contains("\u{1b}["));
}

#[test]
fn broken_toml_is_told_with_the_other_mistakes() {
    let text = "[flow]\nmach = = 0.8\n[cloud]\nspacng = 0.01\nblank = 0.9\nlayers = [1,\n";
    let shown = mistakes(text);
    assert!(shown.contains("case.toml:2:") && shown.contains("this is not TOML"), "{shown}");
    assert!(shown.contains("did you mean `spacing`?") && shown.contains("case.toml:5:9"), "{shown}");
    assert!(!shown.contains("missing"), "{shown}");
}

#[test]
fn free_streams_that_contradict_themselves_are_refused() {
    let flow = |keys: &str| GOOD.replace("mach = 0.8", keys);
    assert_shows(
        &flow("mach = 0.8\nvelocity = 1\npressure = 1\ndensity = 1"),
        &["`mach` and `velocity` are both given"],
    );
    assert_shows(&flow("gamma = 1.3"), &["the free stream has no speed"]);
    assert_shows(&flow("velocity = 1"), &["`velocity` needs a dimensional free stream"]);
    assert_shows(&flow("mach = 1\npressure = 1"), &["`flow.pressure` alone does not fix a dimensional"]);
    assert_shows(&flow("mach = 1\npressure = 1\ndensity = 1\ntemperature = 300"), &["contradict each other"]);
    assert_shows(&flow("mach = 1\nbeta = \"1 deg\""), &["`flow.beta` needs a 3-D case"]);
    assert_shows(
        &flow("mach = nan\ngamma = 1"),
        &["`flow.mach` is nan", "`flow.gamma` is 1, but must be greater than 1"],
    );
}

#[test]
fn bodies_that_contradict_themselves_are_refused() {
    let body = |keys: &str| GOOD.replace("naca = \"0012\"", keys);
    assert_shows(&body("naca = \"0012\"\ncircle = { radius = 1 }"), &["`body-1` has 2 shapes, `naca` and `circle`"]);
    assert_shows(
        &body("naca = \"0012\"\n[[body]]\nsphere.radius = 1"),
        &["`body-2.sphere` is 3-D, but `body-1.naca` is"],
    );
    assert_shows(&body("scale = 2"), &["`body-1` has no shape"]);
    assert_shows(&body("naca = \"23612\""), &["a mean line `236` that is not published"]);
    assert_shows(&body("naca = \"66A010\""), &["is no section of the 6-series"]);
    assert_shows(&body("naca = \"2012\""), &["half a camber line"]);
    assert_shows(&body("naca = \"0012\"\nrotate = [\"1 deg\", 0, 0]"), &["`body-1.rotate` has 3 angles"]);
    assert_shows(&body("naca = \"0012\"\ntranslate = [1, 2, 3]"), &["`body-1.translate` has 3 coordinates in a 2-D"]);
    assert_shows(&body("naca = \"0012\"\nscale = 1\nchord = 2"), &["`body-1.scale` is given twice"]);
    assert_shows(&body("polygon = [[0, 0], [1, 0], [0, 0]]"), &["corners 3 and 1 of"]);
    assert_shows(&body("polygon = [[0, 0], [1, 0]]"), &["has 2 values, but must be a list of 3 or more values"]);
    let twins = "name = \"a\"\nnaca = \"0012\"\n[[body]]\nname = \"a\"\nnaca = \"0012\"";
    assert_shows(&body(twins), &["two bodies are called `a`"]);
    assert_shows(&format!("dimension = 3\n{GOOD}"), &["`body-1.naca` is 2-D, but `dimension` is 3-D"]);
}

#[test]
fn a_case_may_leave_the_cloud_to_the_program() {
    let bare = GOOD.replace("[cloud]\nspacing = 0.01\n", "");
    let case = read(&bare, "case.toml").unwrap();
    assert_eq!((case.cloud.spacing, case.accuracy), (None, None));
    assert_eq!(read(&write(&case), "case.toml").unwrap(), case);
    let asked = read(&format!("{bare}[accuracy]\nloads = \"0.5 %\"\n"), "case.toml").unwrap().accuracy.unwrap();
    assert_eq!((asked.loads.0, asked.particles), (0.005, 50_000));
    let sphere = "[flow]\nmach = 0.3\n[[body]]\nsphere = { radius = 1 }\n";
    assert_eq!(read(sphere, "case.toml").unwrap().cloud.spacing, None);
    let asked = read(&format!("{sphere}[accuracy]\nloads = \"2 %\"\n"), "case.toml").unwrap().accuracy.unwrap();
    assert_eq!((asked.loads.0, asked.particles), (0.02, 250_000));
    // of many points less is asked, whatever else the table says
    let polar = |more: &str| {
        let text = format!("{}[accuracy]\n{more}", bare.replace("mach = 0.8", "mach = [0.3, 0.5]"));
        let asked = read(&text, "case.toml").unwrap().accuracy.unwrap();
        (asked.loads.0, asked.particles)
    };
    assert_eq!([polar(""), polar("particles = 9_000\n")], [(0.05, 50_000), (0.05, 9_000)]);
    assert_eq!(polar("loads = \"1 %\"\n"), (0.01, 50_000));
    assert!(read(&bare.replace("mach = 0.8", "mach = 0.8\nreynolds = 1e4"), "case.toml").is_ok());
    let accuracy = "[accuracy]\nloads = 0.01\n";
    assert!(read(&format!("{bare}{accuracy}[adapt]\ncycles = 1\n"), "case.toml").is_ok());
    assert_shows(&format!("{bare}{accuracy}[time.dual]\nstep = 1\nuntil = 2\n"), &["is for steady cases"]);
    let march = "[time.dual]\nstep = 1\nuntil = 2\n";
    let error = |error: &str| format!("{bare}[accuracy]\nerror = \"{error}\"\n");
    let asked = read(&(error("step") + march), "case.toml").unwrap();
    assert_eq!(asked.accuracy.unwrap().error, LoadErrors::Step);
    assert_eq!(read(&write(&asked), "case.toml").unwrap().accuracy, asked.accuracy, "a resolved case has all keys");
    assert_shows(&error("cloud"), &["is for marches and harmonic balances"]);
    assert_shows(&(error("harmonics") + march), &["a march has no number of harmonics", "error = \"step\""]);
    assert_shows(&format!("{}loads = 0.1\n{march}", error("all")), &["`accuracy.loads` is for steady cases"]);
}

#[test]
fn hinges_that_are_none_are_refused() {
    let hinge = |keys: &str| format!("{GOOD}\n[[hinge]]\n{keys}");
    assert_shows(&hinge("name = \"flap\""), &["hinge", "from"]);
    assert_shows(&hinge("from = [0.7, 0, 0]"), &["`hinge[0].from` has 3 coordinates in a 2-D case"]);
    assert_shows(&hinge("from = [0.7, 0]\nto = [0.7, 1]"), &["a hinge has one end in a 2-D case"]);
    assert_shows(&hinge("from = [0.7, 0]\nbody = \"tail\""), &["no body is called `tail`"]);
    let wing = "[flow]\nmach = 0.5\n[[body]]\nwing = { naca = \"0012\", span = 4, chord = 1 }\n[cloud]\nspacing = 0.1\n[[hinge]]\n";
    let line = |ends: &str| format!("{wing}{ends}");
    assert_shows(&line("from = [0.7, 0, 0]"), &["a hinge needs both ends in a 3-D case"]);
    assert_shows(&line("from = [0.7, 0, 0]\nto = [1.7, 0.01, 0]"), &["the hinge line runs along the stream"]);
    assert!(read(&line("from = [0.7, 0, 0]\nto = [0.7, 1, 0]"), "case.toml").is_ok());
}

#[test]
fn a_field_at_the_start_may_be_formulas_of_the_position() {
    let case = |field: &str| {
        format!(
            "[flow]\nmach = 0.1\n[initial.formula]\n{field}\n[cloud]\nspacing = 0.1\ndomain = {{ min = [0, 0], max = [1, 1] }}\n"
        )
    };
    let good = case("velocity = [\"6 * y * (1 - y)\", 0]\ndensity = 2\n");
    let Initial::Formula { velocity, density, pressure } = read(&good, "case.toml").unwrap().initial else { panic!() };
    assert_eq!((velocity.len(), velocity[1].as_str(), density.as_deref(), pressure), (2, "0.0", Some("2.0"), None));
    assert_shows(&case("density = 1"), &["missing key `velocity` in `[initial.formula]`"]);
    assert_shows(&case("velocity = [1, \"z\"]"), &["unknown name `z`"]);
    assert_shows(&case("velocity = [1, \"sin(t)\"]"), &["uses `t`, but it is a field at the start"]);
    assert_shows(&case("velocity = [1, 2, 3]"), &["has 3 components in a 2-D case"]);
    assert_shows(&case("velocity = [1, 2]\npressure = -1"), &["`initial.formula.pressure` is -1", "greater than 0"]);
}

#[test]
fn domains_and_sides_that_contradict_themselves_are_refused() {
    assert_shows("[flow]\nmach = 1\n[cloud]\nspacing = 1\n", &["a case without bodies needs `cloud.domain`"]);
    assert_shows(
        "",
        &["a case without bodies needs `cloud.spacing`", "needs `cloud.domain`", "the free stream has no speed"],
    );
    let periodic = open("[boundary]\nx_min = \"periodic\"");
    assert_shows(&periodic, &["`boundary.x_min` is periodic, but `boundary.x_max` is not"]);
    assert_shows(&open("[boundary]\nz_min = \"held\""), &["`boundary.z_min` needs a 3-D case"]);
    let layers = open("").replace("[cloud]", "[cloud]\nwall_layers = { first = 0.1, growth = 2 }");
    assert_shows(&layers, &["`cloud.wall_layers` needs a body", "growth"]);
    assert_shows(&open("[boundary]\nx_min = \"inflow\""), &["allowed: `far_field`, `held`, `outflow`, `symmetry` or"]);
    assert_shows(&open("[boundary]\nx_min = { held = {}, outflow = {} }"), &["`boundary.x_min` has two alternatives"]);
    assert_shows(&open("").replace("max = [1, 1]", "max = [1, 0]"), &["`cloud.domain` is empty"]);
    assert_shows(&open("").replace("spacing = 0.1", "spacing = 2"), &["the domain is only 1 wide"]);
    let tilted = open("[boundary]\ny_min = \"symmetry\"").replace("mach = 0.5", "mach = 0.5\nalpha = \"1 deg\"");
    assert_shows(&tilted, &["the free stream crosses the symmetry plane"]);
    assert_shows(
        &format!("{GOOD}[boundary]\ny_min = \"periodic\"\n"),
        &["a periodic side needs `cloud.domain`", "`boundary.y_min` is periodic, but"],
    );
    let half = GOOD.replace("alpha", "# alpha");
    assert!(read(&format!("{half}[boundary]\ny_min = \"symmetry\"\n"), "case.toml").is_ok());
    let solid = open("[initial]\nringleb = {}").replace("[0, 0], max = [1, 1]", "[0, 0, 0], max = [1, 1, 1]");
    assert_shows(&solid, &["`ringleb` is a 2-D flow, but the case is 3-D"]);
    assert_shows(&format!("initial = \"vortex\"\n{GOOD}"), &["`vortex` needs a table of its own"]);
    assert_shows(&open("[time.steady]\ncfl = 10\ncfl_max = 1"), &["`cfl` starts at 10, above `cfl_max` = 1"]);
    assert_shows(&open("[output]\nfield_interval = 1"), &["`output.field_interval` needs a marching run"]);
    assert_shows(
        &open("[time.explicit]\ncfl = 0"),
        &["`[time.explicit]` has neither `until` nor `periods`", "`time.explicit.cfl` is 0"],
    );
}

/// Reads `text`; whatever is wrong must have a place inside it and a message that can be shown.
fn survives(text: &str) {
    let Err(errors) = read(text, "case.toml") else { return };
    assert!(!errors.errors.is_empty());
    for error in &errors.errors {
        assert!(error.line >= 1 && error.column >= 1 && error.end_column >= error.column);
        assert!(error.line <= text.matches('\n').count() + 1 && error.span.end <= text.len());
        assert!(!error.message.contains("does not fit together"), "{}", error.message);
    }
    assert!(errors.render(false).contains("--> case.toml:") && !errors.render(true).is_empty());
}

fn piece() -> impl Strategy<Value = String> {
    let pieces = [
        "",
        "=",
        "[",
        "]]",
        "{",
        "\"",
        "'''",
        "#",
        "\n",
        "\r",
        ".",
        "naca",
        "[[body]]\n",
        "[cloud]\n",
        "nan",
        "-1",
        "é",
        "\u{0}",
        "1e400",
        "0x7f",
        "true",
        "[boundary]\n",
        "x_min = \"periodic\"\n",
        "[0, 0]",
        "1979-05-27",
        ",",
        "99999999999999999999",
        "[initial.vortex]\n",
        "[time]\n",
        "{}",
        "\t",
        "\u{202e}",
        "\u{1b}[31m",
        "[[cloud.box]]\n",
        "[[[[[[",
        "[flow.mach]\n",
    ];
    prop_oneof![proptest::sample::select(pieces.to_vec()).prop_map(str::to_owned), "\\PC{0,6}"]
}

proptest! {
    #[test]
    fn mutated_cases_never_panic(which in 0..TEMPLATES.len(), edits in prop::collection::vec((any::<u16>(), 0..12_u8, piece()), 1..6)) {
        let mut text = template(TEMPLATES[which].0).unwrap();
        for (at, cut, piece) in edits {
            let chars: Vec<char> = text.chars().collect();
            let at = usize::from(at) % (chars.len() + 1);
            let end = (at + usize::from(cut)).min(chars.len());
            text = chars[..at].iter().collect::<String>() + &piece + &chars[end..].iter().collect::<String>();
        }
        survives(&text);
    }

    #[test]
    fn shuffled_lines_never_panic(picks in prop::collection::vec(any::<u16>(), 0..40)) {
        let all: String = TEMPLATES.iter().filter_map(|(name, _)| template(name)).collect();
        let lines: Vec<&str> = all.lines().map(|l| l.trim_start_matches("# ")).collect();
        let text: Vec<&str> = picks.iter().map(|i| lines[usize::from(*i) % lines.len()]).collect();
        survives(&text.join("\n"));
    }

    #[test]
    fn any_text_never_panics(text in "(\\PC|\n){0,200}") {
        survives(&text);
    }
}

#[test]
fn words_of_other_programs_lengths_with_units_and_commas_are_understood_or_answered() {
    let body = |keys: &str| format!("[flow]\nmach = 0.5\n[[body]]\nnaca = \"0012\"\n{keys}\n[cloud]\nspacing = 0.1\n");
    let chord = |keys: &str| read(&body(keys), "t").unwrap().bodies[0].placement.scale;
    assert_eq!((chord("chord = \"30 cm\""), chord("scale = \"1 mm\""), chord("chord = 2")), (0.3, 1e-3, 2.0));
    assert_shows(&body("at = [0, 0]"), &["unknown key `at` in `body-1`", "did you mean `translate`?"]);
    assert_shows(&body("chord = -1"), &["`body-1.chord` is -1"]);
    assert_shows(&body("chord = \"0,35 m\""), &["has a decimal comma", "`\"0.35 m\"`"]);
    assert_shows(&body("chord = 0,35"), &["a number has a decimal comma", "`0.35`"]);
}

#[test]
fn values_that_are_hardly_meant_are_refused() {
    let flow = |keys: &str| format!("[flow]\n{keys}\n[[body]]\nnaca = \"0012\"\n[cloud]\nspacing = 0.1\n");
    let cold = "mach = 0.5\npressure = \"1 bar\"\ntemperature = \"15\"";
    assert_shows(&flow(cold), &["`flow.temperature` is 15 without a unit", "`\"15 degC\"`"]);
    assert!(read(&flow(&cold.replace("15", "15 K")), "t").is_ok());
    assert_shows(&flow("mach = 0.5\nreynolds = 1e9"), &["at a Reynolds number of 1e9", "at most 1e7"]);
    assert_shows(&flow("mach = 0.001"), &["at M 0.001", "M 0.1"]);
    assert!(read(&(flow("mach = 0.001") + "[scheme]\nlow_mach = true\n"), "t").is_ok());
}

#[test]
fn wings_and_profiles_that_cannot_be_are_told() {
    let body = |shape: &str| format!("[flow]\nmach = 0.3\n[[body]]\n{shape}\n");
    assert!(read(&body("wing = { naca = \"0012\", span = 8, chord = 1 }"), "t").is_ok());
    for (shape, told) in [
        ("wing = { span = 8, chord = 1 }", "a wing has no section"),
        ("wing = { naca = \"0012\", airfoil = \"a.dat\", span = 8, chord = 1 }", "two sections at the same end"),
        ("wing = { naca = \"0012\", span = 8 }", "a wing has no chord"),
        ("wing = { naca = \"0012\", span = 8, chord = 1, aspect_ratio = 8 }", "both a chord and an aspect ratio"),
        ("wing = { naca = \"9912x\", span = 8, chord = 1 }", "9912x"),
        ("revolution = [[0, 0.1], [0, 0.5]]", "the profile has no length"),
        ("revolution = [[0, 0], [1, 0]]", "the profile runs along the axis"),
        ("revolution = [[0, 0], [2, 0.5], [1, 0.5], [3, 0]]", "lies ahead of the one before"),
        ("revolution = [[0, 0], [1, 0.5], [1, 0.5], [3, 0]]", "are the same"),
        ("revolution = [[0, 0], [1, 0], [3, 1]]", "does not have a positive radius"),
        ("loft = [[0, 0, 0], [2, 1, 1], [1, 1, 1], [3, 0, 0]]", "station 3 of the loft does not lie behind"),
        ("loft = [[0, 0, 0], [1, 1, 0], [3, 1, 1]]", "station 2 of the loft has no area"),
        ("loft = [[0, 0, 0], [1, 0, 0]]", "the loft has no volume"),
    ] {
        assert_shows(&body(shape), &[told]);
    }
}

#[test]
fn wall_clock_times_are_in_seconds_where_they_have_no_unit() {
    let of = |time: &str| {
        let text = format!("[flow]\nmach = 0.3\n[[body]]\nnaca = \"0012\"\n[output]\ncheckpoint_time = {time}\n");
        read(&text, "c").map(|c| c.output.checkpoint_time.0)
    };
    for (time, seconds) in [("5", 5.0), ("\"5 s\"", 5.0), ("\"5\"", 5.0), ("\"2 min\"", 120.0), ("0.5", 0.5)] {
        assert_eq!(of(time).unwrap_or_else(|e| panic!("{time}: {e}")), seconds);
    }
    assert!(of("0").is_err() && of("\"5 fortnights\"").is_err());
}

#[test]
fn numbers_many_times_beyond_what_is_allowed_are_told_to_be_slips() {
    let told = |jitter: &str| {
        let text = format!("[flow]\nmach = 0.3\n[[body]]\nnaca = \"0012\"\n[cloud]\nblank = {jitter}\n");
        read(&text, "c").unwrap_err().to_string()
    };
    let slip = "hint: check its unit and its exponent";
    assert!(told("4e3").contains(slip) && told("4e3").contains("allowed: from 0.3 to 0.6"));
    assert!(!told("0.7").contains(slip));
}
