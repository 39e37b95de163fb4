"""How fast does a snake slither?
==============================

A snake sends waves down its body, and its scales slide more easily forwards than backwards or
across. Learn how to prescribe the shape of a body that friction moves, and how much of the speed
of its waves a snake gains.
"""

from functools import lru_cache

import asperity as asp
import matplotlib.pyplot as plt
import numpy as np
from scipy.optimize import root
from scipy.special import j0

LINKS, WAVES, AMPLITUDE = 24, 2, 0.9  # lengths relative to the snake's, times to the period

# %%
# Scales
# ------
# A link that slides with γ feels −λ/λ_N = F γ/‖γ‖, F = diag(μ along, μ across) in its axes, so
# that the force is not opposite to the sliding. The coefficients are those of a milk snake on
# cloth: 0.11 forwards, 0.14 backwards and 0.20 across [HuNirodyScottShelley2009].

FORWARDS, BACKWARDS, ACROSS = 0.11, 0.14, 0.20


def friction(phi):
    """Return F for sliding at angles to the link, towards the head at 0."""
    along = np.where(np.cos(phi) >= 0.0, FORWARDS, BACKWARDS)
    return np.stack([along, np.full_like(along, ACROSS)], axis=-1)[..., None] * np.eye(2)


# %%
# A body of prescribed shape
# --------------------------
# The links have the angles θ + A cos 2π (k s − t), s from the head. Centre and θ are left to
# friction; how the links move relative to them is the velocity χ of each contact.


@lru_cache(maxsize=8)
def kinematics(t, angle):
    """Return W and χ of all links, and their places from the centre."""
    phase = 2.0 * np.pi * (WAVES * (np.arange(LINKS) + 0.5) / LINKS - t)
    turned, rate = angle + AMPLITUDE * np.cos(phase), 2.0 * np.pi * AMPLITUDE * np.sin(phase)
    axes = np.array([[np.cos(turned), np.sin(turned)], [-np.sin(turned), np.cos(turned)]])
    # From the head every link extends along −e₁, whose rate is that of its angle times −e₂.
    links = -np.array([axes[0], axes[1] * rate]) / LINKS
    middles = np.cumsum(links, axis=-1) - 0.5 * links
    place, moving = middles - middles.mean(axis=-1, keepdims=True)
    lever = axes[:, 1] * place[0] - axes[:, 0] * place[1]
    directions = np.concatenate([axes, lever[:, None]], axis=1).transpose(2, 1, 0)
    return directions, np.einsum("kil,il->lk", axes, moving), place


class Snake(asp.System):
    """A chain of links on scales."""

    dof = 3
    coordinate_names = ("x", "y", "angle")
    coordinate_units = ("m", "m", "rad")
    constant_mass = True

    def __init__(self, law):
        self.contacts = [asp.ContactLaw(law, normal_force=1.0 / LINKS)] * LINKS

    def mass(self, q):
        """M, so small beside friction that its forces are in balance, as in slow snakes."""
        return 1e-6 * np.eye(3)

    def forces(self, t, q, u):
        """H = 0."""
        return np.zeros(3)

    def direction(self, t, q, contact):
        """W of a link."""
        return kinematics(t, q[2])[0][contact]

    def velocity(self, t, q, contact):
        """χ of a link."""
        return kinematics(t, q[2])[1][contact]


def slither(law, periods=1):
    """Return the motion of a snake."""
    return asp.simulate(Snake(law), dt=0.02, t_end=periods, q0=np.zeros(3), u0=np.zeros(3))


run = slither(asp.FrictionLaw.tensor_function(friction), periods=3)

# %%
# The balance of forces
# ---------------------
# Without sets and percussions: three equations for the velocities of centre and θ at each time,
# with γ/√(‖γ‖² + ε²) for the direction, and the midpoint rule.


def wrench(u, t, angle, epsilon):
    """Return forces and torque of friction, in the opposite direction."""
    directions, chi, _ = kinematics(t, angle)
    slip = np.einsum("lik,i->lk", directions, u) + chi
    along = slip / np.sqrt((slip**2).sum(axis=1) + epsilon**2)[:, None]
    F = friction(np.arctan2(slip[:, 1], slip[:, 0]))
    return np.einsum("lik,lkj,lj->i", directions, F, along)


def balanced(t, angle, u):
    """Return the velocities that friction leaves in balance."""
    for epsilon in (1e-2, 1e-3, 1e-4, 1e-5):
        u = root(wrench, u, args=(t, angle, epsilon), tol=1e-12).x
    assert np.abs(wrench(u, t, angle, epsilon)).max() < 1e-9
    return u


q, u, steps = np.zeros(3), np.zeros(3), 50
for k in range(steps):
    u = balanced(k / steps, q[2], u)
    u = balanced((k + 0.5) / steps, q[2] + 0.5 * u[2] / steps, u)
    q = q + u / steps
moved, expected = (np.linalg.norm(one[:2]) for one in (run.q[-1] - run.q[-1 - steps], q))
print(f"in one period it moves by {moved:.5f} of its length, by the balance of forces", end=" ")
print(f"by {expected:.5f}")
assert abs(moved / expected - 1.0) < 5e-4

# %%
# Scales that do not slide across
# -------------------------------
# A snake that cannot slide across follows its own track and gains J₀(A) of the speed of its waves,
# J₀ being the Bessel function: the mean of cos(A cos φ).

limit = j0(AMPLITUDE) / WAVES
ratios = np.array([1.5, 2.0, 4.0, 8.0, 16.0, 64.0, 1000.0])
ends = [slither(asp.FrictionLaw.tensor(np.diag([0.1, 0.1 * one]))).q[-1, :2] for one in ratios]
gained = np.linalg.norm(ends, axis=-1) / limit
for ratio, share in zip(ratios, gained, strict=True):
    print(f"coefficients across and along {ratio:6.1f} : 1, {share:.3f} of J₀(A)")
assert np.all(np.diff(gained) > 0.0)
assert 0.94 < gained[-1] < 1.0

# %%

with asp.plot.style():
    figure, (left, right) = plt.subplots(1, 2, figsize=(10.0, 3.8), layout="constrained")
    for k, color in ((0, "#999999"), (75, "#56B4E9"), (150, "#0072B2")):
        body = kinematics(run.t[k], run.q[k, 2])[2] + run.q[k, :2, None]
        left.plot(*body, color=color, linewidth=4.0, label=f"after {run.t[k]:.1f} periods")
        left.plot(*body[:, 0], "o", color=color, markersize=9.0)
    left.set(xlabel="$x$ in lengths of the snake", ylabel="$y$", aspect="equal", ylim=(-0.3, 0.4))
    left.legend(loc="upper left", fontsize="small")
    right.semilogx(ratios, gained, "o-", color="#D55E00", label="links on scales")
    right.axhline(1.0, color="#999999", linestyle="--", label="along its own track")
    right.set(
        xlabel="friction across over friction along", ylabel="speed over J₀(A) × speed of the waves"
    )
    right.legend(loc="lower right")
plt.show()
