//! Case files to start from.

/// Names of the templates with a line about each.
pub const TEMPLATES: [(&str, &str); 9] = [
    ("airfoil", "transonic flow over a NACA 0012 section (2-D)"),
    ("flexible", "a steel panel of particles that a shock bends (2-D)"),
    ("flutter", "a typical section on springs in a stream (2-D)"),
    ("pitching", "an airfoil that pitches about its quarter chord (2-D)"),
    ("polar", "lift, drag and moment of a section at several angles and Mach numbers (2-D)"),
    ("solid", "a cantilever made of particles: vibrations, bending, impacts (2-D)"),
    ("sphere", "subsonic flow past a sphere (3-D)"),
    ("stl", "a body from an STL or OBJ surface file (3-D)"),
    ("travelling", "a cylinder in a stream of particles that travel with the fluid (2-D)"),
];

/// Name of the schema that the first line of a template points to, beside the case.
pub const SCHEMA_FILE: &str = "alula.schema.json";

/// The commented case file called `name`. Its first line tells editors (Taplo, Even Better TOML) that [`SCHEMA_FILE`] describes it.
pub fn template(name: &str) -> Option<String> {
    let text = match name {
        "airfoil" => include_str!("templates/airfoil.toml"),
        "flexible" => include_str!("templates/flexible.toml"),
        "flutter" => include_str!("templates/flutter.toml"),
        "pitching" => include_str!("templates/pitching.toml"),
        "polar" => include_str!("templates/polar.toml"),
        "solid" => include_str!("templates/solid.toml"),
        "sphere" => include_str!("templates/sphere.toml"),
        "stl" => include_str!("templates/stl.toml"),
        "travelling" => include_str!("templates/travelling.toml"),
        _ => return None,
    };
    Some(format!("#:schema ./{SCHEMA_FILE}\n{text}"))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::case::read;

    #[test]
    fn every_template_is_a_case() {
        for (name, _) in TEMPLATES {
            let text = template(name).unwrap();
            let case = read(&text, name).unwrap_or_else(|e| panic!("{e}"));
            assert_eq!(case.bodies.len(), 1);
            assert!(text.starts_with("#:schema ./alula.schema.json\n# "), "{name}");
            assert!(text.lines().all(|line| line.len() <= 100), "{name} has long lines");
        }
        assert!(template("wing").is_none());
    }
}
