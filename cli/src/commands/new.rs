//! `alula new`.
use std::fs::OpenOptions;
use std::io::{self, ErrorKind, Write};
use std::path::{Path, PathBuf};

use alula::case::{SCHEMA_FILE, mode_files, read, template};
use alula::geometry::{load_surface, write_stl};
use alula::run::RunError;

use crate::arguments;
use crate::outcome::Outcome;
use crate::output;

/// The wing of the template `stl`.
const WING: &str = "[flow]\nmach = 0.5\n[[body]]\nwing = { naca = \"0012\", span = 3, chord = 1, taper = 0.5, sweep = \"21.8 deg\", tip = \"flat\" }\n";

/// Writes a commented case file, never over an existing one unless asked, and beside it the schema that its first line names, by
/// which editors complete and check it.
pub(crate) fn new(args: &arguments::New) -> Outcome {
    let Some(text) = template(&args.template) else {
        output::error(&format!("no template is called `{}`", args.template), "see `alula new --help`");
        return Outcome::BadInput;
    };
    let path = args.path.clone().unwrap_or_else(|| PathBuf::from(format!("{}.toml", args.template)));
    if path == Path::new("-") {
        return output::data(&text);
    }
    match write(&path, text.as_bytes(), args.force) {
        Ok(()) => {}
        Err(problem) if problem.kind() == ErrorKind::AlreadyExists => {
            output::error(&format!("`{}` exists", path.display()), "give another name, or replace it with `--force`");
            return Outcome::BadInput;
        }
        Err(problem) => return cannot_write(&path, &problem),
    }
    let schema = path.with_file_name(SCHEMA_FILE);
    let mut told = format!("wrote {}\n", path.display());
    if args.template == "stl" {
        let body = path.with_file_name("body.stl");
        let file = match wing_file() {
            Ok(file) => file,
            Err(problem) => return super::refuse(&problem),
        };
        match write(&body, &file, args.force) {
            Ok(()) => told += &format!("wrote {}, a wing to begin with\n", body.display()),
            Err(problem) if problem.kind() == ErrorKind::AlreadyExists => {}
            Err(problem) => return cannot_write(&body, &problem),
        }
    }
    for (name, text) in mode_files(&args.template) {
        let file = path.with_file_name(name);
        match write(&file, text.as_bytes(), args.force) {
            Ok(()) => told += &format!("wrote {}, the shape of a mode\n", file.display()),
            Err(problem) if problem.kind() == ErrorKind::AlreadyExists => {}
            Err(problem) => return cannot_write(&file, &problem),
        }
    }
    match write(&schema, super::schema::text().as_bytes(), args.force) {
        Ok(()) => told += &format!("wrote {}, by which editors complete and check cases\n", schema.display()),
        Err(problem) if problem.kind() == ErrorKind::AlreadyExists => {}
        Err(problem) => return cannot_write(&schema, &problem),
    }
    output::data(&format!("{told}next: alula check {}\n", path.display()))
}

fn cannot_write(path: &Path, problem: &io::Error) -> Outcome {
    output::error(&format!("cannot write `{}`: {problem}", path.display()), "give a path you can write to");
    Outcome::BadInput
}

/// The wing that the template `stl` computes, as a binary STL file.
fn wing_file() -> Result<Vec<u8>, RunError> {
    let case = read(WING, "wing").map_err(|_| RunError::NoStage)?;
    let (surface, _) = load_surface::<3>(&case.bodies, Path::new("."))?;
    let mut bytes = Vec::new();
    // memory takes every byte
    let _ = write_stl(&mut bytes, &surface);
    Ok(bytes)
}

fn write(path: &Path, bytes: &[u8], force: bool) -> io::Result<()> {
    let mut options = OpenOptions::new();
    options.write(true);
    if force {
        options.create(true).truncate(true)
    } else {
        options.create_new(true)
    };
    options.open(path)?.write_all(bytes)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_existing_file_is_kept() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("mine.toml");
        let args = |force| arguments::New { template: "airfoil".to_owned(), path: Some(path.clone()), force };
        let schema = folder.path().join("alula.schema.json");
        assert_eq!(new(&args(false)), Outcome::Done);
        let written = std::fs::read_to_string(&schema).unwrap();
        assert_eq!(serde_json::from_str::<serde_json::Value>(&written).unwrap(), alula::case::schema());
        std::fs::write(&path, "mine").unwrap();
        std::fs::write(&schema, "{}").unwrap();
        assert_eq!(new(&args(false)), Outcome::BadInput);
        assert_eq!(std::fs::read_to_string(&path).unwrap(), "mine");
        let other = arguments::New { path: Some(folder.path().join("other.toml")), ..args(false) };
        assert_eq!(new(&other), Outcome::Done);
        assert_eq!(std::fs::read_to_string(&schema).unwrap(), "{}", "a schema that is there stays");
        assert_eq!(new(&args(true)), Outcome::Done);
        assert_eq!(std::fs::read_to_string(&schema).unwrap(), written);
        assert_eq!(std::fs::read_to_string(&path).unwrap(), template("airfoil").unwrap());
        let stl =
            arguments::New { template: "stl".to_owned(), path: Some(folder.path().join("wing.toml")), force: false };
        assert_eq!(new(&stl), Outcome::Done);
        let case = alula::case::read(&std::fs::read_to_string(folder.path().join("wing.toml")).unwrap(), "wing.toml");
        let (surface, notes) = alula::geometry::load_surface::<3>(&case.unwrap().bodies, folder.path()).unwrap();
        assert!(surface.is_closed() && notes.is_empty(), "{notes:?}");
        let nowhere = arguments::New { path: Some(folder.path().join("no/where.toml")), ..args(false) };
        assert_eq!(new(&nowhere), Outcome::BadInput);
    }
}
