//! Bodies, as data: their shapes and where they are placed.
use serde::{Deserialize, Serialize};

use super::flow::{WALL, Wall};
use super::kinds::{ANGLE, LENGTH, PLANE_POINT, SIZE};
use super::motion::{BODY_MOTION, BodyMotionSpec};
use super::naca::{NACA, Naca, TrailingEdge};
use super::quantity::{Angle, Length};
use super::schema::{Absent, Field, Kind, List, Range, Table};
use super::solid::{SOLID, Solid};
use super::wing::{PROFILE_SIDES, ProfileSides, WING, Wing};

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

/// A body: exactly one shape key, followed by its placement.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Body {
    /// Name in tables of loads; when absent, [`read()`](super::read()) assigns `body-1`, `body-2`, …
    pub name: Option<String>,
    /// Geometry.
    #[serde(flatten)]
    pub shape: Shape,
    /// Placement: scaling, then rotation about the origin of the shape, then translation.
    #[serde(flatten)]
    pub placement: Placement,
    /// Distance up to which vertices of a surface file are merged; absent: the smallest distance that closes the
    /// surface, at most a ten thousandth of its size.
    pub weld: Option<Length>,
    /// Wall condition; absent: slip for an inviscid gas, adiabatic no-slip for a viscous one.
    pub wall: Option<Wall>,
    /// Motion of this body, which replaces that of `[motion]`; an empty table keeps the body at rest.
    pub motion: Option<BodyMotionSpec>,
    /// Material and discretisation of a deformable body; absent: the body is rigid, or deforms in modes.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub solid: Option<Solid>,
}

/// Shape of a body. In the file, each variant is a key of the body table.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Shape {
    /// NACA section, `naca = "0012"` or `naca = "23012"`, or a table with `digits` and `trailing_edge`.
    Naca(Naca),
    /// Airfoil coordinate file, `airfoil = "rae2822.dat"` (Selig, Lednicer or CSV order).
    Airfoil(String),
    /// Closed polygon with sharp corners, `polygon = [[0, 0], [1, 0.1], [1, -0.1]]`.
    Polygon(Vec<[f64; 2]>),
    /// Circle (2-D), `circle = { radius = 0.5 }`.
    Circle {
        /// Radius.
        radius: Length,
    },
    /// Ellipse centred on the origin of the shape (2-D), `ellipse = { size = [1, 0.12] }`.
    Ellipse {
        /// Lengths of the axes along x and y.
        size: [Length; 2],
    },
    /// Sphere (3-D), `sphere = { radius = 0.5 }`.
    Sphere {
        /// Radius.
        radius: Length,
    },
    /// Box centred on the origin of the shape, `box = { size = [1, 1, 1] }` (two or three numbers).
    Box {
        /// Edge lengths.
        size: Vec<Length>,
    },
    /// STL, OBJ or PLY file, `surface = "wing.stl"`.
    Surface(String),
    /// Wing, tail or fin, given by its planform and sections.
    Wing(Box<Wing>),
    /// Body of revolution about the x axis.
    Revolution {
        /// Points (x, r) from the nose to the rear.
        profile: Vec<[f64; 2]>,
        /// Curve through the points.
        sides: ProfileSides,
    },
    /// Body along the x axis with oval or rounded rectangular cross-sections.
    Loft {
        /// Cross-sections (x, width, height and optionally z of the centre) from the nose to the rear.
        stations: Vec<Vec<f64>>,
        /// Exponent n of the cross-sections |2y/width|ⁿ + |2z/height|ⁿ = 1.
        exponent: f64,
        /// Curve through the cross-sections.
        sides: ProfileSides,
    },
    /// Ellipsoid centred on the origin of the shape.
    Ellipsoid {
        /// Lengths of the three axes.
        size: [Length; 3],
    },
}

/// Placement of a body.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Placement {
    /// Length of one unit of the shape: a factor on its coordinates. For an airfoil of unit chord this is the chord.
    pub scale: f64,
    /// Rotation: one angle in 2-D (nose up positive, about the origin of the shape), three in 3-D (about x, y, z);
    /// empty: no rotation.
    pub rotate: Vec<Angle>,
    /// Translation after scaling and rotation; empty: no translation.
    pub translate: Vec<Length>,
}

impl Default for Placement {
    /// No scaling, rotation or translation.
    fn default() -> Self {
        Self { scale: 1.0, rotate: Vec::new(), translate: Vec::new() }
    }
}

impl Body {
    /// A body of this shape without name and motion, placed as the shape defines it.
    pub fn new(shape: Shape) -> Self {
        Self { name: None, shape, placement: Placement::default(), weld: None, wall: None, motion: None, solid: None }
    }

    /// A NACA 4-digit section of unit chord with a closed trailing edge, nose at the origin.
    pub fn naca(digits: &str) -> Self {
        Self::new(Shape::Naca(Naca { digits: digits.to_owned(), trailing_edge: TrailingEdge::Closed }))
    }
}
