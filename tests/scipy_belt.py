"""A second opinion on the mass on a belt: ellipses in closed form, phases by SciPy's Radau.

Slip is integrated as speed and angle, so that nothing but the equation of motion is shared with the
package. Mass and stiffness are one.
"""

import numpy as np
from scipy.integrate import solve_ivp
from scipy.optimize import brentq

START_SPEED, END_SPEED = 1e-9, 5e-10


def unit(angle):
    return np.array([np.cos(angle), np.sin(angle)])


def cross(a, b):
    return a[0] * b[1] - a[1] * b[0]


class Belt:
    """C: semi-axes `c`, turned by `zeta`; D: semi-axes `d`; belt velocity `v`."""

    def __init__(self, c, zeta, d, v, tolerance):
        turn = np.array([unit(zeta), unit(zeta + 0.5 * np.pi)]).T
        self.metric = turn @ np.diag(1.0 / np.square(c)) @ turn.T
        self.d2, self.v, self.tolerance = np.square(d), np.asarray(v), tolerance

    def resistance(self, n):
        z = self.d2 * n / np.sqrt((self.d2 * n * n).sum())
        return z / np.sqrt(z @ self.metric @ z)

    def slip_direction(self, load, last):
        """Of the directions n in which `load` exceeds friction, the nearest to the last one."""

        def crosswise(angle):
            return cross(unit(angle), load - self.resistance(unit(angle)))

        grid = np.linspace(0.0, 2.0 * np.pi, 2001)
        values = [crosswise(angle) for angle in grid]
        found = []
        for a, b, left, right in zip(grid, grid[1:], values, values[1:], strict=False):
            if left * right < 0.0:
                n = unit(brentq(crosswise, a, b, xtol=1e-14))
                if n @ (load - self.resistance(n)) > 0.0:
                    found.append(n)
        return max(found, key=lambda n: n @ last)

    def slip(self, q, last):
        """Return duration, end position and last direction of the slip that begins at `q`."""
        n = self.slip_direction(-(q + 1e-7 * self.v), last)

        def rates(_, x):
            n = unit(x[3])
            a = -x[:2] - self.resistance(n)
            return [*(self.v + x[2] * n), n @ a, cross(n, a) / x[2]]

        def slow(_, x):
            return x[2] - END_SPEED

        slow.terminal, slow.direction = True, -1
        start = [*q, START_SPEED, np.arctan2(n[1], n[0])]
        options = {"method": "Radau", "rtol": self.tolerance, "atol": 0.1 * self.tolerance}
        done = solve_ivp(rates, (0.0, 1e6), start, events=slow, **options)
        x = done.y[:, -1]
        n = unit(x[3])
        rest = x[2] / (n @ (x[:2] + self.resistance(n)))
        return done.t[-1] + rest, x[:2], n

    def stick(self, q):
        """Return the time until the load on a mass sticking from `q` on leaves C."""
        a, b = self.v @ self.metric @ self.v, q @ self.metric @ self.v
        return (-b + np.sqrt(b * b - a * (q @ self.metric @ q - 1.0))) / a

    def turn(self, angle, last):
        """Return the next angle at which the mass, sticking, reaches bdry C, and the durations."""
        q = unit(angle) / np.sqrt(unit(angle) @ self.metric @ unit(angle))
        slipping, q, last = self.slip(q, last)
        sticking = self.stick(q)
        q = q + sticking * self.v
        return np.arctan2(q[1], q[0]), slipping, sticking, last

    def cycle(self, angle, last):
        """Return durations of slip and stick on the limit cycle, by the secant method."""
        image = self.turn(angle, last)[0]
        defect, other = image - angle, angle
        angle = image
        for _ in range(10):
            image, slipping, sticking, last = self.turn(angle, last)
            if abs(image - angle) < 1e-11:
                return slipping, sticking
            slope = (image - angle - defect) / (angle - other)
            defect, other = image - angle, angle
            angle -= defect / slope
        raise AssertionError("the secant method does not converge")
