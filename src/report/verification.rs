//! The page of `alula verify`: claims, what was computed, and whether they hold.
use std::path::Path;

use super::html::page;
use super::sections::{number, table_html};
use super::{ReportError, escape, write_file};
use crate::case::ClaimRow;

/// Writes a self-contained page with one table per case.
pub fn write_verification_page(rows: &[ClaimRow], path: &Path) -> Result<(), ReportError> {
    let held = rows.iter().filter(|row| row.pass).count();
    let class = if held == rows.len() { "good" } else { "bad" };
    let mut body = format!(
        "<header>\n<h1>Verification</h1>\n<p class=\"status\"><span class=\"{class}\">{held} of {} claims hold</span></p>\n</header>\n",
        rows.len()
    );
    let mut cases: Vec<&str> = Vec::new();
    for row in rows {
        if !cases.contains(&row.case.as_str()) {
            cases.push(&row.case);
        }
    }
    for case in cases {
        let claims = rows.iter().filter(|row| row.case == case);
        body.push_str(&format!("<section>\n<h2>{}</h2>\n{}</section>\n", escape(case), claim_table(claims)));
    }
    write_file(path, page("Verification", &body).as_bytes())
}

fn claim_table<'a>(claims: impl Iterator<Item = &'a ClaimRow>) -> String {
    let row = |claim: &ClaimRow| {
        let verdict = if claim.pass { "holds" } else { "FAILS" };
        vec![
            verdict.to_owned(),
            claim.metric.clone(),
            number(claim.value),
            number(claim.reference),
            number(claim.error),
            format!("≤ {}", number(claim.tolerance)),
            claim.source.clone(),
        ]
    };
    let table =
        table_html(&["", "metric", "computed", "reference", "error", "tolerance", "authority"], claims.map(row));
    table
        .replace("<td>holds</td>", "<td class=\"good\">holds</td>")
        .replace("<td>FAILS</td>", "<td class=\"bad\">fails</td>")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::report::html::tests::assert_balanced;

    #[test]
    fn claims_are_listed_by_case() {
        let row = |case: &str, metric: &str, pass: bool| ClaimRow {
            case: case.into(),
            metric: metric.into(),
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
        assert!(page.contains("2 of 3 claims hold") && page.contains("CFL3D &lt;80 chords&gt;"));
        assert_eq!(page.matches("<section>").count(), 2);
        assert_eq!(page.matches("<td class=\"bad\">fails</td>").count(), 1);
        if let Some(folder) = std::env::var_os("ALULA_PICTURES") {
            std::fs::write(Path::new(&folder).join("verification.html"), page).unwrap();
        }
    }
}
