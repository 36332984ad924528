//! Solids as users write them: whole files, and their mistakes.
use crate::case::{
    Case, Contact, Everywhere, JohnsonCook, Length, PerTime, PlaneState, Pressure, SolidAxis, SolidBox, SolidFill,
    SolidLaw, SolidPlace, Temperature, Temporal, read, write,
};

const PLATE: &str = "[[body]]\nbox = { size = [1, 0.1] }\n";
const STEEL: &str = "material = { density = 7800, young = \"200 GPa\", poisson = 0.3 }\n";

/// A plate of steel with more keys of its solid, and what follows.
fn plate(keys: &str, rest: &str) -> String {
    format!("{PLATE}[body.solid]\nthrough = 5\n{STEEL}{keys}\n{rest}\n")
}

/// The same of another material.
fn of(material: &str) -> String {
    format!("{PLATE}[body.solid]\nthrough = 5\nmaterial = {material}\n")
}

fn case(text: &str) -> Case {
    read(text, "case.toml").unwrap_or_else(|e| panic!("{e}\nfor\n{text}"))
}

/// Exactly one mistake, with all the pieces.
fn told(text: &str, pieces: &[&str]) {
    let shown = read(text, "case.toml").expect_err(text).render(false);
    for piece in pieces {
        assert!(shown.contains(piece), "`{piece}` is missing in\n{shown}\nfor\n{text}");
    }
    assert_eq!(shown.matches("error: ").count(), 1, "{shown}\nfor\n{text}");
}

const EVERYTHING: &str = r#"
[[body]]
name = "bar"
box = { size = [1, 0.1] }
[body.solid]
spacing = "5 mm"
fill = "relaxed"
jitter = 0.2
plane = "axisymmetric"
stabilisation = 0.5
viscosity = 0.1
damping = "3 1/s"
stiffness_damping = "1 us"
velocity = [1e-5, "-2*x^2 + y"]
gravity = [0, "-1 g"]
[body.solid.material]
base = "copper"
law = "plastic"
density = "8.96 g/cm3"
young = "124 GPa"
poisson = 0.34
johnson_cook = { a = "90 MPa", b = "292 MPa", n = 0.31, c = 0.025, rate = 1, m = 1.09, melt = "1356 K", room = "20 degC" }
perzyna = { viscosity = "1 ms" }
heat_capacity = "383 J/kg/K"
heating = 1
temperature = "300 K"
[[body.solid.region]]
where = { x_min = "10 cm", y_max = 0 }
material = { density = 1000, shear = "1 MPa", bulk = "100 MPa", relaxation = [[0.3, 0.01], [0.2, 1]] }
[[body.solid.region]]
where = { x_max = "-10 cm" }
material = "lead"
[[body.solid.support]]
where = { x_max = -0.499 }
fix = ["y", "x"]
motion = ["0.1 * t", 0]
[[body.solid.support]]
where = { y_max = 0 }
fix = "y"
motion = "sin(omega * t)"
[[body.solid.load]]
where = "all"
pressure = "1 bar"
history = "min(t, 1)"
[[body.solid.load]]
where = { x_min = 0.4 }
traction = [0, "-1 kPa"]
[[body.solid.load]]
where = { x_min = 0.4 }
force = [0, "2 kN"]
[[body.solid.probe]]
name = "tip"
at = [0.5, 0]
[contact]
planes = [{ point = [0, -1], normal = [0, 2] }]
friction = 0.2
[time.harmonics]
number = 3
frequency = "5 Hz"
"#;

#[test]
fn a_solid_with_every_key_reads_back_to_itself() {
    let c = case(EVERYTHING);
    assert!(!c.has_gas());
    let (_, _, solid) = c.solids().next().unwrap();
    assert_eq!((solid.spacing, solid.through, solid.fill), (Some(Length(0.005)), None, Some(SolidFill::Relaxed)));
    assert_eq!(
        (solid.plane, solid.damping, solid.velocity[0].as_str()),
        (PlaneState::Axisymmetric, PerTime(3.0), "1e-5")
    );
    let copper = &solid.material;
    assert_eq!(
        (copper.base.as_deref(), copper.law(), copper.heating()),
        (Some("copper"), Some(SolidLaw::Plastic), Some(1.0))
    );
    let JohnsonCook { a, melt, room, .. } = copper.johnson_cook.unwrap();
    assert_eq!((a, melt, room), (Pressure(90e6), Some(Temperature(1356.0)), Temperature(293.15)));
    assert_eq!(solid.regions[0].material.law(), Some(SolidLaw::Viscoelastic));
    assert_eq!((solid.regions[1].material.base.as_deref(), solid.regions[1].material.law()), (Some("lead"), None));
    assert_eq!(solid.supports[0].axes(2), [SolidAxis::Y, SolidAxis::X]);
    assert_eq!(solid.supports[1].motion, ["sin(omega * t)"]);
    assert_eq!(solid.loads[0].place, SolidPlace::All(Everywhere::All));
    let end = SolidBox { x_min: Some(Length(0.4)), ..SolidBox::default() };
    assert_eq!(solid.loads[1].place, SolidPlace::Box(end));
    assert!(solid.loads[1].place.contains(&[0.4, 7.0], 0.0) && !solid.loads[1].place.contains(&[0.3, 0.0], 0.05));
    assert!((c.balance_frequency().unwrap() - 10.0 * std::f64::consts::PI).abs() < 1e-12);
    let Some(Contact { bodies, stiffness, .. }) = c.contact else { panic!("{c:?}") };
    assert_eq!((bodies, stiffness), (true, 1.0));
    let written = write(&c);
    assert!(!written.contains("[flow]") && !written.contains("[cloud]"), "{written}");
    let again = read(&written, "case.toml").unwrap_or_else(|e| panic!("{e}\n{written}"));
    assert_eq!((again, write(&c)), (c.clone(), written));
}

#[test]
fn defaults_are_the_documented_ones() {
    let c = case(&plate("", ""));
    let (_, _, s) = c.solids().next().unwrap();
    assert_eq!((s.jitter, s.plane, s.thickness, s.stabilisation), (0.0, PlaneState::Strain, Length(1.0), None));
    assert_eq!((s.fill, s.viscosity, s.material.law()), (None, None, Some(SolidLaw::NeoHookean)));
    assert!(s.velocity.is_empty() && s.gravity.is_empty() && s.supports.is_empty());
    assert_eq!((c.contact.as_ref(), &c.time), (None, &Temporal::default()));
    assert_eq!(c.flow.units().speed, 1.0);
    let law = |material: &str| case(&of(material)).solids().next().unwrap().2.material.law();
    assert_eq!(law("\"steel\""), None);
    assert_eq!(law("{ base = \"steel\", yield = \"1 GPa\" }"), Some(SolidLaw::Plastic));
    let march = case(&plate("", "[time.newmark]\nstep = \"1 ms\"\nuntil = 1"));
    let Temporal::Newmark(n) = &march.time else { panic!("{march:?}") };
    assert_eq!((n.rho_infinity, n.tolerance, n.iterations), (0.9, 1e-8, 20));
    assert_eq!((march.end(None), march.step_length(None), march.is_unsteady()), (Some(1.0), Some(1e-3), true));
    let Temporal::Modes(m) = case(&format!("time = \"modes\"\n{}", plate("", ""))).time else { panic!("no modes") };
    assert_eq!((m.number, m.shift, m.preload), (6, None, false));
}

#[test]
fn constants_for_each_axis_stand_for_the_moduli() {
    const WOOD: &str = "orthotropic = { young = [12e9, 1e9, 8e8], poisson = [0.35, 0.4, 0.45], shear = [9e8, 7e8, 2e8], axis_1 = [1, 1, 0] }";
    let c = case(&of(&format!("{{ density = 500, {WOOD} }}")));
    let material = &c.solids().next().unwrap().2.material;
    assert_eq!(material.law(), Some(SolidLaw::Orthotropic));
    let constants = material.orthotropic.as_ref().unwrap();
    assert_eq!((constants.young[2], constants.axis_3.as_ref()), (Pressure(8e8), None));
    assert_eq!(read(&write(&c), "case.toml").unwrap(), c);
    told(&of(&format!("{{ density = 500, young = 1e9, {WOOD} }}")), &["`young`", "orthotropic", "remove it"]);
    told(&of(&format!("{{ density = 500, law = \"linear\", {WOOD} }}")), &["linear", "remove `law`"]);
    told(&of("{ density = 500, law = \"orthotropic\" }"), &["no constants for each axis", "E1, E2, E3"]);
}

#[test]
fn structures_alone_have_no_gas_and_others_do() {
    let alone = |rest: &str, piece: &str| told(&plate("", rest), &["structures alone", piece]);
    alone("[cloud]\nspacing = 0.1", "`cloud` is for cases with a gas");
    alone("[boundary]\nx_min = \"held\"", "`boundary`");
    alone("[scheme]\norder = 1", "`scheme`");
    alone("[reference]\nchord = 1", "`reference`");
    alone("[[hinge]]\nfrom = [0, 0]", "`hinge`");
    alone("[adapt]\ncycles = 1", "`adapt`");
    alone("[accuracy]\nloads = 0.01", "`accuracy`");
    alone("[time.dual]\nstep = 1\nuntil = 2", "[time.newmark]");
    alone("[[body]]\ncircle = { radius = 1 }", "`body-2` is rigid");
    told("[[body]]\ncircle = { radius = 1 }\n", &["the free stream has no speed", "add `mach = 0.8`"]);
    told(&plate("", "[flow]\ngamma = 1.3").replace("\"200 GPa\"", "2e11"), &["the free stream has no speed"]);
    let air = "[flow]\nmach = 0.5\npressure = 101325\ntemperature = 288.15\n";
    let c = case(&format!("{air}{}", plate("", "[time.explicit]\nuntil = \"1 ms\"\n[cloud]\nspacing = 0.1")));
    assert!(c.has_gas());
    assert_eq!(case(&write(&c)), c);
    let gas = |rest: &str, piece: &str| told(&format!("{air}{}", plate("", rest)), &[piece]);
    gas("[time.newmark]\nstep = 1\nuntil = 2", "`time.newmark` is for structures alone");
    gas("[time.modes]", "`time.modes` is for structures alone");
    gas("[time.steady]\nload_steps = 2", "`time.steady.load_steps` is for structures alone");
    let tube = "initial.riemann = { left = [2, 0, 2e5], right = [1, 0, 1e5] }\n[flow]\ndensity = 1\npressure = 1e5\n\
                [cloud]\nspacing = 0.1\ndomain = { min = [-4, -4], max = [4, 4] }\n[boundary]\nx_min = \"held\"\n\
                x_max = \"outflow\"\ny_min = \"outflow\"\ny_max = \"outflow\"\n[time.explicit]\nuntil = 1\n";
    let c = case(&format!("{tube}{}", plate("", "")));
    assert!(c.has_gas() && c.flow.is_dimensional());
    assert_eq!(case(&write(&c)), c);
}

#[test]
fn solids_that_contradict_themselves_are_refused() {
    told(&plate("spacing = 0.1", ""), &["`spacing` and `through` are both given"]);
    told(&plate("velocity = [\"x\", \"z\"]", ""), &["unknown name `z`", "case.toml:6:19", "names are x, y, t"]);
    told(&plate("velocity = [1]", ""), &["has 1 components in a 2-D case"]);
    told(&plate("gravity = [0, 0, 1]", ""), &["`body-1.solid.gravity` has 3 components"]);
    told(&plate("plane = \"axisymmetric\"\nthickness = 2", ""), &["which is a full turn"]);
    told(
        &plate("thickness = 2", "[flow]\nmach = 0.5\npressure = 101325\ntemperature = \"15 degC\""),
        &["beside a gas, which acts on one unit of length"],
    );
    let other = "[[body]]\nbox = { size = [1, 0.1] }\ntranslate = [0, 3]\nsolid = { material = { density = 1, young = 1, poisson = 0.3 }, through = 5, gravity = [0, -1] }";
    told(&plate("gravity = [0, -2]", other), &["which holds for all bodies made of particles"]);
    told(&plate("plane = \"axisymmetric\"\ngravity = [1, 0]", ""), &["`body-1.solid.gravity` across the axis"]);
    let cube = plate("plane = \"stress\"", "").replace("[1, 0.1]", "[1, 1, 1]");
    told(&cube, &["`body-1.solid.plane` needs a 2-D case"]);
    told(
        &plate("", "[body.motion]\ntranslation = [1, 0]\n[time.explicit]\nuntil = 1"),
        &["made of particles cannot have a prescribed motion"],
    );
    let air = "[flow]\nmach = 0.5\npressure = 101325\ntemperature = 288.15\n";
    let sprung = "[structure]\nmodel = \"rigid_body\"\nmass = 1\nfree = \"plunge\"\nstiffness = { plunge = 1 }\n[time.dual]\nstep = 1\nuntil = 2";
    told(&format!("{air}{}", plate("", sprung)), &["a body made of particles cannot be on springs"]);
    told(&format!("{air}{}", plate("plane = \"axisymmetric\"", "")), &["cannot be in the plane flow"]);
    told(&format!("[flow]\nmach = 0.5\n{}", of("\"steel\"")), &["free stream is nondimensional"]);
    told(&format!("[flow]\nmach = 0.5\n{}", plate("", "")), &["`body-1.solid.material.young` has a unit"]);
    told(&format!("{PLATE}[body.solid]\nthrough = 5\n"), &["missing table `material`"]);
    told(
        &plate("probe = [{ name = \"a\", at = [0, 0] }, { name = \"a\", at = [1, 0] }]", ""),
        &["two probes are called `a`"],
    );
    told(&plate("probe = [{ name = \"a\", at = [0, 0, 0] }]", ""), &["has 3 components in a 2-D case"]);
}

#[test]
fn materials_that_cannot_be_are_refused() {
    let no = |material: &str, piece: &str| told(&of(material), &[piece]);
    no("{ density = 1, young = 1 }", "has `young` alone");
    no("{ density = 1 }", "has no elastic modulus");
    no("{ young = 1, poisson = 0.3 }", "has no density");
    no("{ density = 1, young = 1, poisson = 0.3, bulk = 1 }", "has 3 elastic moduli");
    no("{ density = 1, young = 1, poisson = 0.5 }", "less than 0.5");
    no("{ density = 1, young = 1, poisson = -1 }", "must be greater than -1");
    no("{ density = 1, young = 4, shear = 1 }", "is 1, but must be");
    let e = "density = 1, young = 1, poisson = 0.3";
    no(&format!("{{ {e}, law = \"plastic\" }}"), "is plastic, but never yields");
    no(&format!("{{ {e}, law = \"linear\", yield = 1 }}"), "`yield` of a material whose law is `linear`");
    no(&format!("{{ {e}, hardening = 1 }}"), "`hardening` of a material that never yields");
    no(&format!("{{ {e}, yield = 1, saturation = 1 }}"), "needs both `saturation` and `saturation_rate`");
    no(&format!("{{ {e}, yield = 1, johnson_cook = {{ a = 1, b = 1, n = 1 }} }}"), "are both given");
    no(&format!("{{ {e}, relaxation = [[0.6, 1], [0.4, 2]] }}"), "nothing of the stress would stay");
    no(&format!("{{ {e}, law = \"neo_hookean\", relaxation = [[0.6, 1]] }}"), "whose law is `neo_hookean`");
    no(&format!("{{ {e}, law = \"viscoelastic\" }}"), "never relaxes");
    no(&format!("{{ {e}, yield = 1, heating = 0.9 }}"), "without a heat capacity");
    no(&format!("{{ {e}, johnson_cook = {{ a = 1, b = 1, n = 1, melt = 200 }} }}"), "not above `room`");
    no(&format!("{{ {e}, nu = 0.3 }}"), "did you mean `poisson`?");
    told(
        &plate("region = { where = { x_max = 0 }, material = { density = 1 } }", ""),
        &["`body-1.solid.region[0].material` has no elastic modulus"],
    );
}

#[test]
fn supports_loads_and_contact_that_cannot_be_are_refused() {
    let no = |keys: &str, piece: &str| told(&plate(keys, ""), &[piece]);
    no("support = { where = {} }", "has no bound");
    no("support = { where = \"left\" }", "cannot be `left`");
    no("support = { where = { z_min = 0 } }", "bounds `z` in a 2-D case");
    no("support = { where = { x_min = 1, x_max = 0 } }", "is empty");
    no("support = { where = { x_min = 1 }, fix = \"z\" }", "no axis `z`");
    no("support = { where = { x_min = 1 }, fix = [\"x\", \"x\"] }", "names an axis twice");
    no("support = { where = { x_min = 1 }, fix = \"x\", motion = [0, 1] }", "has 2 displacements, but 1 axes");
    no("support = { where = { x_min = 1 }, fix = \"x\", motion = \"x\" }", "unknown name `x`");
    no("support = { where = { x_min = 1 }, fix = \"x\", motion = \"omega * t\" }", "there is no frequency");
    no("support = { fix = \"x\" }", "missing key `where`");
    no("load = { where = \"all\" }", "`body-1.solid.load[0]` has no load");
    no("load = { where = \"all\", pressure = 1, force = [0, 1] }", "`pressure` and `force` are both given");
    no("load = { where = \"all\", force = [0, 1, 2] }", "has 3 components");
    no("load = { where = \"all\", pressure = 1, history = \"min(t)\" }", "takes two arguments");
    told(&plate("", "[contact]\nplanes = { point = [0, 0], normal = [0, 0] }"), &["a direction of no length"]);
    told(&plate("", "[contact]\nplanes = { point = [0, 0], normal = [0, 0, 1] }"), &["has 3 components"]);
    told("[flow]\nmach = 0.5\n[[body]]\nnaca = \"0012\"\n[contact]\n", &["`[contact]` is of bodies made of particles"]);
    told(&plate("", "[time.harmonics]\nnumber = 2"), &["`time.harmonics` has no frequency"]);
    told(
        &plate("", "[time.harmonics]\nnumber = 2\nfrequency = \"1 Hz\"\ncheck = 3"),
        &["`time.harmonics.check` is for"],
    );
    told(&plate("", "[time.harmonics]\nnumber = 2\nfrequency = \"1 Hz\"\nperiod = 1"), &["both given"]);
}

#[test]
fn numbers_that_no_solid_has_are_refused_with_what_is_allowed() {
    let no = |material: &str, piece: &str| told(&of(material), &[piece]);
    no("{ density = 1e30, young = 1, poisson = 0.3 }", "must be from 1e-9 to 1e9");
    no("{ density = 1, young = 1e40, poisson = 0.3 }", "must be from 1e-9 to 1e18");
    no("{ density = 1, young = 1e-40, poisson = 0.3 }", "must be from 1e-9 to 1e18");
    no("{ density = 1, young = 1, poisson = 0.3, yield = 1, hardening = 1e40 }", "must be from 0 to 1e18");
    no("{ density = 1, young = 1, poisson = 0.3, temperature = 1e9 }", "greater than 0 and at most 1e6");
    told(&plate("gravity = [0, -1e20]", ""), &["must be from -1e6 to 1e6", "check its unit and its exponent"]);
    told(&plate("load = { where = \"all\", pressure = 1e30 }", ""), &["must be from -1e18 to 1e18"]);
}
