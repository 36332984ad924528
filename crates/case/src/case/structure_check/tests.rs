//! What `[structure]` accepts and refuses.
use crate::case::{Case, Freedom, Frequency, Mass, StructureModel, read, write};

const HEAD: &str = "[flow]\nmach = 0.3\n[[body]]\nname = \"wing\"\nnaca = \"0012\"\n[cloud]\nspacing = 0.01\n[time.dual]\n\
                    until = 1\nstep = 0.1\n";
const ISOGAI: &str = "elastic_axis = -2.0\nmass_ratio = 60\nx_alpha = 1.8\nr_alpha2 = 3.48\nfrequency_ratio = 1\n\
                      reduced_speed = 18.4\n";
const AIR: &str = "mach = 0.3\npressure = 101325\ntemperature = 288.15\n";

fn case(text: &str) -> Case {
    let case = read(text, "case.toml").unwrap_or_else(|e| panic!("{e}"));
    assert_eq!(read(&write(&case), "c").unwrap_or_else(|e| panic!("{e}\n{}", write(&case))), case);
    case
}

fn structure(keys: &str) -> String {
    format!("{HEAD}[structure]\n{keys}\n")
}

fn solid(keys: &str) -> String {
    structure(keys).replace("naca = \"0012\"", "sphere = { radius = 1 }")
}

/// As many mistakes as pieces, each with a hint or what is allowed.
fn told(text: &str, pieces: &[&str]) {
    let errors = read(text, "case.toml").expect_err(text);
    let shown = errors.render(false);
    for piece in pieces {
        assert!(shown.contains(piece), "`{piece}` is missing in\n{shown}\nfor\n{text}");
    }
    assert_eq!(errors.errors.len(), pieces.len(), "{shown}\nfor\n{text}");
    assert!(errors.errors.iter().all(|e| e.hint.is_some() || e.allowed.is_some()), "{shown}");
}

#[test]
fn sections_are_read_by_the_numbers_of_flutter() {
    let c = case(&structure(&format!(
        "{ISOGAI}damping_ratio = {{ pitch = 0.01 }}\ninitial = {{ pitch = \"1 deg\", plunge_rate = 0.02 }}\n\
         springs = {{ pitch = {{ cubic = 40, free_play = \"0.5 deg\" }} }}\nforce = {{ pitch = \"1e-3*cos(omega*t)\", \
         reduced_frequency = 0.1 }}"
    )));
    let s = c.structure_of(0).unwrap();
    assert_eq!((s.model, s.freedoms(2)), (StructureModel::TypicalSection, vec![Freedom::Plunge, Freedom::Pitch]));
    assert_eq!((s.elastic_axis, s.mass_ratio, s.reduced_speed), (Some(-2.0), Some(60.0), Some(18.4)));
    assert_eq!((s.initial["pitch"], s.initial["plunge_rate"]), (1f64.to_radians(), 0.02));
    assert_eq!((s.springs["pitch"].cubic, s.springs["pitch"].free_play), (40.0, 0.5f64.to_radians()));
    // k = ωL/U with L half the chord of 2
    assert!((c.force_frequency(2.0).unwrap() - 0.1 * 0.3).abs() < 1e-16);
    assert!(c.structure_of(1).is_none());
}

#[test]
fn sections_that_may_flutter_need_no_speed() {
    let bare = ISOGAI.replace("reduced_speed = 18.4\n", "");
    let within =
        |keys: &str| case(&structure("").replace("[structure]\n", &format!("[structure.section]\n{keys}[flutter]\n")));
    let flat = case(&format!("{}[flutter]\naccuracy = \"0.5 %\"\n", structure(&bare)));
    assert_eq!((flat.structures[0].speed_index, flat.flutter.as_ref().unwrap().accuracy), (Some(1.0), 0.005));
    assert_eq!(within(&bare).structures, flat.structures);
    let given = |keys: &str| within(&format!("{bare}{keys}\n")).structures[0].speed_index;
    assert_eq!((given("speed_index = 2"), given("reduced_velocity = 5")), (Some(2.0), None));
    assert_eq!(given("stiffness = { pitch = 0.1 }"), None);
    let twice = structure(&format!("{ISOGAI}[structure.section]\nmass_ratio = 2\nzzz = 1\n"));
    told(&twice, &["`structure[0].mass_ratio` is given twice, also in `structure[0].section`", "unknown key `zzz`"]);
}

#[test]
fn sections_are_read_with_their_units() {
    let air = HEAD.replace("mach = 0.3\n", AIR);
    let keys = "[[structure]]\nbody = \"wing\"\nfree = [\"plunge\", \"pitch\", \"flap\"]\npivot = [0.4, 0]\nmass = \"12 kg/m\"\n\
                inertia = \"0.5 kg m\"\ncentre_of_mass = [0.45, 0]\nstiffness = { plunge = \"2.8 kN/m2\" }\n\
                frequency = { pitch = \"5 Hz\", flap = \"20 Hz\" }\ngravity = [0, \"-9.81 m/s2\"]\n\
                flap = { hinge_point = [0.8, 0], x_beta = 0.01, r_beta2 = 0.005, blend = 0.02 }\n";
    let c = case(&format!("{air}{keys}"));
    let s = c.structure_of(0).unwrap();
    assert_eq!((s.mass, s.stiffness["plunge"]), (Some(Mass(12.0)), 2800.0));
    assert_eq!(s.frequency["pitch"], Frequency(10.0 * std::f64::consts::PI));
    assert_eq!(s.freedoms(2).last(), Some(&Freedom::Flap));
    let wrong = keys.replace("12 kg/m", "12 kg").replace("0.5 kg m", "0.5 kg m2").replace("kN/m2", "kN/m");
    told(&format!("{air}{wrong}"), &["`structure[0].mass` is in kg,", "is in kg m2,", "is in kN/m, but in a 2-D case"]);
}

#[test]
fn cylinders_and_bodies_in_space_are_read() {
    let c = case(
        &structure("free = \"plunge\"\nmass_ratio = 10\nreduced_velocity = 5")
            .replace("naca = \"0012\"", "circle = { radius = 0.5 }"),
    );
    assert_eq!(c.structure_of(0).unwrap().freedoms(2), [Freedom::Plunge]);
    let c = case(&solid(
        "model = \"rigid_body\"\nmass = 3\ninertia = [1, 1, 2]\ncentre_of_mass = [0, 0, 0.1]\n\
         stiffness = { plunge = 0.2, pitch = 0.1 }\ndamping = { yaw = 0.3 }\ngravity = [0, 0, -0.01]",
    ));
    assert_eq!(c.structure_of(0).unwrap().freedoms(3).len(), 6);
    let modes = "model = \"modal\"\n[[structure.mode]]\nname = \"bending\"\nfile = \"bend.csv\"\nmass = 2\nreduced_frequency = 0.3\n\
                 force = \"sin(t)\"\n[[structure.mode]]\nname = \"torsion\"\nfile = \"twist.csv\"\nmass = 1\nstiffness = 3\n";
    let c = case(&solid(modes));
    assert_eq!(c.structure_of(0).unwrap().modes.len(), 2);
    assert_eq!(c.files().collect::<Vec<_>>(), ["bend.csv", "twist.csv"]);
}

#[test]
fn structures_without_what_they_need_are_refused() {
    let pieces =
        ["no elastic axis", "has no mass", "no moment of inertia", "no spring for `plunge`", "no spring for `pitch`"];
    told(&structure(""), &pieces);
    told(&structure("model = \"modal\""), &["has no modes"]);
    told(&solid("model = \"rigid_body\"\nmass = 1\ncentre_of_mass = [0, 0, 0]"), &["no moment of inertia"]);
    told(
        &solid(""),
        &["a typical section needs a 2-D case", "no elastic axis", "no mass", "no moment", "`plunge`", "`pitch`"],
    );
    let mode = "model = \"modal\"\nmass = 3\n[[structure.mode]]\nname = \"a b\"\nfile = \"f\"\nmass = 1\n";
    told(&structure(mode), &["`mass` does not apply to modes", "cannot be the name of a mode", "has no spring"]);
    let flap = format!("{ISOGAI}flap = {{ x_beta = 0.1, r_beta2 = 0.1 }}");
    told(&structure(&flap), &["the flap has no hinge", "no spring for `flap`"]);
    told(
        &structure(&format!("{ISOGAI}free = [\"plunge\", \"pitch\", \"flap\"]")),
        &["there is no flap", "no spring for `flap`"],
    );
}

#[test]
fn structures_that_contradict_themselves_are_refused() {
    told(
        &structure(&format!("{ISOGAI}mass = 3\npivot = [0, 0]\nspeed_index = 2")),
        &[
            "`pivot` and `elastic_axis` are both given",
            "`mass` and `mass_ratio` are both given",
            "`reduced_speed` and `speed_index` are both given",
        ],
    );
    told(&structure(&format!("{ISOGAI}stiffness = {{ pitch = 3 }}")), &["the spring of `pitch` is given twice"]);
    told(
        &structure(&format!("{ISOGAI}damping_ratio = {{ pitch = 0.1 }}\ndamping = {{ pitch = 1 }}")),
        &["damping of `pitch` is given twice"],
    );
    told(&structure(&format!("{ISOGAI}initial = {{ surge = 1 }}")), &["`initial` of `surge`, which is not free"]);
    told(
        &structure(&format!("{ISOGAI}free = [\"sway\"]")),
        &[
            "there is no `sway` in a 2-D case",
            "fixes the spring of pitch or plunge",
            "over the frequency of pitch",
            "no spring for `sway`",
        ],
    );
    told(&structure(&ISOGAI.replace("mass_ratio = 60", "mass = \"3 kg/m\"")), &["has a unit of mass or time"]);
    told(
        &structure(&format!("{ISOGAI}force = {{ pitch = \"sn(t)\", plunge = \"cos(omega*t)\" }}")),
        &["unknown name `sn`", "uses `omega`, but there is no frequency"],
    );
    told(&structure(&format!("{ISOGAI}stifness = {{ pitch = 3 }}")), &["did you mean `stiffness`?"]);
    told(
        &structure(&format!("{ISOGAI}pivot = [0, 0, 0]").replace("elastic_axis = -2.0\n", "")),
        &["has 3 components in a 2-D case"],
    );
}

#[test]
fn structures_belong_to_bodies() {
    let other = "[[body]]\nnaca = \"0006\"\n";
    told(&format!("{}{other}", structure(ISOGAI)), &["does not say which body it is"]);
    told(&structure(&format!("body = \"wng\"\n{ISOGAI}")), &["did you mean `\"wing\"`?"]);
    let twice = format!("{HEAD}[[structure]]\n{ISOGAI}[[structure]]\n{ISOGAI}");
    told(&twice, &["the body `wing` has two structures"]);
    told(
        &format!("{}[motion]\nplunge = 0.1\nperiod = 3\n", structure(ISOGAI)),
        &["cannot have a prescribed motion as well"],
    );
    let bare = "[flow]\nmach = 0.3\n[cloud]\nspacing = 0.1\ndomain = { min = [0, 0], max = [1, 1] }\n[structure]\n";
    told(&format!("{bare}{ISOGAI}"), &["has no body"]);
}

#[test]
fn a_force_with_a_frequency_makes_periods() {
    let march = "steps_per_period = 64\nperiods = 3\n";
    let text = structure(ISOGAI).replace("until = 1\nstep = 0.1\n", march);
    told(
        &text,
        &["`time.dual.periods` needs a periodic motion", "`time.dual.steps_per_period` needs a periodic motion"],
    );
    case(&format!("{text}force = {{ pitch = \"cos(omega*t)\", period = 20 }}\n"));
}

#[test]
fn masses_springs_and_dampers_of_all_kinds_have_units() {
    let air = |body: &str| body.replace("mach = 0.3\n", AIR);
    let mode = |keys: &str| format!("model = \"modal\"\n[[structure.mode]]\nname = \"a\"\nfile = \"a.csv\"\n{keys}\n");
    let one = |text: &str| case(text).structures[0].modes[0].clone();
    let whole = one(&air(&solid(&mode(
        "mass = \"10 kg\"\nstiffness = \"2 kN/m\"\ninitial_rate = \"3 1/s\"\ndamping_ratio = \"2 %\"",
    ))));
    assert_eq!((whole.mass, whole.stiffness, whole.initial_rate, whole.damping_ratio), (10.0, Some(2000.0), 3.0, 0.02));
    let spread = one(&air(&structure(&mode("mass = \"10 kg/m\"\nfrequency = \"5 Hz\""))));
    assert_eq!(spread.mass, 10.0);
    told(&air(&structure(&mode("mass = \"10 kg\"\nfrequency = \"5 Hz\""))), &["per span"]);
    told(&air(&solid(&mode("mass = \"10 kg/m\"\nfrequency = \"5 Hz\""))), &["but the case is 3-D"]);
    told(&solid(&mode("mass = \"10 kg\"\nreduced_frequency = 0.1")), &["the free stream is nondimensional"]);
    let free = "model = \"rigid_body\"\nfree = [\"plunge\", \"pitch\"]\npivot = [0.3, 0]\nmass = \"3 kg/m\"\ninertia = [\"0.2 kg·m\"]\n\
                stiffness = { plunge = \"9 N/m²\" }\nsprings = { plunge = { cubic = \"40 1/m2\" } }\n";
    let body = case(&air(&structure(&format!("{free}damping = {{ plunge = \"4 N s/m2\", pitch = \"2 N s/rad\" }}"))));
    let s = &body.structures[0];
    assert_eq!((s.damping["plunge"], s.damping["pitch"], s.springs["plunge"].cubic), (4.0, 2.0, 40.0));
    told(&air(&structure(&format!("{free}damping = {{ plunge = \"4 N s/m\" }}"))), &["per span"]);
    told(&air(&structure(&free.replace("kg·m", "kg·m²"))), &["per span"]);
}

#[test]
fn numbers_that_no_structure_has_are_refused_with_what_is_allowed() {
    let wrong = |from: &str, to: &str, pieces: &[&str]| told(&structure(&ISOGAI.replace(from, to)), pieces);
    wrong("x_alpha = 1.8", "x_alpha = 1e20", &["`structure[0].x_alpha` is 1e20, but must be from -100 to 100"]);
    wrong("mass_ratio = 60", "mass_ratio = 1e-30", &["must be from 1e-6 to 1e9"]);
    wrong("r_alpha2 = 3.48", "r_alpha2 = 1e300", &["`structure[0].r_alpha2` is 1e300, but must be from 1e-9 to 10000"]);
    wrong("reduced_speed = 18.4", "reduced_speed = 1e12", &["`structure[0].reduced_speed` is 1e12"]);
    wrong("elastic_axis = -2.0", "elastic_axis = -1e9", &["`structure[0].elastic_axis` is -1e9"]);
    let shown =
        read(&structure(&ISOGAI.replace("x_alpha = 1.8", "x_alpha = 1e20")), "case.toml").unwrap_err().render(false);
    let words = ["case.toml:14:11", "allowed: from -100 to 100", "hint: check its unit and its exponent"];
    words.iter().for_each(|w| assert!(shown.contains(w), "no `{w}` in {shown}"));
    let more = |keys: &str, pieces: &[&str]| told(&structure(&format!("{ISOGAI}{keys}\n")), pieces);
    more("initial = { pitch = \"9000 deg\" }", &["`structure[0].initial.pitch` is 9000 deg, 25 turns"]);
    more("initial = { plunge = 1e9 }", &["`structure[0].initial.plunge` is 1e9"]);
    more("springs = { pitch = { rest = \"10 rad\" } }", &["`structure[0].springs.pitch.rest` is 572.96 deg"]);
    more("damping_ratio = { pitch = 1e3 }", &["must be from 0 to 100"]);
    case(&structure(&format!("{ISOGAI}initial = {{ pitch = \"-360 deg\" }}")));
}

#[test]
fn sections_with_more_unbalance_than_their_inertia_allows_are_refused() {
    let heavy = ISOGAI.replace("x_alpha = 1.8", "x_alpha = -1.9");
    told(
        &structure(&heavy),
        &["`x_alpha` is -1.9, but with `r_alpha2` = 3.48 no body has its centre of mass that far"],
    );
    let flap = "flap = { hinge = 0.6, x_beta = 0.2, r_beta2 = 0.01, frequency_ratio = 3 }";
    told(&structure(&format!("{ISOGAI}{flap}")), &["`x_beta` is 0.2, but with `r_beta2` = 0.01"]);
}
