#!/usr/bin/env python3
"""Feeds mutated inputs to every parser of the command line tool, and keeps those that it does not survive.

    tests/nightly/mutate.py target/release/alula --count 10000 --seed 1

Case files, STL, OBJ and airfoil files, tables, mode shapes and checkpoints are changed at random: bytes, numbers, lines, keys.
The checksums of checkpoints are computed anew, so that the numbers behind them are reached. Each input is looked at within 2 GiB
of address space and 20 s. A panic (exit code 101), an abort (134 or a signal) or a timeout is a failure; its files are kept in
the folder that the script names, and the exit code is 1.
"""
import argparse
import json
import pathlib
import random
import resource
import shutil
import struct
import subprocess
import sys
import tempfile
import zlib

MEMORY = 2 << 30
SECONDS = 20
GOOD_CODES = {0, 1, 2, 130}

STREAM = '[flow]\nmach = 0.5\nalpha = "2 deg"\n'
SMALL = '[cloud]\nspacing = 0.1\nfar_field = 3.0\n[time.steady]\niterations = 2\n[output]\ncheckpoint = 1\nreport = false\n'
SECTION = STREAM + '[[body]]\nnaca = "0012"\n' + SMALL
MARCH = STREAM.replace(' = "2 deg"', " = 0") + (
    '[motion]\nperiod = 4.0\nplunge = 0.1\n[[body]]\nnaca = "0012"\n[cloud]\nspacing = 0.1\nfar_field = 3.0\n'
    "[time.dual]\nsteps_per_period = 8\nperiods = 0.5\n[output]\ncheckpoint = 1\nreport = false\n")
TRAVEL = ('[flow]\nmach = 0.3\n[motion]\nparticles = "lagrangian"\nperiod = 4.0\nplunge = 0.1\n[[body]]\n'
          "circle = { radius = 0.5 }\n[cloud]\nspacing = 0.125\nfar_field = 3.0\n[time.explicit]\nuntil = 0.4\n"
          "[output]\ncheckpoint = 1\nreport = false\n")
BALANCE = MARCH.replace("[time.dual]\nsteps_per_period = 8\nperiods = 0.5\n", "[time]\nharmonics = { number = 1, iterations = 3 }\n")
STARTS = {"steady": SECTION, "march": MARCH, "travel": TRAVEL, "balance": BALANCE}
WORDS = ["0", "-1", "1e308", "1e-308", "-1e308", "nan", "inf", "1e999", "0,5", "99999999999999999999", '""', '"m"', "[]", "{}",
         "true", '"1 mm"', '"300 K"', "1000", "2", "3", "1e9", "1e-9", "\u00e4", "\x00"]


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
TABLE = "t,x,y,theta\n" + "".join(f"{0.5 * k},0,{0.01 * (k % 3)},0\n" for k in range(8))
MODE = "x,y,dx,dy\n" + "".join(f"{0.1 * k},0,0,{0.001 * k * k}\n" for k in range(11))
PLAIN = MARCH.replace("plunge = 0.1", "{}").replace("period = 4.0\n", "")
# kind: names and contents of the files, the one that is changed, the command
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
    "table": ({"case.toml": PLAIN.format('period = 4.0\ntable = { file = "t.csv" }'), "t.csv": TABLE}, "t.csv"),
    "mode": ({"case.toml": PLAIN.format('period = 4.0\nmode = [{ file = "m.csv", amplitude = 0.01 }]'), "m.csv": MODE}, "m.csv"),
    "compare": ({"case.toml": SECTION + '[[compare]]\nfile = "c.csv"\n', "c.csv": "x_c,Cp\n0,1\n0.5,-0.3\n1,0.1\n"}, "c.csv"),
}


def change_text(text, rng):
    """The text with a few random changes of a kind that people, programs and disks make."""
    lines = text.split("\n")
    for _ in range(rng.choice([1, 1, 1, 2, 3, 8])):
        k = rng.randrange(len(lines))
        line = lines[k]
        what = rng.randrange(11)
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


def limited():
    resource.setrlimit(resource.RLIMIT_AS, (MEMORY, MEMORY))


def alula(program, args, folder):
    """Exit code, or why there is none, and what was said."""
    command = [program, *args]
    try:
        done = subprocess.run(command, cwd=folder, capture_output=True, timeout=SECONDS, preexec_fn=limited)
    except subprocess.TimeoutExpired as slow:
        return "timeout", (slow.stderr or b"").decode(errors="replace")
    return done.returncode, done.stderr.decode(errors="replace")


def prepare_runs(program, home):
    """A run with a checkpoint for each kind of study, stopped before its end."""
    for name, case in STARTS.items():
        folder = home / name
        folder.mkdir(parents=True)
        (folder / "case.toml").write_text(case)
        code, told = alula(program, ["run", "case.toml", "--out", "run", "--quiet", "--threads", "1"], folder)
        if not (folder / "run" / "checkpoint.alula").exists():
            sys.exit(f"error: the run `{name}` wrote no checkpoint (exit code {code}): {told}")
        (folder / "run" / "finished.txt").unlink(missing_ok=True)


def one(program, runs, place, rng, only=None):
    """Makes one input in `place`; kind, and how the program ended."""
    kind = only or rng.choice(sorted(INPUTS) + ["checkpoint"] * 3)
    if kind == "checkpoint":
        start = rng.choice(sorted(STARTS))
        shutil.copytree(runs / start, place, dirs_exist_ok=True)
        file = place / "run" / "checkpoint.alula"
        file.write_bytes(change_checkpoint(file.read_bytes(), rng))
        return f"checkpoint of {start}", alula(program, ["resume", "run", "--quiet", "--threads", "1"], place)
    files, changed = INPUTS[kind]
    for name, content in files.items():
        data = content if isinstance(content, bytes) else content.encode()
        if name == changed:
            data = change_bytes(data, rng) if isinstance(content, bytes) else change_text(content, rng)
        (place / name).write_bytes(data)
    return kind, alula(program, ["check", "case.toml"], place)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("alula")
    parser.add_argument("--count", type=int, default=10_000)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--only", choices=sorted(INPUTS), help="mutate inputs of this kind alone")
    args = parser.parse_args()
    program = str(pathlib.Path(args.alula).resolve())
    home = pathlib.Path(tempfile.mkdtemp(prefix="alula-mutate-"))
    prepare_runs(program, home / "runs")
    bad, codes = 0, {}
    for k in range(args.count):
        place = home / f"{args.seed}-{k}"
        place.mkdir()
        kind, (code, told) = one(program, home / "runs", place, random.Random(f"{args.seed} {k}"), args.only)
        codes[code] = codes.get(code, 0) + 1
        if code in GOOD_CODES:
            shutil.rmtree(place)
            continue
        bad += 1
        first = next((l for l in told.splitlines() if l.strip()), "")
        print(f"{kind}: exit code {code} in {place}: {first[:200]}", flush=True)
    print(f"{args.count} inputs, exit codes {dict(sorted(codes.items(), key=str))}: {bad} not survived")
    if bad == 0:
        shutil.rmtree(home)
    sys.exit(1 if bad else 0)


if __name__ == "__main__":
    main()
