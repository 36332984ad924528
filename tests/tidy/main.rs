//! The rules of the house: floors, files, printing, lengths, equations, words.
//!
//! The sources are read as text; a cheap parser is enough because `rustfmt` fixes their layout. Generated pages of the book
//! are compared with what is committed: `ALULA_WRITE=1 cargo test --release --workspace --test tidy` brings them up to date.
#![allow(clippy::unwrap_used, reason = "it may stop anywhere")]
mod equations;
mod floors;
mod papers;

use std::path::{Path, PathBuf};
use std::process::Command;

fn root() -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR"))
}

fn read(path: &str) -> String {
    std::fs::read_to_string(root().join(path)).unwrap_or_else(|e| panic!("{path}: {e}"))
}

/// All files under `folder` whose name ends in `suffix`, sorted, relative to the root.
fn files(folder: &str, suffix: &str) -> Vec<String> {
    let mut found = Vec::new();
    let mut stack = vec![root().join(folder)];
    while let Some(place) = stack.pop() {
        for entry in std::fs::read_dir(&place).unwrap().map(|e| e.unwrap().path()) {
            if entry.is_dir() {
                stack.push(entry);
            } else if entry.to_string_lossy().ends_with(suffix) {
                found.push(entry.strip_prefix(root()).unwrap().to_string_lossy().replace('\\', "/"));
            }
        }
    }
    found.sort();
    found
}

/// Sources of the library: of the crate that users see, and of those that its floors are made of.
fn sources() -> Vec<String> {
    let floors = files("crates", ".rs");
    files("src", ".rs").into_iter().chain(floors.into_iter().filter(|p| p.contains("/src/"))).collect()
}

/// The sources of one module.
fn sources_of(module: &str) -> Vec<String> {
    sources().into_iter().filter(|p| module_of(p) == module).collect()
}

/// Source without its tests and without comments.
fn code(path: &str) -> String {
    let text = read(path);
    if path.ends_with("/tests.rs") {
        return String::new();
    }
    uncommented(text.split("\n#[cfg(test)]\nmod tests {").next().unwrap_or_default())
}

fn uncommented(text: &str) -> String {
    let lines = text.lines().map(|l| l.split("//").next().unwrap_or_default());
    lines.collect::<Vec<_>>().join("\n")
}

fn module_of(path: &str) -> &str {
    let inner = path.split_once("src/").map_or(path, |(_, inner)| inner);
    inner.split('/').next().unwrap_or_default().trim_end_matches(".rs")
}

fn assert_none(problems: &[String], rule: &str) {
    assert!(problems.is_empty(), "{rule}:\n  {}", problems.join("\n  "));
}

/// Tracked files; all files of the main folders where there is no git.
fn tracked() -> Vec<String> {
    let listed = Command::new("git").args(["ls-files", "-z"]).current_dir(root()).output();
    if let Ok(out) = listed
        && out.status.success()
        && !out.stdout.is_empty()
    {
        return String::from_utf8_lossy(&out.stdout)
            .split('\0')
            .filter(|p| !p.is_empty())
            .map(str::to_string)
            .collect();
    }
    ["src", "crates", "cli", "tests", "examples", "benches", "book", "cases", "verification"]
        .iter()
        .flat_map(|f| files(f, ""))
        .collect()
}

/// Compares a generated page with the committed one, or writes it when `ALULA_WRITE` is set.
fn fresh(path: &str, page: &str) {
    let place = root().join(path);
    if std::env::var_os("ALULA_WRITE").is_some() {
        std::fs::create_dir_all(place.parent().unwrap_or(Path::new("."))).unwrap();
        std::fs::write(&place, page).unwrap();
    }
    let committed = std::fs::read_to_string(&place).unwrap_or_default();
    assert!(committed == page, "`{path}` is stale; hint: `ALULA_WRITE=1 cargo test --release --workspace --test tidy`");
}
