//! `alula geometry`.
use std::path::{Path, PathBuf};

use alula::case::Case;
use alula::geometry::{Surface, dimension, load_surface, write_obj, write_outlines, write_stl};
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
    if case.bodies.is_empty() {
        output::error("the case has no bodies", "add a `[[body]]`");
        return Outcome::BadInput;
    }
    if dimension(&case) == 2 { made::<2>(&case, args, "dat") } else { made::<3>(&case, args, "stl") }
}

/// The same in `D` dimensions; `kind` is the usual end of the name of the file.
fn made<const D: usize>(case: &Case, args: &arguments::Geometry, kind: &str) -> Outcome
where
    Surface<D>: Shown,
{
    let out = args.out.clone().unwrap_or_else(|| PathBuf::from(format!("{}.{kind}", name_of(&args.case))));
    if out.exists() && !args.force {
        output::error(
            &format!("`{}` exists", out.display()),
            "give another name with `--out`, or replace it with `--force`",
        );
        return Outcome::BadInput;
    }
    let input = args.case.parent().map_or_else(PathBuf::new, Path::to_path_buf);
    let (surface, notes) = match load_surface::<D>(&case.bodies, &input) {
        Ok(found) => found,
        Err(problem) => return super::refuse(&problem.into()),
    };
    notes.iter().for_each(|n| output::note(n));
    match surface.bytes(&out).and_then(|bytes| std::fs::write(&out, bytes)) {
        Ok(()) => output::data(&format!("{}written to {}\n", surface.describe(), out.display())),
        Err(problem) => {
            output::error(&format!("cannot write `{}`: {problem}", out.display()), "give a path you can write to");
            Outcome::BadInput
        }
    }
}

/// Bodies as a file and in words.
trait Shown {
    /// The bytes of the file `out`, whose name tells the format.
    fn bytes(&self, out: &Path) -> std::io::Result<Vec<u8>>;
    /// What they are in words.
    fn describe(&self) -> String;
}

impl Shown for Surface<2> {
    fn bytes(&self, _: &Path) -> std::io::Result<Vec<u8>> {
        let mut bytes = Vec::new();
        write_outlines(&mut bytes, self)?;
        Ok(bytes)
    }

    fn describe(&self) -> String {
        let (points, length, area) = (self.elements.len(), self.area(), self.volume());
        bodies(self) + &format!("outline        {points} points, {length:.6} long\narea           {area:.8}\n")
    }
}

impl Shown for Surface<3> {
    fn bytes(&self, out: &Path) -> std::io::Result<Vec<u8>> {
        let mut bytes = Vec::new();
        if out.extension().is_some_and(|e| e.eq_ignore_ascii_case("obj")) {
            write_obj(&mut bytes, self)?;
        } else {
            write_stl(&mut bytes, self)?;
        }
        Ok(bytes)
    }

    fn describe(&self) -> String {
        let seen = self.planform(&self.bounds(), None);
        let areas = (0..self.elements.len() as u32).map(|e| self.element_area_vector(e));
        let open = areas.fold(Vector::ZERO, |a, b| a + b).norm() / self.area();
        bodies(self)
            + &format!(
                "triangles      {}\nwetted area    {:.6}, open by {open:.1e} of it\nvolume         {:.6}\nplanform       area {:.6}, mean aerodynamic chord {:.6}\n",
                self.elements.len(),
                self.area(),
                self.volume(),
                seen.area,
                seen.chord
            )
    }
}

/// Names of the bodies, and the boxes around them.
fn bodies<const D: usize>(surface: &Surface<D>) -> String {
    let line = |(k, name): (usize, &String)| {
        let b = surface.bounds_of(k);
        format!("body           `{name}` from {} to {}\n", point(&b.min), point(&b.max))
    };
    surface.bodies.iter().enumerate().map(line).collect()
}

fn point<const D: usize>(x: &Vector<D>) -> String {
    format!("({})", x.0.map(|c| format!("{c:.6}")).join(", "))
}
