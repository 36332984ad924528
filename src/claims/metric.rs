//! Metrics: what a claim measures, and the names of that in claim files.
//!
//! They stand in groups, each measured by one function that matches its group without a rest: a metric that nothing measures does not compile.
macro_rules! metrics {
    ($($(#[$of:meta])* $group:ident($type:ident) { $($(#[$doc:meta])* $variant:ident = $name:literal),* $(,)? })*) => {
        /// What a claim measures.
        #[derive(Clone, Copy, Debug, PartialEq, Eq)]
        pub enum Metric { $($(#[$of])* $group($type)),* }

        $($(#[$of])*
        #[derive(Clone, Copy, Debug, PartialEq, Eq)]
        pub enum $type { $($(#[$doc])* $variant),* })*

        impl Metric {
            /// Every metric.
            pub const ALL: &'static [Metric] = &[$($(Metric::$group($type::$variant)),*),*];

            /// The name in `claim.toml`.
            pub fn name(self) -> &'static str {
                match self { $($(Metric::$group($type::$variant) => $name),*),* }
            }
        }
    };
}

metrics! {
    /// Loads and convergence at the end of a run.
    End(EndMetric) {
        /// Lift coefficient from wall pressure and friction.
        Cl = "cl",
        /// Drag coefficient from wall pressure and friction.
        Cd = "cd",
        /// Moment coefficient about the reference point, nose up positive.
        Cm = "cm",
        /// Part of the drag coefficient that is due to wall pressure, where the gas has viscosity.
        CdPressure = "cd_pressure",
        /// Part of the drag coefficient that is due to friction.
        CdFriction = "cd_friction",
        /// Where friction first turns against the stream on the upper side, x/c.
        SeparationUpper = "separation_upper",
        /// Lift coefficient from the momentum of the gas around the body.
        ClMomentum = "cl_momentum",
        /// Drag coefficient from the momentum of the gas around the body.
        CdMomentum = "cd_momentum",
        /// |Drag coefficient from the walls − that from the momentum of the gas|.
        CdBalance = "cd_balance",
        /// Orders of magnitude the steady residual fell.
        ResidualDrop = "residual_drop",
        /// One when the run reached its own stopping criterion, zero otherwise.
        Converged = "converged",
        /// Number of particles.
        Particles = "particles",
        /// |Mass at the end − expected| over mass at the start; what crossed open ends is expected.
        MassDrift = "mass_drift",
        /// |Energy at the end − expected| over energy at the start; what crossed open ends is expected.
        EnergyDrift = "energy_drift",
        /// Volume-weighted root mean square error of density against the exact solution of `[initial]`.
        ErrorL2Density = "error_l2_density",
    }
    /// Loads that repeat: harmonics of a motion, cycles of the flow itself.
    Periodic(PeriodicMetric) {
        /// Amplitude of the first harmonic of the lift over that of the motion: per radian, or per length.
        LiftAmplitude = "lift_amplitude",
        /// Phase in degrees by which that harmonic leads the motion.
        LiftPhase = "lift_phase",
        /// Amplitude of the first harmonic of the drag over that of the motion: per radian, or per length.
        DragAmplitude = "drag_amplitude",
        /// Phase in degrees by which that harmonic leads the motion.
        DragPhase = "drag_phase",
        /// Amplitude of the second harmonic of the drag.
        DragSecondHarmonic = "drag_second_harmonic",
        /// Frequency of the lift over the last whole cycles of a march, times chord over speed of the stream.
        Strouhal = "strouhal",
        /// Longest less shortest of those cycles over their mean.
        CycleSpread = "cycle_spread",
        /// Mean of the drag coefficient over those cycles.
        MeanCd = "mean_cd",
        /// Half of greatest less smallest drag coefficient within those cycles.
        SwingCd = "swing_cd",
        /// Half of greatest less smallest lift coefficient within those cycles.
        SwingCl = "swing_cl",
        /// Mean of the lift coefficient over the last period of the motion.
        MeanCl = "mean_cl",
        /// Greatest lift coefficient within that period.
        PeakCl = "peak_cl",
    }
    /// Harmonics of loads extrapolated to a section of no thickness.
    Thin(ThinMetric) {
        /// `lift_amplitude` extrapolated to a section of no thickness: along a line through this one and that of the case `other`, with
        /// a `third` along a parabola.
        ThinLiftAmplitude = "thin_lift_amplitude",
        /// `lift_phase` of the same.
        ThinLiftPhase = "thin_lift_phase",
        /// The same of the moment about the reference point, nose up positive.
        ThinMomentAmplitude = "thin_moment_amplitude",
        /// Phase in degrees by which that harmonic leads the motion.
        ThinMomentPhase = "thin_moment_phase",
        /// Amplitude of the first harmonic of the force on the first mode of `[[gaf.mode]]` over that of the motion, extrapolated
        /// like the lift.
        ThinForceAmplitude = "thin_force_amplitude",
        /// Phase in degrees of the same.
        ThinForcePhase = "thin_force_phase",
    }
    /// Differences to a file, an exact solution or another case.
    Comparison(ComparisonMetric) {
        /// Root mean square difference of wall Cp to `file` or `exact`.
        CpRms = "cp_rms",
        /// Greatest difference of wall Cp to `file`, `exact` or the case `other`.
        CpMaxDifference = "cp_max_difference",
        /// Root mean square difference of the lift over the last period to that of the case `other`, over half the range of that
        /// one; with `file`, the greatest difference to its column `CL` at the phases of its column `phase`, in parts of a period.
        LiftLoopDifference = "lift_loop_difference",
        /// The same of the drag (column `CD`).
        DragLoopDifference = "drag_loop_difference",
        /// |Â_1 − B̂_1|/|B̂_1| for the first harmonics (complex) of the lift of this case and of the case `other`.
        LiftHarmonicError = "lift_harmonic_error",
        /// Difference of the means of the lift over the first harmonic of the case `other`.
        LiftMeanError = "lift_mean_error",
    }
    /// The gas and the walls of one run, and tables of its sections.
    Field(FieldMetric) {
        /// Root mean square, in `region`, of cf over that of a laminar plate along x from the origin, less one.
        CfBlasiusRms = "cf_blasius_rms",
        /// The greatest such difference.
        CfBlasiusMax = "cf_blasius_max",
        /// Root mean square of u/U less that of Blasius, over the particles in `region` below eta = 7.
        ProfileBlasiusRms = "profile_blasius_rms",
        /// Root mean square difference of wall Cp to `file` at each of its rows: `y` along the span, `surface`, `x_c` of the section there.
        SectionCpRms = "section_cp_rms",
        /// Chordwise position of the shock on the upper side, x/c.
        ShockUpper = "shock_upper",
        /// Chordwise position of the shock on the lower side, x/c.
        ShockLower = "shock_lower",
        /// Greatest deviation of any conserved variable from the free stream, over its free-stream scale.
        FreeStreamDeviation = "free_stream_deviation",
        /// |Position of the right-most shock − exact| in units of `cloud.spacing`.
        ShockPositionError = "shock_position_error",
        /// Angle of a wave to the x axis in degrees (in space one of revolution about it), samples in `region`, between pressures `levels`.
        WaveAngle = "wave_angle",
        /// Mean wall pressure in `region` over free-stream pressure.
        PanelPressure = "panel_pressure",
        /// Greatest pressure on the wall over what Rayleigh's pitot formula gives.
        PitotPressure = "pitot_pressure",
        /// Distance on the axis from the bow shock, where the density is half way across a normal shock, to the body, in half lengths of the body.
        StandOff = "stand_off",
        /// Length behind the body over which the gas on its axis runs against the stream, in chords.
        WakeLength = "wake_length",
    }
    /// Bodies on springs in a gas.
    Structure(StructureMetric) {
        /// Mean of `coordinate` of the structure over its last whole cycles, or where it came to rest.
        StructureMean = "structure_mean",
        /// Greatest absolute value of it in the whole run.
        StructureLargest = "structure_largest",
        /// Half of greatest less smallest value of it within the last whole cycles.
        StructureAmplitude = "structure_amplitude",
        /// Angular frequency fitted to the tail of its march.
        StructureFrequency = "structure_frequency",
        /// Rate at which that oscillation grows; negative where it decays.
        StructureGrowthRate = "structure_growth_rate",
        /// Its damping ratio.
        StructureDampingRatio = "structure_damping_ratio",
        /// Greatest difference, at the end of any step, between the power that the walls take from the gas and the power that the
        /// structures get, over the greatest power.
        WorkLedger = "work_ledger",
        /// `structure_frequency` extrapolated to a section of no thickness, like the lift.
        ThinFrequency = "thin_frequency",
        /// `structure_growth_rate` of the same, over the frequency.
        ThinGrowthRate = "thin_growth_rate",
        /// Angle of pitch of a section in equilibrium over that which springs and the moment slope of the fixed section of the case
        /// `other` demand, less one.
        EquilibriumAngleError = "equilibrium_angle_error",
        /// Divergence speed that this angle tells over that which the moment slope of the case `other` tells, less one.
        DivergenceSpeedError = "divergence_speed_error",
        /// Observed order in the step of the frequency: from this case, the case `other` with half its step and the `third` with a
        /// quarter of it.
        FrequencyStepOrder = "frequency_step_order",
        /// The same of the amplitude.
        AmplitudeStepOrder = "amplitude_step_order",
    }
    /// Structures of particles alone.
    Solid(SolidMetric) {
        /// Angular frequency of the natural mode of a structure alone whose number `coordinate` is, rad/s.
        ModeOmega = "mode_omega",
        /// Displacement of a probe of a structure alone at its end; `coordinate` names it and the axis, `A.y`.
        ProbeDisplacement = "probe_displacement",
        /// Amplitude of a harmonic of a probe of a structure alone; `coordinate` names it, the axis and, but for the first, the harmonic, `A.y.3`.
        ProbeAmplitude = "probe_amplitude",
        /// Phase of the same, degrees ahead of cos kωt.
        ProbePhase = "probe_phase",
        /// What is missing in the energies of a structure alone, over the largest of them.
        LedgerOpen = "ledger_open",
    }
    /// Flutter boundaries and limit cycles.
    Flutter(FlutterMetric) {
        /// Speed index of the first flutter at the Mach number `mach` of a flutter boundary.
        FlutterIndex = "flutter_index",
        /// Speed of the same in the units of the case.
        FlutterSpeed = "flutter_speed",
        /// Frequency of the same over that of pitch alone.
        FlutterFrequency = "flutter_frequency",
        /// Error bar of the same, relative.
        FlutterError = "flutter_error",
        /// Relative difference of its speed to that of the case `other`.
        FlutterDifference = "flutter_difference",
        /// Speed index of the limit cycle with the greatest amplitude.
        LimitCycleIndex = "limit_cycle_index",
        /// Relative change of its speed with its last harmonics.
        LimitCycleError = "limit_cycle_error",
        /// Relative difference of the amplitude that a march from the largest stable one ends with.
        LimitCycleMarch = "limit_cycle_march",
    }
    /// Forces of small motions.
    Force(ForceMetric) {
        /// Greatest relative difference between the amplitudes of the forces of small motions (`[gaf]`) and those of the table `file`
        /// (columns `mode`, `k`, `coefficient`, `re`, `im`), extrapolated to a section of no thickness where others are named.
        ForceAmplitudeError = "force_amplitude_error",
        /// The same of their phases, in degrees.
        ForcePhaseError = "force_phase_error",
    }
    /// Orders and limits over the spacings of a study.
    Study(StudyMetric) {
        /// Least-squares slope of log error_l2_density against log spacing over the study.
        Order = "order",
        /// The same slope of log cp_rms.
        CpRmsOrder = "cp_rms_order",
        /// Lift coefficient extrapolated to zero spacing over the study.
        ExtrapolatedCl = "extrapolated_cl",
        /// Drag coefficient extrapolated to zero spacing over the study.
        ExtrapolatedCd = "extrapolated_cd",
    }
    /// Error bars of a table of cases.
    Bar(BarMetric) {
        /// Part of the loads of the table `file` (columns `case`, `load`, `exact`) whose error lies within its bar.
        BarsHolding = "bars_holding",
        /// Median of bar over error of those loads.
        BarOverError = "bar_over_error",
    }
}

impl Metric {
    /// The metric of this name.
    pub fn parse(name: &str) -> Option<Self> {
        Self::ALL.iter().copied().find(|m| m.name() == name)
    }
}

impl StudyMetric {
    /// What is measured at each spacing.
    pub fn at_each_spacing(self) -> Metric {
        match self {
            Self::Order => Metric::End(EndMetric::ErrorL2Density),
            Self::CpRmsOrder => Metric::Comparison(ComparisonMetric::CpRms),
            Self::ExtrapolatedCl => Metric::End(EndMetric::Cl),
            Self::ExtrapolatedCd => Metric::End(EndMetric::Cd),
        }
    }
}
