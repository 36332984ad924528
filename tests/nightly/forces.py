#!/usr/bin/env python3
"""Holds the error bars of `alula gaf` against Possio's integral equation, on default clouds.

    tests/nightly/forces.py target/release/alula [--table forces.md]

NACA 0002 and 0004 at Mach 0.3 and 0.5, five reduced frequencies, pitch and plunge, lift and moment: 40 coefficients, of which a straight line through
the two thicknesses gives those of no thickness, with the bars of both. A minute of one core. The exit code is 1 where fewer than nine of ten bars hold.
"""
import argparse
import csv
import pathlib
import statistics
import subprocess
import sys
import tempfile

FREQUENCIES = (0.05, 0.1, 0.2, 0.4, 0.8)
REFERENCES = pathlib.Path(__file__).parents[2] / "verification" / "possio_forces"
CASE = """[flow]
mach = {mach}
[[body]]
naca = "{section}"
[gaf]
reduced_frequencies = {frequencies}
pivot = [0.25, 0.0]
"""


def forces(alula, folder, mach, section):
    """Coefficients and their bars by reduced frequency, motion and name."""
    case, out = folder / f"{section}-{mach}.toml", folder / f"{section}-{mach}"
    case.write_text(CASE.format(mach=mach, section=section, frequencies=list(FREQUENCIES)))
    subprocess.run([alula, "gaf", case, "--out", out, "--quiet"], capture_output=True, check=True)
    found = {}
    with open(out / "gaf.csv", encoding="utf-8") as file:
        for row in csv.DictReader(file):
            for name in ("cl", "cm"):
                value = complex(float(row[name + "_re"]), float(row[name + "_im"]))
                found[float(row["k"]), row["mode"], name] = value, float(row[name + "_error"])
    return found


def exact(mach):
    with open(REFERENCES / f"possio_m{mach:.1f}.csv".replace("0.", "0"), encoding="utf-8") as file:
        rows = csv.DictReader(line for line in file if not line.startswith("#"))
        return {(float(r["k"]), r["mode"], r["coefficient"]): complex(float(r["re"]), float(r["im"])) for r in rows}


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("alula")
    parser.add_argument("--table", type=pathlib.Path)
    options = parser.parse_args()
    lines, ratios = [], []
    with tempfile.TemporaryDirectory() as name:
        for mach in (0.3, 0.5):
            right = exact(mach)
            thin, thick = (forces(options.alula, pathlib.Path(name), mach, section) for section in ("0002", "0004"))
            for key in thin:
                error = abs(2 * thin[key][0] - thick[key][0] - right[key])
                bar = ((2 * thin[key][1]) ** 2 + thick[key][1] ** 2) ** 0.5
                ratios.append(bar / error)
                k, mode, coefficient = key
                lines.append(f"| {mach} | {k} | {mode} | {coefficient} | {abs(right[key]):.4f} | {error:.4f} | {bar:.4f} |")
                print(lines[-1], flush=True)
    held = sum(ratio >= 1.0 for ratio in ratios)
    print(f"{held} of {len(ratios)} bars hold; median of bar over error {statistics.median(ratios):.1f}")
    if options.table:
        options.table.write_text("| Mach | k | motion | | Possio | error | bar |\n" + "|---" * 7 + "|\n" + "\n".join(lines) + "\n")
    sys.exit(0 if held >= 0.9 * len(ratios) else 1)


if __name__ == "__main__":
    main()
