//! `alula new`.
use std::fs::OpenOptions;
use std::io::{self, ErrorKind, Write};
use std::path::{Path, PathBuf};

use alula::case::{SCHEMA_FILE, SCHEMA_LINE, mode_files, read, schema_text, template};
use alula::geometry::{load_surface, write_stl};
use alula::run::RunError;

use crate::arguments;
use crate::outcome::Outcome;
use crate::output;

/// The wing of the template `stl`.
const WING: &str = "[flow]\nmach = 0.5\n[[body]]\nwing = { naca = \"0012\", span = 3, chord = 1, taper = 0.5, sweep = \"21.8 deg\", tip = \"flat\" }\n";

/// Writes a commented case file and what it refers to, never over existing files unless asked; on request beside it the schema that its
/// first line names, by which editors complete and check it.
pub(crate) fn new(args: &arguments::New) -> Outcome {
    let Some(text) = template(&args.template) else {
        output::error(&format!("no template is called `{}`", args.template), "see `alula new --help`");
        return Outcome::BadInput;
    };
    let text = if args.schema { SCHEMA_LINE.to_owned() + &text } else { text };
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
    match beside(args, &path) {
        Ok(told) => output::data(&format!("wrote {}\n{told}next: alula check {}\n", path.display(), path.display())),
        Err(refused) => refused,
    }
}

/// Writes what stands beside the case at `path`, and tells it.
fn beside(args: &arguments::New, path: &Path) -> Result<String, Outcome> {
    let mut files: Vec<(PathBuf, Vec<u8>, &str)> = Vec::new();
    if args.template == "stl" {
        let file = wing_file().map_err(|problem| super::refuse(&problem))?;
        files.push((path.with_file_name("body.stl"), file, "a wing to begin with"));
    }
    let modes = mode_files(&args.template).into_iter();
    files.extend(modes.map(|(name, text)| (path.with_file_name(name), text.into_bytes(), "the shape of a mode")));
    if args.schema {
        let words = "by which editors complete and check cases";
        files.push((path.with_file_name(SCHEMA_FILE), schema_text().into_bytes(), words));
    }
    let mut told = String::new();
    for (file, bytes, words) in files {
        match write(&file, &bytes, args.force) {
            Ok(()) => told += &format!("wrote {}, {words}\n", file.display()),
            Err(problem) if problem.kind() == ErrorKind::AlreadyExists => {}
            Err(problem) => return Err(cannot_write(&file, &problem)),
        }
    }
    Ok(told)
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
        let args =
            |force| arguments::New { template: "airfoil".to_owned(), path: Some(path.clone()), schema: false, force };
        let alone = || std::fs::read_dir(folder.path()).unwrap().count() == 1;
        assert_eq!(new(&args(false)), Outcome::Done);
        assert!(alone() && !std::fs::read_to_string(&path).unwrap().contains("#:schema"));
        std::fs::write(&path, "mine").unwrap();
        assert_eq!(new(&args(false)), Outcome::BadInput);
        assert_eq!(std::fs::read_to_string(&path).unwrap(), "mine");
        assert_eq!(new(&args(true)), Outcome::Done);
        assert_eq!(std::fs::read_to_string(&path).unwrap(), template("airfoil").unwrap());
        assert!(alone());
        let stl =
            arguments::New { template: "stl".to_owned(), path: Some(folder.path().join("wing.toml")), ..args(false) };
        assert_eq!(new(&stl), Outcome::Done);
        let case = alula::case::read(&std::fs::read_to_string(folder.path().join("wing.toml")).unwrap(), "wing.toml");
        let (surface, notes) = alula::geometry::load_surface::<3>(&case.unwrap().bodies, folder.path()).unwrap();
        assert!(surface.is_closed() && notes.is_empty(), "{notes:?}");
        let nowhere = arguments::New { path: Some(folder.path().join("no/where.toml")), ..args(false) };
        assert_eq!(new(&nowhere), Outcome::BadInput);
    }

    #[test]
    fn a_schema_is_written_on_request_and_found_from_the_case() {
        let folder = tempfile::tempdir().unwrap();
        let (path, schema) = (folder.path().join("mine.toml"), folder.path().join("alula.schema.json"));
        let args =
            |force| arguments::New { template: "polar".to_owned(), path: Some(path.clone()), schema: true, force };
        assert_eq!(new(&args(false)), Outcome::Done);
        let first = std::fs::read_to_string(&path).unwrap().lines().next().unwrap().to_owned();
        assert_eq!(folder.path().join(first.strip_prefix("#:schema ./").unwrap()), schema);
        assert_eq!(std::fs::read_to_string(&schema).unwrap(), schema_text());
        std::fs::write(&schema, "{}").unwrap();
        let other = arguments::New { path: Some(folder.path().join("other.toml")), ..args(false) };
        assert_eq!(new(&other), Outcome::Done);
        assert_eq!(std::fs::read_to_string(&schema).unwrap(), "{}", "a schema that is there stays");
        assert_eq!(new(&args(true)), Outcome::Done);
        assert_eq!(std::fs::read_to_string(&schema).unwrap(), schema_text());
    }
}
