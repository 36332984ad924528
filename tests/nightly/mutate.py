#!/usr/bin/env python3
"""Feeds mutated inputs to every parser of the command line tool, and keeps those that it does not survive.

    tests/nightly/mutate.py target/release/alula --count 10000 --seed 1

Case files (flow, solids, flutter, three dimensions), STL, OBJ and airfoil files, tables, mode shapes, forces of flutter, checkpoints
and whole folders of stopped runs are changed at random: bytes, numbers, lines, keys, files. Every input is accepted before it is
changed, or the script ends: what is refused at its first line tests nothing behind it. The checksums of checkpoints are computed
anew, so that the numbers behind them are reached; `forgery` changes a number in any file that a stopped or finished run keeps, with a
checksum of its own that is good, old or gone: it is refused by the name of the file, or has no effect. Each input is looked at by one thread within 2 GiB of address space and 20 s of processor time. A panic (exit code 101), an
abort (134 or a signal) or one that does not end is a failure, and so is a message with a number of hundreds of digits, or an exit code of 0
with numbers that are not finite or, after a forgery, with other results than those of the run that nobody touched. Its files are kept in the folder that the script
names, and the exit code is 1.
"""
import argparse
import csv
import json
import math
import pathlib
import random
import re
import resource
import shutil
import signal
import struct
import subprocess
import sys
import tempfile
import time
import zlib

import kill
from kill import BEAM, STREAM, results

MEMORY = 2 << 30
# of the processor; and of the clock, for what waits forever
SECONDS = 20
PATIENCE = 300
GOOD_CODES = {0, 1, 2, 130}

SMALL = '[cloud]\nspacing = 0.1\nfar_field = 3.0\n[time.steady]\niterations = 2\n[output]\ncheckpoint = 1\nreport = false\n'
SECTION = STREAM + '[[body]]\nnaca = "0012"\n' + SMALL
MARCH = STREAM.replace(' = "2 deg"', " = 0") + (
    '[motion]\nperiod = 4.0\nplunge = 0.1\n[[body]]\nnaca = "0012"\n[cloud]\nspacing = 0.1\nfar_field = 3.0\n'
    "[time.dual]\nsteps_per_period = 8\nperiods = 0.5\n[output]\ncheckpoint = 1\nreport = false\n")
LOOKED_AT = "[output]\ncheckpoint = 1\nreport = false\n"
TRAVEL = kill.TRAVELLING + "[cloud]\nspacing = 0.125\nfar_field = 3.0\n[time.explicit]\nuntil = 0.4\n" + LOOKED_AT
BALANCE = MARCH.replace("[time.dual]\nsteps_per_period = 8\nperiods = 0.5\n", "[time]\nharmonics = { number = 1, iterations = 3 }\n")
SWING = BEAM + "[time.newmark]\nstep = 1e-3\nuntil = 0.05\n" + LOOKED_AT
IMPACT = kill.IMPACT + kill.WALL + "until = 2e-4\n" + LOOKED_AT
SOLID_SPACE = BEAM.replace("[1.0, 0.2]", "[1.0, 0.25, 0.25]").replace("translate = [0.5, 0]", "translate = [0.5, 0, 0]").replace(
    "[0, -9.81]", "[0, -9.81, 0]").replace("[0, 1000]", "[0, 1000, 0]").replace("[1.0, 0.0]", "[1.0, 0.0, 0.0]").replace(
    '["x", "y"]', '["x", "y", "z"]').replace('history = "sin(100 * t)"\n', "") + "[time.modes]\nnumber = 2\n"
PANEL = kill.PANEL + "until = 4e-4\n" + LOOKED_AT
POLAR = SECTION.replace('"2 deg"', '"0:4:1 deg"').replace("iterations = 2", "orders = 3")
GAF = STREAM.replace(' = "2 deg"', " = 0") + '[[body]]\nnaca = "0012"\n' + SMALL.replace("iterations = 2", "orders = 2") + "[gaf]\nreduced_frequencies = [0.1, 0.3]\nmodes = \"plunge\"\n"
FLUTTER = STREAM.replace(' = "2 deg"', " = 0") + kill.FLUTTER + "[output]\nreport = false\n"
SPHERE = kill.SPHERE + SMALL.replace("0.1\n", "0.4\nlayers = 3\n").replace("3.0", "2.0")
STARTS = {"steady": SECTION, "march": MARCH, "travel": TRAVEL, "balance": BALANCE, "space": SPHERE, "polar": POLAR, "flutter": FLUTTER,
          "swing": SWING, "impact": IMPACT, "panel": PANEL}
# what a run has found already, and goes on with
RECORDS = {"polar": "checkpoint.alula", "flutter": "flutter-kept.json"}
WORDS = ["0", "-1", "1e308", "1e-308", "-1e308", "nan", "inf", "1e999", "0,5", "99999999999999999999", '""', '"m"', "[]", "{}",
         "true", '"1 mm"', '"300 K"', "1000", "2", "3", "1e9", "1e-9", "\u00e4", "\x00"]
# numbers that are far from any that is meant, and what they stand in the place of
EXTREMES = ["1e300", "-1e300", "1e-300", "1e20", "1e-20", "0", "1e9", "9" * 300]
TYPED = re.compile(r'(?<![\w.\-"#])-?\d+(?:\.\d+)?(?:e-?\d+)?(?![\w."])')
# a message with a number that nobody reads; the line of the file that it is about may have one
UNREADABLE = re.compile(r"^(?:error|hint|note|warning| *= hint): .*\d{41}", re.M)


def airfoil():
    xs = [0.5 * (1 + c) for c in (1, 0.9, 0.7, 0.4, 0.1, -0.2, -0.5, -0.75, -0.92, -1)]
    y = lambda x: 0.6 * (0.2969 * x**0.5 - 0.126 * x - 0.3516 * x**2 + 0.2843 * x**3 - 0.1036 * x**4)
    rows = [(x, y(x)) for x in xs] + [(x, -y(x)) for x in reversed(xs[:-1])]
    return "section\n" + "".join(f"{x:.6f} {y:.6f}\n" for x, y in rows)


def faces():
    corner = lambda k: tuple(float(k >> d & 1) for d in range(3))
    quads = [(0, 2, 3, 1), (4, 5, 7, 6), (0, 1, 5, 4), (2, 6, 7, 3), (0, 4, 6, 2), (1, 3, 7, 5)]
    return [tuple(map(corner, t)) for a, b, c, d in quads for t in ((a, b, c), (a, c, d))]


def stl_text():
    out = ["solid cube"]
    for t in faces():
        out.append(" facet normal 0 0 0\n  outer loop")
        out += [f"   vertex {x} {y} {z}" for x, y, z in t]
        out.append("  endloop\n endfacet")
    return "\n".join(out + ["endsolid cube\n"])


def stl_binary():
    body = b"".join(struct.pack("<12fH", 0, 0, 0, *(c for p in t for c in p), 0) for t in faces())
    return b"\0" * 80 + struct.pack("<I", len(faces())) + body


def obj():
    points = sorted({p for t in faces() for p in t})
    lines = [f"v {x} {y} {z}" for x, y, z in points]
    return "\n".join(lines + ["f " + " ".join(str(1 + points.index(p)) for p in t) for t in faces()]) + "\n"


def ply():
    points = sorted({p for t in faces() for p in t})
    head = f"ply\nformat ascii 1.0\nelement vertex {len(points)}\nproperty float x\nproperty float y\nproperty float z\n"
    head += f"element face {len(faces())}\nproperty list uchar int vertex_indices\nend_header\n"
    rows = [f"{x} {y} {z}" for x, y, z in points] + ["3 " + " ".join(str(points.index(p)) for p in t) for t in faces()]
    return head + "\n".join(rows) + "\n"


SPACE = "[flow]\nmach = 0.3\n[[body]]\nsurface = \"{}\"\n[cloud]\nspacing = 0.25\nfar_field = 2.0\n"
# few particles where the change cuts the cloud off
AIRCRAFT = """[accuracy]
particles = 20000
[flow]
mach = 0.5
[[body]]
revolution = [
[0, 0],
[0.3, 0.2],
[2, 0.3],
[4, 0.1]]
[[body]]
[body.wing]
naca = "64A010"
tip_naca = "0012"
span = 4
aspect_ratio = 5
taper = 0.4
sweep = "30 deg"
twist = "-2 deg"
[[body]]
ellipsoid = { size = [2, 0.8, 0.9] }
translate = [1, 0, 0.25]
[[body]]
wing = { airfoil = "a.dat", span = 1, chord = 0.6, dihedral = "90 deg", sides = "one", tip = "flat" }
translate = [3, 0, 0]
[cloud]
spacing = 0.4
far_field = 8.0
edge_levels = 0
curvature_levels = 0
"""
TABLE = "time,x,y,angle_deg\n" + "".join(f"{0.5 * k},0,{0.01 * (k % 3)},0\n" for k in range(7))
MODE = "x,y,dx,dy\n" + "".join(f"{0.1 * k},0,0,{0.001 * k * k}\n" for k in range(11))
PLAIN = MARCH.replace("plunge = 0.1", "{}").replace("period = 4.0\n", "")
# kind: names and contents of the files, the one that is changed; the command is `check`, or that of COMMANDS
INPUTS = {
    "case": ({"case.toml": SECTION}, "case.toml"),
    "moving case": ({"case.toml": MARCH}, "case.toml"),
    "airfoil": ({"case.toml": STREAM + '[[body]]\nairfoil = "a.dat"\n' + SMALL, "a.dat": airfoil()}, "a.dat"),
    "aircraft": ({"case.toml": AIRCRAFT, "a.dat": airfoil()}, "case.toml"),
    "fin": ({"case.toml": AIRCRAFT, "a.dat": airfoil()}, "a.dat"),
    "stl": ({"case.toml": SPACE.format("a.stl"), "a.stl": stl_text()}, "a.stl"),
    "binary stl": ({"case.toml": SPACE.format("a.stl"), "a.stl": stl_binary()}, "a.stl"),
    "obj": ({"case.toml": SPACE.format("a.obj"), "a.obj": obj()}, "a.obj"),
    "ply": ({"case.toml": SPACE.format("a.ply"), "a.ply": ply()}, "a.ply"),
    "table": ({"case.toml": PLAIN.format('pivot = [0.25, 0]\ntable = { file = "t.csv", periodic = true }'), "t.csv": TABLE}, "t.csv"),
    "mode": ({"case.toml": PLAIN.format('period = 4.0\nmode = [{ file = "m.csv", amplitude = 0.01 }]'), "m.csv": MODE}, "m.csv"),
    "solid": ({"case.toml": SWING}, "case.toml"),
    "impact": ({"case.toml": IMPACT}, "case.toml"),
    "solid in space": ({"case.toml": SOLID_SPACE}, "case.toml"),
    "solid in a gas": ({"case.toml": PANEL}, "case.toml"),
    "solid, run": ({"case.toml": SWING}, "case.toml"),
    "impact, run": ({"case.toml": IMPACT}, "case.toml"),
    "flutter": ({"case.toml": FLUTTER}, "case.toml"),
    "structure": ({"case.toml": FLUTTER}, "case.toml"),
    "forces": ({"case.toml": FLUTTER}, "forces.json"),
    "space": ({"case.toml": SPHERE}, "case.toml"),
    "space, run": ({"case.toml": SPHERE}, "case.toml"),
    "compare": ({"case.toml": SECTION + '[[compare]]\nfile = "c.csv"\n', "c.csv": "x_c,Cp\n0,1\n0.5,-0.3\n1,0.1\n"}, "c.csv"),
}
RUN = ["run", "case.toml", "--out", "run", "--quiet"]
READ_FORCES = ["flutter", "case.toml", "--forces", "forces.json", "--out", "run", "--quiet"]
COMMANDS = {"solid, run": RUN, "impact, run": RUN, "space, run": RUN, "structure": READ_FORCES, "forces": READ_FORCES}
# the checksum of a file of which a number is another: that of the new numbers, that of the old ones, none
SUMS = ("good", "old", "gone")
NUMBER = re.compile(rb"(?<![\w.])-?\d+(?:\.\d+)?(?:[eE][-+]?\d+)?(?![\w.])")
# columns that have a number in every row; others say NaN where there is nothing to tell
ALWAYS = {"cl", "cd", "cm", "residual", "speed", "frequency", "time", "kinetic", "strain", "work"}


def change_text(text, rng):
    """The text with a few random changes of a kind that people, programs and disks make."""
    lines = text.split("\n")
    for _ in range(rng.choice([1, 1, 1, 2, 3, 8])):
        k = rng.randrange(len(lines))
        line = lines[k]
        what = rng.randrange(12)
        if what == 0:
            del lines[k]
            lines = lines or [""]
        elif what == 1:
            lines.insert(rng.randrange(len(lines) + 1), line)
        elif what == 2 and "=" in line:
            lines[k] = line.split("=")[0] + "= " + rng.choice(WORDS)
        elif what == 3:
            parts = line.replace(",", " , ").split(" ")
            parts[rng.randrange(len(parts))] = rng.choice(WORDS)
            lines[k] = " ".join(parts).replace(" , ", ",")
        elif what == 4:
            at = rng.randrange(len(line) + 1)
            lines[k] = line[:at] + chr(rng.choice([0, 9, 13, 34, 39, 44, 91, 93, 123, 228, 8364, rng.randrange(32, 127)])) + line[at:]
        elif what == 5 and line:
            at = rng.randrange(len(line))
            lines[k] = line[:at] + line[at + 1:]
        elif what == 6:
            lines = lines[:k] + [line[:rng.randrange(len(line) + 1)]]
        elif what == 7:
            j = rng.randrange(len(lines))
            lines[k], lines[j] = lines[j], line
        elif what == 8:
            digits = [i for i, c in enumerate(line) if c.isdigit()]
            if digits:
                i = rng.choice(digits)
                lines[k] = line[:i] + rng.choice(["0", "9", "-", ".", "e", "e9", "e-9", "00000", ","]) + line[i + 1:]
        elif what == 9:
            typed = list(TYPED.finditer(line))
            if typed:
                number = rng.choice(typed)
                lines[k] = line[:number.start()] + rng.choice(EXTREMES) + line[number.end():]
        elif what == 10:
            lines[k:k] = [line] * rng.choice([2, 10, 1000])
        else:
            lines[k] = line.replace(".", ",")
    joined = rng.choice(["\n"] * 8 + ["\r\n", "\r"]).join(lines)
    code = rng.choice(["utf-8"] * 12 + ["utf-16", "latin-1"])
    return joined.encode(code, errors="replace")


def change_bytes(data, rng):
    data = bytearray(data)
    for _ in range(rng.choice([1, 2, 5, 50])):
        what = rng.randrange(4)
        at = rng.randrange(len(data) + 1) if data else 0
        if what == 0 and at < len(data):
            data[at] = rng.randrange(256)
        elif what == 1:
            del data[at:]
        elif what == 2:
            data[at:at] = bytes(rng.randrange(256) for _ in range(rng.randrange(60)))
        else:
            data[at:at + 4] = struct.pack("<f", rng.choice([float("nan"), float("inf"), 1e38, -1e38, 1e-40, 0, 1000]))
    return bytes(data)


def read_checkpoint(data):
    size = struct.unpack("<Q", data[12:20])[0]
    return json.loads(data[24:24 + size]), data[24 + size:]


def write_checkpoint(data, header, body):
    """The file with a header whose checksum is right."""
    text = json.dumps(header).encode()
    size = struct.pack("<Q", len(text))
    crc = zlib.crc32(data[8:12] + size + text)
    return data[:12] + size + struct.pack("<I", crc) + text + body


def change_tree(value, rng):
    """A number, list or key somewhere in `value` is another one."""
    if isinstance(value, dict) and value:
        key = rng.choice(sorted(value))
        if rng.random() < 0.05:
            return {k: v for k, v in value.items() if k != key}
        return {**value, key: change_tree(value[key], rng)}
    if isinstance(value, list) and value and rng.random() < 0.8:
        k = rng.randrange(len(value))
        return rng.choice([value[:k], value + [value[k]], value[:k] + [change_tree(value[k], rng)] + value[k + 1:]])
    if isinstance(value, bool):
        return not value
    if isinstance(value, (int, float)):
        bits = [0x7FF8 << 48, 0x7FF0 << 48, 0xFFF0 << 48, 0x7FE0 << 48, 1]
        return rng.choice([0, 1, 2, 7, 255, 1 << 16, (1 << 32) - 1, (1 << 64) - 1, value + 1, value * 2] + bits)
    return rng.choice([None, "x", [], {}, 0])


def change_checkpoint(data, rng):
    header, body = read_checkpoint(data)
    if rng.random() < 0.5:
        part = rng.choice(["meta", "meta", "meta", "fields"])
        return write_checkpoint(data, {**header, part: change_tree(header[part], rng)}, body)
    # numbers of a field, stored as they are
    k = rng.randrange(len(header["fields"]))
    blocks = [body[f["offset"]:f["offset"] + f["stored"]] for f in header["fields"]]
    field, block = header["fields"][k], bytearray(blocks[k])
    if field["encoding"] == "raw" and block and rng.random() < 0.8:
        for _ in range(rng.choice([1, 3, 100])):
            at = 8 * rng.randrange(len(block) // 8)
            block[at:at + 8] = struct.pack("<d", rng.choice([float("nan"), float("inf"), -1, 0, 1e300, 1e-300]))
    else:
        values = [rng.choice([0.0, 1.0, float("nan"), 1e300]) for _ in range(rng.choice([0, 1, 2, 5, 1000]))]
        block = bytearray(struct.pack(f"<{len(values)}d", *values))
        field.update(encoding="raw", shape=[len(values)])
    blocks[k] = bytes(block)
    offset = 0
    for f, b in zip(header["fields"], blocks):
        f.update(offset=offset, stored=len(b), crc32=zlib.crc32(b))
        offset += len(b)
    return write_checkpoint(data, header, b"".join(blocks))


def change_folder(run, others, rng):
    """A file of a stopped run is lost, cut, spoilt, or that of another run; what was done."""
    files = sorted(f for f in run.iterdir() if f.is_file())
    file = rng.choice(files + [f for f in files if f.suffix in (".alula", ".previous", ".json", ".toml")] * 2)
    what = rng.choice(["lost", "empty", "cut", "bytes", "text", "foreign", "a folder"])
    data = file.read_bytes()
    file.unlink()
    if what == "empty":
        file.write_bytes(b"")
    elif what == "cut":
        file.write_bytes(data[:rng.randrange(len(data) + 1)])
    elif what == "bytes":
        file.write_bytes(change_bytes(data, rng))
    elif what == "text":
        file.write_bytes(change_text(data.decode(errors="replace"), rng))
    elif what == "foreign":
        found = [f for f in sorted(others.glob(f"*/run/{file.name}")) if f.read_bytes() != data]
        file.write_bytes(rng.choice(found).read_bytes() if found else b"x")
    elif what == "a folder":
        file.mkdir()
    return f"{file.name} {what}"


def records(run):
    """Files of numbers that a run keeps, and that nobody is to change."""
    found = [f for f in run.iterdir() if f.suffix in (".csv", ".json", ".alula") or f.name == "cloud.toml"]
    return sorted(f for f in found if f.suffix == ".alula" or NUMBER.search(f.read_bytes()))


def another_number(data, rng, pattern=NUMBER):
    """The bytes with another number at one place."""
    chosen = rng.choice(list(pattern.finditer(data)))
    old = float(chosen.group())
    other = rng.choice([o for o in (b"7.5", b"3", b"0.5", b"1e9", b"-2") if float(o) != old])
    return data[:chosen.start()] + other + data[chosen.end():]


def forge(run, rng, file=None, how=None):
    """One number of a file that the run keeps is another; its own checksum is that of the new numbers, that of the old ones, or gone. What was done,
    and the names of which one must be told."""
    file = file or rng.choice(records(run))
    how = how or rng.choice(SUMS)
    data, names = file.read_bytes(), [file.name]
    if file.suffix == ".alula":
        header, body = read_checkpoint(data)
        meta = json.dumps(header["meta"]).encode()
        forged = {**header, "meta": json.loads(another_number(meta, rng, re.compile(rb"(?<=[:\[, ])-?\d+(?:\.\d+)?(?=[,\]}])")))}
        file.write_bytes(write_checkpoint(data, forged, body) if how == "good" else another_number(data[:24] + json.dumps(forged).encode(), rng) + body)
        file.with_name(file.name + ".previous").unlink(missing_ok=True)
    elif file.name == "flutter-kept.json":
        file.write_bytes(summed(another_number(data, rng), how))
    else:
        file.write_bytes(another_number(data, rng))
    if how == "gone":
        (run / "checksums.txt").unlink()
        names.append("checksums.txt")
    return f"{file.name} ({how} checksum)", names


def summed(data, how):
    """What is kept of a flutter boundary, with the checksum of its numbers or without one."""
    start = data.index(b'"finished": ') + 12
    if how == "gone":
        return re.sub(rb'"crc32": \d+,\s*', b"", data)
    if how == "old":
        return data
    strings = re.split(rb'("(?:[^"\\]|\\.)*")', data[start:data.rindex(b"}")])
    compact = b"".join(part if k % 2 else re.sub(rb"\s", b"", part) for k, part in enumerate(strings))
    return re.sub(rb'"crc32": \d+', b'"crc32": %d' % zlib.crc32(compact), data)


def limited():
    resource.setrlimit(resource.RLIMIT_AS, (MEMORY, MEMORY))
    resource.setrlimit(resource.RLIMIT_CPU, (SECONDS, SECONDS + 1))


def alula(program, args, folder):
    """Exit code, or why there is none, and what was said."""
    command = [program, *args, "--threads", "1"]
    try:
        done = subprocess.run(command, cwd=folder, capture_output=True, timeout=PATIENCE, preexec_fn=limited, stdin=subprocess.DEVNULL)
    except subprocess.TimeoutExpired as slow:
        return "waits", (slow.stderr or b"").decode(errors="replace")
    code = "timeout" if done.returncode in (-signal.SIGXCPU, -signal.SIGKILL) else done.returncode
    return code, done.stderr.decode(errors="replace")


def stopped(program, name, case, folder):
    """A run that has something to go on with: stopped on its way, or without the mark of its end."""
    folder.mkdir(parents=True)
    (folder / "case.toml").write_text(case)
    command = "flutter" if name == "flutter" else "run"
    process = subprocess.Popen([program, command, "case.toml", "--out", "run", "--quiet", "--threads", "1"], cwd=folder,
                               stdout=subprocess.DEVNULL, stderr=subprocess.PIPE)
    record = folder / "run" / RECORDS.get(name, "checkpoint.alula")
    while name in RECORDS and process.poll() is None and not (record.exists() and points(record) > 0):
        time.sleep(0.005)
    if name in RECORDS:
        process.send_signal(signal.SIGINT)
    told = process.communicate(timeout=PATIENCE)[1].decode(errors="replace")
    if not record.exists():
        sys.exit(f"error: the run `{name}` left no {record.name} (exit code {process.returncode}): {told}")
    (folder / "run" / "finished.txt").unlink(missing_ok=True)


def points(record):
    """Number of points that a polar or a flutter boundary has finished."""
    try:
        if record.suffix == ".json":
            return len(json.loads(record.read_text())["finished"])
        return len(read_checkpoint(record.read_bytes())[0]["meta"]["polar"]["record"]["points"])
    except (OSError, ValueError, KeyError, TypeError, struct.error):
        return 0


def prepare(program, home):
    """Stopped runs, what they end with where nobody touches them, and a file of forces; every input is accepted as it is."""
    whole = {}
    for name, case in STARTS.items():
        stopped(program, name, case, home / name)
        folder = home / "whole" / name
        shutil.copytree(home / name, folder)
        code, told = alula(program, ["resume", "run", "--quiet"], folder)
        if code not in (0, 1):
            sys.exit(f"error: the run `{name}` does not go on (exit code {code}): {told}")
        whole[name] = results(folder / "run")
    gaf = home / "whole" / "gaf"
    gaf.mkdir()
    (gaf / "case.toml").write_text(GAF)
    code, told = alula(program, ["gaf", "case.toml", "--out", "run", "--quiet"], gaf)
    if code not in (0, 1):
        sys.exit(f"error: the run `gaf` fails (exit code {code}): {told}")
    INPUTS["structure"][0]["forces.json"] = INPUTS["forces"][0]["forces.json"] = (
        home / "whole" / "flutter" / "run" / "flutter.json").read_text()
    for kind, (files, _) in INPUTS.items():
        place = home / "bases" / kind
        place.mkdir(parents=True)
        for name, content in files.items():
            (place / name).write_bytes(content if isinstance(content, bytes) else content.encode())
        code, told = alula(program, COMMANDS.get(kind, ["check", "case.toml"]), place)
        if code != 0 and not (code == 1 and kind in COMMANDS):
            sys.exit(f"error: the input `{kind}` is refused as it is (exit code {code}): {told}")
    return whole


def wrong_numbers(run, expected=None):
    """What results say that cannot be, where a run ended well."""
    for file in sorted(run.glob("*.csv")):
        with file.open(newline="") as text:
            for row in csv.DictReader(text):
                bad = [name for name in ALWAYS & row.keys() if not math.isfinite(float(row[name] or "nan"))]
                if bad:
                    return f"{', '.join(sorted(bad))} in {file.name} not finite"
    if (run / "summary.json").exists():
        loads = json.loads((run / "summary.json").read_text()).get("loads") or {}
        if not all(isinstance(v, (int, float)) and math.isfinite(v) for v in loads.values()):
            return "loads in summary.json not finite"
    found = results(run) if expected is not None else None
    differing = [] if found is None else sorted(n for n in expected.keys() & found.keys() if expected[n] != found[n])
    return f"believed: {', '.join(differing[:5])}" if differing else None


def one(program, runs, whole, place, rng, kinds):
    """Makes one input in `place`; kind, and how the program ended."""
    kind = rng.choice(kinds)
    if kind == "forgery":
        return forgery(program, runs, whole, place, rng)
    if kind in ("checkpoint", "folder"):
        start = rng.choice(sorted(set(STARTS) - ({"flutter"} if kind == "checkpoint" else set())))
        shutil.copytree(runs / start, place, dirs_exist_ok=True)
        run = place / "run"
        if kind == "checkpoint":
            file, what = run / "checkpoint.alula", ""
            file.write_bytes(change_checkpoint(file.read_bytes(), rng))
            (run / "checkpoint.alula.previous").unlink(missing_ok=True)
        else:
            what = change_folder(run, runs, rng)
        code, told = alula(program, ["resume", "run", "--quiet"], place)
        wrong = wrong_numbers(run) if code == 0 else None
        return f"{kind} of {start} {what}", (wrong or code, told)
    files, changed = INPUTS[kind]
    for name, content in files.items():
        data = content if isinstance(content, bytes) else content.encode()
        if name == changed:
            data = change_bytes(data, rng) if isinstance(content, bytes) else change_text(content, rng)
        (place / name).write_bytes(data)
    code, told = alula(program, COMMANDS.get(kind, ["check", "case.toml"]), place)
    wrong = wrong_numbers(place / "run") if code == 0 and kind in COMMANDS else None
    return kind, (wrong or code, told)


def forgery(program, runs, whole, place, rng, start=None, file=None, how=None):
    """A number of a stopped or finished run is another; whether it is refused by the name of its file, or not believed."""
    start = start or rng.choice(sorted(STARTS) + [f"whole/{name}" for name in sorted(STARTS) + ["gaf"]])
    shutil.copytree(runs / start, place, dirs_exist_ok=True)
    run = place / "run"
    what, names = forge(run, rng, file and run / file, how)
    code, told = alula(program, ["resume", "run", "--quiet"], place)
    wrong = None
    if code == 0 and start in whole:
        wrong = wrong_numbers(run, whole[start])
    elif code == 0:
        wrong = "believed"
    elif code in GOOD_CODES and not any(name in told for name in names):
        wrong = "refused without the name of the file"
    return f"forgery of {start} {what}", (wrong or code, told)


def every_forgery(program, home, whole):
    """Forges each file of each kind of run, with each kind of checksum; the number of those refused and not survived."""
    refused = untouched = bad = 0
    for start in [*sorted(STARTS), *(f"whole/{name}" for name in sorted(STARTS) + ["gaf"])]:
        for file in records(home / "runs" / start / "run"):
            for how in SUMS:
                place = home / "forgery"
                kind, (code, told) = forgery(program, home / "runs", whole, place, random.Random(f"{start} {file.name} {how}"), start, file.name, how)
                shutil.rmtree(place)
                if code in GOOD_CODES:
                    refused, untouched = refused + (code != 0), untouched + (code == 0)
                    continue
                bad += 1
                print(f"{kind}: {code}: {next((l for l in told.splitlines() if l.strip()), '')[:200]}", flush=True)
    print(f"{refused + untouched + bad} forgeries of every file: {refused} refused by name, {untouched} without effect, {bad} not survived")
    return bad


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("alula")
    parser.add_argument("--count", type=int, default=10_000)
    parser.add_argument("--seed", type=int, default=1)
    kinds = sorted(INPUTS) + ["checkpoint", "folder", "forgery"]
    parser.add_argument("--only", choices=kinds, help="mutate inputs of this kind alone")
    parser.add_argument("--without", choices=kinds, nargs="*", default=[], help="leave these kinds out")
    parser.add_argument("--every-forgery", action="store_true", help="forge each file of each kind of run first")
    args = parser.parse_args()
    program = str(pathlib.Path(args.alula).resolve())
    home = pathlib.Path(tempfile.mkdtemp(prefix="alula-mutate-"))
    whole = prepare(program, home / "runs")
    chosen = [args.only] if args.only else sorted(INPUTS) + ["checkpoint"] * 4 + ["folder"] * 4 + ["forgery"] * 2
    chosen = [kind for kind in chosen if kind not in args.without]
    bad, codes = every_forgery(program, home, whole) if args.every_forgery else 0, {}
    for k in range(args.count):
        place = home / f"{args.seed}-{k}"
        place.mkdir()
        kind, (code, told) = one(program, home / "runs", whole, place, random.Random(f"{args.seed} {k}"), chosen)
        codes[code] = codes.get(code, 0) + 1
        if code in GOOD_CODES and UNREADABLE.search(told):
            code = "a number of hundreds of digits"
        if code in GOOD_CODES:
            shutil.rmtree(place)
            continue
        bad += 1
        first = next((l for l in told.splitlines() if l.strip()), "")
        how = f"exit code {code}" if isinstance(code, int) else code
        print(f"{kind}: {how} in {place}: {first[:200]}", flush=True)
    print(f"{args.count} inputs, exit codes {dict(sorted(codes.items(), key=str))}: {bad} not survived")
    if bad == 0:
        shutil.rmtree(home)
    sys.exit(1 if bad else 0)


if __name__ == "__main__":
    main()
