//! Output of a run, its intervals, and reference curves.
use super::kinds::{COUNT, POINT, POSITIVE, SIZE};
use super::quantity::{Length, Time, WallTime};
use super::schema::{Absent, Kind, List, Range, defaulted, keys, optional, required};

keys! {
    /// Hinge line of a control surface. The control surface is the part of a body behind the line, between its ends.
    pub struct Hinge, HINGE {
        /// Name in tables.
        name: String = defaulted(Kind::Text, Absent::Word("hinge")),
        /// Name of the body that the control surface is part of.
        body: Option<String> = optional(Kind::Text, "all bodies"),
        /// One end of the hinge line, before any motion; in 2-D the hinge. Moments are positive by the right-hand rule
        /// about the line from here `to` there (from left to right: trailing edge down), in 2-D where they turn the
        /// trailing edge down.
        from: Vec<Length> = required(POINT),
        /// The other end, in 3-D.
        to: Option<Vec<Length>> = optional(POINT, "2-D: the hinge is a point"),
    }

    /// Reference quantities of the load coefficients.
    #[derive(Default)]
    pub struct Reference, REFERENCE {
        /// Length of the moment coefficient (and of CL, CD in 2-D).
        chord: Option<Length> = optional(
            SIZE,
            "chord line of a section (1 for NACA sections and files of unit chord, times `scale`), of several \
             their extent along x; in 3-D the mean aerodynamic chord of the largest wing as it is typed, the \
             length of bodies of revolution and lofts, else the mean aerodynamic chord of what is seen from above",
        ),
        /// Area of the coefficients in 3-D, length squared.
        area: Option<f64> = optional(
            POSITIVE,
            "planform of the largest wing as it is typed, else of what is seen from above, fins left out; of what \
             stands upright alone, a wing with its span along z, from the side",
        ),
        /// Name of the body that gives the values that are not given: the wing of an aircraft, the main part of a
        /// section. It counts whole, with what lies inside other bodies.
        body: Option<String> = optional(Kind::Text, "the largest wing, else all bodies"),
        /// Point about which moments are taken; it moves with the first body.
        moment_point: Option<Vec<Length>> = optional(
            POINT,
            "quarter of the chord line (2-D), of the mean aerodynamic chord (3-D), moved with the body by \
             `scale`, `rotate` and `translate`",
        ),
    }

    /// Output files and their intervals.
    pub struct Output, OUTPUT {
        /// Iterations between checkpoints, at most. Marches of structures alone, whose steps may take less time than a
        /// file, let twenty times as long pass as writing the last one took.
        checkpoint: u32 = defaulted(COUNT, Absent::Integer(50)),
        /// Wall-clock time between checkpoints, at most, a plain number in seconds: what a run that is killed loses. No
        /// result depends on it.
        checkpoint_time: WallTime = defaulted(
            Kind::Quantity(WallTime::DIMENSION, Range::POSITIVE), Absent::Number(600.0),
        ),
        /// Time between field files in marching runs: seconds, or lengths over sound speed without a dimensional free
        /// stream.
        field_interval: Option<Time> = optional(
            Kind::Quantity(Time::DIMENSION, Range::POSITIVE), "the last field only",
        ),
        /// Fluid particles in a field file, at most: of more, every second, third and so on stays, so that what is fine
        /// stays finer; particles on walls all stay. Up to a million particles in space have cells between them.
        field_particles: Option<u32> = optional(COUNT, "all"),
        /// Periods at the end of a march that loops and harmonics of the loads are the mean of: more than one where the
        /// flow has a rhythm of its own beside that of the motion.
        loop_periods: u32 = defaulted(COUNT, Absent::Integer(1)),
        /// Write `report.html` and pictures.
        report: bool = defaulted(Kind::Flag, Absent::Flag(true)),
        /// Parts of the half span at which Cp is drawn along the chord, in space.
        stations: Option<Vec<f64>> = optional(
            Kind::List(&List { item: Kind::Number(Range::between(0.0, 1.0)), min: 1, max: 24, single: true }),
            "those of the references, else 0.2, 0.44, 0.65, 0.8, 0.9, 0.95",
        ),
    }

    /// A reference curve of Cp against x/c.
    pub struct Compare, COMPARE {
        /// CSV file with columns `x_c` and `Cp`, in space `eta`, the part of the half span, relative to the case file.
        file: String = required(Kind::File),
        /// Name in the legend.
        label: String = defaulted(Kind::Text, Absent::Word("reference")),
    }
}

impl Default for Output {
    fn default() -> Self {
        OUTPUT.value()
    }
}
