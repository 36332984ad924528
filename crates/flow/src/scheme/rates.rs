//! How fast the state of a particle can change: the limit of explicit steps and local steps in pseudo time.
//!
//! 1/τ_i = Σ_j (|(v_i − w_i)·a_ij| + c_i |a_ij|), with friction what viscosity and conduction add.
use super::edge_flux::half_face;
use super::fluid::{Fluid, Work};
use super::frame::Frame;
use crate::math::Vector;
use crate::math::parallel::{fill, sweep, sweep_parts};

impl<const D: usize> Fluid<D> {
    /// Fills `rate` from the states of fluid particles in `work`.
    pub(super) fn fill_rates(&self, frame: &Frame<D>, work: &mut Work<D>, rate: &mut [f64]) {
        let cloud = &frame.discretisation.cloud;
        let Work { state, steepness: sound, .. } = work;
        sweep(&mut sound[..cloud.n_fluid], |i| self.gas.sound_speed(&state[i]));
        self.sum_rates((frame, &*work), rate);
        // evaluations of second order find the steepness anew, others know of none
        fill(&mut work.steepness[..cloud.n_fluid], 0.0);
    }

    /// Fills `rate`, where the speeds of sound are in the place of the steepness.
    fn sum_rates(&self, (frame, work): (&Frame<D>, &Work<D>), rate: &mut [f64]) {
        let (op, cloud) = (&frame.discretisation.operators, &frame.discretisation.cloud);
        let (volume, sound) = (&cloud.volume, &work.steepness);
        let past = |i: usize| work.state[i].velocity - frame.velocity_of(i);
        let speed = |i: usize, a: &Vector<D>| past(i).dot(a).abs() + sound[i] * a.norm();
        sweep_parts(op.fluid_parts(), 1, rate, &|k, out| {
            let start = op.parts[k].start;
            out.fill(0.0);
            let weights = op.weights(k);
            for (n, e) in op.edges(k).iter().enumerate() {
                let (i, j) = (e.i(), e.j());
                let [a_i, a_j] = match self.conservative {
                    true => [half_face(volume[i], &e.s), half_face(volume[j], &e.s)],
                    false => weights.of(n, e, &(cloud.x[j] - cloud.x[i])),
                };
                out[i - start] += speed(i, &a_i);
                if e.both() {
                    out[j - start] += speed(j, &a_j);
                }
            }
            for face in op.wall_faces(k).iter().filter(|_| self.conservative) {
                let i = face.i as usize;
                out[i - start] += speed(i, &half_face(volume[i], &face.area));
            }
        });
        if let Some(viscous_model) = &self.viscous_model {
            self.add_viscous_rate(viscous_model, (frame, work), rate);
        }
    }
}
