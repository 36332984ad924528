#!/usr/bin/env python3
"""Kills runs at random moments, resumes them, and compares every result with that of the run that was left alone.

    tests/nightly/kill.py target/release/alula --count 300 --seed 1

Steady, adapted, viscous, implicit, explicit, travelling, harmonic and structural runs, polars, runs in space, structures of particles
alone and in a gas, flutter boundaries and matrices of generalised forces are killed one to three times and resumed each time. Where no checkpoint was written yet the run is begun again, as the program says. A run
that cannot go on, and a result that differs by one bit, is a failure: its folder is kept, and the exit code is 1.
"""
import argparse
import json
import pathlib
import random
import shutil
import signal
import subprocess
import sys
import tempfile
import time

SECONDS = 300
END = "[output]\ncheckpoint = 1\n"
SECTION = '[[body]]\nnaca = "0012"\n[cloud]\nspacing = 0.0625\nfar_field = 6.0\n'
STREAM = '[flow]\nmach = 0.5\nalpha = "2 deg"\n'
BEAM = """[[body]]
box = { size = [1.0, 0.2] }
translate = [0.5, 0]
[body.solid]
through = 3
gravity = [0, -9.81]
[body.solid.material]
density = 2700
young = 7e10
poisson = 0.33
[[body.solid.support]]
where = { x_max = 0.001 }
fix = ["x", "y"]
[[body.solid.load]]
where = { x_min = 0.99 }
force = [0, 1000]
history = "sin(100 * t)"
[[body.solid.probe]]
name = "tip"
at = [1.0, 0.0]
"""
# bodies, walls and structures that `mutate.py` has too
SPHERE = "[flow]\nmach = 0.3\n[[body]]\nsphere = { radius = 0.5 }\n"
TRAVELLING = ('[flow]\nmach = 0.3\n[motion]\nparticles = "lagrangian"\nperiod = 4.0\nplunge = 0.1\n[[body]]\n'
              "circle = { radius = 0.5 }\n")
PANEL = ('[flow]\nmach = 0.5\npressure = "101 kPa"\ndensity = 1.2\n[[body]]\nbox = { size = [0.1, 1.0] }\n[body.solid]\n'
         "through = 3\n[body.solid.material]\ndensity = 7600\nyoung = 2.2e11\npoisson = 0.33\n[[body.solid.support]]\n"
         "where = { y_max = -0.4 }\n[cloud]\nspacing = 0.05\nfar_field = 4.0\n[time.dual]\nstep = 1e-4\n")
IMPACT = BEAM.replace('fix = ["x", "y"]', 'fix = ["y"]')
WALL = "[contact]\nplanes = [{ point = [-0.01, 0], normal = [1, 0] }]\n[time.explicit]\n"
FLUTTER = ("[structure]\nelastic_axis = -0.5\nmass_ratio = 60.0\nx_alpha = 0.2\nr_alpha2 = 0.25\nfrequency_ratio = 0.5\n"
           '[[body]]\nnaca = "0012"\n[cloud]\nspacing = 0.1\nfar_field = 3.0\n[flutter]\nmach = [0.3, 0.4, 0.5]\n'
           "cloud_error = false\nreduced_frequencies = [0.1, 0.3]\n")
PLUNGE = "[flow]\nmach = 0.5\n[motion]\nperiod = 8.0\nplunge = 0.05\n" + SECTION
CASES = {
    "steady": STREAM + SECTION + END,
    "adapted": '[flow]\nmach = 0.8\nalpha = "1.25 deg"\n' + SECTION + "[adapt]\ncycles = 2\n" + END,
    "family": STREAM + '[[body]]\nnaca = "0012"\n[accuracy]\nparticles = 3000\n' + END,
    "adapted family": '[flow]\nmach = 0.8\nalpha = "1.25 deg"\n[[body]]\nnaca = "0012"\n[accuracy]\nparticles = 3000\n'
                      "[adapt]\ncycles = 1\n" + END,
    "viscous": "[flow]\nmach = 0.3\nreynolds = 100\n" + SECTION + "wall_layers = { first = 0.01 }\n[time.steady]\norders = 4\n" + END,
    "dual": PLUNGE + "[time.dual]\nsteps_per_period = 16\nperiods = 1\n" + END,
    "explicit": PLUNGE + "[time.explicit]\nuntil = 0.5\n" + END,
    "travelling": TRAVELLING + "[cloud]\nspacing = 0.1\nfar_field = 4.0\n[time.explicit]\nuntil = 1.0\n" + END,
    "harmonic": PLUNGE + "[time]\nharmonics = 2\n" + END,
    "structure": '[flow]\nmach = 0.8\n[motion]\nparticles = "rigid"\n[structure]\nelastic_axis = -0.6\nmass_ratio = 75.0\n'
                 "x_alpha = 0.25\nr_alpha2 = 0.75\nfrequency_ratio = 0.5\nspeed_index = 0.65\ninitial = { plunge = 0.01 }\n"
                 + SECTION + "[time.dual]\nstep = 1.0\nuntil = 10.0\n" + END,
    "polar": STREAM.replace('"2 deg"', '"0:3:1 deg"') + SECTION + END,
    "space": SPHERE + "[cloud]\nspacing = 0.2\nfar_field = 3.0\n[time.steady]\norders = 3\n" + END,
    "swing": BEAM + "[time.newmark]\nstep = 1e-3\nuntil = 2.0\n" + END,
    "impact": IMPACT.replace("gravity = ", "velocity = [-10, 0]\ngravity = ") + WALL + "until = 0.05\n" + END,
    "vibration": BEAM.replace("gravity = ", "stiffness_damping = 1e-5\ngravity = ").replace("100 * t", "omega * t")
                 + '[time.harmonics]\nnumber = 2\nfrequency = "40 Hz"\n' + END,
    "panel": PANEL + "until = 1e-3\n" + END,
    "flutter": "[flow]\nmach = 0.5\n" + FLUTTER,
    "gaf": "[flow]\nmach = 0.5\n" + SECTION + '[gaf]\nreduced_frequencies = [0.3]\nmodes = "plunge"\n' + END,
}
# what tells of the machine and of time, not of the flow
CLOCKS = {"seconds", "cpu_seconds", "wall_seconds", "peak_bytes", "run", "phases", "cpu_ms_per_particle", "bytes_per_particle",
          "preconditioner_seconds"}
# the folder stands in the state of ParaView, and what a run took in the checksums of its files
UNCOMPARED = {"report.html", "origin.txt", "checkpoint.alula", "log.txt", "finished.txt", "checksums.txt", "paraview-state.py"}


def without_clocks(value):
    if isinstance(value, dict):
        return {k: without_clocks(v) for k, v in value.items() if k not in CLOCKS}
    return [without_clocks(v) for v in value] if isinstance(value, list) else value


def content(file):
    if file.suffix == ".json":
        return without_clocks(json.loads(file.read_text()))
    if file.suffix == ".csv":
        rows = [line.split(",") for line in file.read_text().splitlines()]
        kept = [i for i, name in enumerate(rows[0]) if name not in CLOCKS] if rows else []
        return [[row[i] for i in kept if i < len(row)] for row in rows]
    return file.read_bytes()


def results(folder):
    files = [f for f in folder.rglob("*") if f.is_file() and f.name not in UNCOMPARED]
    return {str(f.relative_to(folder)): content(f) for f in files}


def begin(program, kind, folder):
    command = kind if kind in ("gaf", "flutter") else "run"
    return start(program, [command, "case.toml", "--out", "run"], folder)


def start(program, args, folder):
    quiet = {"stdout": subprocess.DEVNULL, "stderr": subprocess.PIPE}
    return subprocess.Popen([program, *args, "--quiet", "--threads", "1"], cwd=folder, **quiet)


def ended(process):
    told = process.communicate(timeout=SECONDS)[1].decode(errors="replace")
    return process.returncode, told


def uninterrupted(program, kind, folder):
    folder.mkdir(parents=True)
    (folder / "case.toml").write_text(CASES[kind])
    began = time.monotonic()
    code, told = ended(begin(program, kind, folder))
    if code not in (0, 1):
        sys.exit(f"error: `{kind}` does not run (exit code {code}): {told}")
    return results(folder / "run"), code, time.monotonic() - began


def interrupted(program, kind, folder, seconds, rng):
    """Exit code and words of the last attempt."""
    folder.mkdir()
    (folder / "case.toml").write_text(CASES[kind])
    process = begin(program, kind, folder)
    for _ in range(rng.choice([1, 1, 2, 3])):
        time.sleep(rng.uniform(0.0, 1.05 * seconds))
        process.send_signal(rng.choice([signal.SIGKILL, signal.SIGKILL, signal.SIGINT, signal.SIGTERM]))
        code, told = ended(process)
        if code == 101:
            return code, told
        run = folder / "run"
        if any((run / name).exists() for name in ("checkpoint.alula", "checkpoint.alula.previous", "flutter-kept.json")):
            process = start(program, ["resume", "run"], folder)
        elif (run / "finished.txt").exists():
            return code, told
        else:
            # gaf keeps no checkpoint, nor flutter before its first Mach number: they begin again where they stood
            process = begin(program, kind, folder)
    return ended(process)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("alula")
    parser.add_argument("--count", type=int, default=300)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--only", choices=sorted(CASES))
    args = parser.parse_args()
    program = str(pathlib.Path(args.alula).resolve())
    home = pathlib.Path(tempfile.mkdtemp(prefix="alula-kill-"))
    whole, bad = {}, 0
    for k in range(args.count):
        rng = random.Random(f"{args.seed} {k}")
        kind = args.only or rng.choice(sorted(CASES))
        if kind not in whole:
            whole[kind] = uninterrupted(program, kind, home / f"whole-{kind}")
        expected, expected_code, seconds = whole[kind]
        folder = home / f"{args.seed}-{k}"
        code, told = interrupted(program, kind, folder, seconds, rng)
        found = results(folder / "run")
        differing = sorted(n for n in expected.keys() | found.keys() if expected.get(n) != found.get(n))
        if code == expected_code and not differing:
            shutil.rmtree(folder)
            continue
        bad += 1
        print(f"{kind}: exit code {code}, differing {differing[:8]} in {folder}: {told.strip()[:300]}", flush=True)
    print(f"{args.count} killed runs of {len(whole)} kinds: {bad} not the same")
    if bad == 0:
        shutil.rmtree(home)
    sys.exit(1 if bad else 0)


if __name__ == "__main__":
    main()
