//! What a case file says, as plain data; it knows no solver type.
pub mod case;
