//! Fields and pictures of a march on the way, for whoever writes them.
use super::super::keeper::{Camera, FILM, FILM_FIELDS};
use super::super::look::GasView;
use super::super::record::{Log, passed};
use super::drive::{Now, Observer};
use crate::coupling::Marches;
use crate::geometry::Surface;
use crate::problem::RunError;
use crate::scheme::HasGas;
use crate::time::{Standing, Step};

/// Writes the field at equal intervals of time.
pub(crate) struct FieldSeries<'a, S, const D: usize> {
    /// The system.
    pub(crate) system: &'a S,
    /// Who writes it.
    pub(crate) camera: &'a dyn Camera<D>,
    /// The interval, in the time of the solver.
    pub(crate) interval: f64,
}

impl<S: Marches<D>, const D: usize> Observer<S, Log<'_>> for FieldSeries<'_, S, D> {
    fn step(&mut self, step: &Step, now: &mut Now<'_, S>, log: &mut Log<'_>) -> Result<(), RunError> {
        if passed(step.time, self.interval) <= passed(now.before, self.interval) {
            return Ok(());
        }
        let Standing { frame, work, state, .. } = now.standing();
        let view = GasView::of(self.system, frame, state);
        self.camera.field(&log.case, &view, self.system.gas_work(work), self.interval)?;
        match self.system.solid_snapshot(frame, state) {
            Some(solid) => self.camera.solid(&log.case, &solid, step.time, self.interval),
            None => Ok(()),
        }
    }
}

/// Draws the flow and writes fields at equal parts of a period.
pub(crate) struct Film<'a, S, const D: usize> {
    /// The system.
    pub(crate) system: &'a S,
    /// Who writes them.
    pub(crate) camera: &'a dyn Camera<D>,
    /// The bodies.
    pub(crate) surface: &'a Surface<D>,
}

impl<S: HasGas<D>, const D: usize> Observer<S, Log<'_>> for Film<'_, S, D> {
    fn step(&mut self, step: &Step, now: &mut Now<'_, S>, log: &mut Log<'_>) -> Result<(), RunError> {
        let Some(period) = log.period else { return Ok(()) };
        let before = now.before;
        let begun = |parts: u32| {
            let part = |t: f64| passed(t, period / f64::from(parts));
            (part(step.time) > part(before)).then(|| part(step.time))
        };
        let (picture, field) = (begun(FILM), begun(FILM_FIELDS));
        if picture.is_none() && field.is_none() {
            return Ok(());
        }
        let Standing { frame, work, state, .. } = now.standing();
        let view = GasView::of(self.system, frame, state);
        let work = self.system.gas_work(work);
        if let Some(part) = field {
            self.camera.frame(&log.case, &view, work, period, part)?;
        }
        picture.map_or(Ok(()), |part| self.camera.picture(&log.case, self.surface, &view, work, part))
    }
}
