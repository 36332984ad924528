//! Rules of what people read: papers of the project, book, links, tables that lead to sources, words that do not belong.
use std::path::Path;

use crate::{assert_none, code, files, fresh, read, root, tracked};

#[test]
fn the_project_has_its_papers() {
    let papers = [
        "README.md",
        "ARCHITECTURE.md",
        "CHANGELOG.md",
        "LICENSE-MIT",
        "LICENSE-APACHE",
        "justfile",
        "deny.toml",
        "clippy.toml",
        "rustfmt.toml",
        "book/SUMMARY.md",
        ".ci/run",
    ];
    let missing: Vec<String> = papers.iter().filter(|p| !root().join(p).is_file()).map(|p| (*p).to_string()).collect();
    assert_none(&missing, "missing papers");
    let version = read("Cargo.toml").lines().find_map(|l| l.strip_prefix("version = \"")).map(str::to_string).unwrap();
    assert!(read("CHANGELOG.md").contains(version.trim_end_matches('"')), "CHANGELOG.md does not name {version}");
}

/// Pages people read: README and its like, book, folders of cases.
fn papers() -> Vec<String> {
    let mut all =
        vec!["README.md".to_string(), "ARCHITECTURE.md".into(), "CHANGELOG.md".into(), "python/README.md".into()];
    all.extend(["book", "verification", "cases"].iter().flat_map(|f| files(f, ".md")));
    all
}

/// Markdown without what stands in fences and, where `spans` are to go too, in `code`.
fn prose(text: &str, spans: bool) -> String {
    let outside = text.split("\n```").step_by(2).collect::<Vec<_>>().join("\n");
    if spans { outside.split('`').step_by(2).collect::<Vec<_>>().join(" ") } else { outside }
}

/// What a heading is called in a link: letters and digits in lower case, `-` for each space.
fn anchor(heading: &str) -> String {
    let kept = heading.trim_start_matches('#').trim().chars().filter(|c| c.is_alphanumeric() || " -_".contains(*c));
    kept.map(|c| if c == ' ' { '-' } else { c.to_ascii_lowercase() }).collect()
}

#[test]
fn links_lead_somewhere() {
    let mut lost = Vec::new();
    for page in papers() {
        let text = read(&page);
        let folder = Path::new(&page).parent().unwrap();
        let links = prose(&text, true);
        let links = links.split("](").skip(1).filter_map(|l| l.split(')').next()).filter(|l| !l.contains("://"));
        for link in links {
            let (file, place) = link.split_once('#').unwrap_or((link, ""));
            let target = if file.is_empty() { page.clone() } else { folder.join(file).to_string_lossy().into_owned() };
            let there = root().join(&target).exists();
            let named = || prose(&read(&target), false).lines().any(|l| l.starts_with('#') && anchor(l) == place);
            let found = there && (place.is_empty() || named());
            if !found {
                lost.push(format!("{page}: {link}"));
            }
        }
        for include in text.split("{{#include ").skip(1).filter_map(|i| i.split([':', '}']).next()) {
            if !root().join(folder.join(include)).is_file() {
                lost.push(format!("{page}: {{{{#include {include}}}}}"));
            }
        }
    }
    assert_none(&lost, "links and includes that lead nowhere");
    assert_eq!(anchor("## What `summary.json` holds"), "what-summaryjson-holds");
}

/// mdBook makes pages of those that its summary names only, and takes links to others as they are.
#[test]
fn the_book_is_whole() {
    let named = read("book/SUMMARY.md");
    let mut problems = Vec::new();
    for page in files("book", ".md").iter().filter(|p| *p != "book/SUMMARY.md") {
        let inner = page.trim_start_matches("book/");
        if !named.contains(&format!("]({inner})")) {
            problems.push(format!("{page} is not in book/SUMMARY.md"));
        }
        let text = read(page);
        if ["\\\\(", "\\(", "\\[", "$$"].iter().any(|w| prose(&text, true).contains(w)) {
            problems.push(format!("{page} has a formula that is no code: Markdown would eat its backslashes"));
        }
        if text.lines().any(|l| l.contains("src=\"http") || l.contains("](http") && l.contains("![")) {
            problems.push(format!("{page} asks for a picture from a network"));
        }
    }
    assert_none(
        &problems,
        "the book has all its pages, formulas as code and no picture from elsewhere (book/formulas.py)",
    );
}

/// Each of the twelve rows names a file that has what it says: a function, type or trait of that name.
#[test]
fn questions_lead_to_their_files() {
    let text = read("ARCHITECTURE.md");
    let table = text.split("## Where to look").nth(1).unwrap_or_default().split("\n## ").next().unwrap_or_default();
    let rows: Vec<Vec<&str>> =
        table.lines().filter(|l| l.contains('?')).map(|l| l.split('`').skip(1).step_by(2).collect()).collect();
    assert_eq!(rows.len(), 12, "twelve questions");
    let mut lost = Vec::new();
    for row in &rows {
        let [file, name] = row[..] else { panic!("a row without file and name: {row:?}") };
        let there = root().join(file).is_file();
        let kinds = ["fn", "struct", "trait", "enum"].map(|kind| format!("{kind} {name}"));
        let ends = |rest: &str| !rest.starts_with(|c: char| c == '_' || c.is_alphanumeric());
        let has = |kind: &String| code(file).split(kind.as_str()).skip(1).any(ends);
        if !there || !kinds.iter().any(has) {
            lost.push(format!("{file} has no `{name}`"));
        }
    }
    assert_none(&lost, "ARCHITECTURE.md sends readers where nothing is");
}

#[test]
fn no_machine_paths_or_registries() {
    // spelt in pieces, so that this file passes its own test
    let folders = ["/wo#rk/", "/ro#ot/", "/ho#me/", "/tm#p/", "/Use#rs/"].map(|w| w.replace('#', ""));
    let hosts = ["crates#.io", "pypi#.org", "files.python#hosted"].map(|w| w.replace('#', ""));
    let mut found = Vec::new();
    for path in tracked().into_iter().filter(|p| !p.ends_with("Cargo.lock")) {
        let Ok(text) = std::fs::read_to_string(root().join(&path)) else { continue };
        for (k, line) in text.lines().enumerate() {
            if folders.iter().chain(&hosts).any(|w| line.contains(w.as_str())) {
                found.push(format!("{path}:{}: {}", k + 1, line.trim()));
            }
        }
    }
    assert_none(&found, "machine paths and registry hosts do not belong in the project");
}

#[test]
fn the_reference_of_the_case_file_is_fresh() {
    fresh("book/reference/case.md", &alula::case::reference_markdown());
}

#[test]
fn the_reference_of_the_tables_is_fresh() {
    fresh("book/reference/tables.md", &alula::observe::columns::reference_markdown());
}
