#!/usr/bin/env python3
"""Lines of Rust outside tests, room by room: code, documentation, comments and blank lines.

All crates count, with macros and templates that are Rust, as `cargo fmt` leaves them. Left out are folders called `tests`, files called
`tests.rs` or `tests_….rs`, and items under `#[cfg(test)]`.
"""
import pathlib
import re
import subprocess
import sys

COLUMNS = ["code", "documentation", "comments", "blank", "all"]


def is_test(path):
    """True for files that hold tests alone."""
    return "tests" in path.parts or path.name == "tests.rs" or path.name.startswith("tests_")


def outside_tests(lines):
    """The lines that are in no item under `#[cfg(test)]`; `cargo fmt` ends an item at the indent at which it begins."""
    kept, k = [], 0
    while k < len(lines):
        if not re.match(r"\s*#\[cfg\(test\)\]", lines[k]):
            kept.append(lines[k])
            k += 1
            continue
        while lines[k].lstrip().startswith("#["):
            k += 1
        end = lines[k][: len(lines[k]) - len(lines[k].lstrip())] + "}"
        if not lines[k].endswith(";"):
            k = next(later for later in range(k, len(lines)) if lines[later].startswith(end))
        k += 1
    return kept


def counts(lines):
    """Numbers of lines of each kind."""
    texts = [line.strip() for line in lines]
    documentation = sum(text.startswith(("///", "//!")) for text in texts)
    comments = sum(text.startswith("//") for text in texts) - documentation
    blank = texts.count("")
    return [len(texts) - documentation - comments - blank, documentation, comments, blank, len(texts)]


def room(path):
    """The room of a file: `study` of `src/study/mod.rs`, `case` of `crates/case/src/case/read.rs`."""
    parts = [part for part in path.with_suffix("").parts if part not in ("src", "crates")]
    return parts[1] if path.parts[0] == "crates" and len(parts) > 1 else parts[0]


def main():
    root = pathlib.Path(__file__).parent.parent
    files = subprocess.run(["git", "ls-files", "*.rs"], cwd=root, capture_output=True, text=True, check=True).stdout
    rooms = {}
    for path in map(pathlib.Path, files.split()):
        if is_test(path) or not (root / path).exists():
            continue
        found = counts(outside_tests((root / path).read_text().splitlines()))
        rooms[room(path)] = [a + b for a, b in zip(rooms.get(room(path), [0] * len(COLUMNS)), found)]
    print(f"{'room':<16}" + "".join(f"{column:>15}" for column in COLUMNS))
    total = [sum(column) for column in zip(*rooms.values())]
    for name, found in [*sorted(rooms.items(), key=lambda item: -item[1][-1]), ("all", total)]:
        print(f"{name:<16}" + "".join(f"{number:>15,}" for number in found))
    return 0


if __name__ == "__main__":
    sys.exit(main())
