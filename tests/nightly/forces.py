#!/usr/bin/env python3
"""Holds the error bars of `alula gaf` against Possio's integral equation, on default clouds, and those of wings against finer clouds.

    tests/nightly/forces.py target/release/alula [--space] [--table forces.md]

NACA 0002 and 0004 at Mach 0.3 and 0.5, five reduced frequencies, pitch and plunge, lift and moment: 40 coefficients, of which a straight line through
the two thicknesses gives those of no thickness, with the bars of both. A minute of one core. With `--space` two half wings at two reduced frequencies
instead, on 60,000 and 120,000 particles: 32 coefficients, against those that two similar clouds extrapolate to, the finer one of 290,000 or 380,000 particles
with 8 to a level, which stand in `forces.json`; a wing that is missing there takes a quarter of an hour of one core. The exit code is 1 where fewer than nine of ten bars hold.
"""
import argparse
import csv
import json
import pathlib
import statistics
import subprocess
import sys
import tempfile

FREQUENCIES = (0.05, 0.1, 0.2, 0.4, 0.8)
REFERENCES = pathlib.Path(__file__).parents[2] / "verification" / "possio_forces"
TRUTHS = pathlib.Path(__file__).with_name("forces.json")
IN_SPACE = (0.1, 0.3)
# Mach number, half of a wing, and the spacing of the finer of two clouds that its truth is extrapolated from
WINGS = {
    "swept": (0.5, '{ naca = "0008", span = 6.0, chord = 1.0, taper = 0.6, sweep = "20 deg" }', 0.07),
    "rectangular": (0.3, '{ naca = "0006", span = 5.0, chord = 1.0 }', 0.08),
}
WING = """[flow]
mach = {mach}
[[body]]
name = "wing"
wing = {wing}
[boundary]
y_min = "symmetry"
[gaf]
reduced_frequencies = {frequencies}
pivot = [0.25, 0.0, 0.0]
{cloud}"""
CASE = """[flow]
mach = {mach}
[[body]]
naca = "{section}"
[gaf]
reduced_frequencies = {frequencies}
pivot = [0.25, 0.0]
"""


def coefficients(out):
    """Those of a run with their bars, by reduced frequency, motion and name."""
    found = {}
    with open(out / "gaf.csv", encoding="utf-8") as file:
        for row in csv.DictReader(file):
            for name in ("cl", "cm"):
                value = complex(float(row[name + "_re"]), float(row[name + "_im"]))
                found[float(row["k"]), row["mode"], name] = value, float(row[name + "_error"])
    return found


def forces(alula, folder, mach, section):
    """Coefficients and their bars by reduced frequency, motion and name."""
    case, out = folder / f"{section}-{mach}.toml", folder / f"{section}-{mach}"
    case.write_text(CASE.format(mach=mach, section=section, frequencies=list(FREQUENCIES)))
    subprocess.run([alula, "gaf", case, "--out", out, "--quiet"], capture_output=True, check=True)
    return coefficients(out)


def of_wing(alula, folder, name, word, cloud):
    """Coefficients and their bars of a wing on a cloud, by reduced frequency, motion and name."""
    mach, wing, _ = WINGS[name]
    case, out = folder / f"{name}-{word}.toml", folder / f"{name}-{word}"
    case.write_text(WING.format(mach=mach, wing=wing, frequencies=list(IN_SPACE), cloud=cloud))
    if not (out / "gaf.csv").exists():
        subprocess.run([alula, "gaf", case, "--out", out, "--quiet"], capture_output=True, check=True)
    return coefficients(out)


def limits(alula, folder, name):
    """What the coefficients of a wing are extrapolated to: errors fall with the spacing or with its square, the mean of both."""
    known = json.loads(TRUTHS.read_text()) if TRUTHS.exists() else {}
    if name not in known:
        spacing = WINGS[name][2]
        clouds = (("coarse", 2 * spacing, 4), ("fine", spacing, 8))
        tables = (f"[cloud]\nspacing = {h}\nlayers = {n}\nfar_field = 180\n" for _, h, n in clouds)
        coarse, fine = (of_wing(alula, folder, name, word, table) for (word, *_), table in zip(clouds, tables))
        ends = {key: fine[key][0] + 2 / 3 * (fine[key][0] - coarse[key][0]) for key in fine}
        known[name] = [[*key, end.real, end.imag] for key, end in ends.items()]
        TRUTHS.write_text(json.dumps(known, indent=1) + "\n")
    return {tuple(row[:3]): complex(*row[3:]) for row in known[name]}


def in_space(options, folder):
    """A line of the table for each coefficient of a wing, and its bar over its error."""
    for name in WINGS:
        right = limits(options.alula, folder, name)
        for particles in (60_000, 120_000):
            table = f"[accuracy]\nparticles = {particles}\n"
            for key, (value, bar) in of_wing(options.alula, folder, name, particles, table).items():
                error = abs(value - right[key])
                k, mode, coefficient = key
                line = f"| {name}, {particles:,} | {k} | {mode} | {coefficient} | {abs(right[key]):.4f} | {error:.4f} | {bar:.4f} |"
                yield line, bar / error


def in_the_plane(options, folder):
    """The same for sections, extrapolated to no thickness."""
    for mach in (0.3, 0.5):
        right = exact(mach)
        thin, thick = (forces(options.alula, folder, mach, section) for section in ("0002", "0004"))
        for key in thin:
            error = abs(2 * thin[key][0] - thick[key][0] - right[key])
            bar = ((2 * thin[key][1]) ** 2 + thick[key][1] ** 2) ** 0.5
            k, mode, coefficient = key
            yield f"| Mach {mach} | {k} | {mode} | {coefficient} | {abs(right[key]):.4f} | {error:.4f} | {bar:.4f} |", bar / error


def exact(mach):
    with open(REFERENCES / f"possio_m{mach:.1f}.csv".replace("0.", "0"), encoding="utf-8") as file:
        rows = csv.DictReader(line for line in file if not line.startswith("#"))
        return {(float(r["k"]), r["mode"], r["coefficient"]): complex(float(r["re"]), float(r["im"])) for r in rows}


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("alula")
    parser.add_argument("--space", action="store_true")
    parser.add_argument("--folder", type=pathlib.Path, help="where runs are kept, and read if they are there")
    parser.add_argument("--table", type=pathlib.Path)
    options = parser.parse_args()
    lines, ratios = [], []
    with tempfile.TemporaryDirectory() as temporary:
        folder = options.folder or pathlib.Path(temporary)
        folder.mkdir(exist_ok=True)
        for line, ratio in (in_space if options.space else in_the_plane)(options, folder):
            lines.append(line)
            ratios.append(ratio)
            print(line, flush=True)
    held = sum(ratio >= 1.0 for ratio in ratios)
    print(f"{held} of {len(ratios)} bars hold; median of bar over error {statistics.median(ratios):.1f}")
    if options.table:
        options.table.write_text("| | k | motion | | reference | error | bar |\n" + "|---" * 7 + "|\n" + "\n".join(lines) + "\n")
    sys.exit(0 if held >= 0.9 * len(ratios) else 1)


if __name__ == "__main__":
    main()
