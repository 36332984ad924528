//! Solid particles and their history as plain tables: what files and sessions hold. In SI units, in a gas in the units of the case.
use super::super::look::Snapshot;
use super::record::{Row, ledger};
use crate::physics::solid::{Material, Tensor, tensor};
use crate::problem::solids::Built;
use crate::solid::Solid;
use crate::solid::forces::State;

/// A column: name, components, values.
type Column = (&'static str, usize, Vec<f64>);

/// Von Mises's stress at every particle.
pub(crate) fn von_mises<const D: usize>(solid: &Solid<D>, state: &State<'_, D>) -> Vec<f64> {
    stresses(solid, state).iter().map(mises).collect()
}

fn mises(s: &Tensor) -> f64 {
    (1.5f64).sqrt() * tensor::norm(&tensor::deviator(s))
}

/// Cauchy's stress at every particle.
pub(crate) fn stresses<const D: usize>(solid: &Solid<D>, state: &State<'_, D>) -> Vec<Tensor> {
    (0..solid.len()).map(|i| solid.cauchy(i, state)).collect()
}

/// Vectors with three components, one after another.
fn raised<const D: usize>(vectors: &[[f64; D]]) -> Vec<f64> {
    vectors.iter().flat_map(|v| std::array::from_fn::<f64, 3, _>(|a| v.get(a).copied().unwrap_or(0.0))).collect()
}

/// Where particles are in a state.
pub(crate) fn places<const D: usize>(solid: &Solid<D>, state: &State<'_, D>) -> Vec<[f64; 3]> {
    let place = |i: usize| solid.particles.x[i].to_3d();
    let moved = |i: usize, a: usize| state.displacement[i].get(a).copied().unwrap_or(0.0);
    (0..solid.len()).map(|i| std::array::from_fn(|a| place(i)[a] + moved(i, a))).collect()
}

/// Displacement, velocity, stress and what materials remember, in the order of field files.
pub(crate) fn columns<const D: usize>(solid: &Solid<D>, state: &State<'_, D>, stresses: &[Tensor]) -> Vec<Column> {
    let memory = |f: &dyn Fn(&Material, &[f64]) -> f64| -> Vec<f64> {
        (0..solid.len()).map(|i| f(solid.material_of(i), solid.memory(i, state.history))).collect()
    };
    let mut all = vec![
        ("displacement", 3, raised(state.displacement)),
        ("velocity", 3, raised(state.velocity)),
        ("von_mises_stress", 1, stresses.iter().map(mises).collect()),
        ("pressure", 1, stresses.iter().map(|s| -tensor::trace(s) / 3.0).collect()),
        ("volume", 1, solid.particles.volume.clone()),
        ("body", 1, solid.body.iter().map(|b| f64::from(*b)).collect()),
        ("material", 1, solid.material.iter().map(|b| f64::from(*b)).collect()),
    ];
    if solid.materials.iter().any(|m| m.yield_stress().is_some()) {
        all.push(("plastic_strain", 1, memory(&|m, h| m.plastic_strain(h))));
        all.push(("temperature", 1, memory(&|m, h| m.temperature(h))));
    }
    all
}

/// Particles where they are in a state, with all that field files hold, places at rest, Cauchy's stress (nine components, rows first), volume
/// and spacing at rest.
pub(crate) fn snapshot<const D: usize>(solid: &Solid<D>, state: &State<'_, D>) -> Snapshot {
    let (stresses, particles) = (stresses(solid, state), &solid.particles);
    let mut columns = columns(solid, state, &stresses);
    columns.extend([
        ("at_rest", 3, particles.x.iter().flat_map(|x| x.to_3d()).collect()),
        ("stress", 9, stresses.iter().flatten().flatten().copied().collect()),
        ("spacing", 1, particles.spacing.clone()),
    ]);
    Snapshot { points: places(solid, state), columns }
}

/// The columns of `history.csv`, and its rows.
pub(crate) fn history<const D: usize>(built: &Built<D>, rows: &[Row]) -> (Vec<String>, Vec<Vec<f64>>) {
    let mut names: Vec<String> =
        ["step", "time", "kinetic", "strain", "stabilisation", "contact", "dissipated", "damped", "work", "open"]
            .map(str::to_owned)
            .to_vec();
    let axes = &["x", "y", "z"][..D];
    names.extend(built.probes.iter().flat_map(|(name, ..)| axes.iter().map(move |a| format!("{name}_u{a}"))));
    let line = |row: &Row| {
        let (e, sums) = (&row.energy, ledger(&rows[0], row));
        let energies = [row.time, e.kinetic, e.strain, e.stabilisation, e.contact, e.dissipated];
        let sums = [sums.damped, sums.work, sums.open];
        let probes = row.probes.iter().flat_map(|p| p[..D].iter().copied());
        std::iter::once(f64::from(row.step)).chain(energies).chain(sums).chain(probes).collect()
    };
    (names, rows.iter().map(line).collect())
}
