//! The `alula` command: arguments in, exit codes out. It owns all printing; the computing is in the library.
use std::process::ExitCode;

use clap::Parser;

mod arguments;
mod commands;
mod heap;
#[allow(dead_code, reason = "interface of the run loop")]
mod interrupt;
mod outcome;
mod output;
#[allow(dead_code, reason = "interface of the run loop")]
mod progress;
mod watch;

fn main() -> ExitCode {
    heap::give_back_large_arrays();
    commands::dispatch(arguments::Cli::parse()).into()
}
