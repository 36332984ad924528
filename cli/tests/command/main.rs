//! The command as its users meet it, in one program: what the tests share is compiled and linked once.
#![allow(clippy::unwrap_used, reason = "a test may stop anywhere")]

mod book;
mod cli;
mod events;
mod interrupted;
mod refused;
mod summary;
mod tables;
mod verify;
