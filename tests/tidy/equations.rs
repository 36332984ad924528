//! Equations of the paper: each is coded once and has a test, or is excused; the page of the book that lists them.
use std::collections::BTreeMap;
use std::fmt::Write as _;

use crate::{assert_none, files, fresh, read, sources};

/// What each equation says, by number.
const EQUATIONS: [&str; 32] = [
    "conservation of mass",
    "conservation of momentum",
    "conservation of energy",
    "strain rate",
    "stress of a Newtonian fluid",
    "p = (γ − 1) ρ e",
    "split of the Cauchy stress",
    "hypoelastic pressure",
    "deviatoric stress",
    "normal equations of the linear fit, values given (Dirichlet)",
    "linear fit f = a₀ + a₁x + a₂y + a₃z",
    "∂f/∂n = 0 on the interface (Neumann)",
    "the Neumann condition as a row: a·n = 0",
    "overdetermined system of values and Neumann rows",
    "normal equations with Neumann rows",
    "∂Q/∂t + R = 0",
    "Q = (ρ, u, e)",
    "R as internal and external parts",
    "Fourier series of Q",
    "Fourier series of R",
    "series put into the equations",
    "harmonics sorted",
    "ωA Q̂ + R̂ = 0",
    "vectors of Fourier coefficients",
    "matrix A",
    "vectors of time instances",
    "Q̃ = E⁻¹ Q̂",
    "Q̂ = E Q̃",
    "ωD Q̃ + R̃ = 0, D = E⁻¹ A E",
    "matrix E⁻¹",
    "matrix E",
    "∂Q̃/∂τ + ωD Q̃ + R̃ = 0",
];

/// Where an equation stands: file and the name of what carries it.
fn coded() -> BTreeMap<usize, Vec<(String, String)>> {
    let mut found: BTreeMap<usize, Vec<(String, String)>> = BTreeMap::new();
    for path in sources() {
        let text = read(&path);
        let lines: Vec<&str> = text.lines().map(str::trim).collect();
        for (k, line) in lines.iter().enumerate() {
            let Some(number) = line.strip_prefix("#[doc(alias = \"eq").and_then(|l| l.strip_suffix("\")]")) else {
                continue;
            };
            let item = lines[k..].iter().find(|l| !l.starts_with('#') && !l.starts_with("//")).unwrap();
            let number = number.parse().unwrap_or_else(|_| panic!("{path}: `{line}`"));
            let block = text.lines().take(k).filter(|l| l.starts_with("impl") || *l == "}").last();
            let owner = block.filter(|l| l.starts_with("impl")).map_or_else(String::new, owner_of);
            found.entry(number).or_default().push((path.clone(), owner + &name_of(item)));
        }
    }
    found
}

/// `Type::` of an `impl` line.
fn owner_of(line: &str) -> String {
    let name = line.split(" for ").last().unwrap_or_default().trim_start_matches("impl");
    let name = if name.starts_with('<') { name.split_once("> ").map_or(name, |(_, n)| n) } else { name };
    name.trim().chars().take_while(|c| c.is_alphanumeric()).collect::<String>() + "::"
}

/// Name of the item that a line declares.
fn name_of(line: &str) -> String {
    let words: Vec<&str> = line.split(|c: char| !c.is_alphanumeric() && c != '_').filter(|w| !w.is_empty()).collect();
    let at = words.iter().position(|w| ["fn", "struct", "trait", "enum", "const", "type"].contains(w));
    words
        .get(at.map_or(0, |k| if words[k] == "const" && words.get(k + 1) == Some(&"fn") { k + 2 } else { k + 1 }))
        .map_or_else(String::new, ToString::to_string)
}

/// Tests by the equations they name in the comment beside `#[test]`: `#[test] // eq10, eq15`.
fn proofs() -> BTreeMap<usize, Vec<String>> {
    let mut found: BTreeMap<usize, Vec<String>> = BTreeMap::new();
    for path in sources().into_iter().chain(files("tests", ".rs")) {
        let text = read(&path);
        let lines: Vec<&str> = text.lines().map(str::trim).collect();
        for (k, line) in lines.iter().enumerate() {
            let Some(comment) = line.strip_prefix("#[test] //") else { continue };
            let Some(item) = lines[k..].iter().find(|l| l.starts_with("fn ")) else { continue };
            for word in comment.split([',', ' ', ':', ';']) {
                if let Some(n) = word.strip_prefix("eq").and_then(|n| n.parse().ok()) {
                    found.entry(n).or_default().push(name_of(item));
                }
            }
        }
    }
    found
}

fn excuses() -> BTreeMap<usize, String> {
    let table: toml::Table = toml::from_str(&read("book/equations-not-coded.toml")).unwrap();
    let number = |key: &str| key.strip_prefix("eq").and_then(|n| n.parse().ok()).unwrap_or_else(|| panic!("`{key}`"));
    table.iter().map(|(key, reason)| (number(key), reason.as_str().unwrap().to_string())).collect()
}

#[test]
fn every_equation_is_coded_once_and_proven_or_excused() {
    let (coded, proofs, excuses) = (coded(), proofs(), excuses());
    let mut problems = Vec::new();
    for n in 1..=EQUATIONS.len() {
        match (coded.get(&n).map_or(0, Vec::len), excuses.get(&n)) {
            (1, None) if proofs.contains_key(&n) => {}
            (1, None) => problems.push(format!("eq{n} has no test: write `#[test] // eq{n}` beside one")),
            (1, Some(_)) => problems.push(format!("eq{n} is coded and excused")),
            (0, Some(reason)) if reason.len() > 10 => {}
            (0, _) => problems.push(format!("eq{n} is neither coded nor excused")),
            (k, _) => problems.push(format!("eq{n} stands {k} times")),
        }
    }
    problems.extend(coded.keys().chain(excuses.keys()).filter(|n| **n > EQUATIONS.len()).map(|n| format!("eq{n}?")));
    assert_none(&problems, "each equation stands exactly once in the sources, with a test, or is excused");
    fresh("book/equations.md", &equations_page(&coded, &proofs, &excuses));
}

fn equations_page(
    coded: &BTreeMap<usize, Vec<(String, String)>>,
    proofs: &BTreeMap<usize, Vec<String>>,
    excuses: &BTreeMap<usize, String>,
) -> String {
    let mut page = String::from(
        "# Equations of the paper\n\n<!-- generated by tests/tidy -->\n\nNumbers are those of Hu, Kamakoti, Xue, Wang, Li, Attar and Vedula, AIAA 2010-7604. A function that realises an equation\ncarries its number: search the documentation for `eq10`.\n\n| eq. | statement | function | test |\n|---|---|---|---|\n",
    );
    for (n, statement) in (1..).zip(EQUATIONS) {
        let row = match coded.get(&n).and_then(|places| places.first()) {
            Some((path, name)) => {
                let tests: Vec<String> = proofs.get(&n).into_iter().flatten().map(|t| format!("`{t}`")).collect();
                format!("`{name}` in `{path}` | {}", tests.join(", "))
            }
            None => format!("not coded: {} | ", excuses.get(&n).map_or("", String::as_str)),
        };
        let _ = writeln!(page, "| {n} | {statement} | {row} |");
    }
    page
}
