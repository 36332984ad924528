//! The keys of `[body.solid]` and `[contact]`.
use super::kinds::{LENGTH, POINT, SIZE};
use super::quantity::{Acceleration, Density, Force, Length, PerTime, Pressure, SpecificHeat, Temperature, Time};
use super::schema::{Absent, Field, Kind, List, Range, Table};

const ANY: Kind = Kind::Number(Range::ANY);
const PART: Kind = Kind::Number(Range::between(0.0, 1.0));
/// What no solid is beyond, in SI units, or those of a nondimensional stream: numbers that are larger, or smaller, are slips of a unit or
/// of an exponent, and what is computed of them is round-off.
const STRESSES: f64 = 1e18;
const MODULUS: Kind = Kind::Quantity(Pressure::DIMENSION, Range::between(1e-9, STRESSES));
const STRESS: Kind = Kind::Quantity(Pressure::DIMENSION, Range::between(0.0, STRESSES));
const STRESS_OF_ANY_SIGN: Kind = Kind::Quantity(Pressure::DIMENSION, Range::between(-STRESSES, STRESSES));
const DENSITY: Kind = Kind::Quantity(Density::DIMENSION, Range::between(1e-9, 1e9));
const KELVIN: Kind = Kind::Quantity(Temperature::DIMENSION, Range { min: 0.0, max: 1e6, closed: false });
const NUMBER: Kind = Kind::Number(Range::between(0.0, 1e6));
const THICKNESS: Kind = Kind::Quantity(Length::DIMENSION, Range::between(1e-9, 1e6));
const ACCELERATION: Kind = Kind::Quantity(Acceleration::DIMENSION, Range::between(-1e6, 1e6));
const HEAT_CAPACITY: Kind = Kind::Quantity(SpecificHeat::DIMENSION, Range { min: 0.0, max: 1e9, closed: false });
const OF_RELAXATION: Kind = Kind::Number(Range::between(1e-15, 1e12));
const STRAIN_RATE: Kind = Kind::Quantity(PerTime::DIMENSION, Range::between(1e-12, 1e12));
const OVERSTRESS_TIME: Kind = Kind::Quantity(Time::DIMENSION, Range::between(1e-15, 1e12));
const FORCE: Kind = Kind::Quantity(Force::DIMENSION, Range::between(-1e18, 1e18));
const FORMULAS: Kind = Kind::List(&List { item: Kind::Formula, min: 0, max: 3, single: false });
const PLACE: Kind = Kind::TableOr(&PLACE_KEYS, "all");
/// No more than a lattice bears before particles meet.
const MOST_JITTER: f64 = 0.4;
const FROM_BASE: &str = "that of `base`";
const TWO: &str = "that of `base`, or from two others";

pub(super) static SOLID: Table = Table::of(&[
    Field::required(
        "material",
        Kind::Table(&MATERIAL),
        "Material where no region has another one: a name of the catalogue, `material = \"aluminium 2024-T3\"`, or its numbers.",
    ),
    Field::optional("spacing", SIZE, "from `through`", "Distance of particles."),
    Field::optional(
        "through",
        Kind::Integer(2, 100_000),
        "9, or from `spacing`",
        "Number of particles through the shortest side of the body instead, both surfaces counted.",
    ),
    Field::optional(
        "fill",
        Kind::Words(FILLS),
        "`\"lattice\"` in boxes, `\"relaxed\"` in others",
        "How particles fill the body.",
    ),
    Field::defaulted(
        "jitter",
        Kind::Number(Range::between(0.0, MOST_JITTER)),
        Absent::Number(0.0),
        "Random displacement of particles inside as a fraction of the spacing (for tests of robustness).",
    ),
    Field::defaulted("plane", Kind::Words(PLANES), Absent::Word("strain"), "What holds across the plane (2-D)."),
    Field::defaulted(
        "thickness",
        THICKNESS,
        Absent::Number(1.0),
        "Thickness of bodies in the plane: masses, energies and forces are those of so much of them; not beside a gas, which acts on one unit of length.",
    ),
    Field::optional(
        "stabilisation",
        PART,
        "0.3 in the plane, 0.4 in space",
        "Strength of the forces against zigzag modes, whose strains particles do not see: as a part of the modulus of the material.",
    ),
    Field::optional(
        "viscosity",
        PART,
        "0.1 in explicit marches of plastic materials, with contact or with a gas; 0 otherwise",
        "Artificial viscosity that holds shocks.",
    ),
    Field::defaulted(
        "damping",
        Kind::Quantity(PerTime::DIMENSION, Range::between(0.0, 1e12)),
        Absent::Number(0.0),
        "Damping α in proportion to mass, force −α m v.",
    ),
    Field::defaulted(
        "stiffness_damping",
        Kind::Quantity(Time::DIMENSION, Range::between(0.0, 1e6)),
        Absent::Number(0.0),
        "Damping β in proportion to stiffness: second Piola-Kirchhoff stress β C₀ : Ė, damping ratio βω/2 of small vibration.",
    ),
    Field::defaulted(
        "velocity",
        FORMULAS,
        Absent::Filled,
        "Velocity at the start, a number or a formula in `x`, `y`, `z` of the body as placed for each axis: `[0, \"2 * x^2\"]`.",
    ),
    Field::defaulted(
        "gravity",
        Kind::List(&List { item: ACCELERATION, min: 0, max: 3, single: false }),
        Absent::Filled,
        "Acceleration of gravity, `[0, \"-9.81 m/s2\"]`.",
    ),
    Field::defaulted(
        "region",
        Kind::Tables(&REGION),
        Absent::Filled,
        "Another material inside a box; of several the last one counts.",
    ),
    Field::defaulted(
        "support",
        Kind::Tables(&SUPPORT),
        Absent::Filled,
        "Where particles of the body are held, or led along a given path.",
    ),
    Field::defaulted("load", Kind::Tables(&LOAD), Absent::Filled, "A load on the surface; several add up."),
    Field::defaulted("probe", Kind::Tables(&PROBE), Absent::Filled, "A point whose displacement is recorded."),
]);

const FILLS: &[(&str, &str)] = &[
    ("lattice", "on a lattice along the axes of the shape"),
    ("relaxed", "moved until their distances are even and the outer ones lie on the surface"),
];

const PLANES: &[(&str, &str)] = &[
    ("strain", "no strain across the plane"),
    ("stress", "no stress across the plane"),
    ("axisymmetric", "the y axis is the axis of revolution, x is the radius and not negative"),
];

static MATERIAL: Table = Table::of(&[
    Field::optional("base", Kind::Text, "all numbers must be given", "Name in the catalogue of materials; what is given beside it replaces its numbers."),
    Field::optional(
        "law",
        Kind::Words(LAWS),
        "`\"orthotropic\"` with `orthotropic`, `\"plastic\"` with `yield` or `johnson_cook`, `\"viscoelastic\"` with `relaxation`, else that of `base`, else `\"neo_hookean\"`",
        "Constitutive law.",
    ),
    Field::optional("density", DENSITY, FROM_BASE, "Density."),
    Field::optional("young", MODULUS, TWO, "Young's modulus E; two of `young`, `poisson`, `shear` and `bulk` are given.")
        .known_as(&["e", "youngs_modulus", "elasticity"]),
    Field::optional(
        "poisson",
        Kind::Number(Range { min: -1.0, max: 0.5, closed: false }),
        TWO,
        "Poisson's ratio ν, less than 0.5.",
    )
    .known_as(&["nu", "poissons_ratio"]),
    Field::optional("shear", MODULUS, TWO, "Shear modulus G.").known_as(&["g", "mu", "shear_modulus"]),
    Field::optional("bulk", MODULUS, TWO, "Bulk modulus K.").known_as(&["k", "bulk_modulus"]),
    Field::optional(
        "orthotropic",
        Kind::Table(&ORTHOTROPIC),
        "one modulus for all directions",
        "Constants of a material with three planes of symmetry, wood or a laminate, in place of the moduli above.",
    ),
    Field::optional("yield", MODULUS, "that of `base`, or from `johnson_cook`", "Yield stress.")
        .known_as(&["yield_stress", "yield_strength"]),
    Field::optional("hardening", STRESS, "that of `base`, or none", "Modulus of the linear isotropic hardening."),
    Field::optional(
        "saturation",
        STRESS,
        "that of `base`, or none",
        "Stress Q of the exponential hardening Q (1 − exp(−δ ε)).",
    ),
    Field::optional("saturation_rate", NUMBER, "that of `base`, or none", "Its rate δ."),
    Field::optional("kinematic", STRESS, "that of `base`, or none", "Modulus of the linear kinematic hardening."),
    Field::optional(
        "johnson_cook",
        Kind::Table(&JOHNSON_COOK),
        "that of `base`, or from `yield`",
        "Yield stress (a + b εⁿ)(1 + c ln(ε̇/rate))(1 − T*ᵐ) of Johnson and Cook instead, T* = (T − room)/(melt − room).",
    ),
    Field::optional(
        "perzyna",
        Kind::Table(&PERZYNA),
        "that of `base`, or none: stresses do not exceed the yield stress",
        "Plastic strain by overstress, at the rate (overstress over yield stress)^exponent/viscosity.",
    ),
    Field::optional(
        "heat_capacity",
        HEAT_CAPACITY,
        "that of `base`, or plastic work heats nothing",
        "Heat capacity of a unit of mass.",
    ),
    Field::optional("heating", PART, "0.9 where the heat capacity is known", "Part of the plastic work that becomes heat."),
    Field::optional("temperature", KELVIN, "`room` of `johnson_cook`", "Temperature at the start."),
    Field::defaulted(
        "relaxation",
        Kind::List(&List {
            item: Kind::List(&List { item: OF_RELAXATION, min: 2, max: 2, single: false }),
            min: 0,
            max: 32,
            single: false,
        }),
        Absent::Filled,
        "Prony series of the shear modulus, `[[0.3, 0.01], [0.2, 1]]`: part of the modulus and its time of relaxation in seconds. The moduli \
         above are those of fast loads.",
    ),
])
.short("base");

const LAWS: &[(&str, &str)] = &[
    ("linear", "small strains"),
    ("saint_venant_kirchhoff", "large rotations, strains that stay small"),
    ("neo_hookean", "large strains"),
    ("orthotropic", "large rotations, small strains, other constants along each of three axes"),
    ("hypoelastic", "rate of the stress by the rate of strain, in a frame that turns with the material"),
    ("plastic", "large strains, of which a part stays: metals"),
    ("viscoelastic", "large strains whose stress relaxes: rubber, polymers"),
];

const THREE_MODULI: Kind = Kind::List(&List { item: MODULUS, min: 3, max: 3, single: false });
const THREE: Kind = Kind::List(&List { item: ANY, min: 3, max: 3, single: false });

static ORTHOTROPIC: Table = Table::of(&[
    Field::required("young", THREE_MODULI, "Young's moduli along the axes of the material, `[E1, E2, E3]`."),
    Field::required(
        "poisson",
        THREE,
        "Poisson's ratios `[nu12, nu13, nu23]`: contraction along the second number when pulled along the first.",
    ),
    Field::required("shear", THREE_MODULI, "Shear moduli `[G12, G13, G23]`."),
    Field::optional(
        "axis_1",
        THREE,
        "x",
        "Direction of the first axis, the grain or the fibres, of the body as placed.",
    ),
    Field::optional(
        "axis_3",
        THREE,
        "z",
        "Direction to which the third axis is as near as it can be, across the plies.",
    ),
]);

static JOHNSON_COOK: Table = Table::of(&[
    Field::required("a", MODULUS, "Yield stress."),
    Field::required("b", STRESS, "Stress of the hardening."),
    Field::required("n", NUMBER, "Exponent of the hardening."),
    Field::defaulted("c", NUMBER, Absent::Number(0.0), "Factor of the rate of strain."),
    Field::defaulted("rate", STRAIN_RATE, Absent::Number(1.0), "Rate of strain at which the others were measured."),
    Field::defaulted("m", NUMBER, Absent::Number(1.0), "Exponent of the temperature."),
    Field::optional("melt", KELVIN, "no dependence on temperature", "Temperature at which the material melts."),
    Field::defaulted("room", KELVIN, Absent::Number(293.0), "Temperature at which the others were measured."),
]);

static PERZYNA: Table = Table::of(&[
    Field::required("viscosity", OVERSTRESS_TIME, "A time."),
    Field::defaulted("exponent", Kind::Number(Range::between(1e-3, 1e3)), Absent::Number(1.0), "Exponent."),
]);

const fn bound(key: &'static str, doc: &'static str) -> Field {
    Field::optional(key, LENGTH, "no bound", doc)
}

static PLACE_KEYS: Table = Table::of(&[
    bound("x_min", "Smallest x."),
    bound("x_max", "Largest x."),
    bound("y_min", "Smallest y."),
    bound("y_max", "Largest y."),
    bound("z_min", "Smallest z."),
    bound("z_max", "Largest z."),
]);

static REGION: Table = Table::of(&[
    Field::required("where", PLACE, "What lies inside a box, `{ x_max = 0.1 }`, of the body as placed."),
    Field::required("material", Kind::Table(&MATERIAL), "Material of the region."),
]);

static SUPPORT: Table = Table::of(&[
    Field::required(
        "where",
        PLACE,
        "Particles inside a box, `{ x_max = \"1 mm\" }`, of the body as placed; `\"all\"` of them.",
    ),
    Field::defaulted(
        "fix",
        Kind::List(&List { item: Kind::Words(AXES), min: 0, max: 3, single: true }),
        Absent::Filled,
        "Axes along which they are held; none named: all.",
    ),
    Field::defaulted(
        "motion",
        Kind::List(&List { item: Kind::Formula, min: 0, max: 3, single: true }),
        Absent::Filled,
        "Displacement along each of these axes in the same order, a number or a formula in `t`; none: zero.",
    ),
]);

const AXES: &[(&str, &str)] = &[("x", "along x"), ("y", "along y"), ("z", "along z")];

const ONE_LOAD: &str = "another of `pressure`, `traction` and `force`";

static LOAD: Table = Table::of(&[
    Field::required(
        "where",
        PLACE,
        "The part of the surface inside a box, `{ y_min = 0.02 }`, of the body as placed; `\"all\"` of it.",
    ),
    Field::optional(
        "pressure",
        STRESS_OF_ANY_SIGN,
        ONE_LOAD,
        "Pressure, against the outward normal; it follows the surface as that deforms.",
    ),
    Field::optional(
        "traction",
        Kind::List(&List { item: STRESS_OF_ANY_SIGN, min: 2, max: 3, single: false }),
        ONE_LOAD,
        "Force over the area before any deformation, of fixed direction.",
    ),
    Field::optional(
        "force",
        Kind::List(&List { item: FORCE, min: 2, max: 3, single: false }),
        ONE_LOAD,
        "Force on the whole place, spread evenly over its area, of fixed direction.",
    ),
    Field::optional(
        "history",
        Kind::Formula,
        "1",
        "Factor in time, a formula in `t`: `\"min(t/0.01, 1)\"`; with `omega` in a harmonic balance.",
    ),
]);

static PROBE: Table = Table::of(&[
    Field::required("name", Kind::Text, "Name of its columns."),
    Field::required("at", POINT, "The point, of the body as placed."),
]);

pub(super) static CONTACT: Table = Table::of(&[
    Field::defaulted(
        "planes",
        Kind::Tables(&PLANE),
        Absent::Filled,
        "Rigid planes, `{ point = [0, 0], normal = [0, 1] }`.",
    ),
    Field::defaulted("bodies", Kind::Flag, Absent::Flag(true), "Bodies made of particles touch one another."),
    Field::defaulted(
        "stiffness",
        Kind::Number(Range { min: 0.0, max: 10.0, closed: false }),
        Absent::Number(1.0),
        "Stiffness of the contact as a part of the wave modulus times area over spacing.",
    ),
    Field::defaulted("friction", NUMBER, Absent::Number(0.0), "Coefficient of Coulomb's friction."),
]);

static PLANE: Table = Table::of(&[
    Field::required("point", POINT, "A point of the plane."),
    Field::required(
        "normal",
        Kind::List(&List { item: ANY, min: 2, max: 3, single: false }),
        "Its normal, towards the bodies; its length does not matter.",
    ),
]);
