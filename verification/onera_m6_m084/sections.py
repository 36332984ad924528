"""Cp of a run at stations of the span against a reference, point by point: what the metric `section_cp_rms` measures, with its parts.

The hull of a run (`hull.vtp`, the triangles of the surface) is cut by the plane y of every row of the reference; x/c counts from the
foremost to the rearmost point of the cut. At the point of the row's side with the row's x/c, Cp is the constant term of a quadratic
fit in the tangent plane to the 16 nearest wall particles (`surface.csv`) that look the same way. No row is left out.

    python3 sections.py RUN [--file euler_cp.csv] [--points]

prints the root mean square difference at each station and of all rows, the parts of it by stretch of the chord, and with `--points`
every row. Needs NumPy.
"""
import argparse
import csv
import re
import struct
import zlib

import numpy as np

STRETCHES = [0, 0.01, 0.05, 0.15, 0.3, 0.5, 0.6, 0.8, 0.95, 1.0001]
NEIGHBOURS = 16
SAME_SIDE = 0.5  # cosine between normals
BASE = 0.9  # component along x of the normal of a blunt edge


class Hull:
    """Points, normals and triangles of a `hull.vtp`: compressed raw data behind an XML head."""

    def __init__(self, path):
        with open(path, "rb") as file:
            head, tail = file.read().split(b'<AppendedData encoding="raw">', 1)
        self.data = tail[tail.index(b"_") + 1 :]
        pattern = rb'type="(\w+)" Name="(\w+)" NumberOfComponents="\d" format="appended" offset="(\d+)"'
        self.arrays = {m[2].decode(): (m[1].decode(), int(m[3])) for m in re.finditer(pattern, head)}
        self.points, self.normals, self.triangles = (
            self.array(name).reshape(-1, 3) for name in ("Points", "normal", "connectivity")
        )

    def array(self, name):
        kind, offset = self.arrays[name]
        blocks = struct.unpack_from("<Q", self.data, offset)[0]
        at, out = offset + 24 + 8 * blocks, []
        for size in struct.unpack_from(f"<{blocks}Q", self.data, offset + 24):
            out.append(zlib.decompress(self.data[at : at + size]))
            at += size
        return np.frombuffer(b"".join(out), {"Float64": "<f8", "Int64": "<i8"}[kind])

    def cut(self, y):
        """Pieces of the section: two ends each, of place and normal."""
        height, pieces = self.points[:, 1] - y, []
        above = height[self.triangles] >= 0
        for triangle in self.triangles[above.any(1) & ~above.all(1)]:
            ends = []
            for a, b in zip(triangle, np.roll(triangle, -1)):
                if (height[a] >= 0) != (height[b] >= 0):
                    part = height[a] / (height[a] - height[b])
                    both = [v[a] * (1 - part) + v[b] * part for v in (self.points, self.normals)]
                    ends.append(np.concatenate(both))
            pieces.append(ends)
        return np.array(pieces)


def place(pieces, x_c, upper):
    """Point and normal of a section at x/c."""
    front, rear = pieces[:, :, 0].min(), pieces[:, :, 0].max()
    x, normals = front + x_c * (rear - front), pieces[:, :, 3:].mean(1)
    own = pieces[(normals[:, 0] < BASE) & ((normals[:, 2] > 0) == upper)]
    ends = own[:, :, 0]
    a, b = own[np.maximum(np.maximum(ends.min(1) - x, x - ends.max(1)), 0).argmin()]
    part = 0.5 if a[0] == b[0] else np.clip((x - a[0]) / (b[0] - a[0]), 0, 1)
    point = a + (b - a) * part
    return point[:3], point[3:] / np.linalg.norm(point[3:])


class Wall:
    """The wall particles of a run."""

    def __init__(self, path):
        with open(path, newline="") as file:
            rows = list(csv.DictReader(file))
        column = lambda names: np.array([[float(row[name]) for name in names] for row in rows])
        self.x, self.normal, self.cp = column(["x", "y", "z"]), column(["nx", "ny", "nz"]), column(["cp"])[:, 0]

    def at(self, x, normal):
        same = np.flatnonzero(self.normal @ normal > SAME_SIDE)
        squares = ((self.x[same] - x) ** 2).sum(1)
        near = squares.argsort()[:NEIGHBOURS]
        size = np.sqrt(squares[near[-1]])
        axis = np.eye(3)[np.abs(normal).argmin()]
        first = axis - normal * (axis @ normal)
        first /= np.linalg.norm(first)
        offset = (self.x[same[near]] - x) / size
        a, b = offset @ first, offset @ np.cross(normal, first)
        weight = np.sqrt(np.exp(-2 * squares[near] / size**2))
        rows = np.stack([np.ones_like(a), a, b, a * a, a * b, b * b], 1) * weight[:, None]
        return np.linalg.lstsq(rows, self.cp[same[near]] * weight, rcond=None)[0][0]


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("run")
    parser.add_argument("--file", default="euler_cp.csv")
    parser.add_argument("--points", action="store_true")
    args = parser.parse_args()
    with open(args.file, newline="") as file:
        rows = list(csv.DictReader(line for line in file if not line.startswith("#")))
    hull, wall, found = Hull(f"{args.run}/hull.vtp"), Wall(f"{args.run}/surface.csv"), []
    for y in sorted({float(row["y"]) for row in rows}):
        pieces = hull.cut(y)
        for row in (row for row in rows if float(row["y"]) == y):
            x_c, cp = float(row["x_c"]), float(row["Cp"])
            found.append((y, row["surface"], x_c, cp, wall.at(*place(pieces, x_c, row["surface"] == "upper"))))
    rms = lambda rows: np.sqrt(np.mean([(r[4] - r[3]) ** 2 for r in rows]))
    for y in sorted({r[0] for r in found}):
        own = [r for r in found if r[0] == y]
        print(f"y = {y}: Cp RMS {rms(own):.4f} on {len(own)} points")
        for side in ("upper", "lower"):
            for a, b in zip(STRETCHES, STRETCHES[1:]):
                part = [r for r in own if r[1] == side and a <= r[2] < b]
                if part:
                    share = len(part) / len(own) * (rms(part) / rms(own)) ** 2
                    worst = max(part, key=lambda r: abs(r[4] - r[3]))
                    print(f"  {side} {a:.2f}-{min(b, 1):.2f}: {len(part):2} points, RMS {rms(part):.4f}, {100 * share:4.1f} % "
                          f"of the squares, most {worst[4] - worst[3]:+.3f} at {worst[2]:.4f}")
        if args.points:
            for r in own:
                print(f"  {r[1]} {r[2]:.6f} {r[3]:+.4f} {r[4]:+.4f} {r[4] - r[3]:+.4f}")
    print(f"all: Cp RMS {rms(found):.4f} on {len(found)} points")


if __name__ == "__main__":
    main()
