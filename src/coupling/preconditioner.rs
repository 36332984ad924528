//! How the linear systems of gas and structures are preconditioned: block by block over the fields.
//!
//! The gas as it would be alone, the structures by elimination; what ties them together, forces and the motion of the cloud, is
//! a change of low rank that a few iterations of GMRES take care of.
use crate::scheme::preconditioner::FluidPreconditioner;
use crate::system::{Field, Hierarchy, Implicit, Period, Preconditioner, RightHandSide, Shift, placed};
use crate::time::full::Full;

use super::{Coupled, Frame, Work};

/// The preconditioner of the gas, and the full matrix of the structures.
pub struct CoupledPreconditioner {
    gas: FluidPreconditioner,
    structure: Full,
    fields: Vec<Field>,
    matrix: Vec<f64>,
}

impl<const D: usize> Implicit for Coupled<D> {
    type Preconditioner = CoupledPreconditioner;

    fn preconditioner(&self, plan: &Hierarchy, period: Option<Period>) -> CoupledPreconditioner {
        let (gas, structure) = (self.fluid.preconditioner(plan, period), Full::of_fields(&self.fields[1..], period));
        let n = self.fields[1].len();
        CoupledPreconditioner { gas, structure, fields: self.fields.clone(), matrix: vec![0.0; n * n] }
    }
}

impl<const D: usize> Preconditioner<Coupled<D>> for CoupledPreconditioner {
    fn begin(&mut self, points: usize) {
        Preconditioner::<crate::scheme::Fluid<D>>::begin(&mut self.gas, points);
        self.structure.clear(points);
    }

    fn add(&mut self, coupled: &Coupled<D>, frame: &Frame<D>, u: &[f64], work: &mut Work<D>) {
        let (gas, u) = u.split_at(self.fields[0].len());
        self.gas.add(&coupled.fluid, &frame.gas, gas, &mut work.gas);
        let n = self.fields[1].len();
        self.matrix.fill(0.0);
        for body in &coupled.bodies {
            let (first, width) = (2 * body.first, 2 * body.structure.len());
            let own = match coupled.held {
                true => (0..width * width).map(|k| if k % (width + 1) == 0 { coupled.fastest } else { 0.0 }).collect(),
                false => body.matrix(frame.gas.time, u, frame.steady.then_some(coupled.fastest)),
            };
            for (i, row) in own.chunks_exact(width).enumerate() {
                self.matrix[(first + i) * n + first..][..width].copy_from_slice(row);
            }
        }
        self.structure.add_matrix(&self.matrix);
    }

    fn finish(&mut self, shift: &Shift<'_>) {
        let (gas, own) = shift.rates.split_at(self.fields[0].rows);
        Preconditioner::<crate::scheme::Fluid<D>>::finish(&mut self.gas, &Shift { rates: gas, ..*shift });
        self.structure.complete(&Shift { rates: own, ..*shift });
    }

    fn apply(&mut self, coupled: &Coupled<D>, frames: &[&Frame<D>], r: &RightHandSide<'_>, z: &mut [f64]) {
        let fields: Vec<Field> = self.fields.iter().map(|f| f.at_instances(frames.len())).collect();
        let (gas, all) = z.split_at_mut(fields[0].len());
        let frames: Vec<&crate::scheme::Frame<D>> = frames.iter().map(|f| &f.gas).collect();
        let mut fields = placed(&fields);
        if let Some(at) = fields.next() {
            self.gas.apply(&coupled.fluid, &frames, &r.of(&at), gas);
        }
        if let Some(at) = fields.next() {
            self.structure.solve(&r.of(&at), all);
        }
    }

    fn bytes(&self) -> usize {
        Preconditioner::<crate::scheme::Fluid<D>>::bytes(&self.gas) + self.structure.held()
    }
}
