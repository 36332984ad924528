//! Records: what studies find, as plain data.
//!
//! A record is written and read by the same types. It knows no solver and opens no file: runs write it, and the report, the command line
//! and the Python package read it.
pub mod flutter;
pub mod gaf;
pub mod summary;
