//! What the columns of tables hold, and in which units.
//!
//! Names of columns are plain (`time`, `cl`), so that programs read them by name. What they mean and their units stand beside the
//! tables of a folder in `csv-metadata.json`, the file in which the W3C's *Metadata Vocabulary for Tabular Data* (2015) has readers look
//! for them. Units are written as in UCUM; quantities without one have the unit `1`.
use std::path::Path;

use serde_json::{Value, json};

use super::structure::{self, StructureNames, is_angle};
use super::table::{FileError, write_json};
use crate::case::Freedom;

/// Name of the file with the units of all tables of a folder.
pub const FILE: &str = "csv-metadata.json";

/// What a column holds.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Quantity {
    Text,
    Flag,
    Whole,
    Number,
    Degrees,
    Radians,
    /// Seconds of a clock, whatever the units of the case.
    Seconds,
    Length,
    /// Of a particle on a wall: a length in the plane.
    Area,
    Time,
    Speed,
    AngularRate,
    /// Of the coordinate of a mode, which has no unit.
    Rate,
    /// Cycles per unit of time.
    Frequency,
    Pressure,
    Density,
    Temperature,
    HeatFlux,
    /// Of a particle: an area in the plane.
    Volume,
    Force,
    Moment,
    Energy,
    Power,
}

use Quantity as Q;

/// The units of a case.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Scale {
    /// True where the free stream has units.
    pub dimensional: bool,
    /// Number of space dimensions: forces, energies and areas of plane cases are for a unit of span.
    pub dimension: usize,
}

/// Columns by name: what they hold, and what that is.
const GLOSSARY: &[(&str, Quantity, &str)] = &[
    ("1/k", Q::Number, "one over the reduced frequency"),
    ("alpha_deg", Q::Degrees, "angle of attack, nose up positive"),
    ("altitude", Q::Length, "geometric altitude in the standard atmosphere of 1976"),
    ("altitude_end", Q::Length, "altitude where the range ends"),
    ("altitude_error", Q::Length, "half width of the error bar of altitude"),
    (
        "amplitude",
        Q::Number,
        "amplitude of the first harmonic of the coordinate: degrees, length or number of the mode",
    ),
    ("angle_deg", Q::Degrees, "angle of the first body that moves, nose up positive"),
    ("arc", Q::Length, "length along the outline"),
    ("area", Q::Area, "area of the wall; per unit of span in the plane"),
    ("axis", Q::Text, "axis along which the span of the body runs: y, of a fin z"),
    ("balances", Q::Whole, "harmonic balances of the gas"),
    ("bending_moment", Q::Moment, "bending moment at the inner end of the strip, positive where the tip is bent up"),
    ("body", Q::Text, "name of the body"),
    ("branch", Q::Text, "motion that the row belongs to; in lco.csv the number of the branch"),
    ("cd", Q::Number, "drag coefficient"),
    ("cd_error", Q::Number, "half width of the error bar of cd"),
    ("cd_momentum", Q::Number, "drag coefficient by the balance of momentum"),
    ("cf", Q::Number, "friction coefficient, positive along the stream"),
    ("cfl", Q::Number, "Courant number"),
    ("change_cd", Q::Number, "change of cd in the cycle"),
    ("change_cl", Q::Number, "change of cl in the cycle"),
    ("chord", Q::Length, "mean chord of the strip"),
    ("cl", Q::Number, "lift coefficient"),
    ("cl_error", Q::Number, "half width of the error bar of cl"),
    ("cl_momentum", Q::Number, "lift coefficient by the balance of momentum"),
    (
        "cloud_error",
        Q::Number,
        "half width of the error bar that the spacing leaves, over the root of the dynamic pressure",
    ),
    ("cm", Q::Number, "moment coefficient about the reference point, nose up positive"),
    ("cm_error", Q::Number, "half width of the error bar of cm"),
    ("cm_momentum", Q::Number, "moment coefficient by the balance of momentum"),
    ("converged", Q::Flag, "true where the goal was reached"),
    ("coordinate", Q::Text, "coordinate whose amplitude is told"),
    ("cp", Q::Number, "pressure coefficient"),
    ("cpu_seconds", Q::Seconds, "processor time"),
    ("cycle", Q::Whole, "cycle of adaptation"),
    (
        "damping_g",
        Q::Number,
        "damping g, twice the damping ratio, growth positive; of motions that do not oscillate growth in doublings over a chord of the way",
    ),
    ("damping_g_coarser", Q::Number, "the same on the coarser cloud"),
    ("density", Q::Density, "density"),
    ("density_error", Q::Density, "half width of the error bar of density"),
    ("dissipation", Q::Power, "power that dampers take"),
    ("dynamic_pressure", Q::Pressure, "dynamic pressure of the stream"),
    ("dynamic_pressure_end", Q::Pressure, "dynamic pressure where the range ends"),
    ("dynamic_pressure_error", Q::Pressure, "half width of the error bar of dynamic_pressure"),
    ("eigenvalue_im", Q::Number, "rate of oscillation over the rate of the fastest motion"),
    ("eigenvalue_re", Q::Number, "rate of growth over the rate of the fastest motion"),
    ("equivalent_airspeed", Q::Speed, "equivalent airspeed (EAS): root of twice the dynamic pressure over 1.225 kg/m3"),
    ("equivalent_airspeed_end", Q::Speed, "equivalent airspeed where the range ends"),
    ("equivalent_airspeed_error", Q::Speed, "half width of the error bar of equivalent_airspeed"),
    (
        "error",
        Q::Number,
        "change between the last two interpolations, over the root of the dynamic pressure; in lco.csv change with the last harmonics, over the speed",
    ),
    ("fluid_particles", Q::Whole, "number of fluid particles"),
    ("frequency", Q::Frequency, "frequency of the motion"),
    ("frequency_ratio", Q::Number, "frequency over that of pitch alone"),
    ("from_rest", Q::Flag, "true where the point was started from rest"),
    ("fx", Q::Force, "force along x"),
    ("fy", Q::Force, "force along y"),
    ("fz", Q::Force, "force along z"),
    ("g_method", Q::Number, "what the g-method finds of the root of the dynamic pressure, less one"),
    ("gas_power", Q::Power, "power of the gas on the structures"),
    ("gas_work", Q::Energy, "work of the gas on the structures so far"),
    ("growth", Q::Number, "greatest damping g over the next fifth of the speed"),
    ("harmonics", Q::Whole, "harmonics of the motion"),
    ("heat_flux", Q::HeatFlux, "heat into the wall per area and time"),
    ("holding_damping", Q::Number, "structural damping g that holds flutter that grows little"),
    ("inner", Q::Whole, "iterations within the step"),
    ("iteration", Q::Whole, "iteration over all stages"),
    ("iterations", Q::Whole, "iterations on all clouds; in gaf.csv linear iterations of the column"),
    ("k", Q::Number, "reduced frequency"),
    (
        "kind",
        Q::Text,
        "what begins: flutter, restabilised or divergence; in flutter-doubts.csv why the spacing decides",
    ),
    ("kinetic", Q::Energy, "kinetic energy of the structures"),
    ("ledger", Q::Energy, "work on the walls as the gas has it less work on the structures, so far"),
    ("left", Q::Number, "residual of the linear system over its right-hand side"),
    ("loading", Q::Number, "load along the span: chord times section lift coefficient over reference chord"),
    ("long_bars", Q::Text, "loads whose error bars are longer than was asked for"),
    ("mach", Q::Number, "Mach number"),
    ("margin", Q::Number, "equivalent airspeed over the design speed, less one"),
    ("mass_ratio", Q::Number, "mass ratio"),
    ("mean", Q::Number, "mean of the coordinate, in the unit of amplitude"),
    ("mode", Q::Number, "coordinate of the first mode; in gaf.csv the name of the mode"),
    ("nonlinearity", Q::Number, "part by which the forces change when the amplitude is halved"),
    ("nx", Q::Number, "normal of the wall into the gas, along x"),
    ("ny", Q::Number, "normal of the wall into the gas, along y"),
    ("nz", Q::Number, "normal of the wall into the gas, along z"),
    ("orders", Q::Number, "orders of magnitude that the residual fell"),
    ("particles", Q::Whole, "number of particles"),
    ("phase", Q::Number, "part of the period"),
    ("point", Q::Whole, "point of the polar, from 1"),
    ("potential", Q::Energy, "potential energy of the structures"),
    ("pressure", Q::Pressure, "pressure"),
    ("reason", Q::Text, "why a point did not converge"),
    ("reduced_speed", Q::Number, "reduced speed V* = U/(b omega_alpha)"),
    ("reduced_speed_error", Q::Number, "half width of the error bar of reduced_speed"),
    ("residual", Q::Number, "residual over its first value"),
    ("seconds", Q::Seconds, "wall time since the run began"),
    ("section_cd", Q::Number, "drag of the strip over dynamic pressure, chord and width"),
    ("section_cl", Q::Number, "lift of the strip, of a fin its force along y, over dynamic pressure, chord and width"),
    (
        "section_cm",
        Q::Number,
        "moment of the strip about its quarter chord, nose up positive, over dynamic pressure, squared chord and width",
    ),
    ("shear_force", Q::Force, "force upwards, of a fin along y, on all that is outboard of the inner end of the strip"),
    (
        "shift",
        Q::Length,
        "displacement of the first body that moves; where nothing else moves, the coordinate of its first mode",
    ),
    ("shift_x", Q::Length, "displacement of the first body that moves, along x"),
    ("shift_y", Q::Length, "displacement of the first body that moves, along y"),
    ("shift_z", Q::Length, "displacement of the first body that moves, along z"),
    ("spacing_ratio", Q::Number, "spacing of the coarser cloud over that of this one"),
    ("speed", Q::Speed, "true airspeed (TAS)"),
    ("speed_end", Q::Speed, "true airspeed where the range ends"),
    ("speed_error", Q::Speed, "half width of the error bar of speed"),
    ("speed_index", Q::Number, "speed index V* over the root of the mass ratio"),
    ("speed_index_error", Q::Number, "half width of the error bar of speed_index"),
    ("speed_ratio", Q::Number, "speed over that of the case"),
    ("speed_ratio_end", Q::Number, "speed over that of the case where the range ends"),
    ("speed_ratio_error", Q::Number, "half width of the error bar of speed_ratio"),
    ("stability", Q::Text, "whether larger and smaller motions go to the limit cycle"),
    ("station", Q::Length, "middle of the strip along the span"),
    ("station_in", Q::Length, "inner end of the strip along the span"),
    ("tag", Q::Text, "name of the part of the body"),
    ("time", Q::Time, "time; 0 in steady runs"),
    ("torsion_moment", Q::Moment, "torsion about the quarter chord at the inner end of the strip, nose up positive"),
    ("u", Q::Speed, "velocity along x"),
    ("v", Q::Speed, "velocity along y"),
    ("w", Q::Speed, "velocity along z"),
    ("wall_power", Q::Power, "power on the walls as the gas has it"),
    ("width", Q::Length, "width of the strip"),
    ("within_accuracy", Q::Flag, "true where the error bars are as short as asked for"),
    ("x", Q::Length, "place along x"),
    ("x_c", Q::Number, "distance from the nose over the extent of the bodies along x"),
    ("x_quarter", Q::Length, "place of the quarter chord along x"),
    ("y", Q::Length, "place along y"),
    ("y_plus", Q::Number, "distance of the first particles in viscous lengths"),
    ("z", Q::Length, "place along z"),
];

/// Arrays of field files that no table has, or that hold something else there.
const ARRAYS: &[(&str, Quantity, &str)] = &[
    ("area_vector", Q::Area, "area of the panel times its normal"),
    ("body", Q::Number, "number of the body, from 0"),
    ("condition", Q::Number, "condition number of the fit around the particle"),
    ("cp_amplitude", Q::Number, "amplitude of the unsteady pressure coefficient in the motion as displaced"),
    ("cp_phase_deg", Q::Degrees, "phase by which the unsteady pressure coefficient is ahead of the largest coordinate"),
    ("cp_unsteady", Q::Number, "unsteady pressure coefficient at this phase, without that of the steady flow"),
    ("displacement", Q::Length, "displacement from the place at rest"),
    ("entropy", Q::Number, "p/rho^gamma over that of the free stream, less 1"),
    ("kind", Q::Number, "0 fluid, 1 wall, 2 border of the domain, 3 on a plane of symmetry"),
    ("level", Q::Number, "logarithm to base 2 of the spacing"),
    ("material", Q::Number, "number of the material, from 0"),
    ("normal", Q::Number, "unit normal, into the gas"),
    ("plastic_strain", Q::Number, "equivalent plastic strain"),
    ("spacing", Q::Length, "distance between particles"),
    ("temperature", Q::Temperature, "static temperature"),
    ("total_pressure", Q::Pressure, "p (1 + (gamma - 1)/2 M^2)^(gamma/(gamma - 1))"),
    ("total_pressure_loss", Q::Number, "1 less total pressure over that of the free stream"),
    ("velocity", Q::Speed, "velocity"),
    ("volume", Q::Volume, "volume of the particle; area in the plane"),
    ("von_mises_stress", Q::Pressure, "von Mises stress"),
    ("vorticity", Q::Rate, "curl of the velocity, by the fits of the scheme; zero where these have no slope"),
];

/// Columns whose names are made: what they end in, what they hold, and what that is of the rest of the name.
const ENDINGS: [(&str, Quantity, &str); 6] = [
    ("_error", Q::Number, "error bar, in gaf.csv the radius of a circle in the complex plane, of"),
    ("_phase_deg", Q::Degrees, "phase, positive when the load leads the motion, of"),
    ("_abs", Q::Number, "absolute value, per unit of the motion, of"),
    ("_mean", Q::Number, "mean in time of"),
    ("_re", Q::Number, "real part of a complex coefficient of"),
    ("_im", Q::Number, "imaginary part of a complex coefficient of"),
];

impl Quantity {
    /// The unit as in UCUM, in a case without units in those of the solver: `L` is the unit of the geometry, `a` the sound speed and
    /// `rho` the density of the free stream, `T` its temperature.
    fn unit(self, scale: Scale) -> &'static str {
        let space = scale.dimension == 3;
        let pick = |plane, in_space| if space { in_space } else { plane };
        match (self, scale.dimensional) {
            (Q::Text | Q::Flag, _) => "",
            (Q::Whole | Q::Number, _) => "1",
            (Q::Degrees, _) => "deg",
            (Q::Radians, _) => "rad",
            (Q::Seconds, _) => "s",
            (Q::Length, true) => "m",
            (Q::Length, false) => "L",
            (Q::Area, true) => pick("m", "m2"),
            (Q::Area, false) => pick("L", "L2"),
            (Q::Time, true) => "s",
            (Q::Time, false) => "L/a",
            (Q::Speed, true) => "m/s",
            (Q::Speed, false) => "a",
            (Q::AngularRate, true) => "rad/s",
            (Q::AngularRate, false) => "rad.a/L",
            (Q::Frequency, true) => "Hz",
            (Q::Frequency, false) => "a/L",
            (Q::Rate, true) => "1/s",
            (Q::Rate, false) => "a/L",
            (Q::Pressure, true) => "Pa",
            (Q::Pressure, false) => "rho.a2",
            (Q::Density, true) => "kg/m3",
            (Q::Density, false) => "rho",
            (Q::Temperature, true) => "K",
            (Q::Temperature, false) => "T",
            (Q::Volume, true) => pick("m2", "m3"),
            (Q::Volume, false) => pick("L2", "L3"),
            (Q::HeatFlux, true) => "W/m2",
            (Q::HeatFlux, false) => "rho.a3",
            (Q::Force, true) => pick("N/m", "N"),
            (Q::Force, false) => pick("rho.a2.L", "rho.a2.L2"),
            (Q::Moment, true) => pick("N", "N.m"),
            (Q::Energy, true) => pick("J/m", "J"),
            (Q::Moment | Q::Energy, false) => pick("rho.a2.L2", "rho.a2.L3"),
            (Q::Power, true) => pick("W/m", "W"),
            (Q::Power, false) => pick("rho.a3.L", "rho.a3.L2"),
        }
    }

    /// The kind of value in the words of XML Schema.
    fn kind(self) -> &'static str {
        match self {
            Q::Text => "string",
            Q::Flag => "boolean",
            Q::Whole => "integer",
            _ => "number",
        }
    }
}

/// What the column `name` of `table` holds, and what that is; `None` where nothing is known of it.
fn known(table: &str, name: &str, structures: &[StructureNames]) -> Option<(Quantity, String)> {
    let exact = GLOSSARY.iter().find(|(n, ..)| *n == name).map(|(_, q, about)| (*q, (*about).to_owned()));
    if (table, name) == ("gaf.csv", "mode") {
        return Some((Q::Text, "name of the mode that moves".to_owned()));
    }
    if name == "mode" && ["flutter.csv", "v-g.csv"].contains(&table) {
        return Some((
            Q::Number,
            "number of the natural mode, from 1; not a number where motions do not oscillate".to_owned(),
        ));
    }
    if (table, name) == ("lco.csv", "branch") {
        return Some((Q::Whole, "number of the branch, from 1".to_owned()));
    }
    let made = || {
        let ending = ENDINGS.iter().find_map(|(end, q, about)| Some((name.strip_suffix(end)?, *q, about)));
        ending.map(|(base, quantity, about)| (quantity, format!("{about} `{base}`")))
    };
    if table == structure::FILE { exact.or_else(|| Some(coordinate(name, structures))) } else { exact.or_else(made) }
}

/// Unit of an array of a field file, of the mean, a harmonic or a component of one as well; `None` where nothing is known of it.
pub fn unit_of_array(name: &str, scale: Scale) -> Option<&'static str> {
    let find = |name: &str| ARRAYS.iter().chain(GLOSSARY).find(|(n, ..)| *n == name).map(|(_, q, _)| q.unit(scale));
    let part = |name| ["_mean", "_re", "_im", "_x", "_y", "_z"].iter().find_map(|end| str::strip_suffix(name, end));
    let mut base = name;
    loop {
        match (find(base), part(base)) {
            (Some(unit), _) => return Some(unit).filter(|unit| !unit.is_empty()),
            // `pressure_2_re`: the number of the harmonic goes with its part
            (None, Some(shorter)) => {
                base = shorter.trim_end_matches(|c: char| c.is_ascii_digit()).trim_end_matches('_')
            }
            (None, None) => return None,
        }
    }
}

/// A coordinate of a structure, its rate, or the force of the gas on it.
fn coordinate(name: &str, structures: &[StructureNames]) -> (Quantity, String) {
    let rate = name.strip_suffix("_rate");
    let load = name.strip_suffix("_load");
    let whole = rate.or(load).unwrap_or(name);
    let own = whole.rsplit('.').next().unwrap_or(whole);
    let told = structures.iter().flat_map(|s| &s.coordinates).find(|c| c.name == own);
    let turns = told.map_or_else(|| is_angle(own), |c| c.angle);
    let shifts = [Freedom::Surge, Freedom::Sway, Freedom::Plunge].iter().any(|f| f.name() == own);
    let [value, speed, force] = match (turns, shifts) {
        (true, _) => [Q::Radians, Q::AngularRate, Q::Moment],
        (false, true) => [Q::Length, Q::Speed, Q::Force],
        // a mode is in lengths, its coordinate a number
        (false, false) => [Q::Number, Q::Rate, Q::Energy],
    };
    match (rate, load) {
        (Some(_), _) => (speed, format!("rate of `{whole}`")),
        (_, Some(_)) => (force, format!("force of the gas on `{whole}`")),
        _ => (value, format!("coordinate `{whole}`")),
    }
}

/// Unit of the column `name` of `table`, as in UCUM, `1` for a pure number; `None` of text, and where nothing is known of it.
pub fn unit_of(table: &str, name: &str, scale: Scale) -> Option<&'static str> {
    known(table, name, &[]).map(|(quantity, _)| quantity.unit(scale)).filter(|unit| !unit.is_empty())
}

/// Writes [`FILE`], which tells meaning and unit of every column of the tables in `folder`.
pub fn describe_tables(folder: &Path, scale: Scale, structures: &[StructureNames]) -> Result<(), FileError> {
    let listed = std::fs::read_dir(folder).map_err(FileError::io("read", folder))?;
    let mut names: Vec<String> =
        listed.filter_map(|entry| entry.ok()?.file_name().into_string().ok()).filter(|n| n.ends_with(".csv")).collect();
    names.sort();
    let mut tables = Vec::new();
    for name in names {
        let path = folder.join(&name);
        let head = first_line(&path).map_err(FileError::io("read", &path))?;
        let columns: Vec<Value> = head.split(',').map(|column| described(&name, column, scale, structures)).collect();
        tables.push(json!({ "url": name, "tableSchema": { "columns": columns } }));
    }
    write_json(
        &folder.join(FILE),
        &json!({ "@context": "http://www.w3.org/ns/csvw", "dc:description": convention(scale), "tables": tables }),
    )
}

/// A column in the words of the vocabulary.
fn described(table: &str, name: &str, scale: Scale, structures: &[StructureNames]) -> Value {
    let mut column = json!({ "name": name, "titles": name });
    let Some((quantity, about)) = known(table, name, structures) else { return column };
    column["dc:description"] = about.into();
    column["datatype"] = quantity.kind().into();
    let unit = quantity.unit(scale);
    if !unit.is_empty() {
        column["schema:unitText"] = unit.into();
    }
    column
}

fn convention(scale: Scale) -> String {
    let units = match scale.dimensional {
        true => "SI units",
        false => {
            "no units: L is the unit of the geometry, rho the density and a the sound speed of the free stream, \
                  rho.a2 density times sound speed squared"
        }
    };
    let span = if scale.dimension == 2 { "; forces, moments, energies and areas are for a unit of span" } else { "" };
    format!("{units}; `schema:unitText` is a unit as in UCUM, 1 for a pure number{span}")
}

fn first_line(path: &Path) -> std::io::Result<String> {
    let mut line = String::new();
    std::io::BufRead::read_line(&mut std::io::BufReader::new(crate::case::open_regular(path)?), &mut line)?;
    Ok(line.trim_end().to_owned())
}

/// The reference page of all columns, in Markdown.
pub fn reference_markdown() -> String {
    let unit = |q: Quantity, dimensional: bool| {
        let [plane, space] = [2, 3].map(|dimension| q.unit(Scale { dimensional, dimension }));
        match (plane, space) {
            ("", _) => "–".to_owned(),
            _ if plane == space => format!("`{plane}`"),
            _ => format!("`{plane}`; `{space}`"),
        }
    };
    let mut page = String::from(
        "# Columns of tables\n\nThe tables of a run folder are comma-separated values with one line of names, which \
         `pandas.read_csv` and `numpy.genfromtxt(..., names=True)` take as they are. Meaning and unit of every column stand beside \
         them in `csv-metadata.json`, in the vocabulary of the W3C for tabular data: `dc:description`, `datatype`, and \
         `schema:unitText`, the unit as in UCUM. The unit of a pure number is `1`.\n\n\
         With a dimensional free stream, units are those of SI. Without one, `L` is the unit of the geometry, `rho` the density and `a` the \
         sound speed of the free stream. Where two units are given, the first is for plane cases, in which forces, moments, energies and areas are for a unit \
         of span.\n\n| column | what | unit | without units |\n|---|---|---|---|\n",
    );
    for (name, q, about) in GLOSSARY {
        page += &format!("| `{name}` | {about} | {} | {} |\n", unit(*q, true), unit(*q, false));
    }
    page += "\nNames that are made end in what they hold: ";
    let endings: Vec<String> =
        ENDINGS.iter().map(|(end, _, about)| format!("`…{end}` ({about} what stands before)")).collect();
    page += &endings.join(", ");
    page += ". `structure.csv` has three columns for each coordinate: itself (`rad` or `m`; the coordinate of a mode is a number), its rate \
             `…_rate`, and the force of the gas on it `…_load`.\n";
    page += "\n## Arrays of field files\n\nThe files for ParaView follow the same convention: SI units where the free stream has units, \
             else those of the free stream, of which `T` is the temperature. The unit of every array stands in the file, in the field data \
             `units`. Structures alone are in SI units. Arrays that tables have too (`density`, `pressure`, `mach`, `cp`, …) are those of \
             above.\n\n| array | what | unit | without units |\n|---|---|---|---|\n";
    for (name, q, about) in ARRAYS {
        page += &format!("| `{name}` | {about} | {} | {} |\n", unit(*q, true), unit(*q, false));
    }
    page
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_sorted_and_stand_once() {
        let names: Vec<&str> = GLOSSARY.iter().map(|(name, ..)| *name).collect();
        assert!(names.windows(2).all(|pair| pair[0] < pair[1]), "{names:?}");
        let names: Vec<&str> = ARRAYS.iter().map(|(name, ..)| *name).collect();
        assert!(names.windows(2).all(|pair| pair[0] < pair[1]), "{names:?}");
    }

    #[test]
    fn arrays_have_units_by_one_convention() {
        let unit = |name: &str, dimensional: bool| unit_of_array(name, Scale { dimensional, dimension: 3 });
        for (name, with, without) in [
            ("temperature", "K", "T"),
            ("pressure", "Pa", "rho.a2"),
            ("total_pressure", "Pa", "rho.a2"),
            ("velocity", "m/s", "a"),
            ("vorticity", "1/s", "a/L"),
            ("volume", "m3", "L3"),
            ("cp", "1", "1"),
            ("body", "1", "1"),
            ("pressure_mean", "Pa", "rho.a2"),
            ("velocity_y_12_im", "m/s", "a"),
            ("displacement_x_1_re", "m", "L"),
        ] {
            assert_eq!((unit(name, true), unit(name, false)), (Some(with), Some(without)), "{name}");
        }
        assert_eq!(unit("nonsense_3_re", true), None);
    }

    #[test]
    fn units_follow_the_case() {
        let unit = |table: &str, name: &str, dimensional: bool, dimension: usize| {
            let (quantity, _) = known(table, name, &[]).unwrap();
            quantity.unit(Scale { dimensional, dimension })
        };
        assert_eq!([true, false].map(|d| unit("history.csv", "time", d, 2)), ["s", "L/a"]);
        assert_eq!([2, 3].map(|d| unit("loads.csv", "fx", true, d)), ["N/m", "N"]);
        assert_eq!(unit("history.csv", "cl", true, 2), "1");
        assert_eq!(unit("structure.csv", "pitch_rate", true, 2), "rad/s");
        assert_eq!(unit("structure.csv", "wing.plunge_load", true, 2), "N/m");
        assert_eq!(unit("structure.csv", "bending", true, 3), "1");
        assert_eq!(unit("gaf.csv", "cl_phase_deg", false, 2), "deg");
        assert_eq!(known("history.csv", "nonsense", &[]), None);
    }

    #[test]
    fn a_mode_called_pitch_is_a_number() {
        let coordinates = vec![structure::CoordinateName { name: "pitch".into(), angle: false }];
        let names = [StructureNames { body: "wing".into(), coordinates, samples: false }];
        assert_eq!(known(structure::FILE, "pitch", &names).unwrap().0, Q::Number);
    }

    #[test]
    fn a_folder_is_described() {
        let folder = tempfile::tempdir().unwrap();
        std::fs::write(folder.path().join("polar.csv"), "point,cl,reason\n1,0.5,\n").unwrap();
        describe_tables(folder.path(), Scale { dimensional: false, dimension: 2 }, &[]).unwrap();
        let text = std::fs::read_to_string(folder.path().join(FILE)).unwrap();
        let found: Value = serde_json::from_str(&text).unwrap();
        assert_eq!(found["tables"][0]["url"], "polar.csv");
        let columns = &found["tables"][0]["tableSchema"]["columns"];
        assert_eq!((&columns[1]["name"], &columns[1]["schema:unitText"]), (&json!("cl"), &json!("1")));
        assert_eq!((&columns[2]["datatype"], columns[2].get("schema:unitText")), (&json!("string"), None));
    }
}
