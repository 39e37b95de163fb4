"""Figure 12: Tensor laws
=========================

Can laws of second-order and fourth-order tensors be written as a pair (C, D)? The paper's
parameters are not public; those here are our own.
"""

import asperity as asp
import numpy as np
from asperity.demo import Check
from matplotlib.axes import Axes
from matplotlib.patches import Arc
from paper.curves import named
from paper.drawing import INK, SLIDING, Array, circle, draw_arrows, unit_vectors
from paper.frame import Redrawn, cross, draw_law, note, panels, shared_legend, show
from paper.statements import proposition_5, truth, vanishes
from scipy.integrate import cumulative_simpson

SECOND_ORDER = np.diag([0.3, 0.1])
"""Tensor of Fig. 12a."""


def fourth_order() -> Array:
    """Return the tensor of Fig. 12c: k₁₁₁₁ = k₂₂₂₂ = 0.1, k₁₁₂₂ = k₂₂₁₁ = −0.1."""
    tensor = np.zeros((2, 2, 2, 2))
    tensor[0, 0, 0, 0] = tensor[1, 1, 1, 1] = 0.1
    tensor[0, 0, 1, 1] = tensor[1, 1, 0, 0] = -0.1
    return tensor


def coefficient(phi: Array) -> Array:
    """Return the friction tensor of Fig. 12b, (0.2 + 0.05 cos 4φ) times the unit tensor."""
    return (0.2 + 0.05 * np.cos(4.0 * phi))[:, None, None] * np.eye(2)


def tensor_laws() -> dict[str, asp.FrictionLaw]:
    """Return the three laws of Fig. 12 by panel."""
    return {
        "a": asp.FrictionLaw.tensor(SECOND_ORDER),
        "b": asp.FrictionLaw.tensor_function(coefficient),
        "c": asp.FrictionLaw.tensor(0.2 * np.eye(2), fourth_order=fourth_order()),
    }


def _draw_angles(ax: Axes, law: asp.FrictionLaw, phi: float) -> None:
    """Mark θ, the angle of a force −λ, and φ, that of its sliding direction γ."""
    slip = unit_vectors(phi)
    force = -law.force(slip)
    theta = float(np.arctan2(force[1], force[0]))
    draw_arrows(ax, np.zeros((1, 2)), force[None], color=INK, gid="force from the origin")
    draw_arrows(
        ax, force[None], 0.09 * slip[None], color=SLIDING, gid="sliding direction of this force"
    )
    for apex, angle, radius, name in (
        (np.zeros(2), theta, 0.11, "theta"),
        (force, phi, 0.05, "varphi"),
    ):
        ax.add_patch(Arc(tuple(apex), 2 * radius, 2 * radius, theta2=np.rad2deg(angle), color=INK))
        level = apex + np.array([[0.0, 0.0], [1.3 * radius, 0.0]])
        named(f"{name} is counted from", ax.plot(*level.T, color=INK, linewidth=0.8))
        middle = apex + 1.35 * radius * unit_vectors(0.45 * angle)
        note(ax, rf"$\{name}$", middle, ha="center", va="center")


def _tensor_checks(laws: dict[str, asp.FrictionLaw]) -> list[Check]:
    a, b, c = laws.values()
    quarter = np.array([0.0, 0.5 * np.pi])
    radii = b.direction.radius(circle(720))
    rebuilt = asp.FrictionLaw.from_flow_rule(
        lambda phi: unit_vectors(phi) @ SECOND_ORDER.T
    ).direction
    checks = [
        Check("Fig. 12a p₁/p₂ = √3", 3.0**0.5, _ratio(a.direction.radius(quarter)), 1e-8),
        Check("Fig. 12a p₁/p₂ from forces alone", 3.0**0.5, _ratio(rebuilt.radius(quarter)), 1e-8),
        Check("Fig. 12a n₁/n₂", 3.0, _ratio(a.reservoir.radius(quarter)), 1e-8),
        vanishes(
            "Fig. 12a C − ellipse",
            a.reservoir.radius(circle(720)) - asp.Ellipse(0.3, 0.1).radius(circle(720)),
            1e-6,
        ),
        truth("Fig. 12b found collinear", b.is_collinear),
        Check("Fig. 12b largest / smallest r_D", 1.0, float(radii.max() / radii.min()), 1e-8),
        truth("Fig. 12b C is not convex", not b.reservoir.is_convex),
        truth("Fig. 12c C is not convex", not c.reservoir.is_convex),
        truth("Fig. 12c D is convex", c.direction.is_convex),
        Check("Fig. 12 closure of a skew tensor", 6.13, _closure(SECOND_ORDER + _SKEW), 5e-3),
        truth("Fig. 12 the skew tensor is refused", _refused(SECOND_ORDER + _SKEW)),
    ]
    for panel, law in laws.items():
        checks += [
            vanishes(f"Fig. 12{panel} (71) against D, relative", _quadrature(law), 1e-5),
            *proposition_5(f"Fig. 12{panel}", law),
        ]
    return checks


_SKEW = np.array([[0.0, -0.05], [0.05, 0.0]])


def _ratio(pair: Array) -> float:
    return float(pair[0] / pair[1])


def _closure(tensor: Array) -> float:
    """Return r_D(2π)/r_D(0) = exp ∮ l_p/l_t dφ by the rectangle rule, which is exact here."""
    phi = circle(720)
    force = unit_vectors(phi) @ tensor.T
    along = np.sum(force * unit_vectors(phi), axis=-1)
    across = np.sum(force * unit_vectors(phi + 0.5 * np.pi), axis=-1)
    return float(np.exp(2.0 * np.pi * np.mean(across / along)))


def _refused(tensor: Array) -> bool:
    try:
        asp.FrictionLaw.tensor(tensor)
    except asp.ParameterError:
        return True
    return False


def _quadrature(law: asp.FrictionLaw) -> Array:
    """r_D from (71) by Simpson's rule over θ, relative to r_D of the law."""
    phi = np.linspace(0.0, 2.0 * np.pi, 5761)
    force = -law.force(unit_vectors(phi))
    theta = np.unwrap(np.arctan2(force[:, 1], force[:, 0]))
    grown = np.exp(cumulative_simpson(np.tan(theta - phi), x=theta, initial=0.0))
    radius = law.direction.radius(theta)
    return grown * radius[0] / radius - 1.0


def draw() -> Redrawn:
    """Draw three tensor laws: orthotropic, with non-constant tensor, of fourth order."""
    figure, axes = panels(
        12, "tensor laws", 3, parameters="own parameters: those of the paper are not public"
    )
    laws = tensor_laws()
    titles = {
        "a": r"(a) $F = \mathrm{diag}(0.3, 0.1)$",
        "b": r"(b) $F = (0.2 + 0.05\cos 4\varphi)\,I$",
        "c": "(c) fourth order",
    }
    for ax, (panel, law) in zip(axes, laws.items(), strict=True):
        draw_law(law, ax, angles=8 if panel == "c" else 20)
        ax.set_title(titles[panel])
        cross(ax)
    _draw_angles(axes[2], laws["c"], np.deg2rad(60.0))
    shared_legend(figure, axes)
    return Redrawn(figure, _tensor_checks(laws))


# %%
if __name__ == "__main__":
    show(draw)
