//! Printing that survives a closed pipe: `alula schema | head` must end quietly, not with a panic.
use std::io::{self, ErrorKind, IsTerminal, Write};

use crate::outcome::Outcome;

/// Writes data to stdout; a reader that went away is no failure.
pub(crate) fn data(text: &str) -> Outcome {
    deliver(&mut io::stdout().lock(), text)
}

/// Writes a message to stderr; nobody is left to tell when that fails.
pub(crate) fn message(text: &str) {
    let _ = writeln!(io::stderr().lock(), "{text}");
}

/// Writes an error with its remedy to stderr.
pub(crate) fn error(what: &str, hint: &str) {
    message(&error_text(what, hint));
}

/// An error with its remedy, where there is one.
fn error_text(what: &str, hint: &str) -> String {
    let what = what.strip_prefix("error: ").unwrap_or(what);
    if hint.is_empty() { format!("error: {what}") } else { format!("error: {what}\nhint: {hint}") }
}

/// True when messages may carry colours (<https://no-color.org>).
pub(crate) fn colour() -> bool {
    io::stderr().is_terminal() && std::env::var_os("NO_COLOR").is_none_or(|value| value.is_empty())
}

fn deliver(sink: &mut dyn Write, text: &str) -> Outcome {
    match sink.write_all(text.as_bytes()).and_then(|()| sink.flush()) {
        Ok(()) => Outcome::Done,
        Err(problem) if problem.kind() == ErrorKind::BrokenPipe => Outcome::Done,
        Err(problem) => {
            error(&format!("cannot write to standard output: {problem}"), "check the disk or the receiving program");
            Outcome::Failed
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    struct Closed(ErrorKind);

    impl Write for Closed {
        fn write(&mut self, _: &[u8]) -> io::Result<usize> {
            Err(self.0.into())
        }
        fn flush(&mut self) -> io::Result<()> {
            Ok(())
        }
    }

    #[test]
    fn nothing_is_said_twice_or_left_empty() {
        assert_eq!(error_text("error: it broke", ""), "error: it broke");
        assert_eq!(error_text("it broke", "mend it"), "error: it broke\nhint: mend it");
    }

    #[test]
    fn a_closed_pipe_is_no_failure_but_a_full_disk_is() {
        assert_eq!(deliver(&mut Closed(ErrorKind::BrokenPipe), "text"), Outcome::Done);
        assert_eq!(deliver(&mut Closed(ErrorKind::StorageFull), "text"), Outcome::Failed);
    }
}
