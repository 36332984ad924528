//! Tests of the library as another program uses it, in one program: what they share of the library is compiled once.
#![allow(clippy::unwrap_used, reason = "a test may stop anywhere")]

#[path = "../common/mod.rs"]
mod common;

mod accuracy;
mod claims;
mod convergence;
mod coupled;
mod examples;
mod flutter_forces;
mod flutter_trim;
mod flutter_typical;
mod gaf;
mod harmonic;
mod invariance;
mod keys;
mod layers;
mod limit_cycles;
mod modes;
mod motion;
mod operators;
mod polar;
mod properties;
mod refusals;
mod solids;
mod steps;
mod structure;
mod structures_alone;
mod tables;
mod travel;
mod units;
mod verification;
