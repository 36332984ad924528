//! `alula geometry`.
use std::path::{Path, PathBuf};

use alula::geometry::{Surface, dimension, load_surface, write_obj, write_stl};
use alula::math::Vector;

use super::run::name_of;
use crate::arguments;
use crate::outcome::Outcome;
use crate::output;

/// Writes the bodies of a case as a surface file, and tells what it made.
pub(crate) fn geometry(args: &arguments::Geometry) -> Outcome {
    let case = match super::load(&args.case) {
        Ok(case) => case,
        Err(outcome) => return outcome,
    };
    if case.bodies.is_empty() || dimension(&case) != 3 {
        output::error(
            "the case has no bodies in space",
            "surface files are of wings, bodies of revolution and the like",
        );
        return Outcome::BadInput;
    }
    let out = args.out.clone().unwrap_or_else(|| PathBuf::from(format!("{}.stl", name_of(&args.case))));
    if out.exists() && !args.force {
        output::error(
            &format!("`{}` exists", out.display()),
            "give another name with `--out`, or replace it with `--force`",
        );
        return Outcome::BadInput;
    }
    let input = args.case.parent().map_or_else(PathBuf::new, Path::to_path_buf);
    let (surface, notes) = match load_surface::<3>(&case.bodies, &input) {
        Ok(found) => found,
        Err(problem) => return super::refuse(&problem.into()),
    };
    notes.iter().for_each(|n| output::note(n));
    match write(&out, &surface) {
        Ok(()) => output::data(&format!("{}written to {}\n", describe(&surface), out.display())),
        Err(problem) => {
            output::error(&format!("cannot write `{}`: {problem}", out.display()), "give a path you can write to");
            Outcome::BadInput
        }
    }
}

fn write(out: &Path, surface: &Surface<3>) -> std::io::Result<()> {
    let mut bytes = Vec::new();
    if out.extension().is_some_and(|e| e.eq_ignore_ascii_case("obj")) {
        write_obj(&mut bytes, surface)?;
    } else {
        write_stl(&mut bytes, surface)?;
    }
    std::fs::write(out, bytes)
}

fn point(x: &Vector<3>) -> String {
    format!("({:.6}, {:.6}, {:.6})", x[0], x[1], x[2])
}

fn describe(surface: &Surface<3>) -> String {
    let everywhere = surface.bounds();
    let seen = surface.planform(&everywhere, None);
    let areas = (0..surface.elements.len() as u32).map(|e| surface.element_area_vector(e));
    let open = areas.fold(Vector::ZERO, |a, b| a + b).norm() / surface.area();
    let mut text = String::new();
    for (k, name) in surface.bodies.iter().enumerate() {
        let b = surface.bounds_of(k);
        text += &format!("body           `{name}` from {} to {}\n", point(&b.min), point(&b.max));
    }
    text + &format!(
        "triangles      {}\nwetted area    {:.6}, open by {open:.1e} of it\nvolume         {:.6}\nplanform       area {:.6}, mean aerodynamic chord {:.6}\n",
        surface.elements.len(),
        surface.area(),
        surface.volume(),
        seen.area,
        seen.chord
    )
}
