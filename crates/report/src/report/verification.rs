//! The page of `alula verify`: claims, what was computed, and whether they hold.
use std::path::Path;

use super::page::{Block, Cell, Page, Section, Status, Table};
use super::words::number;
use super::{ReportError, write_file};
use crate::case::ClaimRow;

/// Names of the columns.
const COLUMNS: [&str; 7] = ["", "metric", "computed", "reference", "error", "tolerance", "authority"];

/// Writes a self-contained page with one table per case.
pub fn write_verification_page(rows: &[ClaimRow], path: &Path) -> Result<(), ReportError> {
    let held = rows.iter().filter(|row| row.pass).count();
    let class = if held == rows.len() { "good" } else { "bad" };
    let verdict = format!("{held} of {} claims hold", rows.len());
    let mut cases: Vec<&str> = Vec::new();
    for row in rows {
        if !cases.contains(&row.case.as_str()) {
            cases.push(&row.case);
        }
    }
    let section = |case: &str| {
        let claims = rows.iter().filter(|row| row.case == case).map(cells).collect();
        let table = Table { columns: COLUMNS.map(str::to_owned).to_vec(), rows: claims };
        Section::new("", case, Ok(vec![Block::Table(table)]))
    };
    let page = Page {
        title: "Verification".to_owned(),
        status: Some(Status { class, verdict, facts: String::new() }),
        sections: cases.into_iter().map(section).collect(),
        ..Page::default()
    };
    write_file(path, page.html()?.as_bytes())
}

fn cells(claim: &ClaimRow) -> Vec<Cell> {
    let (text, class) = if claim.pass { ("holds", "good") } else { ("fails", "bad") };
    let entries = [
        claim.metric.clone(),
        number(claim.value),
        number(claim.reference),
        number(claim.error),
        format!("≤ {}", number(claim.tolerance)),
        claim.source.clone(),
    ];
    let verdict = Cell { text: text.to_owned(), class, link: None };
    std::iter::once(verdict).chain(entries.into_iter().map(Cell::from)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::report::overview::tests::assert_balanced;

    #[test]
    fn claims_are_listed_by_case() {
        let row = |case: &str, metric: &str, pass: bool| ClaimRow {
            case: case.into(),
            metric: metric.into(),
            name: "cl",
            label: None,
            kind: "relative",
            runs: 1,
            scatter: 0.0,
            value: 0.352,
            reference: 0.349,
            error: 0.0086,
            tolerance: 0.03,
            pass,
            source: "CFL3D <80 chords>".into(),
        };
        let rows = [row("naca0012-m0.8", "CL", true), row("vortex", "order", false), row("naca0012-m0.8", "CD", true)];
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("verification.html");
        write_verification_page(&rows, &path).unwrap();
        let page = std::fs::read_to_string(&path).unwrap();
        assert_balanced(&page);
        assert!(page.contains("2 of 3 claims hold") && page.contains("CFL3D &#60;80 chords&#62;"));
        assert_eq!(page.matches("<section>").count(), 2);
        assert_eq!(page.matches("<td class=\"bad\">fails</td>").count(), 1);
        if let Some(folder) = std::env::var_os("ALULA_PICTURES") {
            std::fs::write(Path::new(&folder).join("verification.html"), page).unwrap();
        }
    }
}
