//! The case file as plain data: reading, checking and writing. This crate knows no solver type.
pub mod case;
