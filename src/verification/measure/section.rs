//! Pressure along the chord at stations of the span.
use std::path::Path;

use super::{Measured, no_wall};
use crate::claims::wall::contains;
use crate::claims::{Claim, Table};
use crate::geometry::{dimension, load_surface};
use crate::problem::files::plain;

impl Measured {
    /// Cp on the walls less that of the reference, at every row of the table `file` of the claim (within its `region`): `y` along the
    /// span, `x_c` from the nose to the tail of the section there, `surface`. No row is left out; the files of bodies lie in `folder`.
    pub(super) fn section_differences(&self, claim: &Claim, folder: &Path) -> Result<Vec<f64>, String> {
        let name = claim.file.as_deref().ok_or("the claim names no `file`")?;
        let problem = |e: &dyn std::fmt::Display| format!("`{name}`: {e}");
        if dimension(&self.case) != 3 {
            return Err("sections are cut in space".into());
        }
        let text = plain(&folder.join(name)).map_err(|e| problem(&e))?;
        let table = Table::parse(&text).map_err(|e| problem(&e))?;
        let column = |name: &str| table.column(name).map_err(|e| problem(&e));
        let (y, x_c, cp) = (column("y")?, column("x_c")?, column("Cp")?);
        let sides = table.text("surface").map_err(|e| problem(&e))?;
        let surface = load_surface::<3>(&self.case.bodies, folder).map_err(|e| e.to_string())?.0;
        let (mut differences, mut station) = (Vec::new(), None);
        for k in 0..table.len() {
            if station.as_ref().is_none_or(|(at, _)| *at != y[k]) {
                let section =
                    surface.cross_section(y[k]).ok_or_else(|| problem(&format!("no wall at y = {}", y[k])))?;
                station = Some((y[k], section));
            }
            let section = station.as_ref().map(|(_, section)| section);
            let (x, normal) = section.and_then(|o| o.at(x_c[k], sides[k] == "upper")).ok_or_else(no_wall)?;
            if claim.region.as_ref().is_none_or(|[low, high]| contains(low, high, &x.0)) {
                differences.push(self.wall.pressure_coefficient(&x, &normal).ok_or_else(no_wall)? - cp[k]);
            }
        }
        Ok(differences)
    }
}
