#!/usr/bin/env python3
"""Round copper bar that hits a rigid wall, by axisymmetric finite elements: the limit that `solid_axisymmetric` is held against.

Quadrilaterals with one point of integration, stabilised against hourglass modes by damping (Flanagan and Belytschko 1981), in the
frame that moves with the material; Jaumann's rate, return to the yield surface with linear isotropic hardening, pressure
-K (J^2 - 1)/(2 J), artificial bulk viscosity, lumped masses, central differences (Belytschko, Liu and Moran 2000, chapters 6 and 8). The
wall holds a node that would pass it, and lets it go again: no penalty. It shares nothing with the particles.

Usage: impact_elements.py [elements over the radius, default 8]; 16 take minutes.
"""
import sys

import numpy as np

RADIUS, LENGTH, SPEED, UNTIL = 3.2e-3, 32.4e-3, 227.0, 80e-6
DENSITY, YOUNG, POISSON, YIELD, HARDENING = 8930.0, 117e9, 0.35, 400e6, 100e6
HOURGLASS, LINEAR, QUADRATIC = 0.05, 0.06, 1.5
SHEAR, BULK = YOUNG / 2 / (1 + POISSON), YOUNG / 3 / (1 - 2 * POISSON)
WAVE = np.sqrt((BULK + 4 * SHEAR / 3) / DENSITY)


def mesh(across):
    """Places of the nodes, nodes of the elements, masses of a radian; elements are nearly squares."""
    h, along = RADIUS / across, int(across * LENGTH / RADIUS + 0.5)
    r, z = (a.ravel() for a in np.meshgrid(np.arange(across + 1) * h, np.linspace(0, LENGTH, along + 1)))
    k, i = (a.ravel() for a in np.meshgrid(np.arange(along), np.arange(across), indexing="ij"))
    first = k * (across + 1) + i
    nodes = np.stack([first, first + 1, first + across + 2, first + across + 1])
    inner, outer = r[nodes[0]], r[nodes[1]]
    mass = np.zeros(len(r))
    for corner, share in zip(nodes, [2 * inner + outer, inner + 2 * outer, inner + 2 * outer, 2 * inner + outer]):
        np.add.at(mass, corner, DENSITY * share * h * LENGTH / along / 12)
    return r, z, nodes, mass


def stress_step(stress, strain, rate, spin, dt):
    """Jaumann's rate and radial return: rr, zz, tt, rz of the deviator, plastic strain."""
    c, s = np.cos(spin * dt), np.sin(spin * dt)
    rr, zz, tt, rz = stress
    turned = (rr * c * c + zz * s * s + 2 * rz * c * s, rr * s * s + zz * c * c - 2 * rz * c * s, tt, (zz - rr) * c * s + rz * (c * c - s * s))
    mean = (rate[0] + rate[1] + rate[2]) / 3
    trial = np.stack(turned) + 2 * SHEAR * dt * np.stack([rate[0] - mean, rate[1] - mean, rate[2] - mean, rate[3]])
    size = np.sqrt(1.5 * (trial[0] ** 2 + trial[1] ** 2 + trial[2] ** 2 + 2 * trial[3] ** 2))
    flow = np.maximum(size - (YIELD + HARDENING * strain), 0) / (3 * SHEAR + HARDENING)
    strain = strain + flow
    return trial * np.where(flow > 0, (YIELD + HARDENING * strain) / np.maximum(size, YIELD), 1.0), strain


def march(across):
    r, z, nodes, mass = mesh(across)
    u, w = np.zeros_like(r), np.full_like(r, -SPEED)
    stress, strain = np.zeros((4, nodes.shape[1])), np.zeros(nodes.shape[1])
    zigzag, axis = np.array([1.0, -1.0, 1.0, -1.0])[:, None], r == 0
    volume0, t, dt = None, 0.0, 0.3 * RADIUS / across / WAVE
    while t < UNTIL:
        x, y, a, b = r[nodes], z[nodes], u[nodes], w[nodes]
        diagonals = x[2] - x[0], y[2] - y[0], x[1] - x[3], y[1] - y[3]
        area = 0.5 * (diagonals[0] * -diagonals[3] + diagonals[2] * diagonals[1])
        of_r = np.stack([y[1] - y[3], y[2] - y[0], y[3] - y[1], y[0] - y[2]]) / (2 * area)
        of_z = np.stack([x[3] - x[1], x[0] - x[2], x[1] - x[3], x[2] - x[0]]) / (2 * area)
        middle = x.mean(0)
        volume = middle * area
        volume0 = volume if volume0 is None else volume0
        rr, zz = (of_r * a).sum(0), (of_z * b).sum(0)
        zr, rz = (of_r * b).sum(0), (of_z * a).sum(0)
        tt = a.mean(0) / middle
        stress, strain = stress_step(stress, strain, (rr, zz, tt, 0.5 * (rz + zr)), 0.5 * (rz - zr), dt)
        j = volume / volume0
        size = area / np.sqrt(np.maximum(diagonals[0] ** 2 + diagonals[1] ** 2, diagonals[2] ** 2 + diagonals[3] ** 2))
        squeezed = np.maximum(-(rr + zz + tt), 0) * size
        pressure = -BULK * 0.5 * (j * j - 1) / j + DENSITY / j * squeezed * (QUADRATIC * squeezed + LINEAR * WAVE)
        srr, szz, stt = stress[0] - pressure, stress[1] - pressure, stress[2] - pressure
        gamma = zigzag - (zigzag * x).sum(0) * of_r - (zigzag * y).sum(0) * of_z
        brake = HOURGLASS * DENSITY / j * WAVE * np.sqrt(area) * middle * 0.25
        fr = -(volume * (srr * of_r + stress[3] * of_z) + stt * area * 0.25 + brake * (gamma * a).sum(0) * gamma)
        fz = -(volume * (szz * of_z + stress[3] * of_r) + brake * (gamma * b).sum(0) * gamma)
        n = len(r)
        u += dt * np.bincount(nodes.ravel(), fr.ravel(), n) / mass
        w += dt * np.bincount(nodes.ravel(), fz.ravel(), n) / mass
        u[axis] = 0
        w = np.where(z + dt * w < 0, -z / dt, w)
        r, z, t = r + dt * u, z + dt * w, t + dt
        step = 0.5 * size / (WAVE / np.sqrt(j) * (1 + LINEAR) + QUADRATIC * squeezed)
        dt = min(step.min(), 1.02 * dt)
    return r, z, strain


if __name__ == "__main__":
    across = int(sys.argv[1]) if len(sys.argv) > 1 else 8
    r, z, strain = march(across)
    print(f"{across} elements over the radius: length {1e3 * z[-across - 1]:.3f} mm, foot {1e3 * r[across]:.3f} mm, "
          f"{1e3 * z[across]:.3f} mm off the wall, plastic strain up to {strain.max():.2f}")
