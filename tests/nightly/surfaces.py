#!/usr/bin/env python3
"""Feeds some forty small surfaces to `alula geometry`: each way in which files differ from their formats, in each format.

    tests/nightly/surfaces.py target/release/alula            # needs trimesh and numpy
    tests/nightly/surfaces.py target/release/alula --plain    # without them: volume and area by the sum over triangles

A surface is read right, or repaired with a note, or refused with the true reason and its place: the line of a text, the number of a
triangle of a binary file. Volume and area of those that are read must be those that the independent library `trimesh` finds for the clean
surface. The exit code is 1 where one is not.
"""
import argparse
import math
import pathlib
import re
import struct
import subprocess
import sys
import tempfile

SPACE = '[flow]\nmach = 0.3\n[[body]]\nsurface = "{}"\n[cloud]\nspacing = 0.25\nfar_field = 2.0\n'


def box(size=(1.0, 1.0, 1.0), at=(0.0, 0.0, 0.0)):
    corner = lambda k: tuple(at[d] + size[d] * (k >> d & 1) for d in range(3))
    quads = [(0, 2, 3, 1), (4, 5, 7, 6), (0, 1, 5, 4), (2, 6, 7, 3), (0, 4, 6, 2), (1, 3, 7, 5)]
    return [[corner(k) for k in q] for q in quads]


def star(height=1.0):
    """A prism over a star: faces of ten corners that are not convex."""
    rim = [((1.0 if k % 2 == 0 else 0.4) * math.cos(math.pi * k / 5), (1.0 if k % 2 == 0 else 0.4) * math.sin(math.pi * k / 5)) for k in range(10)]
    low, high = [(x, y, 0.0) for x, y in rim], [(x, y, height) for x, y in rim]
    return [low[::-1], high] + [[low[k - 1], low[k], high[k], high[k - 1]] for k in range(10)]


def wing(n=24, stations=6, root=True):
    """A rectangular wing with a cambered section, its ends closed by one face each; without `root` the face at y = 0 is missing."""
    def point(k, sign):
        x = 0.5 * (1 + math.cos(math.pi * k / n))
        half = 0.6 * (0.2969 * x**0.5 - 0.126 * x - 0.3516 * x**2 + 0.2843 * x**3 - 0.1036 * x**4)
        return x, 0.3 * x * (1 - x) + sign * half
    rim = [point(k, 1) for k in range(n + 1)] + [point(k, -1) for k in range(n - 1, 0, -1)]
    ring = lambda j: [(x, 3.0 * j / stations, z) for x, z in rim]
    faces = [[a, b, c, d] for j in range(stations) for a, b, c, d in zip(ring(j), ring(j + 1), ring(j + 1)[1:] + ring(j + 1)[:1], ring(j)[1:] + ring(j)[:1])]
    return faces + [ring(stations)[::-1]] + ([ring(0)] if root else [])


def fan(faces):
    return [(f[0], f[k], f[k + 1]) for f in faces for k in range(1, len(f) - 1)]


def stl(faces, name="cube"):
    facet = lambda t: " facet normal 0 0 0\n  outer loop\n" + "".join(f"   vertex {x!r} {y!r} {z!r}\n" for x, y, z in t) + "  endloop\n endfacet\n"
    return f"solid {name}\n" + "".join(map(facet, fan(faces))) + f"endsolid {name}\n"


def binary(faces, header=b"", count=None, order="<"):
    body = b"".join(struct.pack(order + "12fH", 0, 0, 0, *(c for p in t for c in p), 0) for t in fan(faces))
    return header.ljust(80, b"\0") + struct.pack("<I", len(fan(faces)) if count is None else count) + body


def numbered(faces):
    points = sorted({p for f in faces for p in f})
    return points, [[points.index(p) for p in f] for f in faces]


def obj(faces, ref="{i}", vertex="v {} {} {}\n", before=""):
    points, indices = numbered(faces)
    n = len(points)
    face = lambda f: "f " + " ".join(ref.format(i=i + 1, b=i - n) for i in f) + "\n"
    return "".join(vertex.format(*map(repr, p)) for p in points) + before + "".join(map(face, indices))


def ply(faces, kind="ascii"):
    points, indices = numbered(faces)
    head = (f"ply\nformat {kind} 1.0\ncomment made\nelement vertex {len(points)}\nproperty double x\nproperty double y\nproperty double z\n"
            f"element face {len(indices)}\nproperty list uchar int vertex_indices\nend_header\n").encode()
    if kind == "ascii":
        rows = ["{!r} {!r} {!r}".format(*p) for p in points] + [f"{len(f)} " + " ".join(map(str, f)) for f in indices]
        return head + ("\n".join(rows) + "\n").encode()
    order = "<" if "little" in kind else ">"
    return head + b"".join(struct.pack(order + "3d", *p) for p in points) + b"".join(
        struct.pack(f"{order}B{len(f)}i", len(f), *f) for f in indices)


def corpus():
    """Name, content, the clean faces that it stands for or none where it must be refused, and words that must be told."""
    cube, prism, half, closed = box(), star(), wing(root=False), wing()
    two = box() + box(at=(3.0, 0.0, 0.0))
    triangles = [list(t) for t in fan(cube)]
    turned = [f[::-1] if k % 3 == 0 else f for k, f in enumerate(triangles)]
    text = stl(cube)
    parts = obj(cube).replace("f ", "g lower\nf ", 1)
    holes = [t for k, t in enumerate(triangles) if k not in (0, 1)]
    yield "a.stl", text, cube, None
    yield "header-solid.stl", binary(cube, b"solid cube"), cube, None
    yield "header-solid-byte-more.stl", binary(cube, b"solid cube") + b"\n", cube, "1 byte after the last triangle"
    yield "bytes-more.stl", binary(cube) + b"made by hand", cube, "12 bytes after the last triangle"
    yield "no-count.stl", binary(cube, count=0), cube, "announces 0 triangles, but 12 follow"
    yield "cut.stl", binary(cube)[:-70], None, "cut short in triangle 11"
    yield "not-a-number.stl", binary([[(0.0, 0.0, 0.0), (1.0, float("nan"), 0.0), (0.0, 1.0, 0.0)]] + cube), None, "triangle 1 has the corner"
    yield "end-solid.stl", text.replace("endsolid", "end solid"), cube, None
    yield "end-facet.stl", text.replace("endfacet", "end facet").replace("endloop", "end loop"), cube, None
    yield "capitals.stl", text.upper(), cube, None
    yield "no-endsolid.stl", text.replace("endsolid cube\n", ""), cube, None
    yield "no-solid.stl", text.replace("solid cube\n", "", 1), cube, None
    yield "one-line.stl", text.replace("solid cube\n", "solid cube\n", 1).replace(" facet", "~facet").replace("\n  ", " ").replace("~", " "), cube, None
    yield "normals.stl", text.replace("normal 0 0 0", "normal nan nan nan"), cube, None
    yield "returns.stl", text.replace("\n", "\r"), cube, None
    yield "two-solids.stl", stl(box(), "left wing") + stl(box(at=(3.0, 0.0, 0.0)), "right wing"), two, None
    yield "four-corners.stl", text.replace("  endloop", "   vertex 0 0 0\n  endloop", 1), None, "line 9: the facet has 4 vertices"
    yield "comma.stl", stl(box((1.5, 1.0, 1.0))).replace("1.5", "1,5"), None, "has a decimal comma"
    yield "text-cut.stl", text[: text.rindex("  endloop")], None, "ends inside a facet"
    yield "turned.stl", stl(turned), cube, "are turned to face outward"
    yield "inward.stl", binary([f[::-1] for f in triangles]), cube, "12 of 12 triangles are turned"
    yield "twice.stl", stl(triangles + triangles[:3]), cube, "3 repeated triangles are left out"
    yield "flat.stl", stl(triangles + [[(0.0, 0.0, 0.0), (0.0, 0.0, 0.0), (1.0, 0.0, 0.0)]]), cube, "degenerate"
    yield "side-missing.stl", stl(holes), cube, "a flat opening of 4 edges"
    yield "sheet.stl", stl([cube[0]]), None, "open edges"
    yield "fin.stl", stl(triangles + [[(0.0, 0.0, 0.0), (0.0, 0.0, 1.0), (-1.0, -1.0, 0.5)]]), None, "3 triangles meet at the edge"
    yield "open-root.obj", obj(half), closed, "a flat opening of 48 edges"
    yield "open-ends.stl", binary(half[:-1]), closed, "a flat opening of 48 edges"
    yield "ends-of-many-corners.obj", obj(closed), closed, None
    yield "star.obj", obj(prism), prism, None
    yield "quads.obj", obj(cube), cube, None
    yield "triangles.obj", obj(triangles), cube, None
    yield "negative.obj", obj(cube, "{b}"), cube, None
    yield "textures.obj", obj(cube, "{i}/1", before="vt 0 0\n"), cube, None
    yield "normals.obj", obj(cube, "{i}//1", before="vn 0 0 1\n"), cube, None
    yield "all.obj", obj(cube, "{i}/1/1", before="vt 0 0\nvn 0 0 1\ns off\nusemtl \nmtllib none.mtl\n"), cube, None
    yield "continued.obj", re.sub(r"(f \d+ \d+) ", r"\1 \\\n ", obj(cube)), cube, None
    yield "colours.obj", obj(cube, vertex="v {} {} {} 0.5 0.5 0.5 # grey\n"), cube, None
    yield "groups.obj", parts, cube, None
    yield "short-faces.obj", obj(cube) + "f 1 2\n", cube, "less than three corners"
    yield "no-vertex.obj", obj(cube) + "f 1 2 99\n", None, "line 15: vertex 99 of a face is not there"
    yield "no-number.obj", obj(cube).replace("v 0.0 0.0 1.0", "v 0.0 O.0 1.0"), None, "line 2"
    yield "open.obj", obj(half[::2]), None, "open edges"
    yield "a.ply", ply(cube), cube, None
    yield "little.ply", ply(prism, "binary_little_endian"), prism, None
    yield "big.ply", ply(triangles, "binary_big_endian"), cube, None
    yield "cut.ply", ply(cube, "binary_little_endian")[:-3], None, "face 6 of 6"
    yield "open-root.ply", ply(half), closed, "a flat opening of 48 edges"


def plain(faces):
    """Volume and area by the sum over the triangles of fans; faces that are not convex count with the signs of their parts."""
    cross = lambda a, b: (a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0])
    minus = lambda a, b: tuple(x - y for x, y in zip(a, b))
    volume = area = 0.0
    for face in faces:
        normals = [cross(minus(b, a), minus(c, a)) for a, b, c in fan([face])]
        total = [0.5 * sum(n[d] for n in normals) for d in range(3)]
        area += math.sqrt(sum(x * x for x in total))
        volume += sum(x * y for x, y in zip(total, face[0])) / 3
    return abs(volume), area


def by_trimesh(faces):
    import trimesh

    points, indices = numbered([list(t) for t in fan(faces)])
    mesh = trimesh.Trimesh(points, indices, process=False)
    return abs(mesh.volume), plain(faces)[1] if any(len(f) > 4 for f in faces) else mesh.area


def tell(alula, folder, name):
    case = folder / "case.toml"
    case.write_text(SPACE.format(name))
    done = subprocess.run([alula, "geometry", case, "--out", folder / "out.obj", "--force"], capture_output=True, text=True, errors="replace")
    if done.returncode:
        return None, done.stderr
    value = lambda word: float(re.search(rf"^{word} +([-.\de]+)", done.stdout, re.M)[1])
    return (value("volume"), value("wetted area")), done.stderr


def wrong(alula, folder, item, measured):
    name, content, faces, words = item
    (folder / name).write_bytes(content if isinstance(content, bytes) else content.encode())
    told, said = tell(alula, folder, name)
    if words is not None and words not in said:
        return f"`{words}` is not told, but: {said.strip()}"
    if faces is None:
        return None if told is None else f"is read: volume and area {told}"
    if told is None:
        return f"is refused: {said.strip()}"
    if words is None and "note:" in said and not re.search("turned to face|overlap|Selig", said):
        return f"is read with a note: {said.strip()}"
    expected = measured(faces)
    # binary files hold single precision, and six digits are told
    off = max(abs(a - b) / b for a, b in zip(told, expected))
    return None if off < 5e-6 else f"volume and area {told}, but {expected}"


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("alula")
    parser.add_argument("--plain", action="store_true", help="without trimesh")
    args = parser.parse_args()
    alula = str(pathlib.Path(args.alula).resolve())
    measured = plain if args.plain else by_trimesh
    items, bad = list(corpus()), 0
    with tempfile.TemporaryDirectory() as folder:
        for item in items:
            told = wrong(alula, pathlib.Path(folder), item, measured)
            bad += told is not None
            if told is not None:
                print(f"{item[0]}: {told}")
    print(f"{len(items)} surfaces: {bad} wrong")
    sys.exit(1 if bad else 0)


if __name__ == "__main__":
    main()
