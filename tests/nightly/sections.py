#!/usr/bin/env python3
"""Reads the sections of a public database, and sections written in twenty odd ways beside their clean twins.

    tests/nightly/sections.py target/release/alula            # all; downloads one wheel from the package index
    tests/nightly/sections.py target/release/alula --twins    # the twins alone, without a download and without runs

The database is `airfoil_database` in the Python package `aerosandbox` 4.2, of which the wheel alone is taken. `alula geometry` writes the
outline of each of its 2,174 files; area and extents are held against those of the rows of two numbers in the file, read independently. At
most ten files may be refused, each with its reason; one whose shape is another one is a failure. Twins have the same points: area, chord and
thickness must agree, and the loads of some of them in a small flow. The exit code is 1 where something fails.
"""
import argparse
import concurrent.futures
import json
import math
import os
import pathlib
import re
import subprocess
import sys
import tempfile
import zipfile

REFUSED = 10
# a spline bulges beyond the polygon of coarse points: of thirty points on a thick nose by this part of area and chord
AREA, EXTENT = 0.03, 0.01
RUNS = {"percent of chord", "both sides from the trailing edge", "first point not repeated"}
FLOW = '[flow]\nmach = 0.5\nalpha = "2 deg"\n[[body]]\nairfoil = {}\n[cloud]\nspacing = 0.03125\nfar_field = 8.0\n[output]\nreport = false\n'


def geometry(alula, file, place):
    """What `alula geometry` tells of a section: area, corners of the box around it, notes; or why it is refused."""
    case, out = place / "case.toml", place / "out.dat"
    place.mkdir(parents=True, exist_ok=True)
    case.write_text(FLOW.format(json.dumps(str(file))), encoding="utf-8")
    done = subprocess.run([alula, "geometry", case, "--out", out, "--force"], capture_output=True, text=True, errors="replace")
    if done.returncode:
        return None, done.stderr.strip()
    area = float(re.search(r"^area +([-.\de]+)", done.stdout, re.M)[1])
    box = [float(x) for x in re.search(r"from \((.*)\) to \((.*)\)$", done.stdout, re.M).expand(r"\1, \2").split(", ")]
    return (area, box), done.stderr


def rows(file):
    """The rows of two numbers of a file."""
    found = []
    for line in file.read_text(errors="replace").splitlines():
        words = [w for w in re.split(r"[;,\s]+", line) if w]
        try:
            found += [[float(w) for w in words]] if len(words) == 2 else []
        except ValueError:
            pass
    return found


def shoelace(points):
    return 0.5 * abs(sum(a[0] * b[1] - b[0] * a[1] for a, b in zip(points, points[1:] + points[:1])))


def misread(file, told):
    area, box = told
    points = rows(file)
    x, y = zip(*points)
    expected = [min(x), min(y), max(x), max(y)]
    wrong = []
    if abs(area / shoelace(points) - 1) > AREA:
        wrong.append(f"area {area:.5f}, of its rows {shoelace(points):.5f}")
    wrong += [f"extent {a:.5f}, of its rows {b:.5f}" for a, b in zip(box, expected) if abs(a - b) > EXTENT * (max(x) - min(x))]
    return wrong


def database(alula, home):
    command = [sys.executable, "-m", "pip", "download", "--quiet", "--no-deps", "--disable-pip-version-check", "-d", home, "aerosandbox==4.2.*"]
    subprocess.run(command, check=True)
    (wheel,) = home.glob("aerosandbox-4.2*.whl")
    with zipfile.ZipFile(wheel) as whole:
        names = [n for n in whole.namelist() if "/airfoil_database/" in n and n.endswith(".dat")]
        whole.extractall(home / "wheel", names)
    files = sorted(home.glob("wheel/**/*.dat"))
    with concurrent.futures.ThreadPoolExecutor(os.cpu_count()) as pool:
        told = list(pool.map(lambda kf: geometry(alula, kf[1], home / f"case-{kf[0]}"), enumerate(files)))
    refused = [(f, why) for f, (t, why) in zip(files, told) if t is None]
    wrong = [(f, misread(f, t)) for f, (t, _) in zip(files, told) if t is not None]
    wrong = [(f, w) for f, w in wrong if w]
    for file, why in refused:
        print(f"refused {file.name}: {why.splitlines()[0] if why else 'without a word'}")
    for file, what in wrong:
        print(f"misread {file.name}: {'; '.join(what)}")
    print(f"{len(files)} sections of the database, {len(refused)} refused (at most {REFUSED}), {len(wrong)} misread")
    return len(files) > 2000 and len(refused) <= REFUSED and not wrong


def section(n=40, thickness=0.12, camber=0.04):
    """Points of a cambered section with a sharp trailing edge, six digits: upper side from the rear to the nose, lower side back."""
    def side(sign):
        for k in range(n + 1):
            x = 0.5 * (1 + math.cos(math.pi * k / n))
            half = 5 * thickness * (0.2969 * x**0.5 - 0.126 * x - 0.3516 * x**2 + 0.2843 * x**3 - 0.1036 * x**4)
            yield round(x, 6), round(4 * camber * x * (1 - x) + sign * half, 6) + 0.0
    upper, lower = list(side(1)), list(side(-1))
    return upper, lower[::-1]


def text(points, form="{:.6f} {:.6f}\n"):
    return "".join(form.format(*p) for p in points)


def odd_ones():
    """Name and text of files with the points of `section`, written otherwise than a clean one."""
    upper, lower = section()
    ring = upper + lower[1:]
    clean, nose = text(ring), upper[::-1]
    pairs = list(zip(nose, lower))
    turned = ring[20:-1] + ring[:21]
    return {
        "text after the points": f"t\n{clean}\nReference: somebody 1998\n12 May\n",
        "text among the points": f"t\n{text(upper)}Lower side\n{text(lower[1:])}",
        "limits of a grid": f"MYFOIL\n -1.75 2.75 -2.0 2.5\n{clean}",
        "title of two numbers": f"2412 10\n{clean}",
        "title of one number": f"2412\n{clean}",
        "three lines of title": f"t\nfrom a book\npage 3 of it, 1998\n{clean}",
        "first point not repeated": "t\n" + text(ring[:-1]),
        "both sides from the trailing edge": "t\n" + text(upper) + text(lower[::-1]),
        "Lednicer": f"t\n 41. 41.\n\n{text(nose)}\n{text(lower)}",
        "Lednicer without counts": f"t\n{text(nose)}\n{text(lower)}",
        "Lednicer with other counts": f"t\n 40 40\n{text(nose)}{text(lower)}",
        "clockwise": "t\n" + text(ring[::-1]),
        "once around from the nose": "t\n" + text(nose + lower[::-1][1:]),
        "once around from the middle": "t\n" + text(turned),
        "percent of chord": "t\n" + text([(100 * x, 100 * y) for x, y in ring], "{:.4f} {:.4f}\n").replace("100.0000 0.0000", "100 0"),
        "percent of chord, first point of whole numbers":
            "t\n" + text([(100 * x, 100 * y + 7) for x, y in ring], "{:.4f} {:.4f}\n").replace("100.0000 7.0000", "100 7"),
        "gap of the last digit": "t\n" + clean.replace("1.000000", "1.000009", 1),
        "numbered rows": "t\n" + "".join(f"{k} {x:.6f} {y:.6f}\n" for k, (x, y) in enumerate(ring, 1)),
        "points of a plane in space": "t\n" + text([(x, y, 0) for x, y in ring], "{:.6f} {:.6f} {:.1f}\n"),
        "both sides in a row": "".join(f"{u[0]:.6f} {u[1]:.6f} {l[1]:.6f}\n" for u, l in pairs),
        "table with a header": "x,y_upper,y_lower\n" + "".join(f"{u[0]:.6f},{u[1]:.6f},{l[1]:.6f}\n" for u, l in pairs),
        "commas, tabs and lines of another system": ("t\n" + clean.replace(" ", ",\t")).replace("\n", "\r\n"),
        "exponents of Fortran": "t\n" + text(ring, "{:.6E} {:.6E}\n").replace("E", "D"),
    }


def loads(alula, file, place):
    case = place / "run.toml"
    case.write_text(FLOW.format(json.dumps(str(file))))
    done = subprocess.run([alula, "run", case, "--out", place / "run", "--quiet"], capture_output=True, text=True)
    if done.returncode not in (0, 1) or not (place / "run" / "summary.json").exists():
        sys.exit(f"error: {file} does not run: {done.stderr}")
    summary = json.loads((place / "run" / "summary.json").read_text())
    return {k: summary["loads"][k] for k in ("cl", "cd", "cm")}


def twins(alula, home, with_runs):
    upper, lower = section()
    good = True
    (home / "clean.dat").write_text("clean\n" + text(upper + lower[1:]))
    (area, box), _ = geometry(alula, home / "clean.dat", home / "clean")
    clean_loads = loads(alula, home / "clean.dat", home / "clean") if with_runs else None
    for k, (name, content) in enumerate(odd_ones().items()):
        file = home / f"odd-{k}.dat"
        file.write_bytes(content.encode())
        told, said = geometry(alula, file, home / f"odd-{k}")
        if told is None:
            print(f"{name}: refused: {said}")
            good = False
            continue
        chord, height = told[1][2] - told[1][0], told[1][3] - told[1][1]
        differs = [abs(told[0] / area - 1), abs(chord / (box[2] - box[0]) - 1), abs(height / (box[3] - box[1]) - 1)]
        fine = max(differs) < 1e-4
        if with_runs and name in RUNS:
            found = loads(alula, file, home / f"odd-{k}")
            differs += [abs(found[c] - clean_loads[c]) for c in found]
            fine = fine and found.keys() == clean_loads.keys() and len(found) > 1 and max(differs) < 2e-4
        if not fine:
            print(f"{name}: area, chord, thickness and loads differ by {differs}")
            good = False
    print(f"{len(odd_ones())} odd sections beside their clean twins: {'all the same' if good else 'NOT all the same'}")
    return good


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("alula")
    parser.add_argument("--twins", action="store_true", help="the twins alone, without a download and without runs")
    args = parser.parse_args()
    alula = str(pathlib.Path(args.alula).resolve())
    with tempfile.TemporaryDirectory() as folder:
        home = pathlib.Path(folder)
        good = twins(alula, home, not args.twins)
        if not args.twins:
            good = database(alula, home) and good
    sys.exit(0 if good else 1)


if __name__ == "__main__":
    main()
