//! Metrics of bodies on springs.
use std::f64::consts::PI;

use super::{Measured, Value, no_other};
use crate::case::Structure;
use crate::claims::Claim;
use crate::claims::metric::StructureMetric;
use crate::observe::structure::{CoordinateSummary, StructureSummary};

impl Measured {
    /// A metric of structures; `claim` names the coordinate.
    pub(super) fn of_structure(&self, metric: StructureMetric, claim: &Claim, others: &[&Self]) -> Value {
        let own = || self.coordinate(claim);
        match metric {
            StructureMetric::StructureMean => own()?.mean.ok_or_else(unfinished),
            StructureMetric::StructureLargest => Ok(own()?.largest),
            StructureMetric::StructureAmplitude => self.amplitude(claim),
            StructureMetric::StructureFrequency => self.frequency(claim),
            StructureMetric::StructureGrowthRate => own()?.growth_rate.ok_or_else(no_oscillation),
            StructureMetric::StructureDampingRatio => own()?.damping_ratio.ok_or_else(no_oscillation),
            StructureMetric::WorkLedger => Ok(self.first_structure()?.lost_power),
            StructureMetric::ThinFrequency => self.thin_value(others, |s| s.frequency(claim)),
            StructureMetric::ThinGrowthRate => self.thin_value(others, |s| s.growth(claim)),
            StructureMetric::EquilibriumAngleError => {
                let (angle, linear) = (self.angle(claim)?, self.linear(others)?);
                let expected = self.case.flow.alpha.0 * linear / (1.0 - linear);
                Ok(angle / expected - 1.0)
            }
            StructureMetric::DivergenceSpeedError => {
                let angle = self.angle(claim)?;
                // the angle tells that the speed is the square root of θ/(θ + α) of that at which the section diverges
                let found = angle / (angle + self.case.flow.alpha.0);
                Ok((self.linear(others)? / found).sqrt() - 1.0)
            }
            StructureMetric::FrequencyStepOrder => self.step_order(others, |s| s.frequency(claim)),
            StructureMetric::AmplitudeStepOrder => self.step_order(others, |s| s.amplitude(claim)),
        }
    }

    fn first_structure(&self) -> Result<&StructureSummary, String> {
        self.numbers.structure.first().ok_or_else(|| "no body of the case is on springs".into())
    }

    /// The coordinate that a claim names, or the only one.
    fn coordinate(&self, claim: &Claim) -> Result<&CoordinateSummary, String> {
        let all = &self.first_structure()?.coordinates;
        let found = match &claim.coordinate {
            Some(name) => all.iter().find(|c| c.name == *name),
            None => all.first().filter(|_| all.len() == 1),
        };
        let names = || all.iter().map(|c| format!("`{}`", c.name)).collect::<Vec<_>>().join(", ");
        found.ok_or_else(|| format!("the claim needs a `coordinate`, one of {}", names()))
    }

    fn frequency(&self, claim: &Claim) -> Value {
        self.coordinate(claim)?.frequency.ok_or_else(no_oscillation)
    }

    /// Growth rate over frequency.
    fn growth(&self, claim: &Claim) -> Value {
        let own = self.coordinate(claim)?;
        own.growth_rate.zip(own.frequency).map(|(growth, omega)| growth / omega).ok_or_else(no_oscillation)
    }

    /// Half of greatest less smallest value in the last whole cycles.
    fn amplitude(&self, claim: &Claim) -> Value {
        self.coordinate(claim)?.amplitude.ok_or_else(no_oscillation)
    }

    fn angle(&self, claim: &Claim) -> Value {
        self.coordinate(claim)?.mean.ok_or_else(unfinished)
    }

    fn thin_value(&self, others: &[&Self], value: impl Fn(&Self) -> Value) -> Value {
        self.thin(others, |s| value(s).map(num_complex::Complex64::from)).map(|c| c.re)
    }

    /// Moment of the gas over that of the spring for equal small angles, (V*/V_D*)² = V*² 2 Cm_α/(π μ r_α²), with the moment slope
    /// of the fixed section `other` about the pivot, which is the point of its moments. Moment ρU²c²Cm_α α/2 and stiffness
    /// μπρb⁴r_α²(U/bV*)² give it with c = 2b.
    fn linear(&self, others: &[&Self]) -> Value {
        let fixed = others.first().ok_or_else(no_other)?;
        let data = self.case.structures.first().ok_or("no body of the case is on springs")?;
        let numbers = |s: &Structure| Some((s.mass_ratio?, s.r_alpha2?, s.reduced_speed?));
        let (mu, r2, speed) = numbers(data).ok_or("the section needs `mass_ratio`, `r_alpha2` and `reduced_speed`")?;
        let slope = fixed.numbers.loads.cm / fixed.case.flow.alpha.0;
        Ok(speed * speed * 2.0 * slope / (PI * mu * r2))
    }

    /// p of value(h) = limit + C h^p, from steps h, h/2 and h/4.
    fn step_order(&self, others: &[&Self], value: impl Fn(&Self) -> Value) -> Value {
        let [half, quarter] = others else { return Err("the claim needs `other` and `third`, of finer steps".into()) };
        let (coarse, middle, fine) = (value(self)?, value(half)?, value(quarter)?);
        Ok(((coarse - middle) / (middle - fine)).abs().log2())
    }
}

fn unfinished() -> String {
    "the structure has no place".into()
}

fn no_oscillation() -> String {
    "the structure does not oscillate".into()
}
