#!/usr/bin/env python3
"""What `alula check` tells of memory and time, beside what `alula run` takes.

    tests/nightly/estimate.py target/release/alula [NAME ...]

Each case is checked and run. A run may end on the first clouds that know its loads well enough, or on the last that is allowed:
what it took is held against what was told of the end it came to. Memory should be told within 15 %, time within 30 %.
"""
import json
import pathlib
import subprocess
import sys
import tempfile

MEMORY, TIME = 0.15, 0.30
SECTION = '[flow]\nmach = {mach}\nalpha = "{alpha} deg"\n[[body]]\nnaca = "{naca}"\n'
CIRCLE = "[flow]\nmach = {mach}\n[[body]]\ncircle = {{ radius = 0.5 }}\n"
PITCH = '[motion]\nreduced_frequency = 0.2\npitch = "1 deg"\npivot = [0.25, 0]\n'
CASES = {
    "section-m05": SECTION.format(mach=0.5, alpha=2, naca="0012"),
    "section-m08": SECTION.format(mach=0.8, alpha=1.25, naca="0012"),
    "section-m15": SECTION.format(mach=1.5, alpha=2, naca="0006"),
    "cambered": SECTION.format(mach=0.6, alpha=3, naca="4412"),
    "stated": SECTION.format(mach=0.8, alpha=1.25, naca="0012") + "[cloud]\nspacing = 0.0078125\nfar_field = 40.0\n",
    "adapted": SECTION.format(mach=0.8, alpha=1.25, naca="0012") + "[cloud]\nspacing = 0.03125\nfar_field = 20.0\n[adapt]\ncycles = 3\n",
    "polar": '[flow]\nmach = 0.6\nalpha = "-2:4:2 deg"\n[[body]]\nnaca = "2412"\n',
    "circle-m03": CIRCLE.format(mach=0.3),
    "circle-m2": CIRCLE.format(mach=2.0),
    "circle-re40": CIRCLE.format(mach="0.2\nreynolds = 40"),
    "plate-re5000": SECTION.format(mach="0.5\nreynolds = 5000", alpha=0, naca="0012"),
    "march": SECTION.format(mach=0.5, alpha=0, naca="0012") + PITCH + "[time.dual]\nsteps_per_period = 64\nperiods = 3\n",
    "march-transonic": SECTION.format(mach=0.76, alpha=0, naca="64A010") + PITCH + "[time.dual]\nsteps_per_period = 64\nperiods = 3\n",
    "balance": SECTION.format(mach=0.5, alpha=0, naca="0012") + PITCH + "[time]\nharmonics = 2\n",
    "balance-transonic": SECTION.format(mach=0.76, alpha=0, naca="64A010") + PITCH + "[time]\nharmonics = 3\n",
    "explicit": SECTION.format(mach=0.5, alpha=2, naca="0012")
    + "[cloud]\nspacing = 0.03125\nfar_field = 8.0\n[time.explicit]\nuntil = 4.0\n",
    "sphere-m03": "[flow]\nmach = 0.3\n[[body]]\nsphere = { radius = 0.5 }\n",
    "sphere-stated": "[flow]\nmach = 0.3\n[[body]]\nsphere = { radius = 0.5 }\n[cloud]\nspacing = 0.03125\nfar_field = 10.0\n",
    "wing": None,
}


def last(text, kind):
    lines = [json.loads(line) for line in text.splitlines() if line.startswith("{")]
    return [line for line in lines if line.get("event") == kind][-1]


def told_and_taken(alula, folder, name, text):
    case = folder / f"{name}.toml"
    if text is None:
        subprocess.run([alula, "new", "stl", str(case)], check=True, capture_output=True, cwd=folder)
    else:
        case.write_text(text)
    def call(*words):
        return subprocess.run([alula, *map(str, words), "--json"], capture_output=True, text=True)
    check = call("check", case)
    if check.returncode:
        raise SystemExit(f"{name}: {check.stdout}{check.stderr}")
    told = last(check.stdout, "check")
    run = call("run", case, "--out", folder / name)
    return told, last(run.stdout, "summary")


def main():
    alula = str(pathlib.Path(sys.argv[1]).resolve())
    missed = [0, 0]
    names = sys.argv[2:] or list(CASES)
    print(f"{'case':18} {'particles':>9} {'MB told':>8} {'taken':>7} {'ratio':>6}   {'s told':>7} {'taken':>7} {'ratio':>6}", flush=True)
    with tempfile.TemporaryDirectory() as folder:
        for name in names:
            told, taken = told_and_taken(alula, pathlib.Path(folder), name, CASES[name])
            ends = [end for end in (told["cost"], told.get("least")) if end]
            card = (taken.get("grid_convergence") or {}).get("clouds", [])
            first = len(card) == 3 and told.get("least") is not None
            end = ends[-1] if first else ends[0]
            memory, time = end["bytes"] / taken["peak_bytes"], end["seconds"] / taken["wall_seconds"]
            for i, (ratio, bound) in enumerate([(memory, MEMORY), (time, TIME)]):
                missed[i] += not (1 - bound <= ratio <= 1 + bound)
            print(
                f"{name:18} {taken['particles']:9} {end['bytes'] / 1e6:8.0f} {taken['peak_bytes'] / 1e6:7.0f} {memory:6.2f}   "
                f"{end['seconds']:7.1f} {taken['wall_seconds']:7.1f} {time:6.2f}",
                flush=True,
            )
    print(f"missed: memory {missed[0]}, time {missed[1]} of {len(names)}")


if __name__ == "__main__":
    main()
