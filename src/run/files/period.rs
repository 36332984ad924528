//! Files of a harmonic balance: loads at its instances, and mean and harmonics of the field and on the walls.
use std::borrow::Cow;
use std::path::Path;

use super::super::about;
use crate::case::Case;
use crate::observe::table::{Entry, write_csv};
use crate::observe::vtk::{Column, write_cells};
use crate::problem::RunError;
use crate::study::look::{Held, Mesh, Rim};
use crate::study::studies::PeriodFields;

/// Writes `instances.csv`, `field_harmonics.vtu` and `surface_harmonics.csv`.
pub(crate) fn write_period<const D: usize>(
    case: &Case,
    instances: &[[f64; 6]],
    fields: &PeriodFields<'_, D>,
    out: &Path,
) -> Result<(), RunError> {
    let rows = instances.iter().map(|row| row.map(Entry::from).to_vec());
    write_csv(&out.join("instances.csv"), &["phase", "angle_deg", "shift", "cl", "cd", "cm"], rows)?;
    fields.write_field(case, out)?;
    fields.write_surface(out)
}

impl<const D: usize> PeriodFields<'_, D> {
    /// Coefficient `row` in time of values at the instances.
    fn coefficient(&self) -> impl Fn(usize, &[f64]) -> f64 + use<D> {
        let forth = self.instances.to_coefficients();
        move |row, values| forth.row(row).iter().zip(values).map(|(e, v)| e * v).sum()
    }

    /// `field_harmonics.vtu`: mean and complex harmonics at the particles before any motion.
    fn write_field(&self, case: &Case, out: &Path) -> Result<(), RunError> {
        let (cloud, coefficient) = (&self.gas.discretisation.cloud, self.coefficient());
        let held = Held::of(case, cloud);
        let n = self.instances.harmonics();
        let velocity = ["velocity_x", "velocity_y", "velocity_z"].into_iter().take(D);
        let shift = ["displacement_x", "displacement_y", "displacement_z"].into_iter().take(D);
        let names = std::iter::once("density").chain(velocity).chain(["pressure"]).chain(shift);
        let told = self.moments[..D + 2].iter().chain(&self.moments[D + 3..]);
        let mut columns: Vec<(String, Vec<f64>)> = Vec::new();
        for (name, values) in names.zip(told) {
            let column =
                |row: usize, sign: f64| values.iter().map(|v| sign * coefficient(row, v)).collect::<Vec<f64>>();
            columns.push((format!("{name}_mean"), column(0, 1.0)));
            for m in 1..=n {
                columns.push((format!("{name}_{m}_re"), column(m, 1.0)));
                columns.push((format!("{name}_{m}_im"), column(n + m, -1.0)));
            }
        }
        let rim = Rim::of(case, cloud, &held);
        let points = rim.with_places(held.numbers().map(|i| cloud.x[i].to_3d()).collect());
        let columns: Vec<(&str, Cow<'_, [f64]>)> = columns
            .iter()
            .map(|(name, values)| (name.as_str(), rim.with_values(name, 1, held.rows(1, values))))
            .collect();
        let columns: Vec<Column<'_>> =
            columns.iter().map(|(name, values)| Column { name, components: 1, values }).collect();
        let (about, mesh) = (about::gas(case, "pressure_mean", None), Mesh::of(cloud, &held, &rim));
        Ok(write_cells(&out.join("field_harmonics.vtu"), &about, &points, mesh.cells(), &columns)?)
    }

    /// `surface_harmonics.csv`: the same of the pressure coefficient on the walls.
    fn write_surface(&self, out: &Path) -> Result<(), RunError> {
        let (cloud, coefficient) = (&self.gas.discretisation.cloud, self.coefficient());
        let n = self.instances.harmonics();
        let mut names = ["x", "y", "z", "area", "cp_mean"].map(String::from).to_vec();
        names.extend((1..=n).flat_map(|m| [format!("cp_{m}_re"), format!("cp_{m}_im")]));
        let rows = cloud.interface_range().zip(&cloud.interface).map(|(i, wall)| {
            let cp = &self.moments[D + 2][i];
            let mut row = cloud.x[i].to_3d().map(Entry::from).to_vec();
            row.push(Entry::from(wall.area.norm()));
            row.push(Entry::from(coefficient(0, cp)));
            row.extend((1..=n).flat_map(|m| [coefficient(m, cp), -coefficient(n + m, cp)]).map(Entry::from));
            row
        });
        let names: Vec<&str> = names.iter().map(String::as_str).collect();
        Ok(write_csv(&out.join("surface_harmonics.csv"), &names, rows.collect::<Vec<_>>())?)
    }
}
