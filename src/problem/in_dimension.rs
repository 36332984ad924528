//! A problem in the plane or in space: everything that its case names, read, made and checked in one place.
use std::path::{Path, PathBuf};
use std::sync::Arc;

use super::coarser::coarser;
use super::error::RunError;
use super::given::Given;
use super::modes::told_of;
use super::open::{motions, surface};
use super::remark::{Remark, remarks_on};
use super::sanity::sane;
use super::small_motion::{March, march, settle_at, settle_for, swing};
use super::solids::{self, NaturalMode, NaturalModes, own_modes};
use super::solids_in_gas::fill;
use super::spacing::{Chosen, Forces, one_cloud, scaled};
use super::stream::{StreamRatio, enter_stream};
use super::structures::{Described, bodies, check_equilibrium, described, with_steady_forces};
use super::supported::supported;
use crate::case::{
    Accuracy, Angle, AnyMode, Case, Cloud, Flow, FreeStreamScales, Gaf, GafMethod, LoadErrors, Steady, Temporal,
};
use crate::cloud::CloudSpec;
use crate::coupling::Attached;
use crate::coupling::solids::Solids;
use crate::geometry::Surface;
use crate::motion::Motions;

/// A case in `D` dimensions with everything that it names, resolved: surface, motions, structures, stream. It is never changed; its methods
/// give other problems, which share what stays the same.
#[derive(Clone)]
pub struct ProblemIn<const D: usize> {
    given: Arc<Given>,
    case: Arc<Case>,
    input: Arc<PathBuf>,
    surface: Option<Arc<Surface<D>>>,
    surface_notes: Arc<Vec<String>>,
    prescribed: Motions<D>,
    motions: Motions<D>,
    structures: Vec<Attached<D>>,
    forces: Arc<Vec<f64>>,
    solids: Option<Arc<Solids<D>>>,
    described: Vec<Described>,
    reference: FreeStreamScales,
    remarks: Vec<Remark>,
}

impl<const D: usize> ProblemIn<D> {
    /// The problem of `case`, whose file names refer to the folder `input`. A structure without a gas has neither surface nor motions here:
    /// its particles are made when it is solved.
    pub(crate) fn of_case(case: &Case, input: &Path) -> Result<Self, RunError> {
        if !case.has_gas() {
            solids::supported(case)?;
            return Ok(Self::bare(case, input));
        }
        supported(case)?;
        let modes = own_modes(case, input)?;
        let (surface, notes) = surface::<D>(case, input)?;
        let bare = Self::bare(case, input);
        Self { surface: surface.map(Arc::new), surface_notes: Arc::new(notes), ..bare }.with_modes(modes)
    }

    fn bare(case: &Case, input: &Path) -> Self {
        let fixed = Motions::fixed(case.bodies.len());
        Self {
            given: Arc::new(Given { case: case.clone(), modes: NaturalModes::default() }),
            case: Arc::new(case.clone()),
            reference: case.flow.reference(),
            input: Arc::new(input.to_path_buf()),
            surface: None,
            surface_notes: Arc::new(Vec::new()),
            prescribed: fixed.clone(),
            motions: fixed,
            structures: Vec::new(),
            forces: Arc::new(Vec::new()),
            solids: None,
            described: Vec::new(),
            remarks: Vec::new(),
        }
    }

    /// The same with cloud, motions and structures made from what is given.
    fn resolved(self) -> Result<Self, RunError> {
        let (surface, input) = (self.surface.as_deref(), self.input.as_path());
        let Given { case, modes } = &*self.given;
        let case = match Chosen::of(case, surface) {
            Some(Chosen { cloud, accuracy }) => Case { cloud, accuracy, ..case.clone() },
            None => case.clone(),
        };
        let prescribed = motions(&case, input, surface)?;
        let mut remarks: Vec<Remark> = self.surface_notes.iter().cloned().map(Remark::Note).collect();
        remarks.extend(sane(&case, surface, &prescribed)?.into_iter().map(Remark::Warning));
        let mut motions = prescribed.clone();
        let structures = bodies((&case, modes), input, surface, &mut motions)?;
        let structures = with_steady_forces(structures, &self.forces, &case.flow.units())?;
        let gas = CloudSpec::of_case(&case).limits();
        remarks.extend(remarks_on(told_of((surface, &gas), &motions, &structures)));
        let described = described(&case, surface, &structures);
        let reference = case.flow.reference();
        let case = Arc::new(case);
        Ok(Self { case, prescribed, motions, structures, described, reference, remarks, solids: None, ..self })
    }

    /// The problem of the same bodies where what else it is made from differs as `change` says.
    fn other(&self, change: impl FnOnce(&mut Given)) -> Result<Self, RunError> {
        let mut given = Given::clone(&self.given);
        change(&mut given);
        supported(&given.case)?;
        Self { given: Arc::new(given), ..self.clone() }.resolved()
    }

    /// The same, on one cloud for small motions where the case leaves that to the program.
    fn other_on_one_cloud(&self, change: impl FnOnce(&mut Given), wanted: Forces) -> Result<Self, RunError> {
        self.other(|given| {
            change(given);
            if let Some(cloud) = one_cloud(&given.case, self.surface(), wanted) {
                given.case.cloud = cloud;
            }
        })
    }

    /// The same bodies with these natural modes.
    fn with_modes(&self, modes: NaturalModes) -> Result<Self, RunError> {
        self.other(|given| given.modes = modes)
    }

    /// The same with the constant forces `forces` on the coordinates of all structures, one after another, in the units of the case.
    pub fn with_forces(&self, forces: &[f64]) -> Result<Self, RunError> {
        Self { forces: Arc::new(forces.to_vec()), ..self.clone() }.resolved()
    }

    /// The same bodies at another Mach number and angle of attack, in radians, nose up positive.
    pub fn at(&self, mach: f64, alpha: f64) -> Result<Self, RunError> {
        self.other(|Given { case, .. }| {
            case.polar = None;
            (case.flow.mach, case.flow.velocity, case.flow.alpha) = (Some(mach), None, Angle(alpha));
        })
    }

    /// The same structures in a stream of the same Mach number with other pressure and temperature.
    pub fn in_stream(&self, ratio: StreamRatio) -> Result<Self, RunError> {
        self.other(|given| enter_stream(given, ratio))
    }

    /// The same on a cloud with `factor` times the spacing; `None` where that does not fit into the domain, and where clouds follow what is
    /// found on coarser ones.
    pub fn on_spacing(&self, factor: f64) -> Result<Option<Self>, RunError> {
        let cloud = coarser(self.given(), factor);
        cloud.map(|cloud| self.other(|given| given.case.cloud = cloud)).transpose()
    }

    /// The same on the cloud `cloud`, without a family of clouds.
    pub(crate) fn on_cloud(&self, cloud: Cloud) -> Result<Self, RunError> {
        self.other(|Given { case, .. }| (case.cloud, case.accuracy) = (cloud, None))
    }

    /// The steady flow at one Mach number about which the structures move a little; they stay where they begin unless they are trimmed.
    pub fn about_steady_flow(&self, mach: f64) -> Result<Self, RunError> {
        self.other_on_one_cloud(|given| settle_at(given, mach), Forces::Boundary)
    }

    /// The march of a periodic motion of the structures, see [`March`].
    pub(crate) fn march_of(&self, plan: &March<'_>) -> Result<Self, RunError> {
        let other = self.other_on_one_cloud(|given| march(given, plan), Forces::Boundary)?;
        if self.given().is_trimmed() { Ok(other) } else { other.with_forces(&plan.held(other.case())) }
    }

    /// The steady flow about which the modes of `[gaf]` move a little.
    pub(crate) fn about_steady_flow_of_gaf(&self, gaf: &Gaf) -> Result<Self, RunError> {
        self.other_on_one_cloud(|given| settle_for(&mut given.case, gaf), Forces::Table)
    }

    /// The motion of one mode of `[gaf]` at the reduced frequency `k`, with `factor` times its amplitude.
    pub(crate) fn in_motion_of_gaf(&self, gaf: &Gaf, mode: AnyMode<'_>, k: f64, factor: f64) -> Result<Self, RunError> {
        self.other(|given| swing(&mut given.case, gaf, mode, k, factor))
    }

    /// A further run that tells error bars: on the cloud `cloud` with the method `time`, without error bars, pictures and fields of its own.
    pub(crate) fn further(&self, cloud: Cloud, time: Temporal) -> Result<Self, RunError> {
        self.other(|Given { case, .. }| {
            (case.cloud, case.time) = (cloud, time);
            case.accuracy = Some(Accuracy { error: LoadErrors::None, ..Accuracy::default() });
            (case.output.report, case.output.field_interval) = (false, None);
            case.compare.clear();
        })
    }

    /// The steady flow around the bodies at rest, at the first point of a polar, on a cloud with `factor` times the spacing: what is seen in a
    /// moment.
    pub(crate) fn at_rest(&self, steady: Steady, factor: f64) -> Result<Self, RunError> {
        let cloud = scaled(&self.case.cloud, factor);
        self.other(|Given { case, .. }| {
            // what moves in modes alone is rigid here, and not made of particles
            let full: Vec<usize> = case.solids().map(|(i, ..)| i).collect();
            for (i, body) in case.bodies.iter_mut().enumerate() {
                body.motion = None;
                body.solid = body.solid.take().filter(|_| full.contains(&i));
            }
            (case.cloud, case.time, case.accuracy) = (cloud, Temporal::Steady(steady), None);
            (case.motion, case.gaf, case.polar) = (None, None, None);
            (case.structures, case.compare) = (Vec::new(), Vec::new());
            case.adapt.cycles = 0;
        })
    }

    /// The same on a cloud with `factor` times the spacing, by the method `time`.
    pub(crate) fn in_time(&self, time: Temporal, factor: f64) -> Result<Self, RunError> {
        let (cloud, accuracy) = (scaled(&self.case.cloud, factor), self.case.accuracy);
        self.other(|Given { case, .. }| {
            (case.cloud, case.accuracy, case.time) = (cloud, accuracy, time);
            case.compare.clear();
        })
    }

    /// The problem at each point of a polar, all angles of attack at the first Mach number, then all at the next; itself alone without one.
    pub(crate) fn points(&self) -> Vec<Self> {
        let point = |flow: Flow| {
            let (reference, polar) = (flow.reference(), None);
            Self { reference, case: Arc::new(Case { flow, polar, ..Case::clone(&self.case) }), ..self.clone() }
        };
        self.case.streams().into_iter().map(point).collect()
    }

    /// The same with bodies that move as prescribed alone, without structures.
    pub(crate) fn without_structures(&self) -> Self {
        Self { motions: self.prescribed.clone(), structures: Vec::new(), described: Vec::new(), ..self.clone() }
    }

    /// The same with its bodies made of particles, where the case has such: these are filled now.
    pub(crate) fn with_solids(&self) -> Result<Self, RunError> {
        let first = self.structures.last().map_or(0, |b| b.range().end);
        let mut filled = self.clone();
        let Some(found) = fill(&self.case, &self.input, first, &mut filled.motions)? else { return Ok(filled) };
        filled.solids = Some(found.solids);
        filled.described.extend(found.described);
        filled.remarks.extend(found.remarks);
        Ok(filled)
    }

    /// What is worth telling of the modes of `[gaf]` besides.
    pub(crate) fn remarks_on_gaf_modes(&self) -> Result<Vec<Remark>, RunError> {
        let linear = |plan: &&Gaf| plan.method == GafMethod::Linear && !plan.flexible.is_empty();
        let Some(plan) = self.case.gaf.as_ref().filter(linear) else { return Ok(Vec::new()) };
        let (mut given, surface) =
            (Given { case: Case::clone(&self.case), ..Given::clone(&self.given) }, self.surface());
        settle_for(&mut given.case, plan);
        let Given { case, modes } = &given;
        let mut laws = motions(case, &self.input, surface)?;
        let attached = bodies((case, modes), &self.input, surface, &mut laws)?;
        let gas = CloudSpec::of_case(case).limits();
        let told = remarks_on(told_of((surface, &gas), &laws, &attached));
        Ok(told.filter(|remark| !self.remarks.contains(remark)).collect())
    }

    /// Refuses a steady flow beside a body that no spring holds.
    pub(crate) fn check_equilibrium(&self) -> Result<(), RunError> {
        check_equilibrium(&self.case, self.surface(), &self.structures)
    }

    /// The case with the cloud and the accuracy that are chosen where it leaves them out.
    pub fn case(&self) -> &Case {
        &self.case
    }

    /// The same case, shared.
    pub(crate) fn shared_case(&self) -> Arc<Case> {
        Arc::clone(&self.case)
    }

    /// True where structures or bodies made of particles move with the gas.
    pub(crate) fn is_coupled(&self) -> bool {
        !self.structures.is_empty() || self.solids.is_some()
    }

    /// The case as it is given.
    pub(crate) fn given(&self) -> &Case {
        &self.given.case
    }

    /// Natural modes of its bodies.
    pub(crate) fn modes(&self) -> &NaturalModes {
        &self.given.modes
    }

    /// Natural modes that a body moves in; `None` where its structure is of another kind.
    pub(crate) fn modes_of(&self, body: usize) -> Option<&[NaturalMode]> {
        self.modes().of_body(&self.case, body)
    }

    /// Folder that file names of the case refer to.
    pub(crate) fn input(&self) -> &Path {
        &self.input
    }

    /// Surface of the bodies; `None` without any.
    pub fn surface(&self) -> Option<&Surface<D>> {
        self.surface.as_deref()
    }

    /// Motions of the bodies, prescribed or by coordinates of structures.
    pub fn motions(&self) -> &Motions<D> {
        &self.motions
    }

    /// Structures, attached to their bodies.
    pub fn structures(&self) -> &[Attached<D>] {
        &self.structures
    }

    /// Bodies made of particles, once they are filled.
    pub(crate) fn solids(&self) -> Option<&Arc<Solids<D>>> {
        self.solids.as_ref()
    }

    /// Structures in words.
    pub(crate) fn described(&self) -> &[Described] {
        &self.described
    }

    /// Free stream, in the units of the case.
    pub fn reference(&self) -> &FreeStreamScales {
        &self.reference
    }

    /// What is worth telling of it.
    pub fn remarks(&self) -> &[Remark] {
        &self.remarks
    }
}
