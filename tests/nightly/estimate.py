#!/usr/bin/env python3
"""What `alula check` tells of memory and time, beside what `alula run` takes.

    tests/nightly/estimate.py target/release/alula [NAME ...]

Each case is checked and run. A run may end on the first clouds that know its loads well enough, or on the last that is allowed:
what it took is held against what was told of the end it came to. Memory should be told within 15 %, time within 30 %; the time of
`alula gaf` and `alula flutter`, the steps of explicit marches of solids, and the particles that are counted without building their cloud
(within 5 %) are told beside them: time and steps within a factor of 2, or as "at least so many".
"""
import json
import pathlib
import subprocess
import sys
import tempfile
import time

MEMORY, TIME, FACTOR, COUNT = 0.15, 0.30, 2.0, 0.05
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

WING = """[flow]
mach = 0.6
[[body]]
name = "wing"
wing = { naca = "0008", span = 6.0, chord = 1.0, tip = "flat" }
[boundary]
y_min = "symmetry"
"""
SWEEP = """[gaf]
reduced_frequencies = [0.0, 0.1, 0.3]
modes = ["plunge", "pitch"]
pivot = [0.25, 0.0, 0.0]
"""
BAR = """[[body]]
name = "bar"
box = {{ size = [0.0032, 0.0324] }}
translate = [0.0016, 0.0162]
[body.solid]
plane = "axisymmetric"
through = {through}
velocity = ["0", "-227"]
material = {{ density = 8930, young = 117e9, poisson = 0.35, yield = 4e8, hardening = 1e8 }}
[[body.solid.support]]
where = {{ y_max = 1e-5 }}
fix = ["y"]
[time.explicit]
until = "80 us"
"""
# command, what is told of it by `check`, and the case
OTHERS = {
    "gaf-wing": ("gaf", WING + SWEEP),
    "gaf-section": ("gaf", SECTION.format(mach=0.5, alpha=0, naca="0012") + SWEEP.replace(", 0.0, 0.0]", ", 0.0]")),
    "flutter-wing": ("flutter", None),
    "bar-5": ("steps", BAR.format(through=5)),
    "bar-9": ("steps", BAR.format(through=9)),
    "count-wing": ("particles", WING),
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


def other(alula, folder, name):
    """What is told of another command, of steps or of particles, what it is, and whether that is near enough."""
    command, text = OTHERS[name]
    case = folder / f"{name}.toml"
    if text is None:
        subprocess.run([alula, "new", name, str(case)], check=True, capture_output=True, cwd=folder)
    else:
        case.write_text(text)
    call = lambda *words: subprocess.run([alula, *map(str, words), "--json"], capture_output=True, text=True)  # noqa: E731
    told = last(call("check", case).stdout, "check")
    if command == "particles":
        built = call("cloud", case, "--out", folder / name)
        taken = json.loads((folder / name / "doctor.json").read_text())["particles"] if not built.returncode else 0
        ratio = told["particles"] / max(taken, 1)
        return told["particles"], taken, abs(ratio - 1) <= COUNT
    if command == "steps":
        taken = last(call("run", case, "--out", folder / name).stdout, "summary")["steps"]
        told, more = told["structure"]["steps"] if "structure" in told else told["steps"], told.get("more_steps")
        return told, taken, told / FACTOR <= taken and (more or taken <= FACTOR * told)
    began = time.monotonic()
    call(command, case, "--out", folder / name)
    taken = time.monotonic() - began
    return told[command]["seconds"], taken, 1 / FACTOR <= told[command]["seconds"] / taken <= FACTOR


def main():
    alula = str(pathlib.Path(sys.argv[1]).resolve())
    missed = [0, 0]
    names = sys.argv[2:] or [*CASES, *OTHERS]
    print(f"{'case':18} {'particles':>9} {'MB told':>8} {'taken':>7} {'ratio':>6}   {'s told':>7} {'taken':>7} {'ratio':>6}", flush=True)
    with tempfile.TemporaryDirectory() as folder:
        for name in [name for name in names if name in OTHERS]:
            told, taken, near = other(alula, pathlib.Path(folder), name)
            missed[1] += not near
            print(f"{name:18} {OTHERS[name][0]:>9}: told {told:.5g}, taken {taken:.5g}, ratio {told / taken:.2f}", flush=True)
        for name in [name for name in names if name in CASES]:
            told, taken = told_and_taken(alula, pathlib.Path(folder), name, CASES[name])
            ends = [end for end in (told["cost"], told.get("least")) if end]
            card = (taken.get("grid_convergence") or {}).get("clouds", [])
            first = len(card) == 3 and told.get("least") is not None
            end = ends[-1] if first else ends[0]
            memory, pace = end["bytes"] / taken["peak_bytes"], end["seconds"] / taken["wall_seconds"]
            for i, (ratio, bound) in enumerate([(memory, MEMORY), (pace, TIME)]):
                missed[i] += not (1 - bound <= ratio <= 1 + bound)
            print(
                f"{name:18} {taken['particles']:9} {end['bytes'] / 1e6:8.0f} {taken['peak_bytes'] / 1e6:7.0f} {memory:6.2f}   "
                f"{end['seconds']:7.1f} {taken['wall_seconds']:7.1f} {pace:6.2f}",
                flush=True,
            )
    print(f"missed: memory {missed[0]}, time {missed[1]} of {len(names)}")


if __name__ == "__main__":
    main()
