//! A problem in the plane or in space: everything that its case names, read, made and checked in one place.
use std::path::{Path, PathBuf};
use std::sync::Arc;

use super::coarser::coarser;
use super::error::RunError;
use super::modes::told_of;
use super::open::{motions, surface};
use super::remark::{Remark, remarks_on};
use super::sanity::sane;
use super::small_motion::{self, March};
use super::solids::{self, with_own_modes};
use super::solids_in_gas::fill;
use super::spacing::{Forces, on_one_cloud, with_cloud};
use super::stream::{self, StreamRatio};
use super::structures::{Described, bodies, check_equilibrium, described, with_steady_forces};
use super::supported::supported;
use crate::case::{Angle, AnyMode, Case, Cloud, FreeStreamScales, Gaf, GafMethod};
use crate::cloud::CloudSpec;
use crate::coupling::Attached;
use crate::coupling::solids::Solids;
use crate::geometry::Surface;
use crate::motion::Motions;

/// A case in `D` dimensions with everything that it names, resolved: surface, motions, structures, stream. It is never changed; its methods
/// give other problems, which share what stays the same.
#[derive(Clone)]
pub struct ProblemIn<const D: usize> {
    given: Arc<Case>,
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
            return Ok(Self::bare(Arc::new(case.clone()), input));
        }
        supported(case)?;
        let given = Arc::new(with_own_modes(case, input)?);
        let (surface, notes) = surface::<D>(&given, input)?;
        let bare = Self::bare(given, input);
        Self { surface: surface.map(Arc::new), surface_notes: Arc::new(notes), ..bare }.resolved()
    }

    fn bare(given: Arc<Case>, input: &Path) -> Self {
        let fixed = Motions::fixed(given.bodies.len());
        Self {
            case: Arc::clone(&given),
            reference: given.flow.reference(),
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
            given,
        }
    }

    /// The same with cloud, motions and structures made from the case as it is given.
    fn resolved(self) -> Result<Self, RunError> {
        let (surface, input) = (self.surface.as_deref(), self.input.as_path());
        let case = with_cloud(&self.given, surface).into_owned();
        let prescribed = motions(&case, input, surface)?;
        let mut remarks: Vec<Remark> = self.surface_notes.iter().cloned().map(Remark::Note).collect();
        remarks.extend(sane(&case, surface, &prescribed)?.into_iter().map(Remark::Warning));
        let mut motions = prescribed.clone();
        let structures = bodies(&case, input, surface, &mut motions)?;
        let structures = with_steady_forces(structures, &self.forces, &case.flow.units())?;
        let gas = CloudSpec::of_case(&case).limits();
        remarks.extend(remarks_on(told_of((surface, &gas), &motions, &structures)));
        let described = described(&case, surface, &structures);
        let reference = case.flow.reference();
        let case = Arc::new(case);
        Ok(Self { case, prescribed, motions, structures, described, reference, remarks, solids: None, ..self })
    }

    /// The same bodies with what another case, which names the same ones, says of everything else.
    fn with_case(&self, given: Case) -> Result<Self, RunError> {
        supported(&given)?;
        Self { given: Arc::new(with_own_modes(&given, &self.input)?), ..self.clone() }.resolved()
    }

    /// The same with the constant forces `forces` on the coordinates of all structures, one after another, in the units of the case.
    pub fn with_forces(&self, forces: &[f64]) -> Result<Self, RunError> {
        Self { forces: Arc::new(forces.to_vec()), ..self.clone() }.resolved()
    }

    /// The same bodies at another Mach number and angle of attack, in radians, nose up positive.
    pub fn at(&self, mach: f64, alpha: f64) -> Result<Self, RunError> {
        let mut case = Case { polar: None, ..self.given().clone() };
        (case.flow.mach, case.flow.velocity, case.flow.alpha) = (Some(mach), None, Angle(alpha));
        self.with_case(case)
    }

    /// The same structures in a stream of the same Mach number with other pressure and temperature.
    pub fn in_stream(&self, ratio: StreamRatio) -> Result<Self, RunError> {
        self.with_case(stream::in_stream(&self.given, ratio))
    }

    /// The same on a cloud with `factor` times the spacing; `None` where that does not fit into the domain, and where clouds follow what is
    /// found on coarser ones.
    pub fn on_spacing(&self, factor: f64) -> Result<Option<Self>, RunError> {
        coarser(&self.given, factor).map(|case| self.with_case(case)).transpose()
    }

    /// The same on the cloud `cloud`, without a family of clouds.
    pub(crate) fn on_cloud(&self, cloud: Cloud) -> Result<Self, RunError> {
        self.with_case(Case { cloud, accuracy: None, ..self.given().clone() })
    }

    /// The steady flow at one Mach number about which the structures move a little; they stay where they begin unless they are trimmed.
    pub fn about_steady_flow(&self, mach: f64) -> Result<Self, RunError> {
        self.on_one_cloud(small_motion::about_steady_flow(&self.given, mach), Forces::Boundary)
    }

    /// The march of a periodic motion of the structures, see [`March`].
    pub(crate) fn march_of(&self, march: &March<'_>) -> Result<Self, RunError> {
        let other = self.on_one_cloud(small_motion::march(&self.given, march), Forces::Boundary)?;
        if self.given.is_trimmed() { Ok(other) } else { other.with_forces(&march.held(other.case())) }
    }

    /// The steady flow about which the modes of `[gaf]` move a little.
    pub(crate) fn about_steady_flow_of_gaf(&self, gaf: &Gaf) -> Result<Self, RunError> {
        self.on_one_cloud(self.given.gaf_steady_case(gaf), Forces::Table)
    }

    /// The motion of one mode of `[gaf]` at the reduced frequency `k`, with `factor` times its amplitude.
    pub(crate) fn in_motion_of_gaf(&self, gaf: &Gaf, mode: AnyMode<'_>, k: f64, factor: f64) -> Result<Self, RunError> {
        self.with_case(self.given.gaf_case(gaf, mode, k, factor))
    }

    /// Another case of the same bodies, on one cloud where it leaves that to the program.
    fn on_one_cloud(&self, case: Case, wanted: Forces) -> Result<Self, RunError> {
        self.with_case(on_one_cloud(case, self.surface(), wanted))
    }

    /// The same bodies on the same clouds in the stream of another case: a point of a polar.
    fn in_stream_of(&self, case: Case) -> Self {
        Self { reference: case.flow.reference(), case: Arc::new(case), ..self.clone() }
    }

    /// The problem at each point of a polar, all angles of attack at the first Mach number, then all at the next; itself alone without one.
    pub(crate) fn points(&self) -> Vec<Self> {
        self.case.points().into_iter().map(|case| self.in_stream_of(case)).collect()
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
        let (case, surface) = (self.case.gaf_steady_case(plan), self.surface());
        let mut laws = motions(&case, &self.input, surface)?;
        let attached = bodies(&case, &self.input, surface, &mut laws)?;
        let gas = CloudSpec::of_case(&case).limits();
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

    /// The case as it is given, with own modes where it asks for them.
    pub(crate) fn given(&self) -> &Case {
        &self.given
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
