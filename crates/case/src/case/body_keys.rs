//! The keys of `[[body]]`: shapes and where they are placed.
use super::kinds::{ANGLE, LENGTH, PLANE_POINT, POSITIVE, SIZE};
use super::motion_keys::{BODY_MOTION, WALL};
use super::quantity::Angle;
use super::schema::{Absent, Field, Kind, List, Range, Table};
use super::solid_keys::SOLID;

/// Shape keys of a body with the dimension each of them fixes (0: by the number of lengths).
pub(super) const SHAPES: [(&str, u64); 12] = [
    ("naca", 2),
    ("airfoil", 2),
    ("polygon", 2),
    ("circle", 2),
    ("ellipse", 2),
    ("sphere", 3),
    ("box", 0),
    ("surface", 3),
    ("wing", 3),
    ("revolution", 3),
    ("loft", 3),
    ("ellipsoid", 3),
];
const SHAPE: &str = "another shape key";

pub(super) static BODY: Table = Table::of(&[
    Field::optional("name", Kind::Text, "`body-1`, `body-2`, …", "Name used in tables of loads."),
    Field::optional(
        "naca",
        Kind::Table(&NACA),
        SHAPE,
        "NACA section of four or five digits, modified or not, or of the 6-series (2-D), `naca = \"0012\"`, `\"23012\"`, \
         `\"0012-64\"`, `\"63-415\"` or `\"64A010\"`.",
    ),
    Field::optional("airfoil", Kind::File, SHAPE, "Airfoil coordinate file (2-D) in Selig, Lednicer or CSV order.")
        .known_as(&["file", "dat", "coordinates", "section", "profile"]),
    Field::optional(
        "polygon",
        Kind::List(&List { item: PLANE_POINT, min: 3, max: usize::MAX, single: false }),
        SHAPE,
        "Closed polygon with sharp corners (2-D), `[[0, 0], [1, 0.1], [1, -0.1]]`.",
    ),
    Field::optional("circle", Kind::Table(&CIRCLE), SHAPE, "Circle (2-D), `circle = { radius = 0.5 }`."),
    Field::optional(
        "ellipse",
        Kind::Table(&ELLIPSE),
        SHAPE,
        "Ellipse (2-D) centred on the origin of the shape, `ellipse = { size = [1, 0.12] }`.",
    ),
    Field::optional("sphere", Kind::Table(&SPHERE), SHAPE, "Sphere (3-D), `sphere = { radius = 0.5 }`."),
    Field::optional(
        "box",
        Kind::Table(&BOX),
        SHAPE,
        "Box centred on the origin of the shape, `box = { size = [1, 1, 1] }`.",
    ),
    Field::optional("surface", Kind::File, SHAPE, "STL, OBJ or PLY file (3-D), relative to the case file.")
        .known_as(&["stl", "obj", "mesh", "geometry"]),
    Field::optional(
        "wing",
        Kind::Table(&WING),
        SHAPE,
        "Wing, tail or fin by planform and sections (3-D): nose of the root at the origin, span along y, or along z of a fin.",
    ),
    Field::optional(
        "revolution",
        Kind::Table(&REVOLUTION),
        SHAPE,
        "Body of revolution about the x axis (3-D), `revolution = [[0, 0], [1, 0.2]]` is a cone.",
    ),
    Field::optional(
        "loft",
        Kind::Table(&LOFT),
        SHAPE,
        "Body along the x axis with oval or boxy sections (3-D): fuselages, nacelles, inlets faired over.",
    ),
    Field::optional(
        "ellipsoid",
        Kind::Table(&ELLIPSOID),
        SHAPE,
        "Ellipsoid (3-D) centred on the origin of the shape, `ellipsoid = { size = [6, 1, 1] }`.",
    ),
    Field::defaulted(
        "scale",
        SIZE,
        Absent::Number(1.0),
        "Length of one unit of the shape: the chord of an airfoil of unit chord, `\"0.35 m\"`; `\"1 mm\"` for a file in millimetres.",
    )
    .alias("chord")
    .known_as(&["size", "length", "unit", "units", "factor", "c"]),
    Field::defaulted(
        "rotate",
        Kind::List(&List { item: ANGLE, min: 0, max: 3, single: true }),
        Absent::Filled,
        "Rotation about the origin of the shape after scaling: one angle in 2-D (nose up positive), three in 3-D (about \
         x, then y, then z).",
    )
    .known_as(&["angle", "alpha", "incidence", "rotation", "orientation", "twist", "pitch"]),
    Field::defaulted(
        "translate",
        Kind::List(&List { item: LENGTH, min: 0, max: 3, single: false }),
        Absent::Filled,
        "Translation after scaling and rotation.",
    )
    .known_as(&["at", "position", "origin", "place", "centre", "center", "location", "offset", "shift", "move", "leading_edge"]),
    Field::optional(
        "weld",
        SIZE,
        "as little as closes the surface, at most 1e-4 of its size",
        "Distance up to which vertices of a surface file are joined, in the unit of the placed body: for coarse or noisy exports, `\"0.5 mm\"`.",
    )
    .known_as(&["tolerance", "merge", "snap", "weld_tolerance"]),
    Field::optional(
        "wall",
        Kind::Choice(WALL),
        "`\"slip\"` without viscosity, `\"adiabatic\"` with",
        "Condition of the gas on the surface, `wall = { temperature = \"300 K\" }`.",
    ),
    Field::optional(
        "motion",
        Kind::Table(&BODY_MOTION),
        "that of `[motion]`",
        "Motion of this body in place of that of `[motion]`, whose frequency it takes when it has none; `motion = {}` keeps \
         the body at rest.",
    ),
    Field::optional(
        "solid",
        Kind::Table(&SOLID),
        "rigid",
        "The body is made of particles and deforms: `solid = { material = \"steel\", through = 5 }`. Where a body has this key and the case no \
         `[flow]`, there are structures alone, without gas, in SI units. In a gas the body moves as pressure and friction have it; with \
         `motion` its supports follow that, or all of it where there are none.",
    ),
])
.with_one_of(&["naca", "airfoil", "polygon", "circle", "ellipse", "sphere", "box", "surface", "wing", "revolution", "loft", "ellipsoid"]);

static NACA: Table = Table::of(&[
    Field::required("digits", Kind::Matching("^([Nn][Aa][Cc][Aa][ _-]?)?[0-9].{3,}$"), "Its designation."),
    Field::defaulted("trailing_edge", Kind::Words(TRAILING_EDGES), Absent::Word("closed"), "How the section ends."),
])
.short("digits");

const TRAILING_EDGES: &[(&str, &str)] = &[
    ("closed", "last thickness coefficient -0.1036, no base of a modified form: both sides meet at x/c = 1"),
    (
        "blunt",
        "last thickness coefficient -0.1015 as published: a base of 0.252 % chord for 12 %, of a modified form 0.24 %, of 64A010 0.04 %",
    ),
    ("extended", "as published, extended to where the sides meet and scaled back to unit chord"),
];

static CIRCLE: Table = Table::of(&[Field::required("radius", SIZE, "Radius.")]);

static ELLIPSE: Table = Table::of(&[Field::required(
    "size",
    Kind::List(&List { item: SIZE, min: 2, max: 2, single: false }),
    "Lengths of its axes along x and y.",
)]);

static SPHERE: Table = Table::of(&[Field::required("radius", SIZE, "Radius.")]);

static BOX: Table = Table::of(&[Field::required(
    "size",
    Kind::List(&List { item: SIZE, min: 2, max: 3, single: false }),
    "Edge lengths, two or three.",
)]);

static ELLIPSOID: Table = Table::of(&[Field::required(
    "size",
    Kind::List(&List { item: SIZE, min: 3, max: 3, single: false }),
    "Lengths of its axes along x, y and z.",
)]);

static REVOLUTION: Table = Table::of(&[
    Field::required(
        "profile",
        Kind::List(&List { item: PLANE_POINT, min: 2, max: usize::MAX, single: false }),
        "Points `[x, r]` from the nose to the rear. Where they do not begin or end on the axis a face closes the body.",
    ),
    Field::defaulted("sides", Kind::Words(PROFILE_SIDES), Absent::Word("smooth"), "What joins the points."),
])
.short("profile");

static LOFT: Table = Table::of(&[
    Field::required(
        "stations",
        Kind::List(&List {
            item: Kind::List(&List { item: Kind::Number(Range::ANY), min: 3, max: 4, single: false }),
            min: 2,
            max: usize::MAX,
            single: false,
        }),
        "Sections `[x, width, height]` or `[x, width, height, z]` from the nose to the rear, `z` the middle of the section. Where \
         width and height are zero, at the first and the last alone, the body ends in a point or round; elsewhere a face closes it.",
    ),
    Field::defaulted(
        "exponent",
        Kind::Number(Range::between(2.0, 12.0)),
        Absent::Number(2.0),
        "n of the sections |2y/width|^n + |2z/height|^n = 1: 2 is an ellipse, 5 a box with round corners.",
    ),
    Field::defaulted("sides", Kind::Words(PROFILE_SIDES), Absent::Word("smooth"), "What joins the sections."),
])
.short("stations");

const PROFILE_SIDES: &[(&str, &str)] = &[
    (
        "smooth",
        "a smooth curve with corners where it turns by more than 35 deg; its ends on the axis are round where it reaches them at more than 30 deg",
    ),
    ("straight", "straight lines: cones and cylinders"),
];

const SECTION: &str = "another key of the section";

static WING: Table = Table::of(&[
    Field::optional(
        "naca",
        Kind::Table(&NACA),
        SECTION,
        "NACA section, at the root where there is another one at the tip.",
    ),
    Field::optional("airfoil", Kind::File, SECTION, "Coordinate file of the section."),
    Field::optional("tip_naca", Kind::Table(&NACA), "that of the root", "NACA section at the tip."),
    Field::optional("tip_airfoil", Kind::File, "that of the root", "Coordinate file of the section at the tip."),
    Field::required("span", SIZE, "Distance from tip to tip; from root to tip where there is one side."),
    Field::optional("chord", SIZE, "from `aspect_ratio`", "Chord at the root.").alias("root_chord"),
    Field::optional("aspect_ratio", POSITIVE, "from `chord`", "Square of the span over the area."),
    Field::defaulted(
        "taper",
        Kind::Number(Range::POSITIVE),
        Absent::Number(1.0),
        "Chord at the tip over that at the root.",
    ),
    Field::defaulted(
        "sweep",
        Kind::Quantity(Angle::DIMENSION, Range::between(-STEEPEST_SWEEP, STEEPEST_SWEEP)),
        Absent::Number(0.0),
        "Angle by which the line at `sweep_at` of the chord is swept back.",
    ),
    Field::defaulted(
        "sweep_at",
        Kind::Number(Range::between(0.0, 1.0)),
        Absent::Number(0.0),
        "Part of the chord at which that line runs: 0 is the leading edge.",
    ),
    Field::defaulted(
        "dihedral",
        Kind::Quantity(Angle::DIMENSION, Range::between(-UPRIGHT, UPRIGHT)),
        Absent::Number(0.0),
        "Angle by which tips are raised; `\"90 deg\"` for a fin, which has one side.",
    ),
    Field::defaulted(
        "twist",
        Kind::Quantity(Angle::DIMENSION, Range::between(-UPRIGHT, UPRIGHT)),
        Absent::Number(0.0),
        "Angle by which the nose of the tip is turned up against the root, about the quarter chord; in between it grows in proportion \
         to the distance from the root.",
    ),
    Field::defaulted(
        "planform",
        Kind::Words(PLANFORMS),
        Absent::Word("straight"),
        "How the chord changes along the span.",
    ),
    Field::defaulted("tip", Kind::Words(TIPS), Absent::Word("round"), "How tips end."),
    Field::defaulted("sides", Kind::Words(WING_SIDES), Absent::Word("both"), "Which sides there are."),
]);

/// Steepest sweep of a wing, radians (80°), and the dihedral of a fin.
const STEEPEST_SWEEP: f64 = 80.0 * std::f64::consts::PI / 180.0;
const UPRIGHT: f64 = 0.5 * std::f64::consts::PI;

const PLANFORMS: &[(&str, &str)] = &[
    ("straight", "in proportion to the distance from the root"),
    ("elliptic", "as that of an ellipse, without `taper`"),
];

const TIPS: &[(&str, &str)] = &[
    ("round", "half a circle seen from ahead, inside the planform; an elliptic planform ends in a point"),
    ("flat", "the face of the last section"),
    ("revolved", "half a body of revolution of the last section, beyond the span, as of the ONERA M6"),
];

const WING_SIDES: &[(&str, &str)] = &[("both", "both, mirrored at y = 0"), ("one", "that of positive y, or the fin")];
