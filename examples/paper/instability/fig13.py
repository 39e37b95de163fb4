"""Figure 13: Instability under isotropic friction
==================================================

Which mechanisms make steady sliding unstable although friction is isotropic? Below each sketch
stands what the system of `asperity.mechanisms` does. The paper gives no parameters.
"""

from collections.abc import Callable

import asperity as asp
import matplotlib.pyplot as plt
import numpy as np
from asperity import mechanisms
from asperity.demo import Check
from asperity.plot import plot_growth_chart, plot_root_locus
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from paper.curves import Curve, named
from paper.drawing import BLUE, INK, SLIP, STICK, Array
from paper.frame import OWN, Redrawn, drawn, heading, show
from paper.sketches import mechanisms as sketches
from paper.statements import truth, vanishes

FLUTTER, DIVERGENCE = 3.5 - 2.0**0.5, 3.5 + 2.0**0.5
"""Loads p = Pl/c at which the pendulum of Fig. 13d begins to flutter and to diverge."""

BORDER = "contour of no growth"
"""Name of the borders of instability in the table."""

_ROD = mechanisms.FrictionalImpactOscillator(1.0)


def _panels() -> tuple[Figure, list[Axes], list[Axes]]:
    figure, axes = plt.subplots(
        2, 4, figsize=(17.6, 7.6), layout="constrained", height_ratios=(0.75, 1.1)
    )
    heading(figure, 13, "friction-induced instability under isotropic friction", OWN)
    return figure, list(axes[0]), list(axes[1])


def stick_slip(dt: float = 5e-4) -> asp.Trajectory:
    """Return one cycle of the block on the belt, from the beginning of stick to the next."""
    motion = asp.simulate(mechanisms.stribeck_block(), dt=dt, t_end=60.0).slice(30.0, 60.0)
    sticking = motion.phase[:, 0] == asp.Phase.STICK
    begins = motion.t[1:][np.diff(sticking.astype(int)) == 1]
    return motion.slice(begins[0], begins[1])


def _draw_cycle(ax: Axes, cycle: asp.Trajectory) -> None:
    x, u = cycle.q[:, 0], cycle.u[:, 0]
    sticking = cycle.phase[:, 0] == asp.Phase.STICK
    for name, chosen, color in (("stick", sticking, STICK), ("slip", ~sticking, SLIP)):
        # Lines of the two phases touch: each begins at the last sample of the other.
        shown = chosen | np.append(chosen[1:], False)
        ax.plot(x[shown], u[shown], color=color, linewidth=2.0, label=name)
    rest = 1.0 / (1.0 + 3.0 * 0.2)
    ax.plot([rest], [0.0], "o", color=INK, markerfacecolor="white", label="unstable sliding")
    ax.set(title="(e) limit cycle of (a)", xlabel="$x$ in m", ylabel=r"$\dot x$ in m/s")
    ax.legend(loc="center", bbox_to_anchor=(0.42, 0.35))


def _draw_coupling(ax: Axes) -> None:
    mu, damping = np.linspace(0.3, 1.3, 141), np.linspace(0.0, 0.5, 101)
    growth = coupling_growth(mu[:, None], damping)
    named(BORDER, drawn(plot_growth_chart, growth, ax, x=mu, y=damping))
    ax.set(
        title="(f) growth rate of (b)",
        xlabel=r"friction coefficient $\mu$",
        ylabel="damping $d$ in N s/m",
    )


def _draw_oscillator(ax: Axes) -> None:
    mu, angle = np.linspace(0.0, 2.6, 161), np.deg2rad(np.linspace(10.0, 60.0, 121))
    growth = oscillator_growth(mu[:, None], angle)
    # Towards Painlevé's limit the inertia against the motion vanishes.
    named(BORDER, drawn(plot_growth_chart, growth, ax, x=mu, y=np.rad2deg(angle), limit=0.6))
    m1, m2 = _ROD.masses
    limit = np.tan(angle) + m2 / m1 / np.tan(angle)
    inside = limit <= mu[-1]
    ax.plot(limit[inside], np.rad2deg(angle[inside]), color=BLUE, linestyle="--", label="Painlevé")
    ax.set(
        title="(g) growth rate of (c)",
        xlabel=r"friction coefficient $\mu$",
        ylabel=r"angle $\varphi$ in degrees",
    )
    ax.legend(loc="upper left")


def _draw_follower(ax: Axes) -> list[Curve]:
    load = np.linspace(1.0, 6.0, 501)
    roots = np.linalg.eigvals(_first_order(*follower_matrices(load)))
    named("least p", drawn(plot_root_locus, roots, ax, values=load, label="$p = Pl/c$"))
    ax.set_title("(h) eigenvalues of (d)")
    return [
        ("h", f"eigenvalues at p = {p:.2f}", np.column_stack([row.real, row.imag]))
        for p, row in zip(load[::10], roots[::10], strict=True)
    ]


def _stribeck_checks(cycle: asp.Trajectory) -> list[Check]:
    found = asp.stability(mechanisms.stribeck_block())
    period = float(cycle.t[-1] - cycle.t[0])
    return [
        Check("Fig. 13a period", 12.001031, period, 2e-3, "s"),
        Check("Fig. 13a largest x", 1.133944, float(cycle.q.max()), 1e-3, "m"),
        Check("Fig. 13a growth rate −F'(v)/2", 0.5859375, found.growth_rate, 1e-9, "1/s"),
        truth("Fig. 13a the slope is the reason", _without(found, "Stribeck slope") <= 0.0),
    ]


def _limits() -> list[Check]:
    def coupled(mu: float) -> asp.steady_sliding.Stability:
        return asp.stability(mechanisms.mode_coupling(mu, belt_mass=1e-7))

    def leaning(mu: float) -> asp.steady_sliding.Stability:
        return asp.stability(_ROD.replace(mu=mu))

    def followed(p: float) -> asp.steady_sliding.Stability:
        return asp.stability(mechanisms.FollowerPendulum(p, normal_force=1.0))

    s, (dy, dphi) = np.sin(_ROD.angle), _ROD.damping
    leaned = float(np.tan(_ROD.angle) * (1.0 + dphi / (dy * s * s)))
    return [
        Check("Fig. 13b limit of μ", 0.75, _onset(coupled, 0.6, 0.9), 1e-6),
        Check("Fig. 13b growth rate at μ = 0.9", 0.157147, coupled(0.9).growth_rate, 1e-6, "1/s"),
        Check("Fig. 13b growth rate at μ = 1.2", 0.269036, coupled(1.2).growth_rate, 1e-6, "1/s"),
        truth(
            "Fig. 13b the coupling is the reason", _without(coupled(0.9), "mode coupling") <= 0.0
        ),
        Check("Fig. 13c limit of μ", leaned, _onset(leaning, 0.6, 1.2), 1e-6),
        truth(
            "Fig. 13c the velocity feedback is the reason",
            _without(leaning(1.0), "velocity feedback of the normal force") <= 0.0,
        ),
        Check("Fig. 13d flutter begins at p", FLUTTER, _onset(followed, 1.0, 3.0), 1e-6),
        Check(
            "Fig. 13d flutter ends at p", DIVERGENCE, _onset(followed, 4.0, 6.0, real=True), 1e-6
        ),
        truth(
            "Fig. 13d the follower is the reason", _without(followed(3.0), "follower force") <= 0.0
        ),
    ]


def _onset(
    found: Callable[[float], asp.steady_sliding.Stability],
    low: float,
    high: float,
    *,
    real: bool = False,
) -> float:
    """Return where a system becomes unstable, or the eigenvalues that grow become real."""
    while high - low > 1e-8:
        middle = 0.5 * (low + high)
        one = found(middle)
        growing = one.kind == "unstable"
        if growing and real:
            growing = bool(one.eigenvalues[0].imag == 0.0)
        low, high = (low, middle) if growing else (middle, high)
    return 0.5 * (low + high)


def _without(found: asp.steady_sliding.Stability, mechanism: str) -> float:
    """Return the growth rate that is left without a mechanism, NaN if it does not act."""
    return found.mechanisms.get(mechanism, float("nan"))


def _chart_checks() -> list[Check]:
    coupling = [
        asp.stability(mechanisms.mode_coupling(mu, damping=damping)).growth_rate
        - coupling_growth(np.array(mu), np.array(damping))
        for mu, damping in ((0.4, 0.3), (0.9, 0.1), (0.9, 0.45), (1.2, 0.2))
    ]
    leaning = [
        asp.stability(_ROD.replace(mu=mu, angle=angle)).growth_rate
        - oscillator_growth(np.array(mu), np.array(angle))
        for mu, angle in ((0.3, 0.3), (0.9, 0.3), (1.1, 0.6), (1.5, 0.9))
    ]
    return [
        vanishes("Fig. 13f growth rates against the linearised system", np.array(coupling), 1e-9),
        vanishes("Fig. 13g growth rates against the linearised system", np.array(leaning), 1e-7),
    ]


def coupling_growth(mu: Array, damping: Array, belt_mass: float = 1e-3) -> Array:
    """Return the growth rate of `mechanisms.mode_coupling` with closed contact."""
    one = np.ones(np.broadcast_shapes(mu.shape, damping.shape))
    return _growth(
        _matrix([[one, -mu * belt_mass], [0.0, 1.0 + belt_mass]]),
        _matrix([[damping * one, 0.0], [0.0, damping]]),
        _matrix([[2.0 * one, 1.0 - 4.0 * mu / 3.0], [1.0, 2.0]]),
    )


def oscillator_growth(mu: Array, angle: Array) -> Array:
    """Return the growth rate of the oscillator with closed contact; NaN beyond Painlevé's limit."""
    s, c, a = np.sin(angle), np.cos(angle), np.sin(angle) ** 2 - mu * np.sin(angle) * np.cos(angle)
    (m1, m2), (ky, kphi), (dy, dphi) = _ROD.masses, _ROD.stiffness, _ROD.damping
    inertia = m2 * c * c + m1 * a
    stiffness = kphi + ky * a - _ROD.normal_force * (c + mu * s)
    exists = inertia > 0.0
    rows = (np.where(exists, inertia, 1.0), dphi + dy * a, stiffness)
    growth = _growth(*(value[..., None, None] for value in rows))
    return np.where(exists, growth, np.nan)


def follower_matrices(load: Array) -> tuple[Array, Array, Array]:
    """Return M, B, K of the pendulum for loads p, with m l² = c = 1."""
    one = np.ones_like(load)
    mass = _matrix([[3.0 * one, 1.0], [1.0, 1.0]])
    return mass, 0.0 * mass, _matrix([[2.0 - load, load - 1.0], [-1.0, 1.0]])


def _growth(mass: Array, damping: Array, stiffness: Array) -> Array:
    return np.linalg.eigvals(_first_order(mass, damping, stiffness)).real.max(axis=-1)


def _first_order(mass: Array, damping: Array, stiffness: Array) -> Array:
    """Return [0, I; −M⁻¹K, −M⁻¹B] for stacks of matrices."""
    lower = -np.linalg.solve(mass, np.concatenate([stiffness, damping], axis=-1))
    n = mass.shape[-1]
    upper = np.broadcast_to(np.eye(n, 2 * n, n), lower.shape)
    return np.concatenate([upper, lower], axis=-2)


def _matrix(rows: list[list[Array | float]]) -> Array:
    """Return stacks of matrices from rows of entries that broadcast."""
    entries = np.broadcast_arrays(*(entry for row in rows for entry in row))
    stacked = np.stack(entries, axis=-1)
    return stacked.reshape(*stacked.shape[:-1], len(rows), len(rows[0]))


def draw() -> Redrawn:
    """Draw the mechanisms and what they do: a limit cycle, two stability charts, a root locus."""
    figure, upper, lower = _panels()
    cycle = stick_slip()
    for ax, draw, title in zip(
        upper,
        (
            sketches.stribeck_block,
            sketches.mode_coupling,
            sketches.impact_oscillator,
            sketches.follower_pendulum,
        ),
        ("(a) Stribeck effect", "(b) mode coupling", "(c) impact oscillator", "(d) follower force"),
        strict=True,
    ):
        draw(ax)
        ax.set_anchor("N")
        ax.set_title(title)
    _draw_cycle(lower[0], cycle)
    _draw_coupling(lower[1])
    _draw_oscillator(lower[2])
    eigenvalues = _draw_follower(lower[3])
    return Redrawn(figure, [*_stribeck_checks(cycle), *_limits(), *_chart_checks()], eigenvalues)


# %%
if __name__ == "__main__":
    show(draw)
