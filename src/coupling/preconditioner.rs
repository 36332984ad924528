//! How the linear systems of gas and structures are preconditioned: block by block over the fields.
//!
//! The gas as it would be alone, the structures by elimination; what ties them together, forces and the motion of the cloud, is
//! a change of low rank that a few iterations of GMRES take care of.
use std::sync::Arc;

use crate::scheme::preconditioner::FluidPreconditioner;
use crate::system::{
    Field, Hierarchy, Implicit, Name, Period, Preconditioner, RightHandSide, Shift, System, placed, rows_of,
    unknowns_of,
};
use crate::time::full::Full;

use super::solid_preconditioner::SolidPreconditioner;
use super::solids::Moving;
use super::{Coupled, Frame, Work};

/// The preconditioner of the gas, and the full matrix of the structures.
pub struct CoupledPreconditioner<const D: usize> {
    gas: FluidPreconditioner,
    structure: Full,
    solids: Option<SolidPreconditioner<D>>,
    fields: Vec<Field>,
    matrix: Vec<f64>,
}

impl<const D: usize> Implicit for Coupled<D> {
    type Preconditioner = CoupledPreconditioner<D>;

    fn preconditioner(&self, plan: &Hierarchy, period: Option<Period>) -> CoupledPreconditioner<D> {
        let own: Vec<Field> = self.fields.iter().copied().filter(|field| field.name == Name::Structure).collect();
        let (gas, structure) = (self.fluid.preconditioner(plan, period), Full::of_fields(&own, period));
        let n = self.unknowns_of(Name::Structure).len();
        let solids = self.solids.as_ref().map(|s| SolidPreconditioner::new(Arc::clone(&s.solids), period));
        CoupledPreconditioner { gas, structure, solids, fields: self.fields.clone(), matrix: vec![0.0; n * n] }
    }
}

impl<const D: usize> Preconditioner<Coupled<D>> for CoupledPreconditioner<D> {
    fn begin(&mut self, points: usize) {
        Preconditioner::<crate::scheme::Fluid<D>>::begin(&mut self.gas, points);
        self.structure.clear(points);
        self.solids.iter_mut().for_each(|s| s.begin(points));
    }

    fn add(&mut self, coupled: &Coupled<D>, frame: &Frame<D>, u: &[f64], work: &mut Work<D>) {
        let [gas, sprung, solid, remembered] =
            [Name::Gas, Name::Structure, Name::Solid, Name::History].map(|name| &u[unknowns_of(&self.fields, name)]);
        self.gas.add(&coupled.fluid, &frame.gas, gas, &mut work.gas);
        let n = sprung.len();
        self.matrix.fill(0.0);
        for body in &coupled.bodies {
            let (first, width) = (2 * body.first, 2 * body.structure.len());
            let own = match coupled.held {
                true => (0..width * width).map(|k| if k % (width + 1) == 0 { coupled.fastest } else { 0.0 }).collect(),
                false => body.matrix(frame.gas.time, sprung, frame.steady.then_some(coupled.fastest)),
            };
            for (i, row) in own.chunks_exact(width).enumerate() {
                self.matrix[(first + i) * n + first..][..width].copy_from_slice(row);
            }
        }
        self.structure.add_matrix(&self.matrix);
        if let Some(solids) = &mut self.solids {
            let at = Moving { time: frame.gas.time, step: frame.step, jets: &[], pace: coupled.pace(frame) };
            solids.add(&at, solid, remembered);
        }
    }

    fn finish(&mut self, shift: &Shift<'_>) {
        let [gas, own] = [Name::Gas, Name::Structure].map(|name| &shift.rates[rows_of(&self.fields, name)]);
        Preconditioner::<crate::scheme::Fluid<D>>::finish(&mut self.gas, &Shift { rates: gas, ..*shift });
        self.structure.complete(&Shift { rates: own, ..*shift });
        let row = rows_of(&self.fields, Name::Solid).start;
        self.solids.iter_mut().for_each(|s| s.finish(shift, row));
    }

    fn apply(&mut self, coupled: &Coupled<D>, frames: &[&Frame<D>], r: &RightHandSide<'_>, z: &mut [f64]) {
        let fields: Vec<Field> = self.fields.iter().map(|f| f.at_instances(frames.len())).collect();
        let frames: Vec<&crate::scheme::Frame<D>> = frames.iter().map(|f| &f.gas).collect();
        for at in placed(&fields) {
            let z = &mut z[at.unknowns.clone()];
            match (at.field.name, &mut self.solids) {
                (Name::Gas, _) => self.gas.apply(&coupled.fluid, &frames, &r.of(&at), z),
                (Name::Structure, _) => self.structure.solve(&r.of(&at), z),
                (Name::Solid, Some(solids)) => solids.apply(&r.of(&at), &at, z),
                // no iteration changes what is remembered
                _ => z.fill(0.0),
            }
        }
    }

    fn bytes(&self) -> usize {
        Preconditioner::<crate::scheme::Fluid<D>>::bytes(&self.gas)
            + self.structure.held()
            + self.solids.as_ref().map_or(0, SolidPreconditioner::bytes)
    }
}
