#!/usr/bin/env python3
"""Times steady flows with shocks on clouds whose spacing is named: NACA 0012, 1.25 degrees, six orders, one thread.

    tests/nightly/steady.py target/release/alula [--spacings 24] [--against OTHER] [--table steady.md]

Spacings lie evenly between 1/50 and 1/1000 of the chord by their logarithm, Mach numbers are 0.76, 0.80, 0.84, 0.87 and 1.2. With `--against` every case is
run by another program as well, in turn, so that both meet the same machine. The exit code is 1 where a run does not come to rest.
"""
import argparse
import json
import os
import pathlib
import statistics
import subprocess
import sys
import tempfile

MACHS = (0.76, 0.80, 0.84, 0.87, 1.2)
CASE = """[flow]
mach = {mach}
alpha = "1.25 deg"
[[body]]
naca = "0012"
[cloud]
spacing = {spacing:.6g}
[time.steady]
orders = 6
[output]
report = false
"""


def solved(alula, folder, mach, spacing):
    """Particles, iterations, microseconds of processor time a particle, lift, and whether the flow came to rest."""
    case, out = folder / "case.toml", folder / "run"
    case.write_text(CASE.format(mach=mach, spacing=spacing))
    command = [alula, "run", case, "--out", out, "--quiet", "--force"]
    done = subprocess.run(command, env={**os.environ, "RAYON_NUM_THREADS": "1"}, capture_output=True, text=True, check=False)
    if not (out / "summary.json").exists() or done.returncode not in (0, 1):
        return None
    found = json.loads((out / "summary.json").read_text())
    cost = 1e6 * found["cpu_seconds"] / found["particles"]
    return found["particles"], found["iterations"], cost, found["loads"]["cl"], found["converged"]


def spread(rows):
    costs = sorted(row[2] for row in rows)
    return f"median {statistics.median(costs):.0f} µs a particle, 90th percentile {costs[int(0.9 * (len(costs) - 1))]:.0f}, most {costs[-1]:.0f}"


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("alula")
    parser.add_argument("--spacings", type=int, default=24)
    parser.add_argument("--against")
    parser.add_argument("--table", type=pathlib.Path)
    options = parser.parse_args()
    programs = [options.alula, *([options.against] if options.against else [])]
    step = 20.0 ** (1.0 / max(options.spacings - 1, 1))
    found, lines = {program: [] for program in programs}, []
    with tempfile.TemporaryDirectory() as folder:
        for spacing in (0.02 / step**k for k in range(options.spacings)):
            for mach in MACHS:
                cells = []
                for program in programs:
                    row = solved(program, pathlib.Path(folder), mach, spacing)
                    if row is None or not row[4]:
                        cells.append("not at rest | | ")
                        found[program].append(None)
                        continue
                    found[program].append(row)
                    cells.append(f"{row[1]} | {row[2]:.0f} | {row[3]:.5f}")
                rows = [found[program][-1] for program in programs]
                particles = next((row[0] for row in rows if row), "")
                lines.append(f"| {spacing:.5f} | {mach} | {particles} | " + " | ".join(cells) + " |")
                print(lines[-1], flush=True)
    stalled = 0
    for program in programs:
        rows = [row for row in found[program] if row]
        print(f"{program}: {spread(rows)}; {len(found[program]) - len(rows)} of {len(found[program])} not at rest")
        stalled += len(found[program]) - len(rows) if program == options.alula else 0
    if options.table:
        head = "| spacing | Mach | particles |" + " iterations | µs a particle | CL |" * len(programs)
        options.table.write_text(head + "\n" + "|---" * (3 + 3 * len(programs)) + "|\n" + "\n".join(lines) + "\n")
    sys.exit(1 if stalled else 0)


if __name__ == "__main__":
    main()
