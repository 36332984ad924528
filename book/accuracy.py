#!/usr/bin/env python3
"""Writes the measured accuracy into the book, from what `alula verify --json` prints.

    alula verify --json > FILE
    python3 book/accuracy.py FILE      takes over the claims of FILE: those of its cases replace the ones kept so far
    python3 book/accuracy.py --check   fails where the page does not show what is kept

The claims are kept in `book/verification/claims.jsonl`, one JSON object a line, each with the version of the program that measured it. The
table stands between two marks in `book/verification/accuracy.md`.
"""
import json
import pathlib
import re
import sys

BOOK = pathlib.Path(__file__).resolve().parent
KEPT = BOOK / "verification" / "claims.jsonl"
PAGE = BOOK / "verification" / "accuracy.md"
BEGIN, END = "<!-- accuracy: begin, written by book/accuracy.py -->", "<!-- accuracy: end -->"
KEYS = ("case", "metric", "value", "reference", "error", "tolerance", "pass", "source")


def version():
    """Version of the workspace."""
    return re.search(r'^version = "(.+?)"', (BOOK.parent / "Cargo.toml").read_text(encoding="utf-8"), re.MULTILINE)[1]


def claims(path):
    """Claims of a file of events, in their order; other events are passed over."""
    rows = [json.loads(line) for line in path.read_text(encoding="utf-8").splitlines() if line.strip()]
    return [row for row in rows if row.get("event", "claim") == "claim"]


def number(value):
    """Five significant digits."""
    return "–" if value is None else f"{value:.5g}"


def table(rows):
    """Markdown table of the claims."""
    lines = ["| case | quantity | measured | reference | difference | tolerance | holds | source of the reference | version |",
             "|---|---|---|---|---|---|---|---|---|"]
    case = None
    for row in rows:
        name = f"`{row['case']}`" if row["case"] != case else ""
        case = row["case"]
        source = row["source"].replace("|", "\\|")
        cells = [name, row["metric"], *(number(row[key]) for key in ("value", "reference", "error", "tolerance")),
                 "yes" if row["pass"] else "**no**", source, row["version"]]
        lines.append("| " + " | ".join(cells) + " |")
    held, cases = sum(row["pass"] for row in rows), len({row["case"] for row in rows})
    return f"{held} of {len(rows)} claims of {cases} cases hold.\n\n" + "\n".join(lines)


def page():
    """The page with the table of the claims that are kept."""
    text = PAGE.read_text(encoding="utf-8")
    before, rest = text.split(BEGIN)
    return f"{before}{BEGIN}\n\n{table(claims(KEPT))}\n\n{END}{rest.split(END)[1]}"


def take_over(path):
    """Replaces the claims of the cases in the file at `path`."""
    new = [{**{key: row[key] for key in KEYS}, "version": version()} for row in claims(path)]
    if not new:
        sys.exit(f"error: {path} has no claims; hint: `alula verify --json > {path}`")
    measured = {row["case"] for row in new}
    old = [row for row in claims(KEPT) if row["case"] not in measured] if KEPT.exists() else []
    rows = sorted(old + new, key=lambda row: row["case"])
    KEPT.write_text("".join(json.dumps(row, ensure_ascii=False) + "\n" for row in rows), encoding="utf-8")


def main():
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    if sys.argv[1] == "--check":
        if page() != PAGE.read_text(encoding="utf-8"):
            sys.exit(f"error: {PAGE.name} differs from {KEPT.name}; hint: change {KEPT.name} by `python3 book/accuracy.py FILE` only")
        return
    take_over(pathlib.Path(sys.argv[1]))
    PAGE.write_text(page(), encoding="utf-8")


if __name__ == "__main__":
    main()
