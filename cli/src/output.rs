//! Printing that survives a closed pipe: `alula schema | head` must end quietly, not with a panic.
//!
//! With `--json` all that is told is an *event*: a JSON object on a line of standard output, whose key `event` says what it is.
use std::io::{self, ErrorKind, IsTerminal, Write};
use std::sync::atomic::{AtomicBool, Ordering};

use alula::case::CaseErrors;
use serde_json::{Value, json};

use crate::outcome::Outcome;

/// True when programs listen.
static JSON: AtomicBool = AtomicBool::new(false);

/// From now on everything is told as events if `json`.
pub(crate) fn speak_json(json: bool) {
    JSON.store(json, Ordering::Relaxed);
}

fn json_is_spoken() -> bool {
    JSON.load(Ordering::Relaxed)
}

/// An event in one line: `fields`, an object, after the name.
pub(crate) fn event_line(name: &str, fields: Value) -> String {
    let mut object = json!({ "event": name });
    if let (Some(object), Value::Object(fields)) = (object.as_object_mut(), fields) {
        object.extend(fields);
    }
    object.to_string()
}

/// Writes an event to stdout.
pub(crate) fn event(name: &str, fields: Value) -> Outcome {
    data(&(event_line(name, fields) + "\n"))
}

/// Writes data to stdout; a reader that went away is no failure.
pub(crate) fn data(text: &str) -> Outcome {
    deliver(&mut io::stdout().lock(), text)
}

/// Tells something worth a line: to stderr, or as an event.
pub(crate) fn note(text: &str) {
    if json_is_spoken() {
        event("note", json!({ "message": text }));
    } else {
        message(text);
    }
}

/// Tells all mistakes of a case: to stderr, or as an event each.
pub(crate) fn mistakes(mistakes: &CaseErrors) {
    if !json_is_spoken() {
        return message(&mistakes.render(colour()));
    }
    for mistake in &mistakes.errors {
        let mut fields = json!({ "file": mistakes.name });
        if let (Some(fields), Ok(Value::Object(own))) = (fields.as_object_mut(), serde_json::to_value(mistake)) {
            fields.extend(own.into_iter().filter(|(_, value)| !value.is_null()));
        }
        event("error", fields);
    }
}

/// Writes a message to stderr; nobody is left to tell when that fails.
pub(crate) fn message(text: &str) {
    let _ = writeln!(io::stderr().lock(), "{text}");
}

/// Tells an error with its remedy: to stderr, or as an event.
pub(crate) fn error(what: &str, hint: &str) {
    error_in(None, what, hint);
}

/// The same of a file.
pub(crate) fn error_in(file: Option<&str>, what: &str, hint: &str) {
    if !json_is_spoken() {
        return message(&error_text(what, hint));
    }
    let mut fields = json!({ "message": what });
    let known = [("file", file), ("hint", Some(hint).filter(|h| !h.is_empty()))];
    for (name, text) in known {
        if let Some(text) = text {
            fields[name] = text.into();
        }
    }
    event("error", fields);
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
            // there is no other way to tell it
            let what = format!("cannot write to standard output: {problem}");
            message(&error_text(&what, "check the disk or the receiving program"));
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
    fn an_event_is_one_line_that_begins_with_its_name() {
        let line = event_line("note", json!({ "message": "two\nlines" }));
        assert_eq!(line, r#"{"event":"note","message":"two\nlines"}"#);
    }

    #[test]
    fn a_closed_pipe_is_no_failure_but_a_full_disk_is() {
        assert_eq!(deliver(&mut Closed(ErrorKind::BrokenPipe), "text"), Outcome::Done);
        assert_eq!(deliver(&mut Closed(ErrorKind::StorageFull), "text"), Outcome::Failed);
    }
}
