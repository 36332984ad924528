#!/usr/bin/env python3
"""Lift of thick wings in potential flow by a panel method, as a reference for wings of `verification/` and `bars.py`. Needs numpy.

    tests/nightly/panels.py [elliptic | rectangular | swept ...] [--mach 0.3] [--alpha 4] [--panels 24]

Sources and doublets of constant strength lie on flat quadrilaterals of the surface (L. Morino and C.-C. Kuo, AIAA J. 12 (1974) 191-197;
integrals over a panel after D. R. Wilton et al., IEEE Trans. AP-32 (1984) 276-281), with doublets on a wake that leaves the trailing edge
along the stream; the plane y = 0 is a plane of symmetry. Compressibility follows the linear equation for the potential, with no mass flux
through the wall: x is divided by sqrt(1 - M^2) (B. Goethert, NACA TM 1105, 1946). Errors fall with the number of panels along the chord and
along the span: both are extrapolated from twice the panels. Printed are, one after the other,

1. the lift of the circulation (Kutta and Joukowski), on three numbers of panels and extrapolated;
2. the lift of the pressure on the wing. It is lower: thickness turns the flow along the span where the wake begins, so that a wake along the
   stream is not free of forces. The ratio of both is that of incompressible flow, on the most panels along the chord, over the same ratio of
   a section of the same panels;
3. the same with what the full potential equation adds to the lift slope of the section (C. Kaplan, NACA TR 621, 1938), by lifting-line theory.
"""
import argparse

import numpy as np

# x of the leading edge and chord along y, half span, area of the half, thickness of the section
WINGS = {
    "elliptic": (lambda y: 4 / np.pi * 0.25 * (1 - rounded(y)), lambda y: 4 / np.pi * rounded(y), 4.0, 4.0, 0.12),
    "rectangular": (lambda y: 0.0, lambda y: 1.0, 4.0, 4.0, 0.06),
    "rectangular, thick": (lambda y: 0.0, lambda y: 1.0, 4.0, 4.0, 0.12),
    "swept": (lambda y: np.tan(np.radians(35.0)) * y, lambda y: 1.0, 4.0, 4.0, 0.12),
}


def rounded(y):
    return np.sqrt(max(1 - (y / 4) ** 2, 1e-8))


def section(thickness, n):
    x = 0.5 * (1 - np.cos(np.linspace(0, np.pi, n + 1)))
    z = 5 * thickness * (0.2969 * np.sqrt(x) - 0.1260 * x - 0.3516 * x**2 + 0.2843 * x**3 - 0.1036 * x**4)
    z[[0, -1]] = 0
    return np.concatenate([x[::-1], x[1:]]), np.concatenate([-z[::-1], z[1:]])


def potentials(points, panels):
    """Potentials at `points` of doublets and of sources of unit strength on `panels`, times 4 pi."""
    centre = panels.mean(1)
    along, across = panels[:, 2] - panels[:, 0], panels[:, 3] - panels[:, 1]
    normal = np.cross(along, across)
    normal /= np.linalg.norm(normal, axis=1)[:, None]
    first = along / np.linalg.norm(along, axis=1)[:, None]
    second = np.cross(normal, first)
    offset = panels - centre[:, None]
    corners = np.stack([(offset * first[:, None]).sum(-1), (offset * second[:, None]).sum(-1)], -1)
    doublets, sources = np.empty((2, len(points), len(panels)))
    chunk = max(1, 2_000_000 // len(panels))
    for start in range(0, len(points), chunk):
        apart = points[start : start + chunk, None] - centre
        x, y, z = ((apart * axis).sum(-1) for axis in (first, second, normal))
        height, angle, source = np.abs(z), 0.0, 0.0
        for k in range(4):
            (x1, y1), (x2, y2) = corners[:, k].T, corners[:, (k + 1) % 4].T
            length = np.hypot(x2 - x1, y2 - y1)
            there = length > 1e-12
            tx, ty = (np.where(there, d / np.where(there, length, 1), 0) for d in (x2 - x1, y2 - y1))
            r1, r2 = (np.sqrt((x - a) ** 2 + (y - b) ** 2 + z * z) for a, b in ((x1, y1), (x2, y2)))
            side = (y - y1) * tx - (x - x1) * ty
            s1, s2 = ((x - a) * tx + (y - b) * ty for a, b in ((x1, y1), (x2, y2)))
            foot = side**2 + z * z
            angle = angle + np.arctan2(side * s1, foot + height * r1) - np.arctan2(side * s2, foot + height * r2)
            log = np.log((r1 + r2 + length) / np.maximum(r1 + r2 - length, 1e-14))
            source = source + np.where(there, side * log, 0)
        sources[start : start + chunk] = source - height * angle
        doublets[start : start + chunk] = np.sign(z) * angle
    return doublets, sources


def mirrored(panels):
    return (panels * [1, -1, 1])[:, ::-1]


def solve(wing, mach, alpha, chordwise, spanwise):
    """Potential of the disturbance on the panels of a wing, from nose to nose around the section for each strip."""
    edge, chord, half, _, thickness = WINGS[wing]
    beta = np.sqrt(1 - mach**2)
    x, z = section(thickness, chordwise)
    stations = half * np.sin(np.linspace(0, np.pi / 2, spanwise + 1))
    grid = np.stack([np.stack([(edge(y) + chord(y) * x) / beta, np.full_like(x, y), chord(y) * z], -1) for y in stations], 1)
    panels = np.stack([grid[:-1, :-1], grid[1:, :-1], grid[1:, 1:], grid[:-1, 1:]], 2).reshape(-1, 4, 3)
    tip, last = grid[:, -1], len(grid) - 1
    if np.ptp(tip[:, 2]) > 1e-3:
        cap = np.array([[tip[i], tip[i + 1], tip[last - i - 1], tip[last - i]] for i in range(chordwise)])
        panels = np.concatenate([panels, cap])
    normal = np.cross(panels[:, 2] - panels[:, 0], panels[:, 3] - panels[:, 1])
    if normal[(last - 3) * spanwise, 2] < 0:
        panels, normal = panels[:, ::-1], -normal
    area = 0.5 * np.linalg.norm(normal, axis=1)
    normal /= 2 * area[:, None]
    centre = panels.mean(1)
    far = 2000 * half * np.array([1.0, 0.0, beta * np.tan(alpha)])
    behind = grid[0]
    wake = np.stack([behind[:-1], behind[:-1] + far, behind[1:] + far, behind[1:]], 1)
    if np.cross(wake[0, 2] - wake[0, 0], wake[0, 3] - wake[0, 1])[2] < 0:
        wake = wake[:, ::-1]
    doublets, sources = potentials(centre, panels)
    np.fill_diagonal(doublets, 0)
    other = potentials(centre, mirrored(panels))
    jump = potentials(centre, wake)[0] + potentials(centre, mirrored(wake))[0]
    doublets, sources = doublets + other[0], sources + other[1]
    sign = -np.sign(np.median(doublets.sum(1)))
    matrix = 2 * np.pi * np.eye(len(panels)) - sign * doublets
    matrix[:, (last - 1) * spanwise : last * spanwise] -= sign * jump
    matrix[:, :spanwise] += sign * jump
    through = np.cos(alpha) * normal[:, 0] + beta * np.sin(alpha) * normal[:, 2]
    potential = np.linalg.solve(matrix, sources @ through / beta)
    strips = [v[: last * spanwise].reshape(last, spanwise, *v.shape[1:]) for v in (potential, centre, normal, area)]
    return stations, *strips


def of_circulation(wing, mach, alpha, chordwise, spanwise):
    """Lift coefficient."""
    stations, potential, *_ = solve(wing, mach, alpha, chordwise, spanwise)
    return 2 * ((potential[-1] - potential[0]) * np.diff(stations)).sum() / WINGS[wing][3]


def pressure_over_circulation(wing, alpha, chordwise, spanwise):
    """Lift of the pressure over that of the circulation, in incompressible flow."""
    stations, potential, centre, normal, area = solve(wing, 0.0, alpha, chordwise, spanwise)
    stream = np.array([np.cos(alpha), 0.0, np.sin(alpha)])
    total = potential + centre @ stream
    square, right = np.zeros((*total.shape, 3, 3)), np.zeros((*total.shape, 3))

    def add(here, offset, change):
        offset = offset - (offset * normal[here]).sum(-1)[..., None] * normal[here]
        weight = 1 / (offset**2).sum(-1)
        square[here] += weight[..., None, None] * offset[..., :, None] * offset[..., None, :]
        right[here] += (weight * change)[..., None] * offset

    every, after, before = slice(None), slice(1, None), slice(0, -1)
    for here, there in (((after, every), (before, every)), ((every, after), (every, before))):
        for one, two in ((here, there), (there, here)):
            add(one, centre[two] - centre[one], total[two] - total[one])
    add((every, 0), centre[:, 0] * [1, -1, 1] - centre[:, 0], 0.0)
    square += normal[..., :, None] * normal[..., None, :] * np.trace(square, axis1=2, axis2=3)[..., None, None]
    velocity = np.linalg.solve(square, right[..., None])[..., 0]
    force = ((velocity**2).sum(-1)[..., None] * normal * area[..., None]).sum((0, 1))
    pressure = force[2] * np.cos(alpha) - force[0] * np.sin(alpha)
    return pressure / (2 * ((potential[-1] - potential[0]) * np.diff(stations)).sum())


def full_potential(mach, thickness):
    """Lift slope of a section over that of the linear equation with the same thickness."""
    def slope(m):
        inverse = 1 / np.sqrt(1 - m * m)
        own = thickness / (1 + thickness)
        return inverse + own * (inverse * (inverse - 1) + 0.6 * (inverse**2 - 1) ** 2)

    beta = np.sqrt(1 - mach**2)
    return slope(mach) * beta * (1 + 0.85 * thickness) / (1 + 0.85 * thickness * beta)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("wings", nargs="*", default=["elliptic"])
    parser.add_argument("--mach", type=float, default=0.3)
    parser.add_argument("--alpha", type=float, default=4.0)
    parser.add_argument("--panels", type=int, default=24)
    options = parser.parse_args()
    alpha, n = np.radians(options.alpha), options.panels
    for wing in options.wings:
        half, area, thickness = WINGS[wing][2:]
        few, chordwise, spanwise = (of_circulation(wing, options.mach, alpha, *counts) for counts in ((n, n), (2 * n, n), (n, 2 * n)))
        limit = few + 2 * (chordwise - few) + 2 * (spanwise - few)
        WINGS["section"] = (lambda y: 0.0, lambda y: 1.0, 3000.0, 3000.0, thickness)
        pressure = limit * pressure_over_circulation(wing, alpha, 2 * n, n) / pressure_over_circulation("section", alpha, 2 * n, 3)
        slope = 2 * np.pi * (1 + 0.85 * thickness) / np.sqrt(1 - options.mach**2)
        share = 1 / (1 + slope / (np.pi * 2 * half**2 / area))
        full = pressure * (1 + (full_potential(options.mach, thickness) - 1) * share)
        print(f"{wing}: CL of the circulation {few:.4f}, {chordwise:.4f}, {spanwise:.4f}, extrapolated {limit:.4f}; ", end="")
        print(f"of the pressure {pressure:.4f}; with the full potential equation {full:.4f}")


if __name__ == "__main__":
    main()
