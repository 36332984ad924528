"""Stand-off distance of the bow shock of a circle or a sphere, by a method that has nothing in common with the program.

The steady Euler equations between body and shock, in polar coordinates about the centre, are solved by spectral collocation
(Chebyshev points from body to shock and over the angle, even or odd about the axis). The shock is fitted: its distance at each
angle is an unknown, and the Rankine-Hugoniot relations hold on it exactly. The wall has the entropy of the normal shock on the
axis; total enthalpy is that of the free stream. All equations at all points together are solved by Gauss and Newton's method for
the velocities, the logarithm of the pressure and the distances; what is left of them falls exponentially with the number of points.
Downstream the region ends in supersonic flow, where nothing is to be prescribed. Slow Mach numbers start from faster ones.

    python3 shock_fitted.py MACH [--sphere] [--across 14] [--along 12] [--end 1.1]

prints Mach number, distance in radii, and what is left of the equations. Needs NumPy; ratio of specific heats 1.4.
Body and shock are seen from a unit radius; density and sound speed of the free stream are 1.
"""
import argparse

import numpy as np

GAMMA = 1.4
WEIGHT = 30.0  # of conditions at wall and shock against equations inside


def chebyshev(n):
    """Points cos(k pi / n) and the matrix of derivatives there (Trefethen 2000)."""
    k = np.arange(n + 1)
    x = np.cos(np.pi * k / n)
    c = np.where((k == 0) | (k == n), 2.0, 1.0) * (-1.0) ** k
    matrix = np.outer(c, 1 / c) / (x[:, None] - x[None, :] + np.eye(n + 1))
    return x, matrix - np.diag(matrix.sum(1))


class Layer:
    """The shock layer of a circle (`sphere` 0) or a sphere (1) at a Mach number."""

    def __init__(self, mach, sphere, across, along, end):
        self.mach, self.sphere, self.across, self.along = mach, sphere, across, along
        x, d = chebyshev(across)
        self.eta, self.d_eta = (1 - x) / 2, -2 * d  # 0 at the wall, 1 at the shock
        x, d = chebyshev(2 * along - 1)
        self.theta, d = end * x[:along], d / end  # from the end towards the axis, which is no point
        same, other = d[:along, :along], d[:along, ::-1][:, :along]
        self.even, self.odd = same + other, same - other
        self.p1, self.enthalpy = 1 / GAMMA, 1 / (GAMMA - 1) + mach**2 / 2
        p2, r2 = self.jump(mach**2)
        self.entropy = p2 / r2**GAMMA
        m2 = mach**2
        pitot = ((GAMMA + 1) ** 2 * m2 / (4 * GAMMA * m2 - 2 * (GAMMA - 1))) ** (GAMMA / (GAMMA - 1))
        self.pitot = pitot * (1 - GAMMA + 2 * GAMMA * m2) / (GAMMA + 1) * self.p1

    def jump(self, m2):
        """Pressure and density behind a shock with the square of the normal Mach number `m2`."""
        pressure = self.p1 * (1 + 2 * GAMMA / (GAMMA + 1) * (m2 - 1))
        return pressure, (GAMMA + 1) * m2 / ((GAMMA - 1) * m2 + 2)

    def split(self, unknowns):
        n = (self.across + 1) * self.along
        u, v, p = (unknowns[k * n : (k + 1) * n].reshape(self.across + 1, self.along) for k in range(3))
        return u, v, np.exp(p), unknowns[3 * n :]

    def behind(self, distance):
        """Velocity along r and theta, and pressure, behind the shock."""
        slope = (self.even @ distance) / (1 + distance)
        length = np.sqrt(1 + slope**2)
        nr, nt = -1 / length, slope / length
        u, v = -self.mach * np.cos(self.theta), self.mach * np.sin(self.theta)
        normal, tangential = u * nr + v * nt, -u * nt + v * nr
        pressure, density = self.jump(normal**2)
        normal = normal / density
        return normal * nr - tangential * nt, normal * nt + tangential * nr, pressure

    def equations(self, unknowns):
        u, v, p, distance = self.split(unknowns)
        r = 1 + self.eta[:, None] * distance
        rho = GAMMA / (GAMMA - 1) * p / (self.enthalpy - (u * u + v * v) / 2)
        shift = -self.eta[:, None] * (self.even @ distance) / distance
        dr = lambda f: (self.d_eta @ f) / distance
        dt = lambda f, matrix: (f @ matrix.T + shift * (self.d_eta @ f)) / r
        even, odd = self.even, self.odd
        spread = dr(u) + dt(v, odd) + (1 + self.sphere) * u / r + self.sphere * v / np.tan(self.theta) / r
        mass = (u * dr(rho) + v * dt(rho, even)) / rho + spread
        radial = rho * (u * dr(u) + v * dt(u, even) - v * v / r) + dr(p)
        tangential = rho * (u * dr(v) + v * dt(v, odd) + u * v / r) + dt(p, even)
        us, vs, ps = self.behind(distance)
        wall = [u[0], p[0] / rho[0] ** GAMMA / self.entropy - 1]
        shock = [u[-1] - us, v[-1] - vs, np.log(p[-1] / ps)]
        inside = [mass.ravel(), radial.ravel() / self.mach**2, tangential.ravel() / self.mach**2]
        return np.concatenate(inside + [WEIGHT * f for f in wall + shock])

    def start(self, nose):
        """Newtonian pressure on the wall, linear from there to a parabolic shock."""
        distance = nose * (1 + 0.55 * self.theta**2 * (1 + 0.25 * self.theta**2))
        u, v, p = self.behind(distance)
        wall = np.maximum(self.p1 + (self.pitot - self.p1) * np.cos(self.theta) ** 2, 0.15 * self.pitot)
        rho = (wall / self.entropy) ** (1 / GAMMA)
        speed = np.sqrt(np.maximum(2 * (self.enthalpy - GAMMA / (GAMMA - 1) * wall / rho), 1e-12))
        e = self.eta[:, None]
        fields = [e * u, (1 - e) * speed + e * v, np.log((1 - e) * wall + e * p)]
        return np.concatenate([f.ravel() for f in fields] + [distance])

    def solve(self, unknowns, most=200):
        """Gauss-Newton with Levenberg's damping; derivatives by complex steps."""
        left, damping = self.equations(unknowns), 1e-2
        for _ in range(most):
            jacobian = np.empty((left.size, unknowns.size))
            for k in range(unknowns.size):
                step = unknowns.astype(complex)
                step[k] += 1e-30j
                jacobian[:, k] = self.equations(step).imag / 1e-30
            scale = np.sqrt((jacobian**2).sum(0))
            for _ in range(30):
                rows = np.vstack([jacobian, np.diag(np.sqrt(damping) * scale)])
                change = np.linalg.lstsq(rows, np.concatenate([-left, np.zeros(unknowns.size)]), rcond=None)[0]
                with np.errstate(all="ignore"):
                    tried = self.equations(unknowns + change)
                if np.all(np.isfinite(tried)) and tried @ tried < left @ left:
                    damping = max(damping / 10, 1e-14)
                    break
                damping *= 5
            else:
                break
            unknowns, left = unknowns + change, tried
            if np.abs(change).max() < 1e-11:
                break
        return unknowns, np.sqrt(left @ left / left.size)

    def on_axis(self, unknowns):
        distance, end = self.split(unknowns)[3], self.theta[0]
        both = np.concatenate([self.theta, -self.theta]), np.concatenate([distance, distance])
        return np.polynomial.chebyshev.Chebyshev.fit(*both, 2 * self.along - 2, domain=[-end, end])(0.0)


def main():
    parser = argparse.ArgumentParser(description="stand-off distance of a fitted bow shock")
    parser.add_argument("mach", type=float)
    parser.add_argument("--sphere", action="store_true")
    parser.add_argument("--across", type=int, default=14, help="points from body to shock")
    parser.add_argument("--along", type=int, default=12, help="points along the body")
    parser.add_argument("--end", type=float, default=1.1, help="angle in radians at which the region ends")
    asked = parser.parse_args()
    ladder = [m for m in (3.0, 2.7, 2.4, 2.2) if m > asked.mach] + [asked.mach]
    unknowns, before = None, None
    for mach in ladder:
        layer = Layer(mach, int(asked.sphere), asked.across, asked.along, asked.end)
        nose = 0.143 * np.exp(3.24 / mach**2) if asked.sphere else 0.386 * np.exp(4.67 / mach**2)
        first = layer.start(nose)
        if before is not None:
            u, v, p, distance = before.split(unknowns)
            k, p = mach / before.mach, np.log(p) + np.log(layer.pitot / before.pitot)
            first = np.concatenate([(u * k).ravel(), (v * k).ravel(), p.ravel(), distance * k**-1.6])
        unknowns, left = layer.solve(first)
        before = layer
        print(f"{mach:5.2f}  {layer.on_axis(unknowns):.6f}  {left:.1e}", flush=True)


if __name__ == "__main__":
    main()
