//! Files of the structure in the stream as a linear system.
use std::path::Path;

use crate::observe::table::{Entry, write_csv, write_json};
use crate::problem::RunError;
use crate::record::flutter::StateSpaceAt;

/// Writes `state-space-mach-….json` and a table for each matrix.
pub(super) fn write(system: &StateSpaceAt, mach: f64, out: &Path) -> Result<(), RunError> {
    let name = format!("state-space-mach-{mach:.3}");
    write_json(&out.join(format!("{name}.json")), system)?;
    let all = [
        ("a", &system.a, &system.states),
        ("b", &system.b, &system.inputs),
        ("c", &system.c, &system.states),
        ("d", &system.d, &system.inputs),
    ];
    for (letter, rows, columns) in all {
        let columns: Vec<&str> = columns.iter().map(String::as_str).collect();
        let rows = rows.iter().map(|row| row.iter().map(|x| Entry::from(*x)).collect());
        write_csv(&out.join(format!("{name}-{letter}.csv")), &columns, rows)?;
    }
    Ok(())
}
