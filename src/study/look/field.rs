//! The solution as plain tables in the units of the case.
use crate::case::Case;
use crate::physics::Primitive;
use crate::scheme::View;
use crate::scheme::start::free_stream;

/// Named columns over particles.
#[derive(Clone, Debug, Default)]
pub struct Snapshot {
    /// Positions.
    pub points: Vec<[f64; 3]>,
    /// Columns: name, components, values.
    pub columns: Vec<(&'static str, usize, Vec<f64>)>,
}

impl Snapshot {
    /// Values of the column of this name, component by component; `None` without it.
    pub fn column(&self, name: &str) -> Option<&[f64]> {
        self.columns.iter().find(|(n, ..)| *n == name).map(|(.., values)| &values[..])
    }
}

/// Pressure coefficient; zero when there is no stream.
pub(crate) fn pressure_coefficient<const D: usize>(q: &Primitive<D>, free: &Primitive<D>) -> f64 {
    let dynamic = 0.5 * free.density * free.velocity.norm_squared();
    if dynamic > 0.0 { (q.pressure - free.pressure) / dynamic } else { 0.0 }
}

/// All particles without images, with everything that a field file holds; `view` has states and gradients.
///
/// Temperature is in kelvin where the free stream has units, else in that of the free stream, as all else; entropy is (p/ρ^γ) over that of
/// the free stream less 1, and the loss of total pressure is 1 less p₀ over that of the free stream.
pub(crate) fn field<const D: usize>(case: &Case, view: &View<'_, D>) -> Snapshot {
    let (cloud, gas) = (view.cloud(), view.fluid.gas);
    let n = cloud.n_real();
    let (free, units) = (free_stream::<D>(case), case.flow.units());
    let column = |f: &dyn Fn(usize) -> f64| (0..n).map(f).collect::<Vec<f64>>();
    let state: Vec<Primitive<D>> = (0..n).map(|i| view.state(i)).collect();
    let velocity = (0..n).flat_map(|i| (state[i].velocity * units.speed).to_3d()).collect();
    let kind = |i: usize| f64::from(u8::from(i >= cloud.n_fluid) + u8::from(i >= cloud.n_rows()));
    let entropy = |i: usize| gas.entropy(&state[i]) / gas.entropy(&free) - 1.0;
    let level = |i: usize| (cloud.spacing[i]).log2();
    let total = |i: usize| gas.total_pressure(&state[i]);
    let free_total = gas.total_pressure(&free);
    let kelvin = if case.flow.is_dimensional() { case.flow.kelvin() } else { 1.0 };
    let temperature = |i: usize| kelvin * gas.temperature(&state[i]) / gas.temperature(&free);
    let vorticity = (0..n).flat_map(|i| view.vorticity(i).map(|w| w * units.speed)).collect();
    Snapshot {
        points: (0..n).map(|i| view.place(i).to_3d()).collect(),
        columns: vec![
            ("density", 1, column(&|i| state[i].density * units.density)),
            ("velocity", 3, velocity),
            ("pressure", 1, column(&|i| state[i].pressure * units.pressure())),
            ("mach", 1, column(&|i| state[i].velocity.norm() / gas.sound_speed(&state[i]))),
            ("cp", 1, column(&|i| pressure_coefficient(&state[i], &free))),
            ("temperature", 1, column(&temperature)),
            ("total_pressure", 1, column(&|i| total(i) * units.pressure())),
            ("total_pressure_loss", 1, column(&|i| 1.0 - total(i) / free_total)),
            ("entropy", 1, column(&entropy)),
            ("vorticity", 3, vorticity),
            ("spacing", 1, cloud.spacing[..n].to_vec()),
            ("volume", 1, cloud.volume[..n].to_vec()),
            ("level", 1, column(&level)),
            ("kind", 1, column(&kind)),
        ],
    }
}
