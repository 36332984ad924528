#!/usr/bin/env python3
"""Holds error bars of sections with shocks against loads on finer clouds: 41 flows, about 10,000 and 36,000 particles, CL, CD and CM.

    tests/nightly/shocks.py target/release/alula [--folder shocks]

The truth is the load on some 134,000 particles, and four tenths of its last change more where that is smaller than the one before, two tenths where it is not: errors of first order
leave all of the last change, those of second order a third. Half an hour of one core; runs that are in the folder already are read, not repeated. A bar holds where it is no shorter than the error; the
exit code is 1 where fewer than nine of ten do, or where the median of bar over error is above 5.
"""
import argparse
import json
import pathlib
import statistics
import subprocess
import sys

MACHS = (0.70, 0.72, 0.74, 0.75, 0.76, 0.77, 0.78, 0.79, 0.80, 0.81, 0.82, 0.83, 0.84, 0.85, 0.86, 0.87, 0.89, 0.92, 1.2)
SECTIONS = [("0012", mach, 1.25) for mach in MACHS] + [
    ("0006", 0.86, 1), ("0008", 0.84, 1.5), ("0010", 0.8, 2), ("0015", 0.73, 1), ("0018", 0.70, 1), ("0021", 0.65, 1), ("2412", 0.74, 0), ("2412", 0.78, 0.5),
    ("4412", 0.70, 0), ("4415", 0.66, 0), ("23012", 0.73, 0), ("64A010", 0.82, 1), ("64A010", 0.86, 0.5), ("65-210", 0.78, 0), ("63-415", 0.66, 0), ("1408", 0.82, 0),
    ("2408", 0.80, 1), ("0012", 0.70, 4), ("0012", 0.65, 6), ("0012", 0.5, 8), ("6409", 0.68, 0), ("64A006", 0.9, 1),
]
LOADS = ("cl", "cd", "cm")
PARTICLES = (12_000, 40_000, 140_000)


def family(options, section, particles):
    naca, mach, alpha = section
    out = options.folder / f"{naca}-{mach}-{alpha}-{particles // 1000}"
    if not (out / "finished.txt").exists():
        file = options.folder / f"{out.name}.toml"
        file.write_text(
            f'[flow]\nmach = {mach}\nalpha = "{alpha} deg"\n[[body]]\nname = "section"\nnaca = "{naca}"\n'
            f'[accuracy]\nloads = "0.001 %"\nparticles = {particles}\n[output]\nreport = false\n'
        )
        run = subprocess.run([options.alula, "run", file, "--out", out, "--quiet", "--force"], capture_output=True, text=True, check=False)
        # 1: not converged, which the bars tell
        if run.returncode not in (0, 1):
            sys.exit(f"{out.name}: {run.stderr}")
    return json.loads((out / "summary.json").read_text())["grid_convergence"]


def truth(clouds, load):
    before, last = clouds[-2][load] - clouds[-3][load], clouds[-1][load] - clouds[-2][load]
    return clouds[-1][load] + last * (0.4 if abs(last) < abs(before) else 0.2)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("alula")
    parser.add_argument("--folder", type=pathlib.Path, default=pathlib.Path("shocks"))
    options = parser.parse_args()
    options.folder.mkdir(exist_ok=True)
    ratios = []
    for section in SECTIONS:
        fine = family(options, section, PARTICLES[-1])["clouds"]
        cells = []
        for particles in PARTICLES[:-1]:
            found = family(options, section, particles)
            cloud = found["clouds"][-1]
            if not cloud["supersonic"]:
                continue
            for load in LOADS:
                error = abs(cloud[load] - truth(fine, load))
                ratios.append(found[load]["half_width"] / max(error, 1e-9))
                cells.append(f"{load} {cloud[load]:.5f} ± {found[load]['half_width']:.5f} ({error:.5f}{'' if ratios[-1] >= 1 else ' out'})")
        print(*section, *cells, sep=" | ", flush=True)
    held, median = sum(r >= 1.0 for r in ratios), statistics.median(ratios)
    print(f"{held} of {len(ratios)} bars hold; median of bar over error {median:.1f}")
    sys.exit(0 if held >= 0.9 * len(ratios) and median <= 5.0 else 1)


if __name__ == "__main__":
    main()
