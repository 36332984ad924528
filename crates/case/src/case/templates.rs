//! Case files to start from.

/// Names of the templates with a line about each.
pub const TEMPLATES: [(&str, &str); 10] = [
    ("airfoil", "transonic flow over a NACA 0012 section (2-D)"),
    ("flexible", "a steel panel of particles that a shock bends (2-D)"),
    ("flutter", "a typical section on springs in a stream (2-D)"),
    ("flutter-wing", "a wing that bends and twists in a stream (3-D)"),
    ("pitching", "an airfoil that pitches about its quarter chord (2-D)"),
    ("polar", "lift, drag and moment of a section at several angles and Mach numbers (2-D)"),
    ("solid", "a cantilever made of particles: vibrations, bending, impacts (2-D)"),
    ("sphere", "subsonic flow past a sphere (3-D)"),
    ("stl", "a body from an STL or OBJ surface file (3-D)"),
    ("travelling", "a cylinder in a stream of particles that travel with the fluid (2-D)"),
];

/// Name of the schema that [`SCHEMA_LINE`] points to, beside the case.
pub const SCHEMA_FILE: &str = "alula.schema.json";
/// First line of a case by which editors (Taplo, Even Better TOML) find [`SCHEMA_FILE`].
pub const SCHEMA_LINE: &str = "#:schema ./alula.schema.json\n";

/// The commented case file called `name`.
pub fn template(name: &str) -> Option<String> {
    let text = match name {
        "airfoil" => include_str!("templates/airfoil.toml"),
        "flexible" => include_str!("templates/flexible.toml"),
        "flutter" => include_str!("templates/flutter.toml"),
        "flutter-wing" => include_str!("templates/flutter-wing.toml"),
        "pitching" => include_str!("templates/pitching.toml"),
        "polar" => include_str!("templates/polar.toml"),
        "solid" => include_str!("templates/solid.toml"),
        "sphere" => include_str!("templates/sphere.toml"),
        "stl" => include_str!("templates/stl.toml"),
        "travelling" => include_str!("templates/travelling.toml"),
        _ => return None,
    };
    Some(text.to_owned())
}

/// Files of modes that the template `name` refers to, with their text: clamped bending and twist about 40 % of the chord of its wing.
pub fn mode_files(name: &str) -> Vec<(&'static str, String)> {
    /// Semi-span, stations along it, half of the thickness, and axis of the twist.
    const WING: (f64, u32, f64, f64) = (3.0, 8, 0.04, 0.4);
    if name != "flutter-wing" {
        return Vec::new();
    }
    let (span, stations, thickness, axis) = WING;
    let table = |what: &str, lift: &dyn Fn(f64, f64) -> f64| {
        let mut text = format!("# {what}\nx,y,z,dx,dy,dz\n");
        for station in 0..=stations {
            let part = f64::from(station) / f64::from(stations);
            for (x, z) in [0.0, 0.5, 1.0].into_iter().flat_map(|x| [(x, thickness), (x, -thickness)]) {
                text += &format!("{x},{},{z},0,0,{:.8}\n", span * part, lift(x, part));
            }
        }
        text
    };
    // a cantilever under a load at its tip
    let bending = table("bending: up, one at the tip", &|_, part| 0.5 * part * part * (3.0 - part));
    let twist = |x: f64, part: f64| (axis - x) * (0.5 * std::f64::consts::PI * part).sin();
    vec![("bending.csv", bending), ("torsion.csv", table("torsion: nose up, one radian at the tip", &twist))]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::case::read;

    #[test]
    fn the_line_for_editors_names_the_file() {
        assert_eq!(SCHEMA_LINE, format!("#:schema ./{SCHEMA_FILE}\n"));
    }

    #[test]
    fn every_template_is_a_case() {
        for (name, _) in TEMPLATES {
            let text = template(name).unwrap();
            let case = read(&text, name).unwrap_or_else(|e| panic!("{e}"));
            assert_eq!(case.bodies.len(), 1);
            assert!(text.starts_with("# "), "{name}");
            assert_eq!(read(&(SCHEMA_LINE.to_owned() + &text), name).unwrap(), case, "{name}");
            assert!(text.lines().all(|line| line.len() <= 100), "{name} has long lines");
        }
        assert!(template("wing").is_none());
    }

    #[test]
    fn modes_of_templates_are_modes() {
        assert!(mode_files("flutter").is_empty());
        let case = read(&template("flutter-wing").unwrap(), "flutter-wing").unwrap();
        let files = mode_files("flutter-wing");
        assert!(case.structures[0].modes.iter().zip(&files).all(|(mode, (file, _))| mode.file == *file));
        for (file, text) in files {
            let table = crate::case::read_mode(&text, file, 3).unwrap_or_else(|e| panic!("{e}")).table;
            let tip = table.points.iter().zip(&table.displacements).filter(|(x, _)| x[1] == 3.0);
            let greatest = tip.map(|(_, d)| d[2]).fold(f64::NEG_INFINITY, f64::max);
            assert!(table.points.len() == 54 && greatest == if file == "bending.csv" { 1.0 } else { 0.4 }, "{file}");
        }
    }
}
