//! `alula new`.
use std::fs::OpenOptions;
use std::io::{self, ErrorKind, Write};
use std::path::{Path, PathBuf};

use alula::case::template;

use crate::arguments;
use crate::outcome::Outcome;
use crate::output;

/// Writes a commented case file, never over an existing one unless asked.
pub(crate) fn new(args: &arguments::New) -> Outcome {
    let Some(text) = template(&args.template) else {
        output::error(&format!("no template is called `{}`", args.template), "see `alula new --help`");
        return Outcome::BadInput;
    };
    let path = args.path.clone().unwrap_or_else(|| PathBuf::from(format!("{}.toml", args.template)));
    if path == Path::new("-") {
        return output::data(&text);
    }
    match write(&path, &text, args.force) {
        Ok(()) => output::data(&format!("wrote {0}\nnext: alula check {0}\n", path.display())),
        Err(problem) if problem.kind() == ErrorKind::AlreadyExists => {
            output::error(&format!("`{}` exists", path.display()), "give another name, or replace it with `--force`");
            Outcome::BadInput
        }
        Err(problem) => {
            output::error(&format!("cannot write `{}`: {problem}", path.display()), "give a path you can write to");
            Outcome::BadInput
        }
    }
}

fn write(path: &Path, text: &str, force: bool) -> io::Result<()> {
    let mut options = OpenOptions::new();
    options.write(true);
    if force {
        options.create(true).truncate(true)
    } else {
        options.create_new(true)
    };
    options.open(path)?.write_all(text.as_bytes())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_existing_file_is_kept() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("mine.toml");
        let args = |force| arguments::New { template: "airfoil".to_owned(), path: Some(path.clone()), force };
        assert_eq!(new(&args(false)), Outcome::Done);
        std::fs::write(&path, "mine").unwrap();
        assert_eq!(new(&args(false)), Outcome::BadInput);
        assert_eq!(std::fs::read_to_string(&path).unwrap(), "mine");
        assert_eq!(new(&args(true)), Outcome::Done);
        assert_eq!(std::fs::read_to_string(&path).unwrap(), template("airfoil").unwrap());
        let nowhere = arguments::New { path: Some(folder.path().join("no/where.toml")), ..args(false) };
        assert_eq!(new(&nowhere), Outcome::BadInput);
    }
}
